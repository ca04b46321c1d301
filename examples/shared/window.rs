//! The common beginning and end of programs with a window.

use std::error::Error;
use std::process::ExitCode;

use bevy::prelude::*;
use bevy_offscreen::find_renderer;

/// Number of attempts to reach a server that does not answer, and the time between them.
#[cfg(target_os = "linux")]
const TRIES: u32 = 5;
#[cfg(target_os = "linux")]
const PAUSE: std::time::Duration = std::time::Duration::from_millis(100);

/// A window with a title.
pub(crate) fn titled(title: &str) -> WindowPlugin {
    let window = Window { title: title.to_owned(), ..default() };
    WindowPlugin { primary_window: Some(window), ..default() }
}

/// A connection to the display, which is held while the window is open. Some servers restart when no
/// client is left, and reject others meanwhile.
pub(crate) struct Display {
    #[cfg(target_os = "linux")]
    _connection: x11rb::rust_connection::RustConnection,
}

/// Checks what a window needs. Bevy would panic without it.
///
/// # Errors
///
/// If there is no graphics driver or, on Linux, if no X11 server is named, or if the named one does not
/// answer.
pub(crate) fn find_display() -> Result<Display, Box<dyn Error>> {
    find_renderer()?;
    Ok(Display {
        #[cfg(target_os = "linux")]
        _connection: connect()?,
    })
}

#[cfg(target_os = "linux")]
fn connect() -> Result<x11rb::rust_connection::RustConnection, Box<dyn Error>> {
    let Some(name) = std::env::var_os("DISPLAY").filter(|name| !name.is_empty()) else {
        return Err("no display: `DISPLAY` names no server of X11".into());
    };
    let mut left = TRIES;
    loop {
        left -= 1;
        match x11rb::connect(None) {
            Ok((connection, _)) => return Ok(connection),
            Err(_) if left > 0 => std::thread::sleep(PAUSE),
            Err(error) => {
                return Err(format!("no display: `DISPLAY` is {}: {error}", name.display()).into());
            }
        }
    }
}

/// Reports the error of a program, if there is one, and returns its exit status.
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
