//! Follows the wall on its right, and goes to the nearest frontier if that leads in a circle.

use envgen::geometry::{Pose, Rect, unit_vector, wrap_angle};
use glam::DVec2;

use super::costmap::{CellCost, Costmap};
use super::navigator::{Navigator, pose_of};
use super::path::worst_between;
use super::{Decision, ExplorationPolicy, PolicyInput};

/// Distance in metres that has to be free in a direction for the robot to take it.
const PROBE: f64 = 0.6;

/// Distance in metres to the right within which there has to be a wall to follow.
const HAND: f64 = 1.2;

/// Angle in radians between directions that are tried.
const FAN: f64 = 0.175;

/// Directions that are tried, from the right rear to the left rear.
const DIRECTIONS: i32 = 30;

/// Number of directions, from the rightmost on, of which the first that keeps clear of the wall is
/// taken.
const ASIDE: i32 = 4;

/// Distance in metres between remembered positions, the distance at which the robot counts as back at
/// one of them, and the least path length in between.
const APART: f64 = 0.5;
const AGAIN: f64 = 0.5;
const ROUND: f64 = 10.0;

/// Greatest number of remembered positions. At this number, every second one is forgotten.
const PLACES: usize = 4096;

/// Distance in metres from all positions where the robot followed a wall, from which it follows a wall
/// again.
const AFRESH: f64 = 2.5;

/// Time in seconds between two checks whether anything is left to explore.
const LOOK: f64 = 5.0;

/// Follows the wall on its right.
#[derive(Debug)]
pub(super) struct WallFollow {
    navigator: Navigator,
    followers: Vec<Follower>,
}

#[derive(Clone, Debug, Default)]
struct Follower {
    mode: Mode,
    /// Where and in which direction it followed walls, each with the path length in metres before.
    trail: Vec<(DVec2, DVec2, f64)>,
    driven: f64,
    last: Option<DVec2>,
    /// Whether it has a wall on its right.
    touching: bool,
    /// When it last checked whether anything is left to explore.
    looked: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Mode {
    #[default]
    Explore,
    Follow,
}

impl WallFollow {
    pub(super) fn new(navigator: Navigator, robots: usize) -> Self {
        WallFollow { navigator, followers: vec![Follower::default(); robots] }
    }
}

impl ExplorationPolicy for WallFollow {
    fn decide(&mut self, view: &PolicyInput<'_>) -> Decision {
        let WallFollow { navigator, followers } = self;
        if let (Some(pose), Some(follower)) = (pose_of(view), followers.get_mut(view.robot)) {
            follower.note(pose);
            if follower.mode == Mode::Explore
                && navigator.is_at_ease(view.robot)
                && follower.is_new(pose.position)
            {
                (follower.mode, follower.touching) = (Mode::Follow, false);
            }
            if follower.mode == Mode::Follow && view.seen.time - follower.looked >= LOOK {
                follower.looked = view.seen.time;
                if !navigator.has_frontiers(view) {
                    follower.mode = Mode::Explore;
                    navigator.interrupt(view.robot);
                }
            }
            if follower.mode == Mode::Follow {
                let target = follower.target(navigator, pose, view.area);
                let decision = target.and_then(|target| navigator.steer(view, target));
                if let Some(decision) = decision {
                    return decision;
                }
                follower.mode = Mode::Explore;
                navigator.interrupt(view.robot);
            }
        }
        navigator.explore(view, |planning| planning.nearest())
    }

    fn recoveries(&self, robot: usize) -> u32 {
        self.navigator.recoveries(robot)
    }

    fn path(&self, robot: usize) -> &[DVec2] {
        self.navigator.path(robot)
    }
}

impl Follower {
    fn note(&mut self, pose: Pose) {
        self.driven += self.last.map_or(0.0, |last| last.distance(pose.position));
        self.last = Some(pose.position);
    }

    /// Whether no wall was followed near a position.
    fn is_new(&self, p: DVec2) -> bool {
        self.trail.iter().all(|(at, ..)| at.distance_squared(p) > AFRESH * AFRESH)
    }

    /// Returns the point to drive to: in the rightmost direction in which the map is free, or a little
    /// to the left of it, in one that leads less close along the wall; straight on until there is a
    /// wall to follow. The border of the area to map counts as a wall. `None` if the wall led in a
    /// circle, or if the robot cannot continue.
    fn target(&mut self, navigator: &mut Navigator, pose: Pose, area: Rect) -> Option<DVec2> {
        let ahead = unit_vector(pose.heading);
        let again = self.trail.iter().any(|&(at, then, driven)| {
            self.driven - driven > ROUND
                && at.distance_squared(pose.position) < AGAIN * AGAIN
                && then.dot(ahead) > 0.5
        });
        if again {
            return None;
        }
        if self.trail.last().is_none_or(|(at, ..)| at.distance(pose.position) >= APART) {
            if self.trail.len() >= PLACES {
                let mut keep = false;
                self.trail.retain(|_| {
                    keep = !keep;
                    keep
                });
            }
            self.trail.push((pose.position, ahead, self.driven));
        }
        let costmap = &mut navigator.costmap;
        // At least as far from the wall as it is now, but it may leave a doorway that it is in.
        let limit = costmap.cell_cost_at(pose.position).clamp(CellCost::Close, CellCost::Tight);
        let free = |costmap: &mut Costmap, angle: f64, far: f64| {
            let to = pose.position + unit_vector(pose.heading + angle) * far;
            let is_free = area.contains(to) && worst_between(costmap, pose.position, to) <= limit;
            is_free.then_some(to)
        };
        let hand = [-1.2, -1.6, -2.0].into_iter().any(|angle| free(costmap, angle, HAND).is_none());
        self.touching |= hand;
        if !self.touching
            && let Some(to) = free(costmap, 0.0, PROBE)
        {
            return Some(to);
        }
        self.touching = true;
        let angle = |step: i32| wrap_angle(FAN * f64::from(step) - 1.8);
        let first = (0..DIRECTIONS).find(|&step| free(costmap, angle(step), PROBE).is_some())?;
        // Driving close along the wall is slow and ends in collisions, so a direction a little to the
        // left is preferred.
        let mut roomy = None;
        for step in first..first + ASIDE {
            let Some(to) = free(costmap, angle(step), PROBE) else { break };
            let middle = pose.position.midpoint(to);
            roomy = roomy.or(Some(to));
            if worst_between(costmap, middle, to) <= CellCost::Near {
                roomy = Some(to);
                break;
            }
        }
        roomy
    }
}
