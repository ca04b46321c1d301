//! Lengths of segments, and turns.

use envgen::reproduction::{Reproduction, reproduce};
use envgen::road::{
    Concentration, Crossing, Lengths, Prefab, Road, RoadError, RoadLaws, RoadSpec, TurnLaw,
};
use envgen::{Blueprint, Seed, Spec};
use proptest::prelude::*;
use rand_distr::{Gamma, Uniform};

use super::{Constant, any_number, assert_same_law};

const ROADS: u64 = 4000;

/// Four straights with lengths as published.
fn published() -> RoadSpec {
    RoadSpec {
        prefabs: vec![Prefab::Straight; 4],
        lengths: Lengths::AsPublished,
        step: 100.0,
        kerb: 0.0,
        ..Default::default()
    }
}

fn each(spec: &RoadSpec, laws: &RoadLaws, value: impl Fn(&Road) -> f64) -> Vec<f64> {
    let road = |seed| spec.generate_with_laws(Seed(seed), laws).unwrap();
    (0..ROADS).map(|seed| value(&road(seed))).collect()
}

#[test]
fn gamma_lengths_are_dirichlets() {
    for alpha in [0.3, 1.0, 5.0] {
        let spec = RoadSpec { alpha: Concentration::Same(alpha), ..published() };
        let gamma = RoadLaws::new().lengths(Gamma::new(alpha, 3.0).unwrap());
        let first = |road: &Road| road.segments()[0].length;
        let ours = each(&spec, &RoadLaws::new(), first);
        assert_same_law(ours, each(&spec, &gamma, first));
    }
}

#[test]
fn uniform_turns_are_the_specs() {
    for turns in [TurnLaw::UniformRadius, TurnLaw::UniformAngle] {
        let spec = RoadSpec {
            prefabs: vec![Prefab::Straight, Prefab::Left, Prefab::Straight],
            turn_law: turns,
            speed: 10.0,
            ..Default::default()
        };
        let uniform = RoadLaws::new().turns(Uniform::new(0.0, 1.0).unwrap());
        let angle = |road: &Road| road.segments()[1].angle;
        assert_same_law(each(&spec, &RoadLaws::new(), angle), each(&spec, &uniform, angle));
    }
}

#[test]
fn shares_of_0_and_1_are_the_limits() {
    for (share, turns) in [
        (0.0, TurnLaw::UniformRadius),
        (1.0, TurnLaw::UniformRadius),
        (0.0, TurnLaw::UniformAngle),
        (1.0, TurnLaw::UniformAngle),
    ] {
        let spec = RoadSpec { turn_law: turns, speed: 10.0, ..Default::default() };
        let laws = RoadLaws::new().turns(Constant(share));
        let road = spec.generate_with_laws(Seed(4), &laws).unwrap();
        for turn in road.segments().iter().filter(|segment| segment.kind.is_turn()) {
            let (least, greatest) = spec.turn_limits().radii(turn.length);
            let wide = (share == 1.0) == (turns == TurnLaw::UniformRadius);
            let expected = if wide { greatest } else { least };
            let radius = turn.radius.unwrap();
            assert!((radius / expected - 1.0).abs() < 1e-12, "{radius}, not {expected}");
        }
    }
}

#[test]
fn equal_weights_make_equal_lengths() {
    for weight in [5e-324, 1.0, 1e308] {
        let laws = RoadLaws::new().lengths(Constant(weight));
        let road = published().generate_with_laws(Seed(1), &laws).unwrap();
        for segment in road.segments() {
            assert!((segment.length - 250.0).abs() < 1e-9, "{weight}: {}", segment.length);
        }
    }
}

#[test]
fn no_law_changes_nothing() {
    let closed = RoadSpec { closed: true, segment_count: 8, p_turn: 0.7, ..Default::default() };
    for spec in [RoadSpec::default(), RoadSpec::sbft(), closed] {
        let road = spec.generate_with_laws(Seed(3), &RoadLaws::new());
        assert_eq!(road, spec.generate(Seed(3)));
        assert!(!road.is_ok_and(|road| road.edited()));
    }
}

#[test]
fn circuits_and_drawn_again_roads_keep_their_limits() {
    let law = Uniform::new_inclusive(0.2, 1.0).unwrap();
    let laws = RoadLaws::new().lengths(law).turns(law);
    let circuit = RoadSpec {
        closed: true,
        prefabs: [Prefab::Straight, Prefab::Left].repeat(4),
        theta_max: 150.0,
        speed: 8.0,
        ..Default::default()
    };
    let mut made = 0;
    for spec in [circuit, RoadSpec::sbft()] {
        for seed in 0..10 {
            let Ok(road) = spec.generate_with_laws(Seed(seed), &laws) else { continue };
            let limits = spec.turn_limits();
            for turn in road.segments().iter().filter(|segment| segment.kind.is_turn()) {
                assert!(turn.radius.unwrap() >= limits.least_radius * (1.0 - 1e-9));
            }
            let world = road.to_world();
            assert_eq!(world.check(), Ok(()));
            assert_eq!(reproduce(&world), Reproduction::Edited);
            made += 1;
        }
    }
    assert!(made > 10, "{made}");
}

#[test]
fn errors_name_the_value_and_what_is_allowed() {
    // At once, also where a road would be drawn again.
    let resampled = RoadSpec { crossing: Crossing::Resample, ..Default::default() };
    for spec in [RoadSpec::default(), resampled] {
        let error =
            |laws: RoadLaws| spec.generate_with_laws(Seed(1), &laws).unwrap_err().to_string();
        let lengths = |value| error(RoadLaws::new().lengths(Constant(value)));
        let turns = |value| error(RoadLaws::new().turns(Constant(value)));
        for (value, text) in [(f64::NAN, "NaN"), (f64::INFINITY, "inf"), (-0.5, "-0.5")] {
            let start = "the law of `lengths` must give finite numbers of at least 0, got";
            assert_eq!(lengths(value), format!("{start} {text} for segment 1"));
        }
        let text = "the law of `lengths` must give a number over 0 for at least one of the 5 \
                    segments, got 0 for all";
        assert_eq!(lengths(0.0), text);
        for (value, text) in [(f64::NAN, "NaN"), (1.5, "1.5"), (-1e300, "-1e300")] {
            let start = "the law of `turns` must give numbers from 0 to 1, got";
            assert_eq!(turns(value), format!("{start} {text} for segment 2"));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_law_gives_a_road_or_an_error(
        length in any_number(), turn in any_number(), seed: u64, closed: bool,
    ) {
        let spec = RoadSpec { closed, segment_count: 6, ..Default::default() };
        let laws = RoadLaws::new().lengths(Constant(length)).turns(Constant(turn));
        match spec.generate_with_laws(Seed(seed), &laws) {
            Ok(road) => {
                prop_assert!(length > 0.0 && length.is_finite());
                let sum: f64 = road.segments().iter().map(|segment| segment.length).sum();
                prop_assert_eq!(sum, spec.length);
            }
            Err(RoadError::LengthLaw { value, .. }) => {
                prop_assert_eq!(value.to_bits(), length.to_bits());
            }
            Err(RoadError::TurnLaw { value, .. }) => {
                prop_assert_eq!(value.to_bits(), turn.to_bits());
            }
            Err(RoadError::NoLengths { .. }) => {
                prop_assert_eq!(length, 0.0);
            }
            Err(
                RoadError::NoFullTurn { .. }
                | RoadError::LeadsAway { .. }
                | RoadError::NotClosed { .. },
            ) => prop_assert!(closed),
            Err(other) => panic!("{other}"),
        }
    }
}
