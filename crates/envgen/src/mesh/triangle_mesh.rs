//! Meshes: triangles with normals and texture coordinates.

use glam::{DVec2, DVec3};

/// A closed surface as triangles.
///
/// ```
/// use envgen::geometry::{Rect, Shape};
/// use envgen::glam::DVec2;
/// use envgen::mesh::Mesh;
/// use envgen::world::Extent;
///
/// let shape = Shape::from_rect(Rect::new(DVec2::ZERO, DVec2::new(4.0, 0.5)));
/// let wall = Mesh::extruded(&shape, Extent::new(0.0, 2.6)?).expect("a box");
/// // Positions are relative to the middle of the shape.
/// assert_eq!(wall.pivot, DVec2::new(2.0, 0.25));
/// assert!((wall.volume() - 4.0 * 0.5 * 2.6).abs() < 1e-12);
/// # Ok::<(), envgen::SpecError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// The origin of the positions, on the plan.
    pub pivot: DVec2,
    /// The corners of the triangles. Corners with several normals or texture coordinates are listed several times,
    /// with the same position to the last bit.
    pub positions: Vec<DVec3>,
    /// The unit normal at each corner, which points out of the surface.
    pub normals: Vec<DVec3>,
    /// The texture coordinates of each corner, in metres: on sides the distance along the outline and the height,
    /// on tops and bottoms x and y.
    pub uvs: Vec<DVec2>,
    /// Three corners per triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    pub(super) fn empty(pivot: DVec2) -> Self {
        Mesh {
            pivot,
            positions: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            triangles: Vec::new(),
        }
    }

    pub(super) fn push(&mut self, position: DVec3, normal: DVec3, uv: DVec2) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
        self.positions.len() as u32 - 1
    }

    /// Returns the volume in cubic metres.
    pub fn volume(&self) -> f64 {
        let corner = |i: u32| self.positions[i as usize];
        let six = |&[a, b, c]: &[u32; 3]| corner(a).dot(corner(b).cross(corner(c)));
        self.triangles.iter().map(six).sum::<f64>() / 6.0
    }
}
