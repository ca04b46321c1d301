//! [`World`]: the output of every generator, which everything else reads.

mod check;
mod claim;
mod digest;
mod extent;
mod heights;
mod model;
mod part;
mod part_id;
mod raster;
mod road;
mod simple_polygon;
mod solids;

pub use check::{MAX_COORDINATE, MAX_LANES, Violation};
pub use claim::Claim;
pub(crate) use claim::is_distance;
pub use digest::Digest;
pub use extent::{Extent, MAX_HEIGHT, MIN_HEIGHT};
pub use heights::Crown;
pub(crate) use heights::{DOORWAY, FLOOR, KERB, ROCK, WALL};
pub use model::{SCHEMA_VERSION, World};
pub(crate) use part::is_zero;
pub use part::{
    Contents, Doorway, Obstacle, ObstacleKind, RoadPoint, RoadStrip, Room, Surface, SurfaceKind,
    Tree, Wall, WallKind,
};
pub(crate) use part::{MAX_WHEEL_BIAS, is_visible_range};
pub use part_id::{PartId, PartKind};
pub use raster::ClassRaster;
pub use road::RoadMesh;
#[cfg(feature = "geojson")]
pub(crate) use simple_polygon::is_simple;
pub use solids::Solid;
