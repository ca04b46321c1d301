//! Tree centres with a least distance: a Poisson count, then random sequential addition.
//!
//! The paper modifies the Poisson process "using rejection sampling during the tree-placement
//! phase": the number of trees is drawn first, then each tree is drawn again until it keeps its
//! distance to all trees placed before.

use std::hint::black_box;

use glam::DVec2;

use super::density::Density;
use super::error::ForestError;
use super::index::{CellList, FineGrid, PointIndex};
use super::poisson;
use super::spec::{Border, ForestSpec};
use crate::geometry::Rect;
use crate::seed::{Seed, Stream};

/// The greatest intensity x distance^2 for random sequential addition. It jams at 0.6967 (coverage 0.547 by discs
/// of that diameter: E. L. Hinrichsen, J. Feder and T. Jossang, Physical Review A 41, 1990,
/// <https://doi.org/10.1103/PhysRevA.41.4199>), and its time grows without bound near there; up to 0.65 it ends in
/// reasonable time.
const FILLING_LIMIT: f64 = 0.65;

/// The average number of attempts per tree.
const ATTEMPTS: u64 = 400;

/// The greatest total number of draws that may be rejected to follow a density function that is mostly near 0.
const MOST_WASTED: u64 = 500_000_000;

/// The number of draws whose positions are looked up together before any of them is placed.
const BATCH: usize = 64;

pub(super) fn centres(
    spec: &ForestSpec,
    seed: Seed,
    density: Option<&dyn Density>,
) -> Result<Vec<DVec2>, ForestError> {
    let area = spec.centre_area();
    let count = match density {
        None => poisson::draw_count(area, spec.intensity, seed),
        // The Poisson count of the thinned process: how many trees of the densest forest stay.
        Some(_) => poisson::centres(spec, seed, density)?.len() as u64,
    };
    let distance = spec.min_distance;
    let size = area.size() + distance;
    let room = density.map_or(size.x * size.y, |density| density.room(area, distance));
    let capacity = FILLING_LIMIT * room / (distance * distance);
    // A single tree has no neighbours.
    if count > 1 && count as f64 > capacity {
        return Err(ForestError::Capacity { trees: count, capacity, distance });
    }
    let torus = spec.border == Border::Torus;
    let stream = seed.stream("forest/throws", 0);
    let thrower = Thrower { area, density, stream, wasted: 0 };
    if FineGrid::suits(area, distance, count) {
        add(FineGrid::new(area, distance, count, torus), thrower, count, distance)
    } else {
        add(CellList::new(area, distance, count, torus), thrower, count, distance)
    }
}

fn add(
    mut index: impl PointIndex,
    mut thrower: Thrower<'_>,
    count: u64,
    distance: f64,
) -> Result<Vec<DVec2>, ForestError> {
    let mut placed = 0;
    let most = count.saturating_mul(ATTEMPTS);
    let mut attempts = 0;
    let mut batch = [DVec2::ZERO; BATCH];
    let mut free = [false; BATCH];
    while placed < count {
        if attempts >= most {
            return Err(ForestError::Attempts { trees: count, placed, attempts, distance });
        }
        let thrown = BATCH.min((most - attempts) as usize);
        for p in &mut batch[..thrown] {
            let Some(place) = thrower.throw()? else {
                return Err(ForestError::Attempts { trees: count, placed, attempts, distance });
            };
            *p = place;
        }
        black_box(batch[..thrown].iter().fold(0, |sum, &p| sum ^ index.touch(p)));
        for (free, &p) in free[..thrown].iter_mut().zip(&batch) {
            *free = !index.conflicts(p);
        }
        for (_, &p) in free.iter().zip(&batch[..thrown]).filter(|(free, _)| **free) {
            attempts += 1;
            // Points of this batch that were placed by now may conflict.
            if placed < count && !index.conflicts(p) {
                index.insert(p);
                placed += 1;
            }
        }
        attempts += free[..thrown].iter().filter(|free| !**free).count() as u64;
    }
    Ok(index.into_points())
}

/// Draws positions, either uniformly or in proportion to a density.
struct Thrower<'a> {
    area: Rect,
    density: Option<&'a dyn Density>,
    stream: Stream,
    /// Number of draws that were rejected to follow the density.
    wasted: u64,
}

impl Thrower<'_> {
    /// Draws a position; `None` if too many draws were rejected.
    fn throw(&mut self) -> Result<Option<DVec2>, ForestError> {
        let Some(density) = self.density else {
            return Ok(Some(poisson::uniform(self.area, &mut self.stream)));
        };
        if let Some(p) = density.draw(self.area, &mut self.stream) {
            return Ok(Some(p));
        }
        while self.wasted < MOST_WASTED {
            let p = poisson::uniform(self.area, &mut self.stream);
            if self.stream.unit() * density.max() < poisson::checked(density, p)? {
                return Ok(Some(p));
            }
            self.wasted += 1;
        }
        Ok(None)
    }
}
