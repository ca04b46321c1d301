//! The subcommand `envgen-trials levers`.

use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use envgen::located::Locate;
use envgen::text_file;
use envgen::whole_file;
use mapping_trial::difficulty::levers::{LeverDesign, LeverLevel, figure};
use mapping_trial::difficulty::reference_scale;
use mapping_trial::experiment::Shard;

use crate::stdout;
use crate::survey;

#[derive(Args)]
pub(crate) struct Arguments {
    /// A RON file with the levers, in place of the built-in ones.
    #[arg(long, value_name = "FILE.ron")]
    design: Option<PathBuf>,

    /// The folder to write into. The same command continues an interrupted run.
    #[arg(long, value_name = "FOLDER", default_value = "out/levers")]
    out: PathBuf,

    /// A figure to write as SVG.
    #[arg(long, value_name = "FILE.svg")]
    figure: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments, threads: usize) -> Result<(), Box<dyn Error>> {
    let design = match &arguments.design {
        None => LeverDesign::first(),
        Some(path) => {
            let text = text_file::read(path).in_file(path)?;
            LeverDesign::from_ron(&text).in_file(path)?
        }
    };
    let folder = survey::run(&design.survey()?, &arguments.out, Shard::WHOLE, threads)?;
    let levels = design.levels(reference_scale(), folder.records());
    let mut text = String::new();
    writeln!(text, "{:>14} {:>8} maps      d             m             n", "", "").ok();
    for (lever, levels) in design.levers.iter().zip(&levels) {
        for level in levels {
            let dials = level.dials.named().map(|(_, dial)| {
                format!("{:5.2} +- {:4.2}", dial.value, level.half_interval(dial))
            });
            let LeverLevel { value, maps, .. } = level;
            writeln!(text, "{:>14} {value:8} {maps:4} {}", lever.setting, dials.join(" ")).ok();
        }
    }
    if let Some(path) = &arguments.figure {
        whole_file::write(path, figure(&design.levers, &levels)?.as_bytes())
            .map_err(|error| format!("{}: {}", path.display(), error.error))?;
    }
    Ok(stdout::print(&text)?)
}
