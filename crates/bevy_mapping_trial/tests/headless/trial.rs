//! Headless mapping trials in rapier.

use bevy::prelude::*;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{in_rapier, step};
use bevy_mapping_trial::prelude::*;
use bevy_mapping_trial::trial::{
    MappingTrialError, RapierRobots, replay_headless, run_headless, run_headless_with,
};
use envgen::geometry::{Pose, Rect, Shape};
use envgen::glam::DVec2;
use envgen::hallway::HallwaySpec;
use envgen::indoor::IndoorSpec;
use envgen::world::{Wall, WallKind};
use envgen::{Blueprint, Provenance, Seed, Spec, World as EnvWorld};
use mapping_trial::backend::Command;
use mapping_trial::backend::RobotBackend;
use mapping_trial::lidar::{LaserSensor, NO_ECHO, Scan};
use mapping_trial::odometry::{Increment, WheelSensor};
use mapping_trial::policy::{Decision, ExplorationPolicy, PolicyInput};
use mapping_trial::score::Reference;
use mapping_trial::slam::DeadReckoning;
use mapping_trial::trial::{EndReason, Trial, TrialLog, TrialParts, TrialSettings};

fn hallway() -> EnvWorld {
    HallwaySpec { segments: 4, ..Default::default() }.generate(Seed(7)).unwrap().to_world()
}

pub(crate) fn short(time_limit: f64) -> TrialSettings {
    TrialSettings { time_limit, ..TrialSettings::default() }
}

fn state(trial: &Trial<RapierRobots>) -> impl PartialEq + std::fmt::Debug + use<> {
    let tracks: Vec<_> = (0..trial.robots())
        .map(|robot| {
            let estimated = trial.autonomy().slam().trajectory(robot);
            (trial.trajectory(robot).clone(), trial.end_of(robot), estimated)
        })
        .collect();
    (tracks, trial.time())
}

#[test]
fn a_trial_runs_again_from_its_log_to_the_bit() {
    let world = hallway();
    for settings in [short(40.0), TrialSettings { robots: 2, ..short(20.0) }] {
        let trial = run_headless(&world, settings.clone(), |_| ()).unwrap();
        assert!(
            trial.is_over() && trial.trajectory(0).distance > 1.5,
            "{}",
            trial.trajectory(0).distance
        );
        let log = trial.log();
        let twice = run_headless(&world, settings, |_| ()).unwrap();
        assert_eq!(twice.log().digest(), log.digest());

        let mut bytes = Vec::new();
        log.write(&mut bytes).unwrap();
        let read = TrialLog::read(&mut &bytes[..]).unwrap();
        let again = replay_headless(&read.world.world().unwrap(), read, |_| ()).unwrap();
        assert_eq!(state(&again), state(&trial));
        assert_eq!(again.log().digest(), log.digest());
    }
}

/// Creates an app as a user does, in which each update is a tick.
pub(crate) fn app(steps: f64) -> App {
    app_with_frames(steps, steps)
}

/// Creates an app whose frames are shorter or longer than its ticks, as in an app with a window.
fn app_with_frames(steps: f64, frames: f64) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin));
    app.add_plugins((TopDownPhysicsPlugin::new(steps).with_substeps(4), EnvgenPlugins::default()));
    app.add_plugins(TrialPlugin::default());
    let frame = std::time::Duration::from_secs_f64(1.0 / frames);
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(frame));
    app.finish();
    app.cleanup();
    app
}

#[derive(Resource, Default)]
pub(crate) struct Told(pub(crate) Vec<String>);

pub(crate) fn listen(app: &mut App) {
    app.init_resource::<Told>();
    app.add_observer(|_: On<TrialStarted>, mut reported: ResMut<Told>| {
        reported.0.push("started".into())
    });
    app.add_observer(|_: On<TrialEnded>, mut reported: ResMut<Told>| {
        reported.0.push("ended".into())
    });
    app.add_observer(|failed: On<TrialFailed>, mut reported: ResMut<Told>| {
        reported.0.push(failed.error.to_string());
    });
}

pub(crate) fn environment() -> Environment {
    Environment::prebuilt(hallway()).with_pace(GenerationMode::Blocking)
}

pub(crate) fn robots(app: &mut App) -> usize {
    app.world_mut().query::<&TrialRobot>().iter(app.world()).count()
}

#[test]
fn a_person_drives_and_stops_and_nothing_is_left() {
    let mut app = app(20.0);
    listen(&mut app);
    let root = app.world_mut().spawn(environment()).id();
    step(&mut app, 3);
    let before = in_rapier(&mut app);
    let commands = vec![Command { speed: 0.4, turn_rate: 0.0 }];
    let settings = TrialSettings { policy: None, ..short(60.0) };
    app.world_mut()
        .entity_mut(root)
        .insert((MappingTrial::new(settings), ManualControl { commands }));
    step(&mut app, 60);
    assert_eq!((robots(&mut app), app.world().resource::<Told>().0.len()), (1, 1));
    assert_eq!(in_rapier(&mut app), (before.0 + 1, before.1 + 1));
    let trial = |app: &App| -> (f64, bool) {
        let trial = app.world().get::<MappingTrial>(root).unwrap();
        (trial.trial().unwrap().trajectory(0).distance, trial.is_over())
    };
    assert!(trial(&app).0 > 0.5 && !trial(&app).1, "{:?}", trial(&app));
    app.world_mut().get_mut::<MappingTrial>(root).unwrap().stop();
    step(&mut app, 2);
    assert_eq!(app.world().resource::<Told>().0, ["started", "ended"]);
    let ended = app.world().get::<MappingTrial>(root).unwrap();
    assert_eq!(ended.trial().unwrap().end_of(0).map(|e| e.reason), Some(EndReason::Stopped));

    // A trial that a person drove can be replayed too.
    let log = ended.trial().unwrap().log();
    let track = ended.trial().unwrap().trajectory(0).clone();
    let again = replay_headless(&hallway(), log, |_| ()).unwrap();
    assert_eq!(again.trajectory(0), &track);

    app.world_mut().entity_mut(root).remove::<MappingTrial>();
    step(&mut app, 3);
    assert_eq!((robots(&mut app), in_rapier(&mut app)), (0, before));
}

#[test]
fn another_world_restarts_the_trial_and_despawn_leaves_nothing() {
    let mut app = app(20.0);
    listen(&mut app);
    let root = app.world_mut().spawn((environment(), MappingTrial::new(short(60.0)))).id();
    step(&mut app, 40);
    let other = HallwaySpec { segments: 6, ..Default::default() };
    *app.world_mut().get_mut::<Environment>(root).unwrap() = Environment::new(other, 3);
    step(&mut app, 10);
    assert_eq!(robots(&mut app), 1);
    assert_eq!(app.world().resource::<Told>().0, ["started", "started"]);
    let time = app.world().get::<MappingTrial>(root).unwrap().trial().unwrap().time();
    assert!(time < 0.5, "{time}");
    app.world_mut().despawn(root);
    step(&mut app, 3);
    assert_eq!((robots(&mut app), in_rapier(&mut app)), (0, (0, 0)));
}

#[test]
fn what_cannot_be_is_reported() {
    let reported = |steps: f64, settings: TrialSettings| {
        let mut app = app(steps);
        listen(&mut app);
        app.world_mut().spawn((environment(), MappingTrial::new(settings)));
        step(&mut app, 5);
        assert_eq!(robots(&mut app), 0);
        app.world().resource::<Told>().0.join("; ")
    };
    let text = reported(64.0, short(9.0));
    assert!(text.starts_with("time advances by 0.015625 s per step"), "{text}");
    let text = reported(20.0, TrialSettings { robots: 0, ..short(9.0) });
    assert_eq!(text, "`robots` must be a whole number from 1 to 8, got 0");
    let error = run_headless(&hallway(), short(f64::NAN), |_| ()).err().unwrap().to_string();
    assert!(error.contains("`time_limit` must be"), "{error}");

    let log = Trial::flat(&hallway(), short(1.0)).unwrap().log();
    let error = replay_headless(&hallway(), log, |_| ()).err().unwrap();
    let engine = MappingTrialError::Engine { found: "flat".into() };
    assert_eq!(error, engine.into());
}

#[test]
fn frames_of_any_length_give_the_same_trial() {
    let world = IndoorSpec { width: 5, height: 5, ..Default::default() };
    let world = world.generate(Seed(3)).unwrap().to_world();
    let start = world.start.unwrap();
    let settings = TrialSettings { policy: None, robots: 2, ..short(60.0) };
    for frames in [7.0, 20.0, 190.0] {
        let mut app = app_with_frames(20.0, frames);
        app.insert_resource(ColliderSettings::for_trials());
        let environment = Environment::prebuilt(world.clone()).with_pace(GenerationMode::Blocking);
        let root = app.world_mut().spawn(environment).id();
        step(&mut app, 5);
        let mut manual_control = ManualControl::default();
        let trial = MappingTrial::new(settings.clone());
        app.world_mut().entity_mut(root).insert((trial, manual_control.clone()));
        // The robots drive into walls and into each other, along walls, and back.
        for (speed, turn_rate) in [(0.7, 0.0), (0.5, 0.9), (0.7, -0.3), (-0.4, 0.2), (0.7, 0.0)] {
            let command = Command { speed, turn_rate };
            manual_control.commands =
                vec![command, Command { speed: 0.5 * speed, turn_rate: -turn_rate }];
            app.world_mut().entity_mut(root).insert(manual_control.clone());
            step(&mut app, (4.0 * frames) as usize);
        }
        let mut held = app.world_mut().get_mut::<MappingTrial>(root).unwrap();
        held.stop();
        let trial = held.trial().unwrap();
        let track = trial.trajectory(0);
        assert!(
            track.poses.iter().take(9).all(|pose| pose.position.distance(start.position) < 0.1),
            "{start:?}"
        );
        assert!((1.0..14.0).contains(&track.distance), "{}", track.distance);
        assert!(trial.bodies().collisions(0) > 0);
        let again = replay_headless(&world, trial.log(), |_| ()).unwrap();
        let robots = || 0..trial.robots();
        assert!(
            robots().all(|robot| again.trajectory(robot) == trial.trajectory(robot)),
            "{frames} frames"
        );
    }
}

#[test]
fn another_trial_in_the_same_app_is_as_good_as_the_first() {
    let mut app = app(20.0);
    app.insert_resource(ColliderSettings::for_trials());
    let root = app.world_mut().spawn(environment()).id();
    step(&mut app, 5);
    let settings = TrialSettings { policy: None, robots: 3, ..short(60.0) };
    let commands = vec![Command { speed: 0.6, turn_rate: 0.4 }; 3];
    for number in 0..3 {
        let trial = MappingTrial::new(settings.clone());
        app.world_mut()
            .entity_mut(root)
            .insert((trial, ManualControl { commands: commands.clone() }));
        step(&mut app, 300);
        let trial = app.world().get::<MappingTrial>(root).unwrap().trial().unwrap();
        assert!(trial.bodies().collisions(0) > 0);
        let mut log = trial.log();
        log.ends.fill(None);
        let again = replay_headless(&hallway(), log, |_| ()).unwrap();
        let ticks = again.trajectory(0).poses.len();
        assert!(ticks > 290);
        for robot in 0..3 {
            let both = again.trajectory(robot).poses.iter().zip(&trial.trajectory(robot).poses);
            let differs = both.clone().position(|(again, first)| again != first);
            assert_eq!(differs, None, "robot {robot} of trial {number}, of {ticks} ticks");
        }
    }
}

/// The backends differ, since the robot is a box in rapier and a disc in the flat simulator. Documented for
/// 20 maps: M and N differ by at most 0.3 in the mean, and by at most 1.5 on each map.
#[test]
#[expect(clippy::print_stderr, reason = "the differences are what is asked for")]
fn scores_are_those_of_the_flat_simulator_within_tolerances() {
    let maps: Vec<u64> = (1..=20).collect();
    let (mut mapping, mut navigation) = (0.0, 0.0);
    let differences = std::thread::scope(|scope| {
        let halves: Vec<_> = maps
            .chunks(10)
            .map(|seeds| {
                scope.spawn(|| seeds.iter().map(|&seed| difference(seed)).collect::<Vec<_>>())
            })
            .collect();
        halves.into_iter().flat_map(|half| half.join().unwrap()).collect::<Vec<_>>()
    });
    for (seed, (m, n)) in maps.iter().zip(&differences) {
        eprintln!("seed {seed}: M {m:+.2}, N {n:+.2}");
        assert!(m.abs() <= 1.5 && n.abs() <= 1.5, "seed {seed}: M {m:+.2}, N {n:+.2}");
        mapping += m / 20.0;
        navigation += n / 20.0;
    }
    eprintln!("mean: M {mapping:+.2}, N {navigation:+.2}");
    assert!(mapping.abs() <= 0.3 && navigation.abs() <= 0.3, "{mapping} {navigation}");
}

/// Returns by how much M and N are greater in rapier, with the same world and seeds.
fn difference(seed: u64) -> (f64, f64) {
    let spec = IndoorSpec { width: 4, height: 4, ..Default::default() };
    let world = spec.generate(Seed(seed)).unwrap().to_world();
    let settings = TrialSettings { seed: Seed(seed), ..short(400.0) };
    let truth = Reference::new(&world, &settings.body).unwrap();
    let mut flat = Trial::flat(&world, settings.clone()).unwrap();
    while flat.step() {}
    let flat = flat.score(&truth).unwrap();
    let rapier = run_headless(&world, settings, |_| ()).unwrap().score(&truth).unwrap();
    (rapier.mapping - flat.mapping, rapier.navigation - flat.navigation)
}

#[test]
fn where_another_world_failed_the_last_one_is_driven_in() {
    let mut app = app(20.0);
    listen(&mut app);
    let root = app.world_mut().spawn(environment()).id();
    step(&mut app, 3);
    let none = HallwaySpec { segments: 0, ..Default::default() };
    app.world_mut().entity_mut(root).insert(Environment::new(none, 3));
    step(&mut app, 5);
    assert!(app.world().get::<GroundTruth>(root).is_some());
    app.world_mut().entity_mut(root).insert(MappingTrial::new(short(60.0)));
    step(&mut app, 60);
    assert_eq!(
        (robots(&mut app), &app.world().resource::<Told>().0[..]),
        (1, &["started".into()][..])
    );
}

/// A policy that drives straight ahead, and is asked in every tick.
struct Ahead;

impl ExplorationPolicy for Ahead {
    fn decide(&mut self, _: &PolicyInput<'_>) -> Decision {
        Decision::Drive(Command { speed: 0.3, turn_rate: 0.0 })
    }

    fn ticks_per_decision(&self) -> u64 {
        1
    }
}

/// A laser that detects nothing.
struct Blind;

impl LaserSensor for Blind {
    fn measure(&mut self, exact: &[f64]) -> Scan {
        Scan { ranges: vec![NO_ECHO; exact.len()] }
    }
}

/// A wheel sensor that measures twice the distance.
struct Double;

impl WheelSensor for Double {
    fn measure(&mut self, motion: Increment, _: f64) -> Increment {
        Increment { distance: 2.0 * motion.distance, ..motion }
    }
}

/// Returns a world with a room of 40 x 5 m, whose lower left corner is at a point.
fn room_at(corner: DVec2) -> EnvWorld {
    let bounds = Rect::new(corner, corner + DVec2::new(40.0, 5.0));
    let mut world = EnvWorld::new(Provenance::other("test", serde_json::Value::Null), bounds);
    let corners = Shape::from_rect(bounds).corners();
    world.walls = (0..4)
        .map(|i| Shape::Segment { a: corners[i], b: corners[(i + 1) % 4] })
        .map(|shape| Wall::new(WallKind::Wall, shape))
        .collect();
    world.start = Some(Pose { position: corner + 1.5, heading: 0.3 });
    world
}

#[test]
fn robots_drive_far_from_the_origin_as_near_it() {
    // Such coordinates occur in national map grids.
    let far = DVec2::new(500_000.0, 4_200_000.0);
    let end = |corner: DVec2| {
        let rapier = run_headless(&room_at(corner), short(20.0), |_| ()).unwrap();
        let mut flat = Trial::flat(&room_at(corner), short(20.0)).unwrap();
        while flat.step() {}
        [rapier.trajectory(0), flat.trajectory(0)].map(|track| {
            assert!(track.distance > 4.0, "{corner}: {}", track.distance);
            track.poses.last().unwrap().position - corner
        })
    };
    for (near, far) in end(DVec2::ZERO).into_iter().zip(end(far)) {
        // Rounding differs, which changes a plan now and then.
        assert!(near.distance(far) < 0.5, "{near} {far}");
    }
}

#[test]
fn parts_of_ones_own_drive_robots_in_rapier() {
    let world = hallway();
    let parts =
        TrialParts::default().policy(|_| Ahead).laser(|_, _| Blind).odometry(|_, _| Double).slam(
            |setup| {
                let TrialSettings { body, laser, .. } = setup.settings;
                DeadReckoning::new(setup.starts, body, laser)
            },
        );
    let trial = run_headless_with(&world, short(4.0), parts, None, |_| ()).unwrap();
    let driven = trial.trajectory(0).distance;
    assert!((0.8..1.2).contains(&driven), "{driven}");
    let estimated = trial.autonomy().slam().trajectory(0);
    let measured = estimated[0].position.distance(estimated[estimated.len() - 1].position);
    assert!((measured / driven - 2.0).abs() < 0.1, "{measured} of {driven}");
    assert!(trial.autonomy().scan(0).ranges.iter().all(|range| *range == NO_ECHO));
    let log = trial.log();
    assert_eq!((log.foreign.len(), log.engine.as_str()), (4, "rapier"));
    // The commands are replayed. Built-in sensors replace the custom ones, which only their author has.
    let again = replay_headless(&world, log, |_| ()).unwrap();
    assert_eq!(again.trajectory(0), trial.trajectory(0));
    assert!(again.autonomy().scan(0).ranges.iter().any(|range| range.is_finite()));
}

/// Saves a scene of an environment with a trial that a person drives.
#[cfg(feature = "serialize")]
fn save_scene(app: &App, root: Entity) {
    use bevy::world_serialization::DynamicWorldBuilder;
    let registry = app.world().resource::<AppTypeRegistry>().read();
    assert!(app.world().entity(root).contains::<ManualControl>());
    let scene = DynamicWorldBuilder::from_world(app.world(), &registry)
        .deny_component::<Children>()
        .extract_entities([root].into_iter())
        .build();
    let text = scene.serialize(&registry).unwrap();
    assert!(text.contains("ManualControl"), "{text}");
}

#[test]
fn scenes_leave_trials_and_sensors_out() {
    use bevy::ecs::entity::EntityHashMap;
    use bevy::world_serialization::DynamicWorldBuilder;
    let mut app = app(20.0);
    let environment = Environment::new(HallwaySpec { segments: 4, ..Default::default() }, 7);
    let trial = (MappingTrial::new(short(5.0)), ManualControl::default());
    let root = app.world_mut().spawn((environment, trial)).id();
    bevy_envgen::testing::wait_until_ready(&mut app, root).unwrap();
    for _ in 0..200 {
        if !app.world().get::<MappingTrial>(root).unwrap().robots().is_empty() {
            break;
        }
        step(&mut app, 1);
    }
    step(&mut app, 10);
    let robot = app.world().get::<MappingTrial>(root).unwrap().robots()[0];
    let scene = {
        let registry = app.world().resource::<AppTypeRegistry>().read();
        DynamicWorldBuilder::from_world(app.world(), &registry)
            .deny_component::<ChildOf>()
            .deny_component::<Children>()
            .extract_entities([root, robot].into_iter())
            .build()
    };
    #[cfg(feature = "serialize")]
    save_scene(&app, root);
    let mut entities = EntityHashMap::default();
    scene.write_to_world(app.world_mut(), &mut entities).unwrap();
    let [root, robot] = [entities[&root], entities[&robot]];
    bevy_envgen::testing::wait_until_ready(&mut app, root).unwrap();
    assert!(!app.world().entity(root).contains::<MappingTrial>());
    assert!(!app.world().entity(robot).contains::<LaserScanner>());
    assert!(!app.world().entity(robot).contains::<WheelOdometry>());
    assert!(app.world().entity(robot).contains::<RobotModel>());
}
