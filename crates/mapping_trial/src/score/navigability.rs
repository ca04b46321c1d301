//! Whether a robot can find its way with a map: ways are planned on the map and driven in the true
//! world.

use envgen::Seed;
use glam::DVec2;

use crate::map::OccupancyMap;
use crate::operator::costmap::{Costmap, Node, SIDE};
use crate::operator::search::Search;
use crate::truth::Truth;

/// Starts from which ways are planned.
const STARTS: usize = 8;

/// Goals of each start: 40 ways in all.
const GOALS: usize = 5;

/// Places that are tried for each start and each goal until one can be driven to with the perfect
/// map.
const TRIES: usize = 20;

/// How far a way may end from its goal where the map shows no place for the robot there, in cells
/// of the plan: 0.3 m.
const SNAP: i32 = 3;

/// Shortest piece of a way that is looked at, in metres: how exact a touch is found.
const STEP: f64 = 0.01;

/// Room is used up to so many metres: farther away the ground may be another.
const MOST_ROOM: f64 = 0.2;

/// A start and its goals.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Trip {
    start: DVec2,
    goals: Vec<DVec2>,
}

/// Draws starts and goals that can be driven with the perfect map: what fails on another map is
/// that map's fault. Less than 40 ways, or none, where the world has no room for them.
pub(crate) fn trips(truth: &Truth, perfect: &OccupancyMap, seed: Seed) -> Vec<Trip> {
    let mut planner = Planner::new(truth, perfect);
    let free = truth.free().iter().enumerate().filter(|(_, free)| **free);
    let places: Vec<DVec2> = free
        .map(|(cell, _)| truth.frame().centre(cell))
        .filter(|&p| planner.costmap.class_at(p).is_passable() && truth.is_clear(p))
        .collect();
    let mut draws = seed.stream("trial/navigability", 0);
    let mut draw = || places.get(draws.below(places.len() as u64) as usize).copied();
    let mut trips = Vec::new();
    for _ in 0..STARTS * TRIES {
        if trips.len() == STARTS {
            break;
        }
        let Some(start) = draw() else { break };
        let goals: Vec<DVec2> = (0..TRIES).filter_map(|_| draw()).collect();
        let ways = planner.ways(start, &goals);
        let driven = goals.iter().zip(ways).filter(|(goal, way)| {
            way.as_ref().is_some_and(|way| arrives(truth, start, way, **goal))
        });
        let goals: Vec<DVec2> = driven.map(|(goal, _)| *goal).take(GOALS).collect();
        if !goals.is_empty() {
            trips.push(Trip { start, goals });
        }
    }
    trips
}

/// The share of ways that lead to their goal without a touch; 1 where there are none to try.
pub(super) fn navigability(truth: &Truth, map: &OccupancyMap) -> f64 {
    let mut planner = Planner::new(truth, map);
    let (mut arrived, mut all) = (0_u32, 0_u32);
    for trip in truth.trips() {
        let ways = planner.ways(trip.start, &trip.goals);
        for (goal, way) in trip.goals.iter().zip(ways) {
            let good = way.is_some_and(|way| arrives(truth, trip.start, &way, *goal));
            arrived += u32::from(good);
            all += 1;
        }
    }
    if all == 0 { 1.0 } else { f64::from(arrived) / f64::from(all) }
}

/// Plans on a map, as operators do.
struct Planner {
    costmap: Costmap,
    search: Search,
}

impl Planner {
    fn new(truth: &Truth, map: &OccupancyMap) -> Self {
        let mut costmap = Costmap::new(truth.robot());
        costmap.refresh(map);
        Planner { costmap, search: Search::new() }
    }

    /// The cheapest ways from a start to goals, as points to drive through; `None` for a goal that
    /// cannot be reached.
    fn ways(&mut self, start: DVec2, goals: &[DVec2]) -> Vec<Option<Vec<DVec2>>> {
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
        let way = |goal: Option<Node>| {
            let goal = goal.filter(|goal| reached.contains(goal))?;
            let mut points = Vec::new();
            self.search.way(&self.costmap, goal, &mut points);
            Some(points)
        };
        goals.into_iter().map(way).collect()
    }

    /// The place for the robot that is nearest to a point, according to the map.
    fn snap(&mut self, p: DVec2) -> Option<Node> {
        let around = (-SNAP..=SNAP).flat_map(|y| (-SNAP..=SNAP).map(move |x| (x, y)));
        let mut around: Vec<_> = around.map(|(x, y)| (x * x + y * y, x, y)).collect();
        around.retain(|(squared, _, _)| *squared <= SNAP * SNAP);
        around.sort_unstable();
        around.into_iter().find_map(|(_, x, y)| {
            let q = p + DVec2::new(f64::from(x), f64::from(y)) * SIDE;
            self.costmap.class_at(q).is_passable().then(|| self.costmap.node_at(q))?
        })
    }
}

/// Whether the robot's disc gets from a start along the points of a way to a goal without touching
/// anything.
fn arrives(truth: &Truth, start: DVec2, way: &[DVec2], goal: DVec2) -> bool {
    let room_at = |p: DVec2| truth.room(p).min(MOST_ROOM);
    // All is clear around `at` as far as there is room, and `from` lies in that circle.
    let (mut at, mut room, mut from) = (start, room_at(start), start);
    for &to in way.iter().chain([&goal]) {
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
