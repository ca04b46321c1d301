//! Tree centres with a least distance: a Poisson count, then random sequential addition.
//!
//! The paper modifies the Poisson process "using rejection sampling during the tree-placement
//! phase": the number of trees is drawn first, then each tree is drawn again until it keeps its
//! distance to all trees placed before.
//!
//! Where the density varies, trees are rejected more often where it is high. The numbers of trees are therefore drawn
//! for each class of density, and each tree is drawn again within its class.

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
    counts: [u64; CLASSES],
    distance: f64,
) -> Result<Vec<DVec2>, ForestError> {
    let trees: u64 = counts.iter().sum();
    // Classes with few trees may have little space, which trees of other classes would take.
    let mut order: Vec<usize> = (0..CLASSES).filter(|&class| counts[class] > 0).collect();
    order.sort_by_key(|&class| counts[class]);
    let (mut placed, mut attempts) = (0, 0);
    let mut batch = [DVec2::ZERO; BATCH];
    let mut free = [false; BATCH];
    for class in order {
        let most = attempts + counts[class].saturating_mul(ATTEMPTS);
        let all = placed + counts[class];
        // Draws of a rare class cost more than the lookups that batches save.
        let is_rare = counts[class] < trees / 4;
        while placed < all {
            if attempts >= most {
                return Err(ForestError::Attempts { trees, placed, attempts, distance });
            }
            let wanted = if is_rare { all - placed } else { BATCH as u64 };
            let thrown = BATCH.min((most - attempts).min(wanted) as usize);
            for p in &mut batch[..thrown] {
                let Some(place) = thrower.throw(class)? else {
                    return Err(ForestError::Attempts { trees, placed, attempts, distance });
                };
                *p = place;
            }
            black_box(batch[..thrown].iter().fold(0, |sum, &p| sum ^ index.touch(p)));
            for (free, &p) in free[..thrown].iter_mut().zip(&batch) {
                *free = !index.conflicts(p);
            }
            attempts += thrown as u64;
            for (_, &p) in free.iter().zip(&batch[..thrown]).filter(|(free, _)| **free) {
                // Points of this batch that were placed by now may conflict.
                if placed < all && !index.conflicts(p) {
                    index.insert(p);
                    placed += 1;
                }
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
    /// Number of draws that were rejected to follow the density, or because they were of another class.
    wasted: u64,
}

impl Thrower<'_> {
    /// Draws a position where the density has a class; `None` if too many draws were rejected.
    fn throw(&mut self, class: usize) -> Result<Option<DVec2>, ForestError> {
        let Some(density) = self.density else {
            return Ok(Some(poisson::uniform(self.area, &mut self.stream)));
        };
        while self.wasted < MOST_WASTED {
            let p = match density.draw(self.area, &mut self.stream) {
                Some(p) => Some(p),
                None => {
                    let p = poisson::uniform(self.area, &mut self.stream);
                    let chosen = self.stream.unit() * density.max();
                    (chosen < poisson::checked(density, p)?).then_some(p)
                }
            };
            if let Some(p) = p
                && self::class(self.density, p)? == class
            {
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
        // A rare class of density has room for its few trees, wherever others are.
        for seed in 0..60 {
            let mut rows = vec![vec![1.0; 25]; 25];
            rows[12][12] = 0.5;
            let spec = ForestSpec { density: Some(DensityMap { rows }), ..spec(2.0) };
            spec.generate(Seed(seed)).unwrap();
        }
        // There is no room for 125 trees in the west, whatever there is in the east.
        let crowded = spec(3.0).generate(Seed(1)).unwrap_err();
        assert!(matches!(crowded, ForestError::Attempts { .. }), "{crowded}");
    }
}
