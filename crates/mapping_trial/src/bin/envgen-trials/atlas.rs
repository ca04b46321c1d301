//! The subcommand `envgen-trials atlas`.

use std::error::Error;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use envgen::WorldKind;
use envgen::located::Locate;
use envgen::text_file;
use mapping_trial::difficulty::{AtlasDesign, Panel};
use mapping_trial::experiment::Shard;

use crate::stdout;
use crate::survey;

/// The atlas's design.
#[derive(Args)]
pub(crate) struct DesignOptions {
    /// The kind of worlds, each of which has a built-in atlas. `indoor-small` are indoor maps of 144 to 486 m^2.
    #[arg(long, value_enum, default_value_t = AtlasKind::Indoor)]
    kind: AtlasKind,

    /// A RON file with the design of the atlas, in place of a built-in one.
    #[arg(long, value_name = "FILE.ron", conflicts_with = "kind")]
    design: Option<PathBuf>,
}

/// The kinds of worlds that have an atlas.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum AtlasKind {
    Indoor,
    IndoorSmall,
    Hallway,
    Forest,
}

impl AtlasKind {
    fn design(self) -> AtlasDesign {
        let kind = match self {
            AtlasKind::IndoorSmall => return AtlasDesign::indoor_small(),
            AtlasKind::Indoor => WorldKind::Indoor,
            AtlasKind::Hallway => WorldKind::Hallway,
            AtlasKind::Forest => WorldKind::Forest,
        };
        AtlasDesign::of(kind).unwrap_or_else(|| unreachable!("these kinds have an atlas"))
    }
}

impl DesignOptions {
    /// The command that measures the atlas.
    pub(crate) fn command(&self) -> String {
        match &self.design {
            Some(path) => format!("envgen-trials atlas --design {}", path.display()),
            None => {
                let kind = self.kind.to_possible_value();
                format!(
                    "envgen-trials atlas --kind {}",
                    kind.as_ref().map_or("", |kind| kind.get_name())
                )
            }
        }
    }

    pub(crate) fn read(&self) -> Result<AtlasDesign, Box<dyn Error>> {
        let Some(path) = &self.design else { return Ok(self.kind.design()) };
        let text = text_file::read(path).in_file(path)?;
        Ok(AtlasDesign::from_ron(&text).in_file(path)?)
    }
}

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    design: DesignOptions,

    /// Runs only a share of the worlds, such as 2/8.
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE)]
    shard: Shard,

    /// The folder to write into. The same command continues an interrupted run.
    #[arg(long, value_name = "FOLDER", default_value = "out/atlas")]
    out: PathBuf,
}

pub(crate) fn run(arguments: &Arguments, threads: usize) -> Result<(), Box<dyn Error>> {
    let survey = arguments.design.read()?.survey(&Panel::reference())?;
    let out: &Path = &arguments.out;
    let folder = survey::run(&survey, out, arguments.shard, threads)?;
    let (count, file) = (folder.records().len(), folder.file().display());
    Ok(stdout::print(&format!("wrote {count} trials to {file}\n"))?)
}
