//! Worlds for Gazebo, as SDFormat 1.9.
//!
//! The static model `parts` has a link for each piece of the world, with the name of the piece. The link has a
//! collision and a visual with the name of the piece's kind: boxes, cylinders and extruded outlines. Floors,
//! surfaces and crowns have no collision. The model `floor` is a plane on which robots drive. Start, goal
//! and victims are frames. The provenance is an element of the namespace `envgen`, which readers skip.

use std::io::Write;

use glam::DVec2;

use super::body::Body;
use super::error::ExportError;
use super::places::places;
use super::xml::{Xml, number, numbers};
use crate::palette::Srgb;
use crate::pieces::{Form, Piece, pieces};
use crate::world::World;

/// The namespace of the element that is not part of SDFormat.
const NAMESPACE: &str = "https://docs.rs/envgen";

/// Writes a world.
pub(super) fn write(world: &World, out: &mut dyn Write) -> Result<(), ExportError> {
    let provenance = serde_json::to_string(&world.provenance).map_err(std::io::Error::from)?;
    let mut xml = Xml::begin(out)?;
    let root = [("version", "1.9".to_owned()), ("xmlns:envgen", NAMESPACE.to_owned())];
    xml.nest("sdf", &root, |xml| {
        xml.nest("world", &[("name", world.provenance.kind.clone())], |xml| {
            xml.text("envgen:provenance", &provenance)?;
            for (name, pose) in places(world) {
                xml.nest("frame", &[("name", name)], |xml| {
                    self::pose(xml, pose.position, 0.0, pose.heading)
                })?;
            }
            sun(xml)?;
            floor(xml, world)?;
            model(xml, "parts", |xml| pieces(world).iter().try_for_each(|piece| link(xml, piece)))
        })
    })?;
    xml.end()
}

fn model(
    xml: &mut Xml<'_>,
    name: &str,
    links: impl FnOnce(&mut Xml<'_>) -> Result<(), ExportError>,
) -> Result<(), ExportError> {
    xml.nest("model", &[("name", name.to_owned())], |xml| {
        xml.text("static", "true")?;
        links(xml)
    })
}

fn sun(xml: &mut Xml<'_>) -> Result<(), ExportError> {
    let attributes = [("name", "sun".to_owned()), ("type", "directional".to_owned())];
    xml.nest("light", &attributes, |xml| {
        xml.text("pose", "0 0 10 0 0 0")?;
        xml.text("cast_shadows", "true")?;
        xml.text("diffuse", "0.8 0.8 0.8 1")?;
        xml.text("direction", "-0.4 0.2 -0.9")
    })
}

/// Writes the plane on which robots drive.
fn floor(xml: &mut Xml<'_>, world: &World) -> Result<(), ExportError> {
    model(xml, "floor", |xml| {
        xml.nest("link", &[("name", "floor".to_owned())], |xml| {
            pose(xml, world.bounds.center(), 0.0, 0.0)?;
            xml.nest("collision", &[("name", "floor".to_owned())], |xml| {
                xml.nest("geometry", &[], |xml| {
                    xml.nest("plane", &[], |xml| {
                        xml.text("normal", "0 0 1")?;
                        xml.text("size", &numbers(world.bounds.size().to_array()))
                    })
                })
            })
        })
    })
}

fn link(xml: &mut Xml<'_>, piece: &Piece<'_>) -> Result<(), ExportError> {
    let (place, height, heading) = match &piece.form {
        Form::Prism { shape, extent } => match Body::of(shape, *extent) {
            Body::Box { center, heading, .. } => (center.truncate(), center.z, heading),
            Body::Cylinder { center, .. } => (center.truncate(), center.z, 0.0),
            // An outline is drawn upwards from its frame.
            Body::Polygon { .. } => (shape.bounds().center(), extent.bottom(), 0.0),
        },
        Form::Crown { center, crown } => {
            (*center, 0.5 * (crown.extent.bottom() + crown.extent.top()), 0.0)
        }
        // The plane is driven on: the kerbs show where the road is.
        Form::Road { .. } => return Ok(()),
    };
    let kind = [("name", piece.kind.clone())];
    xml.nest("link", &[("name", piece.to_string())], |xml| {
        pose(xml, place, height, heading)?;
        if piece.is_solid {
            // Siblings must have different names, also of other elements.
            let collision = [("name", format!("{}_collision", piece.kind))];
            xml.nest("collision", &collision, |xml| geometry(xml, &piece.form))?;
        }
        xml.nest("visual", &kind, |xml| {
            geometry(xml, &piece.form)?;
            let color = color(piece.color);
            xml.nest("material", &[], |xml| {
                xml.text("ambient", &color)?;
                xml.text("diffuse", &color)
            })
        })
    })
}

fn geometry(xml: &mut Xml<'_>, form: &Form<'_>) -> Result<(), ExportError> {
    xml.nest("geometry", &[], |xml| match form {
        Form::Prism { shape, extent } => match Body::of(shape, *extent) {
            Body::Box { size, .. } => {
                xml.nest("box", &[], |xml| xml.text("size", &numbers(size.to_array())))
            }
            Body::Cylinder { radius, length, .. } => xml.nest("cylinder", &[], |xml| {
                xml.text("radius", &number(radius))?;
                xml.text("length", &number(length))
            }),
            Body::Polygon { corners } => xml.nest("polyline", &[], |xml| {
                let middle = shape.bounds().center();
                for corner in corners {
                    xml.text("point", &numbers((*corner - middle).to_array()))?;
                }
                xml.text("height", &number(extent.height()))
            }),
        },
        Form::Crown { crown, .. } => xml.nest("ellipsoid", &[], |xml| {
            let radii = [crown.radius, crown.radius, 0.5 * crown.extent.height()];
            xml.text("radii", &numbers(radii))
        }),
        Form::Road { .. } => Ok(()),
    })
}

fn pose(xml: &mut Xml<'_>, at: DVec2, height: f64, heading: f64) -> Result<(), ExportError> {
    xml.text("pose", &numbers([at.x, at.y, height, 0.0, 0.0, heading]))
}

fn color(Srgb(rgb): Srgb) -> String {
    numbers(rgb.map(|part| f64::from(part) / 255.0).into_iter().chain([1.0]))
}
