//! Trials in rapier with doors, people and smoke.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_envgen::prelude::*;
use bevy_envgen::scenario::{DoorKinds, Reactions, Scenario};
use bevy_envgen::testing::step;
use bevy_mapping_trial::prelude::*;
use bevy_mapping_trial::trial::{RapierRobots, replay_headless, run_headless_with};
use envgen::geometry::{Pose, Rect, Shape};
use envgen::glam::DVec2;
use envgen::indoor::IndoorSpec;
use envgen::scenario::smoke::smoke_range;
use envgen::scenario::{DoorCommand, FailedBeams, Person as ListedPerson, Reaction, SmokeProfile};
use envgen::world::{Doorway, Wall as Side, WallKind};
use envgen::{Blueprint, Provenance, Seed, Spec, World as EnvWorld};
use mapping_trial::backend::{Command, RobotBackend};
use mapping_trial::lidar::LaserProfile;
use mapping_trial::trial::{Trial, TrialLog, TrialParts, TrialSettings};

fn indoor() -> EnvWorld {
    let spec = IndoorSpec { width: 5, height: 5, ..Default::default() };
    spec.generate(Seed(3)).unwrap().to_world()
}

/// Returns a world with a hall of 12 x 4 m, which a wall with a doorway of 1 m divides at x = 8.
fn hall() -> EnvWorld {
    let v = DVec2::new;
    let bounds = Rect::new(DVec2::ZERO, v(12.0, 4.0));
    let mut world = EnvWorld::new(Provenance::other("test", serde_json::Value::Null), bounds);
    let corners = Shape::from_rect(bounds).corners();
    let outer = envgen::geometry::edges(&corners).map(|(a, b)| Shape::Segment { a, b });
    let inner = [(v(7.9, 0.0), v(8.1, 1.5)), (v(7.9, 2.5), v(8.1, 4.0))];
    let inner = inner.map(|(from, to)| Shape::from_rect(Rect::new(from, to)));
    world.walls = outer.chain(inner).map(|shape| Side::new(WallKind::Wall, shape)).collect();
    let shape = Shape::from_rect(Rect::new(v(7.9, 1.5), v(8.1, 2.5)));
    world.doorways.push(Doorway::new(shape, true, [None, None]));
    world.start = Some(Pose::new(2.0, 2.0, 0.0));
    world
}

fn settings(time_limit: f64) -> TrialSettings {
    TrialSettings { time_limit, ..Default::default() }
}

fn of(world: &EnvWorld, spec: ScenarioSpec) -> Scenario {
    Scenario::new(world, &spec, Seed(5)).unwrap()
}

fn everything() -> ScenarioSpec {
    let (reaction, failed_beams) = (Reactions::Mixed, FailedBeams::Phantom);
    ScenarioSpec { doors: 0.6, people: 5, smoke: 0.2, reaction, failed_beams, ..Default::default() }
}

/// Creates an app as a user does, in which each update is a tick.
fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, TopDownPhysicsPlugin::for_trials()));
    app.add_plugins((EnvgenPlugins::default(), TrialPlugin::default()));
    app.insert_resource(ColliderSettings::for_trials());
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(50)));
    app.finish();
    app.cleanup();
    app
}

fn spawn(app: &mut App, world: &EnvWorld, scenario: &Scenario) -> Entity {
    let environment = Environment::prebuilt(world.clone()).with_pace(GenerationMode::Blocking);
    app.world_mut().spawn((environment, EnvironmentScenario::prebuilt(scenario.clone()))).id()
}

/// Drives with one command for a number of seconds, and then stops the trial.
fn drive(world: &EnvWorld, scenario: &Scenario, speed: f64, seconds: usize) -> (App, Entity) {
    let mut app = app();
    let root = spawn(&mut app, world, scenario);
    let trial = MappingTrial::new(TrialSettings { policy: None, ..settings(600.0) });
    let commands = vec![Command { speed, turn_rate: 0.0 }];
    app.world_mut().entity_mut(root).insert((trial, ManualControl { commands }));
    step(&mut app, 20 * seconds);
    app.world_mut().get_mut::<MappingTrial>(root).unwrap().stop();
    (app, root)
}

fn trial(app: &App, root: Entity) -> &Trial<RapierRobots> {
    app.world().get::<MappingTrial>(root).unwrap().trial().expect("a trial")
}

fn digest<B: RobotBackend>(trial: &Trial<B>) -> String {
    trial.bodies().scenario().expect("a scenario").digest().to_string()
}

#[test]
fn robots_are_met_where_they_are_in_a_turned_environment() {
    let mut app = app();
    let environment = Environment::prebuilt(hall()).with_pace(GenerationMode::Blocking);
    let turned = Transform::from_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2));
    let trial = MappingTrial::new(TrialSettings { policy: None, ..settings(600.0) });
    let manual = ManualControl { commands: vec![Command { speed: 0.5, turn_rate: 0.0 }] };
    let root = app.world_mut().spawn((environment, turned, trial, manual)).id();
    step(&mut app, 40);
    let robot = app.world().get::<MappingTrial>(root).unwrap().robots()[0];
    let truth = |app: &App| app.world().get::<TruePose>(robot).unwrap().position.as_vec2();
    let place = app.world().get::<Transform>(robot).unwrap().translation;
    let shown = turned.transform_point(place).truncate();
    assert!(shown.distance(truth(&app)) < 1e-3, "{shown}, {}", truth(&app));
    // The robot starts at (2, 2), which is turned to (-2, 2), and drives along y.
    assert!((truth(&app).x + 2.0).abs() < 1e-3 && truth(&app).y > 2.3, "{}", truth(&app));
    let before = truth(&app);
    app.world_mut().get_mut::<Transform>(root).unwrap().translation.x += 1e-3;
    step(&mut app, 2);
    assert!(truth(&app).distance(before) < 0.1, "{}, {before}", truth(&app));
}

#[test]
fn a_trial_continues_when_the_ticks_of_bevy_are_old() {
    let world = hall();
    let mut app = app();
    let root = spawn(&mut app, &world, &of(&world, everything()));
    app.world_mut().entity_mut(root).insert(MappingTrial::new(settings(60.0)));
    step(&mut app, 20);
    let before = trial(&app, root).time();
    // After days Bevy moves ticks that are too old for its comparisons.
    let now = app.world_mut().change_tick();
    let mut moving = app.world_mut().get_mut::<ScenarioRun>(root).unwrap();
    moving.set_last_added(now);
    step(&mut app, 20);
    assert!((trial(&app, root).time() - before - 1.0).abs() < 1e-6);
    // A scenario that begins again is another one.
    app.world_mut().trigger(RestartScenario { entity: root });
    step(&mut app, 20);
    assert!(trial(&app, root).time() < 1.5);
}

#[test]
fn the_scenario_is_that_of_the_flat_simulator_to_the_bit_while_a_robot_waits() {
    let world = indoor();
    let scenario = of(&world, everything());
    // A position that single precision represents exactly.
    let start = world.start.unwrap();
    let position = (start.position * 64.0).round() / 64.0;
    let start = Some(Pose { position, ..start });
    let settings = TrialSettings { policy: None, start, ..settings(600.0) };
    let mut app = app();
    let root = spawn(&mut app, &world, &scenario);
    let (held, manual_control) = (MappingTrial::new(settings.clone()), ManualControl::default());
    app.world_mut().entity_mut(root).insert((held, manual_control));
    let mut flat = Trial::builder(&world, settings).scenario(scenario).build_flat().unwrap();
    let mut compared = 0;
    while compared < 600 {
        step(&mut app, 1);
        let held = app.world().get::<MappingTrial>(root).unwrap().trial();
        let Some(rapier) = held.filter(|rapier| rapier.time() > flat.time()) else { continue };
        assert!(flat.step_with(&[Command::STOP]));
        assert_eq!(rapier.time(), flat.time());
        assert_eq!(digest(rapier), digest(&flat), "{} s", flat.time());
        let (a, b) = (rapier.autonomy().scan(0), flat.autonomy().scan(0));
        let is_same =
            |(a, b): (&f64, &f64)| (a - b).abs() < 0.02 || a.is_nan() && b.is_nan() || a == b;
        let same = a.ranges.iter().zip(&b.ranges).filter(|both| is_same(*both)).count();
        assert!(same + 9 > a.ranges.len(), "{same} beams of {} are equal", a.ranges.len());
        compared += 1;
    }
}

#[test]
fn a_trial_with_everything_is_replayed_to_the_bit() {
    let world = indoor();
    let scenario = of(&world, everything());
    for settings in [settings(90.0), TrialSettings { robots: 2, ..settings(40.0) }] {
        let run = || {
            let (settings, moving) = (settings.clone(), Some(scenario.clone()));
            run_headless_with(&world, settings, TrialParts::default(), moving, |_| ()).unwrap()
        };
        let first = run();
        assert!(first.trajectory(0).distance > 2.0);
        assert_eq!(first.scenario(), Some(&scenario));
        assert_eq!(first.log().digest(), run().log().digest());
        let mut bytes = Vec::new();
        first.log().write(&mut bytes).unwrap();
        let read = TrialLog::read(&mut &bytes[..]).unwrap();
        let again = replay_headless(&world, read, |_| ()).unwrap();
        assert_eq!(digest(&again), digest(&first));
        assert_eq!(again.trajectory(0), first.trajectory(0));
        assert_eq!(again.log().digest(), first.log().digest());
        let truth = first.reference(&world).unwrap();
        let scores = first.score(&truth).unwrap();
        assert_eq!(again.score(&truth).unwrap(), scores);
        assert!(scores.moving.expect("something moves").swept_area > 0.3);
    }
}

#[test]
fn later_trials_in_an_app_begin_with_the_scenario_and_replay_too() {
    let world = indoor();
    let scenario = of(&world, everything());
    let mut app = app();
    let root = spawn(&mut app, &world, &scenario);
    step(&mut app, 77);
    for speed in [0.5, 0.7] {
        let held = MappingTrial::new(TrialSettings { policy: None, robots: 2, ..settings(60.0) });
        let command = Command { speed, turn_rate: 0.3 };
        let manual_control = ManualControl { commands: vec![command; 2] };
        app.world_mut().entity_mut(root).insert((held, manual_control));
        step(&mut app, 300);
        let held = trial(&app, root);
        assert!(held.time() > 14.0 && held.trajectory(0).distance > 1.0);
        let state = held.bodies().scenario().unwrap();
        assert_eq!(state.tick(), (held.time() * 20.0).round() as u64);
        app.world_mut().get_mut::<MappingTrial>(root).unwrap().stop();
        step(&mut app, 1);
        let held = trial(&app, root);
        let again = replay_headless(&world, held.log(), |_| ()).unwrap();
        assert_eq!(again.trajectory(1), held.trajectory(1));
        assert_eq!(digest(&again), digest(held));
    }
    // A replay in an environment with another scenario, or without one, uses the scenario of its log.
    let log = trial(&app, root).log();
    let end = digest(trial(&app, root));
    app.world_mut().entity_mut(root).remove::<(MappingTrial, ManualControl)>();
    for other in [Some(of(&world, ScenarioSpec { people: 2, ..everything() })), None] {
        let mut root = app.world_mut().entity_mut(root);
        match other {
            Some(other) => root.insert(EnvironmentScenario::prebuilt(other)),
            None => root.remove::<EnvironmentScenario>(),
        };
        root.insert(MappingTrial::replay(log.clone()));
        let root = root.id();
        step(&mut app, 320);
        assert_eq!(digest(trial(&app, root)), end);
        app.world_mut().entity_mut(root).remove::<MappingTrial>();
    }
}

#[test]
fn a_replay_restores_the_scenario_that_it_replaced() {
    let world = indoor();
    let scenario = of(&world, ScenarioSpec { people: 3, ..default() });
    let other = EnvironmentScenario::new(ScenarioSpec { people: 1, ..default() }, 4);
    for logged in [Some(scenario.clone()), None] {
        let parts = TrialParts::default();
        let log = run_headless_with(&world, settings(1.0), parts, logged.clone(), |_| ());
        let log = log.unwrap().log();
        let wanted = logged.clone().map(EnvironmentScenario::prebuilt);
        let mut app = app();
        let root = spawn(&mut app, &world, &scenario);
        let request = |app: &App, root: Entity| app.world().get(root).cloned();
        for before in [Some(other.clone()), None] {
            let mut entity = app.world_mut().entity_mut(root);
            match &before {
                Some(before) => entity.insert(before.clone()),
                None => entity.remove::<EnvironmentScenario>(),
            };
            // One replay after the other.
            for _ in 0..2 {
                app.world_mut().entity_mut(root).insert(MappingTrial::replay(log.clone()));
                step(&mut app, 60);
                assert_eq!(request(&app, root), wanted);
                assert!(app.world().get::<MappingTrial>(root).unwrap().is_over());
            }
            let clone = app.world_mut().entity_mut(root).clone_and_spawn();
            app.world_mut().entity_mut(root).remove::<MappingTrial>();
            step(&mut app, 2);
            assert_eq!(request(&app, root), before);
            assert_eq!(request(&app, clone), before);
            app.world_mut().despawn(clone);
        }
        // A scenario that the app has inserted after the replay is kept.
        app.world_mut().entity_mut(root).insert(MappingTrial::replay(log));
        step(&mut app, 60);
        let own = EnvironmentScenario::new(ScenarioSpec { people: 2, ..default() }, 4);
        app.world_mut().entity_mut(root).insert(own.clone()).remove::<MappingTrial>();
        step(&mut app, 2);
        assert_eq!(request(&app, root), Some(own));
    }
}

/// Commands some doors in every tick, except those of replays.
fn command_doors(mut doors: Query<&mut Door>, mut ticks: Local<u32>) {
    *ticks += 1;
    for mut door in &mut doors {
        match (*ticks + 17 * door.index()) % 60 {
            0 => door.slam(),
            20 => door.close(),
            40 => door.open(),
            _ => {}
        }
    }
}

/// Does the same without the components of the doors.
fn command_runs(mut runs: Query<&mut ScenarioRun>, mut ticks: Local<usize>) {
    *ticks += 1;
    for mut run in &mut runs {
        for door in 0..run.doors().count() {
            let command = match (*ticks + 17 * door) % 60 {
                0 => DoorCommand::Slam,
                20 => DoorCommand::Close,
                40 => DoorCommand::Open,
                _ => continue,
            };
            run.command_door(door, command).unwrap();
        }
    }
}

#[test]
fn commands_to_doors_are_in_the_log_and_replay_to_the_bit() {
    commands_to_doors_are_replayed(|app| _ = app.add_systems(FixedUpdate, command_doors));
}

#[test]
fn commands_to_a_run_are_in_the_log_and_replay_to_the_bit() {
    commands_to_doors_are_replayed(|app| _ = app.add_systems(FixedUpdate, command_runs));
}

fn commands_to_doors_are_replayed(add_commands: impl Fn(&mut App)) {
    let world = indoor();
    let door_control = DoorControl::Commanded;
    let scenario = of(&world, ScenarioSpec { doors: 0.6, people: 3, door_control, ..default() });
    let mut app = app();
    add_commands(&mut app);
    let root = spawn(&mut app, &world, &scenario);
    app.world_mut().entity_mut(root).insert(MappingTrial::new(settings(600.0)));
    step(&mut app, 500);
    app.world_mut().get_mut::<MappingTrial>(root).unwrap().stop();
    step(&mut app, 1);
    let (log, end) = (trial(&app, root).log(), digest(trial(&app, root)));
    assert!(log.door_commands().len() > 20);
    let again = replay_headless(&world, log.clone(), |_| ()).unwrap();
    assert_eq!(digest(&again), end);
    assert_eq!(again.log().digest(), log.digest());
    assert_eq!(again.trajectory(0), trial(&app, root).trajectory(0));
    // The replay runs in the same app, whose commands come at other times.
    step(&mut app, 7);
    app.world_mut().entity_mut(root).insert(MappingTrial::replay(log.clone()));
    step(&mut app, 520);
    let held = app.world().get::<MappingTrial>(root).unwrap();
    assert!(held.is_over());
    assert_eq!(digest(trial(&app, root)), end);
    assert_eq!(trial(&app, root).log().digest(), log.digest());
    // After the replay the doors follow the commands of the app again.
    let openness = |app: &mut App| {
        let mut doors = app.world_mut().query::<&Door>();
        doors.iter(app.world()).map(|door| door.openness()).collect::<Vec<_>>()
    };
    let before = openness(&mut app);
    step(&mut app, 15);
    assert_ne!(openness(&mut app), before);
}

#[test]
fn another_scenario_restarts_the_trial() {
    let world = indoor();
    let mut app = app();
    let root = spawn(&mut app, &world, &of(&world, everything()));
    app.world_mut().entity_mut(root).insert(MappingTrial::new(settings(600.0)));
    step(&mut app, 100);
    assert!(trial(&app, root).time() > 4.0);
    let other = of(&world, ScenarioSpec { people: 1, ..Default::default() });
    app.world_mut().entity_mut(root).insert(EnvironmentScenario::prebuilt(other.clone()));
    step(&mut app, 20);
    assert!(trial(&app, root).time() < 1.0);
    assert_eq!(trial(&app, root).scenario(), Some(&other));
    assert_eq!(app.world_mut().query::<&TrialRobot>().iter(app.world()).count(), 1);
    app.world_mut().entity_mut(root).remove::<EnvironmentScenario>();
    step(&mut app, 20);
    assert!(trial(&app, root).time() < 1.0 && trial(&app, root).scenario().is_none());
}

#[test]
fn a_trial_that_failed_because_of_its_scenario_begins_without_it() {
    let world = indoor();
    let mut app = app();
    let root = spawn(&mut app, &world, &of(&world, everything()));
    let broken = EnvironmentScenario::new(ScenarioSpec { people: 1_000_000, ..default() }, 1);
    app.world_mut().entity_mut(root).insert((broken, MappingTrial::new(settings(600.0))));
    step(&mut app, 20);
    assert!(app.world().get::<MappingTrial>(root).unwrap().has_failed());
    app.world_mut().entity_mut(root).remove::<EnvironmentScenario>();
    step(&mut app, 20);
    assert!(trial(&app, root).time() > 0.5 && trial(&app, root).scenario().is_none());
}

#[test]
fn a_person_on_the_path_is_seen_stops_the_robot_and_is_one_collision() {
    let world = hall();
    let mut scenario = of(&world, ScenarioSpec { waiting: 1e6, ..Default::default() });
    let (position, reaction) = (DVec2::new(5.0, 2.0), Reaction::Impassive);
    scenario.people = vec![ListedPerson { position, heading: 0.0, speed: 1.0, reaction }];
    let (app, root) = drive(&world, &scenario, 0.5, 20);
    let trial = trial(&app, root);
    let at = trial.trajectory(0).poses.last().unwrap().position;
    let front = at.x + 0.5 * trial.settings().body.length;
    assert!((front - 4.75).abs() < 0.02, "{front}");
    assert_eq!((trial.bodies().collisions(0), trial.bodies().person_collisions(0)), (0, 1));
    let range = trial.autonomy().scan(0).ranges[90];
    let expected =
        4.75 - trial.settings().body.laser_pose(Pose { position: at, heading: 0.0 }).position.x;
    assert!((range - expected).abs() < 0.05, "{range} {expected}");
    let scores = trial.score(&trial.reference(&world).unwrap()).unwrap();
    let moving = scores.moving.expect("something moves");
    assert_eq!((scores.collisions, moving.person_collisions), (0, 1));
}

#[test]
fn a_closed_door_stops_the_robot_and_an_open_one_does_not() {
    let world = hall();
    for (door_open, closed) in [(0.5, true), (1e6, false)] {
        for door_kind in [DoorKinds::Hinged, DoorKinds::Double, DoorKinds::Sliding] {
            let door_closed = 1e6 + 0.5 - door_open;
            let spec = ScenarioSpec {
                doors: 1.0,
                door_kind,
                door_open,
                door_closed,
                ..Default::default()
            };
            let (app, root) = drive(&world, &of(&world, spec), 0.6, 16);
            let trial = trial(&app, root);
            let at = trial.trajectory(0).poses.last().unwrap().position;
            let front = at.x + 0.5 * trial.settings().body.length;
            if closed {
                assert!((front - 8.0).abs() < 0.03, "{door_kind:?}: {front}");
                assert_eq!(
                    (trial.bodies().collisions(0), trial.bodies().person_collisions(0)),
                    (1, 0)
                );
            } else {
                assert!(front > 9.0, "{door_kind:?}: {front}");
                assert_eq!(trial.bodies().collisions(0), 0);
            }
        }
    }
}

#[test]
fn smoke_hides_what_is_beyond_its_range() {
    let world = hall();
    let scan = |failed_beams, laser: LaserProfile, smoke_profile| {
        let spec = ScenarioSpec {
            smoke: 2.0,
            smoke_radius: 100.0,
            failed_beams,
            smoke_profile,
            ..Default::default()
        };
        let settings = TrialSettings { laser, ..settings(1.0) };
        let scenario = Some(of(&world, spec));
        let trial =
            run_headless_with(&world, settings, TrialParts::default(), scenario, |_| ()).unwrap();
        trial.autonomy().scan(0).ranges.clone()
    };
    // The side walls are 2 m away.
    assert!(smoke_range(30.0, 2.0) < 1.6);
    let sick = LaserProfile::LMS200_MM;
    let none = scan(FailedBeams::None, sick.clone(), SmokeProfile::Physical);
    assert!(none.iter().all(|range| range.is_nan()), "{none:?}");
    let zero = scan(FailedBeams::Zero, sick.clone(), SmokeProfile::Physical);
    assert!(zero.iter().all(|range| *range == 0.0), "{zero:?}");
    let phantom = scan(FailedBeams::Phantom, sick.clone(), SmokeProfile::Physical);
    assert!(phantom.iter().all(|range| (0.8..8.19).contains(range)), "{phantom:?}");
    let seen = scan(FailedBeams::Zero, sick, SmokeProfile::Usarsim);
    assert!(seen.iter().all(|range| *range > 1.5), "{seen:?}");
    let hokuyo = scan(FailedBeams::Zero, LaserProfile::URG_04LX, SmokeProfile::Usarsim);
    assert!(hokuyo.iter().all(|range| *range == 0.0), "{hokuyo:?}");
}

#[test]
fn a_beam_that_smoke_stops_meets_nobody_of_another_scenario() {
    let world = hall();
    let smoke = ScenarioSpec { smoke: 2.0, smoke_radius: 100.0, ..Default::default() };
    let smoke = of(&world, ScenarioSpec { failed_beams: FailedBeams::None, ..smoke });
    let mut person = of(&world, ScenarioSpec { waiting: 1e6, ..Default::default() });
    let (position, reaction) = (DVec2::new(5.0, 2.0), Reaction::Impassive);
    person.people = vec![ListedPerson { position, heading: 0.0, speed: 1.0, reaction }];
    for scenarios in [[&smoke, &person], [&person, &smoke]] {
        let mut app = app();
        for scenario in scenarios {
            spawn(&mut app, &world, scenario);
        }
        let profile = LaserProfile { ticks_a_scan: 1, ..LaserProfile::LMS200_MM };
        let at = Transform::from_xyz(2.0, 2.0, 0.0);
        let robot = (RobotModel::default(), LaserScanner::new(profile, 1, 0), at);
        let robot = app.world_mut().spawn(robot).id();
        step(&mut app, 10);
        let ranges = &app.world().get::<LaserScan>(robot).unwrap().ranges;
        assert!(!ranges.is_empty() && ranges.iter().all(|range| range.is_nan()), "{ranges:?}");
    }
}

#[test]
fn a_scenario_of_another_world_is_refused() {
    let scenario = of(&indoor(), ScenarioSpec { doors: 1.0, ..Default::default() });
    let run =
        run_headless_with(&hall(), settings(1.0), TrialParts::default(), Some(scenario), |_| ());
    let error = run.err().expect("no trial").to_string();
    assert!(error.contains(".doorway` must be the index of a doorway"), "{error}");
}
