//! All parts of one style in a single path, with very small parts as a shadow.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::DVec2;
use svg::node::element::{Group, Image, Path};

use super::error::PictureError;
use super::path::PathData;
use super::style::Style;
use super::view::View;
use crate::geometry::Shape;
use crate::palette::Srgb;

/// Worlds with at most this many parts are drawn entirely as paths. In worlds with more, parts that are smaller
/// than a pixel are drawn as a shadow.
pub(super) const MANY_PARTS: usize = 30_000;

/// Shapes of one style.
#[derive(Debug)]
pub(super) struct Ink<'a> {
    view: &'a View,
    filled: PathData,
    lines: PathData,
    shadow: Option<Shadow>,
    shadows: bool,
}

impl<'a> Ink<'a> {
    /// Creates an empty collection. If the world has `many` parts, coordinates are coarser and the smallest parts
    /// become a shadow.
    pub(super) fn new(view: &'a View, many: bool) -> Self {
        let decimals = if many { 1 } else { 2 };
        Ink {
            view,
            filled: PathData::new(decimals),
            lines: PathData::new(decimals),
            shadow: None,
            shadows: many,
        }
    }

    /// Creates an empty collection without a shadow, for lists with so many styles that not each can have one.
    pub(super) fn without_shadow(view: &'a View, many: bool) -> Self {
        Ink { shadows: false, ..Ink::new(view, many) }
    }

    pub(super) fn shape(&mut self, shape: &Shape) {
        if self.shadows && self.shade(shape) {
            return;
        }
        match shape {
            Shape::Segment { a, b } => self.lines.line(self.view.px(*a), self.view.px(*b)),
            Shape::Disc { center, radius } => {
                self.filled.circle(self.view.px(*center), radius * self.view.scale);
            }
            Shape::Box { .. } | Shape::Polygon { .. } => {
                self.filled.polygon(self.view.outline(shape));
            }
        }
    }

    /// Adds a shape to the shadow if it is smaller than a pixel; returns whether it is.
    fn shade(&mut self, shape: &Shape) -> bool {
        let around = self.view.px_rect(shape.bounds());
        if around.size().max_element() >= 1.0 {
            return false;
        }
        // A line of no thickness counts as a fifth of a pixel wide.
        let area = match shape {
            Shape::Segment { .. } => around.size().length() * 0.2,
            _ => shape.area() * self.view.scale * self.view.scale,
        };
        let view = self.view;
        self.shadow.get_or_insert_with(|| Shadow::new(view)).add(around.center(), area);
        true
    }

    /// Returns the group of all shapes.
    pub(super) fn into_group(self, id: &str, style: Style) -> Result<Group, PictureError> {
        let mut group = Group::new().set("id", id);
        if let Some(shadow) = self.shadow {
            group = group.add(shadow.into_image(style.fill)?);
        }
        if !self.filled.is_empty() {
            let path = Path::new()
                .set("d", self.filled.into_text())
                .set("fill", style.fill.to_string())
                .set("stroke", style.edge.to_string())
                .set("stroke-width", style.edge_width)
                .set("stroke-linejoin", "round");
            group = group.add(path);
        }
        if !self.lines.is_empty() {
            let path = Path::new()
                .set("d", self.lines.into_text())
                .set("fill", "none")
                .set("stroke", style.edge.to_string())
                .set("stroke-width", 1.5)
                .set("stroke-linecap", "round");
            group = group.add(path);
        }
        Ok(group)
    }
}

/// The share of each pixel of the plan that is covered by parts smaller than the pixel.
#[derive(Debug)]
pub(super) struct Shadow {
    corner: DVec2,
    width: usize,
    height: usize,
    /// Coverage per pixel in units of 1 / [`FULL`] of a pixel.
    covered: Vec<u16>,
}

/// The value of a fully covered pixel.
const FULL: f64 = 4096.0;

/// The least area of a part in square pixels, so that parts do not vanish by rounding.
const LEAST_AREA: f64 = 0.02;

impl Shadow {
    pub(super) fn new(view: &View) -> Self {
        let size = view.plan.size();
        let (width, height) = (size.x as usize, size.y as usize);
        Shadow { corner: view.plan.min, width, height, covered: vec![0; width * height] }
    }

    /// Adds `area` square pixels at a point, divided between the four nearest pixels.
    pub(super) fn add(&mut self, at: DVec2, area: f64) {
        let area = area.max(LEAST_AREA);
        let at = at - self.corner - DVec2::splat(0.5);
        let first = at.floor();
        let part = at - first;
        let shares = [
            (0.0, 0.0, (1.0 - part.x) * (1.0 - part.y)),
            (1.0, 0.0, part.x * (1.0 - part.y)),
            (0.0, 1.0, (1.0 - part.x) * part.y),
            (1.0, 1.0, part.x * part.y),
        ];
        for (dx, dy, share) in shares {
            let (x, y) = (first.x + dx, first.y + dy);
            if x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < self.height as f64 {
                let pixel = &mut self.covered[y as usize * self.width + x as usize];
                *pixel = pixel.saturating_add((area * share * FULL).round() as u16);
            }
        }
    }

    /// Returns the shadow as an image. It is darker where more is covered, and amplified where it would be too
    /// faint to be visible.
    pub(super) fn into_image(self, color: Srgb) -> Result<Image, PictureError> {
        let alphas: Vec<u8> = (0..=255).collect();
        let strength = 255.0 * (0.85 / self.upper_percentile()).max(1.0) / FULL;
        let pixels: Vec<u8> =
            self.covered.iter().map(|&c| (f64::from(c) * strength).round() as u8).collect();
        let size = DVec2::new(self.width as f64, self.height as f64);
        let image = Indexed {
            width: self.width as u32,
            height: self.height as u32,
            colors: vec![color; 256],
            alphas,
            pixels,
        };
        image.to_element(self.corner, size)
    }

    /// Returns the coverage that 95 of 100 shaded pixels do not exceed, as a share of a pixel.
    fn upper_percentile(&self) -> f64 {
        let mut counts = vec![0_u64; FULL as usize + 1];
        for &covered in self.covered.iter().filter(|&&covered| covered > 0) {
            counts[usize::from(covered).min(FULL as usize)] += 1;
        }
        let above = counts.iter().sum::<u64>() / 20;
        let mut seen = 0;
        let value = (1..counts.len()).rev().find(|&value| {
            seen += counts[value];
            seen > above
        });
        value.map_or(1.0, |value| value as f64 / FULL)
    }
}

/// An image of 1 to 256 colours.
#[derive(Debug)]
pub(super) struct Indexed {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) colors: Vec<Srgb>,
    /// Opacities of the first colours. The others are opaque.
    pub(super) alphas: Vec<u8>,
    /// One index per pixel, row by row from the top.
    pub(super) pixels: Vec<u8>,
}

impl Indexed {
    /// Returns the image as an element whose pixels remain sharp, stretched to `size` px.
    pub(super) fn to_element(&self, corner: DVec2, size: DVec2) -> Result<Image, PictureError> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(png::ColorType::Indexed);
        let depth = match self.colors.len() {
            0..=2 => png::BitDepth::One,
            3..=4 => png::BitDepth::Two,
            5..=16 => png::BitDepth::Four,
            _ => png::BitDepth::Eight,
        };
        encoder.set_depth(depth);
        encoder.set_palette(self.colors.iter().flat_map(|c| c.0).collect::<Vec<_>>());
        if !self.alphas.is_empty() {
            encoder.set_trns(self.alphas.clone());
        }
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.packed(depth))?;
        writer.finish()?;
        Ok(Image::new()
            .set("x", corner.x)
            .set("y", corner.y)
            .set("width", size.x)
            .set("height", size.y)
            .set("preserveAspectRatio", "none")
            .set("image-rendering", "optimizeSpeed")
            .set("href", format!("data:image/png;base64,{}", STANDARD.encode(&file))))
    }

    /// Packs rows of pixels with as many pixels per byte as the depth allows, the first one in the highest bits.
    fn packed(&self, depth: png::BitDepth) -> Vec<u8> {
        let bits = depth as usize;
        if bits == 8 {
            return self.pixels.clone();
        }
        let pack = |pixels: &[u8]| {
            let bytes = pixels.iter().enumerate();
            bytes.fold(0, |byte, (i, &pixel)| byte | pixel << (8 - bits * (i + 1)))
        };
        let rows = self.pixels.chunks(self.width.max(1) as usize);
        rows.flat_map(|row| row.chunks(8 / bits).map(pack)).collect()
    }
}
