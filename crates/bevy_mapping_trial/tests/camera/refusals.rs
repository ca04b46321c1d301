//! Cameras that cannot take pictures.

use std::sync::{Arc, Mutex};

use bevy::prelude::*;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{step, test_app_with, wait_until_ready};
use bevy_mapping_trial::camera::{
    CameraError, CameraFailed, CameraImages, RobotCamera, RobotCameraPlugin, RobotCameraView,
};
use bevy_mapping_trial::prelude::*;
use bevy_mapping_trial::view3d::RobotVisuals3dPlugin;

/// Creates an app without a renderer, and the list of the errors that cameras report in it.
fn app_with_errors() -> (App, Arc<Mutex<Vec<CameraError>>>) {
    let plugins = (EnvgenPlugins::default(), RobotPlugin::default(), RobotCameraPlugin);
    let mut app = test_app_with(plugins);
    let errors = Arc::new(Mutex::new(Vec::new()));
    let kept = errors.clone();
    app.add_observer(move |failed: On<CameraFailed>| {
        kept.lock().unwrap().push(failed.error.clone());
    });
    (app, errors)
}

/// Spawns a robot with a camera in an app without a renderer, and returns the errors that were reported for
/// it.
fn errors(camera: RobotCamera, world: Option<Environment>) -> Vec<CameraError> {
    let (mut app, errors) = app_with_errors();
    if let Some(world) = world {
        let anchor = app.world_mut().spawn(Transform::default()).id();
        let environment = app.world_mut().spawn((world, StreamAround::new(anchor, 20.0))).id();
        wait_until_ready(&mut app, environment).unwrap();
    }
    let robot = app.world_mut().spawn((RobotModel::default(), camera)).id();
    step(&mut app, 4);
    assert!(app.world().get::<RobotCameraView>(robot).is_none_or(|_| camera.images.color));
    errors.lock().unwrap().clone()
}

#[test]
fn a_clone_of_a_robot_has_one_camera_of_its_own() {
    let plugins = (EnvgenPlugins::default(), RobotPlugin::default(), RobotCameraPlugin);
    let mut app = test_app_with(plugins);
    app.init_asset::<Image>();
    let robot = app.world_mut().spawn((RobotModel::default(), RobotCamera::default())).id();
    step(&mut app, 1);
    let clone = app.world_mut().entity_mut(robot).clone_and_spawn_with_opt_out(|builder| {
        builder.linked_cloning(true);
    });
    step(&mut app, 2);
    let mut cameras = app.world_mut().query_filtered::<&ChildOf, With<Camera3d>>();
    let mut of = |app: &App| cameras.iter(app.world()).map(ChildOf::parent).collect::<Vec<_>>();
    assert_eq!(of(&app).len(), 2);
    assert!(of(&app).contains(&robot) && of(&app).contains(&clone));
    let view = |app: &App, robot| app.world().get::<RobotCameraView>(robot).unwrap().camera;
    assert_ne!(view(&app, robot), view(&app, clone));
    app.world_mut().entity_mut(clone).remove::<RobotCamera>();
    step(&mut app, 1);
    assert_eq!(of(&app), [robot]);
}

#[test]
fn errors_say_what_is_missing() {
    let images = CameraImages { color: false, ..default() };
    let blind = RobotCamera { images, ..default() };
    let hallway = || Some(Environment::new(HallwaySpec::default(), 1));
    assert_eq!(errors(blind, None), [CameraError::NoEnvironment]);
    assert_eq!(errors(blind, hallway()), [CameraError::NoRenderer]);
    let endless = Environment::new(ForestSpec::default(), 1).endless(20.0);
    assert_eq!(errors(blind, Some(endless)), [CameraError::Endless]);
    let wrong = errors(RobotCamera { width: 0, ..blind }, hallway());
    assert!(matches!(wrong[..], [CameraError::Setting { field: "width", .. }]), "{wrong:?}");
}

#[test]
fn a_camera_continues_once_there_is_a_world_for_it() {
    let (mut app, errors) = app_with_errors();
    let images = CameraImages { color: false, ..default() };
    app.world_mut().spawn((RobotModel::default(), RobotCamera { images, ..default() }));
    let anchor = app.world_mut().spawn(Transform::default()).id();
    let forest = Environment::new(ForestSpec::default(), 1).endless(20.0);
    let around = StreamAround::new(anchor, 20.0);
    step(&mut app, 4);
    let environment = app.world_mut().spawn((forest, around)).id();
    wait_until_ready(&mut app, environment).unwrap();
    step(&mut app, 4);
    app.world_mut().despawn(environment);
    // This app has no renderer, which a camera reports when it takes a picture.
    let hallway = Environment::new(HallwaySpec::default(), 1);
    let environment = app.world_mut().spawn(hallway).id();
    wait_until_ready(&mut app, environment).unwrap();
    step(&mut app, 4);
    let expected = [CameraError::NoEnvironment, CameraError::Endless, CameraError::NoRenderer];
    assert_eq!(errors.lock().unwrap()[..], expected);
}

#[test]
fn nothing_is_left_of_a_robot_that_an_observer_despawns_as_it_is_spawned() {
    for (of_model, color) in [(true, true), (true, false), (false, true), (false, false)] {
        let plugins = (EnvgenPlugins::default(), RobotPlugin::default(), RobotCameraPlugin);
        let mut app = test_app_with((plugins, RobotVisuals3dPlugin));
        app.init_asset::<Image>().init_asset::<Mesh>().init_asset::<StandardMaterial>();
        let despawn = |robot: Entity, mut commands: Commands| commands.entity(robot).despawn();
        if of_model {
            app.add_observer(move |added: On<Add, RobotModel>, commands: Commands| {
                despawn(added.entity, commands);
            });
        } else {
            app.add_observer(move |added: On<Add, RobotCamera>, commands: Commands| {
                despawn(added.entity, commands);
            });
        }
        let camera = RobotCamera { images: CameraImages { color, ..default() }, ..default() };
        let mut drawn = app.world_mut().query_filtered::<(), Or<(With<Camera3d>, With<Mesh3d>)>>();
        app.world_mut().spawn((RobotModel::default(), camera));
        step(&mut app, 2);
        assert_eq!(drawn.iter(app.world()).count(), 0);
        // The model and the camera come one after the other.
        let robot = app.world_mut().spawn(RobotModel::default()).id();
        if let Ok(mut robot) = app.world_mut().get_entity_mut(robot) {
            robot.insert(camera);
        }
        step(&mut app, 2);
        assert_eq!(drawn.iter(app.world()).count(), 0);
    }
}
