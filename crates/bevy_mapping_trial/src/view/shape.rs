//! The two-dimensional meshes of robots.

use std::f32::consts::TAU;

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use mapping_trial::robot::{Footprint, Robot};

/// The colour factors of the heading mark, and of everything else.
const MARK: [f32; 4] = [0.08, 0.08, 0.08, 1.0];
const PLAIN: [f32; 4] = [1.0; 4];

/// The width of outlines in metres.
const LINE: f32 = 0.04;

/// The number of corners of a disc.
const DISC_SIDES: u16 = 32;

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

/// Returns half the length and width of the box around a robot's body.
fn half_size(robot: &Robot) -> Vec2 {
    match robot.footprint {
        Footprint::Box => 0.5 * Vec2::new(robot.length as f32, robot.width as f32),
        Footprint::Disc => Vec2::splat(robot.circumscribed_radius as f32),
    }
}

/// Returns the corners of a body of the shape of a robot's, from half the size of the box around it.
fn corners(robot: &Robot, half: Vec2) -> Vec<Vec2> {
    match robot.footprint {
        Footprint::Box => {
            vec![-half, Vec2::new(half.x, -half.y), half, Vec2::new(-half.x, half.y)]
        }
        Footprint::Disc => {
            let angles = (0..DISC_SIDES).map(|k| TAU * f32::from(k) / f32::from(DISC_SIDES));
            angles.map(|angle| half * Vec2::from_angle(angle)).collect()
        }
    }
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
    sketch.add(&corners(robot, half), PLAIN);
    sketch.add(&head(half), MARK);
    sketch.into_mesh()
}

/// Creates the mesh of the outline of a robot's body, with a mark of its heading along x.
pub(super) fn outline(robot: &Robot) -> Mesh {
    let half = half_size(robot);
    let outer = corners(robot, half);
    let inner = corners(robot, (half - LINE).max(Vec2::ZERO));
    let mut sketch = Sketch::default();
    for side in 0..outer.len() {
        let next = (side + 1) % outer.len();
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the greatest and the least distance of a mesh's corners from the origin, without those of the mark.
    fn reach(mesh: &Mesh, corners: usize) -> [f32; 2] {
        let points = mesh.attribute(Mesh::ATTRIBUTE_POSITION).and_then(|all| all.as_float3());
        let distances = points.unwrap()[..corners].iter().map(|p| Vec2::new(p[0], p[1]).length());
        distances.fold([0.0, f32::INFINITY], |[most, least], distance| {
            [distance.max(most), distance.min(least)]
        })
    }

    #[test]
    fn bodies_have_the_shape_of_the_footprint() {
        let base = Robot { circumscribed_radius: 0.4, ..Default::default() };
        let disc = Robot { footprint: Footprint::Disc, ..base.clone() };
        let sides = usize::from(DISC_SIDES);
        let [most, least] = reach(&body(&disc), sides);
        assert!((most - 0.4).abs() < 1e-6 && (least - 0.4).abs() < 1e-6, "{least} to {most}");
        let [most, least] = reach(&outline(&disc), 4 * sides);
        assert!((most - 0.4).abs() < 1e-6 && (least - 0.36).abs() < 1e-6, "{least} to {most}");
        let half = 0.5 * Vec2::new(base.length as f32, base.width as f32);
        let [most, least] = reach(&body(&base), 4);
        assert!(most == half.length() && least == half.length(), "{least} to {most}");
    }
}
