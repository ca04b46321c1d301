//! Stable identifiers of a world's parts.

use std::fmt;

#[cfg(feature = "bevy_reflect")]
use bevy_reflect::{Reflect, ReflectDeserialize, ReflectSerialize};
use serde::{Deserialize, Serialize};
use strum::IntoStaticStr;

/// The kind of a part: the list of [`World`](super::World) that contains it, or the mark that it is.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, IntoStaticStr,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
#[cfg_attr(
    feature = "bevy_reflect",
    derive(Reflect),
    reflect(Clone, Debug, PartialEq, Hash, Serialize, Deserialize)
)]
pub enum PartKind {
    /// A [`Wall`](super::Wall).
    Wall,
    /// A [`Tree`](super::Tree).
    Tree,
    /// A [`RoadStrip`](super::RoadStrip).
    RoadStrip,
    /// A [`Room`](super::Room).
    Room,
    /// A [`Doorway`](super::Doorway).
    Doorway,
    /// An [`Obstacle`](super::Obstacle).
    Obstacle,
    /// A [`Surface`](super::Surface).
    Surface,
    /// The start pose, which has no body.
    Start,
    /// The goal pose, which has no body.
    Goal,
    /// A victim: the pose of a person to be found, which is a mark on the floor.
    Victim,
    /// The cells of the [raster](super::ClassRaster) of a landscape.
    Ground,
}

impl PartKind {
    /// Returns the name of the kind, such as `road_strip`.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Returns whether parts of this kind always stop robots and rays. Doorways do so only where they are closed.
    pub fn is_solid(self) -> bool {
        matches!(self, PartKind::Wall | PartKind::Tree | PartKind::Obstacle)
    }
}

/// The stable identifier of a part: its kind, and its index in the world's list of that kind.
///
/// ```
/// use envgen::world::{PartId, PartKind};
///
/// let part = PartId { kind: PartKind::RoadStrip, index: 2 };
/// assert_eq!(part.to_string(), "road_strip 2");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct PartId {
    /// The kind of the part, which names the list.
    pub kind: PartKind,
    /// The index in the list, counted from 0.
    pub index: u32,
}

impl fmt::Display for PartId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.kind.name(), self.index)
    }
}
