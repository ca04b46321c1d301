//! Line segments.

use glam::DVec2;

use super::Rect;

/// Returns the point of the segment from `a` to `b` that is nearest to a point.
///
/// ```
/// use envgen::geometry::nearest_on_segment;
/// use envgen::glam::DVec2;
///
/// let (a, b) = (DVec2::ZERO, DVec2::new(4.0, 0.0));
/// assert_eq!(nearest_on_segment(DVec2::new(1.0, 2.0), a, b), DVec2::new(1.0, 0.0));
/// // Beyond an end, the end is nearest.
/// assert_eq!(nearest_on_segment(DVec2::new(7.0, 2.0), a, b), b);
/// ```
pub fn nearest_on_segment(p: DVec2, a: DVec2, b: DVec2) -> DVec2 {
    let along = b - a;
    let length2 = along.length_squared();
    let t = if length2 > 0.0 { ((p - a).dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    a + along * t
}

/// Returns the distance from a point to the segment from `a` to `b`.
///
/// ```
/// use envgen::geometry::distance_to_segment;
/// use envgen::glam::DVec2;
///
/// let (a, b) = (DVec2::ZERO, DVec2::new(4.0, 0.0));
/// assert_eq!(distance_to_segment(DVec2::new(1.0, 2.0), a, b), 2.0);
/// assert_eq!(distance_to_segment(DVec2::new(7.0, 4.0), a, b), 5.0);
/// ```
pub fn distance_to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    p.distance(nearest_on_segment(p, a, b))
}

/// Splits a segment into equal pieces of at most a given length.
pub(crate) fn split_segment(
    a: DVec2,
    b: DVec2,
    longest: f64,
) -> impl Iterator<Item = (DVec2, DVec2)> {
    let count = (a.distance(b) / longest).ceil().max(1.0);
    let at = move |k: usize| a.lerp(b, k as f64 / count);
    (0..count as usize).map(move |k| (at(k), at(k + 1)))
}

/// Returns whether two segments have a point in common; ends and overlaps count.
///
/// ```
/// use envgen::geometry::segments_cross;
/// use envgen::glam::DVec2;
///
/// let (a, b) = (DVec2::ZERO, DVec2::new(2.0, 2.0));
/// assert!(segments_cross(a, b, DVec2::new(0.0, 2.0), DVec2::new(2.0, 0.0)));
/// // Lines that only touch at an end share a point too; parallel ones beside each other do not.
/// assert!(segments_cross(a, b, b, DVec2::new(5.0, 0.0)));
/// assert!(!segments_cross(a, b, DVec2::X, DVec2::new(3.0, 2.0)));
/// ```
pub fn segments_cross(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| {
        let s = (q - p).perp_dot(r - p);
        if s > 0.0 {
            1
        } else if s < 0.0 {
            -1
        } else {
            0
        }
    };
    let within = |p: DVec2, q: DVec2, r: DVec2| Rect::new(p.min(q), p.max(q)).contains(r);
    // Rounding may put a distant piece of the same line on both sides of it, which is no crossing.
    if !Rect::new(a.min(b), a.max(b)).overlaps(Rect::new(c.min(d), c.max(d))) {
        return false;
    }
    let (s1, s2, s3, s4) = (side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b));
    (s1 != s2 && s3 != s4)
        || (s1 == 0 && within(a, b, c))
        || (s2 == 0 && within(a, b, d))
        || (s3 == 0 && within(c, d, a))
        || (s4 == 0 && within(c, d, b))
}

/// Returns the distance between two segments, which is 0 where they cross.
pub(crate) fn distance_between_segments(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> f64 {
    if segments_cross(a, b, c, d) {
        return 0.0;
    }
    // Otherwise an end of one of them is nearest to the other.
    [(a, c, d), (b, c, d), (c, a, b), (d, a, b)]
        .map(|(end, from, to)| distance_to_segment(end, from, to))
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossing_counts_ends_and_overlaps() {
        let v = DVec2::new;
        assert!(segments_cross(v(0., 0.), v(2., 2.), v(0., 2.), v(2., 0.)));
        assert!(segments_cross(v(0., 0.), v(2., 0.), v(2., 0.), v(3., 1.)));
        assert!(segments_cross(v(0., 0.), v(2., 0.), v(1., 0.), v(3., 0.)));
        assert!(!segments_cross(v(0., 0.), v(1., 0.), v(2., 0.), v(3., 0.)));
        assert!(!segments_cross(v(0., 0.), v(1., 0.), v(0., 1.), v(1., 1.)));
    }
}
