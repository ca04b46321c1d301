//! Where a disc touches a solid or cannot drive.

use envgen::World;
use envgen::clearance_index::ClearanceIndex;
use envgen::geometry::Shape;
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
        let barred = |shape: &Shape| wet.occupy(shape, Coverage::Entered);
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
    solids.for_each(|part| grid.occupy(&part.shape, Coverage::Entered));
    let inside = |cell| world.bounds.contains(frame.centre(cell));
    Some((0..frame.len()).map(|cell| !grid.cells()[cell] && inside(cell)).collect())
}
