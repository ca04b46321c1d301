//! Progress bars on a terminal.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A progress bar of trials on stderr, some of which were finished before. It is hidden if stderr is
/// not a terminal.
pub(crate) fn trials(count: u64, finished: u64) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(count);
    bar.set_position(finished);
    bar.reset_eta();
    bar.enable_steady_tick(Duration::from_millis(500));
    match ProgressStyle::with_template("{bar:40} {pos}/{len} trials, {per_sec}, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
