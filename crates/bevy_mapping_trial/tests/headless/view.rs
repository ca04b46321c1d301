//! The drawing of mapping trials, tested without a renderer.

use std::sync::Arc;

use bevy::asset::AssetEvent;
use bevy::camera::ScalingMode;
use bevy::camera::visibility::{RenderLayers, VisibilityPlugin};
use bevy::image::Image;
use bevy::mesh::{Mesh2d, MeshPlugin, VertexAttributeValues};
use bevy::prelude::*;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{step, test_app_with, wait_until_ready};
use bevy_mapping_trial::view::{
    FollowRobot, ShowIn3d, ShowWholeMap, TrialPalette, TrialSights, TrialView, TrialViewPlugin,
    WatchTrial, WatchTrials,
};
use envgen::hallway::HallwaySpec;
use envgen::{Blueprint, Seed, Spec, World as EnvgenWorld};
use mapping_trial::flat::FlatSimulator;
use mapping_trial::map::{Cell, CellIndex};
use mapping_trial::slam::SlamKind;
use mapping_trial::trial::{Trial, TrialSettings};

/// A component with a trial in the flat simulator, which a user shows in Bevy.
#[derive(Component)]
pub(super) struct Flat(pub(super) Option<Trial<FlatSimulator>>);

impl WatchTrial for Flat {
    type RobotBackend = FlatSimulator;

    fn watched(&self) -> Option<&Trial<FlatSimulator>> {
        self.0.as_ref()
    }
}

pub(super) fn hallway() -> Arc<EnvgenWorld> {
    let spec = HallwaySpec { segments: 12, ..default() };
    Arc::new(spec.generate(Seed(7)).unwrap().to_world())
}

pub(super) fn trial(world: &EnvgenWorld, robots: u32) -> Trial<FlatSimulator> {
    Trial::flat(world, TrialSettings { robots, time_limit: 60.0, ..default() }).unwrap()
}

/// Creates an app with everything that drawing needs except a GPU.
pub(super) fn app() -> App {
    let mut app = test_app_with((
        MeshPlugin,
        VisibilityPlugin,
        EnvgenPlugins::default(),
        TrialViewPlugin::default(),
    ));
    app.init_asset::<Image>().init_asset::<ColorMaterial>();
    app.watch_trials::<Flat>();
    app
}

pub(super) fn watch(
    app: &mut App,
    world: &Arc<EnvgenWorld>,
    trial: Trial<FlatSimulator>,
) -> Entity {
    let environment = Environment::prebuilt(world.clone());
    let root = app.world_mut().spawn((environment, Flat(Some(trial)))).id();
    wait_until_ready(app, root).unwrap();
    step(app, 2);
    root
}

pub(super) fn drive(app: &mut App, root: Entity, ticks: usize) {
    let mut trial = app.world_mut().get_mut::<Flat>(root).unwrap();
    let trial = trial.0.as_mut().unwrap();
    for _ in 0..ticks {
        trial.step();
    }
}

pub(super) fn named(app: &mut App, wanted: &str) -> Vec<Entity> {
    let mut names = app.world_mut().query::<(Entity, &Name)>();
    let found = names.iter(app.world()).filter(|(_, name)| name.as_str() == wanted);
    found.map(|(entity, _)| entity).collect()
}

fn is_seen(app: &App, entity: Entity) -> bool {
    app.world().get::<InheritedVisibility>(entity).unwrap().get()
}

/// Returns the column and the row in the name of a sheet.
fn place(name: &Name) -> Option<(i32, i32)> {
    let (col, row) = name.strip_prefix("map (")?.strip_suffix(')')?.split_once(", ")?;
    Some((col.parse().ok()?, row.parse().ok()?))
}

/// Returns the cell that a pixel shows, from the colours of the palette.
fn shown(pixel: &[u8], palette: &TrialPalette) -> Cell {
    if pixel == palette.free.to_srgba().to_u8_array() {
        Cell::Free
    } else if pixel == palette.occupied.to_srgba().to_u8_array() {
        Cell::Occupied
    } else {
        assert_eq!(pixel[3], 0, "what is unknown lets see what lies below");
        Cell::Unknown
    }
}

/// Compares every pixel with its cell, and returns how many pixels show something.
pub(super) fn compare(app: &mut App, root: Entity) -> usize {
    let mut sheets = app.world_mut().query::<(&Name, &Sprite, &Transform)>();
    let trial = app.world().get::<Flat>(root).unwrap().watched().unwrap();
    let map = trial.autonomy().slam().map();
    let palette = app.world().resource::<TrialPalette>();
    let images = app.world().resource::<Assets<Image>>();
    let mut known = 0;
    for (name, sprite, transform) in sheets.iter(app.world()) {
        let (col, row) = place(name).unwrap();
        let image = images.get(&sprite.image).unwrap();
        let side = image.width() as i32;
        assert_eq!(image.height() as i32, side);
        let metres = 0.05 * side as f32;
        assert_eq!(sprite.custom_size, Some(Vec2::splat(metres)));
        let middle = (Vec2::new(col as f32, row as f32) + 0.5) * metres;
        assert!(transform.translation.truncate().distance(middle) < 1e-3);
        let pixels = image.data.as_ref().unwrap().chunks_exact(4);
        for (i, pixel) in (0..).zip(pixels) {
            // The first row of pixels is the top row.
            let cell =
                CellIndex { col: col * side + i % side, row: row * side + side - 1 - i / side };
            assert_eq!(shown(pixel, palette), map.cell(cell), "{cell:?}");
            known += usize::from(map.cell(cell) != Cell::Unknown);
        }
    }
    let cells = map.tiles().flat_map(|(_, cells)| cells);
    let all = cells.filter(|odds| odds.abs() > mapping_trial::map::DECIDED).count();
    assert_eq!(known, all, "cells that no sheet shows");
    known
}

#[test]
fn the_map_that_is_shown_is_the_map() {
    let world = hallway();
    let mut app = app();
    let root = watch(&mut app, &world, trial(&world, 1));
    let mut known = 0;
    for ticks in [1, 20, 200, 400] {
        drive(&mut app, root, ticks);
        step(&mut app, 1);
        let now = compare(&mut app, root);
        assert!(now >= known);
        known = now;
    }
    assert!(known > 10_000, "{known}");

    // Other colours give another picture of the same map.
    app.world_mut().resource_mut::<TrialPalette>().free = Color::srgb_u8(1, 2, 3);
    step(&mut app, 1);
    assert_eq!(compare(&mut app, root), known);
}

/// Returns how many assets of a type were changed since the last call.
fn changes<A: Asset>(app: &mut App) -> usize {
    let mut events = app.world_mut().resource_mut::<Messages<AssetEvent<A>>>();
    let changed: std::collections::BTreeSet<_> = events
        .drain()
        .filter_map(|event| match event {
            AssetEvent::Modified { id } => Some(id),
            _ => None,
        })
        .collect();
    changed.len()
}

#[test]
fn only_what_changes_is_written() {
    let world = hallway();
    let mut app = app();
    let root = watch(&mut app, &world, trial(&world, 1));
    drive(&mut app, root, 900);
    step(&mut app, 2);
    let sheets = app.world().resource::<Assets<Image>>().len();
    assert!(sheets >= 6, "{sheets}");
    changes::<Image>(&mut app);
    changes::<Mesh>(&mut app);
    let entities = app.world().entities().count_spawned();

    // A paused trial costs nothing.
    step(&mut app, 10);
    assert_eq!((changes::<Image>(&mut app), changes::<Mesh>(&mut app)), (0, 0));
    assert_eq!(app.world().entities().count_spawned(), entities);

    // When the trial continues, only what the robot sees is written: the scan, the ends of two paths, and the
    // sheets around the robot.
    let revision = |app: &App| {
        let trial = app.world().get::<Flat>(root).unwrap().watched().unwrap();
        trial.autonomy().slam().map().revision()
    };
    let before = revision(&app);
    while revision(&app) == before {
        drive(&mut app, root, 1);
    }
    step(&mut app, 2);
    let written = changes::<Image>(&mut app);
    assert!((1..sheets).contains(&written), "{written} of {sheets}");
    assert!(changes::<Mesh>(&mut app) <= 3);
    compare(&mut app, root);
}

#[test]
fn the_truth_is_hidden_unless_asked_for() {
    let world = hallway();
    let mut app = app();
    // The truth is hidden from the first frame.
    let environment = Environment::prebuilt(world.clone()).with_pace(GenerationMode::Blocking);
    let people = ScenarioSpec { people: 1, ..default() };
    let moving = EnvironmentScenario::new(people, 1);
    let root = app.world_mut().spawn((environment, moving, Flat(Some(trial(&world, 1))))).id();
    let tell = |app: &mut App| {
        let mut walls = named(app, "Wall");
        let people = named(app, "Person");
        let truths = named(app, "truth");
        assert!(!walls.is_empty() && people.len() == 1 && truths.len() == 1);
        walls.extend(people);
        let seen: Vec<bool> = walls.iter().map(|&wall| is_seen(app, wall)).collect();
        assert!(seen.iter().all(|&wall| wall == seen[0]));
        (seen[0], is_seen(app, truths[0]))
    };
    for _ in 0..20 {
        step(&mut app, 1);
        drive(&mut app, root, 1);
        assert_eq!(tell(&mut app), (false, false));
    }
    let maps = named(&mut app, "map");
    assert!(is_seen(&app, maps[0]));

    app.world_mut().get_mut::<TrialView>(root).unwrap().truth = true;
    step(&mut app, 1);
    assert_eq!(tell(&mut app), (true, true));
    app.world_mut().get_mut::<TrialView>(root).unwrap().truth = false;
    step(&mut app, 1);
    assert_eq!(tell(&mut app), (false, false));

    // A world that is rebuilt is hidden again.
    app.world_mut().trigger(RebuildEnvironment { entity: root });
    for _ in 0..3 {
        step(&mut app, 1);
        assert_eq!(tell(&mut app), (false, false));
    }

    // When the trial is removed, the world is shown as before.
    app.world_mut().entity_mut(root).remove::<Flat>();
    step(&mut app, 1);
    assert!(!app.world().entity(root).contains::<TrialView>());
    let walls = named(&mut app, "Wall");
    assert!(walls.iter().all(|&wall| is_seen(&app, wall)));
    assert!(named(&mut app, "trial view").is_empty());
}

#[test]
fn cameras_in_three_dimensions_may_see_what_is_hidden_from_above() {
    let world = hallway();
    let mut app = app();
    let people = EnvironmentScenario::new(ScenarioSpec { people: 1, ..default() }, 1);
    let environment = Environment::prebuilt(world.clone()).with_pace(GenerationMode::Blocking);
    let parts = (environment, people, ShowIn3d, Flat(Some(trial(&world, 1))));
    let root = app.world_mut().spawn(parts).id();
    // Returns the two-dimensional meshes of walls and people, and whether two-dimensional cameras see them.
    let flat = |app: &mut App| {
        let mut drawn = named(app, "Wall");
        drawn.extend(named(app, "Person"));
        drawn.retain(|&entity| app.world().get::<Mesh2d>(entity).is_some());
        assert!(drawn.len() >= 2, "{drawn:?}");
        let seen = |&entity: &Entity| {
            let layers = app.world().get::<RenderLayers>(entity).cloned().unwrap_or_default();
            is_seen(app, entity) && layers.intersects(&RenderLayers::default())
        };
        let seen: Vec<bool> = drawn.iter().map(seen).collect();
        assert!(seen.iter().all(|&one| one == seen[0]), "{seen:?}");
        seen[0]
    };
    let tiles = |app: &mut App| {
        let mut tiles =
            app.world_mut().query_filtered::<&InheritedVisibility, With<bevy_envgen::Tile>>();
        tiles.iter(app.world()).all(|visibility| visibility.get())
    };
    for _ in 0..3 {
        step(&mut app, 1);
        assert!(!flat(&mut app) && tiles(&mut app));
    }
    app.world_mut().get_mut::<TrialView>(root).unwrap().truth = true;
    step(&mut app, 1);
    assert!(flat(&mut app) && tiles(&mut app));
    app.world_mut().get_mut::<TrialView>(root).unwrap().truth = false;
    app.world_mut().entity_mut(root).remove::<ShowIn3d>();
    step(&mut app, 1);
    assert!(!flat(&mut app) && !tiles(&mut app));
    app.world_mut().entity_mut(root).remove::<Flat>();
    step(&mut app, 1);
    assert!(flat(&mut app) && tiles(&mut app));
}

#[test]
fn robots_are_where_they_believe_to_be() {
    let world = hallway();
    let settings = TrialSettings { slam: SlamKind::DeadReckoning, time_limit: 300.0, ..default() };
    let mut app = app();
    let root = watch(&mut app, &world, Trial::flat(&world, settings).unwrap());
    drive(&mut app, root, 1500);
    step(&mut app, 2);
    let trial = app.world().get::<Flat>(root).unwrap().watched().unwrap();
    let estimate = trial.autonomy().slam().estimate(0).pose;
    let truth = *trial.trajectory(0).poses.last().unwrap();
    assert!(estimate.position.distance(truth.position) > 0.05, "the two must differ");
    let at = |app: &mut App, name: &str| {
        let entity = named(app, name)[0];
        app.world().get::<GlobalTransform>(entity).unwrap().compute_transform()
    };
    for (name, pose) in [("robot 0", estimate), ("true robot 0", truth)] {
        let shown = at(&mut app, name);
        assert!(shown.translation.truncate().distance(pose.position.as_vec2()) < 1e-3, "{name}");
        let heading = Vec2::from_angle(pose.heading as f32);
        assert!((shown.rotation * Vec3::X).truncate().distance(heading) < 1e-3, "{name}");
    }
    let sights = app.world().get::<TrialSights>(root).unwrap();
    assert!(sights.robots[0].distance(estimate.position.as_vec2()) < 1e-3);
}

/// Returns the corners of the meshes of entities with a name, in the frame of the environment.
fn corners(app: &mut App, name: &str) -> Vec<Vec2> {
    let mut all = Vec::new();
    for entity in named(app, name) {
        let Some(mesh) = app.world().get::<Mesh2d>(entity) else { continue };
        let at = app.world().get::<GlobalTransform>(entity).unwrap();
        let mesh = app.world().resource::<Assets<Mesh>>().get(&mesh.0).unwrap();
        let Some(VertexAttributeValues::Float32x3(corners)) =
            mesh.attribute(Mesh::ATTRIBUTE_POSITION)
        else {
            panic!("{name} has no corners");
        };
        all.extend(corners.iter().map(|&p| at.transform_point(p.into()).truncate()));
    }
    all
}

#[test]
fn a_scan_ends_at_the_walls() {
    let world = hallway();
    let mut app = app();
    let root = watch(&mut app, &world, trial(&world, 1));
    drive(&mut app, root, 5);
    step(&mut app, 2);
    let flat = app.world().get::<Flat>(root).unwrap().watched().unwrap();
    let scan = flat.autonomy().scan(0).clone();
    let beams = scan.ranges.len();
    assert_eq!(beams, 181);
    let corners = corners(&mut app, "scan 0");
    // The vertices are the position of the laser, the ends of the beams, and four corners of a point for each
    // beam.
    assert_eq!(corners.len(), 1 + 5 * beams);
    for (end, &range) in corners[1..].iter().zip(&scan.ranges) {
        if range.is_finite() {
            assert!((end.distance(corners[0]) - range as f32).abs() < 1e-3);
            let nearest = world.walls.iter().map(|wall| wall.shape.distance(end.as_dvec2()));
            // The robot has hardly moved, so its estimated pose is accurate.
            assert!(nearest.fold(f64::INFINITY, f64::min) < 0.1, "{end}");
        }
    }
    assert!(scan.ranges.iter().filter(|range| range.is_finite()).count() > 100);
}

#[test]
fn paths_follow_the_robots_also_through_loop_closing() {
    let world = hallway();
    for slam in [SlamKind::ScanToMap, SlamKind::PoseGraph] {
        let settings = TrialSettings { slam, robots: 2, time_limit: 60.0, ..default() };
        let mut app = app();
        let root = watch(&mut app, &world, Trial::flat(&world, settings).unwrap());
        for _ in 0..60 {
            drive(&mut app, root, 10);
            step(&mut app, 1);
        }
        let flat = app.world().get::<Flat>(root).unwrap().watched().unwrap();
        let near = |tracks: Vec<Vec2>, p: Vec2| tracks.iter().any(|q| q.distance(p) < 0.2);
        let mut tracks = Vec::new();
        for robot in 0..2 {
            tracks.extend(flat.autonomy().slam().trajectory(robot));
            tracks.extend(flat.trajectory(robot).poses.iter().copied());
        }
        let tracks: Vec<Vec2> = tracks.iter().map(|pose| pose.position.as_vec2()).collect();
        let drawn: Vec<Vec2> =
            corners(&mut app, "path").into_iter().filter(|p| *p != Vec2::ZERO).collect();
        assert!(drawn.len() > 200, "{}", drawn.len());
        assert!(drawn.iter().all(|&p| near(tracks.clone(), p)));
    }
}

#[test]
fn everything_goes_with_the_trial() {
    let world = hallway();
    let mut app = app();
    let root = watch(&mut app, &world, trial(&world, 2));
    drive(&mut app, root, 100);
    step(&mut app, 2);
    assert_eq!(named(&mut app, "robot 1").len(), 1);

    // Another trial begins without the second robot.
    app.world_mut().get_mut::<Flat>(root).unwrap().0 = Some(trial(&world, 1));
    step(&mut app, 2);
    assert_eq!((named(&mut app, "robot 0").len(), named(&mut app, "robot 1").len()), (1, 0));
    drive(&mut app, root, 10);
    step(&mut app, 1);
    compare(&mut app, root);

    // While there is no trial, none is drawn.
    app.world_mut().get_mut::<Flat>(root).unwrap().0 = None;
    step(&mut app, 2);
    assert!(named(&mut app, "robot 0").is_empty() && named(&mut app, "map").is_empty());

    app.world_mut().get_mut::<Flat>(root).unwrap().0 = Some(trial(&world, 1));
    step(&mut app, 2);
    app.world_mut().entity_mut(root).despawn();
    step(&mut app, 3);
    assert!(named(&mut app, "robot 0").is_empty());
    assert_eq!(app.world().resource::<Assets<Image>>().len(), 0);
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), 0);
}

#[test]
fn a_clone_of_an_environment_has_no_drawing() {
    let world = hallway();
    let mut app = app();
    let root = watch(&mut app, &world, trial(&world, 2));
    drive(&mut app, root, 100);
    step(&mut app, 2);
    let clone = app.world_mut().entity_mut(root).clone_and_spawn_with_opt_out(|builder| {
        builder.linked_cloning(true);
    });
    step(&mut app, 2);
    assert_eq!(named(&mut app, "trial view").len(), 1);
    // The world of the clone is not hidden either.
    assert!(!app.world().entity(clone).contains::<TrialView>());
    compare(&mut app, root);
    app.world_mut().entity_mut(clone).despawn();
    step(&mut app, 2);
    compare(&mut app, root);
}

#[test]
fn cameras_show_maps_and_robots_in_turned_and_scaled_environments() {
    let world = hallway();
    let mut app = app();
    let root = watch(&mut app, &world, trial(&world, 1));
    let near = FollowRobot { trial: root, robot: 0, height: 12.0 };
    let near = app.world_mut().spawn((Camera2d, near)).id();
    let turned = Transform::from_rotation(Quat::from_rotation_z(0.3));
    let whole = ShowWholeMap { trial: root, margin: 1.0 };
    let whole = app.world_mut().spawn((Camera2d, whole, turned)).id();
    drive(&mut app, root, 400);
    for (turn, scale) in [(0.0, 1.0), (1.2, 1.0), (std::f32::consts::FRAC_PI_2, 20.0)] {
        let place = Transform::from_xyz(30.0, -4.0, 0.0)
            .with_rotation(Quat::from_rotation_z(turn))
            .with_scale(Vec3::splat(scale));
        app.world_mut().entity_mut(root).insert(place);
        step(&mut app, 2);
        let scaling = |camera: Entity| match app.world().get::<Projection>(camera).unwrap() {
            Projection::Orthographic(seen) => seen.scaling_mode,
            _ => panic!("a flat camera"),
        };
        let ScalingMode::FixedVertical { viewport_height } = scaling(near) else {
            panic!("{:?}", scaling(near))
        };
        assert!((viewport_height - 12.0 * scale).abs() < 1e-3 * scale, "{viewport_height}");
        let ScalingMode::AutoMin { min_width, min_height } = scaling(whole) else {
            panic!("{:?}", scaling(whole))
        };
        let map = app.world().get::<TrialSights>(root).unwrap().map.unwrap();
        let into_camera = app.world().get::<GlobalTransform>(whole).unwrap().affine().inverse();
        let (mut least, mut most) = (Vec2::MAX, Vec2::MIN);
        let others = [Vec2::new(map.min.x, map.max.y), Vec2::new(map.max.x, map.min.y)];
        for corner in [map.min, map.max].into_iter().chain(others) {
            let seen = into_camera.transform_point3(place.transform_point(corner.extend(0.0)));
            (least, most) = (least.min(seen.truncate()), most.max(seen.truncate()));
        }
        let half = 0.5 * Vec2::new(min_width, min_height);
        assert!(most.cmple(half).all() && least.cmpge(-half).all(), "{least} {most} {half}");
        // There is little around the map.
        let around = 2.0 * half - (most - least);
        assert!(around.cmple(Vec2::splat(13.0 * scale)).all(), "{least} {most} {half}");
    }
}

#[test]
fn cameras_look_at_robots_and_maps() {
    let world = hallway();
    let mut app = app();
    let root = watch(&mut app, &world, trial(&world, 1));
    let near = FollowRobot { trial: root, robot: 0, height: 12.0 };
    let near = app.world_mut().spawn((Camera2d, near)).id();
    let whole = ShowWholeMap { trial: root, margin: 1.0 };
    let whole = app.world_mut().spawn((Camera2d, whole)).id();
    drive(&mut app, root, 400);
    step(&mut app, 2);
    let sights = app.world().get::<TrialSights>(root).unwrap().clone();
    let look = |app: &App, camera: Entity| {
        let at = app.world().get::<Transform>(camera).unwrap().translation.truncate();
        match app.world().get::<Projection>(camera).unwrap() {
            Projection::Orthographic(seen) => (at, seen.scaling_mode),
            _ => panic!("a flat camera"),
        }
    };
    let (at, scaling) = look(&app, near);
    assert!(at.distance(sights.robots[0]) < 1e-3);
    assert!(matches!(scaling, ScalingMode::FixedVertical { viewport_height: 12.0 }));
    let (at, scaling) = look(&app, whole);
    let map = sights.map.unwrap();
    assert!(at.distance(map.center()) < 1e-3);
    let ScalingMode::AutoMin { min_width, min_height } = scaling else { panic!("{scaling:?}") };
    assert!(min_width >= map.width() + 2.0 && min_height >= map.height() + 2.0);

    // Cameras follow in the same frame in which the environment moves, even as children of a moved entity.
    let cart = Transform::from_xyz(4.0, -3.0, 0.0).with_rotation(Quat::from_rotation_z(1.0));
    let cart = app.world_mut().spawn(cart).id();
    let carried = FollowRobot { trial: root, robot: 0, height: 12.0 };
    let carried = app.world_mut().spawn((Camera2d, carried, ChildOf(cart))).id();
    let moved = Transform::from_xyz(30.0, 0.0, 0.0);
    app.world_mut().entity_mut(root).insert(moved);
    step(&mut app, 1);
    let sights = app.world().get::<TrialSights>(root).unwrap().clone();
    let robot = sights.robots[0] + Vec2::new(30.0, 0.0);
    assert!(look(&app, near).0.distance(robot) < 1e-3);
    assert!(look(&app, whole).0.distance(map.center() + Vec2::new(30.0, 0.0)) < 1e-3);
    let at = app.world().get::<GlobalTransform>(carried).unwrap().translation().truncate();
    assert!(at.distance(robot) < 1e-3, "{at}");
    // A parent that is stretched along x shows more to the sides, and the same height.
    app.world_mut().entity_mut(cart).insert(Transform::from_scale(Vec3::new(4.0, 1.0, 1.0)));
    step(&mut app, 1);
    let (_, scaling) = look(&app, carried);
    assert!(matches!(scaling, ScalingMode::FixedVertical { viewport_height: 12.0 }), "{scaling:?}");
}

#[test]
fn trials_may_be_spawned_before_the_plugin_is_added() {
    let world = hallway();
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, EnvgenPlugins::default()));
    let environment = || Environment::prebuilt(world.clone());
    let hold = || Flat(Some(trial(&world, 1)));
    let early = app.world_mut().spawn((environment(), hold())).id();
    let own = TrialView { map: false, ..default() };
    let owner = app.world_mut().spawn((environment(), hold(), own)).id();
    app.add_plugins(TrialViewPlugin::default()).watch_trials::<Flat>();
    let late = app.world_mut().spawn((environment(), hold())).id();
    step(&mut app, 2);
    for (root, view) in [(early, TrialView::default()), (owner, own), (late, TrialView::default())]
    {
        assert_eq!(app.world().get(root), Some(&view));
    }
}

#[test]
fn without_plugins_that_draw_nothing_is_drawn() {
    let world = hallway();
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, EnvgenPlugins::default()));
    app.add_plugins(TrialViewPlugin::default()).watch_trials::<Flat>();
    let environment = Environment::prebuilt(world.clone()).with_pace(GenerationMode::Blocking);
    let root = app.world_mut().spawn((environment, Flat(Some(trial(&world, 1))))).id();
    for _ in 0..5 {
        drive(&mut app, root, 5);
        step(&mut app, 1);
    }
    assert!(named(&mut app, "trial view").is_empty());
    assert_eq!(app.world().get::<TrialSights>(root).unwrap().robots.len(), 1);
}
