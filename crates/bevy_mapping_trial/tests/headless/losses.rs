//! Trials that lose their world or their robots.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{in_rapier, step};
use bevy_mapping_trial::bevy_rapier2d::prelude::{NoUserData, RapierPhysicsPlugin, TimestepMode};
use bevy_mapping_trial::prelude::*;
use mapping_trial::backend::Command;
use mapping_trial::trial::{EndReason, TrialSettings};

use crate::trial::{Told, app, environment, listen, robots, short};

fn reported(app: &App) -> &[String] {
    &app.world().resource::<Told>().0
}

fn trial(app: &App, root: Entity) -> &MappingTrial {
    app.world().get(root).expect("a trial")
}

/// Spawns an environment with a running trial.
fn running(app: &mut App, settings: TrialSettings) -> Entity {
    listen(app);
    let root = app.world_mut().spawn((environment(), MappingTrial::new(settings))).id();
    step(app, 20);
    assert_eq!(reported(app), ["started"]);
    root
}

#[test]
fn a_trial_stops_with_its_environment_and_begins_again_with_another() {
    let mut app = app(20.0);
    let root = running(&mut app, short(60.0));
    app.world_mut().entity_mut(root).remove::<Environment>();
    step(&mut app, 20);
    assert_eq!((robots(&mut app), in_rapier(&mut app)), (0, (0, 0)));
    assert!(trial(&app, root).trial().is_none() && trial(&app, root).has_failed());
    let lost = "a trial needs the component `Environment` on its entity";
    assert_eq!(reported(&app), ["started", lost]);
    app.world_mut().entity_mut(root).insert(environment());
    step(&mut app, 20);
    assert_eq!(reported(&app), ["started", lost, "started"]);
    assert_eq!(robots(&mut app), 1);
}

#[test]
fn no_trial_runs_in_an_environment_that_is_tilted() {
    let mut app = app(20.0);
    let root = running(&mut app, short(60.0));
    let tilted = Transform::from_rotation(Quat::from_rotation_x(0.3));
    app.world_mut().entity_mut(root).insert(tilted);
    step(&mut app, 20);
    assert_eq!(app.world().get(root), Some(&EnvironmentState::Failed));
    assert_eq!((robots(&mut app), in_rapier(&mut app)), (0, (0, 0)));
    // A new trial does not begin either.
    app.world_mut().entity_mut(root).insert(MappingTrial::new(short(60.0)));
    step(&mut app, 20);
    assert_eq!((robots(&mut app), reported(&app).len()), (0, 1));
    app.world_mut().entity_mut(root).insert(Transform::IDENTITY);
    step(&mut app, 20);
    assert_eq!(reported(&app), ["started", "started"]);
    assert_eq!(robots(&mut app), 1);
}

#[test]
fn a_trial_that_has_ended_begins_again_when_its_world_is_rebuilt() {
    let generated = HallwaySpec { segments: 4, ..Default::default() };
    let generated = Environment::new(generated, 7).with_pace(GenerationMode::Blocking);
    for environment in [environment(), generated] {
        let mut app = app(20.0);
        listen(&mut app);
        let root = app.world_mut().spawn((environment, MappingTrial::new(short(2.0)))).id();
        step(&mut app, 60);
        assert_eq!(reported(&app), ["started", "ended"]);
        assert_eq!(robots(&mut app), 1);
        app.world_mut().trigger(RebuildEnvironment { entity: root });
        step(&mut app, 20);
        assert_eq!(reported(&app), ["started", "ended", "started"]);
        assert_eq!(robots(&mut app), 1);
        // While the environment is tilted, there are no robots, and the trial names none.
        step(&mut app, 40);
        assert!(trial(&app, root).is_over());
        let tilted = Transform::from_rotation(Quat::from_rotation_x(0.3));
        app.world_mut().entity_mut(root).insert(tilted);
        step(&mut app, 5);
        assert!(trial(&app, root).robots().is_empty() && !trial(&app, root).is_over());
        app.world_mut().entity_mut(root).insert(Transform::IDENTITY);
        step(&mut app, 20);
        assert_eq!(reported(&app)[4..], ["started"]);
        assert_eq!(robots(&mut app), 1);
    }
}

#[test]
fn a_robot_that_is_despawned_ends_its_part() {
    let mut app = app(20.0);
    let root = running(&mut app, TrialSettings { robots: 2, ..short(20.0) });
    let gone = trial(&app, root).robots()[1];
    app.world_mut().entity_mut(gone).despawn();
    step(&mut app, 40);
    let found = trial(&app, root).trial().expect("a trial");
    assert_eq!(found.end_of(1).map(|end| end.reason), Some(EndReason::Removed));
    assert_eq!(found.end_of(0), None);
    // The robot stays where it was, both in truth and in its own estimate.
    let estimated = found.autonomy().slam().trajectory(1);
    assert_eq!(estimated.last().copied(), estimated.get(estimated.len() - 2).copied());
    step(&mut app, 400);
    assert_eq!(reported(&app), ["started", "ended"]);
}

#[test]
fn a_clone_of_an_environment_has_no_robots_and_moves_none() {
    let mut app = app(20.0);
    let root = running(&mut app, short(60.0));
    app.world_mut().entity_mut(root).insert(ManualControl { commands: vec![Command::STOP] });
    step(&mut app, 20);
    let (robot, before) = (trial(&app, root).robots()[0], in_rapier(&mut app));
    let pose = *app.world().get::<TruePose>(robot).expect("a robot");
    let clone = app.world_mut().entity_mut(root).clone_and_spawn_with_opt_out(|builder| {
        builder.linked_cloning(true);
    });
    app.world_mut().get_mut::<Transform>(clone).expect("an environment").translation.x = 500.0;
    app.world_mut().run_schedule(PostUpdate);
    step(&mut app, 5);
    assert_eq!(robots(&mut app), 1);
    assert_eq!(app.world().get::<TruePose>(robot), Some(&pose));
    app.world_mut().despawn(clone);
    step(&mut app, 2);
    assert_eq!(in_rapier(&mut app), before);
}

#[test]
fn robots_that_are_despawned_before_the_start_are_spawned_again() {
    let mut app = app(20.0);
    listen(&mut app);
    // Despawns the robots between their spawn and the first tick.
    let despawn_first = |robots: Query<Entity, With<TrialRobot>>,
                         mut is_done: Local<bool>,
                         mut commands: Commands| {
        for robot in robots.iter().filter(|_| !*is_done) {
            commands.entity(robot).despawn();
        }
        *is_done |= !robots.is_empty();
    };
    let between = despawn_first.after(TrialSystems::Command).before(TrialSystems::Record);
    app.add_systems(FixedUpdate, between);
    app.world_mut().spawn((environment(), MappingTrial::new(short(60.0))));
    step(&mut app, 20);
    assert_eq!(reported(&app), ["started"]);
    assert_eq!(robots(&mut app), 1);
}

#[test]
fn a_trial_fails_where_its_environment_is_scaled_until_that_is_corrected() {
    let mut app = app(20.0);
    let root = running(&mut app, short(60.0));
    app.world_mut().entity_mut(root).insert(Transform::from_scale(Vec3::splat(2.0)));
    step(&mut app, 20);
    assert!(trial(&app, root).has_failed() && reported(&app)[1].contains("scale"));
    assert_eq!((reported(&app).len(), robots(&mut app)), (2, 0));
    app.world_mut().entity_mut(root).insert(Transform::IDENTITY);
    step(&mut app, 20);
    assert_eq!((reported(&app).len(), robots(&mut app)), (3, 1));
    assert_eq!(reported(&app)[2], "started");
}

#[test]
fn a_trial_fails_where_a_step_is_no_tick_until_that_is_corrected() {
    let fixed = |app: &mut App, step: f64| {
        app.world_mut().resource_mut::<Time<Fixed>>().set_timestep_seconds(step);
    };
    let rapier = |app: &mut App, step: f64| {
        app.insert_resource(TimestepMode::Fixed { dt: step as f32, substeps: 4 });
    };
    type Change<'a> = (&'a dyn Fn(&mut App, f64), &'a str);
    let changes: [Change<'_>; 2] = [(&fixed, "time advances by"), (&rapier, "rapier's step")];
    for (set, name) in changes {
        let mut app = app(20.0);
        let root = running(&mut app, short(60.0));
        set(&mut app, 0.1);
        step(&mut app, 20);
        assert!(trial(&app, root).has_failed(), "{name}");
        assert_eq!((reported(&app).len(), robots(&mut app)), (2, 0));
        assert!(reported(&app)[1].contains(name) && reported(&app)[1].contains("0.1"));
        set(&mut app, 0.05);
        step(&mut app, 20);
        assert_eq!(reported(&app)[2..], ["started"]);
        assert_eq!(robots(&mut app), 1);
    }
}

#[test]
fn a_trial_fails_in_a_schedule_whose_step_is_no_tick() {
    for (frame, outcome) in [(0.1, "time advances by 0.1 s per step"), (0.05, "started")] {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin));
        app.insert_resource(Time::<Fixed>::from_seconds(0.05))
            .insert_resource(TimestepMode::Fixed { dt: 0.05, substeps: 4 })
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(frame)));
        app.add_plugins(RapierPhysicsPlugin::<NoUserData>::default());
        let scenarios = EnvgenScenarioPlugin::new(PostUpdate);
        app.add_plugins(EnvgenPlugins::default().build().disable::<EnvgenScenarioPlugin>());
        app.add_plugins((scenarios, TrialPlugin::new(PostUpdate)));
        app.finish();
        app.cleanup();
        listen(&mut app);
        // Time does not advance in the first frame.
        step(&mut app, 1);
        app.world_mut().spawn((environment(), MappingTrial::new(short(60.0))));
        step(&mut app, 20);
        assert!(reported(&app).len() == 1, "{:?}", reported(&app));
        assert!(reported(&app)[0].starts_with(outcome), "{:?}", reported(&app));
    }
}

#[test]
fn a_trial_in_a_world_without_an_end_is_refused() {
    let mut app = app(20.0);
    listen(&mut app);
    let anchor = app.world_mut().spawn(Transform::default()).id();
    let forest = Environment::new(ForestSpec { intensity: 0.01, ..default() }, 1).endless(30.0);
    let around = StreamAround::new(anchor, 30.0);
    let root = app.world_mut().spawn((forest, around, MappingTrial::new(short(60.0)))).id();
    step(&mut app, 60);
    assert!(reported(&app).len() == 1 && reported(&app)[0].contains("endless"));
    assert!(trial(&app, root).has_failed());
    // Another trial fails too, and begins when the world is finite.
    app.world_mut().entity_mut(root).insert(MappingTrial::new(short(60.0)));
    step(&mut app, 20);
    assert_eq!(reported(&app).len(), 2);
    app.world_mut().entity_mut(root).remove::<StreamAround>().insert(environment());
    step(&mut app, 40);
    assert_eq!(reported(&app)[2..], ["started"]);
}

#[test]
fn a_trial_without_an_environment_is_reported_until_there_is_one() {
    let mut app = app(20.0);
    listen(&mut app);
    let root = app.world_mut().spawn(MappingTrial::new(short(60.0))).id();
    step(&mut app, 20);
    let missing = "a trial needs the component `Environment` on its entity";
    assert_eq!(reported(&app), [missing]);
    assert!(trial(&app, root).has_failed());
    // While an environment is tilted, it has no world, and the trial waits.
    let tilted = Transform::from_rotation(Quat::from_rotation_x(0.5));
    app.world_mut().entity_mut(root).insert((environment(), tilted));
    step(&mut app, 20);
    assert!(!trial(&app, root).has_failed());
    app.world_mut().entity_mut(root).remove::<Environment>();
    step(&mut app, 20);
    assert_eq!(reported(&app), [missing, missing]);
    app.world_mut().entity_mut(root).insert((environment(), Transform::default()));
    step(&mut app, 20);
    assert_eq!(reported(&app)[2..], ["started"]);
    assert!(!trial(&app, root).has_failed());
}

#[test]
fn no_robot_is_left_where_an_observer_of_the_first_one_removes_the_environment() {
    let mut app = app(20.0);
    let remove = |added: On<Add, TrialRobot>, parents: Query<&ChildOf>, mut commands: Commands| {
        if let Ok(root) = parents.get(added.entity) {
            commands.entity(root.parent()).try_remove::<Environment>();
        }
    };
    app.add_observer(remove);
    let trial = MappingTrial::new(TrialSettings { robots: 2, ..short(60.0) });
    app.world_mut().spawn((environment(), trial));
    step(&mut app, 20);
    assert_eq!((robots(&mut app), in_rapier(&mut app)), (0, (0, 0)));
}
