//! The water that a robot's camera sees. Lasers do not see water, but the operators of Zwennes (2011)
//! saw the camera's picture and named water as a hazard.

use envgen::geometry::{Pose, unit_vector};
use envgen::raycast::Raycaster;
use envgen::surface_index::SurfaceIndex;
use glam::DVec2;

use crate::robot::Robot;

/// Number of directions that are sampled, from 90 degrees on the right to 90 degrees on the left.
const DIRECTIONS: u32 = 31;

/// Metres from the robot's centre to the nearest sampled point, and between points.
const NEAREST: f64 = 0.3;
const STEP: f64 = 0.1;

/// Returns the points where a robot sees water, in metres in its own frame (x ahead, y to the left):
/// those in front of it, at most [`Robot::water_sight`] away and not behind anything solid.
///
/// Any robot backend that knows the robot's true pose can use it. The same pose gives the same points.
///
/// ```
/// use envgen::geometry::{Pose, Rect, Shape};
/// use envgen::raycast::Raycaster;
/// use envgen::world::{Surface, SurfaceKind};
/// use envgen::{Provenance, World, glam::DVec2, surface_index::SurfaceIndex};
/// use mapping_trial::{robot::Robot, water};
///
/// // A pool that begins 1 m ahead of the robot, which sees 1.5 m.
/// let area = Rect::new(DVec2::splat(-5.0), DVec2::splat(5.0));
/// let mut world = World::new(Provenance::other("manual", serde_json::json!({})), area);
/// let pool = Shape::from_rect(Rect::new(DVec2::new(1.0, -5.0), area.max));
/// world.surfaces.push(Surface::new(SurfaceKind::Water, pool));
/// let (grounds, rays) = (SurfaceIndex::new(&world), Raycaster::new(&world));
/// let points = water::seen(&grounds, &rays, &Robot::default(), Pose::default());
/// assert!(!points.is_empty());
/// assert!(points.iter().all(|p| p.x >= 1.0 - 1e-9 && p.length() <= 1.5 + 1e-9));
/// ```
pub fn seen(grounds: &SurfaceIndex, rays: &Raycaster, robot: &Robot, pose: Pose) -> Vec<DVec2> {
    let mut points = Vec::new();
    if !grounds.has_water() || robot.water_sight < NEAREST {
        return points;
    }
    let ahead = unit_vector(pose.heading);
    for direction in 0..DIRECTIONS {
        let turn = f64::from(direction) / f64::from(DIRECTIONS - 1) - 0.5;
        let look = unit_vector(turn * std::f64::consts::PI);
        let along = ahead.rotate(look);
        let wall = rays.cast_along(pose.position, along, robot.water_sight);
        let free = wall.map_or(robot.water_sight, |hit| hit.distance);
        let steps = ((free - NEAREST) / STEP + 1e-9).floor().max(-1.0) as i32;
        points.extend(
            (0..=steps)
                .map(|step| NEAREST + STEP * f64::from(step))
                .filter(|distance| grounds.at(pose.position + along * *distance).water)
                .map(|distance| look * distance),
        );
    }
    points
}

#[cfg(test)]
mod tests {
    use envgen::geometry::{Rect, Shape};
    use envgen::world::{Surface, SurfaceKind, Wall, WallKind};
    use envgen::{Provenance, World};

    use super::*;

    fn rect(x0: f64, y0: f64, x1: f64, y1: f64) -> Shape {
        Shape::from_rect(Rect::new(DVec2::new(x0, y0), DVec2::new(x1, y1)))
    }

    /// Water right of x = 5, and a wall from y = 1 upwards before it.
    fn world() -> World {
        let bounds = Rect::new(DVec2::splat(-10.0), DVec2::splat(10.0));
        let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
        let shape = rect(5.0, -10.0, 10.0, 10.0);
        let kind = SurfaceKind::Water;
        world.surfaces.push(Surface { speed: 0.0, ..Surface::new(kind, shape) });
        let shape = rect(4.8, 1.0, 4.9, 10.0);
        world.walls.push(Wall::new(WallKind::Wall, shape));
        world
    }

    fn look(robot: &Robot, pose: Pose) -> Vec<DVec2> {
        let world = world();
        seen(&SurfaceIndex::new(&world), &Raycaster::new(&world), robot, pose)
    }

    #[test]
    fn water_ahead_is_seen_where_it_is() {
        let robot = Robot::default();
        let points = look(&robot, Pose::new(4.0, -3.0, 0.0));
        assert!(points.len() > 40, "{points:?}");
        assert!(points.iter().all(|p| p.x >= 1.0 && p.length() <= robot.water_sight + 1e-9));
        let nearest = points.iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1.1, "{nearest}");
        // Turned to the left it lies on the right.
        let points = look(&robot, Pose::new(4.0, -3.0, std::f64::consts::FRAC_PI_2));
        assert!(!points.is_empty() && points.iter().all(|p| p.y <= -1.0 + 1e-9), "{points:?}");
    }

    #[test]
    fn nothing_is_seen_behind_the_robot_or_a_wall_or_by_the_blind() {
        let robot = Robot::default();
        assert_eq!(look(&robot, Pose::new(4.0, -3.0, std::f64::consts::PI)), []);
        assert_eq!(look(&robot, Pose::new(4.0, 5.0, 0.0)), []);
        assert_eq!(look(&robot, Pose::new(0.0, -3.0, 0.0)), []);
        let blind = Robot { water_sight: 0.0, ..robot };
        assert_eq!(look(&blind, Pose::new(4.0, -3.0, 0.0)), []);
    }
}
