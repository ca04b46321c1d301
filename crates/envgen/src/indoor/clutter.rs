//! Clutter: crates at random places of the floors, which leave every place reachable.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::DVec2;

use super::dimensions::STEP;
use super::materials::floors;
use super::spec::IndoorSpec;
use crate::clearance_index::ClearanceIndex;
use crate::geometry::{Pose, Shape};
use crate::seed::{Seed, Stream};
use crate::world::{Obstacle, ObstacleKind, World};

/// The least and the greatest side of a crate in metres.
const SIDES: [f64; 2] = [0.3, 0.9];

/// The number of places that are tried for a crate.
pub(super) const ATTEMPTS: u64 = 20;

/// A crate to be placed.
struct Candidate {
    at: DVec2,
    half_size: DVec2,
    heading: f64,
}

impl Candidate {
    /// Returns the radius of the circle around the crate, in metres.
    fn radius(&self) -> f64 {
        self.half_size.length()
    }
}

/// Adds the spec's clutter to a world; does nothing if the spec has no clutter.
///
/// Robots can pass between a crate and everything else, on every side. Around a convex solid that has free space
/// all around it, no path is lost, so that places that were connected remain connected.
pub(super) fn add(spec: &IndoorSpec, seed: Seed, world: &mut World) {
    if spec.clutter == 0.0 {
        return;
    }
    let gap = (2.0 * (spec.robot_radius + STEP)).max(spec.clearance.unwrap_or(0.0));
    let farthest = 0.5 * SIDES[1] * std::f64::consts::SQRT_2 + gap;
    let Ok(solids) = ClearanceIndex::new(&with_barriers(world), farthest) else { return };
    let floors = floors(world);
    let ends: Vec<f64> = floors
        .iter()
        .scan(0.0, |sum, floor| {
            *sum += floor.size().element_product();
            Some(*sum)
        })
        .collect();
    let Some(&area) = ends.last() else { return };

    let poses = [world.start, world.goal].into_iter().flatten();
    // Crates by squares so large that only neighbours can be too near.
    let side = farthest + 0.5 * SIDES[1] * std::f64::consts::SQRT_2;
    let square = |p: DVec2| ((p.x / side).floor() as i64, (p.y / side).floor() as i64);
    let mut placed: BTreeMap<(i64, i64), Vec<Candidate>> = BTreeMap::new();
    // Marks on the floor count as crates without a size.
    for Pose { position: at, .. } in poses.chain(world.victims.iter().copied()) {
        let mark = Candidate { at, half_size: DVec2::ZERO, heading: 0.0 };
        placed.entry(square(at)).or_default().push(mark);
    }
    for crate_number in 0..(spec.clutter * area / 100.0).round() as u64 {
        for attempt in 0..ATTEMPTS {
            let mut draws = seed.attempt("indoor/clutter", crate_number, attempt);
            let drawn = draws.unit() * area;
            let floor = floors[ends.partition_point(|&end| end <= drawn).min(floors.len() - 1)];
            let at = floor.min + floor.size() * DVec2::new(draws.unit(), draws.unit());
            let half_size = 0.5 * DVec2::new(side_of(&mut draws), side_of(&mut draws));
            let candidate = Candidate { at, half_size, heading: PI * draws.unit() };
            let needed = candidate.radius() + gap;
            let (x, y) = square(at);
            let neighbours = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (x + dx, y + dy)));
            let fits = solids.clearance(at) >= needed
                && neighbours
                    .filter_map(|square| placed.get(&square))
                    .flatten()
                    .all(|other| other.at.distance(at) - other.radius() >= needed);
            if fits {
                let Candidate { at: center, half_size, heading } = candidate;
                let shape = Shape::Box { center, half_size, heading };
                world.obstacles.push(Obstacle::new(ObstacleKind::Crate, shape));
                placed.entry((x, y)).or_default().push(candidate);
                break;
            }
        }
    }
}

fn side_of(draws: &mut Stream) -> f64 {
    SIDES[0] + (SIDES[1] - SIDES[0]) * draws.unit()
}

/// Returns the world with the surfaces that robots cannot enter as further solids.
fn with_barriers(world: &World) -> World {
    let mut solid = World::new(world.provenance.clone(), world.bounds);
    let shapes = world.solids().map(|solid| solid.shape.into_owned());
    let barriers = world
        .surfaces
        .iter()
        .filter(|surface| surface.is_barrier())
        .map(|surface| surface.shape.clone());
    solid.obstacles =
        shapes.chain(barriers).map(|shape| Obstacle::new(ObstacleKind::Other, shape)).collect();
    solid
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Spec;
    use crate::certificate::{Verdict, verify};
    use crate::indoor::IndoorSpec;
    use crate::indoor::tests::small_world as world;

    #[test]
    fn crates_add_up_and_leave_gaps() {
        let plain = world(&IndoorSpec::default(), 4);
        let at = |clutter: f64| world(&IndoorSpec { clutter, ..Default::default() }, 4).obstacles;
        assert_eq!(at(0.0), plain.obstacles);
        let (few, many) = (at(3.0), at(12.0));
        assert!(few.len() > plain.obstacles.len() && many.len() > few.len());
        assert!(many.starts_with(&few), "more clutter adds crates");
        let error = IndoorSpec { clutter: 99.0, ..Default::default() }.generate(Seed(0));
        let error = error.unwrap_err().to_string();
        assert_eq!(error, "`clutter` must be a number from 0 to 30, got 99");
    }

    #[test]
    fn every_place_stays_reachable_with_every_setting_on() {
        let spec = IndoorSpec {
            clutter: 30.0,
            doorway_narrowest: Some(0.82),
            floor_slip: 8.0,
            floor_slip_share: 0.4,
            wheel_bias: 0.2,
            wheel_bias_share: 0.3,
            dark_walls: 0.6,
            dark_objects: 0.5,
            ..Default::default()
        };
        let mut crates = 0;
        for seed in 0..40 {
            let spec = IndoorSpec { difficulty: 0.25 * seed as f64, ..spec.clone() };
            let world = world(&spec, seed);
            world.check().expect("a sound world");
            crates += world.obstacles.iter().filter(|o| o.kind == ObstacleKind::Crate).count();
            for (claim, verdict) in verify(&world) {
                assert_eq!(verdict, Verdict::Holds, "seed {seed}: {claim}");
            }
        }
        assert!(crates > 400, "{crates}");
    }
}
