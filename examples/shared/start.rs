//! Start poses of trials.

use std::error::Error;

use envgen::World;
use envgen::placement::pose_of_most_clearance;
use mapping_trial::trial::TrialSettings;

/// Returns the settings with a start. If neither they nor the world have one, it is in the largest free
/// region, away from walls.
pub(crate) fn with_start(
    world: &World,
    settings: TrialSettings,
) -> Result<TrialSettings, Box<dyn Error>> {
    if settings.start.is_some() || world.start.is_some() {
        return Ok(settings);
    }
    let start = pose_of_most_clearance(world)?.ok_or("the world has no free space to start in")?;
    Ok(TrialSettings { start: Some(start), ..settings })
}
