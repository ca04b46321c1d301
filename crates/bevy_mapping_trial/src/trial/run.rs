//! The systems that run trials.

use bevy::prelude::*;
use bevy_envgen::{
    EndlessTruth, Environment, EnvironmentScenario, EnvironmentState, GroundTruth, ScenarioFailure,
    ScenarioRun, SpawnedOrigin,
};
use bevy_rapier2d::prelude::TimestepMode;
use envgen::geometry::Pose;
use envgen::glam::DVec2;
use mapping_trial::backend::{Command, Condition, RobotBackend, Sensors, TICK};
use mapping_trial::lidar::Scan;
use mapping_trial::trial::{EndReason, Trial, TrialBuilder, TrialLog};

use super::bodies::{ENGINE, RapierRobots, TickReport};
use super::camera::Camera;
use super::component::{ManualControl, MappingTrial, Place, Request, Run, State, TrialRobot};
use super::error::MappingTrialError;
use super::event::{TrialEnded, TrialFailed, TrialStarted};
use super::scenario::{ReplacedScenario, prepare, release};
use crate::robot::{
    Battery, Bumper, DriveCommand, LaserScan, LaserScanner, RobotCondition, RobotModel, TruePose,
    WheelOdometry,
};

/// Relative differences of time steps and scales below this value are due to rounding.
const TOLERANCE: f64 = 1e-5;

/// A trial and its environment.
type Asked = (
    Entity,
    &'static mut MappingTrial,
    &'static SpawnedOrigin,
    &'static EnvironmentState,
    &'static GroundTruth,
    &'static GlobalTransform,
    (
        Option<&'static EnvironmentScenario>,
        Option<&'static ReplacedScenario>,
        Option<&'static mut ScenarioRun>,
        Option<&'static ScenarioFailure>,
    ),
);

/// Begins trials whose worlds are ready, and restarts trials whose worlds or scenarios have changed.
pub(super) fn begin(
    mut trials: Query<Asked>,
    clock: Res<Time>,
    fixed: Res<Time<Fixed>>,
    rapier: Option<Res<TimestepMode>>,
    mut commands: Commands,
) {
    for (entity, mut trial, origin, state, truth, transform, scenario) in &mut trials {
        let (request, replaced, mut moving, failure) = scenario;
        let has_scenario_failed = failure.is_some();
        let place = Place {
            world: truth.0.clone(),
            scenario: moving.as_ref().map(|moving| moving.number()),
        };
        let suits = check(&clock, &fixed, rapier.as_deref(), transform);
        let stays = match &trial.state {
            State::Waiting | State::Nowhere(_) => false,
            // The time steps, the scale or the scenario may have been corrected since.
            State::Failed { place: known, suited, has_scenario_failed: had_failed } => {
                known.is(&place)
                    && (*suited || suits.is_err())
                    && (!*had_failed || has_scenario_failed)
            }
            State::Over(run) => run.place.is(&place),
            State::Warming(run) | State::Running(run) => {
                let unsuited = suits.as_ref().err().filter(|_| run.place.is(&place)).cloned();
                if let Some(error) = unsuited {
                    log::warn!("trial in environment {entity}: {error}");
                    release(moving.as_deref_mut());
                    dismiss(trial.robots(), &mut commands);
                    trial.state = State::Failed { place, suited: false, has_scenario_failed };
                    commands.trigger(TrialFailed { entity, error });
                    continue;
                }
                run.place.is(&place)
            }
        };
        if stays {
            continue;
        }
        dismiss(trial.robots(), &mut commands);
        trial.state = State::Waiting;
        // If another world has failed, the previous one is still spawned.
        if !matches!(state, EnvironmentState::Ready | EnvironmentState::Failed) {
            continue;
        }
        let suited = suits.is_ok();
        let checked = suits.and_then(|()| {
            let root = &mut commands.entity(entity);
            let requests = (request, replaced);
            let is_ready = prepare(&trial.ask, requests, moving.as_deref_mut(), failure, root)?;
            is_ready.then(|| start(&trial, &place.world, moving.as_deref())).transpose()
        });
        match checked {
            // The trial begins in a later tick.
            Ok(None) => {}
            Ok(Some(mut placed)) => {
                let robots = spawn(&mut commands, (entity, *origin), transform, &mut placed);
                let scans = vec![0; robots.len()];
                let script = match &trial.ask {
                    Request::New(_) => Vec::new(),
                    Request::Replay(log) => {
                        let track = |robot| log.commands(robot).collect::<Vec<_>>().into_iter();
                        (0..robots.len()).map(track).collect()
                    }
                };
                let camera = Camera::new(&place.world);
                let run = Run { trial: placed, place, camera, robots, scans, script };
                trial.state = State::Warming(Box::new(run));
            }
            Err(error) => {
                log::warn!("trial in environment {entity}: {error}");
                release(moving.as_deref_mut());
                trial.state = State::Failed { place, suited, has_scenario_failed };
                commands.trigger(TrialFailed { entity, error });
            }
        }
    }
}

/// Reports trials that wait without an environment or in endless worlds.
pub(super) fn refuse_places(
    mut trials: Query<(Entity, &mut MappingTrial, Has<Environment>, Has<EndlessTruth>)>,
    mut commands: Commands,
) {
    for (entity, mut trial, has_environment, is_endless) in &mut trials {
        let error = match (has_environment, is_endless) {
            (false, _) => MappingTrialError::NoEnvironment,
            (true, true) => MappingTrialError::Endless,
            (true, false) => {
                if matches!(trial.state, State::Nowhere(_)) {
                    trial.state = State::Waiting;
                }
                continue;
            }
        };
        let is_known = match &trial.state {
            State::Waiting => false,
            State::Nowhere(known) => *known == error,
            _ => true,
        };
        if is_known {
            continue;
        }
        log::warn!("trial in environment {entity}: {error}");
        trial.state = State::Nowhere(error.clone());
        commands.trigger(TrialFailed { entity, error });
    }
}

impl Place {
    fn is(&self, other: &Place) -> bool {
        std::sync::Arc::ptr_eq(&self.world, &other.world) && self.scenario == other.scenario
    }
}

/// Checks that the time steps and the transform of the environment are valid for a trial. The clock is that of
/// the schedule of trials, in which a tick must be a step.
fn check(
    clock: &Time,
    fixed: &Time<Fixed>,
    rapier: Option<&TimestepMode>,
    transform: &GlobalTransform,
) -> Result<(), MappingTrialError> {
    let tick = |seconds: f64| (seconds / TICK - 1.0).abs() < TOLERANCE;
    // In `FixedUpdate` both are the same. Time does not advance in the first frame of an app.
    let steps = [Some(fixed.timestep()), Some(clock.delta()).filter(|delta| !delta.is_zero())];
    let mut steps = steps.into_iter().flatten().map(|step| step.as_secs_f64());
    if let Some(found) = steps.find(|&step| !tick(step)) {
        return Err(MappingTrialError::FixedStep { found });
    }
    match rapier {
        Some(TimestepMode::Fixed { dt, .. }) if tick(f64::from(*dt)) => {}
        other => {
            let found = other.map_or("none".to_owned(), |mode| format!("{mode:?}"));
            return Err(MappingTrialError::RapierStep { found });
        }
    }
    check_scale(transform)
}

fn check_scale(transform: &GlobalTransform) -> Result<(), MappingTrialError> {
    let found = transform.scale();
    if (found - Vec3::ONE).abs().max_element() > TOLERANCE as f32 {
        return Err(MappingTrialError::Scale { found });
    }
    Ok(())
}

/// Creates a trial with its robots at their start poses.
fn start(
    trial: &MappingTrial,
    world: &envgen::World,
    moving: Option<&ScenarioRun>,
) -> Result<Trial<RapierRobots>, MappingTrialError> {
    let bodies =
        |builder: TrialBuilder<'_>| builder.parts(trial.parts.clone()).build(RapierRobots::new);
    Ok(match &trial.ask {
        Request::New(settings) => {
            let builder = TrialBuilder::new(world, (**settings).clone());
            bodies(match moving {
                Some(moving) => builder.scenario(moving.scenario().clone()),
                None => builder,
            })?
        }
        Request::Replay(log) if log.engine != ENGINE => {
            return Err(MappingTrialError::Engine { found: log.engine.clone() });
        }
        Request::Replay(log) => log.replay_with(world, bodies)?,
    })
}

/// Spawns the robots of a trial as children of its environment.
fn spawn(
    commands: &mut Commands,
    (entity, origin): (Entity, SpawnedOrigin),
    frame: &GlobalTransform,
    trial: &mut Trial<RapierRobots>,
) -> Vec<Entity> {
    let sensors = trial.bodies_mut().take_sensors();
    let settings = trial.settings();
    let robots = sensors.into_iter().enumerate();
    robots
        .map(|(index, Sensors { laser, odometry })| {
            let Pose { position, heading } = trial.bodies().pose(index);
            let at = (position - origin.0).as_vec2();
            let place = Transform::from_translation(at.extend(0.0))
                .with_rotation(Quat::from_rotation_z(heading as f32));
            let robot = (
                Name::new(format!("Robot {}", index + 1)),
                TrialRobot { index },
                RobotModel(settings.body.clone()),
                LaserScanner::with_sensor(settings.laser.clone(), laser)
                    .with_smoke_draws(settings.seed.0, index as u64),
                WheelOdometry::with_sensor(odometry),
                place,
                // Bevy propagates it only once per frame, but rapier reads it in this tick.
                frame.mul_transform(place),
                ChildOf(entity),
            );
            commands.spawn(robot).id()
        })
        .collect()
}

/// Passes what the robots have sensed to their trials, and commands the robots.
pub(super) fn command(
    mut trials: Query<(
        Entity,
        &mut MappingTrial,
        Option<&ManualControl>,
        Option<&mut ScenarioRun>,
    )>,
    mut robots: Query<&mut DriveCommand, With<TrialRobot>>,
    mut commands: Commands,
) {
    for (entity, mut trial, manual_control, mut moving) in &mut trials {
        let MappingTrial { ask, state, .. } = &mut *trial.bypass_change_detection();
        let State::Running(run) = state else { continue };
        if let Some(moving) = &mut moving
            && moving.is_paused()
        {
            // The log and the scores of the trial need everything to move in each of its ticks.
            moving.set_paused(false);
        }
        let given = match ask {
            Request::Replay(log) => {
                if let Some(moving) = &mut moving {
                    replay_doors(log, moving.bypass_change_detection());
                }
                replayed(log, run)
            }
            Request::New(_) => run
                .trial
                .command(manual_control.map(|manual_control| manual_control.commands.as_slice())),
        };
        let stop = vec![Command::STOP; run.robots.len()];
        for (&robot, &command) in run.robots.iter().zip(given.as_ref().unwrap_or(&stop)) {
            if let Ok(mut target) = robots.get_mut(robot) {
                target.set_if_neq(command.into());
            }
        }
        if given.is_none() {
            if let Some(moving) = &mut moving {
                moving.bypass_change_detection().set_ignores_commands(false);
            }
            if let State::Running(run) = std::mem::replace(state, State::Waiting) {
                *state = State::Over(run);
            }
            trial.set_changed();
            commands.trigger(TrialEnded { entity });
        }
    }
}

/// Gives doors the commands of the log for the next tick. Doors ignore all other commands.
fn replay_doors(log: &TrialLog, moving: &mut ScenarioRun) {
    let (given, tick) = (log.door_commands(), moving.state().tick());
    let first = given.partition_point(|given| given.tick < tick);
    for given in given[first..].iter().take_while(|given| given.tick == tick) {
        // A log that was read names only doors of its scenario.
        moving.replay_door(given.door, given.command).ok();
    }
}

/// Returns the commands of the log for the next tick, or `None` at the end of the log.
fn replayed(log: &TrialLog, run: &mut Run) -> Option<Vec<Command>> {
    let Run { trial, script, .. } = run;
    if script.first().is_some_and(|track| track.len() > 0) {
        let commands: Vec<Command> =
            script.iter_mut().map(|track| track.next().unwrap_or(Command::STOP)).collect();
        return trial.command(Some(&commands));
    }
    let stopped = |reason: Option<EndReason>| reason == Some(EndReason::Stopped);
    if log.ends.iter().any(|end| stopped(end.map(|end| end.reason))) {
        trial.stop();
    } else if log.ends.iter().all(Option::is_some) {
        // This is the last observation, after which no robot got a command.
        trial.command(Some(&[]));
    }
    None
}

/// The components with what a robot has sensed.
type Sensed = (
    &'static TruePose,
    &'static Bumper,
    &'static RobotCondition,
    &'static WheelOdometry,
    &'static LaserScan,
    &'static mut Battery,
);

/// A trial that is being recorded.
type Recorded = (
    Entity,
    &'static mut MappingTrial,
    &'static SpawnedOrigin,
    &'static GlobalTransform,
    Option<&'static mut ScenarioRun>,
);

/// Stores what the robots have sensed in their trials.
pub(super) fn record(
    mut trials: Query<Recorded>,
    mut robots: Query<Sensed, With<TrialRobot>>,
    mut commands: Commands,
) {
    for (entity, mut trial, origin, transform, mut moving) in &mut trials {
        let MappingTrial { time, state, .. } = trial.bypass_change_detection();
        let warming = matches!(state, State::Warming(_));
        let (State::Warming(run) | State::Running(run)) = state else { continue };
        if run.trial.is_over() && !warming {
            continue;
        }
        if warming && run.robots.iter().any(|&robot| commands.get_entity(robot).is_err()) {
            // A robot was despawned before the trial has started, so the trial begins again.
            dismiss(&run.robots, &mut commands);
            *state = State::Waiting;
            continue;
        }
        let known = run
            .robots
            .iter()
            .all(|&robot| robots.get(robot).is_ok_and(|(_, _, _, _, scan, _)| scan.number > 0));
        if warming && !known {
            continue;
        }
        if !warming {
            run.trial.bodies_mut().tick();
        }
        let left = run.trial.bodies().battery();
        let to_world = transform.affine().as_daffine3().inverse();
        for (robot, &body) in run.robots.iter().enumerate() {
            let Ok((pose, bumper, condition, wheels, scan, mut battery)) = robots.get_mut(body)
            else {
                run.trial.bodies_mut().remove(robot);
                continue;
            };
            battery.left = left;
            let fresh = scan.number != run.scans[robot];
            run.scans[robot] = scan.number;
            let lost = *condition == RobotCondition::Drowned;
            let pose = in_world(pose, &to_world, origin.0);
            let report = TickReport {
                pose,
                condition: if lost { Condition::Drowned } else { Condition::Operational },
                collisions: bumper.collisions,
                person_collisions: bumper.person_collisions,
                touching: bumper.touching,
                odometry: wheels.last(),
                scan: fresh.then(|| Scan { ranges: scan.ranges.clone() }),
                water: fresh.then(|| run.camera.water(&run.trial.settings().body, pose)),
            };
            run.trial.bodies_mut().store(robot, report);
        }
        if let Some(moving) = &moving {
            run.trial.bodies_mut().store_scenario(moving.state());
        }
        if warming {
            if let Some(moving) = &mut moving {
                moving.set_paused(false);
            }
            if let State::Warming(run) = std::mem::replace(state, State::Waiting) {
                *state = State::Running(run);
            }
            trial.set_changed();
            commands.trigger(TrialStarted { entity });
        } else {
            run.trial.record();
            *time = run.trial.time();
        }
    }
}

/// Converts a pose from the frame of rapier's world to the frame of the environment's world.
pub(crate) fn in_world(pose: &TruePose, to_world: &bevy::math::DAffine3, origin: DVec2) -> Pose {
    let position = to_world.transform_point3(pose.position.extend(0.0)).truncate();
    let turn = to_world.matrix3.x_axis;
    let heading = pose.heading + libm::atan2(turn.y, turn.x);
    Pose { position: position + origin, heading: envgen::geometry::wrap_angle(heading) }
}

/// Despawns the robots of a trial when its environment loses its world. The trial begins again when there is
/// a world.
pub(super) fn lose_world(
    lost: On<Remove, GroundTruth>,
    mut trials: Query<&mut MappingTrial>,
    mut commands: Commands,
) {
    let Ok(mut trial) = trials.get_mut(lost.entity) else { return };
    dismiss(trial.robots(), &mut commands);
    if matches!(trial.state, State::Warming(_) | State::Running(_) | State::Over(_)) {
        trial.state = State::Waiting;
    }
}

/// Despawns the robots of a removed trial, and resumes the scenario that waited for it.
pub(super) fn leave(
    gone: On<Discard, MappingTrial>,
    trials: Query<&MappingTrial>,
    mut scenarios: Query<&mut ScenarioRun>,
    mut commands: Commands,
) {
    let Ok(trial) = trials.get(gone.entity) else { return };
    if let Ok(mut moving) = scenarios.get_mut(gone.entity) {
        if let State::Waiting | State::Warming(_) = &trial.state {
            moving.set_paused(false);
        }
        moving.bypass_change_detection().set_ignores_commands(false);
    }
    dismiss(trial.robots(), &mut commands);
}

/// Despawns robots in reverse order: rapier reuses the freed indices last in, first out, so that the next
/// robots get the same order, on which the last bits of results depend when robots touch each other.
fn dismiss(robots: &[Entity], commands: &mut Commands<'_, '_>) {
    for &robot in robots.iter().rev() {
        if let Ok(mut robot) = commands.get_entity(robot) {
            robot.try_despawn();
        }
    }
}
