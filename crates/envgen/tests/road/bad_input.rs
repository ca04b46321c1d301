//! What cannot be says why, and what is just possible is.

use std::f64::consts::PI;

use envgen::road::{Concentration, Crossing, Prefab, RoadError, RoadSpec};
use envgen::{Blueprint, Seed, Spec};

use envgen::road::Prefab::{Left, Right, Straight};

#[test]
fn a_point_behind_is_out_of_reach() {
    let spec = RoadSpec { end_x: Some(-500.0), end_y: Some(0.0), ..Default::default() };
    let error = spec.generate(Seed(1)).unwrap_err().to_string();
    assert!(error.contains("cannot end at (-500, 0)"), "{error}");
    let far = RoadSpec {
        prefabs: vec![Straight, Left, Straight],
        end_x: Some(1e6),
        end_y: Some(1e6),
        ..Default::default()
    };
    let error = far.generate(Seed(1)).unwrap_err();
    assert!(matches!(error, RoadError::TooLong { .. } | RoadError::Unreachable { .. }), "{error}");
}

#[test]
fn what_cannot_close_says_why() {
    let of = |prefabs: Vec<Prefab>| {
        let spec = RoadSpec { prefabs, closed: true, ..Default::default() };
        spec.generate(Seed(1)).unwrap_err().to_string()
    };
    let error = of(vec![Straight, Left, Straight, Left, Left]);
    assert!(error.contains("90.0 to 270.0 degrees"), "{error}");
    let error = of(vec![Straight]);
    assert!(error.contains("differ by at most 0.0 degrees"), "{error}");
    let error = of(RoadSpec::default().prefabs);
    assert!(error.contains("differ by at most 90.0 degrees"), "{error}");
    let plain = RoadSpec { closed: true, crossing: Crossing::Reject, ..Default::default() };
    let error = plain.generate(Seed(1)).unwrap_err().to_string();
    assert!(
        error.contains("add up to -60.0 to 60.0 degrees, and 360 or -360 is needed"),
        "{error}"
    );
    // A figure of eight turns by 0 in all, and exists.
    let eight = vec![Straight, Left, Left, Left, Straight, Right, Right, Right];
    let spec = RoadSpec { prefabs: eight, closed: true, speed: 5.0, ..Default::default() };
    let angle: f64 = spec.generate(Seed(1)).unwrap().segments().iter().map(|s| s.angle).sum();
    assert!(angle.abs() < 1e-9, "{angle}");
    let spec = RoadSpec { closed: true, end_x: Some(1.0), end_y: Some(1.0), ..Default::default() };
    assert_eq!(spec.validate().unwrap_err().field, "closed");
}

#[test]
fn attempts_run_out_with_the_last_reason() {
    // Longer than the area is wide and high together.
    let spec = RoadSpec {
        crossing: Crossing::Resample,
        attempts: 7,
        area: 20.0,
        start_y: 10.0,
        start_x: 1.0,
        ..Default::default()
    };
    let error = spec.generate(Seed(1)).unwrap_err();
    let RoadError::Attempts { attempts: 7, last } = error else {
        panic!("{error}");
    };
    assert_eq!(*last, RoadError::OutOfArea { side: 20.0 });
    // A start whose edges are outside leaves the area in every attempt.
    let spec = RoadSpec { start_y: 3.0, ..spec };
    assert_eq!(spec.validate().unwrap_err().field, "area");
}

#[test]
fn infeasible_roads_fail_at_once_with_three_numbers() {
    let spec = RoadSpec { speed: 90.0, ..Default::default() };
    let error = spec.validate().unwrap_err();
    assert_eq!(spec.generate(Seed(1)).err(), Some(error.clone().into()));
    // 2 turns of pi / 6 * 90^2 / (9.81 * 0.7) m and 3 straights of 1 m; 1000 m are given; and
    // (1000 - 3) / 2 m are enough for a speed of sqrt(498.5 * 6 / pi * 9.81 * 0.7).
    let needed = 3.0 + 2.0 * PI / 6.0 * 8100.0 / (9.81 * 0.7);
    let speed = (498.5 * 6.0 / PI * 9.81 * 0.7).sqrt();
    let text = error.to_string();
    let needed = (needed * 1e3).ceil() / 1e3;
    for number in [format!("{needed:.3} m"), "got 1000".to_owned(), format!("{speed:.4}")] {
        assert!(text.contains(&number), "{text} lacks {number}");
    }
}

#[test]
fn reserved_lengths_are_enough_even_where_nothing_is_left_over() {
    // The tightest cases: a concentration that leaves all but one segment its bare minimum, and a
    // length that is just what the minima need.
    for length in [1e6, 12_345.678, 300.0] {
        for transition in [0.0, 0.3, 0.5] {
            let mut spec = RoadSpec {
                length,
                transition,
                segment_count: 15,
                p_turn: 0.8,
                width: 0.2,
                speed: 3.0,
                step: length / 10.0,
                kerb: 0.0,
                alpha: Concentration::Same(1e-6),
                ..Default::default()
            };
            for seed in 0..100 {
                assert!(spec.generate(Seed(seed)).is_ok());
            }
            let too_short = RoadSpec { length: 0.2, step: 0.1, ..spec.clone() };
            let words = too_short.validate().unwrap_err().allowed;
            let needed: f64 = words.split(' ').nth(2).unwrap().parse().unwrap();
            (spec.length, spec.step) = (needed, 1.0);
            for seed in 0..100 {
                assert!(spec.generate(Seed(seed)).is_ok());
            }
        }
    }
}

#[test]
fn the_speed_that_an_error_names_is_the_greatest() {
    for (random, length, transition) in [(0, 1000.0, 0.0), (9, 300.0, 0.0), (3, 120.0, 0.4)] {
        let mut spec = RoadSpec {
            segment_count: random,
            length,
            transition,
            speed: 90.0,
            ..Default::default()
        };
        let error = spec.validate().unwrap_err();
        assert_eq!(error.field, "length");
        assert_eq!(error.value, length.to_string());
        let words: Vec<&str> = error.allowed.split(' ').collect();
        let needed: f64 = words[2].parse().unwrap();
        let speed: f64 = words[words.len() - 2].parse().unwrap();
        spec.length = needed + 1e-3;
        assert_eq!(spec.validate(), Ok(()));
        spec.length = needed - 2e-3;
        assert!(spec.validate().is_err());
        spec.length = length;
        spec.speed = speed;
        assert_eq!(spec.validate(), Ok(()));
        assert!(spec.generate(Seed(1)).is_ok());
        spec.speed = speed + 1e-5;
        assert!(spec.validate().is_err());
    }
    // Where the width alone asks for too much, no speed helps.
    let wide = RoadSpec { width: 100.0, length: 40.0, ..Default::default() };
    assert!(wide.validate().unwrap_err().to_string().contains("at any speed"));
    // Longer than any road.
    let fast = RoadSpec { speed: 1000.0, friction: 0.01, ..RoadSpec::default() };
    let text = fast.validate().unwrap_err().to_string();
    assert!(
        text.contains(" m, which is more than the greatest of 1000000 m, for 2 turns"),
        "{text}"
    );
}

#[test]
fn bad_settings_are_named() {
    let check = |field: &str, spec: RoadSpec| {
        let error = spec.validate().expect_err(field);
        assert_eq!(error.field, field);
        assert_eq!(spec.generate(Seed(0)), Err(RoadError::Spec(error)));
    };
    let good = RoadSpec::default;
    for alpha in [0.0, -1.0, f64::NAN, 1e-300, 1e300, f64::INFINITY] {
        check("alpha", RoadSpec { alpha: Concentration::Same(alpha), ..good() });
        let alphas = vec![1.0, 1.0, alpha, 1.0, 1.0];
        check("alpha", RoadSpec { alpha: Concentration::Each(alphas), ..good() });
    }
    check("alpha", RoadSpec { alpha: Concentration::Each(vec![1.0; 4]), ..good() });
    check("alpha", RoadSpec { alpha: Concentration::Each(Vec::new()), ..good() });
    for length in [0.0, 1e18, -1.0, f64::NAN] {
        check("length", RoadSpec { length, ..good() });
    }
    for step in [0.0, -1.0, 1e-9, 1001.0, f64::NAN] {
        check("step", RoadSpec { step, ..good() });
    }
    check("step", RoadSpec { length: 1e6, step: 0.1, ..good() });
    check("prefabs", RoadSpec { prefabs: Vec::new(), ..good() });
    check("prefabs", RoadSpec { prefabs: vec![Straight; 5000], ..good() });
    for friction in [0.0, -0.1, f64::NAN] {
        check("friction", RoadSpec { friction, ..good() });
    }
    for speed in [-1.0, f64::NAN, f64::INFINITY] {
        check("speed", RoadSpec { speed, ..good() });
    }
    check("theta_min", RoadSpec { theta_min: 60.0, theta_max: 45.0, ..good() });
    check("theta_min", RoadSpec { theta_min: 0.0, ..good() });
    check("theta_max", RoadSpec { theta_max: 360.0, ..good() });
    for width in [0.0, -3.0, f64::NAN, 1e9] {
        check("width", RoadSpec { width, ..good() });
    }
    check("lanes", RoadSpec { lanes: 0, ..good() });
    check("transition", RoadSpec { transition: 0.51, ..good() });
    check("end_y", RoadSpec { end_x: Some(1.0), ..good() });
    check("end_x", RoadSpec { end_x: Some(f64::NAN), end_y: Some(1.0), ..good() });
    check("attempts", RoadSpec { attempts: 0, ..good() });
    // No speed is no limit.
    let slow = RoadSpec { speed: 0.0, ..good() };
    assert!((0..100).all(|seed| slow.generate(Seed(seed)).is_ok()));
}

/// Far from the origin, rounding lets no thinner kerb have an area.
#[test]
fn kerbs_are_none_or_a_micrometre_wide() {
    let far = RoadSpec { length: 1e6, start_x: -1e6, start_y: 1e6, ..Default::default() };
    let near = RoadSpec { length: 60.0, speed: 5.0, ..Default::default() };
    for spec in [far, near] {
        for kerb in [0.0, 1e-6] {
            let world = RoadSpec { kerb, ..spec.clone() }.generate(Seed(1)).unwrap().to_world();
            assert_eq!(world.check(), Ok(()), "{kerb}");
            assert_eq!(world.walls.is_empty(), kerb == 0.0);
        }
        for kerb in [1e-308, 9e-7] {
            let error = RoadSpec { kerb, ..spec.clone() }.validate().unwrap_err().to_string();
            assert!(error.starts_with("`kerb` must be 0 or from 0.000001 to 0.9"), "{error}");
        }
    }
}
