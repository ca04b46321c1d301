//! Goes where most unknown space is seen per metre of path (Gonzalez-Banos and Latombe, Navigation
//! strategies for exploring indoor environments, 2002).

use std::f64::consts::TAU;

use envgen::geometry::unit_vector;
use glam::DVec2;

use super::costmap::{Costmap, Node, SIDE};
use super::navigator::Navigator;
use super::search::COST_PER_METRE;
use super::{Decision, ExplorationPolicy, PolicyInput};
use crate::map::{Cell, CellIndex};

/// Number of rays that look for unknown space around a goal.
const RAYS: u32 = 32;

/// Metres of unknown space that a ray is expected to see into.
const DEPTH: f64 = 3.0;

/// Metres that are added to every path, so that near goals do not always win.
const HANDICAP: f64 = 2.0;

/// Greatest number of goals that are compared, and how much longer in metres their paths may be than
/// that to the nearest one.
const CANDIDATES: usize = 16;
const FARTHER: f64 = 15.0;

/// Goes where most unknown space is seen per metre of path.
#[derive(Debug)]
pub(super) struct InfoGain {
    navigator: Navigator,
    rays: Vec<DVec2>,
    candidates: Vec<(Node, u32)>,
}

impl InfoGain {
    pub(super) fn new(navigator: Navigator) -> Self {
        let rays = (0..RAYS).map(|ray| unit_vector(TAU * f64::from(ray) / f64::from(RAYS)));
        InfoGain { navigator, rays: rays.collect(), candidates: Vec::new() }
    }
}

impl ExplorationPolicy for InfoGain {
    fn decide(&mut self, view: &PolicyInput<'_>) -> Decision {
        let InfoGain { navigator, rays, candidates } = self;
        let range = view.laser.max_range.clamp(0.0, 10.0);
        navigator.explore(view, |planning| {
            planning.nearest_of_each(CANDIDATES, FARTHER, candidates);
            let costmap = &*planning.costmap;
            let worth = |&(node, cost): &(Node, u32)| {
                let gain = unknown_area(costmap, costmap.point(node), rays, range);
                gain / (f64::from(cost) / f64::from(COST_PER_METRE) + HANDICAP)
            };
            let worths = candidates.iter().map(|candidate| (candidate.0, worth(candidate)));
            // Of equally good goals the nearest, which comes first.
            let best = worths.reduce(|a, b| if b.1 > a.1 { b } else { a })?;
            Some(best.0)
        })
    }

    fn recoveries(&self, robot: usize) -> u32 {
        self.navigator.recoveries(robot)
    }

    fn path(&self, robot: usize) -> &[DVec2] {
        self.navigator.path(robot)
    }
}

/// Unknown area in square metres that is likely to be seen from a point.
fn unknown_area(costmap: &Costmap, from: DVec2, rays: &[DVec2], range: f64) -> f64 {
    let slice = SIDE * TAU / rays.len().max(1) as f64;
    let mut area = 0.0;
    for &ray in rays {
        let (mut r, mut depth) = (0.5 * SIDE, 0.0);
        while r < range && depth < DEPTH {
            match costmap.cell(CellIndex::of(from + ray * r)) {
                Cell::Occupied => break,
                Cell::Free => {}
                Cell::Unknown => {
                    area += slice * r;
                    depth += SIDE;
                }
            }
            r += SIDE;
        }
    }
    area
}
