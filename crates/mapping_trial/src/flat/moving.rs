//! What moves in the flat simulator besides its robots: doors, people and smoke.

use envgen::Seed;
use envgen::scenario::{PERSON_RADIUS, Robot, ScenarioState};
use glam::DVec2;

use crate::backend::TICK;
use crate::lidar::{LaserProfile, Rays, ScenarioSight};

/// A scenario, and how the robots' lasers see it.
pub(super) struct Moving {
    state: ScenarioState,
    sight: ScenarioSight,
}

impl Moving {
    /// Draws of smoke follow from the seed.
    pub(super) fn new(state: ScenarioState, profile: &LaserProfile, seed: Seed) -> Self {
        Moving { state, sight: ScenarioSight::new(profile, seed) }
    }

    pub(super) fn state(&self) -> &ScenarioState {
        &self.state
    }

    pub(super) fn state_mut(&mut self) -> &mut ScenarioState {
        &mut self.state
    }

    /// Moves everything for one tick.
    pub(super) fn step(&mut self, robots: &[Robot]) {
        if let Err(error) = self.state.step(TICK, robots) {
            // Poses and velocities of discs are finite.
            unreachable!("{error}");
        }
    }

    /// Applies door leaves, people and smoke to the ranges of a robot's scan. Returns the beams that
    /// read 0.
    pub(super) fn see(
        &mut self,
        (robot, tick): (usize, u32),
        rays: &Rays<'_>,
        ranges: &mut [f64],
    ) -> Vec<usize> {
        ScenarioSight::meet(&self.state, rays, ranges);
        let scan = (robot as u64, u64::from(tick));
        self.sight.look_through_smoke(&self.state, scan, rays, ranges)
    }

    /// Calls `press` for every door leaf and person, with a point, its distance from a robot's centre
    /// less the size of what is there, and whether it is a person.
    pub(super) fn press(&self, at: DVec2, mut press: impl FnMut(DVec2, f64, bool)) {
        for leaf in self.state.all_leaves() {
            let point = leaf.nearest_point(at);
            press(point, point.distance(at), false);
        }
        for person in self.state.people() {
            press(person.position, person.position.distance(at) - PERSON_RADIUS, true);
        }
    }
}
