//! The bodies of a world in three dimensions, from which meshes and files of other simulators are made.

use std::borrow::Cow;
use std::fmt;

use glam::DVec2;

use crate::geometry::Shape;
use crate::palette::{self, Srgb};
use crate::world::{
    Crown, Extent, FLOOR, PartId, PartKind, RoadStrip, Room, Tree, WallKind, World,
};

/// Thickness in metres of the body of a part that is a line in the plane.
pub const LINE_THICKNESS: f64 = 0.01;

/// Thickness of the ground in metres.
const GROUND_THICKNESS: f64 = 0.2;

/// The depth in metres of the ground below the lowest floor of a world. It is seen in doorways and wherever else no
/// floor lies. Wheels pass over such a step, and renderers tell the two apart at the distances of a building.
const BELOW_FLOORS: f64 = 0.002;

/// A body in three dimensions: a part of a world, or a component of one, such as the crown of a tree.
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
    /// Which component of its part it is.
    pub role: Role,
    /// The kind of the part, as in world files: `wall`, `desk`, `tree`, `water` and so on.
    pub kind: String,
    /// Its geometric form.
    pub form: Form<'a>,
    /// Whether it stops robots and rays.
    pub is_solid: bool,
    /// Its colour, as in pictures from above.
    pub color: Srgb,
}

/// Which component of its part a piece is.
///
/// ```
/// use envgen::pieces::{Role, pieces};
/// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec};
///
/// // Each tree has a trunk that is solid, and a crown that is not.
/// let world = ForestSpec::default().generate(Seed(7))?.to_world();
/// let pieces = pieces(&world);
/// let crowns: Vec<_> = pieces.iter().filter(|piece| piece.role == Role::Crown).collect();
/// assert_eq!(crowns.len(), world.trees.len());
/// assert!(crowns.iter().all(|crown| !crown.is_solid));
/// # Ok::<(), envgen::GenerateError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Role {
    /// The part itself; the trunk of a tree, or the closed door of a doorway.
    Body,
    /// The wall over a doorway.
    Lintel,
    /// The crown of a tree.
    Crown,
    /// The floor of a room.
    Floor,
    /// The ceiling over a room or hallway.
    Ceiling,
    /// The ground, which is seen where no floor lies.
    Ground,
}

impl Role {
    /// Returns its name in files: `body`, `lintel`, `crown`, `floor`, `ceiling` or `ground`.
    pub fn name(self) -> &'static str {
        match self {
            Role::Body => "body",
            Role::Lintel => "lintel",
            Role::Crown => "crown",
            Role::Floor => "floor",
            Role::Ceiling => "ceiling",
            Role::Ground => "ground",
        }
    }
}

/// The geometric form of a piece.
#[derive(Clone, Debug, PartialEq)]
pub enum Form<'a> {
    /// A shape in the plane, extruded from a bottom to a top.
    Prism {
        /// Its outline, seen from above.
        shape: Cow<'a, Shape>,
        /// Its bottom and top.
        extent: Extent,
    },
    /// An ellipsoid with a vertical axis: the crown of a tree.
    Crown {
        /// Position of the axis in the plane.
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

impl Form<'_> {
    /// Returns the bottom and top of the form.
    pub fn extent(&self) -> Extent {
        match self {
            Form::Prism { extent, .. } | Form::Road { extent, .. } => *extent,
            Form::Crown { crown, .. } => crown.extent,
        }
    }
}

impl fmt::Display for Piece<'_> {
    /// Writes a name that no other piece of the world has, such as `wall_3`, `doorway_0_lintel` or `ground`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(PartId { kind, index }) = self.part {
            write!(f, "{}_{index}", kind.name())?;
        }
        f.write_str(match self.role {
            Role::Body => "",
            Role::Lintel => "_lintel",
            Role::Crown => "_crown",
            Role::Floor => "_floor",
            Role::Ceiling => "_ceiling",
            Role::Ground => "ground",
        })
    }
}

/// Returns all pieces of a world, in the order of its lists: the ground, floors, surfaces, roads, walls,
/// trees with their crowns, doors and lintels, and obstacles. The raster of a landscape has no pieces; its
/// obstacles and surfaces have.
pub fn pieces(world: &World) -> Vec<Piece<'_>> {
    let mut all = vec![ground_of(world)];
    let lintels = world.lintels();
    let lists = [
        (PartKind::Room, world.rooms.len()),
        (PartKind::Surface, world.surfaces.len()),
        (PartKind::RoadStrip, world.road_strips.len()),
        (PartKind::Wall, world.walls.len()),
        (PartKind::Tree, world.trees.len()),
        (PartKind::Doorway, world.doorways.len()),
        (PartKind::Obstacle, world.obstacles.len()),
    ];
    for (kind, length) in lists {
        for i in 0..length {
            let lintel = lintels.get(i).filter(|_| kind == PartKind::Doorway).copied().flatten();
            all.extend(pieces_of(world, PartId { kind, index: i as u32 }, lintel));
        }
    }
    all
}

/// Returns the ground of a world, as large as its bounds. Its top is the plane on which robots drive or, in a world
/// with floors, 2 mm below the lowest of them.
pub fn ground_of(world: &World) -> Piece<'_> {
    let rooms = world.rooms.iter().map(|room| floor_of(room).top());
    let halls = world.surfaces.iter().filter(|surface| surface.kind.is_hall());
    let floors = rooms.chain(halls.map(|hall| hall.extent().top()));
    let lowest = floors.reduce(f64::min).map(|floor| floor.min(FLOOR.top()) - BELOW_FLOORS);
    let top = lowest.unwrap_or(FLOOR.top());
    let extent = Extent::between(top - GROUND_THICKNESS, top);
    Piece {
        part: None,
        role: Role::Ground,
        kind: "ground".to_owned(),
        form: Form::Prism { shape: Cow::Owned(Shape::from_rect(world.bounds)), extent },
        is_solid: false,
        color: palette::ROOM.fill,
    }
}

/// Returns the ceilings over rooms, hallways and open areas. They are not among [`pieces`], because worlds are
/// shown without them; a camera inside a building sees them.
pub fn ceilings(world: &World) -> Vec<Piece<'_>> {
    let part = |kind, index: usize| PartId { kind, index: index as u32 };
    let rooms = (0..world.rooms.len()).map(|i| part(PartKind::Room, i));
    let surfaces = (0..world.surfaces.len()).map(|i| part(PartKind::Surface, i));
    let wall_top = world.wall_top();
    rooms.chain(surfaces).filter_map(|part| ceiling_of(world, part, wall_top)).collect()
}

/// Returns the ceiling over a room, hallway or open area; `None` for other parts. `wall_top` is [`World::wall_top`].
pub fn ceiling_of(world: &World, part: PartId, wall_top: f64) -> Option<Piece<'_>> {
    let index = part.index as usize;
    let (shape, bottom) = match part.kind {
        PartKind::Room => {
            let room = world.rooms.get(index)?;
            (&room.shape, room.extent().top())
        }
        PartKind::Surface => {
            let surface = world.surfaces.get(index).filter(|surface| surface.kind.is_hall())?;
            (&surface.shape, wall_top)
        }
        _ => return None,
    };
    let extent = Extent::between(bottom, bottom + CEILING_THICKNESS);
    Some(Piece {
        part: Some(part),
        role: Role::Ceiling,
        kind: "ceiling".to_owned(),
        form: Form::Prism { shape: Cow::Borrowed(shape), extent },
        is_solid: false,
        color: palette::ROOM.fill,
    })
}

/// Returns the bottom and top of the floor of a room, which is as thick as the floors elsewhere.
fn floor_of(room: &Room) -> Extent {
    let top = room.extent().bottom();
    Extent::between(top + FLOOR.bottom(), top)
}

/// Thickness of ceilings in metres.
const CEILING_THICKNESS: f64 = 0.1;

/// Returns the pieces of one part: two for a tree, and none for an open doorway without a lintel or for a part that
/// does not exist. For a doorway, `lintel` is its element of [`World::lintels`].
pub fn pieces_of(world: &World, part: PartId, lintel: Option<Extent>) -> Vec<Piece<'_>> {
    bodies(world, part, lintel).unwrap_or_default()
}

fn bodies(world: &World, part: PartId, lintel: Option<Extent>) -> Option<Vec<Piece<'_>>> {
    let index = part.index as usize;
    let prism = |shape, extent| Form::Prism { shape: Cow::Borrowed(shape), extent };
    let body = |kind: String, form, is_solid, color| {
        vec![Piece { part: Some(part), role: Role::Body, kind, form, is_solid, color }]
    };
    Some(match part.kind {
        PartKind::Room => {
            let room = world.rooms.get(index)?;
            vec![Piece {
                part: Some(part),
                role: Role::Floor,
                kind: "room".to_owned(),
                form: prism(&room.shape, floor_of(room)),
                is_solid: false,
                color: palette::room_floor(room.difficulty, room.lit),
            }]
        }
        PartKind::Surface => {
            let surface = world.surfaces.get(index)?;
            let form = prism(&surface.shape, surface.extent());
            body(name_of(&surface.kind), form, false, palette::surface(surface.kind).fill)
        }
        PartKind::RoadStrip => {
            let strip = world.road_strips.get(index)?;
            let form = Form::Road { strip, extent: strip.extent() };
            body("road".to_owned(), form, false, palette::ROAD.fill)
        }
        PartKind::Wall => {
            let wall = world.walls.get(index)?;
            let form = prism(&wall.shape, wall.extent());
            body(name_of(&wall.kind), form, true, palette::wall(wall.kind).fill)
        }
        PartKind::Tree => tree_pieces(Some(part), world.trees.get(index)?).into(),
        PartKind::Doorway => {
            let doorway = world.doorways.get(index)?;
            let mut pieces = Vec::new();
            if !doorway.open {
                let form = prism(&doorway.shape, doorway.extent());
                let color = palette::CLOSED_DOORWAY.fill;
                pieces = body("door".to_owned(), form, true, color);
            }
            pieces.extend(lintel.map(|lintel| Piece {
                part: Some(part),
                role: Role::Lintel,
                kind: "lintel".to_owned(),
                form: prism(&doorway.shape, lintel),
                is_solid: true,
                color: palette::wall(WallKind::Wall).fill,
            }));
            pieces
        }
        PartKind::Obstacle => {
            let obstacle = world.obstacles.get(index)?;
            let form = prism(&obstacle.shape, obstacle.extent());
            body(name_of(&obstacle.kind), form, true, palette::obstacle(obstacle.kind).fill)
        }
        PartKind::Start | PartKind::Goal | PartKind::Victim | PartKind::Ground => return None,
    })
}

/// Returns the trunk and the crown of a tree, which need not be part of a world.
pub fn tree_pieces<'a>(part: Option<PartId>, tree: &Tree) -> [Piece<'a>; 2] {
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

/// The colour of bark. Pictures from above do not show trunks.
const TRUNK: Srgb = Srgb::hex(0x7a_5c_43);

/// Returns the name of a kind in world files, which is `class_3` for class 3 of a landscape.
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
    use crate::indoor::IndoorSpec;
    use crate::world::SurfaceKind;
    use crate::{Blueprint, Seed, Spec, WorldKind};

    #[test]
    fn names_are_unique_and_solids_are_those_of_the_world() {
        for &kind in WorldKind::ALL {
            let blueprint = kind.default_spec().generate(Seed(3)).unwrap();
            let world = blueprint.to_world();
            let pieces = pieces(&world);
            let ceilings = ceilings(&world);
            let all = || pieces.iter().chain(&ceilings);
            let names: BTreeSet<String> = all().map(ToString::to_string).collect();
            assert_eq!(names.len(), all().count(), "{kind}");
            let of = |role| pieces.iter().filter(|p| p.role == role && p.is_solid).count();
            assert_eq!(of(Role::Body), world.solids().count(), "{kind}");
            assert_eq!(of(Role::Lintel), world.doorways.len(), "{kind}");
        }
    }

    #[test]
    fn there_is_ground_wherever_a_robot_can_be() {
        let top = |piece: &Piece<'_>| piece.form.extent().top();
        for &kind in WorldKind::ALL {
            let mut world = kind.default_spec().generate(Seed(3)).unwrap().to_world();
            let bodies = |world: &World| -> Vec<(f64, Shape)> {
                let pieces = pieces(world);
                let ground = pieces.iter().filter(|piece| piece.role == Role::Ground);
                assert_eq!(ground.count(), 1, "{kind}");
                let prisms = pieces.iter().filter_map(|piece| match &piece.form {
                    Form::Prism { shape, .. } if !piece.is_solid => {
                        Some((top(piece), shape.clone().into_owned()))
                    }
                    _ => None,
                });
                prisms.collect()
            };
            let all = bodies(&world);
            let doorways = world.doorways.iter().map(|doorway| doorway.shape.bounds().center());
            for place in doorways.chain(world.start.map(|start| start.position)) {
                let below = all.iter().filter(|(_, shape)| shape.contains(place));
                let highest = below.map(|(top, _)| *top).fold(f64::NEG_INFINITY, f64::max);
                assert!((-0.003..=0.06).contains(&highest), "{kind}: {highest} m at {place}");
            }
            // A floor is not hidden below the ground, however deep it lies.
            let Some(room) = world.rooms.first_mut() else { continue };
            room.height = Some(Extent::between(-1.0, 2.0));
            let ground = ground_of(&world);
            assert!(top(&ground) < -1.0 && top(&ground) > -1.01, "{kind}");
        }
    }

    #[test]
    fn ceilings_rest_on_the_walls() {
        for wall_height in [2.0, 2.6, 4.0] {
            let spec = IndoorSpec {
                wall_height,
                doorway_height: 1.9,
                width: 8,
                height: 8,
                ..Default::default()
            };
            let world = spec.generate(Seed(3)).unwrap().to_world();
            let ceilings = ceilings(&world);
            assert!(ceilings.len() > world.rooms.len());
            for piece in ceilings {
                let Form::Prism { extent, .. } = piece.form else { panic!("{}", piece.kind) };
                assert_eq!(extent.bottom(), wall_height, "{:?}", piece.part);
            }
        }
    }

    #[test]
    fn kinds_have_the_names_of_files() {
        assert_eq!(name_of(&SurfaceKind::Class(3)), "class_3");
        assert_eq!(name_of(&SurfaceKind::OpenArea), "open_area");
        assert_eq!(name_of(&WallKind::EndCap), "end_cap");
    }

    #[test]
    fn the_floor_of_a_room_is_at_its_bottom() {
        let spec = IndoorSpec::default();
        let mut world = spec.generate(Seed(7)).unwrap().to_world();
        world.rooms[0].height = Some(Extent::between(-1.0, 2.0));
        let floor = |room: u32| {
            let part = PartId { kind: PartKind::Room, index: room };
            match &pieces_of(&world, part, None)[0].form {
                Form::Prism { extent, .. } => *extent,
                _ => panic!("a floor is a prism"),
            }
        };
        assert_eq!(floor(0), Extent::between(-1.1, -1.0));
        assert_eq!(floor(1), FLOOR);
    }
}
