//! All metrics of a raster.

use std::fmt;

use serde::Serialize;
use thiserror::Error;

use super::adjacency::{Adjacency, ClassSides};
use super::patches::{Neighbourhood, Patch, patches};
use crate::world::ClassRaster;

/// The reasons why a raster cannot be measured, or travelled.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RasterError {
    /// The number of cells is not the number of rows times the number of columns.
    #[error("the raster has {cells} cells, but {rows} rows of {cols}")]
    Size {
        /// Number of rows that the raster states.
        rows: u32,
        /// Number of columns that the raster states.
        cols: u32,
        /// Number of cells that the raster contains.
        cells: usize,
    },
    /// The side of the cells is not a positive number.
    #[error("the side of a cell is {0} m, it must be positive")]
    Cell(f64),
    /// The speed of a class is negative or not finite.
    #[error("the speed of class {class} must be a finite number of at least 0, got {speed}")]
    Speed {
        /// The class, whose number is its place in the list of speeds.
        class: usize,
        /// Its speed.
        speed: f64,
    },
}

/// Checks that a raster's sizes fit together.
pub(crate) fn check(raster: &ClassRaster) -> Result<(), RasterError> {
    let ClassRaster { rows, cols, cell, .. } = *raster;
    if u64::from(rows) * u64::from(cols) != raster.cells.len() as u64 {
        return Err(RasterError::Size { rows, cols, cells: raster.cells.len() });
    }
    if !(cell.is_finite() && cell > 0.0) {
        return Err(RasterError::Cell(cell));
    }
    Ok(())
}

/// Whether sides at the raster's end, and sides beside no data, count as edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Border {
    /// They do not count.
    #[default]
    Free,
    /// They count in all edge counts, lengths and densities.
    Counted,
}

/// The metrics of a raster. Undefined metrics are `None`: evenness and contagion of one class, interspersion of
/// fewer than three classes, contagion and entropies of cells without neighbours, and everything of a raster without
/// cells.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RasterReport {
    /// Total Edge: the number of sides between cells of different class.
    pub edge_count: u64,
    /// The paper's Total Edge Density: number of sides per cell.
    pub ted: Option<f64>,
    /// Length of all edges in metres (FRAGSTATS' TE).
    pub total_edge_m: f64,
    /// Length of all edges divided by the area, in m/ha (ED).
    pub edge_density_m_per_ha: Option<f64>,
    /// Shannon's diversity index in nats (SHDI), the paper's entropy.
    pub shdi: Option<f64>,
    /// Shannon's evenness index (SHEI): SHDI divided by the greatest SHDI for the same number of classes.
    pub shei: Option<f64>,
    /// Simpson's diversity index (SIDI): the probability that two cells are of different class.
    pub sidi: Option<f64>,
    /// Contagion index in percent (CONTAG), with sides read in both directions.
    pub contag_percent: Option<f64>,
    /// Interspersion and juxtaposition index in percent (IJI).
    pub iji_percent: Option<f64>,
    /// Landscape shape index (LSI): length of all edges and the border, divided by the least border of a raster
    /// with the same number of cells.
    pub lsi: Option<f64>,
    /// H(x, y), the joint entropy of a cell's and its neighbour's class, in bits.
    pub joint_entropy_bits: Option<f64>,
    /// H(y | x), the conditional entropy of the neighbour's class, in bits.
    pub conditional_entropy_bits: Option<f64>,
    /// Mutual information of a cell's and its neighbour's class, in bits.
    pub mutual_information_bits: Option<f64>,
    /// Metrics of patches whose cells share sides or corners.
    pub patches_8: PatchReport,
    /// Metrics of patches whose cells share sides.
    pub patches_4: PatchReport,
    /// The metrics of each class that occurs, sorted by class.
    pub by_class: Vec<ClassReport>,
}

/// The metrics of the patches of one class or of all classes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PatchReport {
    /// Number of patches (NP).
    pub count: u64,
    /// Number of patches per 100 ha of the landscape (PD).
    pub density_per_100ha: Option<f64>,
    /// Share of the landscape that the largest patch covers, in percent (LPI).
    pub largest_percent: Option<f64>,
    /// Mean area of a patch in square metres (`AREA_MN`).
    pub mean_area_m2: Option<f64>,
    /// Effective mesh size in square metres (MESH): the sum of squared patch areas divided by the landscape's area.
    pub mesh_m2: Option<f64>,
}

/// The metrics of a class.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClassReport {
    /// The class, by its number in the raster or in the file from which it was read.
    pub class: i64,
    /// Area in square metres.
    pub area_m2: f64,
    /// Share of the landscape in percent.
    pub share_percent: f64,
    /// Length of the edges to other classes in metres. Over all classes these add up to twice the landscape's length.
    pub total_edge_m: f64,
    /// Metrics of patches whose cells share sides or corners.
    pub patches_8: PatchReport,
    /// Metrics of patches whose cells share sides.
    pub patches_4: PatchReport,
    /// Shape index of the class: the length of its edges and border, divided by the least length for the same
    /// number of cells.
    pub lsi: f64,
}

impl RasterReport {
    /// Measures a raster, in time O(N).
    ///
    /// # Errors
    /// When the raster's sizes do not fit together, or when the side of its cells is not positive.
    pub fn new(raster: &ClassRaster, border: Border) -> Result<Self, RasterError> {
        check(raster)?;
        Ok(RasterReport::of_grid(&raster.cells, raster.cols as usize, raster.cell, border))
    }

    /// Replaces the number of each class by its label, `labels[k]` for class `k + 1`, which is its number in the
    /// file from which it was read.
    #[must_use]
    pub fn labelled(mut self, labels: &[i64]) -> Self {
        for class in &mut self.by_class {
            let label = usize::try_from(class.class - 1).ok().and_then(|k| labels.get(k));
            class.class = label.copied().unwrap_or(class.class);
        }
        self
    }

    pub(in crate::landscape) fn of_grid(
        cells: &[u16],
        cols: usize,
        cell: f64,
        border: Border,
    ) -> Self {
        let adjacency = Adjacency::new(cells, cols);
        let sides = adjacency.class_sides();
        let total: u64 = sides.iter().map(|class| class.cells).sum();
        let some = total > 0;
        let of = |value: f64| some.then_some(value);
        let at_border: u64 = sides.iter().map(|class| class.border).sum();
        let inner = adjacency.edge_count();
        let edges = inner + if border == Border::Counted { at_border } else { 0 };
        let area = total as f64 * cell * cell;
        let shares = || sides.iter().map(|class| class.cells as f64 / total as f64);
        let shdi = shares().map(|p| -p * libm::log(p)).sum::<f64>().max(0.0) + 0.0;
        let most = libm::log(sides.len() as f64);
        let entropies = adjacency.entropies();

        let scale = Scale { total, cell };
        let all_8 = patches(cells, cols, Neighbourhood::Eight);
        let all_4 = patches(cells, cols, Neighbourhood::Four);
        let (classes_8, classes_4) = (by_class(&sides, &all_8), by_class(&sides, &all_4));
        let classes = sides.iter().zip(classes_8.iter().zip(&classes_4));
        RasterReport {
            edge_count: edges,
            ted: of(edges as f64 / total as f64),
            total_edge_m: edges as f64 * cell,
            edge_density_m_per_ha: of(edges as f64 * cell / area * 1e4),
            shdi: of(shdi),
            shei: (sides.len() > 1).then(|| shdi / most),
            sidi: of(1.0 - shares().map(|p| p * p).sum::<f64>()),
            contag_percent: contagion(&adjacency, &sides),
            iji_percent: interspersion(&adjacency, sides.len(), inner),
            lsi: of((inner + at_border) as f64 / least_border(total)),
            joint_entropy_bits: entropies.map(|e| e.joint),
            conditional_entropy_bits: entropies.map(|e| e.conditional),
            mutual_information_bits: entropies.map(|e| e.mutual),
            patches_8: Tally::of(&all_8).report(scale),
            patches_4: Tally::of(&all_4).report(scale),
            by_class: classes
                .map(|(class, (eight, four))| {
                    let counted = if border == Border::Counted { class.border } else { 0 };
                    ClassReport {
                        class: i64::from(class.class),
                        area_m2: class.cells as f64 * cell * cell,
                        share_percent: class.cells as f64 / total as f64 * 100.0,
                        total_edge_m: (class.other + counted) as f64 * cell,
                        patches_8: eight.report(scale),
                        patches_4: four.report(scale),
                        lsi: (class.other + class.border) as f64 / least_border(class.cells),
                    }
                })
                .collect(),
        }
    }
}

/// Returns CONTAG: 1 + sum p ln p / (2 ln m), where p is the share of a class times the share of a neighbouring
/// class in its sides.
fn contagion(adjacency: &Adjacency, sides: &[ClassSides]) -> Option<f64> {
    if sides.len() < 2 || adjacency.sides().is_empty() {
        return None;
    }
    let total: u64 = sides.iter().map(|class| class.cells).sum();
    let class =
        |class: u16| sides.binary_search_by_key(&class, |s| s.class).ok().map(|i| &sides[i]);
    let term = |a: u16, n: u64| {
        let Some(class) = class(a) else { return 0.0 };
        let all = 2 * class.own + class.other;
        let p = class.cells as f64 / total as f64 * (n as f64 / all as f64);
        p * libm::log(p)
    };
    let sum: f64 = adjacency
        .sides()
        .iter()
        .map(|&(a, b, n)| if a == b { term(a, 2 * n) } else { term(a, n) + term(b, n) })
        .sum();
    Some((1.0 + sum / (2.0 * libm::log(sides.len() as f64))) * 100.0)
}

/// Returns IJI: the entropy of the edges' shares over pairs of classes, divided by the greatest possible entropy.
fn interspersion(adjacency: &Adjacency, classes: usize, edges: u64) -> Option<f64> {
    if classes < 3 || edges == 0 {
        return None;
    }
    // Not `sum`, which is -0 for a single pair.
    let pairs = adjacency.sides().iter().filter(|(a, b, _)| a != b);
    let sum = pairs.fold(0.0, |sum, &(_, _, n)| {
        let p = n as f64 / edges as f64;
        sum - p * libm::log(p)
    });
    let m = classes as f64;
    Some(sum / libm::log(0.5 * m * (m - 1.0)) * 100.0)
}

/// Returns the least border of this many cells, in cell sides (FRAGSTATS' min E).
fn least_border(cells: u64) -> f64 {
    let root = cells.isqrt();
    let more = cells - root * root;
    let sides = match more {
        0 => 4 * root,
        more if more <= root => 4 * root + 2,
        _ => 4 * root + 4,
    };
    sides as f64
}

/// Factors that convert cells to areas.
#[derive(Clone, Copy)]
struct Scale {
    total: u64,
    cell: f64,
}

/// Sums over patches.
#[derive(Clone, Copy, Default)]
struct Tally {
    count: u64,
    cells: u64,
    squares: f64,
    largest: u64,
}

impl Tally {
    fn add(&mut self, patch: &Patch) {
        self.count += 1;
        self.cells += patch.cells;
        self.squares += patch.cells as f64 * patch.cells as f64;
        self.largest = self.largest.max(patch.cells);
    }

    fn of(patches: &[Patch]) -> Tally {
        let mut tally = Tally::default();
        patches.iter().for_each(|patch| tally.add(patch));
        tally
    }

    fn report(&self, Scale { total, cell }: Scale) -> PatchReport {
        let (all, square) = (total as f64, cell * cell);
        let of = |value: f64| (total > 0 && self.count > 0).then_some(value);
        PatchReport {
            count: self.count,
            density_per_100ha: of(self.count as f64 / (all * square) * 1e6),
            largest_percent: of(self.largest as f64 / all * 100.0),
            mean_area_m2: of(self.cells as f64 / self.count as f64 * square),
            mesh_m2: of(self.squares / all * square),
        }
    }
}

fn by_class(sides: &[ClassSides], patches: &[Patch]) -> Vec<Tally> {
    let mut tallies = vec![Tally::default(); sides.len()];
    for patch in patches {
        if let Ok(i) = sides.binary_search_by_key(&patch.class, |class| class.class) {
            tallies[i].add(patch);
        }
    }
    tallies
}

impl fmt::Display for RasterReport {
    /// Writes a table for human readers, in which undefined metrics are a dash.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: [(&str, Option<f64>, &str); 13] = [
            ("Total Edge", Some(self.edge_count as f64), "sides"),
            ("Total Edge Density", self.ted, "sides per cell"),
            ("edge length", Some(self.total_edge_m), "m"),
            ("edge density", self.edge_density_m_per_ha, "m/ha"),
            ("SHDI (entropy)", self.shdi, "nats"),
            ("SHEI", self.shei, ""),
            ("SIDI", self.sidi, ""),
            ("CONTAG", self.contag_percent, "%"),
            ("IJI", self.iji_percent, "%"),
            ("LSI", self.lsi, ""),
            ("H(x, y)", self.joint_entropy_bits, "bits"),
            ("H(y | x)", self.conditional_entropy_bits, "bits"),
            ("mutual information", self.mutual_information_bits, "bits"),
        ];
        for (name, value, unit) in lines {
            line(f, name, value, unit)?;
        }
        for (rule, patches) in [("8", &self.patches_8), ("4", &self.patches_4)] {
            writeln!(f, "patches, {rule} neighbours")?;
            line(f, "  number", Some(patches.count as f64), "")?;
            line(f, "  density", patches.density_per_100ha, "per 100 ha")?;
            line(f, "  largest", patches.largest_percent, "%")?;
            line(f, "  mean area", patches.mean_area_m2, "m2")?;
            line(f, "  effective mesh size", patches.mesh_m2, "m2")?;
        }
        writeln!(
            f,
            "{:>12} {:>14} {:>10} {:>14} {:>10} {:>10} {:>10}",
            "class", "area m2", "share %", "edge m", "patches 8", "patches 4", "LSI"
        )?;
        for class in &self.by_class {
            writeln!(
                f,
                "{:>12} {:>14} {:>10.4} {:>14} {:>10} {:>10} {:>10.4}",
                class.class,
                class.area_m2,
                class.share_percent,
                class.total_edge_m,
                class.patches_8.count,
                class.patches_4.count,
                class.lsi
            )?;
        }
        Ok(())
    }
}

fn line(f: &mut fmt::Formatter<'_>, name: &str, value: Option<f64>, unit: &str) -> fmt::Result {
    let value = value.map_or("-".to_owned(), |value| {
        if value == value.trunc() { format!("{value:.0}") } else { format!("{value:.6}") }
    });
    writeln!(f, "{name:<24}{value:>16} {unit}")
}
