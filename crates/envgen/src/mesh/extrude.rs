//! Extrusion of flat shapes to solids.

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};

use super::{Mesh, triangulate};
use crate::geometry::{Shape, regular_polygon, signed_area};
use crate::outline::outline;
use crate::world::{Extent, RoadMesh, RoadStrip};

/// The greatest deviation, in metres, of the edges of a road's mesh from the edges of the road.
const ROAD_TOLERANCE: f64 = 0.02;

/// The greatest distance, in metres, between ends of a road that join.
const JOINED: f64 = 1e-6;

/// Least distance in metres between cuts across a road.
const SHORTEST: f64 = 0.01;

/// Returns the surface of a road, as used by its mesh; `None` for a road without length.
pub(super) fn road_surface(strip: &RoadStrip) -> Option<RoadMesh> {
    let path = strip.path();
    let mut distances = path.stations(0.5 * strip.width, ROAD_TOLERANCE);
    let end = distances.last().copied()?;
    // Corners that are nearer would be one in files of single precision.
    distances.dedup_by(|next, kept| *next - *kept < SHORTEST);
    if let Some(last) = distances.last_mut().filter(|last| end - **last < SHORTEST) {
        *last = end;
    }
    Some(strip.mesh_at(&path, distances))
}

impl Mesh {
    /// Extrudes a shape from a bottom to a top. A disc gets flat sides with the normals of a cylinder, at most
    /// [`ROUNDNESS`](crate::outline::ROUNDNESS) inside it; a line is
    /// [`LINE_THICKNESS`](crate::pieces::LINE_THICKNESS) thick.
    ///
    /// Returns `None` for polygons that are not simple and counter-clockwise.
    pub fn extruded(shape: &Shape, extent: Extent) -> Option<Self> {
        let (pivot, outline) = outline(shape);
        let is_convex = !matches!(shape, Shape::Polygon { .. });
        let cover = if is_convex {
            (2..outline.len() as u32).map(|i| [0, i - 1, i]).collect()
        } else {
            triangulate(&outline)?
        };
        let sides = (0..outline.len() as u32).map(|i| [i, (i + 1) % outline.len() as u32]);
        let mut mesh = Mesh::empty(pivot);
        mesh.add_caps(&outline, &cover, extent);
        mesh.add_sides(&outline, sides, extent, matches!(shape, Shape::Disc { .. }));
        Some(mesh)
    }

    /// Extrudes a disc from a bottom to a top, with `sides` flat sides that have the normals of a cylinder. Numbers
    /// of sides below 3 are raised to 3.
    pub fn cylinder(center: DVec2, radius: f64, extent: Extent, sides: u32) -> Self {
        let sides = sides.max(3);
        let outline = regular_polygon(radius, sides as usize);
        let cover: Vec<[u32; 3]> = (2..sides).map(|i| [0, i - 1, i]).collect();
        let mut mesh = Mesh::empty(center);
        mesh.add_caps(&outline, &cover, extent);
        mesh.add_sides(&outline, (0..sides).map(|i| [i, (i + 1) % sides]), extent, true);
        mesh
    }

    /// Creates the mesh of a road; `None` if its edge crosses itself in a bend.
    pub(super) fn of_road(strip: &RoadStrip, extent: Extent) -> Option<Self> {
        let flat = road_surface(strip)?;
        let around = crate::geometry::Rect::around(flat.vertices.iter().copied())?;
        let pivot = around.center();
        let mut corners: Vec<DVec2> = flat.vertices.iter().map(|p| *p - pivot).collect();
        let mut cover = flat.triangles;
        let n = corners.len();
        // The end of a circuit joins its start.
        let joins = |i: usize| corners[n - 2 + i].distance(corners[i]) <= JOINED;
        if strip.closed && n > 6 && joins(0) && joins(1) {
            corners.truncate(n - 2);
            for corner in cover.iter_mut().flatten().filter(|corner| **corner as usize >= n - 2) {
                *corner -= n as u32 - 2;
            }
        }
        let is_upright = |t: &[u32; 3]| signed_area(&t.map(|i| corners[i as usize])) > 0.0;
        if !cover.iter().all(is_upright) {
            return None;
        }
        // The rims are the edges of one triangle alone.
        let edges = || cover.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let all: BTreeSet<[u32; 2]> = edges().collect();
        let rims = edges().filter(|&[a, b]| !all.contains(&[b, a]));
        let mut mesh = Mesh::empty(pivot);
        mesh.add_caps(&corners, &cover, extent);
        mesh.add_sides(&corners, rims, extent, false);
        Some(mesh)
    }

    /// Adds the top, and the bottom, which is seen from below.
    fn add_caps(&mut self, corners: &[DVec2], cover: &[[u32; 3]], extent: Extent) {
        for (height, up) in [(extent.top(), 1.0), (extent.bottom(), -1.0)] {
            let first = self.positions.len() as u32;
            for corner in corners {
                self.push(
                    corner.extend(height),
                    DVec3::new(0.0, 0.0, up),
                    DVec2::new(corner.x, up * corner.y),
                );
            }
            let turned =
                cover.iter().map(|&[a, b, c]| if up > 0.0 { [a, b, c] } else { [a, c, b] });
            self.triangles.extend(turned.map(|corners| corners.map(|i| first + i)));
        }
    }

    /// Adds the sides over edges that have the inside to their left.
    fn add_sides(
        &mut self,
        corners: &[DVec2],
        edges: impl Iterator<Item = [u32; 2]>,
        extent: Extent,
        is_round: bool,
    ) {
        let mut along = 0.0;
        for [a, b] in edges.map(|edge| edge.map(|i| corners[i as usize])) {
            let flat = -(b - a).normalize_or_zero().perp();
            let normal = |corner: DVec2| {
                let outward = if is_round { corner.normalize_or_zero() } else { flat };
                outward.extend(0.0)
            };
            let far = along + a.distance(b);
            let mut corner = |p: DVec2, height: f64, s: f64| {
                self.push(p.extend(height), normal(p), DVec2::new(s, height))
            };
            let low = [corner(a, extent.bottom(), along), corner(b, extent.bottom(), far)];
            let high = [corner(a, extent.top(), along), corner(b, extent.top(), far)];
            self.triangles.extend([[low[0], low[1], high[1]], [low[0], high[1], high[0]]]);
            along = far;
        }
    }
}
