//! The state that a navigator keeps for all robots and for each one.

use std::collections::VecDeque;

use glam::DVec2;

use super::door_rounds::DoorRounds;
use super::progress::Progress;
use crate::lidar::LaserProfile;
use crate::policy::PolicyInput;
use crate::policy::costmap::Costmap;
use crate::policy::frontier::Frontiers;
use crate::policy::guard::Guard;
use crate::policy::margins::Margins;
use crate::policy::path::Path;
use crate::policy::pursuit::Pursuit;
use crate::policy::search::{GridPlanner, KeepoutZone};
use crate::robot::Robot;

/// Distance in metres from its goal at which a robot has arrived.
pub(super) const ARRIVED: f64 = 0.25;

/// Radius in metres around a failed goal in which other goals are excluded.
pub(super) const FAILED: f64 = 0.5;

/// Time in seconds between two updates from the map.
pub(super) const REFRESH: f64 = 1.0;

/// By how much the robot's radius counts as smaller, in metres and at most as a fraction of it, for goals
/// behind gaps that are too narrow on the map. If both walls of a gap are off by this much, they close
/// the narrowest gaps that it fits through.
const SLIMMER: (f64, f64) = (0.1, 0.3);

/// Drives robots to goals.
#[derive(Debug)]
pub(in crate::policy) struct Navigator {
    pub(in crate::policy) costmap: Costmap,
    /// Circumscribed radius of the robots in metres.
    radius: f64,
    /// Whether the costmap is now that of a slimmer robot.
    is_slim: bool,
    pub(super) frontiers: Frontiers,
    pub(super) search: GridPlanner,
    pub(in crate::policy) guard: Guard,
    pub(super) pilots: Vec<Pilot>,
    pub(super) failures: Vec<Failure>,
    pub(super) blocks: Vec<KeepoutZone>,
    pub(super) cells: Vec<DVec2>,
    pub(in crate::policy) margins: Margins,
    pub(super) doors: DoorRounds,
}

/// A frontier that could not be uncovered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Failure {
    pub(super) at: DVec2,
    /// Whether a look at it failed, or its second chance did.
    pub(super) is_final: bool,
    pub(super) active: bool,
}

/// The state of one robot.
#[derive(Debug, Default)]
pub(super) struct Pilot {
    pub(super) path: Path,
    pub(super) pursuit: Pursuit,
    pub(super) task: Task,
    pub(super) progress: Progress,
    /// Time in seconds for which it has waited for the robot ahead of it.
    pub(super) waited: f64,
    /// When it last took over changes of the map.
    pub(super) refreshed: Option<f64>,
    /// Whether it plans for a slimmer robot.
    is_slim: bool,
    pub(super) recovered: VecDeque<f64>,
    pub(super) recoveries: u32,
    pub(super) avoid: Vec<(f64, KeepoutZone)>,
    pub(super) second: SecondLook,
    /// Number of escapes from where it was stuck.
    pub(super) escapes: u32,
}

/// The present task of a robot.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum Task {
    /// Look all around at the beginning of a run, when too little may be known for a choice.
    #[default]
    Begin,
    /// Continue to look all around: the last heading, and how far the robot has turned.
    Survey { heading: f64, turned: f64, until: f64 },
    /// Wait for a scan of where a slow laser has turned to.
    Settle { until: f64 },
    /// Choose a goal.
    Choose,
    /// Drive to a goal.
    Go { goal: Goal, deadline: f64, squeezes: bool },
    /// Turn to what is unknown around a frontier, and look.
    Look { frontier: DVec2, heading: f64, until: f64 },
    /// Back off from where the robot is stuck.
    BackOff { from: DVec2, until: f64 },
    /// Turn away from there.
    TurnAway { heading: f64, until: f64 },
    /// Escape from where the robot is stuck, by the laser alone.
    Escape { stage: Escape, until: f64 },
    /// Do nothing, since nothing has been left to do from this time on.
    Rest { since: f64 },
}

/// The goal of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Goal {
    /// A frontier cell to uncover.
    Frontier(DVec2),
    /// A position.
    Place(DVec2),
}

/// The stage of an escape.
#[derive(Clone, Copy, Debug)]
pub(super) enum Escape {
    /// Turn around: the last heading, how far the robot has turned, and the best direction so far with
    /// its worth.
    Look { heading: f64, turned: f64, best: (f64, f64) },
    /// Turn to a heading.
    Turn { heading: f64 },
    /// Drive ahead from a position.
    Drive { from: DVec2 },
}

/// The attempts of a robot after it had nothing left to explore.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SecondLook {
    pub(super) looks: u32,
    pub(super) narrow_goals: u32,
    /// Number of goals that it drove to, in all and at its last look.
    pub(super) goals: u32,
    pub(super) goals_before: u32,
}

impl Navigator {
    pub(in crate::policy) fn new(robots: usize, robot: &Robot, laser: &LaserProfile) -> Self {
        Navigator {
            costmap: Costmap::new(robot),
            radius: robot.circumscribed_radius,
            is_slim: false,
            frontiers: Frontiers::new(),
            search: GridPlanner::new(),
            guard: Guard::new(robot, laser),
            pilots: (0..robots).map(|_| Pilot::default()).collect(),
            failures: Vec::new(),
            blocks: Vec::new(),
            cells: Vec::new(),
            margins: Margins::of(robot, laser),
            doors: DoorRounds::default(),
        }
    }

    pub(in crate::policy) fn recoveries(&self, robot: usize) -> u32 {
        self.pilots.get(robot).map_or(0, |pilot| pilot.recoveries)
    }

    pub(in crate::policy) fn path(&self, robot: usize) -> &[DVec2] {
        self.pilots.get(robot).map_or(&[], |pilot| pilot.path.points())
    }

    /// Takes over changes of the map.
    pub(super) fn refresh(&mut self, view: &PolicyInput<'_>) {
        self.costmap.refresh(view.map);
        self.pilots[view.robot].refreshed = Some(view.seen.time);
    }

    /// Takes over changes of the map if the robot has not done so for a while. Returns whether it did.
    pub(super) fn refresh_if_due(&mut self, view: &PolicyInput<'_>) -> bool {
        let last = self.pilots[view.robot].refreshed;
        let is_due = last.is_none_or(|last| view.seen.time - last >= REFRESH);
        if is_due {
            self.refresh(view);
        }
        is_due
    }

    /// Plans for a robot from now on, or for a slimmer one in its place.
    pub(super) fn plan_for(&mut self, robot: usize, slim: bool) {
        self.pilots[robot].is_slim = slim;
        self.plan_as_before(robot);
    }

    /// Plans as the robot last did, since another robot may have planned in between.
    pub(super) fn plan_as_before(&mut self, robot: usize) {
        let slim = self.pilots[robot].is_slim;
        if self.is_slim != slim {
            let radius = self.radius;
            let less = if slim { SLIMMER.0.min(SLIMMER.1 * radius) } else { 0.0 };
            self.costmap.set_radius(radius - less);
            self.is_slim = slim;
        }
    }
}

impl SecondLook {
    /// Records a goal to which the robot drives.
    pub(super) fn note_goal(&mut self) {
        self.goals += 1;
    }
}
