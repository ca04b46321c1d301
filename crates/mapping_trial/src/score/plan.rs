//! Ways over free ground of a map, for trying the map out.

use glam::DVec2;

use super::raster::Raster;
use crate::distance::squared_distances;
use crate::map::{CellIndex, RESOLUTION};

/// Distance from what is occupied in metres from which on a way costs no more.
const COMFORT: f64 = 0.75;

/// Cost of a straight and of a diagonal step where nothing is near, and of the steps that the
/// nearest passable place to something occupied costs more.
const STRAIGHT: u32 = 5;
const DIAGONAL: u32 = 7;
const NEAR_FACTOR: f64 = 4.0;

/// More than a step can cost.
const QUEUES: usize = 64;

/// How far a way may end from its goal and begin from its start, in cells.
const SNAP: i32 = 3;

/// The eight neighbours of a cell.
const STEPS: [(i32, i32); 8] =
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// No cell, or no step.
const NONE: u8 = u8::MAX;

/// Where a robot's middle may be according to a map, and the last search.
pub(super) struct Planner<'a> {
    raster: &'a Raster,
    /// Cost factor of each cell, 0 where a way must not lead; one cell of border all around.
    factor: Vec<u8>,
    /// Which of a cell's four cells of the map is farthest from what is occupied.
    best: Vec<u8>,
    cost: Vec<u32>,
    from: Vec<u8>,
    queues: Vec<Vec<u32>>,
}

impl<'a> Planner<'a> {
    /// Plans for a disc of a radius on what a map shows as free.
    pub(super) fn new(raster: &'a Raster, radius: f64) -> Self {
        let frame = raster.frame;
        let distance = squared_distances(2 * frame.cols, &raster.fine);
        // From the middle of a place to the nearest side of an occupied cell.
        let need = (radius / RESOLUTION + 0.5) * (radius / RESOLUTION + 0.5);
        let comfort = (COMFORT / RESOLUTION) * (COMFORT / RESOLUTION);
        let (mut factor, mut best) = (vec![0; frame.len()], vec![0; frame.len()]);
        for cell in (0..frame.len()).filter(|&cell| raster.free[cell]) {
            let corner = raster.fine_corner(cell);
            let four = [0, 1, 2 * frame.cols, 2 * frame.cols + 1].map(|at| distance[corner + at]);
            let place = (0..4).max_by_key(|&i| (four[i], 3 - i)).unwrap_or(0);
            let squared = f64::from(four[place]);
            if squared >= need {
                let near = ((comfort - squared) / (comfort - need).max(1.0)).clamp(0.0, 1.0);
                factor[cell] = (2.0 + 2.0 * NEAR_FACTOR * near * near / 2.0).round() as u8;
                best[cell] = place as u8;
            }
        }
        Planner {
            raster,
            factor,
            best,
            cost: vec![u32::MAX; frame.len()],
            from: vec![NONE; frame.len()],
            queues: vec![Vec::new(); QUEUES],
        }
    }

    /// The cells where a way may lead.
    pub(super) fn passable(&self) -> impl Iterator<Item = usize> + '_ {
        self.factor.iter().enumerate().filter(|(_, factor)| **factor > 0).map(|(cell, _)| cell)
    }

    /// The cheapest ways from a start to goals, as points to drive through; `None` for a goal
    /// that cannot be reached. A way begins and ends within 0.3 m of start and goal.
    pub(super) fn ways(&mut self, start: DVec2, goals: &[DVec2]) -> Vec<Option<Vec<DVec2>>> {
        let goals: Vec<_> = goals.iter().map(|&goal| self.snap(goal)).collect();
        let Some(start) = self.snap(start) else { return vec![None; goals.len()] };
        self.search(start, &goals);
        goals.into_iter().map(|goal| self.way(goal?)).collect()
    }

    /// The passable cell nearest to a point.
    fn snap(&self, p: DVec2) -> Option<usize> {
        let frame = self.raster.frame;
        let cell = frame.cell_at(p)?;
        let around = (-SNAP..=SNAP).flat_map(|y| (-SNAP..=SNAP).map(move |x| (x, y)));
        let around = around.filter(|(x, y)| x * x + y * y <= SNAP * SNAP);
        let passable = around.filter_map(|(x, y)| {
            let near = frame.neighbour(cell, x, y).filter(|&near| self.factor[near] > 0)?;
            Some((x * x + y * y, near))
        });
        passable.min().map(|(_, near)| near)
    }

    /// Dijkstra's search from a cell until all goals are reached, with a queue for each cost
    /// (Dial, 1969).
    fn search(&mut self, start: usize, goals: &[Option<usize>]) {
        let frame = self.raster.frame;
        self.cost.fill(u32::MAX);
        self.from.fill(NONE);
        self.queues.iter_mut().for_each(Vec::clear);
        let mut left: Vec<usize> = goals.iter().copied().flatten().collect();
        left.sort_unstable();
        left.dedup();
        self.cost[start] = 0;
        self.queues[0].push(start as u32);
        let (mut waiting, mut cost) = (1_usize, 0_u32);
        while waiting > 0 && !left.is_empty() {
            let Some(cell) = self.queues[cost as usize % QUEUES].pop() else {
                cost += 1;
                continue;
            };
            waiting -= 1;
            let cell = cell as usize;
            if self.cost[cell] != cost {
                continue;
            }
            if let Ok(at) = left.binary_search(&cell) {
                left.remove(at);
            }
            for (way, &(x, y)) in STEPS.iter().enumerate() {
                let Some(next) = frame.neighbour(cell, x, y) else { continue };
                let factor = u32::from(self.factor[next]);
                if factor == 0 {
                    continue;
                }
                let step = if way % 2 == 0 { STRAIGHT } else { DIAGONAL };
                let through = cost + step * factor / 2;
                if through < self.cost[next] {
                    self.cost[next] = through;
                    self.from[next] = way as u8;
                    self.queues[through as usize % QUEUES].push(next as u32);
                    waiting += 1;
                }
            }
        }
    }

    /// The way to a cell from the start of the last search.
    fn way(&self, to: usize) -> Option<Vec<DVec2>> {
        if self.cost[to] == u32::MAX {
            return None;
        }
        let mut points = vec![self.point(to)];
        let mut cell = to;
        while let Some(&(x, y)) = STEPS.get(usize::from(self.from[cell])) {
            cell = self.raster.frame.neighbour(cell, -x, -y)?;
            points.push(self.point(cell));
        }
        points.reverse();
        Some(points)
    }

    /// The place of a cell to drive through.
    fn point(&self, cell: usize) -> DVec2 {
        let (col, row) = self.raster.frame.place(cell);
        let (x, y) = (i32::from(self.best[cell] & 1), i32::from(self.best[cell] >> 1));
        CellIndex { col: 2 * col + x, row: 2 * row + y }.centre()
    }
}
