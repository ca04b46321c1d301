//! The parts of a world.

#[cfg(feature = "bevy_reflect")]
use bevy_reflect::{Reflect, ReflectDeserialize, ReflectSerialize};
use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::Extent;
use crate::curve::Curve;
use crate::geometry::{Pose, Shape};

/// A wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// What the wall is part of.
    pub kind: WallKind,
    /// Its outline.
    pub shape: Shape,
    /// As [`Obstacle::visible_range`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visible_range: Option<f64>,
    /// Its bottom and top where they are not those of its kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Extent>,
}

impl Wall {
    /// A wall that lasers see at any range.
    pub fn new(kind: WallKind, shape: Shape) -> Self {
        Wall { kind, shape, visible_range: None, height: None }
    }

    /// Its longest side in metres.
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

/// What a wall is part of.
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

/// A tree trunk.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tree {
    /// Middle of the trunk, in metres.
    pub center: DVec2,
    /// Radius in metres.
    pub radius: f64,
    /// Its bottom and top where they do not follow from the radius.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Extent>,
}

impl Tree {
    /// A tree whose height follows from its radius.
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
    /// Points of the centreline, in travel order, the end included.
    pub centreline: Vec<RoadPoint>,
    /// The exact centreline, piece by piece; empty where only points of it are known, which
    /// straight lines then join.
    #[serde(default)]
    pub pieces: Vec<Curve>,
    /// Full width in metres.
    pub width: f64,
    /// Number of lanes side by side.
    pub lanes: u32,
    /// Whether the last point joins the first.
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
    /// Name, not necessarily unique.
    pub name: String,
    /// The floor.
    pub shape: Shape,
    /// Difficulty on the scale from 0 to 10, where one is annotated.
    pub difficulty: Option<f64>,
    /// Whether there is light.
    pub lit: bool,
    /// Whether the room still has the contents that its name and difficulty describe.
    #[serde(default, skip_serializing_if = "Contents::is_as_designed")]
    pub contents: Contents,
    /// Its floor and ceiling where the ceiling is not at the usual height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Extent>,
}

/// What is left of a room's contents: a generator may remove some so that a robot can enter, or replace them, and
/// a person may change them.
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
    /// All of them.
    #[default]
    AsDesigned,
    /// All except those that blocked a doorway.
    Cleared,
    /// None.
    Emptied,
    /// A maze in place of them.
    Maze,
    /// Those that were added, moved or removed by hand.
    Edited,
}

impl Contents {
    /// Whether they are those that its name and difficulty describe.
    pub fn is_as_designed(&self) -> bool {
        *self == Contents::AsDesigned
    }

    /// The name, such as `cleared`.
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

/// An opening in a wall, with a door that may be closed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Doorway {
    /// The opening, as thick as the wall; a closed door fills it.
    pub shape: Shape,
    /// Whether a robot can pass.
    pub open: bool,
    /// The indices in [`World::rooms`](crate::World::rooms) of the rooms that it joins; `None` is
    /// a hallway or an open area.
    pub rooms: [Option<u32>; 2],
    /// The bottom and top of the opening where it is not of the usual height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Extent>,
}

impl Doorway {
    /// A doorway of the usual height between two rooms, hallways or open areas.
    pub fn new(shape: Shape, open: bool, rooms: [Option<u32>; 2]) -> Self {
        Doorway { shape, open, rooms, height: None }
    }
}

/// A solid obstacle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// What it is.
    pub kind: ObstacleKind,
    /// Its outline.
    pub shape: Shape,
    /// Distance in metres beyond which a laser has no echo from it, since it is too dark; absent where
    /// lasers see it as far as they reach.
    ///
    /// An echo's power falls with the square of the distance and is proportional to the reflectance,
    /// so that the distance grows with the square root of it: what SICK's LMS 200 measures up to 10 m
    /// at a reflectance of 10 % (data sheet) it measures up to 3 m at 0.9 %.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visible_range: Option<f64>,
    /// Its bottom and top where they are not those of its kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Extent>,
}

impl Obstacle {
    /// An obstacle that lasers see at any range.
    pub fn new(kind: ObstacleKind, shape: Shape) -> Self {
        Obstacle { kind, shape, visible_range: None, height: None }
    }
}

/// What an obstacle is.
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
    /// A cupboard or shelf.
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
    /// A wall of a cubicle that has come down.
    Panel,
    /// A heap of rubble.
    Rubble,
    /// A flight of stairs, which a robot cannot climb and a ray cannot pass.
    Stairs,
    /// Anything else.
    Other,
}

/// Ground that changes how a robot drives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// What it is.
    pub kind: SurfaceKind,
    /// The ground it covers.
    pub shape: Shape,
    /// Factor on a robot's greatest speed, 1 for plain ground, 0 where it cannot drive.
    pub speed: f64,
    /// Factor on the variances of a robot's odometry, 1 for plain ground.
    pub odometry_noise: f64,
    /// How much too far wheels measure, as a fraction of the distance that was driven: 0.2 where they
    /// measure 1.2 m for each metre. Loose ground gives under them.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub wheel_bias: f64,
    /// Its bottom and top where they are not those of its kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Extent>,
}

impl Surface {
    /// Whether robots cannot or must not enter it: water, whatever its speed, and ground of speed 0.
    pub fn is_barrier(&self) -> bool {
        self.kind == SurfaceKind::Water || self.speed <= 0.0
    }

    /// Ground on which robots drive as on a plain floor.
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

/// Wheels measure at most twice the distance that was driven.
pub(crate) const MAX_WHEEL_BIAS: f64 = 1.0;

/// Whether a part can have this visible range.
pub(crate) fn is_visible_range(range: Option<f64>) -> bool {
    range.is_none_or(|range| range.is_finite() && range > 0.0)
}

pub(crate) fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// What a surface is.
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
    /// Strewn with debris.
    Debris,
    /// Water, which a robot must not enter.
    Water,
    /// Stairs, which also block the view.
    Stairs,
    /// The plain floor of a hallway.
    Hallway,
    /// The plain floor of an open area between rooms.
    OpenArea,
    /// Wet, dusty or strewn with rubble: wheels slip by chance.
    Slippery,
    /// Gravel, sand or litter that gives under wheels: they measure too far.
    Loose,
    /// A class of a landscape, counted from 1.
    Class(u16),
}

impl SurfaceKind {
    /// Whether it is the plain floor of a hallway or of an open area between rooms.
    pub fn is_hall(self) -> bool {
        matches!(self, SurfaceKind::Hallway | SurfaceKind::OpenArea)
    }
}
