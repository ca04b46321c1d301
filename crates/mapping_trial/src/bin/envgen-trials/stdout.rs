//! Output to stdout. The examples use it as well.

use std::io::{self, ErrorKind, Write};

use envgen::located::Located;

/// Writes a text to stdout. It is no error if the reader closes stdout early, as `head` does.
pub(crate) fn print(text: &str) -> Result<(), Located<io::Error>> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Located { place: "stdout".to_owned(), error })
        }
        _ => Ok(()),
    }
}
