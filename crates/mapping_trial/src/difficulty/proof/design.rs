//! Which worlds and trials the proof is made of.

use envgen::indoor::{IndoorSpec, Profile};
use envgen::{Seed, SpecError, WorldSpec, settings};

use crate::difficulty::Panel;
use crate::experiment::survey::{Condition, Family, Survey, ron_options};

const HELD_OUT: &str = include_str!("held_out_1.ron");

settings! {
    /// The size of the proof.
    pub struct ProofDesign {
        /// Sides of the maps in cells, each tested by itself.
        footprints: Vec<u32> = vec![8, 10, 16] => list("cells", "whole numbers from 6 to 24", "8,10,16");
        /// Maps per footprint that are calibrated without simulation.
        maps: u32 = 120 => integer("", 4..=10_000);
        /// Maps per footprint that are verified.
        verified: u32 = 40 => integer("", 0..=10_000);
        /// Maps per footprint by the rules of the thesis.
        thesis: u32 = 40 => integer("", 0..=10_000);
        /// Maps per footprint that link the other conditions to the reference panel.
        link: u32 = 20 => integer("", 4..=10_000);
        /// Trials per map and condition.
        noise_seeds: u32 = 3 => integer("", 1..=1000);
        /// Seed of everything.
        seed: Seed = Seed(77_000_000) => other("", "a seed");
    }
}

/// The part of the proof that a map belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Predicted nearest to the request, not simulated.
    Calibrated,
    /// The nearest of a race.
    Verified,
    /// By the rules of the thesis.
    Thesis,
    /// Maps that link conditions.
    Link,
}

/// A map of the proof.
#[derive(Clone, Debug, PartialEq)]
pub struct ProofMap {
    /// Side in cells.
    pub footprint: u32,
    /// The difficulty that is requested; of links, 0.
    pub requested: f64,
    /// What it is generated from.
    pub spec: IndoorSpec,
    /// Its seed.
    pub seed: Seed,
}

impl ProofDesign {
    /// A short form, for minutes.
    pub fn quick() -> Self {
        ProofDesign {
            footprints: vec![8],
            maps: 16,
            verified: 0,
            thesis: 8,
            link: 8,
            noise_seeds: 1,
            ..Default::default()
        }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// The first that is not allowed.
    pub fn validate(&self) -> Result<(), SpecError> {
        self.check_fields()?;
        let is_size = |size: &u32| (6..=24).contains(size);
        if self.footprints.is_empty() || !self.footprints.iter().all(is_size) {
            let all: Vec<String> = self.footprints.iter().map(u32::to_string).collect();
            let allowed = "one or more whole numbers from 6 to 24";
            return Err(SpecError::new("footprints", all.join(","), allowed));
        }
        Ok(())
    }

    /// The maps of a part. Requests are spread evenly over what each footprint reaches, one drawn in each
    /// of as many equal intervals as there are maps.
    pub fn maps(&self, part: Part) -> Vec<ProofMap> {
        let count = match part {
            Part::Calibrated => self.maps,
            Part::Verified => self.verified,
            Part::Thesis => self.thesis,
            Part::Link => self.link,
        };
        let first = self.seed.offset(1_000_000 * (part as u64 + 1));
        let mut maps = Vec::new();
        for i in 0..count {
            for &footprint in &self.footprints {
                let seed = first.offset(maps.len() as u64);
                let base = IndoorSpec { width: footprint, height: footprint, ..Default::default() };
                let [least, most] = base.reachable().difficulty;
                let place =
                    (f64::from(i) + seed.stream("proof/request", 0).unit()) / f64::from(count);
                let requested = least + (most - least) * place;
                let (requested, spec) = match part {
                    Part::Calibrated | Part::Verified => {
                        let profile = Profile::Calibrated;
                        (requested, IndoorSpec { profile, difficulty: requested, ..base })
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

    /// The survey of maps under the reference panel and all that is held out.
    pub fn survey(&self, maps: &[ProofMap]) -> Survey {
        let families = maps.iter().enumerate().map(|(i, map)| Family {
            name: format!("{i}: {} cells, {:.2}", map.footprint, map.requested),
            spec: WorldSpec::from(map.spec.clone()),
            maps: 1,
            first_seed: map.seed,
        });
        let conditions = panels().into_iter().flat_map(|panel| panel.conditions).collect();
        Survey { families: families.collect(), conditions, noise_seeds: self.noise_seeds }
    }
}

/// The reference panel, and the panels of what the calibration has not seen.
///
/// # Panics
/// Never: the file is part of the crate, and tested.
pub fn panels() -> Vec<Panel> {
    let held_out: Vec<Panel> = ron_options().from_str(HELD_OUT).expect("held_out_1.ron has panels");
    std::iter::once(Panel::reference()).chain(held_out).collect()
}

/// The panel of each condition of [`ProofDesign::survey`].
pub(super) fn panel_of_condition() -> Vec<usize> {
    let sizes = panels().into_iter().map(|panel| panel.conditions);
    let numbered = sizes.enumerate();
    numbered
        .flat_map(|(i, conditions): (usize, Vec<Condition>)| vec![i; conditions.len()])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_condition_is_allowed() {
        for design in [ProofDesign::quick(), ProofDesign { maps: 8, ..Default::default() }] {
            assert_eq!(design.validate(), Ok(()));
            let maps = design.maps(Part::Calibrated);
            let survey = design.survey(&maps);
            assert_eq!(survey.validate(), Ok(()));
            assert_eq!(survey.conditions.len(), panel_of_condition().len());
        }
        let bad = ProofDesign { footprints: vec![4], ..Default::default() };
        let error = bad.validate().expect_err("too small").to_string();
        assert!(error.starts_with("`footprints` must be one or more whole numbers"), "{error}");
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
