//! Tree centres with a least distance: a Poisson count, then random sequential addition.
//!
//! The paper modifies the Poisson process "using rejection sampling during the tree-placement
//! phase": the number of trees is drawn first, then each tree is drawn again until it keeps its
//! distance to all trees placed before.
//!
//! Where the density varies, trees are rejected more often where it is high. Each tree is drawn again where the density
//! is about that of its first place, so that the numbers of trees still follow the density.

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

/// The number of classes of density. Within a class, except for the last, it varies by a factor of 2^(1/4).
const CLASSES: usize = 64;

pub(super) fn centres(
    spec: &ForestSpec,
    seed: Seed,
    density: Option<&dyn Density>,
) -> Result<Vec<DVec2>, ForestError> {
    let area = spec.centre_area();
    // The numbers of trees in each class of density.
    let mut counts = [0; CLASSES];
    match density {
        None => counts[0] = poisson::draw_count(area, spec.intensity, seed),
        // The Poisson counts of the thinned process: how many trees of the densest forest stay.
        Some(_) => {
            for p in poisson::centres(spec, seed, density)? {
                counts[class(density, p)?] += 1;
            }
        }
    }
    let count = counts.iter().sum();
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
        add(FineGrid::new(area, distance, count, torus), thrower, counts, distance)
    } else {
        add(CellList::new(area, distance, count, torus), thrower, counts, distance)
    }
}

/// The class of the density at a point: 0 at its maximum, and 4 at half of it.
fn class(density: Option<&dyn Density>, p: DVec2) -> Result<usize, ForestError> {
    let Some(density) = density else { return Ok(0) };
    let share = poisson::checked(density, p)? / density.max();
    Ok(((-4.0 * libm::log2(share)) as usize).min(CLASSES - 1))
}

fn add(
    mut index: impl PointIndex,
    mut thrower: Thrower<'_>,
    mut left: [u64; CLASSES],
    distance: f64,
) -> Result<Vec<DVec2>, ForestError> {
    let count: u64 = left.iter().sum();
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
        for (is_free, &p) in free[..thrown].iter().zip(&batch) {
            let class = class(thrower.density, p)?;
            if left[class] == 0 {
                thrower.wasted += 1;
                continue;
            }
            attempts += 1;
            // Points of this batch that were placed by now may conflict.
            if *is_free && !index.conflicts(p) {
                index.insert(p);
                placed += 1;
                left[class] -= 1;
            }
        }
    }
    Ok(index.into_points())
}

/// Draws positions, either uniformly or in proportion to a density.
struct Thrower<'a> {
    area: Rect,
    density: Option<&'a dyn Density>,
    stream: Stream,
    /// Number of draws that were rejected to follow the density, or where all trees of its class are placed.
    wasted: u64,
}

impl Thrower<'_> {
    /// Draws a position; `None` if too many draws were rejected.
    fn throw(&mut self) -> Result<Option<DVec2>, ForestError> {
        let Some(density) = self.density else {
            return Ok(Some(poisson::uniform(self.area, &mut self.stream)));
        };
        while self.wasted < MOST_WASTED {
            if let Some(p) = density.draw(self.area, &mut self.stream) {
                return Ok(Some(p));
            }
            let p = poisson::uniform(self.area, &mut self.stream);
            if self.stream.unit() * density.max() < poisson::checked(density, p)? {
                return Ok(Some(p));
            }
            self.wasted += 1;
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forest::DensityMap;
    use crate::generate::Spec;

    #[test]
    fn trees_that_keep_their_distance_follow_the_density() {
        let spec = |min_distance| ForestSpec {
            density: Some(DensityMap { rows: vec![vec![1.0, 0.1]] }),
            intensity: 0.1,
            radius: 0.3,
            min_distance,
            ..ForestSpec::default()
        };
        let (mut west, mut east) = (0, 0);
        for seed in 0..200 {
            let forest = spec(2.0).generate(Seed(seed)).unwrap();
            let middle = 0.5 * spec(2.0).width;
            let trees = forest.trees().iter().filter(|tree| tree.center.x < middle).count();
            west += trees;
            east += forest.trees().len() - trees;
        }
        // 25,000 and 2500 on average, in Poisson laws: off by 4 standard deviations in one of 8000 cases each.
        assert!((west as f64 - 25_000.0).abs() < 4.0 * 25_000.0_f64.sqrt(), "{west}");
        assert!((east as f64 - 2500.0).abs() < 4.0 * 2500.0_f64.sqrt(), "{east}");
        // There is no room for 125 trees in the west, whatever there is in the east.
        let crowded = spec(3.0).generate(Seed(1)).unwrap_err();
        assert!(matches!(crowded, ForestError::Attempts { .. }), "{crowded}");
    }
}
