//! What the command prints.

use std::error::Error;
use std::io::{self, ErrorKind, Write};

use envgen::located::Located;
use serde::Serialize;

/// Writes a text to stdout. That its reader closed it early, as `head` does, is no error.
pub(crate) fn print(text: &str) -> Result<(), Located<io::Error>> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Located { place: "stdout".to_owned(), error })
        }
        _ => Ok(()),
    }
}

/// Writes a value to stdout as JSON.
pub(crate) fn print_json<T: Serialize>(value: &T) -> Result<(), Box<dyn Error>> {
    Ok(print(&format!("{}\n", serde_json::to_string_pretty(value)?))?)
}
