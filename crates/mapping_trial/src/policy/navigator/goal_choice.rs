//! The choice of a robot's goal, and the plan of the path to it.

use envgen::geometry::Pose;
use glam::DVec2;

use super::state::{ARRIVED, FAILED, Goal, Navigator, Task};
use crate::map::CellIndex;
use crate::policy::PolicyInput;
use crate::policy::costmap::{CellCost, Costmap, Node};
use crate::policy::frontier::Frontiers;
use crate::policy::search::{COST_PER_METRE, GridPlanner, KeepoutZone};

/// Fraction of the laser's range within which a wall has to be for a goal to be in sight of it. From
/// there the laser sees a piece of the wall at least as long as the distance to it.
const IN_SIGHT: f64 = 0.6;

/// Radius in metres around another robot's goal that is left to that robot.
pub(super) const TAKEN: f64 = 2.0;

/// The input for the choice of a goal: everything that is known, and the robot's pose.
pub(in crate::policy) struct Planning<'a> {
    pub(in crate::policy) costmap: &'a mut Costmap,
    pub(in crate::policy) frontiers: &'a mut Frontiers,
    pub(in crate::policy) search: &'a mut GridPlanner,
    /// Where the robot is.
    pub(in crate::policy) pose: Pose,
    /// Zones that paths avoid.
    pub(in crate::policy) blocks: &'a [KeepoutZone],
    /// The worst cell cost on paths.
    pub(in crate::policy) limit: CellCost,
}

impl Planning<'_> {
    /// The nearest goal.
    pub(in crate::policy) fn nearest(&mut self) -> Option<Node> {
        self.nearest_of(|_| true)
    }

    /// The nearest goal of the clusters for which `wanted` is true.
    pub(in crate::policy) fn nearest_of(&mut self, wanted: impl Fn(usize) -> bool) -> Option<Node> {
        let Planning { costmap, frontiers, search, pose, blocks, .. } = self;
        if frontiers.goals() == 0 {
            return None;
        }
        let goal = |node, _| frontiers.cluster_at(node).is_some_and(&wanted);
        search.nearest(costmap, pose.position, blocks, goal)
    }

    /// Writes the nearest goal of each cluster with the cost of the path to it into `goals`, the
    /// nearest first: of at most `most` clusters, with paths up to about `farther` metres longer than
    /// that to the nearest.
    pub(in crate::policy) fn nearest_of_each(
        &mut self,
        most: usize,
        farther: f64,
        goals: &mut Vec<(Node, u32)>,
    ) {
        let Planning { costmap, frontiers, search, pose, blocks, .. } = self;
        goals.clear();
        let most = frontiers.with_goal().min(most);
        if most == 0 {
            return;
        }
        let mut seen = vec![false; frontiers.len()];
        let mut farthest = u32::MAX;
        search.nearest(costmap, pose.position, blocks, |node, cost| {
            if let Some(cluster) = frontiers.cluster_at(node)
                && !seen[cluster]
            {
                if goals.is_empty() {
                    farthest = cost.saturating_add((farther * f64::from(COST_PER_METRE)) as u32);
                }
                seen[cluster] = true;
                goals.push((node, cost));
            }
            goals.len() >= most || cost > farthest
        });
    }
}

/// The present aim of a robot.
pub(in crate::policy) enum Aim<'a> {
    /// Uncover the frontiers that this function chooses.
    Explore(&'a mut dyn FnMut(&mut Planning<'_>) -> Option<Node>),
    /// Go to a position.
    Visit(DVec2),
}

/// Goals that are excluded as a precaution.
#[derive(Clone, Copy, Debug)]
struct Restraint {
    /// Goals from which no known wall is seen: there the pose would depend on the wheels alone.
    in_sight: bool,
    /// Goals near those of other robots.
    others: bool,
}

impl Navigator {
    /// Chooses a goal and plans the path to it. Returns false if no goal is left.
    pub(super) fn choose(&mut self, view: &PolicyInput<'_>, pose: Pose, aim: &mut Aim<'_>) -> bool {
        self.costmap.refresh(view.map);
        self.collect_blocks(view, pose);
        match aim {
            Aim::Visit(place) => self.plan_visit(view, pose, *place),
            Aim::Explore(choose) => {
                let Some((node, squeezes)) = self.choose_frontier(view, pose, choose) else {
                    return false;
                };
                let Some(cluster) = self.frontiers.cluster_at(node) else { return false };
                let point = self.costmap.point(node);
                // Goals at which a look has failed are excluded: it would fail again and again.
                let failures = &self.failures;
                let is_open = |p: DVec2| {
                    let mut active = failures.iter().filter(|failure| failure.active);
                    !active.any(|failure| failure.at.distance_squared(p) < FAILED * FAILED)
                };
                let cell = self.frontiers.nearest_cell(cluster, point, is_open);
                let frontier = cell.map_or(point, CellIndex::centre);
                self.pilots[view.robot].second.note_goal();
                self.doors.note_goal();
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
        self.pilots[view.robot].second.note_goal();
        self.set_path(view, node, Goal::Place(place), false);
        true
    }

    /// Chooses a goal, and returns whether its path leads through gaps that the robot may not fit
    /// through. Exclusions are dropped step by step: first the sight of walls, then other robots'
    /// goals, then places where this robot was stuck, then goals that failed once, and at last the
    /// width of gaps.
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
            self.collect_blocks(view, pose);
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

    pub(super) fn set_path(
        &mut self,
        view: &PolicyInput<'_>,
        node: Node,
        goal: Goal,
        squeezes: bool,
    ) {
        let cost = self.search.cost(node).unwrap_or(0);
        self.search.path_to(&self.costmap, node, &mut self.cells);
        let pilot = &mut self.pilots[view.robot];
        pilot.path.set(&mut self.costmap, &self.cells);
        let length = f64::from(cost) / f64::from(COST_PER_METRE);
        let deadline = self.margins.limit(view.seen.time, 30.0) + length / self.margins.slowest;
        pilot.task = Task::Go { goal, deadline, squeezes };
    }

    /// Collects the zones that a robot's paths avoid for now.
    fn collect_blocks(&mut self, view: &PolicyInput<'_>, pose: Pose) {
        let pilot = &mut self.pilots[view.robot];
        pilot.avoid.retain(|(until, _)| *until > view.seen.time);
        self.blocks.clear();
        self.blocks.extend(pilot.avoid.iter().map(|(_, block)| *block));
        let others = view.estimates.iter().enumerate().filter(|(other, _)| *other != view.robot);
        self.blocks.extend(others.map(|(_, other)| {
            let center = other.pose.position;
            // A robot that is already nearer has to get out.
            let inside = 0.9 * center.distance(pose.position);
            let radius = (2.0 * view.body.circumscribed_radius + 0.1).min(inside);
            KeepoutZone { center, radius }
        }));
    }
}

#[cfg(test)]
mod tests {
    use envgen::geometry::{Rect, unit_vector};

    use super::*;
    use crate::backend::Observation;
    use crate::lidar::{LaserProfile, Scan};
    use crate::map::{Estimate, OccupancyMap};
    use crate::policy::tests::input;
    use crate::policy::{Decision, PolicyKind, build};
    use crate::robot::Robot;

    #[test]
    fn what_no_look_uncovers_is_given_up() {
        // A corridor along which a strip stays unknown that is too narrow for the robot.
        let mut map = OccupancyMap::new();
        for row in -6..12 {
            for col in -41..42 {
                let is_wall = row == -6 || row == 11 || col == -41 || col == 41;
                if is_wall || row >= -1 {
                    map.add(CellIndex { col, row }, if is_wall { 200 } else { -200 });
                }
            }
        }
        map.touch(Rect::new(DVec2::splat(-3.0), DVec2::splat(3.0)));
        let (body, laser) = (Robot::default(), LaserProfile::default());
        let mut policy = build(PolicyKind::Nearest, 1, &body, &laser);
        let mut pose = Pose::new(0.0, 0.15, 0.0);
        let mut turned = 0.0;
        for tick in 0..6000 {
            let seen = Observation { time: 0.1 * f64::from(tick), ..Default::default() };
            let decision = policy.decide(&input(
                0,
                &[Estimate { pose, ..Estimate::default() }],
                (&map, &Scan { ranges: vec![2.0; laser.beams as usize] }),
                &seen,
                (&body, &laser),
            ));
            let Decision::Drive(command) = decision else {
                assert_eq!(decision, Decision::Finished, "at {pose:?}");
                return;
            };
            pose.heading += 0.1 * command.turn_rate;
            pose.position += 0.1 * command.speed * unit_vector(pose.heading);
            turned += 0.1 * command.turn_rate.abs();
        }
        panic!("it has not ended at {pose:?}, and turned by {turned} rad");
    }
}
