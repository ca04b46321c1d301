//! What programs with a window begin and end with.

use std::error::Error;
use std::process::ExitCode;

use bevy::prelude::*;
use bevy_offscreen::find_renderer;

/// A window with a title.
pub(crate) fn titled(title: &str) -> WindowPlugin {
    let window = Window { title: title.to_owned(), ..default() };
    WindowPlugin { primary_window: Some(window), ..default() }
}

/// Whether there is what a window needs: Bevy would panic without it.
///
/// # Errors
/// Without a graphics driver and, on Linux, when no server of X11 is named.
pub(crate) fn check() -> Result<(), Box<dyn Error>> {
    find_renderer()?;
    let is_named = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if cfg!(target_os = "linux") && !is_named("DISPLAY") {
        return Err("no display: `DISPLAY` names no server of X11".into());
    }
    Ok(())
}

/// The exit status of a program, whose error is reported.
pub(crate) fn exit_code(ended: Result<AppExit, Box<dyn Error>>) -> ExitCode {
    match ended {
        Ok(AppExit::Success) => ExitCode::SUCCESS,
        Ok(AppExit::Error(code)) => ExitCode::from(code.get()),
        Err(error) => {
            #[expect(clippy::print_stderr, reason = "errors belong on stderr")]
            {
                eprintln!("error: {error}");
            }
            ExitCode::FAILURE
        }
    }
}
