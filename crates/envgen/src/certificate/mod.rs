//! The promises of a world, and an independent check of them.
//!
//! A generator writes its promises into [`World::certificate`]. [`verify`] checks them using only the world: the
//! shapes of its solid parts, whatever the generator's plan was. The region that a disc can reach is determined
//! exactly, at a cost that depends on the world's parts and not on the disc's radius. Time and memory have limits:
//! [`MAX_PIECES`], [`MAX_COMPARISONS`], [`MAX_COMPARISONS_PER_PIECE`], [`MAX_BUBBLES`], [`MAX_SQUARES`] and
//! [`MAX_BEND_POINTS`].

mod bends;
mod blocked_cells;
mod bubbles;
mod budget;
mod disc_path;
mod outlines;
mod piece;
mod piece_index;
mod reachability;
mod squares;
mod stretches;
mod windings;

use std::borrow::Cow;
use std::collections::BTreeMap;

use glam::DVec2;
use serde::{Serialize, Serializer};

pub use crate::world::Claim;
pub use budget::{
    Doubt, MAX_BEND_POINTS, MAX_BUBBLES, MAX_COMPARISONS, MAX_COMPARISONS_PER_PIECE, MAX_PIECES,
    MAX_SQUARES,
};
pub use reachability::{PLACE_MARGIN, Unreached, unreached};

use crate::calibration::{Calibration, Prediction};
use crate::difficulty::{DifficultyVector, Platform};
use bends::bends_keep;
use bubbles::Bubbles;
use budget::Budget;
use disc_path::{Barriers, Nearer};
use piece_index::Pieces;

use crate::geometry::Rect;
use crate::world::World;

/// The result of checking a claim. It serialises to its name only, such as `holds`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The claim holds.
    Holds,
    /// The claim does not hold.
    Broken,
    /// The claim could not be decided, for this reason.
    Undecided(Doubt),
}

impl Verdict {
    /// Returns the name: `holds`, `broken` or `undecided`.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Holds => "holds",
            Verdict::Broken => "broken",
            Verdict::Undecided(_) => "undecided",
        }
    }

    /// Returns the reason why the claim is undecided; `None` if it is decided.
    pub fn doubt(self) -> Option<Doubt> {
        match self {
            Verdict::Undecided(doubt) => Some(doubt),
            Verdict::Holds | Verdict::Broken => None,
        }
    }
}

impl Serialize for Verdict {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Checks every claim of a world's certificate, in order.
///
/// ```
/// use envgen::certificate::{Claim, Verdict, verify, verify_claims};
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
///
/// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
/// let checked = verify(&world);
/// assert!(!checked.is_empty());
/// assert!(checked.iter().all(|(_, verdict)| *verdict == Verdict::Holds));
/// // A disc of 5 m does not fit into a corridor of 2 m.
/// let wide = [Claim::Connected { radius: 5.0 }];
/// assert_eq!(verify_claims(&world, &wide)[0].1, Verdict::Broken);
/// # Ok::<(), envgen::GenerateError>(())
/// ```
pub fn verify(world: &World) -> Vec<(Claim, Verdict)> {
    verify_claims(world, &world.certificate)
}

/// Checks claims about a world, in order, whether or not its certificate contains them. A claim with a negative
/// distance, a number that is not finite or an empty area is undecided ([`Doubt::Indefinite`]).
pub fn verify_claims(world: &World, claims: &[Claim]) -> Vec<(Claim, Verdict)> {
    claims.iter().map(|claim| (*claim, verdict(world, claim))).collect()
}

fn verdict(world: &World, claim: &Claim) -> Verdict {
    match holds(world, claim) {
        Ok(true) => Verdict::Holds,
        Ok(false) => Verdict::Broken,
        Err(doubt) => Verdict::Undecided(doubt),
    }
}

fn holds(world: &World, claim: &Claim) -> Result<bool, Doubt> {
    // Comparisons with such numbers would give any verdict.
    if let Some(field) = claim.indefinite() {
        return Err(Doubt::Indefinite(field));
    }
    let budget = &mut Budget::new(MAX_COMPARISONS);
    match *claim {
        Claim::Connected { radius } => start_reaches_goal(world, radius, budget),
        Claim::TreeDistance { distance, torus } => Ok(trees_keep(world, distance, torus)),
        Claim::CrossesWestEast { area, radius, crosses, .. } => {
            let shapes: Vec<_> = reachability::barriers(world).collect();
            let pieces = Pieces::new(shapes.iter().map(|shape| &**shape), radius)?;
            let barriers = Barriers::new(&pieces, area, radius);
            Ok(barriers.crosses(shapes.iter().map(|shape| &**shape), budget)? == crosses)
        }
        Claim::BendRadius { radius } => {
            let mut points = MAX_BEND_POINTS;
            for strip in &world.road_strips {
                if !bends_keep(strip, radius, &mut points)? {
                    return Ok(false);
                }
            }
            Ok(true)
        }
        Claim::EveryPlaceReachable { radius } => {
            reachability::every_place_reachable(world, radius, budget)
        }
        Claim::Headroom { height } => {
            Ok(world.lintels().iter().flatten().all(|lintel| lintel.bottom() >= height))
        }
        Claim::PredictedDifficulty { prediction } => predicts(world, &prediction),
        Claim::AddedDoorway { doorway } => {
            Ok(world.doorways.get(doorway as usize).is_some_and(|doorway| doorway.open))
        }
    }
}

/// Whether the calibration gives the same prediction again.
fn predicts(world: &World, claimed: &Prediction) -> Result<bool, Doubt> {
    let Ok(vector) = DifficultyVector::of(world, &Platform::default()) else { return Ok(false) };
    let indoor = Calibration::indoor();
    let prediction = indoor.predict(&vector);
    // Worlds of different sizes are predicted by different calibrations. That of smaller worlds is the newer one.
    let is_of_smaller = |smaller: &Calibration| smaller.version == claimed.calibration;
    match claimed.calibration == prediction.calibration {
        false if indoor.smaller.as_deref().is_some_and(is_of_smaller) => Ok(false),
        false => Err(Doubt::OtherCalibration),
        true => Ok(prediction == *claimed),
    }
}

/// Whether a disc fits at the start and at the goal, and can move from one to the other with its centre inside the
/// world's bounds.
fn start_reaches_goal(world: &World, radius: f64, budget: &mut Budget) -> Result<bool, Doubt> {
    let (Some(start), Some(goal)) = (world.start, world.goal) else { return Ok(false) };
    let ends = [start.position, goal.position];
    // Bounds are kept up to a tolerance.
    let area = ends.iter().fold(world.bounds, |area, &end| area.union(Rect::new(end, end)));
    let shapes: Vec<_> = reachability::barriers(world).collect();
    let shapes = || shapes.iter().map(|shape| Cow::Borrowed(&**shape));
    let pieces = Pieces::new(shapes(), radius)?;
    let barriers = Barriers::new(&pieces, area, radius);
    let mut is_close = false;
    for end in ends {
        let room = shapes().map(|shape| shape.distance(end)).fold(f64::INFINITY, f64::min);
        match barriers.nearer(room, radius) {
            Nearer::Yes => return Ok(false),
            Nearer::Perhaps => is_close = true,
            Nearer::No => {}
        }
    }
    if is_close {
        return Err(Doubt::TooClose);
    }
    // Many small pieces near each other make many pairs, but hardly more bubbles.
    match barriers.join(&[ends], &mut budget.half()) {
        Err(Doubt::Comparisons) => budget.grow(pieces.list().len()),
        decided => return decided,
    }
    if radius > 0.0 {
        // Clearance that rounding may take away does not count.
        let radius = radius + barriers.rounding();
        let bubbles = Bubbles::new(shapes(), area, radius)?;
        if bubbles.join(ends, &mut budget.half()) == Ok(true) {
            return Ok(true);
        }
    }
    barriers.join(&[ends], budget)
}

/// Whether all trees keep a distance from each other, on a torus also across its sides. The trees are compared in
/// rows as high as the distance, each sorted by x.
fn trees_keep(world: &World, distance: f64, torus: Option<DVec2>) -> bool {
    if distance <= 0.0 {
        return true;
    }
    let mut rows: BTreeMap<i64, Vec<DVec2>> = BTreeMap::new();
    let mut put = |p: DVec2| rows.entry((p.y / distance).floor() as i64).or_default().push(p);
    for center in world.trees.iter().map(|tree| tree.center) {
        let center = torus.map_or(center, |size| center - size * (center / size).floor());
        put(center);
        // Trees near the low sides count beyond the high sides too.
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
        // A row beyond all numbers holds everything that is so far.
        let above = number.checked_add(1).and_then(|above| rows.get(&above));
        let above = above.map_or(&[][..], Vec::as_slice);
        row.iter().enumerate().all(|(i, &a)| {
            let first = above.partition_point(|b| b.x <= a.x - distance);
            let beside = row[i + 1..].iter().take_while(|b| b.x < a.x + distance);
            let over = above[first..].iter().take_while(|b| b.x < a.x + distance);
            beside.chain(over).all(|&b| apart(a, b))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dials::{Dials, Estimate};
    use crate::forest::{Border, ForestSpec};
    use crate::generate::{Blueprint, Spec};
    use crate::geometry::{Pose, Shape};
    use crate::hallway::{Corners, Ends as HallwayEnds, HallwaySpec, Start, State};
    use crate::indoor::IndoorSpec;
    use crate::provenance::Provenance;
    use crate::road::RoadSpec;
    use crate::seed::Seed;
    use crate::world::{Surface, SurfaceKind, Wall, WallKind};
    use proptest::prelude::*;

    /// A wall from south to north with a gap of `gap` metres in its middle.
    fn gap_world(gap: f64) -> World {
        let bounds = Rect::new(DVec2::ZERO, DVec2::new(10.0, 6.0));
        let mut world = World::new(Provenance::other("manual", serde_json::Value::Null), bounds);
        for (low, high) in [(0.0, 3.0 - 0.5 * gap), (3.0 + 0.5 * gap, 6.0)] {
            let rect = Rect::new(DVec2::new(5.0, low), DVec2::new(5.2, high));
            world.walls.push(Wall::new(WallKind::Wall, Shape::from_rect(rect)));
        }
        world.start = Some(Pose::new(1.0, 1.0, 0.0));
        world.goal = Some(Pose::new(9.0, 5.0, 0.0));
        world
    }

    #[test]
    fn a_gap_lets_through_what_is_narrower() {
        for (gap, passable) in [(1.02, true), (0.98, false), (0.0, false)] {
            let mut world = gap_world(gap);
            let area = world.bounds;
            for claimed in [true, false] {
                let claim =
                    Claim::CrossesWestEast { area, radius: 0.5, crosses: claimed, predicted: None };
                let expected = if passable == claimed { Verdict::Holds } else { Verdict::Broken };
                world.certificate = vec![claim];
                assert_eq!(verify(&world), [(claim, expected)], "gap {gap}");
            }
            let claim = Claim::Connected { radius: 0.5 };
            world.certificate = vec![claim];
            let expected = if passable { Verdict::Holds } else { Verdict::Broken };
            assert_eq!(verify(&world), [(claim, expected)], "gap {gap}");
        }
    }

    #[test]
    fn no_path_leads_through_water() {
        let spec = HallwaySpec { segments: 12, ..Default::default() };
        let mut world = spec.generate(Seed(4)).unwrap().to_world();
        assert!(verify(&world).iter().all(|(_, verdict)| *verdict == Verdict::Holds));
        // Across the whole corridor, half of the path from its start.
        let middle = 0.5 * (world.start.unwrap().position + world.goal.unwrap().position);
        let half = 0.5 * world.bounds.size() + 1.0;
        let band = Rect::new(middle - DVec2::new(half.x, 0.2), middle + DVec2::new(half.x, 0.2));
        let band = Surface::new(SurfaceKind::Slippery, Shape::from_rect(band));
        world.surfaces = vec![band.clone()];
        assert!(verify(&world).iter().all(|(_, verdict)| *verdict == Verdict::Holds));
        world.surfaces = vec![Surface { kind: SurfaceKind::Water, ..band.clone() }];
        assert_eq!(verify(&world)[0].1, Verdict::Broken);
        world.surfaces = vec![Surface { speed: 0.0, ..band }];
        assert_eq!(verify(&world)[0].1, Verdict::Broken);
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
        // Far smaller than any coordinate.
        let tiny = Claim::TreeDistance { distance: 1e-20, torus: None };
        world.certificate = vec![tiny];
        assert_eq!(verify(&world), [(tiny, Verdict::Holds)]);
    }

    #[test]
    fn roads_keep_their_promises() {
        for seed in 0..20 {
            let transition = 0.02 * seed as f64;
            let spec = RoadSpec { segment_count: 8, transition, ..Default::default() };
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
                wall_thickness: wall,
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
        for corners in [Corners::Square, Corners::Rounded] {
            let spec = HallwaySpec { segments: 10_000, corners, ..Default::default() };
            let world = spec.generate(Seed(1)).unwrap().to_world();
            for (claim, verdict) in verify(&world) {
                assert_eq!(verdict, Verdict::Holds, "{claim}");
            }
        }
    }

    #[test]
    fn trees_keep_their_distance_across_the_sides_of_a_torus() {
        for seed in 0..4 {
            let border = Border::Torus;
            let spec = ForestSpec { min_distance: 3.0, border, ..Default::default() };
            let mut world = spec.generate(Seed(seed)).unwrap().to_world();
            let claim = *world.certificate.last().unwrap();
            assert!(verify(&world).contains(&(claim, Verdict::Holds)));
            // Also beside the torus.
            let moved = DVec2::new(-123.0, 7.5);
            world.trees.iter_mut().for_each(|tree| tree.center += moved);
            world.bounds.min += moved;
            world.bounds.max += moved;
            assert!(verify(&world).contains(&(claim, Verdict::Holds)));
            // One tree too near to another, across a corner.
            for (a, b) in [((0.5, 0.5), (49.0, 49.0)), ((12.0, 5.0), (62.5, 5.0))] {
                world.trees[0].center = DVec2::from(a);
                world.trees[1].center = DVec2::from(b);
                assert!(verify(&world).contains(&(claim, Verdict::Broken)));
            }
        }
    }

    #[test]
    fn the_union_of_trunks_and_the_flood_agree_on_paths_through() {
        // Below and above the percolation threshold.
        let mut crossings = 0;
        for seed in 0..30 {
            let intensity = if seed % 2 == 0 { 0.15 } else { 0.22 };
            let spec = ForestSpec { intensity, ..Default::default() };
            let world = spec.generate(Seed(seed)).unwrap().to_world();
            let [(claim, verdict)] = verify(&world)[..] else { panic!("one claim") };
            assert_eq!(verdict, Verdict::Holds, "seed {seed}: {claim}");
            crossings += u32::from(matches!(claim, Claim::CrossesWestEast { crosses: true, .. }));
        }
        assert!((8..=22).contains(&crossings), "{crossings} crossings");
    }

    #[test]
    fn every_radius_is_decided() {
        let hallway =
            HallwaySpec { narrowing_rate: 0.3, narrowing_width: 0.02, ..Default::default() };
        let mut worlds = vec![hallway.generate(Seed(0)).unwrap().to_world()];
        for robot_radius in [0.0, 1e-6, 0.001, 0.01, 0.1] {
            let spec = ForestSpec { robot_radius, ..Default::default() };
            worlds.push(spec.generate(Seed(3)).unwrap().to_world());
        }
        for footprint in [0.01, 0.05, 0.1] {
            let spec =
                IndoorSpec { robot_radius: footprint, width: 8, height: 8, ..Default::default() };
            worlds.extend((1..4).map(|seed| spec.generate(Seed(seed)).unwrap().to_world()));
        }
        for world in &mut worlds {
            for (claim, verdict) in verify(world) {
                assert_eq!(verdict, Verdict::Holds, "{claim}: {:?}", world.provenance.spec);
            }
            for radius in [0.0, 1e-9, 0.001, 1e3, 1e300] {
                world.certificate = vec![Claim::Connected { radius }];
                let expected = if radius < 1.0 { Verdict::Holds } else { Verdict::Broken };
                if world.trees.is_empty() || radius > 1.0 {
                    assert_eq!(verify(world)[0].1, expected, "{radius}");
                }
            }
        }
    }

    #[test]
    fn work_beyond_the_budget_is_undecided() {
        let spec = HallwaySpec { segments: 1000, ..Default::default() };
        let world = spec.generate(Seed(1)).unwrap().to_world();
        let decided = |comparisons| start_reaches_goal(&world, 0.5, &mut Budget::new(comparisons));
        assert_eq!(decided(1000), Err(Doubt::Comparisons));
        assert_eq!(decided(1_000_000), Ok(true));
        let verdict = Verdict::Undecided(Doubt::Comparisons);
        assert_eq!(
            verdict.doubt().unwrap().to_string(),
            "the budget of 536870912 comparisons, or 16384 per piece, is spent"
        );
    }

    /// With polygons, which their index keeps from costing their square.
    #[test]
    fn large_buildings_are_decided() {
        let spec = IndoorSpec { width: 280, height: 280, robot_radius: 0.01, ..Default::default() };
        let world = spec.generate(Seed(2)).unwrap().to_world();
        for (claim, verdict) in verify(&world) {
            assert_eq!(verdict, Verdict::Holds, "{claim}");
        }
    }

    #[test]
    fn claims_that_are_not_definite_never_hold() {
        let worlds = [
            gap_world(1.0),
            ForestSpec::default().generate(Seed(1)).unwrap().to_world(),
            RoadSpec { segment_count: 4, ..Default::default() }
                .generate(Seed(1))
                .unwrap()
                .to_world(),
            IndoorSpec { width: 6, height: 6, ..Default::default() }
                .generate(Seed(1))
                .unwrap()
                .to_world(),
        ];
        let area = Rect::new(DVec2::ZERO, DVec2::ONE);
        let crosses =
            |area, radius| Claim::CrossesWestEast { area, radius, crosses: false, predicted: None };
        let predicted = |value| {
            let dial = Estimate { value, standard_error: 1.0 };
            let dials = Dials { difficulty: dial, mapping: dial, navigation: dial };
            let calibration = Calibration::indoor().version;
            let prediction = Prediction { calibration, dials, outside: 0.0 };
            Claim::PredictedDifficulty { prediction }
        };
        let mut claims = Vec::new();
        for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, -1e-300] {
            claims.extend([
                (Claim::Connected { radius: number }, "radius"),
                (Claim::TreeDistance { distance: number, torus: None }, "distance"),
                (
                    Claim::TreeDistance { distance: 1.0, torus: Some(DVec2::new(9.0, number)) },
                    "torus",
                ),
                (crosses(area, number), "radius"),
                (crosses(Rect::new(DVec2::ZERO, DVec2::new(1.0, number)), 0.1), "area"),
                (Claim::BendRadius { radius: number }, "radius"),
                (Claim::EveryPlaceReachable { radius: number }, "radius"),
                (Claim::Headroom { height: number }, "height"),
            ]);
            if !number.is_finite() {
                claims.push((predicted(number), "difficulty"));
            }
        }
        for world in &worlds {
            for &(claim, field) in &claims {
                let expected = Verdict::Undecided(Doubt::Indefinite(field));
                assert_eq!(verify_claims(world, &[claim])[0].1, expected, "{claim:?}");
                assert!(expected.doubt().unwrap().to_string().starts_with(&format!("`{field}`")));
            }
        }
    }
}
