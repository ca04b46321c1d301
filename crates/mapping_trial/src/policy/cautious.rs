//! Goes to the nearest frontier, but returns to an earlier position if the pose is uncertain.

use glam::DVec2;

use super::navigator::{Aim, Navigator, pose_of};
use super::{Decision, ExplorationPolicy, PolicyInput};

/// Standard deviation of the position in metres from which the robot returns.
const UNSURE: f64 = 0.30;

/// Fraction of it below which the pose is certain again.
const SURE: f64 = 0.5;

/// Factor by which the tolerated deviation rises if the return did not help.
const PATIENCE: f64 = 1.5;

/// Distance in metres between the positions that are remembered.
const APART: f64 = 1.0;

/// Greatest number of remembered positions. At this number, every second one is forgotten.
const PLACES: usize = 4096;

/// Goes to the nearest frontier, and returns to an earlier position if the pose is uncertain.
#[derive(Debug)]
pub(super) struct Cautious {
    navigator: Navigator,
    memories: Vec<Memory>,
}

#[derive(Clone, Debug)]
struct Memory {
    /// Where the robot was, and the standard deviation of its position there.
    places: Vec<(DVec2, f64)>,
    /// The position to which the robot returns.
    back_to: Option<DVec2>,
    bears: f64,
}

impl Cautious {
    pub(super) fn new(navigator: Navigator, robots: usize) -> Self {
        let memory = Memory { places: Vec::new(), back_to: None, bears: UNSURE };
        Cautious { navigator, memories: vec![memory; robots] }
    }
}

impl ExplorationPolicy for Cautious {
    fn decide(&mut self, view: &PolicyInput<'_>) -> Decision {
        let Cautious { navigator, memories } = self;
        let robot = view.robot;
        if let (Some(pose), Some(memory)) = (pose_of(view), memories.get_mut(robot)) {
            let deviation = view.estimates[robot].deviation;
            memory.remember(pose.position, deviation);
            if memory.back_to.is_some() && deviation < SURE * memory.bears {
                memory.back_to = None;
                navigator.interrupt(robot);
            }
            if memory.back_to.is_none() && deviation > memory.bears && navigator.is_at_ease(robot) {
                memory.back_to = memory.surest(deviation);
                navigator.interrupt(robot);
            }
            if let Some(place) = memory.back_to {
                if let Some(decision) = navigator.pursue(view, &mut Aim::Visit(place)) {
                    return decision;
                }
                // The robot has arrived or found no path: it has to tolerate the deviation that it
                // could not reduce.
                if deviation >= SURE * memory.bears {
                    memory.bears = PATIENCE * memory.bears.max(deviation);
                }
                memory.back_to = None;
                navigator.interrupt(robot);
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

impl Memory {
    fn remember(&mut self, place: DVec2, deviation: f64) {
        let far = |last: &(DVec2, f64)| last.0.distance(place) >= APART;
        if deviation.is_finite() && self.places.last().is_none_or(far) {
            if self.places.len() >= PLACES {
                let mut keep = false;
                self.places.retain(|_| {
                    keep = !keep;
                    keep
                });
            }
            self.places.push((place, deviation));
        }
    }

    /// The latest position at which the deviation was at most half of this, or else the first one.
    fn surest(&self, deviation: f64) -> Option<DVec2> {
        let sure = self.places.iter().rev().find(|(_, then)| *then <= SURE * deviation);
        sure.or(self.places.first()).map(|(place, _)| *place)
    }
}
