//! The bends of roads.

use glam::DVec2;

use super::budget::Doubt;
use crate::geometry::{Pose, wrap_angle};
use crate::world::RoadStrip;

/// Points of a road that are farther apart than this, in radii, do not show its bends.
const FAR: f64 = 0.5;

/// Points of a road that are this near to each other, as a share of their coordinates, count as one.
const SAME: f64 = 1e-6;

/// Whether no bend of a road is tighter than a radius, by the curvatures that the road states and by points of its
/// centreline. If the curvature does not exceed 1 / radius and the heading changes by an angle under pi, the
/// chord is at least 2 radius sin(angle / 2).
pub(super) fn bends_keep(strip: &RoadStrip, radius: f64, points: &mut u64) -> Result<bool, Doubt> {
    let path = strip.path();
    let stated = strip.centreline.iter().map(|point| point.curvature.abs());
    let mut stated = stated.chain(path.curves().iter().map(|curve| curve.max_curvature()));
    if !stated.all(|curvature| curvature * radius <= 1.0 + 1e-9) {
        return Ok(false);
    }
    if radius == 0.0 {
        return Ok(true);
    }
    if strip.pieces.is_empty() {
        return Ok(corners_keep(strip, radius));
    }
    let parts = (path.length() / (0.5 * radius)).ceil().max(1.0);
    *points = points.checked_sub(parts as u64).ok_or(Doubt::BendPoints)?;
    let mut walk = path.walk();
    let start = path.pose_at(0.0);
    let mut before = start;
    let mut is_wide = |pose: Pose, rounding: f64| {
        let angle = wrap_angle(pose.heading - before.heading).abs();
        let chord = pose.position.distance(before.position);
        let slack = 1e-9 * (1.0 + pose.position.length());
        before = pose;
        // Twice a huge radius is infinite.
        libm::sin(0.5 * angle) <= (chord + slack) / (2.0 * radius) + rounding
    };
    let along = |i: u64| is_wide(walk.to(path.length() * (i as f64 / parts)).0, 0.0);
    // A circuit that closes but for rounding has no length there in which it could turn.
    Ok((1..=parts as u64).all(along) && (!strip.closed || is_wide(start, 1e-9)))
}

/// Whether a road of which only points are known has no sharper corners than points of a road without a tighter bend.
/// Between two points, such a road turns by at most twice the arcsine of half their distance over the radius, and at
/// either of them it deviates from their chord by at most half of that. Points count as at most [`FAR`] apart.
fn corners_keep(strip: &RoadStrip, radius: f64) -> bool {
    let mut points: Vec<DVec2> = strip.centreline.iter().map(|point| point.pose.position).collect();
    if strip.closed {
        points.extend_from_within(..points.len().min(2));
    }
    // Points that are the same but for rounding have no direction between them.
    points.dedup_by(|b, a| a.distance(*b) <= SAME * (1.0 + a.length()));
    points.windows(3).all(|corner| {
        let (before, after) = (corner[1] - corner[0], corner[2] - corner[1]);
        let angle = libm::atan2(before.perp_dot(after), before.dot(after)).abs();
        let most = |leg: DVec2| libm::asin((leg.length() / radius).min(FAR) / 2.0);
        let slack = 1e-9 * (1.0 + corner[1].length()) / before.length().min(after.length());
        angle <= most(before) + most(after) + slack
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::{Claim, Verdict, verify};
    use crate::curve::Curve;
    use crate::generate::{Blueprint, Spec};
    use crate::road::{Prefab, RoadSpec};
    use crate::seed::Seed;
    use crate::world::{RoadPoint, World};

    #[test]
    fn roads_are_measured_at_a_limited_number_of_points() {
        let mut world = RoadSpec::default().generate(Seed(1)).unwrap().to_world();
        for (radius, expected) in [
            (0.0, Verdict::Holds),
            (1e-9, Verdict::Undecided(Doubt::BendPoints)),
            (1e9, Verdict::Broken),
        ] {
            world.certificate = vec![Claim::BendRadius { radius }];
            assert_eq!(verify(&world)[0].1, expected);
        }
    }

    /// A world with a road of which only points are known.
    fn road(points: &[DVec2], closed: bool) -> World {
        let mut world = RoadSpec::default().generate(Seed(1)).unwrap().to_world();
        let strip = &mut world.road_strips[0];
        let point = |&position| RoadPoint { pose: Pose { position, heading: 0.0 }, curvature: 0.0 };
        strip.centreline = points.iter().map(point).collect();
        strip.pieces.clear();
        strip.closed = closed;
        world
    }

    #[test]
    fn corners_between_points_are_bends() {
        let claim = |radius| Claim::BendRadius { radius };
        let keeps = |world: &World, radius| {
            let mut world = world.clone();
            world.certificate = vec![claim(radius)];
            verify(&world)[0].1 == Verdict::Holds
        };
        let zigzag: Vec<DVec2> =
            (0..40).map(|i| DVec2::new(f64::from((i + 1) / 2), f64::from(i / 2)) * 2.5).collect();
        assert!(!keeps(&road(&zigzag, false), 10.0));
        let bent = [DVec2::ZERO, DVec2::new(50.0, 0.0), DVec2::new(94.0, 23.5)];
        assert!(!keeps(&road(&bent, false), 500.0) && keeps(&road(&bent, false), 90.0));
        let sharp = [DVec2::ZERO, DVec2::new(50.0, 0.0), DVec2::new(50.0, 50.0)];
        assert!(!keeps(&road(&sharp, false), 10.0));
        // A side that is next to nothing hides no corner.
        let hidden = [sharp[0], sharp[1], sharp[1] + DVec2::splat(1e-9), sharp[2]];
        assert!(!keeps(&road(&hidden, false), 10.0));
        // Points of a circle, whatever their distances.
        for count in [15, 60, 1000] {
            let at = |i: i32| {
                let turn = std::f64::consts::TAU * f64::from(i) / f64::from(count);
                20.0 * crate::geometry::unit_vector(
                    turn + 0.3 / f64::from(count) * f64::from(i % 3),
                )
            };
            let circle: Vec<DVec2> = (0..count).map(at).collect();
            for closed in [true, false] {
                let road = road(&circle, closed);
                assert!(keeps(&road, 20.0) && !keeps(&road, 21.0), "{count} points");
            }
        }
    }

    #[test]
    fn the_place_where_a_circuit_closes_is_a_bend() {
        let keeps = |mut world: World| {
            world.certificate = vec![Claim::BendRadius { radius: 10.0 }];
            verify(&world)[0].1 == Verdict::Holds
        };
        // A drop: two lines that meet in a corner, and the arc around their other ends.
        let drop = |closed| {
            let mut world = road(&[], closed);
            let start = Pose { position: DVec2::ZERO, heading: -0.5 };
            let line = Curve::line(start, 50.0);
            let radius = 50.0 * libm::tan(0.5);
            let arc = Curve::arc(line.end(), radius * (std::f64::consts::PI + 1.0), radius.recip());
            let back = Curve::line(arc.end(), 50.0);
            assert!(back.end().position.length() < 1e-9);
            world.road_strips[0].pieces = vec![line, arc, back];
            world
        };
        assert!(keeps(drop(false)) && !keeps(drop(true)));
        for transition in [0.0, 0.3] {
            let prefabs = [Prefab::Straight, Prefab::Left].repeat(4);
            let spec =
                RoadSpec { prefabs, closed: true, speed: 10.0, transition, ..Default::default() };
            for seed in 0..5 {
                let world = spec.generate(Seed(seed)).unwrap().to_world();
                let verdicts: Vec<Verdict> =
                    verify(&world).into_iter().map(|(_, verdict)| verdict).collect();
                assert_eq!(verdicts, [Verdict::Holds; 2], "seed {seed}");
            }
        }
    }

    #[test]
    fn points_of_generated_roads_keep_their_promises_alone() {
        for seed in 0..20 {
            let spec = RoadSpec { transition: 0.02 * seed as f64, ..Default::default() };
            let mut world = spec.generate(Seed(seed)).unwrap().to_world();
            world.road_strips.iter_mut().for_each(|strip| strip.pieces.clear());
            for (claim, verdict) in verify(&world) {
                if matches!(claim, Claim::BendRadius { .. }) {
                    assert_eq!(verdict, Verdict::Holds, "seed {seed}");
                }
            }
        }
    }
}
