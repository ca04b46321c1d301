//! The data of a world: its parts, and the version of its layout in files.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use super::{
    Claim, ClassRaster, Doorway, Obstacle, PartId, PartKind, RoadStrip, Room, Surface, Tree, Wall,
};
use crate::geometry::{Pose, Rect};
use crate::provenance::Provenance;

/// Version of the world files' layout; a file of another version is refused.
pub const SCHEMA_VERSION: u32 = 1;

/// A world in metres: typed parts, bounds, start and goal, and where it comes from.
///
/// Frame: x right, y up, headings counter-clockwise from +x. A part's [`PartId`] is its list and
/// its place in it, so that the same spec and seed give every part the same id.
///
/// Generators make worlds; one can also be put together by hand:
///
/// ```
/// use envgen::geometry::{Pose, Rect, Shape};
/// use envgen::glam::DVec2;
/// use envgen::world::{Tree, Wall, WallKind};
/// use envgen::{Provenance, World};
///
/// let bounds = Rect::new(DVec2::ZERO, DVec2::new(10.0, 6.0));
/// let mut world = World::new(Provenance::other("manual", "a yard".into()), bounds);
/// let shape = Shape::from_rect(Rect::new(DVec2::ZERO, DVec2::new(10.0, 0.2)));
/// world.walls.push(Wall::new(WallKind::Wall, shape));
/// world.trees.push(Tree::new(DVec2::new(5.0, 3.0), 0.25));
/// world.start = Some(Pose::new(1.0, 3.0, 0.0));
/// world.check()?;
/// assert_eq!(world.clearance(DVec2::new(4.0, 3.0)), 0.75);
/// # Ok::<(), envgen::world::Violation>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct World {
    schema: Schema,
    /// What made the world.
    pub provenance: Provenance,
    /// A rectangle around all parts, start and goal.
    pub bounds: Rect,
    /// Where a robot starts; absent where the generator found no free place.
    pub start: Option<Pose>,
    /// Where the robot should go.
    pub goal: Option<Pose>,
    /// Walls, kerbs and partitions.
    pub walls: Vec<Wall>,
    /// Trees.
    pub trees: Vec<Tree>,
    /// Roads.
    pub road_strips: Vec<RoadStrip>,
    /// Rooms.
    pub rooms: Vec<Room>,
    /// Openings in walls, and their doors.
    pub doorways: Vec<Doorway>,
    /// Solids that are not walls, trees or doors.
    pub obstacles: Vec<Obstacle>,
    /// Surfaces that change how a robot drives.
    pub surfaces: Vec<Surface>,
    /// Poses of people to be found. They are marks on the floor, not solids.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub victims: Vec<Pose>,
    /// A landscape's cells.
    pub raster: Option<ClassRaster>,
    /// The promises that the generator makes of this world.
    pub certificate: Vec<Claim>,
}

impl World {
    /// An empty world.
    ///
    /// ```
    /// use envgen::geometry::{Rect, Shape};
    /// use envgen::glam::DVec2;
    /// use envgen::world::{Wall, WallKind};
    /// use envgen::{Provenance, World};
    ///
    /// let source = Provenance::other("manual", serde_json::json!({ "note": "a test" }));
    /// let mut world = World::new(source, Rect::new(DVec2::ZERO, DVec2::new(10.0, 5.0)));
    /// let shape = Shape::thick_segment(DVec2::new(5.0, 0.5), DVec2::new(5.0, 3.0), 0.2, 0.0);
    /// world.walls.push(Wall::new(WallKind::Wall, shape));
    /// assert_eq!(world.check(), Ok(()));
    /// assert!((world.clearance(DVec2::new(2.9, 2.0)) - 2.0).abs() < 1e-12);
    /// ```
    pub fn new(provenance: Provenance, bounds: Rect) -> Self {
        World {
            schema: Schema,
            provenance,
            bounds,
            start: None,
            goal: None,
            walls: Vec::new(),
            trees: Vec::new(),
            road_strips: Vec::new(),
            rooms: Vec::new(),
            doorways: Vec::new(),
            obstacles: Vec::new(),
            surfaces: Vec::new(),
            victims: Vec::new(),
            raster: None,
            certificate: Vec::new(),
        }
    }

    /// Distance in metres beyond which a laser has no echo from a part; `None` where it sees the part
    /// as far as it reaches, and for parts that do not exist.
    pub fn visible_range(&self, part: PartId) -> Option<f64> {
        let index = part.index as usize;
        match part.kind {
            PartKind::Wall => self.walls.get(index)?.visible_range,
            PartKind::Obstacle => self.obstacles.get(index)?.visible_range,
            _ => None,
        }
    }
}

/// The layout version, written first and checked on reading.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Schema;

impl Serialize for Schema {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u32(SCHEMA_VERSION)
    }
}

impl<'de> Deserialize<'de> for Schema {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match u32::deserialize(deserializer)? {
            SCHEMA_VERSION => Ok(Schema),
            other => Err(de::Error::custom(format!(
                "the world file has schema version {other}, expected {SCHEMA_VERSION}"
            ))),
        }
    }
}
