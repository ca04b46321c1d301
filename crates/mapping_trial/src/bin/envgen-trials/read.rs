//! Reading text files.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use envgen::located::{Locate, Located};

/// Greatest length of a text that is read, in bytes, so that an endless file does not fill the memory.
const LONGEST: u64 = 1 << 28;

/// Reads the text of a file.
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
