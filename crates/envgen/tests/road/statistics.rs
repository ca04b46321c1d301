//! Lengths and angles against their laws.

use std::f64::consts::PI;

use envgen::road::{Concentration, Lengths, Road, RoadError, RoadSpec, SegmentKind, TurnLaw};
use envgen::{Blueprint, Seed, Spec};

use envgen::road::Prefab::{Straight, Turn};

use super::{SEEDS, generate};

#[test]
fn proportions_have_dirichlets_mean_and_variance() {
    // 5 standard errors each, of which there are 32: false-alarm rate under 1e-4.
    let n = SEEDS as f64;
    for alpha in [
        Concentration::Same(0.3),
        Concentration::Same(1.0),
        Concentration::Same(5.0),
        Concentration::Each(vec![0.5, 1.0, 2.0, 4.0]),
    ] {
        let spec = RoadSpec {
            prefabs: vec![Straight; 4],
            lengths: Lengths::AsPublished,
            alpha: alpha.clone(),
            step: 100.0,
            kerb: 0.0,
            ..Default::default()
        };
        let roads: Vec<Road> = (0..SEEDS).map(|seed| generate(&spec, seed)).collect();
        let total: f64 = (0..4).map(|i| alpha.of(i)).sum();
        for i in 0..4 {
            let p: Vec<f64> = roads.iter().map(|road| road.segments()[i].length / 1000.0).collect();
            let expected = alpha.of(i) / total;
            let variance = alpha.of(i) * (total - alpha.of(i)) / (total * total * (total + 1.0));
            let mean = p.iter().sum::<f64>() / n;
            let error = 5.0 * (variance / n).sqrt();
            assert!((mean - expected).abs() < error, "{alpha:?}: mean {mean}, not {expected}");
            let squares: Vec<f64> = p.iter().map(|p| (p - expected) * (p - expected)).collect();
            let seen = squares.iter().sum::<f64>() / n;
            let spread = squares.iter().map(|s| (s - seen) * (s - seen)).sum::<f64>() / n;
            let error = 5.0 * (spread / n).sqrt();
            assert!((seen - variance).abs() < error, "{alpha:?}: variance {seen}, not {variance}");
        }
    }
}

#[test]
fn a_great_concentration_shares_out_evenly() {
    let spec = RoadSpec {
        lengths: Lengths::AsPublished,
        alpha: Concentration::Same(1e12),
        ..Default::default()
    };
    for seed in 0..100 {
        let road = generate(&spec, seed);
        for segment in road.segments() {
            assert!((segment.length - 200.0).abs() < 2e-3, "{}", segment.length);
            assert_eq!(segment.waypoints, 200);
        }
    }
}

#[test]
fn published_lengths_fail_as_often_as_their_law_says() {
    // 1 - (1 - 2 a)^4 with a = theta_min R_low / L; 5 sigma, false-alarm rate under 1e-6 each.
    for (kmh, expected) in [(50.0, 0.1126), (100.0, 0.3940)] {
        let spec = RoadSpec {
            speed: kmh / 3.6,
            lengths: Lengths::AsPublished,
            step: 10.0,
            ..Default::default()
        };
        let mut failed = 0;
        for seed in 0..SEEDS {
            if let Err(error) = spec.generate(Seed(seed)) {
                let RoadError::TurnTooShort { segment, .. } = error else {
                    panic!("{error}");
                };
                assert!(segment == 2 || segment == 4);
                failed += 1;
            }
        }
        let share = f64::from(failed) / SEEDS as f64;
        let error = 5.0 * (expected * (1.0 - expected) / SEEDS as f64).sqrt();
        assert!((share - expected).abs() < error, "{kmh} km/h: {share}");
    }
}

#[test]
fn angles_follow_their_law() {
    // P(theta <= x) = (6 - pi / x) / 4 where friction and width do not bind, and uniform where that
    // is asked for: chi-square with 19 degrees of freedom, false-alarm rate 1e-4 (critical 50.8).
    for turns in [TurnLaw::UniformRadius, TurnLaw::UniformAngle] {
        let spec = RoadSpec {
            prefabs: vec![Turn],
            speed: 0.0,
            width: 1.0,
            length: 100.0,
            step: 100.0,
            kerb: 0.0,
            turn_law: turns,
            ..Default::default()
        };
        let mut counts = [0_u32; 20];
        let mut sum = 0.0;
        let mut lefts = 0;
        let mut angles = Vec::new();
        for seed in 0..SEEDS {
            let road = generate(&spec, seed);
            let segment = road.segments()[0];
            let angle = segment.angle.abs();
            let p = match turns {
                TurnLaw::UniformRadius => (6.0 - PI / angle) / 4.0,
                TurnLaw::UniformAngle => (angle - PI / 6.0) / (PI / 3.0),
            };
            counts[((p * 20.0) as usize).min(19)] += 1;
            sum += angle;
            lefts += u32::from(segment.kind == SegmentKind::Left);
            angles.push(angle);
        }
        let chi2: f64 = counts.iter().map(|&c| (f64::from(c) - 500.0).powi_2() / 500.0).sum();
        assert!(chi2 < 50.8, "{turns:?}: chi-square {chi2} of {counts:?}");
        angles.sort_by(f64::total_cmp);
        let median = angles[SEEDS as usize / 2].to_degrees();
        let mean = (sum / SEEDS as f64).to_degrees();
        // Standard errors: of the median 0.5 / (density 1.273 sqrt n) rad = 0.225 degrees, of the
        // mean 0.165; 5 of them.
        let (at_median, at_mean) = match turns {
            TurnLaw::UniformRadius => (45.0, (0.25 * PI * libm::log(3.0)).to_degrees()),
            TurnLaw::UniformAngle => (60.0, 60.0),
        };
        assert!((median - at_median).abs() < 1.5, "{median}");
        assert!((mean - at_mean).abs() < 0.9, "{mean}");
        // A fair bit: 5 sigma.
        assert!(lefts.abs_diff(5000) < 250, "{lefts} to the left");
    }
}

trait Square {
    fn powi_2(self) -> f64;
}

impl Square for f64 {
    fn powi_2(self) -> f64 {
        self * self
    }
}

#[test]
fn metrics_of_zero_are_not_negative() {
    // A road without turns, and one without straights.
    for (prefab, parts) in [(Straight, "turning"), (Turn, "straight_share")] {
        let spec = RoadSpec { prefabs: vec![prefab; 2], ..Default::default() };
        let metrics = serde_json::to_value(generate(&spec, 1).metrics()).unwrap();
        assert_eq!(metrics[parts].to_string(), "0.0", "{metrics}");
    }
}
