//! The subcommand `envgen-trials anchors`.

use std::error::Error;

use clap::Args;

use crate::json;
use crate::panel::PanelOptions;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    panel: PanelOptions,
}

pub(crate) fn run(arguments: &Arguments, threads: usize) -> Result<(), Box<dyn Error>> {
    let panel = arguments.panel.panel()?;
    let scale = arguments.panel.scale(&panel, threads)?;
    json::print(&scale)
}
