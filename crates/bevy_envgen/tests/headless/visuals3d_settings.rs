//! Settings and cameras of the drawing in three dimensions that come late, go, or are not numbers.

use bevy::core_pipeline::prepass::DepthPrepass;
use bevy::light::Skybox;
use bevy::pbr::ContactShadows;
use bevy::prelude::*;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{spawn_ready, step, wait_until_ready};
use bevy_envgen::visuals3d::{Finish, Stage, TileMesh};

use crate::visuals3d::{app, indoor};

#[test]
fn trees_planted_without_a_camera_have_fewer_triangles_for_the_next_one() {
    let mut app = app();
    let eye =
        app.world_mut().spawn((Camera3d::default(), Transform::from_xyz(0.0, 10.0, 1.0))).id();
    let spec = ForestSpec { width: 400.0, height: 20.0, intensity: 0.1, ..default() };
    let finest = |app: &mut App| {
        let mut drawn = app.world_mut().query::<(&TileMesh, &Mesh3d, &GlobalTransform)>();
        let meshes = app.world().resource::<Assets<Mesh>>();
        let far = drawn
            .iter(app.world())
            .filter(|(mesh, _, at)| mesh.finish == Finish::Leaves && at.translation().x > 61.0);
        let triangles = |mesh: &Mesh3d| meshes.get(&mesh.0).unwrap().indices().unwrap().len() / 3;
        let far: Vec<usize> = far.map(|(_, mesh, _)| triangles(mesh)).collect();
        assert!(far.len() > 100);
        far.iter().filter(|&&triangles| triangles == 120).count()
    };
    // The camera is in the same place of the environment before and after.
    let forest = spawn_ready(&mut app, Environment::new(spec, 1)).unwrap();
    step(&mut app, 1);
    assert_eq!(finest(&mut app), 0);
    app.world_mut().get_mut::<Camera>(eye).unwrap().is_active = false;
    app.world_mut().trigger(RebuildEnvironment { entity: forest });
    step(&mut app, 3);
    assert!(finest(&mut app) > 100);
    app.world_mut().get_mut::<Camera>(eye).unwrap().is_active = true;
    step(&mut app, 1);
    assert_eq!(finest(&mut app), 0);
}

#[test]
fn cameras_have_a_depth_prepass_while_there_is_smoke() {
    let mut app = app();
    let [bare, own] = [(); 2].map(|()| app.world_mut().spawn(Camera3d::default()).id());
    app.world_mut().entity_mut(own).insert(DepthPrepass);
    let have =
        |app: &App| [bare, own].map(|eye| app.world().entity(eye).contains::<DepthPrepass>());
    let smoke = || EnvironmentScenario::new(ScenarioSpec { smoke: 0.4, ..default() }, 1);
    let root = app.world_mut().spawn((indoor(8), smoke())).id();
    wait_until_ready(&mut app, root).unwrap();
    for _ in 0..2 {
        step(&mut app, 2);
        assert_eq!(have(&app), [true, true]);
        app.world_mut().entity_mut(root).remove::<EnvironmentScenario>();
        step(&mut app, 2);
        assert_eq!(have(&app), [false, true]);
        app.world_mut().entity_mut(root).insert(smoke());
    }
    // An effect that the app adds while there is smoke keeps what it requires.
    step(&mut app, 2);
    app.world_mut().entity_mut(bare).insert(ContactShadows::default());
    app.world_mut().entity_mut(root).remove::<EnvironmentScenario>();
    step(&mut app, 2);
    assert_eq!(have(&app), [true, true]);
}

#[test]
fn settings_that_are_not_numbers_are_applied_once() {
    let mut app = app();
    let eye = app.world_mut().spawn(Camera3d::default()).id();
    spawn_ready(&mut app, indoor(8)).unwrap();
    let mut settings = app.world_mut().resource_mut::<Visuals3dSettings>();
    (settings.brightness, settings.lamp_spacing, settings.darkness) =
        (f32::NAN, f32::NAN, f32::NAN);
    step(&mut app, 2);
    let drawn = |app: &mut App| {
        let mut stages = app.world_mut().query_filtered::<Entity, With<Stage>>();
        let sky = app.world().entity(eye).get_ref::<Skybox>().expect("a sky").last_changed();
        (stages.single(app.world()).expect("a stage"), sky)
    };
    let before = drawn(&mut app);
    step(&mut app, 3);
    assert_eq!(drawn(&mut app), before);
}

#[test]
fn the_brightness_of_a_skybox_of_the_app_is_kept() {
    let mut app = app();
    let [given, own] = [(); 2].map(|()| app.world_mut().spawn(Camera3d::default()).id());
    spawn_ready(&mut app, indoor(8)).unwrap();
    step(&mut app, 2);
    let brightness = |app: &App| {
        [given, own].map(|eye| app.world().get::<Skybox>(eye).expect("a sky").brightness)
    };
    let before = brightness(&app);
    let loaded = app.world_mut().resource_mut::<Assets<Image>>().add(Image::default());
    let skybox = Skybox { image: Some(loaded), brightness: 5000.0, ..default() };
    app.world_mut().entity_mut(own).insert(skybox);
    app.world_mut().resource_mut::<Visuals3dSettings>().brightness *= 2.0;
    step(&mut app, 2);
    assert_eq!(brightness(&app), [2.0 * before[0], 5000.0]);
}
