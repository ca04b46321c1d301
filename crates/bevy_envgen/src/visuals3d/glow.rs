//! The ambient light of rooms and of the open, as irradiance volumes of ambient cubes: the brightness at a
//! point for surfaces that face each of the six sides. It costs the same for any number of lamps, and dark
//! rooms stay dark without shadow maps.
//!
//! Source: J. Mitchell and others, "Shading in Valve's Source Engine" (2006).

use bevy::asset::RenderAssetUsages;
use bevy::image::{ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use envgen::World as EnvgenWorld;
use envgen::geometry::{Rect as WorldRect, Shape};
use envgen::glam::DVec2;

use super::settings::Visuals3dSettings;

/// The luminance of the brightest light in cd/m², which Bevy's default exposure shows as white.
pub(super) const INTENSITY: f32 = 1000.0;

/// The horizontal side of a voxel in metres, and the largest number of voxels along a side of the world.
const VOXEL: f64 = 0.4;
const MOST_VOXELS: f64 = 256.0;

/// The bottom in metres of the light of a building, and the number of its layers.
const BOTTOM: f64 = -0.5;
const LAYERS: usize = 4;

/// The number of points of the region map along a voxel.
const FINE: usize = 3;

/// The six sides: +x, -x, +y, -y, +z, -z.
const SIDES: [[i32; 3]; 6] = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];

/// The light of the open for each side: a bluish sky, and ground that reflects.
const SKY: [Vec3; 6] = [
    Vec3::new(0.40, 0.43, 0.47),
    Vec3::new(0.44, 0.46, 0.49),
    Vec3::new(0.37, 0.40, 0.45),
    Vec3::new(0.46, 0.48, 0.50),
    Vec3::new(0.48, 0.53, 0.60),
    Vec3::new(0.26, 0.26, 0.24),
];

/// The fraction of the light of lamps that reaches surfaces that face each side.
const LAMPS: [f32; 6] = [0.84, 0.76, 0.71, 0.88, 1.0, 0.68];

/// The colour of lamps.
const WARM: Vec3 = Vec3::new(1.0, 0.965, 0.90);

/// The light outside of rooms, such as on the tops of walls, as a fraction of the brightest light.
const OUTSIDE: f32 = 0.75;

/// Lamps in rows under a ceiling.
struct Lamps {
    low: DVec2,
    step: DVec2,
    count: IVec2,
}

impl Lamps {
    fn under(shape: &Shape, settings: &Visuals3dSettings) -> Self {
        let bounds = shape.bounds();
        let spacing = f64::from(settings.lamp_spacing.max(1.0));
        // More lamps could not be distinguished.
        let count = (bounds.size() / spacing).round().clamp(DVec2::ONE, DVec2::splat(64.0));
        Lamps { low: bounds.min, step: bounds.size() / count, count: count.as_ivec2() }
    }

    fn at(&self, place: IVec2) -> DVec2 {
        self.low + self.step * (place.as_dvec2() + 0.5)
    }

    /// Returns the light of the lamps around a point, at most 1.
    fn light(&self, p: DVec2) -> f32 {
        /// The square of the height of lamps in metres above the middle of a room.
        const ABOVE: f64 = 2.25;
        let under = ((p - self.low) / self.step).floor().as_ivec2();
        let mut sum = 0.0;
        for place in (-1..=1).flat_map(|i| (-1..=1).map(move |j| under + IVec2::new(i, j))) {
            if place.cmpge(IVec2::ZERO).all() && place.cmplt(self.count).all() {
                sum += ABOVE / (ABOVE + self.at(place).distance_squared(p));
            }
        }
        sum.min(1.0) as f32
    }
}

/// Returns the positions of the lamps under the ceiling of a shape, in rows.
pub(super) fn lamps(shape: &Shape, settings: &Visuals3dSettings) -> Vec<DVec2> {
    let lamps = Lamps::under(shape, settings);
    let rows = (0..lamps.count.y).flat_map(|j| (0..lamps.count.x).map(move |i| IVec2::new(i, j)));
    rows.map(|place| lamps.at(place)).filter(|lamp| shape.contains(*lamp)).collect()
}

/// Returns whether a world has rooms or hallways, which have lamps instead of a sky.
pub(super) fn is_building(truth: &EnvgenWorld) -> bool {
    !truth.rooms.is_empty() || truth.surfaces.iter().any(|surface| surface.kind.is_hall())
}

/// Returns the light under the sky over an area.
pub(super) fn of_sky(bounds: WorldRect, origin: DVec2) -> (Image, Transform) {
    /// The height of the volume in metres, which includes everything below and above the floor.
    const HEIGHT: f32 = 400.0;
    let image = image([1, 1, 1], |_, side| SKY[side], None);
    let at = Transform::from_translation((bounds.center() - origin).as_vec2().extend(0.0))
        .with_scale(bounds.size().as_vec2().extend(HEIGHT));
    (image, at)
}

/// The lamps of a part of a building, or `None` if it is dark.
type Region = Option<Lamps>;

/// Returns the light at a point in a part of a building, for surfaces that face a side.
fn light_in(region: &Region, p: DVec2, side: usize, settings: &Visuals3dSettings) -> Vec3 {
    match region {
        Some(lamps) => WARM * LAMPS[side] * (0.62 + 0.38 * lamps.light(p)),
        None => Vec3::splat(settings.darkness.clamp(0.0, 1.0) * LAMPS[side]),
    }
}

/// Returns the light in a building.
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
    let across = FINE * width;
    // In steps of a third of a voxel.
    let region = |i: i64, j: i64| {
        let inside = (0..across as i64).contains(&i) && (0..(FINE * depth) as i64).contains(&j);
        if inside { map[j as usize * across + i as usize] } else { 0 }
    };
    let outside = |side: usize| Vec3::splat(OUTSIDE * LAMPS[side]);
    let light = |[x, y]: [usize; 2], side: usize| {
        let middle = [x, y].map(|i| (FINE * i + FINE / 2) as i64);
        let p = bounds.min + voxel * DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let toward = SIDES[side];
        let ahead = |n: i64, toward: [i32; 3]| {
            region(middle[0] + n * i64::from(toward[0]), middle[1] + n * i64::from(toward[1]))
        };
        let light_in = |number: u16| light_in(&regions[usize::from(number) - 1], p, side, settings);
        if toward[2] == 0 {
            // The sides of a wall get the light of the room that they face, even if their voxel is partly
            // behind the wall.
            let seen = [3, 2, 4, 1, 0].into_iter().map(|n| ahead(n, toward)).find(|&seen| seen > 0);
            return seen.map_or_else(|| outside(side), light_in);
        }
        let here = region(middle[0], middle[1]);
        if here > 0 {
            return light_in(here);
        }
        // Floors extend to the middle of walls, so a point inside a wall gets the mean light of the rooms
        // beside it.
        let (mut sum, mut count) = (Vec3::ZERO, 0.0);
        for (toward, n) in SIDES[..4].iter().flat_map(|side| [(side, 2), (side, 3)]) {
            let beside = ahead(n, *toward);
            if beside > 0 {
                sum += light_in(beside);
                count += 1.0;
            }
        }
        if count > 0.0 { sum / count } else { outside(side) }
    };
    // The highest layer is at the tops of walls, which are visible if there are no ceilings.
    let above = (!settings.ceilings).then_some(Vec3::splat(OUTSIDE));
    let image = image([width, depth, LAYERS], light, above);
    let size = DVec2::new(width as f64, depth as f64) * voxel;
    let middle = (bounds.min + 0.5 * size - origin).as_vec2();
    let at = Transform::from_translation(middle.extend(0.5 * (BOTTOM + top) as f32))
        .with_scale(size.as_vec2().extend((top - BOTTOM) as f32));
    (image, at)
}

/// Returns the regions of a building, and a map with the number of the region at each point, counted from 1,
/// with 0 outside of all regions. Rooms take precedence over hallways.
fn regions(
    truth: &EnvgenWorld,
    low: DVec2,
    voxel: f64,
    [width, depth]: [usize; 2],
    settings: &Visuals3dSettings,
) -> (Vec<Region>, Vec<u16>) {
    let step = voxel / FINE as f64;
    let mut map = vec![0_u16; FINE * FINE * width * depth];
    let hallways = truth.surfaces.iter().filter(|surface| surface.kind.is_hall());
    let shapes = hallways
        .map(|surface| (&surface.shape, true))
        .chain(truth.rooms.iter().map(|room| (&room.shape, room.lit)))
        // More do not fit into the map. The rest is as bright as the outside.
        .take(usize::from(u16::MAX));
    let mut regions = Vec::new();
    for (shape, is_lit) in shapes {
        regions.push(is_lit.then(|| Lamps::under(shape, settings)));
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

/// Packs ambient cubes in the layout that Bevy's shader reads. The three axes follow one another along the
/// last axis of the texture. Along the second axis, the sides that face the positive direction of an axis
/// precede the others. `light` is the same in all layers, except for surfaces that face up in the highest
/// layer, which get `above` if it is given.
fn image(
    [width, depth, height]: [usize; 3],
    light: impl Fn([usize; 2], usize) -> Vec3,
    above: Option<Vec3>,
) -> Image {
    let codes = srgb_codes();
    let code = |light: f32| codes[(light.clamp(0.0, 1.0) * (codes.len() - 1) as f32) as usize];
    let mut data = vec![255_u8; 4 * width * 2 * depth * 3 * height];
    for (side, toward) in SIDES.iter().enumerate() {
        let (axis, half) = (side / 2, side % 2);
        for (x, y) in (0..depth).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let color = light([x, y], side).to_array().map(code);
            for z in 0..height {
                let (row, layer) = (y + half * depth, z + axis * height);
                let at = 4 * (x + width * (row + 2 * depth * layer));
                let above = above.filter(|_| z + 1 == height && toward[2] > 0);
                let color = above.map_or(color, |above| above.to_array().map(code));
                data[at..at + 3].copy_from_slice(&color);
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

/// Returns the sRGB codes of light from 0 to 1, in even steps that are finer than the codes.
pub(super) fn srgb_codes() -> Vec<u8> {
    const STEPS: u16 = 8192;
    let light = |step: u16| LinearRgba::gray(f32::from(step) / f32::from(STEPS));
    (0..=STEPS).map(|step| Srgba::from(light(step)).to_u8_array()[0]).collect()
}

#[cfg(test)]
mod tests {
    use envgen::world::{Room, Wall, WallKind};
    use envgen::{Provenance, World as EnvgenWorld};

    use super::*;

    fn room(from: DVec2, to: DVec2, lit: bool) -> Room {
        let shape = Shape::from_rect(WorldRect::new(from, to));
        let name = String::new();
        Room { name, shape, difficulty: None, lit, contents: Default::default(), height: None }
    }

    /// Returns the red value of a voxel for a side, as Bevy's shader reads it.
    fn red(image: &Image, [x, y, z]: [usize; 3], side: usize) -> u8 {
        let size = image.texture_descriptor.size;
        let (width, rows, layers) =
            (size.width as usize, size.height as usize, size.depth_or_array_layers as usize);
        let row = y + if side % 2 == 1 { rows / 2 } else { 0 };
        let layer = z + side / 2 * (layers / 3);
        image.data.as_ref().unwrap()[4 * (x + width * (row + rows * layer))]
    }

    #[test]
    fn walls_have_the_light_of_the_room_that_they_look_into() {
        let v = DVec2::new;
        let bounds = WorldRect::new(DVec2::ZERO, v(12.0, 6.0));
        let mut world = EnvgenWorld::new(Provenance::other("test", "rooms".into()), bounds);
        let between = Shape::from_rect(WorldRect::new(v(5.9, 0.0), v(6.1, 6.0)));
        world.walls.push(Wall::new(WallKind::Wall, between));
        world.rooms.push(room(DVec2::ZERO, v(5.9, 6.0), true));
        world.rooms.push(room(v(6.1, 0.0), v(12.0, 6.0), false));
        let settings = Visuals3dSettings { ceilings: true, ..Default::default() };
        let (image, at) = of_building(&world, DVec2::ZERO, &settings);
        let size = image.texture_descriptor.size;
        let count = [size.width, size.height / 2, size.depth_or_array_layers / 3];
        // Returns the voxel that contains a point.
        let voxel = |p: Vec3| {
            let unit = at.to_matrix().inverse().transform_point3(p) + 0.5;
            std::array::from_fn(|i| (unit[i] * count[i] as f32) as usize)
        };
        // Between the centres of the voxels at x = 5.6, 6.0 and 6.4, the light of the two sides of the wall
        // is interpolated.
        let light = |x: f32, side| red(&image, voxel(Vec3::new(x, 3.0, 1.0)), side);
        for x in [5.6, 6.0] {
            assert!(light(x, 1) > 180, "the left side at {x}");
        }
        for x in [6.0, 6.4] {
            assert!(light(x, 0) < 60, "the right side at {x}");
        }
        for (x, is_lit) in [(3.0, true), (9.0, false)] {
            for z in [0.0, 2.5] {
                for side in 0..6 {
                    let light = red(&image, voxel(Vec3::new(x, 3.0, z)), side);
                    assert_eq!(light > 120, is_lit, "{x} {z} {side}: {light}");
                }
            }
        }
        // Without ceilings the tops of walls are lit from above.
        let (image, _) = of_building(&world, DVec2::ZERO, &Visuals3dSettings::default());
        assert!(red(&image, voxel(Vec3::new(9.0, 3.0, 2.5)), 4) > 180);
        assert!(red(&image, voxel(Vec3::new(9.0, 3.0, 0.0)), 4) < 60);
    }

    #[test]
    fn codes_are_those_of_srgb() {
        let codes = srgb_codes();
        for light in [0.0, 0.002, 0.02, 0.2, 0.5, 1.0_f32] {
            let exact = Srgba::from(LinearRgba::gray(light)).to_u8_array()[0];
            let found = codes[(light * (codes.len() - 1) as f32) as usize];
            assert!(exact.abs_diff(found) <= 1, "{light}");
        }
    }
}
