//! The trajectory of a robot, drawn as ribbons that grow.

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;

use super::shape::Sketch;

/// The number of segments per ribbon. Each ribbon has its own mesh, so that old parts of the trail are not
/// uploaded to the graphics card again.
pub(super) const SEGMENTS: usize = 256;

/// The smallest length of a segment in metres.
pub(super) const STEP: f32 = 0.1;

/// Half the width of a ribbon in metres.
const HALF: f32 = 0.03;

/// A drawn trajectory in the frame of the environment.
#[derive(Debug, Default)]
pub(super) struct Trail {
    ribbons: Vec<(Handle<Mesh>, Entity)>,
    /// The number of segments that are drawn.
    segments: usize,
    last: Option<Vec2>,
}

impl Trail {
    /// Extends the trail to a point. `spawn` creates the entity of a new ribbon.
    pub(super) fn extend(
        &mut self,
        to: Vec2,
        meshes: &mut Assets<Mesh>,
        mut spawn: impl FnMut(Handle<Mesh>) -> Entity,
    ) {
        let Some(from) = self.last else {
            self.last = Some(to);
            return;
        };
        let Some(along) = (to - from).try_normalize().filter(|_| from.distance(to) >= STEP) else {
            return;
        };
        let (ribbon, segment) = (self.segments / SEGMENTS, self.segments % SEGMENTS);
        if ribbon == self.ribbons.len() {
            let mesh = meshes.add(blank());
            let entity = spawn(mesh.clone());
            self.ribbons.push((mesh, entity));
        }
        let side = along.perp() * HALF;
        let corners = [from - side, to - side, to + side, from + side];
        if let Some(mut mesh) = meshes.get_mut(&self.ribbons[ribbon].0)
            && let Some(quads) = positions(&mut mesh)
        {
            for (corner, p) in quads[4 * segment..].iter_mut().zip(corners) {
                *corner = [p.x, p.y, 0.0];
            }
        }
        self.segments += 1;
        self.last = Some(to);
    }

    /// Returns the entities of the ribbons.
    pub(super) fn entities(&self) -> impl Iterator<Item = Entity> {
        self.ribbons.iter().map(|(_, entity)| *entity)
    }

    /// Clears the trail, and keeps the ribbons for reuse.
    pub(super) fn clear(&mut self, meshes: &mut Assets<Mesh>) {
        for (ribbon, _) in &self.ribbons {
            if let Some(mut mesh) = meshes.get_mut(ribbon)
                && let Some(quads) = positions(&mut mesh)
            {
                quads.fill([0.0; 3]);
            }
        }
        (self.segments, self.last) = (0, None);
    }
}

fn positions(mesh: &mut Mesh) -> Option<&mut Vec<[f32; 3]>> {
    match mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION) {
        Some(VertexAttributeValues::Float32x3(corners)) => Some(corners),
        _ => None,
    }
}

/// Creates a ribbon whose segments have a length of 0.
fn blank() -> Mesh {
    let corners = 4 * SEGMENTS;
    let quads =
        (0..SEGMENTS as u32).flat_map(|segment| [0, 1, 2, 0, 2, 3].map(|c| 4 * segment + c));
    let sketch = Sketch {
        corners: vec![[0.0; 3]; corners],
        colors: vec![[1.0; 4]; corners],
        triangles: quads.collect(),
    };
    sketch.into_mesh()
}
