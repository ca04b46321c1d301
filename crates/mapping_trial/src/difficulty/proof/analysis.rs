//! What the proof shows.

use envgen::calibration::Scale;
use envgen::difficulty::{DifficultyVector, Platform};
use envgen::{Blueprint, Spec};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;

use super::agreement::{Agreement, Link, agreement};
use super::design::{Part, ProofDesign};
use super::run::ProofResult;
use crate::experiment::stats::{mean_and_half, spearman};

/// All comparisons.
#[derive(Clone, Debug, Serialize)]
pub struct Analysis {
    /// The design.
    pub design: ProofDesign,
    /// The links from the other panels to the reference.
    pub links: Vec<Option<Link>>,
    /// Each part at each footprint under each panel.
    pub rows: Vec<Row>,
    /// The maps that are in no comparison; absent for parts without any.
    pub dropped: Vec<Dropped>,
    /// The means of what is measured of the calibrated maps, by request.
    pub levels: Vec<Level>,
    /// What a single number explains, of the calibrated maps.
    pub singles: Vec<Single>,
}

/// Maps of a part that are left out of all comparisons, since trials of a panel cannot run in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Dropped {
    /// The part.
    pub part: Part,
    /// Side of the maps in cells.
    pub footprint: u32,
    /// Number of maps that are left out.
    pub dropped: u32,
    /// Number of maps in the design.
    pub maps: u32,
}

/// How one part agrees with its requests.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The part.
    pub part: Part,
    /// Side of the maps in cells.
    pub footprint: u32,
    /// Name of the panel.
    pub panel: String,
    /// With what this panel measures, on the reference's scale.
    pub raw: Agreement,
    /// With values linked to the reference panel.
    pub linked: Agreement,
}

/// The calibrated maps whose requests are near a level, one unit to either side.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Level {
    /// Side of the maps in cells.
    pub footprint: u32,
    /// The level.
    pub level: f64,
    /// Number of maps.
    pub maps: usize,
    /// Mean of what is measured of them, by the dial.
    pub mean: f64,
    /// Half of Student's interval of 95 % of that mean.
    pub half_interval: f64,
}

/// The largest share of the variance of what is measured that one number explains.
#[derive(Clone, Debug, Serialize)]
pub struct Single {
    /// Side of the maps in cells.
    pub footprint: u32,
    /// `setting`, `two settings` or `feature`.
    pub of: &'static str,
    /// Its name.
    pub name: String,
    /// Squared rank correlation with what is measured.
    pub explained: f64,
    /// The same of the metres of wall.
    pub wall_length: f64,
}

/// Analyses the results of all parts.
pub fn analyse(
    design: &ProofDesign,
    scale: &Scale,
    results: &[(Part, Vec<ProofResult>)],
) -> Analysis {
    let of = |part: Part| {
        results.iter().find(|(own, _)| *own == part).map_or(&[][..], |(_, all)| all.as_slice())
    };
    let names: Vec<String> = design.panels().into_iter().map(|panel| panel.name).collect();
    let links = links(of(Part::Link), names.len());
    let (unit, zero) = (design.dial.of(scale.units()), design.dial.of(scale.zero));
    let dial = |score: f64| unit * (score - zero);
    let mut rows = Vec::new();
    for part in [Part::Calibrated, Part::Verified, Part::Thesis] {
        for &footprint in &design.footprints {
            let own: Vec<&ProofResult> =
                of(part).iter().filter(|result| result.map.footprint == footprint).collect();
            if own.is_empty() {
                continue;
            }
            let requested: Vec<f64> = own.iter().map(|result| result.map.requested).collect();
            for (i, panel) in names.iter().enumerate() {
                let values = |link: Option<Link>| {
                    let linked = |score: f64| link.map_or(score, |link| link.apply(score));
                    own.iter().map(|one| dial(linked(one.scores[i]))).collect::<Vec<f64>>()
                };
                rows.push(Row {
                    part,
                    footprint,
                    panel: panel.clone(),
                    raw: agreement(&requested, &values(None)),
                    linked: agreement(&requested, &values(links[i])),
                });
            }
        }
    }
    let calibrated = of(Part::Calibrated);
    let measured = |one: &ProofResult| dial(one.scores[0]);
    let levels = design.footprints.iter().flat_map(|&footprint| {
        let own = calibrated.iter().filter(move |one| one.map.footprint == footprint);
        levels(footprint, own.map(|one| (one.map.requested, measured(one))).collect())
    });
    let singles = design.footprints.iter().flat_map(|&footprint| {
        let own: Vec<&ProofResult> =
            calibrated.iter().filter(|one| one.map.footprint == footprint).collect();
        let values: Vec<f64> = own.iter().map(|one| measured(one)).collect();
        singles(footprint, &own, &values)
    });
    Analysis {
        design: design.clone(),
        levels: levels.collect(),
        singles: singles.collect(),
        dropped: dropped(design, results),
        links,
        rows,
    }
}

/// The maps of the parts that were run which have no result.
fn dropped(design: &ProofDesign, results: &[(Part, Vec<ProofResult>)]) -> Vec<Dropped> {
    let of = |(part, all): &(Part, Vec<ProofResult>)| {
        let (part, maps) = (*part, design.count(*part));
        let missing = |&footprint: &u32| {
            let found = all.iter().filter(|one| one.map.footprint == footprint).count();
            let dropped = maps.saturating_sub(found as u32);
            (dropped > 0).then_some(Dropped { part, footprint, dropped, maps })
        };
        design.footprints.iter().filter_map(missing).collect::<Vec<Dropped>>()
    };
    results.iter().flat_map(of).collect()
}

/// The links of all panels over the same maps; the reference links to itself.
fn links(results: &[ProofResult], panels: usize) -> Vec<Option<Link>> {
    let scores = |panel: usize| results.iter().map(|one| one.scores[panel]).collect::<Vec<f64>>();
    (0..panels).map(|panel| Link::new(&scores(0), &scores(panel))).collect()
}

fn levels(footprint: u32, maps: Vec<(f64, f64)>) -> Vec<Level> {
    let level = |level: f64| {
        let own: Vec<f64> = maps
            .iter()
            .filter(|(requested, _)| (requested - level).abs() < 1.0)
            .map(|(_, measured)| *measured)
            .collect();
        let (mean, half_interval) = mean_and_half(&own);
        (own.len() > 1).then_some(Level { footprint, level, maps: own.len(), mean, half_interval })
    };
    [1.0, 3.0, 5.0, 7.0, 9.0].into_iter().filter_map(level).collect()
}

/// The best setting, the best product of two settings, and the best feature.
fn singles(footprint: u32, results: &[&ProofResult], measured: &[f64]) -> Vec<Single> {
    let described: Vec<_> = results
        .par_iter()
        .filter_map(|one| {
            let plan = one.map.spec.generate(one.map.seed).ok()?;
            let vector = DifficultyVector::of(&plan.to_world(), &Platform::default()).ok()?;
            Some((plan.spec().lever_terms(), vector.values()))
        })
        .collect();
    let Some((terms, _)) = described.first() else { return Vec::new() };
    if described.len() != measured.len() {
        return Vec::new();
    }
    let squared = |values: Vec<f64>| spearman(&values, measured).map_or(0.0, |rho| rho * rho);
    let features = DifficultyVector::features();
    let feature =
        |i: usize| squared(described.iter().map(|(_, values)| values[i].unwrap_or(0.0)).collect());
    let wall = features.iter().position(|feature| feature.name == "wall_length_m");
    let wall_length = wall.map_or(0.0, feature);
    let by_setting = terms.iter().enumerate().map(|(i, (name, _))| {
        (*name, squared(described.iter().map(|(terms, _)| terms[i].1).collect()))
    });
    // Products are named after both.
    let (by_two, by_one): (Vec<_>, Vec<_>) =
        by_setting.partition(|(name, _)| name.contains("_and_"));
    let by_feature = features.iter().enumerate().map(|(i, one)| (one.name, feature(i)));
    let best = |all: Vec<(&'static str, f64)>, of: &'static str| {
        let best = all.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let (name, explained) = (best.0.to_owned(), best.1);
        Some(Single { footprint, of, name, explained, wall_length })
    };
    [best(by_one, "setting"), best(by_two, "two settings"), best(by_feature.collect(), "feature")]
        .into_iter()
        .flatten()
        .collect()
}

#[cfg(test)]
mod tests {
    use envgen::Seed;
    use envgen::calibration::Dials;
    use envgen::indoor::IndoorSpec;

    use super::super::design::ProofMap;
    use super::*;
    use crate::experiment::stats::Interval;

    const MAPS: u32 = 8;

    /// Eight maps of 6 x 6 cells with requests from 1 to 8, what two panels measure of each, and four that link
    /// them.
    fn analysis(reference: fn(f64) -> f64, other: fn(f64) -> f64) -> Analysis {
        let held_out = vec!["pose graph".to_owned()];
        let footprints = vec![6];
        let design = ProofDesign {
            footprints,
            maps: MAPS,
            verified: 0,
            link: 6,
            held_out,
            ..Default::default()
        };
        let (zero, ten) = (Dials::default(), Dials::default().map(|_: f64| 10.0));
        let panel = "reference".to_owned();
        let scale = Scale { panel, panel_version: 1, anchors_version: 1, zero, ten };
        let result = |requested: u32| {
            let spec = IndoorSpec { width: 6, height: 6, ..Default::default() };
            let seed = Seed(u64::from(requested));
            let requested = f64::from(requested);
            let map = ProofMap { footprint: 6, requested, spec, seed };
            ProofResult { map, scores: vec![reference(requested), other(requested)] }
        };
        // Two of the maps that link are missing.
        let results = [
            (Part::Link, (1..=4).map(result).collect()),
            (Part::Calibrated, (1..=MAPS).map(result).collect()),
        ];
        analyse(&design, &scale, &results)
    }

    fn value(interval: Option<Interval>) -> f64 {
        interval.expect("an interval").value
    }

    #[test]
    fn a_perfect_line_agrees() {
        let found = analysis(|x| x, |x| x);
        assert_eq!(found.rows.len(), 2);
        for row in &found.rows {
            assert_eq!((row.part, row.footprint, row.raw.maps), (Part::Calibrated, 6, 8));
            for agreement in [row.raw, row.linked] {
                assert_eq!((value(agreement.rho), value(agreement.tau)), (1.0, 1.0));
                assert!((value(agreement.slope) - 1.0).abs() < 1e-12);
                assert!(value(agreement.intercept).abs() < 1e-9);
                assert!(value(agreement.error) < 1e-9 && value(agreement.near) == 1.0);
            }
        }
        // Requests within one unit of the level are its own: 3 alone.
        assert!(found.levels.is_empty(), "{:?}", found.levels);
    }

    #[test]
    fn the_link_removes_a_constant_offset() {
        let found = analysis(|x| x, |x| x + 2.0);
        let [reference, other] = &found.rows[..] else { panic!("two panels: {:?}", found.rows) };
        assert_eq!((value(reference.raw.error), value(reference.raw.near)), (0.0, 1.0));
        assert_eq!((value(other.raw.error), value(other.raw.near)), (2.0, 0.0));
        assert_eq!((value(other.raw.rho), value(other.raw.intercept)), (1.0, 2.0));
        assert!(value(other.linked.error) < 1e-12 && value(other.linked.near) == 1.0);
        let link = found.links[1].expect("a link");
        assert!((link.slope - 1.0).abs() < 1e-12 && (link.intercept + 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_reversed_order_is_minus_1() {
        let found = analysis(|x| 9.0 - x, |x| x);
        let reference = &found.rows[0].raw;
        assert_eq!((value(reference.rho), value(reference.tau)), (-1.0, -1.0));
        assert!((value(reference.slope) + 1.0).abs() < 1e-12);
        // Of 4 and 5 the others are 5 and 4.
        assert_eq!((value(reference.error), value(reference.near)), (4.0, 0.0));
        assert_eq!(value(found.rows[1].raw.rho), 1.0);
    }

    #[test]
    fn levels_of_few_maps_have_the_interval_of_student() {
        let found = levels(8, vec![(8.2, 4.0), (8.9, 5.0), (9.9, 6.0), (10.0, 9.0)]);
        let [level] = &found[..] else { panic!("one level: {found:?}") };
        assert_eq!((level.level, level.maps, level.mean), (9.0, 3, 5.0));
        // Standard error 1 / sqrt 3, t(2, 97.5 %) = 4.302653.
        let half = 4.302_652_73 / 3.0_f64.sqrt();
        assert!((level.half_interval - half).abs() < 1e-6, "{level:?}");
    }

    #[test]
    fn maps_without_a_result_are_counted_by_part() {
        let found = analysis(|x| x, |x| x).dropped;
        assert_eq!(found, [Dropped { part: Part::Link, footprint: 6, dropped: 2, maps: 6 }]);
    }
}
