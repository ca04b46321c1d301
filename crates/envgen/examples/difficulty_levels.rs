//! Draws maps of five requested difficulties, six of each, all of one size.
//!
//! `cargo run --release --example difficulty_levels -- docs/pictures/difficulty_levels.png`

mod sheet;

use std::path::PathBuf;

use envgen::indoor::{IndoorSpec, Profile};
use envgen::{Blueprint, Seed, Spec};
use indicatif::ProgressIterator;
use sheet::Result;

/// Number of difficulties, of maps of each, and the side of the maps in cells.
const LEVELS: u32 = 5;
const MAPS: u32 = 6;
const SIDE: u32 = 8;

fn main() -> Result {
    let file = std::env::args().nth(1).ok_or("usage: difficulty_levels FILE")?;
    let profile = Profile::Calibrated;
    let base = IndoorSpec { width: SIDE, height: SIDE, profile, ..Default::default() };
    let [least, most] = base.reachable().difficulty;
    let mut pictures = Vec::new();
    for map in (0..LEVELS * MAPS).progress() {
        let share = (f64::from(map / MAPS) + 0.5) / f64::from(LEVELS);
        let difficulty = (10.0 * (least + (most - least) * share)).round() / 10.0;
        let spec = IndoorSpec { difficulty, ..base.clone() };
        let plan = spec.generate(Seed(u64::from(map)))?;
        let predicted = plan.prediction().ok_or("a calibrated plan has a prediction")?;
        let value = predicted.dials.difficulty.value;
        let title = format!("requested {difficulty:.1}, predicted {value:.1}");
        pictures.push(sheet::picture(&plan.to_world(), title)?);
    }
    sheet::write(&PathBuf::from(file), &pictures, MAPS as usize)
}
