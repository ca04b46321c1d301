//! The triangles of the scenes that cameras see.

use std::collections::BTreeMap;

use bevy::prelude::*;
use envgen::glam::DVec3;
use envgen::mesh;
use envgen::pieces::{Form, ceilings, pieces};
use envgen::scenario::ScenarioState;

use super::labels::Labels;
use super::optics::{CameraOptics, CameraPose};
use super::settings::CameraError;

/// The largest number of triangles of a world. Each takes about 120 bytes.
pub const MAX_TRIANGLES: usize = 4_000_000;

/// The side of a tile in metres. Triangles in tiles that are out of view are not drawn.
const TILE: f64 = 16.0;

/// Triangles with their labels, relative to a point of the world.
#[derive(Clone, Debug, Default)]
pub(super) struct Triangles {
    pub(super) corners: Vec<[DVec3; 3]>,
    pub(super) labels: Vec<u32>,
}

impl Triangles {
    fn add(&mut self, mesh: &mesh::Mesh, origin: DVec3, label: u32) {
        let shift = mesh.pivot.extend(0.0) - origin;
        let corner = |i: u32| mesh.positions[i as usize] + shift;
        self.corners.extend(mesh.triangles.iter().map(|corners| corners.map(corner)));
        self.labels.resize(self.corners.len(), label);
    }

    /// Adds the mesh of a moving body.
    pub(super) fn add_form(&mut self, form: &Form<'_>, origin: DVec3, label: u32) {
        if let Some(mesh) = mesh::Mesh::of_form(form) {
            self.add(&mesh, origin, label);
        }
    }

    /// Returns the depth of a pixel that shows a triangle. It is where the ray of the pixel from `eye` meets
    /// the plane of the triangle, clamped to the depths of the corners, since drivers round the edges of
    /// triangles.
    pub(super) fn depth(&self, triangle: usize, eye: DVec3, forward: DVec3, ray: DVec3) -> f64 {
        let corners = self.corners[triangle];
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let depth = normal.dot(a - eye) / normal.dot(ray);
        let depths = corners.map(|corner| (corner - eye).dot(forward));
        let nearest = depths.into_iter().fold(f64::INFINITY, f64::min).max(0.0);
        let farthest = depths.into_iter().fold(0.0, f64::max);
        if depth.is_nan() { nearest } else { depth.clamp(nearest, farthest.max(nearest)) }
    }
}

/// Triangles that are drawn or skipped together.
#[derive(Clone, Debug)]
pub(super) struct SceneTile {
    pub(super) triangles: std::ops::Range<u32>,
    min: Vec3,
    max: Vec3,
}

/// The parts of a world that do not move.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    /// The origin of all positions, chosen so that single precision resolves them.
    pub(super) origin: DVec3,
    pub(super) triangles: Triangles,
    pub(super) tiles: Vec<SceneTile>,
    pub(super) labels: Labels,
}

impl Scene {
    pub(super) fn new(
        world: &envgen::World,
        moving: Option<&ScenarioState>,
        has_ceilings: bool,
    ) -> Result<Self, CameraError> {
        Scene::of_at_most(MAX_TRIANGLES, world, moving, has_ceilings)
    }

    fn of_at_most(
        limit: usize,
        world: &envgen::World,
        moving: Option<&ScenarioState>,
        has_ceilings: bool,
    ) -> Result<Self, CameraError> {
        let origin = world.bounds.center().extend(0.0);
        let mut pieces = pieces(world);
        if has_ceilings {
            pieces.extend(ceilings(world));
        }
        let numbers = moving.map_or([0, 0], |state| [state.doors().len(), state.people().len()]);
        let labels = Labels::new(&pieces, numbers);
        let mut tiles: BTreeMap<[i64; 2], Triangles> = BTreeMap::new();
        let mut count = 0;
        for (i, piece) in pieces.iter().enumerate() {
            let solid = match mesh::Mesh::of(piece) {
                Ok(solid) => solid,
                Err(error) => {
                    log::warn!("not seen by cameras: {error}");
                    continue;
                }
            };
            count += solid.triangles.len();
            let cell = (solid.pivot / TILE).floor();
            let tile = tiles.entry([cell.x as i64, cell.y as i64]).or_default();
            if count <= limit {
                tile.add(&solid, origin, labels.of_piece(i));
            }
        }
        if count > limit {
            return Err(CameraError::TooManyTriangles { found: count, limit });
        }
        let mut all = Triangles::default();
        let mut ranges = Vec::new();
        for tile in tiles.into_values() {
            let corners = || tile.corners.iter().flatten().map(|corner| corner.as_vec3());
            let Some(min) = corners().reduce(Vec3::min) else { continue };
            let max = corners().fold(min, Vec3::max);
            let first = all.corners.len() as u32;
            all.corners.extend(tile.corners);
            all.labels.extend(tile.labels);
            ranges.push(SceneTile { triangles: first..all.corners.len() as u32, min, max });
        }
        Ok(Scene { origin, triangles: all, tiles: ranges, labels })
    }

    /// Returns the ranges of the triangles of the tiles that may be in view.
    pub(super) fn in_view(&self, view: Mat4, optics: &CameraOptics) -> Vec<std::ops::Range<u32>> {
        let slopes = Vec2::new(optics.width as f32, optics.height as f32)
            / (2.0 * optics.focal_length as f32);
        let mut runs: Vec<std::ops::Range<u32>> = Vec::new();
        for tile in self.tiles.iter().filter(|tile| tile.is_in_view(view, slopes)) {
            match runs.last_mut() {
                Some(run) if run.end == tile.triangles.start => run.end = tile.triangles.end,
                _ => runs.push(tile.triangles.clone()),
            }
        }
        runs
    }

    /// Returns the depths and the labels of the pixels, from the numbers of their triangles: 0 if there is no
    /// surface, and the numbers of `moving` after those of the world.
    pub(super) fn resolve(
        &self,
        moving: &Triangles,
        numbers: &[u32],
        pose: &CameraPose,
        optics: &CameraOptics,
    ) -> (Vec<f32>, Vec<u32>) {
        let still = self.triangles.corners.len();
        let eye = pose.position - self.origin;
        let forward = -pose.axes.z_axis;
        let pixels = (0..optics.height).flat_map(|row| (0..optics.width).map(move |i| (i, row)));
        let resolved = numbers.iter().zip(pixels).map(|(&number, (column, row))| {
            let Some(triangle) = (number as usize).checked_sub(1) else {
                return (f32::INFINITY, 0);
            };
            let (of, triangle) = match triangle.checked_sub(still) {
                None => (&self.triangles, triangle),
                Some(triangle) => (moving, triangle),
            };
            let ray = pose.axes * optics.ray(column, row);
            match of.labels.get(triangle) {
                Some(&label) => (of.depth(triangle, eye, forward, ray) as f32, label),
                None => (f32::INFINITY, 0),
            }
        });
        resolved.unzip()
    }
}

impl SceneTile {
    /// Returns whether the bounding box of the tile is partly between the planes at the sides of the image,
    /// and in front of the camera.
    fn is_in_view(&self, view: Mat4, slopes: Vec2) -> bool {
        let corners = (0..8).map(|i| {
            let pick = |bit: u32, min: f32, max: f32| if i & bit == 0 { min } else { max };
            let corner = Vec3::new(
                pick(1, self.min.x, self.max.x),
                pick(2, self.min.y, self.max.y),
                pick(4, self.min.z, self.max.z),
            );
            view.transform_point3(corner)
        });
        let mut outside = [true; 5];
        for at in corners {
            let edge = slopes * -at.z;
            let beyond = [at.x > edge.x, at.x < -edge.x, at.y > edge.y, at.y < -edge.y, at.z > 0.0];
            for (all, beyond) in outside.iter_mut().zip(beyond) {
                *all &= beyond;
            }
        }
        !outside.contains(&true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use envgen::{Seed, WorldKind};

    #[test]
    fn worlds_of_too_many_triangles_are_refused() {
        let spec = WorldKind::Forest.default_spec();
        let world = spec.generate(Seed(1)).unwrap().to_world();
        let scene = Scene::new(&world, None, false).unwrap();
        let count = scene.triangles.corners.len();
        assert_eq!(
            Scene::of_at_most(count, &world, None, false).unwrap().tiles.len(),
            scene.tiles.len()
        );
        let error = Scene::of_at_most(count - 1, &world, None, false).unwrap_err();
        assert_eq!(error, CameraError::TooManyTriangles { found: count, limit: count - 1 });
        assert!(error.to_string().contains(&count.to_string()));
    }
}
