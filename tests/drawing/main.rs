//! Tests worlds as a driver draws them, without a window. Needs a graphics card or Mesa's software Vulkan:
//! `cargo test --features render --test drawing`.

mod height;

use bevy::prelude::*;
use bevy_envgen::envgen::WorldKind;
use bevy_envgen::prelude::*;
use bevy_envgen::visuals::WorldPalette;
use bevy_offscreen::Studio;

const SIZE: UVec2 = UVec2::new(320, 240);

fn studio() -> Studio {
    let mut studio = Studio::new().unwrap();
    studio.app().add_plugins(EnvgenPlugins::default()).insert_resource(ClearColor(Color::WHITE));
    studio
}

/// Spawns a world of a kind, and a camera that shows all of it.
fn spawn(studio: &mut Studio, kind: &str, seed: u64) -> (Entity, Entity) {
    let spec = kind.parse::<WorldKind>().unwrap().default_spec();
    let environment = Environment::new(spec, seed).with_pace(GenerationMode::Blocking);
    let world = studio.app().world_mut().spawn(environment.clone()).id();
    studio.step().unwrap();
    let root = studio.app().world().entity(world);
    assert_eq!(root.get(), Some(&EnvironmentState::Ready));
    let bounds = root.get::<GroundTruth>().unwrap().bounds;
    let area = environment.area_in_app(root.get::<GlobalTransform>().unwrap(), bounds);
    (world, studio.camera(area, SIZE).unwrap())
}

/// Returns whether a pixel has a colour, up to the rounding of drivers.
fn is(pixel: Option<[u8; 3]>, color: Color) -> bool {
    let wanted = color.to_srgba().to_u8_array_no_alpha();
    pixel.is_some_and(|pixel| pixel.iter().zip(wanted).all(|(a, b)| a.abs_diff(b) <= 2))
}

#[test]
fn trees_are_drawn_where_they_stand() {
    let mut studio = studio();
    let (forest, camera) = spawn(&mut studio, "forest", 3);
    let picture = studio.picture(camera).unwrap();
    assert_eq!(picture.size(), SIZE);
    let world = studio.app().world_mut();
    let truth = world.get::<GroundTruth>(forest).unwrap().clone();
    let green = WorldPalette::default().tree;
    // `Studio::camera` frames an area with a margin of 3 % on each side, so that the whole area is visible.
    let area = (truth.bounds.max - truth.bounds.min).as_vec2() * 1.06;
    let scale = (SIZE.as_vec2() / area).min_element();
    let middle = ((truth.bounds.min + truth.bounds.max) / 2.0).as_vec2();
    let pixel = |p: Vec2| {
        let at = (p - middle) * Vec2::new(scale, -scale) + SIZE.as_vec2() / 2.0;
        picture.pixel(at.x as u32, at.y as u32)
    };
    // Only trees that cover the pixel at their centre completely.
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
    for kind in ["hallway", "forest", "road", "indoor", "landscape", "cellular"] {
        let mut studio = studio();
        let (_, camera) = spawn(&mut studio, kind, 1);
        let picture = studio.picture(camera).unwrap();
        let drawn = picture.rgb().as_chunks::<3>().0.iter().filter(|p| **p != [255; 3]).count();
        assert!(drawn > 100, "{kind}: {drawn} pixels");
        studio.app().world_mut().get_mut::<Camera>(camera).unwrap().is_active = false;
        assert_eq!(picture, studio.picture(camera).unwrap(), "{kind}: no time passes");
        assert!(!studio.app().world().get::<Camera>(camera).unwrap().is_active);
    }
}
