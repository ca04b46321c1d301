//! Simultaneous localisation and mapping, which estimates the robots' poses and the map from their
//! measurements.
//!
//! | Estimator | Poses | Map error left by a loop |
//! |---|---|---|
//! | [`DeadReckoning`] | from the wheels alone | all drift of the wheels |
//! | [`ScanToMap`] | from each scan, matched against all earlier keyframes | the drift along the loop |
//! | [`PoseGraph`] | the same, with loop closing at old places that are found again | little |
//!
//! All of them take a keyframe every 0.3 m or 15 degrees, and draw its scan into one
//! [`OccupancyMap`](crate::map::OccupancyMap) that the robots share. Between keyframes, poses come from
//! the wheels.
//!
//! Estimators that match scans do more. They also correct poses by every scan of which most walls are
//! on the map. Where walls hold the pose, they learn those systematic errors of the wheels that
//! [`WheelCalibration`] names.

mod estimator;
mod fusion;
mod incremental;
mod lattice;
pub mod likelihood;
mod loop_closing;
mod mapper;
pub mod matcher;
pub(crate) mod motion;
mod pose_graph;
mod pose_graph_solver;
pub mod scan_insertion;
mod surfels;
pub mod sweep;
mod track;
mod walls;
mod wheel_calibration;

use envgen::geometry::Pose;
use serde::{Deserialize, Serialize};

pub use estimator::Slam;
pub use incremental::{DeadReckoning, Incremental, ScanToMap};
pub use pose_graph::PoseGraph;
pub use wheel_calibration::WheelCalibration;

use crate::lidar::LaserProfile;
use crate::robot::Robot;

/// Fewest beams, least field of view in radians and least range in metres with which scan matching was seen to keep the
/// pose of robots in buildings.
const FEWEST_BEAMS: u32 = 24;
const LEAST_VIEW: f64 = 1.5;
const LEAST_RANGE: f64 = 3.0;

/// The built-in estimators.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
pub enum SlamKind {
    /// Poses from the wheels alone: [`DeadReckoning`].
    DeadReckoning,
    /// Scan matching without loop closing: [`ScanToMap`].
    #[default]
    ScanToMap,
    /// Scan matching with loop closing: [`PoseGraph`].
    PoseGraph,
}

impl SlamKind {
    /// All of them.
    pub const ALL: [SlamKind; 3] =
        [SlamKind::DeadReckoning, SlamKind::ScanToMap, SlamKind::PoseGraph];

    /// Returns why the estimator may be no better than the wheels with a laser, or worse, as a text for a person. With
    /// lasers that see less, the errors of the pose were metres in maps of 18 m.
    ///
    /// ```
    /// use mapping_trial::{lidar::LaserProfile, slam::SlamKind};
    ///
    /// let few = LaserProfile { beams: 8, ..Default::default() };
    /// let text = SlamKind::ScanToMap.doubt(&few).expect("too few beams");
    /// assert!(text.starts_with("scan matching needs 24 beams or more, and the laser has 8"));
    /// assert_eq!(SlamKind::ScanToMap.doubt(&LaserProfile::default()), None);
    /// assert_eq!(SlamKind::DeadReckoning.doubt(&few), None);
    /// ```
    pub fn doubt(self, laser: &LaserProfile) -> Option<String> {
        if self == SlamKind::DeadReckoning {
            return None;
        }
        let LaserProfile { beams, field_of_view, max_range, .. } = *laser;
        let short = if beams < FEWEST_BEAMS {
            format!("{FEWEST_BEAMS} beams or more, and the laser has {beams}")
        } else if field_of_view < LEAST_VIEW {
            let degrees = field_of_view.to_degrees();
            format!("about 90 degrees or more, and the laser sees {degrees:.0}")
        } else if max_range < LEAST_RANGE {
            format!("a range of {LEAST_RANGE} m or more, and the laser has {max_range} m")
        } else {
            return None;
        };
        Some(format!(
            "scan matching needs {short}: poses may be no better than those of the wheels, or worse"
        ))
    }

    /// Creates an estimator for robots at the poses `starts`, all with the same body and laser. It
    /// learns those errors of the wheels that `calibration` names.
    ///
    /// ```
    /// use envgen::geometry::Pose;
    /// use mapping_trial::backend::Observation;
    /// use mapping_trial::lidar::{LaserProfile, Scan};
    /// use mapping_trial::{map::Cell, map::CellIndex, robot::Robot};
    /// use mapping_trial::slam::{SlamKind, WheelCalibration};
    ///
    /// let (robot, laser) = (Robot::default(), LaserProfile::default());
    /// let calibration = WheelCalibration::default();
    /// for kind in SlamKind::ALL {
    ///     let mut slam = kind.build(&[Pose::default()], &robot, &laser, calibration);
    ///     // A wall all around, 2 m from the laser, which is 0.21 m ahead of the robot's centre.
    ///     let scan = Some(Scan { ranges: vec![2.0; 181] });
    ///     slam.step(0, &Observation { scan, ..Default::default() });
    ///     let wall = envgen::glam::DVec2::new(2.21 + 0.001, 0.0);
    ///     assert_eq!(slam.map().cell(CellIndex::of(wall)), Cell::Occupied);
    ///     assert_eq!(slam.trajectory(0).len(), 2);
    /// }
    /// ```
    pub fn build(
        self,
        starts: &[Pose],
        robot: &Robot,
        laser: &LaserProfile,
        calibration: WheelCalibration,
    ) -> Box<dyn Slam + Send + Sync> {
        match self {
            SlamKind::DeadReckoning => Box::new(DeadReckoning::new(starts, robot, laser)),
            SlamKind::ScanToMap => {
                Box::new(ScanToMap::new(starts, robot, laser).with_calibration(calibration))
            }
            SlamKind::PoseGraph => {
                Box::new(PoseGraph::new(starts, robot, laser).with_calibration(calibration))
            }
        }
    }
}
