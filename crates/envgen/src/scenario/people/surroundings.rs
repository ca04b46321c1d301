//! The surroundings of people: free space, doors and robots.

use glam::DVec2;

use super::free_space::FreeSpace;
use super::routes::Routes;
use crate::grid::CellBuckets;
use crate::raycast::Raycaster;
use crate::scenario::ScenarioSpec;
use crate::scenario::doors::{DoorShape, DoorState};
use crate::scenario::person::{PERSON_RADIUS, Person};
use crate::scenario::robot::Robot;
use crate::seed::Seed;

/// The distance in metres beyond the reach of their leaves within which doors concern people.
pub(crate) const ZONE: f64 = 0.5;

/// The surroundings of people.
pub(crate) struct Surroundings<'a> {
    pub(crate) space: &'a FreeSpace,
    pub(crate) routes: &'a Routes,
    pub(crate) rays: &'a Raycaster,
    pub(crate) shapes: &'a [DoorShape],
    /// For each cell of the free space, the doors near it.
    pub(crate) door_zones: &'a CellBuckets<u32>,
    /// The same for the points to which a person can go before the lists of neighbours are rebuilt.
    pub(crate) near_doors: &'a CellBuckets<u32>,
    pub(crate) people: &'a [Person],
    pub(crate) spec: &'a ScenarioSpec,
    pub(crate) seed: Seed,
    pub(crate) doors: &'a [DoorState],
    pub(crate) robots: &'a [Robot],
    pub(crate) tick: u64,
    /// The greatest speed of all people, in m/s.
    pub(crate) max_speed: f64,
}

impl Surroundings<'_> {
    /// Returns whether a person at a point is where leaves can be, as at no place to which people go.
    pub(super) fn is_in_doorway(&self, p: DVec2) -> bool {
        let is_near = |door: &u32| {
            let shape = &self.shapes[*door as usize];
            p.distance(shape.middle()) < shape.reach() + PERSON_RADIUS
        };
        self.at(self.door_zones, p).iter().any(is_near)
    }

    /// Returns the nearest robot within a distance in metres of a point that is in sight of it.
    pub(super) fn seen_robot(&self, p: DVec2, range: f64) -> Option<Robot> {
        let mut seen: Option<(f64, Robot)> = None;
        for robot in self.robots {
            let to = robot.position - p;
            let distance = to.length();
            let is_nearer = seen.is_none_or(|(nearest, _)| distance < nearest);
            if distance < range && is_nearer && self.sees(p, to) {
                seen = Some((distance, *robot));
            }
        }
        seen.map(|(_, robot)| robot)
    }

    /// Returns the robot that a person at a point reacts to: the nearest one in sight, or else the nearest.
    pub(super) fn noticed_robot(&self, p: DVec2) -> Robot {
        let nearest = nearest_robot(p, self.robots);
        match self.robots {
            [_, _, ..] => self.seen_robot(p, f64::INFINITY).unwrap_or(nearest),
            _ => nearest,
        }
    }

    /// Returns the doors of the cell at a point.
    #[inline]
    pub(super) fn at<'a>(&self, doors: &'a CellBuckets<u32>, p: DVec2) -> &'a [u32] {
        if self.shapes.is_empty() {
            return &[];
        }
        self.space.frame.index_at(p).map_or(&[], |cell| doors.of(cell))
    }

    /// Whether no solid and no leaf is between a point and another one at `to` relative to it.
    pub(super) fn sees(&self, from: DVec2, to: DVec2) -> bool {
        self.sees_with_doors(self.doors, from, to)
    }

    /// The same for given states of the doors.
    pub(super) fn sees_with_doors(&self, doors: &[DoorState], from: DVec2, to: DVec2) -> bool {
        let distance = to.length();
        let direction = to / distance;
        distance == 0.0
            || (self.rays.cast_along(from, direction, distance).is_none()
                && !self.is_leaf_between(doors, from, direction, distance))
    }

    fn is_leaf_between(
        &self,
        states: &[DoorState],
        from: DVec2,
        direction: DVec2,
        distance: f64,
    ) -> bool {
        if self.shapes.is_empty() {
            return false;
        }
        let hides = |&door: &u32| {
            let (shape, state) = (&self.shapes[door as usize], &states[door as usize]);
            let mut leaves = state.leaves(shape);
            leaves.any(|leaf| leaf.distance_along(from, direction).is_some_and(|at| at < distance))
        };
        // No leaf is between two of these points whose door does not concern both of them.
        let parts = (distance / ZONE).ceil();
        let mut before: &[u32] = &[];
        for part in 0..=parts as u32 {
            let p = from + direction * (distance * f64::from(part) / parts);
            let doors = self.at(self.door_zones, p);
            if doors != before && doors.iter().any(hides) {
                return true;
            }
            before = doors;
        }
        false
    }
}

/// Returns the robot that is nearest to a point; of equally near ones, the first; an infinitely distant robot if
/// there are no robots.
pub(super) fn nearest_robot(p: DVec2, robots: &[Robot]) -> Robot {
    let far = Robot { position: DVec2::INFINITY, velocity: DVec2::ZERO, radius: 0.0 };
    robots.iter().fold(far, |best, robot| {
        let is_nearer = robot.position.distance_squared(p) < best.position.distance_squared(p);
        if is_nearer { *robot } else { best }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Rect, Shape};
    use crate::provenance::Provenance;
    use crate::scenario::doors::{Door, DoorKind};
    use crate::scenario::person::{Reaction, Task};
    use crate::scenario::spec::DoorControl;
    use crate::scenario::tick::TICK;
    use crate::scenario::{DoorCommand, Scenario, ScenarioState};
    use crate::world::{Doorway, Wall, WallKind, World};

    const V: fn(f64, f64) -> DVec2 = DVec2::new;

    /// Where someone is who walks towards a doorway, tick by tick, while someone else stays at a point.
    fn walk(stays: DVec2, is_closed: bool) -> Vec<DVec2> {
        let bounds = Rect::new(V(0.0, 0.0), V(8.0, 4.0));
        let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
        for (from, to) in [(V(3.9, 0.0), V(4.1, 1.5)), (V(3.9, 2.5), V(4.1, 4.0))] {
            world.walls.push(Wall::new(WallKind::Wall, Shape::from_rect(Rect::new(from, to))));
        }
        let opening = Shape::from_rect(Rect::new(V(3.9, 1.5), V(4.1, 2.5)));
        world.doorways.push(Doorway::new(opening, true, [None, None]));
        let settings = ScenarioSpec { waiting: 1e6, working: 1e6, ..Default::default() };
        let mut scenario = Scenario::new(&world, &settings, Seed(1)).unwrap();
        scenario.doors.push(Door {
            doorway: 0,
            kind: DoorKind::Sliding,
            far_end: false,
            to_right: false,
            control: DoorControl::Commanded,
            open: 30.0,
            closed: 30.0,
            slam: 0.0,
        });
        let person = |position| {
            let reaction = Reaction::Regular;
            Person { position, heading: 0.0, speed: 1.3, reaction }
        };
        scenario.people = vec![person(V(1.0, 2.0)), person(stays)];
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        if is_closed {
            state.command_door(0, DoorCommand::Close).unwrap();
        }
        state.step(2.0, &[]).unwrap();
        let walker = &mut state.crowd.people[0];
        (walker.path, walker.on_path, walker.task) = (vec![V(3.6, 2.0)], true, Task::Walk);
        state.crowd.quiet_until.fill(0);
        let position = |_| {
            state.step(TICK, &[]).unwrap();
            assert_eq!(state.people()[1].position, stays);
            state.people()[0].position
        };
        (0..60).map(position).collect()
    }

    #[test]
    fn who_is_behind_a_closed_door_is_not_avoided() {
        let (near, far) = (V(4.4, 2.0), V(7.0, 3.5));
        assert_eq!(walk(near, true), walk(far, true));
        let arrives = |p: &DVec2| p.distance(V(3.6, 2.0)) < 1e-9;
        assert!(walk(far, true).iter().any(arrives));
        assert_ne!(walk(near, false), walk(far, false));
    }
}
