//! Turns: the radius of a turn of a given length.

use serde::{Deserialize, Serialize};
use strum::VariantNames;

use crate::seed::Stream;

/// Acceleration of gravity in m/s^2.
pub const GRAVITY: f64 = 9.81;

/// The quantity of a turn that is uniformly distributed between its limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum TurnLaw {
    /// The radius, as published.
    UniformRadius,
    /// The angle.
    UniformAngle,
}

/// The limits of a road's turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnLimits {
    /// Least angle in radians.
    pub theta_min: f64,
    /// Greatest angle in radians.
    pub theta_max: f64,
    /// Least radius in metres, as required by friction, the road's width and the spec.
    pub least_radius: f64,
    /// Share of a turn's length that each of its two clothoids takes, from 0 to 0.5.
    pub transition: f64,
}

impl TurnLimits {
    /// Returns the length in metres of a turn as if it kept its greatest curvature throughout. A clothoid counts
    /// half, so this is the turn's angle times its least radius.
    pub fn effective(&self, length: f64) -> f64 {
        (1.0 - self.transition) * length
    }

    /// Returns the length in metres of the shortest turn that the limits allow.
    pub fn shortest(&self) -> f64 {
        self.theta_min * self.least_radius / (1.0 - self.transition)
    }

    /// Returns the least and the greatest radius in metres of a turn of the given length. The first exceeds the
    /// second if no radius is allowed.
    ///
    /// ```
    /// use std::f64::consts::FRAC_PI_2;
    ///
    /// use envgen::road::TurnLimits;
    ///
    /// // Turns of 45 to 90 degrees, of at least 10 m radius, without clothoids.
    /// let (theta_min, theta_max) = (0.5 * FRAC_PI_2, FRAC_PI_2);
    /// let limits = TurnLimits { theta_min, theta_max, least_radius: 10.0, transition: 0.0 };
    /// // An arc of radius r that is r pi / 2 long turns by 90 degrees.
    /// let (least, greatest) = limits.radii(20.0 * FRAC_PI_2);
    /// assert!((least - 20.0).abs() < 1e-9 && (greatest - 40.0).abs() < 1e-9);
    /// ```
    pub fn radii(&self, length: f64) -> (f64, f64) {
        let effective = self.effective(length);
        (self.least_radius.max(effective / self.theta_max), effective / self.theta_min)
    }

    /// Draws the least radius, in metres, of a turn of the given length, such that the radius or the angle is
    /// uniformly distributed between its limits; `None` if no radius is allowed.
    pub fn draw(&self, length: f64, law: TurnLaw, stream: &mut Stream) -> Option<f64> {
        self.place(length, law, |low, high| stream.between(low, high))
    }

    /// Like `draw`, but the radius or the angle lies at a share, from 0 to 1, of the distance between its limits.
    pub(super) fn at(&self, length: f64, law: TurnLaw, share: f64) -> Option<f64> {
        self.place(length, law, |low, high| low + (high - low) * share)
    }

    /// Like `draw`, but `between` chooses the radius or the angle between its limits.
    fn place(
        &self,
        length: f64,
        law: TurnLaw,
        between: impl FnOnce(f64, f64) -> f64,
    ) -> Option<f64> {
        let (low, high) = self.radii(length);
        // A turn of exactly the reserved length has one radius, and rounding may put it outside the limits.
        if low > high * (1.0 + 1e-12) {
            return None;
        }
        let high = high.max(low);
        let radius = match law {
            TurnLaw::UniformRadius => between(low, high),
            TurnLaw::UniformAngle => {
                let effective = self.effective(length);
                effective / between(effective / high, effective / low)
            }
        };
        Some(radius.clamp(low, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn turns_keep_their_limits(
            seed: u64,
            theta_min in 0.1..1.0_f64,
            more in 0.0..2.0_f64,
            least_radius in 1.0..200.0_f64,
            transition in 0.0..=0.5_f64,
            factor in 1.0..50.0_f64,
            share in 0.0..=1.0_f64,
            uniform_angle: bool,
        ) {
            let limits =
                TurnLimits { theta_min, theta_max: theta_min + more, least_radius, transition };
            let law = if uniform_angle { TurnLaw::UniformAngle } else { TurnLaw::UniformRadius };
            let mut stream = Seed(seed).stream("test", 0);
            let length = limits.shortest() * factor;
            let drawn = limits.draw(length, law, &mut stream).unwrap();
            for radius in [drawn, limits.at(length, law, share).unwrap()] {
                let angle = limits.effective(length) / radius;
                prop_assert!(radius >= least_radius);
                prop_assert!(angle >= theta_min * (1.0 - 1e-12));
                prop_assert!(angle <= limits.theta_max * (1.0 + 1e-12));
            }
            let too_short = limits.shortest() * 0.999;
            prop_assert_eq!(limits.draw(too_short, law, &mut stream), None);
            prop_assert_eq!(limits.at(too_short, law, share), None);
        }
    }
}
