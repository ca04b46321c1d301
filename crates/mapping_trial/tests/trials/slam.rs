//! Properties of every estimator: it accepts any input, repeats to the last bit, and robots share a map.

use envgen::geometry::Pose;
use envgen::glam::DVec2;
use envgen::raycast::Raycaster;
use envgen::{Seed, World};
use mapping_trial::backend::Observation;
use mapping_trial::lidar::{Laser, LaserProfile, LaserSensor, Scan};
use mapping_trial::map::{Cell, CellIndex, OccupancyMap};
use mapping_trial::odometry::{Increment, Odometry, OdometryProfile, WheelSensor};
use mapping_trial::robot::Robot;
use mapping_trial::slam::{Slam, SlamKind, WheelCalibration};
use proptest::prelude::*;

use crate::drive::{Drive, frame, rect, world_of};
use crate::slam_bands::{around, corridor_loop};

fn room() -> World {
    let mut walls = frame(0.0, 0.0, 12.0, 9.0);
    walls.extend([rect(5.0, 4.0, 5.4, 9.0), rect(8.0, 2.0, 8.5, 2.5)]);
    world_of(&walls)
}

/// FNV-1a digest of the cells of a map, ordered by their positions, and of the poses of a robot.
fn digest(slam: &dyn Slam) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut feed = |word: u64| {
        for byte in word.to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    for pose in slam.trajectory(0) {
        [pose.position.x, pose.position.y, pose.heading].iter().for_each(|x| feed(x.to_bits()));
    }
    let estimate = slam.estimate(0);
    [estimate.deviation, estimate.heading_deviation].iter().for_each(|x| feed(x.to_bits()));
    let mut tiles: Vec<_> = slam.map().changed_since(0).collect();
    tiles.sort_unstable();
    for (col, row) in tiles {
        for &odds in slam.map().tile(col, row).into_iter().flatten() {
            feed(odds as u64);
        }
    }
    hash
}

#[test]
fn golden() {
    let mut walls = frame(0.0, 0.0, 30.0, 20.0);
    walls.push(rect(2.0, 2.0, 28.0, 18.0));
    let path = [(4.0, 1.0), (29.0, 1.0), (29.0, 19.0), (1.0, 19.0), (1.0, 1.0), (20.0, 1.0)];
    let path = path.map(|(x, y)| DVec2::new(x, y));
    let drive = Drive::new(&world_of(&walls), &path, &LaserProfile::LMS200_MM_ROUGH);
    let recording = drive.record(&OdometryProfile::SKID, 7);
    let found = SlamKind::ALL.map(|kind| digest(&*recording.replay(kind)));
    // A change here changes every trial, so it must be intended.
    assert_eq!(found, GOLDEN, "{found:#x?}");
}

const GOLDEN: [u64; 3] = [0xe8b4_b174_b646_58c5, 0x639f_2211_4820_cb52, 0x639f_2211_4820_cb52];

/// The drive above closes no loop, so that both estimators give the same. This one comes back after 400
/// m.
#[test]
fn golden_of_a_closed_loop() {
    let walls = corridor_loop(120.0, 80.0, true);
    let path = around(120.0, 80.0, 20.0);
    let drive = Drive::new(&world_of(&walls), &path, &LaserProfile::LMS200_MM);
    let recording = drive.record(&OdometryProfile::SKID, CLOSES);
    let kinds = [SlamKind::ScanToMap, SlamKind::PoseGraph];
    let found = kinds.map(|kind| digest(&*recording.replay(kind)));
    assert_ne!(found[0], found[1], "no loop is closed");
    assert_eq!(found, GOLDEN_LOOP, "{found:#x?}");
}

/// A seed of the wheels and the laser for which the pose graph closes the loop.
const CLOSES: u64 = 6;

const GOLDEN_LOOP: [u64; 2] = [0xf125_d7ab_2f1e_ee0f, 0xa5bd_bf07_306f_71d7];

#[test]
fn kinds_are_named_in_files() {
    let names = SlamKind::ALL.map(|kind| serde_json::to_string(&kind).expect("a name"));
    assert_eq!(names, ["\"dead_reckoning\"", "\"scan_to_map\"", "\"pose_graph\""]);
}

/// Fraction of the free cells of a map that are free in the world, and the number of free cells.
fn free_cells(map: &OccupancyMap, world: &World) -> (f64, usize) {
    let (mut all, mut right) = (0, 0);
    for row in 0..180 {
        for col in 0..240 {
            let index = CellIndex { col, row };
            if map.cell(index) == Cell::Free {
                all += 1;
                right += usize::from(world.clearance(index.centre()) > 0.0);
            }
        }
    }
    (f64::from(right as u32) / f64::from(all), all as usize)
}

#[test]
fn robots_share_one_map() {
    let world = room();
    let rays = Raycaster::new(&world);
    let robot = Robot::default();
    let laser = LaserProfile::LMS200_MM;
    let fan = laser.fan().expect("a laser");
    let starts = [Pose::new(2.0, 7.0, -1.5), Pose::new(10.0, 7.0, -1.5)];
    for kind in SlamKind::ALL {
        let mut slam =
            kind.build(&starts, &robot, &LaserProfile::LMS200_MM, WheelCalibration::default());
        let mut poses = starts;
        let mut wheels = [0, 1].map(|i| Odometry::new(OdometryProfile::MILD, Seed(4), i));
        let mut lasers = [0, 1].map(|i| Laser::new(LaserProfile::LMS200_MM, Seed(4), i));
        let mut exact = Vec::new();
        for tick in 0..200 {
            for i in 0..2 {
                let motion = if tick == 0 {
                    Increment::default()
                } else {
                    Increment { distance: 0.02, turn: [0.004, -0.004][i] }
                };
                poses[i].heading += motion.turn;
                poses[i].position +=
                    envgen::geometry::unit_vector(poses[i].heading) * motion.distance;
                let scan = (tick % 4 == 0).then(|| {
                    let from = robot.laser_pose(poses[i]);
                    rays.scan(from, &fan, laser.max_range, &mut exact);
                    lasers[i].measure(&exact)
                });
                slam.step(i, &seen(wheels[i].measure(motion, 1.0), scan));
            }
            if tick == 0 {
                assert!(free_cells(slam.map(), &world).1 > 1000, "{kind:?} sees no free cell");
            }
        }
        for (i, pose) in poses.iter().enumerate() {
            let off = slam.estimate(i).pose.position.distance(pose.position);
            assert!(off < 0.15, "{kind:?}: robot {i} is off by {off} m");
            assert!(slam.estimate(i).deviation > 0.0);
            assert_eq!(slam.trajectory(i).len(), 201);
        }
        // Because of the wall between them, each robot alone would see only its own half.
        let (right, count) = free_cells(slam.map(), &world);
        assert!(right > 0.99 && count > 25_000, "{kind:?}: {right} of {count}");
        // Robots that do not exist change nothing.
        let revision = slam.map().revision();
        slam.step(9, &seen(Increment::default(), Some(Scan { ranges: vec![1.0; 181] })));
        assert!(slam.trajectory(9).is_empty() && slam.map().revision() == revision);
    }
}

/// In a hall whose walls are out of sight for most of the path, the error is corrected where they come
/// into sight again.
#[test]
fn walls_are_found_again_after_a_path_on_the_wheels() {
    let world = world_of(&frame(0.0, 0.0, 30.0, 30.0));
    let path = [(4.0, 4.0), (14.0, 14.0), (16.0, 12.0), (4.0, 4.0)];
    let path: Vec<DVec2> = path.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
    let drive = Drive::new(&world, &path, &LaserProfile::LMS200_MM);
    let median = |kind: SlamKind| {
        let end = |seed| {
            let slam = drive.record(&OdometryProfile::SKID, seed).replay(kind);
            slam.estimate(0).pose.position.distance(path[0])
        };
        let mut off: Vec<f64> = (0..15).map(end).collect();
        off.sort_by(f64::total_cmp);
        off[7]
    };
    let (lost, found) = (median(SlamKind::DeadReckoning), median(SlamKind::ScanToMap));
    assert!(lost > 1.0 && found < 0.2, "{lost} m on the wheels, {found} m with walls");
}

/// The world has a room with pillars, where walls hold the pose, and then a bare corridor, where the
/// wheels alone measure the distance. The wheels measure 4 % too much. What is learned in the room is
/// used in the corridor.
#[test]
fn what_the_wheels_measure_too_long_is_learned_in_a_room_and_used_in_a_corridor() {
    let mut walls = vec![
        rect(-0.2, -0.2, 40.2, 0.0),
        rect(-0.2, 0.0, 0.0, 8.2),
        rect(0.0, 8.0, 8.2, 8.2),
        rect(8.0, 2.0, 8.2, 8.0),
        rect(8.2, 2.0, 40.2, 2.2),
        rect(40.0, 0.0, 40.2, 2.0),
    ];
    walls.extend(
        [(2.4, 2.4), (5.2, 2.6), (2.5, 5.3), (5.3, 5.4)].map(|(x, y)| rect(x, y, x + 0.4, y + 0.4)),
    );
    let world = world_of(&walls);
    let around = [(1.0, 1.0), (7.0, 1.2), (7.0, 7.0), (1.2, 7.0)];
    let path = [&around[..], &around, &[(1.2, 1.0), (34.0, 1.0)]].concat();
    let path: Vec<DVec2> = path.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
    let drive = Drive::new(&world, &path, &LaserProfile::URG_04LX);
    let median = |kind: SlamKind, calibration| {
        let end = |seed| {
            let profile = OdometryProfile { b_s: 0.0, ..OdometryProfile::SKID };
            let mut recording = drive.record(&profile, seed);
            recording.steps.iter_mut().for_each(|seen| seen.odometry.distance *= 1.04);
            let slam = recording.replay_with(kind, calibration);
            slam.estimate(0).pose.position.distance(path[path.len() - 1])
        };
        let mut off: Vec<f64> = (0..5).map(end).collect();
        off.sort_by(f64::total_cmp);
        off[2]
    };
    for kind in [SlamKind::ScanToMap, SlamKind::PoseGraph] {
        let turns = median(kind, WheelCalibration::Turns);
        let both = median(kind, WheelCalibration::TurnsAndDistances);
        assert!(turns > 0.7 && both < 0.4 * turns, "{kind:?}: {turns} m, {both} m with distances");
    }
}

#[test]
fn cells_decay_to_free_when_what_stood_there_is_gone() {
    // By the wheels the robot drives to and fro, so that each keyframe draws again.
    let scan = |range: f64| Scan { ranges: vec![range; 181] };
    let mut slam = SlamKind::DeadReckoning.build(
        &[Pose::default()],
        &Robot::default(),
        &LaserProfile::LMS200_MM,
        WheelCalibration::default(),
    );
    let ahead = CellIndex::of(DVec2::new(2.21, 0.0));
    for i in 0..8 {
        let turn = if i % 2 == 0 { 0.3 } else { -0.3 };
        slam.step(0, &seen(Increment { distance: 0.0, turn }, Some(scan(2.0))));
    }
    assert_eq!(slam.map().cell(ahead), Cell::Occupied);
    for i in 0..40 {
        let turn = if i % 2 == 0 { 0.3 } else { -0.3 };
        slam.step(0, &seen(Increment { distance: 0.0, turn }, Some(scan(f64::INFINITY))));
    }
    assert_eq!(slam.map().cell(ahead), Cell::Free);
}

/// What a robot measured in a tick.
fn seen(odometry: Increment, scan: Option<Scan>) -> Observation {
    Observation { odometry, scan, ..Observation::default() }
}

fn anything() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>(), -1.0..1.0_f64, Just(f64::NAN), Just(f64::INFINITY), Just(1e300)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn nothing_panics(
        start in (anything(), anything(), anything()),
        steps in proptest::collection::vec(
            ((anything(), anything()), proptest::collection::vec(
                prop_oneof![4 => 0.0..9.0_f64, 1 => anything()], 0..190,
            )),
            1..12,
        ),
        max_range in prop_oneof![Just(8.19), anything()],
    ) {
        let laser = LaserProfile { max_range, ..LaserProfile::LMS200_MM };
        for kind in SlamKind::ALL {
            let start = Pose::new(start.0, start.1, start.2);
            let mut slam = kind.build(&[start], &Robot::default(), &laser, WheelCalibration::default());
            for ((distance, turn), ranges) in &steps {
                let odometry = Increment { distance: *distance, turn: *turn };
                slam.step(0, &seen(odometry, Some(Scan { ranges: ranges.clone() })));
                let estimate = slam.estimate(0);
                prop_assert!(estimate.pose.position.is_finite() && estimate.pose.heading.is_finite());
                prop_assert!(estimate.deviation >= 0.0 && estimate.heading_deviation >= 0.0);
            }
            prop_assert_eq!(slam.trajectory(0).len(), steps.len() + 1);
            let bounds = slam.map().bounds();
            prop_assert!(bounds.is_none_or(|bounds| bounds.size().max_element() < 7000.0));
        }
    }
}
