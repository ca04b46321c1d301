//! Regulated pure pursuit (Macenski et al., Regulated pure pursuit for robot path tracking, Autonomous
//! Robots 47, 2023, <https://doi.org/10.1007/s10514-023-10097-6>): follows a path, slower in curves and
//! near walls, and stops for obstacles that the laser sees.

use envgen::geometry::{Pose, unit_vector, wrap_angle};
use glam::DVec2;

use super::costmap::{CellCost, Costmap};
use super::guard::Guard;
use super::margins::Margins;
use super::path::{Path, worst_between};
use crate::backend::Command;
use crate::robot::Robot;

/// Lookahead distance in metres on narrow parts of the path.
const SHORT_LOOKAHEAD: f64 = 0.3;

/// Distance in metres between the body and an echo ahead at which the robot has to stop.
const STOP: f64 = 0.10;

/// Angles in radians at which turning on the spot begins and ends.
const TURN: (f64, f64) = (1.2, 0.4);

/// Radius in metres from which curves are driven at full speed.
const FULL_SPEED_RADIUS: f64 = 0.8;

/// Distance in metres between the body and an echo below which the robot slows down.
const NEAR: f64 = 0.3;

/// Distance in metres at which the part of the path that a robot sees ahead as straight ends at the latest.
const FARTHEST: f64 = 5.0;

/// Angle in radians by which a straight path may deviate from the heading of the robot.
const STRAIGHT: f64 = 0.2;

/// Angle in radians between the directions that are tried around an obstacle.
const FAN: f64 = 0.087;

/// Drives one robot along paths.
#[derive(Clone, Debug, Default)]
pub(super) struct Pursuit {
    turning: bool,
}

impl Pursuit {
    /// The command that follows a path.
    pub(super) fn follow(
        &mut self,
        robot: &Robot,
        pose: Pose,
        path: &mut Path,
        costmap: &mut Costmap,
        guard: &Guard,
        margins: &Margins,
    ) -> Command {
        path.advance(pose.position);
        let Some(target) = target(pose.position, path, costmap, margins.lookahead) else {
            return Command::STOP;
        };
        let left = path.left();
        let to = target - pose.position;
        let distance = to.length();
        let off = wrap_angle(libm::atan2(to.y, to.x) - pose.heading);
        if distance < 1e-6 {
            return Command::STOP;
        }
        self.turning = off.abs() > if self.turning { TURN.1 } else { TURN.0 };
        if self.turning {
            return turn(robot, off);
        }
        let curvature = 2.0 * libm::sin(off) / distance.max(SHORT_LOOKAHEAD);
        let free = guard.free_along(curvature);
        let allowed = stopping_speed(robot, free);
        if allowed < 0.05 && free < left + STOP {
            return self.around(robot, off, left, guard, margins.creep);
        }
        let bend = (1.0 / (curvature.abs() * FULL_SPEED_RADIUS).max(1.0)).max(0.35);
        let near = 0.4 + 0.6 * (guard.clearance() / NEAR).min(1.0);
        // Brakes towards the end, with less than the greatest deceleration of the robot.
        let end = (robot.acceleration * left).sqrt() + 0.05;
        // A robot that turns slowly would leave the curve.
        let turnable = robot.max_turn_rate / curvature.abs();
        let steady = margins.steady * bend * near;
        let open = straight_ahead(pose, path, costmap, margins).min(free - STOP).max(0.0);
        // Brakes towards the next curve as towards the end.
        let fast = (margins.steady * margins.steady + robot.acceleration * open).sqrt();
        let more = (fast.min(margins.cruise) - margins.steady).max(0.0);
        // Nothing is added in curves, or near walls, that halve the speed.
        let speed = steady + more * (2.0 * bend * near - 1.0).max(0.0);
        let speed = speed.min(end).min(allowed).min(turnable);
        let turn_rate = (speed * curvature).clamp(-robot.max_turn_rate, robot.max_turn_rate);
        Command { speed, turn_rate }
    }

    /// Avoids an obstacle on the path that the map does not show: turns to the direction nearest to the
    /// wanted one in which the laser sees enough free space, and drives there slowly.
    fn around(&mut self, robot: &Robot, off: f64, left: f64, guard: &Guard, creep: f64) -> Command {
        let need = STOP + left.min(0.3);
        for step in 0..32 {
            for side in [1.0, -1.0] {
                let angle = off + side * FAN * f64::from(step);
                if angle.abs() > 1.4 || guard.free_towards(unit_vector(angle)) < need {
                    continue;
                }
                if angle.abs() < 0.15 {
                    return Command { speed: creep, turn_rate: angle };
                }
                return turn(robot, angle);
            }
        }
        Command::STOP
    }
}

/// The point to drive towards: as far along the path as the robot can drive straight.
fn target(p: DVec2, path: &Path, costmap: &mut Costmap, lookahead: f64) -> Option<DVec2> {
    let mut target = None;
    let leaving = !costmap.cell_cost_at(p).is_passable();
    let mut driven = 0.0;
    path.ahead(0.1, lookahead, |ahead| {
        let cell_cost = if leaving { CellCost::Open } else { worst_between(costmap, p, ahead) };
        let tight = cell_cost >= CellCost::Tight && driven > SHORT_LOOKAHEAD;
        if driven <= 0.15 || (cell_cost.is_passable() && !tight) {
            target = Some(ahead);
            driven += 0.1;
            true
        } else {
            false
        }
    });
    target
}

/// Distance in metres for which the path ahead is straight, and not narrow; 0 for robots that always drive at a speed
/// from which they stop soon.
fn straight_ahead(pose: Pose, path: &Path, costmap: &mut Costmap, margins: &Margins) -> f64 {
    let mut straight = 0.0;
    if margins.cruise <= margins.steady {
        return straight;
    }
    let (axis, mut before) = (unit_vector(pose.heading), pose.position);
    path.ahead(0.1, FARTHEST, |ahead| {
        let to = ahead - pose.position;
        let distance = to.length();
        let is_straight = distance < 0.3 || axis.dot(to) >= libm::cos(STRAIGHT) * distance;
        if !is_straight || worst_between(costmap, before, ahead) >= CellCost::Tight {
            return false;
        }
        (straight, before) = (distance, ahead);
        true
    });
    straight
}

/// Turns on the spot by an angle, and brakes in time.
pub(super) fn turn(robot: &Robot, angle: f64) -> Command {
    let rate = (1.6 * robot.turn_acceleration * angle.abs()).sqrt().min(3.0 * angle.abs());
    Command { speed: 0.0, turn_rate: rate.min(robot.max_turn_rate).copysign(angle) }
}

/// Greatest speed from which the robot can stop [`STOP`] before an obstacle that is `free` metres away.
fn stopping_speed(robot: &Robot, free: f64) -> f64 {
    (2.0 * robot.acceleration * (free - STOP).max(0.0)).sqrt()
}
