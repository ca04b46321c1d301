//! Cameras in apps that compile pipelines in the background, as apps with a window do.

use std::sync::Arc;
use std::time::Duration;

use bevy::app::PluginsState;
use bevy::camera::CameraPlugin;
use bevy::core_pipeline::CorePipelinePlugin;
use bevy::diagnostic::FrameCountPlugin;
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::time::{TimePlugin, TimeUpdateStrategy};
use bevy::window::{ExitCondition, WindowPlugin};
use bevy_envgen::physics::TopDownPhysicsPlugin;
use bevy_envgen::prelude::*;
use bevy_mapping_trial::camera::{
    CameraError, CameraFailed, CameraFrame, CameraFrameTaken, CameraImages, RobotCamera,
    RobotCameraPlugin, RobotCameraView,
};
use bevy_mapping_trial::prelude::*;

/// A resource with the pictures that were taken.
#[derive(Resource, Default)]
struct Taken(Vec<Arc<CameraFrame>>);

/// A resource with the errors that were reported.
#[derive(Resource, Default)]
struct Failures(Vec<CameraError>);

fn app() -> App {
    let mut app = App::new();
    let (primary_window, exit_condition) = (None, ExitCondition::DontExit);
    app.add_plugins((
        TaskPoolPlugin::default(),
        FrameCountPlugin,
        TimePlugin,
        TransformPlugin,
        bevy::input::InputPlugin,
        WindowPlugin { primary_window, exit_condition, ..default() },
        AssetPlugin::default(),
        RenderPlugin::default(),
        ImagePlugin::default(),
        MeshPlugin,
        CameraPlugin,
        CorePipelinePlugin,
    ));
    app.add_plugins((
        bevy::sprite::SpritePlugin,
        bevy::sprite_render::SpriteRenderPlugin,
        bevy::gizmos::GizmoPlugin,
        bevy::light::LightPlugin,
        bevy::pbr::PbrPlugin::default(),
    ));
    app.add_plugins((
        TopDownPhysicsPlugin::for_trials(),
        EnvgenPlugins::default(),
        EnvgenVisuals3dPlugin::default(),
        RobotPlugin::default(),
        RobotCameraPlugin,
    ));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(50)));
    app.init_resource::<Taken>();
    app.add_observer(|taken: On<CameraFrameTaken>, mut all: ResMut<Taken>| {
        all.0.push(taken.frame.clone());
    });
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
    app
}

#[test]
fn the_first_picture_lacks_nothing() {
    let mut app = app();
    let map = IndoorSpec { width: 4, height: 4, ..default() };
    let environment = Environment::new(map, 4).with_pace(GenerationMode::Blocking);
    let environment = app.world_mut().spawn(environment).id();
    app.update();
    let start = app.world().get::<EnvironmentLandmarks>(environment).unwrap().start.unwrap().pose;
    let images = CameraImages { color: true, depth: false, labels: false };
    let camera = RobotCamera { images, width: 40, height: 30, rate: 20.0, ..default() };
    app.world_mut().spawn((RobotModel::default(), camera, start, ChildOf(environment)));
    for _ in 0..1000 {
        app.update();
        if app.world().resource::<Taken>().0.len() >= 10 {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let taken = &app.world().resource::<Taken>().0;
    assert!(taken.len() >= 10, "{} pictures", taken.len());
    // Nothing moves, so all pictures are the same.
    for (number, frame) in taken.iter().enumerate() {
        assert_eq!(frame.number, number as u64);
        assert!(frame.color == taken[9].color, "picture {number}");
    }
    let colors = taken[0].color.as_deref().unwrap();
    let tones: std::collections::BTreeSet<_> = colors.iter().collect();
    assert!(tones.len() > 20, "{} tones", tones.len());
}

#[test]
fn no_picture_lacks_its_colours_without_an_error() {
    let mut app = app();
    app.init_resource::<Failures>();
    app.add_observer(|failed: On<CameraFailed>, mut all: ResMut<Failures>| {
        all.0.push(failed.error.clone());
    });
    let environment = Environment::new(HallwaySpec::default(), 4);
    let environment = environment.with_pace(GenerationMode::Blocking);
    let environment = app.world_mut().spawn(environment).id();
    let images = CameraImages { color: true, depth: true, labels: false };
    let camera = RobotCamera { images, width: 40, height: 30, rate: 20.0, ..default() };
    let robot = (RobotModel::default(), camera, ChildOf(environment));
    let robot = app.world_mut().spawn(robot).id();
    app.update();
    let eye = app.world().get::<RobotCameraView>(robot).unwrap().camera;
    app.world_mut().despawn(eye);
    for _ in 0..10 {
        app.update();
    }
    assert_eq!(app.world().resource::<Failures>().0, [CameraError::NoEye]);
    assert!(app.world().resource::<Taken>().0.iter().all(|frame| frame.color.is_some()));
}
