use envgen::geometry::{Pose, Rect, Shape};
use envgen::indoor::IndoorSpec;
use envgen::world::{Obstacle, ObstacleKind, Surface, SurfaceKind, Wall, WallKind};
use envgen::{Blueprint, Provenance, Seed, Spec, WorldKind};
use proptest::prelude::*;

use super::*;
use crate::map::Cell;

/// A room with walls of 0.2 m around `width` x `height` metres of floor, and a start in its corner.
pub(crate) fn room(width: f64, height: f64) -> World {
    let bounds = Rect::new(DVec2::splat(-0.2), DVec2::new(width + 0.2, height + 0.2));
    let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
    for (min, max) in [
        ((-0.2, -0.2), (width + 0.2, 0.0)),
        ((-0.2, height), (width + 0.2, height + 0.2)),
        ((-0.2, 0.0), (0.0, height)),
        ((width, 0.0), (width + 0.2, height)),
    ] {
        add_wall(&mut world, min, max);
    }
    world.start = Some(Pose::new(1.0, 1.0, 0.0));
    world
}

pub(crate) fn add_wall(world: &mut World, min: (f64, f64), max: (f64, f64)) {
    let shape = Shape::from_rect(Rect::new(min.into(), max.into()));
    world.walls.push(Wall::new(WallKind::Wall, shape));
}

fn truth(world: &World) -> MappableArea {
    MappableArea::new(world, &Robot::default()).expect("a world with free space")
}

#[test]
fn an_empty_room_is_free_but_for_what_the_disc_leaves_in_its_corners() {
    let truth = truth(&room(20.0, 20.0));
    // Each corner keeps (1 - pi / 4) r^2 for itself: 0.03 m^2, three cells.
    assert!((truth.free_area() - 400.0).abs() < 0.2, "{}", truth.free_area());
    // Four inner sides, every 5 cm; nothing of the outer ones.
    assert!((truth.walls().len() as i64 - 1600).abs() <= 16, "{}", truth.walls().len());
    let inner = Rect::new(DVec2::ZERO, DVec2::splat(20.0)).grown(1e-9);
    assert!(truth.walls().iter().all(|point| inner.contains(point.position)));
}

#[test]
fn what_is_behind_too_narrow_a_gap_is_not_free() {
    for (gap, passes) in [(0.78, true), (0.50, false)] {
        let mut world = room(10.0, 4.0);
        add_wall(&mut world, (5.0, 0.0), (5.1, 2.0 - 0.5 * gap));
        add_wall(&mut world, (5.0, 2.0 + 0.5 * gap), (5.1, 4.0));
        let truth = truth(&world);
        let area = if passes { 39.5 } else { 20.0 };
        assert!((truth.free_area() - area).abs() < 0.6, "{gap}: {}", truth.free_area());
        let beyond = truth.walls().iter().filter(|point| point.position.x > 5.2).count();
        // Through the gap the far wall can be seen, but not the back of the near one.
        assert!(beyond > 80, "{gap}: {beyond}");
        let behind = truth.walls().iter().filter(|point| point.normal == DVec2::X).count();
        let left = (4.0 / 0.05) as usize;
        assert_eq!(behind > left, passes, "{gap}: {behind}");
    }
}

#[test]
fn water_bars_the_middle_and_counts_as_no_ground() {
    let mut world = room(10.0, 4.0);
    let shape = Shape::from_rect(Rect::new(DVec2::new(4.0, 0.0), DVec2::new(6.0, 4.0)));
    let water = Surface { speed: 0.5, ..Surface::new(SurfaceKind::Water, shape) };
    world.surfaces.push(water);
    let with_water = truth(&world);
    assert!((with_water.free_area() - 16.0).abs() < 0.2, "{}", with_water.free_area());
    assert!(with_water.is_clear(DVec2::new(3.99, 2.0)));
    assert!(!with_water.is_clear(DVec2::new(4.01, 2.0)));
    // One sees across.
    assert!(with_water.walls().iter().any(|point| point.position.x == 10.0));
    world.surfaces[0].kind = SurfaceKind::Uneven;
    assert!((truth(&world).free_area() - 40.0).abs() < 0.2);
    world.surfaces[0].speed = 0.0;
    assert_eq!(truth(&world).free(), with_water.free());
}

#[test]
fn lines_are_seen_from_both_sides_and_count_once() {
    let mut world = room(10.0, 4.0);
    let (a, b) = (DVec2::new(5.0, 1.5), DVec2::new(5.0, 2.5));
    world.walls.push(Wall::new(WallKind::Partition, Shape::Segment { a, b }));
    let truth = truth(&world);
    assert_eq!(truth.walls().iter().filter(|point| point.position.x == 5.0).count(), 20);
    assert!((truth.free_area() - 39.8).abs() < 0.3, "{}", truth.free_area());
}

#[test]
fn a_world_that_cannot_be_mapped_says_why() {
    let error =
        |world: &World| MappableArea::new(world, &Robot::default()).map(|_| ()).unwrap_err();
    let mut world = room(10.0, 4.0);
    world.start = None;
    assert_eq!(error(&world), MappableAreaError::NoStart);
    world.start = Some(Pose::new(0.3, 2.0, 0.0));
    assert!(matches!(error(&world), MappableAreaError::Start { .. }));
    let text = error(&world).to_string();
    assert!(text.contains("got (0.3, 2) m") && text.contains("0.36 m"), "{text}");
    world.start = Some(Pose::new(-0.1, 2.0, 0.0));
    assert!(matches!(error(&world), MappableAreaError::World(Violation::Blocked { .. })));
    world.start = Some(Pose::new(1.0, 1.9, 0.0));
    let shape = Shape::from_rect(Rect::new(DVec2::ZERO, DVec2::splat(2.0)));
    let water = Surface { speed: 0.5, ..Surface::new(SurfaceKind::Water, shape) };
    world.surfaces.push(water);
    assert!(matches!(error(&world), MappableAreaError::Start { .. }));
    world.bounds.max.x = 1e6;
    assert!(matches!(error(&world), MappableAreaError::Size { .. }));
    world.bounds = Rect::new(DVec2::splat(-1e300), DVec2::splat(1e300));
    assert!(matches!(error(&world), MappableAreaError::World(Violation::Extent { .. })));
    // Indoor maps of 192 grid units of 3 m and their walls, and of one more.
    for (side, fits) in [(576.1, true), (579.1, false)] {
        world.bounds = Rect::new(DVec2::ZERO, DVec2::splat(side));
        assert_eq!(MappableArea::check_size(&world).is_ok(), fits, "{side}");
    }
    for circumscribed_radius in [0.0, -1.0, f64::NAN, 1e9] {
        let robot = Robot { circumscribed_radius, ..Robot::default() };
        let text = MappableArea::new(&world, &robot).unwrap_err().to_string();
        assert!(text.contains("`circumscribed_radius`") && text.contains("0.15 to 2"), "{text}");
        assert!(MappableArea::check_robot(&robot).is_err());
    }
}

#[test]
fn every_kind_of_world_has_a_truth() {
    for &kind in WorldKind::ALL {
        let mut spec = kind.default_spec();
        if kind == WorldKind::Road {
            spec.set("length", "150").expect("a setting of roads");
        }
        let world = spec.generate(Seed(2)).expect("defaults").to_world();
        match MappableArea::new(&world, &Robot::default()) {
            Ok(truth) => assert!(truth.free_area() > 1.0, "{kind}"),
            Err(error) => assert!(world.start.is_none(), "{kind}: {error}"),
        }
    }
}

#[test]
fn the_perfect_map_shows_what_is_free_and_what_is_not() {
    let truth = truth(&room(5.0, 4.0));
    let map = truth.perfect_map();
    let at = |x: f64, y: f64| map.cell(CellIndex::of(DVec2::new(x, y)));
    assert_eq!(at(2.0, 2.0), Cell::Free);
    assert_eq!(at(2.0, 0.02), Cell::Free);
    assert_eq!(at(2.0, -0.02), Cell::Occupied);
    assert_eq!(at(5.02, 2.0), Cell::Occupied);
    assert_eq!(at(5.1, 2.0), Cell::Unknown);
}

/// Free cells by the slow method: discs around all points of a lattice, joined step by step.
fn slow_free(world: &World, frame: ScoreFrame) -> Vec<bool> {
    let (radius, step) = (0.36, 0.025);
    let low = frame.area().min + 0.5 * step;
    let (cols, rows) = (4 * frame.cols, 4 * frame.rows);
    let point = |i: usize| low + DVec2::new((i % cols) as f64, (i / cols) as f64) * step;
    let clear: Vec<bool> = (0..cols * rows).map(|i| world.clearance(point(i)) >= radius).collect();
    let start = world.start.unwrap().position;
    let mut reached = vec![false; clear.len()];
    let mut open: Vec<usize> =
        (0..clear.len()).filter(|&i| clear[i] && point(i).distance(start) < 0.05).collect();
    open.iter().for_each(|&i| reached[i] = true);
    while let Some(i) = open.pop() {
        for (x, y) in [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)] {
            let next = (i as i64 + x + y * cols as i64) as usize;
            if next < clear.len() && clear[next] && !reached[next] {
                reached[next] = true;
                open.push(next);
            }
        }
    }
    (0..frame.len())
        .map(|cell| {
            let middle = frame.centre(cell);
            // The cell itself is free of solids.
            let corners = 0.05 * std::f64::consts::SQRT_2;
            let room = world.clearance(middle);
            let free = room > corners
                || (room > 0.0
                    && world.solids().all(|part| {
                        let cell = Rect::new(middle - 0.05, middle + 0.05).grown(-1e-6);
                        !part.shape.bounds().overlaps(cell)
                    }));
            let (x, y) = (4 * (cell % frame.cols) as i64, 4 * (cell / frame.cols) as i64);
            let around = (-15..19).flat_map(|dy| (-15..19).map(move |dx| (x + dx, y + dy)));
            free && around.into_iter().any(|(x, y)| {
                let inside = x >= 0 && y >= 0 && x < cols as i64 && y < rows as i64;
                let i = (y * cols as i64 + x) as usize;
                inside && reached[i] && point(i).distance(middle) <= radius
            })
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn free_ground_is_that_of_the_slow_method(
        boxes in prop::collection::vec((0.0..6.0_f64, 0.0..5.0_f64, 0.05..1.0_f64, 0.05..1.0_f64), 0..8),
        x in 0.5..5.5_f64,
        y in 0.5..4.5_f64,
    ) {
        let mut world = room(6.0, 5.0);
        world.obstacles = boxes
            .into_iter()
            .map(|(x, y, width, height)| {
                let low = DVec2::new(x, y);
                let high = (low + DVec2::new(width, height)).min(DVec2::new(6.1, 5.1));
                let shape = Shape::from_rect(Rect::new(low, high));
                Obstacle::new(ObstacleKind::Other, shape)
            })
            .collect();
        world.start = Some(Pose::new(x, y, 0.0));
        prop_assume!(world.clearance(DVec2::new(x, y)) > 0.4);
        let truth = truth(&world);
        let slow = slow_free(&world, truth.frame());
        prop_assert!(truth.free() == slow);
        for point in truth.walls() {
            prop_assert!(world.clearance(point.position).abs() < 1e-9);
        }
    }

    #[test]
    fn no_robot_that_stays_clear_leaves_free_ground(
        seed in 0_u64..1000,
        legs in prop::collection::vec((-3.2..3.2_f64, 0.1..4.0_f64), 1..60),
    ) {
        let spec = IndoorSpec { difficulty: 6.0, ..Default::default() };
        let world = spec.generate(Seed(seed)).expect("a map").to_world();
        let truth = truth(&world);
        let mut at = world.start.expect("a start").position;
        let robot = Robot::default();
        for (heading, length) in legs {
            for _ in 0..(length / 0.02) as u32 {
                let next = at + envgen::geometry::unit_vector(heading) * 0.02;
                if world.clearance(next) < robot.circumscribed_radius + 0.03 || !truth.is_clear(next) {
                    break;
                }
                at = next;
                prop_assert!(truth.frame().cell_at(at).is_some_and(|cell| truth.free()[cell]));
            }
        }
    }
}
