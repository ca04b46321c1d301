//! The command line.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy_mapping_trial::ui::{ScenarioForm, SpecForm};
use clap::Parser;
use envgen::indoor::{IndoorSpec, Profile};
use envgen::located::Locate;
use envgen::{Seed, World, WorldSpec, import};
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::policy::PolicyKind;
use mapping_trial::profile::named_or_read;
use mapping_trial::robot::Robot;
use mapping_trial::trial::{MAX_ROBOTS, TrialSettings};

use crate::trial_arguments::{TrialArguments, name, named, profile_help};
use crate::{moving, robot, spec_file};

/// Side of the indoor map in grid units, which is about the size that one robot explores in 20 minutes.
const SIZE: u32 = 10;

/// Drive a simulated robot through a world that you do not know, and see how well you map it.
#[derive(Parser, Clone)]
pub(crate) struct Arguments {
    /// Difficulty of the indoor map as trials measure it, from 0 to 10.
    #[arg(long, default_value_t = 5.0, conflicts_with = "world")]
    difficulty: f64,

    /// The seed of the world and of the sensor noise.
    #[arg(long, default_value_t = Seed(0), allow_negative_numbers = true)]
    pub(crate) seed: Seed,

    /// A world file in any format that `envgen convert` reads, or a spec (.ron) for any kind of world.
    #[arg(long, value_name = "FILE")]
    world: Option<PathBuf>,

    /// The person knows the world of the file, for example from the editor, so that trials in it count as training.
    #[arg(long, hide = true, requires = "world")]
    pub(crate) known: bool,

    /// Number of robots, which share one map; Tab switches between them.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_ROBOTS)))]
    robots: u32,

    /// Watch a policy drive.
    #[arg(long, alias = "operator", value_parser = named::<PolicyKind>())]
    pub(crate) policy: Option<PolicyKind>,

    #[command(flatten)]
    trial: TrialArguments,

    /// A robot file in RON, such as `(length: 0.4, width: 0.4)` [default: the Pioneer 3-AT].
    #[arg(long, value_name = "FILE.ron")]
    robot: Option<PathBuf>,

    #[arg(long, help = profile_help::<OdometryProfile>("wheels' odometry"), value_name = "NAME|FILE.ron",
          value_parser = named_or_read::<OdometryProfile>, default_value = name(|settings| &settings.odometry))]
    odometry: OdometryProfile,

    /// Add doors, people or smoke to the world, such as doors=0.5, people=4 or smoke=0.2; may be given several times.
    /// `envgen kinds` lists the settings.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    scenario: Vec<String>,

    /// Show the true world from the start, for training.
    #[arg(long)]
    pub(crate) training: bool,

    /// Draw no pictures of the robots' cameras, for slow machines.
    #[arg(long)]
    no_camera: bool,

    /// Height of the pictures of the robots' cameras in pixels: a higher picture is sharper and takes longer [default:
    /// 720, or 240 without a graphics card].
    #[arg(long, value_name = "ROWS", conflicts_with = "no_camera", value_parser = clap::value_parser!(u32).range(60..=2160))]
    pub(crate) camera_rows: Option<u32>,

    /// The folder to write into.
    #[arg(long, default_value = "out/teleop", value_name = "FOLDER")]
    pub(crate) out: PathBuf,

    /// Write the duration of every frame and the number of ticks so far as CSV.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) frame_log: Option<PathBuf>,
}

/// The initial content of the window: a spec, or a world from a file.
pub(crate) enum Beginning {
    Spec(Box<WorldSpec>),
    World(Arc<World>),
}

impl Arguments {
    /// Returns the world or spec to start with.
    pub(crate) fn beginning(&self) -> Result<Beginning, Box<dyn Error>> {
        let Some(path) = &self.world else {
            let (width, height) = (SIZE, SIZE);
            let (difficulty, profile) = (self.difficulty, Profile::Calibrated);
            let spec = IndoorSpec { difficulty, width, height, profile, ..Default::default() };
            // This also rejects a difficulty that maps of this size do not reach.
            let (spec, _) = SpecForm::new(&spec.into(), self.seed).request()?;
            return Ok(Beginning::Spec(Box::new(spec)));
        };
        if let Some(spec) = spec_file::read(path)? {
            spec.validate().in_file(path)?;
            return Ok(Beginning::Spec(Box::new(spec)));
        }
        let world = import::read_world(path).in_file(path)?;
        Ok(Beginning::World(Arc::new(world)))
    }

    /// Returns the files that are read.
    pub(crate) fn inputs(&self) -> Vec<PathBuf> {
        let world = self.world.iter().flat_map(|path| import::input_files(path));
        world.chain(self.robot.clone()).collect()
    }

    /// Returns the name of the world's file.
    pub(crate) fn world_name(&self) -> String {
        let file = self.world.as_deref().and_then(Path::file_name);
        file.unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Returns whether the robots' cameras are drawn.
    pub(crate) fn has_cameras(&self) -> bool {
        !self.no_camera
    }

    /// Returns the name of the robot, which is that of its file.
    pub(crate) fn robot_name(&self) -> String {
        let file = self.robot.as_deref().and_then(Path::file_stem);
        file.map_or_else(|| "Pioneer 3-AT".to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// Returns what moves in the world at first.
    pub(crate) fn scenario(&self) -> Result<ScenarioForm, Box<dyn Error>> {
        Ok(ScenarioForm::new(&moving::spec(&self.scenario)?))
    }

    /// Returns the initial settings of trials.
    pub(crate) fn settings(&self) -> Result<TrialSettings, Box<dyn Error>> {
        let settings = TrialSettings {
            body: self.robot.as_deref().map_or(Ok(Robot::default()), robot::read)?,
            seed: self.seed,
            policy: self.policy,
            slam: self.trial.slam,
            wheel_calibration: self.trial.wheel_calibration,
            robots: self.robots,
            time_limit: self.trial.time_limit,
            time_per_area: self.trial.time_per_area,
            laser: self.trial.laser.clone(),
            odometry: self.odometry.clone(),
            start: None,
        };
        settings.validate()?;
        Ok(settings)
    }
}
