//! The heights between which parts and bodies extend.

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};

/// A component with the bottom and the top of a part or a body, in metres above the floor. For a doorway they
/// are those of its opening. Transforms do not change them: in a scaled environment they are still heights of
/// the unscaled world.
///
/// Rapier's physics is two-dimensional. With `TopDownPhysicsPlugin`, two bodies that both have this component
/// collide only if their ranges overlap, so that a low robot passes below a table. A body without this
/// component collides at every height. Rays hit every collider, unless their filter checks
/// [`HeightRange::contains`].
///
/// ```
/// use bevy_envgen::HeightRange;
///
/// let table = HeightRange { bottom: 0.7, top: 0.75 };
/// let robot = HeightRange { bottom: 0.0, top: 0.5 };
/// assert!(!table.overlaps(robot) && !table.contains(0.45));
/// ```
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct HeightRange {
    /// The lower end, which is negative below the floor.
    pub bottom: f64,
    /// The upper end.
    pub top: f64,
}

impl HeightRange {
    /// Returns whether the two ranges overlap. Ranges that only touch do not.
    pub fn overlaps(self, other: HeightRange) -> bool {
        self.bottom < other.top && other.bottom < self.top
    }

    /// Returns whether a height, such as that of a laser's plane, is in the range. Both ends are included.
    pub fn contains(self, height: f64) -> bool {
        (self.bottom..=self.top).contains(&height)
    }
}

impl From<envgen::world::Extent> for HeightRange {
    fn from(extent: envgen::world::Extent) -> Self {
        HeightRange { bottom: extent.bottom(), top: extent.top() }
    }
}
