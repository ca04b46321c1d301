//! Looks for doors that were closed: where doors may open and close, a robot that has nothing left to
//! explore drives along what is unknown or out of reach, several times.

use std::collections::BTreeSet;

use envgen::geometry::{Pose, Rect};
use glam::{DVec2, IVec2};

use super::door_rounds::{SQUARE, around, between, centre, side, square_of};
use super::goal_choice::TAKEN;
use super::state::{Goal, Navigator, Task};
use crate::map::{Cell, CellIndex};
use crate::policy::PolicyInput;
use crate::policy::costmap::{CellCost, Costmap, Node};
use crate::policy::search::GridPlanner;

/// Squares along the side of the least block that may be a room: 1.5 m.
const ROOM: i32 = 3;

/// Distance in squares of the places beside rooms: 2.5 m, also where walls are thick.
const BESIDE: i32 = 5;

impl Navigator {
    /// Drives to the nearest place beside a hidden room that was not looked at in this round. Returns false if
    /// none is left in the last round.
    pub(super) fn look_for_doors(&mut self, view: &PolicyInput<'_>, pose: Pose) -> bool {
        if !view.doors || self.doors.is_over(view.seen.time) && !self.doors.is_stale {
            return false;
        }
        if self.doors.places.is_none() || std::mem::take(&mut self.doors.is_stale) {
            self.list_places(view, pose);
        }
        self.doors.visit(pose.position);
        if self.drive_to_place(view, pose) {
            return true;
        }
        let Navigator { doors, .. } = self;
        doors.rounds += 1;
        let Some(places) = &mut doors.places else { return false };
        places.append(&mut doors.visited);
        if places.is_empty() || doors.is_over(view.seen.time) {
            return false;
        }
        self.doors.visit(pose.position);
        if !self.drive_to_place(view, pose) {
            // All are near, or the robot is behind a closed door itself.
            self.pilots[view.robot].task = Task::Begin;
        }
        true
    }

    /// Lists the places that are left in this round.
    fn list_places(&mut self, view: &PolicyInput<'_>, pose: Pose) {
        let Navigator { costmap, search, blocks, doors, .. } = self;
        search.set_worst_allowed(CellCost::Tight);
        search.nearest(costmap, pose.position, blocks, |_, _| false);
        // No place is beside what is far from the map.
        let near = f64::from(BESIDE + ROOM) * side();
        let Some(known) = view.map.bounds().map(|known| known.grown(near)) else { return };
        let (min, max) = (view.area.min.max(known.min), view.area.max.min(known.max));
        let rooms = hidden_rooms(costmap, search, Rect { min, max });
        // One room that is found may lead to others.
        let is_first = doors.places.is_none();
        if is_first || rooms.len() + (ROOM * ROOM) as usize <= doors.rooms {
            (doors.rounds, doors.since) = (0, view.seen.time);
        }
        doors.rooms = rooms.len();
        let mut places = places_beside(costmap, &rooms);
        places.retain(|place| !doors.visited.contains(place));
        doors.places = Some(places);
    }

    /// Drives to the nearest place that is left, and if possible not near where another robot drives to. Returns
    /// false if no place is left.
    fn drive_to_place(&mut self, view: &PolicyInput<'_>, pose: Pose) -> bool {
        let Navigator { costmap, search, blocks, doors, pilots, .. } = self;
        let Some(places) = &doors.places else { return false };
        let others = pilots.iter().enumerate().filter(|(other, _)| *other != view.robot);
        let taken: Vec<DVec2> = others
            .filter_map(|(_, pilot)| match pilot.task {
                Task::Go { goal: Goal::Place(at), .. } => Some(at),
                _ => None,
            })
            .collect();
        let is_taken = |p: DVec2| taken.iter().any(|at| at.distance(p) < TAKEN);
        let nodes = |&(x, y): &(i32, i32)| nodes_in(costmap, x, y).map(|node| node.0);
        let open = places.iter().filter(|(x, y)| !is_taken(centre(*x, *y)));
        let mut goals: Vec<u32> = open.flat_map(nodes).collect();
        if goals.is_empty() {
            goals.extend(places.iter().flat_map(nodes));
        }
        if goals.is_empty() {
            return false;
        }
        goals.sort_unstable();
        search.set_worst_allowed(CellCost::Tight);
        let is_goal = |node: Node, _| goals.binary_search(&node.0).is_ok();
        let Some(node) = search.nearest(costmap, pose.position, blocks, is_goal) else {
            return false;
        };
        let place = costmap.point(node);
        self.set_path(view, node, Goal::Place(place), false);
        true
    }
}

/// The cells of the map in a square.
fn cells_in(x: i32, y: i32) -> impl Iterator<Item = CellIndex> {
    let (cols, rows) = (SQUARE * x..SQUARE * (x + 1), SQUARE * y..SQUARE * (y + 1));
    rows.flat_map(move |row| cols.clone().map(move |col| CellIndex { col, row }))
}

/// The planning cells in a square that the map has.
fn nodes_in(costmap: &Costmap, x: i32, y: i32) -> impl Iterator<Item = Node> + use<'_> {
    // Each planning cell is two cells wide.
    let cells = cells_in(x, y).filter(|cell| cell.col % 2 == 0 && cell.row % 2 == 0);
    cells.filter_map(|cell| costmap.node_at(cell.centre()))
}

/// The squares of the area that the last search has not reached, and of which no wall is known, in blocks that may
/// be rooms.
fn hidden_rooms(costmap: &Costmap, search: &GridPlanner, area: Rect) -> BTreeSet<(i32, i32)> {
    let is_hidden = |&(x, y): &(i32, i32)| {
        area.contains(centre(x, y))
            && cells_in(x, y).all(|cell| costmap.cell(cell) != Cell::Occupied)
            && nodes_in(costmap, x, y).all(|node| search.cost(node).is_none())
    };
    let hidden: BTreeSet<(i32, i32)> =
        between(square_of(area.min), square_of(area.max)).filter(is_hidden).collect();
    let block = |&(x, y): &(i32, i32)| {
        let low = IVec2::new(x, y);
        between(low, low + ROOM - 1)
    };
    let is_room = |square: &&(i32, i32)| block(square).all(|one| hidden.contains(&one));
    hidden.iter().filter(is_room).flat_map(block).collect()
}

/// The squares with free cells beside others.
fn places_beside(costmap: &Costmap, rooms: &BTreeSet<(i32, i32)>) -> BTreeSet<(i32, i32)> {
    let beside = rooms.iter().flat_map(|&(x, y)| around(IVec2::new(x, y), BESIDE));
    let beside: BTreeSet<(i32, i32)> = beside.filter(|square| !rooms.contains(square)).collect();
    let has_free =
        |&(x, y): &(i32, i32)| cells_in(x, y).any(|cell| costmap.cell(cell) == Cell::Free);
    beside.into_iter().filter(has_free).collect()
}

#[cfg(test)]
mod tests {
    use envgen::geometry::unit_vector;

    use super::super::door_rounds::ROUNDS;
    use super::*;
    use crate::backend::Observation;
    use crate::lidar::{LaserProfile, Scan};
    use crate::map::{Estimate, OccupancyMap};
    use crate::policy::tests::input;
    use crate::policy::{Decision, PolicyKind, build};
    use crate::robot::Robot;

    /// Half the width of a room, in cells.
    const HALF: i32 = 40;

    /// Draws a room with four walls, and with a doorway in the eastern one if it is open.
    fn draw(map: &mut OccupancyMap, is_open: bool) {
        for (x, y) in between(IVec2::splat(-HALF), IVec2::new(HALF + 30, HALF)) {
            let is_doorway = is_open && y.abs() < 12;
            if x > HALF && !is_doorway {
                continue;
            }
            let is_wall = x == -HALF || x == HALF || y.abs() == HALF;
            let change = if is_wall && !(is_doorway && x >= HALF) { 200 } else { -400 };
            map.add(CellIndex { col: x, row: y }, change);
        }
        map.touch(Rect::new(DVec2::splat(-3.0), DVec2::new(4.0, 3.0)));
    }

    /// Where `nearest` drives in the room until it is finished, or through the doorway, which opens at a time in
    /// seconds. East of the room, 6 m of the area are unknown.
    fn track(doors: bool, opens: f64) -> Vec<DVec2> {
        let (body, laser) = (Robot::default(), LaserProfile::default());
        let mut policy = build(PolicyKind::Nearest, 1, &body, &laser);
        let scan = Scan { ranges: vec![2.0; laser.beams as usize] };
        let mut map = OccupancyMap::new();
        draw(&mut map, false);
        let (mut pose, mut track, mut is_open) = (Pose::new(-1.0, 0.0, 0.0), Vec::new(), false);
        for tick in 0..6000 {
            let seen = Observation { time: 0.1 * f64::from(tick), ..Default::default() };
            if seen.time >= opens && !is_open {
                is_open = true;
                draw(&mut map, true);
            }
            let estimates = [Estimate { pose, ..Estimate::default() }];
            let view = input(0, &estimates, (&map, &scan), &seen, (&body, &laser));
            let area = Rect::new(DVec2::splat(-2.0), DVec2::new(8.0, 2.0));
            let Decision::Drive(command) = policy.decide(&PolicyInput { area, doors, ..view })
            else {
                return track;
            };
            pose.heading += 0.1 * command.turn_rate;
            pose.position += 0.1 * command.speed * unit_vector(pose.heading);
            track.push(pose.position);
            if pose.position.x > 2.2 {
                return track;
            }
        }
        panic!("it has not ended at {pose:?}");
    }

    #[test]
    fn a_robot_drives_along_what_is_unknown_where_there_are_doors() {
        let start = DVec2::new(-1.0, 0.0);
        let still = track(false, f64::INFINITY);
        assert!(still.iter().all(|p| p.distance(start) < 0.1));
        let moved = track(true, f64::INFINITY);
        // It has been near every piece of the wall for which it has room.
        for y in [-1.2, 0.0, 1.2] {
            let piece = DVec2::new(1.5, y);
            assert!(moved.iter().any(|p| p.distance(piece) < 1.2), "{y}");
        }
        assert!(moved.iter().all(|p| p.x < 2.0));
        assert!(0.1 * moved.len() as f64 > ROUNDS.1);
    }

    #[test]
    fn a_door_that_opens_later_is_found() {
        let end = |track: Vec<DVec2>| track.last().expect("a position").x;
        let time = 0.1 * track(true, f64::INFINITY).len() as f64;
        assert!(end(track(true, 0.7 * time)) > 2.2);
        assert!(end(track(false, 0.7 * time)) < 2.0);
    }
}
