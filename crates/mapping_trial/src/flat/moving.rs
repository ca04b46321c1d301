//! What moves in the flat simulator besides its robots: doors, people and smoke.

use envgen::Seed;
use envgen::scenario::smoke::{Laser, Reading, Stretch};
use envgen::scenario::{PERSON_RADIUS, Robot, ScenarioState};
use glam::DVec2;

use crate::backend::TICK;
use crate::lidar::{LaserProfile, UNSEEN};

/// A scenario, and how the robots' lasers see it.
pub(super) struct Moving {
    state: ScenarioState,
    laser: Laser,
    seed: Seed,
    stretches: Vec<Stretch>,
}

/// The rays of a scan.
pub(super) struct Rays<'a> {
    pub(super) from: DVec2,
    pub(super) directions: &'a [DVec2],
    pub(super) max_range: f64,
}

impl Moving {
    /// Draws of smoke follow from the seed.
    pub(super) fn new(state: ScenarioState, profile: &LaserProfile, seed: Seed) -> Self {
        let laser = profile.in_smoke(state.settings().smoke_profile);
        Moving { state, laser, seed, stretches: Vec::new() }
    }

    pub(super) fn state(&self) -> &ScenarioState {
        &self.state
    }

    /// Moves everything for one tick.
    pub(super) fn step(&mut self, robots: &[Robot]) {
        if let Err(error) = self.state.step(TICK, robots) {
            // Poses and velocities of discs are finite.
            unreachable!("{error}");
        }
    }

    /// Shortens ranges that end at a leaf or a person.
    pub(super) fn shorten(&self, rays: &Rays<'_>, ranges: &mut [f64]) {
        let Rays { from, directions, max_range } = *rays;
        for (_, shape) in self.state.visible(from, max_range) {
            for (range, &direction) in ranges.iter_mut().zip(directions) {
                let distance = shape.distance_along(from, direction);
                *range = distance.map_or(*range, |distance| range.min(distance));
            }
        }
    }

    /// What smoke makes of the ranges of a robot's scan: those that it stops are not seen, or end at a phantom.
    /// Returns the beams that then read 0.
    pub(super) fn dim(
        &mut self,
        (robot, tick): (usize, u32),
        rays: &Rays<'_>,
        ranges: &mut [f64],
    ) -> Vec<usize> {
        let mut zero = Vec::new();
        if !self.state.has_smoke() {
            return zero;
        }
        let failed = self.state.settings().failed_beams;
        let scan = self.seed.attempt("trial/smoke", robot as u64, u64::from(tick)).bits();
        for (beam, (range, &direction)) in ranges.iter_mut().zip(rays.directions).enumerate() {
            self.state.smoke_along(rays.from, direction, *range, &mut self.stretches);
            if self.stretches.is_empty() {
                continue;
            }
            let mut stream = Seed(scan).stream("trial/smoke/beam", beam as u64);
            // The end of the ray stands for a surface: what is left of the beam there decides.
            let end = Some(*range);
            match self.laser.read(end, rays.max_range, &self.stretches, failed, &mut stream) {
                Reading::Echo(_) => {}
                Reading::NoEcho => *range = UNSEEN,
                Reading::Phantom(distance) => *range = distance,
                Reading::Zero => zero.push(beam),
            }
        }
        zero
    }

    /// Calls `press` for every leaf and person: a point, its distance from a robot's centre less the size of
    /// what is there, and whether it is a person.
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
