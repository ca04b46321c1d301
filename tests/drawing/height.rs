//! Worlds in three dimensions.

use bevy::camera::ScalingMode;
use bevy::core_pipeline::prepass::DepthPrepass;
use bevy::prelude::*;
use bevy_envgen::envgen::geometry::{Rect, Shape};
use bevy_envgen::envgen::glam::DVec2;
use bevy_envgen::envgen::scenario::smoke::{SmokeRegion, SmokeSource};
use bevy_envgen::envgen::scenario::{Scenario, ScenarioSpec, SmokeKind};
use bevy_envgen::envgen::world::{Obstacle, ObstacleKind, Room, Wall, WallKind};
use bevy_envgen::envgen::{Provenance, Seed, World};
use bevy_envgen::prelude::*;
use bevy_offscreen::{CaptureError, Studio, TakePicture};

use super::SIZE;

/// The height of the camera in metres.
const EYES: f32 = 1.3;

/// Creates a world with two rooms of 6 x 6 m side by side, of which the right one has no light, with a pipe
/// in each.
fn rooms() -> World {
    let v = DVec2::new;
    let bounds = Rect::new(DVec2::ZERO, v(12.0, 6.0));
    let mut world = World::new(Provenance::other("rooms", serde_json::Value::Null), bounds);
    for (from, to) in [
        (v(0.0, 0.0), v(12.0, 0.2)),
        (v(0.0, 5.8), v(12.0, 6.0)),
        (v(0.0, 0.2), v(0.2, 5.8)),
        (v(11.8, 0.2), v(12.0, 5.8)),
        (v(5.9, 0.2), v(6.1, 5.8)),
    ] {
        let shape = Shape::from_rect(Rect::new(from, to));
        world.walls.push(Wall::new(WallKind::Wall, shape));
    }
    for (left, right, lit) in [(0.2, 5.9, true), (6.1, 11.8, false)] {
        world.rooms.push(Room {
            name: "room".to_owned(),
            shape: Shape::from_rect(Rect::new(v(left, 0.2), v(right, 5.8))),
            difficulty: None,
            lit,
            contents: Default::default(),
            height: None,
        });
        let pipe = Shape::Disc { center: v(0.5 * (left + right), 3.0), radius: 0.4 };
        world.obstacles.push(Obstacle::new(ObstacleKind::Pipe, pipe));
    }
    world
}

/// Creates a studio with a world.
fn studio(world: World, scenario: Option<Scenario>) -> Studio {
    let mut studio = Studio::new().unwrap();
    let settings = Visuals3dSettings { ceilings: true, ..default() };
    studio.app().add_plugins((EnvgenPlugins::default(), EnvgenVisuals3dPlugin::new(settings)));
    let environment = Environment::prebuilt(world).with_pace(GenerationMode::Blocking);
    let root = studio.app().world_mut().spawn(environment).id();
    if let Some(scenario) = scenario {
        let request = EnvironmentScenario::prebuilt(scenario);
        studio.app().world_mut().entity_mut(root).insert(request);
    }
    studio.step().unwrap();
    studio
}

/// Returns the pixel in the centre of a picture that is taken from one point towards another.
fn seen(studio: &mut Studio, from: Vec3, to: Vec3) -> [u8; 3] {
    let pose = Transform::from_translation(from).looking_at(to, Vec3::Z);
    let camera = studio.camera_3d(pose, 1.0, SIZE).unwrap();
    let picture = studio.picture(camera).unwrap();
    assert_eq!(picture.size(), SIZE);
    studio.app().world_mut().despawn(camera);
    picture.pixel(SIZE.x / 2, SIZE.y / 2).unwrap()
}

fn lightness([red, green, blue]: [u8; 3]) -> u32 {
    (u32::from(red) + u32::from(green) + u32::from(blue)) / 3
}

#[test]
fn walls_are_light_where_there_is_light_and_the_sky_is_blue() {
    let mut studio = studio(rooms(), None);
    let x = |x: f32| Vec3::new(x, 1.5, EYES);
    let wall = seen(&mut studio, x(3.0), x(0.2));
    let [red, green, blue] = wall;
    // Plaster under warm lamps.
    assert!(red >= green && green >= blue && red - blue < 60, "{wall:?}");
    assert!(lightness(wall) > 130, "{wall:?}");
    // The back of a wall of the lit room, seen from the dark room.
    let dark = seen(&mut studio, x(9.0), x(6.1));
    assert!(lightness(dark) < 70 && lightness(dark) + 80 < lightness(wall), "{dark:?} {wall:?}");
    let lit = seen(&mut studio, x(3.0), x(5.9));
    assert!(lightness(lit) > 130, "{lit:?}");
    let sky = seen(&mut studio, Vec3::new(-20.0, 3.0, EYES), Vec3::new(-30.0, 3.0, 8.0));
    assert!(sky[2] > sky[0] + 20 && lightness(sky) > 120, "{sky:?}");
    // A ceiling, seen through the opening above the walls. From below, its panels are visible.
    let ceiling = seen(&mut studio, Vec3::new(1.0, 1.0, 1.0), Vec3::new(1.8, 1.8, 2.6));
    assert!(lightness(ceiling) > 100 && ceiling[2] <= ceiling[0], "{ceiling:?}");
}

#[test]
fn things_hide_what_is_behind_them() {
    let mut studio = studio(rooms(), None);
    // The pipe is 1.2 m high.
    let from = |z: f32| Vec3::new(1.0, 3.0, z);
    let pipe = seen(&mut studio, from(1.0), Vec3::new(3.05, 3.0, 1.0));
    let wall = seen(&mut studio, from(1.5), Vec3::new(5.9, 3.0, 1.5));
    assert!(lightness(pipe) + 20 < lightness(wall), "{pipe:?} {wall:?}");
}

fn smoke_in_the_left_room(extinction: f64) -> Scenario {
    let (region, kind) = (SmokeRegion::Room(0), SmokeKind::Regional);
    let smoke = vec![SmokeSource { region, extinction, growth: 0.0, kind }];
    let settings = ScenarioSpec::default();
    Scenario { seed: Seed(1), settings, doors: vec![], people: vec![], smoke }
}

#[test]
fn smoke_hides_more_the_thicker_it_is() {
    let seen_in = |extinction: f64| {
        let mut studio = studio(rooms(), Some(smoke_in_the_left_room(extinction)));
        for _ in 0..20 {
            studio.step().unwrap();
        }
        let world = studio.app().world_mut();
        let failures: Vec<_> = world.query::<&ScenarioFailure>().iter(world).cloned().collect();
        assert!(failures.is_empty(), "{failures:?}");
        let mut smoke = world.query::<&Smoke>();
        let thickness = smoke.iter(world).map(|smoke| smoke.extinction).fold(0.0, f64::max);
        assert!((thickness - extinction).abs() < 0.05 * extinction, "{thickness}");
        let eyes = |x: f32| Vec3::new(x, 1.5, EYES);
        let near = seen(&mut studio, eyes(1.2), eyes(0.2));
        let far = seen(&mut studio, eyes(5.2), eyes(0.2));
        (f64::from(lightness(near)), f64::from(lightness(far)))
    };
    let clear = seen_in(1e-3);
    let thick = seen_in(20.0);
    // Thick smoke hides everything else.
    assert!((thick.0 - thick.1).abs() < 4.0 && clear.0 - thick.0 > 20.0, "{clear:?} {thick:?}");
    let some = seen_in(0.3);
    // After 1 m of smoke a wall keeps 74 % of its contrast, and after 5 m 22 %. These are rough values
    // because of the sRGB curve.
    let kept = |of: f64, whole: f64| (of - thick.0) / (whole - thick.0);
    let (near, far) = (kept(some.0, clear.0), kept(some.1, clear.1));
    assert!((0.6..0.9).contains(&near) && (0.1..0.4).contains(&far), "{near} {far}");
}

#[test]
fn smoke_from_straight_above_does_not_depend_on_the_height_of_the_camera() {
    let mut studio = studio(rooms(), Some(smoke_in_the_left_room(0.3)));
    let mut settings = studio.app().world_mut().resource_mut::<Visuals3dSettings>();
    // Shadows end at a distance from the camera.
    (settings.ceilings, settings.shadows) = (false, false);
    for _ in 0..20 {
        studio.step().unwrap();
    }
    // The whole of the left room, with its pipe.
    let mut above = |height: f32| {
        let pose =
            Transform::from_xyz(3.0, 3.0, height).looking_at(Vec3::new(3.0, 3.0, 0.0), Vec3::Y);
        let camera = studio.camera_3d(pose, 1.0, SIZE).unwrap();
        let flat = OrthographicProjection {
            scaling_mode: ScalingMode::FixedVertical { viewport_height: 7.0 },
            ..OrthographicProjection::default_3d()
        };
        studio.app().world_mut().entity_mut(camera).insert(Projection::Orthographic(flat));
        let picture = studio.picture(camera).unwrap();
        studio.app().world_mut().despawn(camera);
        picture
    };
    let low = above(4.0);
    for height in [10.0, 60.0] {
        let high = above(height);
        let far = low.rgb().iter().zip(high.rgb()).filter(|(a, b)| a.abs_diff(**b) > 4).count();
        assert!(far < 300, "{far} values differ from {height} m above");
    }
    // Vertical rays pass 2.6 m of smoke everywhere.
    let pixel = |x: f32, y: f32| {
        let at = (Vec2::new(x, y) - 3.0) * Vec2::new(1.0, -1.0) * SIZE.y as f32 / 7.0;
        let at = at + SIZE.as_vec2() / 2.0;
        lightness(low.pixel(at.x as u32, at.y as u32).unwrap())
    };
    let (middle, corner) = (pixel(2.2, 3.0), pixel(0.8, 0.8));
    assert!(middle.abs_diff(corner) < 25, "{middle} {corner}");
}

#[test]
fn a_camera_sees_as_before_when_the_smoke_is_gone() {
    let mut studio = studio(rooms(), None);
    let pose = Transform::from_xyz(1.2, 1.5, EYES).looking_at(Vec3::new(0.2, 1.5, EYES), Vec3::Z);
    let camera = studio.camera_3d(pose, 1.0, SIZE).unwrap();
    let world = studio.app().world_mut();
    let root = world.query_filtered::<Entity, With<Environment>>().single(world).unwrap();
    let clear = studio.picture(camera).unwrap();
    let request = EnvironmentScenario::prebuilt(smoke_in_the_left_room(20.0));
    studio.app().world_mut().entity_mut(root).insert(request);
    for _ in 0..20 {
        studio.step().unwrap();
    }
    assert_ne!(studio.picture(camera).unwrap(), clear);
    studio.app().world_mut().entity_mut(root).remove::<EnvironmentScenario>();
    for _ in 0..3 {
        studio.step().unwrap();
    }
    assert!(!studio.app().world().entity(camera).contains::<DepthPrepass>());
    assert_eq!(studio.picture(camera).unwrap(), clear);
}

#[test]
fn cameras_that_cannot_be_are_refused() {
    let mut studio = Studio::new().unwrap();
    let pose = Transform::default();
    for size in [UVec2::ZERO, UVec2::new(0, 10), UVec2::new(10, 4097)] {
        let error = studio.camera_3d(pose, 1.0, size).unwrap_err();
        assert!(matches!(error, CaptureError::Size { .. }), "{error}");
    }
    for angle in [0.0, -1.0, std::f32::consts::PI, f32::NAN, f32::INFINITY] {
        let error = studio.camera_3d(pose, angle, SIZE).unwrap_err();
        assert!(matches!(error, CaptureError::FieldOfView { .. }), "{error}");
    }
    for pose in [Transform::from_xyz(f32::NAN, 0.0, 0.0), Transform::from_scale(Vec3::INFINITY)] {
        let error = studio.camera_3d(pose, 1.0, SIZE).unwrap_err();
        assert!(matches!(error, CaptureError::Pose { .. }), "{error}");
    }
}

#[test]
fn pictures_that_an_app_asks_for_have_the_size_of_the_camera() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rooms.png");
    let mut studio = studio(rooms(), None);
    let pose = Transform::from_xyz(3.0, 1.5, EYES).looking_at(Vec3::new(0.2, 1.5, EYES), Vec3::Z);
    let camera = studio.camera_3d(pose, 1.0, SIZE).unwrap();
    studio.step().unwrap();
    studio.app().world_mut().trigger(TakePicture { entity: camera, path: path.clone() });
    for _ in 0..10 {
        studio.step().unwrap();
    }
    let header = std::fs::read(path).unwrap();
    // The width and the height are in the first chunk of a PNG.
    let side = |at: usize| u32::from_be_bytes(header[at..at + 4].try_into().unwrap());
    assert_eq!(UVec2::new(side(16), side(20)), SIZE);
}
