//! Frontiers: the borders between known free space and unknown space (Yamauchi, A frontier-based
//! approach for autonomous exploration, 1997).

use std::ops::Range;

use glam::{DVec2, IVec2};

use super::costmap::{Bits, Costmap, NODES, Node, SIDE, STEPS, cell_of, step_index};
use crate::map::{Cell, CellIndex, RESOLUTION, TILE};

/// Least number of frontier cells for which a cluster is worth a visit: 0.5 m.
pub const LEAST_CELLS: usize = 10;

/// Distance in metres to which the centre of a robot of the Pioneer's size has to approach a frontier
/// that it cannot drive onto. Larger robots stay farther away.
const VIEWPOINT: f64 = 0.6;

/// Cells of the map along a side of a block. Neighbouring rays of a scan end some cells apart at long
/// range, so frontier cells in blocks that touch count as connected.
const BLOCK: i32 = 4;

/// Blocks along a side of a tile.
const BLOCKS: i32 = TILE / BLOCK;

/// A cluster of connected frontier cells, with at most 0.2 m from one to the next along each axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Cluster {
    cells: Range<usize>,
}

/// The clusters of frontier cells, and the planning cells from which to visit them.
///
/// ```
/// use mapping_trial::map::{CellIndex, MISS, OccupancyMap};
/// use mapping_trial::policy::{costmap::Costmap, frontier::Frontiers};
/// use mapping_trial::robot::Robot;
///
/// // A free square of 2 m, seen twice: its border is one frontier.
/// let mut map = OccupancyMap::new();
/// for (col, row) in (0..40).flat_map(|col| (0..40).map(move |row| (col, row))) {
///     map.add(CellIndex { col, row }, -2 * MISS);
/// }
/// map.touch(map.bounds().expect("there are cells"));
/// let mut costmap = Costmap::new(&Robot::default());
/// costmap.refresh(&map);
/// let mut frontiers = Frontiers::new();
/// frontiers.gather(&mut costmap, |_, _| false);
/// assert_eq!((frontiers.len(), frontiers.cells(0).len()), (1, 4 * 39));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Frontiers {
    /// Cells of all clusters, one cluster after the other.
    cells: Vec<CellIndex>,
    clusters: Vec<Cluster>,
    /// Blocks that do not belong to a cluster yet, tile by tile.
    pending: Vec<u64>,
    open: Vec<(usize, IVec2)>,
    /// For each planning cell, the number of the cluster whose goal it is, plus one; 0 for none.
    labels: Vec<u32>,
    labelled: Vec<Node>,
    /// Number of clusters that have a goal.
    with_goal: usize,
}

impl Frontiers {
    /// Creates an empty set of frontiers.
    pub fn new() -> Self {
        Frontiers::default()
    }

    /// Gathers the frontier cells of a costmap into clusters, and finds the goals of each cluster:
    /// those of its cells into which the robot fits or, if there are none, cells nearby that see one.
    /// Frontier cells for which `skip` is true are not goals.
    pub fn gather(&mut self, costmap: &mut Costmap, skip: impl Fn(&Costmap, DVec2) -> bool) {
        self.cluster(costmap);
        for node in self.labelled.drain(..) {
            if let Some(label) = self.labels.get_mut(node.0 as usize) {
                *label = 0;
            }
        }
        self.labels.resize(costmap.tiles() * NODES, 0);
        self.with_goal = 0;
        for number in 0..self.clusters.len() {
            let before = self.labelled.len();
            let cells = self.clusters[number].cells.clone();
            let mut fits = false;
            for cell in cells.clone() {
                let p = self.cells[cell].centre();
                if let Some(node) = costmap.node_at(p)
                    && costmap.cell_cost(node).is_passable()
                {
                    fits = true;
                    // Several cells of the map lie in one planning cell.
                    if self.cluster_at(node).is_none() && !skip(costmap, p) {
                        self.label(node, number);
                    }
                }
            }
            if !fits && cells.len() >= 2 * LEAST_CELLS {
                for cell in cells.step_by(LEAST_CELLS / 2) {
                    let index = self.cells[cell];
                    if !skip(costmap, index.centre()) {
                        self.label_viewpoints(costmap, index, number);
                    }
                }
            }
            self.with_goal += usize::from(self.labelled.len() > before);
        }
    }

    /// Returns the number of clusters.
    pub fn len(&self) -> usize {
        self.clusters.len()
    }

    /// Returns whether there are no clusters.
    pub fn is_empty(&self) -> bool {
        self.clusters.is_empty()
    }

    /// Returns the number of planning cells that are goals.
    pub fn goals(&self) -> usize {
        self.labelled.len()
    }

    /// Number of clusters that have a goal.
    pub(super) fn with_goal(&self) -> usize {
        self.with_goal
    }

    /// Returns the cluster that has a node as a goal.
    #[inline]
    pub fn cluster_at(&self, node: Node) -> Option<usize> {
        self.labels
            .get(node.0 as usize)
            .and_then(|label| label.checked_sub(1))
            .map(|number| number as usize)
    }

    /// Returns the cells of a cluster.
    pub fn cells(&self, cluster: usize) -> &[CellIndex] {
        &self.cells[self.clusters[cluster].cells.clone()]
    }

    /// Returns the cell of a cluster that is nearest to a point: if there are any, one of those whose
    /// middle is wanted.
    pub fn nearest_cell(
        &self,
        cluster: usize,
        p: DVec2,
        wanted: impl Fn(DVec2) -> bool,
    ) -> Option<CellIndex> {
        let far = |cell: &&CellIndex| cell.centre().distance_squared(p);
        let cells = self.cells(cluster).iter();
        let nearest = cells.clone().filter(|cell| wanted(cell.centre()));
        let nearest = nearest.min_by(|a, b| far(a).total_cmp(&far(b)));
        nearest.or_else(|| cells.min_by(|a, b| far(a).total_cmp(&far(b)))).copied()
    }

    fn label(&mut self, node: Node, cluster: usize) {
        let label = &mut self.labels[node.0 as usize];
        if *label == 0 {
            *label = cluster as u32 + 1;
            self.labelled.push(node);
        }
    }

    fn label_viewpoints(&mut self, costmap: &mut Costmap, cell: CellIndex, cluster: usize) {
        let viewpoint = costmap.grown(VIEWPOINT).max(VIEWPOINT);
        let reach = (viewpoint / SIDE) as i32;
        let frontier = cell.centre();
        let middle = cell_of(frontier);
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let p = ((middle + IVec2::new(dx, dy)).as_dvec2() + 0.5) * SIDE;
                if p.distance_squared(frontier) > viewpoint * viewpoint {
                    continue;
                }
                if let Some(node) = costmap.node_at(p)
                    && costmap.cell_cost(node).is_passable()
                    && sees(costmap, costmap.point(node), frontier)
                {
                    self.label(node, cluster);
                }
            }
        }
    }

    fn cluster(&mut self, costmap: &Costmap) {
        self.cells.clear();
        self.clusters.clear();
        self.pending.clear();
        self.pending.extend((0..costmap.tiles()).map(|slot| blocks(costmap.frontier(slot))));
        for slot in 0..costmap.tiles() {
            while self.pending[slot] != 0 {
                let block = self.pending[slot].trailing_zeros() as i32;
                self.flood(costmap, slot, IVec2::new(block % BLOCKS, block / BLOCKS));
            }
        }
    }

    /// Takes a block and all connected blocks into a new cluster.
    fn flood(&mut self, costmap: &Costmap, slot: usize, block: IVec2) {
        let first = self.cells.len();
        self.pending[slot] &= !(1 << (block.y * BLOCKS + block.x));
        self.open.push((slot, block));
        while let Some((slot, block)) = self.open.pop() {
            let corner = costmap.tile_at(slot) * TILE;
            for row in block.y * BLOCK..(block.y + 1) * BLOCK {
                let low = block.x * BLOCK;
                let mut bits = costmap.frontier(slot)[row as usize] >> low & ((1 << BLOCK) - 1);
                while bits != 0 {
                    let col = low + bits.trailing_zeros() as i32;
                    self.cells.push(CellIndex { col: corner.x + col, row: corner.y + row });
                    bits &= bits - 1;
                }
            }
            for step in STEPS {
                let next = block + step;
                let over = next.div_euclid(IVec2::splat(BLOCKS));
                let slot = if over == IVec2::ZERO {
                    slot
                } else {
                    let Some(slot) = costmap.beside(slot, step_index(over)) else { continue };
                    slot
                };
                let next = next.rem_euclid(IVec2::splat(BLOCKS));
                let bit = 1 << (next.y * BLOCKS + next.x);
                if self.pending[slot] & bit != 0 {
                    self.pending[slot] &= !bit;
                    self.open.push((slot, next));
                }
            }
        }
        if self.cells.len() - first < LEAST_CELLS {
            self.cells.truncate(first);
        } else {
            self.clusters.push(Cluster { cells: first..self.cells.len() });
        }
    }
}

/// One bit per block of a tile, row by row from below: whether the block has a frontier cell.
fn blocks(frontier: &Bits) -> u64 {
    let mut blocks = 0;
    for (row, rows) in frontier.chunks_exact(BLOCK as usize).enumerate() {
        let any = rows.iter().fold(0, |any, row| any | row);
        let any = (any | any >> 1 | any >> 2 | any >> 3) & 0x1111_1111;
        let gathered = (0..BLOCKS).fold(0, |bits, col| bits | (any >> (3 * col)) & (1 << col));
        blocks |= u64::from(gathered) << (row * BLOCKS as usize);
    }
    blocks
}

/// Whether there is no known occupied cell between two points.
pub(super) fn sees(costmap: &Costmap, from: DVec2, to: DVec2) -> bool {
    let offset = to - from;
    let steps = (offset.length() / (0.8 * RESOLUTION)).ceil().clamp(1.0, 1e4);
    (0..steps as usize).all(|step| {
        let p = from + offset * (step as f64 / steps);
        costmap.cell(CellIndex::of(p)) != Cell::Occupied
    })
}

/// Whether a frontier cell is left within a distance in metres of a point.
pub(super) fn is_left(costmap: &Costmap, p: DVec2, within: f64) -> bool {
    let middle = CellIndex::of(p);
    let reach = (within / RESOLUTION) as i32;
    (-reach..=reach).any(|dy| {
        (-reach..=reach).any(|dx| {
            let cell = CellIndex {
                col: middle.col.saturating_add(dx),
                row: middle.row.saturating_add(dy),
            };
            dx * dx + dy * dy <= reach * reach && costmap.is_frontier(cell)
        })
    })
}

/// The vector from a point to the centroid of the unknown cells around another point; `None` if all are
/// known.
pub(super) fn unknown_from(costmap: &Costmap, p: DVec2, around: DVec2) -> Option<DVec2> {
    const REACH: i32 = 10;
    let middle = CellIndex::of(around);
    let (mut sum, mut count) = (DVec2::ZERO, 0.0);
    for dy in -REACH..=REACH {
        for dx in -REACH..=REACH {
            let cell = CellIndex {
                col: middle.col.saturating_add(dx),
                row: middle.row.saturating_add(dy),
            };
            if costmap.cell(cell) == Cell::Unknown {
                sum += cell.centre();
                count += 1.0;
            }
        }
    }
    (count > 0.0).then(|| sum / count - p)
}
