//! Navigability: whether a robot can navigate with a map. Paths are planned on the map and driven in
//! the true world.

use envgen::Seed;
use glam::DVec2;

use crate::map::{OccupancyMap, RESOLUTION};
use crate::mappable_area::MappableArea;
use crate::policy::costmap::{Costmap, Node, SIDE};
use crate::policy::search::GridPlanner;

/// Number of starts of paths.
const STARTS: usize = 8;

/// Goals per start: 40 paths in all.
const GOALS: usize = 5;

/// Number of points that are tried for each start and each goal until one can be reached on the perfect
/// map.
const TRIES: usize = 20;

/// How far a path may end from its goal if the map has no free position for the robot there, in
/// planning cells: 0.3 m.
const SNAP: i32 = 3;

/// Least piece of a path that is checked, in metres, which is the accuracy of finding contacts.
const STEP: f64 = 0.01;

/// Greatest clearance in metres that is used at once, since the ground may be different farther away.
const MOST_ROOM: f64 = 0.2;

/// A start and its goals.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Trip {
    start: DVec2,
    goals: Vec<DVec2>,
}

/// Draws starts and goals that can be reached on the perfect map: if a path fails on another map, that
/// map is the cause. There are fewer than 40 paths, or none, if the world is too small for them.
pub(crate) fn trips(truth: &MappableArea, perfect: &OccupancyMap, seed: Seed) -> Vec<Trip> {
    let mut planner = Planner::new(truth, perfect);
    let free = truth.free().iter().enumerate().filter(|(_, free)| **free);
    let places: Vec<DVec2> = free
        .map(|(cell, _)| truth.frame().centre(cell))
        .filter(|&p| planner.costmap.cell_cost_at(p).is_passable() && truth.is_clear(p))
        .collect();
    if places.is_empty() {
        return Vec::new();
    }
    let mut draws = seed.stream("trial/navigability", 0);
    let mut draw = || places[draws.below(places.len() as u64) as usize];
    let mut trips = Vec::new();
    for _ in 0..STARTS * TRIES {
        if trips.len() == STARTS {
            break;
        }
        let start = draw();
        let goals: Vec<DVec2> = (0..TRIES).map(|_| draw()).collect();
        let paths = planner.paths(start, &goals);
        let driven = goals.iter().zip(paths).filter(|(goal, path)| {
            path.as_ref().is_some_and(|path| arrives(truth, 0.0, start, path, **goal))
        });
        let goals: Vec<DVec2> = driven.map(|(goal, _)| *goal).take(GOALS).collect();
        if !goals.is_empty() {
            trips.push(Trip { start, goals });
        }
    }
    trips
}

/// Returns the fraction of paths that reach their goal without a collision, for the robot and for one
/// that is smaller all around by a cell of the map. It is 1 if there are no paths.
pub(super) fn navigability(truth: &MappableArea, trips: &[Trip], map: &OccupancyMap) -> [f64; 2] {
    let mut planner = Planner::new(truth, map);
    let (mut arrived, mut all) = ([0_u32; 2], 0_u32);
    for trip in trips {
        let paths = planner.paths(trip.start, &trip.goals);
        for (goal, path) in trip.goals.iter().zip(paths) {
            for (arrived, margin) in arrived.iter_mut().zip([0.0, RESOLUTION]) {
                let arrives = |path: &Vec<_>| arrives(truth, margin, trip.start, path, *goal);
                *arrived += u32::from(path.as_ref().is_some_and(arrives));
            }
            all += 1;
        }
    }
    arrived.map(|arrived| if all == 0 { 1.0 } else { f64::from(arrived) / f64::from(all) })
}

/// Plans paths on a map, as policies do.
struct Planner {
    costmap: Costmap,
    search: GridPlanner,
}

impl Planner {
    fn new(truth: &MappableArea, map: &OccupancyMap) -> Self {
        let mut costmap = Costmap::new(truth.robot());
        costmap.refresh(map);
        Planner { costmap, search: GridPlanner::new() }
    }

    /// Returns the cheapest paths from a start to goals, as points to drive through; `None` for a goal
    /// that cannot be reached.
    fn paths(&mut self, start: DVec2, goals: &[DVec2]) -> Vec<Option<Vec<DVec2>>> {
        let goals: Vec<_> = goals.iter().map(|&goal| self.snap(goal)).collect();
        let mut left: Vec<Node> = goals.iter().copied().flatten().collect();
        left.sort_unstable();
        left.dedup();
        let mut reached = Vec::new();
        if !left.is_empty() {
            self.search.nearest(&mut self.costmap, start, &[], |node, _| {
                if let Ok(at) = left.binary_search(&node) {
                    reached.push(left.remove(at));
                }
                left.is_empty()
            });
        }
        let path = |goal: Option<Node>| {
            let goal = goal.filter(|goal| reached.contains(goal))?;
            let mut points = Vec::new();
            self.search.path_to(&self.costmap, goal, &mut points);
            Some(points)
        };
        goals.into_iter().map(path).collect()
    }

    /// Returns the free position for the robot that is nearest to a point by the map.
    fn snap(&mut self, p: DVec2) -> Option<Node> {
        let around = (-SNAP..=SNAP).flat_map(|y| (-SNAP..=SNAP).map(move |x| (x, y)));
        let mut around: Vec<_> = around.map(|(x, y)| (x * x + y * y, x, y)).collect();
        around.retain(|(squared, _, _)| *squared <= SNAP * SNAP);
        around.sort_unstable();
        around.into_iter().find_map(|(_, x, y)| {
            let q = p + DVec2::new(f64::from(x), f64::from(y)) * SIDE;
            self.costmap.cell_cost_at(q).is_passable().then(|| self.costmap.node_at(q))?
        })
    }
}

/// Whether the robot's disc, smaller by a margin in metres, gets from a start along a path to a goal
/// without touching anything.
fn arrives(truth: &MappableArea, margin: f64, start: DVec2, path: &[DVec2], goal: DVec2) -> bool {
    let room_at = |p: DVec2| (truth.room(p) + margin).min(MOST_ROOM);
    // Everything within `room` of `at` is clear, and `from` is in that circle.
    let (mut at, mut room, mut from) = (start, room_at(start), start);
    for &to in path.iter().chain([&goal]) {
        if room >= 0.0 && at.distance(to) > room {
            (at, room) = (from, room_at(from));
        }
        while room >= 0.0 && at.distance(to) > room {
            let ahead = (to - at).normalize_or_zero();
            at += ahead * room.max(STEP).min(at.distance(to));
            room = room_at(at);
        }
        if room < 0.0 {
            return false;
        }
        from = to;
    }
    true
}

#[cfg(test)]
mod tests {
    use std::sync::LazyLock;

    use envgen::World;
    use envgen::geometry::{Rect, Shape, distance_to_segment};
    use proptest::prelude::*;

    use super::*;
    use crate::map::{CLAMP, CellIndex};
    use crate::mappable_area::tests::{add_wall, room};
    use crate::robot::Robot;
    use crate::score::Reference;

    fn truth(world: &World) -> Reference {
        Reference::new(world, &Robot::default()).expect("a world with free space")
    }

    /// Two rooms of 6 x 8 m beside each other and a doorway of 1.4 m between them.
    fn two_rooms() -> World {
        let mut world = room(12.0, 8.0);
        add_wall(&mut world, (5.95, 0.0), (6.05, 3.3));
        add_wall(&mut world, (5.95, 4.7), (6.05, 8.0));
        world
    }

    #[test]
    fn a_convex_room_fails_no_path() {
        let truth = truth(&room(20.0, 20.0));
        let goals: Vec<usize> = truth.trips().iter().map(|trip| trip.goals.len()).collect();
        assert_eq!(goals, [GOALS; STARTS]);
    }

    /// On a map whose only doorway is closed by a wall, exactly the trips from room to room fail.
    #[test]
    fn a_wall_that_is_not_there_fails_the_trips_that_cross_it() {
        let truth = truth(&two_rooms());
        let mut map = truth.perfect_map();
        for row in 0..160 {
            for col in [119, 120] {
                let cell = CellIndex { col, row };
                map.add(cell, CLAMP);
                map.add(cell, CLAMP);
            }
        }
        map.touch(Rect::new(DVec2::new(5.9, 0.0), DVec2::new(6.1, 8.0)));
        let is_left = |p: DVec2| p.x < 6.0;
        let trips: Vec<(DVec2, DVec2)> = truth
            .trips()
            .iter()
            .flat_map(|trip| trip.goals.iter().map(|goal| (trip.start, *goal)))
            .collect();
        let within = trips.iter().filter(|(a, b)| is_left(*a) == is_left(*b)).count();
        assert!(within > 0 && within < trips.len(), "{within} of {}", trips.len());
        let expected = within as f64 / trips.len() as f64;
        assert_eq!(navigability(&truth, truth.trips(), &map), [expected; 2]);
    }

    /// Robots drive into walls of the world that the map does not show: a map of free floor only.
    #[test]
    fn paths_through_walls_do_not_arrive() {
        let truth = truth(&two_rooms());
        let mut map = OccupancyMap::new();
        for row in 0..160 {
            for col in 0..240 {
                map.add(CellIndex { col, row }, -CLAMP);
            }
        }
        map.touch(Rect::new(DVec2::ZERO, DVec2::new(12.0, 8.0)));
        let [found, with_margin] = navigability(&truth, truth.trips(), &map);
        assert!(found > 0.2 && found <= with_margin && with_margin < 1.0, "{found}");
    }

    proptest! {
        /// A straight path arrives if the robot's disc, swept along it, stays clear of a pillar
        /// and of the walls.
        #[test]
        fn a_straight_path_arrives_where_the_swept_disc_is_clear(
            from in (0.5..9.5, 0.5..9.5), to in (0.5..9.5, 0.5..9.5),
        ) {
            static TRUTH: LazyLock<Reference> = LazyLock::new(|| {
                let mut world = room(10.0, 10.0);
                add_wall(&mut world, (4.5, 4.5), (5.5, 5.5));
                truth(&world)
            });
            let radius = Robot::default().circumscribed_radius;
            let (a, b) = (DVec2::from(from), DVec2::from(to));
            // Two convex shapes are nearest at a corner of one, but for those that cross.
            let pillar = Shape::from_rect(Rect::new(DVec2::splat(4.5), DVec2::splat(5.5)));
            let corners = pillar.corners();
            let crosses = envgen::geometry::edges(&corners)
                .any(|(c, d)| envgen::geometry::segments_cross(a, b, c, d));
            let nearest = corners
                .iter()
                .map(|&corner| distance_to_segment(corner, a, b))
                .chain([a, b].map(|end| pillar.distance(end)))
                .fold(f64::INFINITY, f64::min);
            let clear = if crosses { 0.0 } else { nearest };
            // How exactly a contact is found.
            prop_assume!((clear - radius).abs() > STEP);
            prop_assert_eq!(arrives(&TRUTH, 0.0, a, &[b], b), clear > radius);
        }
    }
}
