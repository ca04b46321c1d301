//! The design of the proof: its worlds and trials.

use std::collections::BTreeSet;

use envgen::indoor::IndoorSpec;
use envgen::{Seed, SpecError, WorldSpec, settings};

use super::dial::Dial;
use crate::difficulty::Panel;
use crate::experiment::survey::{Family, Survey, SurveyNoise, ron_options};

/// Panels that the calibration has not seen: frozen with it, and written since.
const HELD_OUT: [&str; 2] = [include_str!("held_out_1.ron"), include_str!("held_out_2.ron")];

settings! {
    /// The size of the proof.
    pub struct ProofDesign {
        /// Sides of the maps in cells, each tested by itself.
        footprints: Vec<u32> = vec![8, 10, 16] => list("cells", "whole numbers from 4 to 24", "8,10,16");
        /// Maps per footprint that are calibrated without simulation.
        maps: u32 = 120 => integer("", 4..=10_000);
        /// Maps per footprint that are verified.
        verified: u32 = 40 => integer("", 0..=10_000);
        /// Maps per footprint by the rules of the thesis.
        thesis: u32 = 40 => integer("", 0..=10_000);
        /// Maps per footprint that link the other conditions to the reference panel.
        link: u32 = 20 => integer("", 4..=10_000);
        /// Trials per map and condition, at least.
        noise_seeds: u32 = 3 => integer("", 1..=1000);
        /// Trials per map and panel, at least: panels of few conditions have more trials of each.
        panel_trials: u32 = 12 => integer("", 1..=1000);
        /// Names of the held-out panels; empty for all.
        held_out: Vec<String> = Vec::new() => list("", "names of held-out panels", "all");
        /// What is requested and measured; only maps of difficulties follow the rules of the thesis.
        #[serde(skip_serializing_if = "Dial::is_default")]
        dial: Dial = Dial::Difficulty => choice;
        /// Seed of everything.
        seed: Seed = Seed(77_000_000) => other("", "a seed");
    }
}

/// A part of the proof, to which maps belong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Maps that are predicted nearest to the request, without simulation.
    Calibrated,
    /// Maps that won a race.
    Verified,
    /// Maps by the rules of the thesis.
    Thesis,
    /// Maps that link other conditions to the reference panel.
    Link,
}

impl Part {
    /// Returns its name in files and folders.
    pub(super) fn name(self) -> &'static str {
        match self {
            Part::Calibrated => "calibrated",
            Part::Verified => "verified",
            Part::Thesis => "thesis",
            Part::Link => "link",
        }
    }
}

/// A map of the proof.
#[derive(Clone, Debug, PartialEq)]
pub struct ProofMap {
    /// Side of the map in cells.
    pub footprint: u32,
    /// Requested value of the design's dial; 0 for links.
    pub requested: f64,
    /// Spec from which it is generated.
    pub spec: IndoorSpec,
    /// Seed of the map.
    pub seed: Seed,
}

impl ProofDesign {
    /// Returns a short design, which takes minutes.
    pub fn quick() -> Self {
        ProofDesign {
            footprints: vec![8],
            maps: 16,
            verified: 0,
            thesis: 8,
            link: 8,
            noise_seeds: 1,
            panel_trials: 1,
            ..Default::default()
        }
    }

    /// Checks every number.
    ///
    /// # Errors
    ///
    /// Names the first field whose value is not allowed.
    pub fn validate(&self) -> Result<(), SpecError> {
        self.check_fields()?;
        let is_size = |size: &u32| (4..=24).contains(size);
        let distinct: BTreeSet<&u32> = self.footprints.iter().collect();
        let is_once = distinct.len() == self.footprints.len();
        if self.footprints.is_empty() || !self.footprints.iter().all(is_size) || !is_once {
            let all: Vec<String> = self.footprints.iter().map(u32::to_string).collect();
            let allowed = "one or more whole numbers from 4 to 24, each once";
            return Err(SpecError::new("footprints", all.join(","), allowed));
        }
        if self.dial != Dial::Difficulty && self.thesis > 0 {
            let allowed = "0 where the `dial` is not difficulty";
            return Err(SpecError::new("thesis", self.thesis, allowed));
        }
        let known: Vec<String> = held_out().into_iter().map(|panel| panel.name).collect();
        match self.held_out.iter().find(|name| !known.contains(name)) {
            Some(name) => {
                let allowed = format!("one of {}", known.join("; "));
                Err(SpecError::new("held_out", format!("\"{name}\""), allowed))
            }
            None => Ok(()),
        }
    }

    /// Returns the reference panel, and the chosen panels that the calibration has not seen.
    pub fn panels(&self) -> Vec<Panel> {
        let is_chosen =
            |panel: &Panel| self.held_out.is_empty() || self.held_out.contains(&panel.name);
        std::iter::once(Panel::reference())
            .chain(held_out().into_iter().filter(is_chosen))
            .collect()
    }

    /// Returns the number of maps of a part per footprint.
    pub fn count(&self, part: Part) -> u32 {
        match part {
            Part::Calibrated => self.maps,
            Part::Verified => self.verified,
            Part::Thesis => self.thesis,
            Part::Link => self.link,
        }
    }

    /// Returns the maps of a part. Requests are spread evenly over the range of each footprint: it is
    /// divided into as many equal intervals as there are maps, and one request is drawn in each.
    pub fn maps(&self, part: Part) -> Vec<ProofMap> {
        let count = self.count(part);
        let first = self.seed.offset(1_000_000 * (part as u64 + 1));
        let mut maps = Vec::new();
        for i in 0..count {
            for &footprint in &self.footprints {
                let seed = first.offset(maps.len() as u64);
                let base = IndoorSpec { width: footprint, height: footprint, ..Default::default() };
                let [least, most] = self.dial.of(base.reachable());
                let place =
                    (f64::from(i) + seed.stream("proof/request", 0).unit()) / f64::from(count);
                let requested = least + (most - least) * place;
                let (requested, spec) = match part {
                    Part::Calibrated | Part::Verified => {
                        (requested, self.dial.request(base, requested))
                    }
                    // The rules have all levels at every size.
                    Part::Thesis => (requested, IndoorSpec { difficulty: 10.0 * place, ..base }),
                    Part::Link => (0.0, base.draw_levers(seed)),
                };
                maps.push(ProofMap { footprint, requested, spec, seed });
            }
        }
        maps
    }

    /// Returns the survey of maps under a panel.
    pub fn survey(&self, maps: &[ProofMap], panel: Panel) -> Survey {
        let families = maps.iter().enumerate().map(|(i, map)| Family {
            name: format!("{i}: {} cells, {:.2}", map.footprint, map.requested),
            spec: WorldSpec::from(map.spec.clone()),
            maps: 1,
            first_seed: map.seed,
        });
        let conditions = panel.conditions;
        let for_panel = self.panel_trials.div_ceil(conditions.len().max(1) as u32);
        let noise_seeds = self.noise_seeds.max(for_panel);
        Survey { families: families.collect(), conditions, noise_seeds, noise: SurveyNoise::Own }
    }
}

/// Returns all panels that the calibration has not seen.
fn held_out() -> Vec<Panel> {
    let panels =
        |text: &str| -> Vec<Panel> { ron_options().from_str(text).expect("the files have panels") };
    HELD_OUT.into_iter().flat_map(panels).collect()
}

#[cfg(test)]
mod tests {
    use envgen::Spec;

    use super::*;

    #[test]
    fn every_condition_is_allowed() {
        for design in [ProofDesign::quick(), ProofDesign { maps: 8, ..Default::default() }] {
            assert_eq!(design.validate(), Ok(()));
            let maps = design.maps(Part::Calibrated);
            for panel in design.panels() {
                assert_eq!(design.survey(&maps, panel).validate(), Ok(()));
            }
        }
    }

    #[test]
    fn bad_designs_are_refused() {
        let error = |design: ProofDesign| design.validate().expect_err("bad").to_string();
        let sizes = error(ProofDesign { footprints: vec![3], ..Default::default() });
        assert!(sizes.starts_with("`footprints` must be one or more whole numbers"), "{sizes}");
        let twice = error(ProofDesign { footprints: vec![8, 10, 8], ..Default::default() });
        assert!(twice.ends_with("from 4 to 24, each once, got 8,10,8"), "{twice}");
        let thesis = error(ProofDesign { dial: Dial::Mapping, ..Default::default() });
        assert_eq!(thesis, "`thesis` must be 0 where the `dial` is not difficulty, got 40");
        let name = "all at twice".to_owned();
        let panel = error(ProofDesign { held_out: vec![name], ..Default::default() });
        let expected = "`held_out` must be one of operator corridors; laser of 12 m, 270 degrees; \
                        pose graph; TurtleBot3; all at once; operator tour, got \"all at twice\"";
        assert_eq!(panel, expected);
    }

    #[test]
    fn panels_of_few_conditions_have_more_trials_of_each() {
        let trials = |design: &ProofDesign| -> Vec<(String, usize, u32)> {
            let each = |panel: Panel| {
                let name = panel.name.clone();
                let survey = design.survey(&[], panel);
                (name, survey.conditions.len(), survey.noise_seeds)
            };
            design.panels().into_iter().map(each).collect()
        };
        let expected = [
            ("reference", 12, 3),
            ("operator corridors", 3, 4),
            ("laser of 12 m, 270 degrees", 4, 3),
            ("pose graph", 4, 3),
            ("TurtleBot3", 4, 3),
            ("all at once", 1, 12),
            ("operator tour", 3, 4),
        ];
        assert_eq!(trials(&ProofDesign::default()), expected.map(|(a, b, c)| (a.to_owned(), b, c)));
        let held_out = vec!["all at once".to_owned()];
        let expected = [("reference", 12, 1), ("all at once", 1, 1)];
        let quick = ProofDesign { held_out, ..ProofDesign::quick() };
        assert_eq!(trials(&quick), expected.map(|(a, b, c)| (a.to_owned(), b, c)));
    }

    #[test]
    fn each_dial_is_requested_over_what_it_reaches() {
        let reach = IndoorSpec { width: 16, height: 16, ..Default::default() }.reachable();
        for dial in [Dial::Difficulty, Dial::Mapping, Dial::Navigation] {
            let footprints = vec![16];
            let design =
                ProofDesign { dial, footprints, thesis: 0, maps: 40, ..Default::default() };
            let [least, most] = dial.of(reach);
            let (mut all, mut first, mut last) = (0, f64::MAX, f64::MIN);
            for map in design.maps(Part::Calibrated) {
                assert_eq!(map.spec.validate(), Ok(()));
                let request = map.spec.request().0;
                assert_eq!(dial.of(request), Some(map.requested));
                all += request.named().iter().filter(|(_, asked)| asked.is_some()).count();
                (first, last) = (first.min(map.requested), last.max(map.requested));
            }
            assert_eq!(all, 40, "one dial alone");
            let step = (most - least) / 40.0;
            assert!((least..least + step).contains(&first), "{first}");
            assert!((most - step..=most).contains(&last), "{last}");
        }
    }

    #[test]
    fn designs_of_difficulties_are_written_as_before_there_were_dials() {
        let json = serde_json::to_string(&ProofDesign::quick()).expect("JSON");
        let expected = concat!(
            r#"{"footprints":[8],"maps":16,"verified":0,"thesis":8,"link":8,"noise_seeds":1,"#,
            r#""panel_trials":1,"held_out":[],"seed":77000000}"#
        );
        assert_eq!(json, expected);
        assert_eq!(serde_json::from_str::<ProofDesign>(&json).ok(), Some(ProofDesign::quick()));
    }

    #[test]
    fn parts_share_no_seed_and_requests_are_spread() {
        let design = ProofDesign {
            footprints: vec![8, 10],
            thesis: 30,
            verified: 30,
            ..ProofDesign::quick()
        };
        let parts = [Part::Calibrated, Part::Verified, Part::Thesis, Part::Link];
        let mut seeds: Vec<Seed> =
            parts.iter().flat_map(|&part| design.maps(part)).map(|map| map.seed).collect();
        let all = seeds.len();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), all);
        let own = |map: &ProofMap| map.footprint == 8;
        let requests: Vec<f64> = design
            .maps(Part::Calibrated)
            .iter()
            .filter(|map| own(map))
            .map(|m| m.requested)
            .collect();
        assert!(requests.is_sorted());
        let [least, most] =
            IndoorSpec { width: 8, height: 8, ..Default::default() }.reachable().difficulty;
        assert!(requests.iter().all(|request| (least..=most).contains(request)));
    }
}
