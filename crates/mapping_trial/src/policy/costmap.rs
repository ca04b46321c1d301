//! The costmap that policies derive from the map: where the robot's centre can be, the cost of being
//! there, and the frontier cells. Only tiles that changed are derived again.

mod cell_cost;
mod node;
mod row;
mod table;
mod tile;

use glam::{DVec2, IVec2};

pub use self::cell_cost::CellCost;
pub use self::node::Node;
use self::row::Row;
use self::table::NONE;
pub(super) use self::tile::{Bits, NODES, STEPS};
pub use self::tile::{CELLS, SIDE};
use self::tile::{Tile, Tiles};
use super::inflation::{Inflation, LEVELS, MOST};
use crate::map::{Cell, CellIndex, DECIDED, OccupancyMap, RESOLUTION, TILE};
use crate::robot::Robot;

/// Greatest distance in metres that [`Costmap::is_occupied_within`] searches, which bounds its work.
const FARTHEST_LOOK: f64 = 20.0;

/// A costmap: the costs of planning cells, and frontier cells, tile by tile as in the map.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, glam::DVec2, hallway::HallwaySpec};
/// use mapping_trial::policy::costmap::{CellCost, Costmap};
/// use mapping_trial::{robot::Robot, mappable_area::MappableArea};
///
/// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
/// let (robot, area) = (Robot::default(), MappableArea::new(&world, &Robot::default())?);
/// let mut costmap = Costmap::new(&robot);
/// costmap.refresh(&area.perfect_map());
/// // The middle of a corridor 2 m wide, 0.2 m from its wall, and outside.
/// let from_middle = |x| area.start() + DVec2::new(x, 0.0);
/// assert_eq!(costmap.cell_cost_at(from_middle(0.0)), CellCost::Open);
/// assert_eq!(costmap.cell_cost_at(from_middle(0.8)), CellCost::Inflated);
/// assert_eq!(costmap.cell_cost_at(from_middle(50.0)), CellCost::Unknown);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Costmap {
    inflation: Inflation,
    revision: u64,
    tiles: Tiles,
    /// Per node, its [`CellCost`] in the low three bits, and the best of its four cells in the high
    /// four.
    costs: Vec<u8>,
    /// Tiles whose frontier is to be derived again.
    stale: Vec<u32>,
}

impl Costmap {
    /// Creates an unknown costmap for robots of this size.
    ///
    /// # Panics
    ///
    /// If [`Robot::validate`] rejects the robot.
    #[track_caller]
    pub fn new(robot: &Robot) -> Self {
        if let Err(error) = robot.validate() {
            panic!("{error}");
        }
        Costmap {
            inflation: Inflation::of(robot),
            revision: 0,
            tiles: Tiles::default(),
            costs: Vec::new(),
            stale: Vec::new(),
        }
    }

    /// Sets the circumscribed radius, in metres, of the robot for which costs are computed.
    pub(super) fn set_radius(&mut self, radius: f64) {
        self.inflation = Inflation::of_radius(radius);
        for tile in self.tiles.iter_mut() {
            tile.stale_costs = true;
        }
    }

    /// Enlarges a distance in metres that suits the Pioneer 3-AT by the robot's excess radius.
    pub(super) fn grown(&self, pioneer: f64) -> f64 {
        self.inflation.grown(pioneer)
    }

    /// Takes over the changes of the map, which must be the same map each time.
    pub fn refresh(&mut self, map: &OccupancyMap) {
        if map.revision() == self.revision {
            return;
        }
        let since = std::mem::replace(&mut self.revision, map.revision());
        // A map that is drawn again drops its tiles without notice.
        for slot in 0..self.tiles.len() {
            let at = self.tiles[slot].at;
            if map.tile(at.x, at.y).is_none() {
                self.write(slot, [0; TILE as usize], [0; TILE as usize]);
            }
        }
        for (col, row) in map.changed_since(since) {
            if let Some(cells) = map.tile(col, row) {
                let slot = self.slot_or_new(IVec2::new(col, row));
                let (occupied, free) = bits(cells);
                self.write(slot, occupied, free);
            }
        }
        while let Some(slot) = self.stale.pop() {
            self.derive_frontier(slot as usize);
        }
    }

    /// Returns the cost of the planning cell that contains a point, for the robot's centre.
    pub fn cell_cost_at(&mut self, p: DVec2) -> CellCost {
        self.node_at(p).map_or(CellCost::Unknown, |node| self.cell_cost(node))
    }

    /// Returns the state of a cell of the map at the last refresh.
    pub fn cell(&self, index: CellIndex) -> Cell {
        let side = IVec2::splat(TILE);
        let index = IVec2::new(index.col, index.row);
        let Some(slot) = self.tiles.slot_of(index.div_euclid(side)) else { return Cell::Unknown };
        let cell = index.rem_euclid(side);
        let tile = &self.tiles[slot as usize];
        if tile.occupied[cell.y as usize] >> cell.x & 1 == 1 {
            Cell::Occupied
        } else if tile.free[cell.y as usize] >> cell.x & 1 == 1 {
            Cell::Free
        } else {
            Cell::Unknown
        }
    }

    /// Keeps robots away from water that was seen at a point in metres, as from obstacles. It is
    /// remembered permanently.
    pub fn mark_water(&mut self, p: DVec2) {
        let side = IVec2::splat(TILE);
        let index = CellIndex::of(p);
        let index = IVec2::new(index.col, index.row);
        // Water beyond the map is seen again once the map reaches it.
        let Some(slot) = self.tiles.slot_of(index.div_euclid(side)) else { return };
        let cell = index.rem_euclid(side);
        let tile = &mut self.tiles[slot as usize];
        let bit = 1 << cell.x;
        if tile.water[cell.y as usize] & bit == 0 {
            tile.water[cell.y as usize] |= bit;
            tile.stale_costs = true;
            for slot in tile.around {
                if slot != NONE {
                    self.tiles[slot as usize].stale_costs = true;
                }
            }
            self.mark_far_costs(slot as usize);
        }
    }

    /// Returns whether water was seen in a cell.
    pub fn is_water(&self, index: CellIndex) -> bool {
        let side = IVec2::splat(TILE);
        let index = IVec2::new(index.col, index.row);
        let cell = index.rem_euclid(side);
        self.tiles
            .slot_of(index.div_euclid(side))
            .is_some_and(|slot| self.tiles[slot as usize].water[cell.y as usize] >> cell.x & 1 == 1)
    }

    /// Returns whether a cell of the map is free and has an unknown cell beside, below or above it.
    pub fn is_frontier(&self, index: CellIndex) -> bool {
        let side = IVec2::splat(TILE);
        let index = IVec2::new(index.col, index.row);
        let cell = index.rem_euclid(side);
        self.tiles
            .slot_of(index.div_euclid(side))
            .is_some_and(|slot| self.frontier(slot as usize)[cell.y as usize] >> cell.x & 1 == 1)
    }

    /// Returns whether an occupied cell is known within a distance in metres of a point, to about a
    /// metre: a tile with an occupied cell counts as occupied at its centre.
    pub fn is_occupied_within(&self, p: DVec2, distance: f64) -> bool {
        let tile = f64::from(TILE) * RESOLUTION;
        let reach = DVec2::splat(distance.clamp(0.0, FARTHEST_LOOK));
        let (low, high) = ((p - reach) / tile, (p + reach) / tile);
        let (low, high) = (low.floor().as_ivec2(), high.floor().as_ivec2());
        let is_occupied = |at: IVec2| {
            let middle = (at.as_dvec2() + 0.5) * tile;
            middle.distance(p) <= distance
                && self.tiles.slot_of(at).is_some_and(|slot| self.tiles[slot as usize].has_occupied)
        };
        // In most cases a wall is near.
        is_occupied((p / tile).floor().as_ivec2())
            || (low.y..=high.y)
                .any(|row| (low.x..=high.x).any(|col| is_occupied(IVec2::new(col, row))))
    }

    /// Returns the number of frontier cells, for benchmarks and tests.
    #[doc(hidden)]
    pub fn frontier_len(&self) -> usize {
        let ones = |tile: &Tile| tile.frontier.iter().map(|row| row.count_ones()).sum::<u32>();
        self.tiles.iter().map(|tile| ones(tile) as usize).sum()
    }

    /// Derives everything that is not up to date, for benchmarks and tests. Otherwise a tile is derived
    /// when the cost of one of its cells is requested.
    #[doc(hidden)]
    pub fn derive_all(&mut self) {
        for slot in 0..self.tiles.len() {
            self.derive_costs(slot);
        }
    }

    /// Returns the planning cell that contains a point; `None` if the map has no tile there.
    pub fn node_at(&self, p: DVec2) -> Option<Node> {
        let cell = cell_of(p);
        let side = IVec2::splat(CELLS);
        let slot = self.tiles.slot_of(cell.div_euclid(side))?;
        Some(Node::at(slot as usize, cell.rem_euclid(side)))
    }

    /// The neighbour of a node in one of [`STEPS`].
    #[inline]
    pub(super) fn step(&self, node: Node, direction: usize) -> Option<Node> {
        let cell = node.cell() + STEPS[direction];
        let inside = |v: i32| (0..CELLS).contains(&v);
        if inside(cell.x) && inside(cell.y) {
            return Some(Node::at(node.slot(), cell));
        }
        let over = IVec2::new(cell.x.div_euclid(CELLS), cell.y.div_euclid(CELLS));
        let slot = self.tiles[node.slot()].around[step_index(over)];
        (slot != NONE).then(|| Node::at(slot as usize, cell.rem_euclid(IVec2::splat(CELLS))))
    }

    /// Column and row of a node.
    #[inline]
    pub(super) fn place(&self, node: Node) -> IVec2 {
        self.tiles[node.slot()].at * CELLS + node.cell()
    }

    /// Returns a node's cost, which is derived if needed.
    pub(super) fn cell_cost(&mut self, node: Node) -> CellCost {
        self.derive_costs(node.slot());
        self.derived_cell_cost(node)
    }

    /// Returns a node's cost in a tile that is up to date.
    #[inline]
    pub(super) fn derived_cell_cost(&self, node: Node) -> CellCost {
        CellCost::of(self.costs[node.0 as usize])
    }

    /// The point of a node to drive through, which is the centre of the best of its four cells.
    pub(super) fn point(&self, node: Node) -> DVec2 {
        let low = self.place(node).as_dvec2() * SIDE;
        let best = self.costs[node.0 as usize] >> 4;
        let mut sum = DVec2::ZERO;
        let mut count = 0.0;
        for cell in 0..4 {
            if best >> cell & 1 == 1 {
                sum += DVec2::new(f64::from(cell & 1), f64::from(cell >> 1)) + 0.5;
                count += 1.0;
            }
        }
        low + if count > 0.0 { sum / count * RESOLUTION } else { DVec2::splat(RESOLUTION) }
    }

    /// Number of tiles.
    pub(super) fn tiles(&self) -> usize {
        self.tiles.len()
    }

    /// A tile's frontier cells.
    pub(super) fn frontier(&self, slot: usize) -> &Bits {
        &self.tiles[slot].frontier
    }

    /// The slot of a tile's neighbour in one of [`STEPS`].
    pub(super) fn beside(&self, slot: usize, direction: usize) -> Option<usize> {
        let slot = self.tiles[slot].around[direction];
        (slot != NONE).then_some(slot as usize)
    }

    /// Column and row of a tile.
    pub(super) fn tile_at(&self, slot: usize) -> IVec2 {
        self.tiles[slot].at
    }

    fn slot_or_new(&mut self, at: IVec2) -> usize {
        if let Some(slot) = self.tiles.slot_of(at) {
            return slot as usize;
        }
        let slot = self.tiles.add(at);
        self.costs.resize(self.costs.len() + NODES, CellCost::Unknown as u8);
        slot
    }

    /// Sets a tile's cells, and marks what depends on those that changed.
    fn write(&mut self, slot: usize, occupied: Bits, free: Bits) {
        let tile = &mut self.tiles[slot];
        let (mut rows, mut cols) = (0_u32, 0_u32);
        let (mut known_rows, mut known_cols) = (0_u32, 0_u32);
        for row in 0..TILE as usize {
            let changed = tile.occupied[row] ^ occupied[row];
            rows |= u32::from(changed != 0) << row;
            cols |= changed;
            let changed = changed | (tile.free[row] ^ free[row]);
            known_rows |= u32::from(changed != 0) << row;
            known_cols |= changed;
        }
        if known_rows == 0 {
            return;
        }
        (tile.occupied, tile.free) = (occupied, free);
        tile.has_occupied = occupied.iter().any(|&row| row != 0);
        tile.stale_costs = true;
        let around = tile.around;
        self.mark_frontier(slot as u32);
        // A change affects the tiles around that are within a margin of it.
        let reaches = |changed: u32, step: i32, margin: i32| match step {
            1 => changed >> (TILE - margin) != 0,
            -1 => changed << (TILE - margin) != 0,
            _ => changed != 0,
        };
        for (direction, step) in STEPS.into_iter().enumerate() {
            if around[direction] == NONE {
                continue;
            }
            if reaches(known_cols, step.x, 3) && reaches(known_rows, step.y, 3) {
                self.mark_frontier(around[direction]);
            }
            let margin = self.inflation.margin.min(TILE);
            if reaches(cols, step.x, margin) && reaches(rows, step.y, margin) {
                self.tiles[around[direction] as usize].stale_costs = true;
            }
        }
        if rows != 0 {
            self.mark_far_costs(slot);
        }
    }

    /// Marks the tiles beyond the neighbours of a changed tile, if the robot is so large that their
    /// costs depend on it.
    fn mark_far_costs(&mut self, slot: usize) {
        if self.inflation.margin <= TILE {
            return;
        }
        let at = self.tiles[slot].at;
        for y in -2..=2 {
            for x in -2..=2 {
                if let Some(slot) = self.tiles.slot_of(at + IVec2::new(x, y)) {
                    self.tiles[slot as usize].stale_costs = true;
                }
            }
        }
    }

    fn mark_frontier(&mut self, slot: u32) {
        let tile = &mut self.tiles[slot as usize];
        if !tile.stale_frontier {
            tile.stale_frontier = true;
            self.stale.push(slot);
        }
    }

    /// Finds the free cells beside unknown ones. Where less than 3 x 3 cells are unknown together,
    /// there is nothing to discover: walls that are seen at a small angle have such gaps.
    fn derive_frontier(&mut self, slot: usize) {
        const ROWS: usize = TILE as usize + 6;
        let wide = |bits: u64| (bits & bits << 1 & bits >> 1, bits | bits << 1 | bits >> 1);
        // From three rows below the tile to three above it.
        let unknown: [u64; ROWS] = std::array::from_fn(|row| {
            self.tiles.wide_row(slot, row as i32 - 3, u32::MAX, |tile, row| {
                !(tile.free[row] | tile.occupied[row])
            })
        });
        let three = |rows: &[u64; ROWS], row: usize| {
            [row.saturating_sub(1), row, (row + 1).min(ROWS - 1)].map(|row| rows[row])
        };
        let core = std::array::from_fn(|row| {
            three(&unknown, row).map(|bits| wide(bits).0).into_iter().fold(u64::MAX, |a, b| a & b)
        });
        let opened: [u64; ROWS] = std::array::from_fn(|row| {
            three(&core, row).map(|bits| wide(bits).1).into_iter().fold(0, |a, b| a | b)
        });
        let tile = &mut self.tiles[slot];
        for row in 0..TILE as usize {
            let [below, here, above] = [row + 2, row + 3, row + 4].map(|row| opened[row]);
            let beside = (below | above | here << 1 | here >> 1) >> 16;
            tile.frontier[row] = tile.free[row] & beside as u32;
        }
        tile.stale_frontier = false;
    }

    /// Derives a tile's costs if something has changed.
    #[inline]
    pub(super) fn derive_costs(&mut self, slot: usize) {
        if self.tiles[slot].stale_costs {
            self.inflate(slot);
        }
    }

    /// Inflates occupied cells and water in and around a tile by the discs of all levels at once. A
    /// number holds a row of cells: the tile's and those on either side.
    fn spread<R: Row>(&self, slot: usize) -> [[u32; TILE as usize]; LEVELS] {
        let Inflation { margin, half_widths, .. } = &self.inflation;
        let mut near = [[0_u32; TILE as usize]; LEVELS];
        for row in -margin..TILE + margin {
            let mut bits = R::solid(&self.tiles, slot, row);
            if bits == R::default() {
                continue;
            }
            let mut spread = [0_u32; MOST + 1];
            for width in &mut spread[..=*margin as usize] {
                *width = bits.middle();
                bits = bits.widened();
            }
            for (level, near) in near.iter_mut().enumerate() {
                for (dy, &width) in half_widths[level].iter().enumerate() {
                    if width < 0 {
                        break;
                    }
                    for target in [row + dy as i32, row - dy as i32] {
                        if (0..TILE).contains(&target) {
                            near[target as usize] |= spread[width as usize];
                        }
                    }
                }
            }
        }
        near
    }

    /// Derives a tile's costs.
    fn inflate(&mut self, slot: usize) {
        let near = if self.inflation.margin <= u64::SIDE {
            self.spread::<u64>(slot)
        } else {
            self.spread::<u128>(slot)
        };
        let tile = &mut self.tiles[slot];
        tile.stale_costs = false;
        let costs = &mut self.costs[slot * NODES..(slot + 1) * NODES];
        for row in 0..CELLS as usize {
            let rows = [2 * row, 2 * row + 1];
            let free = near.map(|near| rows.map(|row| tile.free[row] & !near[row]));
            let occupied = rows.map(|row| tile.occupied[row] | tile.water[row]);
            let inflated = rows.map(|row| near[0][row] | tile.free[row]);
            for col in 0..CELLS as usize {
                let four = |rows: [u32; 2]| {
                    (rows[0] >> (2 * col) & 3 | (rows[1] >> (2 * col) & 3) << 2) as u8
                };
                let packed = |cost: CellCost, best: u8| cost as u8 | best << 4;
                costs[row * CELLS as usize + col] = if four(free[0]) == 0 {
                    if four(occupied) != 0 {
                        packed(CellCost::Occupied, 0)
                    } else if four(inflated) != 0 {
                        packed(CellCost::Inflated, 0)
                    } else {
                        packed(CellCost::Unknown, 0)
                    }
                } else if four(free[1]) == 0 {
                    packed(CellCost::Squeeze, four(free[0]))
                } else if four(free[2]) == 0 {
                    packed(CellCost::Tight, four(free[1]))
                } else if four(free[3]) == 0 {
                    packed(CellCost::Close, four(free[2]))
                } else if four(free[4]) == 0 {
                    packed(CellCost::Near, four(free[3]))
                } else {
                    packed(CellCost::Open, four(free[4]))
                };
            }
        }
    }
}

/// Column and row of the planning cell that contains a point.
pub(super) fn cell_of(p: DVec2) -> IVec2 {
    let index = CellIndex::of(p);
    IVec2::new(index.col.div_euclid(2), index.row.div_euclid(2))
}

/// The index of a step in [`STEPS`].
pub(super) fn step_index(step: IVec2) -> usize {
    const PLACES: [[usize; 3]; 3] = [[5, 6, 7], [4, 0, 0], [3, 2, 1]];
    PLACES[(step.y + 1) as usize][(step.x + 1) as usize]
}

/// A bit for each occupied and each free cell.
fn bits(cells: &[i16]) -> (Bits, Bits) {
    let (mut occupied, mut free) = ([0; TILE as usize], [0; TILE as usize]);
    for (row, cells) in cells.chunks_exact(TILE as usize).enumerate().take(TILE as usize) {
        let (eights, _) = cells.as_chunks::<8>();
        for (byte, cells) in eights.iter().enumerate() {
            let pack = |is: fn(i16) -> bool| {
                let mut ones = [0_u8; 8];
                for i in 0..8 {
                    ones[i] = u8::from(is(cells[i]));
                }
                // Gathers the lowest bit of each byte into the highest byte.
                (u64::from_le_bytes(ones).wrapping_mul(0x0102_0408_1020_4080) >> 56) as u32
            };
            occupied[row] |= pack(|odds| odds > DECIDED) << (8 * byte);
            free[row] |= pack(|odds| odds < -DECIDED) << (8 * byte);
        }
    }
    (occupied, free)
}
