//! What lasers see of a scenario: door leaves, people and smoke.

use envgen::Seed;
use envgen::scenario::ScenarioState;
use envgen::scenario::smoke::{Laser, Reading, Stretch};
use glam::DVec2;

use super::profile::LaserProfile;
use super::scan::UNSEEN;

/// The rays of a scan in the world's frame.
#[derive(Clone, Copy, Debug)]
pub struct Rays<'a> {
    /// Origin of all rays, in metres.
    pub from: DVec2,
    /// Directions of the rays as unit vectors, one per beam.
    pub directions: &'a [DVec2],
    /// Greatest range in metres.
    pub max_range: f64,
}

/// Applies door leaves, people and smoke to the scans of one laser profile. All robot backends use it,
/// so that lasers see the same in each of them.
#[derive(Clone, Debug)]
pub struct ScenarioSight {
    profile: LaserProfile,
    seed: Seed,
    stretches: Vec<Stretch>,
}

impl ScenarioSight {
    /// Creates it for lasers of a profile. Random draws of smoke follow from the seed.
    pub fn new(profile: &LaserProfile, seed: Seed) -> Self {
        ScenarioSight { profile: profile.clone(), seed, stretches: Vec::new() }
    }

    /// Ends rays at the door leaves and people that they meet. The exact ranges to everything else, one
    /// per ray, are changed in place. This comes before [`ScenarioSight::look_through_smoke`].
    pub fn meet(state: &ScenarioState, rays: &Rays<'_>, ranges: &mut [f64]) {
        let Rays { from, directions, max_range } = *rays;
        for (_, shape) in state.visible(from, max_range) {
            for (range, &direction) in ranges.iter_mut().zip(directions) {
                let distance = shape.distance_along(from, direction);
                *range = distance.map_or(*range, |distance| range.min(distance));
            }
        }
    }

    /// Applies smoke to the ranges of a robot's scan in a tick, one per ray. A range that smoke stops
    /// becomes [`UNSEEN`] or ends at a phantom. Returns the beams that read 0 instead, in ascending
    /// order.
    ///
    /// With several scenarios, the leaves and people of all of them come first: see
    /// [`ScenarioSight::meet`].
    pub fn look_through_smoke(
        &mut self,
        state: &ScenarioState,
        (robot, tick): (u64, u64),
        rays: &Rays<'_>,
        ranges: &mut [f64],
    ) -> Vec<usize> {
        let Rays { from, directions, max_range } = *rays;
        let mut zero = Vec::new();
        if !state.has_smoke() {
            return zero;
        }
        let laser: Laser = self.profile.in_smoke(state.settings().smoke_profile);
        let failed = state.settings().failed_beams;
        let scan = self.seed.attempt("trial/smoke", robot, tick).bits();
        for (beam, (range, &direction)) in ranges.iter_mut().zip(directions).enumerate() {
            // This beam ended in the smoke of another scenario.
            if range.is_nan() {
                continue;
            }
            state.smoke_along(from, direction, *range, &mut self.stretches);
            if self.stretches.is_empty() {
                continue;
            }
            let mut stream = Seed(scan).stream("trial/smoke/beam", beam as u64);
            // The end of the ray counts as a surface: the power that is left of the beam there decides.
            let end = Some(*range);
            match laser.read(end, max_range, &self.stretches, failed, &mut stream) {
                Reading::Echo(_) => {}
                Reading::NoEcho => *range = UNSEEN,
                Reading::Phantom(distance) => *range = distance,
                Reading::Zero => zero.push(beam),
            }
        }
        zero
    }
}
