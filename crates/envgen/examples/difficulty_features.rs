//! Draws what features of difficulty look like: for each, of many maps of one size, the map with its least
//! value and the one with its greatest.
//!
//! `cargo run --release --example difficulty_features -- docs/pictures/difficulty_features.png`
//!
//! Names of features after the file replace the list of this program.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::io::Cursor;
use std::path::PathBuf;

use envgen::difficulty::{DifficultyVector, Feature, Platform};
use envgen::indoor::IndoorSpec;
use envgen::picture::{self, PictureOptions};
use envgen::{Blueprint, Seed, Spec, World};
use png::{BitDepth, ColorType, Compression, Decoder, Encoder, Filter};

type Result<T = ()> = std::result::Result<T, Box<dyn Error>>;

/// Number of maps, and their side in cells: of one size, since nearly every feature grows with the size.
const MAPS: u64 = 200;
const SIDE: u32 = 8;

/// What is drawn if the arguments name no features.
const FEATURES: [&str; 16] = [
    "scan_degeneracy",
    "scan_position_error_80_m",
    "visible_area_mean_m2",
    "lost_beam_share",
    "tour_length_95_m",
    "tour_dead_ends",
    "tour_odometry_noise_mean",
    "tour_wheel_bias_mean",
    "drift_position_m",
    "drift_worst_gap_m",
    "clearance_50_m",
    "tour_length_over_clearance",
    "wall_length_m",
    "short_walls_per_m2",
    "places",
    "loops",
];

/// Pictures in a row, and their width in px with the gap to the next.
const COLUMNS: usize = 4;
const WIDTH: u32 = 300;
const GAP: usize = 8;

/// Pixels per px: pictures that are drawn larger and scaled down keep their titles on one line.
const PIXEL_RATIO: f64 = 0.8;

/// A map with the values of its features, in the order of [`DifficultyVector::features`].
struct Sample {
    world: World,
    values: Vec<Option<f64>>,
}

/// Pixels row by row, three bytes each.
struct Image {
    width: usize,
    rgb: Vec<u8>,
}

fn main() -> Result {
    let mut arguments = std::env::args().skip(1);
    let file: PathBuf =
        arguments.next().ok_or("usage: difficulty_features FILE [FEATURE..]")?.into();
    let named: Vec<String> = arguments.collect();
    let features = if named.is_empty() {
        features(FEATURES)?
    } else {
        features(named.iter().map(String::as_str))?
    };
    let samples = (0..MAPS).map(|i| sample(Seed(i))).collect::<Result<Vec<Sample>>>()?;
    let mut tiles = Vec::new();
    for (index, feature) in features {
        let (least, greatest) = ends(&samples, index)
            .ok_or_else(|| format!("no map has the feature {}", feature.name))?;
        tiles.push(tile(least, index, &feature)?);
        tiles.push(tile(greatest, index, &feature)?);
    }
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    Ok(fs::write(file, page(&tiles).to_png()?)?)
}

/// Features by name, with their places in the vector.
fn features<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Vec<(usize, Feature)>> {
    let all = DifficultyVector::features();
    let find = |name: &str| {
        let index = all.iter().position(|feature| feature.name == name);
        let index = index.ok_or_else(|| format!("no feature has the name `{name}`"))?;
        Ok((index, all[index]))
    };
    names.into_iter().map(find).collect()
}

/// A map of which all that makes maps easy or hard is drawn.
fn sample(seed: Seed) -> Result<Sample> {
    let base = IndoorSpec { width: SIDE, height: SIDE, ..Default::default() };
    let world = base.draw_levers(seed).generate(seed)?.to_world();
    let values = DifficultyVector::of(&world, &Platform::default())?.values();
    Ok(Sample { world, values })
}

/// The maps with the least and with the greatest value; `None` if no map has one.
fn ends(samples: &[Sample], index: usize) -> Option<(&Sample, &Sample)> {
    let with_value = || samples.iter().filter(|sample| sample.values[index].is_some());
    let by_value = |a: &&Sample, b: &&Sample| {
        let [a, b] = [a, b].map(|sample| sample.values[index].unwrap_or_default());
        a.total_cmp(&b)
    };
    with_value().min_by(by_value).zip(with_value().max_by(by_value))
}

/// The picture of a map, with the value of a feature as title.
fn tile(sample: &Sample, index: usize, feature: &Feature) -> Result<Image> {
    let value = sample.values[index].unwrap_or_default();
    let decimals = if value.fract() == 0.0 || value.abs() >= 100.0 { 0 } else { 3 };
    let options = PictureOptions {
        width: WIDTH,
        height: WIDTH,
        pixel_ratio: PIXEL_RATIO,
        margin: 4,
        title: Some(format!("{} {value:.decimals$}", feature.name)),
        legend: false,
        names: false,
        ..Default::default()
    };
    Image::from_png(&picture::png(&sample.world, &options)?)
}

/// The pictures in rows.
fn page(tiles: &[Image]) -> Image {
    let columns = COLUMNS.min(tiles.len());
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
