//! Features of clearance: how much space a robot has.

use super::feature::features;
use super::space::Space;
use super::statistics::{mean, quantile};
use super::tour::Tour;
use crate::union_find::UnionFind;

/// The clearance in metres below which the reachable area is divided into pieces.
const ROOMY: f64 = 0.5;

/// The least area of a piece in square metres.
const LEAST_PIECE: f64 = 1.0;

features! {
    /// Features of the clearance: distances from the robot's centre to the nearest solid, up to 1.5 m, or up to the
    /// distance that the robot keeps from solids if that is greater.
    pub struct Clearance {
        /// Area that the robot's centre can be on.
        reachable_area_m2: f64, "m^2";
        /// 10 % quantile of the clearance over that area.
        clearance_10_m: f64, "m";
        /// Median of the clearance.
        clearance_50_m: f64, "m";
        /// 90 % quantile of the clearance.
        clearance_90_m: f64, "m";
        /// Integral of 1 / clearance along the tour: of the features, the best single predictor of the
        /// times that published planners took in BARN's worlds.
        tour_length_over_clearance: f64, "";
        /// The same per metre of the tour; none where the robot need not move.
        tour_mean_inverse_clearance_per_m: Option<f64>, "1/m";
        /// Number of pieces, of 1 m^2 or more, into which that area falls where the clearance is under
        /// 0.5 m.
        pieces_at_0_5_m: u64, "";
        /// Width of the narrowest passage between two pieces: twice the least clearance on the widest
        /// path between them; none where there are none.
        narrowest_passage_m: Option<f64>, "m";
        /// Mean width of the passages between pieces.
        passage_width_mean_m: Option<f64>, "m";
    }
}

impl Clearance {
    pub(super) fn of(space: &Space<'_>, by_clearance: &[usize], tour: &Tour) -> Self {
        let rising: Vec<f64> =
            by_clearance.iter().rev().map(|&cell| space.clearance[cell]).collect();
        let steps = tour.points.iter().filter(|(_, ds)| *ds > 0.0);
        let (mut length, mut slowed) = (0.0, 0.0);
        for &(p, ds) in steps {
            length += ds;
            // Between two cells it may come nearer than it keeps from solids, by rounding.
            slowed += ds / space.clearance_at(p).max(0.5 * space.footprint);
        }
        let passages = Passages::new(space, by_clearance);
        Clearance {
            reachable_area_m2: space.count as f64 * space.cell_area(),
            clearance_10_m: quantile(&rising, 0.1),
            clearance_50_m: quantile(&rising, 0.5),
            clearance_90_m: quantile(&rising, 0.9),
            tour_length_over_clearance: slowed,
            tour_mean_inverse_clearance_per_m: (length > 0.0).then(|| slowed / length),
            pieces_at_0_5_m: passages.pieces,
            narrowest_passage_m: passages.widths.iter().copied().reduce(f64::min),
            passage_width_mean_m: (!passages.widths.is_empty()).then(|| mean(&passages.widths)),
        }
    }
}

/// The pieces of space with a clearance of [`ROOMY`], and the passages that connect them.
struct Passages {
    pieces: u64,
    /// Width of each passage in metres.
    widths: Vec<f64>,
}

impl Passages {
    /// Adds the cells by falling clearance, and joins adjacent ones. Two pieces are joined at the least clearance
    /// of the widest path between them.
    fn new(space: &Space<'_>, by_clearance: &[usize]) -> Self {
        let least = (LEAST_PIECE / space.cell_area()).ceil() as usize;
        let mut sets = UnionFind::new(space.frame.len());
        let mut added = vec![false; space.frame.len()];
        let roomy = by_clearance.partition_point(|&cell| space.clearance[cell] >= ROOMY);
        for &cell in &by_clearance[..roomy] {
            added[cell] = true;
            for (_, other) in space.neighbours(cell).filter(|&(_, other)| added[other]) {
                sets.join(cell, other);
            }
        }
        let mut sizes = vec![0_usize; space.frame.len()];
        by_clearance[..roomy].iter().for_each(|&cell| sizes[sets.find(cell)] += 1);
        let mut has_piece: Vec<bool> = sizes.iter().map(|&size| size >= least).collect();
        let pieces = has_piece.iter().filter(|piece| **piece).count() as u64;
        let mut widths = Vec::new();
        for &cell in &by_clearance[roomy..] {
            added[cell] = true;
            for (_, other) in space.neighbours(cell).filter(|&(_, other)| added[other]) {
                let (a, b) = (sets.find(cell), sets.find(other));
                let both = has_piece[a] && has_piece[b];
                let any = has_piece[a] || has_piece[b];
                if sets.join(a, b) {
                    if both {
                        widths.push(2.0 * space.least_clearance(cell, other));
                    }
                    has_piece[sets.find(a)] = any;
                }
            }
        }
        Passages { pieces, widths }
    }
}
