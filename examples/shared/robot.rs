//! Robots from files.

use std::error::Error;
use std::path::Path;

use envgen::located::Locate;
use envgen::text_file;
use mapping_trial::mappable_area::MappableArea;
use mapping_trial::robot::Robot;

/// Reads a robot whose trials can be scored from a RON file.
pub(crate) fn read(path: &Path) -> Result<Robot, Box<dyn Error>> {
    let text = text_file::read(path).in_file(path)?;
    let robot = Robot::from_ron(&text).in_file(path)?;
    MappableArea::check_robot(&robot).in_file(path)?;
    Ok(robot)
}
