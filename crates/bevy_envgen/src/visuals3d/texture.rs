//! The procedural textures of finishes: tiles, plaster with a skirting board, panels and soil.

use bevy::asset::RenderAssetUsages;
use bevy::image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};

use super::finish::Finish;
use super::glow::srgb_codes;

/// The number of pixels along the side of a texture.
const SIDE: u32 = 256;

/// The width of the joints of tiles and panels, and the height of skirting boards, in metres.
const JOINT: f32 = 0.012;
const SKIRTING: f32 = 0.09;

impl Finish {
    /// Returns the side in metres of the area that the texture covers, or `None` for finishes without a
    /// texture.
    pub(super) fn texture_side(self) -> Option<f32> {
        match self {
            Finish::Floor | Finish::Ceiling => Some(2.4),
            Finish::Wall => Some(3.0),
            Finish::Ground => Some(6.0),
            Finish::Leaves | Finish::Bark => Some(2.0),
            _ => None,
        }
    }

    /// Returns the lightness at a point in metres, as a factor on the colour of the finish.
    fn lightness(self, p: Vec2, side: f32) -> f32 {
        let noise = |cell: f32, share: f32| 1.0 - share * smooth_noise(p, cell, side);
        match self {
            Finish::Floor => {
                let tile = (p / 0.6).floor();
                let inside = p - 0.6 * tile;
                if inside.min_element() < JOINT {
                    return 0.72;
                }
                noise(0.05, 0.04) * (1.0 - 0.06 * random(tile.as_ivec2()))
            }
            Finish::Ceiling => {
                let inside = p - 0.6 * (p / 0.6).floor();
                if inside.min_element() < JOINT { 0.8 } else { noise(0.03, 0.05) }
            }
            Finish::Wall if p.y < SKIRTING => 0.42,
            Finish::Wall => noise(0.6, 0.03) * noise(0.05, 0.02),
            Finish::Leaves => noise(0.25, 0.35) * noise(0.1, 0.3),
            Finish::Bark => noise(0.1, 0.35),
            _ => noise(1.5, 0.10) * noise(0.3, 0.08) * noise(0.05, 0.08),
        }
    }

    /// Returns the texture with all its mipmap levels, so that it does not flicker from afar.
    pub(super) fn texture(self) -> Option<Image> {
        let side = self.texture_side()?;
        let step = side / SIDE as f32;
        let pixel = |x: u32, y: u32| {
            self.lightness(Vec2::new(x as f32 + 0.5, y as f32 + 0.5) * step, side).clamp(0.0, 1.0)
        };
        let mut level: Vec<f32> = (0..SIDE)
            .flat_map(|y| (0..SIDE).map(move |x| (x, y)))
            .map(|(x, y)| pixel(x, y))
            .collect();
        let codes = srgb_codes();
        let mut data = Vec::new();
        let mut size = SIDE as usize;
        let mut levels = 0;
        loop {
            let code = |light: f32| codes[(light * (codes.len() - 1) as f32) as usize];
            data.extend(level.iter().flat_map(|&light| {
                let code = code(light);
                [code, code, code, 255]
            }));
            levels += 1;
            if size == 1 {
                break;
            }
            let half = size / 2;
            let at = |x: usize, y: usize| level[y * size + x];
            let mean = |x: usize, y: usize| {
                0.25 * (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1))
            };
            level = (0..half)
                .flat_map(|y| (0..half).map(move |x| (2 * x, 2 * y)))
                .map(|(x, y)| mean(x, y))
                .collect();
            size = half;
        }
        let size = Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 };
        let format = TextureFormat::Rgba8UnormSrgb;
        let usage = RenderAssetUsages::RENDER_WORLD;
        let mut image = Image::new_uninit(size, TextureDimension::D2, format, usage);
        image.data = Some(data);
        image.texture_descriptor.mip_level_count = levels;
        // The skirting board is only at the bottom, so the texture does not repeat upwards.
        let upward = if self == Finish::Wall {
            ImageAddressMode::ClampToEdge
        } else {
            ImageAddressMode::Repeat
        };
        image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
            address_mode_u: ImageAddressMode::Repeat,
            address_mode_v: upward,
            mag_filter: ImageFilterMode::Linear,
            min_filter: ImageFilterMode::Linear,
            mipmap_filter: ImageFilterMode::Linear,
            anisotropy_clamp: 4,
            ..default()
        });
        Some(image)
    }
}

/// Returns a pseudo-random number from 0 to 1 for a point of a grid.
fn random(at: IVec2) -> f32 {
    // A multiplicative hash in two rounds.
    let mut bits =
        (at.x as u32).wrapping_mul(0x9e37_79b1) ^ (at.y as u32).wrapping_mul(0x85eb_ca77);
    bits = (bits ^ (bits >> 15)).wrapping_mul(0x2c1b_3c6d);
    bits = (bits ^ (bits >> 12)).wrapping_mul(0x297a_2d39);
    (bits >> 8) as f32 / (1 << 24) as f32
}

/// Returns noise from 0 to 1 that varies over `cell` metres and repeats after `side` metres.
fn smooth_noise(p: Vec2, cell: f32, side: f32) -> f32 {
    let count = (side / cell).round().max(1.0);
    let p = p * (count / side);
    let (low, part) = (p.floor(), p.fract());
    let part = part * part * (3.0 - 2.0 * part);
    let corner = |x: f32, y: f32| {
        let at = Vec2::new((low.x + x).rem_euclid(count), (low.y + y).rem_euclid(count));
        random(at.as_ivec2() + 7 * count as i32)
    };
    let bottom = corner(0.0, 0.0).lerp(corner(1.0, 0.0), part.x);
    let top = corner(0.0, 1.0).lerp(corner(1.0, 1.0), part.x);
    bottom.lerp(top, part.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textures_hold_all_their_halves() {
        for finish in [Finish::Floor, Finish::Wall, Finish::Ground, Finish::Ceiling] {
            let image = finish.texture().unwrap();
            let pixels: u32 = (0..=8).map(|level| (SIDE >> level).pow(2)).sum();
            assert_eq!(image.texture_descriptor.mip_level_count, 9);
            assert_eq!(image.data.map(|data| data.len()), Some(4 * pixels as usize));
        }
        assert!(Finish::Metal.texture().is_none());
    }

    #[test]
    fn noise_repeats() {
        for i in 0..100 {
            let p = Vec2::new(0.13, 0.29) * i as f32;
            let noise = smooth_noise(p, 0.25, 2.0);
            assert!((0.0..=1.0).contains(&noise));
            assert!((smooth_noise(p + Vec2::new(2.0, 4.0), 0.25, 2.0) - noise).abs() < 1e-3);
        }
    }
}
