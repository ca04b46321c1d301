//! Progress of long work in steps. The examples use it as well.

use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};

/// Time between two lines.
const BETWEEN_LINES: Duration = Duration::from_secs(60);

/// Shows on stderr how many steps are finished: a bar on a terminal. Elsewhere, such as in the log of a run of
/// hours, a line per minute.
pub(crate) struct Progress {
    bar: ProgressBar,
    stage: Mutex<Stage>,
}

struct Stage {
    name: String,
    /// Time from the beginning to the last line.
    last_line: Duration,
}

impl Progress {
    pub(crate) fn new() -> Self {
        let stage = Stage { name: String::new(), last_line: Duration::ZERO };
        Self { bar: bar(), stage: Mutex::new(stage) }
    }

    /// Shows how many steps of a stage are finished, those of an earlier run included. A new name begins a stage.
    pub(crate) fn set(&self, name: &str, finished: u64, all: u64) {
        let mut stage = self.stage.lock().unwrap_or_else(PoisonError::into_inner);
        let begins = stage.name != name;
        if begins {
            name.clone_into(&mut stage.name);
            self.bar.set_message(name.to_owned());
            self.bar.set_length(all);
        }
        self.bar.set_position(finished);
        if begins {
            // Steps of an earlier run took no time of this one.
            self.bar.reset_eta();
        }
        let now = self.bar.elapsed();
        if self.bar.is_hidden() && now >= stage.last_line + BETWEEN_LINES {
            stage.last_line = now;
            let left = HumanDuration(self.bar.eta());
            #[expect(clippy::print_stderr, reason = "what it is for")]
            {
                eprintln!("{name}: {finished} of {all}, {left} left");
            }
        }
    }

    /// Removes the bar.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

fn bar() -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(0);
    bar.enable_steady_tick(Duration::from_millis(500));
    match ProgressStyle::with_template("{msg} {bar:40} {pos}/{len}, {per_sec}, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
