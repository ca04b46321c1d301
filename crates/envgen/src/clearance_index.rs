//! Clearance and contact queries: which solid parts of a [`World`] are near a point.

use glam::DVec2;

use crate::error::SpecError;
use crate::geometry::{Rect, Shape, edges, split_segment};
use crate::grid::{Convex, GridFrame, GridIndex, index_area};
use crate::world::{Extent, PartId, Solid, World};

/// Target number of cells of the index per shape, where parts are spread evenly.
const CELLS_A_SHAPE: f64 = 1.0;

/// The most cells in which a shape is listed, on average over all shapes.
const MAX_LISTINGS: usize = 48;

/// An upper bound, in metres, of the rounding error of a distance to a shape.
const ROUNDING: f64 = 1e-6;

/// Lines are split into pieces of at most this length in metres, and each piece is looked up.
const MAX_PIECE: f64 = 1.0;

/// The greatest reach of an index, in metres.
const MAX_REACH: f64 = 1e9;

/// A solid part near a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The part.
    pub part: PartId,
    /// The part's point that is nearest to the query point; the query point itself if it lies inside the part.
    pub point: DVec2,
    /// Distance from the query point to `point`, in metres.
    pub distance: f64,
}

/// A spatial index of a world's solid parts for nearest-part queries.
///
/// The index is a uniform grid. Each cell lists the shapes within `reach` of it, so that a query reads only one
/// cell. Distances are exact. The index holds a copy of the parts: build a new one when the world changes.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, clearance_index::ClearanceIndex, hallway::HallwaySpec};
///
/// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
/// let near = ClearanceIndex::new(&world, 1.5)?;
/// let start = world.start.expect("hallways have a start");
/// // The corridor is 2 m wide.
/// assert!((near.clearance(start.position) - 1.0).abs() < 1e-12);
/// # Ok::<(), envgen::GenerateError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ClearanceIndex {
    reach: f64,
    index: GridIndex,
    shapes: Vec<(PartId, Shape)>,
    hulls: Vec<Hull>,
}

/// The clearance at a point, and what the query cost.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Room {
    /// As [`ClearanceIndex::clearance`].
    pub(crate) clearance: f64,
    /// The number of the nearest shape, the same in all indices of a world; `None` beyond the reach.
    pub(crate) nearest: Option<u32>,
    /// Number of shapes that the query read; a polygon counts once per corner.
    pub(crate) cost: usize,
}

/// The bounding box of a shape.
#[derive(Clone, Copy, Debug)]
struct Hull {
    center: DVec2,
    half_size: DVec2,
    /// Whether the shape is identical to its bounding box.
    is_shape: bool,
    /// What a query pays for the shape: the number of corners of a polygon, 1 for other shapes.
    cost: u32,
}

impl Hull {
    fn of(shape: &Shape) -> Self {
        let cost = match shape {
            Shape::Polygon { vertices } => vertices.len() as u32,
            _ => 1,
        };
        match *shape {
            Shape::Box { center, half_size, heading: 0.0 } => {
                Hull { center, half_size, is_shape: true, cost }
            }
            _ => {
                let bounds = shape.bounds();
                let (center, half_size) = (bounds.center(), 0.5 * bounds.size());
                Hull { center, half_size, is_shape: false, cost }
            }
        }
    }

    /// Returns the nearest point to a point; for a box, rounded as by [`Shape::nearest_point`].
    #[inline]
    fn nearest_point(&self, p: DVec2) -> DVec2 {
        self.center + (p - self.center).clamp(-self.half_size, self.half_size)
    }

    /// Returns the squared distance from a point.
    #[inline]
    fn distance_squared(&self, p: DVec2) -> f64 {
        p.distance_squared(self.nearest_point(p))
    }
}

/// A line, and the distance from it beyond which a hull is clear of it.
struct Surrounded {
    middle: DVec2,
    /// Half the sides of the bounding box of all points within that distance of the line.
    half_size: DVec2,
    /// A vector across the line, as long as the line.
    normal: DVec2,
    /// The distance times the length of the line.
    breadth: f64,
}

impl Surrounded {
    fn new(from: DVec2, to: DVec2, distance: f64) -> Self {
        let along = to - from;
        let distance = distance + ROUNDING;
        Surrounded {
            middle: from.midpoint(to),
            half_size: 0.5 * along.abs() + distance,
            normal: along.perp(),
            breadth: distance * along.length(),
        }
    }

    /// Whether a cheap test shows that a hull is clear of the line: along one of the axes, or across the line. A
    /// hull that fails the test can be clear, too.
    #[inline]
    fn is_off(&self, hull: &Hull) -> bool {
        let to = hull.center - self.middle;
        let gap = to.abs() - hull.half_size - self.half_size;
        let across = to.dot(self.normal).abs() - hull.half_size.dot(self.normal.abs());
        (gap.x > 0.0) | (gap.y > 0.0) | (across > self.breadth)
    }
}

impl ClearanceIndex {
    /// Indexes the solid parts of a world for queries within `reach` metres, from 0 to 1e9.
    ///
    /// # Errors
    /// When `reach` is out of this range.
    pub fn new(world: &World, reach: f64) -> Result<Self, SpecError> {
        Self::with_density(world, reach, CELLS_A_SHAPE, MAX_LISTINGS)
    }

    /// Indexes the solid parts that lie at least partly within an extent, such as that of a robot's body. Parts
    /// that lie wholly above or below it are left out. If all parts are within the extent, the result equals that
    /// of [`ClearanceIndex::new`].
    ///
    /// ```
    /// use envgen::world::Extent;
    /// use envgen::{Blueprint, Seed, Spec, clearance_index::ClearanceIndex, road::RoadSpec};
    ///
    /// let spec = RoadSpec { kerb_height: 0.15, ..Default::default() };
    /// let world = spec.generate(Seed(7))?.to_world();
    /// let start = world.start.expect("roads have a start").position;
    /// // A robot whose body begins at 0.2 m passes over the kerbs.
    /// let high = ClearanceIndex::within(&world, 5.0, Extent::new(0.2, 0.6)?)?;
    /// assert_eq!(high.clearance(start), f64::INFINITY);
    /// assert!(ClearanceIndex::new(&world, 5.0)?.clearance(start) < 5.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When `reach` is out of its range.
    pub fn within(world: &World, reach: f64, extent: Extent) -> Result<Self, SpecError> {
        Self::of(world.solids_within(extent), reach, CELLS_A_SHAPE, MAX_LISTINGS)
    }

    /// Like [`ClearanceIndex::new`], but with about `density` cells per shape; a shape is listed in at most
    /// `listings` cells on average. Finer cells take longer to fill and make queries faster.
    pub(crate) fn with_density(
        world: &World,
        reach: f64,
        density: f64,
        listings: usize,
    ) -> Result<Self, SpecError> {
        Self::of(world.solids(), reach, density, listings)
    }

    fn of<'a>(
        parts: impl Iterator<Item = Solid<'a>>,
        reach: f64,
        density: f64,
        listings: usize,
    ) -> Result<Self, SpecError> {
        if !(0.0..=MAX_REACH).contains(&reach) {
            let allowed = format!("a number from 0 to {MAX_REACH}");
            return Err(SpecError::new("reach", reach, allowed));
        }
        let mut shapes = Vec::new();
        for solid in parts {
            match &*solid.shape {
                // Each side is listed on its own, the polygon for its inside.
                Shape::Polygon { vertices } if vertices.len() > 8 => {
                    let sides = edges(vertices).map(|(a, b)| (solid.id, Shape::Segment { a, b }));
                    shapes.extend(sides);
                    shapes.push((solid.id, solid.shape.clone().into_owned()));
                }
                shape => shapes.push((solid.id, shape.clone())),
            }
        }
        let around = shapes.iter().map(|(_, shape)| shape.bounds()).reduce(Rect::union);
        let (area, cells) = (index_area(around, reach), shapes.len() as f64 * density);
        let index = GridIndex::new(area, cells, shapes.len(), Some(listings), |i, frame, visit| {
            touched_runs(&shapes[i].1, reach, frame, visit);
        });
        let hulls = shapes.iter().map(|(_, shape)| Hull::of(shape)).collect();
        Ok(ClearanceIndex { reach, index, shapes, hulls })
    }

    /// Returns the reach of the index, in metres.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Calls `visit` for every part within `radius` metres of a point. A radius greater than
    /// [`ClearanceIndex::reach`] counts as the reach. A part with a long outline may be visited several times.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, clearance_index::ClearanceIndex, hallway::HallwaySpec};
    ///
    /// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
    /// let near = ClearanceIndex::new(&world, 2.0)?;
    /// let start = world.start.expect("hallways have a start").position;
    /// let mut distances = Vec::new();
    /// near.contacts(start, 1.2, |contact| distances.push(contact.distance));
    /// assert!(!distances.is_empty() && distances.iter().all(|&distance| distance <= 1.2));
    /// # Ok::<(), envgen::GenerateError>(())
    /// ```
    pub fn contacts(&self, p: DVec2, radius: f64, mut visit: impl FnMut(Contact)) {
        let radius = radius.min(self.reach);
        let beyond = radius + ROUNDING;
        for &i in self.index.at(p) {
            if self.hulls[i as usize].distance_squared(p) > beyond * beyond {
                continue;
            }
            let point = self.nearest_point(i, p);
            let distance = p.distance(point);
            if distance <= radius {
                visit(Contact { part: self.shapes[i as usize].0, point, distance });
            }
        }
    }

    /// Returns the nearest part within [`ClearanceIndex::reach`]; `None` if no part is that near. Among parts at
    /// the same distance, the choice is always the same.
    ///
    /// ```
    /// use envgen::world::PartKind;
    /// use envgen::{Blueprint, Seed, Spec, clearance_index::ClearanceIndex, hallway::HallwaySpec};
    ///
    /// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
    /// let near = ClearanceIndex::new(&world, 1.5)?;
    /// let start = world.start.expect("hallways have a start").position;
    /// let contact = near.nearest(start).expect("a wall within 1.5 m");
    /// assert_eq!(contact.part.kind, PartKind::Wall);
    /// assert!((contact.point.distance(start) - contact.distance).abs() < 1e-12);
    /// # Ok::<(), envgen::GenerateError>(())
    /// ```
    pub fn nearest(&self, p: DVec2) -> Option<Contact> {
        let nearest = self.room(p).nearest?;
        let point = self.nearest_point(nearest, p);
        Some(Contact { part: self.shapes[nearest as usize].0, point, distance: p.distance(point) })
    }

    /// Returns the nearest point of the shape with a number.
    #[inline]
    fn nearest_point(&self, shape: u32, p: DVec2) -> DVec2 {
        let hull = &self.hulls[shape as usize];
        match hull.is_shape {
            true => hull.nearest_point(p),
            false => self.shapes[shape as usize].1.nearest_point(p),
        }
    }

    /// Returns the distance in metres from a point to the nearest solid part; infinite if no part is within
    /// [`ClearanceIndex::reach`].
    pub fn clearance(&self, p: DVec2) -> f64 {
        self.room(p).clearance
    }

    /// Whether every solid part is at least `distance` metres, which must be less than the reach, from the line
    /// from `a` to `b`. The answer is exact and takes the time of one query per metre.
    pub(crate) fn is_clear_along(&self, a: DVec2, b: DVec2, distance: f64) -> bool {
        // A cell lists what is within reach of a point in it, and so of the line as far as that from the point.
        split_segment(a, b, (self.reach - distance).min(MAX_PIECE)).all(|(from, to)| {
            let line = Surrounded::new(from, to, distance);
            self.index.at(line.middle).iter().all(|&i| {
                line.is_off(&self.hulls[i as usize])
                    || self.shapes[i as usize].1.distance_from_segment(from, to) >= distance
            })
        })
    }

    /// Returns the clearance, the nearest shape, and what the query cost.
    pub(crate) fn room(&self, p: DVec2) -> Room {
        let (mut least, mut nearest, mut cost) = (f64::INFINITY, 0, 0);
        for &i in self.index.at(p) {
            let hull = &self.hulls[i as usize];
            cost += hull.cost as usize;
            let mut squared = hull.distance_squared(p);
            if !hull.is_shape {
                let beyond = least.sqrt() + ROUNDING;
                if squared > beyond * beyond {
                    continue;
                }
                squared = p.distance_squared(self.shapes[i as usize].1.nearest_point(p));
            }
            if squared < least {
                (least, nearest) = (squared, i);
            }
        }
        let clearance = least.sqrt();
        if clearance <= self.reach {
            Room { clearance, nearest: Some(nearest), cost }
        } else {
            Room { clearance: f64::INFINITY, nearest: None, cost }
        }
    }

    /// Returns the distance in metres from a point to the shape with a number, and what the query cost.
    /// [`ClearanceIndex::room`] returns the least of these distances.
    pub(crate) fn distance(&self, p: DVec2, shape: u32) -> (f64, usize) {
        let hull = &self.hulls[shape as usize];
        (p.distance_squared(self.nearest_point(shape, p)).sqrt(), hull.cost as usize)
    }
}

/// Visits the cells that lie within `reach` of a shape, and perhaps a few more.
fn touched_runs(
    shape: &Shape,
    reach: f64,
    frame: &GridFrame,
    visit: &mut dyn FnMut(usize, usize, usize),
) {
    // Rounding must not keep a shape out of a cell that it just reaches.
    let reach = reach + 1e-9 * (1.0 + frame.cell_size);
    let grown = match shape {
        Shape::Disc { center, radius } => {
            return frame.touched_runs(&Convex::Disc(*center, radius + reach), visit);
        }
        Shape::Segment { a, b } => Shape::thick_segment(*a, *b, 2.0 * reach, reach),
        Shape::Box { center, half_size, heading } => {
            Shape::Box { center: *center, half_size: half_size + reach, heading: *heading }
        }
        polygon => Shape::from_rect(polygon.bounds().grown(reach)),
    };
    frame.touched_runs(&Convex::Polygon(&grown.corners()), visit);
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::world::{Obstacle, ObstacleKind, Tree};
    use crate::{Provenance, Seed, WorldKind};

    fn world(shapes: Vec<Shape>) -> World {
        let mut world = World::new(
            Provenance::other("test", serde_json::Value::Null),
            Rect::new(DVec2::ZERO, DVec2::ONE),
        );
        world.obstacles =
            shapes.into_iter().map(|shape| Obstacle::new(ObstacleKind::Other, shape)).collect();
        world
    }

    fn any_shape() -> impl Strategy<Value = Shape> {
        let point = || (-20.0..20.0, -20.0..20.0).prop_map(|(x, y)| DVec2::new(x, y));
        // Boxes along the axes are handled apart.
        let heading = prop_oneof![Just(0.0), -4.0..4.0];
        prop_oneof![
            (point(), point()).prop_map(|(a, b)| Shape::Segment { a, b }),
            (point(), 0.01..5.0).prop_map(|(center, radius)| Shape::Disc { center, radius }),
            (point(), (0.01..5.0, 0.01..5.0), heading).prop_map(|(center, half, heading)| {
                Shape::Box { center, half_size: DVec2::new(half.0, half.1), heading }
            }),
            (point(), 0.5..4.0, 3..20_usize).prop_map(|(center, radius, n)| {
                let corner = |i: usize| {
                    let turn =
                        crate::geometry::unit_vector(std::f64::consts::TAU * i as f64 / n as f64);
                    center + turn * radius * if i.is_multiple_of(2) { 1.0 } else { 0.4 }
                };
                Shape::Polygon { vertices: (0..n).map(corner).collect() }
            }),
        ]
    }

    proptest! {
        #[test]
        fn clearance_is_the_slow_one_within_reach(
            shapes in proptest::collection::vec(any_shape(), 0..30),
            points in proptest::collection::vec((-30.0..30.0, -30.0..30.0), 1..20),
            reach in 0.0..6.0,
        ) {
            let world = world(shapes);
            let near = ClearanceIndex::new(&world, reach).expect("a reach");
            for (x, y) in points {
                let p = DVec2::new(x, y);
                let slow = world.clearance(p);
                let fast = near.clearance(p);
                if slow < reach - 1e-9 {
                    prop_assert!((slow - fast).abs() < 1e-9, "{slow} {fast}");
                } else {
                    prop_assert!(fast >= reach - 1e-9, "{slow} {fast}");
                }
            }
        }

        #[test]
        fn the_nearest_part_is_the_nearest_contact(
            shapes in proptest::collection::vec(any_shape(), 0..30),
            x in -25.0..25.0, y in -25.0..25.0,
        ) {
            let (index, p) = (ClearanceIndex::new(&world(shapes), 6.0).unwrap(), DVec2::new(x, y));
            let mut contacts = Vec::new();
            index.contacts(p, 6.0, |contact| contacts.push(contact));
            let least = contacts.iter().map(|one| one.distance).fold(f64::INFINITY, f64::min);
            match index.nearest(p) {
                Some(found) => {
                    prop_assert!((found.distance - least).abs() < 1e-9, "{found:?} {least}");
                    prop_assert!(contacts.contains(&found));
                }
                None => prop_assert!(least > 6.0 - 1e-9, "{least}"),
            }
        }

        #[test]
        fn a_line_is_clear_where_all_its_points_are(
            shapes in prop::collection::vec(any_shape(), 0..12),
            ax in -30.0..30.0, ay in -30.0..30.0, bx in -30.0..30.0, by in -30.0..30.0,
            distance in 0.0..1.95,
        ) {
            let index = ClearanceIndex::new(&world(shapes), 2.0).unwrap();
            let (a, b) = (DVec2::new(ax, ay), DVec2::new(bx, by));
            let points = (0..=2000).map(|i| index.clearance(a.lerp(b, f64::from(i) / 2000.0)));
            let least = points.fold(f64::INFINITY, f64::min);
            let slack = a.distance(b) / 4000.0 + 1e-9;
            if index.is_clear_along(a, b, distance) {
                prop_assert!(least >= distance - 1e-9, "{least}");
            } else {
                prop_assert!(least <= distance + slack, "{least}");
            }
        }

        #[test]
        fn the_nearest_point_is_on_the_shape(shape in any_shape(), x in -30.0..30.0, y in -30.0..30.0) {
            let p = DVec2::new(x, y);
            let nearest = shape.nearest_point(p);
            prop_assert!((shape.distance(p) - p.distance(nearest)).abs() < 1e-9);
            prop_assert!(shape.distance(nearest) < 1e-9);
        }
    }

    #[test]
    fn every_kind_of_world_is_indexed_exactly() {
        for &kind in WorldKind::ALL {
            let world = kind.default_spec().generate(Seed(3)).expect("defaults").to_world();
            let near = ClearanceIndex::new(&world, 1.0).expect("a reach");
            let mut draws = Seed(1).stream("test", 0);
            for _ in 0..200 {
                let size = world.bounds.size();
                let p = world.bounds.min + DVec2::new(draws.unit(), draws.unit()) * size;
                let slow = world.clearance(p);
                let fast = near.clearance(p);
                let same = if slow <= 1.0 { (slow - fast).abs() < 1e-9 } else { fast > 1.0 };
                assert!(same, "{kind} at {p}: {slow} {fast}");
            }
        }
    }

    #[test]
    fn nothing_and_nonsense_are_far() {
        let near = ClearanceIndex::new(&world(Vec::new()), 0.0).expect("a reach");
        assert_eq!(near.nearest(DVec2::ZERO), None);
        assert_eq!(near.nearest(DVec2::NAN), None);
        assert_eq!(near.clearance(DVec2::splat(1e300)), f64::INFINITY);
    }

    #[test]
    fn a_reach_is_a_distance() {
        let world = world(vec![Shape::Disc { center: DVec2::ONE, radius: 0.5 }]);
        for reach in [f64::NAN, -1.0, -1e-3, f64::INFINITY, 2e9] {
            let error = ClearanceIndex::new(&world, reach)
                .expect_err("the reach is not allowed")
                .to_string();
            let named =
                error.starts_with("`reach` must be") && error.ends_with(&format!("got {reach}"));
            assert!(named && error.contains("from 0 to 1000000000"), "{error}");
        }
        let far = ClearanceIndex::new(&world, 1e9).expect("a reach");
        assert_eq!(far.clearance(DVec2::new(1.0, 1e6)), 1e6 - 1.5);
    }

    #[test]
    fn a_contact_names_its_part() {
        let mut world = world(Vec::new());
        world.trees =
            vec![Tree::new(DVec2::new(3.0, 0.0), 1.0), Tree::new(DVec2::new(-4.0, 0.0), 1.0)];
        let near = ClearanceIndex::new(&world, 5.0).expect("a reach");
        let contact = near.nearest(DVec2::ZERO).expect("a tree");
        assert_eq!((contact.part.index, contact.point, contact.distance), (0, DVec2::X * 2.0, 2.0));
    }
}
