//! The waypoints of roads as comma-separated values.
//!
//! There is one line per waypoint under the header `road,s,x,y,heading,curvature`: the road's number counted from
//! 0, the distance along it in metres, the position in metres, the heading in radians and the curvature in 1/m. A
//! closed road ends with its first waypoint again, one lap farther. Numbers have as many digits as are needed to
//! read the same numbers back.

use std::io::{self, Write};

use super::error::ExportError;
use super::waypoints;
use crate::world::World;

/// Writes the waypoints of a world's roads.
pub(super) fn write(world: &World, out: &mut dyn Write) -> Result<(), ExportError> {
    if world.road_strips.is_empty() {
        return Err(ExportError::Empty { part: "road" });
    }
    let mut table = csv::Writer::from_writer(out);
    table.write_record(["road", "s", "x", "y", "heading", "curvature"]).map_err(io_error)?;
    for (number, strip) in world.road_strips.iter().enumerate() {
        let again = strip.centreline.first().filter(|_| strip.closed);
        for (point, s) in strip.centreline.iter().chain(again).zip(waypoints::distances(strip)) {
            let at = point.pose.position;
            let row = (number, s, at.x, at.y, point.pose.heading, point.curvature);
            table.serialize(row).map_err(io_error)?;
        }
    }
    table.flush()?;
    Ok(())
}

pub(super) fn io_error(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        kind => io::Error::other(format!("{kind:?}")),
    }
}
