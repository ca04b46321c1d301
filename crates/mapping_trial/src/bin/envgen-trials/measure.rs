//! The subcommand `envgen-trials measure`.

use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use envgen::calibration::{Calibration, Dials, Prediction};
use envgen::difficulty::{DifficultyVector, Platform};
use envgen::located::Locate;
use envgen::placement::pose_of_most_clearance;
use envgen::{Seed, World, import};
use mapping_trial::difficulty::{Measurement, Measuring, Panel};
use mapping_trial::mappable_area::MappableArea;
use serde::Serialize;

use crate::panel::PanelOptions;
use crate::progress::Progress;
use crate::warning::{warn_of_coverage, warn_of_map};
use crate::{json, stdout};

#[derive(Args)]
pub(crate) struct Arguments {
    /// A world file in any format that `envgen convert` reads, such as a ROS map. If it has no start, robots start in
    /// the largest free region, away from walls.
    #[arg(value_name = "FILE")]
    world: PathBuf,

    /// Number of trials under each condition.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: u32,

    /// The first seed of the sensor noise.
    #[arg(long, default_value_t = Seed(0), allow_negative_numbers = true)]
    noise_seed: Seed,

    /// Prints JSON.
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    panel: PanelOptions,
}

/// The output as JSON.
#[derive(Serialize)]
struct Report {
    /// Description of the world, such as `indoor, seed 3`.
    world: String,
    measurement: Measurement,
    /// Percentage of the worlds that are easier in the atlas of the prediction, by each dial; absent for panels other
    /// than the reference panel, and for kinds that are not calibrated.
    percentiles: Option<Dials<f64>>,
    /// The prediction of the calibration; absent for panels other than the reference panel, for kinds
    /// that are not calibrated, and for worlds without a difficulty vector.
    prediction: Option<Prediction>,
}

pub(crate) fn run(arguments: &Arguments, threads: usize) -> Result<(), Box<dyn Error>> {
    let path = &arguments.world;
    let mut world = import::read_world(path).in_file(path)?;
    warn_of_map(path);
    MappableArea::check_size(&world).in_file(path)?;
    if world.start.is_none() {
        let start = pose_of_most_clearance(&world).in_file(path)?;
        world.start = Some(start.ok_or("the world has no free space to start in").in_file(path)?);
    }
    let panel = arguments.panel.panel()?;
    let mut measuring = Measuring::new(&world, &panel, arguments.noise_seed);
    // Before the anchors, which may take minutes.
    measuring.check().in_file(path)?;
    let scale = arguments.panel.scale(&panel, threads)?;
    let bar = Progress::new();
    let trials = panel.conditions.len() as u64 * u64::from(arguments.seeds);
    bar.set("trials", 0, trials);
    let all: Vec<usize> = (0..panel.conditions.len()).collect();
    for _ in 0..arguments.seeds {
        measuring.add(&all).in_file(path)?;
        bar.set("trials", measuring.trials() as u64, trials);
    }
    bar.finish();
    let measurement = measuring.finish(&scale).ok_or("the panel has no condition")?;
    // Atlases and predictions are for the reference panel.
    let calibration = Calibration::of_world(&world).filter(|_| panel == Panel::reference());
    warn_of_coverage(&measurement);
    let values = measurement.measured.dials.map(|dial| dial.value);
    let prediction = calibration.and_then(|known| predict(known, &world));
    let percentiles = calibration.and_then(|known| {
        // Worlds are compared with others of their size.
        let smaller = known.smaller.as_ref().filter(|smaller| {
            prediction.is_some_and(|prediction| prediction.calibration == smaller.version)
        });
        smaller.map_or(&known.atlas, |smaller| &smaller.atlas).percentiles(values)
    });
    let report = Report { world: world.provenance.name(), measurement, percentiles, prediction };
    if arguments.json { json::print(&report) } else { Ok(stdout::print(&text(&report))?) }
}

fn predict(calibration: &Calibration, world: &World) -> Option<Prediction> {
    let vector = DifficultyVector::of(world, &Platform::default()).ok()?;
    Some(calibration.predict(&vector))
}

fn text(report: &Report) -> String {
    let mut text = String::new();
    let Measurement { measured, scores, conditions } = &report.measurement;
    writeln!(
        text,
        "{}: {} trials of the panel {:?}, version {}",
        report.world, measured.trials, measured.panel, measured.panel_version
    )
    .ok();
    writeln!(text, "\n{:>12} measured  95 % interval  score  harder than  predicted", "").ok();
    let percentiles = report.percentiles.map(Dials::named);
    let predicted = report.prediction.map(|prediction| prediction.dials.named());
    let intervals = report.measurement.intervals().named();
    for (i, (name, (value, [low, high]))) in intervals.into_iter().enumerate() {
        let predicted = predicted.map_or_else(String::new, |dials| {
            format!("{:5.1} +- {:.1}", dials[i].1.value, dials[i].1.standard_error)
        });
        let harder_than =
            percentiles.map_or_else(String::new, |dials| format!("{:.0} %", dials[i].1));
        let score = scores.named()[i].1;
        writeln!(
 text,
            "{name:>12} {value:8.2}  {low:5.2} to {high:5.2}  {score:5.2}  {harder_than:>11}  {predicted}"
        ).ok();
    }
    if report.prediction.is_some_and(|prediction| prediction.is_extrapolated()) {
        writeln!(text, "this world is unlike those of the atlas: do not rely on the prediction")
            .ok();
    }
    writeln!(text, "\n{:>28}     D     M     N  explored", "").ok();
    for one in conditions {
        let [d, m, n] = one.scores.named().map(|(_, score)| score);
        writeln!(text, "{:>28} {d:5.2} {m:5.2} {n:5.2}  {}", one.condition, one.explored).ok();
    }
    text
}
