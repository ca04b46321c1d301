//! The current scan: the fan of free space along its beams, and a point at every echo.

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use mapping_trial::lidar::{LaserProfile, NO_ECHO, Scan};

use super::shape::Sketch;

/// The colour factors of the fan and of its points, with their opacity.
const FAN: [f32; 4] = [1.0, 1.0, 1.0, 0.18];
const POINT: [f32; 4] = [1.0, 1.0, 1.0, 1.0];

/// Half the side of a point in metres.
const HALF: f32 = 0.035;

/// Creates a mesh for the scans of a laser, in the frame of the laser, with all beams of length 0. Its
/// vertices are the position of the laser, the end of each beam, and four vertices for the point of each
/// beam.
pub(super) fn fan(laser: &LaserProfile) -> Mesh {
    let beams = laser.beams as usize;
    let corners = 1 + 5 * beams;
    let mut colors = vec![FAN; 1 + beams];
    colors.resize(corners, POINT);
    let sweep = (1..beams as u32).flat_map(|beam| [0, beam, beam + 1]);
    let points = (0..beams as u32).flat_map(|beam| {
        let first = 1 + beams as u32 + 4 * beam;
        [0, 1, 2, 0, 2, 3].map(|corner| first + corner)
    });
    let triangles = sweep.chain(points).collect();
    Sketch { corners: vec![[0.0; 3]; corners], colors, triangles }.into_mesh()
}

/// Moves the vertices of a [`fan`] to the ranges of a scan. Ignored beams shrink to the position of the
/// laser, and beams without an echo have no point.
pub(super) fn spread(mesh: &mut Mesh, laser: &LaserProfile, scan: &Scan) {
    let Some(VertexAttributeValues::Float32x3(corners)) =
        mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION)
    else {
        return;
    };
    let beams = laser.beams as usize;
    let Some((ends, points)) = corners.get_mut(1..).and_then(|c| c.split_at_mut_checked(beams))
    else {
        return;
    };
    for (beam, (end, point)) in ends.iter_mut().zip(points.chunks_exact_mut(4)).enumerate() {
        let range = scan.ranges.get(beam).copied().unwrap_or(f64::NAN);
        let echo = range.is_finite();
        let reach = match range {
            NO_ECHO => laser.max_range,
            range if echo => range.max(0.0),
            _ => 0.0,
        };
        let tip = Vec2::from_angle(laser.angle(beam) as f32) * reach as f32;
        *end = [tip.x, tip.y, 0.0];
        let half = if echo { HALF } else { 0.0 };
        let signs = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        for (corner, (x, y)) in point.iter_mut().zip(signs) {
            *corner = [tip.x + x * half, tip.y + y * half, 0.0];
        }
    }
}
