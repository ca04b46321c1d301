//! Robots from files.

use std::path::Path;

use mapping_trial::robot::Robot;

/// Reads a robot's numbers from a RON file.
pub(crate) fn read(path: &Path) -> Result<Robot, String> {
    let of_file = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let text = std::fs::read_to_string(path).map_err(|error| of_file(&error))?;
    Robot::from_ron(&text).map_err(|error| of_file(&error))
}
