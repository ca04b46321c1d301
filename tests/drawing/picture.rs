//! Pictures in memory and as PNG.

use bevy::asset::RenderAssetUsages;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};

use bevy::prelude::*;
use bevy_envgen::capture::Picture;

fn image(format: TextureFormat, data: Vec<u8>) -> Image {
    let size = Extent3d { width: 2, height: 1, depth_or_array_layers: 1 };
    Image::new(size, TextureDimension::D2, data, format, RenderAssetUsages::MAIN_WORLD)
}

#[test]
fn alpha_is_left_out_and_order_of_colours_kept() {
    let pixels = vec![10, 20, 30, 0, 40, 50, 60, 255];
    let picture = Picture::of(&image(TextureFormat::Rgba8UnormSrgb, pixels.clone())).unwrap();
    assert_eq!(picture.rgb(), [10, 20, 30, 40, 50, 60]);
    assert_eq!(picture.pixel(1, 0), Some([40, 50, 60]));
    assert_eq!(picture.pixel(2, 0), None);
    let swapped = Picture::of(&image(TextureFormat::Bgra8UnormSrgb, pixels)).unwrap();
    assert_eq!(swapped.pixel(0, 0), Some([30, 20, 10]));
}

#[test]
fn a_depth_is_no_picture() {
    let depth = image(TextureFormat::R32Float, vec![0; 8]);
    assert!(Picture::of(&depth).unwrap_err().to_string().contains("R32Float"));
}

#[test]
fn a_png_holds_the_pixels() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let pixels = vec![10, 20, 30, 0, 40, 50, 60, 255];
    let picture = Picture::of(&image(TextureFormat::Rgba8UnormSrgb, pixels)).unwrap();
    picture.write_png(&path).unwrap();
    let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut back = vec![0; 6];
    reader.next_frame(&mut back).unwrap();
    assert_eq!(back, picture.rgb());
    let nowhere = picture.write_png(folder.path().join("no/where.png")).unwrap_err();
    assert!(nowhere.to_string().contains("where.png"), "{nowhere}");
}
