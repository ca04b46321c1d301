//! The growing map as textures. Only textures that have changed are written.

use std::collections::BTreeMap;

use bevy::asset::RenderAssetUsages;
use bevy::image::{ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use mapping_trial::map::{DECIDED, OccupancyMap, RESOLUTION, TILE};

/// The number of map tiles along a side of a sheet. A sheet is uploaded to the graphics card as a whole, and
/// drawn with one call. Larger sheets cost more when little changes, and smaller sheets when much is visible.
const TILES_PER_SHEET: i32 = 4;

/// The number of cells, and of pixels, along a side of a sheet.
pub(super) const SHEET_CELLS: i32 = TILES_PER_SHEET * TILE;

/// The side of a sheet in metres.
pub(super) const SHEET_SIDE: f64 = SHEET_CELLS as f64 * RESOLUTION;

/// The number of bytes of a pixel.
const PIXEL: usize = 4;

/// The colours of pixels: red, green and blue in sRGB, and opacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Paint {
    pub(super) free: [u8; PIXEL],
    pub(super) occupied: [u8; PIXEL],
}

impl Paint {
    /// The colour of unknown cells, which is transparent.
    pub(super) const UNKNOWN: [u8; PIXEL] = [0x80, 0x80, 0x80, 0];

    pub(super) fn new(free: Color, occupied: Color) -> Self {
        Paint { free: free.to_srgba().to_u8_array(), occupied: occupied.to_srgba().to_u8_array() }
    }

    fn of(&self, odds: i16) -> [u8; PIXEL] {
        if odds > DECIDED {
            self.occupied
        } else if odds < -DECIDED {
            self.free
        } else {
            Paint::UNKNOWN
        }
    }
}

/// A square of the map with a texture of its own.
#[derive(Debug)]
pub(super) struct Sheet {
    pub(super) image: Handle<Image>,
    pub(super) entity: Entity,
}

/// The sheets of a map that have been drawn so far.
#[derive(Debug, Default)]
pub(super) struct Sheets {
    /// The sheets by column and row.
    sheets: BTreeMap<(i32, i32), Sheet>,
    /// The revision of the map that the sheets show, and the colours.
    drawn: Option<(u64, Paint)>,
    /// The changed tiles with their sheets. The vector is kept to reuse its memory.
    changed: Vec<((i32, i32), (i32, i32))>,
}

impl Sheets {
    pub(super) fn iter(&self) -> impl Iterator<Item = &Sheet> {
        self.sheets.values()
    }

    /// Writes the tiles that have changed since the last call into their textures, or all tiles if the
    /// colours have changed. `spawn` creates the entity of a new sheet at a column and row.
    pub(super) fn renew(
        &mut self,
        map: &OccupancyMap,
        paint: Paint,
        images: &mut Assets<Image>,
        mut spawn: impl FnMut((i32, i32), Handle<Image>) -> Entity,
    ) {
        let since = match self.drawn {
            Some(drawn) if drawn == (map.revision(), paint) => return,
            Some((revision, used)) if used == paint => revision,
            _ => 0,
        };
        self.drawn = Some((map.revision(), paint));
        let sheet = |tile: (i32, i32)| {
            (tile.0.div_euclid(TILES_PER_SHEET), tile.1.div_euclid(TILES_PER_SHEET))
        };
        self.changed.clear();
        self.changed.extend(map.changed_since(since).map(|tile| (sheet(tile), tile)));
        self.changed.sort_unstable();
        for tiles in self.changed.chunk_by(|a, b| a.0 == b.0) {
            let at = tiles[0].0;
            let sheet = self.sheets.entry(at).or_insert_with(|| {
                let image = images.add(blank());
                Sheet { entity: spawn(at, image.clone()), image }
            });
            let Some(mut image) = images.get_mut(&sheet.image) else { continue };
            let Some(pixels) = image.data.as_mut() else { continue };
            for &(_, (col, row)) in tiles {
                if let Some(cells) = map.tile(col, row) {
                    let corner = (
                        col.rem_euclid(TILES_PER_SHEET) * TILE,
                        row.rem_euclid(TILES_PER_SHEET) * TILE,
                    );
                    write(pixels, corner, cells, paint);
                }
            }
        }
    }
}

/// Returns the centre of a sheet in metres.
pub(super) fn centre((col, row): (i32, i32)) -> envgen::glam::DVec2 {
    (envgen::glam::DVec2::new(f64::from(col), f64::from(row)) + 0.5) * SHEET_SIDE
}

/// Creates a texture of unknown cells. With its sampling, cells are squares in a close view, and walls of one
/// cell remain visible in a distant view.
fn blank() -> Image {
    let side = SHEET_CELLS as u32;
    let size = Extent3d { width: side, height: side, depth_or_array_layers: 1 };
    let format = TextureFormat::Rgba8UnormSrgb;
    let usage = RenderAssetUsages::default();
    let mut image = Image::new_fill(size, TextureDimension::D2, &Paint::UNKNOWN, format, usage);
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        mag_filter: ImageFilterMode::Nearest,
        min_filter: ImageFilterMode::Linear,
        ..default()
    });
    image
}

/// Writes a tile whose lower left cell is at `corner` of its sheet. The first row of pixels is the top row,
/// but the first row of cells is the bottom row.
fn write(pixels: &mut [u8], corner: (i32, i32), cells: &[i16], paint: Paint) {
    let width = SHEET_CELLS as usize;
    for (row, cells) in cells.chunks_exact(TILE as usize).enumerate() {
        let y = width - 1 - (corner.1 as usize + row);
        let start = (y * width + corner.0 as usize) * PIXEL;
        let line = &mut pixels[start..start + cells.len() * PIXEL];
        for (pixel, &odds) in line.chunks_exact_mut(PIXEL).zip(cells) {
            pixel.copy_from_slice(&paint.of(odds));
        }
    }
}
