//! How well walls were mapped: precision, recall, distances and ghosts.

use glam::DVec2;

use super::raster::Raster;
use super::swept::SweptCells;
use crate::map::{CellIndex, OccupancyMap, RESOLUTION};
use crate::mappable_area::{MappableArea, SCORE_CELL, WallPoint};
use envgen::distance::{FAR_SQUARED, squared_distances};

/// Greatest distance in metres that counts. Larger ones count as this one.
pub(super) const CUT: f64 = 1.0;

/// Distance in metres to either side of a wall within which a second image of it is searched.
const GHOST_REACH: f64 = 0.7;

/// Distance in metres within which true walls are searched. A map that is off by 0.6 m brings no true
/// wall into view that was not expected.
const TRUE_REACH: f64 = 1.3;

/// Least distance in metres between two images. Nearer ones are one blurred wall, or the two sides of a
/// thin one.
const APART: f64 = 0.2;

/// The walls of a map compared with those of the world.
pub(super) struct WallScores {
    pub(super) precision: [f64; 2],
    pub(super) recall: [f64; 2],
    pub(super) distance: f64,
    pub(super) ghosting: f64,
}

/// Compares walls with two tolerances in metres. Cells in which something moved do not count.
pub(super) fn compare(
    truth: &MappableArea,
    runs: &[u8],
    raster: &Raster,
    swept: Option<&SweptCells>,
    tolerances: [f64; 2],
) -> WallScores {
    let (mut found, mut mapped) = (Tally::new(tolerances), Tally::new(tolerances));
    // For each wall cell of the map: how far is the nearest true wall?
    for (cell, _) in raster.occupied.iter().enumerate().filter(|(_, occupied)| **occupied) {
        let (col, row) = raster.frame.place(cell);
        if swept.is_some_and(|swept| swept.is_moving(col, row)) {
            continue;
        }
        let squared = truth.frame().cell(col, row).map(|cell| truth.wall_distance()[cell]);
        mapped.add(squared.unwrap_or(FAR_SQUARED));
    }
    for _ in 0..raster.occupied_outside {
        mapped.add(FAR_SQUARED);
    }
    // For each wall point of the world: how far is the nearest wall of the map?
    let distance = squared_distances(raster.frame.cols, &raster.occupied);
    let is_moving = |p: DVec2| swept.is_some_and(|swept| swept.is_moving_at(p));
    for point in truth.walls().iter().filter(|point| !is_moving(point.position)) {
        found.add(match raster.frame.cell_at(point.position) {
            Some(cell) => distance[cell],
            // Beyond the map, nothing is nearer than its border.
            None => FAR_SQUARED,
        });
    }
    let recall = found.shares(1.0);
    // If there is nothing to find, an empty map is right.
    let precision = mapped.shares(if truth.walls().is_empty() { 1.0 } else { 0.0 });
    WallScores {
        precision,
        recall,
        // Without any walls, the map has no error.
        distance: if found.count + mapped.count > 0 {
            0.5 * (found.mean() + mapped.mean())
        } else {
            0.0
        },
        ghosting: ghosting(truth, runs, raster),
    }
}

/// Counts distances.
struct Tally {
    /// The tolerances as squared distances in cells.
    within: [f64; 2],
    hits: [u64; 2],
    count: u64,
    sum: f64,
}

impl Tally {
    fn new(tolerances: [f64; 2]) -> Self {
        // Three cells of 0.1 m are 0.3 m, whatever the rounding.
        let within = tolerances.map(|t| (t / SCORE_CELL) * (t / SCORE_CELL) + 1e-9);
        Tally { within, hits: [0; 2], count: 0, sum: 0.0 }
    }

    fn add(&mut self, squared: u16) {
        let squared = f64::from(squared);
        for (hits, within) in self.hits.iter_mut().zip(self.within) {
            *hits += u64::from(squared <= within);
        }
        self.count += 1;
        self.sum += (squared.sqrt() * SCORE_CELL).min(CUT);
    }

    fn shares(&self, of_nothing: f64) -> [f64; 2] {
        self.hits.map(
            |hits| {
                if self.count > 0 { hits as f64 / self.count as f64 } else { of_nothing }
            },
        )
    }

    /// Mean distance in metres; the cut if there are no distances.
    fn mean(&self) -> f64 {
        if self.count > 0 { self.sum / self.count as f64 } else { CUT }
    }
}

/// For each wall point, the number of true walls that a search along its normal crosses.
pub(crate) fn true_runs(truth: &MappableArea, perfect: &OccupancyMap) -> Vec<u8> {
    let raster = Raster::of(truth, perfect);
    truth.walls().iter().map(|point| runs(&raster, point, TRUE_REACH)).collect()
}

/// The fraction of wall points along whose normal the map has more walls than the world.
fn ghosting(truth: &MappableArea, true_runs: &[u8], raster: &Raster) -> f64 {
    let doubled = truth.walls().iter().zip(true_runs);
    let doubled = doubled.filter(|(point, known)| runs(raster, point, GHOST_REACH) > **known);
    let count = doubled.count() as f64;
    if truth.walls().is_empty() { 0.0 } else { count / truth.walls().len() as f64 }
}

/// The number of walls of a map that a search along a wall point's normal crosses, to either side.
fn runs(raster: &Raster, point: &WallPoint, reach: f64) -> u8 {
    let steps = (reach / RESOLUTION).round() as i32;
    let apart = (APART / RESOLUTION).round() as i32;
    let mut last = i32::MIN / 2;
    let mut runs = 0_u8;
    for step in -steps..=steps {
        let p: DVec2 = point.position + point.normal * (f64::from(step) * RESOLUTION);
        if raster.is_occupied(CellIndex::of(p)) {
            runs = runs.saturating_add(u8::from(step - last > apart));
            last = step;
        }
    }
    runs
}
