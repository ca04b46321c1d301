//! Cameras that cannot take pictures.

use std::sync::{Arc, Mutex};

use bevy::prelude::*;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{spawn_ready, step, test_app_with};
use bevy_mapping_trial::camera::{
    CameraError, CameraFailed, CameraImages, RobotCamera, RobotCameraPlugin, RobotCameraView,
};
use bevy_mapping_trial::prelude::*;

/// Spawns a robot with a camera in an app without a renderer; returns what its camera complained of.
fn errors(camera: RobotCamera, has_world: bool) -> Vec<CameraError> {
    let plugins = (EnvgenPlugins::default(), RobotPlugin::default(), RobotCameraPlugin);
    let mut app = test_app_with(plugins);
    let errors = Arc::new(Mutex::new(Vec::new()));
    let kept = errors.clone();
    app.add_observer(move |failed: On<CameraFailed>| {
        kept.lock().unwrap().push(failed.error.clone());
    });
    if has_world {
        spawn_ready(&mut app, Environment::new(HallwaySpec::default(), 1)).unwrap();
    }
    let robot = app.world_mut().spawn((RobotModel::default(), camera)).id();
    step(&mut app, 4);
    assert!(app.world().get::<RobotCameraView>(robot).is_none_or(|_| camera.images.color));
    let errors = errors.lock().unwrap().clone();
    errors
}

#[test]
fn errors_say_what_is_missing() {
    let images = CameraImages { color: false, ..default() };
    let blind = RobotCamera { images, ..default() };
    assert_eq!(errors(blind, false), [CameraError::NoEnvironment]);
    assert_eq!(errors(blind, true), [CameraError::NoRenderer]);
    let wrong = errors(RobotCamera { width: 0, ..blind }, true);
    assert!(matches!(wrong[..], [CameraError::Setting { field: "width", .. }]), "{wrong:?}");
}
