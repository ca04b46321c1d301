//! Invalid input is reported with a name, and the app continues.

use bevy::prelude::*;
use bevy_envgen::envgen::forest::ForestSpec;
use bevy_envgen::envgen::glam::DVec2;
use bevy_envgen::envgen::hallway::HallwaySpec;
use bevy_envgen::envgen::{Seed, WorldSpec};
use bevy_envgen::part::Start;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{in_rapier, parts, spawn_ready, step, test_app, wait_until_ready};
use bevy_envgen::{EnvironmentError, MAX_PARTS, SpawnedOrigin, Tile};

use super::spawned;

/// Checks that the app can still make worlds, and that rapier still runs.
fn continues_to_run(app: &mut App) {
    let root = spawn_ready(app, Environment::new(HallwaySpec::default(), 1)).unwrap();
    step(app, 3);
    assert!(in_rapier(app).0 > 10);
    app.world_mut().despawn(root);
    step(app, 3);
}

fn hallway() -> Environment {
    Environment::new(HallwaySpec::default(), 1)
}

#[test]
fn impossible_specs_are_events() {
    let mut app = test_app();
    for (text, says) in [
        ("Hallway(p_st: 2.0)", "p_st"),
        ("Hallway(segments: 4000000000)", "segments"),
        ("Forest(intensity: -1.0)", "intensity"),
        ("Forest(width: 1e30)", "width"),
        ("Forest(min_distance: 5.0, intensity: 1.0)", "min_distance"),
        ("Road(length: -5.0)", "length"),
        ("Landscape(entropy: 99.0)", "entropy"),
        ("Indoor(difficulty: 11.0)", "difficulty"),
    ] {
        let spec = WorldSpec::from_ron(text).unwrap();
        for pace in [GenerationMode::Blocking, GenerationMode::Async, GenerationMode::Auto] {
            let environment = Environment::new(spec.clone(), 1).with_pace(pace);
            let error = spawn_ready(&mut app, environment).unwrap_err();
            assert!(error.to_string().contains(says), "{text}: {error}");
        }
    }
    assert_eq!(spawned(&mut app), 0);
    continues_to_run(&mut app);
}

#[test]
fn a_spawned_world_survives_an_impossible_change() {
    let mut app = test_app();
    let root = spawn_ready(&mut app, hallway()).unwrap();
    let before = parts(&app, root);
    let bad = HallwaySpec { p_st: 9.0, ..default() };
    app.world_mut().entity_mut(root).insert(Environment::new(bad, 1));
    wait_until_ready(&mut app, root).unwrap_err();
    assert_eq!(parts(&app, root), before);
    app.world_mut().entity_mut(root).insert(hallway());
    wait_until_ready(&mut app, root).unwrap();
    assert_eq!(parts(&app, root), before);
}

#[test]
fn two_environments_on_one_entity_leave_the_last() {
    let mut app = test_app();
    for pace in [GenerationMode::Blocking, GenerationMode::Async] {
        let slow = ForestSpec { width: 300.0, height: 300.0, ..default() };
        let slow = Environment::new(slow, 1).with_pace(pace);
        let root = app.world_mut().spawn(slow.clone()).id();
        app.world_mut().entity_mut(root).insert(hallway().with_pace(pace));
        wait_until_ready(&mut app, root).unwrap();
        // The same while the first world is being generated.
        app.world_mut().entity_mut(root).insert(slow);
        step(&mut app, 1);
        app.world_mut().entity_mut(root).insert(hallway());
        wait_until_ready(&mut app, root).unwrap();
        step(&mut app, 20);
        assert_eq!(app.world_mut().query::<&Tree>().iter(app.world()).count(), 0);
        assert!(parts(&app, root).len() > 10);
        app.world_mut().despawn(root);
        step(&mut app, 2);
        assert_eq!((spawned(&mut app), in_rapier(&mut app).0), (0, 0));
    }
}

#[test]
fn an_environment_below_another_is_independent() {
    let mut app = test_app();
    let outer = spawn_ready(&mut app, hallway()).unwrap();
    let inner = app.world_mut().spawn((hallway(), ChildOf(outer))).id();
    wait_until_ready(&mut app, inner).unwrap();
    let alone = parts(&app, inner);
    app.world_mut().trigger(RebuildEnvironment { entity: outer });
    step(&mut app, 2);
    assert_eq!(parts(&app, inner), alone);
    app.world_mut().despawn(outer);
    step(&mut app, 2);
    assert_eq!((spawned(&mut app), in_rapier(&mut app).0), (0, 0));
}

#[test]
fn despawns_at_any_moment_leave_nothing() {
    let mut app = test_app();
    for frames in 0..6 {
        let spec = ForestSpec { width: 200.0, height: 200.0, ..default() };
        let root =
            app.world_mut().spawn(Environment::new(spec, 1).with_pace(GenerationMode::Async)).id();
        step(&mut app, frames);
        app.world_mut().despawn(root);
        step(&mut app, 30);
        assert_eq!((spawned(&mut app), in_rapier(&mut app).0), (0, 0), "after {frames} frames");
    }
    // Despawned by an observer of the very event that reports the world.
    app.add_observer(|ready: On<EnvironmentReady>, mut commands: Commands| {
        commands.entity(ready.entity).despawn();
    });
    app.world_mut().spawn(hallway());
    step(&mut app, 3);
    assert_eq!((spawned(&mut app), in_rapier(&mut app).0), (0, 0));
}

#[test]
fn tiles_and_parts_that_a_user_despawns_are_no_trouble() {
    let mut app = test_app();
    let root = spawn_ready(&mut app, hallway()).unwrap();
    let mut tiles = app.world_mut().query_filtered::<Entity, With<Tile>>();
    for tile in tiles.iter(app.world()).collect::<Vec<_>>() {
        app.world_mut().despawn(tile);
    }
    step(&mut app, 2);
    app.world_mut().trigger(RebuildEnvironment { entity: root });
    step(&mut app, 2);
    assert!(parts(&app, root).len() > 10);
    app.world_mut().despawn(root);
    step(&mut app, 2);
    // A rebuild is requested of an entity that no longer exists, and of one that never had an environment.
    app.world_mut().trigger(RebuildEnvironment { entity: root });
    let nobody = app.world_mut().spawn_empty().id();
    app.world_mut().trigger(RebuildEnvironment { entity: nobody });
    continues_to_run(&mut app);
}

#[test]
fn observers_may_despawn_what_was_just_spawned() {
    for what in ["part", "tile", "environment"] {
        let mut app = test_app();
        let despawner = move |spawned: On<TileSpawned>, mut commands: Commands| {
            let entity = match what {
                "part" => spawned.parts[0],
                "tile" => spawned.tile,
                _ => spawned.environment,
            };
            commands.entity(entity).try_despawn();
        };
        app.add_observer(despawner);
        let root = app.world_mut().spawn(hallway()).id();
        step(&mut app, 3);
        if what == "part" {
            let stats = *app.world().get::<EnvironmentStats>(root).unwrap();
            let tiles = app.world_mut().query::<&Tile>().iter(app.world()).count();
            assert_eq!(parts(&app, root).len() + tiles, stats.parts.unwrap());
        } else {
            assert_eq!((spawned(&mut app), in_rapier(&mut app)), (0, (0, 0)), "{what}");
        }
    }
}

#[test]
fn observers_may_despawn_a_tile_before_its_parts() {
    fn despawn<C: Component>(added: On<Add, C>, mut commands: Commands) {
        commands.entity(added.entity).try_despawn();
    }
    fn despawn_parent(added: On<Insert, Start>, above: Query<&ChildOf>, mut commands: Commands) {
        if let Ok(above) = above.get(added.entity) {
            commands.entity(above.parent()).try_despawn();
        }
    }
    let observers: [fn(&mut App); 2] =
        [|app| _ = app.add_observer(despawn::<Tile>), |app| _ = app.add_observer(despawn_parent)];
    for (observe, solids, is_endless) in observers.into_iter().flat_map(|observe| {
        [SolidStorage::TileData, SolidStorage::Entities]
            .into_iter()
            .flat_map(move |solids| [false, true].map(|endless| (observe, solids, endless)))
    }) {
        let mut app = test_app();
        observe(&mut app);
        let indoor = Environment::new(IndoorSpec::default(), 1).with_solids(solids);
        let forest = Environment::new(ForestSpec::default(), 1).with_solids(solids);
        let roots = if is_endless {
            let anchor = app.world_mut().spawn(Transform::default()).id();
            let around = StreamAround::new(anchor, 20.0);
            let endless = forest.clone().endless(10.0);
            [(endless, around), (indoor, around)].map(|root| app.world_mut().spawn(root).id())
        } else {
            [forest, indoor].map(|root| app.world_mut().spawn(root).id())
        };
        for root in roots {
            // The world is complete as if its tiles had been despawned later.
            wait_until_ready(&mut app, root).unwrap();
            let mut orphans =
                app.world_mut().query_filtered::<(), (With<PartId>, Without<ChildOf>)>();
            assert_eq!(orphans.iter(app.world()).count(), 0, "{solids:?} {is_endless}");
            app.world_mut().despawn(root);
        }
        step(&mut app, 2);
        assert_eq!((spawned(&mut app), in_rapier(&mut app)), (0, (0, 0)), "{solids:?}");
    }
}

#[test]
fn observers_may_despawn_an_environment_or_remove_it_as_its_components_arrive_and_leave() {
    type Lose = fn(&mut EntityCommands<'_>);
    let despawn: Lose = |root| root.despawn();
    let remove: Lose = |root| {
        root.remove::<Environment>();
    };
    let when: [fn(&mut App, Lose); 5] = [
        lose_on_insert::<SpawnedOrigin>,
        lose_on_insert::<EnvironmentStats>,
        lose_on_insert::<EnvironmentState>,
        lose_on_insert::<EnvironmentFailure>,
        lose_on_remove::<EnvironmentStats>,
    ];
    for observe in when {
        for lose in [despawn, remove] {
            for is_streamed in [false, true] {
                let mut app = test_app();
                let anchor = app.world_mut().spawn(Transform::default()).id();
                let spawn = |app: &mut App| {
                    if is_streamed {
                        let around = StreamAround::new(anchor, 20.0);
                        app.world_mut().spawn((hallway(), around)).id()
                    } else {
                        app.world_mut().spawn(hallway()).id()
                    }
                };
                let (first, second) = (spawn(&mut app), spawn(&mut app));
                step(&mut app, 3);
                observe(&mut app, lose);
                // Another world, one that fails, and a transform without a world.
                app.world_mut().entity_mut(first).insert(hallway().with_origin(DVec2::ONE));
                app.world_mut().entity_mut(second).insert(hallway().with_origin(DVec2::NAN));
                let third = spawn(&mut app);
                step(&mut app, 3);
                if let Ok(mut third) = app.world_mut().get_entity_mut(third) {
                    third.insert(Transform::from_scale(Vec3::ZERO));
                }
                step(&mut app, 3);
                // Nothing is left of environments that are lost.
                let mut tiles = app.world_mut().query_filtered::<&ChildOf, With<Tile>>();
                for tile in tiles.iter(app.world()) {
                    assert!(app.world().get::<Environment>(tile.parent()).is_some());
                }
                type Lost = (With<GroundTruth>, Without<Environment>);
                let mut lost = app.world_mut().query_filtered::<(), Lost>();
                assert_eq!(lost.iter(app.world()).count(), 0);
            }
        }
    }
}

/// Makes an app lose an environment when a component is inserted on it.
fn lose_on_insert<C: Component>(app: &mut App, lose: fn(&mut EntityCommands<'_>)) {
    app.add_observer(move |inserted: On<Insert, C>, mut commands: Commands| {
        lose(&mut commands.entity(inserted.entity));
    });
}

/// Makes an app lose an environment when a component is removed from it.
fn lose_on_remove<C: Component>(app: &mut App, lose: fn(&mut EntityCommands<'_>)) {
    app.add_observer(move |removed: On<Remove, C>, mut commands: Commands| {
        if let Ok(mut root) = commands.get_entity(removed.entity) {
            lose(&mut root);
        }
    });
}

#[test]
fn transforms_that_cannot_carry_a_world_are_named_and_mended() {
    let bad = [
        (Transform::from_scale(Vec3::ZERO), "scale"),
        (Transform::from_scale(Vec3::new(1.0, 2.0, 1.0)), "scale"),
        (Transform::from_scale(Vec3::new(-1.0, 1.0, 1.0)), "scale"),
        (Transform::from_scale(Vec3::splat(f32::NAN)), "scale"),
        (Transform::from_xyz(f32::INFINITY, 0.0, 0.0), "translation"),
        (Transform::from_rotation(Quat::from_rotation_y(1.0)), "x axis"),
    ];
    for (transform, what) in bad {
        let mut app = test_app();
        // The transform is invalid from the start,
        let root = app.world_mut().spawn((hallway(), transform)).id();
        let error = wait_until_ready(&mut app, root).unwrap_err();
        assert!(matches!(error, EnvironmentError::Transform { .. }), "{error}");
        assert!(error.to_string().contains(what), "{error}");
        assert_eq!(spawned(&mut app), 0);
        *app.world_mut().get_mut::<Transform>(root).unwrap() = Transform::default();
        step(&mut app, 3);
        assert_eq!(app.world().get(root), Some(&EnvironmentState::Ready), "{what}");
        let sound = parts(&app, root).len();
        // while the world is spawned,
        *app.world_mut().get_mut::<Transform>(root).unwrap() = transform;
        step(&mut app, 4);
        assert_eq!(app.world().get(root), Some(&EnvironmentState::Failed), "{what}");
        assert_eq!((spawned(&mut app), in_rapier(&mut app).0), (0, 0));
        assert!(!app.world().entity(root).contains::<EnvironmentStats>());
        *app.world_mut().get_mut::<Transform>(root).unwrap() = Transform::default();
        step(&mut app, 4);
        assert_eq!(parts(&app, root).len(), sound);
        app.world_mut().despawn(root);
        // and in the parent of the environment.
        let above = app.world_mut().spawn(transform).id();
        let root = app.world_mut().spawn((hallway(), ChildOf(above))).id();
        assert!(wait_until_ready(&mut app, root).is_err());
        app.world_mut().despawn(above);
        continues_to_run(&mut app);
    }
}

#[test]
fn streams_that_cannot_be_are_named() {
    let mut app = test_app();
    let anchor = app.world_mut().spawn(Transform::default()).id();
    let around = StreamAround::new(anchor, 20.0);
    let forest = || Environment::new(ForestSpec::default(), 1);
    let world = ForestSpec::default();
    let world = WorldSpec::from(world).generate(Seed(1)).unwrap().to_world();
    for (environment, stream, says) in [
        (hallway().endless(10.0), Some(around), "`hallway` cannot be endless"),
        (Environment::prebuilt(world).endless(10.0), Some(around), "exists already"),
        (forest().endless(10.0), None, "StreamAround"),
        (forest().endless(0.0), Some(around), "tile"),
        (forest().endless(f64::NAN), Some(around), "tile"),
        (forest().endless(1e9), Some(around), "tile"),
        (forest(), Some(around.with_tile(0.0)), "tile"),
        (forest(), Some(around.with_tile(f64::NAN)), "tile"),
        (forest(), Some(StreamAround { radius: -1.0, ..around }), "radius"),
        (forest(), Some(StreamAround { radius: f64::NAN, ..around }), "radius"),
        (forest(), Some(StreamAround { radius: 1e12, ..around }), "radius"),
        (forest().endless(10.0), Some(StreamAround { radius: 1e12, ..around }), "radius"),
        (forest().with_origin(DVec2::NAN), None, "origin"),
    ] {
        let root = app.world_mut().spawn(environment).id();
        if let Some(stream) = stream {
            app.world_mut().entity_mut(root).insert(stream);
        }
        let error = wait_until_ready(&mut app, root).unwrap_err();
        assert!(error.to_string().contains(says), "{says}: {error}");
        // The error is reported once, not in every frame.
        app.world_mut().entity_mut(root).observe(|_: On<EnvironmentFailed>| panic!("said twice"));
        step(&mut app, 3);
        app.world_mut().despawn(root);
    }
    // An environment waits for an anchor that has no finite position, or does not exist.
    let lost = app.world_mut().spawn(Transform::from_xyz(f32::NAN, 0.0, 0.0)).id();
    for anchor in [lost, Entity::PLACEHOLDER] {
        let around = StreamAround::new(anchor, 20.0);
        let root = app.world_mut().spawn((forest().endless(10.0), around)).id();
        step(&mut app, 5);
        assert_eq!(app.world().get(root), Some(&EnvironmentState::Streaming));
        app.world_mut().despawn(root);
    }
    // An anchor that is far out of bounds finds the tiles that can be numbered there.
    let far = app.world_mut().spawn(Transform::from_xyz(1e30, -1e30, 0.0)).id();
    let around = StreamAround::new(far, 20.0);
    let root = app.world_mut().spawn((forest().endless(10.0), around)).id();
    step(&mut app, 20);
    app.world_mut().despawn(root);
    continues_to_run(&mut app);
}

#[test]
fn broken_worlds_and_worlds_of_too_many_parts_are_refused() {
    let mut app = test_app();
    let sound = WorldSpec::from(HallwaySpec::default()).generate(Seed(1)).unwrap().to_world();
    let mut broken = sound.clone();
    broken.bounds.max.x = f64::NAN;
    let error = spawn_ready(&mut app, Environment::prebuilt(broken)).unwrap_err();
    assert!(error.to_string().contains("bounds"), "{error}");
    let mut crowded = sound;
    let tree = bevy_envgen::envgen::world::Tree::new(crowded.bounds.center(), 0.1);
    (crowded.start, crowded.goal) = (None, None);
    crowded.trees = vec![tree; MAX_PARTS];
    let error = spawn_ready(&mut app, Environment::prebuilt(crowded)).unwrap_err();
    assert!(matches!(error, EnvironmentError::TooMany { .. }), "{error}");
    assert_eq!(spawned(&mut app), 0);
    continues_to_run(&mut app);
}
