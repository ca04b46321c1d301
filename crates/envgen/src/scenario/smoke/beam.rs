//! The readings of laser beams in smoke.

use super::Stretch;
use crate::scenario::spec::FailedBeams;
use crate::seed::Stream;

/// Distances in metres at which the fields of view of emitter and detector begin to overlap, and are the same (M.
/// Hahner et al., Fog Simulation on Real `LiDAR` Point Clouds, ICCV 2021, <https://arxiv.org/abs/2108.05249>).
const OVERLAP: [f64; 2] = [0.9, 1.0];

/// The number of parts into which the path of a beam is divided for the distribution of its phantom echoes.
const PARTS: u32 = 256;

/// The model of how a laser measures in smoke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Laser {
    /// The lidar equation with the Beer-Lambert law: there is an echo at distance R if R exp(optical depth) is at
    /// most the laser's range without smoke, in metres.
    Physical {
        /// The range in metres without smoke. It may exceed the greatest distance that the laser reports.
        power_range: f64,
    },
    /// A Hokuyo of `USARSim`: a beam fails if density times metres in smoke exceed a budget. With
    /// [`FailedBeams::Zero`], as in `USARSim`, a failed beam reads 0; with the other variants, it reads what these
    /// specify. Particles reflect a beam that reaches them, as a wall would.
    Hokuyo {
        /// The budget, which is [`Laser::HOKUYO_BUDGET`] in `USARSim`.
        budget: f64,
    },
    /// A SICK of `USARSim`: smoke in a region has no effect. Particles reflect every beam, as they do for the Hokuyo.
    Sick,
}

/// The reading of a beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// An echo from a surface at this distance in metres.
    Echo(f64),
    /// No echo. This does not mean that the path of the beam is free.
    NoEcho,
    /// A distance of 0, which a Hokuyo reports as an error.
    Zero,
    /// An echo from smoke at this distance in metres, where there is no surface: a random one, or that of particles in
    /// `USARSim`.
    Phantom(f64),
}

impl Laser {
    /// The budget of the Hokuyo of `USARSim`.
    pub const HOKUYO_BUDGET: f64 = 0.005_75;

    /// Returns the reading of a beam that meets a surface at `distance` metres, or nothing within `max_range`.
    /// `stretches` is the smoke along the beam up to that distance. `stream` is the beam's own random stream, which
    /// is used only for phantom echoes.
    ///
    /// A beam that meets nothing fails where smoke would hide a surface at `max_range`, and never without smoke.
    ///
    /// ```
    /// use envgen::Seed;
    /// use envgen::scenario::FailedBeams;
    /// use envgen::scenario::smoke::{Laser, Reading, Stretch};
    ///
    /// // A wall at 6 m, behind 5 m of smoke that leaves exp(-2 * 0.5 * 5) of the power.
    /// let (laser, mut stream) = (Laser::Physical { power_range: 30.0 }, Seed(7).stream("beam", 0));
    /// let smoke = [Stretch { from: 0.5, to: 5.5, extinction: 0.5, is_particle: false }];
    /// let mut read = |stretches| {
    ///     laser.read(Some(6.0), 8.0, stretches, FailedBeams::Zero, &mut stream)
    /// };
    /// assert_eq!(read(&[]), Reading::Echo(6.0));
    /// assert_eq!(read(&smoke), Reading::Zero);
    /// ```
    pub fn read(
        &self,
        distance: Option<f64>,
        max_range: f64,
        stretches: &[Stretch],
        failed: FailedBeams,
        stream: &mut Stream,
    ) -> Reading {
        let end = distance.unwrap_or(max_range);
        let particles = self.particles(end, stretches);
        let end = particles.unwrap_or(end);
        let is_clear = distance.is_none() && stretches.is_empty();
        // A laser within particles measures nothing.
        let is_within = particles.is_some_and(|front| front <= 0.0);
        if is_clear || !(is_within || self.fails(end, stretches)) {
            let echo = particles.map(Reading::Phantom).or(distance.map(Reading::Echo));
            return echo.unwrap_or(Reading::NoEcho);
        }
        match failed {
            FailedBeams::None => Reading::NoEcho,
            FailedBeams::Zero => Reading::Zero,
            FailedBeams::Phantom => {
                phantom(end, stretches, stream.unit()).map_or(Reading::NoEcho, Reading::Phantom)
            }
        }
    }

    /// Returns the distance in metres at which a beam meets particles before `end`, which are as solid for the lasers
    /// of `USARSim`.
    fn particles(&self, end: f64, stretches: &[Stretch]) -> Option<f64> {
        if matches!(self, Laser::Physical { .. }) {
            return None;
        }
        let fronts = stretches.iter().filter(|s| s.is_particle && s.from < end).map(|s| s.from);
        fronts.min_by(f64::total_cmp)
    }

    /// Whether smoke stops a beam before a distance in metres, apart from particles.
    fn fails(&self, end: f64, stretches: &[Stretch]) -> bool {
        match *self {
            Laser::Physical { power_range } => {
                end * libm::exp(optical_depth(stretches, end)) > power_range
            }
            Laser::Hokuyo { budget } => optical_depth(stretches, end) > budget,
            Laser::Sick => false,
        }
    }
}

/// Returns the integral of the extinction coefficient along a ray up to a distance in metres.
pub(super) fn optical_depth(stretches: &[Stretch], end: f64) -> f64 {
    let depth = |s: &Stretch| s.extinction * (s.to.min(end) - s.from).max(0.0);
    stretches.iter().map(depth).sum()
}

/// Returns the distance of an echo from smoke before `end`, drawn with a uniform number in [0, 1). Its probability
/// density is proportional to the power that smoke scatters back, which is extinction * exp(-2 optical depth) /
/// r^2. `None` if there is no smoke that the detector sees.
fn phantom(end: f64, stretches: &[Stretch], uniform: f64) -> Option<f64> {
    let step = (end - OVERLAP[0]) / f64::from(PARTS);
    if step.is_nan() || step <= 0.0 {
        return None;
    }
    let middle = |part: u32| OVERLAP[0] + (f64::from(part) + 0.5) * step;
    let power = |part: u32| {
        let r = middle(part);
        let here = stretches.iter().filter(|s| (s.from..s.to).contains(&r));
        let extinction: f64 = here.map(|s| s.extinction).sum();
        let overlap = ((r - OVERLAP[0]) / (OVERLAP[1] - OVERLAP[0])).min(1.0);
        overlap * extinction * libm::exp(-2.0 * optical_depth(stretches, r)) / (r * r)
    };
    let powers: Vec<f64> = (0..PARTS).map(power).collect();
    let total: f64 = powers.iter().sum();
    if total.is_nan() || total <= 0.0 {
        return None;
    }
    let mut left = uniform * total;
    let mut last = None;
    for (part, &power) in (0..PARTS).zip(&powers).filter(|(_, power)| **power > 0.0) {
        if left < power {
            return Some(middle(part) + (left / power - 0.5) * step);
        }
        left -= power;
        last = Some(middle(part));
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::smoke::smoke_range;
    use crate::seed::Seed;
    use proptest::prelude::*;

    fn regional(from: f64, to: f64, extinction: f64) -> Stretch {
        Stretch { from, to, extinction, is_particle: false }
    }

    fn read(
        laser: Laser,
        distance: Option<f64>,
        smoke: &[Stretch],
        failed: FailedBeams,
    ) -> Reading {
        laser.read(distance, 20.0, smoke, failed, &mut Seed(1).stream("test", 0))
    }

    #[test]
    fn the_budget_of_a_hokuyo_is_exact() {
        let hokuyo = Laser::Hokuyo { budget: Laser::HOKUYO_BUDGET };
        // 5 m at a density of 0.00115 are the budget itself.
        let smoke = [regional(1.0, 6.0, 0.001_15)];
        let zero = |distance| read(hokuyo, distance, &smoke, FailedBeams::Zero);
        assert_eq!(zero(Some(5.9)), Reading::Echo(5.9));
        assert_eq!(zero(Some(6.0)), Reading::Echo(6.0));
        assert_eq!(zero(Some(9.0)), Reading::Echo(9.0));
        let thicker = [regional(1.0, 6.0, 0.001_16)];
        assert_eq!(read(hokuyo, Some(9.0), &thicker, FailedBeams::Zero), Reading::Zero);
        assert_eq!(read(hokuyo, Some(9.0), &thicker, FailedBeams::None), Reading::NoEcho);
        assert_eq!(read(hokuyo, Some(5.0), &thicker, FailedBeams::Zero), Reading::Echo(5.0));
        // Two regions on one ray share the budget.
        let two = [regional(0.0, 1.0, 0.003), regional(0.5, 2.0, 0.002)];
        assert_eq!(read(hokuyo, Some(1.8), &two, FailedBeams::Zero), Reading::Echo(1.8));
        assert_eq!(read(hokuyo, Some(1.9), &two, FailedBeams::Zero), Reading::Zero);
        assert_eq!(read(hokuyo, None, &two, FailedBeams::Zero), Reading::Zero);
        assert_eq!(read(hokuyo, None, &[], FailedBeams::Zero), Reading::NoEcho);
    }

    #[test]
    fn a_sick_sees_through_regions_and_not_through_particles() {
        let thick = [regional(0.0, 20.0, 50.0)];
        assert_eq!(read(Laser::Sick, Some(7.0), &thick, FailedBeams::Zero), Reading::Echo(7.0));
        let particles = [Stretch { is_particle: true, ..regional(3.0, 4.0, 1e-3) }];
        let hokuyo = Laser::Hokuyo { budget: Laser::HOKUYO_BUDGET };
        for laser in [Laser::Sick, hokuyo] {
            let found =
                |distance, smoke: &[Stretch]| read(laser, distance, smoke, FailedBeams::Zero);
            // As in USARSim's SICK.uc and HokuyoURG04LX.uc: the range to the particles, as to any object.
            assert_eq!(found(Some(7.0), &particles), Reading::Phantom(3.0));
            assert_eq!(found(None, &particles), Reading::Phantom(3.0));
            assert_eq!(found(Some(2.0), &particles), Reading::Echo(2.0));
            let within = [Stretch { is_particle: true, ..regional(0.0, 4.0, 1e-3) }];
            assert_eq!(found(Some(2.0), &within), Reading::Zero);
        }
        // The budget of a Hokuyo ends behind the particles, or before them.
        for (density, expected) in [(0.001, Reading::Phantom(3.0)), (0.002, Reading::Zero)] {
            let smoke = [particles[0], regional(0.0, 20.0, density)];
            assert_eq!(read(hokuyo, Some(7.0), &smoke, FailedBeams::Zero), expected);
        }
    }

    #[test]
    fn a_beam_that_meets_nothing_fails_only_in_smoke() {
        // A laser that reports as far as it sees.
        let laser = Laser::Physical { power_range: 20.0 };
        for failed in [FailedBeams::Zero, FailedBeams::Phantom, FailedBeams::None] {
            assert_eq!(read(laser, None, &[], failed), Reading::NoEcho);
            let weak = Laser::Physical { power_range: 5.0 };
            assert_eq!(read(weak, None, &[], failed), Reading::NoEcho);
        }
        assert_eq!(read(laser, None, &[regional(0.0, 5.0, 1.0)], FailedBeams::Zero), Reading::Zero);
    }

    #[test]
    fn phantoms_follow_their_law() {
        // Uniform smoke from 1 to 5 m: the mean distance against a fine integral of the law.
        let smoke = [regional(1.0, 5.0, 0.4)];
        let density = |r: f64| 0.4 * libm::exp(-0.8 * (r - 1.0)) / (r * r);
        let fine = (0..40_000).map(|i| 1.0 + (f64::from(i) + 0.5) * 1e-4);
        let (mass, moment) =
            fine.fold((0.0, 0.0), |(m, n), r| (m + density(r), n + r * density(r)));
        let mut stream = Seed(3).stream("test", 0);
        let mut draws = 0.0;
        for _ in 0..20_000 {
            let r = phantom(6.0, &smoke, stream.unit()).expect("smoke");
            assert!((0.98..5.02).contains(&r), "{r}");
            draws += r;
        }
        // Standard deviation 0.75 m: within five standard errors and the width of a part.
        assert!(
            (draws / 2e4 - moment / mass).abs() < 0.027 + 0.02,
            "{} {}",
            draws / 2e4,
            moment / mass
        );
    }

    #[test]
    fn without_smoke_in_view_there_is_no_phantom() {
        assert_eq!(phantom(6.0, &[], 0.5), None);
        assert_eq!(phantom(0.5, &[regional(0.0, 5.0, 9.0)], 0.5), None);
        assert_eq!(phantom(f64::NAN, &[regional(0.0, 5.0, 9.0)], 0.5), None);
    }

    proptest! {
        #[test]
        fn in_uniform_smoke_the_range_is_that_of_lambert(
            power_range in 5.0..40.0_f64, extinction in 0.01..5.0_f64, distance in 0.1..20.0_f64,
        ) {
            let range = smoke_range(power_range, extinction);
            prop_assume!((distance / range - 1.0).abs() > 1e-9);
            let smoke = [regional(0.0, 20.0, extinction)];
            let reading =
                read(Laser::Physical { power_range }, Some(distance), &smoke, FailedBeams::None);
            prop_assert_eq!(reading == Reading::Echo(distance), distance < range);
        }

        #[test]
        fn a_phantom_is_in_smoke_before_the_surface(
            a in 0.0..8.0_f64, length in 0.1..8.0_f64, extinction in 0.01..5.0_f64,
            end in 1.2..12.0_f64, uniform in 0.0..1.0_f64,
        ) {
            let smoke = [regional(a, a + length, extinction)];
            if let Some(r) = phantom(end, &smoke, uniform) {
                let part = 12.0 / f64::from(PARTS);
                prop_assert!(r <= end && r > a - part && r < a + length + part, "{r}");
            }
        }
    }
}
