//! Builds the world of a block field.

use glam::DVec2;

use super::blueprint::BlockField;
use crate::generate::Spec;
use crate::geometry::Pose;
use crate::landscape::outlines;
use crate::world::{Claim, ClassRaster, Obstacle, ObstacleKind, World};

/// The share of the distance guaranteed by the free cells that the promised disc takes.
const PROMISED: f64 = 0.9;

/// The class of filled cells in the raster from which outlines are made.
const FILLED: u16 = 2;

pub(super) fn world(field: &BlockField) -> World {
    let spec = field.spec();
    let raster = ClassRaster {
        rows: spec.rows as u32,
        cols: spec.cols as u32,
        cell: spec.cell_size,
        origin: DVec2::ZERO,
        cells: field.cells().iter().map(|&filled| if filled { FILLED } else { 1 }).collect(),
        speeds: Vec::new(),
    };
    let frame = raster.frame();
    let mut world = World::new(spec.provenance(field.seed()), frame.bounds());
    let blocks = outlines(&raster, |class| u16::from(class == FILLED)).into_iter();
    world.obstacles = blocks.map(|(_, shape)| Obstacle::new(ObstacleKind::Other, shape)).collect();
    let pose = |[row, col]: [u32; 2]| {
        let middle = frame.center(col as usize, frame.rows - 1 - row as usize);
        Pose { position: middle, heading: 0.0 }
    };
    world.start = field.start().map(pose);
    world.goal = field.goal().map(pose);
    if field.is_crossed {
        // Around the middle of a free cell this far is free, and between those of neighbours.
        let free = (spec.robot_cells as f64 + 0.5) * spec.cell_size;
        world.certificate = vec![Claim::Connected { radius: PROMISED * free }];
    }
    world
}
