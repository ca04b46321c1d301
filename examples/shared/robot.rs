//! Robots from files.

use std::error::Error;
use std::path::Path;

use envgen::located::Locate;
use mapping_trial::mappable_area::MappableArea;
use mapping_trial::robot::Robot;

/// Reads a robot whose trials can be scored from a RON file.
pub(crate) fn read(path: &Path) -> Result<Robot, Box<dyn Error>> {
    let text = std::fs::read_to_string(path).in_file(path)?;
    let robot = Robot::from_ron(&text).in_file(path)?;
    MappableArea::check_robot(&robot).in_file(path)?;
    Ok(robot)
}
