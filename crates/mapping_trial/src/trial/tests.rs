use std::sync::Arc;

use envgen::geometry::Pose;
use envgen::hallway::HallwaySpec;
use envgen::indoor::IndoorSpec;
use envgen::scenario::{DoorControl, Scenario, ScenarioSpec, ScenarioState};
use envgen::{Blueprint, Seed, Spec, World};
use glam::DVec2;

use super::*;
use crate::backend::Command;
use crate::flat::{FlatSimulator, FlatWorld};
use crate::robot::Robot;
use crate::score::Reference;
use crate::slam::SlamKind;

fn hallway() -> World {
    HallwaySpec { segments: 4, ..Default::default() }.generate(Seed(7)).expect("a hall").to_world()
}

fn short(time_limit: f64) -> TrialSettings {
    TrialSettings { time_limit, ..TrialSettings::default() }
}

fn run(world: &World, settings: TrialSettings) -> Trial<FlatSimulator> {
    let mut trial = Trial::flat(world, settings).expect("a trial");
    while trial.step() {}
    trial
}

#[test]
fn an_index_of_another_world_or_robot_is_refused() {
    let (world, settings) = (hallway(), short(1.0));
    let build = |world: &World, settings: TrialSettings, flat: &Arc<FlatWorld>| {
        Trial::builder(world, settings).build_flat_in(Arc::clone(flat)).map(|_| ())
    };
    let flat = Arc::new(FlatWorld::new(&world, &settings.body).expect("a robot"));
    assert_eq!(build(&world, settings.clone(), &flat), Ok(()));
    // Without its walls, a robot would drive through them.
    let mut empty = world.clone();
    empty.walls.clear();
    let (expected, found) = (empty.digest().to_string(), world.digest().to_string());
    let refused = Err(TrialError::OtherFlatWorld { expected, found });
    assert_eq!(build(&empty, settings.clone(), &flat), refused);
    let mut other = settings.clone();
    other.body.laser_mount.height = 0.2;
    let error = build(&world, other, &flat).expect_err("another laser").to_string();
    let expected =
        "`body.laser_mount.height` must be 0.45, got 0.2: the world was indexed for such robots";
    assert_eq!(error, expected);
    // A smaller robot does not see the difference.
    let mut small = settings;
    small.body = Robot { length: 0.3, width: 0.3, circumscribed_radius: 0.25, ..small.body };
    let own = Arc::new(FlatWorld::new(&world, &small.body).expect("a robot"));
    let [shared, own] = [flat, own].map(|flat| {
        let mut trial = Trial::builder(&world, small.clone()).build_flat_in(flat).expect("a trial");
        while trial.step() {}
        trial.log().digest()
    });
    assert_eq!(shared, own);
}

/// What must be the same after a replay.
fn state(trial: &Trial<FlatSimulator>) -> impl PartialEq + std::fmt::Debug + use<> {
    let robots = 0..trial.robots();
    let tracks: Vec<_> = robots
        .map(|robot| {
            let slam = trial.autonomy().slam();
            let known = (trial.end_of(robot), trial.recoveries(robot), slam.trajectory(robot));
            (trial.trajectory(robot).clone(), known)
        })
        .collect();
    let map = trial.autonomy().slam().map();
    let tiles: Vec<_> =
        map.changed_since(0).map(|(col, row)| map.tile(col, row).map(<[_]>::to_vec)).collect();
    (tracks, tiles, trial.time())
}

#[test]
fn a_trial_runs_again_from_its_log() {
    let indoor = IndoorSpec::default().generate(Seed(3)).expect("a map").to_world();
    for (world, settings) in [
        (hallway(), short(60.0)),
        (hallway(), TrialSettings { slam: SlamKind::DeadReckoning, ..short(1200.0) }),
        (indoor, TrialSettings { robots: 2, ..short(90.0) }),
    ] {
        let trial = run(&world, settings);
        let log = trial.log();
        let mut bytes = Vec::new();
        log.write(&mut bytes).expect("memory takes all");
        let read = TrialLog::read(&mut &bytes[..]).expect("its own log");
        assert_eq!(read, log);
        let again = read.replay().expect("its own world");
        assert!(again.is_over());
        assert_eq!(state(&again), state(&trial));
        assert_eq!(again.log().digest(), log.digest());
    }
}

#[test]
fn a_log_of_half_a_trial_runs_to_where_it_stood() {
    let mut trial = Trial::flat(&hallway(), short(60.0)).expect("a trial");
    for _ in 0..200 {
        assert!(trial.step());
    }
    let again = trial.log().replay().expect("its own world");
    assert!(!again.is_over());
    assert_eq!(state(&again), state(&trial));
}

#[test]
fn a_person_drives_and_stops() {
    let settings = TrialSettings { policy: None, ..short(60.0) };
    let mut trial = Trial::flat(&hallway(), settings).expect("a trial");
    for tick in 0..200 {
        let turn_rate = if tick > 100 { 0.3 } else { 0.0 };
        assert!(trial.step_with(&[Command { speed: 0.3, turn_rate }]));
    }
    trial.stop();
    assert!(!trial.step_with(&[Command::STOP]));
    let end = RobotEnd { reason: EndReason::Stopped, tick: 200 };
    assert_eq!(trial.end_of(0), Some(end));
    assert!(trial.trajectory(0).distance > 2.0);
    let again = trial.log().replay().expect("its own world");
    assert_eq!(state(&again), state(&trial));
}

#[test]
fn the_clock_and_the_battery_end_a_trial() {
    let end = |settings| {
        let trial = run(&hallway(), settings);
        (trial.end_of(0).map(|end| end.reason), trial.time())
    };
    assert_eq!(end(short(3.0)), (Some(EndReason::TimeLimit), 3.0));
    let mut settings = short(3.0);
    settings.body.battery = 2.0;
    assert_eq!(end(settings), (Some(EndReason::Battery), 2.0));
}

#[test]
fn the_area_that_limits_the_time_is_that_of_the_robot() {
    let world = hallway();
    let settings = TrialSettings { time_per_area: Some(60.0), ..short(60.0) };
    let limit =
        |builder: &mut TrialBuilder<'_>| builder.setup().expect("a start").settings.time_limit;
    let narrow = Robot { circumscribed_radius: 0.25, length: 0.44, width: 0.2, ..Robot::default() };
    let mut builder = TrialBuilder::new(&world, settings.clone());
    let usual = limit(&mut builder);
    assert_eq!(limit(&mut builder), usual);
    let mut changed = builder.settings(|settings| settings.body = narrow.clone());
    let fresh = TrialSettings { body: narrow, ..settings };
    assert_eq!(limit(&mut changed), limit(&mut TrialBuilder::new(&world, fresh)));
    assert!(limit(&mut changed) > usual, "{usual}");
}

#[test]
fn exact_wheels_have_no_trajectory_error() {
    let world = hallway();
    let settings = TrialSettings {
        slam: SlamKind::DeadReckoning,
        odometry: crate::odometry::OdometryProfile::EXACT,
        policy: None,
        ..short(60.0)
    };
    let truth = Reference::new(&world, &settings.body).expect("a start");
    let mut trial = Trial::flat(&world, settings).expect("a trial");
    for tick in 0..400 {
        let turn_rate = if (tick + 20) / 40 % 2 == 0 { 0.4 } else { -0.4 };
        assert!(trial.step_with(&[Command { speed: 0.25, turn_rate }]));
    }
    trial.stop();
    let scores = trial.score(&truth).expect("scores");
    assert_eq!((scores.collisions, scores.distance), (0, trial.trajectory(0).distance));
    assert!(scores.distance > 4.0 && scores.turning > 4.0, "{scores:?}");
    assert!(scores.trajectory_error < 1e-9, "{}", scores.trajectory_error);
    // A replay has the same scores, to the bit.
    let again = trial.log().replay().expect("its own world");
    assert_eq!(again.score(&truth), Ok(scores));
}

#[test]
fn noise_seeds_differ_and_nothing_else_does() {
    let run = |seed| {
        let settings = TrialSettings { seed: Seed(seed), ..short(20.0) };
        run(&hallway(), settings).log().digest()
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn bad_worlds_and_starts_are_reported() {
    let mut world = hallway();
    let begin = |world: &World, settings| {
        Trial::flat(world, settings).map(|_| ()).expect_err("not allowed").to_string()
    };
    let outside = Some(Pose::new(f64::NAN, 0.0, 0.0));
    assert!(begin(&world, TrialSettings { start: outside, ..short(9.0) }).contains("start.x"));
    let wall = Some(Pose::new(1.0, 0.5, 0.0));
    assert!(begin(&world, TrialSettings { start: wall, ..short(9.0) }).contains("nearest solid"));
    let far = Some(Pose::new(-500.0, 0.0, 0.0));
    assert!(begin(&world, TrialSettings { start: far, ..short(9.0) }).contains("outside"));
    world.start = None;
    assert!(begin(&world, short(9.0)).contains("no start"));
}

#[test]
fn robots_start_off_the_leaves_of_doors() {
    let world = IndoorSpec { width: 6, height: 6, ..Default::default() }.generate(Seed(3));
    let world = world.expect("a map").to_world();
    let door_control = DoorControl::Triggered;
    let doors = ScenarioSpec { doors: 1.0, door_control, ..Default::default() };
    let scenario = Scenario::new(&world, &doors, Seed(3)).expect("doors");
    let state = ScenarioState::new(&world, &scenario).expect("doors");
    let build = |start: Pose, robots: u32| {
        let settings = TrialSettings { start: Some(start), robots, ..short(1.0) };
        Trial::builder(&world, settings).scenario(scenario.clone()).build_flat()
    };
    // In a doorway with a closed leaf, and beside it.
    let middle = state.doorway_middle(0);
    let at = |position| Pose { position, heading: 0.0 };
    let error = build(at(middle), 1).err().expect("the leaf is there").to_string();
    assert!(error.contains("0.000 m from a leaf of door 0"), "{error}");
    let free = |position: &DVec2| {
        let robot = Robot::default();
        let touches = state.all_leaves().any(|leaf| {
            leaf.nearest_point(*position).distance(*position) < robot.circumscribed_radius
        });
        world.clearance(*position) > robot.circumscribed_radius && !touches
    };
    let offsets = [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y].map(|along| middle + 0.5 * along);
    let beside = offsets.into_iter().find(free).expect("free ground");
    let trial = build(at(beside), 8).expect("room for eight");
    assert!((0..8).all(|robot| free(&trial.trajectory(robot).poses[0].position)));
}

#[test]
fn bad_logs_are_reported() {
    let log = run(&hallway(), short(2.0)).log();
    let text = serde_json::to_string(&log).expect("a log");
    let error =
        |text: &str| TrialLog::read(&mut text.as_bytes()).expect_err("not a log").to_string();
    assert!(error("").contains("not a trial log"));
    assert!(error(&text[..text.len() / 2]).contains("not a trial log"));
    let other = error(&text.replacen("\"version\":3", "\"version\":7", 1));
    assert_eq!(other, "a log of version 7, expected version 3");
    let robots = error(&text.replacen("\"robots\":1", "\"robots\":2", 1));
    assert_eq!(robots, "`commands` must be 2, one per robot, got 1");
    let mut value: serde_json::Value = serde_json::from_str(&text).expect("a log");
    value["commands"][0][0][2] = u64::MAX.into();
    assert!(error(&value.to_string()).contains("`commands`"));
    // More than a day.
    value["commands"][0] = serde_json::json!([[0.0, 0.0, 1_728_002]]);
    assert!(error(&value.to_string()).contains("at most 1728001 ticks"), "{value}");

    let written = |log: &TrialLog| serde_json::to_string(log).expect("a log");
    let mut timeless = log.clone();
    timeless.settings.time_limit = -1.0;
    let reported = error(&written(&timeless));
    assert!(reported.starts_with("the log's settings: `time_limit` must be"), "{reported}");
    let mut world = hallway();
    world.bounds.max = world.bounds.min;
    let mut broken = log.clone();
    broken.world = LogWorld::Given(Box::new(world));
    let reported = error(&written(&broken));
    assert!(reported.starts_with("the log's world is broken: the bounds"), "{reported}");

    let mut late = log.clone();
    late.ends = vec![Some(RobotEnd { reason: EndReason::Explored, tick: 41 })];
    assert_eq!(
        error(&written(&late)),
        "`ends` must be in tick 40 at the latest, got one in tick 41"
    );

    let mut moved = log.clone();
    moved.world_digest = "0".repeat(64);
    let reported = moved.replay().map(|_| ()).expect_err("another world").to_string();
    assert!(reported.contains("digest 000"), "{reported}");
}

#[test]
fn counts_of_a_log_that_are_too_large_stop_no_score() {
    let world = hallway();
    let mut log = run(&world, TrialSettings { robots: 2, ..short(2.0) }).log();
    log.recoveries = vec![u32::MAX, 2];
    let again = log.replay().expect("its own world");
    let scores = again.score(&again.reference(&world).expect("a start")).expect("scores");
    assert_eq!(scores.recoveries, u32::MAX);
}

/// A world's provenance may be of another version, or claim a spec that is dear to generate.
#[test]
fn only_worlds_that_their_spec_makes_are_generated_again() {
    let world = hallway();
    assert!(matches!(LogWorld::of(&world), LogWorld::Generated(_)));
    let mut older = world.clone();
    older.provenance.value_version += 1;
    let mut larger = world;
    larger.provenance.spec["segments"] = 100_000.into();
    for world in [older, larger] {
        assert_eq!(LogWorld::of(&world), LogWorld::Given(Box::new(world)));
    }
}

#[test]
fn a_time_limit_by_area_follows_what_can_be_mapped() {
    let world = hallway();
    let limits = |time_per_area| {
        let settings = TrialSettings { time_per_area: Some(time_per_area), ..short(1.0) };
        let trial = Trial::flat(&world, settings).expect("a free start");
        let area = trial.reference(&world).expect("a reference").free_area();
        (trial.settings().clone(), area)
    };
    let (least, _) = limits(0.01);
    assert_eq!((least.time_limit, least.body.battery), (MIN_TIME_BY_AREA, 1200.0));
    let (long, area) = limits(100.0);
    assert!(area > 15.0);
    assert_eq!(long.time_limit.to_bits(), (100.0 * area).to_bits());
    assert_eq!(long.body.battery, long.time_limit);
    let bad = TrialSettings { time_per_area: Some(-1.0), ..short(1.0) };
    let error = Trial::flat(&world, bad).map(|_| ()).expect_err("not allowed").to_string();
    assert!(error.contains("`time_per_area` must be a number from 0.01"), "{error}");
}
