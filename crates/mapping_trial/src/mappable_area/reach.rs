//! Where a robot's centre can go: a flood fill over sixteen points per cell.

use glam::DVec2;

use super::frame::{SCORE_CELL, ScoreFrame};
use super::ground::DiscGround;
use envgen::distance::squared_distances;

/// Points along a side of a cell.
const POINTS: i32 = 4;

/// Distance in metres between neighbouring points. When the centre of a disc of the robot's radius
/// moves from one to the next, the disc comes nearer to a solid than it is at both by 0.5 mm at most.
/// Passages that are wider than the disc by this much are found.
const STEP: f64 = SCORE_CELL / POINTS as f64;

/// Greatest distance in metres of a point of a cell from the cell's centre.
const OFF_MIDDLE: f64 = 1.5 * STEP * std::f64::consts::SQRT_2;

/// The points of the right, left, upper and lower side of a cell. Bit 4 y + x is the point (x, y).
const RIGHT: u16 = 0x8888;
const LEFT: u16 = 0x1111;
const TOP: u16 = 0xf000;
const BOTTOM: u16 = 0x000f;

/// All points of a cell.
const ALL: u16 = u16::MAX;

/// The points of each cell where a disc's centre can be.
pub(super) struct Reach {
    frame: ScoreFrame,
    points: Vec<u16>,
}

impl Reach {
    /// Floods from a start for a disc of a given radius.
    pub(super) fn from_start(ground: &DiscGround, radius: f64, start: DVec2) -> Reach {
        let frame = ground.frame();
        let free = free_points(ground, radius);
        let mut reached = vec![0_u16; free.len()];
        let mut grown: Vec<usize> = Vec::new();
        // The start lies between points; these are the points near it to which the robot can move.
        for (cell, points) in around(frame, start, 1) {
            let near = each_point(points_of(frame, cell), |p| p.distance(start) <= 2.0 * STEP);
            reached[cell] = free[cell] & near & points;
            if reached[cell] != 0 {
                grown.push(cell);
            }
        }
        while let Some(cell) = grown.pop() {
            let points = spread(reached[cell], free[cell]);
            reached[cell] = points;
            for y in -1..=1 {
                for x in -1..=1 {
                    let Some(next) = frame.neighbour(cell, x, y).filter(|&next| next != cell)
                    else {
                        continue;
                    };
                    let new = spill(points, x, y) & free[next] & !reached[next];
                    if new != 0 {
                        reached[next] |= new;
                        grown.push(next);
                    }
                }
            }
        }
        Reach { frame, points: reached }
    }

    /// The open cells whose centre is covered by a disc with its centre at a reached point.
    pub(super) fn covered(&self, open: &[bool], radius: f64) -> Vec<bool> {
        let frame = self.frame;
        let reached: Vec<bool> = self.points.iter().map(|&points| points != 0).collect();
        let cells = ((radius + OFF_MIDDLE) / SCORE_CELL).floor();
        let near = squared_distances(frame.cols, &reached);
        let mut window: Vec<(i32, i32)> = Vec::new();
        let span = cells as i32;
        for y in -span..=span {
            window.extend((-span..=span).map(|x| (x, y)));
        }
        window.sort_by_key(|(x, y)| x * x + y * y);
        let within = ((radius + OFF_MIDDLE) / SCORE_CELL) * ((radius + OFF_MIDDLE) / SCORE_CELL);
        let covered = |cell: usize| {
            let middle = frame.centre(cell);
            window.iter().any(|&(x, y)| {
                frame.neighbour(cell, x, y).is_some_and(|other| {
                    let covers = |p: DVec2| p.distance_squared(middle) <= radius * radius;
                    self.points[other] != 0
                        && self.points[other] & each_point(points_of(frame, other), covers) != 0
                })
            })
        };
        (0..open.len())
            .map(|cell| {
                let candidate = open[cell] && f64::from(near[cell]) <= within;
                candidate && (reached[cell] || covered(cell))
            })
            .collect()
    }
}

/// The cells around a point, up to a number of cells away, each with all its points.
fn around(frame: ScoreFrame, p: DVec2, span: i32) -> impl Iterator<Item = (usize, u16)> {
    let cell = frame.cell_at(p);
    (-span..=span).flat_map(move |y| {
        (-span..=span).filter_map(move |x| Some((frame.neighbour(cell?, x, y)?, ALL)))
    })
}

/// The points of each cell where a disc touches no solid.
fn free_points(ground: &DiscGround, radius: f64) -> Vec<u16> {
    let frame = ground.frame();
    let sure = radius + OFF_MIDDLE;
    // A lower bound of the disc's clearance, which falls from cell to cell by at most the distance.
    let mut room = 0.0;
    (0..frame.len())
        .map(|cell| {
            room -= SCORE_CELL;
            if cell % frame.cols == 0 {
                room = 0.0;
            }
            if !ground.is_open(cell) {
                room = 0.0;
                return 0;
            }
            let middle = frame.centre(cell);
            if room < sure {
                room = ground.clearance(middle).min(ground.reach());
            }
            let free = if room >= sure {
                ALL
            } else if room < radius - OFF_MIDDLE {
                return 0;
            } else {
                each_point(points_of(frame, cell), |p| ground.clearance(p) >= radius)
            };
            let dry = || each_point(points_of(frame, cell), |p| ground.is_dry(p));
            if ground.is_dry_cell(cell) { free } else { free & dry() }
        })
        .collect()
}

/// The lower left point of a cell.
fn points_of(frame: ScoreFrame, cell: usize) -> DVec2 {
    frame.centre(cell) - DVec2::splat(1.5 * STEP)
}

/// The points of a cell for which `holds` is true.
fn each_point(corner: DVec2, holds: impl Fn(DVec2) -> bool) -> u16 {
    (0..POINTS * POINTS).fold(0, |points, i| {
        let at = DVec2::new(f64::from(i % POINTS), f64::from(i / POINTS));
        points | u16::from(holds(corner + at * STEP)) << i
    })
}

/// All points of a cell that are connected to some points by free ones.
fn spread(mut points: u16, free: u16) -> u16 {
    if free == ALL && points != 0 {
        return ALL;
    }
    loop {
        let across = points | (points & !RIGHT) << 1 | (points & !LEFT) >> 1;
        let next = (across | across << 4 | across >> 4) & free;
        if next == points {
            return points;
        }
        points = next;
    }
}

/// The points of a neighbouring cell that touch some points of a cell, across sides and corners.
fn spill(points: u16, x: i32, y: i32) -> u16 {
    let rows = match y {
        0 => points,
        1 => (points & TOP) >> 12,
        _ => (points & BOTTOM) << 12,
    };
    // Along the side that the cells share, a point touches three others.
    match (x, y) {
        (0, 0) => points,
        (0, _) => rows | (rows & !RIGHT) << 1 | (rows & !LEFT) >> 1,
        (1, 0) => upright((points & RIGHT) >> 3),
        (_, 0) => upright((points & LEFT) << 3),
        (1, _) => (rows & RIGHT) >> 3,
        _ => (rows & LEFT) << 3,
    }
}

fn upright(points: u16) -> u16 {
    points | points << 4 | points >> 4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_spill_to_their_neighbours() {
        // Every point of a cell, and every neighbouring cell, by coordinates.
        for point in 0..16 {
            for (x, y) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)] {
                let found = spill(1 << point, x, y);
                for other in 0..16 {
                    let dx: i32 = 4 * x + other % 4 - point % 4;
                    let dy: i32 = 4 * y + other / 4 - point / 4;
                    let touches = dx.abs() <= 1 && dy.abs() <= 1;
                    assert_eq!(found >> other & 1 == 1, touches, "{point} {x} {y} {other}");
                }
            }
        }
    }

    #[test]
    fn points_spread_over_what_is_free() {
        // A path around a corner, and a point without connection.
        let free = 0b1000_0000_0111_0001_u16;
        assert_eq!(spread(1, free), 0b0000_0000_0111_0001);
        assert_eq!(spread(1 << 6, free), 0b0000_0000_0111_0001);
        assert_eq!(spread(1 << 15, free), 1 << 15);
        assert_eq!(spread(4, ALL), ALL);
    }
}
