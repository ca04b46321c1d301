//! Robots of any size pass gaps that are wider than they are and do not enter narrower ones: in plans,
//! in the flat simulator, and in the reference for scores. Robots and lasers that ship map worlds.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;

use envgen::geometry::{Pose, Rect};
use envgen::glam::DVec2;
use envgen::hallway::HallwaySpec;
use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec, World};
use mapping_trial::backend::{Command, RobotBackend};
use mapping_trial::flat::{FlatSimulator, FlatWorld};
use mapping_trial::lidar::LaserProfile;
use mapping_trial::mappable_area::MappableArea;
use mapping_trial::names::Named;
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::policy::costmap::{CellCost, Costmap};
use mapping_trial::policy::search::GridPlanner;
use mapping_trial::profile::named_or_read;
use mapping_trial::robot::{Footprint, LaserMount, Robot};
use mapping_trial::score::Scores;
use mapping_trial::trial::{EndReason, Trial, TrialSettings};

use crate::drive::{frame, rect, world_of};

/// Side of either room in metres.
const ROOM: f64 = 6.0;

/// A disc of a radius.
fn disc(radius: f64) -> Robot {
    Robot {
        length: 2.0 * radius,
        width: 2.0 * radius,
        circumscribed_radius: radius,
        footprint: Footprint::Disc,
        laser_offset: 0.0,
        ..Robot::default()
    }
}

/// Two rooms beside each other with a gap in the wall between them. The start is in the left room,
/// where the laser sees the gap.
fn rooms(gap: f64) -> World {
    let (wall, middle) = (0.1, 0.5 * ROOM);
    let mut walls: Vec<Rect> = frame(0.0, 0.0, 2.0 * ROOM, ROOM);
    walls.push(rect(ROOM - wall, 0.0, ROOM + wall, middle - 0.5 * gap));
    walls.push(rect(ROOM - wall, middle + 0.5 * gap, ROOM + wall, ROOM));
    let mut world = world_of(&walls);
    world.start = Some(Pose::new(0.5 * ROOM, middle, 0.0));
    world
}

/// Whether a plan on the map of a robot without errors leads into the right room.
fn plan_passes(robot: &Robot, gap: f64, limit: CellCost) -> bool {
    // A small robot maps both rooms, whatever the gap.
    let map = MappableArea::new(&rooms(gap), &disc(0.15)).expect("a start").perfect_map();
    let mut costmap = Costmap::new(robot);
    costmap.refresh(&map);
    let mut search = GridPlanner::new();
    search.set_worst_allowed(limit);
    let start = DVec2::new(0.5 * ROOM, 0.5 * ROOM);
    search.to(&mut costmap, start, &[], start + DVec2::X * ROOM).is_some()
}

/// Whether a disc that drives straight ahead gets through, and its number of collisions.
fn drive_passes(robot: &Robot, gap: f64) -> (bool, u32) {
    let world = rooms(gap);
    let flat = Arc::new(FlatWorld::new(&world, robot).expect("a robot"));
    let start = world.start.expect("a start");
    let (laser, odometry) = (LaserProfile::default(), OdometryProfile::EXACT);
    let mut bodies = FlatSimulator::new(flat, robot, &[start], &laser, &odometry, Seed(1));
    for _ in 0..300 {
        bodies.advance(&[Command { speed: 0.5, turn_rate: 0.0 }]);
    }
    (bodies.pose(0).position.x > ROOM + robot.circumscribed_radius, bodies.collisions(0))
}

/// Area in square metres that can be mapped by the reference.
fn mappable(robot: &Robot, gap: f64) -> f64 {
    MappableArea::new(&rooms(gap), robot).expect("a start").free_area()
}

#[test]
fn robots_pass_gaps_of_their_own_size_and_refuse_narrower_ones() {
    for radius in [0.2, 0.355, 0.8, 1.3] {
        let robot = disc(radius);
        // A plan keeps half a centimetre of distance, and knows walls to within a cell of 5 cm on
        // either side.
        let (wide, narrow) = (2.0 * radius + 0.15, 2.0 * radius - 0.15);
        assert!(plan_passes(&robot, wide, CellCost::Tight), "{radius}");
        assert!(!plan_passes(&robot, 2.0 * radius - 0.05, CellCost::Tight), "{radius}");
        assert!(!plan_passes(&robot, narrow - 0.05, CellCost::Squeeze), "{radius}");

        assert_eq!(drive_passes(&robot, 2.0 * radius + 0.02), (true, 0), "{radius}");
        assert_eq!(drive_passes(&robot, 2.0 * radius - 0.02), (false, 1), "{radius}");

        let (one, both) = (mappable(&robot, 2.0 * radius - 0.02), mappable(&robot, wide));
        assert!(both > 1.9 * one, "{radius}: {one} and {both} m^2");
    }
}

/// Runs a trial without errors of the wheels to its end, and returns it with its scores.
fn run(
    world: &World,
    body: Robot,
    laser: LaserProfile,
    time_limit: f64,
) -> (Trial<FlatSimulator>, Scores) {
    let odometry = OdometryProfile::EXACT;
    let settings = TrialSettings { body, laser, odometry, time_limit, ..TrialSettings::default() };
    let mut trial = Trial::flat(world, settings).expect("a free start");
    while trial.step() {}
    let scores = trial.score(&trial.reference(world).expect("a start")).expect("scores");
    (trial, scores)
}

/// Why the robot's part of a trial ended.
fn end(trial: &Trial<FlatSimulator>) -> Option<EndReason> {
    trial.end_of(0).map(|end| end.reason)
}

/// A whole trial uses one robot's numbers: to plan, drive, map and score.
#[test]
fn a_trial_ends_where_the_robot_no_longer_fits() {
    for radius in [0.2, 0.8] {
        let run = |gap: f64| {
            let (trial, scores) = run(&rooms(gap), disc(radius), LaserProfile::USARSIM, 400.0);
            let farthest = trial.trajectory(0).poses.iter().map(|pose| pose.position.x);
            (farthest.fold(0.0, f64::max), scores, end(&trial))
        };
        let (x, scores, end) = run(2.0 * radius + 0.4);
        assert!(x > ROOM, "{radius}: never left the first room: {x}");
        assert_eq!((end, scores.collisions), (Some(EndReason::Explored), 0), "{radius}");
        assert!(scores.coverage > 0.9 && scores.navigability > 0.9, "{radius}: {scores:?}");
        let (x, scores, _) = run(2.0 * radius - 0.2);
        assert!(x < ROOM, "{radius}: went through a gap that it does not fit into: {x}");
        assert!(scores.coverage > 0.9, "{radius}: what it could reach: {scores:?}");
    }
}

/// Robots that take minutes to turn around or to cross a room, and those that hardly brake, are slow, not stuck.
#[test]
fn slow_robots_explore_as_well() {
    let body = disc(0.3);
    for robot in [
        Robot { max_turn_rate: 0.1, ..body.clone() },
        Robot { max_turn_rate: 0.03, ..body.clone() },
        Robot { turn_acceleration: 0.02, ..body.clone() },
        Robot { max_speed: 0.03, ..body.clone() },
        Robot { acceleration: 0.05, ..body.clone() },
        Robot { max_speed: 0.03, max_turn_rate: 0.03, turn_acceleration: 0.02, ..body },
    ] {
        for gap in [1.0, 1.8] {
            let (trial, scores) = run(&rooms(gap), robot.clone(), LaserProfile::USARSIM, 7200.0);
            let hits = (end(&trial), scores.collisions, trial.recoveries(0));
            assert_eq!(hits, (Some(EndReason::Explored), 0, 0), "{robot:?}");
            assert!(scores.coverage > 0.9 && scores.navigability > 0.9, "{robot:?}: {scores:?}");
        }
    }
}

/// Lasers with one scan in 1 to 5 s, and lasers that look backwards.
/// Robots that need more than a metre to stop brake before curves and near walls.
#[test]
fn fast_robots_hardly_collide() {
    let mut collisions = 0;
    for seed in 1..=3 {
        let spec = IndoorSpec { width: 6, height: 6, ..Default::default() };
        let world = spec.generate(Seed(seed)).expect("a map").to_world();
        let body = Robot { max_speed: 3.0, acceleration: 2.0, ..Robot::default() };
        let settings = TrialSettings { body, seed: Seed(seed), ..Default::default() };
        let mut trial = Trial::flat(&world, settings).expect("a free start");
        while trial.step() {}
        let scores = trial.score(&trial.reference(&world).expect("a start")).expect("scores");
        assert!(scores.coverage > 0.95, "seed {seed}: {scores:?}");
        collisions += scores.collisions;
    }
    // 62 without braking for what is ahead.
    assert!(collisions <= 10, "{collisions}");
}

#[test]
fn slow_lasers_and_lasers_that_look_backwards_explore_as_well() {
    let backwards = LaserMount { heading: PI, ..LaserMount::default() };
    for (ticks_a_scan, laser_mount) in
        [(20, LaserMount::default()), (100, LaserMount::default()), (4, backwards)]
    {
        let body = Robot { laser_mount, ..disc(0.3) };
        let laser = LaserProfile { ticks_a_scan, ..LaserProfile::USARSIM };
        for gap in [1.2, 2.0] {
            let (trial, scores) = run(&rooms(gap), body.clone(), laser.clone(), 1200.0);
            let hits = (end(&trial), scores.collisions);
            assert_eq!(hits, (Some(EndReason::Explored), 0), "{ticks_a_scan}");
            assert!(scores.coverage > 0.9, "{ticks_a_scan}: {scores:?}");
        }
    }
}

/// The first scan of this map shows no frontier that can be reached, and the next one comes after 6 or 10 s.
#[test]
fn slow_lasers_look_all_around_before_anything_ends() {
    let spec = IndoorSpec { width: 5, height: 5, ..Default::default() };
    let world = spec.generate(Seed(3)).expect("a plan").to_world();
    // With one scan in 10 s, a robot may get lost later.
    for (ticks_a_scan, least) in [(120, 0.9), (200, 0.5)] {
        let laser = LaserProfile { ticks_a_scan, ..LaserProfile::USARSIM };
        let (_, scores) = run(&world, Robot::default(), laser, 1200.0);
        assert!(scores.coverage > least, "{ticks_a_scan}: {scores:?}");
    }
}

/// The robots in `assets/robots` are valid, and each of them maps a hallway with few collisions.
#[test]
fn the_robots_that_ship_can_be_driven() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots");
    let mut names = Vec::new();
    for entry in folder.read_dir().expect("the folder of robots") {
        let path = entry.expect("an entry").path();
        let text = std::fs::read_to_string(&path).expect("a file");
        let robot = Robot::from_ron(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        // The corridor is as wide for a large robot as it is for the Pioneer.
        let larger = (robot.circumscribed_radius / 0.355).max(1.0);
        let (pitch, width) = (5.0 * larger, 2.0 * larger);
        let spec = HallwaySpec { segments: 4, pitch, width, ..Default::default() };
        let world = spec.generate(Seed(7)).expect("a hall").to_world();
        let settings =
            TrialSettings { body: robot.clone(), time_limit: 200.0, ..Default::default() };
        let mut trial = Trial::flat(&world, settings).expect("a free start");
        while trial.step() {}
        let scores = trial.score(&trial.reference(&world).expect("a start")).expect("scores");
        assert!(scores.coverage > 0.5 && scores.stuck == 0, "{}: {scores:?}", path.display());
        assert!(scores.collisions <= 2, "{}: {scores:?}", path.display());
        names.push(path.file_stem().expect("a name").to_string_lossy().into_owned());
    }
    names.sort();
    let shipped = ["clearpath_jackal", "mir600", "pioneer_3at", "pioneer_3dx", "turtlebot3_waffle"];
    assert_eq!(names, shipped);
    let pioneer = std::fs::read_to_string(folder.join("pioneer_3at.ron")).expect("a file");
    assert_eq!(Robot::from_ron(&pioneer), Ok(Robot::default()));
}

/// The lasers in `assets/lasers`, which look all around, map rooms.
#[test]
fn the_lasers_that_ship_map_rooms() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/lasers");
    let spec = IndoorSpec { width: 5, height: 5, ..Default::default() };
    let world = spec.generate(Seed(3)).expect("a map").to_world();
    let mut names = Vec::new();
    for entry in folder.read_dir().expect("the folder of lasers") {
        let path = entry.expect("an entry").path();
        let laser: LaserProfile =
            named_or_read(&path.to_string_lossy()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((laser.beams, laser.name()), (360, None), "{}", path.display());
        let settings = TrialSettings { laser, ..Default::default() };
        let mut trial = Trial::flat(&world, settings).expect("a free start");
        while trial.step() {}
        let scores = trial.score(&trial.reference(&world).expect("a start")).expect("scores");
        assert!(scores.coverage > 0.9, "{}: {scores:?}", path.display());
        assert!(scores.trajectory_error < 0.2, "{}: {scores:?}", path.display());
        names.push(path.file_stem().expect("a name").to_string_lossy().into_owned());
    }
    names.sort();
    assert_eq!(names, ["lds_01", "rplidar_a1"]);
}
