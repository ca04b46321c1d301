//! `envgen-trials anchors`.

use std::error::Error;

use clap::Args;

use crate::panel::PanelOptions;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    panel: PanelOptions,
}

#[expect(clippy::print_stdout, reason = "what the command is for")]
pub(crate) fn run(arguments: &Arguments, threads: usize) -> Result<(), Box<dyn Error>> {
    let panel = arguments.panel.panel()?;
    let scale = arguments.panel.scale(&panel, threads)?;
    println!("{}", serde_json::to_string_pretty(&scale)?);
    Ok(())
}
