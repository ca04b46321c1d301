//! Densities of forests that vary over the area.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::SpecError;
use crate::geometry::Rect;
use crate::landscape::metrics::{RasterError, check};
use crate::seed::Stream;
use crate::world::ClassRaster;

/// The greatest number of cells of a density map.
const MAX_CELLS: usize = 1 << 24;

/// The greatest factor of a density map.
const MAX_FACTOR: f64 = 1e6;

/// The mean number of trees per square metre, as a function of the position.
pub trait Density {
    /// Returns the greatest value anywhere, in trees per square metre.
    fn max(&self) -> f64;

    /// Returns the value at a point, from 0 to [`Density::max`].
    fn at(&self, p: DVec2) -> f64;

    /// Draws a point of `within` with a probability proportional to the density; `None` if such points can only be
    /// drawn by rejecting uniform points.
    fn draw(&self, _within: Rect, _stream: &mut Stream) -> Option<DVec2> {
        None
    }

    /// Returns the greatest area in square metres that discs of diameter `distance` can cover, if their centres lie
    /// in the part of `within` where the density is not 0.
    fn room(&self, within: Rect, distance: f64) -> f64 {
        let size = within.size() + distance;
        size.x * size.y
    }
}

/// A density given by its greatest value and a function.
impl<F: Fn(DVec2) -> f64> Density for (f64, F) {
    fn max(&self) -> f64 {
        self.0
    }

    fn at(&self, p: DVec2) -> f64 {
        (self.1)(p)
    }
}

/// A raster of factors on a forest's intensity, stretched over its area. All rows have the same length; the top row
/// (greatest y) is first.
///
/// ```
/// use envgen::forest::{DensityMap, ForestSpec};
/// use envgen::{Seed, Spec, landscape::LandscapeSpec};
///
/// // Trees where a landscape has class 1, half as many in class 2, and none elsewhere.
/// let landscape = LandscapeSpec::default().generate(Seed(7))?.to_raster();
/// let density = DensityMap::from_classes(&landscape, &[1.0, 0.5])?;
/// let spec = ForestSpec { density: Some(density), ..Default::default() };
/// assert!(!spec.generate(Seed(7))?.trees().is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct DensityMap {
    /// The factors, each at least 0.
    pub rows: Vec<Vec<f64>>,
}

impl DensityMap {
    /// Creates the density map of a landscape: class `k` of the raster has the factor `factors[k - 1]`; no data,
    /// and classes without a factor, have 0.
    ///
    /// # Errors
    /// When the sizes of the raster do not fit together. The factors are checked later, together with the spec that
    /// contains the map.
    pub fn from_classes(raster: &ClassRaster, factors: &[f64]) -> Result<Self, RasterError> {
        check(raster)?;
        let factor = |&class: &u16| {
            usize::from(class).checked_sub(1).and_then(|i| factors.get(i)).copied().unwrap_or(0.0)
        };
        let row = |row: &[u16]| row.iter().map(factor).collect();
        let rows = match raster.cols as usize {
            0 => Vec::new(),
            cols => raster.cells.chunks_exact(cols).map(row).collect(),
        };
        Ok(DensityMap { rows })
    }

    /// Returns the greatest factor.
    pub fn max(&self) -> f64 {
        self.rows.iter().flatten().copied().fold(0.0, f64::max)
    }

    pub(super) fn validate(&self) -> Result<(), SpecError> {
        let error = |value: String, allowed: &str| Err(SpecError::new("density", value, allowed));
        let cols = self.rows.first().map_or(0, Vec::len);
        if cols == 0 || self.rows.iter().any(|row| row.len() != cols) {
            return error("ragged or empty".to_owned(), "rows of equal length, at least one cell");
        }
        if self.rows.len() * cols > MAX_CELLS {
            let size = format!("{} x {cols} cells", self.rows.len());
            return error(size, &format!("at most {MAX_CELLS} cells"));
        }
        let bad = |factor: &&f64| !(**factor >= 0.0 && **factor <= MAX_FACTOR);
        match self.rows.iter().flatten().find(bad) {
            Some(factor) => error(factor.to_string(), &format!("factors from 0 to {MAX_FACTOR}")),
            None => Ok(()),
        }
    }

    /// Returns the density over an area: the factors times an intensity.
    pub(super) fn over(&self, area: Rect, intensity: f64) -> impl Density {
        let mut sum = 0.0;
        let sums = self.rows.iter().flatten().map(|factor| {
            sum += factor;
            sum
        });
        MapDensity { map: self, area, intensity, max: intensity * self.max(), sums: sums.collect() }
    }
}

struct MapDensity<'a> {
    map: &'a DensityMap,
    area: Rect,
    intensity: f64,
    /// The greatest density. It is asked for with every tree.
    max: f64,
    /// Cumulative sums of the factors, one per cell.
    sums: Vec<f64>,
}

impl MapDensity<'_> {
    fn cell_size(&self) -> DVec2 {
        self.area.size() / DVec2::new(self.map.rows[0].len() as f64, self.map.rows.len() as f64)
    }
}

impl Density for MapDensity<'_> {
    fn max(&self) -> f64 {
        self.max
    }

    fn at(&self, p: DVec2) -> f64 {
        let rows = &self.map.rows;
        let (height, width) = (rows.len(), rows[0].len());
        let cell = (p - self.area.min) / self.cell_size();
        let (col, row) = ((cell.x as usize).min(width - 1), (cell.y as usize).min(height - 1));
        self.intensity * rows[height - 1 - row][col]
    }

    fn draw(&self, within: Rect, stream: &mut Stream) -> Option<DVec2> {
        let rows = &self.map.rows;
        let (height, width) = (rows.len(), rows[0].len());
        let size = self.cell_size();
        // Cells that extend beyond the area of the centres are drawn again there.
        loop {
            let wanted = stream.unit() * self.sums[self.sums.len() - 1];
            let cell = self.sums.partition_point(|&sum| sum <= wanted).min(self.sums.len() - 1);
            let (row, col) = (height - 1 - cell / width, cell % width);
            let corner = self.area.min + size * DVec2::new(col as f64, row as f64);
            let p = corner + size * DVec2::new(stream.unit(), stream.unit());
            if within.contains(p) {
                return Some(p);
            }
        }
    }

    fn room(&self, within: Rect, distance: f64) -> f64 {
        let filled = self.map.rows.iter().flatten().filter(|&&factor| factor > 0.0).count();
        let whole = within.size() + distance;
        let cell = self.cell_size() + distance;
        (whole.x * whole.y).min(filled as f64 * cell.x * cell.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forest::ForestSpec;
    use crate::generate::Spec;
    use crate::seed::Seed;

    #[test]
    fn a_landscape_says_where_trees_grow() {
        // Grass above water: trees on class 1 only.
        let raster = ClassRaster {
            rows: 2,
            cols: 1,
            cell: 25.0,
            origin: DVec2::ZERO,
            cells: vec![1, 2],
            speeds: Vec::new(),
        };
        let broken = ClassRaster { cols: 0, ..raster.clone() };
        assert!(DensityMap::from_classes(&broken, &[2.0]).is_err());
        let map = DensityMap::from_classes(&raster, &[2.0]).unwrap();
        assert_eq!(map.rows, [[2.0], [0.0]]);
        let spec = ForestSpec { density: Some(map), ..Default::default() };
        let trees = spec.generate(Seed(1)).unwrap();
        assert!(trees.trees().len() > 50);
        assert!(trees.trees().iter().all(|tree| tree.center.y >= 25.0));
    }

    #[test]
    fn bad_maps_are_refused() {
        for rows in [
            vec![],
            vec![vec![]],
            vec![vec![1.0], vec![1.0, 2.0]],
            vec![vec![-1.0]],
            vec![vec![f64::NAN]],
            vec![vec![f64::INFINITY]],
            vec![vec![0.0; 1 << 13]; (1 << 11) + 1],
        ] {
            assert_eq!(DensityMap { rows }.validate().unwrap_err().field, "density");
        }
    }
}
