//! Whether every room, hallway and open area can be reached.

use super::Verdict;
use super::ways::{Flood, MOST_POINTS, SparseBits};
use crate::geometry::Shape;
use crate::world::{SurfaceKind, World};

/// Whether a disc can move from the start to every place on the floors of the world's rooms,
/// hallways and open areas where its middle fits, by floods over ever finer lattices. It does not
/// drive on surfaces of speed 0.
///
/// Of the two sets of points that enclose the free space (see [`super::ways::decide`]) the narrow
/// one must be flooded whole. A place that is narrower than the lattice can tell from solid is not
/// looked for.
pub(super) fn every_place_reachable(world: &World, radius: f64) -> Verdict {
    let Some(start) = world.start else { return Verdict::Broken };
    let mut h = 0.25 * radius;
    if !(h > 0.0 && h.is_finite()) {
        return Verdict::Undecided;
    }
    let mut budget = MOST_POINTS;
    loop {
        let flood = Flood::new(barriers(world).collect(), world.bounds, h, radius);
        let sure = flood.sure(radius);
        let mut reached = |distance, inside| {
            let from = [flood.nearest(start.position)].into_iter();
            flood.spread(from, distance, inside, &mut budget, |_| false).map(|(reached, _)| reached)
        };
        // Every point that is free for certain is reached, and every room has one that is.
        let whole = |reached: &SparseBits| {
            let missed = |at| !reached.contains(at) && flood.is_clear(at, sure);
            !floors(world).any(|floor| flood.points_in(floor).any(missed))
                && world
                    .rooms
                    .iter()
                    .all(|room| flood.points_in(&room.shape).any(|at| reached.contains(at)))
        };
        match reached(sure, true) {
            None => return Verdict::Undecided,
            Some(reached) if whole(&reached) => return Verdict::Holds,
            Some(_) => {}
        }
        if let Some(distance) = flood.maybe(radius) {
            match reached(distance, false) {
                None => return Verdict::Undecided,
                Some(reached) if !whole(&reached) => return Verdict::Broken,
                Some(_) => {}
            }
        }
        h *= 0.6;
    }
}

fn barriers(world: &World) -> impl Iterator<Item = Shape> + '_ {
    let solids = world.solids().map(|solid| solid.shape.into_owned());
    let deep = world.surfaces.iter().filter(|surface| surface.speed == 0.0);
    solids.chain(deep.map(|surface| surface.shape.clone()))
}

fn floors(world: &World) -> impl Iterator<Item = &Shape> {
    let halls = world
        .surfaces
        .iter()
        .filter(|s| matches!(s.kind, SurfaceKind::Hallway | SurfaceKind::OpenArea));
    world.rooms.iter().map(|room| &room.shape).chain(halls.map(|surface| &surface.shape))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::{Claim, verify};
    use crate::generate::{Blueprint, Spec};
    use crate::indoor::{IndoorSpec, Layout, Profile};
    use crate::seed::Seed;

    #[test]
    fn indoor_maps_keep_their_promises() {
        for (seed, difficulty) in (0..12).zip([0.0, 2.0, 4.5, 6.8, 8.0, 10.0].into_iter().cycle()) {
            let layout = if seed % 2 == 0 { Layout::Grid } else { Layout::LSystem };
            let spec =
                IndoorSpec { difficulty, width: 14, height: 11, layout, ..Default::default() };
            let world = spec.generate(Seed(seed)).unwrap().to_world();
            assert!(world.certificate.contains(&Claim::EveryPlaceReachable { radius: 0.36 }));
            for (claim, verdict) in verify(&world) {
                assert_eq!(verdict, Verdict::Holds, "d = {difficulty}, seed {seed}: {claim}");
            }
        }
    }

    #[test]
    fn large_maps_are_decided_too() {
        let spec = IndoorSpec { width: 40, height: 40, ..Default::default() };
        let world = spec.generate(Seed(1)).unwrap().to_world();
        for (claim, verdict) in verify(&world) {
            assert_eq!(verdict, Verdict::Holds, "{claim}");
        }
    }

    #[test]
    fn a_closed_room_breaks_the_promise() {
        let spec = IndoorSpec { width: 8, height: 8, difficulty: 1.0, ..Default::default() };
        let mut world = spec.generate(Seed(2)).unwrap().to_world();
        let claim = Claim::EveryPlaceReachable { radius: 0.36 };
        world.certificate = vec![claim];
        assert_eq!(verify(&world), [(claim, Verdict::Holds)]);
        for door in world.doorways.iter_mut().filter(|door| door.rooms.contains(&Some(0))) {
            door.open = false;
        }
        assert_eq!(verify(&world), [(claim, Verdict::Broken)]);
    }

    #[test]
    fn the_graph_and_the_flood_agree_on_the_thesis() {
        let claim = Claim::EveryPlaceReachable { radius: 0.36 };
        let (mut whole, mut parted) = (0, 0);
        for seed in 0..16 {
            let spec = IndoorSpec {
                width: 9,
                height: 9,
                difficulty: 3.0 + seed as f64 * 0.4,
                profile: Profile::Thesis,
                ..Default::default()
            };
            let plan = spec.generate(Seed(seed)).unwrap();
            let one = plan.access().parts() == 1;
            let mut world = plan.to_world();
            world.certificate.retain(|kept| *kept != claim);
            world.certificate.push(claim);
            let expected = if one { Verdict::Holds } else { Verdict::Broken };
            for (claim, verdict) in verify(&world) {
                let is_places = matches!(claim, Claim::EveryPlaceReachable { .. });
                let expected = if is_places { expected } else { Verdict::Holds };
                assert_eq!(verdict, expected, "seed {seed}: {claim}");
            }
            if one { whole += 1 } else { parted += 1 }
        }
        assert!(whole > 0 && parted > 0, "{whole} whole, {parted} parted");
    }
}
