//! What a driver draws, and the pictures that an app asks for.

use std::path::PathBuf;

use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy_offscreen::{CaptureError, MAX_SIDE, PictureFailed, PictureTaken, Studio, TakePicture};

const SIZE: UVec2 = UVec2::new(320, 240);

fn studio() -> Studio {
    let mut studio = Studio::new().unwrap();
    studio.app().insert_resource(ClearColor(Color::WHITE));
    studio
}

#[test]
fn a_sprite_is_drawn_where_it_is() {
    let mut studio = studio();
    let red = Sprite::from_color(Color::srgb(1.0, 0.0, 0.0), Vec2::splat(4.0));
    studio.app().world_mut().spawn((red, Transform::from_xyz(3.0, 2.0, 0.0)));
    // 10 m of 320 x 240 pixels, with a margin of 3 % on each side: about 22.6 pixels per metre.
    let camera = studio.camera(Rect::new(-5.0, -5.0, 5.0, 5.0), SIZE).unwrap();
    let picture = studio.picture(camera).unwrap();
    assert_eq!(picture.size(), SIZE);
    let pixel =
        |x: f32, y: f32| picture.pixel((160.0 + 22.6 * x) as u32, (120.0 - 22.6 * y) as u32);
    for (x, y) in [(3.0, 2.0), (1.2, 0.2), (4.8, 3.8), (1.2, 3.8)] {
        let [r, g, b] = pixel(x, y).unwrap();
        assert!(r >= 253 && g <= 2 && b <= 2, "{x} {y}: {r} {g} {b}");
    }
    for (x, y) in [(0.8, 2.0), (3.0, -0.2), (-3.0, 2.0), (3.0, 4.2)] {
        assert_eq!(pixel(x, y), Some([255; 3]), "{x} {y}");
    }
}

#[derive(Resource, Default)]
struct Answers(Vec<Result<PathBuf, String>>);

#[test]
fn an_app_asks_for_pictures_of_its_cameras() {
    let folder = tempfile::tempdir().unwrap();
    let mut studio = studio();
    studio
        .app()
        .init_resource::<Answers>()
        .add_observer(|taken: On<PictureTaken>, mut answers: ResMut<Answers>| {
            answers.0.push(Ok(taken.path.clone()));
        })
        .add_observer(|failed: On<PictureFailed>, mut answers: ResMut<Answers>| {
            answers.0.push(Err(failed.error.to_string()));
        });
    let camera = studio.camera(Rect::new(0.0, 0.0, 10.0, 10.0), SIZE).unwrap();
    studio.step().unwrap();
    let path = folder.path().join("camera.png");
    let world = studio.app().world_mut();
    world.trigger(TakePicture { entity: camera, path: path.clone() });
    // In the same frame, into another file.
    let second = folder.path().join("second.png");
    world.trigger(TakePicture { entity: camera, path: second.clone() });
    let nobody = world.spawn_empty().id();
    world.trigger(TakePicture { entity: nobody, path: folder.path().join("nobody.png") });
    for _ in 0..10 {
        studio.step().unwrap();
    }
    let answers = std::mem::take(&mut studio.app().world_mut().resource_mut::<Answers>().0);
    assert_eq!(answers.len(), 3, "{answers:?}");
    assert!(answers[0].as_ref().unwrap_err().contains("is not a camera"), "{answers:?}");
    assert_eq!(answers[1..], [Ok(path.clone()), Ok(second.clone())]);
    assert_eq!(std::fs::read(path).unwrap(), std::fs::read(second).unwrap());

    // Requests for a camera whose image no longer exists, and for one that draws nowhere, are answered as
    // well.
    let world = studio.app().world_mut();
    let gone = world.resource::<Assets<Image>>().reserve_handle();
    world.entity_mut(camera).insert(RenderTarget::Image(gone.into()));
    world.trigger(TakePicture { entity: camera, path: folder.path().join("gone.png") });
    let blind = world.spawn((Camera2d, RenderTarget::None { size: SIZE })).id();
    world.trigger(TakePicture { entity: blind, path: folder.path().join("blind.png") });
    for _ in 0..110 {
        studio.step().unwrap();
    }
    let answers = &studio.app().world().resource::<Answers>().0;
    let errors: Vec<&str> =
        answers.iter().map(|answer| answer.as_ref().unwrap_err().as_str()).collect();
    assert_eq!(errors.len(), 2, "{errors:?}");
    assert!(errors[0].contains("is not a camera") && errors[1].contains("frames"), "{errors:?}");
}

#[test]
fn a_camera_that_is_not_active_draws_for_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let mut studio = studio();
    let camera = studio.camera(Rect::new(0.0, 0.0, 10.0, 10.0), SIZE).unwrap();
    studio.app().world_mut().get_mut::<Camera>(camera).unwrap().is_active = false;
    studio.step().unwrap();
    let path = folder.path().join("camera.png");
    studio.app().world_mut().trigger(TakePicture { entity: camera, path: path.clone() });
    for _ in 0..10 {
        studio.step().unwrap();
    }
    assert!(!studio.app().world().get::<Camera>(camera).unwrap().is_active);
    let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    assert!(pixels.iter().all(|value| *value == 255));
}

#[test]
fn what_cannot_be_drawn_is_reported() {
    let mut studio = studio();
    let area = Rect::new(0.0, 0.0, 10.0, 10.0);
    for size in [UVec2::ZERO, UVec2::new(MAX_SIDE + 1, 10)] {
        let error = studio.camera(area, size).unwrap_err();
        assert!(matches!(error, CaptureError::Size { .. }), "{error}");
    }
    let error = studio.camera(Rect { max: Vec2::NAN, ..area }, SIZE).unwrap_err();
    assert!(matches!(error, CaptureError::Area { .. }), "{error}");
    let nobody = studio.app().world_mut().spawn_empty().id();
    assert!(matches!(studio.picture(nobody), Err(CaptureError::NoCamera { .. })));
}
