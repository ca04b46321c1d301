//! Hostile worlds: their difficulty vectors end, or errors say why there are none.

use std::time::{Duration, Instant};

use envgen::difficulty::{DifficultyError, DifficultyVector, Platform};
use envgen::geometry::{Rect, Shape};
use envgen::glam::DVec2;
use envgen::world::{Wall, WallKind};
use envgen::{Provenance, World};

/// The longest that a vector may take; tests without optimisation and beside others are slower.
const LONGEST: Duration = Duration::from_secs(20);

/// A world of a size without walls around it, from the origin on.
fn open(width: f64, height: f64) -> World {
    let bounds = Rect::new(DVec2::ZERO, DVec2::new(width, height));
    World::new(Provenance::other("manual", serde_json::Value::Null), bounds)
}

/// The result of work that has to end within [`LONGEST`].
#[expect(clippy::disallowed_methods, reason = "hostile worlds must not take long")]
fn in_time<T>(work: impl FnOnce() -> T) -> T {
    let begun = Instant::now();
    let result = work();
    assert!(begun.elapsed() < LONGEST, "{:?}", begun.elapsed());
    result
}

/// Adds parallel segments, from the left to the right border and a distance apart.
fn add_lines(world: &mut World, count: u32, distance: f64) {
    let Rect { min, max } = world.bounds;
    world.walls.extend((0..count).map(|i| {
        let y = min.y + distance * (0.5 + f64::from(i));
        Wall::new(
            WallKind::Wall,
            Shape::Segment { a: DVec2::new(min.x, y), b: DVec2::new(max.x, y) },
        )
    }));
}

#[test]
fn worlds_that_are_too_large_are_errors_at_once() {
    let mut world = open(2e8, 2e8);
    world.bounds = Rect::new(DVec2::splat(-1e8), DVec2::splat(1e8));
    add_lines(&mut world, 1000, 1.0);
    let found = in_time(|| DifficultyVector::of(&world, &Platform::default()));
    let error = found.expect_err("too large");
    assert_eq!(error, DifficultyError::TooLarge { width: 2e8, height: 2e8 });
    assert_eq!(
        error.to_string(),
        "the bounds of the world must hold at most 262144 cells of 5 m, got 200000000 m x 200000000 m"
    );
}

#[test]
fn parallel_walls_in_the_largest_world_end() {
    let mut world = open(2500.0, 2500.0);
    add_lines(&mut world, 1000, 2.5);
    let _ = in_time(|| DifficultyVector::of(&world, &Platform::default()));
}

#[test]
fn piles_of_solids_are_errors() {
    let mut world = open(200.0, 200.0);
    add_lines(&mut world, 100_000, 1e-5);
    let error = in_time(|| DifficultyVector::of(&world, &Platform::default())).err();
    assert_eq!(error, Some(DifficultyError::TooDense));
}

#[test]
fn long_strips_end() {
    let world = open(50e3, 0.2);
    let found = in_time(|| DifficultyVector::of(&world, &Platform::default()));
    let found = found.expect("a vector");
    // Across the strip there is one cell.
    assert_eq!(found.barn.barn_tour_characteristic_dimension_m, Some(0.0));
    assert!((found.ground.ground_area_m2 - 10e3).abs() < 1e-3, "{}", found.ground.ground_area_m2);
}
