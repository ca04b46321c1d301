//! Converts the shapes of parts to shapes of rapier.

use bevy::prelude::*;
use bevy_rapier2d::geometry::Collider;
use bevy_rapier2d::parry::transformation::hertel_mehlhorn;
use bevy_rapier2d::rapier::math::Pose;
use bevy_rapier2d::rapier::prelude::SharedShape;

use crate::shape::PartShape;
use crate::tessellate::triangles;

/// A convex shape and its pose.
pub(crate) type Piece = (Pose, SharedShape);

/// The largest fraction of the area of a polygon that its convex pieces may lose by rounding.
const AREA_TOLERANCE: f64 = 1e-3;

/// The largest absolute cosine of an angle that counts as a right angle.
const RIGHT_ANGLE: f32 = 1e-5;

/// Returns the collider of a single part, in the frame of the part, or `None` for parts without an extent.
pub(crate) fn collider(shape: &PartShape) -> Option<Collider> {
    let mut pieces = Vec::new();
    append_pieces(&mut pieces, Pose::IDENTITY, shape);
    match pieces.len() {
        0 => None,
        1 if pieces[0].0 == Pose::IDENTITY => pieces.pop().map(|(_, shape)| shape.into()),
        _ => Some(SharedShape::compound(pieces).into()),
    }
}

/// Returns one collider for many parts, or `None` if none of them has an extent.
pub(crate) fn merged<'a>(
    parts: impl Iterator<Item = (&'a Transform, &'a PartShape)>,
) -> Option<Collider> {
    let mut pieces = Vec::with_capacity(parts.size_hint().0);
    for (transform, shape) in parts {
        append_pieces(&mut pieces, pose(transform), shape);
    }
    (!pieces.is_empty()).then(|| SharedShape::compound(pieces).into())
}

fn pose(transform: &Transform) -> Pose {
    // The rotation is about z only. Twice the half-angle avoids an arc sine, which would lose digits.
    let angle = if transform.rotation == Quat::IDENTITY {
        0.0
    } else {
        2.0 * transform.rotation.z.atan2(transform.rotation.w)
    };
    Pose::new(transform.translation.truncate(), angle)
}

/// Appends the convex shapes that fill a part. They are exact: a concave polygon is split into convex pieces
/// with the same corners, and is not approximated.
fn append_pieces(pieces: &mut Vec<Piece>, at: Pose, shape: &PartShape) {
    match shape {
        PartShape::Point | PartShape::Strip { .. } => {}
        PartShape::Segment { half_length } => {
            let end = Vec2::X * *half_length;
            pieces.push((at, SharedShape::segment(-end, end)));
        }
        PartShape::Disc { radius } => pieces.push((at, SharedShape::ball(*radius))),
        PartShape::Box { half_size } => {
            pieces.push((at, SharedShape::cuboid(half_size.x, half_size.y)));
        }
        PartShape::Polygon { vertices } => {
            let inner = polygon(vertices).unwrap_or_else(|| outline(vertices));
            pieces.extend(inner.into_iter().map(|(pose, shape)| (at * pose, shape)));
        }
    }
}

/// Returns the shapes that fill a polygon, or `None` if too little of its area remains in single precision.
///
/// Only rectangles and triangles are used, since parry computes the distances of rays to other convex
/// polygons by iteration, with errors of centimetres.
fn polygon(vertices: &[Vec2]) -> Option<Vec<Piece>> {
    let area = |vertices: &[Vec2]| {
        let corners: Vec<_> = vertices.iter().map(|v| v.as_dvec2()).collect();
        envgen::geometry::signed_area(&corners)
    };
    let convex = if is_convex(vertices) {
        vec![vertices.to_vec()]
    } else {
        hertel_mehlhorn(vertices, &triangles(vertices))
    };
    let all = area(vertices);
    let filled: f64 = convex.iter().map(|piece| area(piece)).sum();
    if convex.is_empty() || (filled - all).abs() > AREA_TOLERANCE * all {
        return None;
    }
    let mut pieces = Vec::with_capacity(convex.len());
    for piece in convex {
        if let Some(rectangle) = rectangle(&piece) {
            pieces.push(rectangle);
        } else {
            let fan = piece.windows(2).skip(1);
            let triangle = |side: &[Vec2]| SharedShape::triangle(piece[0], side[0], side[1]);
            pieces.extend(fan.map(|side| (Pose::IDENTITY, triangle(side))));
        }
    }
    Some(pieces)
}

/// Returns a polygon with four right angles as a cuboid.
fn rectangle(vertices: &[Vec2]) -> Option<Piece> {
    let &[a, b, c, d] = vertices else { return None };
    let (along, up) = (b - a, d - a);
    let (width, height) = (along.length(), up.length());
    let closed = c.distance(b + up) <= RIGHT_ANGLE * width.min(height);
    if !(closed && along.dot(up).abs() <= RIGHT_ANGLE * width * height) {
        return None;
    }
    let pose = Pose::new(0.25 * (a + b + c + d), along.y.atan2(along.x));
    Some((pose, SharedShape::cuboid(0.5 * width, 0.5 * height)))
}

/// Returns the sides of a polygon that is too thin to fill.
fn outline(vertices: &[Vec2]) -> Vec<Piece> {
    let ends = vertices.iter().copied().cycle().skip(1);
    let sides = vertices.iter().zip(ends);
    sides.map(|(&a, b)| (Pose::IDENTITY, SharedShape::segment(a, b))).collect()
}

fn is_convex(vertices: &[Vec2]) -> bool {
    let n = vertices.len();
    (0..n).all(|i| {
        let [a, b, c] = [0, 1, 2].map(|k| vertices[(i + k) % n].as_dvec2());
        (b - a).perp_dot(c - b) > 0.0
    }) && n >= 3
}

#[cfg(test)]
mod tests {
    use super::*;
    use envgen::geometry::Shape;
    use envgen::glam::DVec2;
    use proptest::prelude::*;

    fn u_shape(width: f32, depth: f32, wall: f32) -> Vec<Vec2> {
        let p = Vec2::new;
        vec![
            p(0.0, 0.0),
            p(width, 0.0),
            p(width, depth),
            p(width - wall, depth),
            p(width - wall, wall),
            p(wall, wall),
            p(wall, depth),
            p(0.0, depth),
        ]
    }

    proptest! {
        #[test]
        fn a_concave_polygon_holds_the_points_that_the_world_says(
            width in 1.0..20.0_f32, depth in 1.0..20.0_f32, share in 0.05..0.45_f32,
            x in -0.1..1.1_f32, y in -0.1..1.1_f32,
        ) {
            let wall = share * width.min(depth);
            let vertices = u_shape(width, depth, wall);
            let shape = Shape::Polygon { vertices: vertices.iter().map(|v| v.as_dvec2()).collect() };
            let p = Vec2::new(x * width, y * depth);
            // Points on the border itself are left out, since rounding decides there.
            let edges = envgen::geometry::edges(&shape.corners())
                .map(|(a, b)| envgen::geometry::distance_to_segment(p.as_dvec2(), a, b))
                .fold(f64::INFINITY, f64::min);
            prop_assume!(edges > 1e-3);
            let collider = collider(&PartShape::Polygon { vertices }).unwrap();
            prop_assert_eq!(collider.contains_local_point(p), shape.contains(p.as_dvec2()));
        }
    }

    fn corners_of(shape: &PartShape) -> Vec<Vec2> {
        match shape {
            PartShape::Polygon { vertices } => vertices.clone(),
            _ => Vec::new(),
        }
    }

    #[test]
    fn every_shape_has_its_collider() {
        let place = |shape: &Shape| crate::shape::LocalFrame::new(DVec2::ZERO).place(shape).1;
        let disc = Shape::Disc { center: DVec2::ONE, radius: 0.5 };
        assert!(collider(&place(&disc)).unwrap().as_ball().is_some());
        let turned = Shape::Box { center: DVec2::ONE, half_size: DVec2::ONE, heading: 0.4 };
        assert!(collider(&place(&turned)).unwrap().as_cuboid().is_some());
        let line = Shape::Segment { a: DVec2::ZERO, b: DVec2::ONE };
        assert!(collider(&place(&line)).unwrap().as_segment().is_some());
        let rectangle = Shape::Polygon { vertices: turned.corners() };
        let pieces = polygon(&corners_of(&place(&rectangle))).unwrap();
        assert_eq!(pieces.len(), 1);
        assert!(pieces[0].1.as_cuboid().is_some());
        let kite = [Vec2::NEG_Y, Vec2::X * 2.0, Vec2::Y, Vec2::NEG_X];
        assert_eq!(polygon(&kite).unwrap().len(), 2);
        assert!(collider(&PartShape::Point).is_none());
    }

    #[test]
    fn a_polygon_too_thin_to_fill_keeps_its_sides() {
        let vertices = vec![Vec2::ZERO, Vec2::X, Vec2::new(2.0, 0.0)];
        let collider = collider(&PartShape::Polygon { vertices }).unwrap();
        let hit = collider.cast_local_ray(Vec2::new(1.5, 1.0), Vec2::NEG_Y, 2.0, true);
        assert_eq!(hit, Some(1.0));
    }
}
