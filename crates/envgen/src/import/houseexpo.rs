//! Houses of the data set HouseExpo; [`export`](crate::export) describes the format.

use std::collections::BTreeMap;
use std::io::Read;

use glam::DVec2;
use serde::Deserialize;

use super::PlanError;
use super::made_by::made_by;
use super::start::start_of_most_clearance;
use crate::file::{FileError, read_text};
use crate::geometry::{Pose, Rect, Shape};
use crate::provenance::IMPORT;
use crate::provenance::Provenance;
use crate::world::{Contents, MAX_COORDINATE, Room, Wall, WallKind, World};

const FORMAT: &str = "the JSON of a house of HouseExpo";

/// The greatest number of corners of an outline that are read.
const MAX_CORNERS: usize = 1 << 18;

/// The greatest number of rooms that are read.
const MAX_ROOMS: usize = 1 << 16;

/// Width of the ground around the outline that belongs to the world's bounds, in metres.
const MARGIN: f64 = 0.5;

/// A house. Other fields of the file are ignored.
#[derive(Deserialize)]
struct House {
    #[serde(default)]
    id: String,
    verts: Vec<[f64; 2]>,
    #[serde(default)]
    room_category: BTreeMap<String, Vec<[f64; 4]>>,
    #[serde(default)]
    start: Option<[f64; 3]>,
    #[serde(default)]
    goal: Option<[f64; 3]>,
    /// The provenance, in files of this crate.
    #[serde(default)]
    provenance: Option<serde_json::Value>,
}

/// Reads a house: walls without thickness along the outline of its free ground, and its rooms, which are rectangles
/// that may overlap. If there is no start, the point of greatest clearance inside becomes the start.
///
/// # Errors
/// When the text is not the JSON of a house, when it has too many corners or rooms, or when the world breaks an
/// invariant.
pub fn read_houseexpo(input: &mut dyn Read) -> Result<World, PlanError> {
    let house: House = serde_json::from_str(&read_text(input)?)
        .map_err(|error| PlanError::syntax(FORMAT, error.to_string()))?;
    let corners = house.verts.len();
    if !(3..=MAX_CORNERS).contains(&corners) {
        let allowed = format!("from 3 to {MAX_CORNERS} corners");
        return Err(PlanError::value("verts", corners, allowed));
    }
    let allowed = || format!("numbers from -{MAX_COORDINATE:e} to {MAX_COORDINATE:e}");
    if let Some(wrong) =
        house.verts.iter().position(|v| !v.iter().all(|x| x.abs() <= MAX_COORDINATE))
    {
        let value = format!("{:?}", house.verts[wrong]);
        return Err(PlanError::value(&format!("verts[{wrong}]"), value, allowed()));
    }
    let verts: Vec<DVec2> = house.verts.iter().copied().map(DVec2::from_array).collect();
    let bounds = Rect::around(verts.iter().copied()).map(|bounds| bounds.grown(MARGIN));
    let bounds = bounds.unwrap_or(Rect::new(DVec2::ZERO, DVec2::ONE));
    let made_by = made_by(house.provenance.as_ref());
    let source = serde_json::json!({ "format": "houseexpo", "id": house.id, "made_by": made_by });
    let mut world = World::new(Provenance::other(IMPORT, source), bounds);
    world.walls = crate::geometry::edges(&verts)
        .filter(|(a, b)| a != b)
        .map(|(a, b)| Wall::new(WallKind::Wall, Shape::Segment { a, b }))
        .collect();
    let count = house.room_category.values().map(Vec::len).sum::<usize>();
    if count > MAX_ROOMS {
        let allowed = format!("at most {MAX_ROOMS} rooms");
        return Err(PlanError::value("room_category", count, allowed));
    }
    for (name, boxes) in &house.room_category {
        for (number, &[a, b, c, d]) in boxes.iter().enumerate() {
            let floor = Rect::new(DVec2::new(a, b), DVec2::new(c, d));
            if !(floor.min.cmplt(floor.max).all() && floor.size().is_finite()) {
                let field = format!("room_category.{name}[{number}]");
                let value = format!("[{a}, {b}, {c}, {d}]");
                return Err(PlanError::value(
                    &field,
                    value,
                    "x1 < x2 and y1 < y2, in this order: x1, y1, x2, y2",
                ));
            }
            world.bounds = world.bounds.union(floor);
            world.rooms.push(Room {
                name: name.clone(),
                shape: Shape::from_rect(floor),
                difficulty: None,
                lit: true,
                contents: Contents::AsDesigned,
                height: None,
            });
        }
    }
    let pose = |[x, y, heading]: [f64; 3]| Pose::new(x, y, heading);
    (world.start, world.goal) = (house.start.map(pose), house.goal.map(pose));
    // Outside of the outline too.
    for pose in
        [world.start, world.goal].into_iter().flatten().filter(|pose| pose.position.is_finite())
    {
        world.bounds = world.bounds.union(Rect::new(pose.position, pose.position));
    }
    if world.start.is_none() && world.check().is_ok() {
        world.start = start_of_most_clearance(&world, true);
    }
    world.check().map_err(FileError::World)?;
    Ok(world)
}

/// Whether a JSON text is that of a house rather than of a world. The names of both files can end with `.json`.
pub(super) fn is_house(text: &str) -> bool {
    /// The fields that distinguish the two.
    #[derive(Deserialize)]
    struct Fields {
        verts: Option<serde::de::IgnoredAny>,
        schema: Option<serde::de::IgnoredAny>,
    }
    serde_json::from_str::<Fields>(text)
        .is_ok_and(|fields| fields.verts.is_some() && fields.schema.is_none())
}
