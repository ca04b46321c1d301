//! Worlds as glTF 2.0 in a binary file (GLB).
//!
//! Each piece of the world is a node below the node `world` and has the name of the piece. Its `extras` hold the
//! part's list and index, and its kind and role. Pieces of the same form share their mesh. Start, goal and victims
//! are nodes without a mesh. The provenance is in the extras of the asset. In glTF, y points up: x is the world's x,
//! -z its y, and y the height. Numbers have 32 bits: positions in a piece are relative to its middle, and middles are
//! relative to a whole number of metres near the middle of the world.

use std::collections::BTreeMap;
use std::io::Write;

use glam::{DVec2, DVec3};
use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Stride, Target, View};
use gltf_json::material::{PbrBaseColorFactor, StrengthFactor};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::scene::UnitQuaternion;
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Asset, Buffer, Extras, Index, Material, Node, Root, Scene};
use serde::Serialize;
use serde_json::json;

use super::error::ExportError;
use super::places::places;
use crate::mesh::Mesh;
use crate::palette::Srgb;
use crate::pieces::{Piece, pieces};
use crate::world::{PartKind, World};

/// The indices of the buffer's views, in the order of its parts.
const POSITIONS: u32 = 0;
const NORMALS: u32 = 1;
const UVS: u32 = 2;
const TRIANGLES: u32 = 3;

/// Writes a world.
pub(super) fn write(world: &World, out: &mut dyn Write) -> Result<(), ExportError> {
    let mut file = File::default();
    // Beyond 2^24 m, single precision does not have every whole number.
    let origin = world.bounds.center().round().as_vec2().as_dvec2();
    let mut children = Vec::new();
    for piece in pieces(world) {
        let mesh = Mesh::of(&piece)?;
        let place = mesh.pivot - origin;
        let node = Node {
            name: Some(piece.to_string()),
            mesh: Some(file.mesh(&piece, &mesh)),
            translation: Some(narrow(up(place.extend(0.0)))),
            extras: extras(&described(world, &piece))?,
            ..Node::default()
        };
        children.push(Index::push(&mut file.root.nodes, node));
    }
    for (name, pose) in places(world) {
        let (sin, cos) = libm::sincos(0.5 * pose.heading);
        let node = Node {
            name: Some(name),
            translation: Some(narrow(up((pose.position - origin).extend(0.0)))),
            rotation: Some(UnitQuaternion([0.0, sin as f32, 0.0, cos as f32])),
            ..Node::default()
        };
        children.push(Index::push(&mut file.root.nodes, node));
    }
    let top = Node {
        name: Some("world".to_owned()),
        translation: Some(narrow(up(origin.extend(0.0)))),
        children: Some(children),
        ..Node::default()
    };
    let top = Index::push(&mut file.root.nodes, top);
    file.root.asset = Asset {
        version: "2.0".to_owned(),
        generator: Some(concat!("envgen ", env!("CARGO_PKG_VERSION")).to_owned()),
        extras: extras(&json!({ "provenance": world.provenance }))?,
        ..Asset::default()
    };
    let scene = Scene {
        name: Some(world.provenance.name()),
        nodes: vec![top],
        extensions: None,
        extras: None,
    };
    file.root.scene = Some(Index::push(&mut file.root.scenes, scene));
    file.write(out)
}

/// Returns the description of a piece.
fn described(world: &World, piece: &Piece<'_>) -> serde_json::Value {
    let mut extras =
        json!({ "kind": piece.kind, "role": piece.role.name(), "solid": piece.is_solid });
    if let Some(id) = piece.part {
        extras["part"] = json!(id.kind.name());
        extras["index"] = json!(id.index);
        if id.kind == PartKind::Room {
            extras["name"] = json!(world.rooms[id.index as usize].name);
        }
    }
    extras
}

fn extras<T: Serialize>(value: &T) -> Result<Extras, ExportError> {
    Ok(Some(serde_json::value::to_raw_value(value).map_err(std::io::Error::from)?))
}

/// Converts a vector from z-up to y-up.
fn up(p: DVec3) -> DVec3 {
    DVec3::new(p.x, p.z, -p.y)
}

/// Converts a vector to 32 bits, without negative zeros.
fn narrow(p: DVec3) -> [f32; 3] {
    p.to_array().map(|x| x as f32 + 0.0)
}

/// A file that is being built.
#[derive(Default)]
struct File {
    root: Root,
    /// The parts of the buffer: positions, normals, texture coordinates, and corners of triangles.
    data: [Vec<u8>; 4],
    materials: BTreeMap<String, Index<Material>>,
    /// The meshes by material, positions and corners, so that equal meshes are shared.
    meshes: BTreeMap<(usize, Vec<u8>, Vec<u8>), Index<gltf_json::Mesh>>,
}

impl File {
    fn mesh(&mut self, piece: &Piece<'_>, mesh: &Mesh) -> Index<gltf_json::Mesh> {
        let material = self.material(piece);
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| narrow(up(*p))).collect();
        let position_bytes = bytes(positions.iter().flatten().map(|x| x.to_le_bytes()));
        let triangles = bytes(mesh.triangles.iter().flatten().map(|i| i.to_le_bytes()));
        let key = (material.value(), position_bytes, triangles);
        if let Some(known) = self.meshes.get(&key) {
            return *known;
        }
        let normals = mesh.normals.iter().map(|normal| narrow(up(*normal)));
        let normals = bytes(normals.flatten().map(|x| x.to_le_bytes()));
        // The first row of a picture is its top.
        let uvs = mesh.uvs.iter().flat_map(|uv: &DVec2| [uv.x as f32, -uv.y as f32]);
        let uvs = bytes(uvs.map(|x| (x + 0.0).to_le_bytes()));
        let corners = mesh.positions.len();
        let [low, high] = [f32::min as fn(f32, f32) -> f32, f32::max].map(|pick| {
            let ends = positions.iter().copied().reduce(|a, b| [0, 1, 2].map(|i| pick(a[i], b[i])));
            ends.map(|ends| json!(ends))
        });
        let place = self.accessor(POSITIONS, &key.1, corners, Type::Vec3);
        self.root.accessors[place.value()].min = low;
        self.root.accessors[place.value()].max = high;
        let attributes = [
            (Semantic::Positions, place),
            (Semantic::Normals, self.accessor(NORMALS, &normals, corners, Type::Vec3)),
            (Semantic::TexCoords(0), self.accessor(UVS, &uvs, corners, Type::Vec2)),
        ];
        let indices = self.accessor(TRIANGLES, &key.2, 3 * mesh.triangles.len(), Type::Scalar);
        let primitive = Primitive {
            attributes: attributes.map(|(what, at)| (Checked::Valid(what), at)).into(),
            indices: Some(indices),
            material: Some(material),
            mode: Checked::Valid(Mode::Triangles),
            targets: None,
            extensions: None,
            extras: None,
        };
        let mesh = gltf_json::Mesh {
            name: Some(piece.to_string()),
            primitives: vec![primitive],
            weights: None,
            extensions: None,
            extras: None,
        };
        let index = Index::push(&mut self.root.meshes, mesh);
        self.meshes.insert(key, index);
        index
    }

    fn accessor(&mut self, view: u32, content: &[u8], count: usize, of: Type) -> Index<Accessor> {
        let data = &mut self.data[view as usize];
        let offset = data.len();
        data.extend_from_slice(content);
        let number = if view == TRIANGLES { ComponentType::U32 } else { ComponentType::F32 };
        let accessor = Accessor {
            buffer_view: Some(Index::new(view)),
            byte_offset: Some(USize64::from(offset)),
            count: USize64::from(count),
            component_type: Checked::Valid(GenericComponentType(number)),
            type_: Checked::Valid(of),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
            extensions: None,
            extras: None,
        };
        Index::push(&mut self.root.accessors, accessor)
    }

    /// Returns the material of a kind and colour, which is added if necessary.
    fn material(&mut self, piece: &Piece<'_>) -> Index<Material> {
        let Srgb([r, g, b]) = piece.color;
        let name = format!("{} #{r:02x}{g:02x}{b:02x}", piece.kind);
        if let Some(known) = self.materials.get(&name) {
            return *known;
        }
        let [r, g, b] = piece.color.linear();
        let mut material = Material { name: Some(name.clone()), ..Material::default() };
        material.pbr_metallic_roughness.base_color_factor = PbrBaseColorFactor([r, g, b, 1.0]);
        material.pbr_metallic_roughness.metallic_factor = StrengthFactor(0.0);
        material.pbr_metallic_roughness.roughness_factor = StrengthFactor(0.9);
        let index = Index::push(&mut self.root.materials, material);
        self.materials.insert(name, index);
        index
    }

    /// Writes the header, the JSON and the buffer.
    fn write(mut self, out: &mut dyn Write) -> Result<(), ExportError> {
        let mut offset = 0;
        for (data, stride) in self.data.iter().zip([Some(12), Some(12), Some(8), None]) {
            let target =
                if stride.is_some() { Target::ArrayBuffer } else { Target::ElementArrayBuffer };
            self.root.buffer_views.push(View {
                buffer: Index::new(0),
                byte_length: USize64::from(data.len()),
                byte_offset: Some(USize64::from(offset)),
                byte_stride: stride.map(Stride),
                target: Some(Checked::Valid(target)),
                name: None,
                extensions: None,
                extras: None,
            });
            offset += data.len();
        }
        self.root.buffers.push(Buffer {
            byte_length: USize64::from(offset),
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        });
        let mut json = serde_json::to_vec(&self.root).map_err(std::io::Error::from)?;
        // Chunks are whole words; those of the buffer are by themselves.
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = |bytes: usize| {
            u32::try_from(bytes)
                .map_err(|_| ExportError::TooLarge { format: "glTF", limit: "4 GiB" })
        };
        let whole = length(12 + 8 + json.len() + 8 + offset)?;
        out.write_all(b"glTF")?;
        out.write_all(&2_u32.to_le_bytes())?;
        out.write_all(&whole.to_le_bytes())?;
        out.write_all(&length(json.len())?.to_le_bytes())?;
        out.write_all(b"JSON")?;
        out.write_all(&json)?;
        out.write_all(&length(offset)?.to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        for data in &self.data {
            out.write_all(data)?;
        }
        Ok(())
    }
}

fn bytes(words: impl Iterator<Item = [u8; 4]>) -> Vec<u8> {
    words.flatten().collect()
}
