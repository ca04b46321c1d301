//! The light that fills rooms and the open, as volumes of ambient cubes: how bright it is at a point, for surfaces
//! that look to each of the six sides. It costs the same for any number of lamps, and dark rooms stay dark without
//! shadow maps.
//!
//! J. Mitchell, G. McTaggart, C. Green, "Shading in Valve's Source Engine" (2006).

use bevy::asset::RenderAssetUsages;
use bevy::image::{ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use envgen::World as EnvgenWorld;
use envgen::geometry::{Rect as WorldRect, Shape};
use envgen::glam::DVec2;

use super::Visuals3dSettings;
use super::stage::is_hallway;

/// Luminance of the brightest light in cd/m², which Bevy's default exposure shows as white.
pub(super) const INTENSITY: f32 = 1000.0;

/// Side of a voxel on the plan in metres, and the most voxels along a side of the world.
const VOXEL: f64 = 0.4;
const MOST_VOXELS: f64 = 256.0;

/// Bottom and height of the light of a building in metres, and its layers.
const BOTTOM: f64 = -0.5;
const LAYERS: usize = 4;

/// Points of the region map along a voxel.
const FINE: usize = 3;

/// The six sides: +x, -x, +y, -y, +z, -z.
const SIDES: [[i32; 3]; 6] = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];

/// Light of the open on each side: a sky that is bluish, ground that reflects.
const SKY: [Vec3; 6] = [
    Vec3::new(0.40, 0.43, 0.47),
    Vec3::new(0.44, 0.46, 0.49),
    Vec3::new(0.37, 0.40, 0.45),
    Vec3::new(0.46, 0.48, 0.50),
    Vec3::new(0.48, 0.53, 0.60),
    Vec3::new(0.26, 0.26, 0.24),
];

/// Share of the light of lamps that reaches surfaces on each side.
const LAMPS: [f32; 6] = [0.84, 0.76, 0.71, 0.88, 1.0, 0.68];

/// The colour of lamps.
const WARM: Vec3 = Vec3::new(1.0, 0.965, 0.90);

/// Light of what is no room, such as the tops of walls: as a share of the brightest.
const OUTSIDE: f32 = 0.75;

/// The lamps under the ceiling of a shape, in rows.
pub(super) fn lamps(shape: &Shape, settings: &Visuals3dSettings) -> Vec<DVec2> {
    let bounds = shape.bounds();
    let spacing = f64::from(settings.lamp_spacing.max(1.0));
    // More would hardly be brighter.
    let count = (bounds.size() / spacing).round().clamp(DVec2::ONE, DVec2::splat(64.0));
    let step = bounds.size() / count;
    let rows = (0..count.y as u32).flat_map(|j| (0..count.x as u32).map(move |i| (i, j)));
    let lamp =
        |(i, j): (u32, u32)| bounds.min + step * DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
    rows.map(lamp).filter(|lamp| shape.contains(*lamp)).collect()
}

/// The light under the sky over an area.
pub(super) fn of_sky(bounds: WorldRect, origin: DVec2) -> (Image, Transform) {
    /// From below everything to above it, in metres.
    const HEIGHT: f32 = 400.0;
    let image = image([1, 1, 1], |_, side| SKY[side]);
    let at = Transform::from_translation((bounds.center() - origin).as_vec2().extend(0.0))
        .with_scale(bounds.size().as_vec2().extend(HEIGHT));
    (image, at)
}

/// A part of a building that is lit in one way.
struct Region {
    is_lit: bool,
    lamps: Vec<DVec2>,
}

impl Region {
    /// Light at a point for a side.
    fn light(&self, p: DVec2, side: usize, settings: &Visuals3dSettings) -> Vec3 {
        /// Height of lamps above the middle of a room in metres, squared.
        const ABOVE: f64 = 2.25;
        if !self.is_lit {
            return Vec3::splat(settings.darkness.clamp(0.0, 1.0) * LAMPS[side]);
        }
        let near = |lamp: &DVec2| ABOVE / (ABOVE + lamp.distance_squared(p));
        let direct: f64 = self.lamps.iter().map(near).sum();
        WARM * LAMPS[side] * (0.62 + 0.38 * direct.min(1.0) as f32)
    }
}

/// The light in a building.
pub(super) fn of_building(
    truth: &EnvgenWorld,
    origin: DVec2,
    settings: &Visuals3dSettings,
) -> (Image, Transform) {
    let bounds = truth.bounds.grown(1.0);
    let voxel = VOXEL.max(bounds.size().max_element() / MOST_VOXELS);
    let count = (bounds.size() / voxel).ceil();
    let [width, depth] = [count.x as usize, count.y as usize];
    let (regions, map) = regions(truth, bounds.min, voxel, [width, depth], settings);
    let walls = truth.walls.iter().map(|wall| wall.extent().top());
    let top = walls.fold(2.6, f64::max) + 0.3;
    let height = (top - BOTTOM) / LAYERS as f64;
    let across = FINE * width;
    // In steps of a third of a voxel.
    let region = |i: i64, j: i64| {
        let inside = (0..across as i64).contains(&i) && (0..(FINE * depth) as i64).contains(&j);
        if inside { map[j as usize * across + i as usize] } else { 0 }
    };
    let light = |[x, y, z]: [usize; 3], side: usize| {
        let middle = [x, y].map(|i| (FINE * i + FINE / 2) as i64);
        let p = bounds.min + voxel * DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let toward = SIDES[side];
        let above_walls = BOTTOM + height * (z as f64 + 0.5) > top - 0.7;
        if toward[2] != 0 {
            // Floors reach to the walls: what is in a wall takes the light of what is beside it.
            if above_walls && toward[2] > 0 {
                return Vec3::splat(OUTSIDE);
            }
            let here = region(middle[0], middle[1]);
            if here > 0 {
                return regions[usize::from(here) - 1].light(p, side, settings);
            }
            let beside =
                SIDES[..4].iter().flat_map(|side| [2, 3].map(|n| (side, n))).map(|(side, n)| {
                    region(middle[0] + n * i64::from(side[0]), middle[1] + n * i64::from(side[1]))
                });
            let beside: Vec<u16> = beside.filter(|&region| region > 0).collect();
            let sum: Vec3 = beside
                .iter()
                .map(|&region| regions[usize::from(region) - 1].light(p, side, settings))
                .sum();
            return match beside.len() {
                0 => Vec3::splat(OUTSIDE * LAMPS[side]),
                n => sum / n as f32,
            };
        }
        // A wall is lit by what it looks at, although its voxel is partly behind it.
        let ahead = [3, 2, 4, 1, 0].map(|n| {
            region(middle[0] + n * i64::from(toward[0]), middle[1] + n * i64::from(toward[1]))
        });
        match ahead.into_iter().find(|&region| region > 0) {
            Some(region) => regions[usize::from(region) - 1].light(p, side, settings),
            None => Vec3::splat(OUTSIDE * LAMPS[side]),
        }
    };
    let image = image([width, depth, LAYERS], light);
    let size = DVec2::new(width as f64, depth as f64) * voxel;
    let middle = (bounds.min + 0.5 * size - origin).as_vec2();
    let at = Transform::from_translation(middle.extend(0.5 * (BOTTOM + top) as f32))
        .with_scale(size.as_vec2().extend((top - BOTTOM) as f32));
    (image, at)
}

/// The regions of a building, and the number of the one at each point of a map, from 1; 0 is none. Rooms are over
/// hallways.
fn regions(
    truth: &EnvgenWorld,
    low: DVec2,
    voxel: f64,
    [width, depth]: [usize; 2],
    settings: &Visuals3dSettings,
) -> (Vec<Region>, Vec<u16>) {
    let step = voxel / FINE as f64;
    let mut map = vec![0_u16; FINE * FINE * width * depth];
    let hallways = truth.surfaces.iter().filter(|surface| is_hallway(surface.kind));
    let shapes = hallways
        .map(|surface| (&surface.shape, true))
        .chain(truth.rooms.iter().map(|room| (&room.shape, room.lit)))
        // More do not fit into the map: the rest is as bright as the outside.
        .take(usize::from(u16::MAX));
    let mut regions = Vec::new();
    for (shape, is_lit) in shapes {
        let lamps = if is_lit { lamps(shape, settings) } else { Vec::new() };
        regions.push(Region { is_lit, lamps });
        let number = regions.len() as u16;
        let bounds = shape.bounds();
        let cell = |p: DVec2| ((p - low) / step).floor().max(DVec2::ZERO);
        let (from, to) = (cell(bounds.min), cell(bounds.max));
        for j in from.y as usize..=(to.y as usize).min(FINE * depth - 1) {
            for i in from.x as usize..=(to.x as usize).min(FINE * width - 1) {
                let p = low + step * DVec2::new(i as f64 + 0.5, j as f64 + 0.5);
                if shape.contains(p) {
                    map[j * FINE * width + i] = number;
                }
            }
        }
    }
    (regions, map)
}

/// Packs ambient cubes as Bevy's shader reads them: the three axes one after the other along the last axis of the
/// texture, the sides that look to the positive of an axis before the others along the second.
fn image([width, depth, height]: [usize; 3], light: impl Fn([usize; 3], usize) -> Vec3) -> Image {
    let mut data = vec![0_u8; 4 * width * 2 * depth * 3 * height];
    for side in 0..6 {
        let (axis, half) = (side / 2, side % 2);
        for z in 0..height {
            for y in 0..depth {
                for x in 0..width {
                    let [red, green, blue] = light([x, y, z], side).to_array();
                    let color = Srgba::from(LinearRgba::rgb(red, green, blue)).to_u8_array();
                    let (row, layer) = (y + half * depth, z + axis * height);
                    let at = 4 * (x + width * (row + 2 * depth * layer));
                    data[at..at + 4].copy_from_slice(&color);
                }
            }
        }
    }
    let size = Extent3d {
        width: width as u32,
        height: 2 * depth as u32,
        depth_or_array_layers: 3 * height as u32,
    };
    let format = TextureFormat::Rgba8UnormSrgb;
    let usage = RenderAssetUsages::RENDER_WORLD;
    let mut image = Image::new(size, TextureDimension::D3, data, format, usage);
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        ..default()
    });
    image
}
