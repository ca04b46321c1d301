//! Laser scanners: their profiles, scans and errors.

mod in_scenario;
mod profile;
mod scan;

use std::f64::consts::TAU;

use envgen::Seed;

pub use in_scenario::{Rays, ScenarioSight};
pub use profile::LaserProfile;
pub use scan::{NO_ECHO, Scan, UNSEEN};

/// Random numbers drawn per beam, whether they are used or not, so that the errors of a beam do not
/// depend on other beams.
const DRAWS_A_BEAM: usize = 4;

/// Least difference in metres between neighbouring ranges at which one beam can hit both surfaces.
const MIXED_PIXEL_JUMP: f64 = 0.3;

/// A model of a laser scanner, which turns exact ranges into measured ones. The built-in model is
/// [`Laser`].
///
/// The trial's [`LaserProfile`] always sets the beams, the field of view, the greatest range and the
/// scan rate, whatever the sensor returns. In particular, [`NO_ECHO`] means that a beam is free up to
/// the profile's greatest range.
///
/// A custom model is plugged in with [`TrialBuilder::laser`](crate::trial::TrialBuilder::laser).
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
/// use mapping_trial::lidar::{LaserSensor, Scan, UNSEEN};
/// use mapping_trial::trial::{Trial, TrialSettings};
///
/// /// A laser to which nothing beyond 2 m is bright enough. No echo would say that 8 m are free there.
/// struct Weak;
///
/// impl LaserSensor for Weak {
///     fn measure(&mut self, exact: &[f64]) -> Scan {
///         let range = |&exact: &f64| if exact <= 2.0 { exact } else { UNSEEN };
///         Scan { ranges: exact.iter().map(range).collect() }
///     }
/// }
///
/// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
/// let settings = TrialSettings { time_limit: 1.0, ..Default::default() };
/// let mut trial = Trial::builder(&world, settings).laser(|_, _| Weak).build_flat()?;
/// while trial.step() {}
/// let ranges = &trial.autonomy().scan(0).ranges;
/// assert!(ranges.iter().all(|&range| range <= 2.0 || range.is_nan()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait LaserSensor {
    /// Returns the name of a plugged-in sensor for logs and reports. The default is the path of the
    /// type.
    fn name(&self) -> &str {
        std::any::type_name::<Self>()
    }

    /// Returns the next scan, given the exact ranges, one per beam. A range of the profile's
    /// `max_range` or more has no echo; NaN ([`UNSEEN`]) is an echo that is too weak.
    fn measure(&mut self, exact: &[f64]) -> Scan;
}

/// The built-in model of a laser scanner: the laser of one robot in one run.
///
/// ```
/// use envgen::Seed;
/// use mapping_trial::lidar::{Laser, LaserProfile, LaserSensor, NO_ECHO};
///
/// let profile = LaserProfile { beams: 3, ..LaserProfile::LMS200_MM };
/// let mut laser = Laser::new(profile, Seed(7), 0);
/// let scan = laser.measure(&[1.0, 2.0, 100.0]);
/// assert!((scan.ranges[0] - 1.0).abs() < 0.1);
/// assert_eq!(scan.ranges[2], NO_ECHO);
/// ```
#[derive(Clone, Debug)]
pub struct Laser {
    profile: LaserProfile,
    seed: Seed,
    robot: u64,
    scans: u64,
}

impl Laser {
    /// Creates the laser of robot number `robot` (from 0). Its noise is drawn from `seed`.
    ///
    /// # Panics
    ///
    /// If [`LaserProfile::validate`] rejects the profile.
    #[track_caller]
    pub fn new(profile: LaserProfile, seed: Seed, robot: u64) -> Self {
        if let Err(error) = profile.validate() {
            panic!("{error}");
        }
        Laser { profile, seed, robot, scans: 0 }
    }
}

impl LaserSensor for Laser {
    fn measure(&mut self, exact: &[f64]) -> Scan {
        let mut draws = self.seed.attempt("trial/laser", self.robot, self.scans);
        self.scans += 1;
        let p = &self.profile;
        let ranges = exact.iter().enumerate().map(|(beam, &range)| {
            let [angle, radius, fault, place] =
                std::array::from_fn::<_, DRAWS_A_BEAM, _>(|_| draws.unit());
            if range.is_nan() {
                return range;
            }
            let mut range = range;
            if p.mixed_pixel > 0.0 && fault < p.mixed_pixel {
                let next = exact.get(beam + 1).filter(|next| !next.is_nan());
                let next = next.map_or(range, |&next| next.min(p.max_range));
                let here = range.min(p.max_range);
                if (next - here).abs() > MIXED_PIXEL_JUMP {
                    range = here + place * (next - here);
                }
            }
            // One random number decides on all faults of a beam: the rarest faults are at its upper
            // end.
            if fault >= 1.0 - p.dropout {
                return f64::NAN;
            }
            if fault >= 1.0 - p.dropout - p.short {
                range = place * range.min(p.max_range);
            }
            if range >= p.max_range {
                return NO_ECHO;
            }
            if p.sigma > 0.0 {
                // The method of Box and Muller always takes two numbers, unlike the polar method.
                let normal = (-2.0 * libm::log(1.0 - radius)).sqrt() * libm::cos(TAU * angle);
                range += p.sigma * normal;
            }
            if p.range_step > 0.0 {
                range = rounded(range / p.range_step) * p.range_step;
            }
            if range >= p.max_range { NO_ECHO } else { range.max(0.0) }
        });
        Scan { ranges: ranges.collect() }
    }
}

/// Rounds as [`f64::round`], which is a function call on most processors.
#[inline]
fn rounded(number: f64) -> f64 {
    // Numbers from here on are integers.
    const WHOLE: f64 = (1_u64 << 52) as f64;
    if number.is_nan() || number.abs() >= WHOLE {
        return number;
    }
    let towards_zero = number as i64 as f64;
    let away = f64::from(u8::from((number - towards_zero).abs() >= 0.5));
    (towards_zero.abs() + away).copysign(number)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn numbers_are_rounded_as_the_standard_library_does(
            number in any::<f64>(), halves in -20_i32..20, next: bool,
        ) {
            let half = 0.5 * f64::from(halves);
            let beside = if next { half.next_up() } else { half.next_down() };
            for number in [number, half, beside, number.fract(), -0.0] {
                prop_assert_eq!(rounded(number).to_bits(), number.round().to_bits());
            }
        }
    }

    #[test]
    #[should_panic(expected = "`laser.beams` must be a whole number from 1 to 4096, got 0")]
    fn a_laser_has_beams() {
        Laser::new(LaserProfile { beams: 0, ..LaserProfile::USARSIM }, Seed(0), 0);
    }

    #[test]
    fn every_number_of_a_laser_is_checked() {
        for field in ["field_of_view", "max_range", "range_step", "sigma", "dropout", "short"] {
            let mut profile = serde_json::to_value(LaserProfile::USARSIM).expect("JSON");
            profile[field] = (-1.0).into();
            let profile: LaserProfile = serde_json::from_value(profile).expect("a profile");
            let error = profile.validate().expect_err("it is negative").to_string();
            assert!(error.starts_with(&format!("`laser.{field}` must be ")), "{error}");
        }
    }

    proptest! {
        #[test]
        fn faults_of_a_beam_sum_to_one_at_most(
            dropout in 0.0..=1.0_f64, short in 0.0..=1.0_f64, mixed_pixel in 0.0..=1.0_f64,
            part in 0.0..=1.0_f64,
        ) {
            let profile = LaserProfile { dropout, short, mixed_pixel, ..LaserProfile::LMS200_MM };
            let sum = dropout + short + mixed_pixel;
            prop_assert_eq!(profile.validate().is_ok(), sum <= 1.0 + 1e-9);
            prop_assert_eq!(profile.fan().is_ok(), sum <= 1.0 + 1e-9);
            // Parts of a whole are allowed whatever their rounding.
            let (dropout, rest) = (part * dropout, 1.0 - part * dropout);
            let whole = LaserProfile { dropout, short: rest * short, mixed_pixel: rest * (1.0 - short), ..profile };
            prop_assert_eq!(whole.validate(), Ok(()));
        }
    }

    #[test]
    fn faults_that_sum_to_one_are_as_frequent_as_stated() {
        let (dropout, short, mixed_pixel) = (0.25, 0.25, 0.5);
        let profile =
            LaserProfile { dropout, short, mixed_pixel, sigma: 0.0, ..LaserProfile::LMS200_MM };
        let mut laser = Laser::new(profile, Seed(4), 0);
        let n = 4000;
        let (mut lost, mut early, mut mixed) = (0.0, 0.0, 0.0);
        for _ in 0..n {
            let range = laser.measure(&[2.0, 6.0]).ranges[0];
            lost += f64::from(range.is_nan());
            early += f64::from(range < 2.0);
            mixed += f64::from(range > 2.0);
        }
        // Binomial counts within four standard deviations.
        let near =
            |count: f64, p: f64| (count - f64::from(n) * p).abs() < 4.0 * (f64::from(n) * p).sqrt();
        assert!(near(lost, dropout) && near(early, short), "{lost} lost, {early} early");
        assert!(near(mixed, mixed_pixel), "{mixed} mixed");
    }

    #[test]
    fn draws_of_a_beam_depend_on_nothing_else() {
        let mut alone = Laser::new(LaserProfile::LMS200_MM_ROUGH, Seed(4), 0);
        let mut among = alone.clone();
        let ranges = vec![5.0; 181];
        let mut others = ranges.clone();
        others[..40].fill(20.0);
        others[42..].fill(0.5);
        let (a, b) = (alone.measure(&ranges), among.measure(&others));
        assert_eq!(a.ranges[40].to_bits(), b.ranges[40].to_bits());
        assert_ne!(a, alone.measure(&ranges), "every scan has draws of its own");
    }

    #[test]
    fn noise_has_the_deviation_of_the_profile() {
        let mut laser = Laser::new(LaserProfile::LMS200_MM, Seed(4), 1);
        let errors: Vec<f64> = (0..100)
            .flat_map(|_| laser.measure(&[5.0; 181]).ranges)
            .map(|range| range - 5.0)
            .collect();
        let n = errors.len() as f64;
        let mean = errors.iter().sum::<f64>() / n;
        let variance = errors.iter().map(|e| e * e).sum::<f64>() / n;
        // Within four standard deviations of 18 100 draws; steps of 1 mm add a twelfth of 1e-6.
        assert!(mean.abs() < 4.0 * 0.01 / n.sqrt(), "{mean}");
        assert!((variance / (1e-4 + 1e-6 / 12.0) - 1.0).abs() < 4.0 * (2.0 / n).sqrt());
        assert!(errors.iter().all(|e| (e * 1000.0 - (e * 1000.0).round()).abs() < 1e-6));
    }

    #[test]
    fn a_rough_laser_loses_shortens_and_mixes() {
        let mut laser = Laser::new(LaserProfile::LMS200_MM_ROUGH, Seed(4), 0);
        // Beam 90 sees a post, beam 91 the wall behind it.
        let exact: Vec<f64> = (0..181).map(|beam| if beam <= 90 { 2.0 } else { 6.0 }).collect();
        let n = 4000;
        let (mut lost, mut early, mut mixed) = (0.0, 0.0, 0.0);
        for _ in 0..n {
            let scan = laser.measure(&exact);
            let between = |beam: usize| (2.1..5.9).contains(&scan.ranges[beam]);
            lost += scan.ranges.iter().filter(|range| range.is_nan()).count() as f64;
            mixed += f64::from(between(90));
            early += (0..90).filter(|&beam| scan.ranges[beam] < 1.9).count() as f64;
        }
        let beams = 181.0 * f64::from(n);
        // Binomial counts within four standard deviations.
        let near = |count: f64, p: f64, n: f64| (count - n * p).abs() < 4.0 * (n * p).sqrt();
        assert!(near(lost, 0.005, beams), "{lost} lost");
        assert!(near(early, 0.001 * 0.95, 90.0 * f64::from(n)), "{early} early");
        assert!(near(mixed, 0.3 * 3.8 / 4.0, f64::from(n)), "{mixed} mixed");
    }

    #[test]
    fn what_is_too_dark_is_neither_echo_nor_free() {
        for profile in
            [LaserProfile::USARSIM, LaserProfile::LMS200_MM, LaserProfile::LMS200_MM_ROUGH]
        {
            let mut laser = Laser::new(profile, Seed(4), 0);
            let mut light = laser.clone();
            let mut exact = vec![5.0; 60];
            let all = light.measure(&exact);
            exact[20] = UNSEEN;
            let seen = laser.measure(&exact);
            assert!(seen.ranges[20].is_nan());
            let same = |i: usize| seen.ranges[i].to_bits() == all.ranges[i].to_bits();
            assert!((0..60).filter(|&i| i != 20).all(same));
        }
    }

    #[test]
    fn far_is_no_echo_and_never_negative() {
        let mut laser = Laser::new(LaserProfile::LMS200_MM, Seed(4), 0);
        let scan = laser.measure(&[8.19, 9.0, f64::INFINITY, 0.0, 0.001]);
        assert!(scan.ranges[..3].iter().all(|&range| range == NO_ECHO));
        assert!(scan.ranges[3..].iter().all(|&range| (0.0..0.1).contains(&range)));
        let mut usarsim = Laser::new(LaserProfile::USARSIM, Seed(4), 0);
        assert_eq!(usarsim.measure(&[1.234, 19.999]).ranges, [1.23, NO_ECHO]);
    }
}
