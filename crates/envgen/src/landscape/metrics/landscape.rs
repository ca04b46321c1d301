//! Metrics of a generated landscape.

use serde::Serialize;

use super::report::{Border, RasterReport};
use crate::landscape::blueprint::Landscape;
use crate::landscape::construct::least_built;
use crate::landscape::edge::{edge_lower_bound, edge_upper_bound, mean_edge_count};

/// The metrics of a landscape: its deviation from the request, the bounds of what is possible, and the metrics of
/// its raster.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LandscapeMetrics {
    /// Entropy minus the requested entropy, in nats.
    pub entropy_error: f64,
    /// Total Edge minus the requested Total Edge, if one is requested. It differs from 0 only if no exact landscape
    /// was found.
    pub total_edge_error: Option<i64>,
    /// The exact mean of the Total Edge over all arrangements of the counts.
    pub total_edge_mean: f64,
    /// A lower bound of the Total Edge over all arrangements.
    pub total_edge_lower_bound: u64,
    /// The least Total Edge of bands.
    pub total_edge_least_built: u64,
    /// An upper bound of the Total Edge over all arrangements.
    pub total_edge_upper_bound: u64,
    /// Number of swaps that were needed to reach the Total Edge.
    pub swaps: u64,
    /// The metrics of the raster.
    #[serde(flatten)]
    pub report: Box<RasterReport>,
}

pub(in crate::landscape) fn measure(landscape: &Landscape) -> LandscapeMetrics {
    let (spec, counts) = (landscape.spec(), landscape.counts());
    let (rows, cols) = (spec.rows, spec.cols);
    LandscapeMetrics {
        entropy_error: landscape.entropy() - spec.entropy,
        total_edge_error: spec
            .total_edge
            .map(|target| landscape.total_edge() as i64 - target as i64),
        total_edge_mean: mean_edge_count(rows, cols, counts),
        total_edge_lower_bound: edge_lower_bound(rows, cols, counts),
        total_edge_least_built: least_built(rows, cols, counts),
        total_edge_upper_bound: edge_upper_bound(rows, cols, counts),
        swaps: landscape.swaps(),
        report: Box::new(RasterReport::of_grid(
            landscape.cells(),
            landscape.cols(),
            spec.cell_size,
            Border::Free,
        )),
    }
}
