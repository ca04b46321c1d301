//! What all policies share: one costmap and one set of frontiers, and a pilot for each robot that
//! drives it to goals, looks around there and frees it when it is stuck.

mod escape;
mod recovery;
mod second_look;

use std::collections::VecDeque;

use envgen::geometry::{Pose, unit_vector, wrap_angle};
use glam::DVec2;

use self::escape::Escape;
use self::recovery::Progress;
use self::second_look::SecondLook;
use super::costmap::{CellCost, Costmap, Node};
use super::frontier::{Frontiers, is_left, unknown_from};
use super::guard::Guard;
use super::margins::Margins;
use super::path::Path;
use super::pursuit::{Pursuit, turn};
use super::search::{COST_PER_METRE, GridPlanner, KeepoutZone};
use super::{Decision, PolicyInput};
use crate::backend::{Command, TICK};
use crate::lidar::LaserProfile;
use crate::map::CellIndex;
use crate::robot::Robot;

/// Seconds between two updates from the map.
const REFRESH: f64 = 1.0;

/// Distance in metres from its goal at which a robot has arrived.
const ARRIVED: f64 = 0.25;

/// Metres around a frontier point within which a frontier is still the same one.
const SAME_FRONTIER: f64 = 0.3;

/// Radius in metres around a failed goal in which other goals are excluded.
const FAILED: f64 = 0.5;

/// Share of the laser's range within which a wall has to be for a goal to be in sight of it:
/// from there at least as long a piece of the wall is seen as its distance.
const IN_SIGHT: f64 = 0.6;

/// Metres around another robot's goal that are left to it.
const TAKEN: f64 = 2.0;

/// Seconds that a robot waits for another one to pass, and seconds between two decisions.
const PATIENCE: f64 = 4.0;
const DECISION: f64 = 2.0 * TICK;

/// Seconds that a robot looks at an unknown place before it gives it up: two scans and the map.
const LOOK: f64 = 0.6;

/// The input for the choice of a goal: everything that is known, and the robot's pose.
pub(super) struct Planning<'a> {
    pub(super) costmap: &'a mut Costmap,
    pub(super) frontiers: &'a mut Frontiers,
    pub(super) search: &'a mut GridPlanner,
    /// Where the robot is.
    pub(super) pose: Pose,
    /// Where no path may lead.
    pub(super) blocks: &'a [KeepoutZone],
    /// The worst cell cost on paths.
    pub(super) limit: CellCost,
}

impl Planning<'_> {
    /// The nearest goal.
    pub(super) fn nearest(&mut self) -> Option<Node> {
        self.nearest_of(|_| true)
    }

    /// The nearest goal of the clusters for which `wanted` is true.
    pub(super) fn nearest_of(&mut self, wanted: impl Fn(usize) -> bool) -> Option<Node> {
        let Planning { costmap, frontiers, search, pose, blocks, .. } = self;
        if frontiers.goals() == 0 {
            return None;
        }
        let goal = |node, _| frontiers.cluster_at(node).is_some_and(&wanted);
        search.nearest(costmap, pose.position, blocks, goal)
    }
}

/// What a robot is to do.
pub(super) enum Aim<'a> {
    /// Uncover the frontiers that this chooses.
    Explore(&'a mut dyn FnMut(&mut Planning<'_>) -> Option<Node>),
    /// Go to a position.
    Visit(DVec2),
}

/// Drives robots to goals.
#[derive(Debug)]
pub(super) struct Navigator {
    pub(super) costmap: Costmap,
    /// Circumscribed radius of the robots in metres.
    radius: f64,
    /// Whether the costmap is that of a slimmer robot.
    is_slim: bool,
    frontiers: Frontiers,
    search: GridPlanner,
    pub(super) guard: Guard,
    pilots: Vec<Pilot>,
    failures: Vec<Failure>,
    refreshed: f64,
    blocks: Vec<KeepoutZone>,
    cells: Vec<DVec2>,
    pub(super) margins: Margins,
}

/// A frontier that could not be uncovered.
#[derive(Clone, Copy, Debug)]
struct Failure {
    at: DVec2,
    /// Whether a look at it failed, or it had its second chance.
    is_final: bool,
    active: bool,
}

/// The state of one robot.
#[derive(Debug, Default)]
struct Pilot {
    path: Path,
    pursuit: Pursuit,
    task: Task,
    progress: Progress,
    recovered: VecDeque<f64>,
    recoveries: u32,
    avoid: Vec<(f64, KeepoutZone)>,
    second: SecondLook,
    /// How often it escaped from where it was stuck.
    escapes: u32,
}

#[derive(Clone, Copy, Debug, Default)]
enum Task {
    /// Look all around: the beginning of every run, when too little may be known to choose.
    #[default]
    Begin,
    /// The same, after its first heading is known: how far it has turned.
    Survey { heading: f64, turned: f64, until: f64 },
    /// Choose a goal.
    Choose,
    /// Drive to a goal.
    Go { goal: Goal, deadline: f64, squeezes: bool, waited: f64 },
    /// Turn to what is unknown around a frontier, and look.
    Look { frontier: DVec2, heading: f64, until: f64 },
    /// Back off from where the robot is stuck.
    BackOff { from: DVec2, until: f64 },
    /// Turn away from it.
    TurnAway { heading: f64, until: f64 },
    /// Drive out of where it is stuck, by the laser alone.
    Escape { stage: Escape, until: f64 },
    /// Nothing is left to do, as of this time.
    Rest { since: f64 },
}

/// The goals that are excluded out of caution.
#[derive(Clone, Copy, Debug)]
struct Restraint {
    /// Those from which no known wall is seen: the pose would depend on the wheels alone there.
    in_sight: bool,
    /// Those that are near other robots' goals.
    others: bool,
}

/// Where a robot is going.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Goal {
    /// A frontier cell to uncover.
    Frontier(DVec2),
    /// A position.
    Place(DVec2),
}

impl Navigator {
    pub(super) fn new(robots: usize, robot: &Robot, laser: &LaserProfile) -> Self {
        Navigator {
            costmap: Costmap::new(robot),
            radius: robot.circumscribed_radius,
            is_slim: false,
            frontiers: Frontiers::new(),
            search: GridPlanner::new(),
            guard: Guard::new(robot, laser),
            pilots: (0..robots).map(|_| Pilot::default()).collect(),
            failures: Vec::new(),
            refreshed: f64::NEG_INFINITY,
            blocks: Vec::new(),
            cells: Vec::new(),
            margins: Margins::of(robot, laser),
        }
    }

    pub(super) fn recoveries(&self, robot: usize) -> u32 {
        self.pilots.get(robot).map_or(0, |pilot| pilot.recoveries)
    }

    pub(super) fn path(&self, robot: usize) -> &[DVec2] {
        self.pilots.get(robot).map_or(&[], |pilot| pilot.path.points())
    }

    /// Drives to goals that `choose` returns until none is left.
    pub(super) fn explore(
        &mut self,
        view: &PolicyInput<'_>,
        mut choose: impl FnMut(&mut Planning<'_>) -> Option<Node>,
    ) -> Decision {
        let decision = self.pursue(view, &mut Aim::Explore(&mut choose));
        decision.unwrap_or(Decision::Finished)
    }

    /// Drops a robot's current goal, so that another aim takes effect.
    pub(super) fn interrupt(&mut self, robot: usize) {
        if let Some(pilot) = self.pilots.get_mut(robot)
            && matches!(pilot.task, Task::Go { .. } | Task::Look { .. } | Task::Rest { .. })
        {
            pilot.task = Task::Choose;
        }
    }

    /// Whether a robot is free to do something else: not in the middle of its first look around or
    /// of a recovery.
    pub(super) fn is_at_ease(&self, robot: usize) -> bool {
        self.pilots.get(robot).is_some_and(|pilot| {
            matches!(pilot.task, Task::Choose | Task::Go { .. } | Task::Rest { .. })
        })
    }

    /// Drives on towards an aim; `None` if it is reached or cannot be.
    pub(super) fn pursue(&mut self, view: &PolicyInput<'_>, aim: &mut Aim<'_>) -> Option<Decision> {
        let Some(pose) = pose_of(view) else { return Some(Decision::Drive(Command::STOP)) };
        if view.robot >= self.pilots.len() {
            return None;
        }
        self.look(view, pose);
        let renewed = view.seen.time - self.refreshed >= REFRESH;
        if renewed {
            self.refresh(view);
        }
        // A task may end and another begin in the same tick, but not without a limit.
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
                    if left > 0.1 && view.seen.time < until {
                        pilot.task = Task::Survey { heading: pose.heading, turned, until };
                        return Some(Decision::Drive(turn(view.body, left)));
                    }
                    pilot.task = Task::Choose;
                }
                Task::Choose => {
                    self.plan_for(false);
                    if !(self.choose(view, pose, aim) || self.look_again(view, pose, aim)) {
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
                    if let Some(decision) = self.go(view, pose, renewed) {
                        return Some(decision);
                    }
                }
                Task::Look { frontier, heading, until } => {
                    let off = wrap_angle(heading - pose.heading);
                    if view.seen.time < until && off.abs() > 0.15 {
                        return Some(Decision::Drive(turn(view.body, off)));
                    }
                    if view.seen.time < until.min(view.seen.time + 1.0)
                        && until - view.seen.time > LOOK
                    {
                        pilot.task = Task::Look { frontier, heading, until: view.seen.time + LOOK };
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
                    pilot.task = Task::TurnAway { heading, until: view.seen.time + 4.0 };
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

    /// Drives straight to a point nearby, for policies that plan their paths themselves; `None`
    /// if the robot is stuck there.
    pub(super) fn steer(&mut self, view: &PolicyInput<'_>, target: DVec2) -> Option<Decision> {
        let pose = pose_of(view)?;
        self.plan_for(false);
        self.look(view, pose);
        if view.seen.time - self.refreshed >= REFRESH {
            self.refresh(view);
        }
        let pilot = self.pilots.get_mut(view.robot)?;
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

    /// Takes in what a robot sees: obstacles ahead, and water for later.
    fn look(&mut self, view: &PolicyInput<'_>, pose: Pose) {
        self.guard.look(view.scan);
        self.guard.look_at_water(pose, view.water);
        for &p in view.water {
            self.costmap.mark_water(p);
        }
    }

    /// Whether the map shows a frontier anywhere in the area to map.
    pub(super) fn has_frontiers(&mut self, view: &PolicyInput<'_>) -> bool {
        self.costmap.refresh(view.map);
        self.frontiers.gather(&mut self.costmap, |_, p| !view.area.contains(p));
        self.frontiers.goals() > 0
    }

    /// Takes over the changes of the map.
    fn refresh(&mut self, view: &PolicyInput<'_>) {
        self.costmap.refresh(view.map);
        self.refreshed = view.seen.time;
    }

    /// Drives on; `None` when the task ends.
    fn go(&mut self, view: &PolicyInput<'_>, pose: Pose, renewed: bool) -> Option<Decision> {
        let pilot = &mut self.pilots[view.robot];
        let Task::Go { goal, deadline, squeezes, waited } = pilot.task else { return None };
        if let Some(ahead) = other_ahead(view, pose, self.margins.meeting) {
            // The robot with the higher number lets the other pass; after a while both look for
            // another path, on which the other is an obstacle.
            if ahead < view.robot && waited < PATIENCE {
                let waited = waited + DECISION;
                pilot.task = Task::Go { goal, deadline, squeezes, waited };
                return Some(Decision::Drive(Command::STOP));
            }
            if renewed {
                pilot.task = Task::Choose;
                return None;
            }
        }
        if pilot.progress.is_stuck(view.seen.time, pose.position, self.margins.stuck)
            || view.seen.time > deadline
        {
            return self.recover(view, pose, goal, squeezes);
        }
        if renewed {
            let gone = match goal {
                Goal::Frontier(at) => !is_left(&self.costmap, at, SAME_FRONTIER),
                Goal::Place(_) => false,
            };
            if gone || !pilot.path.is_passable(&mut self.costmap, 5.0) {
                pilot.task = Task::Choose;
                return None;
            }
        }
        // Before a wall the robot stops a little earlier.
        let held_up = pilot.progress.stalled > 1.0;
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
                            heading: libm::atan2(to.y, to.x),
                            until: view.seen.time + 6.0,
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

    /// Chooses a goal and plans the path to it; false if no goal is left.
    fn choose(&mut self, view: &PolicyInput<'_>, pose: Pose, aim: &mut Aim<'_>) -> bool {
        self.costmap.refresh(view.map);
        self.collect_blocks(view);
        match aim {
            Aim::Visit(place) => self.plan_visit(view, pose, *place),
            Aim::Explore(choose) => {
                let Some((node, squeezes)) = self.choose_frontier(view, pose, choose) else {
                    return false;
                };
                let Some(cluster) = self.frontiers.cluster_at(node) else { return false };
                let point = self.costmap.point(node);
                let cell = self.frontiers.nearest_cell(cluster, point);
                let frontier = cell.map_or(point, CellIndex::centre);
                self.set_path(view, node, Goal::Frontier(frontier), squeezes);
                true
            }
        }
    }

    fn plan_visit(&mut self, view: &PolicyInput<'_>, pose: Pose, place: DVec2) -> bool {
        if place.distance(pose.position) < 2.0 * ARRIVED {
            return false;
        }
        let Navigator { costmap, search, blocks, .. } = self;
        search.set_worst_allowed(CellCost::Tight);
        let Some(node) = search.to(costmap, pose.position, blocks, place) else { return false };
        self.set_path(view, node, Goal::Place(place), false);
        true
    }

    /// A goal, and whether its path leads through gaps that the robot may not fit through. Exclusions
    /// are dropped step by step: first the sight of walls, then other robots' goals, then
    /// where this one was stuck, then the goals that failed once, at last the width of gaps.
    fn choose_frontier(
        &mut self,
        view: &PolicyInput<'_>,
        pose: Pose,
        choose: &mut dyn FnMut(&mut Planning<'_>) -> Option<Node>,
    ) -> Option<(Node, bool)> {
        let (fits, mut restraint) = (CellCost::Tight, Restraint { in_sight: true, others: true });
        if let Some(node) = self.search_goal(view, pose, fits, restraint, choose) {
            return Some((node, false));
        }
        restraint.in_sight = false;
        if let Some(node) = self.search_goal(view, pose, fits, restraint, choose) {
            return Some((node, false));
        }
        restraint.others = false;
        if view.estimates.len() > 1
            && let Some(node) = self.search_goal(view, pose, fits, restraint, choose)
        {
            return Some((node, false));
        }
        if !self.pilots[view.robot].avoid.is_empty() {
            self.pilots[view.robot].avoid.clear();
            self.collect_blocks(view);
            if let Some(node) = self.search_goal(view, pose, fits, restraint, choose) {
                return Some((node, false));
            }
        }
        if self.failures.iter().any(|failure| failure.active && !failure.is_final) {
            for failure in &mut self.failures {
                failure.active &= failure.is_final;
            }
            if let Some(node) = self.search_goal(view, pose, fits, restraint, choose) {
                return Some((node, false));
            }
        }
        let node = self.search_goal(view, pose, CellCost::Squeeze, restraint, choose)?;
        Some((node, true))
    }

    fn search_goal(
        &mut self,
        view: &PolicyInput<'_>,
        pose: Pose,
        limit: CellCost,
        restraint: Restraint,
        choose: &mut dyn FnMut(&mut Planning<'_>) -> Option<Node>,
    ) -> Option<Node> {
        let Navigator { costmap, frontiers, search, pilots, failures, blocks, .. } = self;
        let near = |at: DVec2, p: DVec2, radius: f64| at.distance_squared(p) < radius * radius;
        let others = pilots.iter().enumerate().filter(|(other, _)| *other != view.robot);
        let taken = |p: DVec2| {
            restraint.others
                && others.clone().any(|(_, pilot)| match pilot.task {
                    Task::Go { goal: Goal::Frontier(at), .. } => near(at, p, TAKEN),
                    _ => false,
                })
        };
        let sight = IN_SIGHT * view.laser.max_range;
        let feet = self.margins.feet;
        let ruled_out = |costmap: &Costmap, p: DVec2| {
            near(pose.position, p, feet)
                || !view.area.contains(p)
                || taken(p)
                || failures.iter().any(|failure| failure.active && near(failure.at, p, FAILED))
                || (restraint.in_sight && !costmap.is_occupied_within(p, sight))
        };
        frontiers.gather(costmap, ruled_out);
        search.set_worst_allowed(limit);
        choose(&mut Planning { costmap, frontiers, search, pose, blocks, limit })
    }

    fn set_path(&mut self, view: &PolicyInput<'_>, node: Node, goal: Goal, squeezes: bool) {
        let cost = self.search.cost(node).unwrap_or(0);
        self.search.path_to(&self.costmap, node, &mut self.cells);
        let pilot = &mut self.pilots[view.robot];
        pilot.second.note_goal();
        pilot.path.set(&mut self.costmap, &self.cells);
        let length = f64::from(cost) / f64::from(COST_PER_METRE);
        let deadline = view.seen.time + 30.0 + length / self.margins.slowest;
        pilot.task = Task::Go { goal, deadline, squeezes, waited: 0.0 };
    }

    /// The zones where no path of a robot may lead for now.
    fn collect_blocks(&mut self, view: &PolicyInput<'_>) {
        let pilot = &mut self.pilots[view.robot];
        pilot.avoid.retain(|(until, _)| *until > view.seen.time);
        self.blocks.clear();
        self.blocks.extend(pilot.avoid.iter().map(|(_, block)| *block));
        let others = view.estimates.iter().enumerate().filter(|(other, _)| *other != view.robot);
        self.blocks.extend(others.map(|(_, other)| KeepoutZone {
            center: other.pose.position,
            radius: 2.0 * view.body.circumscribed_radius + 0.1,
        }));
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
