//! The components of a world's parts.

use std::fmt;

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use envgen::world;
pub use envgen::world::{Contents, ObstacleKind, PartKind, SurfaceKind, WallKind};

/// A component that inspectors and, with `serialize`, files can read.
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
    /// The stable name of a part: the same spec and seed always give a part the same id. It is
    /// unique within one environment.
    #[derive(Copy, Eq, PartialOrd, Ord, Hash)]
    pub struct PartId {
        /// The kind of the part.
        pub kind: PartKind,
        /// The tile of an endless world, (0, 0) in a finite one.
        pub tile: [i32; 2],
        /// The index in the list of that kind, of the world or of the tile.
        pub index: u32,
    }
}

impl PartId {
    /// A part of a finite world.
    pub const fn new(kind: PartKind, index: u32) -> Self {
        PartId { kind, tile: [0, 0], index }
    }

    /// Its id in [`envgen`], for finding it in the world or comparing it with what a ray met;
    /// `None` for parts that have none there.
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

/// The environment that a part belongs to, on the entity of each part.
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
    /// A wall, kerb or partition.
    pub struct Wall {
        /// What it is part of.
        pub kind: WallKind,
        /// Distance in metres beyond which a laser has no echo from it, since it is too dark; `None`
        /// where lasers see it as far as they reach.
        #[cfg_attr(feature = "serialize", serde(default))]
        pub visible_range: Option<f32>,
    }
}

data! {
    /// A tree trunk.
    pub struct Tree {
        /// Radius in metres.
        pub radius: f32,
    }
}

data! {
    /// A road. Its middle line is its [`PartShape`](crate::PartShape).
    pub struct RoadStrip {
        /// Full width in metres.
        pub width: f32,
        /// Number of lanes side by side.
        pub lanes: u32,
        /// Whether the end joins the start.
        pub closed: bool,
    }
}

data! {
    /// A room.
    pub struct Room {
        /// Name, not necessarily unique.
        pub name: String,
        /// Difficulty on the scale from 0 to 10, `None` where none is annotated.
        pub difficulty: Option<f32>,
        /// Whether the room is lit.
        pub lit: bool,
        /// Whether it still holds what its name and difficulty are based on.
        #[cfg_attr(feature = "serialize", serde(default))]
        pub contents: Contents,
    }
}

data! {
    /// An opening in a wall. A `Door` of a scenario may be in it.
    pub struct Doorway {
        /// Whether the generator left the door open.
        pub open: bool,
        /// The indices of the rooms that it joins; `None` is a hallway or the outside.
        pub rooms: [Option<u32>; 2],
    }
}

data! {
    /// A solid obstacle.
    pub struct Obstacle {
        /// The kind of the obstacle.
        pub kind: ObstacleKind,
        /// As [`Wall::visible_range`].
        #[cfg_attr(feature = "serialize", serde(default))]
        pub visible_range: Option<f32>,
    }
}

data! {
    /// Ground that changes how robots drive.
    pub struct Surface {
        /// The kind of the surface.
        pub kind: SurfaceKind,
        /// Factor on a robot's maximum speed, from 0 (cannot drive there) to 1 (plain ground).
        pub speed: f32,
        /// Factor on the variances of a robot's odometry, 1 for plain ground.
        pub odometry_noise: f32,
        /// How much too far wheels measure, as a fraction of the distance that was driven.
        #[cfg_attr(feature = "serialize", serde(default))]
        pub wheel_bias: f32,
    }
}

data! {
    /// The start pose of a robot; the heading is the transform's x axis.
    #[derive(Copy)]
    pub struct Start;
}

data! {
    /// The goal pose of a robot; the heading is the transform's x axis.
    #[derive(Copy)]
    pub struct Goal;
}

data! {
    /// A person who is to be found.
    #[derive(Copy)]
    pub struct Victim;
}

data! {
    /// A block of a landscape's cells. Its [`PartShape`](crate::PartShape) is the rectangle that
    /// they fill.
    pub struct Ground {
        /// The block's first row of the landscape, counted from the top.
        pub row: u32,
        /// The block's first column.
        pub col: u32,
        /// Number of columns of the block.
        pub cols: u32,
        /// Side of a cell in metres.
        pub cell: f32,
        /// Class of each cell, counted from 1; 0 is no data. Row by row from the top.
        pub classes: Vec<u16>,
    }
}

/// Registers the types for inspectors, also without Bevy's `reflect_auto_register`.
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
