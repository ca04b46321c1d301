//! Draws what features of difficulty look like: for each, of many maps of one size, the map with its least
//! value and the one with its greatest.
//!
//! `cargo run --release --example difficulty_features -- docs/pictures/difficulty_features.png`
//!
//! Names of features after the file replace the list of this program.

mod sheet;

use std::path::PathBuf;

use envgen::difficulty::{DifficultyVector, Feature, Platform};
use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec, World};
use indicatif::ProgressIterator;
use sheet::{Image, Result};

/// Number of maps, and their side in cells: of one size, since nearly every feature grows with the size.
const MAPS: u32 = 200;
const SIDE: u32 = 8;

/// What is drawn if the arguments name no features.
const FEATURES: [&str; 16] = [
    "scan_degeneracy",
    "scan_position_error_80_m",
    "visible_area_mean_m2",
    "lost_beam_share",
    "tour_length_95_m",
    "tour_dead_ends",
    "tour_odometry_noise_mean",
    "tour_wheel_bias_mean",
    "drift_position_m",
    "drift_worst_gap_m",
    "clearance_50_m",
    "tour_length_over_clearance",
    "wall_length_m",
    "short_walls_per_m2",
    "places",
    "loops",
];

/// Pictures in a row.
const COLUMNS: usize = 4;

/// A map with the values of its features, in the order of [`DifficultyVector::features`].
struct Sample {
    world: World,
    values: Vec<Option<f64>>,
}

fn main() -> Result {
    let mut arguments = std::env::args().skip(1);
    let file: PathBuf =
        arguments.next().ok_or("usage: difficulty_features FILE [FEATURE..]")?.into();
    let named: Vec<String> = arguments.collect();
    let features = if named.is_empty() {
        features(FEATURES)?
    } else {
        features(named.iter().map(String::as_str))?
    };
    let samples = (0..MAPS)
        .progress()
        .map(|i| sample(Seed(u64::from(i))))
        .collect::<Result<Vec<Sample>>>()?;
    let mut tiles = Vec::new();
    for (index, feature) in features {
        let (least, greatest) = ends(&samples, index)
            .ok_or_else(|| format!("no map has the feature {}", feature.name))?;
        tiles.push(tile(least, index, &feature)?);
        tiles.push(tile(greatest, index, &feature)?);
    }
    sheet::write(&file, &tiles, COLUMNS)
}

/// Features by name, with their places in the vector.
fn features<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Vec<(usize, Feature)>> {
    let all = DifficultyVector::features();
    let find = |name: &str| {
        let index = all.iter().position(|feature| feature.name == name);
        let index = index.ok_or_else(|| format!("no feature has the name `{name}`"))?;
        Ok((index, all[index]))
    };
    names.into_iter().map(find).collect()
}

/// A map of which all that makes maps easy or hard is drawn.
fn sample(seed: Seed) -> Result<Sample> {
    let base = IndoorSpec { width: SIDE, height: SIDE, ..Default::default() };
    let world = base.draw_levers(seed).generate(seed)?.to_world();
    let values = DifficultyVector::of(&world, &Platform::default())?.values();
    Ok(Sample { world, values })
}

/// The maps with the least and with the greatest value; `None` if no map has one.
fn ends(samples: &[Sample], index: usize) -> Option<(&Sample, &Sample)> {
    let with_value = || samples.iter().filter(|sample| sample.values[index].is_some());
    let by_value = |a: &&Sample, b: &&Sample| {
        let [a, b] = [a, b].map(|sample| sample.values[index].unwrap_or_default());
        a.total_cmp(&b)
    };
    with_value().min_by(by_value).zip(with_value().max_by(by_value))
}

/// The picture of a map, with the value of a feature as title.
fn tile(sample: &Sample, index: usize, feature: &Feature) -> Result<Image> {
    let value = sample.values[index].unwrap_or_default();
    let decimals = if value.fract() == 0.0 || value.abs() >= 100.0 { 0 } else { 3 };
    let title = format!("{} {value:.decimals$}", feature.name);
    sheet::picture(&sample.world, title)
}
