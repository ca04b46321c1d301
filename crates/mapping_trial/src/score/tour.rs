//! The tour of a robot without errors: how far it drives and turns to see everything that can be mapped.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use envgen::geometry::{Rect, unit_vector, wrap_angle};
use envgen::raycast::Raycaster;
use envgen::world::World;
use glam::{DVec2, IVec2};

use crate::robot::Robot;
use crate::truth::MappableArea;

/// Least side of a cell of the tour's grid in metres, and its greatest number of cells: larger worlds
/// have larger cells.
const SIDE: f64 = 0.4;
const MOST_CELLS: f64 = 60_000.0;

/// How far the robot sees, all around, in metres.
const RANGE: f64 = 8.0;

/// Rays of a look around.
const RAYS: u32 = 180;

/// Share of the greatest speed at which a robot cruises, as policies do.
const CRUISE: f64 = 5.0 / 7.0;

/// Weight of a step in the smoothed direction of motion: steps follow a grid, a robot does not.
const SMOOTHING: f64 = 0.4;

/// The eight neighbours of a cell.
const STEPS: [IVec2; 8] = [
    IVec2::new(1, 0),
    IVec2::new(0, 1),
    IVec2::new(-1, 0),
    IVec2::new(0, -1),
    IVec2::new(1, 1),
    IVec2::new(-1, 1),
    IVec2::new(-1, -1),
    IVec2::new(1, -1),
];

/// What a robot that knows its pose, makes no error and drives to the nearest unseen place needs to
/// see all of F, with a view of 8 m all around: the part of a trial's time and turning that a world
/// costs by its size alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tour {
    /// Path length in metres.
    pub distance: f64,
    /// Turning in radians.
    pub turning: f64,
    /// Time in seconds at cruising speed, turning at the greatest rate.
    pub time: f64,
}

impl Tour {
    pub(super) fn of(world: &World, area: &MappableArea) -> Self {
        let mut walk = Walk::new(world, area);
        walk.look();
        while let Some(path) = walk.path_to_unseen() {
            for cell in path {
                walk.step(cell);
                walk.look();
            }
            walk.see_around();
        }
        let Walk { distance, turning, .. } = walk;
        let Robot { max_speed, max_turn_rate, .. } = area.robot();
        let time = distance / (CRUISE * max_speed) + turning / max_turn_rate;
        Tour { distance, turning, time }
    }
}

/// A robot on its tour.
struct Walk {
    rays: Raycaster,
    bounds: Rect,
    side: f64,
    size: IVec2,
    /// Cells of F that are not seen yet.
    unseen: Vec<bool>,
    /// Cells in whose centre the robot can be.
    clear: Vec<bool>,
    /// The cell from which a search reached a cell, and the search.
    from: Vec<(u32, u32)>,
    search: u32,
    at: IVec2,
    direction: Option<DVec2>,
    distance: f64,
    turning: f64,
}

impl Walk {
    fn new(world: &World, area: &MappableArea) -> Self {
        let bounds = area.frame().area();
        let extent = bounds.size();
        let side = (extent.x * extent.y / MOST_CELLS).sqrt().max(SIDE);
        let size = (extent / side).ceil().as_ivec2().max(IVec2::ONE);
        let cells = (size.x * size.y) as usize;
        let mut walk = Walk {
            rays: Raycaster::new(world),
            bounds,
            side,
            size,
            unseen: vec![false; cells],
            clear: vec![false; cells],
            from: vec![(0, 0); cells],
            search: 0,
            at: IVec2::ZERO,
            direction: None,
            distance: 0.0,
            turning: 0.0,
        };
        for cell in 0..cells {
            let centre = walk.centre(walk.place(cell));
            walk.unseen[cell] = area.frame().cell_at(centre).is_some_and(|cell| area.free()[cell]);
            walk.clear[cell] = walk.unseen[cell] && area.is_clear(centre);
        }
        walk.at = walk.cell_of(area.start());
        walk
    }

    fn place(&self, cell: usize) -> IVec2 {
        let cell = cell as i32;
        IVec2::new(cell % self.size.x, cell / self.size.x)
    }

    fn centre(&self, place: IVec2) -> DVec2 {
        self.bounds.min + (place.as_dvec2() + 0.5) * self.side
    }

    fn cell_of(&self, p: DVec2) -> IVec2 {
        ((p - self.bounds.min) / self.side).floor().as_ivec2()
    }

    fn index(&self, place: IVec2) -> Option<usize> {
        let inside = place.x >= 0 && place.y >= 0 && place.x < self.size.x && place.y < self.size.y;
        inside.then(|| (place.y * self.size.x + place.x) as usize)
    }

    /// Sees what is in sight.
    fn look(&mut self) {
        let from = self.centre(self.at);
        for ray in 0..RAYS {
            let direction = unit_vector(TAU * f64::from(ray) / f64::from(RAYS));
            let free =
                self.rays.cast_along(from, direction, RANGE).map_or(RANGE, |hit| hit.distance);
            let mut r = 0.0;
            while r < free {
                if let Some(cell) = self.index(self.cell_of(from + direction * r)) {
                    self.unseen[cell] = false;
                }
                r += 0.5 * self.side;
            }
        }
    }

    /// Sees the cells beside the robot, which a ray may miss.
    fn see_around(&mut self) {
        for step in STEPS {
            if let Some(cell) = self.index(self.at + step) {
                self.unseen[cell] = false;
            }
        }
    }

    /// Whether an unseen cell is at a place or beside it.
    fn shows_unseen(&self, place: IVec2) -> bool {
        let near = STEPS.into_iter().chain([IVec2::ZERO]);
        near.filter_map(|step| self.index(place + step)).any(|cell| self.unseen[cell])
    }

    /// The shortest path, in steps, to a place beside an unseen cell; `None` if none is left.
    fn path_to_unseen(&mut self) -> Option<Vec<IVec2>> {
        self.search += 1;
        let start = self.index(self.at)?;
        self.from[start] = (self.search, start as u32);
        let mut open = VecDeque::from([start]);
        while let Some(cell) = open.pop_front() {
            let place = self.place(cell);
            if self.shows_unseen(place) {
                return Some(self.path_back(start, cell));
            }
            for step in STEPS {
                let Some(next) = self.index(place + step) else { continue };
                let free = |place: IVec2| self.index(place).is_some_and(|cell| self.clear[cell]);
                let around_a_corner =
                    !(free(place + IVec2::new(step.x, 0)) && free(place + IVec2::new(0, step.y)));
                let cuts = step.x != 0 && step.y != 0 && around_a_corner;
                if self.clear[next] && !cuts && self.from[next].0 != self.search {
                    self.from[next] = (self.search, cell as u32);
                    open.push_back(next);
                }
            }
        }
        None
    }

    fn path_back(&self, start: usize, mut cell: usize) -> Vec<IVec2> {
        let mut path = Vec::new();
        while cell != start {
            path.push(self.place(cell));
            cell = self.from[cell].1 as usize;
        }
        path.reverse();
        path
    }

    fn step(&mut self, to: IVec2) {
        let step = (to - self.at).as_dvec2();
        self.distance += step.length() * self.side;
        let ahead = step.normalize_or_zero();
        let direction = match self.direction {
            Some(before) => {
                let smooth = (before.lerp(ahead, SMOOTHING)).normalize_or(ahead);
                let angle = |d: DVec2| libm::atan2(d.y, d.x);
                self.turning += wrap_angle(angle(smooth) - angle(before)).abs();
                smooth
            }
            None => ahead,
        };
        self.direction = Some(direction);
        self.at = to;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::tests::{add_wall, room};

    fn tour(world: &World) -> Tour {
        let area = MappableArea::new(world, &Robot::default()).expect("free space");
        Tour::of(world, &area)
    }

    #[test]
    fn a_room_in_sight_needs_hardly_any_tour() {
        // From (1, 1) the far corner is 7.1 m away: no more than a look at cells that rays missed.
        let found = tour(&room(6.0, 6.0));
        assert!(found.distance < 8.0, "{found:?}");
    }

    #[test]
    fn a_corridor_is_driven_up_to_the_range() {
        // From (1, 1) to where the far end is in sight.
        let found = tour(&room(60.0, 3.0));
        let expected = 60.0 - 1.0 - RANGE;
        assert!((found.distance / expected - 1.0).abs() < 0.1, "{found:?}, {expected}");
        assert!(found.turning < TAU, "{found:?}");
        let robot = Robot::default();
        let time = found.distance / 0.5 + found.turning / robot.max_turn_rate;
        assert!((found.time - time).abs() < 1e-9);
    }

    #[test]
    fn walls_make_it_longer() {
        let mut walls = room(30.0, 30.0);
        for i in 0..4 {
            let x = 6.0 * f64::from(i + 1);
            let (low, high) = if i % 2 == 0 { (0.0, 28.0) } else { (2.0, 30.0) };
            if (x - 15.0).abs() > 1.0 {
                add_wall(&mut walls, (x, low), (x + 0.1, high));
            }
        }
        let (open, closed) = (tour(&room(30.0, 30.0)), tour(&walls));
        assert!(closed.distance > 1.2 * open.distance, "{open:?} {closed:?}");
    }
}
