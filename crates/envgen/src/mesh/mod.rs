//! Worlds as triangles: closed, oriented meshes with normals and texture coordinates.
//!
//! In the frame of meshes, x points right and y up on the plan, and z points up; all lengths are in metres. Every
//! mesh is a closed surface: each edge joins exactly two triangles, which run along it in opposite directions, and
//! no triangle is degenerate. Seen from outside, triangles run counter-clockwise.

mod convex;
mod extrude;
mod raycast;
mod revolve;
mod triangle_mesh;
mod triangulate;

use thiserror::Error;

pub use self::convex::convex_pieces;
pub use self::raycast::{BodyHit, BodyRaycaster};
pub use self::triangle_mesh::Mesh;
pub use self::triangulate::triangulate;
use crate::pieces::{Form, Piece};

/// The error for a piece that has no mesh.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "{piece} has no mesh: its outline crosses or touches itself, or its numbers are too large or too small"
)]
pub struct MeshError {
    /// The name of the piece.
    pub piece: String,
}

impl Mesh {
    /// Creates the mesh of a piece of a world.
    ///
    /// # Errors
    /// For outlines that are not simple, and for roads whose edge crosses itself in a bend.
    pub fn of(piece: &Piece<'_>) -> Result<Self, MeshError> {
        Mesh::of_form(&piece.form).ok_or_else(|| MeshError { piece: piece.to_string() })
    }

    /// Creates the mesh of a form; `None` for outlines that are not simple, and for roads whose edge crosses itself
    /// in a bend.
    pub fn of_form(form: &Form<'_>) -> Option<Self> {
        match form {
            Form::Prism { shape, extent } => Mesh::extruded(shape, *extent),
            Form::Crown { center, crown } => Some(Mesh::ellipsoid(*center, *crown)),
            Form::Road { strip, extent } => Mesh::of_road(strip, *extent),
        }
    }
}

#[cfg(test)]
mod tests;
