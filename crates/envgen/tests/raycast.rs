//! Rays against brute force and against the raster.

use std::f64::consts::FRAC_PI_2;

use envgen::forest::ForestSpec;
use envgen::geometry::{Pose, Rect, Shape, edges, unit_vector};
use envgen::glam::DVec2;
use envgen::hallway::{Corners, HallwaySpec};
use envgen::occupancy::{Coverage, OccupancyGrid};
use envgen::raycast::{Raycaster, ScanPattern};
use envgen::world::{Obstacle, ObstacleKind};
use envgen::{Blueprint, Provenance, Seed, Spec, World};
use proptest::prelude::*;

/// Range to one shape, by another method than the library's: sides by Cramer's rule, discs by the
/// quadratic formula, insides by `contains`.
fn range_to(shape: &Shape, from: DVec2, direction: DVec2) -> f64 {
    if shape.contains(from) {
        return 0.0;
    }
    if let Shape::Disc { center, radius } = shape {
        let f = from - *center;
        let (b, c) = (2.0 * f.dot(direction), f.length_squared() - radius * radius);
        let discriminant = b * b - 4.0 * c;
        let near = (-b - discriminant.sqrt()) / 2.0;
        return if discriminant >= 0.0 && near >= 0.0 { near } else { f64::INFINITY };
    }
    let corners = shape.corners();
    edges(&corners)
        .filter_map(|(a, b)| {
            let determinant = direction.x * (a.y - b.y) - direction.y * (a.x - b.x);
            let (rx, ry) = (a.x - from.x, a.y - from.y);
            let t = (rx * (a.y - b.y) - ry * (a.x - b.x)) / determinant;
            let s = (direction.x * ry - direction.y * rx) / determinant;
            (determinant != 0.0 && t >= 0.0 && (0.0..=1.0).contains(&s)).then_some(t)
        })
        .fold(f64::INFINITY, f64::min)
}

fn brute(world: &World, from: DVec2, direction: DVec2, max_range: f64) -> Option<f64> {
    let range = world
        .solids()
        .map(|solid| range_to(&solid.shape, from, direction))
        .fold(f64::INFINITY, f64::min);
    (range.is_finite() && range <= max_range).then_some(range)
}

fn empty_world() -> World {
    let bounds = Rect::new(DVec2::splat(-20.0), DVec2::splat(20.0));
    World::new(Provenance::other("manual", serde_json::Value::Null), bounds)
}

fn world_of(shapes: Vec<Shape>) -> World {
    let mut world = empty_world();
    world.obstacles =
        shapes.into_iter().map(|shape| Obstacle::new(ObstacleKind::Other, shape)).collect();
    world
}

fn shapes() -> impl Strategy<Value = Shape> {
    let point = || (-9.0..9.0_f64, -9.0..9.0_f64).prop_map(DVec2::from);
    prop_oneof![
        (point(), point()).prop_map(|(a, b)| Shape::Segment { a, b }),
        (point(), 0.05..2.0_f64).prop_map(|(center, radius)| Shape::Disc { center, radius }),
        (point(), (0.05..2.0_f64, 0.05..2.0_f64), prop_oneof![Just(0.0), -4.0..4.0_f64]).prop_map(
            |(center, half, heading)| Shape::Box { center, half_size: half.into(), heading }
        ),
        (point(), prop::collection::vec(0.3..2.0_f64, 3..9)).prop_map(|(center, radii)| {
            let step = std::f64::consts::TAU / radii.len() as f64;
            let corner = |(i, r): (usize, &f64)| center + unit_vector(step * i as f64) * *r;
            Shape::Polygon { vertices: radii.iter().enumerate().map(corner).collect() }
        }),
    ]
}

proptest! {
    #[test]
    fn rays_agree_with_brute_force(
        shapes in prop::collection::vec(shapes(), 0..60),
        rays in prop::collection::vec(
            (
                (-12.0..12.0_f64, -12.0..12.0_f64),
                prop_oneof![
                    -4.0..4.0_f64,
                    (-4..=4_i32).prop_map(|k| f64::from(k) * FRAC_PI_2),
                ],
                prop_oneof![Just(f64::INFINITY), Just(1e9), 0.0..30.0_f64],
            ),
            1..40,
        ),
    ) {
        let world = world_of(shapes);
        let rays_index = Raycaster::new(&world);
        for (from, heading, max_range) in rays {
            let (from, direction) = (DVec2::from(from), unit_vector(heading));
            let expected = brute(&world, from, direction, max_range);
            let hit = rays_index.cast(from, heading, max_range);
            match (hit, expected) {
                (None, None) => {}
                (Some(hit), Some(range)) => {
                    prop_assert!((hit.distance - range).abs() < 1e-9, "{hit:?} {range}");
                    let part = world.solids().find(|solid| solid.id == hit.part).unwrap();
                    let own = range_to(&part.shape, from, direction);
                    prop_assert!((own - hit.distance).abs() < 1e-9);
                    let surface = rays_index.cast_surface(from, direction, max_range).unwrap();
                    prop_assert_eq!(surface.hit, hit);
                    prop_assert!((surface.normal.length() - 1.0).abs() < 1e-9);
                    prop_assert!(surface.normal.dot(direction) <= 0.0);
                    // Away from corners the distance grows along the normal as far as one goes.
                    let end = from + direction * hit.distance;
                    let corners = part.shape.corners();
                    let at_corner = corners.iter().any(|corner| corner.distance(end) < 0.01);
                    if hit.distance > 0.0 && !at_corner {
                        let lifted = part.shape.distance(end + surface.normal * 1e-4);
                        prop_assert!((lifted - 1e-4).abs() < 1e-7, "{surface:?} {:?}", part.shape);
                    }
                }
                // At a corner or at the end of the range rounding decides.
                (Some(hit), None) => {
                    let near = brute(&world, from, direction, max_range + 1e-9);
                    let end = from + direction * hit.distance;
                    prop_assert!(near.is_some() || world.clearance(end) < 1e-9, "{hit:?}");
                }
                (None, Some(range)) => {
                    let end = from + direction * range;
                    let corner = world.solids().any(|solid| {
                        solid.shape.corners().iter().any(|c| c.distance(end) < 1e-6)
                    });
                    prop_assert!(corner || range > max_range - 1e-9, "missed at {range}");
                }
            }
        }
    }

    #[test]
    fn rays_end_where_the_raster_says(seed: u64, heading in -4.0..4.0_f64, rounded: bool) {
        // One geometry: a ray of the index, and a march over the raster, agree within its cells.
        let corners = if rounded { Corners::Rounded } else { Corners::Square };
        let hallway = HallwaySpec { corners, ..Default::default() };
        let forest = ForestSpec { width: 20.0, height: 20.0, ..Default::default() };
        for world in [
            hallway.generate(Seed(seed)).unwrap().to_world(),
            forest.generate(Seed(seed)).unwrap().to_world(),
        ] {
            let Some(start) = world.start else { continue };
            let cell = 0.02;
            let grid = OccupancyGrid::of(&world, cell, Coverage::Conservative).unwrap();
            let range = Raycaster::new(&world)
                .cast(start.position, heading, 30.0)
                .map_or(f64::INFINITY, |hit| hit.distance);
            let direction = unit_vector(heading);
            let mut march = 0.0;
            while march < range.min(30.0)
                && grid.occupied_at(start.position + direction * march) == Some(false)
            {
                march += 0.25 * cell;
            }
            let end = start.position + direction * march;
            if grid.occupied_at(end).is_some() {
                // The march may only stop short within a cell of a solid part.
                prop_assert!(march <= range + cell);
                prop_assert!(world.clearance(end) < 1.5 * cell, "stopped at {end}");
            }
        }
    }
}

#[test]
fn a_ray_that_starts_inside_has_range_zero() {
    for shape in [
        Shape::Disc { center: DVec2::ZERO, radius: 1.0 },
        Shape::Box { center: DVec2::ZERO, half_size: DVec2::ONE, heading: 0.0 },
        Shape::Box { center: DVec2::ZERO, half_size: DVec2::ONE, heading: 0.3 },
        Shape::Polygon {
            vertices: vec![DVec2::new(-1.0, -1.0), DVec2::new(1.0, -1.0), DVec2::new(0.0, 1.5)],
        },
    ] {
        let rays = Raycaster::new(&world_of(vec![shape.clone()]));
        let hit = rays.cast(DVec2::new(0.1, 0.2), 1.0, 5.0);
        assert_eq!(hit.map(|hit| hit.distance), Some(0.0), "{shape:?}");
    }
}

#[test]
fn an_empty_world_has_no_ranges() {
    let rays = Raycaster::new(&empty_world());
    assert_eq!(rays.cast(DVec2::ZERO, 1.0, f64::INFINITY), None);
    let mut ranges = vec![1.0];
    rays.scan(Pose::default(), &ScanPattern::new(3.0, 5).unwrap(), 8.0, &mut ranges);
    assert_eq!(ranges, [8.0; 5]);
}

#[test]
fn nonsense_rays_meet_nothing_and_end() {
    let disc = Shape::Disc { center: DVec2::new(3.0, 0.0), radius: 1.0 };
    let rays = Raycaster::new(&world_of(vec![disc]));
    let (x_nan, y_nan) = (DVec2::new(f64::NAN, 0.0), DVec2::new(0.0, f64::NAN));
    for from in [DVec2::NAN, x_nan, y_nan, DVec2::splat(f64::INFINITY), DVec2::splat(1e300)] {
        for heading in [0.0, 0.5, FRAC_PI_2] {
            assert_eq!(rays.cast(from, heading, f64::INFINITY), None);
        }
    }
    assert_eq!(rays.cast(DVec2::ZERO, f64::NAN, 10.0), None);
    assert_eq!(rays.cast(DVec2::ZERO, 0.0, f64::NAN), None);
    assert_eq!(rays.cast(DVec2::ZERO, 0.0, -1.0), None);
}

#[test]
fn rays_without_direction_meet_nothing() {
    let ring = |radius| Shape::Polygon {
        vertices: (0..5).map(|i| unit_vector(1.2 * f64::from(i)) * radius).collect(),
    };
    // Inside a disc, in the middle of walls, in a filled polygon, beside and outside of everything.
    let worlds = [
        vec![Shape::Disc { center: DVec2::ZERO, radius: 1.0 }],
        edges(&ring(3.0).corners()).map(|(a, b)| Shape::Segment { a, b }).collect(),
        vec![ring(2.0)],
        vec![Shape::from_rect(Rect::new(DVec2::splat(-1.0), DVec2::splat(2.0)))],
        Vec::new(),
    ];
    let numbers = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    let fan = ScanPattern::new(3.0, 7).unwrap();
    for (rays, at) in worlds.iter().flat_map(|shapes| {
        let rays = Raycaster::new(&world_of(shapes.clone()));
        [(0.0, 0.0), (0.1, 0.2), (2.0, 0.0), (5.0, -3.0), (99.0, 1.0)].map(|at| (rays.clone(), at))
    }) {
        let from = DVec2::from(at);
        for number in numbers {
            assert_eq!(rays.cast(from, number, 10.0), None, "{from}");
            for direction in
                [DVec2::new(number, 0.0), DVec2::new(1.0, number), DVec2::splat(number)]
            {
                assert_eq!(rays.cast_along(from, direction, 10.0), None, "{from} {direction}");
                assert_eq!(rays.cast_surface(from, direction, 10.0), None, "{from} {direction}");
            }
            let pose = Pose { position: from, heading: number };
            assert!(rays.hits(pose, &fan, 10.0).all(|hit| hit.is_none()), "{from}");
            let mut ranges = Vec::new();
            rays.scan(pose, &fan, 10.0, &mut ranges);
            assert_eq!(ranges, [10.0; 7], "{from}");
        }
    }
}

#[test]
fn directions_with_negative_zeros_are_those_with_zeros() {
    let disc = |x, y| Shape::Disc { center: DVec2::new(x, y), radius: 1.0 };
    let rays = Raycaster::new(&world_of(vec![
        disc(9.0, 0.0),
        disc(0.0, 8.0),
        disc(-7.0, 0.0),
        disc(0.0, -6.0),
    ]));
    for (direction, distance) in
        [(DVec2::X, 8.0), (DVec2::Y, 7.0), (DVec2::NEG_X, 6.0), (DVec2::NEG_Y, 5.0)]
    {
        for sign in [0.0, -0.0] {
            let direction = direction.map(|part| if part == 0.0 { sign } else { part });
            let hit = rays.cast_along(DVec2::ZERO, direction, 20.0);
            assert_eq!(hit.map(|hit| hit.distance), Some(distance), "{direction}");
        }
    }
}

#[test]
fn rays_meet_the_joints_of_boxes_that_touch() {
    let half_size = DVec2::new(1.0, 2.0);
    let a = DVec2::new(6.0, 2.0);
    for (i, turn) in [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y].into_iter().enumerate() {
        let half_size = if i % 2 == 0 { half_size } else { half_size.perp().abs() };
        let rectangle = |center: DVec2| Shape::Box { center, half_size, heading: 0.0 };
        // The joint is on an axis, which the ray runs along.
        let (above, below) = (turn.rotate(a), turn.rotate(DVec2::new(a.x, -a.y)));
        let rays = Raycaster::new(&world_of(vec![rectangle(above), rectangle(below)]));
        let hit = rays.cast_along(DVec2::ZERO, turn, 20.0);
        assert_eq!(hit.map(|hit| hit.distance), Some(5.0), "{turn}");
        // A side is met as well, and what is beside it is not.
        let one = Raycaster::new(&world_of(vec![rectangle(above)]));
        assert_eq!(one.cast_along(DVec2::ZERO, turn, 20.0).map(|hit| hit.distance), Some(5.0));
        let beside = turn.rotate(DVec2::new(0.0, -0.01));
        assert_eq!(one.cast_along(beside, turn, 20.0), None);
    }
}

#[test]
fn a_fan_is_at_most_a_full_turn_of_a_million_rays() {
    for angle in [-0.1, f64::NAN, f64::INFINITY, 6.3] {
        let error = ScanPattern::new(angle, 3).unwrap_err().to_string();
        assert!(error.starts_with("`field_of_view` must be"), "{error}");
    }
    let error = ScanPattern::new(1.0, usize::MAX).unwrap_err().to_string();
    assert!(error.starts_with("`beams` must be"), "{error}");
    assert!(ScanPattern::new(0.0, 0).unwrap().is_empty());
    assert_eq!(ScanPattern::new(std::f64::consts::TAU, 1).unwrap().len(), 1);
}

#[test]
fn a_scan_runs_from_right_to_left() {
    let wall = Shape::from_rect(Rect::new(DVec2::new(-1.0, 2.0), DVec2::new(1.0, 2.5)));
    let rays = Raycaster::new(&world_of(vec![wall]));
    let mut ranges = Vec::new();
    let pose = Pose::new(0.0, 0.0, 0.0);
    rays.scan(pose, &ScanPattern::new(std::f64::consts::PI, 3).unwrap(), 8.0, &mut ranges);
    assert_eq!(ranges[..2], [8.0, 8.0]);
    assert!((ranges[2] - 2.0).abs() < 1e-12);
}

#[test]
fn dark_parts_are_met_but_not_seen_from_afar() {
    let slab = |x: f64| Shape::from_rect(Rect::new(DVec2::new(x, -5.0), DVec2::new(x + 0.5, 5.0)));
    let mut world = world_of(vec![slab(2.0), slab(-7.0), slab(6.0)]);
    assert!(Raycaster::of_dark(&world, 0.45).is_none());
    world.obstacles[1].visible_range = Some(4.0);
    world.obstacles[2].visible_range = Some(1.0);
    let (rays, dark) = (Raycaster::new(&world), Raycaster::of_dark(&world, 0.45).unwrap());
    let meet = |rays: &Raycaster, x: f64, heading: f64| {
        let hit = rays.cast(DVec2::new(x, 0.0), heading, 20.0).unwrap();
        (hit.part.index, hit.distance, rays.is_unseen(hit))
    };
    // A light slab hides the dark one behind it, but for the index of dark parts alone.
    assert_eq!(meet(&rays, 0.0, 0.0), (0, 2.0, false));
    assert_eq!(meet(&dark, 0.0, 0.0), (2, 6.0, true));
    let left = std::f64::consts::PI;
    for rays in [&rays, &dark] {
        let (part, distance, unseen) = meet(rays, 0.0, left);
        assert!(part == 1 && (distance - 6.5).abs() < 1e-12 && unseen);
        let (_, distance, unseen) = meet(rays, -3.0, left);
        assert!((distance - 3.5).abs() < 1e-12 && !unseen);
    }
    assert_eq!(world.visible_range(rays.cast(DVec2::ZERO, left, 20.0).unwrap().part), Some(4.0));
}

#[test]
fn parts_piled_on_each_other_do_not_blow_up_the_index() {
    // 20,000 discs that each cover everything: an even grid would list each in every cell.
    let disc = Shape::Disc { center: DVec2::ZERO, radius: 9.0 };
    let rays = Raycaster::new(&world_of(vec![disc; 20_000]));
    let hit = rays.cast(DVec2::new(-10.0, 0.0), 0.0, 10.0).unwrap();
    assert!((hit.distance - 1.0).abs() < 1e-12);
    assert_eq!(hit.part.index, 0);
}
