//! The progress that a terminal shows while the command works.

use std::borrow::Cow;
use std::fmt::Write;
use std::io::{self, IsTerminal};
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

/// A progress bar on stderr, hidden where stdout is a terminal, so that it is not mixed with lines.
pub(crate) fn bar(count: u64) -> ProgressBar {
    if io::stdout().is_terminal() {
        return ProgressBar::with_draw_target(Some(count), ProgressDrawTarget::hidden());
    }
    let style =
        ProgressStyle::with_template("{bar:40} {human_pos}/{human_len} {per_sec} {eta} left");
    let bar = ProgressBar::new(count);
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// Steps of a command on stderr, with a spinner: which one is worked on, the time so far, and about how much is left if
/// the others take as long as those before. Removed when it is dropped.
pub(crate) struct Steps(ProgressBar);

/// Begins a command of so many steps; [`Steps::begin`] names each.
pub(crate) fn steps(count: usize) -> Steps {
    let bar = ProgressBar::new(count as u64);
    bar.enable_steady_tick(Duration::from_millis(100));
    let template = "{spinner} step {step} of {len}: {msg}, {elapsed} so far{left}";
    let Ok(style) = ProgressStyle::with_template(template) else { return Steps(bar) };
    let step = |state: &ProgressState, out: &mut dyn Write| {
        // What cannot be written is not shown.
        let _ = write!(out, "{}", state.pos() + 1);
    };
    let left = |state: &ProgressState, out: &mut dyn Write| {
        if state.pos() > 0 {
            let _ = write!(out, ", about {} left", HumanDuration(state.eta()));
        }
    };
    Steps(bar.with_style(style.with_key("step", step).with_key("left", left)))
}

impl Steps {
    /// Begins a step; the one before is done.
    pub(crate) fn begin(&self, what: impl Into<Cow<'static, str>>) {
        // The first step follows none.
        if !self.0.message().is_empty() {
            self.0.inc(1);
        }
        self.0.set_message(what);
    }
}

impl Drop for Steps {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
