//! Animated GIFs and folders of frames.

use bevy::asset::RenderAssetUsages;
use bevy::prelude::*;
use bevy_offscreen::{CapturedImage, Film, Frames};
use wgpu_types::{Extent3d, TextureDimension, TextureFormat};

/// A grey picture with one white square.
fn picture(width: u32, height: u32, square: u32) -> CapturedImage {
    let mut data = [90, 90, 90, 255].repeat((width * height) as usize);
    for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let at = 4 * ((square + y) * width + square + x) as usize;
        data[at..at + 4].fill(255);
    }
    let size = Extent3d { width, height, depth_or_array_layers: 1 };
    let format = TextureFormat::Rgba8UnormSrgb;
    let usage = RenderAssetUsages::MAIN_WORLD;
    CapturedImage::of(&Image::new(size, TextureDimension::D2, data, format, usage)).unwrap()
}

/// Plays a film: returns each picture and how long it is shown, in hundredths of a second.
fn play(path: &std::path::Path) -> Vec<(Vec<u8>, u16)> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut film = options.read_info(std::fs::File::open(path).unwrap()).unwrap();
    let (width, height) = (film.width() as usize, film.height() as usize);
    let mut canvas = vec![0; 3 * width * height];
    let mut seen = Vec::new();
    while let Some(frame) = film.read_next_frame().unwrap() {
        for (i, pixel) in frame.buffer.as_chunks::<4>().0.iter().enumerate() {
            let x = frame.left as usize + i % frame.width as usize;
            let y = frame.top as usize + i / frame.width as usize;
            let at = 3 * (y * width + x);
            canvas[at..at + 3].copy_from_slice(&pixel[..3]);
        }
        seen.push((canvas.clone(), frame.delay));
    }
    seen
}

#[test]
fn a_film_plays_what_was_pushed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.gif");
    let mut film = Film::create(&path, 20.0).unwrap();
    let pictures: Vec<CapturedImage> = [3, 4, 4, 4, 9].map(|at| picture(20, 15, at)).into();
    for picture in &pictures {
        film.push(picture).unwrap();
    }
    assert!(!path.exists(), "it appears when it is finished");
    film.finish().unwrap();
    let seen = play(&path);
    let shown: Vec<(&[u8], u16)> = seen.iter().map(|(rgb, d)| (rgb.as_slice(), *d)).collect();
    let expected = [(0, 5), (1, 5), (1, 10), (4, 5)].map(|(i, delay)| (pictures[i].rgb(), delay));
    assert_eq!(shown, expected);
}

#[test]
fn what_does_not_move_for_long_is_seen_as_long() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.gif");
    let mut film = Film::create(&path, 1.0).unwrap();
    // A frame of a GIF is shown for 655 s at most.
    for _ in 0..1500 {
        film.push(&picture(5, 5, 1)).unwrap();
    }
    film.finish().unwrap();
    let hundredths: Vec<u32> = play(&path).iter().map(|(_, delay)| u32::from(*delay)).collect();
    assert_eq!(hundredths.iter().sum::<u32>(), 150_000, "{hundredths:?}");
}

#[test]
fn frames_of_a_film_have_one_size() {
    let folder = tempfile::tempdir().unwrap();
    let mut film = Film::create(folder.path().join("film.gif"), 10.0).unwrap();
    film.push(&picture(20, 15, 3)).unwrap();
    let error = film.push(&picture(15, 20, 3)).unwrap_err().to_string();
    assert_eq!(error, "the frame must have [20, 15] pixels like the film, got [15, 20]");
    drop(film);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left behind");
}

#[test]
fn frames_are_numbered() {
    let folder = tempfile::tempdir().unwrap();
    let mut frames = Frames::create(folder.path().join("a/b")).unwrap();
    let first = frames.push(&picture(20, 15, 3)).unwrap();
    frames.push(&picture(20, 15, 4)).unwrap();
    assert_eq!(first.file_name().unwrap(), "frame_000001.png");
    assert_eq!(std::fs::read_dir(frames.folder()).unwrap().count(), 2);
    assert_eq!(frames.count(), 2);
}

#[test]
fn rates_that_gif_cannot_tell_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for rate in [f64::NAN, f64::INFINITY, -1.0, 0.0, 0.5, 50.1] {
        let error = Film::create(folder.path().join("film.gif"), rate).err().unwrap().to_string();
        assert!(error.contains("frames_per_second") && error.contains("from 1 to 50"), "{error}");
    }
    for rate in [1.0, 50.0] {
        Film::create(folder.path().join("film.gif"), rate).unwrap();
    }
}

#[test]
fn a_picture_without_pixels_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.gif");
    let mut film = Film::create(&path, 20.0).unwrap();
    for (width, height) in [(0, 0), (0, 5), (5, 0)] {
        let size = Extent3d { width, height, depth_or_array_layers: 1 };
        let (format, usage) = (TextureFormat::Rgba8UnormSrgb, RenderAssetUsages::MAIN_WORLD);
        let image = Image::new(size, TextureDimension::D2, Vec::new(), format, usage);
        let said = film.push(&CapturedImage::of(&image).unwrap()).unwrap_err().to_string();
        assert!(said.contains(&format!("1 to 65535 pixels, got {width} x {height}")), "{said}");
    }
    film.push(&picture(20, 15, 3)).unwrap();
    film.finish().unwrap();
    assert_eq!(play(&path).len(), 1);
}
