//! Pictures in memory and as PNG.

use bevy::asset::RenderAssetUsages;
use bevy::prelude::*;
use bevy_offscreen::CapturedImage;
use wgpu_types::{Extent3d, TextureDimension, TextureFormat};

fn image(format: TextureFormat, data: Vec<u8>) -> Image {
    let size = Extent3d { width: 2, height: 1, depth_or_array_layers: 1 };
    Image::new(size, TextureDimension::D2, data, format, RenderAssetUsages::MAIN_WORLD)
}

#[test]
fn alpha_is_left_out_and_order_of_colours_kept() {
    let pixels = vec![10, 20, 30, 0, 40, 50, 60, 255];
    let picture = CapturedImage::of(&image(TextureFormat::Rgba8UnormSrgb, pixels.clone())).unwrap();
    assert_eq!(picture.rgb(), [10, 20, 30, 40, 50, 60]);
    assert_eq!(picture.pixel(1, 0), Some([40, 50, 60]));
    assert_eq!(picture.pixel(2, 0), None);
    let swapped = CapturedImage::of(&image(TextureFormat::Bgra8UnormSrgb, pixels)).unwrap();
    assert_eq!(swapped.pixel(0, 0), Some([30, 20, 10]));
}

#[test]
fn a_depth_is_no_picture() {
    let depth = image(TextureFormat::R32Float, vec![0; 8]);
    assert!(CapturedImage::of(&depth).unwrap_err().to_string().contains("R32Float"));
}

#[test]
fn a_png_holds_the_pixels() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let pixels = vec![10, 20, 30, 0, 40, 50, 60, 255];
    let picture = CapturedImage::of(&image(TextureFormat::Rgba8UnormSrgb, pixels)).unwrap();
    picture.write_png(&path).unwrap();
    let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut back = vec![0; 6];
    reader.next_frame(&mut back).unwrap();
    assert_eq!(back, picture.rgb());
    let nowhere = picture.write_png(folder.path().join("no/where.png")).unwrap_err();
    assert!(nowhere.to_string().contains("where.png"), "{nowhere}");
}

#[test]
#[cfg(unix)]
fn a_picture_goes_where_a_link_leads_and_nothing_that_is_read_only_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let picture = CapturedImage::of(&image(
        TextureFormat::Rgba8UnormSrgb,
        vec![10, 20, 30, 0, 40, 50, 60, 255],
    ))
    .unwrap();
    let (file, link) = (folder.path().join("a.png"), folder.path().join("link.png"));
    std::fs::write(&file, "old").unwrap();
    std::os::unix::fs::symlink(&file, &link).unwrap();
    picture.write_png(&link).unwrap();
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    let written = std::fs::read(&file).unwrap();
    assert_ne!(written, b"old");
    let mut mode = std::fs::metadata(&file).unwrap().permissions();
    mode.set_readonly(true);
    std::fs::set_permissions(&file, mode).unwrap();
    let error = picture.write_png(&file).unwrap_err().to_string();
    assert!(error.contains("a.png") && error.contains("read-only"), "{error}");
    assert!(picture.write_png(folder.path()).is_err());
    assert_eq!(std::fs::read(&file).unwrap(), written);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "nothing is left behind");
}
