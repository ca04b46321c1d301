//! Recovery of robots that make no progress: noticing it, and backing off.

use envgen::geometry::{Pose, unit_vector};
use glam::DVec2;

use super::AWAY;
use super::progress::Progress;
use super::state::{FAILED, Failure, Goal, Navigator, Task};
use crate::map::{Cell, CellIndex, RESOLUTION};
use crate::policy::search::KeepoutZone;
use crate::policy::{Decision, PolicyInput};
use crate::robot::Robot;

/// Number of recoveries within a number of seconds after which backing off does not help.
const HOPELESS: (usize, f64) = (3, 60.0);

/// Time in seconds for which the robot avoids a place where it got stuck.
const AVOID: f64 = 90.0;

impl Navigator {
    /// Begins to free a robot that is stuck. It escapes instead if that has happened too often.
    pub(super) fn recover(
        &mut self,
        view: &PolicyInput<'_>,
        pose: Pose,
        goal: Goal,
        squeezes: bool,
    ) -> Option<Decision> {
        if let Goal::Frontier(at) = goal {
            let is_final = self
                .failures
                .iter()
                .any(|failure| !failure.active && failure.at.distance(at) < FAILED);
            let is_final = is_final || squeezes;
            self.failures.push(Failure { at, is_final, active: true });
        }
        let pilot = &mut self.pilots[view.robot];
        pilot.progress = Progress::default();
        pilot.recoveries += 1;
        // A narrow gap that was only tried is no reason to escape.
        if !squeezes {
            pilot.recovered.push_back(view.seen.time);
        }
        let is_long_ago = |&time: &f64| view.seen.time - time > self.margins.limit(0.0, HOPELESS.1);
        while pilot.recovered.front().is_some_and(is_long_ago) {
            pilot.recovered.pop_front();
        }
        if pilot.recovered.len() >= HOPELESS.0 {
            return self.begin_escape(view, pose);
        }
        // The unmapped obstacle, whatever it is, lies where the path led.
        let (radius, near) = self.margins.obstruction;
        let mut ahead = pose.position + unit_vector(pose.heading) * near;
        pilot.path.ahead(0.1, near + 0.3, |p| {
            ahead = p;
            true
        });
        let block = KeepoutZone { center: ahead, radius };
        pilot.avoid.push((self.margins.limit(view.seen.time, AVOID), block));
        let until = self.margins.limit(view.seen.time, AWAY);
        pilot.task = Task::BackOff { from: pose.position, until };
        pilot.path.clear();
        None
    }

    /// Whether the map shows no obstacle and no water where the robot would back off to.
    pub(super) fn is_free_behind(&self, robot: &Robot, pose: Pose) -> bool {
        let back = -unit_vector(pose.heading);
        let reach = (robot.circumscribed_radius / RESOLUTION) as i32;
        let middle = pose.position + back * 0.1;
        (-reach..=reach).all(|dy| {
            (-reach..=reach).all(|dx| {
                let off = DVec2::new(f64::from(dx), f64::from(dy)) * RESOLUTION;
                let counts = off.length() < robot.circumscribed_radius && off.dot(back) > 0.1;
                let cell = CellIndex::of(middle + off);
                let occupied = self.costmap.cell(cell) == Cell::Occupied;
                !counts || !(occupied || self.costmap.is_water(cell))
            })
        })
    }

    /// Returns the angle by which to turn to the side where the laser sees more free space.
    pub(super) fn open_side(&self) -> f64 {
        let nearest = |side: f64| {
            let echoes = self.guard.echoes().iter().filter(|echo| side * echo.y > 0.0);
            echoes.map(|echo| echo.length_squared()).fold(f64::INFINITY, f64::min)
        };
        if nearest(1.0) >= nearest(-1.0) { 1.5 } else { -1.5 }
    }
}
