//! Graph SLAM, which closes loops by optimising a pose graph.

use envgen::geometry::Pose;

use super::estimator::Slam;
use super::loop_closing::LoopCloser;
use super::mapper::{Added, Mapper};
use super::pose_graph_solver::{Relation, held_by_walls, of_motion, solve};
use super::track::Variance;
use super::walls::{WALL_VARIANCE, constrained};
use super::wheel_calibration::WheelCalibration;
use crate::backend::Observation;
use crate::lidar::LaserProfile;
use crate::map::{Estimate, OccupancyMap};
use crate::robot::Robot;

/// Error of a closed loop, in standard deviations, beyond which all poses are optimised again.
const WORTH_SOLVING: f64 = 1.0;

/// Greatest error, in standard deviations, that a loop may have after the optimisation. Otherwise it is
/// rejected.
const INCREDIBLE: f64 = 5.0;

/// Limits on the fraction of echoes that contradict the map when it is drawn again, relative to the
/// fraction before. A true loop resolves contradictions; a false one bends the map and leaves them.
/// Where no pose moves by more than [`SMALL_MOVE`], a smaller improvement is enough.
const LESS_CONTRADICTION: f64 = 0.5;
const LESS_FOR_SMALL: f64 = 0.9;

/// Distance in metres up to which [`LESS_FOR_SMALL`] applies. Places that look alike are farther apart.
const SMALL_MOVE: f64 = 0.5;

/// Graph SLAM with loop closing.
///
/// It works as [`super::ScanToMap`], but also searches scans in places from long before. If several in
/// a row are found there, it optimises the poses of all keyframes again and draws the map from them.
#[derive(Clone, Debug)]
pub struct PoseGraph {
    mapper: Mapper,
    relations: Vec<Relation>,
    closer: LoopCloser,
}

impl PoseGraph {
    /// Creates an estimator for robots at the poses `starts`.
    pub fn new(starts: &[Pose], robot: &Robot, laser: &LaserProfile) -> Self {
        PoseGraph {
            mapper: Mapper::new(starts, robot, laser, true),
            relations: Vec::new(),
            closer: LoopCloser::new(starts.len(), laser.field_of_view),
        }
    }

    /// Sets the errors of the wheels that it learns.
    pub fn with_calibration(mut self, calibration: WheelCalibration) -> Self {
        self.mapper.calibrate(calibration);
        self
    }

    fn extend(&mut self, added: Added) {
        let keyframes = &self.mapper.keyframes;
        let new = &keyframes[added.keyframe];
        if let Some(before) = added.before {
            let measured = keyframes[before].pose.between(new.pose);
            self.relations.push(Relation {
                from: before,
                to: added.keyframe,
                measured,
                information: of_motion(added.motion.position, added.motion.heading)
                    + held_by_walls(measured, &added.walls, WALL_VARIANCE),
                is_robust: false,
            });
        }
        if let Some(found) = self.closer.take(keyframes)
            && self.close(&found.relations)
        {
            // A keyframe at an old place is as certain as that place.
            let [.., last] = found.relations;
            let old = self.mapper.keyframes[last.from].variance;
            let unknown = Variance { position: 1.0, heading: 0.1 };
            let through = old.after(constrained(unknown, &found.walls), 0.0);
            let new = &mut self.mapper.keyframes[last.to];
            if through.position < new.variance.position {
                new.variance = through;
            }
        }
    }

    /// Adds the relations of a closed loop, unless they contradict the other relations or the scans.
    fn close(&mut self, relations: &[Relation]) -> bool {
        let deviates = |poses: &[Pose], most: f64| {
            relations.iter().any(|relation| relation.deviations(poses) > most)
        };
        let known = self.relations.len();
        self.relations.extend(relations);
        let keyframes = &mut self.mapper.keyframes;
        let mut poses: Vec<Pose> = keyframes.iter().map(|keyframe| keyframe.pose).collect();
        if !deviates(&poses, WORTH_SOLVING) {
            return true;
        }
        let fixed: Vec<bool> = keyframes.iter().map(|keyframe| keyframe.is_first).collect();
        solve(&mut poses, &fixed, &self.relations);
        if deviates(&poses, INCREDIBLE) {
            self.relations.truncate(known);
            return false;
        }
        let contradiction = self.mapper.contradiction();
        let is_closed = self.mapper.place_if(poses, |before, mapper| {
            let moves = before.iter().zip(&mapper.keyframes);
            let farthest = moves.map(|(before, now)| before.position.distance(now.pose.position));
            let is_small = farthest.fold(0.0, f64::max) <= SMALL_MOVE;
            let factor = if is_small { LESS_FOR_SMALL } else { LESS_CONTRADICTION };
            mapper.contradiction() <= factor * contradiction
        });
        if !is_closed {
            self.relations.truncate(known);
        }
        is_closed
    }
}

impl Slam for PoseGraph {
    fn step(&mut self, robot: usize, seen: &Observation) {
        if let Some(added) = self.mapper.step(robot, seen.odometry, seen.scan.as_ref()) {
            self.extend(added);
        }
    }

    fn estimate(&self, robot: usize) -> Estimate {
        self.mapper.estimate(robot)
    }

    fn map(&self) -> &OccupancyMap {
        &self.mapper.map
    }

    fn trajectory(&self, robot: usize) -> Vec<Pose> {
        self.mapper.trajectory(robot)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec2};

    use super::super::mapper::tests::hall_scan;
    use super::*;
    use crate::odometry::Increment;

    /// A robot that drove 2.9 m straight on through a hall of 8 x 6 m.
    fn driven() -> PoseGraph {
        let (robot, laser) = (Robot::default(), LaserProfile::LMS200_MM);
        let mut graph = PoseGraph::new(&[Pose::default()], &robot, &laser);
        for tick in 0..30 {
            let distance = if tick == 0 { 0.0 } else { 0.1 };
            let at = DVec2::new(0.1 * f64::from(tick) + robot.laser_offset, 0.0);
            let seen = Observation {
                odometry: Increment { distance, turn: 0.0 },
                scan: Some(hall_scan(&laser, at)),
                ..Observation::default()
            };
            graph.step(0, &seen);
        }
        graph
    }

    /// The relations of a loop in which the last keyframe and the one before see the first one `off` metres
    /// aside of where they are.
    fn closed(graph: &PoseGraph, off: f64) -> [Relation; 2] {
        let keyframes = &graph.mapper.keyframes;
        let last = keyframes.len() - 1;
        [last - 1, last].map(|to| {
            let seen = keyframes[0].pose.between(keyframes[to].pose);
            Relation {
                from: 0,
                to,
                measured: Pose { position: seen.position + DVec2::new(0.0, off), ..seen },
                information: DMat3::from_diagonal(glam::DVec3::new(1e3, 1e3, 1e4)),
                is_robust: true,
            }
        })
    }

    fn poses(graph: &PoseGraph) -> Vec<Pose> {
        graph.mapper.keyframes.iter().map(|keyframe| keyframe.pose).collect()
    }

    #[test]
    fn a_true_loop_is_kept() {
        let mut graph = driven();
        let (relations, known) = (closed(&graph, 0.0), graph.relations.len());
        assert!(known > 5 && graph.close(&relations));
        assert_eq!(graph.relations.len(), known + 2);
    }

    #[test]
    fn a_loop_that_walls_contradict_is_refused() {
        let mut graph = driven();
        let (before, known) = (poses(&graph), graph.relations.len());
        assert!(!graph.close(&closed(&graph, 1.0)));
        assert_eq!((poses(&graph), graph.relations.len()), (before, known));
    }

    #[test]
    fn a_loop_that_bends_the_map_is_refused() {
        let mut graph = driven();
        // Between two keyframes the wheels may have done anything: no relation contradicts the loop, and the poses
        // behind move aside by 1 m. The scans do not fit then.
        let weak = graph.relations.len() / 2;
        graph.relations[weak].information *= 1e-9;
        let relations = closed(&graph, 1.0);
        let (mut moved, before) = (poses(&graph), poses(&graph));
        let fixed: Vec<bool> =
            graph.mapper.keyframes.iter().map(|keyframe| keyframe.is_first).collect();
        let all = [graph.relations.clone(), relations.to_vec()].concat();
        assert!(solve(&mut moved, &fixed, &all));
        assert!(relations.iter().all(|relation| relation.deviations(&moved) < INCREDIBLE));
        assert!(moved.last().is_some_and(|pose| pose.position.y > 0.9), "{moved:?}");

        let known = graph.relations.len();
        assert!(!graph.close(&relations));
        assert_eq!((poses(&graph), graph.relations.len()), (before, known));
    }
}
