//! Tests whether a strip along a path overlaps itself, and where lines beside the path meet it.
//!
//! The strip of half width h is the union of the path's normals of length h to both sides. As long as every bend
//! has a radius greater than h, the strip is locally one-to-one, and it overlaps itself if and only if its border
//! touches itself: a map from a disc that is locally one-to-one, and one-to-one on the border, is one-to-one. The
//! border consists of lines and arcs, which are intersected in closed form. The border along a clothoid is replaced
//! by arcs that deviate from it by at most [`TOLERANCE`].

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::tree::BoxTree;
use super::{Curve, Path};
use crate::geometry::{Rect, unit_vector};

/// The greatest deviation, in metres, of the arcs that replace the border along a clothoid.
pub const TOLERANCE: f64 = 1e-5;

/// Pieces shorter than this, in metres, are not part of the border; their neighbours meet.
const SHORTEST: f64 = 1e-6;

/// The rounding error of the fraction along a line or arc.
const EDGE: f64 = 1e-12;

/// Ends that are nearer to another line than this, in metres, lie on it.
const TOUCH: f64 = 1e-9;

/// Tests whether the strip of half width `half` along the path overlaps itself. All bends must have a radius
/// greater than `half`. Returns two distances along the path at which the strip overlaps itself, the lesser first,
/// or `None`.
///
/// A path whose headings span less than pi never overlaps itself. For each of its points, the two circles with the
/// radius of the tightest bend that touch the path there do not meet the rest of it, because the sine of the
/// heading changes by at most 1/radius per metre along the middle direction. So the normal at one point, which lies
/// inside those circles, is never as near to another point of the path as to its own, and no two normals meet.
pub fn strip_overlap(path: &Path<'_>, half: f64, closed: bool) -> Option<(f64, f64)> {
    let (low, high) = path.headings();
    if high - low < PI && !closed {
        return None;
    }
    let border = Border::new(path, half, closed);
    let mut found = None;
    for (i, edge) in border.edges.iter().enumerate() {
        border.tree.any_overlap(edge.bounds(), |j| {
            let other = &border.edges[j];
            if j <= i || border.adjacent(i, j) {
                return false;
            }
            edge.meets(other, |a, b| {
                let (a, b) = (edge.s_at(a), other.s_at(b));
                found = found.or(Some((a.min(b), a.max(b))));
            });
            found.is_some()
        });
        if found.is_some() {
            break;
        }
    }
    found
}

/// Whether half circles of radius `half` around both ends of a path that does not overlap itself do not touch its
/// strip of half width `reach`.
pub(crate) fn round_ends_are_clear(path: &Path<'_>, half: f64, reach: f64) -> bool {
    let mut border = Border::new(path, reach, true);
    let sides = border.edges.len();
    border.round_ends(path, half);
    border.edges[sides..].iter().all(|end| {
        !border.tree.any_overlap(end.bounds(), |i| {
            let mut is_met = false;
            end.meets(&border.edges[i], |_, _| is_met = i < sides);
            is_met
        })
    })
}

/// Returns the sections, as distances along the path, in which the lines at the given offsets to the left of it are
/// all at least `half` metres away from the whole path.
pub(crate) fn clear_stretches(
    path: &Path<'_>,
    index: &super::PathIndex,
    offsets: impl IntoIterator<Item = f64>,
    half: f64,
    closed: bool,
) -> Vec<(f64, f64)> {
    let mut border = Border::new(path, half, true);
    if !closed {
        border.round_ends(path, half);
    }
    let border = border;
    let mut blocked: Vec<(f64, f64)> = Vec::new();
    for offset in offsets {
        let mut edges = Vec::new();
        side(path, offset, &mut edges);
        for edge in &edges {
            let mut cuts = vec![0.0, 1.0];
            border.tree.any_overlap(edge.bounds(), |j| {
                edge.meets(&border.edges[j], |a, _| cuts.push(a.clamp(0.0, 1.0)));
                false
            });
            cuts.sort_by(f64::total_cmp);
            for cut in cuts.windows(2).filter(|cut| cut[1] > cut[0]) {
                let p = edge.at(0.5 * (cut[0] + cut[1]));
                let near = index.locate(p).is_some_and(|at| at.offset.abs() < half - TOLERANCE);
                if near {
                    blocked.push((edge.s_at(cut[0]), edge.s_at(cut[1])));
                }
            }
        }
    }
    blocked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut clear = Vec::new();
    let mut from = 0.0;
    for (start, end) in blocked {
        if start > from {
            clear.push((from, start));
        }
        from = f64::max(from, end);
    }
    if path.length() > from {
        clear.push((from, path.length()));
    }
    clear
}

/// The border of a strip.
struct Border {
    edges: Vec<Edge>,
    tree: BoxTree,
    closed: bool,
    /// Number of edges of the left side, which come first. Those of the right side follow, then the ends.
    left: usize,
    sides: usize,
}

impl Border {
    fn new(path: &Path<'_>, half: f64, closed: bool) -> Self {
        let mut edges = Vec::new();
        side(path, half, &mut edges);
        let left = edges.len();
        side(path, -half, &mut edges);
        let sides = edges.len();
        if !closed && left > 0 {
            for (s, a, b) in [
                (0.0, edges[0].a, edges[left].a),
                (path.length(), edges[left - 1].b, edges[sides - 1].b),
            ] {
                edges.push(Edge { s0: s, s1: s, a, b, arc: None });
            }
        }
        let tree = tree_of(&edges);
        Border { edges, tree, closed, left, sides }
    }

    /// Adds half a circle around each end of the path.
    fn round_ends(&mut self, path: &Path<'_>, half: f64) {
        let ends = [
            path.curves().first().map(|curve| (0.0, curve.start, 1.0)),
            path.curves().last().map(|curve| (path.length(), curve.end(), -1.0)),
        ];
        for (s, pose, sign) in ends.into_iter().flatten() {
            let from = pose.heading + sign * 0.5 * PI;
            let (a, b) = (unit_vector(from) * half, unit_vector(from + PI) * half);
            let arc = Some(Arc { center: pose.position, radius: half, from, sweep: PI });
            self.edges.push(Edge { s0: s, s1: s, a: pose.position + a, b: pose.position + b, arc });
        }
        self.tree = tree_of(&self.edges);
    }

    /// Whether two edges meet by construction. Neighbours along a side touch smoothly, and smooth neighbours that
    /// are lines, or arcs of less than a full turn, meet nowhere else.
    fn adjacent(&self, i: usize, j: usize) -> bool {
        let (left, sides) = (self.left, self.sides);
        if j >= sides {
            let of_start = [0, left];
            let of_end = [left - 1, sides - 1];
            return i < sides && if j == sides { of_start } else { of_end }.contains(&i);
        }
        let (first, last) = if i < left { (0, left - 1) } else { (left, sides - 1) };
        let same_side = (i < left) == (j < left);
        same_side && (j - i == 1 || (self.closed && i == first && j == last))
    }
}

fn tree_of(edges: &[Edge]) -> BoxTree {
    BoxTree::new(&edges.iter().map(Edge::bounds).collect::<Vec<_>>())
}

/// Adds the line at `offset` metres to the left of a path, as lines and arcs.
fn side(path: &Path<'_>, offset: f64, edges: &mut Vec<Edge>) {
    for (i, curve) in path.curves().iter().enumerate() {
        if curve.length < SHORTEST {
            continue;
        }
        let s = path.start_of(i);
        let parts = if curve.is_arc() {
            1.0
        } else {
            // Against the arc through its ends, a clothoid of length l strays by sqrt(3)/216 c l^3.
            let longest = libm::cbrt(TOLERANCE / (8.1e-3 * curve.sharpness().abs()));
            (curve.length / longest).ceil().clamp(1.0, 10_000.0)
        };
        let length = curve.length / parts;
        let beside = |t: f64| {
            let pose = curve.pose_at(t);
            (pose.position + unit_vector(pose.heading).perp() * offset, pose.heading)
        };
        let mut start = beside(0.0);
        for part in 0..parts as u32 {
            let t = f64::from(part) * length;
            let end = beside(t + length);
            edges.push(Edge {
                s0: s + t,
                s1: s + t + length,
                a: start.0,
                b: end.0,
                arc: Arc::between(curve, offset, start, end),
            });
            start = end;
        }
    }
}

/// A line or an arc.
#[derive(Clone, Copy, Debug)]
struct Edge {
    s0: f64,
    s1: f64,
    a: DVec2,
    b: DVec2,
    arc: Option<Arc>,
}

#[derive(Clone, Copy, Debug)]
struct Arc {
    center: DVec2,
    radius: f64,
    /// Direction from the centre to the start, and the signed angle to the end.
    from: f64,
    sweep: f64,
}

impl Arc {
    /// Creates the arc from one place beside a curve to another.
    fn between(curve: &Curve, offset: f64, a: (DVec2, f64), b: (DVec2, f64)) -> Option<Arc> {
        let sweep = b.1 - a.1;
        if sweep.abs() < 1e-9 {
            return None;
        }
        if curve.is_arc() {
            let turn_radius = 1.0 / curve.start_curvature;
            let normal = unit_vector(a.1).perp();
            let center = a.0 + normal * (turn_radius - offset);
            let from = a.1 - 0.5 * PI * sweep.signum();
            return Some(Arc { center, radius: (turn_radius - offset).abs(), from, sweep });
        }
        let chord = b.0 - a.0;
        let half = 0.5 * sweep;
        let (sin, cos) = libm::sincos(half);
        let middle = 0.5 * (a.0 + b.0);
        let center = middle + chord.perp() * (0.5 * cos / sin);
        let out = a.0 - center;
        let from = libm::atan2(out.y, out.x);
        Some(Arc { center, radius: out.length(), from, sweep })
    }

    fn at(&self, fraction: f64) -> DVec2 {
        self.center + unit_vector(self.from + fraction * self.sweep) * self.radius
    }

    /// Returns the position on the arc of a direction from the centre, as a fraction of the arc.
    fn fraction(&self, p: DVec2) -> Option<f64> {
        let out = p - self.center;
        let mut angle = (libm::atan2(out.y, out.x) - self.from) * self.sweep.signum();
        angle -= TAU * (angle / TAU).floor();
        let fraction = angle / self.sweep.abs();
        if fraction <= 1.0 + EDGE {
            Some(fraction.min(1.0))
        } else {
            (angle > TAU - EDGE).then_some(0.0)
        }
    }
}

impl Edge {
    fn at(&self, fraction: f64) -> DVec2 {
        match self.arc {
            Some(arc) => arc.at(fraction),
            None => self.a.lerp(self.b, fraction),
        }
    }

    fn s_at(&self, fraction: f64) -> f64 {
        self.s0 + fraction * (self.s1 - self.s0)
    }

    fn bounds(&self) -> Rect {
        let chord = Rect::new(self.a.min(self.b), self.a.max(self.b));
        let Some(arc) = self.arc else { return chord.grown(TOUCH) };
        if arc.sweep.abs() >= PI {
            return Rect::new(arc.center, arc.center).grown(arc.radius + TOUCH);
        }
        let sagitta = arc.radius * (1.0 - libm::cos(0.5 * arc.sweep));
        chord.grown(sagitta + TOUCH)
    }

    /// Returns the position of a point on the edge's line or circle, as a fraction of the edge.
    fn fraction(&self, p: DVec2) -> Option<f64> {
        match self.arc {
            Some(arc) => arc.fraction(p),
            None => {
                let along = self.b - self.a;
                let fraction = (p - self.a).dot(along) / along.length_squared();
                (-EDGE..=1.0 + EDGE).contains(&fraction).then_some(fraction)
            }
        }
    }

    /// Returns the position of a point that lies on the edge, up to [`TOUCH`], as a fraction of the edge; otherwise
    /// `None`.
    fn touched_by(&self, p: DVec2) -> Option<f64> {
        self.fraction(p).filter(|&fraction| self.at(fraction).distance(p) < TOUCH)
    }

    /// Calls `found` with the fractions along both edges of the points that they share; for a common section, with
    /// its ends.
    fn meets(&self, other: &Edge, mut found: impl FnMut(f64, f64)) {
        let mut both = |p: DVec2| {
            if let (Some(a), Some(b)) = (self.fraction(p), other.fraction(p)) {
                found(a, b);
            }
        };
        match (self.arc, other.arc) {
            (None, None) => {
                let (u, v) = (self.b - self.a, other.b - other.a);
                let cross = u.perp_dot(v);
                if cross != 0.0 {
                    both(self.a + u * ((other.a - self.a).perp_dot(v) / cross));
                }
            }
            (Some(arc), None) => line_circle(other.a, other.b, &arc, &mut both),
            (None, Some(arc)) => line_circle(self.a, self.b, &arc, &mut both),
            (Some(a), Some(b)) => circles(&a, &b, &mut both),
        }
        for p in [other.a, other.b] {
            if let Some(fraction) = self.touched_by(p) {
                found(fraction, if p == other.a { 0.0 } else { 1.0 });
            }
        }
        for p in [self.a, self.b] {
            if let Some(fraction) = other.touched_by(p) {
                found(if p == self.a { 0.0 } else { 1.0 }, fraction);
            }
        }
    }
}

fn line_circle(a: DVec2, b: DVec2, arc: &Arc, found: &mut impl FnMut(DVec2)) {
    let along = b - a;
    let length = along.length();
    if length == 0.0 {
        return;
    }
    let u = along / length;
    let foot = a + u * u.dot(arc.center - a);
    let height = u.perp_dot(arc.center - a);
    let half2 = (arc.radius - height) * (arc.radius + height);
    if half2 >= 0.0 {
        let half = half2.sqrt();
        found(foot - u * half);
        found(foot + u * half);
    }
}

fn circles(a: &Arc, b: &Arc, found: &mut impl FnMut(DVec2)) {
    let between = b.center - a.center;
    let d = between.length();
    if d == 0.0 {
        return;
    }
    let u = between / d;
    // The radical line: differences before products, so that near radii do not cancel.
    let x = 0.5 * (d + (a.radius - b.radius) * (a.radius + b.radius) / d);
    let half2 = (a.radius - x) * (a.radius + x);
    if half2 >= 0.0 {
        let foot = a.center + u * x;
        let side = u.perp() * half2.sqrt();
        found(foot - side);
        found(foot + side);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::PathIndex;
    use crate::geometry::{Pose, segments_cross};
    use proptest::prelude::*;

    /// A path of (length, angle) pieces; an angle of 0 is a line.
    fn path(pieces: &[(f64, f64)]) -> Path<'static> {
        let mut pose = Pose::default();
        let curves: Vec<Curve> = pieces
            .iter()
            .map(|&(length, angle)| {
                let curve = Curve::arc(pose, length, angle / length);
                pose = curve.end();
                curve
            })
            .collect();
        Path::new(curves)
    }

    /// Whether two normals of a path meet, of those taken every `step` metres.
    fn normals_meet(path: &Path<'_>, half: f64, step: f64) -> bool {
        let stations: Vec<f64> =
            (0..=(path.length() / step) as u32).map(|i| f64::from(i) * step).collect();
        let left = path.offset_curve(half, &stations);
        let right = path.offset_curve(-half, &stations);
        let n = stations.len();
        (0..n).any(|i| (i + 1..n).any(|j| segments_cross(left[i], right[i], left[j], right[j])))
    }

    #[test]
    fn a_loop_crosses_itself_and_a_bend_does_not() {
        let quarter = (20.0, 0.5 * PI);
        assert!(strip_overlap(&path(&[quarter; 3]), 3.0, false).is_none());
        let round = [(30.0, 0.0), quarter, quarter, quarter, (30.0, 0.0)];
        let (first, second) = strip_overlap(&path(&round), 3.0, false).unwrap();
        // The last straight crosses the first one 12.7 m from its end.
        assert!((14.0..=21.0).contains(&first), "{first}");
        assert!((90.0..=120.0).contains(&second), "{second}");
    }

    #[test]
    fn parallel_arms_overlap_when_they_are_wider_than_their_distance() {
        // A gentle S that comes back beside itself: two arms 2 x 10 m apart.
        let turn = (10.0 * PI, PI);
        let arms = path(&[(50.0, 0.0), turn, (50.0, 0.0)]);
        assert!(strip_overlap(&arms, 9.9, false).is_none());
        let back = path(&[(50.0, 0.0), (10.0 * PI, PI), (20.0, 0.0), (5.0 * PI, 1.0), (60.0, 0.0)]);
        assert!(strip_overlap(&back, 2.0, false).is_some());
    }

    #[test]
    fn driving_the_same_circle_twice_is_found() {
        // Lines and circles that coincide have no crossing points, only common stretches.
        let side = [(40.0, 0.0), (10.0, 0.5 * PI)];
        let twice: Vec<_> = side.iter().copied().cycle().take(12).collect();
        assert!(strip_overlap(&path(&twice), 2.0, false).is_some());
        let once: Vec<_> = side.iter().copied().cycle().take(8).collect();
        assert!(strip_overlap(&path(&once), 2.0, true).is_none());
    }

    #[test]
    fn a_figure_of_eight_crosses_itself_though_it_closes() {
        let angle = 1.5 * PI;
        let eight =
            path(&[(angle * 10.0, angle), (20.0, 0.0), (angle * 10.0, -angle), (20.0, 0.0)]);
        assert!(strip_overlap(&eight, 2.0, true).is_some());
    }

    #[test]
    fn a_short_piece_between_two_turns_is_no_crossing() {
        for length in [1e-12, 1e-7, 1e-5, 1e-3] {
            let bends =
                path(&[(30.0, 1.5), (length, 0.0), (30.0, 1.0), (length, 0.0), (40.0, -1.0)]);
            assert!(strip_overlap(&bends, 5.0, false).is_none(), "{length}");
        }
    }

    #[test]
    fn an_end_near_the_path_sticks_out() {
        // Around three corners, and then towards the first side: it ends 3 m from it.
        let corner = (1.5 * PI, 0.5 * PI);
        let sides = [(10.0, 0.0), corner, (10.0, 0.0), corner, (2.0, 0.0), corner, (10.0, 0.0)];
        let path = path(&sides);
        assert!(strip_overlap(&path, 2.0, false).is_none());
        assert!(round_ends_are_clear(&path, 0.9, 2.0));
        assert!(!round_ends_are_clear(&path, 1.1, 2.0));
    }

    #[test]
    fn kerbs_stop_where_the_road_crosses() {
        let quarter = (20.0, 0.5 * PI);
        let round = path(&[(30.0, 0.0), quarter, quarter, quarter, (30.0, 0.0)]);
        let index = PathIndex::new(&round);
        let clear = clear_stretches(&round, &index, [3.0, 3.2], 3.0, false);
        let length: f64 = clear.iter().map(|(from, to)| to - from).sum();
        // Six metres of each arm are covered by the other, and a little more by the kerb's width.
        assert!((round.length() - length - 12.8).abs() < 1.0, "{clear:?}");
        for (from, to) in clear {
            for i in 1..200 {
                let s = from + (to - from) * f64::from(i) / 200.0;
                let p = round.offset_curve(3.0, &[s])[0];
                assert!(index.locate(p).unwrap().offset.abs() > 3.0 - 1e-4);
            }
        }
    }

    proptest! {
        #[test]
        fn overlaps_are_those_of_the_normals(
            pieces in prop::collection::vec((8.0..60.0_f64, -1.5..1.5_f64, any::<bool>()), 1..9),
        ) {
            // Radii stay over 4.2 m, so that the wider strip's normals meet only where it overlaps.
            let pieces: Vec<(f64, f64)> = pieces
                .into_iter()
                .map(|(length, angle, straight)| (length, if straight { 0.0 } else { angle }))
                .filter(|(length, angle)| angle.abs() * 5.0 < *length)
                .chain([(10.0, 0.0)])
                .collect();
            let path = path(&pieces);
            let half = 3.0;
            if strip_overlap(&path, half, false).is_some() {
                prop_assert!(normals_meet(&path, half + 0.6, 0.5), "no normals meet");
            } else {
                prop_assert!(!normals_meet(&path, half - 1e-6, 1.0), "normals meet");
            }
        }

        #[test]
        fn clothoids_overlap_like_their_arcs(scale in 0.5..2.0_f64, half in 1.0..4.0_f64) {
            // A loop of clothoids: out, around and back over the start.
            let mut pose = Pose::default();
            let mut curves = Vec::new();
            for (length, from, to) in [
                (40.0, 0.0, 0.0), (30.0, 0.0, 0.1), (20.0, 0.1, 0.1), (30.0, 0.1, 0.0), (60.0, 0.0, 0.0),
            ] {
                let (length, from, to) = (length * scale, from / scale, to / scale);
                let curve =
                    Curve { start: pose, length, start_curvature: from, end_curvature: to };
                pose = curve.end();
                curves.push(curve);
            }
            let path = Path::new(curves);
            let found = strip_overlap(&path, half, false).is_some();
            if found {
                prop_assert!(normals_meet(&path, half + 0.6, 0.5));
            } else {
                prop_assert!(!normals_meet(&path, half - 1e-4, 0.5));
            }
        }
    }
}
