//! The analysis of the proof's results.

use envgen::calibration::Scale;
use envgen::difficulty::{DifficultyVector, Platform};
use envgen::{Blueprint, Spec};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;
use statrs::statistics::Statistics;

use super::agreement::{Agreement, Link, agreement, linked_agreement};
use super::design::{Part, ProofDesign};
use super::run::ProofResult;
use crate::experiment::stats::{Interval, mean_and_half, spearman};

/// All comparisons.
#[derive(Clone, Debug, Serialize)]
pub struct Analysis {
    /// The design.
    pub design: ProofDesign,
    /// The links from each panel to the reference.
    pub links: Vec<Option<Link>>,
    /// The agreement of each part at each footprint under each panel.
    pub rows: Vec<Row>,
    /// The maps that are in no comparison; no entry for parts without such maps.
    pub dropped: Vec<Dropped>,
    /// Mean measured values of the calibrated maps, by request.
    pub levels: Vec<Level>,
    /// How much single numbers explain, for the calibrated maps.
    pub singles: Vec<Single>,
    /// The calibrated maps by kind.
    pub kinds: Vec<MapKind>,
    /// The calibrated maps of all footprints together; absent for a single footprint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub all_sizes: Option<AllSizes>,
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

/// The agreement of one part with its requests.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The part.
    pub part: Part,
    /// Side of the maps in cells.
    pub footprint: u32,
    /// Name of the panel.
    pub panel: String,
    /// Agreement of this panel's measurements on the reference's scale.
    pub raw: Agreement,
    /// Agreement of the values that are linked to the reference panel.
    pub linked: Agreement,
    /// Fraction of the variance of the measured values over maps that is not noise of trials; absent if
    /// a condition has a single trial in a map, or if all values are equal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reliability: Option<f64>,
    /// Rank correlation divided by the root of the reliability, from -1 to 1: an estimate of the
    /// correlation without noise (Spearman, 1904).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rho_without_noise: Option<f64>,
}

/// The calibrated maps with requests near a level, within one unit to either side.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Level {
    /// Side of the maps in cells.
    pub footprint: u32,
    /// The level.
    pub level: f64,
    /// Number of maps.
    pub maps: usize,
    /// Mean measured value, by the dial.
    pub mean: f64,
    /// Half of Student's 95 % interval of that mean.
    pub half_interval: f64,
}

/// The largest fraction of the variance of measured values that one number explains.
#[derive(Clone, Debug, Serialize)]
pub struct Single {
    /// Side of the maps in cells.
    pub footprint: u32,
    /// `setting`, `two settings` or `feature`.
    pub of: &'static str,
    /// Name of the number.
    pub name: String,
    /// Squared rank correlation with the measured values.
    pub explained: f64,
    /// Squared rank correlation of the metres of wall with the measured values.
    pub wall_length: f64,
}

/// The calibrated maps of a kind, under the reference panel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MapKind {
    /// Side of the maps in cells.
    pub footprint: u32,
    /// The kind, such as `mazes requested`.
    pub kind: &'static str,
    /// Number of maps.
    pub maps: usize,
    /// Rank correlation between measured and requested values; absent for fewer than three maps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rho: Option<f64>,
    /// Mean absolute difference between measured and requested values.
    pub error: f64,
    /// Mean difference, which is positive if maps are harder than requested.
    pub offset: f64,
}

/// The order of the calibrated maps of all footprints together, under the reference panel.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct AllSizes {
    /// Number of maps.
    pub maps: usize,
    /// Rank correlation between measured and requested values.
    pub rho: Option<Interval>,
    /// Rank correlation of measured values with the metres of wall alone.
    pub wall_length: Option<f64>,
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
                let scores: Vec<f64> = own.iter().map(|one| one.scores[i]).collect();
                let measured: Vec<f64> = scores.iter().map(|&score| dial(score)).collect();
                let raw = agreement(&requested, &measured);
                // The link of the reference panel is to itself.
                let linked = (i > 0).then(|| {
                    let of = |panel: usize| of(Part::Link).iter().map(move |one| one.scores[panel]);
                    let (reference, other): (Vec<f64>, Vec<f64>) = of(0).zip(of(i)).unzip();
                    linked_agreement((&requested, &scores), (&reference, &other), dial)
                });
                let reliability = reliability(&own, i);
                let rho = raw.rho.zip(reliability.filter(|share| *share > 0.0));
                rows.push(Row {
                    part,
                    footprint,
                    panel: panel.clone(),
                    raw,
                    linked: linked.flatten().unwrap_or(raw),
                    reliability,
                    rho_without_noise: rho
                        .map(|(rho, share)| (rho.value / share.sqrt()).clamp(-1.0, 1.0)),
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
    let described: Vec<Described<'_>> =
        calibrated.par_iter().filter_map(|one| Described::new(one, measured(one))).collect();
    let is_whole = |footprint: u32| {
        let of_size = |one: &&ProofResult| one.map.footprint == footprint;
        let known = described.iter().map(|one| one.result).filter(of_size).count();
        known == calibrated.iter().filter(of_size).count()
    };
    let singles =
        design.footprints.iter().filter(|&&footprint| is_whole(footprint)).flat_map(|&footprint| {
            let own = described.iter().filter(|one| one.result.map.footprint == footprint);
            singles(footprint, &own.collect::<Vec<_>>())
        });
    let kinds = design.footprints.iter().flat_map(|&footprint| {
        let own = described.iter().filter(|one| one.result.map.footprint == footprint);
        kinds(footprint, &own.collect::<Vec<_>>())
    });
    Analysis {
        design: design.clone(),
        levels: levels.collect(),
        singles: singles.collect(),
        kinds: kinds.collect(),
        all_sizes: (design.footprints.len() > 1).then(|| all_sizes(&described)),
        dropped: dropped(design, results),
        links,
        rows,
    }
}

/// Fraction of the variance of a panel's measurements over maps that is not noise of trials.
fn reliability(maps: &[&ProofResult], panel: usize) -> Option<f64> {
    let noise: Vec<f64> = maps.iter().map(|one| one.noise[panel]).collect::<Option<_>>()?;
    let variance = maps.iter().map(|one| one.scores[panel]).variance();
    (variance > 0.0).then(|| (1.0 - noise.mean() / variance).clamp(0.0, 1.0))
}

/// The maps that have no result, of those parts that were run.
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

/// The links of all panels over the same maps. That of the reference panel is to itself.
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

/// A map with what is known of it without trials.
struct Described<'a> {
    result: &'a ProofResult,
    measured: f64,
    terms: Vec<(&'static str, f64)>,
    features: Vec<Option<f64>>,
    /// Metres of wall.
    wall_length: f64,
}

impl<'a> Described<'a> {
    /// Returns `None` if its world has no difficulty vector.
    fn new(result: &'a ProofResult, measured: f64) -> Option<Self> {
        let plan = result.map.spec.generate(result.map.seed).ok()?;
        let vector = DifficultyVector::of(&plan.to_world(), &Platform::default()).ok()?;
        let (terms, features) = (plan.spec().lever_terms(), vector.values());
        let all = DifficultyVector::features();
        let wall = all.iter().position(|feature| feature.name == "wall_length_m");
        let wall_length = wall.and_then(|i| *features.get(i)?).unwrap_or(0.0);
        Some(Described { result, measured, terms, features, wall_length })
    }

    fn feature(&self, i: usize) -> f64 {
        self.features.get(i).copied().flatten().unwrap_or(0.0)
    }
}

/// How well the maps of each kind agree with their requests: kinds by the layout of hallways, and by
/// the request for rooms.
fn kinds(footprint: u32, maps: &[&Described<'_>]) -> Vec<MapKind> {
    let is = |one: &Described<'_>, term: &str| {
        let found = one.terms.iter().find(|(name, _)| *name == term);
        found.unwrap_or_else(|| unreachable!("`{term}` is a term of all maps")).1 > 0.0
    };
    let of = |kind: &'static str, term: &str, expected: bool| {
        let own: Vec<_> = maps.iter().filter(|one| is(one, term) == expected).collect();
        let requested: Vec<f64> = own.iter().map(|one| one.result.map.requested).collect();
        let measured: Vec<f64> = own.iter().map(|one| one.measured).collect();
        let n = own.len() as f64;
        let differences = || requested.iter().zip(&measured).map(|(asked, found)| found - asked);
        (!own.is_empty()).then(|| MapKind {
            footprint,
            kind,
            maps: own.len(),
            rho: (own.len() > 2).then(|| spearman(&requested, &measured)).flatten(),
            error: differences().map(f64::abs).sum::<f64>() / n,
            offset: differences().sum::<f64>() / n,
        })
    };
    [
        of("hallways on a grid", "l_system", false),
        of("hallways that branch", "l_system", true),
        of("no mazes requested", "mazes", false),
        of("mazes requested", "mazes", true),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// How well the order of maps of all sizes agrees with their requests, and with their size alone.
fn all_sizes(maps: &[Described<'_>]) -> AllSizes {
    let of = |value: fn(&Described<'_>) -> f64| maps.iter().map(value).collect::<Vec<f64>>();
    let measured = of(|one| one.measured);
    AllSizes {
        maps: maps.len(),
        rho: agreement(&of(|one| one.result.map.requested), &measured).rho,
        wall_length: spearman(&of(|one| one.wall_length), &measured),
    }
}

/// Returns the best setting, the best product of two settings, and the best feature.
fn singles(footprint: u32, maps: &[&Described<'_>]) -> Vec<Single> {
    let Some(first) = maps.first() else { return Vec::new() };
    let measured: Vec<f64> = maps.iter().map(|one| one.measured).collect();
    let squared = |value: &dyn Fn(&Described<'_>) -> f64| {
        let values: Vec<f64> = maps.iter().map(|one| value(one)).collect();
        spearman(&values, &measured).map_or(0.0, |rho| rho * rho)
    };
    let wall_length = squared(&|one| one.wall_length);
    let by_setting = first.terms.iter().enumerate().map(|(i, (name, _))| {
        (*name, squared(&|one| one.terms.get(i).map_or(0.0, |(_, value)| *value)))
    });
    // The names of products have both settings.
    let (by_two, by_one): (Vec<_>, Vec<_>) =
        by_setting.partition(|(name, _)| name.contains("_and_"));
    let features = DifficultyVector::features();
    let by_feature =
        features.iter().enumerate().map(|(i, one)| (one.name, squared(&|map| map.feature(i))));
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
    use envgen::indoor::{IndoorSpec, Layout};

    use super::super::design::ProofMap;
    use super::*;

    const MAPS: u32 = 8;

    /// Eight maps of 6 x 6 cells with requests from 1 to 8, what two panels measure of each, and four that link
    /// them.
    fn analysis(reference: fn(f64) -> f64, other: fn(f64) -> f64) -> Analysis {
        analysis_of(&[6], reference, other)
    }

    /// The same of several footprints; requests of the second begin where those of the first end, and so on.
    fn analysis_of(
        footprints: &[u32],
        reference: fn(f64) -> f64,
        other: fn(f64) -> f64,
    ) -> Analysis {
        let held_out = vec!["pose graph".to_owned()];
        let design = ProofDesign {
            footprints: footprints.to_vec(),
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
            let place = (requested as usize - 1) / MAPS as usize;
            let footprint = footprints[place];
            let spec = IndoorSpec { width: footprint, height: footprint, ..Default::default() };
            let seed = Seed(u64::from(requested));
            let requested = f64::from(requested);
            let map = ProofMap { footprint, requested, spec, seed };
            let scores = vec![reference(requested), other(requested)];
            // The variance of requests from 1 to 8 is 6.
            ProofResult { map, scores, noise: vec![Some(1.5), None] }
        };
        // Two of the maps that link are missing.
        let results = [
            (Part::Link, (1..=4).map(result).collect()),
            (Part::Calibrated, (1..=MAPS * footprints.len() as u32).map(result).collect()),
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
        assert_eq!(found.rows[0].reliability, Some(0.75));
        assert_eq!(found.rows[0].rho_without_noise, Some(1.0));
        assert_eq!(found.rows[1].reliability, None);
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
        assert_eq!(found.rows[0].rho_without_noise, Some(-1.0));
        assert_eq!(value(found.rows[1].raw.rho), 1.0);
    }

    #[test]
    fn every_map_is_of_a_kind_by_its_hallways_and_by_its_rooms() {
        let map = |seed: u64| {
            let layout = if seed < 3 { Layout::LSystem } else { Layout::Grid };
            let mazes = if seed.is_multiple_of(2) { 0.3 } else { 0.0 };
            let spec = IndoorSpec { width: 6, height: 6, layout, mazes, ..Default::default() };
            let requested = seed as f64;
            ProofResult {
                map: ProofMap { footprint: 6, requested, spec, seed: Seed(seed) },
                scores: vec![requested - 0.5],
                noise: vec![None],
            }
        };
        let maps: Vec<ProofResult> = (0..8).map(map).collect();
        let described: Vec<Described<'_>> =
            maps.iter().filter_map(|one| Described::new(one, one.scores[0])).collect();
        let found = kinds(6, &described.iter().collect::<Vec<_>>());
        let counts: Vec<(&str, usize)> = found.iter().map(|kind| (kind.kind, kind.maps)).collect();
        let expected = [
            ("hallways on a grid", 5),
            ("hallways that branch", 3),
            ("no mazes requested", 4),
            ("mazes requested", 4),
        ];
        assert_eq!(counts, expected);
        for kind in found {
            assert_eq!((kind.footprint, kind.rho), (6, Some(1.0)));
            assert_eq!((kind.error, kind.offset), (0.5, -0.5));
        }
    }

    #[test]
    fn all_sizes_are_ordered_together() {
        assert!(analysis(|x| x, |x| x).all_sizes.is_none());
        let found = analysis_of(&[6, 9], |x| x, |x| x).all_sizes.expect("two sizes");
        assert_eq!((found.maps, value(found.rho)), (16, 1.0));
        // The larger maps are the harder ones here, so that walls alone know which of the two a map is.
        let wall_length = found.wall_length.expect("a correlation");
        assert!((0.7..1.0).contains(&wall_length), "{wall_length}");
        let reversed = analysis_of(&[6, 9], |x| 20.0 - x, |x| x).all_sizes.expect("two sizes");
        assert_eq!((value(reversed.rho), reversed.wall_length), (-1.0, Some(-wall_length)));
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
