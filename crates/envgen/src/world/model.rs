//! The data of a world: its parts, and the version of the file layout.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use super::{
    Claim, ClassRaster, Doorway, Obstacle, PartId, PartKind, RoadStrip, Room, Surface, Tree, Wall,
};
use crate::geometry::{Pose, Rect};
use crate::provenance::Provenance;

/// The version of the layout of world files. A file of another version is refused.
pub const SCHEMA_VERSION: u32 = 1;

/// A world in metres: its parts by type, its bounds, start and goal, and its provenance.
///
/// In the frame of a world, x points right, y points up, and headings are counter-clockwise from +x. A part's
/// [`PartId`] is its list and its index in that list, so that the same spec and seed give every part the same id.
///
/// Generators make worlds, but a world can also be built by hand:
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
    /// The origin of the world: what made it, and from which settings.
    pub provenance: Provenance,
    /// A rectangle that contains all parts, the start and the goal.
    pub bounds: Rect,
    /// The pose in which a robot starts; absent if the generator found no free place.
    pub start: Option<Pose>,
    /// The pose that the robot should reach.
    pub goal: Option<Pose>,
    /// Walls, kerbs and partitions.
    pub walls: Vec<Wall>,
    /// Trees.
    pub trees: Vec<Tree>,
    /// Roads.
    pub road_strips: Vec<RoadStrip>,
    /// Rooms.
    pub rooms: Vec<Room>,
    /// Doorways: openings in walls, with their doors.
    pub doorways: Vec<Doorway>,
    /// Solids that are not walls, trees or doors.
    pub obstacles: Vec<Obstacle>,
    /// Surfaces that change how a robot drives.
    pub surfaces: Vec<Surface>,
    /// Poses of victims: people that robots should find. They are marks on the floor, not solids.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub victims: Vec<Pose>,
    /// The cells of a landscape.
    pub raster: Option<ClassRaster>,
    /// The promises that the generator makes of the world.
    pub certificate: Vec<Claim>,
}

impl World {
    /// Creates a world without parts.
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

    /// Returns the distance in metres beyond which a laser gets no echo from a part; `None` for parts that it sees
    /// at any range, and for parts that do not exist.
    pub fn visible_range(&self, part: PartId) -> Option<f64> {
        let index = part.index as usize;
        match part.kind {
            PartKind::Wall => self.walls.get(index)?.visible_range,
            PartKind::Obstacle => self.obstacles.get(index)?.visible_range,
            _ => None,
        }
    }
}

/// The layout version, which is written first and checked on reading.
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
