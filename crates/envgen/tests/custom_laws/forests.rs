//! Radii of trees.

use envgen::distribution::Truncated;
use envgen::forest::{Border, DensityMap, ForestError, ForestLaws, ForestSpec, RadiusLaw};
use envgen::reproduction::{Reproduction, reproduce};
use envgen::{Blueprint, Seed, Spec};
use proptest::prelude::*;
use rand_distr::{LogNormal, Uniform};

use super::{Constant, any_number, assert_same_law};

/// About 2500 trees of small trunks.
fn wide() -> ForestSpec {
    ForestSpec {
        width: 250.0,
        height: 200.0,
        radius: 0.2,
        radius_min: 0.1,
        radius_max: 0.6,
        ..Default::default()
    }
}

fn radii(spec: &ForestSpec, laws: &ForestLaws) -> Vec<f64> {
    let radii = |seed| {
        let forest = spec.generate_with_laws(Seed(seed), laws).unwrap();
        forest.trees().iter().map(|tree| tree.radius).collect::<Vec<_>>()
    };
    (0..8).flat_map(radii).collect()
}

#[test]
fn radii_follow_rand_distrs_laws_as_they_follow_the_specs() {
    let none = ForestLaws::new();
    let spec = ForestSpec { radius_law: RadiusLaw::Uniform, ..wide() };
    let uniform = ForestLaws::new().radii(Uniform::new(0.1, 0.6).unwrap());
    assert_same_law(radii(&spec, &none), radii(&wide(), &uniform));

    let spec = ForestSpec { radius_law: RadiusLaw::LogNormal, ..wide() };
    let law = LogNormal::new(libm::log(0.2), spec.radius_sigma).unwrap();
    let log_normal = ForestLaws::new().radii(Truncated::new(law, 0.1, 0.6).unwrap());
    assert_same_law(radii(&spec, &none), radii(&wide(), &log_normal));
}

#[test]
fn no_law_changes_nothing() {
    let density = DensityMap { rows: vec![vec![0.0, 1.0], vec![2.0, 0.5]] };
    let map = ForestSpec { density: Some(density), ..wide() };
    let spaced = ForestSpec { min_distance: 2.0, border: Border::Torus, ..wide() };
    for spec in [wide(), map, spaced] {
        let forest = spec.generate_with_laws(Seed(3), &ForestLaws::new()).unwrap();
        assert_eq!(forest, spec.generate(Seed(3)).unwrap());
        assert!(!forest.edited());
    }
}

#[test]
fn only_the_radii_differ() {
    let law = Constant(0.25);
    for min_distance in [0.0, 2.0] {
        let spec = ForestSpec { min_distance, ..wide() };
        let own = spec.generate(Seed(5)).unwrap();
        let forest = spec.generate_with_laws(Seed(5), &ForestLaws::new().radii(&law)).unwrap();
        assert_eq!(forest.trees().len(), own.trees().len());
        for (tree, own) in forest.trees().iter().zip(own.trees()) {
            assert_eq!((tree.center, tree.radius, own.radius), (own.center, 0.25, 0.2));
        }
    }
}

#[test]
fn a_density_replaces_the_intensity_beside_it() {
    let spec = wide();
    let west = (0.1, |p: envgen::glam::DVec2| if p.x < 100.0 { 0.1 } else { 0.0 });
    let of_density = spec.generate_with(Seed(2), &west).unwrap();
    let laws = ForestLaws::new().density(&west);
    assert_eq!(spec.generate_with_laws(Seed(2), &laws).unwrap(), of_density);
    let forest = spec.generate_with_laws(Seed(2), &laws.radii(Constant(0.3))).unwrap();
    assert_eq!(forest.trees().len(), of_density.trees().len());
    assert!(forest.trees().iter().all(|tree| tree.center.x < 100.0 && tree.radius == 0.3));
}

#[test]
fn the_world_is_sound_and_marked_as_edited() {
    let laws = ForestLaws::new().radii(Uniform::new(0.1, 0.6).unwrap());
    for border in [Border::Open, Border::Inset, Border::Torus] {
        let spec = ForestSpec { border, clearing: 2.0, min_distance: 1.0, ..wide() };
        let forest = spec.generate_with_laws(Seed(1), &laws).unwrap();
        let world = forest.to_world();
        assert_eq!(world.check(), Ok(()));
        assert!(forest.edited() && world.provenance.edited);
        assert_eq!(reproduce(&world), Reproduction::Edited);
        let metrics = forest.metrics();
        // lambda pi E[(r + rho)^2] of 0.1 to 0.6 m and a robot of 0.36 m: 0.0808, with 2500 trees
        // within 4 standard errors of it.
        let expected = 0.05 * std::f64::consts::PI * (0.43 / 3.0 + 0.252 + 0.1296);
        assert!((metrics.reduced_density - expected).abs() < 0.004, "{metrics:?}");
        assert_eq!((metrics.cover_predicted, metrics.free_path_predicted), (None, None));
    }
}

#[test]
fn a_forest_without_trees_needs_no_radius() {
    let spec = ForestSpec { intensity: 0.0, ..Default::default() };
    let laws = ForestLaws::new().radii(Constant(f64::NAN));
    let forest = spec.generate_with_laws(Seed(1), &laws).unwrap();
    assert_eq!(forest.metrics().reduced_density, 0.0);
    assert_eq!(forest.to_world().check(), Ok(()));
}

#[test]
fn errors_name_the_value_and_the_limits() {
    let error = |spec: &ForestSpec, value| {
        let laws = ForestLaws::new().radii(Constant(value));
        spec.generate_with_laws(Seed(1), &laws).unwrap_err().to_string()
    };
    let limits = "the law of `radii` must give numbers from 0.1 to 0.6 m, `radius_min` to \
                  `radius_max`, got";
    for (value, text) in [
        (f64::NAN, "NaN"),
        (f64::INFINITY, "inf"),
        (-1.0, "-1.0"),
        (0.0, "0.0"),
        (0.7, "0.7"),
        (1e300, "1e300"),
    ] {
        assert_eq!(error(&wide(), value), format!("{limits} {text}"));
    }
    let crossed = ForestSpec { radius_min: 1.0, ..wide() };
    let text = error(&crossed, 0.5);
    assert_eq!(text, "`radius_min` must be at most radius_max, which is 0.6 m, got 1");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_law_gives_a_forest_or_an_error(value in any_number(), seed: u64) {
        let spec = ForestSpec { radius_min: 0.5, radius_max: 2.0, ..Default::default() };
        let laws = ForestLaws::new().radii(Constant(value));
        match spec.generate_with_laws(Seed(seed), &laws) {
            Ok(forest) => {
                prop_assert!((0.5..=2.0).contains(&value) || forest.trees().is_empty());
                prop_assert_eq!(forest.to_world().check(), Ok(()));
            }
            Err(ForestError::Radius { value: named, min, max }) => {
                prop_assert_eq!(named.to_bits(), value.to_bits());
                prop_assert_eq!((min, max), (0.5, 2.0));
                prop_assert!(!(0.5..=2.0).contains(&value));
            }
            Err(other) => panic!("{other}"),
        }
    }
}
