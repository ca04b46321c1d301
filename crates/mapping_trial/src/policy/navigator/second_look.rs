//! What a robot does before it has nothing left to explore: obstacles that were seen wrongly, or poses
//! that were wrong, may have closed the path to what is left.

use envgen::geometry::Pose;

use super::goal_choice::{Aim, Planning};
use super::state::{Goal, Navigator, Task};
use crate::policy::PolicyInput;

/// Greatest number of times that a robot looks around again.
const LOOKS: u32 = 4;

/// Greatest number of goals that it tries through gaps that are too narrow on the map.
const NARROW_GOALS: u32 = 6;

/// Frontier cells that make one of those goals worth it: 1 m, as wide as a doorway.
const WIDE: usize = 20;

impl Navigator {
    /// Tries what is left: first the robot forgets what failed and looks all around, then it takes
    /// gaps that are a little too narrow on the map, in which the laser has to keep it off the
    /// walls. False if there is nothing left to try.
    pub(super) fn look_again(
        &mut self,
        view: &PolicyInput<'_>,
        pose: Pose,
        aim: &mut Aim<'_>,
    ) -> bool {
        if !matches!(aim, Aim::Explore(_)) {
            return false;
        }
        let pilot = &mut self.pilots[view.robot];
        let second = &mut pilot.second;
        if second.looks < LOOKS && (second.looks == 0 || second.goals > second.goals_before) {
            second.looks += 1;
            second.goals_before = second.goals;
            pilot.avoid.clear();
            pilot.task = Task::Begin;
            self.failures.clear();
            return true;
        }
        if second.narrow_goals >= NARROW_GOALS {
            return false;
        }
        second.narrow_goals += 1;
        self.plan_for(true);
        let mut wide = |planning: &mut Planning<'_>| {
            let frontiers = &*planning.frontiers;
            let wide: Vec<bool> = (0..frontiers.len())
                .map(|cluster| frontiers.cells(cluster).len() >= WIDE)
                .collect();
            planning.nearest_of(|cluster| wide[cluster])
        };
        let found = self.choose(view, pose, &mut Aim::Explore(&mut wide));
        if let Task::Go { goal: goal @ Goal::Frontier(_), deadline, waited, .. } =
            self.pilots[view.robot].task
            && found
        {
            // A goal that is not reached does not count against the robot.
            self.pilots[view.robot].task = Task::Go { goal, deadline, squeezes: true, waited };
        } else {
            self.plan_for(false);
        }
        found
    }
}
