//! What is promised of a world, and an independent check of it.
//!
//! A generator writes its promises into [`World::certificate`]. [`verify`] checks them on the world
//! alone, by other means than the generator's: floods over lattices in place of graphs and unions,
//! so that an error in one is not repeated in the other.

mod places;
mod ways;

use std::collections::BTreeMap;
use std::fmt;

use glam::DVec2;
use serde::{Deserialize, Serialize};
use ways::{Ends, decide};

use crate::geometry::{Rect, wrap_angle};
use crate::world::{RoadStrip, World};

/// A promise that a generator makes of a world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Claim {
    /// A disc of this radius can move from the start to the goal.
    Connected {
        /// Radius of the disc in metres.
        radius: f64,
    },
    /// No two trees' centres are nearer than this.
    TreeDistance {
        /// Least distance in metres.
        distance: f64,
        /// Width and height of the area in metres where distances count across its joined sides.
        torus: Option<DVec2>,
    },
    /// Whether a disc can cross an area from its west to its east side with its middle inside.
    CrossesWestEast {
        /// The area.
        area: Rect,
        /// Radius of the disc in metres.
        radius: f64,
        /// Whether it can.
        crosses: bool,
        /// Whether theory predicts so for a wide forest of this density.
        predicted: bool,
    },
    /// No bend of a road is tighter than this.
    BendRadius {
        /// Least radius in metres.
        radius: f64,
    },
    /// From the start a disc of this radius can reach every room, or every part of a room that its
    /// contents divide, and every piece of the hallways and open areas.
    EveryPlaceReachable {
        /// Radius of the disc in metres.
        radius: f64,
    },
    /// This doorway was added, and is open, so that some place can be reached.
    AddedDoorway {
        /// Its place in [`World::doorways`](crate::World::doorways).
        doorway: u32,
    },
}

impl Claim {
    /// Whether its distances are finite and not negative, and its area finite and not empty.
    pub(crate) fn is_definite(&self) -> bool {
        let distance = |d: f64| d.is_finite() && d >= 0.0;
        match *self {
            Claim::Connected { radius } => distance(radius),
            Claim::TreeDistance { distance: least, torus } => {
                distance(least)
                    && torus.is_none_or(|size| size.is_finite() && size.cmpgt(DVec2::ZERO).all())
            }
            Claim::CrossesWestEast { area, radius, .. } => {
                let finite = area.min.is_finite() && area.max.is_finite();
                distance(radius) && finite && area.min.cmplt(area.max).all()
            }
            Claim::BendRadius { radius } => distance(radius),
            Claim::EveryPlaceReachable { radius } => distance(radius),
            Claim::AddedDoorway { .. } => true,
        }
    }
}

/// What became of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It holds.
    Holds,
    /// It does not hold.
    Broken,
    /// It is too close to call, or the world is too large, for the finest lattice that is tried.
    Undecided,
}

impl fmt::Display for Claim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Claim::Connected { radius } => {
                write!(f, "a disc of radius {radius} m can move from start to goal")
            }
            Claim::TreeDistance { distance, .. } => {
                write!(f, "no two trees' centres are nearer than {distance} m")
            }
            Claim::CrossesWestEast { radius, crosses, predicted, .. } => {
                let word = |can: bool| if can { "can" } else { "cannot" };
                write!(
                    f,
                    "a disc of radius {radius} m {} cross from west to east (predicted: {})",
                    word(*crosses),
                    word(*predicted)
                )
            }
            Claim::BendRadius { radius } => {
                write!(f, "no bend of a road is tighter than {radius} m")
            }
            Claim::EveryPlaceReachable { radius } => {
                write!(f, "a disc of radius {radius} m can reach every room and hallway")
            }
            Claim::AddedDoorway { doorway } => {
                write!(f, "doorway {doorway} was added so that a place can be reached")
            }
        }
    }
}

/// Checks every claim of a world's certificate, in order.
pub fn verify(world: &World) -> Vec<(Claim, Verdict)> {
    world.certificate.iter().map(|claim| (*claim, verdict(world, claim))).collect()
}

fn verdict(world: &World, claim: &Claim) -> Verdict {
    match *claim {
        Claim::Connected { radius } => match (world.start, world.goal) {
            (Some(start), Some(goal)) => {
                let ends = Ends::Points(start.position, goal.position);
                decide(world, world.bounds, radius, true, &ends)
            }
            _ => Verdict::Broken,
        },
        Claim::TreeDistance { distance, torus } => {
            if trees_keep(world, distance, torus) {
                Verdict::Holds
            } else {
                Verdict::Broken
            }
        }
        Claim::CrossesWestEast { area, radius, crosses, .. } => {
            decide(world, area, radius, crosses, &Ends::WestToEast)
        }
        Claim::BendRadius { radius } => {
            if world.road_strips.iter().all(|strip| bends_keep(strip, radius)) {
                Verdict::Holds
            } else {
                Verdict::Broken
            }
        }
        Claim::EveryPlaceReachable { radius } => places::every_place_reachable(world, radius),
        Claim::AddedDoorway { doorway } => match world.doorways.get(doorway as usize) {
            Some(doorway) if doorway.open => Verdict::Holds,
            _ => Verdict::Broken,
        },
    }
}

/// The most places at which a road's bends are looked at.
const MOST_PLACES: f64 = (1 << 24) as f64;

/// Whether all trees keep a distance, on a torus across its sides too: in rows as high as the
/// distance, each in order of x.
fn trees_keep(world: &World, distance: f64, torus: Option<DVec2>) -> bool {
    if distance <= 0.0 {
        return true;
    }
    let mut rows: BTreeMap<i64, Vec<DVec2>> = BTreeMap::new();
    let mut put = |p: DVec2| rows.entry((p.y / distance).floor() as i64).or_default().push(p);
    for center in world.trees.iter().map(|tree| tree.center) {
        put(center);
        // Trees near the low sides stand beyond the high ones too.
        if let Some(size) = torus {
            let low = [center.x < distance, center.y < distance];
            for (i, j) in [(1, 0), (0, 1), (1, 1), (-1, 1)] {
                let x_ok =
                    i == 0 || (i == 1 && low[0]) || (i == -1 && center.x > size.x - distance);
                if x_ok && (j == 0 || low[1]) {
                    put(center + size * DVec2::new(f64::from(i), f64::from(j)));
                }
            }
        }
    }
    rows.values_mut().for_each(|row| row.sort_by(|a, b| a.x.total_cmp(&b.x)));
    let apart = |a: DVec2, b: DVec2| a.distance_squared(b) >= distance * distance;
    rows.iter().all(|(number, row)| {
        let above = rows.get(&(number + 1)).map_or(&[][..], Vec::as_slice);
        row.iter().enumerate().all(|(i, &a)| {
            let first = above.partition_point(|b| b.x <= a.x - distance);
            let beside = row[i + 1..].iter().take_while(|b| b.x < a.x + distance);
            let over = above[first..].iter().take_while(|b| b.x < a.x + distance);
            beside.chain(over).all(|&b| apart(a, b))
        })
    })
}

/// Whether no bend of a road is tighter than a radius: by the curvatures that it states, and by the
/// places that it leads through. Where the curvature stays within 1 / radius and the heading
/// changes by an angle under pi, the chord is at least 2 radius sin(angle / 2).
fn bends_keep(strip: &RoadStrip, radius: f64) -> bool {
    let path = strip.path();
    let stated = strip.centreline.iter().map(|point| point.curvature.abs());
    let mut stated = stated.chain(path.curves().iter().map(|curve| curve.tightest()));
    let parts = (path.length() / (0.5 * radius)).ceil().clamp(1.0, MOST_PLACES);
    let mut walk = path.walk();
    let mut before = path.pose_at(0.0);
    stated.all(|curvature| curvature * radius <= 1.0 + 1e-9)
        && (1..=parts as u64).all(|i| {
            let (pose, _) = walk.to(path.length() * (i as f64 / parts));
            let angle = wrap_angle(pose.heading - before.heading).abs();
            let chord = pose.position.distance(before.position);
            let slack = 1e-9 * (1.0 + pose.position.length());
            before = pose;
            2.0 * radius * libm::sin(0.5 * angle) <= chord + slack
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forest::{Border, ForestSpec};
    use crate::generate::{Blueprint, Spec};
    use crate::geometry::{Pose, Shape};
    use crate::hallway::{Corners, Ends as HallwayEnds, HallwaySpec, Start, State};
    use crate::provenance::Provenance;
    use crate::road::RoadSpec;
    use crate::seed::Seed;
    use crate::world::{Wall, WallKind};
    use proptest::prelude::*;

    /// A wall from south to north with a gap of `gap` metres in its middle.
    fn gap_world(gap: f64) -> World {
        let bounds = Rect::new(DVec2::ZERO, DVec2::new(10.0, 6.0));
        let mut world = World::new(Provenance::other("manual", serde_json::Value::Null), bounds);
        for (low, high) in [(0.0, 3.0 - 0.5 * gap), (3.0 + 0.5 * gap, 6.0)] {
            let rect = Rect::new(DVec2::new(5.0, low), DVec2::new(5.2, high));
            world.walls.push(Wall { kind: WallKind::Wall, shape: Shape::from_rect(rect) });
        }
        world.start = Some(Pose::new(1.0, 1.0, 0.0));
        world.goal = Some(Pose::new(9.0, 5.0, 0.0));
        world
    }

    #[test]
    fn a_gap_lets_through_what_is_narrower() {
        for (gap, way) in [(1.02, true), (0.98, false), (0.0, false)] {
            let mut world = gap_world(gap);
            let area = world.bounds;
            for claimed in [true, false] {
                let claim =
                    Claim::CrossesWestEast { area, radius: 0.5, crosses: claimed, predicted: true };
                let expected = if way == claimed { Verdict::Holds } else { Verdict::Broken };
                world.certificate = vec![claim];
                assert_eq!(verify(&world), [(claim, expected)], "gap {gap}");
            }
            let claim = Claim::Connected { radius: 0.5 };
            world.certificate = vec![claim];
            let expected = if way { Verdict::Holds } else { Verdict::Broken };
            assert_eq!(verify(&world), [(claim, expected)], "gap {gap}");
        }
    }

    #[test]
    fn trees_too_near_break_their_claim() {
        let spec = ForestSpec { min_distance: 2.0, ..Default::default() };
        let mut world = spec.generate(Seed(1)).unwrap().to_world();
        assert!(verify(&world).iter().all(|(_, verdict)| *verdict == Verdict::Holds));
        world.trees[3].center = world.trees[4].center + DVec2::new(1.9, 0.0);
        assert_eq!(
            verify(&world).last().unwrap(),
            &(Claim::TreeDistance { distance: 2.0, torus: None }, Verdict::Broken)
        );
    }

    #[test]
    fn roads_keep_their_promises() {
        for seed in 0..20 {
            let transition = 0.02 * seed as f64;
            let spec = RoadSpec { random: 8, transition, ..Default::default() };
            let mut world = spec.generate(Seed(seed)).unwrap().to_world();
            for (claim, verdict) in verify(&world) {
                assert_eq!(verdict, Verdict::Holds, "seed {seed}: {claim}");
            }
            let turning = world.road_strips[0].pieces.iter().any(|piece| !piece.is_line());
            for claim in &mut world.certificate {
                if let Claim::BendRadius { radius } = claim {
                    *radius *= 1.01;
                    assert!(turning);
                }
            }
            let broken = verify(&world).iter().any(|(_, verdict)| *verdict == Verdict::Broken);
            assert_eq!(broken, turning, "seed {seed}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn hallways_keep_their_promises(
            seed: u64,
            start in 1..=8_u8,
            segments in 1..40_u64,
            p_tt in prop_oneof![Just(0.0), 0.0..=1.0_f64],
            pitch in 0.5..6.0_f64,
            fill in 0.1..=1.0_f64,
            wall in 0.02..0.3_f64,
            rounded: bool,
            open: bool,
            rates in prop::array::uniform3(prop_oneof![Just(0.0), 0.0..0.05_f64]),
        ) {
            let rows = if p_tt > 0.0 { 1.0 } else { 2.0 };
            let width = fill * (rows * pitch - wall);
            let spec = HallwaySpec {
                segments,
                p_tt,
                start: Start::State(State::new(start).unwrap()),
                pitch,
                width,
                wall,
                corners: if rounded { Corners::Rounded } else { Corners::Square },
                ends: if open { HallwayEnds::Open } else { HallwayEnds::Closed },
                alcove_rate: rates[0],
                alcove_width: 0.5 * pitch - wall.min(0.4 * pitch),
                alcove_depth: 0.3 * pitch,
                door_frame_rate: rates[1],
                door_frame_width: 0.6 * width,
                narrowing_rate: rates[2],
                narrowing_width: 0.5 * width,
                ..Default::default()
            };
            prop_assume!(spec.validate().is_ok());
            let world = spec.generate(Seed(seed)).unwrap().to_world();
            for (claim, verdict) in verify(&world) {
                prop_assert_eq!(verdict, Verdict::Holds, "{} {:?}", claim, spec);
            }
        }
    }

    #[test]
    fn long_hallways_are_decided_too() {
        let spec = HallwaySpec { segments: 10_000, ..Default::default() };
        let world = spec.generate(Seed(1)).unwrap().to_world();
        assert!(verify(&world).iter().all(|(_, verdict)| *verdict == Verdict::Holds));
    }

    #[test]
    fn trees_keep_their_distance_across_the_sides_of_a_torus() {
        for seed in 0..4 {
            let border = Border::Torus;
            let spec = ForestSpec { min_distance: 3.0, border, ..Default::default() };
            let mut world = spec.generate(Seed(seed)).unwrap().to_world();
            let claim = *world.certificate.last().unwrap();
            assert!(verify(&world).contains(&(claim, Verdict::Holds)));
            // One tree too near to another, across a corner.
            world.trees[0].center = DVec2::new(0.5, 0.5);
            world.trees[1].center = DVec2::new(49.0, 49.0);
            assert!(verify(&world).contains(&(claim, Verdict::Broken)));
        }
    }

    #[test]
    fn the_union_of_trunks_and_the_flood_agree_on_ways_through() {
        // Below and above the percolation threshold. A narrowest gap within two hundredths of a
        // metre of the robot's width stays undecided.
        let (mut ways, mut decided) = (0, 0);
        for seed in 0..30 {
            let intensity = if seed % 2 == 0 { 0.15 } else { 0.22 };
            let spec = ForestSpec { intensity, ..Default::default() };
            let world = spec.generate(Seed(seed)).unwrap().to_world();
            let [(claim, verdict)] = verify(&world)[..] else { panic!("one claim") };
            assert_ne!(verdict, Verdict::Broken, "seed {seed}: {claim}");
            decided += u32::from(verdict == Verdict::Holds);
            ways += u32::from(matches!(claim, Claim::CrossesWestEast { crosses: true, .. }));
        }
        assert!(decided >= 25 && (8..=22).contains(&ways), "{decided} decided, {ways} ways");
    }
}
