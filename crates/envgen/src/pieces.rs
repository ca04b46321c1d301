//! What a world consists of in three dimensions: what meshes and files of other simulators are made of.

use std::borrow::Cow;
use std::fmt;

use glam::DVec2;

use crate::geometry::Shape;
use crate::palette::{self, Srgb};
use crate::world::{
    Crown, Extent, FLOOR, PartId, PartKind, RoadStrip, SurfaceKind, Tree, WallKind, World,
};

/// Thickness in metres of what is a line in the world.
pub const LINE_THICKNESS: f64 = 0.01;

/// The ground of worlds without floors.
fn ground() -> Extent {
    let Ok(extent) = Extent::new(-0.2, FLOOR.top()) else {
        unreachable!("-0.2 is below the floor")
    };
    extent
}

/// One body of a world: a part, or a part of it.
///
/// ```
/// use envgen::pieces::{Role, pieces};
/// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
///
/// let world = IndoorSpec { width: 6, height: 6, ..Default::default() }.generate(Seed(7))?.to_world();
/// let lintels = pieces(&world).into_iter().filter(|piece| piece.role == Role::Lintel);
/// assert_eq!(lintels.count(), world.doorways.len());
/// # Ok::<(), envgen::indoor::IndoorError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Piece<'a> {
    /// The part that it belongs to; `None` for the ground.
    pub part: Option<PartId>,
    /// What it is of its part.
    pub role: Role,
    /// What the part is, as in world files: `wall`, `desk`, `tree`, `water` and so on.
    pub kind: String,
    /// Its form.
    pub form: Form<'a>,
    /// Whether it stops robots and rays.
    pub is_solid: bool,
    /// Its colour, as in pictures.
    pub color: Srgb,
}

/// What a piece is of its part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Role {
    /// The part itself; of a tree the trunk, of a doorway the closed door.
    Body,
    /// The wall over a doorway.
    Lintel,
    /// The crown of a tree.
    Crown,
    /// The floor of a room.
    Floor,
    /// The ground of worlds without floors.
    Ground,
}

impl Role {
    /// Its name in files: `body`, `lintel`, `crown`, `floor` or `ground`.
    pub fn name(self) -> &'static str {
        match self {
            Role::Body => "body",
            Role::Lintel => "lintel",
            Role::Crown => "crown",
            Role::Floor => "floor",
            Role::Ground => "ground",
        }
    }
}

/// The form of a piece.
#[derive(Clone, Debug, PartialEq)]
pub enum Form<'a> {
    /// A shape from a bottom to a top.
    Prism {
        /// Its outline from above.
        shape: Cow<'a, Shape>,
        /// Its bottom and top.
        extent: Extent,
    },
    /// An ellipsoid about a vertical axis.
    Crown {
        /// The axis, from above.
        center: DVec2,
        /// Its extent and radius.
        crown: Crown,
    },
    /// A road.
    Road {
        /// Its centreline and width.
        strip: &'a RoadStrip,
        /// Its bottom and top.
        extent: Extent,
    },
}

impl fmt::Display for Piece<'_> {
    /// A name that no other piece of its world has: `wall_3`, `doorway_0_lintel`, `ground`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(PartId { kind, index }) = self.part {
            write!(f, "{}_{index}", kind.name())?;
        }
        f.write_str(match self.role {
            Role::Body => "",
            Role::Lintel => "_lintel",
            Role::Crown => "_crown",
            Role::Floor => "_floor",
            Role::Ground => "ground",
        })
    }
}

/// Everything of a world that has a body, in the order of its lists: the ground or the floors, surfaces,
/// roads, walls, trees with their crowns, doors and lintels, and obstacles. A landscape's raster is not
/// among it; its obstacles and surfaces are.
pub fn pieces(world: &World) -> Vec<Piece<'_>> {
    let mut all = Vec::new();
    let prism = |shape, extent| Form::Prism { shape: Cow::Borrowed(shape), extent };
    let part = |kind, index: usize| Some(PartId { kind, index: index as u32 });
    let is_floor = |kind| matches!(kind, SurfaceKind::Hallway | SurfaceKind::OpenArea);
    if world.rooms.is_empty() && !world.surfaces.iter().any(|surface| is_floor(surface.kind)) {
        all.push(Piece {
            part: None,
            role: Role::Ground,
            kind: "ground".to_owned(),
            form: Form::Prism {
                shape: Cow::Owned(Shape::from_rect(world.bounds)),
                extent: ground(),
            },
            is_solid: false,
            color: palette::ROOM.fill,
        });
    }
    for (i, room) in world.rooms.iter().enumerate() {
        all.push(Piece {
            part: part(PartKind::Room, i),
            role: Role::Floor,
            kind: "room".to_owned(),
            form: prism(&room.shape, FLOOR),
            is_solid: false,
            color: palette::room_floor(room.difficulty, room.lit),
        });
    }
    for (i, surface) in world.surfaces.iter().enumerate() {
        all.push(Piece {
            part: part(PartKind::Surface, i),
            role: Role::Body,
            kind: name_of(&surface.kind),
            form: prism(&surface.shape, surface.extent()),
            is_solid: false,
            color: palette::surface(surface.kind).fill,
        });
    }
    for (i, strip) in world.road_strips.iter().enumerate() {
        all.push(Piece {
            part: part(PartKind::RoadStrip, i),
            role: Role::Body,
            kind: "road".to_owned(),
            form: Form::Road { strip, extent: strip.extent() },
            is_solid: false,
            color: palette::ROAD.fill,
        });
    }
    for (i, wall) in world.walls.iter().enumerate() {
        all.push(Piece {
            part: part(PartKind::Wall, i),
            role: Role::Body,
            kind: name_of(&wall.kind),
            form: prism(&wall.shape, wall.extent()),
            is_solid: true,
            color: palette::wall(wall.kind).fill,
        });
    }
    for (i, tree) in world.trees.iter().enumerate() {
        all.extend(tree_pieces(part(PartKind::Tree, i), tree));
    }
    let lintels = world.lintels();
    for (i, doorway) in world.doorways.iter().enumerate() {
        let part = part(PartKind::Doorway, i);
        if !doorway.open {
            all.push(Piece {
                part,
                role: Role::Body,
                kind: "door".to_owned(),
                form: prism(&doorway.shape, doorway.extent()),
                is_solid: true,
                color: palette::CLOSED_DOORWAY.fill,
            });
        }
        all.extend(lintels[i].map(|lintel| Piece {
            part,
            role: Role::Lintel,
            kind: "lintel".to_owned(),
            form: prism(&doorway.shape, lintel),
            is_solid: true,
            color: palette::wall(WallKind::Wall).fill,
        }));
    }
    for (i, obstacle) in world.obstacles.iter().enumerate() {
        all.push(Piece {
            part: part(PartKind::Obstacle, i),
            role: Role::Body,
            kind: name_of(&obstacle.kind),
            form: prism(&obstacle.shape, obstacle.extent()),
            is_solid: true,
            color: palette::obstacle(obstacle.kind).fill,
        });
    }
    all
}

fn tree_pieces<'a>(part: Option<PartId>, tree: &Tree) -> [Piece<'a>; 2] {
    let shape = Cow::Owned(Shape::Disc { center: tree.center, radius: tree.radius });
    let trunk = Piece {
        part,
        role: Role::Body,
        kind: "tree".to_owned(),
        form: Form::Prism { shape, extent: tree.trunk() },
        is_solid: true,
        color: TRUNK,
    };
    let crown = Piece {
        role: Role::Crown,
        form: Form::Crown { center: tree.center, crown: tree.crown() },
        is_solid: false,
        color: palette::TREE.fill,
        ..trunk.clone()
    };
    [trunk, crown]
}

/// Bark; pictures from above show no trunks.
const TRUNK: Srgb = Srgb::hex(0x7a_5c_43);

/// The name of a kind in world files; of a class of a landscape `class_3`.
fn name_of<T: serde::Serialize>(kind: &T) -> String {
    match serde_json::to_value(kind) {
        Ok(serde_json::Value::String(name)) => name,
        Ok(serde_json::Value::Object(fields)) => {
            fields.iter().map(|(name, number)| format!("{name}_{number}")).collect()
        }
        _ => unreachable!("kinds are names, with a number where there are several"),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::{Seed, WorldKind};

    #[test]
    fn names_are_unique_and_solids_are_those_of_the_world() {
        for &kind in WorldKind::ALL {
            let blueprint = kind.default_spec().generate(Seed(3)).unwrap();
            let world = blueprint.to_world();
            let pieces = pieces(&world);
            let names: BTreeSet<String> = pieces.iter().map(ToString::to_string).collect();
            assert_eq!(names.len(), pieces.len(), "{kind}");
            let of = |role| pieces.iter().filter(|p| p.role == role && p.is_solid).count();
            assert_eq!(of(Role::Body), world.solids().count(), "{kind}");
            assert_eq!(of(Role::Lintel), world.doorways.len(), "{kind}");
        }
    }

    #[test]
    fn kinds_have_the_names_of_files() {
        assert_eq!(name_of(&SurfaceKind::Class(3)), "class_3");
        assert_eq!(name_of(&SurfaceKind::OpenArea), "open_area");
        assert_eq!(name_of(&WallKind::EndCap), "end_cap");
    }
}
