//! Reading texts of a limited length.
//!
//! A file may be a device without an end, and some editors begin UTF-8 with a byte order mark, which parsers do not
//! accept. Texts that users write are therefore read here.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// The usual limit on the length of a text, in bytes: 256 MiB.
pub const MAX_TEXT_BYTES: u64 = 1 << 28;

/// Reads the text of a file of at most [`MAX_TEXT_BYTES`], without a byte order mark.
///
/// # Errors
/// As [`read_at_most`], and when the file cannot be opened.
pub fn read(path: &Path) -> io::Result<String> {
    read_at_most(&mut File::open(path)?, MAX_TEXT_BYTES)
}

/// Reads a UTF-8 text of at most `limit` bytes, without a byte order mark.
///
/// ```
/// use std::io::ErrorKind;
///
/// use envgen::text_file::read_at_most;
///
/// assert_eq!(read_at_most(&mut "\u{feff}text".as_bytes(), 7)?, "text");
/// let error = read_at_most(&mut std::io::repeat(b' '), 7).unwrap_err();
/// assert_eq!((error.kind(), error.to_string().as_str()), (ErrorKind::FileTooLarge, "longer than 7 bytes"));
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// When the input cannot be read, when it is not UTF-8, or when it is too long ([`ErrorKind::FileTooLarge`]).
pub fn read_at_most(input: &mut dyn Read, limit: u64) -> io::Result<String> {
    let mut text = String::new();
    let length = input.take(limit.saturating_add(1)).read_to_string(&mut text)?;
    if length as u64 > limit {
        return Err(io::Error::new(ErrorKind::FileTooLarge, format!("longer than {limit} bytes")));
    }
    let mark = text.len() - without_mark(&text).len();
    text.drain(..mark);
    Ok(text)
}

/// Returns a text without the byte order mark at its beginning, if it has one.
pub fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}
