//! Collects many bodies in one mesh.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use envgen::glam::{DVec2, DVec3};
use envgen::mesh::Mesh as Solid;

use super::finish::Finish;

/// The height in metres at which the texture of walls is sampled for their tops.
const TOP: f64 = 1.0;

/// The corners and triangles of bodies of several colours.
#[derive(Debug, Default)]
pub(super) struct Draft {
    /// The finish of the bodies, on which texture coordinates depend.
    finish: Option<Finish>,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    colors: Vec<[f32; 4]>,
    corners: Vec<u32>,
}

impl Draft {
    /// Creates a draft for bodies of a finish.
    pub(super) fn of(finish: Finish) -> Self {
        Draft { finish: Some(finish), ..Draft::default() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Adds a body, in the frame whose origin is the point `origin` of the world. Textures of tops and
    /// bottoms continue from one body to the next.
    pub(super) fn add(&mut self, solid: &Solid, origin: DVec2, color: Color) {
        let first = self.positions.len() as u32;
        let shift = solid.pivot - origin;
        let place = |p: &DVec3| (*p + shift.extend(0.0)).as_vec3().to_array();
        self.positions.extend(solid.positions.iter().map(place));
        self.normals.extend(solid.normals.iter().map(|normal| normal.as_vec3().to_array()));
        let texture = |((uv, normal), p): ((&DVec2, &DVec3), &DVec3)| {
            let on_plan = p.truncate() + shift;
            let is_flat = normal.z.abs() > 0.5;
            let texture = match self.finish {
                // The texture of the sides depends on the height above the floor.
                Some(Finish::Wall) if is_flat => DVec2::new(on_plan.x + on_plan.y, TOP),
                Some(Finish::Leaves) => *uv,
                _ if is_flat => on_plan,
                _ => *uv,
            };
            texture.as_vec2().to_array()
        };
        let sides = solid.uvs.iter().zip(&solid.normals).zip(&solid.positions);
        self.uvs.extend(sides.map(texture));
        self.paint(color);
        self.corners.extend(solid.triangles.iter().flatten().map(|corner| first + corner));
    }

    /// Adds a flat, convex polygon at a height, with corners that are counter-clockwise as seen from above.
    pub(super) fn add_flat(&mut self, outline: &[Vec2], height: f32, color: Color) {
        let first = self.positions.len() as u32;
        self.positions.extend(outline.iter().map(|p| [p.x, p.y, height]));
        self.normals.extend(outline.iter().map(|_| [0.0, 0.0, 1.0]));
        self.uvs.extend(outline.iter().map(|p| p.to_array()));
        self.paint(color);
        let fan = (2..outline.len() as u32).flat_map(|i| [first, first + i - 1, first + i]);
        self.corners.extend(fan);
    }

    /// Adds an axis-aligned box between its lowest and its highest corner.
    pub(super) fn add_box(&mut self, low: Vec3, high: Vec3, color: Color) {
        let rect =
            envgen::geometry::Rect::new(low.truncate().as_dvec2(), high.truncate().as_dvec2());
        let extent = envgen::world::Extent::new(f64::from(low.z), f64::from(high.z)).ok();
        let shape = envgen::geometry::Shape::from_rect(rect);
        if let Some(solid) = extent.and_then(|extent| Solid::extruded(&shape, extent)) {
            self.add(&solid, DVec2::ZERO, color);
        }
    }

    /// Adds a mesh of Bevy, which must be a triangle list with indices.
    pub(super) fn add_mesh(&mut self, mesh: &Mesh, color: Color) {
        let first = self.positions.len() as u32;
        let floats = |attribute| mesh.attribute(attribute).and_then(|values| values.as_float3());
        let (Some(positions), Some(normals), Some(corners)) =
            (floats(Mesh::ATTRIBUTE_POSITION), floats(Mesh::ATTRIBUTE_NORMAL), mesh.indices())
        else {
            return;
        };
        self.positions.extend(positions);
        self.normals.extend(normals);
        self.uvs.extend(positions.iter().map(|p| [p[0], p[1]]));
        self.paint(color);
        self.corners.extend(corners.iter().map(|corner| first + corner as u32));
    }

    /// Sets the colour of all corners that have no colour yet.
    fn paint(&mut self, color: Color) {
        self.colors.resize(self.positions.len(), color.to_linear().to_f32_array());
    }

    pub(super) fn into_mesh(self) -> Mesh {
        Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, self.positions)
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, self.normals)
            .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, self.uvs)
            .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, self.colors)
            .with_inserted_indices(Indices::U32(self.corners))
    }
}
