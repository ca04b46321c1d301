//! What an app can read when the event reports that a world is ready.

use bevy::diagnostic::{DiagnosticPath, DiagnosticsStore};
use bevy::prelude::*;
use bevy_envgen::envgen::geometry::unit_vector;
use bevy_envgen::envgen::glam::DVec2;
use bevy_envgen::part::{Goal, Start};
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{parts, spawn_ready, step, test_app, test_app_with, wait_until_ready};
use bevy_envgen::{StreamingReport, Tile};

use super::specs;

/// A component that the observer of a new user spawns.
#[derive(Component)]
struct Player {
    environment: Entity,
}

/// A resource with what an observer saw of the parts of one environment when it was triggered.
#[derive(Resource, Default)]
struct Seen(Vec<(Entity, GlobalTransform)>);

fn spawn_player(
    ready: On<EnvironmentReady>,
    landmarks: Query<&EnvironmentLandmarks>,
    mut commands: Commands,
) -> Result {
    let environment = ready.entity;
    if let Some(start) = landmarks.get(environment)?.start {
        commands.spawn((Player { environment }, start.pose));
    }
    Ok(())
}

fn look(
    ready: On<EnvironmentReady>,
    everything: Query<(Entity, &GlobalTransform)>,
    children: Query<&Children>,
    mut seen: ResMut<Seen>,
) {
    let below = children.iter_descendants(ready.entity).chain([ready.entity]);
    seen.0.extend(everything.iter_many(below).map(|(entity, global)| (entity, *global)));
}

/// Creates an app as a user does, with only the plugin group of this crate.
fn user_app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, EnvgenPlugins::default()));
    app.init_resource::<Seen>().add_observer(spawn_player).add_observer(look);
    app.finish();
    app.cleanup();
    app
}

/// Returns a moved and rotated transform, and a parent that is moved and rotated too.
fn odd_place(app: &mut App, i: usize) -> (Transform, Entity) {
    let turn = |angle: f32| Quat::from_rotation_z(angle + i as f32);
    let above = Transform::from_xyz(-40.0, 7.0 * i as f32, 0.0).with_rotation(turn(0.4));
    let above = app.world_mut().spawn(above).id();
    let at = Transform::from_xyz(100.0 * i as f32, 3.0, 2.0).with_rotation(turn(2.0));
    (if i == 1 { at.with_scale(Vec3::splat(2.0)) } else { at }, above)
}

/// Asserts that what was seen is equal, to the last bit, to what Bevy's propagation gives.
fn check_seen(app: &mut App) {
    let seen = std::mem::take(&mut app.world_mut().resource_mut::<Seen>().0);
    assert!(seen.len() > 10);
    for (entity, global) in seen {
        let propagated = app.world().get::<GlobalTransform>(entity);
        assert_eq!(propagated, Some(&global), "{:?}", app.world().get::<Name>(entity));
    }
}

#[test]
fn players_are_spawned_at_the_starts_of_their_own_worlds() {
    for pace in [GenerationMode::Blocking, GenerationMode::Async] {
        let mut app = user_app();
        let mut asked = Vec::new();
        for (i, spec) in specs().into_iter().enumerate() {
            let (at, above) = odd_place(&mut app, i);
            let origin = DVec2::new(30.0 * i as f64, -7.0);
            let environment = Environment::new(spec, 3).with_pace(pace).with_origin(origin);
            let root = app.world_mut().spawn((environment, at, ChildOf(above))).id();
            asked.push((root, above, at, origin));
        }
        if pace == GenerationMode::Blocking {
            app.update();
        }
        for &(root, ..) in &asked {
            if pace == GenerationMode::Async {
                wait_until_ready(&mut app, root).unwrap();
            }
            assert_eq!(app.world().get(root), Some(&EnvironmentState::Ready));
        }
        check_seen(&mut app);
        let mut players = app.world_mut().query::<(&Player, &GlobalTransform)>();
        let mut starts =
            app.world_mut().query_filtered::<(&PartOf, &GlobalTransform), With<Start>>();
        let mut found = 0;
        for (root, above, at, origin) in asked {
            let world = app.world().get::<GroundTruth>(root).unwrap();
            let own: Vec<_> = players
                .iter(app.world())
                .filter(|(player, _)| player.environment == root)
                .map(|(_, global)| *global)
                .collect();
            assert_eq!(own.len(), usize::from(world.start.is_some()));
            let (Some(start), Some(player)) = (world.start, own.first()) else { continue };
            found += 1;
            // The expected pose is computed from the world itself and the transforms that the app has set.
            let above = app.world().get::<Transform>(above).unwrap();
            let place =
                |p: DVec2| above.transform_point(at.transform_point(p.as_vec2().extend(0.0)));
            let there = place(start.position - origin);
            assert!(player.translation().distance(there) < 1e-3, "{player:?} {there}");
            let ahead = place(start.position - origin + unit_vector(start.heading)) - there;
            let facing = player.rotation() * Vec3::X;
            assert!(facing.distance(ahead.normalize()) < 1e-3, "{facing} {ahead}");
            assert!((player.scale() - 1.0).abs().max_element() < 1e-5);
            // The pose must also be that of the part.
            let part = starts.iter(app.world()).find(|(part, _)| part.0 == root).unwrap().1;
            assert!(part.translation().distance(player.translation()) < 1e-4);
        }
        assert!(found >= 6, "{found}");
    }
}

#[test]
fn every_part_leads_to_its_environment() {
    let mut app = test_app();
    let roots: Vec<Entity> = specs()
        .into_iter()
        .map(|spec| spawn_ready(&mut app, Environment::new(spec, 3)).unwrap())
        .collect();
    let mut parts = app.world_mut().query::<(Entity, &PartId, Option<&PartOf>)>();
    let mut parents = app.world_mut().query::<&ChildOf>();
    let parents = parents.query(app.world());
    let mut counts = vec![0; roots.len()];
    for (entity, id, part) in parts.iter(app.world()) {
        let Some(part) = part else { panic!("{id} has no `PartOf`") };
        assert_eq!(parents.root_ancestor(entity), part.0, "{id}");
        counts[roots.iter().position(|root| *root == part.0).unwrap()] += 1;
    }
    for (root, count) in roots.into_iter().zip(counts) {
        let stats = app.world().get::<EnvironmentStats>(root).unwrap();
        assert_eq!(stats.parts, Some(count));
    }
}

#[test]
fn a_world_that_is_moved_while_it_is_streamed_is_right_when_it_is_ready() {
    let mut app = user_app();
    app.insert_resource(StreamingBudget::Parts(1));
    let anchor = app.world_mut().spawn(Transform::default()).id();
    let spec = ForestSpec { width: 60.0, height: 60.0, intensity: 0.2, ..default() };
    let environment = Environment::new(spec, 2).with_pace(GenerationMode::Blocking);
    let root = app.world_mut().spawn((environment, StreamAround::new(anchor, 100.0))).id();
    for frame in 0..200 {
        // The environment moves together with the anchor, so that the streamed tiles remain the same.
        for entity in [root, anchor] {
            let mut at = app.world_mut().get_mut::<Transform>(entity).unwrap();
            at.translation.x += 1.0;
            at.rotation = Quat::from_rotation_z(0.01 * frame as f32);
        }
        app.update();
        if app.world().get(root) == Some(&EnvironmentState::Ready) {
            assert!(frame > 3);
            check_seen(&mut app);
            return;
        }
    }
    panic!("it was not ready after 200 frames");
}

#[test]
fn landmarks_follow_their_environment_and_their_parts() {
    let mut app = test_app();
    app.insert_resource(StreamingBudget::Parts(1_000_000));
    let anchor = app.world_mut().spawn(Transform::default()).id();
    let spec = HallwaySpec { segments: 300, p_st: 0.8, ..default() };
    let around = StreamAround::new(anchor, 10.0);
    let root = app.world_mut().spawn((Environment::new(spec, 1), around)).id();
    wait_until_ready(&mut app, root).unwrap();
    let landmarks = |app: &App| {
        let EnvironmentLandmarks { start, goal } = *app.world().get(root).unwrap();
        (start.unwrap(), goal.unwrap())
    };
    let (_, goal) = landmarks(&app);
    assert!(goal.pose.translation.length() > 50.0);
    for (at, near) in [(goal.pose.translation, true), (Vec3::splat(-1e4), false)] {
        app.world_mut().get_mut::<Transform>(anchor).unwrap().translation = at;
        step(&mut app, 2);
        assert_eq!(app.world().resource::<StreamingReport>().waiting, 0);
        let (start, goal) = landmarks(&app);
        assert_eq!((start.part, goal.part.is_some()), (None, near));
        if let Some(part) = goal.part {
            assert!(app.world().entity(part).contains::<Goal>());
            assert_eq!(app.world().get(part), Some(&goal.local));
        }
    }
    let moved = Transform::from_xyz(0.0, 50.0, 0.0).with_rotation(Quat::from_rotation_z(1.5));
    *app.world_mut().get_mut::<Transform>(root).unwrap() = moved;
    step(&mut app, 1);
    let after = landmarks(&app).1;
    assert_eq!(after.local, goal.local);
    let there = moved.transform_point(goal.local.translation);
    assert!(after.pose.translation.distance(there) < 1e-4);

    // Another world has other landmarks, and a world without a start and a goal has none.
    let mut world = app.world().get::<GroundTruth>(root).unwrap().as_ref().clone();
    (world.start, world.goal) = (None, None);
    app.world_mut().entity_mut(root).insert(Environment::prebuilt(world));
    wait_until_ready(&mut app, root).unwrap();
    assert_eq!(app.world().get(root), Some(&EnvironmentLandmarks::default()));
}

#[test]
fn a_failure_stays_until_the_world_is_ready() {
    let mut app = test_app();
    let bad = Environment::new(HallwaySpec { p_st: 9.0, ..default() }, 1);
    let root = app.world_mut().spawn(bad).id();
    let error = wait_until_ready(&mut app, root).unwrap_err();
    step(&mut app, 3);
    assert_eq!(app.world().get(root), Some(&EnvironmentFailure(error.clone())));
    // While the next world is generated, the failure remains the reason why there is no world.
    let slow = Environment::new(HallwaySpec::default(), 1).with_pace(GenerationMode::Async);
    app.world_mut().entity_mut(root).insert(slow);
    app.update();
    if app.world().get(root) == Some(&EnvironmentState::Generating) {
        assert_eq!(app.world().get(root), Some(&EnvironmentFailure(error)));
    }
    wait_until_ready(&mut app, root).unwrap();
    assert!(!app.world().entity(root).contains::<EnvironmentFailure>());
    // The failure is removed together with the environment.
    app.world_mut()
        .entity_mut(root)
        .insert(Environment::new(RoadSpec { length: -1.0, ..default() }, 1));
    wait_until_ready(&mut app, root).unwrap_err();
    app.world_mut().entity_mut(root).remove::<Environment>();
    step(&mut app, 1);
    let left = app.world().entity(root);
    assert!(!left.contains::<EnvironmentFailure>() && !left.contains::<EnvironmentLandmarks>());
}

#[test]
fn a_radius_that_is_refused_is_mended() {
    let mut app = test_app();
    let anchor = app.world_mut().spawn(Transform::default()).id();
    let around = StreamAround::new(anchor, 20.0);
    let forest = Environment::new(ForestSpec::default(), 1);
    let refused = StreamAround { radius: f64::NAN, ..around };
    let root = app.world_mut().spawn((forest, refused)).id();
    for radius in [-1.0, -2.0, f64::INFINITY] {
        wait_until_ready(&mut app, root).unwrap_err();
        app.world_mut().get_mut::<StreamAround>(root).unwrap().radius = radius;
        step(&mut app, 1);
        let failure = app.world().get::<EnvironmentFailure>(root).unwrap().to_string();
        assert!(failure.contains(&format!("got {radius}")), "{failure}");
    }
    app.world_mut().get_mut::<StreamAround>(root).unwrap().radius = 20.0;
    wait_until_ready(&mut app, root).unwrap();
    assert!(!app.world().entity(root).contains::<EnvironmentFailure>());
}

#[test]
fn a_tile_that_is_refused_is_the_only_failure() {
    for tile in [f64::NAN, 0.0, 0.001] {
        let mut app = test_app();
        let anchor = app.world_mut().spawn(Transform::default()).id();
        let around = StreamAround::new(anchor, 20.0);
        let forest = Environment::new(ForestSpec::default(), 1);
        let root = app.world_mut().spawn((forest, around)).id();
        wait_until_ready(&mut app, root).unwrap();
        app.world_mut().get_mut::<StreamAround>(root).unwrap().tile = tile;
        let error = wait_until_ready(&mut app, root).unwrap_err();
        assert!(matches!(error, EnvironmentError::Stream { field: "tile", .. }), "{tile}: {error}");
        // The old tiles are kept, and followed.
        let before = parts(&app, root).len();
        app.world_mut().get_mut::<Transform>(anchor).unwrap().translation.x = 10.0;
        step(&mut app, 200);
        assert!(parts(&app, root).len() > before);
        let failure = app.world().get::<EnvironmentFailure>(root).unwrap();
        assert_eq!(failure.to_string(), error.to_string());
    }
}

#[test]
fn polling_systems_read_what_observers_hear() {
    #[derive(Resource, Default, Debug, PartialEq)]
    struct Heard(Vec<String>);
    #[derive(Resource, Default, Debug, PartialEq)]
    struct Read(Vec<String>);
    fn read(
        mut ready: MessageReader<EnvironmentReady>,
        mut failed: MessageReader<EnvironmentFailed>,
        mut started: MessageReader<ScenarioStarted>,
        mut changed: MessageReader<DoorChanged>,
        mut read: ResMut<Read>,
    ) {
        read.0.extend(ready.read().map(|ready| format!("{ready:?}")));
        read.0.extend(failed.read().map(|failed| format!("{failed:?}")));
        read.0.extend(started.read().map(|started| format!("{started:?}")));
        read.0.extend(changed.read().map(|changed| format!("{changed:?}")));
    }
    let mut app = test_app();
    app.init_resource::<Heard>().init_resource::<Read>().add_systems(Last, read);
    app.add_observer(|ready: On<EnvironmentReady>, mut heard: ResMut<Heard>| {
        heard.0.push(format!("{:?}", ready.event()));
    });
    app.add_observer(|failed: On<EnvironmentFailed>, mut heard: ResMut<Heard>| {
        heard.0.push(format!("{:?}", failed.event()));
    });
    app.add_observer(|started: On<ScenarioStarted>, mut heard: ResMut<Heard>| {
        heard.0.push(format!("{:?}", started.event()));
    });
    app.add_observer(|changed: On<DoorChanged>, mut heard: ResMut<Heard>| {
        heard.0.push(format!("{:?}", changed.event()));
    });
    let root = spawn_ready(&mut app, Environment::new(IndoorSpec::default(), 4)).unwrap();
    spawn_ready(&mut app, Environment::new(HallwaySpec { p_st: 9.0, ..default() }, 1)).unwrap_err();
    app.world_mut().trigger(RebuildEnvironment { entity: root });
    step(&mut app, 1);
    let door_control = DoorControl::Commanded;
    let doors = ScenarioSpec { doors: 1.0, door_control, ..default() };
    app.world_mut().entity_mut(root).insert(EnvironmentScenario::new(doors, 1));
    step(&mut app, 1);
    for mut door in app.world_mut().query::<&mut Door>().iter_mut(app.world_mut()) {
        door.slam();
    }
    step(&mut app, 80);
    let Heard(heard) = app.world().resource();
    assert_eq!(&app.world().resource::<Read>().0, heard);
    for what in ["EnvironmentReady", "EnvironmentFailed", "ScenarioStarted", "DoorChanged"] {
        assert!(heard.iter().any(|said| said.starts_with(what)), "{what} of {heard:?}");
    }
}

#[test]
fn diagnostics_count_and_time() {
    let mut app = test_app_with((EnvgenPlugins::default(), EnvgenDiagnosticsPlugin));
    let value = |app: &App, path: &DiagnosticPath| {
        app.world().resource::<DiagnosticsStore>().get(path).unwrap().value()
    };
    assert_eq!(value(&app, &EnvgenDiagnosticsPlugin::PARTS), Some(0.0));
    assert_eq!(value(&app, &EnvgenDiagnosticsPlugin::GENERATION_TIME), None);
    assert_eq!(value(&app, &EnvgenDiagnosticsPlugin::STREAMING_TIME), None);

    let mut parts = 0.0;
    for solids in [SolidStorage::Entities, SolidStorage::TileData] {
        let environment = Environment::new(ForestSpec::default(), 1).with_solids(solids);
        let root = spawn_ready(&mut app, environment).unwrap();
        parts += app.world().get::<EnvironmentStats>(root).unwrap().parts.unwrap() as f64;
        assert_eq!(value(&app, &EnvgenDiagnosticsPlugin::PARTS), Some(parts));
    }
    let tiles = app.world_mut().query::<&Tile>().iter(app.world()).count();
    assert_eq!(value(&app, &EnvgenDiagnosticsPlugin::TILES), Some(tiles as f64));
    assert!(value(&app, &EnvgenDiagnosticsPlugin::GENERATION_TIME).unwrap() > 0.0);
    assert_eq!(value(&app, &EnvgenDiagnosticsPlugin::STREAMING_TIME), None);

    let anchor = app.world_mut().spawn(Transform::default()).id();
    let forest = Environment::new(ForestSpec::default(), 1).endless(10.0);
    let root = app.world_mut().spawn((forest, StreamAround::new(anchor, 30.0))).id();
    wait_until_ready(&mut app, root).unwrap();
    let time = value(&app, &EnvgenDiagnosticsPlugin::STREAMING_TIME).unwrap();
    let report = app.world().resource::<StreamingReport>().time.as_secs_f64();
    assert!((time - 1e3 * report).abs() < 1e-9 && time > 0.0);
}

#[test]
fn a_world_whose_transform_changes_in_every_frame_comes_back() {
    let mut app = test_app();
    let pace = GenerationMode::Async;
    let environment = Environment::new(HallwaySpec::default(), 1).with_pace(pace);
    let root = spawn_ready(&mut app, environment).unwrap();
    let place = |app: &mut App, at: Transform| {
        *app.world_mut().get_mut::<Transform>(root).unwrap() = at;
        app.update();
    };
    place(&mut app, Transform::from_scale(Vec3::ZERO));
    step(&mut app, 2);
    assert_eq!(app.world().get(root), Some(&EnvironmentState::Failed));
    for frame in 0..2000 {
        place(&mut app, Transform::from_xyz(0.01 * frame as f32, 0.0, 0.0));
        if app.world().get(root) == Some(&EnvironmentState::Ready) {
            return;
        }
        std::thread::sleep(std::time::Duration::from_micros(200));
    }
    panic!("it never comes back: {:?}", app.world().get::<EnvironmentState>(root));
}

#[test]
fn a_suspended_world_that_cannot_be_generated_fails_once() {
    #[derive(Resource, Default)]
    struct Failures(usize);
    let mut app = test_app();
    app.init_resource::<Failures>();
    app.add_observer(|_: On<EnvironmentFailed>, mut failures: ResMut<Failures>| failures.0 += 1);
    let pace = GenerationMode::Blocking;
    let environment = Environment::new(HallwaySpec::default(), 1).with_pace(pace);
    let root = spawn_ready(&mut app, environment).unwrap();
    assert!(app.world().entity(root).contains::<EnvironmentLandmarks>());
    app.world_mut().entity_mut(root).insert(Transform::from_scale(Vec3::ZERO));
    step(&mut app, 2);
    // There is no world, and so no start in it.
    assert!(!app.world().entity(root).contains::<EnvironmentLandmarks>());
    let impossible = ForestSpec { width: -1.0, ..default() };
    app.world_mut().entity_mut(root).insert(Environment::new(impossible, 1).with_pace(pace));
    step(&mut app, 2);
    let before = app.world().resource::<Failures>().0;
    for frame in 0..5 {
        let at = Transform::from_xyz(f32::from(frame as u8), 0.0, 0.0);
        app.world_mut().entity_mut(root).insert(at);
        step(&mut app, 1);
    }
    assert!(app.world().resource::<Failures>().0 <= before + 1);
    assert_eq!(app.world().get(root), Some(&EnvironmentState::Failed));
    // A world that can be generated appears.
    let possible = Environment::new(HallwaySpec::default(), 1).with_pace(pace);
    app.world_mut().entity_mut(root).insert(possible);
    step(&mut app, 2);
    assert_eq!(app.world().get(root), Some(&EnvironmentState::Ready));
    assert!(app.world().entity(root).contains::<EnvironmentLandmarks>());
}

#[test]
fn nothing_is_left_of_an_environment_that_an_observer_of_its_tiles_removes() {
    let mut app = test_app();
    app.add_observer(|spawned: On<TileSpawned>, mut commands: Commands| {
        commands.entity(spawned.environment).remove::<Environment>();
    });
    // The forest has several pages.
    let forest = ForestSpec { width: 200.0, height: 200.0, intensity: 0.1, ..default() };
    let pace = GenerationMode::Blocking;
    let root = app.world_mut().spawn(Environment::new(forest, 1).with_pace(pace)).id();
    for _ in 0..3 {
        app.update();
        assert_eq!(app.world_mut().query::<&Tile>().iter(app.world()).count(), 0);
    }
    assert!(!app.world().entity(root).contains::<GroundTruth>());
}

#[test]
fn no_failure_is_reported_of_an_environment_that_an_observer_has_removed() {
    #[derive(Resource, Default)]
    struct Heard(usize);
    let remove = |inserted: On<Insert, EnvironmentFailure>, mut commands: Commands| {
        commands.entity(inserted.entity).remove::<Environment>();
    };
    let despawn = |inserted: On<Insert, EnvironmentFailure>, mut commands: Commands| {
        commands.entity(inserted.entity).despawn();
    };
    for (observer, expected) in
        [(None, 1), (Some(Observer::new(remove)), 0), (Some(Observer::new(despawn)), 0)]
    {
        let mut app = test_app();
        app.init_resource::<Heard>();
        app.add_observer(|_: On<EnvironmentFailed>, mut heard: ResMut<Heard>| heard.0 += 1);
        if let Some(observer) = observer {
            app.world_mut().spawn(observer);
        }
        let wrong = ForestSpec { width: -1.0, ..default() };
        app.world_mut().spawn(Environment::new(wrong, 1).with_pace(GenerationMode::Blocking));
        step(&mut app, 4);
        assert_eq!(app.world().resource::<Heard>().0, expected);
        let mut failures = app.world_mut().query::<&EnvironmentFailure>();
        assert_eq!(failures.iter(app.world()).count(), expected);
    }
}
