//! Poses spread over the ground that a robot reaches, and the views of its laser from them.

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

/// Returns poses over the cells that a robot reaches: every n-th cell along a Z-order curve (G. M. Morton, 1966),
/// which visits squares one after the other, so that every part of the ground has its share. Headings cycle through
/// quarter turns.
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

/// Returns a number with a zero bit inserted between its bits.
fn spread(number: usize) -> u64 {
    (0..32).fold(0, |bits, i| bits | (number as u64 >> i & 1) << (2 * i))
}

/// The result of a beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Beam {
    /// There is a solid at this range in metres.
    Echo(f64),
    /// There is nothing up to the greatest range.
    Free,
    /// Nothing is known, because the beam ends at a part that is too dark to be seen from that distance. As in
    /// trials, it is not an echo, and it does not mean that its path is free.
    Lost,
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

    /// Scans from a pose of the robot. Calls `visit` with the laser's position, and the direction and the result of
    /// each beam.
    pub(super) fn scan(
        &self,
        pose: Pose,
        mut visit: impl FnMut(DVec2, DVec2, Beam),
    ) -> ScanInformation {
        let heading = unit_vector(pose.heading);
        let from = pose.position + heading * self.offset;
        let eye = self.rays.eye(from);
        let mut echoes = Echoes::default();
        for &direction in self.pattern.directions() {
            let direction = heading.rotate(direction);
            let beam = match eye.cast_surface(direction, self.max_range) {
                Some(met) if self.rays.is_unseen(met.hit) => Beam::Lost,
                Some(met) => {
                    echoes.add(direction * met.hit.distance, met.normal);
                    Beam::Echo(met.hit.distance)
                }
                None => Beam::Free,
            };
            visit(from, direction, beam);
        }
        echoes.information()
    }
}

/// The view of the laser from a pose.
#[derive(Clone, Debug)]
pub(super) struct View {
    pub(super) position: DVec2,
    pub(super) information: ScanInformation,
    /// Ranges in metres: the greatest range for beams without an echo, NaN for lost beams.
    pub(super) ranges: Vec<f64>,
    /// Number of beams with an echo, and the sum of their ranges in metres.
    pub(super) echoes: usize,
    pub(super) echo_ranges: f64,
    /// Number of lost beams.
    pub(super) lost: usize,
}

impl View {
    pub(super) fn new(laser: &Laser<'_>, pose: Pose) -> Self {
        let mut ranges = Vec::with_capacity(laser.pattern.len());
        let (mut echoes, mut echo_ranges, mut lost) = (0, 0.0, 0);
        let information = laser.scan(pose, |_, _, beam| {
            ranges.push(match beam {
                Beam::Echo(range) => {
                    echoes += 1;
                    echo_ranges += range;
                    range
                }
                Beam::Free => laser.max_range,
                Beam::Lost => {
                    lost += 1;
                    f64::NAN
                }
            });
        });
        View { position: pose.position, information, ranges, echoes, echo_ranges, lost }
    }
}
