//! The navigator that all policies share: one costmap and one set of frontiers, and for each robot a
//! pilot that drives it to goals, looks around there, and frees it when it is stuck.

mod closed_doors;
mod door_rounds;
mod escape;
mod goal_choice;
mod progress;
mod recovery;
mod second_look;
mod state;

use envgen::geometry::{Pose, unit_vector, wrap_angle};
use glam::DVec2;

pub(super) use self::goal_choice::{Aim, Planning};
pub(super) use self::state::Navigator;

use self::progress::Progress;
use self::state::{ARRIVED, Failure, Goal, REFRESH, Task};
use super::costmap::Node;
use super::frontier::{is_left, unknown_from};
use super::pursuit::turn;
use super::{Decision, PolicyInput};
use crate::backend::{Command, TICK};

/// Radius in metres around a frontier point within which a frontier counts as the same one.
const SAME_FRONTIER: f64 = 0.3;

/// How long a robot waits for another one to pass, and the time between two decisions, in seconds.
const PATIENCE: f64 = 4.0;
const DECISION: f64 = 2.0 * TICK;

/// Time limits in seconds of a turn to an unknown place, and of either part of a recovery, for a Pioneer 3-AT.
const TURN: f64 = 6.0;
const AWAY: f64 = 4.0;

impl Navigator {
    /// Drives to goals that `choose` returns until none is left.
    pub(super) fn explore(
        &mut self,
        view: &PolicyInput<'_>,
        mut choose: impl FnMut(&mut Planning<'_>) -> Option<Node>,
    ) -> Decision {
        let decision = self.pursue(view, &mut Aim::Explore(&mut choose));
        decision.unwrap_or(Decision::Finished)
    }

    /// Drops a robot's current goal, so that it can take another aim.
    pub(super) fn interrupt(&mut self, robot: usize) {
        if let Some(pilot) = self.pilots.get_mut(robot)
            && matches!(pilot.task, Task::Go { .. } | Task::Look { .. } | Task::Rest { .. })
        {
            pilot.task = Task::Choose;
        }
    }

    /// Whether a robot is free to do something else: it is not in the middle of its first look around
    /// or of a recovery.
    pub(super) fn is_at_ease(&self, robot: usize) -> bool {
        self.pilots.get(robot).is_some_and(|pilot| {
            matches!(pilot.task, Task::Choose | Task::Go { .. } | Task::Rest { .. })
        })
    }

    /// Drives on towards an aim; `None` if it is reached or cannot be reached.
    pub(super) fn pursue(&mut self, view: &PolicyInput<'_>, aim: &mut Aim<'_>) -> Option<Decision> {
        let Some(pose) = pose_of(view) else { return Some(Decision::Drive(Command::STOP)) };
        if view.robot >= self.pilots.len() {
            return None;
        }
        self.plan_as_before(view.robot);
        self.look(view, pose);
        let mut renewed = self.refresh_if_due(view);
        // In one tick, a task may end and the next one begin, but not without limit.
        for _ in 0..4 {
            let pilot = &mut self.pilots[view.robot];
            match pilot.task {
                Task::Begin => {
                    let until = view.seen.time + self.margins.survey.1;
                    pilot.task = Task::Survey { heading: pose.heading, turned: 0.0, until };
                }
                Task::Survey { heading, turned, until } => {
                    let turned = turned + wrap_angle(pose.heading - heading);
                    let left = self.margins.survey.0 - turned;
                    let slow = self.margins.slow_survey;
                    if left > 0.1 && view.seen.time < until {
                        pilot.task = Task::Survey { heading: pose.heading, turned, until };
                        let Command { speed, turn_rate } = turn(view.body, left);
                        let most = slow.map_or(f64::INFINITY, |(rate, _)| rate);
                        let turn_rate = turn_rate.clamp(-most, most);
                        return Some(Decision::Drive(Command { speed, turn_rate }));
                    }
                    pilot.task = match slow {
                        Some((_, wait)) => Task::Settle { until: view.seen.time + wait },
                        None => Task::Choose,
                    };
                }
                Task::Settle { until } => {
                    if view.seen.time < until {
                        return Some(Decision::Drive(Command::STOP));
                    }
                    self.refresh(view);
                    self.pilots[view.robot].task = Task::Choose;
                }
                Task::Choose => {
                    self.plan_for(view.robot, false);
                    let found = self.choose(view, pose, aim)
                        || self.look_again(view, pose, aim)
                        || matches!(aim, Aim::Explore(_)) && self.look_for_doors(view, pose);
                    if !found {
                        self.pilots[view.robot].task = Task::Rest { since: view.seen.time };
                        return None;
                    }
                }
                Task::Rest { since } => {
                    if view.seen.time - since < REFRESH {
                        return None;
                    }
                    pilot.task = Task::Choose;
                }
                Task::Go { .. } => {
                    if let Some(decision) = self.go(view, pose, &mut renewed) {
                        return Some(decision);
                    }
                }
                Task::Look { frontier, heading, until } => {
                    let off = wrap_angle(heading - pose.heading);
                    if view.seen.time < until && off.abs() > 0.15 {
                        return Some(Decision::Drive(turn(view.body, off)));
                    }
                    let look = self.margins.look;
                    if until - view.seen.time > look {
                        pilot.task = Task::Look { frontier, heading, until: view.seen.time + look };
                    }
                    if view.seen.time < until {
                        return Some(Decision::Drive(Command::STOP));
                    }
                    self.refresh(view);
                    if is_left(&self.costmap, frontier, SAME_FRONTIER) {
                        self.failures.push(Failure { at: frontier, is_final: true, active: true });
                    }
                    self.pilots[view.robot].task = Task::Choose;
                }
                Task::BackOff { from, until } => {
                    let done = from.distance(pose.position) >= self.margins.back_off.0
                        || view.seen.time >= until;
                    if !done && !view.seen.bumped && self.is_free_behind(view.body, pose) {
                        let speed = -self.margins.back_off.1;
                        return Some(Decision::Drive(Command { speed, turn_rate: 0.0 }));
                    }
                    let heading = pose.heading + self.open_side();
                    let pilot = &mut self.pilots[view.robot];
                    pilot.task =
                        Task::TurnAway { heading, until: self.margins.limit(view.seen.time, AWAY) };
                }
                Task::Escape { stage, until } => {
                    if let Some(decision) = self.escape(view, pose, stage, until) {
                        return Some(decision);
                    }
                }
                Task::TurnAway { heading, until } => {
                    let off = wrap_angle(heading - pose.heading);
                    if off.abs() > 0.2 && view.seen.time < until {
                        return Some(Decision::Drive(turn(view.body, off)));
                    }
                    self.refresh(view);
                    self.pilots[view.robot].task = Task::Choose;
                }
            }
        }
        Some(Decision::Drive(Command::STOP))
    }

    /// Drives straight to a point nearby, for policies that plan their own paths; `None` if the robot
    /// is stuck there.
    pub(super) fn steer(&mut self, view: &PolicyInput<'_>, target: DVec2) -> Option<Decision> {
        let pose = pose_of(view)?;
        if view.robot >= self.pilots.len() {
            return None;
        }
        self.plan_for(view.robot, false);
        self.look(view, pose);
        self.refresh_if_due(view);
        let pilot = &mut self.pilots[view.robot];
        let waits = other_ahead(view, pose, self.margins.meeting).is_some();
        if waits || pilot.progress.is_stuck(view.seen.time, pose.position, self.margins.stuck) {
            pilot.progress = Progress::default();
            return None;
        }
        pilot.path.set(&mut self.costmap, &[pose.position, target]);
        let (path, pursuit) = (&mut pilot.path, &mut pilot.pursuit);
        let command =
            pursuit.follow(view.body, pose, path, &mut self.costmap, &self.guard, &self.margins);
        pilot.progress.wants(command, view.seen.time);
        Some(Decision::Drive(command))
    }

    /// Processes what a robot sees: obstacles ahead, and water, which is remembered.
    fn look(&mut self, view: &PolicyInput<'_>, pose: Pose) {
        self.guard.look(view.scan, view.since_scan);
        self.guard.look_at_water(pose, view.water);
        for &p in view.water {
            self.costmap.mark_water(p);
        }
        self.doors.visit(pose.position);
    }

    /// Whether the map shows a frontier anywhere in the area to map.
    pub(super) fn has_frontiers(&mut self, view: &PolicyInput<'_>) -> bool {
        self.costmap.refresh(view.map);
        self.frontiers.gather(&mut self.costmap, |_, p| !view.area.contains(p));
        self.frontiers.goals() > 0
    }

    /// Drives on; `None` when the task ends. `renewed` says whether the map has changed since the path
    /// was planned.
    fn go(&mut self, view: &PolicyInput<'_>, pose: Pose, renewed: &mut bool) -> Option<Decision> {
        let pilot = &mut self.pilots[view.robot];
        let Task::Go { goal, deadline, squeezes } = pilot.task else { return None };
        if let Some(ahead) = other_ahead(view, pose, self.margins.meeting) {
            // The robot with the higher number lets the other pass. After a while both look for another
            // path, on which the other robot is an obstacle.
            if ahead < view.robot && pilot.waited < PATIENCE * self.margins.slowness {
                pilot.waited += DECISION;
                return Some(Decision::Drive(Command::STOP));
            }
            // Only once per renewal: the path that is found then is driven.
            if std::mem::take(renewed) {
                pilot.task = Task::Choose;
                return None;
            }
        } else {
            pilot.waited = 0.0;
        }
        if pilot.progress.is_stuck(view.seen.time, pose.position, self.margins.stuck)
            || view.seen.time > deadline
        {
            return self.recover(view, pose, goal, squeezes);
        }
        if *renewed {
            let gone = match goal {
                Goal::Frontier(at) => !is_left(&self.costmap, at, SAME_FRONTIER),
                Goal::Place(_) => false,
            };
            if gone || !pilot.path.is_passable(&mut self.costmap, 5.0) {
                pilot.task = Task::Choose;
                return None;
            }
        }
        // Close to a wall the robot stops a little earlier.
        let held_up = pilot.progress.stalled > 0.2 * self.margins.stuck.1;
        let arrived = if held_up { 2.0 * ARRIVED } else { ARRIVED };
        let near = pilot.path.end().is_none_or(|end| end.distance(pose.position) < arrived);
        if near && pilot.path.left() < 2.0 * ARRIVED {
            pilot.progress = Progress::default();
            pilot.task = match goal {
                Goal::Frontier(frontier) => {
                    let to = unknown_from(&self.costmap, pose.position, frontier);
                    match to {
                        Some(to) => Task::Look {
                            frontier,
                            heading: libm::atan2(to.y, to.x) - view.body.laser_mount.heading,
                            until: self
                                .margins
                                .limit(view.seen.time, TURN)
                                .max(view.seen.time + 2.0 * self.margins.look),
                        },
                        None => Task::Choose,
                    }
                }
                Goal::Place(_) => Task::Choose,
            };
            return None;
        }
        let (path, pursuit) = (&mut pilot.path, &mut pilot.pursuit);
        let command =
            pursuit.follow(view.body, pose, path, &mut self.costmap, &self.guard, &self.margins);
        pilot.progress.wants(command, view.seen.time);
        Some(Decision::Drive(command))
    }
}

/// The pose estimate of the robot that is asked for, if it is finite.
pub(super) fn pose_of(view: &PolicyInput<'_>) -> Option<Pose> {
    let pose = view.estimates.get(view.robot)?.pose;
    (pose.position.is_finite() && pose.heading.is_finite()).then_some(pose)
}

/// Another robot that is nearer than `meeting` metres and in the direction in which this one drives.
fn other_ahead(view: &PolicyInput<'_>, pose: Pose, meeting: f64) -> Option<usize> {
    let ahead = unit_vector(pose.heading);
    let mut others = view.estimates.iter().enumerate().filter(|(other, _)| *other != view.robot);
    let found = others.find(|(_, other)| {
        let to = other.pose.position - pose.position;
        to.length() < meeting && ahead.dot(to) > 0.3 * to.length()
    });
    found.map(|(other, _)| other)
}
