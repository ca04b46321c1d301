//! Explores hallways first and rooms later, with a reaction time, as the operators of Zwennes (2011)
//! described.

use std::collections::VecDeque;

use envgen::geometry::{unit_vector, wrap_angle};
use glam::DVec2;

use super::costmap::{CellCost, Costmap, Node, SIDE};
use super::navigator::{Navigator, Planning, pose_of};
use super::{Decision, ExplorationPolicy, PolicyInput};
use crate::backend::{Command, TICK};
use crate::map::Estimate;

/// Reaction time in seconds, from seeing to acting.
const DELAY: f64 = 0.25;

/// Cruising speed relative to that of a policy without reaction time: 0.4 m/s for the Pioneer 3-AT.
const CAUTION: f64 = 0.8;

/// Seconds after which a robot in a room looks for goals in hallways again.
const LOOK_AGAIN: f64 = 10.0;

/// Distance in metres from a narrow place within which a robot there counts as in a hallway.
const BESIDE: f64 = 0.6;

/// Explores hallways first and rooms later.
///
/// A hallway is where the robot gets from its start without passing a gap that the map shows as
/// narrower than 1.1 m. Rooms lie behind such gaps.
#[derive(Debug)]
pub(super) struct Corridors {
    navigator: Navigator,
    /// A position in a hallway, and the time of the next search for frontiers from there.
    homes: Vec<Option<(DVec2, f64)>>,
    /// Commands that are decided but not yet carried out, per robot.
    pending: Vec<VecDeque<(f64, Command)>>,
    carried_out: Vec<Command>,
    estimates: Vec<Estimate>,
}

impl Corridors {
    pub(super) fn new(mut navigator: Navigator, robots: usize) -> Self {
        navigator.margins.cruise *= CAUTION;
        navigator.margins.steady *= CAUTION;
        Corridors {
            navigator,
            homes: vec![None; robots],
            pending: vec![VecDeque::new(); robots],
            carried_out: vec![Command::STOP; robots],
            estimates: Vec::new(),
        }
    }

    /// Predicts where the robot will be when the pending commands are carried out, since operators know
    /// what they have just commanded.
    fn foresee(&mut self, view: &PolicyInput<'_>) {
        self.estimates.clear();
        self.estimates.extend_from_slice(view.estimates);
        let Some(pose) = self.estimates.get_mut(view.robot).map(|estimate| &mut estimate.pose)
        else {
            return;
        };
        for (_, command) in &self.pending[view.robot] {
            let time = 2.0 * TICK;
            pose.heading = wrap_angle(pose.heading + command.turn_rate * time);
            pose.position += unit_vector(pose.heading) * (command.speed * time);
        }
    }
}

impl ExplorationPolicy for Corridors {
    fn decide(&mut self, view: &PolicyInput<'_>) -> Decision {
        let robot = view.robot;
        let (Some(pose), true) = (pose_of(view), robot < self.homes.len()) else {
            return Decision::Drive(Command::STOP);
        };
        self.foresee(view);
        let Corridors { navigator, homes, pending, carried_out, estimates } = self;
        let (home, next_look) = homes[robot].get_or_insert((pose.position, 0.0));
        let view = PolicyInput { estimates: &*estimates, ..*view };
        let decision =
            navigator.explore(&view, |planning| choose(planning, view.seen.time, home, next_look));
        let Decision::Drive(command) = decision else { return decision };
        let pending = &mut pending[robot];
        pending.push_back((view.seen.time, command));
        // A tolerance below a tick, since times are sums of ticks.
        while pending.front().is_some_and(|(then, _)| view.seen.time - then >= DELAY - 1e-6) {
            if let Some((_, command)) = pending.pop_front() {
                carried_out[robot] = command;
            }
        }
        Decision::Drive(carried_out[robot])
    }

    fn recoveries(&self, robot: usize) -> u32 {
        self.navigator.recoveries(robot)
    }

    fn path(&self, robot: usize) -> &[DVec2] {
        self.navigator.path(robot)
    }
}

/// Chooses the nearest goal in a hallway, or else the nearest one. `home` is a position in a hallway,
/// which follows the robot while it is in one; `next_look` is the time of the next search from there.
fn choose(
    planning: &mut Planning<'_>,
    time: f64,
    home: &mut DVec2,
    next_look: &mut f64,
) -> Option<Node> {
    let around = wide_around(planning.costmap, planning.pose.position);
    let Planning { costmap, frontiers, search, limit, .. } = planning;
    let (limit, goal) = (*limit, |node, _| frontiers.cluster_at(node).is_some());
    search.set_worst_allowed(CellCost::Near);
    // The search is from the home, which may leave a place that has turned out to be narrow. A path to
    // the home would not end there.
    if let Some(here) = search.nearest(costmap, *home, &[], |node, _| around.contains(&node)) {
        *home = costmap.point(here);
        let node = search.nearest(costmap, *home, planning.blocks, goal);
        if node.is_some() {
            search.set_worst_allowed(limit);
            return node;
        }
    } else if time >= *next_look {
        let cluster =
            search.nearest(costmap, *home, &[], goal).and_then(|node| frontiers.cluster_at(node));
        search.set_worst_allowed(limit);
        if let Some(cluster) = cluster
            && let Some(node) = planning.nearest_of(|other| other == cluster)
        {
            return Some(node);
        }
        *next_look = time + LOOK_AGAIN;
    }
    planning.search.set_worst_allowed(limit);
    planning.nearest()
}

/// The wide cell of a position; if it is narrow, as beside an object, the wide cells around it.
fn wide_around(costmap: &mut Costmap, p: DVec2) -> Vec<Node> {
    let mut wide =
        |p: DVec2| costmap.node_at(p).filter(|&node| costmap.cell_cost(node) <= CellCost::Near);
    if let Some(node) = wide(p) {
        return vec![node];
    }
    let reach = (BESIDE / SIDE) as i32;
    let offsets = (-reach..=reach).flat_map(|row| (-reach..=reach).map(move |col| (col, row)));
    offsets
        .filter(|(col, row)| col * col + row * row <= reach * reach)
        .filter_map(|(col, row)| wide(p + SIDE * DVec2::new(col.into(), row.into())))
        .collect()
}
