//! Moves a world by half a score cell where that is better for its walls.
//!
//! Where the surface of a wall lies on a border of score cells, its echoes fall on either side, and the cells beside
//! it hardly become free: the same world would be more difficult at one place than at another. Generated worlds are
//! measured where they are, as are the anchors and the worlds of atlases; walls of most generated indoor maps lie in
//! the middle of cells.

use std::borrow::Cow;

use envgen::glam::DVec2;
use envgen::{World, WorldKind};

use crate::mappable_area::{MappableArea, SCORE_CELL};
use crate::robot::Robot;

/// How near to a border of cells a surface lies on it, as a fraction of a cell.
const NEAR: f64 = 0.125;

/// How parallel to an axis a surface is, as the greatest slope of its normal.
const PARALLEL: f64 = 1e-3;

/// Returns a world of another tool, or one that was edited, moved along each axis by nothing or by half a score cell,
/// so that fewer of the walls that a robot can see lie on borders of cells. Roads and landscapes stay where they are,
/// and so do worlds in which the robot does not fit.
pub(super) fn placed<'a>(world: &'a World, robot: &Robot) -> Cow<'a, World> {
    let made = world.provenance.original();
    let is_generated = made.kind.parse::<WorldKind>().is_ok() && !made.edited;
    if is_generated || !world.road_strips.is_empty() || world.raster.is_some() {
        return Cow::Borrowed(world);
    }
    let Ok(area) = MappableArea::new(world, robot) else { return Cow::Borrowed(world) };
    match best_move(&area) {
        DVec2::ZERO => Cow::Borrowed(world),
        by => Cow::Owned(moved(world, by)),
    }
}

fn best_move(area: &MappableArea) -> DVec2 {
    // Numbers of points of walls on borders, along each axis: where the world is, and half a cell farther.
    let (mut here, mut there) = ([0; 2], [0; 2]);
    for wall in area.walls() {
        for axis in 0..2 {
            if wall.normal[1 - axis].abs() > PARALLEL {
                continue;
            }
            let cells = wall.position[axis] / SCORE_CELL;
            let is_on_border = |cells: f64| (cells - cells.round()).abs() < NEAR;
            here[axis] += u32::from(is_on_border(cells));
            there[axis] += u32::from(is_on_border(cells + 0.5));
        }
    }
    let half = |axis: usize| if there[axis] < here[axis] { 0.5 * SCORE_CELL } else { 0.0 };
    DVec2::new(half(0), half(1))
}

/// The parts of a world that trials meet, moved. What the world promises is left out.
fn moved(world: &World, by: DVec2) -> World {
    let mut world = world.clone();
    world.certificate.clear();
    let shapes = (world.walls.iter_mut().map(|part| &mut part.shape))
        .chain(world.rooms.iter_mut().map(|part| &mut part.shape))
        .chain(world.doorways.iter_mut().map(|part| &mut part.shape))
        .chain(world.obstacles.iter_mut().map(|part| &mut part.shape))
        .chain(world.surfaces.iter_mut().map(|part| &mut part.shape));
    shapes.for_each(|shape| *shape = shape.moved(by));
    world.trees.iter_mut().for_each(|tree| tree.center += by);
    let poses = world.victims.iter_mut().chain(&mut world.start).chain(&mut world.goal);
    poses.for_each(|pose| pose.position += by);
    world.bounds.min += by;
    world.bounds.max += by;
    world
}

#[cfg(test)]
mod tests {
    use envgen::geometry::{Pose, Rect, Shape};
    use envgen::hallway::HallwaySpec;
    use envgen::indoor::IndoorSpec;
    use envgen::world::{Wall, WallKind};
    use envgen::{Blueprint, Provenance, Seed, Spec};

    use super::*;

    /// A room between walls whose surfaces lie at the ends of `inner`.
    fn room(inner: Rect) -> World {
        let outer = inner.grown(0.1);
        let walls = [
            Rect::new(outer.min, DVec2::new(inner.min.x, outer.max.y)),
            Rect::new(DVec2::new(inner.max.x, outer.min.y), outer.max),
            Rect::new(DVec2::new(inner.min.x, outer.min.y), DVec2::new(inner.max.x, inner.min.y)),
            Rect::new(DVec2::new(inner.min.x, inner.max.y), DVec2::new(inner.max.x, outer.max.y)),
        ];
        let middle = inner.center();
        let mut world = World::new(Provenance::other("test", serde_json::Value::Null), outer);
        world.start = Some(Pose::new(middle.x, middle.y, 0.0));
        world.walls = walls.map(|wall| Wall::new(WallKind::Wall, Shape::from_rect(wall))).into();
        world
    }

    #[test]
    fn surfaces_leave_the_borders_of_cells() {
        let inner = |x: f64, y: f64| {
            let min = DVec2::new(x, y);
            Rect::new(min, min + DVec2::new(8.0, 6.0))
        };
        for (at, by) in [
            ((0.0, 0.0), (0.05, 0.05)),
            ((-3.3, 0.45), (0.05, 0.0)),
            ((0.03, 2.101), (0.0, 0.05)),
            ((0.025, 0.075), (0.0, 0.0)),
        ] {
            let world = room(inner(at.0, at.1));
            let by = DVec2::new(by.0, by.1);
            let robot = Robot::default();
            let placed = placed(&world, &robot);
            let again = super::placed(&placed, &robot);
            assert!(matches!(again, Cow::Borrowed(_)), "{at:?}");
            assert_eq!(placed.bounds.min, world.bounds.min + by);
            let moved = |world: &World| world.start.expect("a start").position;
            assert_eq!(moved(&placed), moved(&world) + by);
            for (one, other) in placed.solids().zip(world.solids()) {
                let (one, other) = (one.shape.bounds(), other.shape.bounds());
                assert!((one.min - other.min - by).length() < 1e-12);
            }
        }
    }

    #[test]
    fn surfaces_that_no_robot_sees_do_not_count() {
        // The backs of the walls, and what is behind them, lie on borders, but the sides that a robot sees do not.
        let inner = Rect::new(DVec2::splat(0.05), DVec2::new(8.05, 6.05));
        let mut world = room(inner);
        let beyond = [
            Rect::new(DVec2::new(-1.0, -0.05), DVec2::new(-0.05, 6.15)),
            Rect::new(DVec2::new(-1.0, 6.15), DVec2::new(9.0, 7.0)),
        ];
        let wall = |area| Wall::new(WallKind::Wall, Shape::from_rect(area));
        world.walls.extend((0..40).flat_map(|_| beyond).map(wall));
        world.bounds = world.bounds.grown(2.0);
        assert!(matches!(placed(&world, &Robot::default()), Cow::Borrowed(_)));
        world.start = None;
        assert!(matches!(placed(&world, &Robot::default()), Cow::Borrowed(_)));
    }

    #[test]
    fn generated_worlds_stay_where_they_are_until_they_are_edited() {
        for seed in 0..30 {
            let base = IndoorSpec { width: 8, height: 8, ..Default::default() };
            for spec in [base.draw_levers(Seed(seed)), base] {
                let mut world = spec.generate(Seed(seed)).expect("a plan").to_world();
                assert!(
                    matches!(placed(&world, &Robot::default()), Cow::Borrowed(_)),
                    "seed {seed}"
                );
                // Also edited ones: their walls lie in the middle of cells.
                world.provenance.edited = true;
                assert!(
                    matches!(placed(&world, &Robot::default()), Cow::Borrowed(_)),
                    "seed {seed}"
                );
            }
        }
        // Walls of hallways that are 2 m wide lie on borders.
        let hall = HallwaySpec { segments: 5, width: 2.0, ..Default::default() };
        let mut world = hall.generate(Seed(1)).expect("a hallway").to_world();
        assert!(matches!(placed(&world, &Robot::default()), Cow::Borrowed(_)));
        world.provenance.edited = true;
        assert!(matches!(placed(&world, &Robot::default()), Cow::Owned(_)));
    }
}
