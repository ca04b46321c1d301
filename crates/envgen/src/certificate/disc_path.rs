//! An exact test whether solid parts separate places for a disc, at a cost that does not depend on the disc's
//! radius.
//!
//! A disc's centre cannot be nearer to a solid part than the radius. So every convex piece of the parts, enlarged
//! by the radius, is forbidden ground, and pieces less than two radii apart form one barrier. Barriers separate two
//! points if and only if one of them goes around one of the points and not around the other: some closed walk over
//! overlapping pieces then crosses a line between the points more often to the one side than to the other. (By
//! Alexander's duality; the pieces are convex, and so are their overlaps, so that every loop in their union can be
//! drawn as such a walk.) A union-find that stores, for every piece, the number of crossings on the walk to it from
//! its set's root finds such a walk as soon as it receives the walk's last pair. This takes time nearly linear in
//! the number of pairs.

use glam::DVec2;

use super::budget::{Budget, Doubt};
use super::piece::Piece;
use super::piece_index::Pieces;
use super::stretches::{End, stretches};
use super::windings::{Crossings, Windings};
use crate::geometry::{Rect, Shape};

/// Lengths that differ by this share of the largest coordinate may differ only by rounding.
const ROUNDING: f64 = 1e-13;

/// The greatest number of pairs whose overlap is uncertain because of rounding. Worlds with more such pairs mostly
/// consist of them.
const MAX_UNSURE: usize = 1 << 20;

/// The result of a comparison up to rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Nearer {
    Yes,
    Perhaps,
    No,
}

/// Forbidden ground for the centre of a disc: pieces enlarged by the disc's radius, and everything outside a
/// rectangle.
pub(super) struct Barriers<'a> {
    pieces: &'a Pieces,
    area: Rect,
    radius: f64,
    /// Lengths that differ by less than this may be equal.
    rounding: f64,
}

/// Ground that two barriers share, as a walk from the middle of the one to the middle of the other.
struct Joint {
    between: [usize; 2],
    /// The points of the walk, which is straight between them.
    walk: [DVec2; 3],
    is_sure: bool,
}

impl<'a> Barriers<'a> {
    /// Creates barriers from pieces, which must be indexed at least as far as the radius.
    pub(super) fn new(pieces: &'a Pieces, area: Rect, radius: f64) -> Self {
        let largest = area.min.abs().max(area.max.abs()).max_element();
        Barriers { pieces, area, radius, rounding: ROUNDING * (1.0 + largest + radius) }
    }

    /// Returns the difference below which lengths may be equal.
    pub(super) fn rounding(&self) -> f64 {
        self.rounding
    }

    pub(super) fn nearer(&self, distance: f64, limit: f64) -> Nearer {
        if distance > limit + self.rounding {
            Nearer::No
        } else if distance < limit - self.rounding || limit <= self.rounding {
            // A disc without size is stopped by what touches.
            Nearer::Yes
        } else {
            Nearer::Perhaps
        }
    }

    /// Whether both ends of every line are in the same connected part of the free space. All ends must be free and
    /// inside the area.
    pub(super) fn join(&self, lines: &[[DVec2; 2]], budget: &mut Budget) -> Result<bool, Doubt> {
        let mut crossings = Crossings::new(lines);
        let mut unsure = Vec::new();
        // The last number is that of all outside of the area.
        let mut windings = Windings::new(self.pieces.list().len() + 1);
        let mut is_whole = true;
        self.joints(budget, |joint, budget| {
            if joint.is_sure {
                is_whole = windings.join(joint.between, crossings.of(&joint.walk, budget)?);
            } else if unsure.len() < MAX_UNSURE {
                unsure.push(joint);
            } else {
                return Err(Doubt::TooClose);
            }
            Ok(!is_whole)
        })?;
        if !is_whole {
            return Ok(false);
        }
        for joint in unsure {
            if !windings.join(joint.between, crossings.of(&joint.walk, budget)?) {
                return Err(Doubt::TooClose);
            }
        }
        Ok(true)
    }

    /// Whether a connected part of the free space extends from the area's west side to its east side. This is the
    /// case if and only if no barrier extends from its south side to its north side inside the area.
    ///
    /// `shapes` are those of the pieces.
    pub(super) fn crosses<'b>(
        &self,
        shapes: impl Iterator<Item = &'b Shape>,
        budget: &mut Budget,
    ) -> Result<bool, Doubt> {
        let count = self.pieces.list().len();
        let (south, north) = (count, count + 1);
        let mut windings = Windings::new(count + 2);
        let mut unsure = Vec::new();
        let mut visit = |between: [usize; 2], nearer: Nearer| {
            match nearer {
                Nearer::Yes => _ = windings.join(between, 0),
                Nearer::Perhaps if unsure.len() < MAX_UNSURE => unsure.push(between),
                Nearer::Perhaps => return Err(Doubt::TooClose),
                Nearer::No => {}
            }
            Ok(windings.are_joined(south, north))
        };
        let (low, high) = (self.area.min.y, self.area.max.y);
        for between in self.interiors(shapes, [south, north], budget)? {
            if visit(between, Nearer::Yes)? {
                return Ok(false);
            }
        }
        for (i, piece) in self.pieces.list().iter().enumerate() {
            budget.spend(1)?;
            let bounds = piece.bounds();
            let sides = [
                (south, DVec2::NEG_Y, bounds.min.y - low, low),
                (north, DVec2::Y, high - bounds.max.y, -high),
            ];
            for (side, direction, distance, limit) in sides {
                let nearer = self.nearer_side(distance);
                if nearer == Nearer::No {
                    continue;
                }
                let beyond = |p: DVec2| -direction.y * p.y - limit + self.radius;
                let both = |p: DVec2| piece.distance(p).max(beyond(p));
                let at = piece.farthest(direction);
                let nearer = self.inside(at, nearer, [piece, piece], both, budget)?;
                if visit([i, side], nearer)? {
                    return Ok(false);
                }
            }
        }
        let mut crosses = true;
        self.near_pairs(budget, |[i, j], [a, b], nearer, at, budget| {
            let both = |p: DVec2| a.distance(p).max(b.distance(p));
            let nearer = self.inside(at, nearer, [a, b], both, budget)?;
            crosses = !visit([i, j], nearer)?;
            Ok(!crosses)
        })?;
        for between in unsure {
            windings.join(between, 0);
        }
        if crosses && windings.are_joined(south, north) {
            return Err(Doubt::TooClose);
        }
        Ok(crosses)
    }

    /// Returns what the interiors of polygons join along the area's west and east side: two of their sides, or a side
    /// and one of the area's sides, whose numbers are given.
    fn interiors<'b>(
        &self,
        shapes: impl Iterator<Item = &'b Shape>,
        [south, north]: [usize; 2],
        budget: &mut Budget,
    ) -> Result<Vec<[usize; 2]>, Doubt> {
        let Rect { min, max } = self.area;
        let (mut joined, mut first) = (Vec::new(), 0);
        for shape in shapes {
            if let Shape::Polygon { vertices } = shape {
                budget.spend(2 * vertices.len() as u64)?;
                let number = |end| match end {
                    End::Side(side) => first + side,
                    End::Low => south,
                    End::High => north,
                };
                let ends = [min.x, max.x].map(|x| stretches(vertices, x, [min.y, max.y]));
                joined.extend(ends.into_iter().flatten().map(|ends| ends.map(number)));
            }
            first += Piece::count(shape);
        }
        Ok(joined)
    }

    /// Whether ground that two barriers share, as near as `nearer` at a place, has a part between the lines of the
    /// area's west and east side. `both` is the greater of the distances to the two, which is a convex function, so
    /// that the ground meets the line next to the place if its least value there is within the radius.
    fn inside(
        &self,
        at: DVec2,
        nearer: Nearer,
        pieces: [&Piece; 2],
        both: impl Fn(DVec2) -> f64,
        budget: &mut Budget,
    ) -> Result<Nearer, Doubt> {
        let x = at.x.clamp(self.area.min.x, self.area.max.x);
        if nearer == Nearer::No || x == at.x {
            return Ok(nearer);
        }
        let around = pieces[0].bounds().union(pieces[1].bounds()).grown(self.radius);
        let (mut low, mut high) = (around.min.y, around.max.y);
        budget.spend(2 * THIRDS)?;
        for _ in 0..THIRDS {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if both(DVec2::new(x, a)) <= both(DVec2::new(x, b)) { high = b } else { low = a }
        }
        Ok(self.nearer(both(DVec2::new(x, 0.5 * (low + high))), self.radius))
    }

    /// Calls `visit` for all shared ground until it returns that this is enough.
    fn joints(
        &self,
        budget: &mut Budget,
        mut visit: impl FnMut(Joint, &mut Budget) -> Result<bool, Doubt>,
    ) -> Result<(), Doubt> {
        let (area, outside) = (self.area, self.pieces.list().len());
        for (i, piece) in self.pieces.list().iter().enumerate() {
            budget.spend(1)?;
            let bounds = piece.bounds();
            for (direction, distance) in [
                (DVec2::NEG_X, bounds.min.x - area.min.x),
                (DVec2::X, area.max.x - bounds.max.x),
                (DVec2::NEG_Y, bounds.min.y - area.min.y),
                (DVec2::Y, area.max.y - bounds.max.y),
            ] {
                let nearer = self.nearer_side(distance);
                if nearer == Nearer::No {
                    continue;
                }
                // To the nearest place on the area's side, and beyond it: from there no walk outside crosses a line
                // inside, or on the side.
                let end = piece.farthest(direction) + direction * distance.max(0.0);
                let walk = [piece.center, end, end + direction * (1.0 + self.rounding)];
                let joint = Joint { between: [i, outside], walk, is_sure: nearer == Nearer::Yes };
                if visit(joint, budget)? {
                    return Ok(());
                }
            }
        }
        self.near_pairs(budget, |between, [a, b], nearer, at, budget| {
            let walk = [a.center, at, b.center];
            visit(Joint { between, walk, is_sure: nearer == Nearer::Yes }, budget)
        })
    }

    /// Calls `visit` for all pairs of pieces that overlap when enlarged, or may do so, with a place that both
    /// cover, until it returns that this is enough.
    fn near_pairs(
        &self,
        budget: &mut Budget,
        mut visit: impl FnMut(
            [usize; 2],
            [&Piece; 2],
            Nearer,
            DVec2,
            &mut Budget,
        ) -> Result<bool, Doubt>,
    ) -> Result<(), Doubt> {
        let reach = 2.0 * self.radius;
        let list = self.pieces.list();
        self.pieces.pairs(reach + self.rounding, budget, |i, j, gap, budget| {
            let (a, b) = (&list[i], &list[j]);
            let nearer = self.nearer(gap.distance, reach);
            if nearer == Nearer::No {
                return Ok(false);
            }
            // As far into the one grown piece as into the other.
            let total = a.radius + b.radius + reach;
            let share = if total > 0.0 { (a.radius + self.radius) / total } else { 0.5 };
            let at = gap.points[0].lerp(gap.points[1], share);
            visit([i, j], [a, b], nearer, at, budget)
        })
    }

    fn nearer_side(&self, distance: f64) -> Nearer {
        if distance <= 0.0 { Nearer::Yes } else { self.nearer(distance, self.radius) }
    }
}

/// Number of search steps, each of which keeps two thirds of a line, until rounding is reached.
const THIRDS: u64 = 120;

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    pub(in crate::certificate) const SIDE: f64 = 6.0;
    /// Side of the lattice that floods are over.
    const H: f64 = 0.1;

    /// Up to 13 shapes of all sorts in an area of side [`SIDE`].
    pub(in crate::certificate) fn shapes() -> impl Strategy<Value = Vec<Shape>> {
        let point = || (-0.5..6.5, -0.5..6.5).prop_map(|(x, y)| DVec2::new(x, y));
        let shape = prop_oneof![
            (point(), point()).prop_map(|(a, b)| Shape::Segment { a, b }),
            (point(), 0.05..1.0).prop_map(|(center, radius)| Shape::Disc { center, radius }),
            (point(), (0.05..1.5, 0.05..0.5), -4.0..4.0).prop_map(|(center, half, heading)| {
                Shape::Box { center, half_size: DVec2::new(half.0, half.1), heading }
            }),
            (point(), 0.2..4.0_f64).prop_map(|(p, size)| {
                let p = p - 0.5 * size;
                let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 0.5), (0.0, 2.0)];
                let corner = |(x, y)| p + size * DVec2::new(x, y);
                Shape::Polygon { vertices: corners.map(corner).to_vec() }
            }),
        ];
        prop::collection::vec(shape, 0..14)
    }

    /// The points of a lattice over the area that are `least` away from all shapes and joined, over
    /// sides and corners, to one of those that `from` names.
    fn flood(shapes: &[Shape], least: f64, from: impl Fn(DVec2) -> bool) -> Vec<DVec2> {
        let count = (SIDE / H).round() as usize + 1;
        let point = |i: usize| DVec2::new((i % count) as f64, (i / count) as f64) * H;
        let is_free = |i| shapes.iter().all(|shape| shape.distance(point(i)) >= least);
        let mut free: Vec<bool> = (0..count * count).map(is_free).collect();
        let mut open: Vec<usize> = (0..count * count).filter(|&i| from(point(i))).collect();
        open.retain(|&i| std::mem::take(&mut free[i]));
        let mut next = 0;
        while let Some(&i) = open.get(next) {
            next += 1;
            for row in (i / count).saturating_sub(1)..=(i / count + 1).min(count - 1) {
                for col in (i % count).saturating_sub(1)..=(i % count + 1).min(count - 1) {
                    let beside = row * count + col;
                    if std::mem::take(&mut free[beside]) {
                        open.push(beside);
                    }
                }
            }
        }
        open.into_iter().map(point).collect()
    }

    /// What floods over a lattice say for certain: every point lies within H / sqrt 2 of one of the
    /// lattice, and distances change by no more than a point moves.
    fn by_flood(
        shapes: &[Shape],
        radius: f64,
        from: impl Fn(DVec2) -> bool,
        to: impl Fn(DVec2) -> bool,
    ) -> Option<bool> {
        let step = H * std::f64::consts::FRAC_1_SQRT_2;
        if flood(shapes, radius + step, &from).into_iter().any(&to) {
            return Some(true);
        }
        let near = |p: DVec2, ends: &dyn Fn(DVec2) -> bool| {
            let steps = [-H, 0.0, H];
            steps.iter().any(|&x| steps.iter().any(|&y| ends(p + DVec2::new(x, y))))
        };
        let reached = flood(shapes, radius - step, |p| near(p, &from));
        (!reached.into_iter().any(|p| near(p, &to))).then_some(false)
    }

    fn budget() -> Budget {
        Budget::new(u64::MAX)
    }

    fn pieces(shapes: &[Shape], radius: f64) -> Pieces {
        Pieces::new(shapes.iter(), radius).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]
        #[test]
        fn floods_over_lattices_agree(
            shapes in shapes(),
            radius in prop_oneof![Just(0.0), 0.0..0.6_f64],
            ends in prop::array::uniform4(0..=60_u8),
        ) {
            let area = Rect::new(DVec2::ZERO, DVec2::splat(SIDE));
            let pieces = pieces(&shapes, radius);
            let barriers = Barriers::new(&pieces, area, radius);

            let crosses = barriers.crosses(shapes.iter(), &mut budget());
            let (west, east) = (|p: DVec2| p.x < 0.5 * H, |p: DVec2| p.x > SIDE - 0.5 * H);
            if let Some(expected) = by_flood(&shapes, radius, west, east) {
                prop_assert_eq!(crosses, Ok(expected));
            }

            let [a, b, c, d] = ends.map(|end| f64::from(end) * H);
            let (start, goal) = (DVec2::new(a, b), DVec2::new(c, d));
            let is_free = |p: DVec2| shapes.iter().all(|shape| shape.distance(p) > radius + 1e-6);
            prop_assume!(is_free(start) && is_free(goal));
            let joined = barriers.join(&[[start, goal]], &mut budget());
            let at = |end: DVec2| move |p: DVec2| p.distance(end) < 0.5 * H;
            if let Some(expected) = by_flood(&shapes, radius, at(start), at(goal)) {
                prop_assert_eq!(joined, Ok(expected));
            }
            // Whatever the order, and with lines beside it that are joined anyway.
            let lines = [[start, start], [goal, start], [goal, goal]];
            prop_assert_eq!(barriers.join(&lines, &mut budget()), joined);
        }
    }

    /// A square ring of four walls around (0, 0), with a gap in the eastern one.
    fn ring(gap: f64) -> Vec<Shape> {
        let wall = |x: f64, y: f64, w: f64, h: f64| {
            let center = DVec2::new(x, y);
            Shape::Box { center, half_size: DVec2::new(w, h), heading: 0.0 }
        };
        let half = 0.5 * (5.0 - 0.5 * gap);
        vec![
            wall(-5.0, 0.0, 0.1, 5.1),
            wall(0.0, -5.0, 5.1, 0.1),
            wall(0.0, 5.0, 5.1, 0.1),
            wall(5.0, 0.5 * gap + half, 0.1, half),
            wall(5.0, -0.5 * gap - half, 0.1, half),
        ]
    }

    #[test]
    fn gaps_differ_from_walls_to_a_nanometre_in_large_worlds() {
        let area = Rect::new(DVec2::splat(-1000.0), DVec2::splat(1000.0));
        let line = [DVec2::ZERO, DVec2::new(900.0, 321.0)];
        for radius in [1e-6, 1e-3, 0.5] {
            for (gap, expected) in [
                (2.0 * radius + 1e-9, Ok(true)),
                (2.0 * radius - 1e-9, Ok(false)),
                (2.0 * radius, Err(Doubt::TooClose)),
            ] {
                let pieces = pieces(&ring(gap), radius);
                let barriers = Barriers::new(&pieces, area, radius);
                let joined = barriers.join(&[line], &mut budget());
                assert_eq!(joined, expected, "radius {radius}, gap {gap}");
            }
        }
        // A point is stopped by what touches.
        let pieces = pieces(&ring(0.0), 0.0);
        let barriers = Barriers::new(&pieces, area, 0.0);
        assert_eq!(barriers.join(&[line], &mut budget()), Ok(false));
    }

    #[test]
    fn filled_polygons_are_barriers() {
        let area = Rect::new(DVec2::splat(0.5), DVec2::new(9.5, 5.5));
        let polygon = |corners: &[(f64, f64)]| {
            let vertices = corners.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
            [Shape::Polygon { vertices }]
        };
        for (corners, expected) in [
            // All of the area, all but a corner, and all but a strip in the north.
            (&[(0.0, 0.0), (10.0, 0.0), (10.0, 6.0), (0.0, 6.0)][..], false),
            (&[(0.0, 0.0), (10.0, 0.0), (10.0, 3.0), (7.0, 6.0), (0.0, 6.0)], false),
            (&[(0.0, 0.0), (10.0, 0.0), (10.0, 4.0), (0.0, 4.0)], true),
            // Two arms that are connected outside the area.
            (
                &[
                    (4.0, -2.0),
                    (4.0, 2.0),
                    (3.0, 2.0),
                    (3.0, -3.0),
                    (12.0, -3.0),
                    (12.0, 8.0),
                    (6.0, 8.0),
                    (6.0, 4.0),
                    (7.0, 4.0),
                    (7.0, 7.0),
                    (11.0, 7.0),
                    (11.0, -2.0),
                ],
                true,
            ),
        ] {
            let shapes = polygon(corners);
            let pieces = pieces(&shapes, 0.3);
            let barriers = Barriers::new(&pieces, area, 0.3);
            let found = barriers.crosses(shapes.iter(), &mut budget());
            assert_eq!(found, Ok(expected), "{corners:?}");
        }
    }

    #[test]
    fn ends_on_the_same_side_of_the_area_are_parted_in_both_directions() {
        let area = Rect::new(DVec2::ZERO, DVec2::new(10.0, 6.0));
        let wall = |from: (f64, f64), to: (f64, f64)| {
            Shape::from_rect(Rect::new(DVec2::new(from.0, from.1), DVec2::new(to.0, to.1)))
        };
        for (wall, a, b) in [
            (wall((0.2, 2.9), (10.0, 3.1)), (0.0, 5.0), (0.0, 1.0)),
            (wall((0.0, 2.9), (9.8, 3.1)), (10.0, 5.0), (10.0, 1.0)),
            (wall((4.9, 0.2), (5.1, 6.0)), (1.0, 0.0), (9.0, 0.0)),
            (wall((4.9, 0.0), (5.1, 5.8)), (1.0, 6.0), (9.0, 6.0)),
        ] {
            let (a, b) = (DVec2::from(a), DVec2::from(b));
            let pieces = pieces(&[wall], 0.3);
            let barriers = Barriers::new(&pieces, area, 0.3);
            for line in [[a, b], [b, a]] {
                assert_eq!(barriers.join(&[line], &mut budget()), Ok(false), "{line:?}");
            }
        }
    }

    #[test]
    fn the_frame_is_a_barrier() {
        let area = Rect::new(DVec2::splat(-6.0), DVec2::splat(6.0));
        let line = [DVec2::ZERO, DVec2::new(-5.9, 0.0)];
        for (gap, expected) in [(1.0, true), (0.7, false)] {
            // The path around leads between the ring and the area's sides, 0.9 m wide.
            let pieces = pieces(&ring(gap), 0.4);
            let joined = Barriers::new(&pieces, area, 0.4).join(&[line], &mut budget());
            assert_eq!(joined, Ok(expected));
        }
        // A wall whose ends are half a metre from the area's sides.
        let center = DVec2::ZERO;
        let wall = [Shape::Box { center, half_size: DVec2::new(0.1, 5.5), heading: 0.0 }];
        let line = [DVec2::new(-3.0, 0.0), DVec2::new(3.0, 0.0)];
        for (radius, expected) in [(0.4, true), (0.6, false)] {
            let pieces = pieces(&wall, radius);
            let barriers = Barriers::new(&pieces, area, radius);
            assert_eq!(barriers.join(&[line], &mut budget()), Ok(expected));
            assert_eq!(barriers.crosses(wall.iter(), &mut budget()), Ok(expected));
        }
    }
}
