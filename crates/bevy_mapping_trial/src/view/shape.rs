//! The two-dimensional meshes of robots.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use mapping_trial::robot::Robot;

/// The colour factors of the heading mark, and of everything else.
const MARK: [f32; 4] = [0.08, 0.08, 0.08, 1.0];
const PLAIN: [f32; 4] = [1.0; 4];

/// The width of outlines in metres.
const LINE: f32 = 0.04;

/// Triangles with a colour per vertex, which is multiplied with the colour of the material.
#[derive(Default)]
pub(super) struct Sketch {
    pub(super) corners: Vec<[f32; 3]>,
    pub(super) colors: Vec<[f32; 4]>,
    pub(super) triangles: Vec<u32>,
}

impl Sketch {
    /// Adds a convex polygon with counter-clockwise corners.
    fn add(&mut self, corners: &[Vec2], color: [f32; 4]) {
        let first = self.corners.len() as u32;
        self.corners.extend(corners.iter().map(|p| [p.x, p.y, 0.0]));
        self.colors.extend(corners.iter().map(|_| color));
        let fan = (2..corners.len() as u32).flat_map(|i| [first, first + i - 1, first + i]);
        self.triangles.extend(fan);
    }

    pub(super) fn into_mesh(self) -> Mesh {
        let normals = vec![[0.0, 0.0, 1.0]; self.corners.len()];
        Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, self.corners)
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
            .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, self.colors)
            .with_inserted_indices(Indices::U32(self.triangles))
    }
}

/// Returns the corners of a box around the origin from its half size.
fn corners(half: Vec2) -> [Vec2; 4] {
    [-half, Vec2::new(half.x, -half.y), half, Vec2::new(-half.x, half.y)]
}

fn half_size(robot: &Robot) -> Vec2 {
    0.5 * Vec2::new(robot.length as f32, robot.width as f32)
}

/// Returns an arrow head that fills the front of a box.
fn head(half: Vec2) -> [Vec2; 3] {
    [
        Vec2::new(0.1 * half.x, -0.6 * half.y),
        Vec2::new(0.85 * half.x, 0.0),
        Vec2::new(0.1 * half.x, 0.6 * half.y),
    ]
}

/// Creates the mesh of a robot's body from above, with a mark of its heading along x.
pub(super) fn body(robot: &Robot) -> Mesh {
    let half = half_size(robot);
    let mut sketch = Sketch::default();
    sketch.add(&corners(half), PLAIN);
    sketch.add(&head(half), MARK);
    sketch.into_mesh()
}

/// Creates the mesh of the outline of a robot's body, with a mark of its heading along x.
pub(super) fn outline(robot: &Robot) -> Mesh {
    let half = half_size(robot);
    let (outer, inner) = (corners(half), corners((half - LINE).max(Vec2::ZERO)));
    let mut sketch = Sketch::default();
    for side in 0..4 {
        let next = (side + 1) % 4;
        sketch.add(&[outer[side], outer[next], inner[next], inner[side]], PLAIN);
    }
    sketch.add(&head(half), PLAIN);
    sketch.into_mesh()
}

/// Creates an arrow head of length 1 along x, for maps on which a robot is too small to be visible.
pub(super) fn mark() -> Mesh {
    let mut sketch = Sketch::default();
    sketch.add(&[Vec2::new(-0.5, -0.4), Vec2::new(0.5, 0.0), Vec2::new(-0.5, 0.4)], PLAIN);
    sketch.into_mesh()
}
