//! Runs trials whose robots have cameras, in an app without a window.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy::asset::RenderAssetUsages;
use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy_envgen::visuals3d::{EnvgenVisuals3dPlugin, Visuals3dSettings};
use bevy_offscreen::{CaptureError, CapturedImage, Film, Studio};
use envgen::scenario::Scenario;
use mapping_trial::trial::{Trial, TrialLog, TrialParts, TrialSettings};
use thiserror::Error;

use super::files::CameraFolder;
use super::frame::CameraFrame;
use super::optics::CameraOptics;
use super::plugin::RobotCameraPlugin;
use super::settings::{CameraError, CameraImages, RobotCamera};
use super::shutter::{CameraFailed, CameraFrameTaken, Exposure};
use crate::trial::{HeadlessError, MappingTrial, RapierRobots, TrialRobot, drive, set_up};
use crate::view3d::RobotVisuals3dPlugin;

/// What to record of a trial, and in which folder.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraRecording {
    /// The camera of each robot.
    pub camera: RobotCamera,
    /// The folder of the pictures. If there are several robots, each has its own folder `robot_1`, `robot_2`
    /// and so on in it.
    pub folder: PathBuf,
}

/// An error that prevents the recording of a trial.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The trial cannot run.
    #[error(transparent)]
    Trial(#[from] HeadlessError),
    /// The camera cannot take pictures.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The machine cannot draw, or the film cannot be written.
    #[error(transparent)]
    Drawing(#[from] CaptureError),
    /// A file cannot be written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// The error of the file system.
        source: io::Error,
    },
}

/// A trial that is run with cameras.
///
/// ```no_run
/// use bevy_mapping_trial::camera::{CameraRecording, CameraTrial, RobotCamera};
/// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
/// use mapping_trial::trial::{TrialParts, TrialSettings};
///
/// let world = IndoorSpec::default().generate(Seed(7))?.to_world();
/// let settings = TrialSettings { start: world.start, ..Default::default() };
/// let trial = CameraTrial::new(&world, settings, TrialParts::default(), None);
/// let camera = RobotCamera { width: 640, height: 480, ..Default::default() };
/// let recording = CameraRecording { camera, folder: "out/frames".into() };
/// let (trial, files) = trial.record(&recording, |_| ())?;
/// println!("{} m, {files:?}", trial.trajectory(0).distance);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct CameraTrial<'a> {
    world: &'a envgen::World,
    robots: u32,
    trial: MappingTrial,
    scenario: Option<Scenario>,
}

impl<'a> CameraTrial<'a> {
    /// Creates a trial like that of [`run_headless_with`](crate::trial::run_headless_with).
    pub fn new(
        world: &'a envgen::World,
        settings: TrialSettings,
        parts: TrialParts,
        scenario: Option<Scenario>,
    ) -> Self {
        let robots = settings.robots;
        let trial = MappingTrial::new(settings).with_parts(parts);
        CameraTrial { world, robots, trial, scenario }
    }

    /// Creates the replay of a log like that of [`replay_headless_with`](crate::trial::replay_headless_with).
    pub fn replay(world: &'a envgen::World, log: TrialLog, parts: TrialParts) -> Self {
        let (robots, scenario) = (log.settings.robots, log.scenario.clone());
        let trial = MappingTrial::replay(log).with_parts(parts);
        CameraTrial { world, robots, trial, scenario }
    }

    /// Runs the trial, and writes what the robots see into folders. The trial is the same as without cameras,
    /// to the last bit. Returns the trial and the paths of the descriptions of the pictures.
    ///
    /// # Errors
    /// Returns the errors of [`CameraTrial::watch`], and an error if a file cannot be written. The pictures
    /// that were written before are kept.
    pub fn record(
        self,
        recording: &CameraRecording,
        progress: impl FnMut(f64),
    ) -> Result<(Trial<RapierRobots>, Vec<PathBuf>), RecordingError> {
        recording.camera.check()?;
        let folder = &recording.folder;
        let paths: Vec<PathBuf> = match self.robots {
            0 | 1 => vec![folder.clone()],
            robots => (1..=robots).map(|robot| folder.join(format!("robot_{robot}"))).collect(),
        };
        // Folders are created with the first picture, so that a trial that cannot begin does not remove an
        // earlier recording.
        let mut folders: Vec<Option<CameraFolder>> = paths.iter().map(|_| None).collect();
        let begin = |path: &PathBuf| {
            CameraFolder::create(path, recording.camera).map_err(|error| of_file(path, error))
        };
        let trial = self.watch(recording.camera, progress, |robot, frame| {
            let (Some(folder), Some(path)) = (folders.get_mut(robot), paths.get(robot)) else {
                return Ok(());
            };
            let folder = match folder {
                Some(folder) => folder,
                None => folder.insert(begin(path)?),
            };
            folder.push(frame).map_err(|error| of_file(path, error))
        });
        let mut files = Vec::new();
        for (folder, path) in folders.into_iter().zip(&paths) {
            let folder = match folder {
                None if trial.is_ok() => Some(begin(path)?),
                folder => folder,
            };
            if let Some(folder) = folder {
                files.push(folder.finish().map_err(|error| of_file(path, error))?);
            }
        }
        Ok((trial?, files))
    }

    /// Runs the trial, and writes what the first robot sees as an animated GIF with `frames_per_second` from
    /// 1 to 50. If this is equal to the rate of the camera, the film is as fast as the trial in simulated
    /// time.
    ///
    /// # Errors
    /// Returns the errors of [`CameraTrial::watch`], and an error if the frame rate is out of range, or if
    /// the file cannot be written.
    pub fn film(
        self,
        camera: RobotCamera,
        (path, frames_per_second): (&Path, f64),
        progress: impl FnMut(f64),
    ) -> Result<Trial<RapierRobots>, RecordingError> {
        let mut film = Film::create(path, frames_per_second)?;
        let images = CameraImages { color: true, depth: false, labels: false };
        let camera = RobotCamera { images, ..camera };
        let trial = self.watch(camera, progress, |robot, frame| match &frame.color {
            Some(color) if robot == 0 => {
                let picture = CapturedImage::of(&image(color, frame.optics))?;
                Ok(film.push(&picture)?)
            }
            _ => Ok(()),
        })?;
        film.finish()?;
        Ok(trial)
    }

    /// Runs the trial with this camera on each robot, drawn with ceilings. `see` is called with the number of
    /// the robot, counted from 0, and each picture in order; an error of it ends the trial. `progress` is
    /// called from time to time with the simulated seconds so far.
    ///
    /// # Errors
    /// Returns the errors of [`run_headless_with`](crate::trial::run_headless_with) or
    /// [`replay_headless_with`](crate::trial::replay_headless_with), the error of `see`, and an error if a
    /// setting of the camera is out of range, or if the machine cannot draw.
    pub fn watch(
        self,
        camera: RobotCamera,
        progress: impl FnMut(f64),
        mut see: impl FnMut(usize, &CameraFrame) -> Result<(), RecordingError>,
    ) -> Result<Trial<RapierRobots>, RecordingError> {
        camera.check()?;
        let mut app = app(camera)?;
        let mut error = None;
        let mut ticked = |app: &mut App| {
            let mut taken = app.world_mut().resource_mut::<Taken>();
            let failure = taken.failure.take();
            let mut result = failure.map_or(Ok(()), |failure| Err(failure.into()));
            for (robot, frame) in std::mem::take(&mut taken.frames) {
                result = result.and_then(|()| see(robot, &frame));
            }
            if let Err(failure) = result {
                error.get_or_insert(failure);
                let mut trials = app.world_mut().query::<&mut MappingTrial>();
                trials.iter_mut(app.world_mut()).for_each(|mut trial| trial.stop());
            }
        };
        let CameraTrial { world, trial, scenario, .. } = self;
        let trial = drive(&mut app, world.clone(), trial, scenario, progress, &mut ticked);
        // The last colour images arrive after the end of the trial.
        let mut exposures = app.world_mut().query::<&Exposure>();
        while exposures.iter(app.world()).next().is_some() {
            app.update();
            ticked(&mut app);
        }
        match error {
            Some(error) => Err(error),
            None => Ok(trial?),
        }
    }
}

/// A resource with the pictures since the last tick, each with the number of its robot.
#[derive(Resource, Default)]
struct Taken {
    /// The numbers of robots, including robots that no longer exist when their last picture arrives.
    robots: EntityHashMap<usize>,
    frames: Vec<(usize, Arc<CameraFrame>)>,
    failure: Option<CameraError>,
}

fn of_file(path: &Path, source: io::Error) -> RecordingError {
    RecordingError::File { path: path.to_owned(), source }
}

/// Converts colours to an image of Bevy.
fn image(color: &[u8], optics: CameraOptics) -> Image {
    let pixels = color.as_chunks::<3>().0.iter();
    let size = Extent3d { width: optics.width, height: optics.height, depth_or_array_layers: 1 };
    Image::new(
        size,
        TextureDimension::D2,
        pixels.flat_map(|[red, green, blue]| [*red, *green, *blue, u8::MAX]).collect(),
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::MAIN_WORLD,
    )
}

/// Creates an app that draws, in which each update is a tick, and in which the robots of trials have cameras.
fn app(camera: RobotCamera) -> Result<App, CaptureError> {
    let mut app = std::mem::replace(Studio::new()?.app(), App::empty());
    // The robots are indoors.
    let visuals = Visuals3dSettings { ceilings: true, ..default() };
    if camera.images.color {
        app.add_plugins((EnvgenVisuals3dPlugin::new(visuals), RobotVisuals3dPlugin));
    }
    app.insert_resource(visuals).init_resource::<Taken>().add_plugins(RobotCameraPlugin);
    app.add_observer(
        move |added: On<Add, TrialRobot>,
              robots: Query<&TrialRobot>,
              mut all: ResMut<Taken>,
              mut commands: Commands| {
            let robot = added.entity;
            if let Ok(TrialRobot { index }) = robots.get(robot) {
                all.robots.insert(robot, *index);
                commands.entity(robot).insert(camera);
            }
        },
    );
    app.add_observer(|taken: On<CameraFrameTaken>, mut all: ResMut<Taken>| {
        if let Some(&index) = all.robots.get(&taken.entity) {
            all.frames.push((index, taken.frame.clone()));
        }
    });
    app.add_observer(|failed: On<CameraFailed>, mut all: ResMut<Taken>| {
        all.failure.get_or_insert(failed.error.clone());
    });
    set_up(&mut app);
    Ok(app)
}
