//! Where trials start.

use std::error::Error;

use envgen::World;
use envgen::geometry::Pose;
use envgen::occupancy::{Coverage, OccupancyGrid};
use envgen::placement::max_clearance_point;
use mapping_trial::trial::TrialSettings;

/// Cells in metres of the grid on which the point of largest clearance is searched.
const GRID: f64 = 0.1;

/// Settings with a start: if neither they nor the world give one, it is in the largest free
/// region, away from walls.
pub(crate) fn with_start(
    world: &World,
    settings: TrialSettings,
) -> Result<TrialSettings, Box<dyn Error>> {
    if settings.start.is_some() || world.start.is_some() {
        return Ok(settings);
    }
    let grid = OccupancyGrid::of(world, GRID, Coverage::Conservative)?;
    let place = max_clearance_point(&grid).ok_or("the world has no free space to start in")?;
    Ok(TrialSettings { start: Some(Pose { position: place, heading: 0.0 }), ..settings })
}
