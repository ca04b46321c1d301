//! Trials with parts that are plugged in.

use envgen::geometry::Pose;
use envgen::hallway::HallwaySpec;
use envgen::indoor::IndoorSpec;
use envgen::scenario::{DoorCommand, Scenario, ScenarioSpec};
use envgen::{Blueprint, Seed, Spec, World};
use glam::DVec2;

use super::*;
use crate::backend::{Command, Condition, Observation, RobotBackend, TICK};
use crate::flat::{FlatSimulator, FlatWorld};
use crate::lidar::{LaserSensor, NO_ECHO, Scan};
use crate::map::{Estimate, OccupancyMap};
use crate::odometry::{Increment, WheelSensor};
use crate::policy::{Decision, ExplorationPolicy, PolicyInput};
use crate::robot::Robot;
use crate::score::{Reference, ScoreError};
use crate::slam::{DeadReckoning, Slam};

fn hallway() -> World {
    HallwaySpec { segments: 4, ..Default::default() }.generate(Seed(7)).expect("a hall").to_world()
}

fn short(time_limit: f64) -> TrialSettings {
    TrialSettings { time_limit, ..TrialSettings::default() }
}

fn run<B: RobotBackend>(mut trial: Trial<B>) -> Trial<B> {
    while trial.step() {}
    trial
}

/// Dead reckoning that counts its steps and can lose the end of its trajectory.
struct Counting {
    wheels: DeadReckoning,
    forgets: bool,
}

impl Slam for Counting {
    fn name(&self) -> &str {
        "counting"
    }

    fn step(&mut self, robot: usize, seen: &Observation) {
        self.wheels.step(robot, seen);
    }

    fn estimate(&self, robot: usize) -> Estimate {
        self.wheels.estimate(robot)
    }

    fn map(&self) -> &OccupancyMap {
        self.wheels.map()
    }

    fn trajectory(&self, robot: usize) -> Vec<Pose> {
        let mut poses = self.wheels.trajectory(robot);
        if self.forgets {
            poses.pop();
        }
        poses
    }
}

/// Drives ahead at a speed, asked every tick; fails after some decisions.
struct Ahead {
    speed: f64,
    decisions: u32,
    breaks_after: u32,
}

impl ExplorationPolicy for Ahead {
    fn decide(&mut self, view: &PolicyInput<'_>) -> Decision {
        assert_eq!(view.seen.time, f64::from(self.decisions) * TICK, "asked every tick");
        self.decisions += 1;
        if self.decisions > self.breaks_after {
            return Decision::Failed;
        }
        Decision::Drive(Command { speed: self.speed, turn_rate: 0.0 })
    }

    fn ticks_per_decision(&self) -> u64 {
        1
    }

    fn failure(&self) -> Option<&str> {
        (self.decisions > self.breaks_after).then_some("out of ideas")
    }
}

fn ahead(speed: f64, breaks_after: u32) -> impl Fn(&Setup<'_>) -> Ahead {
    move |_| Ahead { speed, decisions: 0, breaks_after }
}

/// A laser that sees nothing.
struct Blind;

impl LaserSensor for Blind {
    fn measure(&mut self, exact: &[f64]) -> Scan {
        Scan { ranges: vec![NO_ECHO; exact.len()] }
    }
}

/// Wheels that measure twice the distance.
struct Double;

impl WheelSensor for Double {
    fn measure(&mut self, motion: Increment, _: f64) -> Increment {
        Increment { distance: 2.0 * motion.distance, ..motion }
    }
}

#[test]
fn parts_are_named_and_used() {
    let world = hallway();
    let builder = Trial::builder(&world, short(5.0))
        .slam(|setup| {
            let TrialSettings { body, laser, .. } = setup.settings;
            Counting { wheels: DeadReckoning::new(setup.starts, body, laser), forgets: false }
        })
        .policy(ahead(0.2, u32::MAX))
        .laser(|_, _| Blind)
        .odometry(|_, _| Double);
    let trial = run(builder.build_flat().expect("a trial"));
    let names: Vec<_> = trial.foreign().iter().map(|part| (part.role, &*part.name)).collect();
    assert_eq!(names[0], (PartRole::Slam, "counting"));
    assert!(names[1].0 == PartRole::Policy && names[1].1.ends_with("::Ahead"), "{names:?}");
    assert_eq!(names.len(), 4);
    assert_eq!(trial.settings().policy, None, "the policy of the settings did not drive");
    let driven = trial.trajectory(0).distance;
    assert!((0.7..1.0).contains(&driven), "{driven}");
    let estimated = trial.autonomy().slam().trajectory(0);
    let measured = estimated[0].position.distance(estimated[estimated.len() - 1].position);
    assert!((measured / driven - 2.0).abs() < 0.05, "{measured} of {driven}");
    assert!(trial.autonomy().scan(0).ranges.iter().all(|range| *range == NO_ECHO));
    let report = trial.report(&world, &trial.reference(&world).expect("a start")).expect("scores");
    assert!(report.headline().contains("Ahead with counting and"), "{}", report.headline());
    assert_eq!(report.foreign, trial.foreign());
}

#[test]
fn a_log_with_foreign_parts_replays_its_commands_and_names_them() {
    let world = hallway();
    let slam = |setup: &Setup<'_>| {
        let TrialSettings { body, laser, .. } = setup.settings;
        Counting { wheels: DeadReckoning::new(setup.starts, body, laser), forgets: false }
    };
    let builder = Trial::builder(&world, short(6.0)).slam(slam).policy(ahead(0.3, 80));
    let trial = run(builder.build_flat().expect("a trial"));
    let mut bytes = Vec::new();
    trial.log().write(&mut bytes).expect("memory takes all");
    let log = TrialLog::read(&mut &bytes[..]).expect("its own log");
    assert_eq!(log.foreign, trial.foreign());
    // Without the parts the robots move the same; the built-in SLAM of the settings makes the map.
    let again = log.replay().expect("its own world");
    assert_eq!(again.trajectory(0), trial.trajectory(0));
    assert_eq!(again.end_of(0), trial.end_of(0));
    assert_eq!(again.log(), log);
    let report = again.report(&world, &again.reference(&world).expect("a start")).expect("scores");
    assert!(report.headline().contains("Ahead with scan_to_map and"), "{}", report.headline());
    let roles = |parts: &[ForeignPart]| parts.iter().map(|part| part.role).collect::<Vec<_>>();
    assert_eq!(roles(&report.foreign), [PartRole::Policy]);
    assert_eq!(roles(&report.replaced), [PartRole::Slam]);
    assert_ne!(again.autonomy().slam().trajectory(0), trial.autonomy().slam().trajectory(0));
    // With them, so does the map.
    let mut again =
        log.replay_with(&world, |builder| builder.slam(slam).build_flat()).expect("its own world");
    log.run_through(&mut again).expect("the log's commands");
    assert!(again.replaced().is_empty());
    assert_eq!(again.autonomy().slam().trajectory(0), trial.autonomy().slam().trajectory(0));
    let mut other = log.clone();
    other.engine = "wheels on desks".to_owned();
    let error = other.replay().map(|_| ()).expect_err("another engine").to_string();
    assert!(error.contains("`wheels on desks`"), "{error}");
}

#[test]
fn built_in_parts_leave_no_trace_in_logs() {
    let log = run(Trial::flat(&hallway(), short(1.0)).expect("a trial")).log();
    let text = serde_json::to_string(&log).expect("JSON");
    assert!(log.foreign.is_empty() && !text.contains("foreign"), "{text}");
}

#[test]
fn a_policy_that_fails_ends_the_trial_with_its_reason() {
    let world = hallway();
    let builder = Trial::builder(&world, short(60.0)).policy(ahead(0.3, 40));
    let trial = run(builder.build_flat().expect("a trial"));
    let end = RobotEnd { reason: EndReason::Failed, tick: 40 };
    assert_eq!(trial.end_of(0), Some(end));
    let report = trial.report(&world, &trial.reference(&world).expect("a start")).expect("scores");
    assert_eq!(report.failure.as_deref(), Some("out of ideas"));
    assert!(report.scores.coverage > 0.0, "what was mapped so far is scored");
}

/// Fails for the first robot after two seconds; the others wait.
struct FirstFails;

impl ExplorationPolicy for FirstFails {
    fn decide(&mut self, view: &PolicyInput<'_>) -> Decision {
        match view.robot {
            0 if view.seen.time >= 2.0 => Decision::Failed,
            _ => Decision::Drive(Command::STOP),
        }
    }
}

#[test]
fn a_policy_that_fails_for_one_robot_ends_the_trial_of_all() {
    let settings = TrialSettings { robots: 2, ..short(60.0) };
    let world = hallway();
    let builder = Trial::builder(&world, settings).policy(|_| FirstFails);
    let trial = run(builder.build_flat().expect("a trial"));
    let end = RobotEnd { reason: EndReason::Failed, tick: 40 };
    assert_eq!([0, 1].map(|robot| trial.end_of(robot)), [Some(end); 2]);
    let again = trial.log().replay().expect("its own world");
    assert_eq!([0, 1].map(|robot| again.end_of(robot)), [Some(end); 2]);
}

#[test]
fn commands_that_are_not_finite_are_logged_as_zero() {
    let world = hallway();
    let builder = Trial::builder(&world, short(1.0)).policy(ahead(f64::NAN, u32::MAX));
    let trial = run(builder.build_flat().expect("a trial"));
    assert!(trial.log().commands(0).all(|command| command == Command::STOP));
    let mut trial = Trial::flat(&world, short(1.0)).expect("a trial");
    let wild = Command { speed: f64::INFINITY, turn_rate: f64::NAN };
    trial.step_with(&[wild]);
    let mut bytes = Vec::new();
    trial.log().write(&mut bytes).expect("memory takes all");
    assert!(TrialLog::read(&mut &bytes[..]).is_ok(), "{}", String::from_utf8_lossy(&bytes));
}

#[test]
fn a_trajectory_without_all_its_poses_is_named() {
    let world = hallway();
    let builder = Trial::builder(&world, short(1.0)).slam(|setup| {
        let TrialSettings { body, laser, .. } = setup.settings;
        Counting { wheels: DeadReckoning::new(setup.starts, body, laser), forgets: true }
    });
    let trial = run(builder.build_flat().expect("a trial"));
    let error = trial.score(&trial.reference(&world).expect("a start")).expect_err("short");
    assert_eq!(error, ScoreError::Trajectory { robot: 0, found: 21, expected: 22 });
}

#[test]
fn scores_are_measured_from_where_the_trial_began() {
    let world = hallway();
    let own = world.start.expect("a start");
    let elsewhere = Pose { position: own.position + DVec2::new(0.0, 0.3), ..own };
    assert!(world.clearance(elsewhere.position) > 0.4);
    let settings = TrialSettings { start: Some(elsewhere), ..short(20.0) };
    let trial = run(Trial::flat(&world, settings.clone()).expect("free"));
    let mut moved = world.clone();
    moved.start = Some(elsewhere);
    let expected = Reference::new(&moved, &settings.body).expect("a start");
    let scores = trial.score(&trial.reference(&world).expect("a start")).expect("scores");
    assert_eq!(scores, trial.score(&expected).expect("scores"));
    // The world has another start: an error, not a score.
    let wrong = trial.score(&Reference::new(&world, &settings.body).expect("a start"));
    assert!(matches!(wrong, Err(ScoreError::Reference { .. })), "{wrong:?}");
    // So is that of another robot, which drives faster.
    let body = Robot { max_speed: 1.0, ..settings.body.clone() };
    let wrong = trial.score(&Reference::new(&moved, &body).expect("a start"));
    assert_eq!(wrong, Err(ScoreError::OtherRobot));
    let charged = Robot { battery: 9000.0, ..settings.body };
    assert_eq!(trial.score(&Reference::new(&moved, &charged).expect("a start")), Ok(scores));
}

/// The flat simulator, driven backwards.
struct Backwards(FlatSimulator);

impl RobotBackend for Backwards {
    fn engine(&self) -> &str {
        "backwards"
    }

    fn observe(&mut self, robot: usize) -> Observation {
        self.0.observe(robot)
    }

    fn advance(&mut self, commands: &[Command]) {
        let back: Vec<_> =
            commands.iter().map(|c| Command { speed: -c.speed, turn_rate: c.turn_rate }).collect();
        self.0.advance(&back);
    }

    fn pose(&self, robot: usize) -> Pose {
        self.0.pose(robot)
    }

    fn condition(&self, robot: usize) -> Condition {
        self.0.condition(robot)
    }

    fn collisions(&self, robot: usize) -> u32 {
        self.0.collisions(robot)
    }
}

/// A trial of this backend.
fn backwards<'w>(world: &'w World, builder: TrialBuilder<'w>) -> Trial<Backwards> {
    let trial = builder.build(|setup, sensors| {
        let TrialSettings { body, laser, .. } = setup.settings;
        let flat = std::sync::Arc::new(crate::flat::FlatWorld::new(world, body).expect("a robot"));
        Backwards(FlatSimulator::with_sensors(flat, body, setup.starts, laser, sensors))
    });
    trial.expect("a trial")
}

#[test]
fn only_the_backend_knows_what_moves() {
    let spec = IndoorSpec { width: 5, height: 5, ..Default::default() };
    let world = spec.generate(Seed(3)).expect("a map").to_world();
    let doors = ScenarioSpec { doors: 1.0, ..Default::default() };
    let scenario = Scenario::new(&world, &doors, Seed(1)).expect("doors");
    let builder = Trial::builder(&world, short(1.0)).scenario(scenario).policy(|setup| {
        assert!(setup.scenario.is_none());
        Ahead { speed: 0.2, decisions: 0, breaks_after: u32::MAX }
    });
    let mut known = false;
    builder
        .build(|setup, sensors| {
            known = setup.scenario.is_some();
            let flat = FlatWorld::new(&world, &setup.settings.body).expect("a robot that fits");
            let TrialSettings { body, laser, .. } = setup.settings;
            FlatSimulator::with_sensors(flat.into(), body, setup.starts, laser, sensors)
        })
        .expect("a trial");
    assert!(known);
}

#[test]
fn a_replay_that_cannot_command_doors_is_an_error() {
    let spec = IndoorSpec { width: 5, height: 5, ..Default::default() };
    let world = spec.generate(Seed(3)).expect("a map").to_world();
    let doors = ScenarioSpec { doors: 1.0, ..Default::default() };
    let scenario = Scenario::new(&world, &doors, Seed(1)).expect("doors");
    let builder = Trial::builder(&world, short(3.0)).scenario(scenario);
    let mut trial = builder.build_flat().expect("a trial");
    for tick in 0..20 {
        if tick == 10 {
            trial.command_door(1, DoorCommand::Slam).expect("a door");
        }
        trial.step();
    }
    trial.stop();
    let log = trial.log();
    let mut again =
        log.replay_with(&world, |builder| Ok(backwards(&world, builder))).expect("its own world");
    let error = log.run_through(&mut again).expect_err("no doors").to_string();
    assert_eq!(
        error,
        "`door_commands[0].door` must be the index of a door that the robot backend `backwards` \
         commands, got 1"
    );
    assert_eq!(again.time(), 10.0 * TICK);
    let mut flat = log.replay_with(&world, TrialBuilder::build_flat).expect("its own world");
    assert_eq!(log.run_through(&mut flat), Ok(()));
    assert_eq!(flat.log(), log);
}

#[test]
fn bodies_of_ones_own_name_their_engine() {
    let world = hallway();
    let builder = Trial::builder(&world, short(2.0)).policy(ahead(0.3, u32::MAX));
    let trial = run(backwards(&world, builder));
    let (start, end) =
        (trial.trajectory(0).poses[0], trial.trajectory(0).poses.last().expect("poses"));
    assert!(envgen::geometry::unit_vector(start.heading).dot(end.position - start.position) < -0.2);
    assert_eq!(trial.log().engine, "backwards");
}
