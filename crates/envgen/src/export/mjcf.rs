//! Worlds for MuJoCo, as MJCF.
//!
//! Each piece of the world is a geom of the world body with the name of the piece. Its material has the name of the
//! piece's kind. Geoms are boxes, cylinders and ellipsoids. Outlines of other forms are meshes; because MuJoCo takes
//! the convex hull of a mesh, those that are not convex are divided into convex pieces: `obstacle_3`, `obstacle_3.1`
//! and so on. Pieces that are too thin for meshes are boxes. Floors, surfaces and crowns do not collide; robots drive
//! on the plane `floor`. Start, goal and victims are sites. The provenance is a custom text. Middle and extent of the
//! model are stated, and with them planes between which cameras see the whole world from 1 cm on; the near plane would
//! otherwise be 1 % of the extent that MuJoCo computes.

use std::collections::BTreeSet;
use std::io::Write;

use glam::{DVec2, DVec3};

use super::body::Body;
use super::error::ExportError;
use super::places::places;
use super::xml::{Attribute, Xml, number, numbers};
use crate::geometry::edges;
use crate::mesh::convex_pieces;
use crate::palette::Srgb;
use crate::pieces::{Form, Piece, pieces};
use crate::world::{Extent, World};

/// Half the distance between the lines that MuJoCo draws on the floor, in metres.
const GRID: f64 = 0.5;

/// The distance in metres from which on cameras see bodies.
const NEAR: f64 = 0.01;

/// The distance up to which cameras see, in extents of the world. Its diagonal has less than four.
const FAR: f64 = 10.0;

/// The least thickness in metres of a convex piece of an outline; thinner pieces are left out.
const THINNEST: f64 = 1e-7;

/// The least thickness of a mesh as a share of its greatest coordinate, because MuJoCo's corners have 32 bits, and it
/// refuses meshes whose corners lie in one plane.
const SINGLE: f64 = 4.0 * f32::EPSILON as f64;

/// A convex piece of an outline: its name, its position, and its corners relative to that position.
struct Hull {
    name: String,
    place: DVec2,
    corners: Vec<DVec2>,
    extent: Extent,
    /// Whether it is a box, since it is too thin for a mesh.
    is_thin: bool,
}

/// Writes a world.
pub(super) fn write(world: &World, out: &mut dyn Write) -> Result<(), ExportError> {
    let provenance = serde_json::to_string(&world.provenance).map_err(std::io::Error::from)?;
    let pieces = pieces(world);
    let mut hulls = Vec::with_capacity(pieces.len());
    for piece in &pieces {
        hulls.push(hulls_of(piece)?);
    }
    let kinds: BTreeSet<&str> = pieces.iter().map(|piece| piece.kind.as_str()).collect();
    let mut xml = Xml::begin(out)?;
    xml.nest("mujoco", &[("model", world.provenance.kind.clone())], |xml| {
        xml.leaf("compiler", &[("angle", "radian".into())])?;
        planes(xml, world, &pieces)?;
        xml.nest("custom", &[], |xml| {
            xml.leaf("text", &[("name", "provenance".into()), ("data", provenance)])
        })?;
        xml.nest("asset", &[], |xml| {
            for name in kinds {
                xml.leaf("material", &[("name", name.to_owned())])?;
            }
            hulls.iter().flatten().filter(|hull| !hull.is_thin).try_for_each(|hull| {
                let ends = [hull.extent.bottom(), hull.extent.top()];
                let corners =
                    ends.into_iter().flat_map(|z| hull.corners.iter().map(move |p| p.extend(z)));
                let vertex = numbers(corners.flat_map(|corner| corner.to_array()));
                xml.leaf("mesh", &[("name", hull.name.clone()), ("vertex", vertex)])
            })
        })?;
        xml.nest("worldbody", &[], |xml| {
            let sun = [
                ("directional", "true".into()),
                ("pos", "0 0 10".into()),
                ("dir", "-0.4 0.2 -0.9".into()),
            ];
            xml.leaf("light", &sun)?;
            floor(xml, world)?;
            for (name, pose) in places(world) {
                let pos = numbers(pose.position.extend(0.0).to_array());
                let euler = numbers([0.0, 0.0, pose.heading]);
                xml.leaf("site", &[("name", name), ("pos", pos), ("euler", euler)])?;
            }
            pieces.iter().zip(&hulls).try_for_each(|(piece, hulls)| geoms(xml, piece, hulls))
        })
    })?;
    xml.end()
}

/// Writes the middle and the extent of the model, and the near and far planes of cameras, which are fractions of the
/// extent.
fn planes(xml: &mut Xml<'_>, world: &World, pieces: &[Piece<'_>]) -> Result<(), ExportError> {
    let extents = || pieces.iter().map(|piece| piece.form.extent());
    let bottom = extents().map(Extent::bottom).fold(0.0, f64::min);
    let top = extents().map(Extent::top).fold(0.0, f64::max);
    let center = world.bounds.center().extend(0.5 * (bottom + top));
    let extent = 0.5 * world.bounds.size().max_element().max(top - bottom);
    let statistic = [("center", numbers(center.to_array())), ("extent", number(extent))];
    xml.leaf("statistic", &statistic)?;
    xml.nest("visual", &[], |xml| {
        xml.leaf("map", &[("znear", number(NEAR / extent)), ("zfar", number(FAR))])
    })
}

/// Returns the convex pieces of an outline; an empty list for other forms.
fn hulls_of(piece: &Piece<'_>) -> Result<Vec<Hull>, ExportError> {
    let Form::Prism { shape, extent } = &piece.form else { return Ok(Vec::new()) };
    let Body::Polygon { corners } = Body::of(shape, *extent) else { return Ok(Vec::new()) };
    let place = shape.bounds().center();
    let around: Vec<DVec2> = corners.iter().map(|corner| *corner - place).collect();
    let name = piece.to_string();
    let convex =
        convex_pieces(&around).ok_or_else(|| crate::mesh::MeshError { piece: name.clone() })?;
    let farthest = around.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    Ok(convex
        .into_iter()
        .map(|corners| corners.into_iter().map(|i| around[i as usize]).collect::<Vec<_>>())
        .map(|corners| (thickness(&corners), corners))
        .filter(|(thickness, _)| *thickness >= THINNEST)
        .enumerate()
        .map(|(i, (thickness, corners))| Hull {
            name: if i == 0 { name.clone() } else { format!("{name}.{i}") },
            place,
            corners,
            extent: *extent,
            is_thin: thickness < SINGLE * farthest,
        })
        .collect())
}

/// Returns how thick a convex polygon is: the distance of the farthest corner from the line through the longest side.
fn thickness(corners: &[DVec2]) -> f64 {
    let (start, along) = longest_side(corners);
    corners.iter().map(|corner| along.perp_dot(*corner - start)).fold(0.0, f64::max)
}

/// Returns the start and the direction of the longest side of a polygon.
fn longest_side(corners: &[DVec2]) -> (DVec2, DVec2) {
    let longest = edges(corners).max_by(|(a, b), (c, d)| a.distance(*b).total_cmp(&c.distance(*d)));
    longest.map_or((DVec2::ZERO, DVec2::X), |(a, b)| (a, (b - a).normalize_or(DVec2::X)))
}

impl Hull {
    /// Returns the middle, the half sides and the heading of the box around the corners, along their longest side.
    fn around(&self) -> (DVec2, DVec2, f64) {
        let (start, along) = longest_side(&self.corners);
        let ends = self.corners.iter().map(|corner| along.dot(*corner - start));
        let (near, far) =
            ends.fold((0.0, 0.0), |(near, far), s| (f64::min(near, s), f64::max(far, s)));
        let half = 0.5 * DVec2::new(far - near, thickness(&self.corners));
        let middle = start + along * (near + half.x) + along.perp() * half.y;
        (self.place + middle, half, libm::atan2(along.y, along.x))
    }
}

/// Writes the plane on which robots drive.
fn floor(xml: &mut Xml<'_>, world: &World) -> Result<(), ExportError> {
    let half = 0.5 * world.bounds.size();
    let attributes = [
        ("name", "floor".into()),
        ("type", "plane".into()),
        ("pos", numbers(world.bounds.center().extend(0.0).to_array())),
        ("size", numbers([half.x, half.y, GRID])),
        // Floors and surfaces are seen in its place.
        ("rgba", "0 0 0 0".into()),
    ];
    xml.leaf("geom", &attributes)
}

fn geoms(xml: &mut Xml<'_>, piece: &Piece<'_>, hulls: &[Hull]) -> Result<(), ExportError> {
    let mut geom = |name: String, form: &[Attribute]| {
        let mut attributes =
            vec![("name", name), ("material", piece.kind.clone()), ("rgba", rgba(piece.color))];
        attributes.extend_from_slice(form);
        if !piece.is_solid {
            attributes.extend([("contype", "0".into()), ("conaffinity", "0".into())]);
        }
        xml.leaf("geom", &attributes)
    };
    match &piece.form {
        Form::Prism { shape, extent } => match Body::of(shape, *extent) {
            Body::Box { center, size, heading } => {
                geom(piece.to_string(), &box_of(center, 0.5 * size, heading))
            }
            Body::Cylinder { center, radius, length } => geom(
                piece.to_string(),
                &[
                    ("type", "cylinder".into()),
                    ("pos", numbers(center.to_array())),
                    ("size", numbers([radius, 0.5 * length])),
                ],
            ),
            Body::Polygon { .. } => hulls.iter().try_for_each(|hull| {
                if hull.is_thin {
                    let (middle, half, heading) = hull.around();
                    let size = half.extend(0.5 * hull.extent.height());
                    let middle = middle.extend(hull.extent.bottom() + size.z);
                    return geom(hull.name.clone(), &box_of(middle, size, heading));
                }
                let mesh = [
                    ("type", "mesh".into()),
                    ("mesh", hull.name.clone()),
                    ("pos", numbers(hull.place.extend(0.0).to_array())),
                ];
                geom(hull.name.clone(), &mesh)
            }),
        },
        Form::Crown { center, crown } => {
            let half = 0.5 * crown.extent.height();
            geom(
                piece.to_string(),
                &[
                    ("type", "ellipsoid".into()),
                    ("pos", numbers(center.extend(crown.extent.bottom() + half).to_array())),
                    ("size", numbers([crown.radius, crown.radius, half])),
                ],
            )
        }
        // The plane is driven on: the kerbs show where the road is.
        Form::Road { .. } => Ok(()),
    }
}

/// Returns the attributes of a box with a middle, half sides in metres, and a heading.
fn box_of(middle: DVec3, half: DVec3, heading: f64) -> [Attribute; 4] {
    [
        ("type", "box".into()),
        ("pos", numbers(middle.to_array())),
        ("size", numbers(half.to_array())),
        ("euler", numbers([0.0, 0.0, heading])),
    ]
}

fn rgba(Srgb(rgb): Srgb) -> String {
    let parts: Vec<String> = rgb.iter().map(|part| number(f64::from(*part) / 255.0)).collect();
    format!("{} 1", parts.join(" "))
}
