//! Trials whose robots' pictures are written, in an app without a window.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use bevy::prelude::*;
use bevy_envgen::visuals3d::{EnvgenVisuals3dPlugin, Visuals3dSettings};
use bevy_offscreen::{CaptureError, Studio};
use envgen::scenario::Scenario;
use mapping_trial::trial::{Trial, TrialLog, TrialParts, TrialSettings};
use thiserror::Error;

use super::files::CameraFolder;
use super::settings::{CameraError, RobotCamera};
use super::shutter::{CameraFailed, CameraFrameTaken, Exposure};
use super::RobotCameraPlugin;
use crate::trial::{HeadlessError, MappingTrial, RapierRobots, TrialRobot, drive, set_up};

/// What to record of a trial, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraRecording {
    /// The camera of each robot.
    pub camera: RobotCamera,
    /// The folder for the pictures; of several robots each has a folder `robot_1`, `robot_2` and so on in it.
    pub folder: PathBuf,
}

/// Why a trial cannot be recorded.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The trial cannot be run.
    #[error(transparent)]
    Trial(#[from] HeadlessError),
    /// The camera takes no pictures.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The machine cannot draw.
    #[error(transparent)]
    Drawing(#[from] CaptureError),
    /// A file cannot be written.
    #[error("{}: {source}", path.display())]
    File {
        /// The folder.
        path: PathBuf,
        /// The error of the file system.
        source: io::Error,
    },
}

/// As [`run_headless_with`](crate::trial::run_headless_with), and writes what the robots see. The trial is the same to
/// the last bit. Also returns the descriptions of the pictures that were written.
///
/// # Errors
/// As [`run_headless_with`](crate::trial::run_headless_with); a camera that is out of range, a machine that cannot
/// draw, files that cannot be written. The pictures until then are kept.
pub fn record_headless(
    world: &envgen::World,
    settings: TrialSettings,
    parts: TrialParts,
    scenario: Option<Scenario>,
    recording: &CameraRecording,
    progress: impl FnMut(f64),
) -> Result<(Trial<RapierRobots>, Vec<PathBuf>), RecordingError> {
    let robots = settings.robots;
    let trial = MappingTrial::new(settings).with_parts(parts);
    record(world, trial, scenario, (recording, robots), progress)
}

/// As [`replay_headless_with`](crate::trial::replay_headless_with), and writes what the robots see.
///
/// # Errors
/// As [`record_headless`]; a world or an engine that is not the log's.
pub fn record_replay(
    world: &envgen::World,
    log: TrialLog,
    parts: TrialParts,
    recording: &CameraRecording,
    progress: impl FnMut(f64),
) -> Result<(Trial<RapierRobots>, Vec<PathBuf>), RecordingError> {
    let (robots, scenario) = (log.settings.robots, log.scenario.clone());
    let trial = MappingTrial::replay(log).with_parts(parts);
    record(world, trial, scenario, (recording, robots), progress)
}

/// The folders, and the first error.
struct Recorder {
    folders: Vec<CameraFolder>,
    paths: Vec<PathBuf>,
    error: Option<RecordingError>,
}

impl Recorder {
    fn new(recording: &CameraRecording, robots: u32) -> Result<Self, RecordingError> {
        recording.camera.check()?;
        let folder = &recording.folder;
        let paths: Vec<PathBuf> = match robots {
            0 | 1 => vec![folder.clone()],
            _ => (1..=robots).map(|robot| folder.join(format!("robot_{robot}"))).collect(),
        };
        let begin = |path: &PathBuf| {
            CameraFolder::create(path, recording.camera).map_err(|error| of_file(path, error))
        };
        let folders = paths.iter().map(begin).collect::<Result<_, _>>()?;
        Ok(Recorder { folders, paths, error: None })
    }

    /// Keeps the first error, and ends the trial.
    fn fail(&mut self, error: RecordingError, mut trials: Query<&mut MappingTrial>) {
        self.error.get_or_insert(error);
        for mut trial in &mut trials {
            trial.stop();
        }
    }
}

fn of_file(path: &Path, source: io::Error) -> RecordingError {
    RecordingError::File { path: path.to_owned(), source }
}

fn record(
    world: &envgen::World,
    trial: MappingTrial,
    scenario: Option<Scenario>,
    (recording, robots): (&CameraRecording, u32),
    progress: impl FnMut(f64),
) -> Result<(Trial<RapierRobots>, Vec<PathBuf>), RecordingError> {
    let recorder = Arc::new(Mutex::new(Recorder::new(recording, robots)?));
    let mut app = std::mem::replace(Studio::new()?.app(), App::empty());
    let camera = recording.camera;
    // Robots are inside.
    let visuals = Visuals3dSettings { ceilings: true, ..default() };
    if camera.images.color {
        app.add_plugins(EnvgenVisuals3dPlugin::new(visuals));
    }
    app.insert_resource(visuals).add_plugins(RobotCameraPlugin);
    app.add_observer(move |robot: On<Add, TrialRobot>, mut commands: Commands| {
        commands.entity(robot.entity).insert(camera);
    });
    let writer = recorder.clone();
    app.add_observer(
        move |taken: On<CameraFrameTaken>, robots: Query<&TrialRobot>, trials: Query<&mut MappingTrial>| {
            let mut recorder = writer.lock().unwrap_or_else(PoisonError::into_inner);
            let Ok(TrialRobot { index }) = robots.get(taken.entity) else { return };
            let Some(folder) = recorder.folders.get_mut(*index) else { return };
            if let Err(error) = folder.push(&taken.frame) {
                let error = of_file(&recorder.paths[*index], error);
                recorder.fail(error, trials);
            }
        },
    );
    let writer = recorder.clone();
    app.add_observer(move |failed: On<CameraFailed>, trials: Query<&mut MappingTrial>| {
        let mut recorder = writer.lock().unwrap_or_else(PoisonError::into_inner);
        recorder.fail(failed.error.clone().into(), trials);
    });
    set_up(&mut app);
    let trial = drive(&mut app, world.clone(), trial, scenario, progress);
    // The last colours arrive after the trial.
    while app.world_mut().query::<&Exposure>().iter(app.world()).next().is_some() {
        app.update();
    }
    drop(app);
    let mut recorder = recorder.lock().unwrap_or_else(PoisonError::into_inner);
    let mut files = Vec::new();
    for (folder, path) in std::mem::take(&mut recorder.folders).into_iter().zip(&recorder.paths) {
        files.push(folder.finish().map_err(|error| of_file(path, error))?);
    }
    match recorder.error.take() {
        Some(error) => Err(error),
        None => Ok((trial?, files)),
    }
}
