//! `envgen-trials levers`.

use std::error::Error;
use std::path::PathBuf;

use clap::Args;
use envgen::located::Locate;
use envgen::whole_file;
use mapping_trial::difficulty::levers::{LeverDesign, figure};
use mapping_trial::difficulty::reference_scale;
use mapping_trial::experiment::Shard;

use crate::survey;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The levers in RON, if not those of the crate.
    #[arg(long, value_name = "FILE.ron")]
    design: Option<PathBuf>,

    /// The folder to write into. The same command continues an interrupted run.
    #[arg(long, value_name = "FOLDER", default_value = "out/levers")]
    out: PathBuf,

    /// A figure to write.
    #[arg(long, value_name = "FILE.svg")]
    figure: Option<PathBuf>,
}

#[expect(clippy::print_stdout, reason = "what the command is for")]
pub(crate) fn run(arguments: &Arguments, threads: usize) -> Result<(), Box<dyn Error>> {
    let design = match &arguments.design {
        None => LeverDesign::first(),
        Some(path) => {
            let text = std::fs::read_to_string(path).in_file(path)?;
            LeverDesign::from_ron(&text).in_file(path)?
        }
    };
    let folder = survey::run(&design.survey()?, &arguments.out, Shard::WHOLE, threads)?;
    let levels = design.levels(reference_scale(), folder.records());
    println!("{:>14} {:>8}      d             m             n", "", "");
    for (lever, levels) in design.levers.iter().zip(&levels) {
        for level in levels {
            let dials = level.dials.named().map(|(_, dial)| {
                format!("{:5.2} +- {:4.2}", dial.value, 1.96 * dial.standard_error)
            });
            println!("{:>14} {:8} {}", lever.setting, level.value, dials.join(" "));
        }
    }
    if let Some(path) = &arguments.figure {
        whole_file::write(path, figure(&design.levers, &levels)?.as_bytes())
            .map_err(|error| format!("{}: {}", path.display(), error.error))?;
    }
    Ok(())
}
