//! Displays.

/// Whether there is a display to open a window on: Bevy would panic without one.
///
/// # Errors
/// On Linux, when no server of X11 is named.
pub(crate) fn find() -> Result<(), &'static str> {
    let is_named = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    match cfg!(target_os = "linux") && !is_named("DISPLAY") {
        true => Err("no display: `DISPLAY` names no server of X11"),
        false => Ok(()),
    }
}
