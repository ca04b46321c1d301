//! `envgen inspect`.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::ops::Add;
use std::process::ExitCode;

use clap::Args;
use envgen::calibration::{Calibration, Dials, Prediction};
use envgen::certificate::{Claim, Verdict, verify_claims};
use envgen::difficulty::{DifficultyVector, Platform};
use envgen::geometry::{Pose, Rect};
use envgen::indoor::Profile;
use envgen::reproduction::{Reproduction, reproduce};
use envgen::world::{Extent, Surface};
use envgen::{Provenance, World, WorldMetrics, WorldSpec};
use serde::Serialize;
use serde_json::Value;

use crate::failure::Failure;
use crate::platform::PlatformOptions;
use crate::progress::{Steps, steps};
use crate::source::{WorldFile, note};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    file: WorldFile,

    /// Prints JSON.
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    platform: PlatformOptions,
}

/// What a world file holds.
#[derive(Serialize)]
struct Report<'a> {
    provenance: &'a Provenance,
    digest: String,
    /// Whether this crate generates the same world from the same spec and seed.
    reproducible: bool,
    bounds: Rect,
    start: Option<Pose>,
    goal: Option<Pose>,
    parts: Parts,
    /// Bottoms and tops in metres, by the kind of part.
    heights: BTreeMap<&'static str, Heights>,
    /// Absent where floors are plain and lasers see everything as far as they reach.
    #[serde(skip_serializing_if = "Materials::is_empty")]
    materials: Materials,
    certificate: Vec<Checked>,
    /// Absent when the world is no longer the one of its spec and seed.
    metrics: Option<WorldMetrics>,
    /// Absent when the robot does not fit at the start, or anywhere in a world without one.
    difficulty: Option<DifficultyVector>,
    /// The difficulty that trials are predicted to measure, for the usual robot; absent for kinds that are not
    /// calibrated.
    #[serde(skip_serializing_if = "Option::is_none")]
    predicted: Option<Prediction>,
    /// What the profile `calibrated` reaches at this size with the settings that are kept; absent for other
    /// profiles.
    #[serde(skip_serializing_if = "Option::is_none")]
    reachable: Option<Dials<[f64; 2]>>,
}

#[derive(Serialize)]
struct Parts {
    walls: usize,
    trees: usize,
    road_strips: usize,
    rooms: usize,
    doorways: usize,
    obstacles: usize,
    surfaces: usize,
    raster_cells: usize,
}

/// How high the parts of a list are.
#[derive(Serialize)]
struct Heights {
    /// The lowest bottom and the highest top in metres above the floor.
    from_to_m: [f64; 2],
    /// The lowest top: lasers that are higher do not see every part.
    lowest_top_m: f64,
}

impl Heights {
    /// Those of solids and doorways; lists without parts are absent.
    fn of(world: &World) -> BTreeMap<&'static str, Self> {
        let walls = world.walls.iter().map(|wall| wall.extent());
        let trees = world.trees.iter().map(|tree| tree.extent());
        let doorways = world.doorways.iter().map(|doorway| doorway.extent());
        let obstacles = world.obstacles.iter().map(|obstacle| obstacle.extent());
        let lists = [
            ("walls", walls.collect::<Vec<_>>()),
            ("trees", trees.collect()),
            ("doorways", doorways.collect()),
            ("obstacles", obstacles.collect()),
        ];
        let heights = lists.into_iter().filter_map(|(name, extents)| {
            let least = |of: fn(Extent) -> f64| extents.iter().map(|e| of(*e)).reduce(f64::min);
            let most = |of: fn(Extent) -> f64| extents.iter().map(|e| of(*e)).reduce(f64::max);
            let from_to_m = [least(Extent::bottom)?, most(Extent::top)?];
            Some((name, Heights { from_to_m, lowest_top_m: least(Extent::top)? }))
        });
        heights.collect()
    }
}

/// What is slippery, loose or dark in a world.
#[derive(Default, PartialEq, Serialize)]
struct Materials {
    /// Area on which wheel odometry has more variance than on a plain floor, in square metres, each
    /// surface for itself.
    noisy_floor_m2: f64,
    /// The greatest factor on its variances.
    max_odometry_noise: f64,
    /// Area on which wheels measure too far, in square metres.
    loose_m2: f64,
    /// The greatest fraction by which they do.
    max_wheel_bias: f64,
    /// Walls that lasers see only from near.
    dark_walls: usize,
    /// Their length, in metres.
    dark_walls_m: f64,
    /// Obstacles that lasers see only from near.
    dark_obstacles: usize,
    /// The least distance in metres from which lasers see a dark part; none where there is none.
    min_visible_range_m: Option<f64>,
}

impl Materials {
    fn of(world: &World) -> Self {
        let area = |of: fn(&Surface) -> bool| {
            world.surfaces.iter().filter(|s| of(s)).map(|s| s.shape.area()).fold(0.0, Add::add)
        };
        let most = |of: fn(&Surface) -> f64| world.surfaces.iter().map(of).fold(0.0, f64::max);
        let dark_walls = || world.walls.iter().filter(|wall| wall.visible_range.is_some());
        let dark_obstacles = || world.obstacles.iter().filter_map(|o| o.visible_range);
        let ranges = dark_walls().filter_map(|wall| wall.visible_range).chain(dark_obstacles());
        let noisy_floor_m2 = area(|surface| surface.odometry_noise > 1.0);
        Materials {
            noisy_floor_m2,
            max_odometry_noise: if noisy_floor_m2 > 0.0 { most(|s| s.odometry_noise) } else { 0.0 },
            loose_m2: area(|surface| surface.wheel_bias > 0.0),
            max_wheel_bias: most(|surface| surface.wheel_bias),
            dark_walls: dark_walls().count(),
            dark_walls_m: dark_walls().map(|wall| wall.length()).fold(0.0, Add::add),
            dark_obstacles: dark_obstacles().count(),
            min_visible_range_m: ranges.reduce(f64::min),
        }
    }

    fn is_empty(&self) -> bool {
        *self == Materials::default()
    }
}

#[derive(Serialize)]
struct Checked {
    claim: Claim,
    text: String,
    verdict: Verdict,
    /// Why it is undecided.
    #[serde(skip_serializing_if = "Option::is_none")]
    doubt: Option<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let platform = arguments.platform.read()?;
    let world = arguments.file.read()?;
    let working = steps(world.certificate.len() + 3);
    let report = report(&world, &platform, &working);
    drop(working);
    let mut out = io::stdout().lock();
    if arguments.json {
        serde_json::to_writer_pretty(&mut out, &report)?;
        writeln!(out)?;
    } else {
        let tree = serde_json::to_value(&report)?;
        print(&mut out, &tree, 0)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn report<'a>(world: &'a World, platform: &Platform, steps: &Steps) -> Report<'a> {
    steps.begin("the world of its spec and seed");
    let again = match reproduce(world) {
        Reproduction::Same(blueprint) => Some(blueprint.metrics()),
        _ => None,
    };
    steps.begin("features of its difficulty");
    let difficulty = DifficultyVector::of(world, platform);
    if let Err(error) = &difficulty {
        note(&format!("no difficulty: {error}"));
    }
    let checked = |(claim, verdict): (Claim, Verdict)| Checked {
        claim,
        text: claim.to_string(),
        verdict,
        doubt: verdict.doubt().map(|doubt| doubt.to_string()),
    };
    let certificate = world.certificate.iter().flat_map(|claim| {
        steps.begin(claim.to_string());
        verify_claims(world, &[*claim])
    });
    let certificate = certificate.map(checked).collect();
    steps.begin("its prediction");
    let predicted = predicted(world, platform, difficulty.as_ref().ok());
    if let Some(prediction) = predicted.filter(Prediction::is_extrapolated) {
        note(&format!(
            "{:.0} % of the features lie outside what was calibrated: do not rely on the prediction",
            100.0 * prediction.outside
        ));
    }
    Report {
        provenance: &world.provenance,
        digest: world.digest().to_string(),
        reproducible: again.is_some(),
        bounds: world.bounds,
        start: world.start,
        goal: world.goal,
        parts: Parts {
            walls: world.walls.len(),
            trees: world.trees.len(),
            road_strips: world.road_strips.len(),
            rooms: world.rooms.len(),
            doorways: world.doorways.len(),
            obstacles: world.obstacles.len(),
            surfaces: world.surfaces.len(),
            raster_cells: world.raster.as_ref().map_or(0, |raster| raster.cells.len()),
        },
        heights: Heights::of(world),
        materials: Materials::of(world),
        certificate,
        metrics: again,
        predicted,
        difficulty: difficulty.ok(),
        reachable: reachable(world),
    }
}

fn reachable(world: &World) -> Option<Dials<[f64; 2]>> {
    match WorldSpec::from_provenance(&world.provenance) {
        Ok(WorldSpec::Indoor(spec)) if spec.profile == Profile::Calibrated => {
            Some(spec.reachable())
        }
        _ => None,
    }
}

fn predicted(
    world: &World,
    platform: &Platform,
    vector: Option<&DifficultyVector>,
) -> Option<Prediction> {
    let calibration = Calibration::of_world(world)?;
    let is_known = *platform == Platform::default();
    vector.filter(|_| is_known).map(|vector| calibration.predict(vector))
}

/// Prints a tree of values, two spaces per level; lists of plain values are on one line.
fn print(out: &mut impl Write, value: &Value, level: usize) -> io::Result<()> {
    let Value::Object(fields) = value else { return writeln!(out, "{}", plain(value)) };
    for (name, value) in fields {
        write!(out, "{:indent$}{name}:", "", indent = 2 * level)?;
        match value {
            Value::Object(fields) if !fields.is_empty() => {
                writeln!(out)?;
                print(out, value, level + 1)?;
            }
            Value::Array(items) if items.iter().any(Value::is_object) => {
                writeln!(out)?;
                for item in items {
                    writeln!(out, "{:indent$}-", "", indent = 2 * level + 2)?;
                    print(out, item, level + 2)?;
                }
            }
            _ => writeln!(out, " {}", plain(value))?,
        }
    }
    Ok(())
}

fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => "none".to_owned(),
        other => other.to_string(),
    }
}
