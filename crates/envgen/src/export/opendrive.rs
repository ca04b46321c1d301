//! Roads as ASAM OpenDRIVE 1.7.
//!
//! Each road strip is a `road` whose reference line is the strip's centreline: lines, arcs and spirals, exactly as
//! in the world. Numbers are written with as many digits as are needed to read the same numbers back, at most 17.
//! Lanes lie beside the reference line, half of them on each side. If their number is odd, one more lies to the
//! right, and a lane offset moves the border between them to its position. A closed strip is linked to itself.
//! Kerbs and other solids are objects of the road that is nearest to them.

use std::io::Write;

use super::error::ExportError;
use super::road_objects::RoadObjects;
use super::xml::{Attribute, Xml, number};
use crate::curve::{Curve, Path};
use crate::world::{RoadStrip, World};

/// Curves that are shorter than this share of their road are due to rounding, such as the arc of a turn that is two
/// clothoids.
const ROUNDING: f64 = 1e-12;

/// Writes the roads of a world.
pub(super) fn write(world: &World, out: &mut dyn Write) -> Result<(), ExportError> {
    if world.road_strips.is_empty() {
        return Err(ExportError::Empty { part: "road" });
    }
    let mut xml = Xml::begin(out)?;
    let bounds = world.bounds;
    xml.nest("OpenDRIVE", &[], |xml| {
        xml.leaf(
            "header",
            &[
                ("revMajor", "1".into()),
                ("revMinor", "7".into()),
                ("name", world.provenance.kind.clone()),
                ("version", "1".into()),
                ("north", number(bounds.max.y)),
                ("south", number(bounds.min.y)),
                ("east", number(bounds.max.x)),
                ("west", number(bounds.min.x)),
                ("vendor", concat!("envgen ", env!("CARGO_PKG_VERSION")).into()),
            ],
        )?;
        let paths: Vec<Path<'_>> = world
            .road_strips
            .iter()
            .map(|strip| without_rounding(&strip.path().merged()))
            .collect();
        let objects = RoadObjects::of(world, &paths);
        let mut roads = world.road_strips.iter().zip(&paths).enumerate();
        roads.try_for_each(|(id, road)| write_road(xml, id, road, &objects))
    })?;
    xml.end()
}

/// Returns a path whose curves also cover what follows them because of rounding. The length stays exactly the same.
fn without_rounding(path: &Path<'_>) -> Path<'static> {
    let mut curves: Vec<Curve> = Vec::with_capacity(path.curves().len());
    for curve in path.curves() {
        match curves.last_mut() {
            Some(last) if curve.length < ROUNDING * path.length() => last.length += curve.length,
            _ => curves.push(*curve),
        }
    }
    Path::new(curves)
}

fn write_road(
    xml: &mut Xml<'_>,
    id: usize,
    (strip, path): (&RoadStrip, &Path<'_>),
    objects: &RoadObjects<'_>,
) -> Result<(), ExportError> {
    let attributes = [
        ("name", format!("road {id}")),
        ("length", number(path.length())),
        ("id", id.to_string()),
        ("junction", "-1".into()),
        ("rule", "RHT".into()),
    ];
    xml.nest("road", &attributes, |xml| {
        if strip.closed {
            xml.nest("link", &[], |xml| {
                for (name, contact) in [("predecessor", "end"), ("successor", "start")] {
                    let to = [
                        ("elementType", "road".into()),
                        ("elementId", id.to_string()),
                        ("contactPoint", contact.into()),
                    ];
                    xml.leaf(name, &to)?;
                }
                Ok(())
            })?;
        }
        xml.nest("planView", &[], |xml| {
            path.curves()
                .iter()
                .enumerate()
                .try_for_each(|(i, curve)| geometry(xml, path, i, curve))
        })?;
        lanes(xml, strip)?;
        objects.write(xml, id)
    })
}

fn geometry(
    xml: &mut Xml<'_>,
    path: &Path<'_>,
    i: usize,
    curve: &Curve,
) -> Result<(), ExportError> {
    let attributes = [
        ("s", number(path.start_of(i))),
        ("x", number(curve.start.position.x)),
        ("y", number(curve.start.position.y)),
        ("hdg", number(curve.start.heading)),
        ("length", number(curve.length)),
    ];
    xml.nest("geometry", &attributes, |xml| {
        if curve.is_line() {
            xml.leaf("line", &[])
        } else if curve.is_arc() {
            xml.leaf("arc", &[("curvature", number(curve.start_curvature))])
        } else {
            let ends = [
                ("curvStart", number(curve.start_curvature)),
                ("curvEnd", number(curve.end_curvature)),
            ];
            xml.leaf("spiral", &ends)
        }
    })
}

fn lanes(xml: &mut Xml<'_>, strip: &RoadStrip) -> Result<(), ExportError> {
    let left = i64::from(strip.lanes / 2);
    let right = i64::from(strip.lanes) - left;
    let width = strip.lane_width();
    xml.nest("lanes", &[], |xml| {
        if left != right {
            xml.leaf("laneOffset", &cubic("s", 0.5 * width))?;
        }
        xml.nest("laneSection", &[("s", number(0.0))], |xml| {
            if left > 0 {
                xml.nest("left", &[], |xml| {
                    (1..=left).rev().try_for_each(|id| lane(xml, strip, id, id == left))
                })?;
            }
            xml.nest("center", &[], |xml| {
                let attributes = lane_attributes(0, "none");
                xml.nest("lane", &attributes, |xml| road_mark(xml, left == 0))
            })?;
            xml.nest("right", &[], |xml| {
                (1..=right).try_for_each(|id| lane(xml, strip, -id, id == right))
            })
        })
    })
}

fn lane(xml: &mut Xml<'_>, strip: &RoadStrip, id: i64, outer: bool) -> Result<(), ExportError> {
    xml.nest("lane", &lane_attributes(id, "driving"), |xml| {
        if strip.closed {
            xml.nest("link", &[], |xml| {
                xml.leaf("predecessor", &[("id", id.to_string())])?;
                xml.leaf("successor", &[("id", id.to_string())])
            })?;
        }
        xml.leaf("width", &cubic("sOffset", strip.lane_width()))?;
        road_mark(xml, outer)
    })
}

/// Writes the line at a lane's outer side, which is solid at the road's edge and otherwise broken.
fn road_mark(xml: &mut Xml<'_>, edge: bool) -> Result<(), ExportError> {
    let attributes = [
        ("sOffset", number(0.0)),
        ("type", if edge { "solid" } else { "broken" }.into()),
        ("weight", "standard".into()),
        ("color", "standard".into()),
        ("width", number(0.12)),
    ];
    xml.leaf("roadMark", &attributes)
}

fn lane_attributes(id: i64, kind: &str) -> [Attribute; 3] {
    [("id", id.to_string()), ("type", kind.into()), ("level", "false".into())]
}

/// Returns the attributes of a constant cubic polynomial.
fn cubic(from: &'static str, value: f64) -> [Attribute; 5] {
    let zero = || number(0.0);
    [(from, zero()), ("a", number(value)), ("b", zero()), ("c", zero()), ("d", zero())]
}
