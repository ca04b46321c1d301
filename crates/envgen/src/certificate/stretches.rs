//! Stretches of a line inside a polygon. The pieces of a polygon are only its sides, and inside an area two of them
//! may be connected by the polygon's interior alone.

use glam::DVec2;

use crate::geometry::edges;

/// Where a stretch ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// At a side of the polygon, by its number.
    Side(usize),
    /// Below the line's lower end.
    Low,
    /// Above the line's upper end.
    High,
}

/// Returns the lower and the upper end of every stretch of the line at `x` from `low` to `high` that is inside a
/// polygon.
pub(super) fn stretches(vertices: &[DVec2], x: f64, [low, high]: [f64; 2]) -> Vec<[End; 2]> {
    let sides = edges(vertices).enumerate();
    let crossing = sides.filter(|(_, (a, b))| (a.x <= x) != (b.x <= x));
    let mut crossing: Vec<(f64, usize)> = crossing
        .map(|(side, (a, b))| (a.y + (b.y - a.y) * ((x - a.x) / (b.x - a.x)), side))
        .collect();
    crossing.sort_by(|a, b| a.0.total_cmp(&b.0));
    let end = |(y, side): (f64, usize)| match y {
        y if y < low => End::Low,
        y if y > high => End::High,
        _ => End::Side(side),
    };
    let pairs = crossing.chunks_exact(2);
    let inside = pairs.filter(|pair| pair[1].0 >= low && pair[0].0 <= high);
    inside.map(|pair| [end(pair[0]), end(pair[1])]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_end_at_sides_and_at_the_ends_of_the_line() {
        let corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 6.0), (2.0, 3.0), (0.0, 6.0)];
        let polygon: Vec<DVec2> = corners.map(|(x, y)| DVec2::new(x, y)).into();
        let side = End::Side;
        for (x, line, expected) in [
            (1.0, [-1.0, 9.0], vec![[side(0), side(3)]]),
            (1.0, [1.0, 2.0], vec![[End::Low, End::High]]),
            (3.0, [1.0, 9.0], vec![[End::Low, side(2)]]),
            (3.0, [5.0, 9.0], vec![]),
            (5.0, [0.0, 9.0], vec![]),
        ] {
            assert_eq!(stretches(&polygon, x, line), expected, "{x} {line:?}");
        }
        // Two arms.
        let fork = [(0.0, 0.0), (4.0, 0.0), (1.0, 1.0), (4.0, 2.0), (0.0, 2.0)];
        let fork: Vec<DVec2> = fork.map(|(x, y)| DVec2::new(x, y)).into();
        let found = stretches(&fork, 2.0, [-1.0, 3.0]);
        assert_eq!(found, [[side(0), side(1)], [side(2), side(3)]]);
    }
}
