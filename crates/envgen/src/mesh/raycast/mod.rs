//! Ray casting in three dimensions.

mod solid;

use std::collections::VecDeque;

use glam::DVec3;

use self::solid::Solid;
use crate::geometry::Rect;
use crate::grid::{Convex, GridFrame, GridIndex, index_area};
use crate::pieces::Form;

/// Target number of cells of the index per solid.
const CELLS_A_SOLID: f64 = 2.0;

/// The most cells in which a solid is listed, on average over all solids.
const LISTINGS_A_SOLID: usize = 24;

/// The number of solids that a ray remembers, so that it does not meet solids that are listed in many cells again
/// and again.
const REMEMBERED: usize = 16;

/// The first body that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyHit {
    /// Distance in lengths of the ray's direction: in metres if that is a unit vector.
    pub distance: f64,
    /// The body's index in the list that was indexed.
    pub body: usize,
}

/// An index of bodies for casting rays in three dimensions, such as the [`pieces`](crate::pieces::pieces) of a
/// world.
///
/// Bodies have the same form as in [`Mesh::of`](super::Mesh::of), so that distances agree with pictures of the
/// meshes up to the rounding of these: discs are the polygons of [`outline`](crate::outline::outline), crowns of
/// trees have flat sides, and roads have straight edges between their stations. No triangles are used: rays are
/// intersected with outlines, heights and planes. Like a camera, a ray meets only surfaces that face it; it does
/// not meet a body in which it starts.
///
/// ```
/// use envgen::glam::DVec3;
/// use envgen::mesh::BodyRaycaster;
/// use envgen::pieces::{Role, pieces};
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
///
/// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
/// let pieces = pieces(&world);
/// let rays = BodyRaycaster::new(pieces.iter().map(|piece| &piece.form));
/// let eye = world.start.expect("hallways have a start").position.extend(0.4);
/// // The corridor's walls are 1 m to the left and right of its start.
/// let hit = rays.cast(eye, DVec3::NEG_X, 8.0).expect("a wall");
/// assert!((hit.distance - 1.0).abs() < 1e-12);
/// assert_eq!(pieces[hit.body].to_string(), "wall_0");
/// let below = rays.cast(eye, DVec3::NEG_Z, 8.0).expect("a floor");
/// assert!((below.distance - 0.4).abs() < 1e-12);
/// # Ok::<(), envgen::GenerateError>(())
/// ```
#[derive(Clone, Debug)]
pub struct BodyRaycaster {
    /// The solids, each with the index of its body.
    solids: Vec<(usize, Solid)>,
    index: GridIndex,
    /// The lowest and the highest point of all solids.
    heights: [f64; 2],
}

impl BodyRaycaster {
    /// Indexes bodies.
    pub fn new<'a>(bodies: impl IntoIterator<Item = &'a Form<'a>>) -> Self {
        let mut solids = Vec::new();
        for (i, form) in bodies.into_iter().enumerate() {
            solids.extend(Solid::of(form).into_iter().map(|solid| (i, solid)));
        }
        let bounds: Vec<Rect> = solids.iter().map(|(_, solid)| solid.bounds()).collect();
        let around = bounds.iter().copied().reduce(Rect::union);
        let cells = solids.len() as f64 * CELLS_A_SOLID;
        let most = Some(LISTINGS_A_SOLID);
        let runs = |i: usize, frame: &GridFrame, visit: &mut dyn FnMut(usize, usize, usize)| {
            let corners = crate::geometry::Shape::from_rect(bounds[i]).corners();
            frame.touched_runs(&Convex::Polygon(&corners), visit);
        };
        let index = GridIndex::new(index_area(around, 0.0), cells, solids.len(), most, runs);
        let extents = solids.iter().map(|(_, solid)| solid.heights());
        let join = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.min(c), b.max(d)];
        let heights = extents.reduce(join).unwrap_or_default();
        BodyRaycaster { solids, index, heights }
    }

    /// Returns the first body that a ray meets within `range` lengths of its direction, which need not be a unit
    /// vector. Returns `None` if it meets no body, and for a direction of length 0, a negative range or NaN. Of
    /// bodies at the same distance, it returns the first in the list.
    pub fn cast(&self, from: DVec3, direction: DVec3, range: f64) -> Option<BodyHit> {
        let (plan, along) = (from.truncate(), direction.truncate());
        let frame = self.index.frame;
        let area = frame.bounds();
        let [low, high] = self.heights;
        let (min, max) = (area.min.extend(low), area.max.extend(high));
        let (enter, leave) = slab(from, direction, min, max);
        let (enter, end) = (enter.max(0.0), leave.min(range));
        let is_ray = from.is_finite() && direction.is_finite() && direction != DVec3::ZERO;
        if !is_ray || range.is_nan() || enter > end {
            return None;
        }
        let mut search = Search {
            solids: &self.solids,
            from,
            direction,
            best: range,
            body: None,
            met: VecDeque::new(),
        };
        // Amanatides and Woo, A Fast Voxel Traversal Algorithm for Ray Tracing, 1987.
        let start = (plan + along * enter - frame.origin) / frame.cell_size;
        let mut cell = [start.x, start.y].map(|cell| cell.floor());
        let last = [frame.cols as f64 - 1.0, frame.rows as f64 - 1.0];
        for axis in 0..2 {
            cell[axis] = cell[axis].clamp(0.0, last[axis]);
        }
        loop {
            search.visit(self.index.of(cell[1] as usize * frame.cols + cell[0] as usize));
            // Where the ray leaves the cell, on each axis; never, where it runs along the other one.
            let border = [0, 1].map(|axis| {
                let ahead = cell[axis] + f64::from(along[axis] > 0.0);
                let line = frame.origin[axis] + ahead * frame.cell_size;
                if along[axis] == 0.0 { f64::INFINITY } else { (line - plan[axis]) / along[axis] }
            });
            let axis = usize::from(border[1] < border[0]);
            cell[axis] += along[axis].signum();
            let is_inside = (0.0..=last[axis]).contains(&cell[axis]);
            if !is_inside || border[axis] > end.min(search.best) {
                break;
            }
        }
        search.body.map(|body| BodyHit { distance: search.best, body })
    }
}

/// A ray that is followed through the cells.
struct Search<'a> {
    solids: &'a [(usize, Solid)],
    from: DVec3,
    direction: DVec3,
    /// The least distance found so far; initially the range.
    best: f64,
    body: Option<usize>,
    /// The solids that were met or missed last.
    met: VecDeque<u32>,
}

impl Search<'_> {
    fn visit(&mut self, listed: &[u32]) {
        for &i in listed {
            if self.met.contains(&i) {
                continue;
            }
            if self.met.len() == REMEMBERED {
                self.met.pop_front();
            }
            self.met.push_back(i);
            let (body, solid) = &self.solids[i as usize];
            let Some(distance) = solid.distance(self.from, self.direction) else { continue };
            let is_first = |other: usize| distance < self.best || *body < other;
            if distance <= self.best && self.body.is_none_or(is_first) {
                (self.best, self.body) = (distance, Some(*body));
            }
        }
    }
}

/// Returns where a ray enters and leaves a box. If it misses the box, it enters after it leaves.
fn slab(from: DVec3, direction: DVec3, min: DVec3, max: DVec3) -> (f64, f64) {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let (low, high) = (min[axis] - from[axis], max[axis] - from[axis]);
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return (f64::INFINITY, f64::NEG_INFINITY);
            }
            continue;
        }
        let (a, b) = (low / direction[axis], high / direction[axis]);
        (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
    }
    (enter, leave)
}

#[cfg(test)]
mod tests;
