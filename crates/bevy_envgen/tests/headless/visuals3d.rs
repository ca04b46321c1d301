//! The three-dimensional meshes of worlds, tested without a renderer.

use std::collections::BTreeSet;
use std::sync::Arc;

use bevy::light::{IrradianceVolume, Skybox};
use bevy::mesh::{MeshPlugin, MeshTag};
use bevy::prelude::*;
use bevy::world_serialization::DynamicWorldBuilder;
use bevy_envgen::EnvgenPlugins;
use bevy_envgen::envgen::WorldKind;
use bevy_envgen::envgen::glam::DVec2;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{
    refuse_ambiguities, spawn_ready, step, test_app_with, truth, wait_until_ready,
};
use bevy_envgen::visuals3d::{Figure, Finish, Palette3d, Sky, Stage, Sun, TileMesh};

use crate::{GenerateWorld, specs};

/// Creates an app with everything that drawing needs except a GPU.
pub(super) fn app() -> App {
    let visuals = EnvgenVisuals3dPlugin::default();
    let mut app = test_app_with((MeshPlugin, EnvgenPlugins::default(), visuals));
    app.init_asset::<StandardMaterial>().init_asset::<Image>();
    app
}

pub(super) fn indoor(side: u32) -> Environment {
    Environment::new(IndoorSpec { width: side, height: side, ..default() }, 4)
}

/// Returns the number of meshes of tiles.
fn meshes(app: &mut App) -> usize {
    app.world_mut().query::<&TileMesh>().iter(app.world()).count()
}

/// Returns the volume of the meshes of some finishes in cubic metres, by the theorem of Gauss, and their
/// lowest and highest corners.
fn volume(app: &mut App, is_counted: impl Fn(Finish) -> bool) -> (f64, Vec3, Vec3) {
    let mut drawn = app.world_mut().query::<(&TileMesh, &Mesh3d, &Transform)>();
    let meshes = app.world().resource::<Assets<Mesh>>();
    let (mut whole, mut low, mut high) = (0.0, Vec3::INFINITY, Vec3::NEG_INFINITY);
    for (_, mesh, at) in drawn.iter(app.world()).filter(|(mesh, ..)| is_counted(mesh.finish)) {
        let mesh = meshes.get(&mesh.0).unwrap();
        let corners = mesh.attribute(Mesh::ATTRIBUTE_POSITION).unwrap().as_float3().unwrap();
        let corner = |i: usize| at.transform_point(Vec3::from(corners[i]));
        let indices: Vec<usize> = mesh.indices().unwrap().iter().collect();
        // Corners are relative to a corner nearby, so that rounding errors are small.
        let pivot = corner(indices[0]);
        for t in indices.chunks(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| {
                (low, high) = (low.min(corner(i)), high.max(corner(i)));
                (corner(i) - pivot).as_dvec3()
            });
            whole += a.dot(b.cross(c)) / 6.0;
        }
    }
    (whole, low, high)
}

#[test]
fn nothing_is_kept_of_a_world_that_is_gone() {
    let world = Arc::new(IndoorSpec::default().generate_world(4));
    let indoor = || Environment::prebuilt(world.clone()).with_pace(GenerationMode::Blocking);
    let forest = Environment::new(ForestSpec::default(), 1).with_pace(GenerationMode::Blocking);
    let mut app = app();
    let root = spawn_ready(&mut app, indoor()).unwrap();
    assert!(Arc::strong_count(&world) > 1);
    app.world_mut().entity_mut(root).remove::<Environment>();
    step(&mut app, 2);
    assert_eq!(Arc::strong_count(&world), 1);
    app.world_mut().entity_mut(root).insert(indoor());
    step(&mut app, 2);
    app.world_mut().entity_mut(root).insert(forest);
    step(&mut app, 2);
    assert_eq!(Arc::strong_count(&world), 1);
}

#[test]
fn walls_have_the_volume_of_their_area_by_their_height() {
    let both = WorldKind::ALL.iter().flat_map(|kind| {
        [SolidStorage::Entities, SolidStorage::TileData].map(|solids| (kind, solids))
    });
    for (kind, solids) in both {
        let mut app = app();
        let origin = DVec2::new(3.0, -2.0);
        let environment = Environment::new(kind.default_spec(), 2).with_solids(solids);
        let root = spawn_ready(&mut app, environment.with_origin(origin)).unwrap();
        let truth = truth(&app, root);
        if truth.walls.is_empty() || *kind == WorldKind::Road {
            continue;
        }
        let is_plain = |kind| kind != bevy_envgen::envgen::world::WallKind::Partition;
        let walls = truth.walls.iter();
        let walls = walls.filter(|wall| is_plain(wall.kind) && wall.visible_range.is_none());
        let walls: f64 = walls.map(|wall| wall.shape.area() * wall.extent().height()).sum();
        let lintels = truth.doorways.iter().zip(truth.lintels());
        let lintels: f64 = lintels
            .map(|(door, lintel)| door.shape.area() * lintel.map_or(0.0, |l| l.height()))
            .sum();
        let is_wall = |finish| finish == Finish::Wall;
        let (found, low, high) = volume(&mut app, is_wall);
        let exact = walls + lintels;
        assert!((found - exact).abs() < 1e-3 * exact, "{kind}: {found} {exact}");
        let bounds = (truth.bounds.min - origin, truth.bounds.max - origin);
        assert!(low.truncate().as_dvec2().cmpge(bounds.0 - 0.3).all(), "{kind} {low}");
        assert!(high.truncate().as_dvec2().cmple(bounds.1 + 0.3).all(), "{kind} {high}");
        assert!(low.z == 0.0 && (high.z - 2.6).abs() < 1e-6, "{kind} {low} {high}");
    }
}

#[test]
fn a_large_building_needs_few_draws() {
    let mut app = app();
    spawn_ready(&mut app, indoor(16)).unwrap();
    let count = meshes(&mut app);
    assert!((5..=60).contains(&count), "{count} meshes");
    // Every mesh has one of a few materials, and belongs to a tile.
    let mut drawn = app.world_mut().query_filtered::<&ChildOf, With<TileMesh>>();
    let tiles: Vec<Entity> = drawn.iter(app.world()).map(ChildOf::parent).collect();
    assert!(tiles.iter().all(|tile| app.world().entity(*tile).contains::<bevy_envgen::Tile>()));
    let materials = app.world().resource::<Assets<StandardMaterial>>().len();
    assert!(materials <= 12, "{materials}");
}

/// Bodies with the same mesh and material are drawn with one call.
#[test]
fn what_moves_needs_few_draws() {
    let mut app = app();
    let moving = ScenarioSpec { doors: 1.0, people: 20, smoke: 0.1, ..default() };
    let request = EnvironmentScenario::new(moving, 1);
    let root = app.world_mut().spawn((indoor(16), request)).id();
    wait_until_ready(&mut app, root).unwrap();
    step(&mut app, 70);
    let world = app.world_mut();
    let leaves = world.query::<&DoorLeaf>().iter(world).count();
    assert!(leaves > 20, "{leaves} leaves");
    let boxes = world.query::<&Name>().iter(world).filter(|name| name.as_str() == "smoke").count();
    let mut plain = world.query::<(&Mesh3d, &MeshMaterial3d<StandardMaterial>)>();
    let bodies = plain.iter(world).count();
    let draws: BTreeSet<_> =
        plain.iter(world).map(|(mesh, material)| (mesh.id(), material.id())).collect();
    // All smoke shares one mesh. A test in the file of the smoke checks that it shares one material.
    let of_bodies: BTreeSet<_> = draws.iter().map(|(mesh, _)| *mesh).collect();
    let meshes: BTreeSet<_> = world.query::<&Mesh3d>().iter(world).map(|mesh| mesh.id()).collect();
    assert_eq!(meshes.len(), of_bodies.len() + 1);
    assert!(boxes > 20 && bodies > 100, "{boxes} boxes of smoke, {bodies} other bodies");
    let count = draws.len() + 1;
    assert!((5..=60).contains(&count), "{count} draws");
}

#[test]
fn trees_share_their_meshes() {
    for solids in [SolidStorage::Entities, SolidStorage::TileData] {
        let mut app = app();
        let spec = ForestSpec { width: 100.0, height: 100.0, intensity: 0.1, ..default() };
        let environment = Environment::new(spec, 1).with_solids(solids);
        let root = spawn_ready(&mut app, environment).unwrap();
        let trees = truth(&app, root).trees.clone();
        let mut crowns: Vec<(Vec3, Vec3)> = Vec::new();
        let mut handles = BTreeSet::new();
        let mut drawn = app.world_mut().query::<(&TileMesh, &Mesh3d, &Transform)>();
        for (mesh, handle, at) in drawn.iter(app.world()) {
            handles.insert(handle.0.id());
            if mesh.finish == Finish::Leaves {
                crowns.push((at.translation, at.scale));
            }
        }
        assert!(trees.len() > 500 && handles.len() <= 4, "{} {}", trees.len(), handles.len());
        assert_eq!(crowns.len(), trees.len());
        for tree in &trees {
            let crown = tree.crown();
            let middle = 0.5 * (crown.extent.bottom() + crown.extent.top());
            let at = tree.center.extend(middle).as_vec3();
            let (radius, height) = (crown.radius as f32, crown.extent.height() as f32);
            let scale = Vec3::new(radius, radius, height);
            assert!(crowns.iter().any(|(p, s)| p.distance(at) < 1e-4 && s.distance(scale) < 1e-4));
        }
    }
}

#[test]
fn trees_far_from_every_camera_have_fewer_triangles() {
    let mut app = app();
    let spec = ForestSpec { width: 400.0, height: 20.0, intensity: 0.1, ..default() };
    let forest = spawn_ready(&mut app, Environment::new(spec, 1)).unwrap();
    let eye = |x| (Camera3d::default(), Transform::from_xyz(x, 10.0, 1.0));
    // The triangles of trees, and their smallest distance to these positions.
    let triangles = |app: &mut App, eyes: &[f32]| {
        step(app, 1);
        let mut drawn = app.world_mut().query::<(&TileMesh, &Mesh3d, &GlobalTransform)>();
        let meshes = app.world().resource::<Assets<Mesh>>();
        let trees = drawn.iter(app.world()).filter(|(mesh, ..)| mesh.finish == Finish::Leaves);
        let mut found: Vec<(f32, usize)> = trees
            .map(|(_, mesh, at)| {
                let at = at.translation();
                let eyes = eyes.iter().map(|x| at.distance(Vec3::new(*x, 10.0, 1.0)));
                let count = meshes.get(&mesh.0).unwrap().indices().unwrap().len() / 3;
                (eyes.fold(f32::INFINITY, f32::min), count)
            })
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
    };
    let expected = |distance: f32| match distance {
        ..=60.0 => 120,
        ..=150.0 => 48,
        _ => 24,
    };
    assert!(triangles(&mut app, &[0.0]).iter().all(|(_, count)| *count == 120), "without cameras");
    let first = app.world_mut().spawn(eye(0.0)).id();
    for (distance, count) in triangles(&mut app, &[0.0]) {
        assert_eq!(count, expected(distance), "{distance}");
    }
    // Adds another camera, and moves one.
    let second = app.world_mut().spawn(eye(390.0)).id();
    for (distance, count) in triangles(&mut app, &[0.0, 390.0]) {
        assert_eq!(count, expected(distance), "{distance}");
    }
    app.world_mut().entity_mut(first).insert(Transform::from_xyz(200.0, 10.0, 1.0));
    let found = triangles(&mut app, &[200.0, 390.0]);
    assert!(found.iter().any(|(distance, _)| *distance > 150.0));
    for (distance, count) in found {
        assert_eq!(count, expected(distance), "{distance}");
    }
    // The forest is moved instead, so that it is to the right of both cameras.
    app.world_mut().entity_mut(forest).insert(Transform::from_xyz(500.0, 0.0, 0.0));
    for (distance, count) in triangles(&mut app, &[200.0, 390.0]) {
        assert_eq!(count, expected(distance), "{distance}");
    }
    // The forest is enlarged. A camera at its origin sees that too, and each moves by little in it.
    for (scale, [one, two]) in [
        (1.0, [0.0, 0.0]),
        (10.0, [0.0, 0.0]),
        (10.0, [9.0, 0.0]),
        (0.5, [9.0, 0.0]),
        (0.5, [11.0, 0.0]),
    ] {
        app.world_mut()
            .entity_mut(forest)
            .insert(Transform::from_xyz(0.0, 10.0, 1.0).with_scale(Vec3::splat(scale)));
        app.world_mut().entity_mut(first).insert(Transform::from_xyz(one, 10.0, 1.0));
        app.world_mut().entity_mut(second).insert(Transform::from_xyz(two, 10.0, 1.0));
        let found = triangles(&mut app, &[one, two]);
        assert!(found.iter().any(|(distance, _)| *distance > 150.0));
        for (distance, count) in found {
            assert_eq!(count, expected(distance), "{scale} {one} {two} {distance}");
        }
    }
    app.world_mut().entity_mut(forest).insert(Transform::IDENTITY);
    // All triangles are drawn with an orthographic projection, and if the settings say so.
    let flat = Projection::Orthographic(OrthographicProjection::default_3d());
    app.world_mut().entity_mut(first).insert(flat);
    assert!(triangles(&mut app, &[0.0]).iter().all(|(_, count)| *count == 120));
    app.world_mut().entity_mut(first).insert(Projection::default());
    assert!(triangles(&mut app, &[0.0]).iter().any(|(_, count)| *count < 120));
    app.world_mut().resource_mut::<Visuals3dSettings>().detail_distance = f32::INFINITY;
    assert!(triangles(&mut app, &[0.0]).iter().all(|(_, count)| *count == 120));
}

#[test]
fn ceilings_are_shown_on_demand() {
    let mut app = app();
    spawn_ready(&mut app, indoor(8)).unwrap();
    let shown = |app: &mut App| {
        let mut drawn = app.world_mut().query::<(&TileMesh, &Visibility)>();
        let ceilings = drawn.iter(app.world()).filter(|(mesh, _)| mesh.finish == Finish::Ceiling);
        let shown: Vec<bool> = ceilings.map(|(_, shown)| *shown != Visibility::Hidden).collect();
        assert!(!shown.is_empty());
        assert!(shown.iter().all(|now| *now == shown[0]));
        shown[0]
    };
    let suns = |app: &mut App| app.world_mut().query::<&Sun>().iter(app.world()).count();
    assert!(!shown(&mut app));
    step(&mut app, 1);
    assert_eq!(suns(&mut app), 1);
    app.world_mut().resource_mut::<Visuals3dSettings>().ceilings = true;
    step(&mut app, 2);
    assert!(shown(&mut app));
    // The sun does not shine in.
    assert_eq!(suns(&mut app), 0);
}

#[test]
fn each_world_has_one_stage_that_goes_with_it() {
    let mut app = app();
    let stages = |app: &mut App| {
        let stages = app.world_mut().query::<&Stage>().iter(app.world()).count();
        let lights = app.world_mut().query::<&IrradianceVolume>().iter(app.world()).count();
        assert_eq!(stages, lights);
        stages
    };
    let roots: Vec<Entity> = specs()
        .into_iter()
        .map(|spec| spawn_ready(&mut app, Environment::new(spec, 1)).unwrap())
        .collect();
    step(&mut app, 2);
    assert_eq!(stages(&mut app), roots.len());
    let shining = |app: &mut App| {
        let mut suns = app.world_mut().query_filtered::<&Visibility, With<Sun>>();
        suns.iter(app.world()).filter(|sun| **sun != Visibility::Hidden).count()
    };
    assert_eq!(shining(&mut app), 1);
    // Settings that are written with the same values change nothing, and others do.
    let entities = |app: &mut App| -> Vec<Entity> {
        let mut stages = app.world_mut().query_filtered::<Entity, With<Stage>>();
        stages.iter(app.world()).collect()
    };
    let before = entities(&mut app);
    for brightness in [1.0, 1.0, 0.5] {
        app.world_mut().resource_mut::<Visuals3dSettings>().brightness = brightness;
        step(&mut app, 1);
        assert_eq!(entities(&mut app) == before, brightness == 1.0);
    }
    // Another seed is another world.
    app.world_mut().get_mut::<Environment>(roots[0]).unwrap().seed = 9;
    step(&mut app, 3);
    assert_eq!(stages(&mut app), roots.len());
    app.world_mut().entity_mut(roots[0]).remove::<Environment>();
    step(&mut app, 2);
    assert_eq!((stages(&mut app), shining(&mut app)), (roots.len() - 1, 1));
    for root in &roots[1..] {
        app.world_mut().entity_mut(*root).despawn();
    }
    step(&mut app, 3);
    assert_eq!((stages(&mut app), meshes(&mut app)), (0, 0));
}

#[test]
fn people_doors_and_smoke_have_bodies() {
    let mut app = app();
    let moving = ScenarioSpec { doors: 1.0, people: 4, smoke: 0.4, smoke_growth: 5.0, ..default() };
    let request = EnvironmentScenario::new(moving, 1);
    let root = app.world_mut().spawn((indoor(8), request)).id();
    wait_until_ready(&mut app, root).unwrap();
    step(&mut app, 70);
    let world = app.world_mut();
    for entity in world.query_filtered::<Entity, With<Person>>().iter(world).collect::<Vec<_>>() {
        let children = world.get::<Children>(entity).unwrap();
        assert_eq!(
            children.iter().filter(|child| world.entity(*child).contains::<Mesh3d>()).count(),
            1
        );
    }
    let mut leaves = world.query::<(&DoorLeaf, &Children)>();
    let leaves: Vec<_> = leaves.iter(world).map(|(leaf, c)| (leaf.length, c[0])).collect();
    assert!(leaves.len() > 5);
    let shared = world.get::<Mesh3d>(leaves[0].1).unwrap().0.clone();
    for (length, mesh) in leaves {
        let scale = world.get::<Transform>(mesh).unwrap().scale;
        assert_eq!((scale.x, scale.y), (length.max(1e-3), 1.0));
        assert!((scale.z - 2.1).abs() < 0.02, "{scale}");
        assert_eq!(world.get::<Mesh3d>(mesh).unwrap().0, shared);
    }
    // The tags of the boxes have their extinction coefficient.
    let mut smoke = world.query::<(&bevy_envgen::scenario::Smoke, &Children)>();
    let boxes: Vec<_> = smoke
        .iter(world)
        .flat_map(|(smoke, boxes)| boxes.iter().map(move |entity| (smoke.extinction, entity)))
        .collect();
    assert!(boxes.iter().any(|(extinction, _)| *extinction > 0.01));
    for (extinction, entity) in boxes {
        let MeshTag(tag) = world.get::<MeshTag>(entity).expect("a box of smoke has a tag");
        let root = f64::from(tag >> 12) / 8192.0;
        assert!((root * root - extinction).abs() < 1e-3, "{extinction} {root}");
        // There are lit rooms and dark rooms.
        let light = f64::from(tag & 4095) / 4095.0;
        assert!((light - 0.75).abs() < 1e-3 || light < 0.2, "{light}");
    }
    let state = world.get::<ScenarioRun>(root).unwrap().state();
    let shapes = state.smoke().flat_map(|(place, _)| state.smoke_shapes(place));
    let exact: f64 = shapes.map(|shape| 2.6 * shape.area()).sum();
    let mut boxes = world.query::<(&Name, &Transform, &Mesh3d)>();
    let boxes = boxes.iter(world).filter(|(name, ..)| name.as_str() == "smoke");
    let found: f64 = boxes.map(|(_, at, _)| f64::from(at.scale.element_product())).sum();
    assert!(exact > 10.0 && (found - exact).abs() < 0.01 * exact, "{found} {exact}");
    let before = world.query::<&Mesh3d>().iter(world).count();
    world.entity_mut(root).remove::<EnvironmentScenario>();
    step(&mut app, 2);
    assert!(app.world_mut().query::<&Mesh3d>().iter(app.world()).count() < before);
}

#[test]
fn streamed_worlds_have_the_meshes_of_their_tiles() {
    let mut app = app();
    app.insert_resource(StreamingBudget::Parts(100_000));
    let anchor = app.world_mut().spawn(Transform::default()).id();
    let environment = Environment::new(ForestSpec::default(), 1).endless(10.0);
    let stream = StreamAround::new(anchor, 30.0);
    let root = app.world_mut().spawn((environment, stream)).id();
    wait_until_ready(&mut app, root).unwrap();
    let trees = |app: &mut App| app.world_mut().query::<&Tree>().iter(app.world()).count();
    for x in [0.0, 200.0] {
        app.world_mut().get_mut::<Transform>(anchor).unwrap().translation.x = x;
        for _ in 0..20 {
            step(&mut app, 1);
            bevy_envgen::testing::wait_until_ready(&mut app, root).unwrap();
        }
        let count = trees(&mut app);
        assert!(count > 20 && meshes(&mut app) == 2 * count, "{count}");
    }
}

#[test]
fn the_sky_is_switched_on_and_off() {
    let mut app = app();
    let own = Sky { zenith: Color::BLACK, ..default() };
    let skies = |app: &App, cameras: [Entity; 3]| {
        cameras.map(|camera| {
            let camera = app.world().entity(camera);
            (camera.contains::<Sky>(), camera.contains::<Skybox>())
        })
    };
    let camera = |app: &mut App| app.world_mut().spawn(Camera3d::default()).id();
    let [bare, changed, others] = [(); 3].map(|()| camera(&mut app));
    app.world_mut().entity_mut(others).insert(Sky::default());
    let cameras = [bare, changed, others];
    let all = [(true, true); 3];
    step(&mut app, 2);
    assert_eq!(skies(&app, cameras), all);
    app.world_mut().entity_mut(changed).insert(own);
    for _ in 0..2 {
        app.world_mut().resource_mut::<Visuals3dSettings>().sky = false;
        step(&mut app, 2);
        assert_eq!(skies(&app, cameras), [(false, false), (true, true), (true, true)]);
        app.world_mut().resource_mut::<Visuals3dSettings>().sky = true;
        step(&mut app, 2);
        assert_eq!(skies(&app, cameras), all);
    }
    // A skybox of the app is not removed.
    app.world_mut().entity_mut(bare).insert(Skybox::default()).remove::<Sky>();
    step(&mut app, 2);
    assert_eq!(skies(&app, cameras)[0], (false, true));
}

#[test]
fn a_sky_from_before_its_camera_is_drawn() {
    let mut app = app();
    let camera = app.world_mut().spawn(Sky::default()).id();
    step(&mut app, 2);
    assert!(!app.world().entity(camera).contains::<Skybox>());
    app.world_mut().entity_mut(camera).insert(Camera3d::default());
    step(&mut app, 2);
    assert!(app.world().entity(camera).contains::<Skybox>());
}

#[test]
fn a_figure_that_is_removed_is_no_longer_drawn() {
    let mut app = app();
    let player = app.world_mut().spawn(Figure).id();
    let drawn = |app: &mut App| app.world_mut().query::<&Mesh3d>().iter(app.world()).count();
    step(&mut app, 1);
    assert_eq!(drawn(&mut app), 1);
    app.world_mut().entity_mut(player).remove::<Figure>();
    step(&mut app, 1);
    assert_eq!(drawn(&mut app), 0);
    app.world_mut().entity_mut(player).insert(Figure);
    step(&mut app, 1);
    assert_eq!(drawn(&mut app), 1);
}

#[test]
fn clones_and_scenes_are_drawn_once() {
    let mut app =
        test_app_with((MeshPlugin, EnvgenCorePlugin::default(), EnvgenVisuals3dPlugin::default()));
    app.init_asset::<StandardMaterial>().init_asset::<Image>();
    app.register_type::<ChildOf>().register_type::<Children>();
    let root = spawn_ready(&mut app, indoor(4)).unwrap();
    let player = app.world_mut().spawn(Figure).id();
    step(&mut app, 2);
    let named = |app: &mut App, wanted: &str| {
        let mut names = app.world_mut().query::<&Name>();
        names.iter(app.world()).filter(|name| name.as_str() == wanted).count()
    };
    let counts = |app: &mut App| ["stage", "ground", "sun", "figure"].map(|name| named(app, name));
    assert_eq!(counts(&mut app), [1; 4]);
    for entity in [root, player] {
        app.world_mut().entity_mut(entity).clone_and_spawn_with_opt_out(|builder| {
            builder.linked_cloning(true);
        });
    }
    step(&mut app, 5);
    assert_eq!(counts(&mut app), [2; 4]);

    let scene = {
        let below = |of: Entity| {
            let mut all = vec![of];
            let mut next = 0;
            while let Some(&entity) = all.get(next) {
                all.extend(app.world().get::<Children>(entity).into_iter().flatten());
                next += 1;
            }
            all
        };
        let registry = app.world().resource::<AppTypeRegistry>().read();
        DynamicWorldBuilder::from_world(app.world(), &registry)
            .extract_entities([below(root), below(player)].concat().into_iter())
            .build()
    };
    scene.write_to_world(app.world_mut(), &mut default()).unwrap();
    step(&mut app, 5);
    assert_eq!(counts(&mut app), [3; 4]);
    let mut figures = app.world_mut().query_filtered::<&Children, With<Figure>>();
    assert!(figures.iter(app.world()).all(|children| children.len() == 1));
}

#[test]
fn colours_and_settings_that_an_app_has_are_kept() {
    let mut app = App::new();
    let settings = Visuals3dSettings { ceilings: true, ..default() };
    app.insert_resource(settings).add_plugins(EnvgenVisuals3dPlugin::default());
    assert_eq!(*app.world().resource::<Visuals3dSettings>(), settings);
    let mut app = App::new();
    let own = EnvgenVisuals3dPlugin::new(Visuals3dSettings::default());
    app.insert_resource(settings).add_plugins(own);
    assert_eq!(*app.world().resource::<Visuals3dSettings>(), Visuals3dSettings::default());
}

#[test]
fn without_plugins_for_meshes_nothing_is_drawn() {
    let mut app = test_app_with((EnvgenPlugins::default(), EnvgenVisuals3dPlugin::default()));
    spawn_ready(&mut app, Environment::new(WorldKind::Indoor.default_spec(), 2)).unwrap();
    step(&mut app, 3);
    assert_eq!(app.world_mut().query::<&Mesh3d>().iter(app.world()).count(), 0);
}

#[test]
fn no_two_of_our_systems_are_ambiguous() {
    let fixed = EnvgenPlugins::default().in_schedule(FixedUpdate);
    for envgen in [EnvgenPlugins::default(), fixed] {
        let visuals = EnvgenVisuals3dPlugin::default();
        let seen = (MeshPlugin, bevy::camera::visibility::VisibilityPlugin);
        let mut app = test_app_with((seen, envgen, EnvgenDiagnosticsPlugin, visuals));
        app.init_asset::<StandardMaterial>().init_asset::<Image>();
        refuse_ambiguities(&mut app);
        let moving = ScenarioSpec { doors: 0.5, people: 2, smoke: 0.1, ..default() };
        app.world_mut().spawn((indoor(6), EnvironmentScenario::new(moving, 1)));
        step(&mut app, 3);
        assert!(meshes(&mut app) > 0);
    }
}

#[test]
fn the_ground_of_an_endless_world_follows_its_anchor() {
    let mut app = app();
    let anchor = app.world_mut().spawn(Transform::from_xyz(5000.0, 0.0, 0.0)).id();
    let spec = ForestSpec { intensity: 0.01, ..default() };
    let around = StreamAround::new(anchor, 30.0);
    let root = app.world_mut().spawn((Environment::new(spec, 1).endless(30.0), around)).id();
    wait_until_ready(&mut app, root).unwrap();
    for x in [5000.0, 9000.0, -20_000.0] {
        app.world_mut().get_mut::<Transform>(anchor).unwrap().translation.x = x;
        step(&mut app, 3);
        let mut stages = app.world_mut().query_filtered::<&Transform, With<Stage>>();
        let stage = stages.single(app.world()).unwrap().translation;
        assert!((stage.x - x).abs() < 1600.0 && stage.x % 6.0 == 0.0, "{stage} for {x}");
    }
}

#[test]
fn new_worlds_have_the_colours_of_a_changed_palette() {
    let mut app = app();
    let forest = |seed| {
        let spec = ForestSpec { width: 20.0, height: 20.0, intensity: 0.1, ..default() };
        Environment::new(spec, seed)
    };
    let leaves = |app: &mut App| {
        let mut drawn = app.world_mut().query::<(&TileMesh, &MeshMaterial3d<StandardMaterial>)>();
        let materials = app.world().resource::<Assets<StandardMaterial>>();
        let mut leaves = drawn.iter(app.world()).filter(|(mesh, _)| mesh.finish == Finish::Leaves);
        let (_, material) = leaves.next().expect("a tree");
        materials.get(&material.0).unwrap().base_color
    };
    let root = spawn_ready(&mut app, forest(1)).unwrap();
    let before = leaves(&mut app);
    app.world_mut().resource_mut::<Palette3d>().crown = Color::srgb(0.9, 0.1, 0.1);
    app.world_mut().entity_mut(root).insert(forest(2));
    wait_until_ready(&mut app, root).unwrap();
    let Srgba { red, green, .. } = leaves(&mut app).to_srgba();
    assert_ne!(before, leaves(&mut app));
    assert!(red > 2.0 * green, "{red} {green}");
}
