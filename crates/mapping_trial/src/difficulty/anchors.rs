//! Anchors: the worlds that fix 0 and 10 of the difficulty scale.

use std::collections::BTreeSet;

use envgen::WorldSpec;
use envgen::calibration::{Calibration, Scale};
use serde::{Deserialize, Serialize};

use super::measure::{MeasureError, mean, scores};
use super::panel::Panel;
use crate::experiment::survey::{Family, Record, Survey, SurveyError, SurveyNoise, ron_options};

const FIRST: &str = include_str!("anchors_1.ron");

/// Easy worlds, and worlds that are as difficult as robots can still pass.
///
/// ```
/// use mapping_trial::difficulty::{Anchors, Panel};
///
/// let (anchors, panel) = (Anchors::first(), Panel::reference());
/// // 20 easy and 20 hard worlds, under 12 conditions, once each.
/// let survey = anchors.survey(&panel, 1);
/// assert_eq!((survey.maps().count(), survey.trials()), (40, 480));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Anchors {
    /// Version of the anchors.
    pub version: u32,
    /// Worlds of difficulty 0: empty rooms whose walls a laser sees.
    pub easy: Vec<Family>,
    /// Worlds of difficulty 10: narrow doorways, dark walls, and floors on which wheels slip and
    /// measure too far.
    pub hard: Vec<Family>,
}

impl Anchors {
    /// Returns the anchors of the scale, 20 worlds of each kind.
    ///
    /// # Panics
    ///
    /// Never: the file is part of the crate, and tested.
    pub fn first() -> Self {
        Self::from_ron(FIRST).expect("anchors_1.ron has anchors")
    }

    /// Reads anchors from RON.
    ///
    /// # Errors
    ///
    /// Returns line and column of a syntax error, or names the first value that is not allowed.
    pub fn from_ron(text: &str) -> Result<Self, SurveyError> {
        let anchors: Anchors = ron_options().from_str(text).map_err(Box::new)?;
        anchors.survey(&Panel::reference(), 1).validate()?;
        Ok(anchors)
    }

    /// Returns the survey of the anchors under a panel. The easy worlds come first.
    pub fn survey(&self, panel: &Panel, noise_seeds: u32) -> Survey {
        let families = self.easy.iter().chain(&self.hard).cloned().collect();
        let conditions = panel.conditions.clone();
        Survey { families, conditions, noise_seeds, noise: SurveyNoise::Own }
    }

    /// Returns the number of anchors in which some trial cannot run.
    pub fn failed<'a>(&self, records: impl IntoIterator<Item = &'a Record>) -> usize {
        let failed = records.into_iter().filter(|record| record.scores.is_none());
        failed.map(|record| record.map).collect::<BTreeSet<u32>>().len()
    }

    /// Returns the width of the narrowest doorways in metres; `None` if there are none.
    pub fn narrowest_doorway(&self) -> Option<f64> {
        let doorway = |family: &Family| match &family.spec {
            WorldSpec::Indoor(spec) => Some(spec.doorway_narrowest.unwrap_or(spec.doorway)),
            _ => None,
        };
        self.easy.iter().chain(&self.hard).filter_map(doorway).min_by(f64::total_cmp)
    }

    /// Returns the scale of a panel, from the trials of its [survey](Anchors::survey) of these anchors,
    /// without those that [failed](Anchors::failed).
    ///
    /// # Errors
    ///
    /// If some trial failed in all easy or in all hard anchors, or if the hard anchors do not score
    /// more than the easy ones.
    pub fn scale<'a>(
        &self,
        panel: &Panel,
        records: impl IntoIterator<Item = &'a Record>,
    ) -> Result<Scale, MeasureError> {
        let easy: u64 = self.easy.iter().map(|family| u64::from(family.maps)).sum();
        let records: Vec<&Record> = records.into_iter().collect();
        let failed: BTreeSet<u32> = records
            .iter()
            .filter(|record| record.scores.is_none())
            .map(|record| record.map)
            .collect();
        let (mut zero, mut ten) = (Vec::new(), Vec::new());
        // An anchor that some conditions cannot map would give the other conditions more weight.
        for record in records.iter().filter(|record| !failed.contains(&record.map)) {
            let to = if u64::from(record.map) < easy { &mut zero } else { &mut ten };
            to.extend(record.scores.as_ref().map(scores));
        }
        for (anchors, scored) in [("easy", &zero), ("hard", &ten)] {
            if scored.is_empty() {
                return Err(MeasureError::NoAnchors { anchors });
            }
        }
        let (zero, ten) = (mean(zero.into_iter()), mean(ten.into_iter()));
        for (dial, (easy, hard)) in zero.zip(ten).named() {
            if easy >= hard {
                return Err(MeasureError::Scale { dial, easy, hard });
            }
        }
        Ok(Scale {
            panel: panel.name.clone(),
            panel_version: panel.version,
            anchors_version: self.version,
            zero,
            ten,
        })
    }
}

/// Returns the scale of the [reference panel](Panel::reference), as measured with the
/// [first](Anchors::first) anchors.
///
/// ```
/// use mapping_trial::difficulty::{Panel, reference_scale};
///
/// let (scale, panel) = (reference_scale(), Panel::reference());
/// assert_eq!((&scale.panel, scale.panel_version), (&panel.name, panel.version));
/// // A trial that scores as those in the easy anchors has the difficulty 0.
/// assert_eq!(scale.dials(scale.zero).difficulty, 0.0);
/// ```
pub fn reference_scale() -> &'static Scale {
    &Calibration::indoor().scale
}

#[cfg(test)]
mod tests {
    use envgen::Seed;
    use envgen::calibration::Dials;

    use super::*;
    use crate::experiment::ExperimentError;
    use crate::score::Scores;

    fn record(map: u32, difficulty: f64) -> Record {
        let scores = Scores {
            difficulty,
            mapping: 2.0 * difficulty,
            navigation: 1.0 + difficulty,
            ..Default::default()
        };
        Record { map, scores: Some(scores), ..Record::default() }
    }

    #[test]
    fn no_two_trials_have_the_same_noise() {
        // The easy families all begin with the seed 0.
        let survey = Anchors::first().survey(&Panel::reference(), 3);
        let conditions = survey.conditions.len() as u32;
        let mut seeds: Vec<Seed> = Vec::new();
        for map in survey.maps() {
            for condition in 0..conditions {
                seeds.extend((0..3).map(|noise| survey.noise_seed(&map, condition, noise)));
            }
        }
        let all = seeds.len();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!((seeds.len(), all), (all, 40 * 12 * 3));
    }

    /// An anchor as it was when its digest was taken.
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Known {
        family: String,
        seed: Seed,
        digest: String,
        /// Its mean scores under the reference panel.
        scores: Dials<f64>,
    }

    fn known() -> Vec<Known> {
        ron_options().from_str(include_str!("anchors_1_digests.ron")).expect("known anchors")
    }

    #[test]
    fn the_anchors_are_the_worlds_that_they_were() {
        let survey = Anchors::first().survey(&Panel::reference(), 1);
        let known = known();
        assert_eq!(survey.maps().count(), known.len());
        for (map, known) in survey.maps().zip(&known) {
            assert_eq!((&map.family.name, map.seed), (&known.family, known.seed));
            let world = map.family.spec.generate(map.seed).expect("a world").to_world();
            let digest = world.digest().to_string();
            assert_eq!(
                digest, known.digest,
                "{}, seed {}: another world",
                known.family, known.seed
            );
        }
    }

    #[test]
    fn the_scale_is_that_of_the_known_anchors() {
        let known = known();
        let scale = reference_scale();
        for (anchors, end) in known.chunks(20).zip([scale.zero, scale.ten]) {
            for (dial, (found, end)) in mean(anchors.iter().map(|one| one.scores)).zip(end).named()
            {
                // Trials have changed a little since the scale was measured.
                assert!((found - end).abs() < 0.05, "{dial}: {found}, the scale has {end}");
            }
        }
    }

    #[test]
    fn the_scale_lies_between_the_means_of_the_anchors() -> Result<(), ExperimentError> {
        let (anchors, panel) = (Anchors::first(), Panel::reference());
        let survey = anchors.survey(&panel, 2);
        survey.validate()?;
        assert_eq!(survey.trials(), 40 * 12 * 2);
        let records = [record(0, 0.0), record(19, 1.0), record(20, 6.0), record(39, 8.0)];
        let scale = anchors.scale(&panel, &records).expect("a scale");
        let zero = Dials { difficulty: 0.5, mapping: 1.0, navigation: 1.5 };
        assert_eq!((scale.zero, scale.ten.difficulty), (zero, 7.0));
        let reversed = [record(0, 5.0), record(20, 4.0)];
        let error = anchors.scale(&panel, &reversed).expect_err("no scale").to_string();
        assert_eq!(
            error,
            "the hard anchors must score more than the easy ones, got 4 and 5 of difficulty"
        );
        Ok(())
    }

    #[test]
    fn anchors_that_fail_are_counted_once() {
        let anchors = Anchors::first();
        assert_eq!(anchors.narrowest_doorway(), Some(0.82));
        let failed =
            |map| Record { map, failure: Some("too large".to_owned()), ..Record::default() };
        let records = [record(0, 1.0), failed(20), failed(20), record(21, 3.0), failed(39)];
        assert_eq!(anchors.failed(&records), 2);
    }

    #[test]
    fn anchors_that_cannot_be_measured_are_refused() {
        let family =
            |name: &str, maps: u32| format!("(name: \"{name}\", spec: Hallway(), maps: {maps})");
        let read = |easy: [u32; 2]| {
            let [a, b] = easy.map(|maps| family(&format!("{maps} a"), maps));
            let text = format!("(version: 1, easy: [{a}, {b}], hard: [{}])", family("hard", 1));
            Anchors::from_ron(&text).map_err(|error| error.to_string())
        };
        assert!(read([1, 2]).is_ok());
        let error = read([u32::MAX, 2]).expect_err("too many");
        assert!(error.contains("`maps` must be"), "{error}");
        let error = read([900_000, 900_001]).expect_err("too many");
        assert!(error.contains("at most 1000000 trials"), "{error}");
    }

    #[test]
    fn the_calibration_of_the_crate_is_of_these_anchors_and_this_panel() {
        let (anchors, panel, scale) = (Anchors::first(), Panel::reference(), reference_scale());
        assert_eq!(scale.panel, panel.name);
        assert_eq!((scale.panel_version, scale.anchors_version), (panel.version, anchors.version));
    }
}
