//! `envgen-trials generate`.

use std::error::Error;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use clap::Args;
use envgen::export::{Format, Job};
use envgen::indoor::{IndoorSpec, Profile};
use envgen::located::Locate;
use envgen::whole_file::{WholeFile, commit_all};
use envgen::{Seed, WorldSpec};
use mapping_trial::difficulty::{RACERS, Verified, verified};

use crate::panel::PanelOptions;
use crate::progress;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Sets a setting of indoor maps (see `envgen kinds`), such as `difficulty=7`; may be given several times.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    settings: Vec<String>,

    /// The seed from which everything random follows.
    #[arg(long, default_value_t = Seed(0), allow_negative_numbers = true)]
    seed: Seed,

    /// Trials under each condition of the last measurement.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: u32,

    /// A file to write; its ending selects the format. May be given several times.
    #[arg(long, value_name = "FILE", required = true)]
    out: Vec<PathBuf>,

    #[command(flatten)]
    panel: PanelOptions,
}

impl Arguments {
    fn spec(&self) -> Result<IndoorSpec, Box<dyn Error>> {
        let mut spec =
            WorldSpec::from(IndoorSpec { profile: Profile::Calibrated, ..Default::default() });
        let mut names = Vec::new();
        for option in &self.settings {
            let (name, value) = option
                .split_once('=')
                .ok_or_else(|| format!("--set {option}: is not of the form name=value"))?;
            spec.set(name.trim(), value).in_option("--set", option)?;
            names.push(name.trim());
        }
        let WorldSpec::Indoor(mut spec) = spec else { unreachable!("the kind is never set") };
        names.into_iter().for_each(|name| spec.fix(name));
        Ok(spec)
    }
}

pub(crate) fn run(arguments: &Arguments, threads: usize) -> Result<(), Box<dyn Error>> {
    let spec = arguments.spec()?;
    let formats: Result<Vec<Format>, _> =
        arguments.out.iter().map(|path| Format::from_path(path).in_file(path)).collect();
    let formats = formats?;
    let panel = arguments.panel.panel()?;
    let scale = arguments.panel.scale(&panel, threads)?;
    let bar = progress::trials(2 * RACERS as u64 + 1);
    let found = verified(&spec, arguments.seed, &panel, &scale, arguments.seeds, &mut |rounds| {
        bar.set_position(rounds as u64);
    });
    bar.finish_and_clear();
    let found = found?;
    let mut files = Vec::new();
    for (path, format) in arguments.out.iter().zip(formats) {
        let job = Job::for_path(&found.world, path);
        for (i, (ending, write)) in format.files().iter().enumerate() {
            let path = if i == 0 { path.clone() } else { path.with_extension(ending) };
            let mut file = WholeFile::create(&path).in_file(&path)?;
            let mut out = BufWriter::new(&mut file);
            write(&job, &mut out).in_file(&path)?;
            out.flush().in_file(&path)?;
            drop(out);
            files.push(file);
        }
    }
    commit_all(files)?;
    print(&found);
    Ok(())
}

#[expect(clippy::print_stdout, reason = "what the command is for")]
fn print(found: &Verified) {
    let measured = &found.measurement.measured;
    for (name, dial) in measured.dials.named() {
        let [low, high] = dial.interval();
        println!("{name:>12} {:5.2}, 95 % from {low:.2} to {high:.2}", dial.value);
    }
    let race: Vec<String> =
        found.race.iter().map(|dials| format!("{:.1}", dials.difficulty.value)).collect();
    println!("measured by {} fresh trials; the race: {}", measured.trials, race.join(", "));
}
