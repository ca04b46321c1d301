//! Builds the world of a road.

use super::blueprint::Road;
use crate::curve::Path;
use crate::curve::overlap::{clear_stretches, round_ends_are_clear, strip_overlap};
use crate::generate::Spec;
use crate::geometry::{Pose, Rect, Shape};
use crate::world::{Claim, Extent, KERB, RoadPoint, RoadStrip, Wall, WallKind, World};

/// The greatest deviation, in metres, of the faces of the kerbs from the road's edge: on the outer side of a bend
/// into the road, on the inner side away from it.
pub const KERB_TOLERANCE: f64 = 0.01;

pub(super) fn world(road: &Road) -> World {
    let spec = road.spec();
    let half = 0.5 * spec.width;
    let path = road.path();
    let mut centreline = road.waypoints().to_vec();
    if !spec.closed {
        let curvature = path.curves().last().map_or(0.0, |curve| curve.end_curvature);
        centreline.push(RoadPoint { pose: road.end(), curvature });
    }
    let strip = RoadStrip {
        centreline,
        pieces: path.curves().to_vec(),
        width: spec.width,
        lanes: spec.lanes as u32,
        closed: spec.closed,
    };
    let walls = kerbs(road);

    let stations = path.stations(half, KERB_TOLERANCE);
    let edges = [half, -half].map(|offset| path.offset_curve(offset, &stations));
    let around = Rect::around(edges.into_iter().flatten())
        .into_iter()
        .map(|rect| rect.grown(KERB_TOLERANCE))
        .chain(walls.iter().map(|wall| wall.shape.bounds()))
        .reduce(Rect::union);
    let bounds = around.unwrap_or(Rect::new(glam::DVec2::ZERO, glam::DVec2::ONE));
    let mut provenance = spec.provenance(road.seed());
    provenance.edited = road.edited();
    let mut world = World::new(provenance, bounds);
    world.start = Some(spec.start());
    world.goal = Some(goal(road));
    world.walls = walls;
    world.road_strips = vec![strip];
    world.certificate = promises(road);
    world
}

/// Returns the claims of the road's certificate.
fn promises(road: &Road) -> Vec<Claim> {
    let mut claims = vec![Claim::Connected { radius: 0.4 * road.spec().width }];
    let radii = road.segments().iter().filter_map(|segment| segment.radius);
    claims.extend(radii.reduce(f64::min).map(|radius| Claim::BendRadius { radius }));
    claims
}

/// Returns the pose that a robot should reach: the end, or on a circuit the last waypoint of the lap.
fn goal(road: &Road) -> Pose {
    if road.spec().closed {
        road.waypoints().last().map_or(road.end(), |point| point.pose)
    } else {
        road.end()
    }
}

/// Returns the kerbs along both edges, except where they would lie on another part of the road.
fn kerbs(road: &Road) -> Vec<Wall> {
    let spec = road.spec();
    let (half, kerb) = (0.5 * spec.width, spec.kerb);
    if kerb == 0.0 {
        return Vec::new();
    }
    let path = road.path();
    let height = Extent::unless_usual(KERB, spec.kerb_height);
    let free = strip_overlap(path, half + kerb, spec.closed).is_none()
        && (spec.closed || round_ends_are_clear(path, half, half + kerb));
    let mut walls = Vec::new();
    for side in [1.0, -1.0] {
        let stretches = if free {
            vec![(0.0, path.length())]
        } else {
            // What passes between two of these lines, such as a round end, is in the kerb by 1.6 % of the road's width.
            let gaps = (4.0 * kerb / spec.width).ceil();
            let lines = (0..=gaps as u32).map(|i| side * (half + kerb * (f64::from(i) / gaps)));
            clear_stretches(path, road.index(), lines, half, spec.closed)
        };
        for stretch in stretches {
            let shapes = kerb_along(path, side, half, kerb, stretch);
            walls.extend(shapes.map(|shape| Wall { height, ..Wall::new(WallKind::Kerb, shape) }));
        }
    }
    walls
}

/// Returns a kerb along one edge (1 for the left, -1 for the right) between two distances along the road, in pieces as
/// long as the tolerance allows, which join without a gap.
fn kerb_along(
    path: &Path<'_>,
    side: f64,
    half: f64,
    kerb: f64,
    (from, to): (f64, f64),
) -> impl Iterator<Item = Shape> {
    let stations = path.stations_between(from, to, half + kerb, KERB_TOLERANCE);
    let face = path.offset_curve(side * half, &stations);
    let back = path.offset_curve(side * (half + kerb), &stations);
    (1..stations.len()).filter(move |&i| stations[i] - stations[i - 1] > SHORTEST).map(move |i| {
        let (a, b) = if side > 0.0 { (i - 1, i) } else { (i, i - 1) };
        Shape::Polygon { vertices: vec![face[a], face[b], back[b], back[a]] }
    })
}

/// A kerb that is shorter than this, in metres, is due to rounding.
const SHORTEST: f64 = 1e-6;
