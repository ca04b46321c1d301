//! The kinds of surfaces of bodies.

use bevy::prelude::*;

/// A kind of surface. All surfaces of a finish share one material, and the corners of their meshes have the
/// colours.
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
    /// Lamps, which emit light.
    Lamp,
    /// The bark of trees.
    Bark,
    /// The leaves of trees.
    Leaves,
    /// Marks that are visible in any light.
    Mark,
}
