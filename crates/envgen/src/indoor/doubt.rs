//! Reasons to doubt that a map of the profile `calibrated` is as difficult as requested.

use std::fmt;

use super::blueprint::{Choice, FloorPlan};
use super::calibrated::FARTHEST;
use crate::calibration::{Calibration, Input, Prediction};

/// A reason why the difficulty of a map of the profile `calibrated` may be farther from the request than the standard
/// error of its prediction says. Measured maps need no such doubts: see `envgen-trials measure`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CalibrationDoubt {
    /// The map is smaller or larger than those that the calibration comes from. Predictions count it as the smallest
    /// or the largest of them.
    Size {
        /// Area of the grid in m².
        area: f64,
        /// Least and greatest area of the grids of the atlas in m².
        atlas: [f64; 2],
    },
    /// Much of the map is unlike those that the calibration comes from.
    Unlike {
        /// Share of the features that lie outside the range of the atlas.
        outside: f64,
    },
    /// No candidate is predicted near the request of a dial.
    Far {
        /// The name of the dial.
        dial: &'static str,
        /// The request.
        requested: f64,
        /// What is predicted for the map.
        predicted: f64,
    },
}

impl fmt::Display for CalibrationDoubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CalibrationDoubt::Size { area, atlas: [least, most] } => write!(
                f,
                "the map has {area:.0} m\u{b2}, but difficulties are calibrated by maps of {least:.0} to {most:.0} \
                 m\u{b2}: measure it before you rely on its difficulty"
            ),
            CalibrationDoubt::Unlike { outside } => write!(
                f,
                "{:.0} % of the map's features lie outside what was calibrated: measure it before you rely on its \
                 difficulty",
                100.0 * outside
            ),
            CalibrationDoubt::Far { dial, requested, predicted } => write!(
                f,
                "no map near the request was found: {dial} {requested} is requested, {predicted:.1} is predicted; \
                 another seed or size may be nearer"
            ),
        }
    }
}

impl FloorPlan {
    /// Returns the reasons to doubt that the plan is as difficult as requested; none for plans of other profiles, and
    /// for edited plans, which have no prediction.
    pub fn calibration_doubts(&self) -> Vec<CalibrationDoubt> {
        let Some(choice) = self.choice.as_ref().filter(|_| !self.edited) else { return Vec::new() };
        let Choice { spec, prediction, .. } = &**choice;
        let mut doubts = Vec::new();
        let side = |cells: u32| f64::from(cells) * spec.cell_size;
        let area = side(spec.width) * side(spec.height);
        doubts.extend(calibrated_areas().and_then(|(input, atlas)| {
            input.standardised(Some(area)).1.then_some(CalibrationDoubt::Size { area, atlas })
        }));
        let Prediction { outside, dials, .. } = *prediction;
        if prediction.is_extrapolated() {
            doubts.push(CalibrationDoubt::Unlike { outside });
        }
        let requests = spec.request().0.zip(dials).named().into_iter();
        doubts.extend(requests.filter_map(|(dial, (requested, predicted))| {
            let (requested, predicted) = (requested?, predicted.value);
            let is_far = (predicted - requested).abs() > FARTHEST;
            is_far.then_some(CalibrationDoubt::Far { dial, requested, predicted })
        }));
        doubts
    }
}

/// Returns the input of the areas of grids, and their range in m².
fn calibrated_areas() -> Option<(&'static Input, [f64; 2])> {
    let inputs = &Calibration::indoor().settings.as_ref()?.inputs;
    let area = inputs.iter().find(|input| input.name == "area_m2")?;
    Some((area, area.range.map(|log| area.scale * libm::expm1(log))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::Spec;
    use crate::indoor::{IndoorSpec, Profile};
    use crate::seed::Seed;

    fn doubts(spec: IndoorSpec) -> Vec<CalibrationDoubt> {
        let spec = IndoorSpec { profile: Profile::Calibrated, ..spec };
        spec.generate(Seed(1)).expect("a plan").calibration_doubts()
    }

    fn square(size: u32, difficulty: f64) -> IndoorSpec {
        IndoorSpec { width: size, height: size, difficulty, ..Default::default() }
    }

    #[test]
    fn sizes_of_the_atlas_are_not_doubted() {
        for size in [8, 10, 16] {
            assert_eq!(doubts(square(size, 5.0)), [], "{size}");
        }
        let narrow = IndoorSpec { width: 6, height: 9, ..square(8, 5.0) };
        assert_eq!(doubts(narrow), []);
        assert_eq!(
            IndoorSpec::default().generate(Seed(1)).expect("a plan").calibration_doubts(),
            []
        );
    }

    #[test]
    fn other_sizes_are_doubted() {
        for (size, area) in [(4, 144.0), (6, 324.0), (20, 3600.0)] {
            let CalibrationDoubt::Size { area: found, atlas } = doubts(square(size, 6.0))[0] else {
                panic!("{size} cells are not doubted")
            };
            assert_eq!((found, atlas.map(f64::round)), (area, [486.0, 2304.0]));
        }
        let text = doubts(square(4, 6.0))[0].to_string();
        assert!(text.starts_with("the map has 144 m\u{b2}"), "{text}");
        assert!(text.contains("by maps of 486 to 2304 m\u{b2}"), "{text}");
    }

    #[test]
    fn dials_that_are_not_met_together_are_doubted() {
        let both = IndoorSpec {
            mapping: Some(0.6),
            navigation: Some(8.4),
            ..square(8, IndoorSpec::default().difficulty)
        };
        let found = doubts(both);
        let [CalibrationDoubt::Far { dial: "mapping", requested: 0.6, predicted }] = found[..]
        else {
            panic!("{found:?}")
        };
        assert!(predicted > 0.6 + FARTHEST, "{predicted}");
        let text = found[0].to_string();
        assert!(text.contains("mapping 0.6 is requested, 2.0 is predicted"), "{text}");
    }

    #[test]
    fn edited_plans_are_not_doubted() {
        let spec = IndoorSpec { profile: Profile::Calibrated, ..square(4, 6.0) };
        let mut plan = spec.generate(Seed(1)).expect("a plan");
        assert!(!plan.calibration_doubts().is_empty());
        plan.edited = true;
        assert_eq!(plan.calibration_doubts(), []);
    }
}
