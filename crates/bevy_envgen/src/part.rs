//! The components of a world's parts.

use std::fmt;

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use envgen::world;

/// A component or a field type that inspectors and, with `serialize`, files can read.
macro_rules! data {
    ($(#[$meta:meta])* component $($rest:tt)+) => {
        $(#[$meta])*
        #[derive(Component, Clone, Debug, PartialEq, Reflect)]
        #[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
        #[reflect(Component, Debug, PartialEq, Clone)]
        $($rest)+
    };
    ($(#[$meta:meta])* field $($rest:tt)+) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Reflect)]
        #[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
        #[reflect(Debug, PartialEq, Clone)]
        $($rest)+
    };
}

data! {
    /// The kind of a part.
    field pub enum PartKind {
        /// A [`Wall`].
        Wall,
        /// A [`Tree`].
        Tree,
        /// A [`RoadStrip`].
        RoadStrip,
        /// A [`Room`].
        Room,
        /// A [`Doorway`].
        Doorway,
        /// An [`Obstacle`].
        Obstacle,
        /// A [`Surface`].
        Surface,
        /// The [`Start`].
        Start,
        /// The [`Goal`].
        Goal,
        /// A [`Victim`].
        Victim,
        /// A block of a landscape's cells, a [`Ground`].
        Ground,
    }
}

impl PartKind {
    /// Whether parts of this kind stop robots and rays. Doorways have a separate door that may.
    pub fn is_solid(self) -> bool {
        matches!(self, PartKind::Wall | PartKind::Tree | PartKind::Obstacle)
    }

    /// Its name, such as `road strip`.
    pub fn name(self) -> &'static str {
        match self {
            PartKind::Wall => "wall",
            PartKind::Tree => "tree",
            PartKind::RoadStrip => "road strip",
            PartKind::Room => "room",
            PartKind::Doorway => "doorway",
            PartKind::Obstacle => "obstacle",
            PartKind::Surface => "surface",
            PartKind::Start => "start",
            PartKind::Goal => "goal",
            PartKind::Victim => "victim",
            PartKind::Ground => "ground",
        }
    }
}

data! {
    /// The stable name of a part: the same spec and seed always give a part the same id. It is
    /// unique within one environment.
    #[derive(Copy, Eq, PartialOrd, Ord, Hash)]
    component pub struct PartId {
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
        let kind = match self.kind {
            PartKind::Wall => world::PartKind::Wall,
            PartKind::Tree => world::PartKind::Tree,
            PartKind::RoadStrip => world::PartKind::RoadStrip,
            PartKind::Room => world::PartKind::Room,
            PartKind::Doorway => world::PartKind::Doorway,
            PartKind::Obstacle => world::PartKind::Obstacle,
            PartKind::Surface => world::PartKind::Surface,
            PartKind::Start | PartKind::Goal | PartKind::Victim | PartKind::Ground => return None,
        };
        (self.tile == [0, 0]).then_some(world::PartId { kind, index: self.index })
    }
}

impl From<world::PartId> for PartId {
    fn from(id: world::PartId) -> Self {
        let kind = match id.kind {
            world::PartKind::Wall => PartKind::Wall,
            world::PartKind::Tree => PartKind::Tree,
            world::PartKind::RoadStrip => PartKind::RoadStrip,
            world::PartKind::Room => PartKind::Room,
            world::PartKind::Doorway => PartKind::Doorway,
            world::PartKind::Obstacle => PartKind::Obstacle,
            world::PartKind::Surface => PartKind::Surface,
        };
        PartId::new(kind, id.index)
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

/// Mirrors an enum of the pure crate as one that can be reflected. Variants that a later version
/// adds become the last variant.
macro_rules! mirror {
    ($(#[$meta:meta])* $name:ident { $($(#[$doc:meta])* $variant:ident),+ } else $other:ident) => {
        data! {
            $(#[$meta])*
            field pub enum $name { $($(#[$doc])* $variant),+ }
        }

        impl From<world::$name> for $name {
            fn from(kind: world::$name) -> Self {
                match kind {
                    $(world::$name::$variant => $name::$variant,)+
                    _ => $name::$other,
                }
            }
        }
    };
}

mirror! {
    /// What a wall is part of.
    WallKind {
        /// The shell of a building or corridor.
        Wall,
        /// The wall across a corridor's end.
        EndCap,
        /// The side of an alcove.
        Alcove,
        /// A wall inside a room.
        Partition,
        /// The edge of a road.
        Kerb
    } else Wall
}

mirror! {
    /// The kind of an obstacle.
    ObstacleKind {
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
        /// A cubicle wall that has fallen over.
        Panel,
        /// A heap of rubble.
        Rubble,
        /// A flight of stairs.
        Stairs,
        /// Anything else.
        Other
    } else Other
}

data! {
    /// The kind of a surface.
    field pub enum SurfaceKind {
        /// Uneven ground.
        Uneven,
        /// Ground covered with debris.
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
}

impl From<world::SurfaceKind> for SurfaceKind {
    fn from(kind: world::SurfaceKind) -> Self {
        match kind {
            world::SurfaceKind::Debris => SurfaceKind::Debris,
            world::SurfaceKind::Water => SurfaceKind::Water,
            world::SurfaceKind::Stairs => SurfaceKind::Stairs,
            world::SurfaceKind::Hallway => SurfaceKind::Hallway,
            world::SurfaceKind::OpenArea => SurfaceKind::OpenArea,
            world::SurfaceKind::Slippery => SurfaceKind::Slippery,
            world::SurfaceKind::Loose => SurfaceKind::Loose,
            world::SurfaceKind::Class(class) => SurfaceKind::Class(class),
            _ => SurfaceKind::Uneven,
        }
    }
}

data! {
    /// Which of a room's contents a generator kept: some may be removed so that a robot can enter.
    #[derive(Default)]
    field pub enum Contents {
        /// All.
        #[default]
        AsDesigned,
        /// All but those that blocked a doorway.
        Cleared,
        /// None.
        Emptied,
        /// A maze in place of them.
        Maze,
        /// Those that were added, moved or removed by hand.
        Edited,
    }
}

impl From<world::Contents> for Contents {
    fn from(contents: world::Contents) -> Self {
        match contents {
            world::Contents::AsDesigned => Contents::AsDesigned,
            world::Contents::Cleared => Contents::Cleared,
            world::Contents::Emptied => Contents::Emptied,
            world::Contents::Maze => Contents::Maze,
            world::Contents::Edited => Contents::Edited,
        }
    }
}

data! {
    /// A wall, kerb or partition.
    component pub struct Wall {
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
    component pub struct Tree {
        /// Radius in metres.
        pub radius: f32,
    }
}

data! {
    /// A road. Its middle line is its [`PartShape`](crate::PartShape).
    component pub struct RoadStrip {
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
    component pub struct Room {
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
    component pub struct Doorway {
        /// Whether the generator left the door open.
        pub open: bool,
        /// The indices of the rooms that it joins; `None` is a hallway or the outside.
        pub rooms: [Option<u32>; 2],
    }
}

data! {
    /// A solid obstacle.
    component pub struct Obstacle {
        /// The kind of the obstacle.
        pub kind: ObstacleKind,
        /// As [`Wall::visible_range`].
        #[cfg_attr(feature = "serialize", serde(default))]
        pub visible_range: Option<f32>,
    }
}

data! {
    /// Ground that changes how robots drive.
    component pub struct Surface {
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
    component pub struct Start;
}

data! {
    /// The goal pose of a robot; the heading is the transform's x axis.
    #[derive(Copy)]
    component pub struct Goal;
}

data! {
    /// A person who is to be found.
    #[derive(Copy)]
    component pub struct Victim;
}

data! {
    /// A block of a landscape's cells. Its [`PartShape`](crate::PartShape) is the rectangle that
    /// they fill.
    component pub struct Ground {
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
    use serde::de::{DeserializeOwned, Deserializer, IntoDeserializer, Visitor};
    use serde::forward_to_deserialize_any;

    /// The variants of an enum of the pure crate as its files name them, with those that a later version adds.
    fn variants<T: DeserializeOwned>() -> &'static [&'static str] {
        struct Names<'a>(&'a mut &'static [&'static str]);

        impl<'de> Deserializer<'de> for Names<'_> {
            type Error = serde::de::value::Error;

            fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Self::Error> {
                Err(serde::de::Error::custom("not an enum"))
            }

            fn deserialize_enum<V: Visitor<'de>>(
                self,
                _: &'static str,
                names: &'static [&'static str],
                _: V,
            ) -> Result<V::Value, Self::Error> {
                *self.0 = names;
                Err(serde::de::Error::custom("names alone"))
            }

            forward_to_deserialize_any! {
                bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf
                option unit unit_struct newtype_struct seq tuple tuple_struct map struct identifier
                ignored_any
            }
        }

        let mut names: &'static [&'static str] = &[];
        assert!(T::deserialize(Names(&mut names)).is_err());
        assert!(!names.is_empty());
        names
    }

    /// A variant without fields, by its name in files.
    fn variant<T: DeserializeOwned>(name: &str) -> T {
        T::deserialize(name.into_deserializer())
            .unwrap_or_else(|error: serde::de::value::Error| panic!("{name}: {error}"))
    }

    #[test]
    fn ids_go_to_the_pure_crate_and_back() {
        for name in variants::<world::PartKind>() {
            let id = world::PartId { kind: variant(name), index: 7 };
            assert_eq!(PartId::from(id).in_world(), Some(id));
        }
        assert_eq!(PartId::new(PartKind::Start, 0).in_world(), None);
        let endless = PartId { kind: PartKind::Tree, tile: [3, -4], index: 5 };
        assert_eq!(endless.in_world(), None);
        assert_eq!(endless.to_string(), "tree 5 of tile (3, -4)");
        assert_eq!(PartId::new(PartKind::RoadStrip, 1).to_string(), "road strip 1");
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

    /// Checks that each variant of an enum of the pure crate has one of the same name here. The
    /// names come from its serde, so that a variant that a later version adds cannot be missed.
    fn check_names<T, U>(with_fields: &[&str])
    where
        T: DeserializeOwned + Into<U> + Copy + fmt::Debug,
        U: fmt::Debug,
    {
        for name in variants::<T>().iter().filter(|name| !with_fields.contains(name)) {
            let theirs: T = variant(name);
            let ours: U = theirs.into();
            assert_eq!(format!("{ours:?}"), format!("{theirs:?}"));
        }
    }

    #[test]
    fn every_kind_of_thing_keeps_its_name() {
        check_names::<world::WallKind, WallKind>(&[]);
        check_names::<world::ObstacleKind, ObstacleKind>(&[]);
        check_names::<world::Contents, Contents>(&[]);
        check_names::<world::SurfaceKind, SurfaceKind>(&["class"]);
        assert_eq!(SurfaceKind::from(world::SurfaceKind::Class(9)), SurfaceKind::Class(9));
    }
}
