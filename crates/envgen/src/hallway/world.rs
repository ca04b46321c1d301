//! Builds the world of a hallway from its layout.

use glam::DVec2;

use super::blueprint::Hallway;
use super::feature::{self, Feature, FeatureKind, Side};
use super::layout::{Corner, HallwayLayout};
use super::spec::{Ends, HallwaySpec};
use crate::generate::Spec;
use crate::geometry::{Rect, Shape, signed_area};
use crate::world::{Claim, Extent, Obstacle, ObstacleKind, WALL, Wall, WallKind, World};

/// Runs that are shorter than this, in metres, are due to rounding; the walls beside them meet without a run.
const SHORTEST_RUN: f64 = 1e-9;

pub(super) fn world(hallway: &Hallway) -> World {
    let spec = hallway.spec();
    let layout = hallway.layout();
    let features = feature::place(hallway, &layout).features;

    let mut walls = Vec::new();
    for side in [Side::Left, Side::Right] {
        side_walls(&layout, spec, side, &features, &mut walls);
    }
    if spec.ends == Ends::Closed {
        let (first, last) = (layout.legs[0], layout.legs[layout.legs.len() - 1]);
        for (end, outward) in [(first.from, -first.direction), (last.to, last.direction)] {
            let across = outward.perp() * (0.5 * spec.width + spec.wall_thickness);
            let cap = block(end - across, end + across, outward, 0.0, spec.wall_thickness);
            walls.push(Wall::new(WallKind::EndCap, cap));
        }
    }
    let height = Extent::unless_usual(WALL, spec.wall_height);
    walls.iter_mut().for_each(|wall| wall.height = height);
    let obstacles: Vec<_> = features.iter().flat_map(|feature| obstacles(feature, spec)).collect();

    let around = Rect::around(layout.legs.iter().flat_map(|leg| [leg.from, leg.to]))
        .into_iter()
        .chain(walls.iter().map(|wall| wall.shape.bounds()))
        .reduce(Rect::union);
    let bounds = around.unwrap_or(Rect::new(DVec2::ZERO, DVec2::ONE));
    let mut world = World::new(spec.provenance(hallway.seed()), bounds);
    world.start = Some(layout.start());
    world.goal = Some(layout.goal());
    world.walls = walls;
    world.obstacles = obstacles;
    // Four fifths of what fits through the narrowest place, and between the ends and their caps.
    let ends = [layout.start(), layout.goal()].map(|pose| world.clearance(pose.position));
    let fits = ends.into_iter().fold(0.5 * narrowest(&features, spec), f64::min);
    world.certificate = vec![Claim::Connected { radius: 0.8 * fits }];
    world
}

/// Returns the least clear width of the corridor in metres: beside door frames and crates, and between two that
/// follow each other, where the path may lead from one side to the other.
fn narrowest(features: &[Feature], spec: &HallwaySpec) -> f64 {
    let in_the_way: Vec<_> = features.iter().filter(|f| f.kind != FeatureKind::Alcove).collect();
    let beside = in_the_way.iter().map(|feature| match feature.kind {
        FeatureKind::Alcove => spec.width,
        FeatureKind::DoorFrame => spec.door_frame_width,
        FeatureKind::Narrowing => spec.narrowing_width,
    });
    let between = in_the_way.windows(2).filter(|pair| pair[0].leg == pair[1].leg).map(|pair| {
        let apart = (pair[1].at - pair[0].at).dot(pair[0].direction).abs();
        // No feature is drawn nearer; rounding must not claim less.
        (apart - 0.5 * (pair[0].length + pair[1].length)).max(feature::passage(spec))
    });
    beside.chain(between).fold(spec.width, f64::min)
}

/// Adds all walls along one side: straight runs with gaps for alcoves, the alcoves, and the corners.
fn side_walls(
    layout: &HallwayLayout,
    spec: &HallwaySpec,
    side: Side,
    features: &[Feature],
    walls: &mut Vec<Wall>,
) {
    let offset = side.sign() * 0.5 * spec.width;
    let mut alcoves = features
        .iter()
        .filter(|feature| feature.kind == FeatureKind::Alcove && feature.side == side)
        .peekable();
    for (k, leg) in layout.legs.iter().enumerate() {
        let outward = leg.direction.perp() * side.sign();
        let (mut from, to) = layout.run(k, offset);
        let mut run = |from: DVec2, to: DVec2, extension: f64| {
            if (to - from).dot(leg.direction) > SHORTEST_RUN {
                let to = to + leg.direction * extension;
                let shape = block(from, to, outward, 0.0, spec.wall_thickness);
                walls.push(Wall::new(WallKind::Wall, shape));
            }
        };
        let mut recesses = Vec::new();
        while let Some(alcove) = alcoves.next_if(|alcove| alcove.leg == k) {
            let middle = alcove.at + outward * (0.5 * spec.width);
            let half = leg.direction * (0.5 * alcove.length);
            run(from, middle - half, 0.0);
            from = middle + half;
            recesses.push((middle - half, middle + half));
        }
        // The outer wall of a square corner is longer by its thickness, which fills the corner.
        let corner = layout.corner(k);
        let outer = corner.is_some_and(|corner| corner.turn * side.sign() < 0.0);
        let extension = if outer && layout.arc_radius == 0.0 { spec.wall_thickness } else { 0.0 };
        run(from, to, extension);
        for (a, b) in recesses {
            alcove_walls(a, b, outward, spec, walls);
        }
        if let Some(corner) = corner
            && layout.arc_radius > 0.0
        {
            arc_walls(&corner, offset, side, layout, spec, walls);
        }
    }
}

/// Adds the two sides and the back of an alcove that opens between `a` and `b`.
fn alcove_walls(a: DVec2, b: DVec2, outward: DVec2, spec: &HallwaySpec, walls: &mut Vec<Wall>) {
    let along = (b - a).normalize();
    let (depth, wall) = (spec.alcove_depth, spec.wall_thickness);
    let shapes = [
        block(a - along * wall, a, outward, 0.0, depth + wall),
        block(b, b + along * wall, outward, 0.0, depth + wall),
        block(a, b, outward, depth, depth + wall),
    ];
    walls.extend(shapes.map(|shape| Wall::new(WallKind::Alcove, shape)));
}

/// Adds the wall along a rounded corner, in convex pieces.
fn arc_walls(
    corner: &Corner,
    offset: f64,
    side: Side,
    layout: &HallwayLayout,
    spec: &HallwaySpec,
    walls: &mut Vec<Wall>,
) {
    let inner = corner.arc(corner.face_radius(offset), layout.arc_pieces);
    let outer = corner
        .arc(corner.face_radius(offset + side.sign() * spec.wall_thickness), layout.arc_pieces);
    for (face, back) in inner.windows(2).zip(outer.windows(2)) {
        let mut vertices = vec![face[0], face[1], back[1], back[0]];
        // Where the inner wall is thicker than its radius, the pieces meet in the arc's centre.
        vertices.dedup();
        if signed_area(&vertices) < 0.0 {
            vertices.reverse();
        }
        if signed_area(&vertices) > SHORTEST_RUN * SHORTEST_RUN && vertices.len() > 2 {
            walls.push(Wall::new(WallKind::Wall, Shape::Polygon { vertices }));
        }
    }
}

/// Returns the obstacles of a feature in the corridor: the posts of a door frame, or a crate.
fn obstacles(feature: &Feature, spec: &HallwaySpec) -> Vec<Obstacle> {
    let along = feature.direction * (0.5 * feature.length);
    let left = feature.direction.perp();
    let half = 0.5 * spec.width;
    let at_wall = |outward: DVec2, kind: ObstacleKind, clear_from_middle: f64| {
        let (from, to) = (feature.at - along, feature.at + along);
        Obstacle {
            height: kind.height_beside_walls(spec.wall_height),
            ..Obstacle::new(kind, block(from, to, outward, clear_from_middle, half))
        }
    };
    match feature.kind {
        FeatureKind::Alcove => Vec::new(),
        FeatureKind::DoorFrame => [left, -left]
            .map(|outward| at_wall(outward, ObstacleKind::DoorPost, 0.5 * spec.door_frame_width))
            .to_vec(),
        FeatureKind::Narrowing => {
            let outward = left * feature.side.sign();
            vec![at_wall(outward, ObstacleKind::Crate, spec.narrowing_width - half)]
        }
    }
}

/// Returns the axis-aligned box beside the line from `a` to `b` that extends from `near` to `far` metres in the
/// direction `outward`.
fn block(a: DVec2, b: DVec2, outward: DVec2, near: f64, far: f64) -> Shape {
    let (p, q) = (a + outward * near, b + outward * far);
    Shape::from_rect(Rect::new(p.min(q), p.max(q)))
}

#[cfg(test)]
mod tests {
    use std::borrow::Cow;

    use super::*;
    use crate::certificate::{Verdict, verify};
    use crate::generate::Blueprint;
    use crate::hallway::{Corners, Start, State};
    use crate::seed::Seed;
    use proptest::prelude::*;

    fn spec(p_tt: f64, fill: f64, corners: Corners) -> HallwaySpec {
        let rows = if p_tt > 0.0 { 1.0 } else { 2.0 };
        let width = fill * (rows * 2.5 - 0.1);
        HallwaySpec {
            p_tt,
            width,
            corners,
            alcove_rate: 0.1,
            door_frame_rate: 0.1,
            door_frame_width: 0.6 * width,
            narrowing_rate: 0.1,
            narrowing_width: 0.5 * width,
            ..Default::default()
        }
    }

    /// With its bounds, since a long hallway has hundreds of shapes.
    fn with_bounds(shape: Cow<'_, Shape>) -> (Rect, Cow<'_, Shape>) {
        (shape.bounds().grown(1e-6), shape)
    }

    proptest! {
        #[test]
        fn worlds_hold_their_invariants_and_the_centreline_is_free(
            seed: u64,
            start in 1..=8_u8,
            p_tt in prop_oneof![Just(0.0), 0.0..=1.0_f64],
            fill in 0.05..=1.0_f64,
            rounded: bool,
            open: bool,
        ) {
            let corners = if rounded { Corners::Rounded } else { Corners::Square };
            let spec = HallwaySpec {
                start: Start::State(State::new(start).unwrap()),
                ends: if open { Ends::Open } else { Ends::Closed },
                ..spec(p_tt, fill, corners)
            };
            let hallway = spec.generate(Seed(seed)).unwrap();
            let world = hallway.to_world();
            prop_assert_eq!(world.check(), Ok(()));
            let layout = hallway.layout();
            let walls = world.walls.iter().map(|wall| Cow::Borrowed(&wall.shape));
            let walls: Vec<_> = walls.map(with_bounds).collect();
            let solids: Vec<_> = world.solids().map(|solid| with_bounds(solid.shape)).collect();
            let is_free = |p: DVec2| {
                walls.iter().all(|(bounds, wall)| !(bounds.contains(p) && wall.contains(p)))
            };
            for pair in layout.centreline().windows(2).filter(|p| p[0].distance(p[1]) > 1e-9) {
                for i in 0..8 {
                    let p = pair[0].lerp(pair[1], f64::from(i) / 8.0 + 0.01);
                    prop_assert!(is_free(p), "{p} lies in a wall");
                }
            }
            // Just behind either face is a wall, except where an alcove opens.
            let solid = |p: DVec2| {
                solids.iter().any(|(bounds, s)| bounds.contains(p) && s.distance(p) < 1e-6)
            };
            let alcoves: Vec<Rect> = feature::place(&hallway, &layout)
                .features
                .iter()
                .filter(|feature| feature.kind == FeatureKind::Alcove)
                .map(|feature| feature.alcove_outline(&spec).grown(1e-9))
                .collect();
            for (k, _) in layout.legs.iter().enumerate() {
                for side in [0.5, -0.5] {
                    let (a, b) = layout.run(k, side * spec.width);
                    let outward = layout.legs[k].direction.perp() * side.signum();
                    for i in 0..20 {
                        let p = a.lerp(b, f64::from(i) / 20.0 + 0.025) + outward * 0.5 * spec.wall_thickness;
                        let is_closed = solid(p) || alcoves.iter().any(|alcove| alcove.contains(p));
                        prop_assert!(is_closed, "the wall has a hole at {p}");
                    }
                }
            }
        }
    }

    #[test]
    fn features_come_at_the_asked_rate() {
        // Straight hallways: every cell but the ends can hold a feature, so that the count is
        // binomial; 5 sigma, false-alarm rate under 1e-6.
        let spec = HallwaySpec {
            segments: 100_002,
            p_st: 0.0,
            door_frame_rate: 0.1,
            ..Default::default()
        };
        let world = spec.generate(Seed(3)).unwrap().to_world();
        let frames = world.obstacles.len() as f64 / 2.0;
        let sigma = (100_000.0 * 0.25 * 0.75_f64).sqrt();
        assert!((frames - 25_000.0).abs() < 5.0 * sigma, "{frames} door frames");
    }

    #[test]
    fn crates_that_stand_near_each_other_leave_what_is_promised() {
        // Rare door frames are narrow, so that crates may be near each other where there are no frames.
        let spec = HallwaySpec {
            segments: 41,
            door_frame_rate: 0.003,
            door_frame_width: 0.05,
            narrowing_rate: 0.11,
            narrowing_width: 1.0,
            ..Default::default()
        };
        let mut near = 0;
        for seed in 0..300 {
            let hallway = spec.generate(Seed(seed)).unwrap();
            let features = feature::place(&hallway, &hallway.layout()).features;
            let has_frame = features.iter().any(|f| f.kind == FeatureKind::DoorFrame);
            near += u32::from(!has_frame && narrowest(&features, &spec) < 1.0);
            for (claim, verdict) in verify(&hallway.to_world()) {
                assert_eq!(verdict, Verdict::Holds, "seed {seed}: {claim}");
            }
        }
        assert!(near > 0);
    }

    #[test]
    fn a_door_frame_leaves_its_width() {
        let spec = HallwaySpec { p_st: 0.0, door_frame_rate: 0.4, ..Default::default() };
        let world = spec.generate(Seed(1)).unwrap().to_world();
        for pair in world.obstacles.chunks(2) {
            let (a, b) = (pair[0].shape.bounds(), pair[1].shape.bounds());
            let gap = (a.min.x - b.max.x).max(b.min.x - a.max.x);
            assert!((gap - spec.door_frame_width).abs() < 1e-12);
        }
        assert!(world.obstacles.len() > 20);
    }
}
