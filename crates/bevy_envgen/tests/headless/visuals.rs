//! The two-dimensional meshes of worlds, tested without a renderer.

use bevy::camera::visibility::VisibilityPlugin;
use bevy::mesh::{Mesh2d, MeshPlugin};
use bevy::prelude::*;
use bevy_envgen::envgen::WorldKind;
use bevy_envgen::prelude::*;
use bevy_envgen::scenario::DoorKinds;
use bevy_envgen::testing::{spawn_ready, step, test_app_with, truth, wait_until_ready};
use bevy_envgen::{EnvgenPlugins, Tile};

/// Creates an app with everything that drawing needs except a GPU.
fn app() -> App {
    let mut app = test_app_with((MeshPlugin, EnvgenPlugins::default()));
    app.init_asset::<ColorMaterial>();
    app
}

/// Returns the area in square metres that is drawn for one group of parts.
fn area(app: &mut App, group: &str) -> f32 {
    let mut drawn = app.world_mut().query::<(&Name, &Mesh2d)>();
    let meshes = app.world().resource::<Assets<Mesh>>();
    drawn
        .iter(app.world())
        .filter(|(name, _)| name.starts_with(group))
        .map(|(_, mesh)| {
            let mesh = meshes.get(&mesh.0).unwrap();
            let corners = mesh.attribute(Mesh::ATTRIBUTE_POSITION).unwrap();
            let corners = corners.as_float3().unwrap();
            let at = |i: usize| Vec2::new(corners[i][0], corners[i][1]);
            let indices: Vec<usize> = mesh.indices().unwrap().iter().collect();
            indices
                .chunks(3)
                .map(|t| 0.5 * (at(t[1]) - at(t[0])).perp_dot(at(t[2]) - at(t[0])))
                .inspect(|area| assert!(*area > -1e-4, "a triangle runs clockwise"))
                .sum::<f32>()
        })
        .sum()
}

#[test]
fn what_is_drawn_has_the_area_of_the_parts() {
    let both = WorldKind::ALL.iter().flat_map(|kind| {
        [SolidStorage::Entities, SolidStorage::TileData].map(|solids| (kind, solids))
    });
    for (kind, solids) in both {
        let mut app = app();
        let environment = Environment::new(kind.default_spec(), 2).with_solids(solids);
        let root = spawn_ready(&mut app, environment).unwrap();
        let truth = truth(&app, root);
        let walls: f64 = truth.walls.iter().map(|wall| wall.shape.area()).sum();
        let things: f64 = truth.obstacles.iter().map(|thing| thing.shape.area()).sum();
        let trees: f64 =
            truth.trees.iter().map(|tree| std::f64::consts::PI * tree.radius * tree.radius).sum();
        let cells = truth.raster.as_ref().map_or(0.0, |raster| {
            let known = raster.cells.iter().filter(|&&class| class > 0).count();
            known as f64 * raster.cell * raster.cell
        });
        let roads: f64 =
            truth.road_strips.iter().map(|strip| strip.path().length() * strip.width).sum();
        for (group, exact, tolerance) in [
            ("Wall", walls, 1e-3),
            // Some obstacles are discs, which are drawn as polygons, as trees are.
            ("Obstacle", things, 0.02),
            ("Tree", trees, 0.1),
            ("Class", cells, 1e-3),
            ("Road", roads, 0.01),
        ] {
            let drawn = f64::from(area(&mut app, group));
            assert!((drawn - exact).abs() <= tolerance * exact, "{kind} {group}: {drawn} {exact}");
        }
    }
}

#[test]
fn people_leaves_and_smoke_are_drawn_as_they_are() {
    let mut app = app();
    let kinds = DoorKinds::Sliding;
    let moving = ScenarioSpec {
        doors: 1.0,
        door_kind: kinds,
        door_open: 1.0,
        door_closed: 1.0,
        people: 4,
        smoke: 0.4,
        smoke_growth: 5.0,
        ..default()
    };
    let root = app
        .world_mut()
        .spawn((
            Environment::new(WorldKind::Indoor.default_spec(), 4),
            EnvironmentScenario::new(moving, 1),
        ))
        .id();
    wait_until_ready(&mut app, root).unwrap();
    let people = area(&mut app, "Person");
    let exact = 4.0 * std::f32::consts::PI * 0.25 * 0.25;
    assert!(people < exact && people > 0.9 * exact, "{people} {exact}");
    let state = app.world().get::<ScenarioRun>(root).unwrap().state();
    let shapes = state.smoke().flat_map(|(place, _)| state.smoke_shapes(place));
    let exact: f64 = shapes.map(|shape| shape.area()).sum();
    let smoke = f64::from(area(&mut app, "Smoke"));
    assert!((smoke - exact).abs() < 0.01 * exact, "{smoke} {exact}");
    for _ in 0..20 {
        step(&mut app, 20);
        let mut leaves = app.world_mut().query::<(&DoorLeaf, &Children)>();
        let found: Vec<_> = leaves.iter(app.world()).map(|(leaf, c)| (leaf.length, c[0])).collect();
        assert!(found.len() > 5);
        for (length, mesh) in found {
            assert_eq!(app.world().get::<Transform>(mesh).unwrap().scale.x, length);
        }
        let mut smoke = app.world_mut().query::<(&Smoke, &Children)>();
        let found: Vec<_> = smoke.iter(app.world()).map(|(s, c)| (s.extinction, c[0])).collect();
        let materials = app.world().resource::<Assets<ColorMaterial>>();
        for (extinction, mesh) in found {
            let material = app.world().get::<MeshMaterial2d<ColorMaterial>>(mesh).unwrap();
            let alpha = f64::from(materials.get(&material.0).unwrap().color.alpha());
            assert!((alpha - (1.0 - (-extinction).exp())).abs() < 1e-6, "{extinction} {alpha}");
            let hidden = app.world().get::<Visibility>(mesh) == Some(&Visibility::Hidden);
            assert_eq!(hidden, extinction < 0.005, "{extinction}");
        }
    }
    let before = app.world().resource::<Assets<Mesh>>().len();
    app.world_mut().entity_mut(root).remove::<EnvironmentScenario>();
    step(&mut app, 3);
    assert_eq!(area(&mut app, "Smoke") + area(&mut app, "Person") + area(&mut app, "Leaf"), 0.0);
    assert!(app.world().resource::<Assets<Mesh>>().len() < before);
}

#[test]
fn materials_are_shared_and_everything_goes_with_the_environment() {
    let mut app = app();
    let roots: Vec<Entity> = (0..3)
        .map(|seed| {
            let environment = Environment::new(WorldKind::Indoor.default_spec(), seed);
            spawn_ready(&mut app, environment).unwrap()
        })
        .collect();
    let materials = app.world().resource::<Assets<ColorMaterial>>().len();
    // There is at most one material for every group, except for those of classes.
    assert!(materials <= 13, "{materials}");
    assert!(app.world().resource::<Assets<Mesh>>().len() > materials);
    for root in roots {
        app.world_mut().entity_mut(root).despawn();
    }
    step(&mut app, 3);
    assert_eq!(app.world_mut().query::<&Mesh2d>().iter(app.world()).count(), 0);
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), 0);
}

#[test]
fn without_plugins_for_meshes_nothing_is_drawn() {
    let mut app = test_app_with(EnvgenPlugins::default());
    spawn_ready(&mut app, Environment::new(WorldKind::Hallway.default_spec(), 2)).unwrap();
    assert_eq!(app.world_mut().query::<&Mesh2d>().iter(app.world()).count(), 0);
}

#[test]
fn an_app_can_hide_environments_that_precede_the_plugins() {
    let indoor = || {
        Environment::new(WorldKind::Indoor.default_spec(), 1).with_pace(GenerationMode::Blocking)
    };
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default()));
    app.add_plugins((MeshPlugin, VisibilityPlugin));
    let early = app.world_mut().spawn(indoor()).id();
    let hidden = app.world_mut().spawn((indoor(), Visibility::Hidden)).id();
    app.add_plugins(EnvgenPlugins::default()).init_asset::<ColorMaterial>();
    let late = app.world_mut().spawn(indoor()).id();
    let late_hidden = app.world_mut().spawn((indoor(), Visibility::Hidden)).id();
    step(&mut app, 3);
    let seen = |app: &mut App, root: Entity| {
        let mut tiles =
            app.world_mut().query_filtered::<(&ChildOf, &InheritedVisibility), With<Tile>>();
        let tiles = tiles.iter(app.world()).filter(|(below, _)| below.parent() == root);
        let seen: Vec<bool> = tiles.map(|(_, seen)| seen.get()).collect();
        assert!(!seen.is_empty() && seen.iter().all(|now| *now == seen[0]));
        seen[0]
    };
    for (root, is_seen) in [(early, true), (hidden, false), (late, true), (late_hidden, false)] {
        assert_eq!(seen(&mut app, root), is_seen);
        *app.world_mut().get_mut::<Visibility>(root).unwrap() = Visibility::Hidden;
        step(&mut app, 1);
        assert!(!seen(&mut app, root));
    }
}
