//! The plugins together with other plugins, and without them.

use std::time::Duration;

use bevy::ecs::schedule::ScheduleLabel;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_envgen::asset::EnvgenAssetPlugin;
use bevy_envgen::bevy_rapier2d::prelude::{
    BevyPhysicsHooks, Collider, CollisionEvent, MassModifiedMessage, NoUserData,
    RapierPhysicsPlugin, RigidBody,
};
use bevy_envgen::bevy_rapier2d::rapier::geometry::CollisionEventFlags;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{
    in_rapier, refuse_ambiguities, spawn_ready, step, test_app, test_app_with, wait_until_ready,
};
use bevy_envgen::{EnvironmentError, Tile};

use super::assets;

fn hallway() -> Environment {
    Environment::new(HallwaySpec::default(), 1).with_pace(GenerationMode::Blocking)
}

fn walls(app: &mut App) -> usize {
    app.world_mut().query::<&Wall>().iter(app.world()).count()
}

/// Creates Bevy's plugin for assets, with the assets of the project.
fn asset_plugin() -> AssetPlugin {
    AssetPlugin { file_path: assets().to_string_lossy().into_owned(), ..default() }
}

#[test]
fn no_two_of_our_systems_are_ambiguous() {
    let fixed = EnvgenPlugins::default().in_schedule(FixedUpdate);
    for mut app in [test_app(), test_app_with(fixed)] {
        refuse_ambiguities(&mut app);
        let moving = ScenarioSpec { people: 2, smoke: 0.1, ..default() };
        app.world_mut().spawn((hallway(), EnvironmentScenario::new(moving, 1)));
        step(&mut app, 3);
        assert!(walls(&mut app) > 0);
    }
}

#[test]
fn scenarios_in_the_schedule_of_transform_propagation_are_not_ambiguous() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin));
    app.add_plugins(RapierPhysicsPlugin::<NoUserData>::default());
    app.add_plugins(EnvgenPlugins::default().build().disable::<EnvgenScenarioPlugin>());
    app.add_plugins(EnvgenScenarioPlugin::new(PostUpdate));
    app.finish();
    app.cleanup();
    refuse_ambiguities(&mut app);
    let moving = ScenarioSpec { people: 2, smoke: 0.1, ..default() };
    app.world_mut().spawn((hallway(), EnvironmentScenario::new(moving, 1)));
    step(&mut app, 3);
    assert_eq!(app.world_mut().query::<&Person>().iter(app.world()).count(), 2);
}

#[test]
#[should_panic(expected = "ambigu")]
fn an_ambiguity_would_show() {
    let mut app = test_app();
    refuse_ambiguities(&mut app);
    app.add_systems(FixedUpdate, (|_: Query<&mut Transform>| {}, |_: Query<&mut Transform>| {}));
    step(&mut app, 3);
}

#[test]
fn each_plugin_works_without_its_neighbours() {
    // Only the core plugin: no time, task pools, transforms, assets or rapier.
    let mut app = App::new();
    app.add_plugins(EnvgenCorePlugin::default());
    app.world_mut().spawn(hallway());
    app.update();
    assert!(walls(&mut app) > 0);

    // Every plugin of the group, without any of the plugins that they can use.
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, EnvgenPlugins::default()));
    let root = app.world_mut().spawn(hallway()).id();
    let asset = app.world_mut().spawn(Environment::from_asset(Handle::default(), 1)).id();
    step(&mut app, 3);
    assert!(walls(&mut app) > 0);
    assert_eq!(app.world().get(asset), Some(&EnvironmentState::Failed));
    app.world_mut().despawn(root);
    step(&mut app, 2);

    // Bevy's asset plugin is added after ours, and the plugins of the group one by one in any order.
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, EnvgenAssetPlugin));
    app.add_plugins((EnvgenPhysicsPlugin::default(), EnvgenCorePlugin::default()));
    app.add_plugins((asset_plugin(), TopDownPhysicsPlugin::default()));
    app.finish();
    app.cleanup();
    app.world_mut().spawn(hallway());
    let paper = app.world().resource::<AssetServer>().load("worlds/paper_forest.envgen.ron");
    let paper = app.world_mut().spawn(Environment::from_asset(paper, 1)).id();
    wait_until_ready(&mut app, paper).unwrap();
    assert!(walls(&mut app) > 0);
}

#[test]
fn environments_may_be_spawned_before_the_plugins_are_added() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin));
    let early = app.world_mut().spawn(hallway()).id();
    app.add_plugins((TopDownPhysicsPlugin::default(), EnvgenPlugins::default()));
    app.finish();
    app.cleanup();
    let late = app.world_mut().spawn(hallway()).id();
    for root in [early, late] {
        wait_until_ready(&mut app, root).unwrap();
        assert!(walls(&mut app) > 0);
        app.world_mut().despawn(root);
    }
    step(&mut app, 3);
    assert_eq!((walls(&mut app), in_rapier(&mut app)), (0, (0, 0)));
}

/// Hooks as an app might have them.
#[derive(SystemParam)]
struct OwnHooks;

impl BevyPhysicsHooks for OwnHooks {}

#[test]
fn rapier_may_be_there_already_and_may_run_elsewhere() {
    let without_hooks = |app: &mut App| {
        app.add_plugins(RapierPhysicsPlugin::<NoUserData>::default());
    };
    let with_hooks = |app: &mut App| {
        app.add_plugins(RapierPhysicsPlugin::<OwnHooks>::default());
    };
    let others: [&dyn Fn(&mut App); 2] = [&without_hooks, &with_hooks];
    for add in others {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin));
        add(&mut app);
        app.add_plugins((TopDownPhysicsPlugin::default(), EnvgenPlugins::default()));
        app.world_mut().spawn(hallway());
        app.finish();
        app.cleanup();
        step(&mut app, 5);
        assert!(in_rapier(&mut app).0 > 10);
    }
}

#[test]
fn messages_of_rapier_are_cleared_once_per_frame_in_any_order_of_plugins() {
    type Step<'a> = &'a dyn Fn(&mut App);
    let rapier = |app: &mut App| {
        app.add_plugins(RapierPhysicsPlugin::<NoUserData>::default());
    };
    let ours = |app: &mut App| {
        app.add_plugins(EnvgenPlugins::default());
    };
    let top_down = |app: &mut App| {
        app.add_plugins(TopDownPhysicsPlugin::default());
    };
    let orders: [&[Step<'_>]; 5] =
        [&[&rapier, &ours], &[&ours, &rapier], &[&ours, &top_down], &[&top_down, &ours], &[&ours]];
    for (number, order) in orders.into_iter().enumerate() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin));
        for add in order {
            add(&mut app);
        }
        let frame = TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / 64.0));
        app.insert_resource(frame);
        app.finish();
        app.cleanup();
        step(&mut app, 3);
        if order.len() == 1 {
            assert!(!app.world().contains_resource::<Messages<CollisionEvent>>());
            continue;
        }
        let written = |app: &App| {
            let messages = app.world().resource::<Messages<MassModifiedMessage>>();
            messages.len() + app.world().resource::<Messages<CollisionEvent>>().len()
        };
        let body = (RigidBody::Dynamic, Collider::ball(1.0), Transform::default());
        let body = app.world_mut().spawn(body).id();
        step(&mut app, 4);
        let stopped = CollisionEvent::Stopped(body, body, CollisionEventFlags::empty());
        app.world_mut().write_message(stopped);
        app.world_mut().write_message(MassModifiedMessage(body));
        step(&mut app, 1);
        assert_eq!(written(&app), 2, "order {number}");
        step(&mut app, 3);
        assert_eq!(written(&app), 0, "order {number}");
    }
}

#[test]
fn settings_that_an_app_has_are_kept_unless_a_plugin_has_its_own() {
    let (apps, plugins) = (0.2, 0.9);
    let settings = |friction| ColliderSettings { friction, ..default() };
    let friction = |own: EnvgenPlugins| {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin)).insert_resource(settings(apps));
        app.add_plugins(own);
        app.world().resource::<ColliderSettings>().friction
    };
    assert_eq!(friction(EnvgenPlugins::default()), apps);
    assert_eq!(friction(EnvgenPlugins::default().with_colliders(settings(plugins))), plugins);
    let usual = ColliderSettings::default();
    assert_eq!(friction(EnvgenPlugins::default().with_colliders(usual)), usual.friction);
}

#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
struct Build;

#[test]
fn the_schedule_is_a_parameter() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, asset_plugin()));
    app.add_plugins(TopDownPhysicsPlugin::default());
    app.add_plugins(EnvgenPlugins::default().in_schedule(Build));
    app.finish();
    app.cleanup();
    app.world_mut().spawn(hallway());
    let file = app.world().resource::<AssetServer>().load("worlds/paper_forest.envgen.ron");
    app.world_mut().spawn(Environment::from_asset(file, 1));
    step(&mut app, 3);
    assert_eq!(walls(&mut app), 0);
    app.world_mut().run_schedule(Build);
    assert!(walls(&mut app) > 0);
}

#[test]
fn systems_are_ordered_against_the_public_sets() {
    #[derive(Resource, Default, Debug, PartialEq)]
    struct Seen(Vec<usize>);
    fn look(walls: Query<&Wall>, mut seen: ResMut<Seen>) {
        seen.0.push(walls.iter().count());
    }
    let mut app = test_app();
    app.init_resource::<Seen>();
    app.add_systems(
        Update,
        (look.before(EnvgenSystems::Request), look.after(EnvgenSystems::Notify)),
    );
    app.world_mut().spawn(hallway());
    app.update();
    let walls = walls(&mut app);
    assert_eq!(app.world().resource::<Seen>().0, [0, walls]);
}

#[test]
fn others_can_add_to_tiles_before_the_world_is_ready() {
    #[derive(Component)]
    struct Painted(u32);

    // The observer has state of its own, which a function could not have.
    let mut tiles = 0;
    let mut app = test_app();
    app.add_observer(
        move |spawned: On<TileSpawned>,
              roots: Query<&GroundTruth>,
              all: Query<&Tile>,
              mut commands: Commands| {
            assert!(roots.contains(spawned.environment) && all.contains(spawned.tile));
            tiles += 1;
            for &part in &spawned.parts {
                commands.entity(part).insert(Painted(tiles));
            }
        },
    );
    app.add_observer(|_: On<EnvironmentReady>, parts: Query<&PartId>, painted: Query<&Painted>| {
        assert!(parts.iter().count() > 1000);
        assert_eq!(parts.iter().count(), painted.iter().count());
    });
    // A system between spawning and notifying sees the same.
    app.add_systems(
        Update,
        (|tiles: Query<&Children, Added<Tile>>, painted: Query<&Painted>| {
            assert!(tiles.iter().flatten().all(|part| painted.contains(*part)));
        })
        .after(EnvgenSystems::Stream)
        .before(EnvgenSystems::Notify),
    );
    let spec = ForestSpec { width: 100.0, height: 100.0, intensity: 0.2, ..default() };
    spawn_ready(&mut app, Environment::new(spec, 1)).unwrap();
    let painted = app.world_mut().query::<&Painted>().iter(app.world()).map(|part| part.0).max();
    let tiles = app.world_mut().query::<&Tile>().iter(app.world()).count();
    assert_eq!(painted, Some(tiles as u32));
    assert!(tiles > 1);
}

#[test]
fn components_can_be_reflected() {
    let mut app = test_app();
    let root = spawn_ready(&mut app, hallway()).unwrap();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let names: Vec<_> = registry
        .iter()
        .filter(|registration| registration.data::<ReflectComponent>().is_some())
        .map(|registration| registration.type_info().type_path_table().short_path())
        .collect();
    for name in [
        "Environment",
        "EnvironmentState",
        "EnvironmentStats",
        "EnvironmentLandmarks",
        "PartId",
        "PartOf",
        "PartShape",
        "Wall",
        "Tree",
        "RoadStrip",
        "Room",
        "Doorway",
        "Obstacle",
        "Surface",
        "Start",
        "Goal",
        "Victim",
        "Ground",
        "Tile",
        "StreamAround",
        "Door",
        "DoorLeaf",
        "EnvironmentScenario",
        "Person",
        "ScenarioAgent",
        "Smoke",
        "EnvironmentColliders",
    ] {
        assert!(names.contains(&name), "{name} of {names:?}");
    }
    let environment = app.world().entity(root).get::<Environment>().unwrap();
    let reflected = environment.as_partial_reflect().to_dynamic();
    assert!(format!("{reflected:?}").contains("seed"));
}

#[test]
fn environments_can_be_compared_and_named_in_errors() {
    let error = EnvironmentError::NoAnchor;
    assert_eq!(error, error.clone());
    assert!(!error.to_string().ends_with('.'));
}
