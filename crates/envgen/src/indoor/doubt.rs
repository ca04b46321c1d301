//! Reasons to doubt that a map of the profile `calibrated` is as difficult as requested.

use std::fmt;

use super::blueprint::{Choice, FloorPlan};
use super::calibrated::FARTHEST;
use crate::calibration::{Calibration, Prediction};

/// A reason why the difficulty of a map of the profile `calibrated` may be farther from the request than the standard
/// error of its prediction says. Measured maps need no such doubts: see `envgen-trials measure`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CalibrationDoubt {
    /// The map is smaller or larger than those that the calibrations come from. Predictions count it as the smallest
    /// or the largest of them.
    Size {
        /// Area of the grid in m².
        area: f64,
        /// Least and greatest area of the grids of the atlases in m².
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
        let atlas = calibrated_areas();
        let tolerance = 1e-9 * area;
        if area < atlas[0] - tolerance || area > atlas[1] + tolerance {
            doubts.push(CalibrationDoubt::Size { area, atlas });
        }
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

/// Returns the least and the greatest area in m² of the grids to which the calibrations of indoor maps are fitted.
fn calibrated_areas() -> [f64; 2] {
    let indoor = Calibration::indoor();
    let all = [Some(indoor), indoor.smaller.as_deref()].into_iter().flatten();
    let inputs = all.filter_map(|one| one.settings.as_ref()).flat_map(|models| &models.inputs);
    let areas = inputs.filter(|input| input.name == "area_m2");
    areas.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], input| {
        let [low, high] = input.range.map(|log| input.scale * libm::expm1(log));
        [least.min(low), most.max(high)]
    })
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
        for size in [4, 5, 6, 7, 8, 10, 16] {
            assert_eq!(doubts(square(size, 5.0)), [], "{size}");
        }
        let narrow = IndoorSpec { width: 4, height: 9, ..square(8, 5.0) };
        assert_eq!(doubts(narrow), []);
        assert_eq!(
            IndoorSpec::default().generate(Seed(1)).expect("a plan").calibration_doubts(),
            []
        );
    }

    #[test]
    fn other_sizes_are_doubted() {
        for (size, cell_size, area) in [(4, 2.5, 100.0), (20, 3.0, 3600.0)] {
            let spec = IndoorSpec { cell_size, ..square(size, 5.0) };
            let CalibrationDoubt::Size { area: found, atlas } = doubts(spec)[0] else {
                panic!("{size} cells of {cell_size} m are not doubted")
            };
            assert_eq!((found, atlas.map(f64::round)), (area, [144.0, 2304.0]));
        }
        let text = doubts(square(20, 5.0))[0].to_string();
        assert!(text.starts_with("the map has 3600 m\u{b2}"), "{text}");
        assert!(text.contains("by maps of 144 to 2304 m\u{b2}"), "{text}");
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
        let spec = IndoorSpec { profile: Profile::Calibrated, ..square(20, 6.0) };
        let mut plan = spec.generate(Seed(1)).expect("a plan");
        assert!(!plan.calibration_doubts().is_empty());
        plan.edited = true;
        assert_eq!(plan.calibration_doubts(), []);
    }
}
