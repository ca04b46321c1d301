//! The classes of a landscape as an embedded image.

use std::collections::BTreeSet;

use svg::node::element::{Group, Image};

use super::error::PictureError;
use super::ink::Indexed;
use super::view::View;
use crate::geometry::Rect;
use crate::palette;
use crate::world::ClassRaster;

/// Returns the classes of a raster, without 0.
pub(super) fn classes(raster: &ClassRaster) -> BTreeSet<u16> {
    let mut present = vec![false; 1 << 16];
    for &class in &raster.cells {
        present[usize::from(class)] = true;
    }
    (1..=u16::MAX).filter(|&class| present[usize::from(class)]).collect()
}

pub(super) fn group(raster: &ClassRaster, view: &View) -> Result<Group, PictureError> {
    Ok(Group::new().set("id", "landscape").add(image(raster, view)?))
}

fn image(raster: &ClassRaster, view: &View) -> Result<Image, PictureError> {
    let around = view.px_rect(raster.frame().bounds());
    // Index 0 is no data; where there are more classes than colours, classes share them.
    let greatest = raster.cells.iter().copied().max().unwrap_or(0).min(255);
    let index = |class: u16| if class < 256 { class as u8 } else { ((class - 1) % 255 + 1) as u8 };
    let colors = std::iter::once(palette::PLAN)
        .chain((1..=greatest).map(palette::class))
        .collect::<Vec<_>>();
    let (width, height, pixels) = if raster.cell * view.scale >= 1.0 {
        (raster.cols, raster.rows, raster.cells.iter().map(|&class| index(class)).collect())
    } else {
        sampled(raster, view, around, index)
    };
    let image = Indexed { width, height, colors, alphas: vec![0], pixels };
    image.to_element(around.min, around.size())
}

/// Samples a raster that has cells smaller than a pixel, to one cell per pixel of the picture.
fn sampled(
    raster: &ClassRaster,
    view: &View,
    around: Rect,
    index: impl Fn(u16) -> u8,
) -> (u32, u32, Vec<u8>) {
    let limit = |px: f64, cells: u32| (px.round().max(1.0) as u32).min(cells);
    let width = limit(around.size().x, raster.cols);
    let height = limit(around.size().y, raster.rows);
    debug_assert!(f64::from(width) <= view.plan.size().x + 1.0);
    let nearest = |i: u32, pixels: u32, cells: u32| {
        ((f64::from(i) + 0.5) * f64::from(cells) / f64::from(pixels)) as usize
    };
    let mut pixels = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        let row = nearest(y, height, raster.rows) * raster.cols as usize;
        pixels
            .extend((0..width).map(|x| index(raster.cells[row + nearest(x, width, raster.cols)])));
    }
    (width, height, pixels)
}
