//! The difficulty vector over worlds of every kind.

#[path = "common/random_spec.rs"]
mod random_spec;

use envgen::difficulty::{DifficultyError, DifficultyVector, Platform};
use envgen::forest::ForestSpec;
use envgen::geometry::Pose;
use envgen::indoor::{IndoorSpec, Profile};
use envgen::landscape::LandscapeSpec;
use envgen::world::Digest;
use envgen::{Blueprint, Seed, Spec, World, WorldKind};
use proptest::prelude::*;

/// What holds of every vector.
fn check(vector: &DifficultyVector, platform: &Platform) -> Result<(), TestCaseError> {
    let features = DifficultyVector::features();
    for (feature, value) in features.iter().zip(vector.values()) {
        let Some(value) = value else { continue };
        prop_assert!(value.is_finite() && value >= 0.0, "{}: {value}", feature.name);
        let is_share = feature.name.ends_with("_share") && feature.unit.is_empty();
        prop_assert!(!is_share || (0.0..=1.0).contains(&value), "{}: {value}", feature.name);
    }
    let DifficultyVector {
        ground, localization, visibility, tour, clearance, places, barn, ..
    } = vector;
    prop_assert!(ground.ground_area_m2 >= clearance.reachable_area_m2);
    prop_assert!((0.0..=1.0).contains(&localization.scan_degeneracy));
    prop_assert!(localization.scan_ratio_20 <= 1.0);
    let sector = 0.5 * platform.field_of_view * platform.max_range * platform.max_range;
    prop_assert!(visibility.visible_area_10_m2 <= sector * (1.0 + 1e-9));
    prop_assert!(visibility.visible_area_mean_m2 <= sector * (1.0 + 1e-9));
    for [a, b, c] in [
        [tour.tour_length_80_m, tour.tour_length_95_m, tour.tour_length_100_m],
        [tour.tour_turning_80_rad, tour.tour_turning_95_rad, tour.tour_turning_100_rad],
    ] {
        prop_assert!(c.is_none() || (a <= b && b <= c), "{a:?} {b:?} {c:?}");
        prop_assert!(b.is_some() || c.is_none());
        prop_assert!(a.is_some() || b.is_none());
    }
    prop_assert!(tour.tour_dead_ends <= tour.tour_goals);
    let [low, middle, high] =
        [clearance.clearance_10_m, clearance.clearance_50_m, clearance.clearance_90_m];
    prop_assert!(platform.circumscribed_radius <= low && low <= middle && middle <= high);
    let passage = clearance.narrowest_passage_m;
    prop_assert!(passage.is_none_or(|width| width >= 2.0 * platform.circumscribed_radius));
    prop_assert!(passage <= clearance.passage_width_mean_m);
    prop_assert!(places.places >= 1 && places.place_links + 1 >= places.places);
    for dispersion in [barn.barn_tour_dispersion, barn.barn_reference_goal_dispersion] {
        prop_assert!(dispersion.is_none_or(|changes| (0.0..=16.0).contains(&changes)));
    }
    for tortuosity in [barn.barn_goal_tortuosity, barn.barn_tour_tortuosity] {
        prop_assert!(tortuosity.is_none_or(|tortuosity| tortuosity >= 1.0 - 1e-9));
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn every_world_has_numbers_or_an_error(
        kind in prop::sample::select(WorldKind::ALL),
        seed: u64,
        radius in 0.05..1.0_f64,
        offset in -1.0..=1.0_f64,
        beams in 2..200_u32,
        field_of_view in prop_oneof![Just(std::f64::consts::TAU), 0.05..6.2_f64],
        max_range in 0.5..30.0_f64,
    ) {
        let spec = random_spec::random_spec(kind, seed, random_spec::MAX_COST);
        let Ok(blueprint) = spec.generate(Seed(seed)) else { return Ok(()) };
        let world = blueprint.to_world();
        let platform = Platform {
            circumscribed_radius: radius,
            laser_offset: radius * offset,
            beams,
            field_of_view,
            max_range,
            ..Default::default()
        };
        match DifficultyVector::of(&world, &platform) {
            Ok(vector) => check(&vector, &platform)?,
            Err(
                DifficultyError::Start { .. }
                | DifficultyError::NoGround { .. }
                | DifficultyError::TooLarge { .. },
            ) => {}
            Err(other) => prop_assert!(false, "{other}"),
        }
    }

    #[test]
    fn what_a_robot_does_not_meet_changes_nothing(seed in 0..1000_u64) {
        let spec = IndoorSpec { width: 6, height: 6, ..Default::default() };
        let mut world = spec.generate(Seed(seed)).unwrap().to_world();
        let platform = Platform::default();
        let before = DifficultyVector::of(&world, &platform).unwrap();
        check(&before, &platform)?;
        world.certificate.clear();
        world.rooms.iter_mut().for_each(|room| room.name = "other".to_owned());
        world.provenance = envgen::Provenance::other("test", serde_json::Value::Null);
        prop_assert_eq!(DifficultyVector::of(&world, &platform).unwrap(), before);
    }
}

fn indoor(difficulty: f64, seed: u64) -> World {
    let spec = IndoorSpec { difficulty, width: 8, height: 8, ..Default::default() };
    spec.generate(Seed(seed)).unwrap().to_world()
}

#[test]
fn guaranteed_maps_are_reached_as_a_whole() {
    // What the certificate promises, all but the gaps behind furniture is found on the grid.
    let platform = Platform::default();
    for seed in 0..6 {
        let mut world = indoor(2.0 * seed as f64, seed);
        let vector = DifficultyVector::of(&world, &platform).unwrap();
        let from_start = vector.clearance.reachable_area_m2;
        world.start = None;
        let largest = DifficultyVector::of(&world, &platform).unwrap();
        assert_reached(from_start, largest.clearance.reachable_area_m2, seed);
        for room in world.rooms.clone() {
            let middle = room.shape.bounds().center();
            world.start = Some(Pose { position: middle, heading: 0.0 });
            // Where the middle is free, it is in the same region.
            if let Ok(inside) = DifficultyVector::of(&world, &platform) {
                assert_reached(inside.clearance.reachable_area_m2, from_start, seed);
            }
        }
    }
}

fn assert_reached(found: f64, expected: f64, seed: u64) {
    assert!((found - expected).abs() < 1e-6, "seed {seed}: {found} m^2, not {expected} m^2");
}

#[test]
fn a_better_laser_makes_no_tour_longer_to_see_all() {
    // Not for every world, but on the whole: the greedy tour is no shortest one.
    let length = |platform: &Platform| -> f64 {
        (0..6)
            .map(|seed| DifficultyVector::of(&indoor(5.0, seed), platform).unwrap())
            .map(|vector| vector.tour.tour_length_95_m.unwrap())
            .sum()
    };
    let (short, usual) = (Platform { max_range: 3.0, ..Default::default() }, Platform::default());
    let all_around = Platform {
        max_range: 20.0,
        field_of_view: std::f64::consts::TAU,
        beams: 361,
        ..Default::default()
    };
    let lengths = [&short, &usual, &all_around].map(length);
    assert!(lengths.is_sorted_by(|a, b| a > b), "{lengths:?}");
}

#[test]
fn digests_are_frozen() {
    let digest = |world: &World| {
        let vector = DifficultyVector::of(world, &Platform::default()).unwrap();
        Digest::of(&vector).to_string()[..16].to_owned()
    };
    let default = |kind: WorldKind| kind.default_spec().generate(Seed(1)).unwrap().to_world();
    let found = [
        digest(&indoor(0.0, 1)),
        digest(&indoor(5.0, 2)),
        digest(&indoor(10.0, 3)),
        digest(&default(WorldKind::Hallway)),
        digest(&default(WorldKind::Forest)),
        digest(&default(WorldKind::Landscape)),
    ];
    assert_eq!(
        found,
        [
            "271badf05cf3e7a7",
            "b90c2c3bdef42ee4",
            "e1c829e8e391c6c1",
            "3465ad690bfd4415",
            "9f2c5bb0adc5810a",
            "d7810e6d33a5dd57"
        ]
    );
}

#[test]
fn digests_are_frozen_of_predictions() {
    let found: Vec<String> = [(2.9, 3), (5.0, 4), (7.5, 5)]
        .map(|(difficulty, seed)| {
            let profile = Profile::Calibrated;
            let spec =
                IndoorSpec { width: 8, height: 8, difficulty, profile, ..Default::default() };
            let plan = spec.generate(Seed(seed)).expect("within reach");
            let digest = Digest::of(&(plan.prediction(), plan.to_world().digest().to_string()));
            digest.to_string()[..16].to_owned()
        })
        .into();
    assert_eq!(found, PREDICTIONS, "{found:#?}");
}

const PREDICTIONS: [&str; 3] = ["50453a5eb4678484", "ef2310d417f3361f", "84b848b91afdab60"];

#[test]
fn clearances_of_large_robots_agree() {
    let spec = ForestSpec { width: 30.0, height: 30.0, intensity: 0.0, ..Default::default() };
    let world = spec.generate(Seed(0)).expect("a meadow").to_world();
    for radius in [0.3, 1.4, 1.6, 2.0] {
        let platform = Platform { circumscribed_radius: radius, ..Default::default() };
        let vector = DifficultyVector::of(&world, &platform).expect("a vector");
        // Nothing is near: the clearance is the greatest that counts, everywhere.
        let (clearance, greatest) = (vector.clearance, f64::max(1.5, radius + 0.005));
        assert_eq!((clearance.clearance_10_m, clearance.clearance_90_m), (greatest, greatest));
        let inverse = clearance.tour_mean_inverse_clearance_per_m.expect("it drives");
        assert!((inverse * greatest - 1.0).abs() < 1e-9, "{inverse} with {radius} m");
    }
}

#[test]
fn nobody_drives_where_a_raster_has_no_data() {
    let spec = LandscapeSpec { rows: 20, cols: 20, ..Default::default() };
    let mut world = spec.generate(Seed(1)).expect("a landscape").to_world();
    let area = |world: &World| {
        let vector = DifficultyVector::of(world, &Platform::default()).expect("a vector");
        vector.clearance.reachable_area_m2
    };
    let whole = area(&world);
    let raster = world.raster.as_mut().expect("landscapes have a raster");
    raster.cells.iter_mut().skip(10).step_by(20).for_each(|class| *class = 0);
    assert!((area(&world) / whole - 0.5).abs() < 1e-9, "{} of {whole} m^2", area(&world));
    // As with speeds that say so.
    world.raster.as_mut().expect("as before").speeds = vec![0.0];
    assert!((area(&world) / whole - 0.5).abs() < 1e-9);
}

#[test]
fn requests_that_an_error_allows_are_allowed() {
    for (width, height) in [(8, 8), (5, 5), (8, 4)] {
        let base = IndoorSpec { width, height, profile: Profile::Calibrated, ..Default::default() };
        let reachable = base.reachable();
        let requests: [fn(IndoorSpec, f64) -> IndoorSpec; 3] = [
            |spec, difficulty| IndoorSpec { difficulty, ..spec },
            |spec, wanted| IndoorSpec { mapping: Some(wanted), ..spec },
            |spec, wanted| IndoorSpec { navigation: Some(wanted), ..spec },
        ];
        for request in requests {
            let check = |wanted: f64| {
                let spec = request(base.clone(), wanted);
                spec.request().check(&spec, reachable)
            };
            let error = check(11.0).expect_err("beyond the scale").to_string();
            let ends = error.split_once(" from ").and_then(|(_, ends)| ends.split_once(", what"));
            let ends = ends.and_then(|(ends, _)| ends.split_once(" to ")).expect("an interval");
            for end in [ends.0, ends.1] {
                assert_eq!(check(end.parse().expect("a number")), Ok(()), "{error}");
            }
        }
    }
}
