//! Goes to the first frontier of the shortest path through the nearest ones. This is as in Kulich,
//! Faigl and Preucil (On distance utility in the exploration task, 2011), but the path does not return
//! to its start, and leads through the nearest cells of at most eight frontiers.

use glam::DVec2;

use super::costmap::Node;
use super::navigator::{Navigator, Planning};
use super::{Decision, ExplorationPolicy, PolicyInput};

/// Greatest number of frontiers on a path.
const STOPS: usize = 8;

/// Goes to the first of the eight nearest frontiers on the shortest path through all of them.
#[derive(Debug)]
pub(super) struct Tour {
    navigator: Navigator,
    stops: Vec<(Node, u32)>,
}

impl Tour {
    pub(super) fn new(navigator: Navigator) -> Self {
        Tour { navigator, stops: Vec::new() }
    }
}

impl ExplorationPolicy for Tour {
    fn decide(&mut self, view: &PolicyInput<'_>) -> Decision {
        let Tour { navigator, stops } = self;
        navigator.explore(view, |planning| {
            planning.nearest_of_each(STOPS, f64::INFINITY, stops);
            let legs: Vec<Vec<u32>> = match stops.len() {
                0 | 1 => return stops.first().map(|stop| stop.0),
                _ => stops.iter().map(|stop| costs_from(planning, stop.0, stops)).collect(),
            };
            let starts: Vec<u32> = stops.iter().map(|stop| stop.1).collect();
            let (first, _) = stops[first_stop(&starts, &legs)];
            // The path is that of the last search.
            let Planning { costmap, search, pose, blocks, .. } = planning;
            search.nearest(costmap, pose.position, blocks, |node, _| node == first)
        })
    }

    fn recoveries(&self, robot: usize) -> u32 {
        self.navigator.recoveries(robot)
    }

    fn path(&self, robot: usize) -> &[DVec2] {
        self.navigator.path(robot)
    }
}

/// Costs of the paths from a stop to all; `u32::MAX` where there is none.
fn costs_from(planning: &mut Planning<'_>, from: Node, stops: &[(Node, u32)]) -> Vec<u32> {
    let Planning { costmap, search, blocks, .. } = planning;
    let (mut costs, mut left) = (vec![u32::MAX; stops.len()], stops.len());
    let from = costmap.point(from);
    search.nearest(costmap, from, blocks, |node, cost| {
        if let Some(stop) = stops.iter().position(|stop| stop.0 == node) {
            costs[stop] = cost;
            left -= 1;
        }
        left == 0
    });
    costs
}

/// Returns the first stop of the shortest path through all stops, given the costs of the paths to each
/// and between them. Of equally good stops it is the first. The method is exact (Held and Karp, 1962).
fn first_stop(starts: &[u32], legs: &[Vec<u32>]) -> usize {
    let all = (1_usize << starts.len()) - 1;
    let indices = || 0..starts.len();
    // The least cost from a stop through all stops of a set, by set and stop.
    let mut rest = vec![vec![0_u64; starts.len()]; all + 1];
    for set in 1..=all {
        for from in indices().filter(|from| set & (1 << from) == 0) {
            let through = |to: usize| u64::from(legs[from][to]) + rest[set & !(1 << to)][to];
            let least = indices().filter(|to| set & (1 << to) != 0).map(through).min();
            rest[set][from] = least.unwrap_or(0);
        }
    }
    let cost = |first: &usize| u64::from(starts[*first]) + rest[all & !(1 << first)][*first];
    indices().min_by_key(cost).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The least cost through all stops that are left, and the first of them, by trying every order.
    fn by_trying(starts: &[u32], legs: &[Vec<u32>], left: &[usize]) -> (u64, usize) {
        let through = |&first: &usize| {
            let left: Vec<usize> = left.iter().copied().filter(|stop| *stop != first).collect();
            let rest = if left.is_empty() { 0 } else { by_trying(&legs[first], legs, &left).0 };
            (u64::from(starts[first]) + rest, first)
        };
        left.iter().map(through).min().expect("a stop")
    }

    #[test]
    fn a_near_stop_is_left_for_later_where_that_is_shorter() {
        // Along a hallway: stops at -3, 2 and 2.5, and then at -3, 2 and 9.
        let order = |stops: [u32; 3]| {
            let legs = stops.map(|a| stops.map(|b| a.abs_diff(b)).to_vec());
            first_stop(&stops.map(|stop| stop.abs_diff(30)), &legs)
        };
        assert_eq!(order([0, 50, 55]), 1);
        assert_eq!(order([0, 50, 120]), 0);
    }

    proptest! {
        #[test]
        fn tours_are_the_shortest(
            starts in prop::collection::vec(0..1000_u32, 1..6),
            draws in prop::collection::vec(0..1000_u32, 36),
        ) {
            let n = starts.len();
            let legs: Vec<Vec<u32>> = (0..n).map(|i| draws[6 * i..6 * i + n].to_vec()).collect();
            let first = first_stop(&starts, &legs);
            let all: Vec<usize> = (0..n).collect();
            prop_assert_eq!(first, by_trying(&starts, &legs, &all).1);
        }
    }
}
