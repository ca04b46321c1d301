//! Worlds as Universal Scene Description in text (USDA), for Isaac Sim, Omniverse, Blender and usdview.
//!
//! Each piece of the world is a prim below `/World` with the name of the piece, in metres with z up: a cube, a
//! cylinder or a sphere, and for other outlines a closed mesh. Solids have USD's `PhysicsCollisionAPI`; meshes
//! collide with their triangles. Kind, role, list and index of a part are `userProperties`. Start, goal and
//! victims are prims without a form, whose x axis is the heading. The provenance is `userProperties:provenance` of
//! `/World`.

use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::DVec3;
use openusd::gf::{self, Vec3f};
use openusd::sdf::{ChildrenKey, Data, FieldKey, Path, SpecType, Specifier, Value, Variability};
use openusd::tf::Token;
use openusd::usda::TextWriter;

use super::body::Body;
use super::error::ExportError;
use super::places::places;
use crate::mesh::Mesh;
use crate::pieces::{Form, Piece, pieces};
use crate::world::World;

/// The list of schemas, which adds to those that other layers apply. The writer leaves out the brackets of list
/// operations with one item, which Pixar's reader refuses; therefore it is written as a list.
const PREPENDED_SCHEMAS: &str = "prepend apiSchemas";

/// Thickness in metres of the slab on which robots drive.
const FLOOR_THICKNESS: f64 = 0.1;

/// Writes a world.
pub(super) fn write(world: &World, mut out: &mut dyn Write) -> Result<(), ExportError> {
    let provenance = serde_json::to_string(&world.provenance).map_err(io::Error::from)?;
    let mut layer = Layer(Data::new());
    layer.add(
        Path::abs_root(),
        SpecType::PseudoRoot,
        [
            ("documentation", Value::String(format!("envgen {}", env!("CARGO_PKG_VERSION")))),
            (FieldKey::DefaultPrim.as_str(), token("World")),
            ("upAxis", token("Z")),
            ("metersPerUnit", Value::Double(1.0)),
            (ChildrenKey::PrimChildren.as_str(), Value::TokenVec(vec!["World".into()])),
        ],
    );
    let mut root = Prim::new("/World", "Xform")?;
    root.fields.push((FieldKey::Kind.as_str(), token("component")));
    root.user(&mut layer, "provenance", "string", Value::String(provenance))?;
    for (name, pose) in places(world) {
        let mut place = root.child(&name, "Xform")?;
        place.transform(&mut layer, pose.position.extend(0.0), pose.heading, None)?;
        place.finish(&mut layer);
    }
    for piece in pieces(world) {
        write_piece(&mut layer, &mut root, &piece)?;
    }
    write_floor(&mut layer, &mut root, world)?;
    root.finish(&mut layer);
    TextWriter::write(&layer.0, &mut out).map_err(|error| failure(error).into())
}

fn write_piece(layer: &mut Layer, root: &mut Prim, piece: &Piece<'_>) -> Result<(), ExportError> {
    let name = piece.to_string();
    let body = match &piece.form {
        Form::Prism { shape, extent } => Some(Body::of(shape, *extent)),
        _ => None,
    };
    let (mut prim, is_mesh) = match (&piece.form, body) {
        (_, Some(Body::Box { center, size, heading })) => {
            let mut prim = root.child(&name, "Cube")?;
            prim.attribute(layer, "size", "double", Value::Double(1.0))?;
            prim.extent(layer, DVec3::splat(-0.5), DVec3::splat(0.5))?;
            prim.transform(layer, center, heading, Some(size))?;
            (prim, false)
        }
        (_, Some(Body::Cylinder { center, radius, length })) => {
            let mut prim = root.child(&name, "Cylinder")?;
            prim.uniform(layer, "axis", token("Z"))?;
            prim.attribute(layer, "height", "double", Value::Double(length))?;
            prim.attribute(layer, "radius", "double", Value::Double(radius))?;
            let half = DVec3::new(radius, radius, 0.5 * length);
            prim.extent(layer, -half, half)?;
            prim.transform(layer, center, 0.0, None)?;
            (prim, false)
        }
        (Form::Crown { center, crown }, _) => {
            let mut prim = root.child(&name, "Sphere")?;
            prim.attribute(layer, "radius", "double", Value::Double(1.0))?;
            prim.extent(layer, DVec3::NEG_ONE, DVec3::ONE)?;
            let (low, high) = (crown.extent.bottom(), crown.extent.top());
            let size = DVec3::new(crown.radius, crown.radius, 0.5 * (high - low));
            prim.transform(layer, center.extend(0.5 * (low + high)), 0.0, Some(size))?;
            (prim, false)
        }
        _ => {
            let mesh = Mesh::of(piece)?;
            let mut prim = root.child(&name, "Mesh")?;
            prim.mesh(layer, &mesh)?;
            prim.transform(layer, mesh.pivot.extend(0.0), 0.0, None)?;
            (prim, true)
        }
    };
    let [r, g, b] = piece.color.linear();
    prim.attribute(
        layer,
        "primvars:displayColor",
        "color3f[]",
        Value::Vec3fVec(vec![gf::vec3f(r, g, b)]),
    )?;
    prim.user(layer, "kind", "string", Value::String(piece.kind.clone()))?;
    prim.user(layer, "role", "string", Value::String(piece.role.name().to_owned()))?;
    if let Some(part) = piece.part {
        prim.user(layer, "part", "string", Value::String(part.kind.name().to_owned()))?;
        // A list of more parts than that is far beyond what the format's users can open.
        let index = i32::try_from(part.index).unwrap_or(i32::MAX);
        prim.user(layer, "index", "int", Value::Int(index))?;
    }
    if piece.is_solid {
        let mut schemas: Vec<Token> = vec!["PhysicsCollisionAPI".into()];
        if is_mesh {
            schemas.push("PhysicsMeshCollisionAPI".into());
            prim.uniform(layer, "physics:approximation", token("none"))?;
        }
        prim.fields.push((PREPENDED_SCHEMAS, Value::TokenVec(schemas)));
    }
    prim.finish(layer);
    Ok(())
}

/// Writes the slab on which robots drive, below the whole world. It is not drawn.
fn write_floor(layer: &mut Layer, root: &mut Prim, world: &World) -> Result<(), ExportError> {
    let mut prim = root.child("floor_plane", "Cube")?;
    prim.attribute(layer, "size", "double", Value::Double(1.0))?;
    prim.extent(layer, DVec3::splat(-0.5), DVec3::splat(0.5))?;
    let center = world.bounds.center().extend(-0.5 * FLOOR_THICKNESS);
    let size = world.bounds.size().extend(FLOOR_THICKNESS);
    prim.transform(layer, center, 0.0, Some(size))?;
    prim.uniform(layer, "purpose", token("guide"))?;
    let schemas = Value::TokenVec(vec!["PhysicsCollisionAPI".into()]);
    prim.fields.push((PREPENDED_SCHEMAS, schemas));
    prim.finish(layer);
    Ok(())
}

fn token(text: &str) -> Value {
    Value::Token(text.into())
}

/// Converts an error of the writer. An error of the output remains as it is.
fn failure(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> io::Error {
    match error.into().downcast::<io::Error>() {
        Ok(error) => *error,
        Err(error) => io::Error::other(error),
    }
}

fn narrow(p: DVec3) -> Vec3f {
    // Without negative zeros.
    let [x, y, z] = p.to_array().map(|x| x as f32 + 0.0);
    gf::vec3f(x, y, z)
}

/// A file that is being built.
struct Layer(Data);

impl Layer {
    fn add<const N: usize>(&mut self, path: Path, of: SpecType, fields: [(&str, Value); N]) {
        let spec = self.0.create_spec(path, of);
        for (name, value) in fields {
            spec.add(name, value);
        }
    }
}

/// A prim that is being built. [`Prim::finish`] adds it to the layer.
struct Prim {
    path: Path,
    of: &'static str,
    fields: Vec<(&'static str, Value)>,
    properties: Vec<Token>,
    children: Vec<Token>,
}

impl Prim {
    fn new(path: &str, of: &'static str) -> Result<Self, ExportError> {
        let path = openusd::sdf::path(path).map_err(failure)?;
        Ok(Prim { path, of, fields: Vec::new(), properties: Vec::new(), children: Vec::new() })
    }

    fn child(&mut self, name: &str, of: &'static str) -> Result<Self, ExportError> {
        self.children.push(name.into());
        Prim::new(&format!("{}/{name}", self.path.as_str()), of)
    }

    fn finish(self, layer: &mut Layer) {
        let spec = layer.0.create_spec(self.path, SpecType::Prim);
        spec.add(FieldKey::Specifier, Value::Specifier(Specifier::Def));
        spec.add(FieldKey::TypeName, token(self.of));
        for (name, value) in self.fields {
            spec.add(name, value);
        }
        spec.add(ChildrenKey::PropertyChildren, Value::TokenVec(self.properties));
        spec.add(ChildrenKey::PrimChildren, Value::TokenVec(self.children));
    }

    /// Adds an attribute with fields in addition to its type and value.
    fn property<const N: usize>(
        &mut self,
        layer: &mut Layer,
        name: &str,
        (of, value): (&str, Value),
        others: [(&str, Value); N],
    ) -> Result<(), ExportError> {
        let path = self.path.append_property(name).map_err(failure)?;
        self.properties.push(name.into());
        let spec = layer.0.create_spec(path, SpecType::Attribute);
        spec.add(FieldKey::TypeName, token(of));
        spec.add(FieldKey::Default, value);
        for (name, value) in others {
            spec.add(name, value);
        }
        Ok(())
    }

    fn attribute(
        &mut self,
        layer: &mut Layer,
        name: &str,
        of: &str,
        value: Value,
    ) -> Result<(), ExportError> {
        self.property(layer, name, (of, value), [])
    }

    /// Adds a word that does not change with time.
    fn uniform(&mut self, layer: &mut Layer, name: &str, value: Value) -> Result<(), ExportError> {
        let of = if matches!(value, Value::TokenVec(_)) { "token[]" } else { "token" };
        let uniform = (FieldKey::Variability.as_str(), Value::Variability(Variability::Uniform));
        self.property(layer, name, (of, value), [uniform])
    }

    /// Adds a property that no schema defines.
    fn user(
        &mut self,
        layer: &mut Layer,
        name: &str,
        of: &str,
        value: Value,
    ) -> Result<(), ExportError> {
        let custom = (FieldKey::Custom.as_str(), Value::Bool(true));
        self.property(layer, &format!("userProperties:{name}"), (of, value), [custom])
    }

    /// Adds the corners of a box around the form, in the form's own frame.
    fn extent(&mut self, layer: &mut Layer, low: DVec3, high: DVec3) -> Result<(), ExportError> {
        let corners = Value::Vec3fVec(vec![narrow(low), narrow(high)]);
        self.attribute(layer, "extent", "float3[]", corners)
    }

    fn transform(
        &mut self,
        layer: &mut Layer,
        at: DVec3,
        heading: f64,
        size: Option<DVec3>,
    ) -> Result<(), ExportError> {
        let vector = |p: DVec3| Value::Vec3d(gf::vec3d(p.x, p.y, p.z));
        let mut order: Vec<Token> = vec!["xformOp:translate".into()];
        self.attribute(layer, "xformOp:translate", "double3", vector(at))?;
        if heading != 0.0 {
            order.push("xformOp:rotateZ".into());
            let degrees = Value::Double(heading.to_degrees());
            self.attribute(layer, "xformOp:rotateZ", "double", degrees)?;
        }
        if let Some(size) = size {
            order.push("xformOp:scale".into());
            self.attribute(layer, "xformOp:scale", "double3", vector(size))?;
        }
        self.uniform(layer, "xformOpOrder", Value::TokenVec(order))
    }

    /// Adds the triangles of a mesh. Corners at the same position are one corner, with a normal for each triangle.
    fn mesh(&mut self, layer: &mut Layer, mesh: &Mesh) -> Result<(), ExportError> {
        let mut places: BTreeMap<[u64; 3], i32> = BTreeMap::new();
        let mut points = Vec::new();
        let mut corners = Vec::with_capacity(mesh.positions.len());
        for position in &mesh.positions {
            let key = position.to_array().map(f64::to_bits);
            corners.push(*places.entry(key).or_insert_with(|| {
                points.push(narrow(*position));
                points.len() as i32 - 1
            }));
        }
        let all = || mesh.triangles.iter().flatten().map(|&corner| corner as usize);
        let counts = Value::IntVec(vec![3; mesh.triangles.len()]);
        let indices = Value::IntVec(all().map(|corner| corners[corner]).collect());
        let normals = all().map(|corner| narrow(mesh.normals[corner])).collect();
        let uvs = all().map(|corner| mesh.uvs[corner].as_vec2());
        let uvs = uvs.map(|uv| gf::vec2f(uv.x + 0.0, uv.y + 0.0)).collect();
        let (low, high) = mesh
            .positions
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| {
                (low.min(p), high.max(p))
            });
        let by_corner = || ("interpolation", token("faceVarying"));
        self.extent(layer, low, high)?;
        self.attribute(layer, "points", "point3f[]", Value::Vec3fVec(points))?;
        self.attribute(layer, "faceVertexCounts", "int[]", counts)?;
        self.attribute(layer, "faceVertexIndices", "int[]", indices)?;
        self.property(layer, "normals", ("normal3f[]", Value::Vec3fVec(normals)), [by_corner()])?;
        self.property(layer, "primvars:st", ("texCoord2f[]", Value::Vec2fVec(uvs)), [by_corner()])?;
        self.uniform(layer, "subdivisionScheme", token("none"))
    }
}
