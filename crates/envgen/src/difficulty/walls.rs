//! Features of walls: how much wall a robot sees, and how it is structured.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::feature::features;
use super::space::Space;
use crate::geometry::{Shape, edges, unit_vector};
use crate::raycast::Raycaster;
use crate::world::World;

/// Distance between points of an outline in metres.
const SPACING: f64 = 0.2;

/// The greatest number of points of outlines. In larger worlds, points are farther apart.
const MAX_POINTS: f64 = 200_000.0;

/// Distance in metres from an outline at which a point of it looks for reachable ground.
const LIFT: f64 = 0.01;

/// Tangents of the angles to the normal in which a point looks.
const LOOKS: [f64; 5] = [0.0, -0.6, 0.6, -1.7, 1.7];

/// The greatest distance in metres at which a point looks for reachable ground.
const SIGHT: f64 = 8.0;

/// The greatest differences between outlines on one line: of their directions in radians, and of their distances
/// from the origin in metres.
const COLLINEAR: (f64, f64) = (1e-3, 0.01);

/// The least length in metres of a plain wall, which is a straight wall without anything in it.
const PLAIN: f64 = 2.0;

/// The length in metres below which a piece of wall is short.
const SHORT: f64 = 1.0;

features! {
    /// Features of walls, which are outlines of solids as seen from the ground that the robot reaches. A run is a
    /// straight piece without an opening, a corner, or an obstacle before it. Walls of several parts on one line
    /// are one run.
    pub struct Walls {
        /// Length of the walls that are seen.
        wall_length_m: f64, "m";
        /// The same per area of free ground.
        wall_length_per_area_per_m: f64, "1/m";
        /// Number of runs and of round obstacles under 1 m per area of free ground.
        short_walls_per_m2: f64, "1/m^2";
        /// Longest run by the laser's greatest range.
        longest_plain_run_over_range: f64, "";
        /// Sum of the runs of 2 m or more.
        plain_runs_m: f64, "m";
        /// Share of the walls that is in runs of 2 m or more; none without walls.
        plain_share: Option<f64>, "";
    }
}

impl Walls {
    pub(super) fn of(
        world: &World,
        space: &Space<'_>,
        rays: &Raycaster,
        ground_area: f64,
        max_range: f64,
    ) -> Self {
        let runs = runs(world, space, rays);
        // Not `sum`, which is -0 without any.
        let length = runs.iter().fold(0.0, |sum, run| sum + run.length);
        let straight = || runs.iter().filter(|run| run.is_straight).map(|run| run.length);
        let plain = straight().filter(|&length| length >= PLAIN).fold(0.0, |sum, run| sum + run);
        let short = runs.iter().filter(|run| run.length < SHORT).count();
        Walls {
            wall_length_m: length,
            wall_length_per_area_per_m: length / ground_area,
            short_walls_per_m2: short as f64 / ground_area,
            longest_plain_run_over_range: straight().fold(0.0, f64::max) / max_range,
            plain_runs_m: plain,
            plain_share: (length > 0.0).then(|| plain / length),
        }
    }
}

/// A piece of wall.
struct Run {
    length: f64,
    is_straight: bool,
}

/// A visible piece of an outline, on the line of its direction.
struct Seen {
    /// Direction of the outline in radians, with the visible side to its right.
    angle: f64,
    /// Distance of its line from the origin in metres.
    offset: f64,
    middle: DVec2,
    length: f64,
}

fn runs(world: &World, space: &Space<'_>, rays: &Raycaster) -> Vec<Run> {
    let sight = Sight { space, rays };
    let origin = world.bounds.min;
    let spacing = spacing(world);
    let (mut seen, mut runs) = (Vec::new(), Vec::new());
    for solid in world.solids() {
        let mut side = |a: DVec2, b: DVec2, both: bool| {
            let along = b - a;
            let length = along.length();
            let angle = direction_of(along);
            let count = (length / spacing).ceil().max(1.0);
            let right = -along.normalize_or_zero().perp();
            for i in 0..count as usize {
                let middle = a + along * ((i as f64 + 0.5) / count);
                let piece = |angle, normal: DVec2| {
                    let offset = normal.dot(middle - origin);
                    Seen { angle, offset, middle, length: length / count }
                };
                if sight.has(middle, right) {
                    seen.push(piece(angle, right));
                }
                if both && sight.has(middle, -right) {
                    seen.push(piece(direction_of(-along), -right));
                }
            }
        };
        match &*solid.shape {
            Shape::Segment { a, b } => side(*a, *b, true),
            Shape::Disc { center, radius } => {
                let around = TAU * radius;
                let count = (around / spacing).ceil().max(8.0);
                let piece = around / count;
                let length: f64 = (0..count as usize)
                    .map(|i| unit_vector(TAU * (i as f64 / count)))
                    .filter(|&normal| sight.has(*center + normal * *radius, normal))
                    .map(|_| piece)
                    .sum();
                if length > 0.0 {
                    runs.push(Run { length, is_straight: false });
                }
            }
            shape => edges(&shape.corners()).for_each(|(a, b)| side(a, b, false)),
        }
    }
    join(seen, spacing, &mut runs);
    runs
}

/// Returns the direction of a line in radians, such that directions that are equal up to rounding are near each other.
fn direction_of(along: DVec2) -> f64 {
    let angle = libm::atan2(along.y, along.x);
    if angle < COLLINEAR.0 - PI { angle + TAU } else { angle }
}

/// Returns the distance between points in metres, large enough that there are not too many points.
fn spacing(world: &World) -> f64 {
    let around: f64 = world
        .solids()
        .map(|solid| match &*solid.shape {
            Shape::Segment { a, b } => 2.0 * a.distance(*b),
            Shape::Disc { radius, .. } => TAU * radius,
            shape => edges(&shape.corners()).map(|(a, b)| a.distance(b)).sum(),
        })
        .sum();
    SPACING.max(around / MAX_POINTS)
}

/// Joins consecutive pieces on a line to runs.
fn join(mut seen: Vec<Seen>, spacing: f64, runs: &mut Vec<Run>) {
    seen.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    for parallel in seen.chunk_by_mut(grouped(|piece: &Seen| piece.angle, COLLINEAR.0)) {
        parallel.sort_by(|a, b| a.offset.total_cmp(&b.offset));
        for line in parallel.chunk_by_mut(grouped(|piece: &Seen| piece.offset, COLLINEAR.1)) {
            let direction = unit_vector(line[0].angle);
            let along = |piece: &Seen| direction.dot(piece.middle);
            line.sort_by(|a, b| along(a).total_cmp(&along(b)));
            let mut end = f64::NEG_INFINITY;
            for piece in line {
                let (from, to) =
                    (along(piece) - 0.5 * piece.length, along(piece) + 0.5 * piece.length);
                // A piece that is not seen because a corner is near does not end a run.
                match runs.last_mut() {
                    Some(run) if run.is_straight && from <= end + 0.5 * spacing => {
                        run.length += (to - end.max(from)).max(0.0);
                    }
                    _ => runs.push(Run { length: piece.length, is_straight: true }),
                }
                end = end.max(to);
            }
        }
    }
}

/// Returns a predicate that groups sorted values: those that differ from the first of their group by less than a
/// tolerance.
fn grouped<T>(value: impl Fn(&T) -> f64, tolerance: f64) -> impl FnMut(&T, &T) -> bool {
    let mut first = None;
    move |a, b| {
        let same = value(b) - *first.get_or_insert_with(|| value(a)) < tolerance;
        if !same {
            first = Some(value(b));
        }
        same
    }
}

struct Sight<'a> {
    space: &'a Space<'a>,
    rays: &'a Raycaster,
}

impl Sight<'_> {
    /// Whether ground that the robot's centre reaches is visible from a point of an outline, on the side of its
    /// normal.
    fn has(&self, point: DVec2, normal: DVec2) -> bool {
        let frame = self.space.frame;
        let eye = point + normal * LIFT;
        LOOKS.into_iter().any(|tangent| {
            let direction = (normal + normal.perp() * tangent).normalize_or_zero();
            let is_ground = |&step: &usize| {
                let p = eye + direction * (step as f64 * frame.cell_size);
                frame.index_at(p).is_some_and(|cell| self.space.reached[cell])
            };
            let Some(first) = (0..=(SIGHT / frame.cell_size) as usize).find(is_ground) else {
                return false;
            };
            // What is farther than the first ground, whatever rounding does, need not be looked for.
            let sight = SIGHT.min((first + 1) as f64 * frame.cell_size);
            let hit = self.rays.cast_along(eye, direction, sight);
            hit.is_none_or(|hit| first <= (hit.distance / frame.cell_size) as usize)
        })
    }
}
