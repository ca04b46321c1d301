//! Ray casting: exact ranges to a [`World`]'s solid parts.

mod scan_pattern;

use glam::DVec2;

pub use scan_pattern::ScanPattern;

use crate::geometry::{Pose, Rect, Shape, edges, polygon_contains, unit_vector};
use crate::grid::{CellBuckets, Convex, GridFrame, MAX_CELLS, finest_frame, index_area};
use crate::world::{PartId, Solid, World};

/// Target number of cells of the index per shape, where parts are spread evenly.
const CELLS_A_SHAPE: f64 = 2.0;

/// The most cells in which a shape is listed, on average over all shapes. Worlds with overlapping parts get a
/// coarser index, so that its memory is bounded.
const MAX_LISTINGS: usize = 24;

/// The first part that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in metres; 0 for a ray that starts inside a part.
    pub distance: f64,
    /// The part.
    pub part: PartId,
}

/// The first surface that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// The part and its distance.
    pub hit: Hit,
    /// The surface's unit normal where the ray meets it, on the side from which the ray comes. If the ray starts
    /// inside the part, the normal is opposite to the ray's direction.
    pub normal: DVec2,
}

/// An index of a world's solid parts for casting rays.
///
/// The index is a coarse uniform grid. A ray visits the cells that it crosses in order, and each cell lists the
/// shapes that touch it. Rays are intersected with the shapes themselves, so ranges are exact. The index holds a
/// copy of the parts: build a new one when the world changes.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec, raycast::Raycaster};
///
/// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
/// let rays = Raycaster::new(&world);
/// let start = world.start.expect("hallways have a start");
/// // The first segment goes up: the corridor's walls are 1 m to the left and right.
/// let hit = rays.cast(start.position, std::f64::consts::PI, 8.0).expect("a wall");
/// assert!((hit.distance - 1.0).abs() < 1e-12);
/// # Ok::<(), envgen::GenerateError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Raycaster {
    frame: GridFrame,
    per_cell: f64,
    shapes: CellBuckets<Listing>,
    /// The filled polygons around each cell. Rays are intersected with their sides; the fillings are used only to
    /// find whether a ray starts inside one.
    fillings: CellBuckets<u32>,
    polygons: Vec<(PartId, Vec<DVec2>)>,
    /// The parts with a limited visible range, with that range in metres, in the parts' order.
    dark: Vec<(PartId, f64)>,
}

/// A shape as a cell lists it, with all data that a ray needs.
#[derive(Clone, Copy, Debug)]
struct Listing {
    outline: Outline,
    part: PartId,
}

#[derive(Clone, Copy, Debug)]
enum Outline {
    /// Start, and the vector to the end.
    Side(DVec2, DVec2),
    /// Middle and squared radius, filled.
    Disc(DVec2, f64),
    /// Corners of an axis-aligned box, filled.
    Aligned(DVec2, DVec2),
}

impl Raycaster {
    /// Indexes the solid parts of a world.
    pub fn new(world: &World) -> Self {
        Raycaster::of(world, world.solids())
    }

    /// Indexes the solid parts that a horizontal plane, such as that of a laser, meets at a height in metres above
    /// the floor. If it meets all parts, this equals [`Raycaster::new`].
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, raycast::Raycaster, road::RoadSpec};
    ///
    /// let spec = RoadSpec { kerb_height: 0.15, ..Default::default() };
    /// let world = spec.generate(Seed(7))?.to_world();
    /// let start = world.start.expect("roads have a start").position;
    /// let left = std::f64::consts::FRAC_PI_2;
    /// assert!(Raycaster::at_height(&world, 0.1).cast(start, left, 8.0).is_some());
    /// assert!(Raycaster::at_height(&world, 0.45).cast(start, left, 8.0).is_none());
    /// # Ok::<(), envgen::road::RoadError>(())
    /// ```
    pub fn at_height(world: &World, height: f64) -> Self {
        Raycaster::of(world, world.solids_at(height))
    }

    /// Indexes the dark parts that a laser at a height in metres meets; `None` if a world has no dark parts.
    pub fn of_dark(world: &World, height: f64) -> Option<Self> {
        let dark = dark_parts(world);
        let is_dark = |part: PartId| dark.binary_search_by_key(&part, |&(dark, _)| dark).is_ok();
        let parts = || world.solids_at(height).filter(|solid| is_dark(solid.id));
        (!dark.is_empty()).then(|| Raycaster::of(world, parts()))
    }

    fn of<'a>(world: &World, parts: impl Iterator<Item = Solid<'a>>) -> Self {
        let mut shapes = Vec::new();
        let mut polygons = Vec::new();
        let mut around: Option<Rect> = None;
        for solid in parts {
            let bounds = solid.shape.bounds();
            around = Some(around.map_or(bounds, |rect| rect.union(bounds)));
            let part = solid.id;
            let listing = |outline| Listing { outline, part };
            match &*solid.shape {
                Shape::Segment { a, b } => shapes.push(listing(Outline::Side(*a, *b - *a))),
                Shape::Disc { center, radius } => {
                    shapes.push(listing(Outline::Disc(*center, radius * radius)));
                }
                Shape::Box { center, half_size, heading: 0.0 } => {
                    shapes.push(listing(Outline::Aligned(center - half_size, center + half_size)));
                }
                turned => {
                    let corners = turned.corners();
                    shapes.extend(edges(&corners).map(|(a, b)| listing(Outline::Side(a, b - a))));
                    polygons.push((part, corners));
                }
            }
        }
        let numbers: Vec<u32> = (0..polygons.len() as u32).collect();
        let cells = (shapes.len() as f64 * CELLS_A_SHAPE).min(MAX_CELLS);
        let most = Some(MAX_LISTINGS * shapes.len());
        let area = index_area(around, 0.0);
        let (frame, (shapes, fillings)) = finest_frame(area, cells, most, |frame, most| {
            let listed = CellBuckets::build(frame, &shapes, most, Listing::touched_runs)?;
            let filled = CellBuckets::build(frame, &numbers, most, |&i, frame, visit| {
                filled_runs(&polygons[i as usize].1, frame, visit);
            })?;
            Some((listed, filled))
        });
        let (per_cell, dark) = (1.0 / frame.cell_size, dark_parts(world));
        Raycaster { frame, per_cell, shapes, fillings, polygons, dark }
    }

    /// Returns the distance in metres beyond which lasers get no echo from a part; infinite where it is not dark.
    pub fn visible_range(&self, part: PartId) -> f64 {
        let found = self.dark.binary_search_by_key(&part, |&(dark, _)| dark);
        found.map_or(f64::INFINITY, |i| self.dark[i].1)
    }

    /// Returns whether lasers get no echo from what a ray met, because it is too dark to be seen from that distance.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec, raycast::Raycaster};
    ///
    /// // Walls so dark that lasers see them from half a metre.
    /// let mut world = HallwaySpec::default().generate(Seed(7))?.to_world();
    /// world.walls.iter_mut().for_each(|wall| wall.visible_range = Some(0.5));
    /// let rays = Raycaster::new(&world);
    /// let start = world.start.expect("hallways have a start").position;
    /// let hit = rays.cast(start, std::f64::consts::PI, 8.0).expect("a wall 1 m away");
    /// assert!(rays.is_unseen(hit) && rays.visible_range(hit.part) == 0.5);
    /// # Ok::<(), envgen::GenerateError>(())
    /// ```
    pub fn is_unseen(&self, hit: Hit) -> bool {
        !self.dark.is_empty() && hit.distance > self.visible_range(hit.part)
    }

    /// Returns the first part that a ray meets within `max_range` metres, or `None`; also `None` for a negative
    /// range, a position or heading that is not finite, or NaN. `heading` is in radians.
    pub fn cast(&self, from: DVec2, heading: f64, max_range: f64) -> Option<Hit> {
        self.cast_along(from, unit_vector(heading), max_range)
    }

    /// Like [`Raycaster::cast`], but in the direction of a unit vector.
    pub fn cast_along(&self, from: DVec2, direction: DVec2, max_range: f64) -> Option<Hit> {
        self.first_met(from, direction, max_range).map(|(hit, _)| hit)
    }

    /// Like [`Raycaster::cast_along`], but returns also the normal of the surface that the ray meets.
    ///
    /// ```
    /// use envgen::glam::DVec2;
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec, raycast::Raycaster};
    ///
    /// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
    /// let start = world.start.expect("hallways have a start").position;
    /// // The normal of the wall on the left points back to the robot.
    /// let surface = Raycaster::new(&world).cast_surface(start, DVec2::NEG_X, 8.0).expect("a wall");
    /// assert_eq!(surface.normal, DVec2::X);
    /// # Ok::<(), envgen::GenerateError>(())
    /// ```
    pub fn cast_surface(
        &self,
        from: DVec2,
        direction: DVec2,
        max_range: f64,
    ) -> Option<SurfaceHit> {
        if !direction.is_finite() {
            return None;
        }
        self.eye(from).cast_surface(direction, max_range)
    }

    /// Prepares casting many rays from one point, whose directions must be finite.
    pub(crate) fn eye(&self, from: DVec2) -> Eye<'_> {
        let GridFrame { origin, cols, rows, .. } = self.frame;
        let is_inside = from.cmpgt(origin).all() && from.cmplt(self.frame.corner(cols, rows)).all();
        let inside = is_inside.then(|| {
            let (col, row) = self.cell_around(from);
            ((col, row), self.filling(col + row * cols, from))
        });
        Eye { rays: self, from, inside }
    }

    /// Returns the first surface that a ray meets, from the part and outline that it meets.
    #[inline]
    fn surface(
        from: DVec2,
        direction: DVec2,
        (hit, outline): (Hit, Option<&Outline>),
    ) -> SurfaceHit {
        let at = from + direction * hit.distance;
        let normal = outline
            .filter(|_| hit.distance > 0.0)
            .and_then(|outline| outline.normal(at))
            .unwrap_or(-direction);
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        SurfaceHit { hit, normal }
    }

    /// Returns the column and row of the cell that contains a point of the grid.
    #[inline]
    fn cell_around(&self, p: DVec2) -> (usize, usize) {
        let cell = (p - self.frame.origin) * self.per_cell;
        ((cell.x as usize).min(self.frame.cols - 1), (cell.y as usize).min(self.frame.rows - 1))
    }

    /// Returns the first part that a ray meets, with its outline unless the ray starts in a filled polygon.
    #[inline]
    fn first_met(
        &self,
        from: DVec2,
        direction: DVec2,
        max_range: f64,
    ) -> Option<(Hit, Option<&Outline>)> {
        let inverse = direction.recip();
        let GridFrame { origin, cols, rows, .. } = self.frame;

        // Where the ray enters the grid, and the cell there.
        let (enter, leave) = slab::<true>(from, inverse, origin, self.frame.corner(cols, rows));
        let enter = enter.max(0.0);
        // The sum is finite if both are.
        let is_finite = (from + direction).is_finite();
        if !(is_finite && enter <= leave && enter <= max_range) {
            return None;
        }
        let (col, row) = self.cell_around(from + direction * enter);
        if enter == 0.0
            && let Some(part) = self.filling(col + row * cols, from)
        {
            return Some((Hit { distance: 0.0, part }, None));
        }
        self.first_met_from(from, (col, row), direction, max_range)
    }

    /// Like [`Raycaster::first_met`], but from the cell in which a ray enters the grid, or begins.
    #[inline]
    fn first_met_from(
        &self,
        from: DVec2,
        cell: (usize, usize),
        direction: DVec2,
        max_range: f64,
    ) -> Option<(Hit, Option<&Outline>)> {
        let inverse = direction.recip();
        if inverse.is_finite() {
            self.traverse::<false>(from, cell, (direction, inverse), max_range)
        } else {
            self.traverse::<true>(from, cell, (direction, inverse), max_range)
        }
    }

    /// Follows a ray from cell to cell. `AXIAL`: it is along an axis, and distances to lines along it infinite or NaN.
    #[inline]
    fn traverse<const AXIAL: bool>(
        &self,
        from: DVec2,
        (mut col, mut row): (usize, usize),
        (direction, inverse): (DVec2, DVec2),
        max_range: f64,
    ) -> Option<(Hit, Option<&Outline>)> {
        let GridFrame { origin, cell_size: side, cols, rows } = self.frame;

        // Amanatides and Woo, A Fast Voxel Traversal Algorithm for Ray Tracing, 1987.
        let forward = inverse.cmpge(DVec2::ZERO); // of -0 it is negative
        let ahead = |cell: usize, forward: bool| (cell + usize::from(forward)) as f64 * side;
        let border = |row: usize, col: usize| {
            let line = DVec2::new(ahead(col, forward.x), ahead(row, forward.y)) + origin;
            (line - from) * inverse
        };
        let step = (inverse * side).abs();
        let mut next = border(row, col);
        let mut best = max_range;
        let mut met: Option<&Listing> = None;
        loop {
            for listing in self.shapes.of(row * cols + col) {
                if let Some(distance) = listing.outline.distance::<AXIAL>(from, direction, inverse)
                    && distance <= best
                {
                    // Of two parts at the same distance the first in the world's order is met.
                    if distance < best || met.is_none_or(|other| listing.part < other.part) {
                        best = distance;
                        met = Some(listing);
                    }
                }
            }
            // An axial ray has an infinite or undefined border on the other axis.
            let across_x = next.x < next.y || (AXIAL && next.y.is_nan());
            let crossing = if across_x { next.x } else { next.y };
            let inside = crossing < best
                && if across_x {
                    next.x += step.x;
                    shift(&mut col, forward.x, cols)
                } else {
                    next.y += step.y;
                    shift(&mut row, forward.y, rows)
                };
            if !inside {
                let hit = |part| Hit { distance: best, part };
                return met.map(|listing| (hit(listing.part), Some(&listing.outline)));
            }
        }
    }

    /// Writes the ranges of all rays of `fan` from a pose into `ranges`, in metres, with `max_range` where a ray
    /// meets nothing, and for all rays of a pose that is not finite. Ranges are purely geometric: dark parts are met
    /// at any distance.
    pub fn scan(&self, pose: Pose, fan: &ScanPattern, max_range: f64, ranges: &mut Vec<f64>) {
        ranges.clear();
        let hits = self.hits(pose, fan, max_range);
        ranges.extend(hits.map(|hit| hit.map_or(max_range, |hit| hit.distance)));
    }

    /// Returns the first part that each ray of `fan` from a pose meets within `max_range` metres; `None` for all rays
    /// of a pose that is not finite.
    ///
    /// ```
    /// use envgen::raycast::{Raycaster, ScanPattern};
    /// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec};
    ///
    /// let world = ForestSpec::default().generate(Seed(7))?.to_world();
    /// let (rays, all_around) = (Raycaster::new(&world), ScanPattern::new(6.28, 360)?);
    /// let start = world.start.expect("a forest with a free place");
    /// for hit in rays.hits(start, &all_around, 20.0).flatten() {
    ///     let tree = &world.trees[hit.part.index as usize];
    ///     let distance = tree.center.distance(start.position);
    ///     assert!(hit.distance >= distance - tree.radius - 1e-9 && hit.distance < distance);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn hits(
        &self,
        pose: Pose,
        fan: &ScanPattern,
        max_range: f64,
    ) -> impl Iterator<Item = Option<Hit>> {
        // Where nothing is met, so that no ray has to be checked by itself.
        let from = if pose.heading.is_finite() { pose.position } else { DVec2::NAN };
        let (heading, eye) = (unit_vector(pose.heading), self.eye(from));
        fan.directions()
            .iter()
            .map(move |&direction| eye.cast_along(heading.rotate(direction), max_range))
    }

    /// Returns the filled polygon that contains a point.
    fn filling(&self, cell: usize, p: DVec2) -> Option<PartId> {
        let polygons = self.fillings.of(cell).iter().map(|&i| &self.polygons[i as usize]);
        let inside = |(_, vertices): &&(PartId, Vec<DVec2>)| polygon_contains(vertices, p);
        polygons.filter(inside).map(|(part, _)| *part).min()
    }
}

/// A point from which many rays are cast. What is the same for all of them is looked up once.
pub(crate) struct Eye<'a> {
    rays: &'a Raycaster,
    from: DVec2,
    /// The cell that contains the point, and the polygon that does; `None` outside the grid and on its border.
    inside: Option<((usize, usize), Option<PartId>)>,
}

impl<'a> Eye<'a> {
    /// As [`Raycaster::cast_surface`].
    #[inline]
    pub(crate) fn cast_surface(&self, direction: DVec2, max_range: f64) -> Option<SurfaceHit> {
        let met = self.first_met(direction, max_range);
        met.map(|met| Raycaster::surface(self.from, direction, met))
    }

    /// As [`Raycaster::cast_along`].
    #[inline]
    fn cast_along(&self, direction: DVec2, max_range: f64) -> Option<Hit> {
        self.first_met(direction, max_range).map(|(hit, _)| hit)
    }

    #[inline]
    fn first_met(&self, direction: DVec2, max_range: f64) -> Option<(Hit, Option<&'a Outline>)> {
        match self.inside {
            None => self.rays.first_met(self.from, direction, max_range),
            Some(_) if max_range.is_nan() || max_range < 0.0 => None,
            Some((_, Some(part))) => Some((Hit { distance: 0.0, part }, None)),
            Some((cell, None)) => self.rays.first_met_from(self.from, cell, direction, max_range),
        }
    }
}

/// Returns the parts with a limited visible range, with that range, in order.
fn dark_parts(world: &World) -> Vec<(PartId, f64)> {
    world.solids().filter_map(|solid| Some((solid.id, world.visible_range(solid.id)?))).collect()
}

/// Steps to the next cell along an axis; returns false at the grid's end.
fn shift(cell: &mut usize, forward: bool, len: usize) -> bool {
    let next = if forward { *cell + 1 } else { cell.wrapping_sub(1) };
    *cell = next;
    next < len
}

/// Visits the cells around a filled polygon's bounding box. A superfluous cell costs time only where a ray starts
/// in it.
fn filled_runs(vertices: &[DVec2], frame: &GridFrame, visit: &mut dyn FnMut(usize, usize, usize)) {
    let Some(bounds) = Rect::around(vertices.iter().copied()) else { return };
    let corners = Shape::from_rect(bounds).corners();
    frame.touched_runs(&Convex::Polygon(&corners), visit);
}

impl Listing {
    fn touched_runs(&self, frame: &GridFrame, visit: &mut dyn FnMut(usize, usize, usize)) {
        match self.outline {
            Outline::Side(a, edge) => frame.touched_runs(&Convex::Polygon(&[a, a + edge]), visit),
            Outline::Disc(center, radius2) => {
                frame.touched_runs(&Convex::Disc(center, radius2.sqrt()), visit);
            }
            Outline::Aligned(min, max) => {
                let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
                frame.touched_runs(&Convex::Polygon(&corners), visit);
            }
        }
    }
}

impl Outline {
    /// Returns a unit normal at a point of the outline, on either side; `None` for an outline without length.
    fn normal(&self, at: DVec2) -> Option<DVec2> {
        match *self {
            Outline::Side(_, edge) => edge.perp().try_normalize(),
            Outline::Disc(center, _) => (at - center).try_normalize(),
            Outline::Aligned(min, max) => {
                let x = (at.x - min.x).abs().min((at.x - max.x).abs());
                let y = (at.y - min.y).abs().min((at.y - max.y).abs());
                Some(if x <= y { DVec2::X } else { DVec2::Y })
            }
        }
    }

    /// Returns the distance along a ray to the outline, 0 inside it; `None` if the ray misses it.
    #[inline]
    fn distance<const AXIAL: bool>(
        &self,
        from: DVec2,
        direction: DVec2,
        inverse: DVec2,
    ) -> Option<f64> {
        match *self {
            Outline::Side(a, edge) => {
                let to = a - from;
                let across = direction.perp_dot(edge);
                let off = to.perp_dot(direction);
                if across == 0.0 {
                    // Along the side: the nearer end, when the ray runs on its line.
                    let (s, e) = (to.dot(direction), (to + edge).dot(direction));
                    return (off == 0.0 && s.max(e) >= 0.0).then(|| s.min(e).max(0.0));
                }
                let distance = to.perp_dot(edge) / across;
                let along = off / across;
                (distance >= 0.0 && (0.0..=1.0).contains(&along)).then_some(distance)
            }
            Outline::Disc(center, radius2) => {
                let to = center - from;
                let middle = to.dot(direction);
                let off = to.perp_dot(direction);
                let half2 = radius2 - off * off;
                if half2 < 0.0 {
                    return None;
                }
                let half = half2.sqrt();
                (middle + half >= 0.0).then(|| (middle - half).max(0.0))
            }
            Outline::Aligned(min, max) => {
                let (enter, leave) = slab::<AXIAL>(from, inverse, min, max);
                (enter <= leave && leave >= 0.0).then(|| enter.max(0.0))
            }
        }
    }
}

/// Returns where a ray's line enters and leaves an axis-aligned box, sides included. An `AXIAL` ray along the line
/// of a side gives NaN, which counts as between the sides all along. Without NaN, an instruction each is enough.
#[inline]
fn slab<const AXIAL: bool>(from: DVec2, inverse: DVec2, min: DVec2, max: DVec2) -> (f64, f64) {
    let (a, b) = ((min - from) * inverse, (max - from) * inverse);
    if AXIAL {
        let along = a.is_nan_mask() | b.is_nan_mask();
        let enter = DVec2::select(along, DVec2::NEG_INFINITY, a.min(b));
        let leave = DVec2::select(along, DVec2::INFINITY, a.max(b));
        return (enter.max_element(), leave.min_element());
    }
    let lesser = |a: f64, b: f64| if a < b { a } else { b };
    let greater = |a: f64, b: f64| if a > b { a } else { b };
    let enter = greater(lesser(a.x, b.x), lesser(a.y, b.y));
    (enter, lesser(greater(a.x, b.x), greater(a.y, b.y)))
}
