//! Environments in Bevy's scenes, and clones of them.

use std::path::Path;

use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use bevy::world_serialization::DynamicWorldBuilder;
use bevy::world_serialization::serde::WorldDeserializer;
use bevy_envgen::envgen::glam::DVec2;
use bevy_envgen::envgen::indoor::Catalogue;
use bevy_envgen::envgen::{Seed, WorldKind};
use bevy_envgen::physics::ColliderMerging;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{
    digest, parts, spawn_ready, step, test_app_in, test_app_with, wait_until_ready,
};
use bevy_envgen::{GroundTruth, Tile, WorldSource};
use serde::de::DeserializeSeed;

fn app() -> App {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets").canonicalize().unwrap();
    let mut app = test_app_in(&assets);
    app.insert_resource(StreamingBudget::Parts(1_000_000));
    with_hierarchy(app)
}

/// Creates an app without rapier, some of whose components do not reflect.
fn app_without_physics() -> App {
    with_hierarchy(test_app_with((EnvgenCorePlugin::default(), EnvgenAssetPlugin)))
}

/// Lets scenes hold the hierarchy, as in apps with Bevy's `reflect_auto_register`.
fn with_hierarchy(mut app: App) -> App {
    app.register_type::<ChildOf>().register_type::<Children>();
    app
}

/// Saves a scene of some entities, with all of their reflected components.
fn save(app: &App, entities: &[Entity]) -> String {
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let scene = DynamicWorldBuilder::from_world(app.world(), &registry)
        .extract_entities(entities.iter().copied())
        .build();
    scene.serialize(&registry).unwrap()
}

/// Loads a scene. Returns its entities by their ids in the scene.
fn load(app: &mut App, text: &str) -> EntityHashMap<Entity> {
    let scene = {
        let registry = app.world().resource::<AppTypeRegistry>().read();
        let mut server = app.world().resource::<AssetServer>().clone();
        let seed = WorldDeserializer { type_registry: &registry, load_from_path: &mut server };
        seed.deserialize(&mut ron::de::Deserializer::from_str(text).unwrap()).unwrap()
    };
    let mut entities = EntityHashMap::default();
    scene.write_to_world(app.world_mut(), &mut entities).unwrap();
    entities
}

/// Returns environments of every kind of source, with settings that are not the default ones.
fn environments(app: &App) -> Vec<Environment> {
    let mut environments: Vec<_> = WorldKind::ALL
        .iter()
        .map(|kind| Environment::new(kind.default_spec(), 7).with_origin(DVec2::new(0.1, -1e5)))
        .collect();
    let rooms = Some(Catalogue::builtin().clone());
    let hallway = HallwaySpec { segments: 12, p_st: 0.1 + 0.2, ..default() };
    let world = WorldSpec::from(hallway.clone()).generate(Seed(3)).unwrap().to_world();
    let file = app.world().resource::<AssetServer>().load("worlds/paper_forest.envgen.ron");
    environments.extend([
        Environment::new(hallway, u64::MAX).with_pace(GenerationMode::Async),
        Environment::new(IndoorSpec { catalogue: rooms, ..default() }, 2)
            .with_solids(SolidStorage::TileData),
        Environment::prebuilt(world),
        Environment::from_asset(file, 5),
    ]);
    environments
}

#[test]
fn a_scene_gives_the_same_world_in_another_app() {
    let mut first = app();
    for environment in environments(&first) {
        let root = spawn_ready(&mut first, environment.clone()).unwrap();
        let at = Transform::from_xyz(5.0, 6.0, 0.0).with_rotation(Quat::from_rotation_z(1.0));
        let colliders = EnvironmentColliders(ColliderSettings {
            merge: ColliderMerging::Above(7),
            ..default()
        });
        let scenario = EnvironmentScenario::new(ScenarioSpec { people: 1, ..default() }, 3);
        first.world_mut().entity_mut(root).insert((at, colliders, scenario.clone()));
        let text = save(&first, &[root]);

        let mut second = app();
        let loaded = load(&mut second, &text)[&root];
        assert_ne!(second.world().get(loaded), Some(&EnvironmentState::Ready));
        wait_until_ready(&mut second, loaded).unwrap();
        assert_eq!(digest(&second, loaded), digest(&first, root), "{environment:?}");
        assert!(!parts(&second, loaded).is_empty());
        let (ours, theirs) = (second.world().entity(loaded), first.world().entity(root));
        assert_eq!(ours.get::<Transform>(), Some(&at));
        assert_eq!(ours.get::<EnvironmentColliders>(), Some(&colliders));
        assert_eq!(ours.get::<EnvironmentScenario>(), Some(&scenario));
        assert_eq!(**ours.get::<GroundTruth>().unwrap(), **theirs.get::<GroundTruth>().unwrap());
        let again = ours.get::<Environment>().unwrap();
        if !matches!(environment.source, WorldSource::Asset(_)) {
            assert_eq!(*again, environment);
        }
        first.world_mut().despawn(root);
        // The loaded environment can be saved again.
        save(&second, &[loaded]);
    }
}

#[test]
fn a_streamed_world_follows_the_anchor_of_its_scene() {
    let mut first = app();
    let at = Transform::from_xyz(300.0, -20.0, 0.0);
    let anchor = first.world_mut().spawn((Name::new("robot"), at)).id();
    let spec = ForestSpec { intensity: 0.05, radius: 0.3, ..default() };
    let environment = Environment::new(spec, 7).endless(12.0);
    let around = StreamAround::new(anchor, 40.0).with_tile(9.0);
    let root = first.world_mut().spawn((environment, around)).id();
    wait_until_ready(&mut first, root).unwrap();
    let text = save(&first, &[root, anchor]);

    let mut second = app();
    // Other entities are spawned first, so that ids are not equal by chance.
    second.world_mut().spawn_batch((0..50).map(|i| Name::new(format!("other {i}"))));
    let entities = load(&mut second, &text);
    let (loaded, robot) = (entities[&root], entities[&anchor]);
    assert_ne!(robot, anchor);
    let stream = second.world().get::<StreamAround>(loaded);
    assert_eq!(stream, Some(&StreamAround { anchor: robot, ..around }));
    wait_until_ready(&mut second, loaded).unwrap();
    assert_eq!(digest(&second, loaded), digest(&first, root));
    assert!(parts(&second, loaded).len() > 100);
}

#[test]
fn a_scene_of_all_entities_leaves_each_part_once() {
    let mut first = app_without_physics();
    let environment = Environment::new(HallwaySpec::default(), 4);
    let root = spawn_ready(&mut first, environment).unwrap();
    let mut all: Vec<Entity> = vec![root];
    let mut below = first.world_mut().query_filtered::<Entity, With<ChildOf>>();
    all.extend(below.iter(first.world()));
    let text = save(&first, &all);

    let mut second = app_without_physics();
    let loaded = load(&mut second, &text)[&root];
    let expected = parts(&first, root);
    assert_eq!(parts(&second, loaded), expected);
    let mut of = second.world_mut().query::<&PartOf>();
    assert!(of.iter(second.world()).all(|part| part.0 == loaded));
    wait_until_ready(&mut second, loaded).unwrap();
    step(&mut second, 2);
    assert_eq!(parts(&second, loaded), expected);
    assert_eq!(of.iter(second.world()).count(), expected.len());
}

#[test]
fn a_clone_makes_a_world_of_its_own() {
    let mut app = app();
    let environment = Environment::new(IndoorSpec::default(), 4);
    let root = spawn_ready(&mut app, environment).unwrap();
    let before = digest(&app, root);
    for deep in [false, true] {
        let clone = app.world_mut().entity_mut(root).clone_and_spawn_with_opt_out(move |builder| {
            builder.linked_cloning(deep);
        });
        assert_eq!(app.world().get(clone), Some(&EnvironmentState::Waiting));
        wait_until_ready(&mut app, clone).unwrap();
        assert_eq!((digest(&app, clone), digest(&app, root)), (before, before));
        let landmarks = *app.world().get::<EnvironmentLandmarks>(clone).unwrap();
        let start = landmarks.start.unwrap().part.unwrap();
        assert_eq!(app.world().get::<PartOf>(start), Some(&PartOf(clone)));
        app.world_mut().despawn(clone);
        let mut tiles = app.world_mut().query_filtered::<&ChildOf, With<Tile>>();
        assert!(tiles.iter(app.world()).all(|tile| tile.parent() == root));
    }
    // A clone of a streamed environment keeps the anchor, or uses the clone of the anchor if it is cloned
    // too.
    let anchor = app.world_mut().spawn(Transform::default()).id();
    app.world_mut().entity_mut(root).insert(StreamAround::new(anchor, 20.0));
    let clone = app.world_mut().entity_mut(root).clone_and_spawn();
    assert_eq!(app.world().get::<StreamAround>(clone).unwrap().anchor, anchor);
    app.world_mut().entity_mut(anchor).insert(ChildOf(root));
    let clone = app.world_mut().entity_mut(root).clone_and_spawn_with_opt_out(|builder| {
        builder.linked_cloning(true);
    });
    let cloned = app.world().get::<StreamAround>(clone).unwrap().anchor;
    assert_ne!(cloned, anchor);
    assert_eq!(app.world().get::<ChildOf>(cloned).unwrap().parent(), clone);
}
