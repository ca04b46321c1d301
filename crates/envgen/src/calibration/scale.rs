//! The scale of difficulty.

use serde::{Deserialize, Serialize};

use crate::dials::Dials;

/// A scale from 0 to 10 and beyond, which is linear between the mean scores of two sets of worlds, the anchors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scale {
    /// The panel whose trials give the mean scores.
    pub panel: String,
    /// Version of the panel.
    pub panel_version: u32,
    /// Version of the set of anchors.
    pub anchors_version: u32,
    /// Mean scores of the easy anchors.
    pub zero: Dials<f64>,
    /// Mean scores of the hard anchors.
    pub ten: Dials<f64>,
}

impl Scale {
    /// Converts mean scores D, M and N into dials.
    ///
    /// ```
    /// use envgen::calibration::{Calibration, Dials};
    ///
    /// // Scores as those of the easy anchors are 0 on each dial, as those of the hard ones 10.
    /// let scale = &Calibration::indoor().scale;
    /// assert_eq!(scale.dials(scale.zero), Dials::default());
    /// for (_, dial) in scale.dials(scale.ten).named() {
    ///     assert!((dial - 10.0).abs() < 1e-12);
    /// }
    /// ```
    pub fn dials(&self, scores: Dials<f64>) -> Dials<f64> {
        scores
            .zip(self.zero.zip(self.ten))
            .map(|(score, (zero, ten))| 10.0 * (score - zero) / (ten - zero))
    }

    /// Returns, for each dial, the difference on the scale that a score difference of one makes.
    pub fn units(&self) -> Dials<f64> {
        self.zero.zip(self.ten).map(|(zero, ten)| 10.0 / (ten - zero))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchors_are_0_and_10() {
        let zero = Dials { difficulty: 0.5, mapping: 0.0, navigation: 1.0 };
        let ten = Dials { difficulty: 7.5, mapping: 9.0, navigation: 6.0 };
        let scale =
            Scale { panel: "reference".into(), panel_version: 1, anchors_version: 1, zero, ten };
        assert_eq!(scale.dials(zero), Dials::default());
        assert_eq!(scale.dials(ten), zero.map(|_| 10.0));
        let middle = scale.dials(Dials { difficulty: 4.0, mapping: 4.5, navigation: 8.5 });
        assert_eq!(middle, Dials { difficulty: 5.0, mapping: 5.0, navigation: 15.0 });
        assert_eq!(scale.units().navigation, 2.0);
    }
}
