//! Files with the spec of a world instead of a world.

use std::error::Error;
use std::path::Path;

use envgen::located::Locate;
use envgen::text_file;
use envgen::{WorldKind, WorldSpec};

/// Reads the spec from a file whose name ends with `.ron`; `None` for any other file, and for a file
/// that may be the RON of a world.
pub(crate) fn read(path: &Path) -> Result<Option<WorldSpec>, Box<dyn Error>> {
    let name = path.to_string_lossy().to_ascii_lowercase();
    if !name.ends_with(".ron") {
        return Ok(None);
    }
    let text = text_file::read(path).in_file(path)?;
    match WorldSpec::from_ron(&text) {
        Ok(spec) => Ok(Some(spec)),
        Err(error) if name.ends_with(".envgen.ron") || is_of_kind(&text) => {
            Err(error).in_file(path)?
        }
        Err(_) => Ok(None),
    }
}

/// Whether a line begins with the name of a kind, as specs do.
fn is_of_kind(text: &str) -> bool {
    let name = |line: &str| Some(line.split_once('(')?.0.trim().to_ascii_lowercase());
    text.lines().filter_map(name).any(|name| name.parse::<WorldKind>().is_ok())
}
