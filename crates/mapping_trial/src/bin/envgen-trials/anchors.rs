//! The subcommand `envgen-trials anchors`.

use std::error::Error;

use clap::Args;

use crate::panel::PanelOptions;
use crate::stdout;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    panel: PanelOptions,
}

pub(crate) fn run(arguments: &Arguments, threads: usize) -> Result<(), Box<dyn Error>> {
    let panel = arguments.panel.panel()?;
    let scale = arguments.panel.scale(&panel, threads)?;
    stdout::print_json(&scale)
}
