//! The solid parts of a world, with start, goal and victims, as comma-separated values.
//!
//! There is one line per part under the header
//! `part,index,kind,shape,x,y,heading,length,width,radius,points,bottom,top`: the part's list and its index in that
//! list, its kind, its shape in metres and radians, and the heights of its bottom and top in metres. A `box` has a
//! centre, a heading, and its size along and across the heading; a `disc` has a centre and a radius; a `segment`
//! and a `polygon` have their points, as `x y` with semicolons between them. A `pose` is the start, the goal or a
//! victim.
//! Numbers have as many digits as are needed to read the same numbers back.

use std::io::Write;

use glam::DVec2;
use serde::Serialize;

use super::csv::io_error;
use super::error::ExportError;
use crate::geometry::{Pose, Shape};
use crate::world::{Extent, PartKind, World};

const HEADER: [&str; 13] = [
    "part", "index", "kind", "shape", "x", "y", "heading", "length", "width", "radius", "points",
    "bottom", "top",
];

/// A line of the file, with fields in the order of the header.
#[derive(Default, Serialize)]
struct Row<'a> {
    part: &'a str,
    index: Option<u32>,
    kind: String,
    shape: &'a str,
    x: Option<f64>,
    y: Option<f64>,
    heading: Option<f64>,
    length: Option<f64>,
    width: Option<f64>,
    radius: Option<f64>,
    points: String,
    bottom: Option<f64>,
    top: Option<f64>,
}

/// Writes start, goal, victims and every solid part of a world.
pub(super) fn write(world: &World, out: &mut dyn Write) -> Result<(), ExportError> {
    // The header is there without parts too.
    let mut table = csv::WriterBuilder::new().has_headers(false).from_writer(out);
    table.write_record(HEADER).map_err(io_error)?;
    let ends = [("start", world.start), ("goal", world.goal)].into_iter();
    let ends = ends.filter_map(|(name, pose)| Some((name, None, pose?)));
    let victims = (0..).zip(&world.victims).map(|(i, &pose)| ("victim", Some(i), pose));
    for (part, index, Pose { position, heading }) in ends.chain(victims) {
        let row = Row { part, index, shape: "pose", heading: Some(heading), ..at(position) };
        table.serialize(row).map_err(io_error)?;
    }
    let name = |of: &dyn Fn() -> serde_json::Result<serde_json::Value>| {
        of().ok().and_then(|name| name.as_str().map(str::to_owned)).unwrap_or_default()
    };
    for solid in world.solids() {
        let index = solid.id.index as usize;
        let (part, kind) = match solid.id.kind {
            PartKind::Wall => ("wall", name(&|| serde_json::to_value(world.walls[index].kind))),
            PartKind::Obstacle => {
                ("obstacle", name(&|| serde_json::to_value(world.obstacles[index].kind)))
            }
            PartKind::Tree => ("tree", String::new()),
            PartKind::Doorway => ("doorway", String::new()),
            _ => continue,
        };
        let extent = world.extent(solid.id);
        let row = Row {
            part,
            index: Some(solid.id.index),
            kind,
            bottom: extent.map(Extent::bottom),
            top: extent.map(Extent::top),
            ..row(&solid.shape)
        };
        table.serialize(row).map_err(io_error)?;
    }
    Ok(table.flush()?)
}

fn at(p: DVec2) -> Row<'static> {
    Row { x: Some(p.x), y: Some(p.y), ..Default::default() }
}

fn row(shape: &Shape) -> Row<'static> {
    match shape {
        Shape::Disc { center, radius } => {
            Row { shape: "disc", radius: Some(*radius), ..at(*center) }
        }
        Shape::Box { center, half_size, heading } => Row {
            shape: "box",
            heading: Some(*heading),
            length: Some(2.0 * half_size.x),
            width: Some(2.0 * half_size.y),
            ..at(*center)
        },
        Shape::Segment { .. } | Shape::Polygon { .. } => {
            let points: Vec<_> =
                shape.corners().iter().map(|p| format!("{} {}", p.x, p.y)).collect();
            let is_line = matches!(shape, Shape::Segment { .. });
            let shape = if is_line { "segment" } else { "polygon" };
            Row { shape, points: points.join(";"), ..Default::default() }
        }
    }
}
