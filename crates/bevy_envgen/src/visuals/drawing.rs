//! Two-dimensional meshes of parts.

use std::f32::consts::TAU;

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;

use crate::shape::PartShape;
use crate::tessellate::triangles;

/// The size in metres of the mark of a start, goal or victim.
const MARK: f32 = 0.4;

/// A mesh in the frame of the environment.
#[derive(Default)]
pub(super) struct Drawing {
    corners: Vec<[f32; 3]>,
    pub(super) triangles: Vec<u32>,
}

impl Drawing {
    pub(super) fn add(&mut self, corners: impl IntoIterator<Item = Vec2>, triangles: &[[u32; 3]]) {
        let first = self.corners.len() as u32;
        self.corners.extend(corners.into_iter().map(|p| [p.x, p.y, 0.0]));
        self.triangles.extend(triangles.iter().flatten().map(|corner| first + corner));
    }

    pub(super) fn add_shape(&mut self, transform: &Transform, shape: &PartShape) {
        let place = |p: Vec2| transform.transform_point(p.extend(0.0)).truncate();
        let mut polygon = |corners: &[Vec2]| {
            self.add(corners.iter().copied().map(place), &triangles(corners));
        };
        match shape {
            PartShape::Disc { radius } => {
                let sides = (8.0 * (1.0 + radius.sqrt())).clamp(8.0, 48.0).round() as u32;
                let corner = |i: u32| Vec2::from_angle(TAU * i as f32 / sides as f32) * *radius;
                let fan: Vec<_> = (2..sides).map(|i| [0, i - 1, i]).collect();
                self.add((0..sides).map(corner).map(place), &fan);
            }
            PartShape::Box { half_size: h } => {
                polygon(&[-*h, Vec2::new(h.x, -h.y), *h, Vec2::new(-h.x, h.y)]);
            }
            PartShape::Polygon { vertices } => polygon(vertices),
            // An arrow along the heading.
            PartShape::Point => polygon(&[
                Vec2::new(-0.5 * MARK, -0.5 * MARK),
                Vec2::new(MARK, 0.0),
                Vec2::new(-0.5 * MARK, 0.5 * MARK),
            ]),
            PartShape::Segment { .. } | PartShape::Strip { .. } => {}
        }
    }

    pub(super) fn into_mesh(self) -> Mesh {
        let normals = vec![[0.0, 0.0, 1.0]; self.corners.len()];
        Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, self.corners)
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
            .with_inserted_indices(Indices::U32(self.triangles))
    }
}
