//! The last resort of a robot that is stuck: it looks all around and drives to where the laser sees
//! most free space, whatever the map shows.

use std::f64::consts::TAU;

use envgen::geometry::{Pose, unit_vector, wrap_angle};
use glam::DVec2;

use super::progress::Progress;
use super::state::{Escape, Navigator, Task};
use crate::backend::Command;
use crate::policy::pursuit::turn;
use crate::policy::{Decision, PolicyInput};

/// Number of escapes after which a robot that is stuck again gives up.
const MOST_ESCAPES: u32 = 6;

/// Time limit in seconds of an escape.
const TIME: f64 = 30.0;

/// Greatest distance in metres of an escape, and the distance to an echo at which it stops.
const DRIVE: (f64, f64) = (1.0, 0.12);

/// Free space ahead in metres beyond which more does not count.
const ENOUGH: f64 = 1.2;

/// Angle in radians to either side, the distance in metres up to which free space there counts, and its
/// weight. Of two directions with equal free space ahead, the one with more space beside the body is
/// better.
const SIDES: (f64, f64, f64) = (1.4, 0.3, 0.1);

impl Navigator {
    /// Begins an escape, or gives the robot up.
    pub(super) fn begin_escape(&mut self, view: &PolicyInput<'_>, pose: Pose) -> Option<Decision> {
        let pilot = &mut self.pilots[view.robot];
        if pilot.escapes >= MOST_ESCAPES {
            return Some(Decision::Stuck);
        }
        pilot.escapes += 1;
        pilot.recovered.clear();
        pilot.path.clear();
        let look = Escape::Look { heading: pose.heading, turned: 0.0, best: (pose.heading, 0.0) };
        pilot.task = Task::Escape { stage: look, until: self.margins.limit(view.seen.time, TIME) };
        None
    }

    /// Continues an escape; `None` when it ends.
    pub(super) fn escape(
        &mut self,
        view: &PolicyInput<'_>,
        pose: Pose,
        stage: Escape,
        until: f64,
    ) -> Option<Decision> {
        if view.seen.time >= until {
            self.end_escape(view);
            return None;
        }
        let (next, command) = match stage {
            Escape::Look { heading, turned, best } => {
                let turned = turned + wrap_angle(pose.heading - heading);
                let best = self.freest(pose, view.body.laser_mount.heading, best);
                // Each direction is rated while the laser faces it, even if the laser sees all around.
                let left = TAU - turned;
                if left > 0.1 {
                    let look = Escape::Look { heading: pose.heading, turned, best };
                    (look, turn(view.body, left))
                } else {
                    (Escape::Turn { heading: best.0 }, Command::STOP)
                }
            }
            Escape::Turn { heading } => {
                let off = wrap_angle(heading - pose.heading);
                if off.abs() > 0.1 {
                    (stage, turn(view.body, off))
                } else {
                    (Escape::Drive { from: pose.position }, Command::STOP)
                }
            }
            Escape::Drive { from } => {
                let free = self.guard.free_towards(DVec2::X);
                if free < DRIVE.1 || from.distance(pose.position) >= DRIVE.0 {
                    self.end_escape(view);
                    return None;
                }
                (stage, Command { speed: self.margins.creep, turn_rate: 0.0 })
            }
        };
        self.pilots[view.robot].task = Task::Escape { stage: next, until };
        Some(Decision::Drive(command))
    }

    /// Returns the better of two directions, each as its heading and its worth: `best`, and the one
    /// that the laser faces, which is `mount` from the robot's heading. The scan then sees both sides
    /// of the body.
    fn freest(&self, pose: Pose, mount: f64, best: (f64, f64)) -> (f64, f64) {
        let (angle, most, weight) = SIDES;
        let free = |angle| self.guard.free_towards(unit_vector(mount + angle));
        let beside = |angle| free(angle).min(most);
        let worth = free(0.0).min(ENOUGH) + weight * (beside(-angle) + beside(angle));
        if worth > best.1 { (pose.heading + mount, worth) } else { best }
    }

    /// Plans again, since what blocked the robot may not block it from here.
    fn end_escape(&mut self, view: &PolicyInput<'_>) {
        self.refresh(view);
        let pilot = &mut self.pilots[view.robot];
        pilot.progress = Progress::default();
        pilot.task = Task::Choose;
    }
}
