//! Progress of a trial on a terminal.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

/// A progress bar of simulated seconds on stderr. It is hidden if stderr is not a terminal.
pub(crate) fn trial_bar(limit: f64) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(limit as u64);
    match ProgressStyle::with_template(
        "{bar:40} {pos}/{len} simulated seconds, {per_sec}, {eta} left",
    ) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
