//! The command line.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy_mapping_trial::ui::{ScenarioForm, SpecForm};
use clap::Parser;
use envgen::indoor::{IndoorSpec, Profile};
use envgen::located::Locate;
use envgen::scenario::ScenarioSpec;
use envgen::{Seed, World, WorldSpec, import};
use mapping_trial::lidar::LaserProfile;
use mapping_trial::names::Named;
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::policy::PolicyKind;
use mapping_trial::robot::Robot;
use mapping_trial::slam::SlamKind;
use mapping_trial::trial::TrialSettings;

use crate::robot;

/// Side of the indoor map in grid units: about the size that one robot explores in 20 minutes.
const SIZE: u32 = 10;

/// The most robots of a trial.
pub(crate) const MAX_ROBOTS: u32 = 4;

/// Drive a simulated robot through a world that you do not know, and see how well you map it.
#[derive(Parser, Clone)]
#[expect(clippy::doc_markdown, reason = "these texts are for the terminal, not Markdown")]
pub(crate) struct Arguments {
    /// Difficulty of the indoor map as trials measure it, from 0 to 10.
    #[arg(long, default_value_t = 5.0, conflicts_with = "world")]
    difficulty: f64,

    /// The seed of the world and of the sensor noise.
    #[arg(long, default_value_t = Seed(0), allow_negative_numbers = true)]
    pub(crate) seed: Seed,

    /// A world file in any format that `envgen convert` reads, or a spec (.envgen.ron) for any kind of world.
    #[arg(long, value_name = "FILE")]
    world: Option<PathBuf>,

    /// Number of robots, which share one map; Tab switches between them.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_ROBOTS)))]
    robots: u32,

    /// Watch a program drive: nearest, info_gain, cautious, wall_follow or corridors.
    #[arg(long = "policy", alias = "operator", value_parser = PolicyKind::named)]
    pub(crate) policy: Option<PolicyKind>,

    /// How poses and map are estimated: scan_to_map, pose_graph or dead_reckoning.
    #[arg(long, default_value = "scan_to_map", value_parser = SlamKind::named)]
    slam: SlamKind,

    /// A robot file in RON, such as `(length: 0.4, width: 0.4)` [default: the Pioneer 3-AT].
    #[arg(long, value_name = "FILE.ron")]
    robot: Option<PathBuf>,

    /// Resolution and noise of the laser: lms200_mm, lms200_mm_rough, usarsim, urg_04lx or wide_12m.
    #[arg(long, default_value = "lms200_mm", value_parser = LaserProfile::named)]
    laser: LaserProfile,

    /// Noise of the wheel odometry: skid, mild, poor or exact.
    #[arg(long, default_value = "skid", value_parser = OdometryProfile::named)]
    odometry: OdometryProfile,

    /// Simulated seconds after which the trial ends.
    #[arg(long, default_value_t = 1200.0)]
    time_limit: f64,

    /// Sets what moves in the world, such as doors=0.5, people=4 or smoke=0.2; may be given several times.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    scenario: Vec<String>,

    /// Show the true world from the start, for training.
    #[arg(long)]
    pub(crate) training: bool,

    /// Draw no pictures of the robots' cameras, for slow machines.
    #[arg(long)]
    no_camera: bool,

    /// Rows of the picture of a robot's camera: more look better and take longer [default: 720, or 240 without a
    /// graphics card].
    #[arg(long, value_name = "ROWS", conflicts_with = "no_camera", value_parser = clap::value_parser!(u32).range(60..=2160))]
    pub(crate) camera_rows: Option<u32>,

    /// The folder to write into.
    #[arg(long, default_value = "out/teleop", value_name = "FOLDER")]
    pub(crate) out: PathBuf,

    /// Write the duration of every frame and the number of ticks so far as CSV.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) frame_log: Option<PathBuf>,
}

/// What the window starts with: a spec, or a world from a file.
pub(crate) enum Beginning {
    Spec(Box<WorldSpec>),
    World(Arc<World>),
}

impl Arguments {
    /// The world or spec to start with.
    pub(crate) fn beginning(&self) -> Result<Beginning, Box<dyn Error>> {
        let Some(path) = &self.world else {
            let (width, height) = (SIZE, SIZE);
            let (difficulty, profile) = (self.difficulty, Profile::Calibrated);
            let spec = IndoorSpec { difficulty, width, height, profile, ..Default::default() };
            // Also refuses a difficulty that maps of this size do not reach.
            let (spec, _) = SpecForm::new(&spec.into(), self.seed).request()?;
            return Ok(Beginning::Spec(Box::new(spec)));
        };
        if path.to_string_lossy().ends_with(".envgen.ron") {
            let text = std::fs::read_to_string(path).in_file(path)?;
            let spec = WorldSpec::from_ron(&text).in_file(path)?;
            spec.validate().in_file(path)?;
            return Ok(Beginning::Spec(Box::new(spec)));
        }
        let world = import::read_world(path).in_file(path)?;
        Ok(Beginning::World(Arc::new(world)))
    }

    /// Whether the robots' cameras are drawn.
    pub(crate) fn has_cameras(&self) -> bool {
        !self.no_camera
    }

    /// What the robot is called: as its file is.
    pub(crate) fn robot_name(&self) -> String {
        let file = self.robot.as_deref().and_then(Path::file_stem);
        file.map_or_else(|| "Pioneer 3-AT".to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// What moves in the world at first.
    pub(crate) fn scenario(&self) -> Result<ScenarioForm, Box<dyn Error>> {
        let mut spec = ScenarioSpec::default();
        for setting in &self.scenario {
            let (name, value) = setting
                .split_once('=')
                .ok_or_else(|| format!("--set {setting}: not of the form NAME=VALUE"))?;
            spec.set(name, value).map_err(|error| format!("--set {setting}: {error}"))?;
        }
        Ok(ScenarioForm::new(&spec))
    }

    /// The initial settings of trials.
    pub(crate) fn settings(&self) -> Result<TrialSettings, Box<dyn Error>> {
        let settings = TrialSettings {
            body: self.robot.as_deref().map_or(Ok(Robot::default()), robot::read)?,
            seed: self.seed,
            policy: self.policy,
            slam: self.slam,
            robots: self.robots,
            time_limit: self.time_limit,
            laser: self.laser.clone(),
            odometry: self.odometry.clone(),
            ..TrialSettings::default()
        };
        settings.validate()?;
        Ok(settings)
    }
}
