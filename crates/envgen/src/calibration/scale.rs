//! The scale of difficulty.

use serde::{Deserialize, Serialize};

use crate::dials::Dials;
use crate::error::SpecError;

/// A scale from 0 to 10 and beyond, which is linear between the mean scores of two sets of worlds, the anchors. It
/// is checked when it is read from a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "UncheckedScale")]
pub struct Scale {
    /// The panel whose trials give the mean scores.
    pub panel: String,
    /// Version of the panel.
    pub panel_version: u32,
    /// Version of the set of anchors.
    pub anchors_version: u32,
    /// Mean scores of the easy anchors.
    pub zero: Dials<f64>,
    /// Mean scores of the hard anchors, each above that of the easy ones.
    pub ten: Dials<f64>,
}

/// A scale as it is read from a file, before it is checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct UncheckedScale {
    panel: String,
    panel_version: u32,
    anchors_version: u32,
    zero: Dials<f64>,
    ten: Dials<f64>,
}

impl TryFrom<UncheckedScale> for Scale {
    type Error = SpecError;

    fn try_from(read: UncheckedScale) -> Result<Self, SpecError> {
        let UncheckedScale { panel, panel_version, anchors_version, zero, ten } = read;
        let scale = Scale { panel, panel_version, anchors_version, zero, ten };
        for (dial, ((zero, ten), unit)) in zero.zip(ten).zip(scale.units()).named() {
            if !zero.is_finite() {
                return Err(SpecError::new(dial, zero, "a finite number").within("zero"));
            }
            // The unit of a difference that is too small, or not finite, is not a number to multiply by.
            if !(zero < ten && ten.is_finite() && unit > 0.0 && unit.is_finite()) {
                let allowed = format!("a finite number above that of `zero`, {zero}");
                return Err(SpecError::new(dial, ten, allowed).within("ten"));
            }
        }
        Ok(scale)
    }
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
    use serde_json::json;

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

    #[test]
    fn scales_without_length_are_refused() {
        let read = |change: &dyn Fn(&mut serde_json::Value)| {
            let dials = |at| json!({"difficulty": at, "mapping": at, "navigation": at});
            let mut scale = json!({
                "panel": "reference", "panel_version": 1, "anchors_version": 1,
                "zero": dials(0.5), "ten": dials(7.5),
            });
            change(&mut scale);
            serde_json::from_value::<Scale>(scale).map_err(|error| error.to_string())
        };
        assert_eq!(read(&|_| {}).map(|scale| scale.units().mapping), Ok(10.0 / 7.0));
        for ten in [0.5, 0.25, -7.5] {
            let error = read(&|scale| scale["ten"]["mapping"] = json!(ten)).unwrap_err();
            let allowed = "a finite number above that of `zero`, 0.5";
            assert_eq!(error, format!("`ten.mapping` must be {allowed}, got {ten}"));
        }
        // So near that ten divided by the difference is not finite.
        let near = |scale: &mut serde_json::Value| {
            (scale["zero"]["navigation"], scale["ten"]["navigation"]) = (json!(0.0), json!(5e-324));
        };
        assert!(read(&near).unwrap_err().starts_with("`ten.navigation` must be"));
        let far = |scale: &mut serde_json::Value| {
            (scale["zero"]["navigation"], scale["ten"]["navigation"]) =
                (json!(-1e308), json!(1e308));
        };
        assert!(read(&far).unwrap_err().starts_with("`ten.navigation` must be"));
        let other = |scale: &mut serde_json::Value| scale["five"] = json!(5);
        assert!(read(&other).unwrap_err().contains("unknown field `five`"));
    }
}
