//! Output of values as JSON.

use std::error::Error;

use serde::Serialize;

use crate::stdout;

/// Writes a value to stdout as JSON.
pub(crate) fn print<T: Serialize>(value: &T) -> Result<(), Box<dyn Error>> {
    Ok(stdout::print(&format!("{}\n", serde_json::to_string_pretty(value)?))?)
}
