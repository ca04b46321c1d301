//! Laser profiles: what lasers measure and how accurate they are.

use std::f64::consts::{PI, TAU};

use envgen::raycast::ScanPattern;
use envgen::scenario::{SmokeProfile, smoke};
use envgen::{SpecError, settings};

/// Range in metres to bright walls that SICK's LMS 200 has without smoke. It is more than the laser
/// reports.
const SICK_RANGE: f64 = 30.0;

/// The range that lasers would have without smoke is at least this many times what they report.
const RESERVE: f64 = 1.1;

/// Tolerance of the sum of probabilities, since decimal numbers are rounded.
const ROUNDING: f64 = 1e-9;

settings! {
    /// The beams, the range and the errors of a laser.
    ///
    /// ```
    /// use mapping_trial::lidar::LaserProfile;
    ///
    /// // The default is SICK's LMS 200: 181 beams over 180 degrees, 5 scans per second.
    /// let laser = LaserProfile::default();
    /// assert_eq!((laser.beams, laser.ticks_a_scan), (181, 4));
    /// assert_eq!(laser.fan()?.len(), 181);
    /// let blind = LaserProfile { max_range: 0.0, ..laser };
    /// assert_eq!(blind.validate().unwrap_err().field, "laser.max_range");
    /// # Ok::<(), envgen::SpecError>(())
    /// ```
    pub struct LaserProfile {
        /// Number of beams, spread evenly over the field of view, both ends included.
        beams: u32 = LaserProfile::LMS200_MM.beams => integer("", 1..=4096);
        /// Field of view, centred ahead.
        field_of_view: f64 = LaserProfile::LMS200_MM.field_of_view => number("rad", 0.0..=TAU);
        /// Greatest range.
        max_range: f64 = LaserProfile::LMS200_MM.max_range => number("m", 0.1..=200.0);
        /// Step of the ranges, which are rounded to its multiples; 0 for no rounding.
        range_step: f64 = LaserProfile::LMS200_MM.range_step => number("m", 0.0..=1.0);
        /// Standard deviation of a range.
        sigma: f64 = LaserProfile::LMS200_MM.sigma => number("m", 0.0..=1.0);
        /// Ticks from one scan to the next.
        ticks_a_scan: u32 = LaserProfile::LMS200_MM.ticks_a_scan => integer("", 1..=200);
        /// Probability that a beam is lost.
        dropout: f64 = LaserProfile::LMS200_MM.dropout => number("", 0.0..=1.0);
        /// Probability that a beam returns too short a range.
        short: f64 = LaserProfile::LMS200_MM.short => number("", 0.0..=1.0);
        /// Probability that a beam at an edge, where ranges jump, returns a range between the two.
        mixed_pixel: f64 = LaserProfile::LMS200_MM.mixed_pixel => number("", 0.0..=1.0);
    }
}

impl LaserProfile {
    /// USARSim's laser, which is exact except for its steps of 1 cm.
    pub const USARSIM: LaserProfile = LaserProfile {
        beams: 181,
        field_of_view: PI,
        max_range: 20.0,
        range_step: 0.01,
        sigma: 0.0,
        ticks_a_scan: 4,
        dropout: 0.0,
        short: 0.0,
        mixed_pixel: 0.0,
    };
    /// SICK's LMS 200 in millimetre mode, which is the default.
    pub const LMS200_MM: LaserProfile =
        LaserProfile { max_range: 8.19, range_step: 0.001, sigma: 0.01, ..LaserProfile::USARSIM };
    /// SICK's LMS 200 with the errors of real scans: lost, early and mixed echoes.
    pub const LMS200_MM_ROUGH: LaserProfile =
        LaserProfile { dropout: 0.005, short: 0.001, mixed_pixel: 0.3, ..LaserProfile::LMS200_MM };
    /// Hokuyo's URG-04LX, of which every third beam and every second scan is used.
    pub const URG_04LX: LaserProfile = LaserProfile {
        beams: 229,
        field_of_view: 4.0 / 3.0 * PI,
        max_range: 5.6,
        ..LaserProfile::LMS200_MM
    };
    /// A laser with a field of view of 270 degrees, a range of 12 m and one beam per degree, otherwise
    /// as SICK's LMS 200.
    pub const WIDE_12M: LaserProfile = LaserProfile {
        beams: 271,
        field_of_view: 1.5 * PI,
        max_range: 12.0,
        ..LaserProfile::LMS200_MM
    };

    /// Returns the model of this laser in smoke.
    ///
    /// Without smoke, every laser would see at least 1.1 times its `max_range`: what is so thin that
    /// nobody sees it stops no beam. A laser with a field of view of at most 180 degrees counts as a
    /// SICK, which would see at least 30 m. Any other laser counts as a Hokuyo.
    ///
    /// ```
    /// use envgen::scenario::{SmokeProfile, smoke};
    /// use mapping_trial::lidar::LaserProfile;
    ///
    /// let physical = LaserProfile::LMS200_MM.in_smoke(SmokeProfile::Physical);
    /// assert_eq!(physical, smoke::Laser::Physical { power_range: 30.0 });
    /// // 240 degrees: a Hokuyo.
    /// let hokuyo = LaserProfile::URG_04LX.in_smoke(SmokeProfile::Usarsim);
    /// assert!(matches!(hokuyo, smoke::Laser::Hokuyo { .. }));
    /// ```
    pub fn in_smoke(&self, profile: SmokeProfile) -> smoke::Laser {
        let is_sick = self.field_of_view <= PI;
        match profile {
            SmokeProfile::Physical => {
                let least = RESERVE * self.max_range;
                let power_range = if is_sick { least.max(SICK_RANGE) } else { least };
                smoke::Laser::Physical { power_range }
            }
            SmokeProfile::Usarsim if is_sick => smoke::Laser::Sick,
            SmokeProfile::Usarsim => smoke::Laser::Hokuyo { budget: smoke::Laser::HOKUYO_BUDGET },
        }
    }

    /// Checks every number.
    ///
    /// # Errors
    ///
    /// Names the first field whose value is not allowed, such as `laser.beams`. The probabilities
    /// `dropout`, `short` and `mixed_pixel` must sum to at most 1, since a beam has one fault at most.
    ///
    /// ```
    /// use mapping_trial::lidar::LaserProfile;
    ///
    /// let laser = LaserProfile { dropout: 0.5, short: 0.5, ..LaserProfile::LMS200_MM };
    /// assert_eq!(laser.validate(), Ok(()));
    /// let error = LaserProfile { mixed_pixel: 0.25, ..laser }.validate().unwrap_err().to_string();
    /// let expected = "`laser.mixed_pixel` must be so small that `dropout`, `short` and `mixed_pixel` \
    ///                 sum to at most 1, got 0.25";
    /// assert!(error.starts_with(expected), "{error}");
    /// ```
    pub fn validate(&self) -> Result<(), SpecError> {
        self.check_fields()
            .and_then(|()| self.check_faults())
            .map_err(|error| error.within("laser"))
    }

    /// Checks that no beam would have two faults, which one random number decides on.
    fn check_faults(&self) -> Result<(), SpecError> {
        let LaserProfile { dropout, short, mixed_pixel, .. } = *self;
        let sum = dropout + short + mixed_pixel;
        if sum <= 1.0 + ROUNDING {
            return Ok(());
        }
        let (field, value) =
            if mixed_pixel > 0.0 { ("mixed_pixel", mixed_pixel) } else { ("short", short) };
        let allowed = format!(
            "so small that `dropout`, `short` and `mixed_pixel` sum to at most 1: a beam has one \
             fault at most, and they sum to {sum}"
        );
        Err(SpecError::new(field, value, allowed))
    }

    /// Returns the angle of a beam relative to the laser's heading, in radians. Beams are counted from
    /// right to left.
    ///
    /// ```
    /// use std::f64::consts::FRAC_PI_2;
    ///
    /// use mapping_trial::lidar::LaserProfile;
    ///
    /// // From 90 degrees on the right to 90 degrees on the left.
    /// let laser = LaserProfile::LMS200_MM;
    /// assert_eq!(laser.angle(0), -FRAC_PI_2);
    /// assert!(laser.angle(90).abs() < 1e-12);
    /// assert!((laser.angle(180) - FRAC_PI_2).abs() < 1e-12);
    /// ```
    pub fn angle(&self, beam: usize) -> f64 {
        let step = self.field_of_view / f64::from(self.beams.saturating_sub(1).max(1));
        let first = if self.beams > 1 { -0.5 * self.field_of_view } else { 0.0 };
        first + step * beam as f64
    }

    /// Returns the directions of the beams, to cast them with
    /// [`Raycaster::scan`](envgen::raycast::Raycaster::scan).
    ///
    /// # Errors
    ///
    /// Names the first field whose value is not allowed.
    pub fn fan(&self) -> Result<ScanPattern, SpecError> {
        self.validate()?;
        ScanPattern::new(self.field_of_view, self.beams as usize)
    }
}
