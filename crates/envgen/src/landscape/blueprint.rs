//! The blueprint of a landscape: the cells that are generated from a spec.

use serde::ser::SerializeSeq;
use serde::{Serialize, Serializer};

use super::composition::{Composition, entropy_of};
use super::edge::edge_count;
use super::spec::LandscapeSpec;
use crate::seed::Seed;
use crate::world::ClassRaster;

/// A landscape: the class of each cell, with the spec and seed from which it was generated.
///
/// ```
/// use envgen::landscape::{LandscapeSpec, edge_count};
/// use envgen::{Seed, Spec};
///
/// let landscape = LandscapeSpec { rows: 20, cols: 30, ..Default::default() }.generate(Seed(7))?;
/// assert_eq!(landscape.counts().iter().sum::<u32>(), 20 * 30);
/// assert_eq!(landscape.total_edge(), edge_count(landscape.cells(), landscape.cols()));
/// assert!((landscape.ted() - landscape.total_edge() as f64 / 600.0).abs() < 1e-12);
/// # Ok::<(), envgen::landscape::LandscapeError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Landscape {
    beta: f64,
    counts: Vec<u32>,
    total_edge: u64,
    cells: Vec<u16>,
    epsilon: Option<f64>,
    sigma: Option<f64>,
    swaps: u64,
    spec: LandscapeSpec,
    seed: Seed,
}

impl Landscape {
    pub(super) fn new(
        spec: &LandscapeSpec,
        seed: Seed,
        composition: &Composition,
        counts: Vec<u32>,
        cells: Vec<u16>,
        (epsilon, sigma, swaps): (Option<f64>, Option<f64>, u64),
    ) -> Self {
        let total_edge = edge_count(&cells, spec.cols as usize);
        let (spec, beta) = (spec.clone(), composition.beta());
        Landscape { beta, counts, total_edge, cells, epsilon, sigma, swaps, spec, seed }
    }

    /// Returns the number of swaps that the Total Edge required.
    pub fn swaps(&self) -> u64 {
        self.swaps
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> usize {
        self.spec.rows as usize
    }

    /// Returns the number of columns.
    pub fn cols(&self) -> usize {
        self.spec.cols as usize
    }

    /// Returns the class of each cell, counted from 1, row by row from the top.
    pub fn cells(&self) -> &[u16] {
        &self.cells
    }

    /// Returns the number of cells of each class, with class 1 first.
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// Returns the ratio of the geometric sequence that the counts follow, as in [`Composition::beta`].
    pub fn beta(&self) -> f64 {
        self.beta
    }

    /// Returns the entropy of the classes' shares in nats.
    pub fn entropy(&self) -> f64 {
        entropy_of(&self.counts)
    }

    /// Returns the Total Edge: the number of sides between cells of different class. It is the requested number or,
    /// if no landscape of these counts with that number was found, the nearest one found.
    pub fn total_edge(&self) -> u64 {
        self.total_edge
    }

    /// Returns the Total Edge per cell.
    pub fn ted(&self) -> f64 {
        self.total_edge as f64 / self.cells.len() as f64
    }

    /// Returns the automaton's probability of an extra change of class, if the automaton was used.
    pub fn epsilon(&self) -> Option<f64> {
        self.epsilon
    }

    /// Returns the smoothing in cells, if the landscape was smoothed.
    pub fn sigma(&self) -> Option<f64> {
        self.sigma
    }

    /// Returns the spec.
    pub fn spec(&self) -> &LandscapeSpec {
        &self.spec
    }

    /// Returns the seed with which the landscape was drawn.
    pub fn seed(&self) -> Seed {
        self.seed
    }

    /// Returns the cells as a raster with its lower left corner at the origin.
    pub fn to_raster(&self) -> ClassRaster {
        let mut speeds = Vec::new();
        if !self.spec.speeds.is_empty() {
            speeds.push(0.0);
            speeds.extend(&self.spec.speeds);
        }
        ClassRaster {
            rows: self.spec.rows as u32,
            cols: self.spec.cols as u32,
            cell: self.spec.cell_size,
            origin: glam::DVec2::ZERO,
            cells: self.cells.clone(),
            speeds,
        }
    }
}

impl Serialize for Landscape {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct View<'a> {
            rows: u64,
            cols: u64,
            classes: u64,
            cell: f64,
            beta: f64,
            counts: &'a [u32],
            entropy: f64,
            total_edge: u64,
            total_edge_asked: Option<u64>,
            ted: f64,
            epsilon: Option<f64>,
            sigma: Option<f64>,
            cells: Rows<'a>,
        }
        let view = View {
            rows: self.spec.rows,
            cols: self.spec.cols,
            classes: self.spec.classes,
            cell: self.spec.cell_size,
            beta: self.beta,
            counts: &self.counts,
            entropy: self.entropy(),
            total_edge: self.total_edge,
            total_edge_asked: self.spec.total_edge,
            ted: self.ted(),
            epsilon: self.epsilon,
            sigma: self.sigma,
            cells: Rows(&self.cells, self.cols()),
        };
        view.serialize(serializer)
    }
}

/// Serialises cells as a list of rows.
struct Rows<'a>(&'a [u16], usize);

impl Serialize for Rows<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let rows = self.0.chunks_exact(self.1);
        let mut list = serializer.serialize_seq(Some(rows.len()))?;
        for row in rows {
            list.serialize_element(row)?;
        }
        list.end()
    }
}
