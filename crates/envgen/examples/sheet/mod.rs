//! Pages of many small pictures of worlds.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::io::Cursor;
use std::path::Path;

use envgen::World;
use envgen::picture::{self, PictureOptions};
use png::{BitDepth, ColorType, Compression, Decoder, Encoder, Filter};

pub(crate) type Result<T = ()> = std::result::Result<T, Box<dyn Error>>;

/// Width of a picture in px, and the gap to the next.
const WIDTH: u32 = 300;
const GAP: usize = 8;

/// Pixels per px: pictures that are drawn larger and scaled down keep their titles on one line.
const PIXEL_RATIO: f64 = 0.8;

/// Pixels row by row, three bytes each.
pub(crate) struct Image {
    width: usize,
    rgb: Vec<u8>,
}

/// The picture of a world.
pub(crate) fn picture(world: &World, title: String) -> Result<Image> {
    let options = PictureOptions {
        width: WIDTH,
        height: WIDTH,
        pixel_ratio: PIXEL_RATIO,
        margin: 4,
        title: Some(title),
        legend: false,
        names: false,
        ..Default::default()
    };
    Image::from_png(&picture::png(world, &options)?)
}

/// Writes pictures as a page of so many columns; folders are made where they are missing.
pub(crate) fn write(file: &Path, pictures: &[Image], columns: usize) -> Result {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    Ok(fs::write(file, page(pictures, columns).to_png()?)?)
}

/// The pictures in rows.
fn page(tiles: &[Image], columns: usize) -> Image {
    let columns = columns.min(tiles.len());
    let width = tiles.iter().map(|tile| tile.width).max().unwrap_or_default() + GAP;
    let height = tiles.iter().map(Image::height).max().unwrap_or_default() + GAP;
    let whole = columns * width;
    let mut rgb = vec![u8::MAX; 3 * whole * height * tiles.len().div_ceil(columns)];
    for (i, tile) in tiles.iter().enumerate() {
        let corner = (i / columns * height) * whole + i % columns * width;
        for (row, pixels) in tile.rgb.chunks_exact(3 * tile.width).enumerate() {
            let from = 3 * (corner + row * whole);
            rgb[from..from + pixels.len()].copy_from_slice(pixels);
        }
    }
    Image { width: whole, rgb }
}

impl Image {
    fn height(&self) -> usize {
        self.rgb.len() / (3 * self.width)
    }

    fn from_png(file: &[u8]) -> Result<Self> {
        let mut reader = Decoder::new(Cursor::new(file)).read_info()?;
        let size = reader.output_buffer_size().ok_or("the picture is too large")?;
        let mut rgb = vec![0; size];
        let frame = reader.next_frame(&mut rgb)?;
        Ok(Image { width: frame.width as usize, rgb })
    }

    /// As a PNG of at most 256 colours, the most frequent; others become the nearest of them.
    fn to_png(&self) -> Result<Vec<u8>> {
        let (palette, pixels) = self.indexed();
        let mut file = Vec::new();
        let size = [self.width, self.height()].map(u32::try_from);
        let [width, height] = [size[0]?, size[1]?];
        let mut encoder = Encoder::new(&mut file, width, height);
        encoder.set_color(ColorType::Indexed);
        encoder.set_palette(palette.as_flattened());
        encoder.set_depth(BitDepth::Eight);
        encoder.set_filter(Filter::NoFilter);
        encoder.set_compression(Compression::High);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&pixels)?;
        writer.finish()?;
        Ok(file)
    }

    /// The palette, and the index of each pixel's colour.
    fn indexed(&self) -> (Vec<[u8; 3]>, Vec<u8>) {
        let (colors, _) = self.rgb.as_chunks::<3>();
        let mut counts: BTreeMap<[u8; 3], usize> = BTreeMap::new();
        for color in colors {
            *counts.entry(*color).or_default() += 1;
        }
        let mut palette: Vec<[u8; 3]> = counts.keys().copied().collect();
        palette.sort_by_key(|color| Reverse(counts[color]));
        palette.truncate(256);
        let squared = |a: u8, b: u8| u32::from(a.abs_diff(b)).pow(2);
        let nearest = |color: &[u8; 3]| {
            let distance = |other: &[u8; 3]| -> u32 {
                color.iter().zip(other).map(|(a, b)| squared(*a, *b)).sum()
            };
            (0..=u8::MAX)
                .zip(&palette)
                .min_by_key(|(_, other)| distance(other))
                .map_or(0, |(i, _)| i)
        };
        let indices: BTreeMap<&[u8; 3], u8> =
            counts.keys().map(|color| (color, nearest(color))).collect();
        let pixels = colors.iter().map(|color| indices[color]).collect();
        (palette, pixels)
    }
}
