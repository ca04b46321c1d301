//! The space of a robot's centre, on a grid.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec2;

use super::error::DifficultyError;
use super::limits::{MAX_CELL, MAX_CELLS, MAX_READS};
use super::platform::MARGIN;
use crate::clearance_index::{ClearanceIndex, Room};
use crate::geometry::Shape;
use crate::grid::GridFrame;
use crate::surface_index::{Ground, SurfaceIndex, ground_raster};
use crate::world::{ClassRaster, World};

/// Side of a cell in metres, unless the world is too large for it.
pub const CELL: f64 = 0.2;

/// The greatest clearance that is measured, in metres, unless the robot keeps a greater distance from solids. Greater
/// clearances count as the greatest.
const SIGHT_OF_SOLIDS: f64 = 1.5;

/// Number of cells per solid of the indices of solids, and number of cells in which a solid may be listed. There
/// are so many queries that fine cells are worthwhile.
const INDEX: (f64, usize) = (10.0, 200);

/// If there are many solids, each is listed in fewer cells, so that the lists of an index take about 64 MiB, but in
/// no fewer cells than the second number.
const LISTINGS: (usize, usize) = (1 << 24, 24);

/// Number of rounds in which a point of a cell is searched whose centre is too near to a solid: the best of nine
/// points, then of nine points around it, and once more. Three rounds end within a hundredth of a cell.
const ROUNDS: usize = 3;

/// The eight neighbours of a cell, counter-clockwise from the right.
pub(super) const STEPS: [(isize, isize); 8] =
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// The free cells of a grid over a world, the cells that the robot reaches, and the moves between them.
///
/// A cell is free if it contains a point at which the robot's centre can be. This is the cell's centre or, if that
/// is too near to a solid, the point of greatest clearance in the cell. A robot moves from cell to cell in a
/// straight line between these points, so that passages narrower than a cell are found.
pub(super) struct Space<'a> {
    pub(super) frame: GridFrame,
    /// The distance that the robot's centre keeps from solids, in metres.
    pub(super) footprint: f64,
    /// The point of each cell.
    pub(super) points: Vec<DVec2>,
    /// Clearance of each point in metres, at most the greatest that is measured; 0 for cells that are not free.
    pub(super) clearance: Vec<f64>,
    /// For each cell the possible moves, with bit i for the move to neighbour i of [`STEPS`].
    moves: Vec<u8>,
    /// Offsets from the index of a cell to those of its neighbours.
    offsets: [isize; 8],
    /// Whether the robot reaches a cell.
    pub(super) reached: Vec<bool>,
    /// The cell in which the robot starts.
    pub(super) start: usize,
    /// Number of cells that the robot reaches.
    pub(super) count: usize,
    finder: Finder<'a>,
}

impl<'a> Space<'a> {
    /// Finds the cells that a robot reaches from the world's start; without a start, those of the largest connected
    /// region, from its cell of greatest clearance.
    pub(super) fn new(world: &'a World, footprint: f64) -> Result<Self, DifficultyError> {
        let frame = frame(world)?;
        let finder = Finder::new(world, footprint, frame.cell_size)?;
        let half_diagonal = frame.cell_size * std::f64::consts::FRAC_1_SQRT_2;
        let mut points = Vec::with_capacity(frame.len());
        let mut clearance = Vec::with_capacity(frame.len());
        for row in 0..frame.rows {
            // The clearance changes by no more than the distance.
            let mut most = f64::INFINITY;
            for col in 0..frame.cols {
                let center = frame.center(col, row);
                most += frame.cell_size;
                if most + half_diagonal < footprint {
                    points.push(center);
                    clearance.push(0.0);
                    continue;
                }
                let (point, room) = finder.best_point(center, frame.cell_size, &mut most);
                points.push(point);
                clearance.push(room);
            }
        }
        let moves = moves(frame, &points, &clearance, &finder);
        finder.check_reads()?;
        let mut space = Space {
            frame,
            footprint,
            points,
            clearance,
            moves,
            offsets: STEPS.map(|(x, y)| y * frame.cols as isize + x),
            reached: vec![false; frame.len()],
            start: 0,
            count: 0,
            finder,
        };
        match world.start {
            Some(start) => {
                let (p, radius) = (start.position, footprint);
                let error = DifficultyError::Start { x: p.x, y: p.y, radius };
                let fits = space.fits(p);
                space.start = space.cell_near(p).filter(|_| fits).ok_or(error)?;
                space.count = space.flood(space.start).len();
            }
            None => space.reach_the_largest_region()?,
        }
        Ok(space)
    }

    /// Returns the moves of a robot from a cell: the number of the neighbour in [`STEPS`], and the cell there.
    pub(super) fn neighbours(&self, cell: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let mut moves = self.moves[cell];
        std::iter::from_fn(move || {
            let bit = moves.trailing_zeros() as usize;
            // The lowest bit is taken away.
            moves &= moves.wrapping_sub(1);
            (bit < STEPS.len()).then(|| (bit, cell.wrapping_add_signed(self.offsets[bit])))
        })
    }

    /// Returns the cells that a robot reaches, in order.
    pub(super) fn cells(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.reached.len()).filter(|&cell| self.reached[cell])
    }

    /// Returns the area of a cell in square metres.
    pub(super) fn cell_area(&self) -> f64 {
        self.frame.cell_size * self.frame.cell_size
    }

    /// Returns the free cell around a point, or beside it, whose own point is nearest.
    fn cell_near(&self, p: DVec2) -> Option<usize> {
        let cell = self.frame.index_at(p).or_else(|| {
            // The upper right borders of the bounds belong to no cell.
            self.frame.index_at(p - 0.5 * self.frame.cell_size)
        })?;
        let beside = STEPS.iter().filter_map(|&(x, y)| self.frame.neighbour(cell, x, y));
        let near = std::iter::once(cell).chain(beside).filter(|&cell| self.is_free(cell));
        let distance = |cell: &usize| self.points[*cell].distance_squared(p);
        near.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// Whether the robot's centre can be at a point.
    fn fits(&self, p: DVec2) -> bool {
        self.finder.clearance(p) + MARGIN >= self.footprint && self.finder.is_ground(p)
    }

    /// Returns the reached cell from which a robot can move to a point; `None` if it does not fit there.
    pub(super) fn cell_to(&self, p: DVec2) -> Option<usize> {
        self.reached_near(p).filter(|_| self.fits(p))
    }

    /// Returns the reached cell around a point, or beside it.
    pub(super) fn reached_near(&self, p: DVec2) -> Option<usize> {
        self.cell_near(p).filter(|&cell| self.reached[cell])
    }

    /// Returns the distance from a point to the nearest solid in metres, at most the greatest that is measured.
    pub(super) fn clearance_at(&self, p: DVec2) -> f64 {
        self.finder.clearance(p)
    }

    /// Returns the least clearance in metres on the move from a cell to a neighbour, measured at nine points.
    pub(super) fn least_clearance(&self, from: usize, to: usize) -> f64 {
        let (a, b) = (self.points[from], self.points[to]);
        let points = (0..=8).map(|part| a + (b - a) * (f64::from(part) / 8.0));
        points.map(|p| self.clearance_at(p)).fold(f64::INFINITY, f64::min).max(self.footprint)
    }

    /// Whether the robot's centre can move in a straight line between two points where it can be.
    pub(super) fn is_clear(&self, a: DVec2, b: DVec2) -> bool {
        let room = |p: DVec2| self.finder.near_clearance(p);
        self.finder.is_clear(a, room(a), b, room(b))
    }

    /// Returns the cells that a robot reaches, sorted by falling clearance. Of equal ones, the first comes first.
    pub(super) fn by_clearance(&self) -> Vec<usize> {
        let mut cells: Vec<usize> = self.cells().collect();
        cells.sort_by(|&a, &b| self.clearance[b].total_cmp(&self.clearance[a]));
        cells
    }

    /// Returns an error if [`MAX_READS`] are used up, because clearances are wrong from then on.
    pub(super) fn check_reads(&self) -> Result<(), DifficultyError> {
        self.finder.check_reads()
    }

    pub(super) fn is_free(&self, cell: usize) -> bool {
        self.clearance[cell] > 0.0
    }

    /// Marks the cells that are connected to a cell as reached, and returns them.
    fn flood(&mut self, first: usize) -> Vec<usize> {
        self.reached[first] = true;
        // The list of cells serves as the queue.
        let mut cells = vec![first];
        let mut next = 0;
        while let Some(&cell) = cells.get(next) {
            next += 1;
            let moves = self.moves[cell];
            for (bit, offset) in self.offsets.into_iter().enumerate() {
                let other = cell.wrapping_add_signed(offset);
                if moves >> bit & 1 == 1 && !std::mem::replace(&mut self.reached[other], true) {
                    cells.push(other);
                }
            }
        }
        cells
    }

    fn reach_the_largest_region(&mut self) -> Result<(), DifficultyError> {
        let mut largest = Vec::new();
        for cell in 0..self.frame.len() {
            if self.is_free(cell) && !self.reached[cell] {
                let region = self.flood(cell);
                if region.len() > largest.len() {
                    largest = region;
                }
            }
        }
        largest.sort_unstable();
        let better = |a: usize, b: usize| if self.clearance[b] > self.clearance[a] { b } else { a };
        let Some(start) = largest.iter().copied().reduce(better) else {
            return Err(DifficultyError::NoGround { radius: self.footprint });
        };
        self.reached.fill(false);
        largest.iter().for_each(|&cell| self.reached[cell] = true);
        (self.start, self.count) = (start, largest.len());
        Ok(())
    }
}

/// Returns a frame of cells over the world's bounds: of [`CELL`], or larger ones up to [`MAX_CELL`], but at most
/// [`MAX_CELLS`] of them.
fn frame(world: &World) -> Result<GridFrame, DifficultyError> {
    let size = world.bounds.size();
    let cells = |side: f64| (size / side - 1e-9).ceil().max(DVec2::ONE);
    let mut side = CELL.max((size.x * size.y / MAX_CELLS as f64).sqrt());
    // A long strip has at least one row of cells; sides that are rounded up make more than the area has.
    side = side.max(size.max_element() / MAX_CELLS as f64);
    while cells(side).x * cells(side).y > MAX_CELLS as f64 {
        side *= 1.01;
    }
    if side > MAX_CELL {
        return Err(DifficultyError::TooLarge { width: size.x, height: size.y });
    }
    let count = cells(side);
    let (cols, rows) = (count.x as usize, count.y as usize);
    Ok(GridFrame { origin: world.bounds.min, cell_size: side, cols, rows })
}

/// Finds points at which a robot's centre can be.
struct Finder<'a> {
    world: &'a World,
    footprint: f64,
    /// An index for clearances up to the greatest that is measured.
    far: ClearanceIndex,
    /// An index for the many queries of points near solids.
    near: ClearanceIndex,
    /// An index of the ground on which the robot cannot drive, if there is any.
    grounds: Option<SurfaceIndex>,
    /// Number of distances to solids that were computed, of [`MAX_READS`].
    reads: AtomicUsize,
}

impl<'a> Finder<'a> {
    fn new(world: &'a World, footprint: f64, side: f64) -> Result<Self, DifficultyError> {
        let shapes: usize = world
            .solids()
            .map(|solid| match &*solid.shape {
                // Their sides are listed on their own.
                Shape::Polygon { vertices } => vertices.len() + 1,
                _ => 1,
            })
            .sum();
        let listings = (LISTINGS.0 / shapes.max(1)).clamp(LISTINGS.1, INDEX.1);
        let index = |reach| ClearanceIndex::with_density(world, reach, INDEX.0, listings);
        Ok(Finder {
            world,
            footprint,
            far: index(SIGHT_OF_SOLIDS.max(footprint))?,
            near: index(footprint + side)?,
            grounds: has_bad_ground(world).then(|| SurfaceIndex::of(world, Ground::is_barrier)),
            reads: AtomicUsize::new(0),
        })
    }

    /// Returns the point of the cell around `center`, and its clearance, which is 0 if the robot cannot be there.
    /// Sets `most` to the clearance of the centre, up to the reach of `far`.
    fn best_point(&self, center: DVec2, side: f64, most: &mut f64) -> (DVec2, f64) {
        let reach = self.far.reach();
        let Room { clearance: room, mut nearest, .. } = self.room(center);
        *most = if room < reach { room } else { f64::INFINITY };
        if room >= self.footprint + 0.25 * side && self.is_ground(center) {
            return (center, room);
        }
        let (mut best, mut best_room) = (center, if self.is_ground(center) { room } else { 0.0 });
        let (mut middle, mut middle_room, mut step) = (center, room, side / 3.0);
        for _ in 0..ROUNDS {
            // Nothing in the square of the next points is farther from solids than this.
            if middle_room + 1.5 * step * std::f64::consts::SQRT_2 < self.footprint {
                break;
            }
            let around = middle;
            for (x, y) in STEPS {
                let p = around + DVec2::new(x as f64, y as f64) * step;
                // No point is farther from solids than from any one of them.
                let most = nearest.map_or(reach, |shape| self.distance(p, shape));
                if most <= middle_room && (most <= best_room || most < self.footprint) {
                    continue;
                }
                let found = self.read(&self.near, p);
                let room = found.clearance.min(self.near.reach()).min(reach);
                if room > middle_room {
                    (middle, middle_room, nearest) = (p, room, found.nearest.or(nearest));
                }
                if room > best_room && room >= self.footprint && self.is_ground(p) {
                    (best, best_room) = (p, room);
                }
            }
            if middle == around && best_room >= self.footprint {
                break;
            }
            step /= 3.0;
        }
        (best, if best_room >= self.footprint { best_room } else { 0.0 })
    }

    /// Returns the clearance at a point, at most the reach of `far`, and the nearest solid.
    fn room(&self, p: DVec2) -> Room {
        let near = self.read(&self.near, p);
        let room = if near.nearest.is_some() { near } else { self.read(&self.far, p) };
        Room { clearance: room.clearance.min(self.far.reach()), ..room }
    }

    /// Returns the distance to the nearest solid in metres, at most the reach of `far`.
    fn clearance(&self, p: DVec2) -> f64 {
        self.room(p).clearance
    }

    /// Returns the distance to the nearest solid in metres, at most the reach of `near`.
    fn near_clearance(&self, p: DVec2) -> f64 {
        self.read(&self.near, p).clearance.min(self.near.reach())
    }

    /// Queries an index. Once [`MAX_READS`] are used up, the clearance is 0, which ends every search.
    fn read(&self, index: &ClearanceIndex, p: DVec2) -> Room {
        if self.reads.load(Ordering::Relaxed) > MAX_READS {
            return Room { clearance: 0.0, nearest: None, cost: 0 };
        }
        let room = index.room(p);
        self.reads.fetch_add(1 + room.cost, Ordering::Relaxed);
        room
    }

    /// Returns the distance in metres to a solid that was the nearest one of a point nearby.
    fn distance(&self, p: DVec2, shape: u32) -> f64 {
        let (distance, cost) = self.near.distance(p, shape);
        self.reads.fetch_add(cost, Ordering::Relaxed);
        distance
    }

    fn check_reads(&self) -> Result<(), DifficultyError> {
        let reads = self.reads.load(Ordering::Relaxed);
        if reads > MAX_READS { Err(DifficultyError::TooDense) } else { Ok(()) }
    }

    /// Whether a robot can drive on the ground at a point.
    fn is_ground(&self, p: DVec2) -> bool {
        let is_good = |grounds: &SurfaceIndex| !grounds.at(p).is_barrier();
        self.world.bounds.contains(p) && self.grounds.as_ref().is_none_or(is_good)
    }

    /// Whether a robot can move in a straight line between two points of known clearance.
    fn is_clear(&self, a: DVec2, room_a: f64, b: DVec2, room_b: f64) -> bool {
        self.is_off_solids(a, room_a, b, room_b) && self.is_ground_along(a, b)
    }

    /// Whether a robot can drive everywhere between two points.
    fn is_ground_along(&self, a: DVec2, b: DVec2) -> bool {
        let Some(grounds) = &self.grounds else { return true };
        let (meets, cost) = grounds.barrier_along(a, b);
        self.reads.fetch_add(cost, Ordering::Relaxed);
        !meets
    }

    /// Whether a robot does not touch solids between two points of known clearance. Between points half a footprint
    /// apart, it comes nearer to a convex solid by at most 1/32 of its footprint.
    fn is_off_solids(&self, a: DVec2, room_a: f64, b: DVec2, room_b: f64) -> bool {
        let length = a.distance(b);
        if room_a + room_b - length >= 2.0 * self.footprint || length <= 0.5 * self.footprint {
            return true;
        }
        let middle = 0.5 * (a + b);
        let room = self.near_clearance(middle);
        room >= self.footprint
            && self.is_off_solids(a, room_a, middle, room)
            && self.is_off_solids(middle, room, b, room_b)
    }
}

/// Whether there is ground on which no robot can drive.
fn has_bad_ground(world: &World) -> bool {
    // A class without a speed has one, too: no data cannot be passed.
    let is_blocked =
        |raster: &ClassRaster| raster.cells.iter().any(|&class| raster.speed_of(class) <= 0.0);
    ground_raster(world).is_some_and(is_blocked)
        || world.surfaces.iter().map(Ground::from).any(Ground::is_barrier)
}

/// Returns the possible moves of each cell to its neighbours.
fn moves(frame: GridFrame, points: &[DVec2], clearance: &[f64], finder: &Finder<'_>) -> Vec<u8> {
    let mut moves = vec![0_u8; frame.len()];
    for cell in (0..frame.len()).filter(|&cell| clearance[cell] > 0.0) {
        for (bit, &(x, y)) in STEPS.iter().enumerate().take(4) {
            let Some(other) = frame.neighbour(cell, x, y) else { continue };
            if clearance[other] > 0.0
                && finder.is_clear(points[cell], clearance[cell], points[other], clearance[other])
            {
                moves[cell] |= 1 << bit;
                moves[other] |= 1 << (bit + 4);
            }
        }
    }
    moves
}
