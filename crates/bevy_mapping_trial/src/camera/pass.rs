//! Determines with the graphics card which triangle is visible at each pixel.
//!
//! The graphics card only decides which triangle is visible. The depth is computed from the triangle and the
//! ray of the pixel in double precision, so that it does not depend on how drivers interpolate.

use std::borrow::Cow;
use std::sync::mpsc;

use bevy::prelude::*;
use bevy::render::render_resource::{
    BindGroup, BindGroupEntry, BindGroupLayoutEntry, BindingType, Buffer, BufferBindingType,
    BufferDescriptor, BufferInitDescriptor, BufferUsages, ColorTargetState, ColorWrites,
    CommandEncoderDescriptor, CompareFunction, DepthStencilState, Extent3d, Face, LoadOp, MapMode,
    MultisampleState, Operations, PipelineLayoutDescriptor, PollType, PrimitiveState,
    RawFragmentState, RawRenderPipelineDescriptor, RawVertexBufferLayout, RawVertexState,
    RenderPassColorAttachment, RenderPassDepthStencilAttachment, RenderPassDescriptor,
    RenderPipeline, ShaderModuleDescriptor, ShaderSource, ShaderStages, StoreOp,
    TexelCopyBufferInfo, TexelCopyBufferLayout, Texture, TextureDescriptor, TextureDimension,
    TextureFormat, TextureUsages, TextureViewDescriptor, VertexAttribute, VertexFormat,
    VertexStepMode,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use envgen::glam::DVec3;

use super::optics::{CameraOptics, CameraPose};
use super::scene::{Scene, Triangles};
use super::settings::CameraError;

/// A shader that draws the number of each triangle, counted from 1: the index of the triangle in the vertex
/// buffer, plus an offset that is passed as the instance index.
const SHADER: &str = "
@group(0) @binding(0) var<uniform> clip_from_scene: mat4x4<f32>;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) number: u32,
}

@vertex
fn place(
    @location(0) position: vec3<f32>,
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) before: u32,
) -> Corner {
    return Corner(clip_from_scene * vec4(position, 1.0), vertex / 3u + 1u + before);
}

@fragment
fn number(corner: Corner) -> @location(0) u32 {
    return corner.number;
}
";

/// The size of a position in bytes.
const POSITION: u64 = 12;

/// The alignment in bytes of the rows of copied images.
const ROW: u32 = 256;

/// A render pass that draws the numbers of triangles.
pub(super) struct NumberPass {
    device: RenderDevice,
    queue: RenderQueue,
    pipeline: RenderPipeline,
    uniform: Buffer,
    bindings: BindGroup,
    target: Option<Target>,
}

/// The images and the buffer for pictures of one size.
struct Target {
    size: UVec2,
    numbers: Texture,
    depth: Texture,
    copy: Buffer,
}

/// The triangles of a scene on the graphics card.
pub(super) struct SceneBuffer(Buffer);

impl NumberPass {
    pub(super) fn new(device: &RenderDevice, queue: &RenderQueue) -> Self {
        let shader = device.create_and_validate_shader_module(ShaderModuleDescriptor {
            label: Some("triangle numbers"),
            source: ShaderSource::Wgsl(Cow::Borrowed(SHADER)),
        });
        let layout = device.create_bind_group_layout(
            "triangle numbers",
            &[BindGroupLayoutEntry {
                binding: 0,
                visibility: ShaderStages::VERTEX,
                ty: BindingType::Buffer {
                    ty: BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        );
        let pipeline_layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label: Some("triangle numbers"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&RawRenderPipelineDescriptor {
            label: Some("triangle numbers"),
            layout: Some(&pipeline_layout),
            vertex: RawVertexState {
                module: &shader,
                entry_point: Some("place"),
                compilation_options: default(),
                buffers: &[RawVertexBufferLayout {
                    array_stride: POSITION,
                    step_mode: VertexStepMode::Vertex,
                    attributes: &[VertexAttribute {
                        format: VertexFormat::Float32x3,
                        offset: 0,
                        shader_location: 0,
                    }],
                }],
            },
            primitive: PrimitiveState { cull_mode: Some(Face::Back), ..default() },
            depth_stencil: Some(DepthStencilState {
                format: TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(CompareFunction::Greater),
                stencil: default(),
                bias: default(),
            }),
            multisample: MultisampleState::default(),
            fragment: Some(RawFragmentState {
                module: &shader,
                entry_point: Some("number"),
                compilation_options: default(),
                targets: &[Some(ColorTargetState {
                    format: TextureFormat::R32Uint,
                    blend: None,
                    write_mask: ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        });
        let uniform = device.create_buffer(&BufferDescriptor {
            label: Some("view of a robot's camera"),
            size: 64,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bindings = device.create_bind_group(
            "triangle numbers",
            &layout,
            &[BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        );
        NumberPass {
            device: device.clone(),
            queue: queue.clone(),
            pipeline,
            uniform,
            bindings,
            target: None,
        }
    }

    /// Uploads the triangles of a scene.
    pub(super) fn load(&self, scene: &Scene) -> SceneBuffer {
        SceneBuffer(self.upload(&scene.triangles))
    }

    fn upload(&self, triangles: &Triangles) -> Buffer {
        self.device.create_buffer_with_data(&BufferInitDescriptor {
            label: Some("triangles"),
            contents: &bytes(&triangles.corners),
            usage: BufferUsages::VERTEX,
        })
    }

    /// Draws a scene and the moving bodies in it. Returns the number of the triangle at each pixel, or 0 if
    /// there is no surface. Waits for the graphics card.
    pub(super) fn draw(
        &mut self,
        (scene, still): (&Scene, &SceneBuffer),
        moving: &Triangles,
        pose: &CameraPose,
        optics: &CameraOptics,
    ) -> Result<Vec<u32>, CameraError> {
        let view = pose.view_from(scene.origin);
        let clip_from_scene = optics.projection() * view;
        let matrix: Vec<u8> =
            clip_from_scene.to_cols_array().iter().flat_map(|x| x.to_le_bytes()).collect();
        self.queue.write_buffer(&self.uniform, 0, &matrix);
        let moving_buffer = (!moving.corners.is_empty()).then(|| self.upload(moving));

        let size = UVec2::new(optics.width, optics.height);
        let device = &self.device;
        if self.target.as_ref().is_none_or(|target| target.size != size) {
            self.target = Some(Target::new(device, size));
        }
        let Some(target) = &self.target else { return Ok(Vec::new()) };
        let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor::default());
        {
            let numbers = target.numbers.create_view(&TextureViewDescriptor::default());
            let depth = target.depth.create_view(&TextureViewDescriptor::default());
            let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
                label: Some("triangle numbers"),
                color_attachments: &[Some(RenderPassColorAttachment {
                    view: &numbers,
                    depth_slice: None,
                    resolve_target: None,
                    ops: Operations { load: LoadOp::Clear(default()), store: StoreOp::Store },
                })],
                depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
                    view: &depth,
                    depth_ops: Some(Operations {
                        load: LoadOp::Clear(0.0),
                        store: StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                ..default()
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &*self.bindings, &[]);
            pass.set_vertex_buffer(0, *still.0.slice(..));
            for run in scene.in_view(view, optics) {
                pass.draw(3 * run.start..3 * run.end, 0..1);
            }
            if let Some(buffer) = &moving_buffer {
                let before = scene.triangles.corners.len() as u32;
                pass.set_vertex_buffer(0, *buffer.slice(..));
                pass.draw(0..3 * moving.corners.len() as u32, before..before + 1);
            }
        }
        encoder.copy_texture_to_buffer(
            target.numbers.as_image_copy(),
            TexelCopyBufferInfo {
                buffer: &target.copy,
                layout: TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(bytes_per_row(size.x)),
                    rows_per_image: None,
                },
            },
            extent(size),
        );
        self.queue.submit([encoder.finish()]);
        target.read(device)
    }
}

impl Target {
    fn new(device: &RenderDevice, size: UVec2) -> Self {
        let texture = |label, format, usage| {
            device.create_texture(&TextureDescriptor {
                label: Some(label),
                size: extent(size),
                mip_level_count: 1,
                sample_count: 1,
                dimension: TextureDimension::D2,
                format,
                usage: TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
        };
        let numbers = texture("triangle numbers", TextureFormat::R32Uint, TextureUsages::COPY_SRC);
        let depth = TextureFormat::Depth32Float;
        let depth = texture("depth of triangles", depth, TextureUsages::empty());
        let copy = device.create_buffer(&BufferDescriptor {
            label: Some("triangle numbers"),
            size: u64::from(bytes_per_row(size.x)) * u64::from(size.y),
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Target { size, numbers, depth, copy }
    }

    /// Returns the copied numbers, row by row.
    fn read(&self, device: &RenderDevice) -> Result<Vec<u32>, CameraError> {
        let failed = |reason: String| CameraError::Driver(reason);
        let (sender, receiver) = mpsc::channel();
        let slice = self.copy.slice(..);
        slice.map_async(MapMode::Read, move |mapped| {
            // If this fails, nothing is waiting for the result any more.
            let _ = sender.send(mapped);
        });
        device
            .poll(PollType::Wait { submission_index: None, timeout: None })
            .map_err(|error| failed(error.to_string()))?;
        let mapped = receiver.recv().map_err(|error| failed(error.to_string()))?;
        mapped.map_err(|error| failed(error.to_string()))?;
        let data = slice.get_mapped_range();
        let rows = data.chunks_exact(bytes_per_row(self.size.x) as usize);
        let pixels = rows.flat_map(|row| row.as_chunks::<4>().0.iter().take(self.size.x as usize));
        let numbers = pixels.map(|pixel| u32::from_le_bytes(*pixel)).collect();
        drop(data);
        self.copy.unmap();
        Ok(numbers)
    }
}

fn extent(size: UVec2) -> Extent3d {
    Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 }
}

/// Returns the number of bytes of a row of a copied image of a given width, including its padding.
fn bytes_per_row(width: u32) -> u32 {
    (4 * width).next_multiple_of(ROW)
}

/// Returns positions in single precision as bytes.
fn bytes(triangles: &[[DVec3; 3]]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(36 * triangles.len());
    for corner in triangles.iter().flatten() {
        for x in corner.as_vec3().to_array() {
            bytes.extend(x.to_le_bytes());
        }
    }
    bytes
}
