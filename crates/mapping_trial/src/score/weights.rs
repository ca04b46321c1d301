//! The weights of the parts of scores, and how a ranking depends on them.

use envgen::SpecError;
use serde::de::{Deserializer, Error};
use serde::{Deserialize, Serialize, Serializer};

use super::kendall::{by_value, kendall_tau};
use super::parts::Parts;

/// The weights of the parts of scores. The default weights are those of [`Scores`](super::Scores).
///
/// Only the ratios of the weights of M, of those of N, and of those of D matter. Where all are 0, the
/// score is 0. Weights that are read must be [valid](Weights::validate).
///
/// ```
/// use mapping_trial::score::Weights;
///
/// let weights: Weights = serde_json::from_str("{\"wall\": 0.5}")?;
/// assert_eq!(weights, Weights { wall: 0.5, ..Default::default() });
/// // It would turn the score around.
/// let error = serde_json::from_str::<Weights>("{\"wall\": -1}").unwrap_err().to_string();
/// assert!(error.starts_with("`wall` must be a number from 0 to 1e9, got -1"), "{error}");
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self", default, deny_unknown_fields)]
pub struct Weights {
    /// Weight of `e_wall` in M.
    pub wall: f64,
    /// Weight of `e_use` in M.
    pub navigability: f64,
    /// Weight of `e_pose` in M.
    pub pose: f64,
    /// Weight of `e_cov` in M.
    pub coverage: f64,
    /// Weight of `e_time` in N.
    pub time: f64,
    /// Weight of `e_cov` in N.
    pub reach: f64,
    /// Weight of `e_hit` in N. Its name in files is `hits`.
    #[serde(rename = "hits", alias = "collisions")]
    pub collisions: f64,
    /// Weight of `e_turn` in N.
    pub turning: f64,
    /// Weight of M in D.
    pub mapping: f64,
    /// Weight of N in D.
    pub navigation: f64,
}

/// The greatest weight, far below what overflows.
const MOST: f64 = 1e9;

impl Serialize for Weights {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // The derived function, which `remote` makes one of the type itself.
        Weights::serialize(self, serializer)
    }
}

impl<'de> Deserialize<'de> for Weights {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let weights = Weights::deserialize(deserializer)?;
        weights.validate().map_err(Error::custom)?;
        Ok(weights)
    }
}

impl Default for Weights {
    fn default() -> Self {
        Weights {
            wall: 0.20,
            navigability: 0.20,
            // The drift of the pose distinguishes worlds better than its consequences do.
            pose: 0.50,
            coverage: 0.10,
            time: 0.40,
            // The time already accounts for ground that was not covered.
            reach: 0.10,
            collisions: 0.15,
            turning: 0.35,
            mapping: 0.6,
            navigation: 0.4,
        }
    }
}

impl Weights {
    /// The weights of [`Score1`](super::Score1).
    pub const SCORE_1: Weights = Weights {
        wall: 0.35,
        navigability: 0.30,
        pose: 0.25,
        coverage: 0.10,
        time: 0.40,
        reach: 0.25,
        collisions: 0.20,
        turning: 0.15,
        mapping: 0.6,
        navigation: 0.4,
    };

    /// Checks every weight, which must be a number from 0 to 1e9: a negative one would turn a score
    /// around.
    ///
    /// # Errors
    ///
    /// Names the first weight that is not allowed, as files call it.
    pub fn validate(&self) -> Result<(), SpecError> {
        let mut copy = *self;
        let wrong = copy.all().into_iter().find(|(_, weight)| !(0.0..=MOST).contains(&**weight));
        wrong.map_or(Ok(()), |(name, weight)| {
            Err(SpecError::new(name_in_files(name), *weight, "a number from 0 to 1e9"))
        })
    }

    /// Returns name and value of every weight.
    fn all(&mut self) -> [(&'static str, &mut f64); 10] {
        [
            ("wall", &mut self.wall),
            ("navigability", &mut self.navigability),
            ("pose", &mut self.pose),
            ("coverage", &mut self.coverage),
            ("time", &mut self.time),
            ("reach", &mut self.reach),
            ("collisions", &mut self.collisions),
            ("turning", &mut self.turning),
            ("mapping", &mut self.mapping),
            ("navigation", &mut self.navigation),
        ]
    }

    /// Returns the weights with one of them multiplied; `None` if no weight has that name.
    ///
    /// ```
    /// use mapping_trial::score::Weights;
    ///
    /// let weights = Weights::default().changed("collisions", 2.0).expect("a weight");
    /// assert_eq!(weights.collisions, 2.0 * Weights::default().collisions);
    /// assert_eq!(Weights::default().changed("speed", 2.0), None);
    /// ```
    pub fn changed(mut self, weight: &str, factor: f64) -> Option<Self> {
        *self.all().into_iter().find(|(name, _)| *name == weight)?.1 *= factor;
        Some(self)
    }

    /// Returns M, N and D on the scale from 0 to 10, given the parts of a score.
    ///
    /// ```
    /// use mapping_trial::score::{Parts, Weights};
    ///
    /// // A pose that drifts as much as it can, and nothing else wrong.
    /// let parts = Parts { e_pose: 1.0, ..Default::default() };
    /// let difficulties = Weights::default().difficulties(&parts);
    /// assert!((difficulties.mapping - 5.0).abs() < 1e-12);
    /// assert_eq!(difficulties.navigation, 0.0);
    /// assert!((difficulties.overall - 0.6 * 5.0).abs() < 1e-12);
    /// ```
    pub fn difficulties(&self, parts: &Parts) -> Difficulties {
        let mean = |weighted: &[(f64, f64)]| {
            let (sum, weight) = weighted
                .iter()
                .fold((0.0, 0.0), |(sum, all), (weight, e)| (sum + weight * e, all + weight));
            if weight > 0.0 { sum / weight } else { 0.0 }
        };
        let mapping = 10.0
            * mean(&[
                (self.wall, parts.e_wall),
                (self.navigability, parts.e_use),
                (self.pose, parts.e_pose),
                (self.coverage, parts.e_cov),
            ]);
        let navigation = 10.0
            * mean(&[
                (self.time, parts.e_time),
                (self.reach, parts.e_cov),
                (self.collisions, parts.e_hit),
                (self.turning, parts.e_turn),
            ]);
        let overall = mean(&[(self.mapping, mapping), (self.navigation, navigation)]);
        Difficulties { mapping, navigation, overall }
    }
}

/// The difficulty of a world in a run, from 0 to 10.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Difficulties {
    /// M: difficulty of mapping.
    pub mapping: f64,
    /// N: difficulty of navigation.
    pub navigation: f64,
    /// D: overall difficulty.
    pub overall: f64,
}

/// How a ranking changes if one weight changes by half.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sensitivity {
    /// The weight, as the name of its field in [`Weights`]. Files call that of collisions `hits`.
    #[serde(serialize_with = "weight_in_files")]
    pub weight: &'static str,
    /// The factor on the weight: 0.5 or 1.5.
    pub factor: f64,
    /// Kendall's tau-b between the orders by D before and after. It is 1 if nothing changes, and absent
    /// if all values of one of the two are equal.
    pub tau: Option<f64>,
    /// The greatest number of positions that a trial moves in the order by D, least first. Ties keep
    /// the order in which they were given.
    pub most_places: usize,
}

fn weight_in_files<S: Serializer>(weight: &str, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(name_in_files(weight))
}

/// The former name, which readers of earlier summaries know.
fn name_in_files(weight: &str) -> &str {
    if weight == "collisions" { "hits" } else { weight }
}

/// Ranks trials by D, with each weight in turn multiplied by 0.5 and by 1.5, and compares this with the
/// ranking by the given weights.
///
/// ```
/// use mapping_trial::score::{Parts, Weights, sensitivity};
///
/// // Every trial is worse in everything than the one before: no weight changes the order.
/// let parts = |e| Parts { e_wall: e, e_pose: e, e_time: e, e_turn: e, ..Default::default() };
/// let trials = [0.1, 0.3, 0.6].map(parts);
/// let changes = sensitivity(&trials, Weights::default());
/// assert_eq!(changes.len(), 2 * 10);
/// assert!(changes.iter().all(|change| change.most_places == 0 && change.tau == Some(1.0)));
/// ```
pub fn sensitivity(trials: &[Parts], weights: Weights) -> Vec<Sensitivity> {
    let overall = |weights: Weights| -> Vec<f64> {
        trials.iter().map(|parts| weights.difficulties(parts).overall).collect()
    };
    let before = overall(weights);
    let mut found = Vec::new();
    for i in 0..10 {
        for factor in [0.5, 1.5] {
            let mut changed = weights;
            let mut all = changed.all();
            let (weight, value) = &mut all[i];
            let weight = *weight;
            **value *= factor;
            let after = overall(changed);
            let tau = kendall_tau(&before, &after);
            found.push(Sensitivity {
                weight,
                factor,
                tau,
                most_places: most_places(&before, &after),
            });
        }
    }
    found
}

fn most_places(a: &[f64], b: &[f64]) -> usize {
    let places = |values: &[f64]| {
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&i, &j| by_value(values[i], values[j]));
        let mut places = vec![0; values.len()];
        order.into_iter().enumerate().for_each(|(place, i)| places[i] = place);
        places
    };
    let (a, b) = (places(a), places(b));
    a.into_iter().zip(b).map(|(a, b): (usize, usize)| a.abs_diff(b)).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn zeros_have_the_same_place_whatever_their_sign() {
        assert_eq!(most_places(&[0.0, -0.0, 1.0], &[0.0, 0.0, 1.0]), 0);
    }

    #[test]
    fn one_weight_changes_by_its_name() {
        let changed = Weights::default().changed("pose", 0.5);
        assert_eq!(changed, Some(Weights { pose: 0.25, ..Weights::default() }));
        assert_eq!(Weights::default().changed("poses", 0.5), None);
    }

    proptest! {
        #[test]
        fn weights_that_are_read_keep_scores_in_their_range(
            field in 0..10_usize, value in prop_oneof![-1.0..2.0_f64, any::<f64>(), Just(f64::NAN)],
            all in any::<bool>(), e in prop::array::uniform7(0.0..=1.0_f64),
        ) {
            let mut weights = Weights::default();
            let name = name_in_files(weights.all()[field].0);
            if all {
                weights.all().into_iter().for_each(|(_, weight)| *weight = value);
            } else {
                *weights.all()[field].1 = value;
            }
            let read = ron::from_str::<Weights>(&ron::to_string(&weights).expect("RON"));
            if !(0.0..=MOST).contains(&value) {
                let error = read.expect_err("not allowed").to_string();
                let named = format!("`{}` must be a number from 0 to 1e9", if all { "wall" } else { name });
                prop_assert!(error.contains(&named), "{}", error);
                return Ok(());
            }
            prop_assert_eq!(read, Ok(weights));
            let [e_wall, e_use, e_pose, e_cov, e_time, e_hit, e_turn] = e;
            let parts = Parts { e_wall, e_use, e_pose, e_cov, e_time, e_hit, e_turn };
            let found = weights.difficulties(&parts);
            for score in [found.mapping, found.navigation, found.overall] {
                prop_assert!((0.0..=10.0 + 1e-9).contains(&score), "{}", score);
            }
        }
    }

    #[test]
    fn weights_in_files_have_their_names() {
        let text = serde_json::to_string(&Weights::default()).expect("JSON");
        assert!(text.starts_with("{\"wall\":0.2,\"navigability\":0.2,"), "{text}");
        assert!(text.contains("\"hits\":0.15,\"turning\":0.35"), "{text}");
        assert_eq!(serde_json::from_str::<Weights>(&text).expect("weights"), Weights::default());
        let read = |text: &str| serde_json::from_str::<Weights>(text);
        assert_eq!(read("{\"collisions\":2}").expect("weights").collisions, 2.0);
        assert!(read("{\"walls\":2}").is_err());
        let error = read("{\"hits\":-0.5}").expect_err("negative").to_string();
        assert!(error.starts_with("`hits` must be a number from 0 to 1e9, got -0.5"), "{error}");
    }

    fn parts(e_wall: f64, e_time: f64) -> Parts {
        Parts { e_wall, e_time, ..Parts::default() }
    }

    #[test]
    fn a_ranking_that_depends_on_one_weight_is_found() {
        // D is 2.1 e_wall + 1.6 e_time.
        let trials = [parts(0.8, 0.1), parts(0.1, 0.9), parts(0.0, 0.0)];
        let found = sensitivity(&trials, Weights::SCORE_1);
        assert_eq!(found.len(), 20);
        let of = |weight, factor| {
            found.iter().find(|s| s.weight == weight && s.factor == factor).unwrap()
        };
        assert_eq!(of("wall", 1.5).tau, Some(1.0));
        assert_eq!(of("wall", 1.5).most_places, 0);
        assert!(of("wall", 0.5).tau.unwrap() < 1.0);
        assert_eq!(of("wall", 0.5).most_places, 1);
        // A weight of a part that is 0 everywhere does not change the order within M.
        assert_eq!(of("collisions", 0.5).tau, Some(1.0));
    }
}
