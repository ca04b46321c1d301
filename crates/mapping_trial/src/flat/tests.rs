use std::f64::consts::PI;

use envgen::geometry::{Rect, Shape};
use envgen::scenario::{Person, Reaction, Scenario, ScenarioSpec};
use envgen::world::{Surface, SurfaceKind, Wall, WallKind};
use envgen::{Blueprint, Provenance, Spec};
use proptest::prelude::*;

use super::*;

fn room(width: f64, height: f64) -> World {
    let bounds = Rect::new(DVec2::ZERO, DVec2::new(width, height));
    let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
    let corners = Shape::from_rect(bounds).corners();
    world.walls = envgen::geometry::edges(&corners)
        .map(|(a, b)| Wall::new(WallKind::Wall, Shape::Segment { a, b }))
        .collect();
    world
}

#[test]
fn a_world_is_indexed_for_robots_that_there_can_be() {
    for circumscribed_radius in [f64::NAN, -1.0, 0.0, 50.0] {
        let robot = Robot { circumscribed_radius, ..Robot::default() };
        let error = FlatWorld::new(&room(5.0, 5.0), &robot).expect_err("no robot").to_string();
        assert!(error.contains("`body.circumscribed_radius` must be"), "{error}");
    }
}

#[test]
#[should_panic(
    expected = "`body.circumscribed_radius` must be at most 0.355, got 1: the world was indexed"
)]
fn a_robot_that_is_too_large_for_the_index_does_not_start() {
    let flat = Arc::new(FlatWorld::new(&room(5.0, 5.0), &Robot::default()).expect("a robot"));
    let large = Robot { circumscribed_radius: 1.0, ..Robot::default() };
    let (laser, odometry) = (LaserProfile::USARSIM, OdometryProfile::EXACT);
    FlatSimulator::new(flat, &large, &[Pose::new(2.5, 2.5, 0.0)], &laser, &odometry, Seed(1));
}

proptest! {
    #[test]
    fn a_world_serves_robots_that_are_not_larger_and_as_high(
        one in (0.1..2.0_f64, 0.1..1.0_f64, 0.1..1.0_f64),
        other in (0.1..2.0_f64, 0.1..1.0_f64, 0.1..1.0_f64),
        as_high: bool, same_laser: bool,
    ) {
        let robot = |(circumscribed_radius, height, laser): (f64, f64, f64)| {
            let mut robot = Robot { circumscribed_radius, height, ..Robot::default() };
            (robot.length, robot.width, robot.laser_offset) = (0.05, 0.05, 0.0);
            robot.laser_mount.height = laser;
            robot
        };
        let known = robot(one);
        let height = if as_high { one.1 } else { other.1 };
        let laser = if same_laser { one.2 } else { other.2 };
        let new = robot((other.0, height, laser));
        let flat = FlatWorld::new(&room(5.0, 5.0), &known).expect("a robot");
        prop_assert_eq!(flat.check_robot(&known), Ok(()));
        let serves = other.0 <= one.0 && laser == one.2 && height.max(laser) == one.1.max(one.2);
        let found = flat.check_robot(&new);
        prop_assert_eq!(found.is_ok(), serves, "{:?}", found);
        if let Err(error) = found {
            // What it asks for is allowed.
            let mut asked = new;
            let SpecError { field, allowed, .. } = &error;
            prop_assert!(allowed.ends_with(": the world was indexed for such robots"), "{}", error);
            match field.as_str() {
                "body.circumscribed_radius" => asked.circumscribed_radius = one.0,
                "body.laser_mount.height" => asked.laser_mount.height = one.2,
                "body.height" => asked.height = one.1.max(one.2),
                _ => prop_assert!(false, "{}", error),
            }
            let next = flat.check_robot(&asked).err();
            prop_assert!(next.is_none_or(|next| next.field != *field));
        }
    }
}

fn simulator(world: &World, starts: &[Pose]) -> FlatSimulator {
    let robot = Robot::default();
    let flat = Arc::new(FlatWorld::new(world, &robot).expect("a robot"));
    let (laser, odometry) = (LaserProfile::USARSIM, OdometryProfile::EXACT);
    FlatSimulator::new(flat, &robot, starts, &laser, &odometry, Seed(1))
}

fn drive(bodies: &mut FlatSimulator, command: Command, seconds: f64) -> Increment {
    let mut total = Increment::default();
    for _ in 0..(seconds / TICK).round() as u32 {
        bodies.advance(&[command]);
        let seen = bodies.observe(0);
        total.distance += seen.odometry.distance;
        total.turn += seen.odometry.turn;
    }
    total
}

#[test]
fn a_free_robot_drives_as_its_wheels_say() {
    let mut bodies = simulator(&room(20.0, 20.0), &[Pose::new(5.0, 10.0, 0.0)]);
    let command = Command { speed: 0.5, turn_rate: 0.0 };
    let driven = drive(&mut bodies, command, 10.0);
    // It takes one second to reach 0.5 m/s at 0.5 m/s^2.
    let expected = 0.5 * 10.0 - 0.25;
    assert!((driven.distance - expected).abs() < 0.03, "{}", driven.distance);
    assert!((bodies.pose(0).position.x - 5.0 - driven.distance).abs() < 1e-9);
    assert_eq!(bodies.collisions(0), 0);
    let turned = drive(&mut bodies, Command { speed: 0.0, turn_rate: 9.0 }, 5.0);
    assert!(turned.turn < 1.4 * 5.0 && turned.turn > 1.4 * 4.0, "{}", turned.turn);
}

#[test]
fn a_wall_stops_and_is_one_collision() {
    let mut bodies = simulator(&room(10.0, 10.0), &[Pose::new(5.0, 5.0, 0.0)]);
    drive(&mut bodies, Command { speed: 0.7, turn_rate: 0.0 }, 20.0);
    assert!((bodies.pose(0).position.x - (10.0 - 0.355)).abs() < 1e-6);
    assert!(bodies.observe(0).bumped);
    assert_eq!(bodies.collisions(0), 1);
    let stalled = drive(&mut bodies, Command { speed: 0.7, turn_rate: 0.0 }, 1.0);
    assert!(stalled.distance.abs() < 1e-6, "stalled wheels measure {}", stalled.distance);
    drive(&mut bodies, Command { speed: -0.5, turn_rate: 0.0 }, 3.0);
    assert!(!bodies.observe(0).bumped && bodies.pose(0).position.x < 9.0);
    drive(&mut bodies, Command { speed: 0.5, turn_rate: 0.0 }, 5.0);
    assert_eq!(bodies.collisions(0), 2);
}

#[test]
fn a_disc_slides_along_a_wall() {
    let mut bodies = simulator(&room(30.0, 10.0), &[Pose::new(5.0, 8.0, PI / 6.0)]);
    drive(&mut bodies, Command { speed: 0.5, turn_rate: 0.0 }, 20.0);
    let pose = bodies.pose(0);
    assert!((pose.position.y - 9.645).abs() < 1e-6 && pose.position.x > 8.5, "{pose:?}");
}

#[test]
fn water_drowns_and_deep_ground_stops() {
    let mut world = room(20.0, 10.0);
    let mut surface = |x: f64, speed: f64, kind| {
        let rect = Rect::new(DVec2::new(x, 0.0), DVec2::new(x + 1.0, 10.0));
        let shape = Shape::from_rect(rect);
        world.surfaces.push(Surface { speed, ..Surface::new(kind, shape) });
    };
    surface(14.0, 0.0, SurfaceKind::Class(1));
    surface(2.0, 0.0, SurfaceKind::Water);
    let mut bodies = simulator(&world, &[Pose::new(8.0, 5.0, 0.0)]);
    drive(&mut bodies, Command { speed: 0.5, turn_rate: 0.0 }, 30.0);
    assert_eq!(bodies.condition(0), Condition::Operational);
    assert!((13.9..=14.0).contains(&bodies.pose(0).position.x), "{:?}", bodies.pose(0));
    drive(&mut bodies, Command { speed: -0.5, turn_rate: 0.0 }, 40.0);
    assert_eq!(bodies.condition(0), Condition::Drowned);
    let lost = bodies.pose(0);
    drive(&mut bodies, Command { speed: 0.5, turn_rate: 0.0 }, 5.0);
    assert_eq!(bodies.pose(0), lost);
}

#[test]
fn wheels_measure_too_far_on_loose_ground() {
    for wheel_bias in [0.0, 0.1, 0.35] {
        let mut world = room(20.0, 10.0);
        let loose = Surface::new(SurfaceKind::Loose, Shape::from_rect(world.bounds));
        world.surfaces.push(Surface { wheel_bias, ..loose });
        let mut bodies = simulator(&world, &[Pose::new(5.0, 5.0, 0.0)]);
        let reported = drive(&mut bodies, Command { speed: 0.5, turn_rate: 0.0 }, 10.0);
        let driven = bodies.pose(0).position.x - 5.0;
        assert!((reported.distance / driven - 1.0 - wheel_bias).abs() < 1e-9, "{reported:?}");
        let turned = drive(&mut bodies, Command { speed: 0.0, turn_rate: 1.0 }, 2.0);
        assert!((turned.turn - bodies.pose(0).heading).abs() < 1e-9, "turns are not biased");
    }
}

#[test]
fn dark_walls_are_seen_only_from_near() {
    let mut world = room(20.0, 10.0);
    for wall in &mut world.walls {
        wall.visible_range = Some(3.0);
    }
    let ahead = |bodies: &mut FlatSimulator| {
        let scan = bodies.observe(0).scan.expect("the first tick has a scan");
        scan.ranges[scan.ranges.len() / 2]
    };
    let offset = Robot::default().laser_offset;
    let near = Pose::new(20.0 - offset - 2.9, 5.0, 0.0);
    assert!((ahead(&mut simulator(&world, &[near])) - 2.9).abs() < 0.011);
    let far = Pose::new(20.0 - offset - 3.1, 5.0, 0.0);
    assert!(ahead(&mut simulator(&world, &[far])).is_nan());
    // Beyond its range the laser cannot tell.
    let farther = Pose::new(0.5, 5.0, 0.0);
    let laser = LaserProfile { max_range: 8.0, ..LaserProfile::USARSIM };
    let robot = Robot::default();
    let flat = Arc::new(FlatWorld::new(&world, &robot).expect("a robot"));
    let wheels = OdometryProfile::EXACT;
    let mut bodies = FlatSimulator::new(flat, &robot, &[farther], &laser, &wheels, Seed(1));
    assert_eq!(ahead(&mut bodies), crate::lidar::NO_ECHO);
    // Robots are not dark: one before the wall is seen.
    let other = Pose::new(far.position.x - 4.0, 5.0, 0.0);
    let seen = ahead(&mut simulator(&world, &[other, far]));
    assert!((seen - (4.0 - offset - robot.circumscribed_radius)).abs() < 0.011, "{seen}");
    // The map takes no cell in between for free.
    let mut bodies = simulator(&world, &[far]);
    let scan = bodies.observe(0).scan.expect("a scan");
    let sweep = crate::slam::sweep::Sweeper::new(&robot, &LaserProfile::USARSIM).sweep(&scan);
    assert!(sweep.clear.is_empty(), "{} free rays", sweep.clear.len());
}

#[test]
fn rough_ground_multiplies_the_variance() {
    let error = |noise: f64| {
        let mut world = room(40.0, 10.0);
        let shape = Shape::from_rect(world.bounds);
        let kind = SurfaceKind::Uneven;
        world.surfaces.push(Surface { odometry_noise: noise, ..Surface::new(kind, shape) });
        let robot = Robot::default();
        let flat = Arc::new(FlatWorld::new(&world, &robot).expect("a robot"));
        let profile = OdometryProfile { b_s: 0.0, b_t: 0.0, ..OdometryProfile::SKID };
        let errors: Vec<f64> = (0..60)
            .map(|seed| {
                let start = [Pose::new(2.0, 5.0, 0.0)];
                let laser = LaserProfile { ticks_a_scan: 200, ..LaserProfile::USARSIM };
                let mut bodies =
                    FlatSimulator::new(flat.clone(), &robot, &start, &laser, &profile, Seed(seed));
                let driven = drive(&mut bodies, Command { speed: 0.5, turn_rate: 0.0 }, 30.0);
                driven.distance - (bodies.pose(0).position.x - 2.0)
            })
            .collect();
        errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64
    };
    let (plain, rough) = (error(1.0), error(4.0));
    // The same draws at twice the deviation: the ratio is exact.
    assert!((rough / plain - 4.0).abs() < 1e-6, "{rough} / {plain}");
    // k_ss times 14.75 m; 60 squared normals lie within a factor of two with p > 0.9999.
    let expected = 2.5e-4 * 14.75;
    assert!((0.5..2.0).contains(&(plain / expected)), "{plain} is not {expected}");
}

#[test]
fn robots_are_solid_and_seen() {
    let starts = [Pose::new(3.0, 5.0, 0.0), Pose::new(7.0, 5.0, 0.0)];
    let mut bodies = simulator(&room(10.0, 10.0), &starts);
    let scan = bodies.observe(0).scan.expect("the first observation has a scan");
    assert!((scan.ranges[90] - (4.0 - 0.21 - 0.355)).abs() < 0.01, "{}", scan.ranges[90]);
    for _ in 0..400 {
        bodies.advance(&[Command { speed: 0.5, turn_rate: 0.0 }, Command::STOP]);
    }
    let gap = bodies.pose(0).position.distance(bodies.pose(1).position);
    assert!((gap - 0.71).abs() < 1e-5, "{gap}");
    assert_eq!((bodies.collisions(0), bodies.pose(1)), (1, starts[1]));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever the commands are, a disc never enters a solid.
    #[test]
    fn nothing_is_passed_through(
        seed in 0_u64..1000,
        commands in proptest::collection::vec((-2.0..2.0, -3.0..3.0, 1_u32..60), 1..40),
    ) {
        let spec = envgen::indoor::IndoorSpec { difficulty: 8.0, ..Default::default() };
        let world = spec.generate(Seed(seed)).expect("a map").to_world();
        let start = world.start.expect("a start");
        let mut bodies = simulator(&world, &[start]);
        let mut last = start.position;
        for (speed, turn_rate, ticks) in commands {
            for _ in 0..ticks {
                bodies.advance(&[Command { speed, turn_rate }]);
                let at = bodies.pose(0).position;
                prop_assert!(world.clearance(at) > 0.355 - 1e-5, "{}", world.clearance(at));
                prop_assert!(at.distance(last) < 0.1, "jumped {}", at.distance(last));
                last = at;
            }
        }
    }
}

#[test]
fn a_robot_that_is_pushed_does_not_drive_on() {
    let world = room(12.0, 6.0);
    let mut scenario =
        Scenario::new(&world, &ScenarioSpec::default(), Seed(1)).expect("a scenario");
    let position = DVec2::new(2.9, 3.0);
    let reaction = Reaction::Surprised;
    scenario.people = vec![Person { position, heading: 0.0, speed: 1.0, reaction }];
    let state = ScenarioState::new(&world, &scenario).expect("a state");
    // Robot and person overlap by 0.21 m.
    let mut bodies = simulator(&world, &[Pose::new(3.3, 3.0, 0.0)]).in_scenario(state, Seed(1));
    for _ in 0..40 {
        bodies.advance(&[Command::STOP]);
    }
    let moved = bodies.pose(0).position.x - 3.3;
    assert!((0.2..0.25).contains(&moved), "{moved} m");
}

#[test]
fn commands_that_are_no_numbers_stop() {
    let mut bodies = simulator(&room(10.0, 10.0), &[Pose::new(5.0, 5.0, 0.0)]);
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        drive(&mut bodies, Command { speed: value, turn_rate: value }, 1.0);
    }
    assert_eq!(bodies.pose(0), Pose::new(5.0, 5.0, 0.0));
}
