//! The robot and the laser for which features are computed.

use std::f64::consts::{PI, TAU};

use crate::error::SpecError;
use crate::raycast::ScanPattern;
use crate::settings;

settings! {
    /// The properties of a robot, its laser and its wheels on which features depend. The defaults are those of
    /// mapping trials: a Pioneer 3-AT with a SICK LMS 200 in millimetre mode and the odometry of a skid-steered
    /// robot.
    ///
    /// ```
    /// use envgen::difficulty::Platform;
    ///
    /// let small = Platform { circumscribed_radius: 0.11, max_range: 3.5, ..Default::default() };
    /// assert!(small.validate().is_err(), "the laser would be 0.21 m ahead of the centre");
    /// let small = Platform { laser_offset: 0.0, ..small };
    /// assert_eq!(small.validate(), Ok(()));
    /// ```
    pub struct Platform {
        /// Radius of the circle that the robot's body sweeps when it turns on the spot.
        circumscribed_radius: f64 = 0.355 => number("m", 0.05..=2.0);
        /// Position of the laser ahead of the robot's centre, on the body.
        laser_offset: f64 = 0.21 => number("m", -2.0..=2.0);
        /// Number of beams, spread evenly over the field of view, both ends included.
        beams: u32 = 181 => integer("", 2..=4096);
        /// Field of view, centred ahead.
        field_of_view: f64 = PI => number("rad", 0.01..=TAU);
        /// Greatest range.
        max_range: f64 = 8.19 => number("m", 0.1..=200.0);
        /// Standard deviation of a range.
        sigma: f64 = 0.01 => number("m", 1e-4..=1.0);
        /// Variance of the odometry's distance per distance.
        k_ss: f64 = 2.5e-4 => number("m^2/m", 0.0..=1.0);
        /// Variance of the odometry's distance per turning.
        k_st: f64 = 1e-4 => number("m^2/rad", 0.0..=1.0);
        /// Variance of the odometry's turn per turning.
        k_tt: f64 = 1.2e-3 => number("rad^2/rad", 0.0..=1.0);
        /// Variance of the odometry's turn per distance.
        k_ts: f64 = 3e-5 => number("rad^2/m", 0.0..=1.0);
    }
}

/// The margin in metres that is added to a robot's circumscribed radius for planning, as in mapping trials.
pub(super) const MARGIN: f64 = 0.005;

impl Platform {
    /// Checks every number.
    ///
    /// # Errors
    /// Names the first field that is not allowed, such as `platform.beams`.
    pub fn validate(&self) -> Result<(), SpecError> {
        self.check().map_err(|error| error.within("platform"))
    }

    /// Sets a number from text, as `--platform name=value` does on the command line. The numbers together are
    /// checked by [`Platform::validate`].
    ///
    /// ```
    /// use envgen::difficulty::Platform;
    ///
    /// let mut platform = Platform::default();
    /// platform.set("max_range", "5.5")?;
    /// assert_eq!(platform.max_range, 5.5);
    /// let error = platform.set("beams", "1").unwrap_err();
    /// assert_eq!(error.field, "platform.beams");
    /// # Ok::<(), envgen::SpecError>(())
    /// ```
    ///
    /// # Errors
    /// When the number does not exist (the error lists those that do), or when the text is not one of its values.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), SpecError> {
        let Some(setting) = Self::SETTINGS.iter().find(|setting| setting.name == name) else {
            let known: Vec<_> = Self::SETTINGS.iter().map(|setting| setting.name).collect();
            return Err(SpecError::new("platform", name, format!("one of {}", known.join(", "))));
        };
        let wrong = || setting.error(value).within("platform");
        let value = setting.parse(value).map_err(|error| error.within("platform"))?;
        let mut all = serde_json::to_value(&*self).map_err(|_| wrong())?;
        all[setting.name] = value;
        *self = serde_json::from_value(all).map_err(|_| wrong())?;
        Ok(())
    }

    fn check(&self) -> Result<(), SpecError> {
        self.check_fields()?;
        let radius = self.circumscribed_radius;
        if self.laser_offset.abs() > radius {
            let allowed = format!("a number from -{radius} to {radius}: the laser is on the body");
            return Err(SpecError::new("laser_offset", self.laser_offset, allowed));
        }
        Ok(())
    }

    /// Returns the distance that the robot's centre keeps from solids, in metres.
    pub(crate) fn footprint(&self) -> f64 {
        self.circumscribed_radius + MARGIN
    }

    /// Returns the directions of the beams.
    pub(super) fn pattern(&self) -> Result<ScanPattern, SpecError> {
        ScanPattern::new(self.field_of_view, self.beams as usize)
            .map_err(|error| error.within("platform"))
    }

    /// Returns the angle between neighbouring beams in radians.
    pub(super) fn beam_step(&self) -> f64 {
        self.field_of_view / f64::from(self.beams - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_field_and_what_is_allowed() {
        let error = |platform: Platform| platform.validate().expect_err("not allowed").to_string();
        let radius = error(Platform { circumscribed_radius: f64::NAN, ..Default::default() });
        assert_eq!(
            radius,
            "`platform.circumscribed_radius` must be a number from 0.05 to 2, got NaN"
        );
        let beams = error(Platform { beams: 1, ..Default::default() });
        assert_eq!(beams, "`platform.beams` must be a whole number from 2 to 4096, got 1");
        let offset = error(Platform { laser_offset: -0.4, ..Default::default() });
        assert!(offset.ends_with("to 0.355, got -0.4: the laser is on the body"), "{offset}");
        assert_eq!(Platform::default().validate(), Ok(()));
    }

    #[test]
    fn numbers_are_set_from_text() {
        let mut platform = Platform::default();
        for setting in Platform::SETTINGS {
            let error = platform.set(setting.name, "-9").expect_err("too little").to_string();
            assert!(error.starts_with(&format!("`platform.{}` must be", setting.name)), "{error}");
        }
        assert_eq!(platform, Platform::default());
        assert_eq!(platform.set("beams", " 91 "), Ok(()));
        assert_eq!(platform.set("max_range", "20"), Ok(()));
        assert_eq!(platform, Platform { beams: 91, max_range: 20.0, ..Default::default() });
        let error = platform.set("wheels", "4").expect_err("unknown").to_string();
        assert!(error.starts_with("`platform` must be one of circumscribed_radius, "), "{error}");
    }
}
