//! [`World`]: what every generator makes and everything else reads.

mod check;
mod claim;
mod digest;
mod extent;
mod heights;
mod part;
mod part_id;
mod raster;
mod road;

use std::borrow::Cow;

use glam::DVec2;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

pub use check::{MAX_COORDINATE, MAX_LANES, Violation};
pub use claim::Claim;
pub use digest::Digest;
pub use extent::{Extent, MAX_HEIGHT, MIN_HEIGHT};
pub use heights::Crown;
pub(crate) use heights::{DOORWAY, FLOOR, KERB, ROCK, WALL};
pub(crate) use part::is_zero;
pub use part::{
    Contents, Doorway, Obstacle, ObstacleKind, RoadPoint, RoadStrip, Room, Surface, SurfaceKind,
    Tree, Wall, WallKind,
};
pub(crate) use part::{MAX_WHEEL_BIAS, is_visible_range};
pub use part_id::{PartId, PartKind};
pub use raster::ClassRaster;
pub use road::RoadMesh;

use crate::geometry::{Pose, Rect, Shape};
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

/// A part that stops a robot and a ray, with its shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid<'a> {
    /// Which part it is.
    pub id: PartId,
    /// Its shape in world coordinates.
    pub shape: Cow<'a, Shape>,
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

    /// Everything that stops a robot and a ray: walls, trees, closed doors and obstacles, in this
    /// order, whatever their heights. Rooms, roads and surfaces do not.
    ///
    /// ```
    /// use envgen::world::{Surface, SurfaceKind};
    /// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec, geometry::Shape};
    ///
    /// let mut world = ForestSpec::default().generate(Seed(7))?.to_world();
    /// // Water stops no ray, and is no solid.
    /// world.surfaces.push(Surface::new(SurfaceKind::Water, Shape::from_rect(world.bounds)));
    /// assert_eq!(world.solids().count(), world.trees.len());
    /// # Ok::<(), envgen::GenerateError>(())
    /// ```
    pub fn solids(&self) -> impl Iterator<Item = Solid<'_>> {
        let is_open = |id: PartId| self.doorways[id.index as usize].open;
        self.uprights().filter(move |part| part.id.kind != PartKind::Doorway || !is_open(part.id))
    }

    /// Walls, trees, doorways and obstacles, in this order.
    pub(crate) fn uprights(&self) -> impl Iterator<Item = Solid<'_>> {
        let solid =
            |kind, index: usize, shape| Solid { id: PartId { kind, index: index as u32 }, shape };
        let walls = self.walls.iter().enumerate();
        let trees = self.trees.iter().enumerate();
        let doorways = self.doorways.iter().enumerate();
        let obstacles = self.obstacles.iter().enumerate();
        walls
            .map(move |(i, wall)| solid(PartKind::Wall, i, Cow::Borrowed(&wall.shape)))
            .chain(trees.map(move |(i, tree)| {
                let shape = Shape::Disc { center: tree.center, radius: tree.radius };
                solid(PartKind::Tree, i, Cow::Owned(shape))
            }))
            .chain(doorways.map(move |(i, doorway)| {
                solid(PartKind::Doorway, i, Cow::Borrowed(&doorway.shape))
            }))
            .chain(obstacles.map(move |(i, obstacle)| {
                solid(PartKind::Obstacle, i, Cow::Borrowed(&obstacle.shape))
            }))
    }

    /// The solids that are partly within an extent, such as that of a robot's body: in the order of
    /// [`World::solids`], with the open doorways whose lintels are.
    pub fn solids_within(&self, extent: Extent) -> impl Iterator<Item = Solid<'_>> {
        self.solids_where(move |part| part.overlaps(extent))
    }

    /// The solids that a level plane meets, such as a laser's, at a height in metres above the floor: in the
    /// order of [`World::solids`], with the open doorways whose lintels it meets. None for NaN.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
    ///
    /// let spec = HallwaySpec { wall_height: 1.0, ..Default::default() };
    /// let world = spec.generate(Seed(7))?.to_world();
    /// assert_eq!(world.solids_at(0.5).count(), world.walls.len());
    /// // A laser at 1.5 m looks over the walls.
    /// assert_eq!(world.solids_at(1.5).count(), 0);
    /// # Ok::<(), envgen::GenerateError>(())
    /// ```
    pub fn solids_at(&self, height: f64) -> impl Iterator<Item = Solid<'_>> {
        self.solids_where(move |part| part.contains(height))
    }

    fn solids_where(&self, is_met: impl Fn(Extent) -> bool) -> impl Iterator<Item = Solid<'_>> {
        let lintels = self.lintels();
        self.uprights().filter(move |part| {
            let is_part_met = || self.extent(part.id).is_some_and(&is_met);
            if part.id.kind != PartKind::Doorway {
                return is_part_met();
            }
            let index = part.id.index as usize;
            let is_closed = !self.doorways[index].open;
            (is_closed && is_part_met()) || lintels[index].is_some_and(&is_met)
        })
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

    /// How many parts there are, and points and cells of parts: what the time to draw or check a world grows with.
    pub fn part_count(&self) -> usize {
        let points: usize = self.road_strips.iter().map(|strip| strip.centreline.len()).sum();
        let cells = self.raster.as_ref().map_or(0, |raster| raster.cells.len());
        points + cells + self.solids().count() + self.rooms.len() + self.surfaces.len()
    }

    /// Distance in metres from a point to the nearest solid part, infinite when there is none.
    /// Costs one step per part.
    pub fn clearance(&self, p: DVec2) -> f64 {
        self.solids().map(|solid| solid.shape.distance(p)).fold(f64::INFINITY, f64::min)
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
