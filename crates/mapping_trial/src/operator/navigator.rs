//! What all operators share: one costmap and one set of frontiers, and a pilot for each robot who
//! drives it to goals, looks around there and frees it when it is stuck.

use std::collections::VecDeque;
use std::f64::consts::PI;

use envgen::geometry::{Pose, unit_vector, wrap_angle};
use glam::DVec2;

use super::costmap::{Costmap, Node, SIDE};
use super::frontier::{Frontiers, is_left, unknown_from};
use super::guard::Guard;
use super::pursuit::{CRUISE, Pursuit, turn};
use super::search::{Block, METRE, Search};
use super::way::Way;
use super::{Decision, View};
use crate::body::Command;
use crate::lidar::LaserProfile;
use crate::map::{Cell, CellIndex, RESOLUTION};
use crate::robot::Robot;

/// Seconds between two looks at what has changed in the map.
const REFRESH: f64 = 1.0;

/// Distance in metres from its goal at which a robot has arrived.
const ARRIVED: f64 = 0.25;

/// Metres around a frontier point within which a frontier is still the same one.
const SAME_FRONTIER: f64 = 0.3;

/// Radius in metres of what a failed goal rules out around it.
const FAILED: f64 = 0.5;

/// Metres around a robot's middle within which it does not look for frontiers: its own feet.
const FEET: f64 = 0.4;

/// A robot that moves less than this many metres in so many seconds is stuck.
const STUCK: (f64, f64) = (0.1, 5.0);

/// This many recoveries within so many seconds, and the robot is given up.
const HOPELESS: (usize, f64) = (3, 60.0);

/// Seconds for which a place where the robot got stuck is driven around.
const AVOID: f64 = 90.0;

/// Metres and m/s of backing off.
const BACK_OFF: (f64, f64) = (0.3, 0.15);

/// Radians to turn in the beginning, with which the laser's field of view of half a circle has seen
/// all around, and the seconds after which that must do.
const FULL_TURN: f64 = 1.1 * PI;
const SURVEY: f64 = 10.0;

/// Seconds that a robot looks at an unknown place before it gives it up: two scans and the map.
const LOOK: f64 = 0.6;

/// What chooses a goal: everything that is known, and where the robot is.
pub(super) struct Planning<'a> {
    pub(super) costmap: &'a mut Costmap,
    pub(super) frontiers: &'a mut Frontiers,
    pub(super) search: &'a mut Search,
    /// Where the robot is.
    pub(super) pose: Pose,
    /// What no way may lead through.
    pub(super) blocks: &'a [Block],
}

impl Planning<'_> {
    /// The nearest goal.
    pub(super) fn nearest(&mut self) -> Option<Node> {
        let Planning { costmap, frontiers, search, pose, blocks } = self;
        let goal = |node, _| frontiers.cluster_at(node).is_some();
        search.nearest(costmap, pose.position, blocks, goal)
    }
}

/// Drives robots to goals.
#[derive(Debug)]
pub(super) struct Navigator {
    pub(super) costmap: Costmap,
    frontiers: Frontiers,
    search: Search,
    pub(super) guard: Guard,
    pilots: Vec<Pilot>,
    failures: Vec<Failure>,
    refreshed: f64,
    blocks: Vec<Block>,
    cells: Vec<DVec2>,
}

/// A frontier that could not be uncovered.
#[derive(Clone, Copy, Debug)]
struct Failure {
    at: DVec2,
    /// Whether it was looked at in vain or has had its second chance.
    is_final: bool,
    active: bool,
}

/// What a navigator knows of one robot.
#[derive(Debug, Default)]
struct Pilot {
    way: Way,
    pursuit: Pursuit,
    task: Task,
    /// Time and place at most [`STUCK`] seconds ago, while it wants to move.
    trail: VecDeque<(f64, DVec2)>,
    recovered: VecDeque<f64>,
    recoveries: u32,
    avoid: Vec<(f64, Block)>,
}

#[derive(Clone, Copy, Debug, Default)]
enum Task {
    /// Look all around: the beginning of every run, in which too little may be known to choose.
    #[default]
    Begin,
    /// The same, from a heading on: how far it has turned.
    Survey { heading: f64, turned: f64 },
    /// Choose a goal.
    Choose,
    /// Drive to a goal.
    Go { goal: Goal, deadline: f64 },
    /// Turn to what is unknown around a frontier, and look.
    Look { frontier: DVec2, heading: f64, until: f64 },
    /// Back off from where the robot is stuck.
    BackOff { from: DVec2, until: f64 },
    /// Turn away from it.
    TurnAway { heading: f64, until: f64 },
    /// Nothing is left to do, as of this time.
    Rest { since: f64 },
}

/// Where a robot is going.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Goal {
    /// A frontier cell to uncover.
    Frontier(DVec2),
    /// A place.
    Place(DVec2),
}

impl Navigator {
    pub(super) fn new(robots: usize, robot: &Robot, laser: &LaserProfile) -> Self {
        Navigator {
            costmap: Costmap::new(),
            frontiers: Frontiers::new(),
            search: Search::new(),
            guard: Guard::new(robot, laser),
            pilots: (0..robots).map(|_| Pilot::default()).collect(),
            failures: Vec::new(),
            refreshed: f64::NEG_INFINITY,
            blocks: Vec::new(),
            cells: Vec::new(),
        }
    }

    pub(super) fn recoveries(&self, robot: usize) -> u32 {
        self.pilots.get(robot).map_or(0, |pilot| pilot.recoveries)
    }

    pub(super) fn path(&self, robot: usize) -> &[DVec2] {
        self.pilots.get(robot).map_or(&[], |pilot| pilot.way.points())
    }

    /// Explores: drives to goals that `choose` names until none is left.
    pub(super) fn explore(
        &mut self,
        view: &View<'_>,
        mut choose: impl FnMut(&mut Planning<'_>) -> Option<Node>,
    ) -> Decision {
        let Some(pose) = pose_of(view) else { return Decision::Drive(Command::STOP) };
        if view.robot >= self.pilots.len() {
            return Decision::Finished;
        }
        self.guard.look(view.scan);
        let renewed = view.time - self.refreshed >= REFRESH;
        if renewed {
            self.refresh(view);
        }
        // A task may end and another begin in the same moment, but not for ever.
        for _ in 0..4 {
            let pilot = &mut self.pilots[view.robot];
            match pilot.task {
                Task::Begin => {
                    pilot.task = Task::Survey { heading: pose.heading, turned: 0.0 };
                }
                Task::Survey { heading, turned } => {
                    let turned = turned + wrap_angle(pose.heading - heading);
                    let left = FULL_TURN - turned;
                    if left > 0.1 && view.time < SURVEY {
                        pilot.task = Task::Survey { heading: pose.heading, turned };
                        return Decision::Drive(turn(view.body, left));
                    }
                    pilot.task = Task::Choose;
                }
                Task::Choose => {
                    if !self.choose(view, pose, &mut choose) {
                        self.pilots[view.robot].task = Task::Rest { since: view.time };
                        return Decision::Finished;
                    }
                }
                Task::Rest { since } => {
                    if view.time - since < REFRESH {
                        return Decision::Finished;
                    }
                    pilot.task = Task::Choose;
                }
                Task::Go { goal, deadline } => {
                    if let Some(decision) = self.go(view, pose, goal, deadline, renewed) {
                        return decision;
                    }
                }
                Task::Look { frontier, heading, until } => {
                    let off = wrap_angle(heading - pose.heading);
                    if view.time < until && off.abs() > 0.15 {
                        return Decision::Drive(turn(view.body, off));
                    }
                    if view.time < until.min(view.time + 1.0) && until - view.time > LOOK {
                        pilot.task = Task::Look { frontier, heading, until: view.time + LOOK };
                    }
                    if view.time < until {
                        return Decision::Drive(Command::STOP);
                    }
                    self.refresh(view);
                    if is_left(&self.costmap, frontier, SAME_FRONTIER) {
                        self.failures.push(Failure { at: frontier, is_final: true, active: true });
                    }
                    self.pilots[view.robot].task = Task::Choose;
                }
                Task::BackOff { from, until } => {
                    let done = from.distance(pose.position) >= BACK_OFF.0 || view.time >= until;
                    if !done && !view.bumped && self.is_free_behind(view.body, pose) {
                        let speed = -BACK_OFF.1;
                        return Decision::Drive(Command { speed, turn_rate: 0.0 });
                    }
                    let heading = pose.heading + self.open_side();
                    let pilot = &mut self.pilots[view.robot];
                    pilot.task = Task::TurnAway { heading, until: view.time + 4.0 };
                }
                Task::TurnAway { heading, until } => {
                    let off = wrap_angle(heading - pose.heading);
                    if off.abs() > 0.2 && view.time < until {
                        return Decision::Drive(turn(view.body, off));
                    }
                    self.refresh(view);
                    self.pilots[view.robot].task = Task::Choose;
                }
            }
        }
        Decision::Drive(Command::STOP)
    }

    /// Takes over what has changed in the map.
    fn refresh(&mut self, view: &View<'_>) {
        self.costmap.refresh(view.map);
        self.refreshed = view.time;
    }

    /// Drives on; `None` when the task is at its end.
    fn go(
        &mut self,
        view: &View<'_>,
        pose: Pose,
        goal: Goal,
        deadline: f64,
        renewed: bool,
    ) -> Option<Decision> {
        let pilot = &mut self.pilots[view.robot];
        if pilot.is_stuck(view.time, pose.position) || view.time > deadline {
            return self.recover(view, pose, goal);
        }
        if renewed {
            let gone = match goal {
                Goal::Frontier(at) => !is_left(&self.costmap, at, SAME_FRONTIER),
                Goal::Place(_) => false,
            };
            if gone || !pilot.way.is_passable(&mut self.costmap, 5.0) {
                pilot.task = Task::Choose;
                return None;
            }
        }
        let near = pilot.way.end().is_none_or(|end| end.distance(pose.position) < ARRIVED);
        if near && pilot.way.left() < 2.0 * ARRIVED {
            pilot.trail.clear();
            pilot.task = match goal {
                Goal::Frontier(frontier) => {
                    let to = unknown_from(&self.costmap, pose.position, frontier);
                    match to {
                        Some(to) => Task::Look {
                            frontier,
                            heading: libm::atan2(to.y, to.x),
                            until: view.time + 6.0,
                        },
                        None => Task::Choose,
                    }
                }
                Goal::Place(_) => Task::Choose,
            };
            return None;
        }
        let (way, pursuit) = (&mut pilot.way, &mut pilot.pursuit);
        let command = pursuit.follow(view.body, pose, way, &mut self.costmap, &self.guard, CRUISE);
        Some(Decision::Drive(command))
    }

    /// Chooses a goal and plans the way there; false when there is none left.
    fn choose(
        &mut self,
        view: &View<'_>,
        pose: Pose,
        choose: &mut impl FnMut(&mut Planning<'_>) -> Option<Node>,
    ) -> bool {
        self.costmap.refresh(view.map);
        self.collect_blocks(view, pose);
        let mut goal = self.search_goal(pose, choose);
        if goal.is_none() && !self.blocks.is_empty() {
            self.blocks.clear();
            self.pilots[view.robot].avoid.clear();
            self.collect_blocks(view, pose);
            goal = self.search_goal(pose, choose);
        }
        if goal.is_none() && self.failures.iter().any(|failure| failure.active && !failure.is_final)
        {
            for failure in &mut self.failures {
                failure.active &= failure.is_final;
            }
            goal = self.search_goal(pose, choose);
        }
        let Some(node) = goal else { return false };
        let Some(cluster) = self.frontiers.cluster_at(node) else { return false };
        let point = self.costmap.point(node);
        let frontier = self.frontiers.nearest_cell(cluster, point).map_or(point, CellIndex::centre);
        self.set_way(view, node, Goal::Frontier(frontier));
        true
    }

    fn search_goal(
        &mut self,
        pose: Pose,
        choose: &mut impl FnMut(&mut Planning<'_>) -> Option<Node>,
    ) -> Option<Node> {
        let Navigator { costmap, frontiers, search, failures, blocks, .. } = self;
        let near = |at: DVec2, p: DVec2, radius: f64| at.distance_squared(p) < radius * radius;
        let failed = |p: DVec2| {
            near(pose.position, p, FEET)
                || failures.iter().any(|failure| failure.active && near(failure.at, p, FAILED))
        };
        frontiers.gather(costmap, failed);
        choose(&mut Planning { costmap, frontiers, search, pose, blocks })
    }

    fn set_way(&mut self, view: &View<'_>, node: Node, goal: Goal) {
        let cost = self.search.cost(node).unwrap_or(0);
        self.search.way(&self.costmap, node, &mut self.cells);
        let pilot = &mut self.pilots[view.robot];
        pilot.way.set(&mut self.costmap, &self.cells);
        let length = f64::from(cost) / f64::from(METRE);
        pilot.task = Task::Go { goal, deadline: view.time + 30.0 + length / 0.1 };
    }

    /// What no way of a robot may lead through for now.
    fn collect_blocks(&mut self, view: &View<'_>, _pose: Pose) {
        let pilot = &mut self.pilots[view.robot];
        pilot.avoid.retain(|(until, _)| *until > view.time);
        self.blocks.clear();
        self.blocks.extend(pilot.avoid.iter().map(|(_, block)| *block));
        let others = view.estimates.iter().enumerate().filter(|(other, _)| *other != view.robot);
        self.blocks.extend(others.map(|(_, other)| Block {
            center: other.pose.position,
            radius: 2.0 * view.body.swing_radius + 0.1,
        }));
    }

    /// Begins to free a robot that is stuck; gives it up when that has happened too often.
    fn recover(&mut self, view: &View<'_>, pose: Pose, goal: Goal) -> Option<Decision> {
        if let Goal::Frontier(at) = goal {
            let is_final = self
                .failures
                .iter()
                .any(|failure| !failure.active && failure.at.distance(at) < FAILED);
            self.failures.push(Failure { at, is_final, active: true });
        }
        let pilot = &mut self.pilots[view.robot];
        pilot.trail.clear();
        pilot.recoveries += 1;
        pilot.recovered.push_back(view.time);
        while pilot.recovered.front().is_some_and(|&time| view.time - time > HOPELESS.1) {
            pilot.recovered.pop_front();
        }
        if pilot.recovered.len() >= HOPELESS.0 {
            return Some(Decision::Stuck);
        }
        // Whatever it is that the map does not show, it is where the way led.
        let mut ahead = pose.position + unit_vector(pose.heading) * (2.0 * SIDE);
        pilot.way.ahead(0.1, 0.5, |p| {
            ahead = p;
            true
        });
        let block = Block { center: ahead, radius: 0.25 };
        pilot.avoid.push((view.time + AVOID, block));
        pilot.task = Task::BackOff { from: pose.position, until: view.time + 4.0 };
        pilot.way.clear();
        None
    }

    /// Whether nothing is known to stand where the robot would back to.
    fn is_free_behind(&self, robot: &Robot, pose: Pose) -> bool {
        let back = -unit_vector(pose.heading);
        let reach = (robot.swing_radius / RESOLUTION) as i32;
        let middle = pose.position + back * 0.1;
        (-reach..=reach).all(|dy| {
            (-reach..=reach).all(|dx| {
                let off = DVec2::new(f64::from(dx), f64::from(dy)) * RESOLUTION;
                let counts = off.length() < robot.swing_radius && off.dot(back) > 0.1;
                !counts || self.costmap.cell(CellIndex::of(middle + off)) != Cell::Occupied
            })
        })
    }

    /// The angle by which to turn to the side where the laser sees more room.
    fn open_side(&self) -> f64 {
        let nearest = |side: f64| {
            let echoes = self.guard.echoes().iter().filter(|echo| side * echo.y > 0.0);
            echoes.map(|echo| echo.length_squared()).fold(f64::INFINITY, f64::min)
        };
        if nearest(1.0) >= nearest(-1.0) { 1.5 } else { -1.5 }
    }
}

impl Pilot {
    /// Notes where the robot is, and tells whether it has hardly moved for too long.
    fn is_stuck(&mut self, time: f64, p: DVec2) -> bool {
        let (least, span) = STUCK;
        self.trail.push_back((time, p));
        while self.trail.get(1).is_some_and(|(then, _)| time - then >= span) {
            self.trail.pop_front();
        }
        let (first, _) = self.trail[0];
        time - first >= span && self.trail.iter().all(|(_, then)| then.distance(p) < least)
    }
}

/// Where the robot that is asked for is thought to be, if that is a place at all.
pub(super) fn pose_of(view: &View<'_>) -> Option<Pose> {
    let pose = view.estimates.get(view.robot)?.pose;
    (pose.position.is_finite() && pose.heading.is_finite()).then_some(pose)
}
