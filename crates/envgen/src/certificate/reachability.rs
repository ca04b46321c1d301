//! Tests whether every room, hallway and open area can be reached.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use glam::DVec2;

use super::blocked_cells::blocked_cells;
use super::budget::{Budget, Doubt, MAX_COMPARISONS};
use super::disc_path::{Barriers, Nearer};
use super::outlines::Outlines;
use super::piece::Piece;
use super::piece_index::Pieces;
use super::squares::{Square, Squares};
use crate::geometry::{Rect, Shape};
use crate::grid::{GridFrame, index_area};
use crate::world::{World, is_distance};

/// The clearance in metres that a disc must have to spare on every side, so that a place on a floor counts.
/// Narrower places, such as the gap between two chairs, are not part of a room.
pub const PLACE_MARGIN: f64 = 0.0625;

/// The greatest difference in metres between spare clearances that count as equal.
const ALIKE: f64 = 1e-4;

/// Whether a disc can move from the start to every place on the floors of the world's rooms, hallways and open
/// areas where it has [`PLACE_MARGIN`] to spare, and into every room. It does not drive on surfaces of speed 0.
///
/// All places are found by dividing the free space of one floor after the other into squares. [`Barriers`] decide
/// whether the places of one floor, and of neighbouring floors, are connected.
pub(super) fn every_place_reachable(
    world: &World,
    radius: f64,
    budget: &mut Budget,
) -> Result<bool, Doubt> {
    let Some(ground) = StartGround::new(world, radius, budget)? else { return Ok(false) };
    budget.grow(ground.pieces.list().len());
    let space = ground.space();
    let mut places = Places::new(&space, ground.start);
    let rooms = world.rooms.iter().map(|room| (&room.shape, true));
    for (floor, is_room) in along(rooms.chain(halls(world).map(|hall| (hall, false))).collect()) {
        let is_found = places.find(floor, budget)?;
        // Into a room too narrow for places with the margin the disc has to get all the same.
        if is_room && !is_found && !places.find_any(floor, budget)? {
            return Ok(false);
        }
    }
    ground.barriers().join(&places.lines, budget)
}

/// Orders floors so that most are near the one before: in rows, alternately to the east and to the west.
fn along(mut floors: Vec<(&Shape, bool)>) -> Vec<(&Shape, bool)> {
    let middle = |floor: &Shape| floor.bounds().center();
    let Some(around) = Rect::around(floors.iter().map(|(floor, _)| middle(floor))) else {
        return floors;
    };
    let frame = GridFrame::over(index_area(Some(around), 0.0), floors.len() as f64);
    floors.sort_by_cached_key(|(floor, _)| {
        let (col, row) = frame.cell_at(middle(floor)).unwrap_or_default();
        (row, if row % 2 == 0 { col } else { frame.cols - col })
    });
    floors
}

/// The places that a disc cannot reach from a world's start.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unreached {
    /// Squares of floor, which touch but do not overlap, where the disc's centre could be with [`PLACE_MARGIN`] to
    /// spare. In worlds without floors, they cover all free ground.
    pub squares: Vec<Rect>,
    /// The indices of the rooms in which it reaches no place.
    pub rooms: Vec<u32>,
}

/// Finds the places that a disc cannot reach from the start, which are those that break
/// [`Claim::EveryPlaceReachable`](crate::world::Claim). Returns `None` if the world has no start, or if the disc
/// does not fit there. If few places are out of reach, the cost is at most a few times that of verifying the claim.
///
/// ```
/// use envgen::certificate::unreached;
/// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
///
/// let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
/// let mut world = spec.generate(Seed(2))?.to_world();
/// assert!(unreached(&world, 0.36)?.is_some_and(|places| places.squares.is_empty()));
/// for door in world.doorways.iter_mut().filter(|door| door.rooms.contains(&Some(3))) {
///     door.open = false;
/// }
/// assert_eq!(unreached(&world, 0.36)?.map(|places| places.rooms), Some(vec![3]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the radius is negative or not finite, or when it cannot be decided which places are out of reach.
pub fn unreached(world: &World, radius: f64) -> Result<Option<Unreached>, Doubt> {
    if !is_distance(radius) {
        return Err(Doubt::Indefinite("radius"));
    }
    let budget = &mut Budget::new(MAX_COMPARISONS);
    let Some(ground) = StartGround::new(world, radius, budget)? else { return Ok(None) };
    let (space, barriers) = (ground.space(), ground.barriers());
    // Connections through other ground are left to the barriers.
    let around = floors(world).map(Shape::bounds).reduce(Rect::union).unwrap_or(ground.area);
    let around = around.union(Rect::new(ground.start, ground.start));
    let squares = &space.squares(around, ground.pieces.list(), budget)?;
    let everything = [Shape::from_rect(world.bounds)];
    let has_floors = floors(world).next().is_some();
    let all: Vec<&Shape> =
        if has_floors { floors(world).collect() } else { everything.iter().collect() };
    let home = squares.at(ground.start).map(|square| squares.region(square));
    // Regions that the start reaches.
    let mut reached: BTreeSet<usize> = home.into_iter().collect();
    // Squares by region and node: floors may overlap.
    let mut others: BTreeMap<usize, BTreeMap<usize, Square>> = BTreeMap::new();
    for floor in all {
        squares.over(floor, |square| {
            let region = squares.region(square);
            if square.is_wide && Some(region) != home {
                others.entry(region).or_default().insert(square.node, square);
            }
            budget.spend(1)
        })?;
    }
    let mut found = Unreached::default();
    for (region, parts) in others {
        let mut place = None;
        for &Square { middle, half, .. } in parts.values() {
            let shape = Shape::from_rect(Rect::new(middle, middle).grown(half));
            place = space.find(&shape, middle, half, radius + PLACE_MARGIN, budget)?;
            if place.is_some() {
                break;
            }
        }
        let Some(place) = place else { continue };
        if barriers.join(&[[ground.start, place]], budget)? {
            reached.insert(region);
        } else {
            let square = |part: &Square| Rect::new(part.middle, part.middle).grown(part.half);
            found.squares.extend(parts.values().map(square));
        }
    }
    for (i, room) in world.rooms.iter().enumerate() {
        let mut has_place = false;
        squares.over(&room.shape, |square| {
            has_place |= room.shape.distance(square.middle) <= square.half
                && reached.contains(&squares.region(square));
            Ok(())
        })?;
        if has_place {
            continue;
        }
        let place = space.find_any(&room.shape, budget)?;
        let is_reached = |place| barriers.join(&[[ground.start, place]], budget);
        if !place.map_or(Ok(false), is_reached)? {
            found.rooms.push(i as u32);
        }
    }
    Ok(Some(found))
}

/// The ground around a disc at the start of a world.
struct StartGround<'a> {
    pieces: Pieces,
    outlines: Outlines<'a>,
    area: Rect,
    start: DVec2,
    radius: f64,
}

impl<'a> StartGround<'a> {
    /// Returns `None` if there is no start, or if the disc does not fit there.
    fn new(world: &'a World, radius: f64, budget: &mut Budget) -> Result<Option<Self>, Doubt> {
        let Some(start) = world.start.map(|start| start.position) else { return Ok(None) };
        let area = world.bounds.union(Rect::new(start, start));
        let shapes: Vec<_> = barriers(world).collect();
        let borrowed = shapes.iter().map(|shape| Cow::Borrowed(&**shape));
        let pieces = Pieces::new(borrowed, radius + PLACE_MARGIN)?;
        let outlines = Outlines::new(shapes.into_iter());
        let space = Space { pieces: &pieces, outlines: &outlines, area, radius };
        let clearance = space.clearance(start, budget)?;
        match Barriers::new(&pieces, area, radius).nearer(clearance, radius) {
            Nearer::Yes => return Ok(None),
            Nearer::Perhaps => return Err(Doubt::TooClose),
            Nearer::No => {}
        }
        Ok(Some(StartGround { pieces, outlines, area, start, radius }))
    }

    fn space(&self) -> Space<'_> {
        let (pieces, outlines) = (&self.pieces, &self.outlines);
        Space { pieces, outlines, area: self.area, radius: self.radius }
    }

    fn barriers(&self) -> Barriers<'_> {
        Barriers::new(&self.pieces, self.area, self.radius)
    }
}

/// Returns the shapes of all that stops a disc: solids, and ground that no robot can enter.
pub(super) fn barriers(world: &World) -> impl Iterator<Item = Cow<'_, Shape>> {
    let deep = world.surfaces.iter().filter(|surface| surface.is_barrier());
    let deep = deep.map(|surface| Cow::Borrowed(&surface.shape));
    let cells = blocked_cells(world).into_iter().map(Cow::Owned);
    world.solids().map(|solid| solid.shape).chain(deep).chain(cells)
}

fn floors(world: &World) -> impl Iterator<Item = &Shape> {
    world.rooms.iter().map(|room| &room.shape).chain(halls(world))
}

fn halls(world: &World) -> impl Iterator<Item = &Shape> {
    let halls = world.surfaces.iter().filter(|surface| surface.kind.is_hall());
    halls.map(|surface| &surface.shape)
}

/// The space in which a disc can be.
struct Space<'a> {
    pieces: &'a Pieces,
    outlines: &'a Outlines<'a>,
    area: Rect,
    radius: f64,
}

impl Space<'_> {
    /// Returns the free space in a rectangle and [`PLACE_MARGIN`] around it, if only `pieces` are near.
    fn squares(
        &self,
        around: Rect,
        pieces: &[Piece],
        budget: &mut Budget,
    ) -> Result<Squares, Doubt> {
        let around = around.grown(PLACE_MARGIN);
        let around = Rect::new(around.min.max(self.area.min), around.max.min(self.area.max));
        Squares::new(pieces, around, self.radius, PLACE_MARGIN, budget)
    }

    /// Returns the distance to the nearest obstruction for the disc's centre, up to the reach of the index. The
    /// outside of the area counts as a piece one radius beyond its sides.
    fn clearance(&self, p: DVec2, budget: &mut Budget) -> Result<f64, Doubt> {
        if self.outlines.contain(p, budget)? {
            return Ok(0.0);
        }
        let sides = (p - self.area.min).min(self.area.max - p).min_element();
        Ok(self.pieces.clearance(p, budget)?.min(sides + self.radius))
    }

    /// Returns some point of a room at which the disc just fits.
    fn find_any(&self, room: &Shape, budget: &mut Budget) -> Result<Option<DVec2>, Doubt> {
        self.find_in(room, self.radius + ALIKE, budget)
    }

    /// Whether there is a point of a room at which the disc does or does not fit, depending on the search's accuracy.
    fn has_nearly(&self, room: &Shape, budget: &mut Budget) -> Result<bool, Doubt> {
        let least = self.radius - ALIKE;
        Ok(least > 0.0 && self.find_in(room, least, budget)?.is_some())
    }

    /// Returns a point of a room with a clearance of `least`, as [`find`](Self::find).
    fn find_in(
        &self,
        room: &Shape,
        least: f64,
        budget: &mut Budget,
    ) -> Result<Option<DVec2>, Doubt> {
        let bounds = room.bounds();
        let (middle, half) = (bounds.center(), 0.5 * bounds.size().max_element());
        self.find(room, middle, half, least, budget)
    }

    /// Returns a point of a floor inside a square with a clearance of `least`, searched in the order of falling
    /// clearance; `None` if no such point is found. A point that exceeds `least` by less than [`ALIKE`] may be
    /// missed.
    fn find(
        &self,
        floor: &Shape,
        middle: DVec2,
        half: f64,
        least: f64,
        budget: &mut Budget,
    ) -> Result<Option<DVec2>, Doubt> {
        let cost = Piece::count(floor) as u64;
        let mut open = BinaryHeap::new();
        let mut parts = vec![(middle, half)];
        open.push((u64::MAX, 0));
        while let Some((_, part)) = open.pop() {
            let (middle, half) = parts[part];
            for corner in 0..4 {
                let half = 0.5 * half;
                let sign = |bit| if corner & bit == 0 { -half } else { half };
                let middle = middle + DVec2::new(sign(1), sign(2));
                let reach = half * std::f64::consts::SQRT_2;
                budget.spend(cost)?;
                if floor.distance(middle) > reach {
                    continue;
                }
                let clearance = self.clearance(middle, budget)?;
                if clearance >= least && floor.contains(middle) {
                    return Ok(Some(middle));
                }
                if clearance + reach >= least && reach > ALIKE {
                    // The bits of non-negative numbers sort as the numbers do.
                    open.push(((clearance + reach).to_bits(), parts.len()));
                    parts.push((middle, half));
                }
            }
        }
        Ok(None)
    }
}

/// The places found, in the order of the floors.
struct Places<'a> {
    space: &'a Space<'a>,
    /// The place that was found last.
    last: DVec2,
    /// Lines from every place to the next, beginning with the start.
    lines: Vec<[DVec2; 2]>,
}

impl<'a> Places<'a> {
    fn new(space: &'a Space<'a>, start: DVec2) -> Self {
        Places { space, last: start, lines: Vec::new() }
    }

    /// Adds a place of a floor in every region of its squares that has one; returns whether there is any.
    fn find(&mut self, floor: &Shape, budget: &mut Budget) -> Result<bool, Doubt> {
        let Space { pieces, area, radius, .. } = *self.space;
        let around = floor.bounds();
        let near = pieces.near(around.grown(PLACE_MARGIN), budget)?;
        if !around.overlaps(area) {
            return Ok(false);
        }
        let squares = self.space.squares(around, &near, budget)?;
        let mut regions: BTreeMap<usize, Vec<Square>> = BTreeMap::new();
        squares.over(floor, |square| {
            if square.is_wide {
                regions.entry(squares.region(square)).or_default().push(square);
            }
            budget.spend(1)
        })?;
        let before = self.lines.len();
        for parts in regions.values() {
            for &Square { middle, half, .. } in parts {
                let least = radius + PLACE_MARGIN;
                if let Some(place) = self.space.find(floor, middle, half, least, budget)? {
                    self.add(place);
                    break;
                }
            }
        }
        Ok(self.lines.len() > before)
    }

    /// Adds some point of a room at which the disc just fits; returns false if there are no such points.
    fn find_any(&mut self, room: &Shape, budget: &mut Budget) -> Result<bool, Doubt> {
        let place = self.space.find_any(room, budget)?;
        if place.is_none() && self.space.has_nearly(room, budget)? {
            return Err(Doubt::TooClose);
        }
        place.into_iter().for_each(|place| self.add(place));
        Ok(place.is_some())
    }

    fn add(&mut self, place: DVec2) {
        self.lines.push([self.last, place]);
        self.last = place;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::{Claim, Verdict, verify};
    use crate::generate::{Blueprint, Spec};
    use crate::geometry::Pose;
    use crate::indoor::{Edit, IndoorSpec, Layout, PlaceKind, PlanEditor, Profile};
    use crate::provenance::Provenance;
    use crate::seed::Seed;
    use crate::world::{Wall, WallKind};

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
    fn what_is_out_of_reach_is_found_place_by_place() {
        // The plan's own graph knows which rooms are behind closed doorways.
        let (mut apart, mut whole) = (0, 0);
        for seed in 0..12 {
            let spec = IndoorSpec { width: 9, height: 9, difficulty: 4.0, ..Default::default() };
            let mut editor = PlanEditor::new(spec.generate(Seed(seed)).unwrap());
            let gates: Vec<_> = editor.plan().openings().iter().map(|o| o.gate).collect();
            for gate in gates.into_iter().step_by(2 + seed as usize % 3) {
                editor.apply(Edit::CloseDoorway(gate)).unwrap();
            }
            let (plan, world) = (editor.plan(), editor.plan().to_world());
            let found = unreached(&world, spec.robot_radius).unwrap().unwrap();
            let claim = Claim::EveryPlaceReachable { radius: spec.robot_radius };
            assert_eq!(world.certificate.contains(&claim), found.squares.is_empty(), "{seed}");
            if found.squares.is_empty() {
                whole += 1
            } else {
                apart += 1
            }
            let access = plan.access();
            let start = world.start.unwrap().position;
            let from = access.places().iter().position(|place| place.at == start).unwrap();
            let distances = access.distances(from as u32);
            for room in 0..plan.rooms().len() as u32 {
                let is_in =
                    |kind| matches!(kind, PlaceKind::Room { room: other, .. } if other == room);
                let places = access.places().iter().zip(&distances);
                let mut of_room = places.filter(|(place, _)| is_in(place.kind));
                let is_reached = of_room.any(|(_, distance)| distance.is_finite());
                assert_eq!(found.rooms.contains(&room), !is_reached, "{seed}, room {room}");
            }
            for (place, distance) in access.places().iter().zip(&distances) {
                let lit = found.squares.iter().any(|square| square.contains(place.at));
                assert!(!lit || distance.is_infinite(), "{seed}: {place:?} is lit");
                let is_hall = !matches!(place.kind, PlaceKind::Room { .. });
                assert!(!is_hall || lit == distance.is_infinite(), "{seed}: {place:?}");
            }
        }
        assert!(apart > 2 && whole + apart == 12, "{whole} whole, {apart} apart");
    }

    #[test]
    fn worlds_without_floors_have_places_out_of_reach_too() {
        let bounds = Rect::new(DVec2::ZERO, DVec2::new(10.0, 4.0));
        let mut world = World::new(Provenance::other("manual", serde_json::Value::Null), bounds);
        assert_eq!(unreached(&world, 0.3), Ok(None));
        world.start = Some(Pose::new(1.0, 2.0, 0.0));
        assert_eq!(unreached(&world, 0.3), Ok(Some(Unreached::default())));
        let wall = Shape::from_rect(Rect::new(DVec2::new(5.0, 0.0), DVec2::new(5.2, 4.0)));
        world.walls.push(Wall::new(WallKind::Wall, wall));
        let found = unreached(&world, 0.3).unwrap().unwrap();
        let area: f64 = found.squares.iter().map(|square| square.size().element_product()).sum();
        // All that is right of the wall by the radius, less the margin: the disc's middle may be at the sides.
        assert!(area <= 4.5 * 4.0 && area > 4.3 * 3.8, "{area}");
        assert!(found.squares.iter().all(|square| square.min.x >= 5.5));
        for radius in [-0.3, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(unreached(&world, radius), Err(Doubt::Indefinite("radius")));
        }
        // Where the disc does not fit at the start, nothing is known.
        world.start = Some(Pose::new(4.8, 2.0, 0.0));
        assert_eq!(unreached(&world, 0.3), Ok(None));
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
