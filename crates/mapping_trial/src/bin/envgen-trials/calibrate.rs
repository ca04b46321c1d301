//! The subcommand `envgen-trials calibrate`.

use std::collections::BTreeSet;
use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use envgen::calibration::{Atlas, Calibration, Dials, Scale};
use envgen::whole_file;
use envgen::world::Digest;
use mapping_trial::difficulty::{Anchors, Panel, calibrate, reference_scale, samples};
use mapping_trial::experiment::Shard;
use mapping_trial::experiment::survey::{Record, Survey, SurveyFolder};

use crate::atlas::DesignOptions;
use crate::spinner::spinner;
use crate::stdout;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    design: DesignOptions,

    /// The folder of the atlas's trials, or the folders of all its shares.
    #[arg(long, value_name = "FOLDER", num_args = 1.., default_value = "out/atlas")]
    atlas: Vec<PathBuf>,

    /// The folder of the anchors' trials.
    #[arg(long, value_name = "FOLDER", default_value = "out/anchors")]
    anchors: PathBuf,

    /// Number of trials per anchor and condition.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    anchor_seeds: u32,

    /// Uses the scale of the built-in calibrations, in place of the anchors' trials.
    #[arg(long, conflicts_with_all = ["anchors", "anchor_seeds"])]
    built_in_scale: bool,

    /// Fits to the worlds whose trials are finished, and leaves out the others.
    #[arg(long)]
    partial: bool,

    /// The calibration file to write.
    #[arg(long, value_name = "FILE.json")]
    out: PathBuf,

    /// Also writes a table of the atlas's worlds: settings, features and measured dials.
    #[arg(long, value_name = "FILE.parquet")]
    table: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let panel = Panel::reference();
    let scale = scale(arguments, &panel)?;
    let design = arguments.design.read()?;
    let survey = design.survey(&panel)?;
    // The shares may be in any order, but each occurs once.
    let of = arguments.atlas.len() as u32;
    let mut missing: BTreeSet<u32> = (1..=of).collect();
    let mut folders = Vec::new();
    for path in &arguments.atlas {
        let index = SurveyFolder::shard_of(path)?.index;
        if !missing.remove(&index) {
            let name = path.display();
            return Err(format!("{name}: share {index}, expected each of 1 to {of} once").into());
        }
        folders.push(open(&survey, path, Shard { index, of }, arguments.partial)?);
    }
    let mut records: Vec<&Record> = folders.iter().flat_map(SurveyFolder::records).collect();
    // The order is that of a single folder, whatever the shares were.
    records.sort_by_key(|record| (record.map, record.condition, record.noise));
    let spinner = spinner("fitting");
    let samples = samples(&survey, &records, &scale)?;
    let atlas = Atlas {
        command: arguments.design.command(),
        worlds: samples.len() as u32,
        trials: records.len() as u32,
        digest: Digest::of(&records).to_string(),
        // The fit adds them.
        dials: Dials::default(),
    };
    let calibration = calibrate(design.version(), design.kind(), atlas, scale, &samples)?;
    spinner.finish_and_clear();
    let mut json = serde_json::to_vec_pretty(&calibration)?;
    json.push(b'\n');
    write(&arguments.out, &json)?;
    if let Some(path) = &arguments.table {
        write(path, &mapping_trial::difficulty::table(&samples)?)?;
    }
    stdout::print(&text(&calibration))?;
    Ok(())
}

/// The scale on which the atlas's worlds are measured.
fn scale(arguments: &Arguments, panel: &Panel) -> Result<Scale, Box<dyn Error>> {
    if arguments.built_in_scale {
        return Ok(reference_scale().clone());
    }
    let anchors = Anchors::first();
    let survey = anchors.survey(panel, arguments.anchor_seeds);
    let folder = open(&survey, &arguments.anchors, Shard::WHOLE, false)?;
    Ok(anchors.scale(panel, folder.records())?)
}

/// Opens a folder whose trials are all finished, or only some of them.
fn open(
    survey: &Survey,
    path: &Path,
    shard: Shard,
    partial: bool,
) -> Result<SurveyFolder, Box<dyn Error>> {
    if !path.is_dir() {
        return Err(format!("{}: there is no such folder", path.display()).into());
    }
    // The folder has to hold a survey: opening another one would begin a survey in it.
    SurveyFolder::survey_of(path)?;
    let folder = SurveyFolder::open(path, survey, shard)?;
    if !partial && !folder.is_complete() {
        let (done, all) = (folder.records().len(), folder.trials());
        return Err(format!("{}: {done} of {all} trials are finished", path.display()).into());
    }
    Ok(folder)
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Box<dyn Error>> {
    whole_file::write(path, bytes)
        .map_err(|error| format!("{}: {}", path.display(), error.error).into())
}

fn text(calibration: &Calibration) -> String {
    let mut text = String::new();
    writeln!(text, "{} worlds, {} trials", calibration.atlas.worlds, calibration.atlas.trials).ok();
    let settings = calibration.settings.iter().map(|models| ("settings", models));
    for (name, models) in std::iter::once(("world", &calibration.world)).chain(settings) {
        for (dial, model) in models.models.as_ref().named() {
            let [low, high] = model.standard_errors;
            writeln!(
 text,
                "{dial} from {name}: {} inputs, explains {:.2}, standard error {low:.2} at 0, {high:.2} at 10",
                models.inputs.len(),
                model.explained
            ).ok();
        }
    }
    text
}
