//! The parts of a world.

#[cfg(feature = "bevy_reflect")]
use bevy_reflect::{Reflect, ReflectDeserialize, ReflectSerialize};
use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::Extent;
use crate::curve::Curve;
use crate::geometry::{Pose, Shape};

/// A wall of a building or corridor, or the kerb of a road.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// The structure of which the wall is part.
    pub kind: WallKind,
    /// The wall's outline in the plane.
    pub shape: Shape,
    /// The visible range, as in [`Obstacle::visible_range`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visible_range: Option<f64>,
    /// The bottom and top, if they differ from those of the kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Extent>,
}

impl Wall {
    /// Creates a wall that lasers see at any range.
    pub fn new(kind: WallKind, shape: Shape) -> Self {
        Wall { kind, shape, visible_range: None, height: None }
    }

    /// Returns the wall's longest side in metres.
    ///
    /// ```
    /// use envgen::geometry::Shape;
    /// use envgen::glam::DVec2;
    /// use envgen::world::{Wall, WallKind};
    ///
    /// let shape = Shape::thick_segment(DVec2::ZERO, DVec2::new(0.0, 3.0), 0.2, 0.0);
    /// assert!((Wall::new(WallKind::Wall, shape).length() - 3.0).abs() < 1e-12);
    /// ```
    pub fn length(&self) -> f64 {
        match &self.shape {
            Shape::Box { half_size, .. } => 2.0 * half_size.max_element(),
            Shape::Disc { radius, .. } => 2.0 * radius,
            Shape::Segment { a, b } => a.distance(*b),
            shape @ Shape::Polygon { .. } => shape.bounds().size().max_element(),
        }
    }
}

/// The structure that a wall is part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(
    feature = "bevy_reflect",
    derive(Reflect),
    reflect(Clone, Debug, PartialEq, Hash, Serialize, Deserialize)
)]
#[non_exhaustive]
pub enum WallKind {
    /// The shell of a building or corridor.
    Wall,
    /// The wall across a corridor's end.
    EndCap,
    /// The side of an alcove.
    Alcove,
    /// A wall inside a room.
    Partition,
    /// The edge of a road.
    Kerb,
}

/// A tree, given by its trunk.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tree {
    /// Centre of the trunk, in metres.
    pub center: DVec2,
    /// Radius of the trunk in metres.
    pub radius: f64,
    /// The bottom and top, if they do not follow from the radius.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Extent>,
}

impl Tree {
    /// Creates a tree whose height follows from its radius.
    ///
    /// ```
    /// use envgen::glam::DVec2;
    /// use envgen::world::Tree;
    ///
    /// // 2.5 m, and ten times the radius.
    /// let tree = Tree::new(DVec2::new(4.0, 1.0), 0.2);
    /// assert!((tree.extent().top() - 4.5).abs() < 1e-12);
    /// // The trunk ends inside the crown.
    /// assert!(tree.crown().extent.contains(tree.trunk().top()));
    /// ```
    pub fn new(center: DVec2, radius: f64) -> Self {
        Tree { center, radius, height: None }
    }
}

/// A road: a strip of constant width along a centreline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadStrip {
    /// Points of the centreline, in the direction of travel, including the end.
    pub centreline: Vec<RoadPoint>,
    /// The exact centreline, piece by piece. Empty if only points of it are known; straight lines then join the
    /// points.
    #[serde(default)]
    pub pieces: Vec<Curve>,
    /// Full width in metres.
    pub width: f64,
    /// Number of lanes side by side.
    pub lanes: u32,
    /// Whether the last point is joined to the first.
    pub closed: bool,
}

/// A point of a road's centreline.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadPoint {
    /// Position and heading of the centreline.
    pub pose: Pose,
    /// Curvature in 1/m, positive to the left.
    pub curvature: f64,
}

/// A room.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Room {
    /// The name, which need not be unique.
    pub name: String,
    /// The outline of the floor.
    pub shape: Shape,
    /// The difficulty on the scale from 0 to 10, if one is annotated.
    pub difficulty: Option<f64>,
    /// Whether the room is lit.
    pub lit: bool,
    /// Whether the room still has the contents to which its name and difficulty refer.
    #[serde(default, skip_serializing_if = "Contents::is_as_designed")]
    pub contents: Contents,
    /// The heights of its floor and ceiling, if the ceiling is not at the default height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Extent>,
}

/// The state of a room's contents. A generator may remove some so that a robot can enter, or replace them, and a
/// user may edit them.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(
    feature = "bevy_reflect",
    derive(Reflect),
    reflect(Clone, Debug, PartialEq, Hash, Serialize, Deserialize)
)]
pub enum Contents {
    /// All of the room's contents.
    #[default]
    AsDesigned,
    /// All contents except those that blocked a doorway.
    Cleared,
    /// No contents.
    Emptied,
    /// A maze in place of the contents.
    Maze,
    /// Contents that were added, moved or removed by hand.
    Edited,
}

impl Contents {
    /// Returns whether the contents are those to which the room's name and difficulty refer.
    pub fn is_as_designed(&self) -> bool {
        *self == Contents::AsDesigned
    }

    /// Returns the name of the state, such as `cleared`.
    pub fn name(self) -> &'static str {
        match self {
            Contents::AsDesigned => "as designed",
            Contents::Cleared => "cleared",
            Contents::Emptied => "emptied",
            Contents::Maze => "maze",
            Contents::Edited => "edited",
        }
    }
}

/// An opening in a wall, with a door that can be closed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Doorway {
    /// The opening, as thick as the wall. A closed door fills it.
    pub shape: Shape,
    /// Whether the door is open, so that a robot can pass.
    pub open: bool,
    /// The indices in [`World::rooms`](crate::World::rooms) of the rooms that the doorway joins; `None` for a
    /// hallway or an open area.
    pub rooms: [Option<u32>; 2],
    /// The bottom and top of the opening, if it does not have the default height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Extent>,
}

impl Doorway {
    /// Creates a doorway of default height between two rooms, hallways or open areas.
    pub fn new(shape: Shape, open: bool, rooms: [Option<u32>; 2]) -> Self {
        Doorway { shape, open, rooms, height: None }
    }
}

/// A solid obstacle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// The kind of obstacle.
    pub kind: ObstacleKind,
    /// The obstacle's outline in the plane.
    pub shape: Shape,
    /// The distance in metres beyond which a laser gets no echo from the obstacle, because it is too dark; absent
    /// if lasers see it at any range.
    ///
    /// The power of an echo falls with the square of the distance and is proportional to the reflectance, so that
    /// this distance grows with the square root of the reflectance. For example, SICK's LMS 200 measures up to 10 m
    /// at a reflectance of 10 % (data sheet), and up to 3 m at 0.9 %.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visible_range: Option<f64>,
    /// The bottom and top, if they differ from those of the kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Extent>,
}

impl Obstacle {
    /// Creates an obstacle that lasers see at any range.
    pub fn new(kind: ObstacleKind, shape: Shape) -> Self {
        Obstacle { kind, shape, visible_range: None, height: None }
    }
}

/// The kind of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(
    feature = "bevy_reflect",
    derive(Reflect),
    reflect(Clone, Debug, PartialEq, Hash, Serialize, Deserialize)
)]
#[non_exhaustive]
pub enum ObstacleKind {
    /// One of the two posts that narrow a corridor at a door frame.
    DoorPost,
    /// A crate that narrows a corridor.
    Crate,
    /// A desk or table.
    Desk,
    /// A chair.
    Chair,
    /// A computer screen, on the floor.
    Screen,
    /// A cabinet or shelf.
    Cabinet,
    /// The counter of a reception.
    Counter,
    /// A shipping container.
    Container,
    /// A boiler.
    Boiler,
    /// A pipe or duct.
    Pipe,
    /// A statue.
    Statue,
    /// A wall of a cubicle that has fallen over.
    Panel,
    /// A heap of rubble.
    Rubble,
    /// A flight of stairs. A robot cannot climb it, and rays cannot pass it.
    Stairs,
    /// Anything else.
    Other,
}

/// An area of ground that changes how a robot drives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// The kind of ground.
    pub kind: SurfaceKind,
    /// The area that it covers.
    pub shape: Shape,
    /// Factor on a robot's greatest speed: 1 for plain ground, 0 where it cannot drive.
    pub speed: f64,
    /// Factor on the variances of a robot's odometry: 1 for plain ground.
    pub odometry_noise: f64,
    /// The fraction by which wheels measure distances too far because loose ground gives under them: 0.2 where they
    /// measure 1.2 m for each metre that is driven.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub wheel_bias: f64,
    /// The bottom and top, if they differ from those of the kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Extent>,
}

impl Surface {
    /// Returns whether robots cannot or must not enter the ground: water, whatever its speed, and ground of speed 0.
    pub fn is_barrier(&self) -> bool {
        self.kind == SurfaceKind::Water || self.speed <= 0.0
    }

    /// Creates ground on which robots drive as on a plain floor.
    ///
    /// ```
    /// use envgen::geometry::{Rect, Shape};
    /// use envgen::glam::DVec2;
    /// use envgen::surface_index::Ground;
    /// use envgen::world::{Surface, SurfaceKind};
    ///
    /// let area = Shape::from_rect(Rect::new(DVec2::ZERO, DVec2::ONE));
    /// let floor = Surface::new(SurfaceKind::Uneven, area);
    /// assert_eq!(Ground::from(&floor), Ground::PLAIN);
    /// // Sand: half the speed, and wheels that measure 1.2 m for each metre.
    /// let sand = Surface { speed: 0.5, wheel_bias: 0.2, ..floor };
    /// assert!((Ground::from(&sand).rolled(10.0) - 12.0).abs() < 1e-12);
    /// ```
    pub fn new(kind: SurfaceKind, shape: Shape) -> Self {
        Surface { kind, shape, speed: 1.0, odometry_noise: 1.0, wheel_bias: 0.0, height: None }
    }
}

/// The greatest wheel bias: wheels then measure twice the distance that was driven.
pub(crate) const MAX_WHEEL_BIAS: f64 = 1.0;

/// Whether a value is allowed as the visible range of a part.
pub(crate) fn is_visible_range(range: Option<f64>) -> bool {
    range.is_none_or(|range| range.is_finite() && range > 0.0)
}

pub(crate) fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// The kind of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(
    feature = "bevy_reflect",
    derive(Reflect),
    reflect(Clone, Debug, PartialEq, Hash, Serialize, Deserialize)
)]
#[non_exhaustive]
pub enum SurfaceKind {
    /// Uneven ground.
    Uneven,
    /// Ground strewn with debris.
    Debris,
    /// Water, which a robot must not enter.
    Water,
    /// Stairs, which also stop rays.
    Stairs,
    /// The plain floor of a hallway.
    Hallway,
    /// The plain floor of an open area between rooms.
    OpenArea,
    /// Ground that is wet, dusty or strewn with rubble, on which wheels slip at random.
    Slippery,
    /// Gravel, sand or litter that gives under wheels, so that they measure distances too far.
    Loose,
    /// A class of a landscape; classes are counted from 1.
    Class(u16),
}

impl SurfaceKind {
    /// Returns whether the surface is the plain floor of a hallway or of an open area between rooms.
    pub fn is_hall(self) -> bool {
        matches!(self, SurfaceKind::Hallway | SurfaceKind::OpenArea)
    }
}
