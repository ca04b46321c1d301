//! Files that hold a spec of a world in place of a world.

use std::error::Error;
use std::path::Path;

use envgen::WorldSpec;
use envgen::located::Locate;

/// The spec in a file that ends with `.ron`; `None` for any other file, and for the RON of a world.
pub(crate) fn read(path: &Path) -> Result<Option<WorldSpec>, Box<dyn Error>> {
    let name = path.to_string_lossy().to_ascii_lowercase();
    if !name.ends_with(".ron") {
        return Ok(None);
    }
    let text = std::fs::read_to_string(path).in_file(path)?;
    match WorldSpec::from_ron(&text) {
        Ok(spec) => Ok(Some(spec)),
        Err(error) if name.ends_with(".envgen.ron") => Err(error).in_file(path)?,
        Err(_) => Ok(None),
    }
}
