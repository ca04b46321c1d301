//! Travel costs over a raster of classes: cost rasters, least-cost paths and cost fields.
//!
//! Kuznetsov's classes are the greatest speeds at which cells can be crossed. A step between the centres of two
//! cells costs its length times the mean of their slowness, 1 / speed. A diagonal step requires that both cells
//! beside it are passable, as in the MovingAI benchmarks (N. R. Sturtevant, Benchmarks for grid-based pathfinding,
//! IEEE TCIAIG 4, 2012, <https://doi.org/10.1109/TCIAIG.2012.2197681>).

use std::cmp::Ordering;
use std::f64::consts::SQRT_2;
use std::ops::Add;

use pathfinding::directed::{astar::astar, dijkstra::dijkstra_reach};
use pathfinding::num_traits::Zero;

use super::metrics::{Neighbourhood, RasterError};
use crate::world::ClassRaster;

/// The costs of travelling over a raster.
///
/// ```
/// use envgen::landscape::metrics::Neighbourhood;
/// use envgen::landscape::LandscapeSpec;
/// use envgen::landscape::paths::TravelMap;
/// use envgen::{Seed, Spec};
///
/// // Three classes at 1, 2 and 4 m/s.
/// let speeds = vec![1.0, 2.0, 4.0];
/// let spec = LandscapeSpec { classes: 3, entropy: 1.0, speeds, ..Default::default() };
/// let raster = spec.generate(Seed(7))?.to_raster();
/// let map = TravelMap::new(&raster, Neighbourhood::Eight)?;
/// let seconds = map.cost_field(0);
/// let last = raster.cells.len() - 1;
/// let path = map.path(0, last).expect("all cells can be crossed");
/// assert!((path.cost - seconds[last]).abs() < 1e-9);
/// // Seconds per metre of each cell, such as for a map of costs.
/// assert!(map.cost_raster().iter().all(|cost| [1.0, 0.5, 0.25].contains(cost)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct TravelMap<'a> {
    raster: &'a ClassRaster,
    slowness: Vec<f64>,
    least: f64,
    moves: Neighbourhood,
}

/// A least-cost path.
#[derive(Clone, Debug, PartialEq)]
pub struct TravelPath {
    /// The cells from start to goal, by their index in the raster's list.
    pub cells: Vec<usize>,
    /// The cost: metres divided by speed. If speeds are in m/s, the cost is in seconds; if they are factors of a
    /// robot's greatest speed, it is in metres of plain ground.
    pub cost: f64,
}

impl<'a> TravelMap<'a> {
    /// Creates the map of a raster with its own speeds. Class 0 and classes of speed 0 cannot be passed.
    ///
    /// # Errors
    /// When the raster's sizes do not fit together, or when a speed is negative or not finite.
    pub fn new(raster: &'a ClassRaster, moves: Neighbourhood) -> Result<Self, RasterError> {
        super::metrics::check(raster)?;
        // A search does not end where steps have negative costs.
        let is_speed = |speed: f64| speed >= 0.0 && speed.is_finite();
        if let Some(class) = raster.speeds.iter().position(|&speed| !is_speed(speed)) {
            return Err(RasterError::Speed { class, speed: raster.speeds[class] });
        }
        let slowness: Vec<f64> = (0..=u16::MAX)
            .map(|class| match raster.speed_of(class) {
                // Not divided by what may be -0.
                speed if class == 0 || speed == 0.0 => f64::INFINITY,
                speed => 1.0 / speed,
            })
            .collect();
        let least = raster
            .cells
            .iter()
            .map(|&class| slowness[usize::from(class)])
            .fold(f64::INFINITY, f64::min);
        Ok(TravelMap { raster, slowness, least, moves })
    }

    /// Returns the cost per metre in each cell, which is infinite if the cell cannot be passed.
    pub fn cost_raster(&self) -> Vec<f64> {
        self.raster.cells.iter().map(|&class| self.slowness[usize::from(class)]).collect()
    }

    /// Returns whether a cell can be passed; `false` outside the raster.
    pub fn is_passable(&self, cell: usize) -> bool {
        self.raster
            .cells
            .get(cell)
            .is_some_and(|&class| self.slowness[usize::from(class)] < f64::INFINITY)
    }

    /// Returns the cells that can be reached from a cell in one step, with the cost of the step; none from outside
    /// the raster.
    pub fn steps(&self, from: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let cols = self.raster.cols as usize;
        let cells = self.raster.cells.len();
        let slow = |cell: usize| self.slowness[usize::from(self.raster.cells[cell])];
        neighbours(from, cols, cells, self.moves).filter_map(move |to| {
            let straight = from / cols == to / cols || from % cols == to % cols;
            let free = straight || {
                let (r, c) = (to / cols, to % cols);
                self.is_passable(from / cols * cols + c) && self.is_passable(r * cols + from % cols)
            };
            let length = if straight { 1.0 } else { SQRT_2 } * self.raster.cell;
            let cost = length * 0.5 * (slow(from) + slow(to));
            (free && cost < f64::INFINITY).then_some((to, cost))
        })
    }

    /// Returns a least-cost path between two cells, found by A* with the straight-line distance over the fastest
    /// ground; `None` if there are no paths, or if one of the cells cannot be passed.
    ///
    /// ```
    /// use envgen::glam::DVec2;
    /// use envgen::landscape::{metrics::Neighbourhood, paths::TravelMap};
    /// use envgen::world::ClassRaster;
    ///
    /// // A wall of class 2 in the middle column leaves a gap in the lower row.
    /// let cells = vec![1, 2, 1, 1, 2, 1, 1, 1, 1];
    /// let speeds = vec![0.0, 1.0, 0.0];
    /// let raster = ClassRaster { rows: 3, cols: 3, cell: 1.0, origin: DVec2::ZERO, cells, speeds };
    /// let map = TravelMap::new(&raster, Neighbourhood::Four)?;
    /// let path = map.path(0, 2).expect("a path around the wall");
    /// assert_eq!((path.cells, path.cost), (vec![0, 3, 6, 7, 8, 5, 2], 6.0));
    /// assert_eq!(map.path(0, 1), None);
    /// # Ok::<(), envgen::landscape::metrics::RasterError>(())
    /// ```
    pub fn path(&self, from: usize, to: usize) -> Option<TravelPath> {
        if !(self.is_passable(from) && self.is_passable(to)) {
            return None;
        }
        // Slightly less than the distance, so that rounding does not overestimate it.
        let pace = self.least * self.raster.cell * (1.0 - 1e-9);
        let cols = self.raster.cols as usize;
        let ahead = |&cell: &u32| {
            let dr = (cell as usize / cols).abs_diff(to / cols) as f64;
            let dc = (cell as usize % cols).abs_diff(to % cols) as f64;
            Cost(
                pace * match self.moves {
                    Neighbourhood::Four => dr + dc,
                    Neighbourhood::Eight => dr.max(dc) + (SQRT_2 - 1.0) * dr.min(dc),
                },
            )
        };
        let (cells, cost) =
            astar(&(from as u32), |&cell| self.priced(cell), ahead, |&cell| cell as usize == to)?;
        let cells = cells.into_iter().map(|cell| cell as usize).collect();
        Some(TravelPath { cells, cost: cost.0 })
    }

    /// Returns the least cost from a cell to every cell (Dijkstra), which is infinite for cells that cannot be reached.
    pub fn cost_field(&self, from: usize) -> Vec<f64> {
        let mut field = vec![f64::INFINITY; self.raster.cells.len()];
        if self.is_passable(from) {
            for reached in dijkstra_reach(&(from as u32), |&cell| self.priced(cell)) {
                field[reached.node as usize] = reached.total_cost.0;
            }
        }
        field
    }

    fn priced(&self, cell: u32) -> impl Iterator<Item = (u32, Cost)> + '_ {
        self.steps(cell as usize).map(|(to, cost)| (to as u32, Cost(cost)))
    }
}

/// A finite cost, which can be ordered.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cost(f64);

impl Eq for Cost {}

impl Ord for Cost {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Cost {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Add for Cost {
    type Output = Cost;

    fn add(self, other: Cost) -> Cost {
        Cost(self.0 + other.0)
    }
}

impl Zero for Cost {
    fn zero() -> Self {
        Cost(0.0)
    }

    fn is_zero(&self) -> bool {
        self.0 == 0.0
    }
}

/// Returns the neighbours of a cell of a grid of `cells` cells, with the four at its sides first; none of a cell
/// outside the grid.
fn neighbours(
    at: usize,
    cols: usize,
    cells: usize,
    neighbourhood: Neighbourhood,
) -> impl Iterator<Item = usize> {
    let inside = at < cells;
    let column = at % cols.max(1);
    let (left, right) = (inside && column > 0, inside && column + 1 < cols);
    let (up, down) = (inside && at >= cols, at < cells.saturating_sub(cols));
    let corners = neighbourhood == Neighbourhood::Eight;
    [
        (left, -1),
        (right, 1),
        (up, -(cols as isize)),
        (down, cols as isize),
        (corners && up && left, -(cols as isize) - 1),
        (corners && up && right, -(cols as isize) + 1),
        (corners && down && left, cols as isize - 1),
        (corners && down && right, cols as isize + 1),
    ]
    .into_iter()
    .filter(|step| step.0)
    .map(move |(_, step)| at.wrapping_add_signed(step))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use proptest::prelude::*;

    fn raster(rows: u32, cols: u32, cells: Vec<u16>, speeds: Vec<f64>) -> ClassRaster {
        ClassRaster { rows, cols, cell: 2.0, origin: glam::DVec2::ZERO, cells, speeds }
    }

    /// Bellman-Ford: every step again and again until nothing changes.
    fn slow_field(map: &TravelMap<'_>, from: usize) -> Vec<f64> {
        let mut field = vec![f64::INFINITY; map.raster.cells.len()];
        field[from] = 0.0;
        loop {
            let mut changed = false;
            for cell in 0..field.len() {
                if field[cell] == f64::INFINITY {
                    continue;
                }
                for (to, cost) in map.steps(cell) {
                    if field[cell] + cost < field[to] - 1e-12 {
                        field[to] = field[cell] + cost;
                        changed = true;
                    }
                }
            }
            if !changed {
                return field;
            }
        }
    }

    #[test]
    fn corners_are_not_cut() {
        let raster = raster(2, 2, vec![1, 2, 2, 1], vec![0.0, 1.0, 0.0]);
        let map = TravelMap::new(&raster, Neighbourhood::Eight).unwrap();
        assert_eq!(map.path(0, 3), None);
        assert_eq!(map.path(0, 1), None);
        assert_eq!(map.path(0, 99), None);
        assert_eq!(map.path(0, 0), Some(TravelPath { cells: vec![0], cost: 0.0 }));
    }

    #[test]
    fn speeds_without_meaning_are_refused() {
        for speed in [-1.0, -1e-300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let raster = raster(1, 2, vec![1, 1], vec![0.0, 1.0, speed]);
            let error = TravelMap::new(&raster, Neighbourhood::Four).unwrap_err().to_string();
            let expected = "the speed of class 2 must be a finite number of at least 0, got";
            assert_eq!(error, format!("{expected} {speed}"));
        }
        // Ground of speed -0 is as that of speed 0.
        let raster = raster(1, 3, vec![1, 2, 1], vec![0.0, 1.0, -0.0]);
        let map = TravelMap::new(&raster, Neighbourhood::Four).unwrap();
        assert_eq!(map.cost_raster(), [1.0, f64::INFINITY, 1.0]);
        assert_eq!(map.path(0, 2), None);
    }

    #[test]
    fn no_steps_lead_from_outside() {
        for (rows, cols) in [(1, 2), (2, 1), (2, 2), (0, 0), (0, 3), (3, 0)] {
            let count = (rows * cols) as usize;
            let raster = raster(rows, cols, vec![1; count], vec![]);
            let map = TravelMap::new(&raster, Neighbourhood::Eight).unwrap();
            for cell in [count, count + 1, 9, usize::MAX] {
                assert_eq!(map.steps(cell).count(), 0, "{rows} x {cols}, {cell}");
                assert!(!map.is_passable(cell));
                assert!(map.cost_field(cell).iter().all(|cost| *cost == f64::INFINITY));
            }
        }
    }

    #[test]
    fn slow_ground_is_gone_around() {
        let cells = vec![1, 1, 1, 1, 2, 1, 1, 1, 1];
        let raster = raster(3, 3, cells, vec![0.0, 1.0, 0.1]);
        let map = TravelMap::new(&raster, Neighbourhood::Four).unwrap();
        let path = map.path(3, 5).unwrap();
        assert_eq!((path.cost, path.cells.len()), (8.0, 5));
        assert_eq!(map.cost_raster()[4], 10.0);
    }

    proptest! {
        #[test]
        fn every_search_ends(
            rows in 1_u32..5, cols in 1_u32..5, seed: u64, eight: bool, cell in 0_usize..30,
            speeds in prop::collection::vec(
                prop_oneof![
                    8 => 0.0..2.0_f64, 2 => Just(-0.0), 1 => -1.0..0.0_f64, 1 => Just(f64::NAN),
                    1 => Just(f64::INFINITY),
                ],
                0..4,
            ),
        ) {
            let mut stream = Seed(seed).stream("test", 0);
            let cells = (0..rows * cols).map(|_| stream.below(4) as u16).collect();
            let raster = raster(rows, cols, cells, speeds);
            let are_speeds = raster.speeds.iter().all(|speed| *speed >= 0.0 && speed.is_finite());
            let moves = if eight { Neighbourhood::Eight } else { Neighbourhood::Four };
            let map = TravelMap::new(&raster, moves);
            prop_assert_eq!(map.is_ok(), are_speeds);
            let Ok(map) = map else { return Ok(()) };
            let (field, slow) = (map.cost_field(0), map.cost_raster());
            prop_assert!(field.iter().chain(&slow).all(|cost| *cost >= 0.0));
            for (to, least) in field.into_iter().enumerate() {
                prop_assert_eq!(map.path(0, to).is_some(), least < f64::INFINITY);
            }
            prop_assert!(map.steps(cell).all(|(to, cost)| to < raster.cells.len() && cost >= 0.0));
        }

        #[test]
        fn paths_and_fields_agree_with_the_slow_method(
            rows in 1_u32..9, cols in 1_u32..9, seed: u64, eight: bool,
        ) {
            let mut stream = Seed(seed).stream("test", 0);
            let cells = (0..rows * cols).map(|_| stream.below(5) as u16).collect();
            let raster = raster(rows, cols, cells, vec![0.0, 1.0, 0.5, 0.0, 2.0]);
            let moves = if eight { Neighbourhood::Eight } else { Neighbourhood::Four };
            let map = TravelMap::new(&raster, moves).unwrap();
            let from = stream.below(u64::from(rows * cols)) as usize;
            prop_assume!(map.is_passable(from));
            let (field, slow) = (map.cost_field(from), slow_field(&map, from));
            for (to, &least) in slow.iter().enumerate() {
                prop_assert!(field[to] == least || (field[to] - least).abs() < 1e-9);
                match map.path(from, to) {
                    None => prop_assert_eq!(least, f64::INFINITY),
                    Some(path) => {
                        prop_assert!((path.cost - least).abs() < 1e-9);
                        let cost: f64 = path
                            .cells
                            .windows(2)
                            .map(|w| map.steps(w[0]).find(|step| step.0 == w[1]).unwrap().1)
                            .sum();
                        prop_assert!((cost - path.cost).abs() < 1e-9);
                        prop_assert_eq!((path.cells[0], path.cells[path.cells.len() - 1]), (from, to));
                    }
                }
            }
        }
    }
}
