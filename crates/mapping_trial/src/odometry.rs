//! Wheel odometry: what wheel encoders measure of a motion.

use envgen::distribution::standard_normal;
use envgen::{Seed, SpecError, Stream, settings};
use serde::{Deserialize, Serialize};

/// A small motion in the robot's own frame, such as that of one tick: a distance ahead and a turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Increment {
    /// Distance ahead in metres, negative backwards.
    pub distance: f64,
    /// Turn in radians, counter-clockwise.
    pub turn: f64,
}

settings! {
    /// The errors of wheel odometry.
    ///
    /// Random errors have variances that are proportional to the motion, so that they do not depend on
    /// how often the wheels are read. Systematic errors are drawn once per run.
    ///
    /// ```
    /// use envgen::Seed;
    /// use mapping_trial::odometry::{Increment, Odometry, OdometryProfile, WheelSensor};
    ///
    /// // Over 100 m in steps of 2 cm, the errors of the default wheels add up to some metres at most.
    /// let drive = |profile| {
    ///     let mut wheels = Odometry::new(profile, Seed(7), 0);
    ///     let tick = Increment { distance: 0.02, turn: 0.0 };
    ///     (0..5000).map(|_| wheels.measure(tick, 1.0).distance).sum::<f64>()
    /// };
    /// assert!((drive(OdometryProfile::EXACT) - 100.0).abs() < 1e-9);
    /// let error = (drive(OdometryProfile::default()) - 100.0).abs();
    /// assert!(error > 1e-6 && error < 6.0);
    /// ```
    pub struct OdometryProfile {
        /// Variance of the measured distance per metre of distance.
        k_ss: f64 = OdometryProfile::SKID.k_ss => number("m^2/m", 0.0..=1.0);
        /// Variance of the measured distance per radian of turning.
        k_st: f64 = OdometryProfile::SKID.k_st => number("m^2/rad", 0.0..=1.0);
        /// Variance of the measured turn per radian of turning.
        k_tt: f64 = OdometryProfile::SKID.k_tt => number("rad^2/rad", 0.0..=1.0);
        /// Variance of the measured turn per metre of distance.
        k_ts: f64 = OdometryProfile::SKID.k_ts => number("rad^2/m", 0.0..=1.0);
        /// Standard deviation of the relative error of distances, which is drawn once per run.
        b_s: f64 = OdometryProfile::SKID.b_s => number("", 0.0..=1.0);
        /// Standard deviation of the relative error of turns, which is drawn once per run.
        b_t: f64 = OdometryProfile::SKID.b_t => number("", 0.0..=1.0);
    }
}

impl OdometryProfile {
    /// The wheels of a robot on good ground.
    pub const MILD: OdometryProfile = OdometryProfile {
        k_ss: 2.5e-4,
        k_st: 1e-5,
        k_tt: 4.4e-4,
        k_ts: 3e-5,
        b_s: 0.015,
        b_t: 0.025,
    };
    /// The wheels of a skid-steered robot, which are the default.
    pub const SKID: OdometryProfile =
        OdometryProfile { k_st: 1e-4, k_tt: 1.2e-3, b_t: 0.05, ..OdometryProfile::MILD };
    /// The wheels of a skid-steered robot that slips.
    pub const POOR: OdometryProfile =
        OdometryProfile { k_tt: 3e-3, b_t: 0.10, ..OdometryProfile::SKID };
    /// Wheels that measure exactly.
    pub const EXACT: OdometryProfile =
        OdometryProfile { k_ss: 0.0, k_st: 0.0, k_tt: 0.0, k_ts: 0.0, b_s: 0.0, b_t: 0.0 };
}

impl OdometryProfile {
    /// Checks every number.
    ///
    /// # Errors
    ///
    /// Names the first field whose value is not allowed, such as `odometry.k_ss`.
    pub fn validate(&self) -> Result<(), SpecError> {
        self.check_fields().map_err(|error| error.within("odometry"))
    }
}

/// A model of wheel encoders, which turns true motions into measured ones. The built-in model is
/// [`Odometry`].
///
/// A custom model is plugged in with [`TrialBuilder::odometry`](crate::trial::TrialBuilder::odometry).
pub trait WheelSensor {
    /// Returns the name of a plugged-in sensor for logs and reports. The default is the path of the
    /// type.
    fn name(&self) -> &str {
        std::any::type_name::<Self>()
    }

    /// Returns the measured motion of a tick, given the true one. The ground multiplies the variances
    /// of the errors by `factor`.
    fn measure(&mut self, motion: Increment, factor: f64) -> Increment;
}

/// The built-in model of wheel encoders: the wheels of one robot in one run.
///
/// ```
/// use envgen::Seed;
/// use mapping_trial::odometry::{Increment, Odometry, OdometryProfile, WheelSensor};
///
/// let mut wheels = Odometry::new(OdometryProfile::SKID, Seed(7), 0);
/// let tick = Increment { distance: 0.02, turn: 0.01 };
/// let measured = wheels.measure(tick, 1.0);
/// assert!(measured != tick && (measured.distance - tick.distance).abs() < 0.02);
/// ```
#[derive(Debug)]
pub struct Odometry {
    profile: OdometryProfile,
    distance_scale: f64,
    turn_scale: f64,
    noise: Stream,
}

impl Odometry {
    /// Creates the wheels of robot number `robot` (from 0). Their noise is drawn from `seed`.
    ///
    /// # Panics
    ///
    /// If [`OdometryProfile::validate`] rejects the profile.
    #[track_caller]
    pub fn new(profile: OdometryProfile, seed: Seed, robot: u64) -> Self {
        if let Err(error) = profile.validate() {
            panic!("{error}");
        }
        let mut run = seed.stream("trial/odometry_bias", robot);
        Odometry {
            distance_scale: 1.0 + profile.b_s * standard_normal(&mut run),
            turn_scale: 1.0 + profile.b_t * standard_normal(&mut run),
            noise: seed.stream("trial/odometry", robot),
            profile,
        }
    }
}

impl WheelSensor for Odometry {
    fn measure(&mut self, motion: Increment, factor: f64) -> Increment {
        let (length, turn) = (motion.distance.abs(), motion.turn.abs());
        if length == 0.0 && turn == 0.0 {
            return motion;
        }
        let p = &self.profile;
        let distance = (factor * (p.k_ss * length + p.k_st * turn)).sqrt();
        let angle = (factor * (p.k_tt * turn + p.k_ts * length)).sqrt();
        Increment {
            distance: motion.distance * self.distance_scale
                + distance * standard_normal(&mut self.noise),
            turn: motion.turn * self.turn_scale + angle * standard_normal(&mut self.noise),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[should_panic(expected = "`odometry.k_st` must be a number from 0 to 1, got NaN")]
    fn wheels_have_errors_that_are_numbers() {
        Odometry::new(OdometryProfile { k_st: f64::NAN, ..OdometryProfile::MILD }, Seed(0), 0);
    }

    /// Mean and variance of the distance measured in many runs, each cut into `steps`.
    fn distances(steps: u32, profile: &OdometryProfile) -> (f64, f64) {
        let runs = 2000;
        let totals: Vec<f64> = (0..runs)
            .map(|run| {
                let mut wheels = Odometry::new(profile.clone(), Seed(3), run);
                let part = Increment { distance: 10.0 / f64::from(steps), turn: 0.0 };
                (0..steps).map(|_| wheels.measure(part, 1.0).distance).sum()
            })
            .collect();
        let mean = totals.iter().sum::<f64>() / runs as f64;
        let variance = totals.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / runs as f64;
        (mean, variance)
    }

    #[test]
    fn errors_do_not_depend_on_the_step() {
        let profile = OdometryProfile { b_s: 0.0, ..OdometryProfile::SKID };
        // k_ss times 10 m. The variance of 2000 normals is within 12 % at four standard deviations
        // (sqrt(2 / 2000) = 3.2 %), the mean within 4 sqrt(2.5e-3 / 2000) = 4.5 mm.
        for steps in [1, 20, 500] {
            let (mean, variance) = distances(steps, &profile);
            assert!((mean - 10.0).abs() < 4.5e-3, "{steps} steps: mean {mean}");
            assert!((variance / 2.5e-3 - 1.0).abs() < 0.13, "{steps} steps: {variance}");
        }
    }

    #[test]
    fn a_run_has_one_systematic_error() {
        let profile = OdometryProfile { k_ss: 0.0, k_st: 0.0, ..OdometryProfile::SKID };
        let (mean, variance) = distances(10, &profile);
        // Relative errors of deviation 1.5 % over 10 m.
        assert!((mean - 10.0).abs() < 4.0 * 0.15 / 2000_f64.sqrt(), "{mean}");
        assert!((variance / (0.15 * 0.15) - 1.0).abs() < 0.13, "{variance}");
        let mut wheels = Odometry::new(profile, Seed(3), 5);
        let part = Increment { distance: 0.1, turn: 0.0 };
        let first = wheels.measure(part, 1.0).distance;
        assert!((0..50).all(|_| wheels.measure(part, 1.0).distance == first));
    }

    #[test]
    fn a_robot_at_rest_measures_nothing() {
        let mut wheels = Odometry::new(OdometryProfile::POOR, Seed(3), 0);
        let still = Increment::default();
        assert!((0..50).all(|_| wheels.measure(still, 9.0) == still));
    }

    #[test]
    fn exact_wheels_are_exact() {
        let mut wheels = Odometry::new(OdometryProfile::EXACT, Seed(3), 0);
        let motion = Increment { distance: 0.3, turn: -0.2 };
        assert_eq!(wheels.measure(motion, 1.0), motion);
    }
}
