//! What lasers of a height see, and what stops robots of a height.

use std::sync::Arc;

use envgen::Seed;
use envgen::geometry::{Pose, Rect, Shape};
use envgen::world::{Doorway, Extent, Obstacle, ObstacleKind, Wall, WallKind};
use glam::DVec2;

use super::*;
use crate::mappable_area::MappableArea;
use crate::mappable_area::tests::room;

/// A room with a block from 4 to 5 m ahead of its start, across its whole width.
fn with_block(bottom: f64, top: f64) -> World {
    let mut world = room(10.0, 2.0);
    let shape = Shape::from_rect(Rect::new(DVec2::new(5.0, 0.0), DVec2::new(6.0, 2.0)));
    let height = Some(Extent::new(bottom, top).expect("a height"));
    world.obstacles.push(Obstacle { height, ..Obstacle::new(ObstacleKind::Other, shape) });
    world
}

fn robot(height: f64, laser: f64) -> Robot {
    let mut robot = Robot { height, ..Robot::default() };
    robot.laser_mount.height = laser;
    robot
}

/// The range straight ahead in metres, and how far a robot drives ahead.
fn ahead(world: &World, robot: &Robot) -> (f64, f64) {
    let flat = Arc::new(FlatWorld::new(world, robot).expect("a robot"));
    let (laser, odometry) = (LaserProfile::USARSIM, OdometryProfile::EXACT);
    let start = Pose::new(1.0, 1.0, 0.0);
    let mut simulator = FlatSimulator::new(flat, robot, &[start], &laser, &odometry, Seed(1));
    let scan = simulator.observe(0).scan.expect("a scan at the start");
    let range = scan.ranges[scan.ranges.len() / 2] + robot.laser_offset;
    for _ in 0..(30.0 / TICK) as u32 {
        simulator.advance(&[Command { speed: 1.0, turn_rate: 0.0 }]);
    }
    (range, simulator.pose(0).position.x - start.position.x)
}

#[test]
fn what_is_lower_than_the_laser_is_not_seen_but_stops_the_robot() {
    let pioneer = Robot::default();
    let near = |a: f64, b: f64| (a - b).abs() < 0.1;
    let stop = |wall: f64| wall - 1.0 - pioneer.circumscribed_radius;
    for (bottom, top, seen, stopped) in [
        (0.0, 1.0, 5.0, 5.0),
        // Below the laser at 0.45 m, which is seen where the laser's plane just touches it.
        (0.0, 0.3, 10.0, 5.0),
        (0.0, 0.45, 5.0, 5.0),
        // Over the laser, lower than the top at 0.5 m.
        (0.47, 1.0, 10.0, 5.0),
        // Over the robot.
        (0.5, 1.0, 10.0, 10.0),
        (2.1, 2.6, 10.0, 10.0),
    ] {
        let (range, driven) = ahead(&with_block(bottom, top), &pioneer);
        assert!(near(range, seen - 1.0), "{bottom} to {top}: seen at {range}");
        assert!(near(driven, stop(stopped)), "{bottom} to {top}: stopped after {driven}");
    }
}

#[test]
fn a_lower_robot_passes_below_and_a_lower_laser_sees() {
    let (table, step) = (with_block(0.3, 0.75), with_block(0.0, 0.15));
    let (range, driven) = ahead(&table, &robot(0.25, 0.2));
    assert!(range > 8.0 && driven > 8.0, "{range} {driven}");
    let (range, driven) = ahead(&step, &robot(0.25, 0.132));
    assert!(range < 4.1 && driven < 4.0, "{range} {driven}");
}

#[test]
fn lintels_stop_what_is_higher_than_the_opening() {
    let mut world = room(10.0, 2.0);
    let rect = |y0, y1| Shape::from_rect(Rect::new(DVec2::new(5.0, y0), DVec2::new(5.2, y1)));
    world.walls.extend([rect(0.0, 0.5), rect(1.5, 2.0)].map(|s| Wall::new(WallKind::Wall, s)));
    world.doorways.push(Doorway::new(rect(0.5, 1.5), true, [None, None]));
    let (_, driven) = ahead(&world, &robot(2.0, 0.45));
    assert!(driven > 8.0, "{driven}");
    let (range, driven) = ahead(&world, &robot(2.2, 0.45));
    assert!(range > 8.0 && driven < 4.0, "{range} {driven}");
    let (range, _) = ahead(&world, &robot(2.2, 2.15));
    assert!(range < 4.1, "{range}");
}

#[test]
fn the_truth_is_what_this_robot_can_map() {
    let area = |world: &World| MappableArea::new(world, &Robot::default()).expect("free space");
    let at = |area: &MappableArea, x: f64| {
        area.walls().iter().filter(|point| (point.position.x - x).abs() < 1e-6).count()
    };
    let (step, high) = (area(&with_block(0.0, 0.3)), area(&with_block(0.0, 1.0)));
    // The robot stays on its side of both; over the step it sees the far wall.
    assert!((step.free_area() - high.free_area()).abs() < 0.5);
    assert!(at(&high, 5.0) > 30 && at(&high, 10.0) == 0);
    assert!(at(&step, 5.0) == 0 && at(&step, 10.0) > 30);
    // Below a beam it drives on.
    assert!(area(&with_block(0.6, 1.0)).free_area() > 19.0);
}

#[test]
fn wrong_heights_are_named() {
    let error = |robot: &Robot| {
        let world = room(5.0, 5.0);
        let error = FlatWorld::new(&world, robot).expect_err("no robot").to_string();
        assert_eq!(MappableArea::new(&world, robot).expect_err("no robot").to_string(), error);
        error
    };
    for wrong in [f64::NAN, -1.0, 20.0] {
        assert!(error(&robot(wrong, 0.4)).contains("`body.height` must be"));
        assert!(error(&robot(0.4, wrong)).contains("`body.laser_mount.height` must be"));
    }
}
