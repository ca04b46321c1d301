//! The difficulty of worlds, requested as a user does.

use std::time::Duration;

use bevy::prelude::*;
use bevy_envgen::envgen::calibration::Calibration;
use bevy_envgen::envgen::difficulty::{DifficultyError, DifficultyVector, Platform};
use bevy_envgen::prelude::*;

/// A resource with the environments whose difficulty was reported.
#[derive(Resource, Default)]
struct Reported(Vec<Entity>);

/// Creates an app as a user does, with only the plugin group of this crate.
fn user_app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, EnvgenPlugins::default()));
    app.init_resource::<Reported>();
    app.add_observer(|computed: On<DifficultyComputed>, mut reported: ResMut<Reported>| {
        reported.0.push(computed.entity);
    });
    app.finish();
    app.cleanup();
    app
}

/// Runs frames until another difficulty is reported.
fn wait(app: &mut App) -> Entity {
    let before = app.world().resource::<Reported>().0.len();
    for _ in 0..60_000 {
        app.update();
        let reported = &app.world().resource::<Reported>().0;
        if reported.len() > before {
            return reported[before];
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    panic!("no difficulty is reported");
}

fn map(seed: u64) -> Environment {
    Environment::new(IndoorSpec { width: 6, height: 6, ..default() }, seed)
}

fn vector(app: &App, root: Entity, platform: &Platform) -> DifficultyVector {
    let truth = app.world().get::<GroundTruth>(root).expect("a world");
    DifficultyVector::of(truth, platform).expect("a vector")
}

#[test]
fn an_indoor_map_has_its_vector_and_prediction() {
    let mut app = user_app();
    let root = app.world_mut().spawn((map(1), ComputeDifficulty::default())).id();
    assert_eq!(wait(&mut app), root);
    let found = app.world().get::<EnvironmentDifficulty>(root).expect("a difficulty").clone();
    assert_eq!(found.vector, vector(&app, root, &Platform::default()));
    assert_eq!(found.prediction, Some(Calibration::indoor().predict(&found.vector)));

    // First another world, and then another robot.
    *app.world_mut().get_mut::<Environment>(root).expect("an environment") = map(2);
    assert_eq!(wait(&mut app), root);
    let second = app.world().get::<EnvironmentDifficulty>(root).expect("a difficulty").clone();
    assert_eq!(second.vector, vector(&app, root, &Platform::default()));
    assert_ne!(second, found);
    let platform = Platform { max_range: 4.0, ..default() };
    app.world_mut().entity_mut(root).insert(ComputeDifficulty::new(platform.clone()));
    app.update();
    assert!(app.world().get::<EnvironmentDifficulty>(root).is_none_or(|now| *now != second));
    if app.world().get::<EnvironmentDifficulty>(root).is_none() {
        wait(&mut app);
    }
    let third = app.world().get::<EnvironmentDifficulty>(root).expect("a difficulty");
    assert_eq!(third.vector, vector(&app, root, &platform));
    assert_eq!(third.prediction, None, "predictions are for the default platform");

    // If nothing changes, nothing is reported, even if the request is written again. A difficulty that is not
    // requested is removed.
    let reported = app.world().resource::<Reported>().0.len();
    for _ in 0..5 {
        app.world_mut().get_mut::<ComputeDifficulty>(root).expect("a request").set_changed();
        app.update();
        assert!(app.world().get::<EnvironmentDifficulty>(root).is_some());
    }
    assert_eq!(app.world().resource::<Reported>().0.len(), reported);
    app.world_mut().entity_mut(root).remove::<ComputeDifficulty>();
    app.update();
    assert!(app.world().get::<EnvironmentDifficulty>(root).is_none());
    app.world_mut().entity_mut(root).despawn();
    app.update();
}

#[test]
fn kinds_without_calibration_have_a_vector_and_no_prediction() {
    let mut app = user_app();
    let hallway = Environment::new(HallwaySpec { segments: 12, ..default() }, 1);
    let root = app.world_mut().spawn((hallway, ComputeDifficulty::default())).id();
    wait(&mut app);
    let found = app.world().get::<EnvironmentDifficulty>(root).expect("a difficulty");
    assert!(found.prediction.is_some());
    let road = Environment::new(RoadSpec { length: 100.0, ..default() }, 1);
    let root = app.world_mut().spawn((road, ComputeDifficulty::default())).id();
    wait(&mut app);
    let found = app.world().get::<EnvironmentDifficulty>(root).expect("a difficulty");
    assert_eq!(found.vector, vector(&app, root, &Platform::default()));
    assert_eq!(found.prediction, None);
}

#[test]
fn a_robot_that_does_not_fit_is_an_error_until_it_does() {
    let mut app = user_app();
    let wide = Platform { circumscribed_radius: 1.9, ..default() };
    let root = app.world_mut().spawn((map(1), ComputeDifficulty::new(wide))).id();
    wait(&mut app);
    let failure = app.world().get::<DifficultyFailure>(root).expect("a failure");
    assert!(matches!(**failure, DifficultyError::Start { .. }), "{}", failure.0);
    assert!(app.world().get::<EnvironmentDifficulty>(root).is_none());
    app.world_mut().entity_mut(root).insert(ComputeDifficulty::default());
    wait(&mut app);
    assert!(app.world().get::<DifficultyFailure>(root).is_none());
    assert!(app.world().get::<EnvironmentDifficulty>(root).is_some());
}

#[test]
fn environments_that_are_despawned_meanwhile_do_no_harm() {
    let mut app = user_app();
    for frames in 0..4 {
        let root = app.world_mut().spawn((map(3), ComputeDifficulty::default())).id();
        for _ in 0..frames {
            app.update();
        }
        app.world_mut().entity_mut(root).despawn();
        app.update();
    }
    let root = app.world_mut().spawn((map(4), ComputeDifficulty::default())).id();
    wait(&mut app);
    let world = app.world().get::<GroundTruth>(root).expect("a world").0.clone();
    // A request on an entity without a world waits for one.
    let bare = app.world_mut().spawn(ComputeDifficulty::default()).id();
    app.update();
    assert!(app.world().get::<EnvironmentDifficulty>(bare).is_none());
    app.world_mut().entity_mut(bare).insert(Environment::prebuilt(world));
    assert_eq!(wait(&mut app), bare);
}

#[test]
fn a_request_that_is_removed_when_its_result_arrives_has_no_result() {
    let mut app = user_app();
    let asked = (map(1), ComputeDifficulty::default());
    let roots = [(); 2].map(|()| app.world_mut().spawn(asked.clone()).id());
    // The first result removes the request of the other environment.
    let remove = move |computed: On<DifficultyComputed>, mut commands: Commands| {
        for root in roots.into_iter().filter(|root| *root != computed.entity) {
            commands.entity(root).remove::<ComputeDifficulty>();
        }
    };
    app.add_observer(remove);
    app.update();
    // Both results are ready in the same frame, unless one was already ready in the first.
    std::thread::sleep(Duration::from_millis(500));
    let early = app.world().resource::<Reported>().0.first().copied();
    let first = early.unwrap_or_else(|| wait(&mut app));
    app.update();
    for root in roots {
        let has_result = app.world().get::<EnvironmentDifficulty>(root).is_some();
        assert_eq!(has_result, root == first);
    }
    assert_eq!(app.world().resource::<Reported>().0, [first]);
}
