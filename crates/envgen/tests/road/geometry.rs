//! Segments, ends, aims, circuits and crossings.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use envgen::curve::overlap::strip_overlap;
use envgen::glam::DVec2;
use envgen::road::{Crossing, GRAVITY, Lengths, Prefab, RoadError, RoadSpec};
use envgen::{Blueprint, Seed, Spec};
use proptest::prelude::*;

use envgen::road::Prefab::{Left, Right, Straight};

use super::{SEEDS, closed_form_end, generate, turns};

#[test]
fn every_road_keeps_what_it_promises() {
    let spec = RoadSpec::default();
    for seed in 0..SEEDS {
        let road = generate(&spec, seed);
        let sum: f64 = road.segments().iter().map(|segment| segment.length).sum();
        assert_eq!(sum, 1000.0, "seed {seed}");
        for turn in turns(&road) {
            let radius = turn.radius.unwrap();
            let angle = (turn.length / radius).to_degrees();
            assert!((30.0 - 1e-9..=90.0 + 1e-9).contains(&angle), "seed {seed}: {angle}");
            let force = spec.speed * spec.speed * turn.curvature.abs();
            assert!(force <= GRAVITY * spec.friction * (1.0 + 1e-12), "seed {seed}: {force}");
            assert!(radius >= 0.5 * spec.width + 1.0);
        }
        let (p, heading) = closed_form_end(&road);
        let end = road.end();
        assert!(end.position.distance(p) < 1e-9 && (end.heading - heading).abs() < 1e-12);
        assert_eq!(road.waypoints().len(), 1000);
        assert_eq!(road.segments().iter().map(|s| s.waypoints).sum::<u64>(), 1000);
        assert_eq!(road.waypoints()[0].pose, spec.start());
    }
}

#[test]
fn waypoints_lie_on_the_curve_and_on_their_segment() {
    for (lengths, transition) in
        [(Lengths::Reserve, 0.0), (Lengths::Reserve, 0.3), (Lengths::AsPublished, 0.0)]
    {
        let spec = RoadSpec {
            lengths,
            transition,
            speed: 8.0,
            step: 0.7,
            segment_count: 9,
            ..Default::default()
        };
        for seed in 0..200 {
            let Ok(road) = spec.generate(Seed(seed)) else {
                assert_eq!(lengths, Lengths::AsPublished);
                continue;
            };
            let mut waypoints = road.waypoints().iter().enumerate();
            for segment in road.segments() {
                for k in 0..segment.waypoints {
                    let (j, point) = waypoints.next().unwrap();
                    let s = match lengths {
                        Lengths::Reserve => j as f64 * road.step(),
                        Lengths::AsPublished => {
                            segment.start + segment.length * (k as f64 / segment.waypoints as f64)
                        }
                    };
                    let s = if j == 0 { 0.0 } else { s };
                    let pose = road.pose_at(s);
                    assert!(pose.position.distance(point.pose.position) < 1e-9);
                    assert!((pose.heading - point.pose.heading).abs() < 1e-12);
                    if transition == 0.0 && j > 0 {
                        assert_eq!(point.curvature, segment.curvature, "seed {seed}, {j}");
                    } else {
                        let most = segment.curvature.abs() * (1.0 + 1e-12);
                        assert!(point.curvature.abs() <= most);
                    }
                }
            }
            assert!(waypoints.next().is_none());
        }
    }
}

#[test]
fn the_step_changes_nothing_but_the_waypoints() {
    for lengths in [Lengths::Reserve, Lengths::AsPublished] {
        for transition in [0.0, 0.2] {
            for seed in 0..300 {
                let of = |step: f64| {
                    let spec = RoadSpec { step, lengths, transition, ..Default::default() };
                    spec.generate(Seed(seed))
                };
                let Ok(fine) = of(0.1) else {
                    assert!(of(1.0).is_err() && of(10.0).is_err());
                    continue;
                };
                for step in [1.0, 10.0] {
                    let coarse = of(step).unwrap();
                    assert_eq!(coarse.end(), fine.end());
                    for (a, b) in coarse.segments().iter().zip(fine.segments()) {
                        assert_eq!((a.radius, a.length), (b.radius, b.length));
                    }
                    assert_eq!(coarse.waypoints().len() as f64 * step, 1000.0);
                }
            }
        }
    }
}

#[test]
fn transitions_ramp_the_curvature() {
    for transition in [0.1, 0.5] {
        let spec = RoadSpec { transition, ..Default::default() };
        for seed in 0..300 {
            let road = generate(&spec, seed);
            for turn in turns(&road) {
                let peak = turn.angle.abs() / ((1.0 - transition) * turn.length);
                assert!((turn.curvature.abs() - peak).abs() < 1e-12);
                assert!(spec.speed * spec.speed * peak <= GRAVITY * spec.friction * (1.0 + 1e-12));
                assert!((turn.radius.unwrap() * peak - 1.0).abs() < 1e-12);
                let ramp = transition * turn.length;
                for i in 0..=50 {
                    let t = turn.length * f64::from(i) / 50.0;
                    let expected = (t / ramp).min((turn.length - t) / ramp).min(1.0);
                    let seen = road.curvature_at(turn.start + t) / turn.curvature;
                    let at_end = i == 50 || i == 0;
                    assert!(at_end || (seen - expected).abs() < 1e-6, "{seen} {expected}");
                }
                let before = road.pose_at(turn.start).heading;
                let after = road.pose_at(turn.start + turn.length).heading;
                assert!((after - before - turn.angle).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn an_aimed_road_ends_there() {
    let mut reached = 0;
    for seed in 0..500 {
        let spec = RoadSpec { segment_count: 12, p_turn: 0.4, speed: 8.0, ..Default::default() };
        let plain = generate(&spec, seed);
        let aim = DVec2::new(500.0, 150.0);
        let spec = RoadSpec { end_x: Some(aim.x), end_y: Some(aim.y), ..spec };
        match spec.generate(Seed(seed)) {
            Ok(road) => {
                reached += 1;
                assert!(road.end().position.distance(aim) < 1e-9);
                let (end, heading) = (road.end(), plain.end().heading);
                assert!((end.heading - heading).abs() < 1e-12);
                for (a, b) in road.segments().iter().zip(plain.segments()) {
                    assert_eq!((a.kind, a.radius), (b.kind, b.radius));
                    assert!(a.kind.is_turn() && a.length == b.length || a.length >= 1.0);
                }
                assert_eq!(road.waypoints().len() as f64, road.length().round());
            }
            Err(RoadError::Unreachable { x, y, .. }) => {
                assert_eq!((x, y), (aim.x, aim.y));
            }
            Err(error) => panic!("{error}"),
        }
    }
    assert!((100..500).contains(&reached), "{reached}");
}

#[test]
fn circuits_close() {
    let lists: [&[Prefab]; 4] = [
        &[Straight, Left, Straight, Left, Straight, Left, Straight, Left],
        &[Left, Left, Left, Left, Left],
        &[Straight, Right, Right, Straight, Right, Left, Right, Straight, Right, Right, Right],
        &[Straight, Left, Left, Left, Left, Straight, Right, Right, Right, Right],
    ];
    for (i, prefabs) in lists.into_iter().enumerate() {
        for transition in [0.0, 0.25] {
            let spec = RoadSpec {
                prefabs: prefabs.to_vec(),
                closed: true,
                speed: 10.0,
                transition,
                start_x: 30.0,
                start_heading: 20.0,
                ..Default::default()
            };
            for seed in 0..50 {
                let road = generate(&spec, seed);
                let (start, end) = (spec.start(), road.end());
                assert!(end.position.distance(start.position) < 1e-9, "list {i}, seed {seed}");
                let around = (end.heading - start.heading) / TAU;
                assert!((around - around.round()).abs() * TAU < 1e-9);
                assert!((road.length() - 1000.0).abs() < 1e-9);
                let least = spec.turn_limits().least_radius * (1.0 - 1e-12);
                for segment in road.segments() {
                    assert!(segment.length >= 1.0 - 1e-12);
                    if let Some(radius) = segment.radius {
                        let angle = segment.angle.abs().to_degrees();
                        assert!(radius >= least && (30.0 - 1e-9..=90.0 + 1e-9).contains(&angle));
                    }
                }
                assert!(road.to_world().check().is_ok());
            }
        }
    }
}

#[test]
fn roads_with_turns_that_are_too_short_are_drawn_again() {
    let spec = RoadSpec { lengths: Lengths::AsPublished, speed: 25.0, ..Default::default() };
    let again = RoadSpec { crossing: Crossing::Resample, ..spec.clone() };
    let short =
        |seed: &u64| matches!(spec.generate(Seed(*seed)), Err(RoadError::TurnTooShort { .. }));
    let seeds: Vec<u64> = (0..40).filter(short).collect();
    assert!(seeds.len() > 3, "{seeds:?}");
    for seed in seeds {
        again.generate(Seed(seed)).unwrap();
    }
}

#[test]
fn rejected_and_resampled_roads_do_not_cross() {
    let spec = RoadSpec {
        length: 900.0,
        segment_count: 24,
        p_turn: 0.9,
        speed: 6.0,
        step: 5.0,
        ..Default::default()
    };
    let (mut crossed, mut retried) = (0, 0);
    for seed in 0..300 {
        let allowed = generate(&spec, seed);
        let crosses = strip_overlap(allowed.path(), 3.5, false).is_some();
        assert_eq!(allowed.metrics().crosses_itself, crosses);
        let rejecting = RoadSpec { crossing: Crossing::Reject, ..spec.clone() };
        match rejecting.generate(Seed(seed)) {
            Ok(road) => assert!(!crosses && road.segments() == allowed.segments()),
            Err(RoadError::Crossing { first, second }) => {
                assert!(crosses && first < second);
                crossed += 1;
            }
            Err(error) => panic!("{error}"),
        }
        let resampling = RoadSpec { crossing: Crossing::Resample, ..spec.clone() };
        let road = generate(&resampling, seed);
        assert!(strip_overlap(road.path(), 3.5, false).is_none());
        // The first attempt is the road that the other modes draw.
        assert_eq!(road.attempts() == 1, !crosses);
        assert!(!crosses || road.segments() != allowed.segments());
        retried += u64::from(road.attempts() > 1);
    }
    assert!(crossed > 30 && retried == crossed, "{crossed} crossed");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn a_heading_span_under_pi_never_crosses(
        seed: u64, speed in 0.0..20.0_f64, transition in 0.0..=0.5_f64,
    ) {
        // The fast accept against the normals themselves.
        let prefabs = vec![Straight, Left, Right, Straight, Right, Left, Straight, Right, Left];
        let spec = RoadSpec { prefabs, length: 600.0, speed, transition, ..Default::default() };
        let Ok(road) = spec.generate(Seed(seed)) else { return Ok(()) };
        let (low, high) = road.path().headings();
        prop_assume!(high - low < PI && high - low > FRAC_PI_2);
        let stations: Vec<f64> = (0..=300).map(|i| f64::from(i) * 2.0).collect();
        let (left, right) = (road.path().offset_curve(3.5, &stations), road.path().offset_curve(-3.5, &stations));
        for i in 0..stations.len() {
            for j in i + 1..stations.len() {
                prop_assert!(!envgen::geometry::segments_cross(left[i], right[i], left[j], right[j]));
            }
        }
    }
}
