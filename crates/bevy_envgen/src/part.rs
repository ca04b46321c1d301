//! The components of the parts of worlds.

use std::fmt;

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use envgen::world;
pub use envgen::world::{Contents, ObstacleKind, PartKind, SurfaceKind, WallKind};

/// Defines a component that inspectors and, with the feature `serialize`, files can read.
macro_rules! data {
    ($($item:tt)+) => {
        #[derive(Component, Clone, Debug, PartialEq, Reflect)]
        #[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
        #[reflect(Component, Debug, PartialEq, Clone)]
        $($item)+
    };
}

data! {
    /// A component with the stable id of a part: with the same spec and seed, a part always has the same id.
    /// It is unique within an environment.
    #[derive(Copy, Eq, PartialOrd, Ord, Hash)]
    pub struct PartId {
        /// The kind of the part.
        pub kind: PartKind,
        /// The tile of an endless world. It is (0, 0) in a finite world.
        pub tile: [i32; 2],
        /// The index of the part among those of its kind, in the world or in the tile.
        pub index: u32,
    }
}

impl PartId {
    /// Creates the id of a part of a finite world.
    pub const fn new(kind: PartKind, index: u32) -> Self {
        PartId { kind, tile: [0, 0], index }
    }

    /// Returns the id of the part in [`envgen`], to look it up in the world or to compare it with what a ray
    /// has hit, or `None` for parts that have no id there.
    pub fn in_world(self) -> Option<world::PartId> {
        let marks = matches!(
            self.kind,
            PartKind::Start | PartKind::Goal | PartKind::Victim | PartKind::Ground
        );
        (self.tile == [0, 0] && !marks)
            .then_some(world::PartId { kind: self.kind, index: self.index })
    }
}

impl From<world::PartId> for PartId {
    fn from(id: world::PartId) -> Self {
        PartId::new(id.kind, id.index)
    }
}

/// A component with the environment that a part belongs to, on the entity of each part.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Hash, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct PartOf(#[entities] pub Entity);

impl fmt::Display for PartId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PartId { kind, tile: [i, j], index } = *self;
        write!(f, "{} {index}", kind.name())?;
        if (i, j) != (0, 0) {
            write!(f, " of tile ({i}, {j})")?;
        }
        Ok(())
    }
}

data! {
    /// A component of walls, kerbs and partitions.
    pub struct Wall {
        /// The kind of the wall.
        pub kind: WallKind,
        /// The distance in metres beyond which a laser receives no echo from the wall, since its surface is
        /// too dark, or `None` if only the range of the laser limits it.
        #[cfg_attr(feature = "serialize", serde(default))]
        pub visible_range: Option<f32>,
    }
}

data! {
    /// A component of tree trunks.
    pub struct Tree {
        /// Radius in metres.
        pub radius: f32,
    }
}

data! {
    /// A component of roads. The [`PartShape`](crate::PartShape) has the centre line, with so many points that straight
    /// edges deviate from the exact ones by at most 1 cm.
    pub struct RoadStrip {
        /// The full width in metres.
        pub width: f32,
        /// The number of lanes side by side.
        pub lanes: u32,
        /// Whether the road is a closed loop.
        pub closed: bool,
    }
}

data! {
    /// A component of rooms.
    pub struct Room {
        /// The name, which need not be unique.
        pub name: String,
        /// The difficulty on a scale from 0 to 10, or `None` if it is not annotated.
        pub difficulty: Option<f32>,
        /// Whether the room is lit.
        pub lit: bool,
        /// Whether the room still contains the obstacles on which its name and difficulty are based.
        #[cfg_attr(feature = "serialize", serde(default))]
        pub contents: Contents,
    }
}

data! {
    /// A component of doorways, which are openings in walls. A `Door` of a scenario may be in it.
    pub struct Doorway {
        /// Whether the doorway is open in the generated world.
        pub open: bool,
        /// The indices of the two rooms that the doorway connects, where `None` is a hallway or the outside.
        pub rooms: [Option<u32>; 2],
    }
}

data! {
    /// A component of solid obstacles.
    pub struct Obstacle {
        /// The kind of the obstacle.
        pub kind: ObstacleKind,
        /// The same as [`Wall::visible_range`].
        #[cfg_attr(feature = "serialize", serde(default))]
        pub visible_range: Option<f32>,
    }
}

data! {
    /// A component of areas of ground that change how robots drive.
    pub struct Surface {
        /// The kind of the surface.
        pub kind: SurfaceKind,
        /// A factor on a robot's maximum speed, from 0 (a robot cannot drive there) to 1 (plain ground).
        pub speed: f32,
        /// A factor on the variances of a robot's odometry. It is 1 for plain ground.
        pub odometry_noise: f32,
        /// By how much wheels measure distances too far, as a fraction of the driven distance.
        #[cfg_attr(feature = "serialize", serde(default))]
        pub wheel_bias: f32,
    }
}

data! {
    /// A component of the start pose of a robot. The heading is along +x of the transform.
    #[derive(Copy)]
    pub struct Start;
}

data! {
    /// A component of the goal pose of a robot. The heading is along +x of the transform.
    #[derive(Copy)]
    pub struct Goal;
}

data! {
    /// A component of a person who is to be found.
    #[derive(Copy)]
    pub struct Victim;
}

data! {
    /// A component of a block of the cells of a landscape. The [`PartShape`](crate::PartShape) is the
    /// rectangle of these cells.
    pub struct Ground {
        /// The first row of the block in the landscape, counted from the top.
        pub row: u32,
        /// The first column of the block in the landscape.
        pub col: u32,
        /// The number of columns of the block.
        pub cols: u32,
        /// The side of a cell in metres.
        pub cell: f32,
        /// The class of each cell, row by row from the top. Classes are counted from 1, and 0 means no data.
        pub classes: Vec<u16>,
    }
}

/// Registers the types for inspectors, also without Bevy's feature `reflect_auto_register`.
pub(crate) fn register(app: &mut App) {
    app.register_type::<PartId>()
        .register_type::<PartOf>()
        .register_type::<crate::PartShape>()
        .register_type::<crate::HeightRange>()
        .register_type::<Wall>()
        .register_type::<Tree>()
        .register_type::<RoadStrip>()
        .register_type::<Room>()
        .register_type::<Doorway>()
        .register_type::<Obstacle>()
        .register_type::<Surface>()
        .register_type::<Start>()
        .register_type::<Goal>()
        .register_type::<Victim>()
        .register_type::<Ground>();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_go_to_the_pure_crate_and_back() {
        let id = world::PartId { kind: PartKind::Wall, index: 7 };
        assert_eq!(PartId::from(id).in_world(), Some(id));
        assert_eq!(PartId::new(PartKind::Start, 0).in_world(), None);
        let endless = PartId { kind: PartKind::Tree, tile: [3, -4], index: 5 };
        assert_eq!(endless.in_world(), None);
        assert_eq!(endless.to_string(), "tree 5 of tile (3, -4)");
        assert_eq!(PartId::new(PartKind::RoadStrip, 1).to_string(), "road_strip 1");
    }

    #[test]
    #[cfg(feature = "serialize")]
    fn components_survive_a_file() {
        use std::fmt::Debug;

        fn there_and_back<T>(part: T)
        where
            T: serde::Serialize + serde::de::DeserializeOwned + Debug + PartialEq,
        {
            let text = ron::to_string(&part).unwrap();
            assert_eq!(ron::from_str::<T>(&text).unwrap(), part);
        }
        there_and_back(PartId { kind: PartKind::Ground, tile: [-1, 7], index: 3 });
        there_and_back(Wall { kind: WallKind::Kerb, visible_range: Some(2.0) });
        there_and_back(Doorway { open: true, rooms: [None, Some(2)] });
        let contents = Contents::Cleared;
        there_and_back(Room {
            name: "hall".to_owned(),
            difficulty: Some(2.5),
            lit: false,
            contents,
        });
        // Files from before rooms had the field `contents`.
        let old: Room = ron::from_str("(name: \"hall\", difficulty: None, lit: true)").unwrap();
        assert_eq!(old.contents, Contents::AsDesigned);
        there_and_back(Surface {
            kind: SurfaceKind::Class(4),
            speed: 0.5,
            odometry_noise: 2.0,
            wheel_bias: 0.1,
        });
        there_and_back(Start);
        there_and_back(crate::PartShape::Strip {
            centreline: vec![Vec2::ZERO, Vec2::new(1.5, -2.0)],
            width: 7.0,
            closed: false,
        });
    }
}
