//! The data of a run from which it is scored.

use super::error::ScoreError;
use super::swept::SweptCells;
use super::trajectory_pair::{TrajectoryPair, check_tracks};
use crate::map::OccupancyMap;

/// Number of collisions for which a robot counts that is stuck for good, or lost in water.
pub(super) const STUCK_COLLISIONS: f64 = 3.0;

/// The data of a run from which it is scored.
#[derive(Clone, Copy, Debug)]
pub struct RunSummary<'a> {
    /// The robots' map, with all its changes announced by [`OccupancyMap::touch`].
    pub map: &'a OccupancyMap,
    /// One pair of trajectories per robot.
    pub tracks: &'a [TrajectoryPair<'a>],
    /// Simulated time in seconds.
    pub time: f64,
    /// Time in seconds at which the run would have ended.
    pub time_limit: f64,
    /// Path length of all robots in metres.
    pub distance: f64,
    /// Turning of all robots in radians, left and right added.
    pub turning: f64,
    /// Number of collisions of all robots, without those with people.
    pub collisions: u32,
    /// Where people and door leaves were, and the number of collisions of all robots with people;
    /// `None` if nothing moves.
    pub moving: Option<(&'a SweptCells, u32)>,
    /// Number of recoveries of all robots.
    pub recoveries: u32,
    /// Number of robots that were stuck for good, or lost in water.
    pub stuck: u32,
    /// Least time in seconds, over all robots, for which the battery would still have lasted.
    pub energy_left: f64,
}

/// Checks the trajectories and every number of a run.
pub(super) fn check(run: &RunSummary<'_>) -> Result<(), ScoreError> {
    check_tracks(run.tracks)?;
    let numbers = [
        ("time", run.time),
        ("time_limit", run.time_limit),
        ("distance", run.distance),
        ("turning", run.turning),
        ("energy_left", run.energy_left),
    ];
    match numbers.into_iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0)) {
        Some((field, value)) => Err(ScoreError::Number { field, value }),
        None => Ok(()),
    }
}
