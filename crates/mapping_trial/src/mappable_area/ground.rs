//! Where a disc touches a solid or cannot drive.

use envgen::World;
use envgen::clearance_index::ClearanceIndex;
use envgen::geometry::{Shape, edges};
use envgen::occupancy::{Coverage, OccupancyGrid};
use envgen::surface_index::SurfaceIndex;
use envgen::world::{Extent, Solid};
use glam::DVec2;

use super::frame::{SCORE_CELL, ScoreFrame};

/// Solid parts, and ground that a robot's centre must not be on, on a grid.
#[derive(Clone, Debug)]
pub(super) struct DiscGround {
    frame: ScoreFrame,
    /// The cells inside the world's bounds that no solid part enters.
    open: Vec<bool>,
    /// The cells that no water and no ground of speed 0 enters.
    dry: Vec<bool>,
    near: ClearanceIndex,
    grounds: SurfaceIndex,
}

impl DiscGround {
    /// Indexes a world for distances up to `reach` metres to what is within a body's height. `None` if
    /// there are too many cells, or if the reach is not a distance.
    pub(super) fn new(world: &World, frame: ScoreFrame, reach: f64, body: Extent) -> Option<Self> {
        let mut wet = OccupancyGrid::empty(frame.area(), SCORE_CELL).ok()?;
        let barred = |shape: &Shape| occupy_entered(&mut wet, shape);
        let surfaces = world.surfaces.iter().filter(|surface| surface.is_barrier());
        surfaces.map(|surface| &surface.shape).for_each(barred);
        Some(DiscGround {
            frame,
            open: open_cells(world, frame, world.solids_within(body))?,
            dry: wet.cells().iter().map(|wet| !wet).collect(),
            near: ClearanceIndex::within(world, reach, body).ok()?,
            grounds: SurfaceIndex::new(world),
        })
    }

    pub(super) fn frame(&self) -> ScoreFrame {
        self.frame
    }

    /// Whether a cell lies inside the world's bounds and no solid part enters it.
    pub(super) fn is_open(&self, cell: usize) -> bool {
        self.open[cell]
    }

    /// Whether no water and no ground of speed 0 enters a cell.
    pub(super) fn is_dry_cell(&self, cell: usize) -> bool {
        self.dry[cell]
    }

    /// Whether a robot can drive with its centre at a point.
    pub(super) fn is_dry(&self, p: DVec2) -> bool {
        !self.grounds.at(p).is_barrier()
    }

    /// The distance up to which clearances are known, in metres.
    pub(super) fn reach(&self) -> f64 {
        self.near.reach()
    }

    /// Distance in metres to the nearest solid part, infinite beyond the reach.
    pub(super) fn clearance(&self, p: DVec2) -> f64 {
        self.near.clearance(p)
    }

    /// How far in metres a disc is from the nearest solid part, infinite beyond the reach; negative
    /// where it touches one, leaves the world or cannot drive.
    pub(super) fn room(&self, p: DVec2, radius: f64) -> f64 {
        match self.frame.cell_at(p) {
            Some(cell) if self.open[cell] && (self.dry[cell] || self.is_dry(p)) => {
                self.clearance(p) - radius
            }
            _ => -radius,
        }
    }
}

/// The cells inside the world's bounds that none of the given solid parts enters; `None` if there are
/// too many cells.
pub(super) fn open_cells<'a>(
    world: &World,
    frame: ScoreFrame,
    solids: impl Iterator<Item = Solid<'a>>,
) -> Option<Vec<bool>> {
    let mut grid = OccupancyGrid::empty(frame.area(), SCORE_CELL).ok()?;
    solids.for_each(|part| occupy_entered(&mut grid, &part.shape));
    let inside = |cell| world.bounds.contains(frame.centre(cell));
    Some((0..frame.len()).map(|cell| !grid.cells()[cell] && inside(cell)).collect())
}

/// Depth in metres to which a filled shape must reach into a cell to enter it, so that a wall along the
/// line between two cells is in one of them.
const DEPTH: f64 = 1e-6;

/// Occupies the cells that a shape enters. A line between two cells enters both.
fn occupy_entered(grid: &mut OccupancyGrid, shape: &Shape) {
    let shrunk = match shape {
        Shape::Segment { .. } => shape.clone(),
        Shape::Disc { center, radius } => {
            Shape::Disc { center: *center, radius: (radius - DEPTH).max(0.5 * radius) }
        }
        Shape::Box { center, half_size, heading } => {
            let half_size = (*half_size - DEPTH).max(0.5 * *half_size);
            Shape::Box { center: *center, half_size, heading: *heading }
        }
        Shape::Polygon { vertices } => {
            for (a, b) in edges(vertices) {
                // Polygons run counter-clockwise: their inside is on the left.
                let along = (b - a).normalize_or_zero() * DEPTH.min(0.25 * a.distance(b));
                let inside = along.perp();
                let inner = Shape::Segment { a: a + along + inside, b: b - along + inside };
                grid.occupy(&inner, Coverage::Conservative);
            }
            return grid.occupy(shape, Coverage::Centre);
        }
    };
    grid.occupy(&shrunk, Coverage::Conservative);
}
