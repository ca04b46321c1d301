//! Builds the world of a forest.

use glam::DVec2;

use super::blueprint::Forest;
use super::index::CellList;
use super::metrics::{crosses_west_east, predicts_crossing};
use super::spec::Border;
use super::start_goal::wished;
use crate::generate::Spec;
use crate::geometry::{Pose, Rect};
use crate::world::{Claim, World};

pub(super) fn world(forest: &Forest) -> World {
    let (spec, trees) = (forest.spec(), forest.trees());
    let largest = trees.iter().map(|tree| tree.radius).fold(0.0, f64::max);
    let bounds = match spec.border {
        Border::Inset => spec.area(),
        Border::Open | Border::Torus => spec.area().grown(largest),
    };
    let mut provenance = spec.provenance(forest.seed());
    provenance.edited = forest.edited();
    let mut world = World::new(provenance, bounds);
    world.trees = trees.to_vec();

    let reach = largest + spec.robot_radius;
    let grid = CellList::of(spec.area(), reach, false, trees.iter().map(|tree| tree.center));
    let blocked = |p: DVec2| {
        grid.any(p, |i, offset| {
            let needed = trees[i as usize].radius + spec.robot_radius;
            offset.length_squared() <= needed * needed
        })
    };
    let [west, east] = wished(spec);
    let step = 0.25 * spec.robot_radius.max(0.1);
    world.start = nearest_free(west, spec.area(), step, &blocked).map(|p| Pose::new(p.x, p.y, 0.0));
    world.goal = nearest_free(east, spec.area(), step, &blocked).map(|p| Pose::new(p.x, p.y, 0.0));

    world.certificate = vec![Claim::CrossesWestEast {
        area: spec.area(),
        radius: spec.robot_radius,
        crosses: crosses_west_east(forest),
        predicted: predicts_crossing(forest),
    }];
    if spec.min_distance > 0.0 {
        let torus = (spec.border == Border::Torus).then_some(spec.area().size());
        world.certificate.push(Claim::TreeDistance { distance: spec.min_distance, torus });
    }
    world
}

/// Returns a free point near `wish`: the nearest one of a square lattice of side `step`, which is searched ring by
/// ring. If no free point is near, the lattice becomes coarser, so that a wide thicket costs little.
fn nearest_free(
    wish: DVec2,
    area: Rect,
    step: f64,
    blocked: &impl Fn(DVec2) -> bool,
) -> Option<DVec2> {
    const RINGS: i64 = 40;
    let (mut step, mut first) = (step, 0);
    while step * (first as f64) <= area.size().max_element() {
        for ring in first..=RINGS {
            // The ring is a square: its sides' middles are nearest, its corners farthest.
            for along in (0..=ring).flat_map(|i| [i, -i]).skip(usize::from(ring > 0)) {
                for (i, j) in [(along, ring), (along, -ring), (ring, along), (-ring, along)] {
                    let p = wish + DVec2::new(i as f64, j as f64) * step;
                    if area.contains(p) && !blocked(p) {
                        return Some(p);
                    }
                }
            }
        }
        step *= 2.0;
        first = RINGS / 2 + 1;
    }
    None
}
