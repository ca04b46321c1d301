//! The walls that a scan sees, and how well they hold the pose at which it was matched.

use envgen::geometry::Pose;
use glam::{DVec2, Vec2};

use super::likelihood::LikelihoodField;
use super::track::Variance;

/// Standard deviation in metres that an echo's distance from its wall is assumed to have.
const WALL_DEVIATION: f64 = 0.1;

/// Variance of an echo's distance from its wall.
pub(crate) const WALL_VARIANCE: f64 = WALL_DEVIATION * WALL_DEVIATION;

/// Greatest distance in metres between neighbouring echoes that count as one wall.
pub(super) const WALL_GAP: f32 = 0.5;

/// Least length in metres of a wall whose direction is measured: ten times the noise of a range.
const WALL_LENGTH: f32 = 0.3;

/// Likelihood of an echo, in 1/255, from which it counts as matched to its wall.
const FOUND: u8 = 77;

/// A piece of wall as seen from a pose: a point and the unit normal there.
pub(crate) type WallPiece = (DVec2, DVec2);

/// Returns the walls that hold a matched scan: for each echo where earlier echoes were, the wall from
/// there to the next echo that is far enough for noise not to matter. An echo of something new has no
/// information on the pose.
pub(crate) fn walls(field: &LikelihoodField, pose: Pose, echoes: &[Vec2]) -> Vec<WallPiece> {
    let on_map = pose.local_to_world();
    let mut end = 0;
    let mut pieces = Vec::with_capacity(echoes.len());
    for (i, &a) in echoes.iter().enumerate() {
        end = end.max(i);
        let b = loop {
            if echoes[end].distance(a) >= WALL_LENGTH {
                break Some(echoes[end]);
            }
            match echoes.get(end + 1) {
                Some(next) if next.distance(echoes[end]) <= WALL_GAP => end += 1,
                _ => break None,
            }
        };
        let Some(b) = b else { continue };
        let (a, b) = (a.as_dvec2(), b.as_dvec2());
        if field.at(on_map(a)) >= FOUND {
            pieces.push((a, (b - a).normalize().perp()));
        }
    }
    pieces
}

/// Returns the variance of a step after a match: the echoes hold the pose across their walls, not along
/// them.
pub(crate) fn constrained(motion: Variance, walls: &[WallPiece]) -> Variance {
    let (mut xx, mut xy, mut yy, mut turn) = (0.0, 0.0, 0.0, 0.0);
    for (point, normal) in walls {
        xx += normal.x * normal.x;
        xy += normal.x * normal.y;
        yy += normal.y * normal.y;
        let lever = normal.dot(point.perp());
        turn += lever * lever;
    }
    let middle: f64 = 0.5 * (xx + yy);
    let worst = middle - (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
    let left =
        |variance: f64, weight: f64| variance / (1.0 + variance * weight.max(0.0) / WALL_VARIANCE);
    Variance { position: left(motion.position, worst), heading: left(motion.heading, turn) }
}
