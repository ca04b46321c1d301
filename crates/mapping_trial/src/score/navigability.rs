//! Whether a robot can find its way with a map: ways are planned on the map and driven in the true
//! world.

use envgen::Seed;
use glam::DVec2;

use super::plan::Planner;
use super::raster::Raster;
use crate::map::OccupancyMap;
use crate::truth::Truth;

/// Starts from which ways are planned.
const STARTS: usize = 8;

/// Goals of each start: 40 ways in all.
const GOALS: usize = 5;

/// Places that are tried for each start and each goal until one can be driven to with the perfect
/// map.
const TRIES: usize = 20;

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
    let raster = Raster::of(truth, perfect);
    let mut planner = Planner::new(&raster, truth.footprint());
    let places: Vec<DVec2> = planner
        .passable()
        .map(|cell| raster.frame.centre(cell))
        .filter(|&p| truth.is_clear(p))
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
pub(super) fn navigability(truth: &Truth, raster: &Raster) -> f64 {
    let mut planner = Planner::new(raster, truth.footprint());
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
