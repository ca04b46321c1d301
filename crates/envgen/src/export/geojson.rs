//! The parts of a world as GeoJSON (RFC 7946), in metres.
//!
//! Coordinates are those of the world, x right and y up, and not longitude and latitude, as stated by the member
//! `frame` of the collection. Each part is a feature. Its properties give its name (`part`), its kind (`kind`) and
//! whether it stops a robot (`solid`). A disc is a polygon of 64 corners on its circle, with `center` and `radius`.
//! The line of a closed road ends with its first point.

use std::io::Write;

use geojson::{Feature, FeatureCollection, Geometry, JsonObject, JsonValue, feature};
use glam::DVec2;
use serde::Serialize;
use serde_json::json;

use super::error::ExportError;
use crate::geometry::{Pose, Shape, unit_vector};
use crate::world::{PartId, PartKind, World};

/// Number of corners of the polygon that represents a disc.
const CORNERS: u32 = 64;

/// The description of the coordinates.
const FRAME: &str = "local, in metres: x right, y up; not longitude and latitude";

/// Writes the parts of a world.
pub(super) fn write(world: &World, out: &mut dyn Write) -> Result<(), ExportError> {
    let mut foreign = JsonObject::new();
    foreign.insert("frame".to_owned(), FRAME.into());
    foreign.insert("provenance".to_owned(), value(&world.provenance));
    let (min, max) = (world.bounds.min, world.bounds.max);
    let mut collection = FeatureCollection::new(features(world));
    collection.bbox = Some(vec![min.x, min.y, max.x, max.y]);
    collection.foreign_members = Some(foreign);
    let mut out = std::io::BufWriter::new(out);
    serde_json::to_writer(&mut out, &collection).map_err(std::io::Error::from)?;
    out.write_all(b"\n")?;
    Ok(out.flush()?)
}

fn features(world: &World) -> impl Iterator<Item = Feature> + '_ {
    let ends = [("start", world.start), ("goal", world.goal)].into_iter();
    let ends = ends.filter_map(|(name, pose)| Some(place(name, name.to_owned(), pose?)));
    let walls = world.walls.iter().enumerate().map(|(i, wall)| {
        let properties = json!({ "kind": value(&wall.kind), "visible_range": wall.visible_range });
        part(world, PartKind::Wall, i, &wall.shape, true, properties)
    });
    let trees = world.trees.iter().enumerate().map(|(i, tree)| {
        let shape = Shape::Disc { center: tree.center, radius: tree.radius };
        part(world, PartKind::Tree, i, &shape, true, json!({}))
    });
    let roads = world.road_strips.iter().enumerate().map(|(i, road)| {
        let again = road.centreline.first().filter(|_| road.closed);
        let points = road.centreline.iter().chain(again);
        let line = points.map(|point| position(point.pose.position));
        let properties = json!({ "closed": road.closed, "lanes": road.lanes, "width": road.width });
        of_geometry(
            world,
            PartKind::RoadStrip,
            i,
            Geometry::new_line_string(line),
            false,
            properties,
        )
    });
    let rooms = world.rooms.iter().enumerate().map(|(i, room)| {
        let properties = json!({
            "contents": value(&room.contents),
            "difficulty": room.difficulty,
            "lit": room.lit,
            "name": room.name,
        });
        part(world, PartKind::Room, i, &room.shape, false, properties)
    });
    let doorways = world.doorways.iter().enumerate().map(|(i, doorway)| {
        let properties = json!({ "open": doorway.open, "rooms": doorway.rooms });
        part(world, PartKind::Doorway, i, &doorway.shape, !doorway.open, properties)
    });
    let obstacles = world.obstacles.iter().enumerate().map(|(i, obstacle)| {
        let properties =
            json!({ "kind": value(&obstacle.kind), "visible_range": obstacle.visible_range });
        part(world, PartKind::Obstacle, i, &obstacle.shape, true, properties)
    });
    let surfaces = world.surfaces.iter().enumerate().map(|(i, surface)| {
        let properties = json!({
            "kind": value(&surface.kind),
            "odometry_noise": surface.odometry_noise,
            "speed": surface.speed,
            "wheel_bias": surface.wheel_bias,
        });
        part(world, PartKind::Surface, i, &surface.shape, false, properties)
    });
    let victims = world.victims.iter().enumerate();
    let victims = victims.map(|(i, &pose)| place("victim", format!("victim {i}"), pose));
    ends.chain(walls)
        .chain(trees)
        .chain(roads)
        .chain(rooms)
        .chain(doorways)
        .chain(obstacles)
        .chain(surfaces)
        .chain(victims)
}

fn value(of: &impl Serialize) -> JsonValue {
    serde_json::to_value(of).unwrap_or_default()
}

fn position(p: DVec2) -> [f64; 2] {
    p.to_array()
}

/// Returns a pose as a point feature.
fn place(name: &str, id: String, pose: Pose) -> Feature {
    let properties = json!({ "heading": pose.heading, "part": name, "solid": false });
    Feature {
        geometry: Some(Geometry::new_point(position(pose.position))),
        id: Some(feature::Id::String(id)),
        properties: properties.as_object().cloned(),
        ..Default::default()
    }
}

fn part(
    world: &World,
    kind: PartKind,
    index: usize,
    shape: &Shape,
    is_solid: bool,
    mut properties: JsonValue,
) -> Feature {
    let ring = |corners: &mut dyn Iterator<Item = DVec2>| {
        let mut ring: Vec<[f64; 2]> = corners.map(position).collect();
        ring.extend(ring.first().copied());
        Geometry::new_polygon([ring])
    };
    let geometry = match shape {
        Shape::Segment { a, b } => Geometry::new_line_string([position(*a), position(*b)]),
        Shape::Disc { center, radius } => {
            properties["center"] = json!(center.to_array());
            properties["radius"] = json!(radius);
            let turn = std::f64::consts::TAU / f64::from(CORNERS);
            ring(&mut (0..CORNERS).map(|i| *center + *radius * unit_vector(turn * f64::from(i))))
        }
        Shape::Box { .. } | Shape::Polygon { .. } => ring(&mut shape.corners().into_iter()),
    };
    of_geometry(world, kind, index, geometry, is_solid, properties)
}

fn of_geometry(
    world: &World,
    kind: PartKind,
    index: usize,
    geometry: Geometry,
    is_solid: bool,
    mut properties: JsonValue,
) -> Feature {
    let name = value(&kind);
    let id = format!("{} {index}", name.as_str().unwrap_or_default());
    properties["height"] = value(&world.extent(PartId { kind, index: index as u32 }));
    properties["part"] = name;
    properties["solid"] = is_solid.into();
    let properties = properties.as_object().cloned();
    // What is not known is left out.
    let known =
        properties.map(|all| all.into_iter().filter(|(_, value)| !value.is_null()).collect());
    Feature {
        geometry: Some(geometry),
        id: Some(feature::Id::String(id)),
        properties: known,
        ..Default::default()
    }
}
