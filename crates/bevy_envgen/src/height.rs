//! From where to where parts and bodies reach.

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};

/// Bottom and top of a part, or of a body, in metres above the floor. Doorways have those of their opening. Transforms
/// do not change them: in an environment of another scale they are still those of the world.
///
/// Rapier is flat: with `TopDownPhysicsPlugin`, two bodies that both have this component collide only
/// where their ranges overlap, so that a low robot passes below a table. A body without it is as high
/// as everything. Rays meet every collider, unless their filter asks [`HeightRange::contains`].
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
    /// The lower end, negative below the floor.
    pub bottom: f64,
    /// The upper end.
    pub top: f64,
}

impl HeightRange {
    /// Whether more than a plane is in both.
    pub fn overlaps(self, other: HeightRange) -> bool {
        self.bottom < other.top && other.bottom < self.top
    }

    /// Whether a height, such as that of a laser's plane, is in it, its ends included.
    pub fn contains(self, height: f64) -> bool {
        (self.bottom..=self.top).contains(&height)
    }
}

impl From<envgen::world::Extent> for HeightRange {
    fn from(extent: envgen::world::Extent) -> Self {
        HeightRange { bottom: extent.bottom(), top: extent.top() }
    }
}
