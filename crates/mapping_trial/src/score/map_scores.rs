//! Scores of a map, whoever made it, and of trajectories.

use serde::{Deserialize, Serialize};

use super::error::ScoreError;
use super::parts::{Parts, e_pose};
use super::raster::Raster;
use super::reference::Reference;
use super::swept::SweptCells;
use super::trajectory_pair::{TrajectoryPair, check_tracks};
use super::weights::Weights;
use super::{navigability, pose, walls};
use crate::map::OccupancyMap;
use crate::mappable_area::MappableArea;

/// Distances in metres up to which a wall counts as mapped in its place.
pub(super) const TOLERANCES: [f64; 2] = [0.30, 0.15];

/// The scores of a map alone. The fields are those of [`Scores`](super::Scores).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapScores {
    /// Wall error: 1 - F1 at 0.30 m.
    pub e_wall: f64,
    /// Usability error: 1 - U', with a margin of one cell of the map.
    pub e_use: f64,
    /// Coverage error: 1 - C.
    pub e_cov: f64,
    /// C: fraction of F that the map shows as free.
    pub coverage: f64,
    /// Fraction of the map's occupied cells that are within 0.30 m of a wall that can be seen from F.
    pub precision_30: f64,
    /// Fraction of those walls that are within 0.30 m of an occupied cell of the map.
    pub recall_30: f64,
    /// Harmonic mean of precision and recall within 0.30 m.
    pub f1_30: f64,
    /// Precision within 0.15 m.
    pub precision_15: f64,
    /// Recall within 0.15 m.
    pub recall_15: f64,
    /// Harmonic mean of precision and recall within 0.15 m.
    pub f1_15: f64,
    /// Mean distance in metres from the map's walls to the true ones and back, each at most 1 m.
    pub wall_distance: f64,
    /// Fraction of the walls that the map shows twice.
    pub ghosting: f64,
    /// U: fraction of 40 paths, planned on the map and driven in the true world, that arrive without a
    /// collision.
    pub navigability: f64,
    /// Area of F in square metres.
    pub free_area: f64,
}

impl MapScores {
    /// Scores a map in the world's frame.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
    /// use mapping_trial::robot::Robot;
    /// use mapping_trial::score::{MapScores, Reference};
    ///
    /// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
    /// let truth = Reference::new(&world, &Robot::default())?;
    /// let scores = MapScores::of(&truth, &truth.perfect_map());
    /// assert_eq!((scores.coverage, scores.f1_30, scores.e_use), (1.0, 1.0, 0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(truth: &Reference, map: &OccupancyMap) -> Self {
        MapScores::of_raster(truth, map, &Raster::of(truth, map), None)
    }

    /// Scores a map whose raster is known. Cells in which something moved do not count.
    pub(super) fn of_raster(
        truth: &Reference,
        map: &OccupancyMap,
        raster: &Raster,
        swept: Option<&SweptCells>,
    ) -> Self {
        let walls = walls::compare(truth, truth.runs(), raster, swept, TOLERANCES);
        let [f1_30, f1_15] = [0, 1].map(|i| harmonic(walls.precision[i], walls.recall[i]));
        let coverage = coverage(truth, raster);
        let [navigability, with_margin] = navigability::navigability(truth, truth.trips(), map);
        MapScores {
            e_wall: 1.0 - f1_30,
            e_use: 1.0 - with_margin,
            e_cov: 1.0 - coverage,
            coverage,
            precision_30: walls.precision[0],
            recall_30: walls.recall[0],
            f1_30,
            precision_15: walls.precision[1],
            recall_15: walls.recall[1],
            f1_15,
            wall_distance: walls.distance,
            ghosting: walls.ghosting,
            navigability,
            free_area: truth.free_area(),
        }
    }

    /// Returns M, the difficulty of mapping from 0 to 10, for this map and the trajectory along which
    /// it was made.
    pub fn mapping(&self, trajectory: &TrajectoryScores) -> f64 {
        let MapScores { e_wall, e_use, e_cov, .. } = *self;
        let parts = Parts { e_wall, e_use, e_cov, e_pose: trajectory.e_pose, ..Parts::default() };
        Weights::default().difficulties(&parts).mapping
    }
}

/// The scores of estimated trajectories. The fields are those of [`Scores`](super::Scores).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrajectoryScores {
    /// Pose error: drift of the pose, from 0 to 1.
    pub e_pose: f64,
    /// Absolute trajectory error (ATE): root mean square of the position errors in metres over all
    /// poses.
    pub trajectory_error: f64,
    /// Root mean square error in metres of the position relative to the pose 1 m of path before; absent
    /// if no robot drove that far.
    pub relative_error_near: Option<f64>,
    /// Root mean square error in radians of the heading relative to that pose.
    pub relative_turn_near: Option<f64>,
    /// Root mean square error in metres of the position relative to the pose 20 m of path before;
    /// absent if no robot drove that far.
    pub relative_error_far: Option<f64>,
    /// Root mean square error in radians of the heading relative to that pose.
    pub relative_turn_far: Option<f64>,
}

impl TrajectoryScores {
    /// Scores trajectories, one pair per robot, in the world's frame.
    ///
    /// ```
    /// use envgen::geometry::Pose;
    /// use mapping_trial::score::{TrajectoryPair, TrajectoryScores};
    ///
    /// // 5 m along +x; the estimate is always 0.3 m too far to the left.
    /// let truth: Vec<_> = (0..=50).map(|i| Pose::new(0.1 * f64::from(i), 0.0, 0.0)).collect();
    /// let estimated: Vec<_> = truth.iter().map(|pose| Pose::new(pose.position.x, 0.3, 0.0)).collect();
    /// let scores = TrajectoryScores::of(&[TrajectoryPair { truth: &truth, estimated: &estimated }])?;
    /// assert!((scores.trajectory_error - 0.3).abs() < 1e-12);
    /// // Relative to the metre before, it is exact; nothing is known over 20 m.
    /// assert!(scores.relative_error_near.is_some_and(|error| error < 1e-12));
    /// assert_eq!(scores.relative_error_far, None);
    /// # Ok::<(), mapping_trial::score::ScoreError>(())
    /// ```
    ///
    /// # Errors
    /// If a pair's lists differ in length, or a pose is not finite.
    pub fn of(tracks: &[TrajectoryPair<'_>]) -> Result<Self, ScoreError> {
        check_tracks(tracks)?;
        Ok(TrajectoryScores::of_checked(tracks, pose::drift(tracks)))
    }

    /// Scores trajectories that are already checked, given their [drift](pose::drift) in metres.
    pub(super) fn of_checked(tracks: &[TrajectoryPair<'_>], drift: f64) -> Self {
        let near = pose::relative(tracks, pose::NEAR);
        let far = pose::relative(tracks, pose::FAR);
        TrajectoryScores {
            e_pose: e_pose(drift),
            trajectory_error: pose::absolute(tracks),
            relative_error_near: near.map(|(position, _)| position),
            relative_turn_near: near.map(|(_, heading)| heading),
            relative_error_far: far.map(|(position, _)| position),
            relative_turn_far: far.map(|(_, heading)| heading),
        }
    }
}

/// `C = |E_f and F| / |F|`.
fn coverage(truth: &MappableArea, raster: &Raster) -> f64 {
    let free = raster.free.iter().enumerate().filter(|(_, free)| **free);
    let covered = free.filter(|(cell, _)| {
        let (col, row) = raster.frame.place(*cell);
        truth.frame().cell(col, row).is_some_and(|cell| truth.free()[cell])
    });
    covered.count() as f64 / truth.free_cells() as f64
}

fn harmonic(a: f64, b: f64) -> f64 {
    if a + b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 }
}
