//! What the surfaces of bodies feel like.

use bevy::prelude::*;

/// What a surface feels like. Each is one material, whose colours are those of the corners of its meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Reflect)]
#[reflect(Debug, PartialEq, Clone)]
#[non_exhaustive]
pub enum Finish {
    /// Soil, grass, asphalt, debris.
    Ground,
    /// Floors.
    Floor,
    /// Plastered and stone walls.
    Wall,
    /// Wood, plastics and cloth.
    Plain,
    /// Painted or bare metal, glass.
    Metal,
    /// Water.
    Water,
    /// Ceilings.
    Ceiling,
    /// Lamps, which are bright in themselves.
    Lamp,
    /// The bark of trees.
    Bark,
    /// The leaves of trees.
    Leaves,
    /// Marks that are seen whatever the light.
    Mark,
}
