//! Worlds as a driver draws them, and the pictures that an app asks for.

use std::path::PathBuf;

use bevy::prelude::*;
use bevy_envgen::capture::{
    CaptureError, MAX_SIDE, PictureFailed, PictureTaken, Studio, TakePicture,
};
use bevy_envgen::envgen::{WorldKind, WorldSpec};
use bevy_envgen::prelude::*;
use bevy_envgen::visuals::Palette;

const SIZE: UVec2 = UVec2::new(320, 240);

fn studio() -> Studio {
    let mut studio = Studio::new().unwrap();
    studio.app().add_plugins(EnvgenPlugins::default()).insert_resource(ClearColor(Color::WHITE));
    studio
}

fn spec(kind: &str) -> WorldSpec {
    kind.parse::<WorldKind>().unwrap().default_spec()
}

/// Whether a pixel has a colour, within what drivers round.
fn is(pixel: Option<[u8; 3]>, color: Color) -> bool {
    let wanted = color.to_srgba().to_u8_array_no_alpha();
    pixel.is_some_and(|pixel| pixel.iter().zip(wanted).all(|(a, b)| a.abs_diff(b) <= 2))
}

#[test]
fn trees_are_drawn_where_they_stand() {
    let mut studio = studio();
    let forest = studio.app().world_mut().spawn(Environment::new(spec("forest"), 3)).id();
    studio.wait_until_ready(forest).unwrap();
    let camera = studio.camera_over(forest, SIZE).unwrap();
    let picture = studio.picture(camera).unwrap();
    assert_eq!(picture.size(), SIZE);
    let world = studio.app().world_mut();
    let truth = world.get::<GroundTruth>(forest).unwrap().clone();
    let green = Palette::default().tree;
    // As `Studio::camera` frames an area: a margin of 3 % on each side, the whole area visible.
    let area = (truth.bounds.max - truth.bounds.min).as_vec2() * 1.06;
    let scale = (SIZE.as_vec2() / area).min_element();
    let middle = ((truth.bounds.min + truth.bounds.max) / 2.0).as_vec2();
    let pixel = |p: Vec2| {
        let at = (p - middle) * Vec2::new(scale, -scale) + SIZE.as_vec2() / 2.0;
        picture.pixel(at.x as u32, at.y as u32)
    };
    // Those whose middles cover a pixel whole.
    let (mut seen, mut large) = (0, 0);
    for tree in truth.trees.iter().filter(|tree| tree.radius as f32 * scale > 2.0) {
        large += 1;
        seen += u32::from(is(pixel(tree.center.as_vec2()), green));
    }
    assert!(large > 20, "{large} trees");
    assert_eq!(seen, large);
    assert!(is(picture.pixel(1, 1), Color::WHITE));
}

#[test]
fn every_kind_leaves_a_mark() {
    for kind in ["hallway", "forest", "road", "indoor", "landscape"] {
        let mut studio = studio();
        let world = studio.app().world_mut().spawn(Environment::new(spec(kind), 1)).id();
        studio.wait_until_ready(world).unwrap();
        let camera = studio.camera_over(world, SIZE).unwrap();
        let picture = studio.picture(camera).unwrap();
        let drawn = picture.rgb().as_chunks::<3>().0.iter().filter(|p| **p != [255; 3]).count();
        assert!(drawn > 100, "{kind}: {drawn} pixels");
        studio.app().world_mut().get_mut::<Camera>(camera).unwrap().is_active = false;
        assert_eq!(picture, studio.picture(camera).unwrap(), "{kind}: no time passes");
        assert!(!studio.app().world().get::<Camera>(camera).unwrap().is_active);
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
    let nobody = world.spawn_empty().id();
    world.trigger(TakePicture { entity: nobody, path: folder.path().join("nobody.png") });
    for _ in 0..10 {
        studio.step().unwrap();
    }
    let answers = &studio.app().world().resource::<Answers>().0;
    assert_eq!(answers.len(), 2, "{answers:?}");
    assert!(answers[0].as_ref().unwrap_err().contains("is not a camera"), "{answers:?}");
    assert_eq!(answers[1], Ok(path.clone()));
    assert!(path.exists());
}

#[test]
fn what_cannot_be_drawn_is_told() {
    let mut studio = studio();
    let area = Rect::new(0.0, 0.0, 10.0, 10.0);
    for size in [UVec2::ZERO, UVec2::new(MAX_SIDE + 1, 10)] {
        let error = studio.camera(area, size).unwrap_err();
        assert!(matches!(error, CaptureError::Size { .. }), "{error}");
    }
    let nobody = studio.app().world_mut().spawn_empty().id();
    assert!(matches!(studio.picture(nobody), Err(CaptureError::NoCamera { .. })));
    assert!(matches!(studio.camera_over(nobody, SIZE), Err(CaptureError::NoWorld { .. })));
    assert!(matches!(studio.wait_until_ready(nobody), Err(CaptureError::NoWorld { .. })));
    let mut impossible = spec("forest");
    impossible.set("intensity", "1e6").unwrap();
    let failing = studio.app().world_mut().spawn(Environment::new(impossible, 1)).id();
    let error = studio.wait_until_ready(failing).unwrap_err().to_string();
    assert!(error.contains("intensity") || error.contains("trees"), "{error}");
}
