//! The last attempts of a robot before it declares that nothing is left to explore. False echoes or
//! wrong poses may have closed the path to what is left.

use envgen::geometry::Pose;

use super::goal_choice::{Aim, Planning};
use super::state::{Goal, Navigator, Task};
use crate::policy::PolicyInput;

/// Greatest number of times that a robot looks around again.
const LOOKS: u32 = 4;

/// Greatest number of goals that it tries behind gaps that are too narrow on the map.
const NARROW_GOALS: u32 = 6;

/// Least number of frontier cells for which such a goal is worth it: 1 m, the width of a doorway.
const WIDE: usize = 20;

impl Navigator {
    /// Tries what is left. First the robot forgets failures and looks all around; then it tries gaps
    /// that are a little too narrow on the map, where the laser has to keep it off the walls. Returns
    /// false if there is nothing left to try.
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
        self.plan_for(view.robot, true);
        let mut wide = |planning: &mut Planning<'_>| {
            let frontiers = &*planning.frontiers;
            let wide: Vec<bool> = (0..frontiers.len())
                .map(|cluster| frontiers.cells(cluster).len() >= WIDE)
                .collect();
            planning.nearest_of(|cluster| wide[cluster])
        };
        let found = self.choose(view, pose, &mut Aim::Explore(&mut wide));
        if let Task::Go { goal: goal @ Goal::Frontier(_), deadline, .. } =
            self.pilots[view.robot].task
            && found
        {
            // A goal that is not reached does not count against the robot.
            self.pilots[view.robot].task = Task::Go { goal, deadline, squeezes: true };
        } else {
            self.plan_for(view.robot, false);
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use envgen::geometry::Rect;
    use glam::DVec2;

    use super::*;
    use crate::backend::Observation;
    use crate::lidar::{LaserProfile, Scan};
    use crate::map::{CellIndex, Estimate, OccupancyMap};
    use crate::policy::margins::Margins;
    use crate::policy::tests::input;
    use crate::policy::{Decision, PolicyKind, build};
    use crate::robot::Robot;

    /// A room of 4 x 4 m, and to the right of it, behind a wall with a gap so many cells wide, a place
    /// that is open to the unknown.
    fn draw_room(map: &mut OccupancyMap, gap: i32) {
        map.clear();
        for row in -42..42 {
            for col in -42..70 {
                let inside = (-40..40).contains(&col) && (-40..40).contains(&row);
                let free = inside || col >= 42 || (col >= 40 && (0..gap).contains(&row));
                map.add(CellIndex { col, row }, if free { -200 } else { 200 });
            }
        }
        map.touch(Rect::new(DVec2::splat(-3.0), DVec2::splat(4.0)));
    }

    /// What `nearest` does in the middle of the room until it ends or drives ahead, and how often it looked
    /// all around until then. Once it looks again, it sees the room as `second`.
    fn outcome(first: i32, second: i32) -> (Decision, f64) {
        let (body, laser) = (Robot::default(), LaserProfile::default());
        let once = Margins::of(&body, &laser).survey.0;
        let mut policy = build(PolicyKind::Nearest, 1, &body, &laser);
        let scan = Scan { ranges: vec![2.0; laser.beams as usize] };
        let (mut map, mut pose, mut turned) = (OccupancyMap::new(), Pose::default(), 0.0);
        draw_room(&mut map, first);
        let mut is_first = true;
        for tick in 0..4000 {
            let seen = Observation { time: 0.1 * f64::from(tick), ..Default::default() };
            let decision = policy.decide(&input(
                0,
                &[Estimate { pose, ..Estimate::default() }],
                (&map, &scan),
                &seen,
                (&body, &laser),
            ));
            match decision {
                Decision::Drive(command) if command.speed <= 0.0 => {
                    pose.heading += 0.1 * command.turn_rate;
                    turned += 0.1 * command.turn_rate.abs();
                }
                _ => return (decision, turned / once),
            }
            if is_first && turned > 1.2 * once {
                is_first = false;
                draw_room(&mut map, second);
            }
        }
        panic!("it neither ends nor drives ahead");
    }

    #[test]
    fn a_robot_looks_all_around_again_before_it_ends() {
        let (decision, looks) = outcome(0, 0);
        assert_eq!(decision, Decision::Finished);
        assert!((looks - 2.0).abs() < 0.2, "{looks} looks");
    }

    #[test]
    fn what_the_second_look_opens_is_explored() {
        // A door of 1.2 m, which something hid at first.
        let (decision, looks) = outcome(0, 24);
        assert!(matches!(decision, Decision::Drive(_)), "{decision:?} after {looks} looks");
        assert!(looks > 1.8, "{looks} looks");
    }

    #[test]
    fn gaps_that_are_a_little_too_narrow_on_the_map_are_tried_last() {
        // The robot is 0.71 m wide; 0.55 m and 0.4 m on the map.
        let (decision, looks) = outcome(11, 11);
        assert!(matches!(decision, Decision::Drive(_)), "{decision:?} after {looks} looks");
        assert!(looks > 1.8, "{looks} looks");
        assert_eq!(outcome(8, 8).0, Decision::Finished);
    }
}
