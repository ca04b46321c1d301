//! Reading text files.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use envgen::located::{Locate, Located};

/// The longest text that is read, in bytes: what has no end must not fill the memory.
const LONGEST: u64 = 1 << 28;

/// The text of a file.
pub(crate) fn text(path: &Path) -> Result<String, Located<io::Error>> {
    read(path).in_file(path)
}

fn read(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    let length = File::open(path)?.take(LONGEST + 1).read_to_string(&mut text)?;
    if length as u64 > LONGEST {
        return Err(io::Error::other(format!("longer than {LONGEST} bytes")));
    }
    Ok(text)
}
