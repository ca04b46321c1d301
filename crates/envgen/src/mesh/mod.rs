//! Worlds as triangles: closed, oriented meshes with normals and texture coordinates.
//!
//! Frame: x right, y up on the plan, z up; all lengths in metres. Every mesh is a closed surface: each
//! edge joins exactly two triangles, which run along it in opposite directions, and no triangle is
//! degenerate. Seen from outside, triangles run counter-clockwise.

mod convex;
mod extrude;
mod raycast;
mod revolve;
mod triangulate;

use glam::{DVec2, DVec3};
use thiserror::Error;

pub use self::convex::convex_pieces;
pub use self::raycast::{BodyHit, BodyRaycaster};
pub use self::triangulate::triangulate;
use crate::pieces::{Form, Piece};

/// How far the edges of a mesh of a road stray from the road's at most, in metres.
const ROAD_TOLERANCE: f64 = 0.02;

/// Ends of a road that are this near join, in metres.
const JOINED: f64 = 1e-6;

/// Why there is no mesh.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "{piece} has no mesh: its outline crosses or touches itself, or its numbers are too large or too small"
)]
pub struct MeshError {
    /// The name of the piece.
    pub piece: String,
}

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
    /// What the positions are relative to, on the plan.
    pub pivot: DVec2,
    /// The corners of the triangles. Corners of different normals or texture coordinates are
    /// listed several times, with the same position to the last bit.
    pub positions: Vec<DVec3>,
    /// The unit normal at each corner, out of the surface.
    pub normals: Vec<DVec3>,
    /// Texture coordinates of each corner, in metres: on sides the distance along the outline and the
    /// height, on tops and bottoms x and y.
    pub uvs: Vec<DVec2>,
    /// Three corners per triangle, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    fn empty(pivot: DVec2) -> Self {
        Mesh {
            pivot,
            positions: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            triangles: Vec::new(),
        }
    }

    fn push(&mut self, position: DVec3, normal: DVec3, uv: DVec2) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
        self.positions.len() as u32 - 1
    }

    /// The mesh of a piece of a world.
    ///
    /// # Errors
    /// For outlines that are not simple, and roads whose edge crosses itself in a bend.
    pub fn of(piece: &Piece<'_>) -> Result<Self, MeshError> {
        Mesh::of_form(&piece.form).ok_or_else(|| MeshError { piece: piece.to_string() })
    }

    /// The mesh of a form; `None` for outlines that are not simple, and roads whose edge crosses itself in a
    /// bend.
    pub fn of_form(form: &Form<'_>) -> Option<Self> {
        match form {
            Form::Prism { shape, extent } => Mesh::extruded(shape, *extent),
            Form::Crown { center, crown } => Some(Mesh::ellipsoid(*center, *crown)),
            Form::Road { strip, extent } => Mesh::of_road(strip, *extent),
        }
    }

    /// The volume in cubic metres.
    pub fn volume(&self) -> f64 {
        let corner = |i: u32| self.positions[i as usize];
        let six = |&[a, b, c]: &[u32; 3]| corner(a).dot(corner(b).cross(corner(c)));
        self.triangles.iter().map(six).sum::<f64>() / 6.0
    }
}

#[cfg(test)]
mod tests;
