//! The formats, each with a corpus and a function that reads a file and uses its contents.

use std::path::Path;
use std::sync::LazyLock;

use envgen::geometry::Pose;
use envgen::import::barn::read_path;
use envgen::import::ros_map::{RosDescription, RosMode, UnknownCells};
use envgen::import::{
    ImportedRaster, read_class_png, read_scenarios, read_world_generator_library,
    read_world_generator_project, reader,
};
use envgen::indoor::world_generator::HALLWAY;
use envgen::indoor::{Catalogue, IndoorSpec, room_from_ron};
use envgen::scenario::{Scenario, ScenarioState};
use envgen::{Blueprint, Seed, World, WorldKind, WorldSpec};
use mapping_trial::difficulty::levers::LeverDesign;
use mapping_trial::difficulty::{Anchors, AtlasDesign, Panel};
use mapping_trial::driver::{Driver, Hello, Limits};
use mapping_trial::experiment::Shard;
use mapping_trial::experiment::survey::{MAX_SURVEY_TRIALS, Survey, SurveyFolder};
use mapping_trial::map::OccupancyMap;
use mapping_trial::robot::Robot;
use mapping_trial::score::{TrajectoryPair, alignment};
use mapping_trial::trial::{Trial, TrialLog, TrialReport, TrialSettings};
use mapping_trial::tum;

use crate::corpus::{self, Corpus};
use crate::exercise;
use crate::script::script;

/// The largest amount of work of a spec that is generated. Specs of more work are only checked.
const MOST_WORK: f64 = 3e4;

/// The largest number of cells that a spec may draw in all its attempts to be generated. Drawing more takes
/// seconds, so such specs are only checked.
const MOST_DRAWN: f64 = 2e7;

/// The largest number of ticks of a log that is replayed. Longer logs are only read.
const MOST_TICKS: u64 = 400;

/// A format with a reader.
pub struct Format {
    /// The name of the format on the command line.
    pub name: &'static str,
    /// The extension of its files.
    pub ending: &'static str,
    /// The files from which mutations start.
    pub corpus: fn() -> Corpus,
    /// Reads a file and uses its contents. Returns whether it could be read.
    pub read: fn(&[u8]) -> bool,
}

macro_rules! formats {
    ($($name:ident $ending:literal $read:expr;)+) => {
        /// Every format.
        pub const FORMATS: &[Format] = &[$(Format {
            name: stringify!($name),
            ending: $ending,
            corpus: corpus::$name,
            read: $read,
        }),+];
    };
}

formats! {
    world_json "json" |file| world("a.json", file);
    world_ron "ron" |file| world("a.ron", file);
    spec_ron "ron" |file| text(file).is_some_and(|text| {
        WorldSpec::from_ron(text).is_ok_and(|spec| generated(&spec, file))
    });
    settings "txt" |file| text(file).is_some_and(|text| settings(text, file));
    room_ron "ron" |file| text(file).is_some_and(|text| room(text, file));
    asc "asc" |file| world("a.asc", file);
    map "map" |file| world("a.map", file);
    scen "scen" |mut file| read_scenarios(&mut file).is_ok();
    raster_json "json" |mut file| {
        ImportedRaster::read(Path::new("a.json"), &mut file).is_ok()
    };
    pgm "pgm" |file| grey_image(file);
    png "png" |file| {
        let image = grey_image(file);
        let mut rest = file;
        read_class_png(&mut rest).is_ok() | image
    };
    yaml "yaml" |file| text(file).is_some_and(|text| description(text, file));
    project_xml "xml" |file| project(file);
    library_xml "xml" |mut file| read_world_generator_library(&mut file).is_ok_and(|rooms| {
        let mut own = rooms.iter().filter(|room| room.name != HALLWAY);
        own.all(|room| room.to_design().validate().is_ok())
    });
    geojson "geojson" |file| world("a.geojson", file);
    house_json "json" |file| world("a.json", file);
    barn_world "world" |file| world("a.world", file);
    barn_grid "npy" |file| world("a.npy", file);
    barn_path "npy" |mut file| read_path(&mut file).is_ok();
    scenario_ron "ron" |file| text(file).is_some_and(scenario);
    tum "tum" |file| text(file).is_some_and(trajectory);
    survey_ron "ron" |file| text(file).is_some_and(survey);
    difficulty_ron "ron" |file| text(file).is_some_and(difficulty);
    survey_folder "txt" |file| survey_folder(file).is_some();
    report_json "json" |file| std::str::from_utf8(file).is_ok_and(|text| TrialReport::from_json(text).is_ok());
    driver "txt" |file| driver(file);
    robot_ron "ron" |file| text(file).is_some_and(|text| Robot::from_ron(text).is_ok());
    trial_log "json" |file| log(file);
}

/// Returns a file as text if it is UTF-8, as the command does for readers of text.
fn text(file: &[u8]) -> Option<&str> {
    std::str::from_utf8(file).ok()
}

fn world(name: &str, mut file: &[u8]) -> bool {
    let path = Path::new(name);
    let read = reader(path).and_then(|read| read(&mut file, path));
    read.is_ok_and(|world| used(&world, file))
}

fn used(world: &World, file: &[u8]) -> bool {
    exercise::world(world, file);
    true
}

fn generated(spec: &WorldSpec, file: &[u8]) -> bool {
    if spec.validate().is_err() {
        return false;
    }
    let drawn = match spec {
        WorldSpec::Cellular(field) => (field.rows * field.cols * field.attempts) as f64,
        _ => 0.0,
    };
    if spec.work() > MOST_WORK || drawn > MOST_DRAWN {
        return true;
    }
    if let Ok(plan) = spec.generate(Seed(1)) {
        let world = plan.to_world();
        assert_eq!(world.check(), Ok(()), "a generated world is whole");
        used(&world, file);
        if exercise::thorough(file) {
            plan.metrics();
        }
    }
    true
}

fn settings(text: &str, file: &[u8]) -> bool {
    let mut lines = text.lines();
    let Some(Ok(kind)) = lines.next().map(str::parse::<WorldKind>) else { return false };
    let mut spec = kind.default_spec();
    for line in lines {
        let Some((name, value)) = line.split_once('=') else { continue };
        // A rejected setting must change nothing.
        let _ = spec.set(name, value);
    }
    generated(&spec, file)
}

fn room(text: &str, file: &[u8]) -> bool {
    let Ok(design) = room_from_ron(text) else { return false };
    let large = design.width.saturating_mul(design.height) > 36;
    let Ok(catalogue) = Catalogue::new([design]) else { return false };
    if !large {
        let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
        generated(&IndoorSpec { catalogue: Some(catalogue), ..spec }.into(), file);
    }
    true
}

fn grey_image(file: &[u8]) -> bool {
    let mut read = false;
    for mode in [RosMode::Trinary, RosMode::Scale, RosMode::Raw] {
        let description = RosDescription {
            image: "a.pgm".to_owned(),
            resolution: 0.25,
            origin: [1.0, -2.0, 0.4],
            negate: false,
            occupied_thresh: 0.65,
            free_thresh: 0.196,
            mode,
        };
        if let Ok(map) = description.map(file) {
            read = true;
            let _ = OccupancyMap::from_ros_map(&map, Pose::new(1.0, -2.0, 0.7));
            let world = map.to_world(UnknownCells::Solid);
            if world.check().is_ok() {
                used(&world, file);
            }
        }
    }
    read
}

fn description(text: &str, file: &[u8]) -> bool {
    let Ok(description) = RosDescription::from_yaml(text) else { return false };
    for image in corpus::pgm() {
        for unknown in [UnknownCells::Solid, UnknownCells::Free] {
            let Ok(map) = description.map(&image) else { continue };
            let _ = OccupancyMap::from_ros_map(&map, Pose::default());
            let world = map.to_world(unknown);
            if world.check().is_ok() {
                used(&world, file);
            }
        }
    }
    true
}

fn project(mut file: &[u8]) -> bool {
    let bytes = file;
    let project = read_world_generator_project(&mut file, Catalogue::builtin(), &[]);
    project.is_ok_and(|project| {
        let world = project.plan.to_world();
        assert_eq!(world.check(), Ok(()), "the world of a project is whole");
        used(&world, bytes)
    })
}

/// The number of ticks of 0.1 s for which the doors, people and smoke of a scenario move.
const SCENARIO_TICKS: usize = 20;

fn scenario(text: &str) -> bool {
    static WORLD: LazyLock<World> = LazyLock::new(corpus::scenario_world);
    let Ok(scenario) = Scenario::from_ron(text) else { return false };
    let Ok(mut state) = ScenarioState::new(&WORLD, &scenario) else { return false };
    let _ = scenario.with_open_doors(&WORLD);
    let digest = state.digest();
    for _ in 0..SCENARIO_TICKS {
        if state.step(0.1, &[]).is_err() {
            break;
        }
    }
    let _ = (state.bodies(&WORLD), state.digest());
    assert!(state.restarted().digest() == digest, "a restarted scenario is as it was");
    true
}

fn trajectory(text: &str) -> bool {
    let Ok(poses) = tum::read(text) else { return false };
    let times = poses.iter().map(|pose| pose.time + 0.05);
    let pairs = poses.iter().zip(tum::at_times(&poses, times));
    let (truth, estimated): (Vec<_>, Vec<_>) =
        pairs.filter_map(|(pose, at)| Some((pose.pose, at?))).unzip();
    let _ = alignment(&TrajectoryPair { truth: &truth, estimated: &estimated });
    let _ = tum::write(poses.iter().copied(), &mut std::io::sink());
    true
}

/// The largest number of worlds of a family that is listed. Larger families are only checked.
const MOST_MAPS: u64 = 10_000;

fn survey(text: &str) -> bool {
    Survey::from_ron(text).is_ok_and(|survey| listed(&survey))
}

fn listed(survey: &Survey) -> bool {
    if survey.validate().is_ok() && survey.trials() < MOST_MAPS {
        let _ = survey.maps().count();
    }
    true
}

fn difficulty(text: &str) -> bool {
    let panel = Panel::reference();
    if let Ok(mut panel) = Panel::from_ron(text) {
        panel.drop_repeated();
        return true;
    }
    if let Ok(anchors) = Anchors::from_ron(text) {
        let _ = anchors.scale(&panel, &[]);
        return listed(&anchors.survey(&panel, 2));
    }
    if let Ok(levers) = LeverDesign::from_ron(text) {
        return levers.survey().is_ok_and(|survey| listed(&survey));
    }
    let Ok(design) = AtlasDesign::from_ron(text) else { return false };
    let maps: u64 = match &design {
        AtlasDesign::Indoor { sizes, .. } => sizes.iter().map(|size| u64::from(size.maps)).sum(),
        AtlasDesign::Drawn { maps, .. } => u64::from(*maps),
    };
    // More than a survey may have are rejected at once. Fewer are all drawn.
    let is_quick = maps <= MOST_MAPS || maps > MAX_SURVEY_TRIALS;
    !is_quick || design.survey(&panel).is_ok_and(|survey| listed(&survey))
}

/// Creates a folder with two files, or returns `None` if they cannot be written.
fn folder(file: &[u8], names: [&str; 2]) -> Option<tempfile::TempDir> {
    let folder = tempfile::tempdir().ok()?;
    let end = file.windows(2).position(|pair| pair == b"\n\n").unwrap_or(file.len());
    let (head, lines) = file.split_at(end);
    std::fs::write(folder.path().join(names[0]), head).ok()?;
    std::fs::write(folder.path().join(names[1]), lines.get(2..).unwrap_or_default()).ok()?;
    Some(folder)
}

fn survey_folder(file: &[u8]) -> Option<()> {
    static SURVEY: LazyLock<Option<Survey>> = LazyLock::new(corpus::short_survey);
    let folder = folder(file, corpus::SURVEY_FILES)?;
    SurveyFolder::open(folder.path(), SURVEY.as_ref()?, Shard::WHOLE).ok().map(drop)
}

/// Runs a trial with a driver that writes the lines of the file, whatever it is sent. Returns whether its
/// hello is accepted.
fn driver(file: &[u8]) -> bool {
    static WORLD: LazyLock<World> = LazyLock::new(corpus::scenario_world);
    let settings = TrialSettings { time_limit: 1.0, ..Default::default() };
    let (input, output) = script(file);
    let driver = Driver::connect(input, output, Limits::default());
    let mut builder = Trial::builder(&WORLD, settings);
    let Ok(setup) = builder.setup() else { return false };
    let is_greeted = driver.greet(&Hello::new(&setup)).is_some();
    let Ok(mut trial) = builder.parts(driver.parts()).build_flat() else { return false };
    while trial.step() {}
    driver.end(None);
    let _ = driver.failure();
    is_greeted
}

fn log(mut file: &[u8]) -> bool {
    let Ok(log) = TrialLog::read(&mut file) else { return false };
    if log.ticks() <= MOST_TICKS {
        let _ = log.replay();
    }
    true
}
