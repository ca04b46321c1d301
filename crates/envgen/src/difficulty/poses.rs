//! Poses spread over the ground that a robot reaches, and what its laser sees from them.

use std::f64::consts::FRAC_PI_2;

use glam::DVec2;

use super::information::{Echoes, ScanInformation};
use super::platform::Platform;
use super::space::Space;
use crate::error::SpecError;
use crate::geometry::{Pose, unit_vector};
use crate::raycast::{Raycaster, ScanPattern};

/// Number of poses.
pub const POSES: usize = 160;

/// Poses over the cells that a robot reaches: every n-th cell along a Z-order curve (G. M. Morton, 1966),
/// which visits squares one after the other, so that every part of the ground has its share. Headings are
/// quarter turns one after the other.
pub(super) fn poses(space: &Space<'_>) -> Vec<Pose> {
    let mut cells: Vec<(u64, usize)> = space
        .cells()
        .map(|cell| {
            let (col, row) = space.frame.cell(cell);
            (spread(col) | spread(row) << 1, cell)
        })
        .collect();
    cells.sort_unstable();
    let pose = |i: usize| {
        let (_, cell) = cells[(2 * i + 1) * cells.len() / (2 * POSES)];
        Pose { position: space.points[cell], heading: FRAC_PI_2 * (i % 4) as f64 }
    };
    (0..POSES).filter(|_| !cells.is_empty()).map(pose).collect()
}

/// A number with a zero bit between its bits.
fn spread(number: usize) -> u64 {
    (0..32).fold(0, |bits, i| bits | (number as u64 >> i & 1) << (2 * i))
}

/// The laser of a platform in a world.
pub(super) struct Laser<'a> {
    rays: &'a Raycaster,
    pattern: ScanPattern,
    offset: f64,
    pub(super) max_range: f64,
}

impl<'a> Laser<'a> {
    pub(super) fn new(rays: &'a Raycaster, platform: &Platform) -> Result<Self, SpecError> {
        Ok(Laser {
            rays,
            pattern: platform.pattern()?,
            offset: platform.laser_offset,
            max_range: platform.max_range,
        })
    }

    /// Scans from a pose of the robot; calls `visit` with the laser's position, the direction of each beam
    /// and its range, the greatest range where it has no echo.
    pub(super) fn scan(
        &self,
        pose: Pose,
        mut visit: impl FnMut(DVec2, DVec2, Option<f64>),
    ) -> ScanInformation {
        let heading = unit_vector(pose.heading);
        let from = pose.position + heading * self.offset;
        let mut echoes = Echoes::default();
        for &direction in self.pattern.directions() {
            let direction = heading.rotate(direction);
            let met = self.rays.cast_surface(from, direction, self.max_range);
            if let Some(met) = met {
                echoes.add(direction * met.hit.distance, met.normal);
            }
            visit(from, direction, met.map(|met| met.hit.distance));
        }
        echoes.information()
    }
}

/// What the laser sees from a pose.
#[derive(Clone, Debug)]
pub(super) struct View {
    pub(super) position: DVec2,
    pub(super) information: ScanInformation,
    /// Ranges in metres, the greatest range where there is no echo.
    pub(super) ranges: Vec<f64>,
    /// Number of beams with an echo.
    pub(super) echoes: usize,
}

impl View {
    pub(super) fn new(laser: &Laser<'_>, pose: Pose) -> Self {
        let (mut ranges, mut echoes) = (Vec::with_capacity(laser.pattern.len()), 0);
        let information = laser.scan(pose, |_, _, range| {
            echoes += usize::from(range.is_some());
            ranges.push(range.unwrap_or(laser.max_range));
        });
        View { position: pose.position, information, ranges, echoes }
    }
}
