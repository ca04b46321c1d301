//! The profile `calibrated`: maps of a requested difficulty, on the scale that trials measure.
//!
//! Levers are drawn many times, and the result of each draw is predicted from its settings. The draws nearest to
//! the request are generated. Of these maps, the one is taken whose difficulty, predicted from its difficulty
//! vector, is nearest. Nothing is simulated.

use super::blueprint::{Choice, FloorPlan};
use super::custom_laws::IndoorLaws;
use super::error::IndoorError;
use super::levers::Levers;
use super::request::Request;
use super::spec::{IndoorSpec, LEVERS, Profile};
use super::stages::{Stage, plan_as_set};
use super::world::world;
use crate::calibration::Calibration;
use crate::dials::{Dials, Estimate, Prediction};
use crate::difficulty::{DifficultyVector, Platform};
use crate::error::SpecError;
use crate::seed::Seed;

/// Number of draws of the levers.
const DRAWS: u64 = 2048;

/// Number of draws that determine the reach of a spec, and the share of them that is cut off at either end.
const REACH_DRAWS: u64 = 2048;
const BEYOND: f64 = 0.002;

/// Number of maps that are generated, of which the nearest is taken.
pub(super) const CANDIDATES: usize = 8;

/// The greatest distance of the nearest draw from a request of both dials. Maps that are farther from the request of a
/// dial are [doubted](super::CalibrationDoubt).
pub(super) const FARTHEST: f64 = 1.0;

/// Generates the plan whose prediction is nearest to the spec's request, or one of those that follow it.
pub(super) fn plan(
    spec: &IndoorSpec,
    seed: Seed,
    laws: &IndoorLaws<'_>,
    after: &mut dyn FnMut(Stage),
) -> Result<FloorPlan, IndoorError> {
    let mut plans = plans(spec, seed, laws, after)?;
    let rank = (spec.candidate as usize).min(plans.len() - 1);
    Ok(plans.swap_remove(rank))
}

/// Generates plans, beginning with the one whose prediction is nearest to the spec's request; at least one.
fn plans(
    spec: &IndoorSpec,
    seed: Seed,
    laws: &IndoorLaws<'_>,
    after: &mut dyn FnMut(Stage),
) -> Result<Vec<FloorPlan>, IndoorError> {
    let request = spec.request();
    let levers = Levers::new(spec);
    request.check(spec, reachable(&levers))?;
    let draw = |i: u64| {
        let seed = Seed(seed.attempt("indoor/calibrated", 0, i).bits());
        (levers.draw(seed), seed)
    };
    let mut drawn: Vec<(f64, u64)> =
        (0..DRAWS).map(|i| (request.distance(expected(&draw(i).0)), i)).collect();
    drawn.sort_by(|a, b| a.0.total_cmp(&b.0));
    request.check_nearest(drawn[0].0, &draw(drawn[0].1).0)?;
    let calibration = Calibration::indoor();
    let mut failure = None;
    let mut candidates: Vec<(f64, FloorPlan, Prediction)> = Vec::new();
    for &(_, i) in &drawn[..CANDIDATES] {
        let (drawn, own_seed) = draw(i);
        let plan = plan_as_set(&drawn, own_seed, laws, after)?;
        match DifficultyVector::of(&world(&plan), &Platform::default()) {
            Ok(vector) => {
                let prediction = calibration.predict(&vector);
                let distance = request.distance(values(prediction.dials));
                candidates.push((distance, plan, prediction));
            }
            Err(error) => failure = Some(error),
        }
    }
    if candidates.is_empty() {
        let reason = failure.map_or_else(String::new, |error| error.to_string());
        return Err(IndoorError::Unpredicted(reason));
    }
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    let chosen = candidates.into_iter().zip(0..).map(|((_, mut plan, prediction), candidate)| {
        let spec = IndoorSpec { candidate, ..spec.clone() };
        plan.choice = Some(Box::new(Choice { spec, seed, prediction }));
        plan
    });
    Ok(chosen.collect())
}

impl IndoorSpec {
    /// Returns the difficulties that maps of this size can reach, with the settings that are kept: the interval of
    /// each dial, as predicted from settings, between the .2 % and the 99.8 % quantile of the drawn levers, and
    /// within the 0 to 10 that can be requested.
    pub fn reachable(&self) -> Dials<[f64; 2]> {
        reachable(&Levers::new(self))
    }

    /// Returns the candidates of the profile `calibrated`, beginning with the one whose prediction is nearest to
    /// the request. The spec with a candidate's number as `candidate` gives that plan.
    ///
    /// # Errors
    /// As [`Spec::generate`](crate::Spec::generate), and when the spec has another profile.
    pub fn candidates(&self, seed: Seed) -> Result<Vec<FloorPlan>, IndoorError> {
        self.check()?;
        if self.profile != Profile::Calibrated {
            let name = serde_json::to_string(&self.profile).unwrap_or_default();
            return Err(SpecError::new("profile", name, "calibrated, to have candidates").into());
        }
        plans(self, seed, &IndoorLaws::default(), &mut |_| ())
    }

    /// Fixes the settings that a user has given, each as [`IndoorSpec::fix`] does, and checks that none contradicts
    /// the others.
    ///
    /// # Errors
    /// When `difficulty` is given beside the difficulty of mapping or navigation alone, which take its place.
    pub fn fix_given(&mut self, names: &[&str]) -> Result<(), SpecError> {
        names.iter().for_each(|name| self.fix(name));
        let others = [("mapping", self.mapping), ("navigation", self.navigation)];
        match others.into_iter().find(|(_, dial)| dial.is_some()) {
            Some((other, _)) if names.contains(&"difficulty") => {
                let allowed = format!("absent, since `{other}` takes its place");
                Err(SpecError::new("difficulty", self.difficulty, allowed))
            }
            _ => Ok(()),
        }
    }

    /// Keeps a setting at its default in the profile `calibrated`, which otherwise draws it. Does nothing for
    /// settings that the profile does not draw, or that have other values.
    pub fn fix(&mut self, name: &str) {
        let drawn = LEVERS.into_iter().find(|lever| *lever == name && *lever != "difficulty");
        let Some(lever) = drawn.filter(|_| self.profile == Profile::Calibrated) else { return };
        let is_default =
            self.settings_json()[lever] == IndoorSpec::default().settings_json()[lever];
        if is_default && !self.fixed.iter().any(|fixed| fixed == lever) {
            self.fixed.push(lever.to_owned());
        }
    }
}

fn reachable(levers: &Levers<'_>) -> Dials<[f64; 2]> {
    let draws: Vec<Dials<f64>> = (0..REACH_DRAWS)
        .map(|i| expected(&levers.draw(Seed(0).attempt("indoor/reachable", 0, i).bits().into())))
        .collect();
    let interval = |of: fn(&Dials<f64>) -> f64| {
        let mut all: Vec<f64> = draws.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        let cut = (BEYOND * all.len() as f64) as usize;
        [all[cut], all[all.len() - 1 - cut]].map(|reached| reached.clamp(0.0, 10.0))
    };
    Dials {
        difficulty: interval(|dials| dials.difficulty),
        mapping: interval(|dials| dials.mapping),
        navigation: interval(|dials| dials.navigation),
    }
}

/// Returns the expected dials for given settings.
fn expected(spec: &IndoorSpec) -> Dials<f64> {
    let prediction = Calibration::indoor().predict_terms(&spec.lever_terms());
    prediction.map_or_else(Dials::default, |prediction| values(prediction.dials))
}

fn values(dials: Dials<Estimate>) -> Dials<f64> {
    dials.map(|estimate| estimate.value)
}

/// Writes the ends of an interval with few digits, but so that they lie in it: a request of what an error allows must
/// not be refused.
fn rounded_inwards([least, most]: [f64; 2]) -> [String; 2] {
    for (digits, parts) in [(1, 10.0), (2, 100.0), (3, 1000.0)] {
        let [low, high] = [(least * parts).ceil() / parts, (most * parts).floor() / parts];
        if least <= low && low <= high && high <= most {
            return [low, high].map(|end| format!("{end:.digits$}"));
        }
    }
    [least, most].map(|end| end.to_string())
}

impl Request {
    /// Checks whether each dial on its own is within the [reach](IndoorSpec::reachable) of maps of the spec's size
    /// and settings.
    ///
    /// # Errors
    /// Names the first dial that is not, with its interval.
    pub fn check(&self, spec: &IndoorSpec, reachable: Dials<[f64; 2]>) -> Result<(), SpecError> {
        for (name, (wanted, [least, most])) in self.0.zip(reachable).named() {
            let Some(wanted) = wanted else { continue };
            if !(least..=most).contains(&wanted) {
                let IndoorSpec { width, height, .. } = spec;
                let [least, most] = rounded_inwards([least, most]);
                let allowed = format!(
                    "from {least} to {most}, what the profile calibrated reaches at {width} x \
                     {height} cells with these settings"
                );
                return Err(SpecError::new(name, wanted, allowed));
            }
        }
        Ok(())
    }

    /// Checks whether both dials can be reached together.
    fn check_nearest(&self, distance: f64, nearest: &IndoorSpec) -> Result<(), SpecError> {
        let Dials { mapping: Some(mapping), navigation: Some(navigation), .. } = self.0 else {
            return Ok(());
        };
        if distance <= FARTHEST {
            return Ok(());
        }
        let near = expected(nearest);
        let allowed = format!(
            "what the profile calibrated reaches together, the nearest is {:.1} and {:.1}",
            near.mapping, near.navigation
        );
        let wanted = format!("{mapping} and {navigation}");
        Err(SpecError::new("mapping` and `navigation", wanted, allowed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Blueprint, Spec};
    use crate::world::Claim;

    fn base(size: u32) -> IndoorSpec {
        let profile = Profile::Calibrated;
        IndoorSpec { width: size, height: size, profile, ..Default::default() }
    }

    /// A request in the middle of what a spec reaches.
    fn middle(spec: &IndoorSpec) -> f64 {
        let [least, most] = spec.reachable().difficulty;
        0.5 * (least + most)
    }

    #[test]
    fn predictions_are_near_requests() {
        let [least, most] = base(8).reachable().difficulty;
        let mut errors = Vec::new();
        for i in 0..6 {
            let difficulty = least + (most - least) * (f64::from(i) + 0.5) / 6.0;
            let plan =
                IndoorSpec { difficulty, ..base(8) }.generate(Seed(i as u64)).expect("a plan");
            let prediction = plan.prediction().expect("a prediction");
            errors.push((prediction.dials.difficulty.value - difficulty).abs());
        }
        assert!(errors.iter().sum::<f64>() / 6.0 < 0.5, "{errors:?}");
    }

    #[test]
    fn the_world_claims_its_prediction_and_names_the_request() {
        let spec = IndoorSpec { difficulty: middle(&base(6)), ..base(6) };
        let plan = spec.generate(Seed(5)).expect("a plan");
        let world = plan.to_world();
        assert_eq!(world.provenance.spec, serde_json::json!(spec));
        assert_eq!(world.provenance.seed, Some(Seed(5)));
        let claims = crate::certificate::verify(&world);
        let claimed = claims.iter().find(|(claim, _)| {
            matches!(claim, Claim::PredictedDifficulty { prediction } if Some(prediction) == plan.prediction())
        });
        assert_eq!(claimed.map(|(_, verdict)| *verdict), Some(crate::certificate::Verdict::Holds));
        // An easier floor is not what was predicted.
        let mut other = world.clone();
        other.obstacles.clear();
        other.walls.truncate(4);
        let broken = crate::certificate::verify(&other);
        assert!(broken.iter().any(|(claim, verdict)| {
            matches!(claim, Claim::PredictedDifficulty { .. })
                && *verdict == crate::certificate::Verdict::Broken
        }));
    }

    #[test]
    fn candidates_are_what_their_numbers_give_and_farther_one_by_one() {
        let spec = IndoorSpec { difficulty: middle(&base(6)), ..base(6) };
        let plans = spec.candidates(Seed(2)).expect("candidates");
        assert_eq!(plans.len(), CANDIDATES);
        let distances: Vec<f64> = plans
            .iter()
            .map(|plan| spec.request().distance(values(plan.prediction().expect("one").dials)))
            .collect();
        assert!(distances.is_sorted(), "{distances:?}");
        let third = IndoorSpec { candidate: 2, ..spec.clone() };
        assert_eq!(third.generate(Seed(2)).as_ref(), Ok(&plans[2]));
        let other = IndoorSpec { profile: Profile::Guaranteed, ..IndoorSpec::default() };
        let error = other.candidates(Seed(2)).expect_err("another profile").to_string();
        assert!(error.starts_with("`profile` must be calibrated"), "{error}");
    }

    #[test]
    fn dials_are_requested_apart() {
        let reach = base(8).reachable();
        let high = |[least, most]: [f64; 2], share: f64| least + share * (most - least);
        let spec = IndoorSpec {
            mapping: Some(high(reach.mapping, 0.2)),
            navigation: Some(high(reach.navigation, 0.6)),
            ..base(8)
        };
        let plan = spec.generate(Seed(1)).expect("a plan");
        let dials = values(plan.prediction().expect("a prediction").dials);
        assert!(spec.request().distance(dials) < 1.0, "{dials:?}");
    }

    #[test]
    fn the_ends_of_what_is_reached_can_be_requested() {
        let reach = base(16).reachable();
        // Predictions are above 10 for the most difficult maps of this size.
        assert_eq!(reach.difficulty[1], 10.0);
        for difficulty in reach.difficulty {
            IndoorSpec { difficulty, ..base(16) }.generate(Seed(1)).expect("a plan");
        }
        for (mapping, navigation) in reach.mapping.into_iter().zip(reach.navigation) {
            let (mapping, navigation) = (Some(mapping), Some(navigation));
            assert_eq!(IndoorSpec { mapping, navigation, ..base(16) }.check(), Ok(()));
        }
    }

    #[test]
    fn requests_out_of_reach_are_refused_with_what_is_reached() {
        let error =
            |spec: IndoorSpec| spec.generate(Seed(0)).expect_err("out of reach").to_string();
        let text = error(IndoorSpec { difficulty: 0.0, ..base(16) });
        assert!(text.starts_with("`difficulty` must be from "), "{text}");
        assert!(text.ends_with("reaches at 16 x 16 cells with these settings, got 0"), "{text}");
        let text = error(IndoorSpec { width: 100, height: 100, ..base(16) });
        assert!(text.starts_with("`width` must be at most 40"), "{text}");
        let text = error(IndoorSpec { robot_radius: 0.2, ..base(16) });
        assert!(text.starts_with("`robot_radius` must be at least 0.36"), "{text}");
        let text = error(IndoorSpec { fixed: vec!["width".into()], ..base(16) });
        assert!(text.starts_with("`fixed` must be any of layout"), "{text}");
        let plain = IndoorSpec { mapping: Some(3.0), ..IndoorSpec::default() };
        let text = error(plain);
        assert_eq!(text, "`mapping` must be absent, except in the profile calibrated, got 3.0");
    }

    #[test]
    fn doorways_are_drawn_for_the_robot() {
        let wide = |robot_radius| IndoorSpec { robot_radius, ..base(7) };
        for robot_radius in [0.5, 0.82, 1.335] {
            let spec = wide(robot_radius);
            assert_eq!(spec.check(), Ok(()), "{robot_radius}");
            for seed in 0..200 {
                let drawn = spec.draw_levers(Seed(seed));
                assert_eq!(drawn.check(), Ok(()), "{robot_radius}, seed {seed}");
                assert!(2.0 * robot_radius + 0.1 <= drawn.doorway + 1e-9, "{drawn:?}");
            }
        }
        let spec = IndoorSpec { difficulty: middle(&wide(0.82)), ..wide(0.82) };
        let world = spec.generate(Seed(3)).expect("a plan").to_world();
        let claim = Claim::EveryPlaceReachable { radius: 0.82 };
        assert!(world.certificate.contains(&claim));
        for (claim, verdict) in crate::certificate::verify(&world) {
            assert_eq!(verdict, crate::certificate::Verdict::Holds, "{claim}");
        }
        let error = |spec: IndoorSpec| spec.check().expect_err("too large").to_string();
        let text = error(wide(1.34));
        assert!(text.starts_with("`robot_radius` must be at most 1.335 m, got 1.34"), "{text}");
        assert!(text.ends_with("it must pass a doorway of 2.77 m"), "{text}");
        let mut kept = wide(0.82);
        kept.fix("doorway");
        assert!(error(kept).contains("must pass a doorway of 0.94 m"));
        let guaranteed = IndoorSpec { profile: Profile::Guaranteed, ..wide(0.82) };
        assert!(error(guaranteed).contains("must pass a doorway of 0.94 m"));
    }

    #[test]
    fn what_is_fixed_stays_and_narrows_the_reach() {
        let mut spec = base(8);
        for lever in ["floor_slip", "wheel_bias", "dark_walls", "dark_objects", "width"] {
            spec.fix(lever);
        }
        assert_eq!(spec.fixed.len(), 4);
        let (free, kept) = (base(8).reachable().mapping, spec.reachable().mapping);
        assert!(kept[1] < free[1] - 2.0, "{kept:?} {free:?}");
        spec.difficulty = middle(&spec);
        let plan = spec.generate(Seed(3)).expect("a plan");
        assert_eq!((plan.spec().floor_slip, plan.spec().dark_walls), (1.0, 0.0));
    }

    #[test]
    fn an_edited_plan_has_no_prediction() {
        let spec = IndoorSpec { difficulty: middle(&base(6)), ..base(6) };
        let mut plan = spec.generate(Seed(5)).expect("a plan");
        plan.edited = true;
        assert_eq!(plan.prediction(), None);
        let world = plan.to_world();
        assert_eq!(world.provenance.difficulty_requested, Some(spec.difficulty));
        assert!(!world.certificate.iter().any(|c| matches!(c, Claim::PredictedDifficulty { .. })));
    }
}
