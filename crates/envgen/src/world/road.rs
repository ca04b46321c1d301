//! The geometry of a road strip, for exporters, pictures and colliders.

use std::borrow::Cow;

use glam::DVec2;

use super::RoadStrip;
use crate::curve::{Curve, Path, corner};
use crate::geometry::{Pose, Rect};

/// The surface of a road as triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct RoadMesh {
    /// Corners in metres, alternately on the left and on the right edge, in the direction of travel.
    pub vertices: Vec<DVec2>,
    /// Distance along the road of each corner in metres, such as for textures.
    pub distances: Vec<f64>,
    /// Three corners per triangle, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}

impl RoadStrip {
    /// Returns the centreline as a path: the exact pieces if they are known, otherwise straight lines between the
    /// points.
    pub fn path(&self) -> Path<'_> {
        if !self.pieces.is_empty() {
            return Path::new(self.pieces.as_slice());
        }
        let joined = self.closed.then(|| self.centreline.first()).flatten();
        let ends = self.centreline.iter().skip(1).chain(joined);
        let lines: Vec<Curve> = self
            .centreline
            .iter()
            .zip(ends)
            .filter_map(|(a, b)| {
                let (a, along) = (a.pose.position, b.pose.position - a.pose.position);
                let length = along.length();
                let start = Pose { position: a, heading: libm::atan2(along.y, along.x) };
                (length > 0.0).then(|| Curve::line(start, length))
            })
            .collect();
        Path::new(Cow::Owned(lines))
    }

    /// Returns the least rectangle around the centreline, enlarged by half the width on every side; `None` without
    /// points.
    pub fn bounds(&self) -> Option<Rect> {
        let points = || Rect::around(self.centreline.iter().map(|point| point.pose.position));
        Some(self.path().bounds().or_else(points)?.grown(0.5 * self.width))
    }

    /// Returns the points of the line at `offset` metres to the left of the centreline, so many that straight lines
    /// between them, and between those of the road's edges, deviate from the exact curves by at most `tolerance`
    /// metres. The line of a closed road ends with its first point again.
    ///
    /// # Panics
    /// When `tolerance` is not positive.
    #[track_caller]
    pub fn line(&self, offset: f64, tolerance: f64) -> Vec<DVec2> {
        let path = self.path();
        let distances = path.stations(offset.abs().max(0.5 * self.width), tolerance);
        self.line_at(&path, offset, &distances)
    }

    /// Returns the width of a lane in metres.
    pub fn lane_width(&self) -> f64 {
        self.width / f64::from(self.lanes.max(1))
    }

    /// Returns the surface as triangles. Their edges deviate from the road's edges by at most `tolerance` metres.
    ///
    /// ```
    /// use envgen::geometry::signed_area;
    /// use envgen::road::{Prefab, RoadSpec};
    /// use envgen::{Blueprint, Seed, Spec};
    ///
    /// // A straight road of 100 m by 7 m.
    /// let spec = RoadSpec { length: 100.0, prefabs: vec![Prefab::Straight], ..Default::default() };
    /// let world = spec.generate(Seed(7))?.to_world();
    /// let mesh = world.road_strips[0].mesh(0.01);
    /// let corners = |triangle: &[u32; 3]| triangle.map(|i| mesh.vertices[i as usize]);
    /// let area: f64 = mesh.triangles.iter().map(|triangle| signed_area(&corners(triangle))).sum();
    /// assert!((area - 700.0).abs() < 1e-6);
    /// # Ok::<(), envgen::road::RoadError>(())
    /// ```
    ///
    /// # Panics
    /// When `tolerance` is not positive.
    #[track_caller]
    pub fn mesh(&self, tolerance: f64) -> RoadMesh {
        let path = self.path();
        let distances = path.stations(0.5 * self.width, tolerance);
        self.mesh_at(&path, distances)
    }

    /// Returns the surface as triangles, with corners at given distances along the road's path.
    pub(crate) fn mesh_at(&self, path: &Path<'_>, distances: Vec<f64>) -> RoadMesh {
        let left = self.line_at(path, 0.5 * self.width, &distances);
        let right = self.line_at(path, -0.5 * self.width, &distances);
        let quads = distances.len().saturating_sub(1) as u32;
        RoadMesh {
            vertices: left.into_iter().zip(right).flat_map(|(l, r)| [l, r]).collect(),
            distances: distances.into_iter().flat_map(|s| [s, s]).collect(),
            triangles: (0..quads)
                .flat_map(|i| {
                    let (l, r) = (2 * i, 2 * i + 1);
                    [[l, r, r + 2], [l, r + 2, l + 2]]
                })
                .collect(),
        }
    }

    /// Returns the points at `offset` metres to the left of the road's path at given distances along it, which must not
    /// decrease.
    pub(crate) fn line_at(&self, path: &Path<'_>, offset: f64, distances: &[f64]) -> Vec<DVec2> {
        if path.curves().is_empty() {
            // All points are the same.
            let at = self.centreline.first().map_or(DVec2::ZERO, |point| point.pose.position);
            return vec![at; distances.len()];
        }
        let mut line = path.offset_curve(offset, distances);
        if self.closed
            && distances.first() == Some(&0.0)
            && distances.last() == Some(&path.length())
            && let [start, .., end] = line.as_mut_slice()
            && let [first, .., last] = path.curves()
            && let Some(beside) = corner(last.end().heading, first.start.heading)
        {
            // The circuit turns where it closes.
            *start = first.start.position + beside * offset;
            *end = last.end().position + beside * offset;
        }
        line
    }
}
