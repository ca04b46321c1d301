//! Distances between hallways, and contents of rooms.

use envgen::distribution::Truncated;
use envgen::indoor::{IndoorError, IndoorLaws, IndoorSpec};
use envgen::reproduction::{Reproduction, reproduce};
use envgen::{Blueprint, Seed, Spec};
use proptest::prelude::*;
use rand_distr::Normal;

use super::{Constant, any_number, assert_same_law};

#[test]
fn spacings_follow_rand_distrs_normal_law_as_the_difficultys() {
    // Mean and deviation of the first adaptation; the limits are 4 deviations away.
    let spec = IndoorSpec { width: 30, height: 30, difficulty: 5.0, ..Default::default() };
    let law = Truncated::new(Normal::new(15.0, 3.0).unwrap(), 3.0, 29.0).unwrap();
    let raw = |laws: &IndoorLaws| -> Vec<f64> {
        let plan = |seed| spec.generate_with_laws(Seed(seed), laws).unwrap();
        (0..1500).flat_map(|seed| plan(seed).draws().unwrap().spacing_raw).collect()
    };
    assert_same_law(raw(&IndoorLaws::new()), raw(&IndoorLaws::new().spacing(law)));
}

#[test]
fn no_law_changes_nothing() {
    let spec = IndoorSpec { clearance: Some(0.9), width: 8, height: 8, ..Default::default() };
    let plan = spec.generate_with_laws(Seed(3), &IndoorLaws::new()).unwrap();
    assert_eq!(plan, spec.generate(Seed(3)).unwrap());
    assert!(!plan.is_edited());
}

#[test]
fn laws_decide_spacings_moves_and_turns() {
    let spec = IndoorSpec { clearance: Some(0.9), width: 12, height: 10, ..Default::default() };
    let still = IndoorLaws::new().spacing(Constant(4.6)).moves(Constant(0.0));
    let plan = spec.generate_with_laws(Seed(3), &still.turns(Constant(0.0))).unwrap();
    assert_eq!(plan.draws().unwrap().spacing, [5, 5]);
    assert!(!plan.rooms().is_empty());
    let world = plan.to_world();
    assert_eq!(world.check(), Ok(()));
    assert_eq!(reproduce(&world), Reproduction::Edited);
    // What stays where it was is as the catalogue has it; copies come after it.
    for placed in plan.rooms() {
        let design = spec.catalogue().get(&placed.room.name).unwrap();
        let kept = |shape| design.obstacles.iter().any(|obstacle| obstacle.shape == shape);
        let first = placed.room.obstacles.first().map(|obstacle| obstacle.shape.clone());
        assert!(first.is_none_or(kept), "{}", placed.room.name);
    }
    let set = IndoorSpec { spacing_h: Some(6), ..spec };
    let laws = IndoorLaws::new().spacing(Constant(4.0));
    let plan = set.generate_with_laws(Seed(3), &laws).unwrap();
    assert_eq!(plan.draws().unwrap().spacing, [6, 4]);
}

#[test]
fn errors_name_the_value_and_the_limits() {
    let spec = IndoorSpec {
        clearance: Some(0.9),
        width: 12,
        height: 10,
        rooms: vec!["computer lab".to_owned()],
        ..Default::default()
    };
    let error = |laws: IndoorLaws| spec.generate_with_laws(Seed(1), &laws).unwrap_err().to_string();
    for (value, text) in [(f64::NAN, "NaN"), (2.9, "2.9"), (11.5, "11.5"), (-1.0, "-1.0")] {
        let start = "the law of `spacing` must give numbers from 3 to 11 cells, got";
        assert_eq!(error(IndoorLaws::new().spacing(Constant(value))), format!("{start} {text}"));
    }
    for (value, text) in [(f64::NAN, "NaN"), (193.0, "193.0"), (f64::INFINITY, "inf")] {
        let start = "the law of `moves` must give numbers from -192 to 192 m, got";
        assert_eq!(error(IndoorLaws::new().moves(Constant(value))), format!("{start} {text}"));
    }
    for (value, text) in [(f64::NAN, "NaN"), (-1001.0, "-1001.0")] {
        let start = "the law of `turns` must give numbers from -1000 to 1000 radians, got";
        assert_eq!(error(IndoorLaws::new().turns(Constant(value))), format!("{start} {text}"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn any_law_gives_a_plan_or_an_error(
        spacing in prop_oneof![any_number(), 2.0..7.0_f64],
        moves in any_number(),
        turns in any_number(),
        seed: u64,
    ) {
        let spec = IndoorSpec {
            width: 7,
            height: 7,
            clearance: Some(1.0),
            ..Default::default()
        };
        let laws = IndoorLaws::new()
            .spacing(Constant(spacing))
            .moves(Constant(moves))
            .turns(Constant(turns));
        match spec.generate_with_laws(Seed(seed), &laws) {
            Ok(plan) => {
                prop_assert!((3.0..=6.0).contains(&spacing));
                prop_assert_eq!(plan.to_world().check(), Ok(()));
            }
            Err(IndoorError::Spacing { value, max }) => {
                prop_assert_eq!((value.to_bits(), max), (spacing.to_bits(), 6));
            }
            Err(IndoorError::Move { value, .. }) => {
                prop_assert_eq!(value.to_bits(), moves.to_bits());
            }
            Err(IndoorError::Turn { value, .. }) => {
                prop_assert_eq!(value.to_bits(), turns.to_bits());
            }
            Err(other) => panic!("{other}"),
        }
    }
}
