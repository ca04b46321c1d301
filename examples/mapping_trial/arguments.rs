//! The command line.

use std::error::Error;
use std::path::{Path, PathBuf};

use clap::Parser;
use envgen::geometry::Pose;
use envgen::indoor::{IndoorSpec, Profile};
use envgen::located::Locate;
use envgen::scenario::{Scenario, ScenarioState};
use envgen::text_file;
use envgen::whole_file::{WholeFile, refuse_inputs};
use envgen::{Blueprint, Seed, Spec, World, import};
use mapping_trial::mappable_area::MappableArea;
use mapping_trial::names::Named;
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::policy::PolicyKind;
use mapping_trial::profile::named_or_read;
use mapping_trial::robot::Robot;
use mapping_trial::trial::TrialSettings;

use crate::bag::Bag;
use crate::trial_arguments::{TrialArguments, help, name, named, profile_help};
use crate::{moving, output, robot, spec_file, start, start_argument};

/// Greatest value of `--size`: 192 grid units are 576 m, and a wall.
const MAX_SIZE: i64 = 192;

/// Drive a simulated robot through a world that it does not know, and score the map that it makes.
#[derive(Parser)]
#[command(allow_negative_numbers = true)]
#[expect(clippy::doc_markdown, reason = "help texts are not Markdown")]
pub(crate) struct Arguments {
    /// Difficulty of the indoor map for the rules of Zwennes (2011), from 0 to 10. It is not what trials measure: `envgen
    /// generate indoor --set profile=calibrated` writes maps of a measured difficulty, for `--world`.
    #[arg(long, default_value_t = 5.0, conflicts_with_all = ["world", "map", "replay"])]
    difficulty: f64,

    /// The rules of Zwennes (2011) exactly, or with the guarantee that every cell is reachable.
    #[arg(long, default_value = "guaranteed", value_parser = ["thesis", "guaranteed"],
          conflicts_with_all = ["world", "map", "replay"])]
    profile: String,

    /// Side of the indoor map in cells of 3 m. In 20 minutes, one robot explores a map of 10 x 10 cells, and half
    /// of one of 16 x 16.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(4..=MAX_SIZE),
          allow_negative_numbers = true, conflicts_with_all = ["world", "map", "replay"])]
    size: u32,

    /// The seed of the world and of the sensor noise.
    #[arg(long, default_value_t = Seed(0), allow_negative_numbers = true, conflicts_with = "replay")]
    seed: Seed,

    /// The seed of the sensor noise [default: the seed of the world].
    #[arg(long, allow_negative_numbers = true, conflicts_with = "replay")]
    noise_seed: Option<Seed>,

    /// A world file in any format that `envgen convert` reads, or a spec (.ron) for any kind of world.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["map", "replay"])]
    world: Option<PathBuf>,

    /// A ROS map, as map_server of Nav2 reads it.
    #[arg(long, value_name = "FILE.yaml", conflicts_with = "replay")]
    map: Option<PathBuf>,

    /// The policy that decides where to go.
    #[arg(long, alias = "operator", value_parser = named::<PolicyKind>(),
          default_value = PolicyKind::Nearest.name(), conflicts_with = "replay")]
    policy: PolicyKind,

    /// A driver program with its arguments, in place of a policy; see docs/driver-protocol.md. - is the
    /// program that started this one, over standard input and output.
    #[arg(long, value_name = "PROGRAM", allow_hyphen_values = true,
          conflicts_with_all = ["policy", "replay"])]
    pub(crate) driver: Option<String>,

    /// Seconds per answer of the driver.
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, requires = "driver")]
    pub(crate) driver_timeout: f64,

    /// Seconds for all answers of the driver together.
    #[arg(long, value_name = "SECONDS", default_value_t = 3600.0, requires = "driver")]
    pub(crate) driver_total: f64,

    #[command(flatten)]
    trial: TrialArguments,

    #[arg(long, help = help("robots"), default_value_t = TrialSettings::default().robots, conflicts_with = "replay")]
    robots: u32,

    /// A RON file with the robot, such as `(length: 0.4, width: 0.4)` [default: the Pioneer 3-AT].
    #[arg(long, value_name = "FILE.ron", conflicts_with = "replay")]
    robot: Option<PathBuf>,

    #[arg(long, help = profile_help::<OdometryProfile>("wheels' odometry"), value_name = "NAME|FILE.ron",
          value_parser = named_or_read::<OdometryProfile>, default_value = name(|settings| &settings.odometry),
          conflicts_with = "replay")]
    odometry: OdometryProfile,

    /// Where the first robot starts, in metres and degrees; a heading that is left out is 0 [default: the start of
    /// the world].
    #[arg(long, value_name = "X,Y,HEADING", value_parser = start_argument::start, allow_hyphen_values = true,
          conflicts_with = "replay")]
    start: Option<Pose>,

    /// The simulator: flat, which is fast and has robots as discs, or rapier, with rigid-body physics.
    #[arg(long, default_value = "flat", value_parser = ["flat", "rapier"], conflicts_with = "replay")]
    pub(crate) engine: String,

    /// Replay a trial from its log.json, in the simulator that made it.
    #[arg(long, value_name = "LOG",
          conflicts_with_all = ["slam", "wheel_calibration", "laser", "time_limit", "time_per_area"])]
    pub(crate) replay: Option<PathBuf>,

    /// Also write a bag for ROS 2, which Foxglove shows and `ros2 bag play` plays: this file, and in the same folder
    /// metadata.yaml, the world, and the true and the estimated trajectory. Give each bag a folder of its own.
    #[arg(long, value_name = "FILE.mcap")]
    log: Option<PathBuf>,

    /// Also write what the robots' cameras see, in the simulator rapier: colours, depths in millimetres, labels, and
    /// frames.json. See docs/guide/bevy.md. Needs a build with --features window.
    #[arg(long, value_name = "FOLDER")]
    pub(crate) camera: Option<PathBuf>,

    /// Pixels of the cameras.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "320x240", value_parser = pixels, requires = "camera")]
    pub(crate) camera_size: [u32; 2],

    /// Horizontal field of view of the cameras in degrees.
    #[arg(
        long,
        value_name = "DEGREES",
        default_value_t = 70.0,
        allow_negative_numbers = true,
        requires = "camera"
    )]
    pub(crate) camera_fov: f64,

    /// Pictures of each camera per simulated second.
    #[arg(
        long,
        value_name = "NUMBER",
        default_value_t = 2.0,
        allow_negative_numbers = true,
        requires = "camera"
    )]
    pub(crate) camera_rate: f64,

    /// Add doors, people or smoke to the world, such as doors=0.5, people=4 or smoke=0.2; may be given several times.
    /// `envgen kinds` lists the settings.
    #[arg(long = "set", value_name = "NAME=VALUE", conflicts_with = "replay")]
    settings: Vec<String>,

    /// A scenario: a RON file of doors, people and smoke.
    #[arg(long, value_name = "FILE.ron", conflicts_with_all = ["settings", "replay"])]
    scenario: Option<PathBuf>,

    /// The seed of doors, people and smoke [default: the seed of the world].
    #[arg(long, allow_negative_numbers = true, requires = "settings")]
    scenario_seed: Option<Seed>,

    /// Fill in the feedback form of Zwennes (2011) yourself. Otherwise measurements fill it in.
    #[arg(long)]
    pub(crate) form: bool,

    /// The folder to write into.
    #[arg(long, default_value = "out", value_name = "FOLDER")]
    pub(crate) out: PathBuf,
}

impl Arguments {
    /// Reads or generates the world to map.
    pub(crate) fn world(&self) -> Result<World, Box<dyn Error>> {
        if let Some(path) = self.map.as_deref().or(self.world.as_deref()) {
            let world = self.read(path)?;
            // A trial that cannot be scored is not run.
            MappableArea::check_size(&world).in_file(path)?;
            return Ok(world);
        }
        let profile = if self.profile == "thesis" { Profile::Thesis } else { Profile::Guaranteed };
        let IndoorSpec { width, height, .. } =
            IndoorSpec { width: self.size, height: self.size, ..Default::default() };
        let spec = IndoorSpec {
            difficulty: self.difficulty,
            profile,
            width,
            height,
            ..Default::default()
        };
        Ok(spec.generate(self.seed)?.to_world())
    }

    /// Returns what moves in the world; `None` if nothing does.
    #[expect(clippy::print_stderr, reason = "a note for the person at the terminal")]
    pub(crate) fn scenario(
        &self,
        world: &World,
        start: Option<Pose>,
    ) -> Result<Option<Scenario>, Box<dyn Error>> {
        if let Some(path) = &self.scenario {
            let text = text_file::read(path).in_file(path)?;
            let scenario = Scenario::from_ron(&text).in_file(path)?;
            ScenarioState::new(world, &scenario).in_file(path)?;
            if let Some(text) = scenario.note() {
                eprintln!("{}: {text}", path.display());
            }
            return Ok(Some(scenario));
        }
        let spec = moving::spec(&self.settings)?;
        if spec.is_still() {
            if let Some(setting) = self.settings.first() {
                eprintln!("--set {setting}: nothing moves without doors, people or smoke above 0");
            }
            return Ok(None);
        }
        // People keep off the place where the robots start.
        let mut at = world.clone();
        at.start = start.or(world.start);
        Ok(Some(Scenario::new(&at, &spec, self.scenario_seed.unwrap_or(self.seed))?))
    }

    /// Returns the files that are read.
    fn inputs(&self) -> Vec<PathBuf> {
        let worlds = [&self.world, &self.map].into_iter().flatten();
        let others = [&self.robot, &self.replay, &self.scenario].into_iter().flatten().cloned();
        worlds.flat_map(|path| import::input_files(path)).chain(others).collect()
    }

    /// Returns the bag for ROS 2 of a trial with a number of robots, which is begun before the trial; `None`
    /// if none is requested.
    pub(crate) fn bag(&self, robots: u32) -> Result<Option<Bag>, Box<dyn Error>> {
        self.log.as_deref().map(|path| Bag::begin(path, &self.inputs(), robots)).transpose()
    }

    /// Checks that every output file can be written, and that none is an input.
    pub(crate) fn check_outputs(&self) -> Result<(), Box<dyn Error>> {
        let inputs = self.inputs();
        for name in output::FILES {
            let path = self.out.join(name);
            refuse_inputs(&path, &inputs).in_file(&path)?;
            WholeFile::create(&path).in_file(&path)?;
        }
        Ok(())
    }

    #[expect(clippy::print_stderr, reason = "a warning for the person at the terminal")]
    fn read(&self, path: &Path) -> Result<World, Box<dyn Error>> {
        match spec_file::read(path)? {
            Some(spec) => Ok(spec.generate(self.seed).in_file(path)?.to_world()),
            None => {
                let world = import::read_world(path).in_file(path)?;
                if let Some(text) = import::ros_map::unknown_cells_warning(path) {
                    eprintln!("warning: {}: {text}", path.display());
                }
                Ok(world)
            }
        }
    }

    /// Returns the settings of the trial. If neither the arguments nor the world give a start, it is in
    /// the largest free region, away from walls.
    #[expect(clippy::print_stderr, reason = "a note for the person at the terminal")]
    pub(crate) fn settings(&self, world: &World) -> Result<TrialSettings, Box<dyn Error>> {
        let settings = TrialSettings {
            body: self.robot.as_deref().map_or(Ok(Robot::default()), robot::read)?,
            seed: self.noise_seed.unwrap_or(self.seed),
            policy: Some(self.policy),
            slam: self.trial.slam,
            wheel_calibration: self.trial.wheel_calibration,
            robots: self.robots,
            time_limit: self.trial.time_limit,
            time_per_area: self.trial.time_per_area,
            start: self.start,
            laser: self.trial.laser.clone(),
            odometry: self.odometry.clone(),
        };
        settings.validate()?;
        // A driver may have an estimator of its own.
        if let Some(text) = settings.slam.doubt(&settings.laser).filter(|_| self.driver.is_none()) {
            eprintln!("note: {text}");
        }
        start::with_start(world, settings)
    }
}

/// Parses a size such as `320x240`.
fn pixels(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(width, height)| {
        Some([width.trim().parse().ok()?, height.trim().parse().ok()?])
    });
    sides.ok_or_else(|| "not of the form WIDTHxHEIGHT with numbers of pixels".to_owned())
}
