//! The worlds of the BARN data set: D. Perille, A. Truong, X. Xiao and P. Stone, Benchmarking Metric Ground
//! Navigation, SSRR 2020, arXiv:2008.13315.
//!
//! A world `N` of the data set consists of a Gazebo world (`world_N.world`), a grid of filled cells (`grid_N.npy`),
//! a path through it (`path_N.npy`, rows and columns) and a map for ROS (`yaml_N.yaml` with `map_pgm_N.pgm`, which
//! [`ros_map`](super::ros_map) reads). All are read into the frame of the Gazebo world: a cell is 0.15 m wide; rows
//! run along x and end at 0; columns run along y and begin 34 cells from the axis, after the walls around the
//! robot's first position. The maps for ROS have one row of cells fewer there.

mod gazebo;
mod npy;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use glam::DVec2;

pub use gazebo::{Cylinder, read_cylinders};

use super::PlanError;
use crate::cellular::{c_space, middle_ends};
use crate::difficulty::{BarnMetrics, BarnMode};
use crate::file::{FileError, read_bytes, read_text};
use crate::geometry::{Pose, Rect, Shape};
use crate::landscape::outlines;
use crate::provenance::IMPORT;
use crate::provenance::Provenance;
use crate::world::{ClassRaster, Obstacle, ObstacleKind, World};

/// Side of a cell in metres, which equals the diameter of a cylinder.
pub const CELL: f64 = 0.15;

/// Number of cells between the x axis of a Gazebo world and the first column of its grid.
pub const FIRST_COLUMN: usize = 34;

/// Number of cells that must be free on each side of the robot's own cell.
pub const ROBOT_CELLS: usize = 2;

/// Start and goal of robots in the Gazebo worlds of the BARN challenge, in metres.
const CHALLENGE: [DVec2; 2] = [DVec2::new(-2.25, 3.0), DVec2::new(-2.25, 13.0)];

/// Heading of robots in radians: they drive along the columns.
const HEADING: f64 = std::f64::consts::FRAC_PI_2;

/// The greatest distance of a cylinder from the centre of its cell, in metres. Files have six decimals.
const NEAR_MIDDLE: f64 = 1e-3;

/// The grid of a world: for each cell, row by row, whether it is filled.
///
/// ```
/// use envgen::difficulty::BarnMode;
/// use envgen::import::barn::BarnGrid;
///
/// // Seven rows, of which the outer ones are filled, and a path along the middle.
/// let filled = (0..70).map(|cell| cell < 10 || cell >= 60).collect();
/// let grid = BarnGrid::new(10, filled)?;
/// let path: Vec<_> = (0..10).map(|col| [3, col]).collect();
/// let metrics = grid.metrics(&path, BarnMode::Reference)?;
/// assert_eq!(metrics.closest_obstacle_cells, Some(1.0));
/// # Ok::<(), envgen::import::PlanError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BarnGrid {
    cols: usize,
    filled: Vec<bool>,
}

impl BarnGrid {
    /// Creates a grid of `cols` columns.
    ///
    /// # Errors
    /// When the cells do not fill one or more whole rows.
    pub fn new(cols: usize, filled: Vec<bool>) -> Result<Self, PlanError> {
        if filled.is_empty() || cols == 0 || !filled.len().is_multiple_of(cols) {
            let allowed = format!("whole rows of {cols}");
            return Err(PlanError::value("cells", filled.len(), allowed));
        }
        Ok(BarnGrid { cols, filled })
    }

    /// Reads a file `grid_N.npy`.
    ///
    /// # Errors
    /// When it is not the array of a grid, or when a cell is neither 0 nor 1.
    pub fn read(input: &mut dyn Read) -> Result<Self, PlanError> {
        let array = npy::read(&read_bytes(input)?)?;
        if let Some(wrong) = array.values.iter().position(|value| !(0..=1).contains(value)) {
            let field = format!("cell ({}, {})", wrong / array.cols, wrong % array.cols);
            return Err(PlanError::value(&field, array.values[wrong], "0 or 1"));
        }
        BarnGrid::new(array.cols, array.values.iter().map(|&value| value == 1).collect())
    }

    /// Creates the grid of a Gazebo world. The files of Gazebo worlds leave out cylinders that are surrounded by
    /// others; the enclosed cells are filled here.
    ///
    /// ```no_run
    /// use envgen::import::barn::{BarnGrid, read_cylinders};
    ///
    /// let text = std::fs::read_to_string("world_0.world")?;
    /// let grid = BarnGrid::of_cylinders(&read_cylinders(&text)?)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When a cylinder does not lie in a cell of the data set, or when there are no cylinders besides the walls
    /// around the robot's first position.
    pub fn of_cylinders(cylinders: &[Cylinder]) -> Result<Self, PlanError> {
        const MOST: f64 = 1024.0;
        let low = cylinders.iter().map(|cylinder| cylinder.center.x).fold(0.0, f64::min);
        // The row of the lowest x is row 0.
        let place = |cylinder: &Cylinder| {
            let (row, col) = ((cylinder.center.x - low) / CELL, cylinder.center.y / CELL - 0.5);
            let is_in_cell = |at: f64| (at - at.round()).abs() * CELL <= NEAR_MIDDLE;
            let is_of_grid =
                (0.0..MOST).contains(&row.round()) && (0.0..MOST).contains(&col.round());
            let fits = is_in_cell(row) && is_in_cell(col) && is_of_grid;
            fits.then(|| [row.round() as usize, col.round() as usize]).ok_or_else(|| {
                let allowed =
                    format!("the middle of a cell of {CELL} m, {MOST} of them a side at most");
                PlanError::value("cylinder", cylinder.center, allowed)
            })
        };
        let mut cells = Vec::new();
        let (mut rows, mut cols) = (0, 0);
        for cylinder in cylinders {
            let [row, col] = place(cylinder)?;
            if let Some(col) = col.checked_sub(FIRST_COLUMN) {
                (rows, cols) = (rows.max(row + 1), cols.max(col + 1));
                cells.push([row, col]);
            }
        }
        if cells.is_empty() {
            let allowed = format!("at least one {FIRST_COLUMN} cells or more from the x axis");
            return Err(PlanError::value("cylinders", cylinders.len(), allowed));
        }
        let mut filled = vec![false; rows * cols];
        cells.iter().for_each(|[row, col]| filled[row * cols + col] = true);
        fill_enclosed(cols, &mut filled);
        BarnGrid::new(cols, filled)
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> usize {
        self.filled.len() / self.cols
    }

    /// Returns the number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Returns for each cell whether it is filled.
    pub fn filled(&self) -> &[bool] {
        &self.filled
    }

    /// Returns for each cell whether the robot's centre cannot be in it.
    pub fn c_space(&self) -> Vec<bool> {
        c_space(self.cols, &self.filled, ROBOT_CELLS)
    }

    /// Computes BARN's metrics of a path, which is a list of rows and columns.
    ///
    /// # Errors
    /// When the path is empty or leaves the grid.
    pub fn metrics(&self, path: &[[u32; 2]], mode: BarnMode) -> Result<BarnMetrics, PlanError> {
        let cells: Vec<_> = path.iter().map(|&cell| self.index(cell)).collect::<Result<_, _>>()?;
        BarnMetrics::of(self.cols, &self.c_space(), &cells, mode)
            .ok_or_else(|| PlanError::value("path", "no cells", "one or more"))
    }

    fn index(&self, [row, col]: [u32; 2]) -> Result<usize, PlanError> {
        let (row, col) = (row as usize, col as usize);
        if row >= self.rows() || col >= self.cols {
            let allowed = format!("of cells in {} rows and {} columns", self.rows(), self.cols);
            return Err(PlanError::value("path", format!("[{row}, {col}]"), allowed));
        }
        Ok(row * self.cols + col)
    }

    /// Returns the world of the grid, with its filled cells as obstacles, and start and goal at the ends of the
    /// path. Without a path, start and goal are the cells nearest to the middle of the sides, in the largest
    /// regions at these sides in which the robot can be.
    ///
    /// # Errors
    /// When the path leaves the grid, or when one of its ends is filled.
    pub fn to_world(&self, path: &[[u32; 2]]) -> Result<World, PlanError> {
        // The raster has its rows along x.
        let (rows, cols) = (self.rows(), self.cols);
        let mut cells = vec![0; rows * cols];
        for (i, &filled) in self.filled.iter().enumerate() {
            cells[(cols - 1 - i % cols) * rows + i / cols] = u16::from(filled);
        }
        let raster = ClassRaster {
            rows: cols as u32,
            cols: rows as u32,
            cell: CELL,
            origin: DVec2::new(-(rows as f64), FIRST_COLUMN as f64) * CELL,
            cells,
            speeds: Vec::new(),
        };
        let source = serde_json::json!({ "format": "barn_grid", "rows": rows, "cols": cols });
        let mut world = World::new(Provenance::other(IMPORT, source), raster.frame().bounds());
        let blocks = outlines(&raster, |filled| filled).into_iter();
        world.obstacles =
            blocks.map(|(_, shape)| Obstacle::new(ObstacleKind::Other, shape)).collect();
        let ends = match (path.first(), path.last()) {
            (Some(&first), Some(&last)) => [Some(self.index(first)?), Some(self.index(last)?)],
            _ => middle_ends(cols, &self.c_space(), ROBOT_CELLS),
        };
        let frame = raster.frame();
        let pose = |cell: usize| Pose {
            position: frame.center(cell / cols, cell % cols),
            heading: HEADING,
        };
        [world.start, world.goal] = ends.map(|end| end.map(pose));
        world.check().map_err(FileError::World)?;
        Ok(world)
    }
}

/// Fills the cells that are not connected by their sides to the first or last column.
fn fill_enclosed(cols: usize, filled: &mut [bool]) {
    let mut open: Vec<bool> = filled.iter().map(|filled| !filled).collect();
    for row in 0..open.len() / cols {
        for end in [row * cols, row * cols + cols - 1] {
            crate::flood::flood(cols, &mut open, end, |_| {});
        }
    }
    for (filled, enclosed) in filled.iter_mut().zip(open) {
        *filled |= enclosed;
    }
}

/// Reads a file `path_N.npy`, which contains rows and columns, from start to goal.
///
/// # Errors
/// When it is not the array of a path.
pub fn read_path(input: &mut dyn Read) -> Result<Vec<[u32; 2]>, PlanError> {
    let array = npy::read(&read_bytes(input)?)?;
    if array.cols != 2 {
        return Err(PlanError::value("shape", array.cols, "two columns for a path"));
    }
    let cell = |pair: &[i64]| {
        let number = |value: i64| {
            u32::try_from(value)
                .map_err(|_| PlanError::value("path", value, "rows and columns from 0 on"))
        };
        Ok([number(pair[0])?, number(pair[1])?])
    };
    array.values.chunks_exact(2).map(cell).collect()
}

/// Reads the path of a grid from a file beside it; an empty path if that file does not exist.
fn path_beside(grid: &Path) -> Result<Vec<[u32; 2]>, PlanError> {
    let stem = grid.file_stem().unwrap_or_default().to_string_lossy();
    let Some(number) = stem.strip_prefix("grid_") else { return Ok(Vec::new()) };
    let folder = grid.parent().unwrap_or(Path::new(""));
    let name = format!("path_{number}.npy");
    let places: [PathBuf; 3] = [
        folder.join(&name),
        folder.join("path_files").join(&name),
        folder.join("..").join("path_files").join(&name),
    ];
    for path in places {
        if let Ok(mut file) = File::open(&path) {
            return read_path(&mut file)
                .map_err(|error| PlanError::Beside { path, error: Box::new(error) });
        }
    }
    Ok(Vec::new())
}

/// Reads the world of a grid, `grid_N.npy`. Its path is `path_N.npy` in the same folder, or in a folder
/// `path_files` in it or beside it.
pub(super) fn read_grid_world(input: &mut dyn Read, path: &Path) -> Result<World, PlanError> {
    BarnGrid::read(input)?.to_world(&path_beside(path)?)
}

/// Reads a Gazebo world, with its cylinders as obstacles, and with start and goal of the BARN challenge if these
/// are free.
pub(super) fn read_gazebo_world(input: &mut dyn Read) -> Result<World, PlanError> {
    let cylinders = read_cylinders(&read_text(input)?)?;
    let source = serde_json::json!({ "format": "barn_world", "cylinders": cylinders.len() });
    let discs = cylinders.iter().map(|&Cylinder { center, radius }| Shape::Disc { center, radius });
    let bounds = discs.clone().map(|disc| disc.bounds()).reduce(Rect::union);
    let bounds = bounds.ok_or_else(|| PlanError::value("cylinders", 0, "one or more"))?;
    let ends = CHALLENGE.into_iter().map(|end| Rect::new(end, end).grown(CELL));
    let bounds = ends.fold(bounds, Rect::union);
    let mut world = World::new(Provenance::other(IMPORT, source), bounds);
    world.obstacles = discs.map(|disc| Obstacle::new(ObstacleKind::Other, disc)).collect();
    let free = |end: DVec2| {
        let pose = Pose { position: end, heading: HEADING };
        (world.clearance(end) > 0.0).then_some(pose)
    };
    let [start, goal] = CHALLENGE.map(free);
    (world.start, world.goal) = (start, goal);
    world.check().map_err(FileError::World)?;
    Ok(world)
}

#[cfg(test)]
mod tests;
