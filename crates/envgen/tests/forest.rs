//! Poisson forests against the oracles of their theory. Seeds are fixed; each tolerance states its
//! false-alarm rate.

use envgen::forest::{Border, DensityMap, Forest, ForestError, ForestSpec, RadiusLaw};
use envgen::glam::DVec2;
use envgen::world::{Digest, Tree};
use envgen::{Blueprint, Seed, Spec};
use proptest::prelude::*;

fn generate(spec: &ForestSpec, seed: u64) -> Forest {
    spec.generate(Seed(seed)).unwrap()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn variance(values: &[f64]) -> f64 {
    let mean = mean(values);
    values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (values.len() - 1) as f64
}

/// The least distance between two centres, by comparing each with each.
fn least_distance(trees: &[Tree], torus: Option<DVec2>) -> f64 {
    let mut least = f64::INFINITY;
    for (i, a) in trees.iter().enumerate() {
        for b in &trees[i + 1..] {
            let mut d = (a.center - b.center).abs();
            if let Some(size) = torus {
                d = d.min(size - d);
            }
            least = least.min(d.length());
        }
    }
    least
}

#[test]
fn narrow_forests_have_a_cover_too() {
    for (width, height) in [(1000.0, 1.9), (1.9, 1000.0), (20_000.0, 3.0)] {
        let spec = ForestSpec { width, height, intensity: 0.2, radius: 0.3, ..Default::default() };
        let covers: Vec<f64> = (0..20).map(|seed| generate(&spec, seed).metrics().cover).collect();
        // Without the trunks whose middle is outside. The standard error of the mean is below 2 %.
        let (found, expected) =
            (mean(&covers), 1.0 - libm::exp(-0.2 * std::f64::consts::PI * 0.09));
        assert!((0.6 * expected..1.1 * expected).contains(&found), "{found} of {expected}");
    }
}

#[test]
fn counts_are_poisson() {
    let spec = ForestSpec { width: 40.0, height: 25.0, ..Default::default() };
    let counts: Vec<f64> =
        (0..10_000).map(|seed| generate(&spec, seed).trees().len() as f64).collect();
    // Mean 50: 5 standard errors of sqrt(50 / 10,000). Variance / mean: the specification's 0.06 is
    // 4.2 sigma.
    assert!((mean(&counts) - 50.0).abs() < 0.354, "{}", mean(&counts));
    let ratio = variance(&counts) / mean(&counts);
    assert!((ratio - 1.0).abs() < 0.06, "{ratio}");
}

#[test]
fn places_are_uniform() {
    // Chi-square over a grid of 8 x 5, 39 degrees of freedom, false-alarm rate 1e-5 (critical 89.7).
    let spec = ForestSpec {
        width: 40.0,
        height: 25.0,
        intensity: 40.0,
        robot_radius: 0.0,
        radius: 0.1,
        ..Default::default()
    };
    let forest = generate(&spec, 5);
    let mut counts = [0.0; 40];
    for tree in forest.trees() {
        counts[(tree.center.x / 5.0) as usize + 8 * (tree.center.y / 5.0) as usize] += 1.0;
    }
    let expected = forest.trees().len() as f64 / 40.0;
    let chi2: f64 = counts.iter().map(|c| (c - expected) * (c - expected) / expected).sum();
    assert!(chi2 < 89.7, "{chi2}");
}

#[test]
fn figure_two_covers_touches_and_spaces_as_predicted() {
    // A torus has no border to correct for. 400 forests of 500 trees; the tolerances are 5 standard
    // errors as measured between forests.
    let spec =
        ForestSpec { width: 100.0, height: 100.0, border: Border::Torus, ..Default::default() };
    let metrics: Vec<_> = (0..400).map(|seed| generate(&spec, seed).metrics()).collect();
    let check = |name: &str, values: Vec<f64>, expected: f64| {
        let error = 5.0 * (variance(&values) / values.len() as f64).sqrt();
        let mean = mean(&values);
        assert!((mean - expected).abs() < error, "{name}: {mean} +- {error}, not {expected}");
    };
    check("cover", metrics.iter().map(|m| m.cover).collect(), 0.1454);
    check("untouched", metrics.iter().filter_map(|m| m.untouched).collect(), 0.5335);
    check("nearest neighbour", metrics.iter().filter_map(|m| m.nearest_neighbour).collect(), 2.238);
    let m = &metrics[0];
    assert!((m.cover_predicted.unwrap() - 0.1454).abs() < 1e-4);
    assert!((m.untouched_predicted.unwrap() - 0.5335).abs() < 1e-3);
    // 1 / (2 sqrt lambda) = 2.23607 for a tree of an endless forest. Of n trees one has n - 1 neighbours,
    // and n is drawn: the mean of forests is greater by a share of 1 / (8 n) + 3 / (8 n).
    let off = m.nearest_neighbour_predicted.unwrap() - 2.23607 * (1.0 + 0.5 / 500.0);
    assert!(off.abs() < 1e-4, "{off}");
    assert!((m.free_path_predicted.unwrap() - 10.0 / 1.36).abs() < 1e-9);
}

#[test]
fn predictions_hold_with_a_border_too() {
    // Means over forests against predictions, with 5 standard errors as measured between forests and
    // a tolerance of 0.1 % for the quadrature. The prediction of an endless forest is refuted by the
    // same test.
    let default = ForestSpec::default();
    let small = ForestSpec { width: 12.0, height: 5.0, intensity: 0.1, ..default.clone() };
    let inset = ForestSpec {
        radius_law: RadiusLaw::LogNormal,
        border: Border::Inset,
        width: 30.0,
        ..default.clone()
    };
    let tight = ForestSpec { border: Border::Torus, ..small.clone() };
    for (spec, count) in [(default.clone(), 1500), (small, 1500), (inset, 800), (tight, 1500)] {
        let metrics: Vec<_> = (0..count).map(|seed| generate(&spec, seed).metrics()).collect();
        let lambda = spec.intensity;
        let check = |name: &str, values: Vec<f64>, predicted: Option<f64>, endless: f64| {
            let Some(predicted) = predicted else { return };
            let error = 5.0 * (variance(&values) / values.len() as f64).sqrt() + 1e-3 * predicted;
            let mean = mean(&values);
            let off = (mean - predicted).abs();
            assert!(off < error, "{name} {spec:?}: {mean} +- {error}, not {predicted}");
            if spec == default {
                assert!((mean - endless).abs() > error, "{name}: {mean} and {endless}");
            }
        };
        let m = &metrics[0];
        let values = |value: fn(&envgen::forest::ForestMetrics) -> Option<f64>| -> Vec<f64> {
            metrics.iter().filter_map(value).collect()
        };
        check("cover", values(|m| Some(m.cover)), m.cover_predicted, 0.1454);
        check("untouched", values(|m| m.untouched), m.untouched_predicted, 0.5335);
        let endless = 0.5 / lambda.sqrt();
        let near = m.nearest_neighbour_predicted;
        check("nearest neighbour", values(|m| m.nearest_neighbour), near, endless);
    }
}

proptest! {
    #[test]
    fn predictions_are_numbers_in_their_range(
        width in 0.1..300.0_f64,
        height in 0.1..300.0_f64,
        intensity in -20.0..1.0_f64,
        radius in 0.001..0.5_f64,
        law in 0..3_usize,
        border in 0..3_usize,
    ) {
        let spec = ForestSpec {
            width,
            height,
            intensity: libm::exp(intensity),
            radius,
            radius_min: 0.01 * radius,
            radius_max: 2.0 * radius,
            radius_law: [RadiusLaw::Fixed, RadiusLaw::Uniform, RadiusLaw::LogNormal][law],
            border: [Border::Open, Border::Inset, Border::Torus][border],
            robot_radius: 0.1,
            ..Default::default()
        };
        prop_assume!(spec.validate().is_ok() && spec.work() < 1e4);
        let m = generate(&spec, 0).metrics();
        let cover = m.cover_predicted.unwrap();
        // At most what an endless forest has, and no less than a quarter of it: a corner.
        let most = -libm::expm1(-spec.intensity * std::f64::consts::PI * 4.0 * radius * radius);
        prop_assert!(cover > 0.0 && cover <= most * 1.001, "{cover} {most}");
        if let Some(untouched) = m.untouched_predicted {
            prop_assert!(untouched > 0.0 && untouched <= 1.001, "{untouched}");
        }
        let near = m.nearest_neighbour_predicted.unwrap();
        let farthest = DVec2::new(width, height).length();
        prop_assert!(near > 0.0 && near <= farthest, "{near} {farthest}");
    }
}

#[test]
fn robots_drive_their_mean_free_path() {
    // From places that are free, straight on in any direction until the first trunk: exponential of
    // mean 1 / (2 lambda (r + rho)) = 7.353 m, capped at 40 m inside a 120 m forest. 4000 rays, 5
    // standard errors of the capped mean.
    let spec = ForestSpec { width: 120.0, height: 120.0, ..Default::default() };
    let reach = 1.36;
    let mut paths = Vec::new();
    for seed in 0..400 {
        let forest = generate(&spec, seed);
        let mut stream = Seed(seed).stream("test/rays", 0);
        for _ in 0..10 {
            let from = DVec2::new(stream.between(40.0, 80.0), stream.between(40.0, 80.0));
            let heading = stream.between(0.0, std::f64::consts::TAU);
            let direction = envgen::geometry::unit_vector(heading);
            if forest.trees().iter().any(|tree| tree.center.distance(from) < reach) {
                continue;
            }
            let hit = |tree: &Tree| {
                let to = tree.center - from;
                let (along, across) = (to.dot(direction), to.perp_dot(direction).abs());
                (along > 0.0 && across < reach)
                    .then(|| along - (reach * reach - across * across).sqrt())
            };
            let free = forest.trees().iter().filter_map(hit).fold(40.0, f64::min);
            paths.push(free);
        }
    }
    let expected = 7.353 * (1.0 - libm::exp(-40.0 / 7.353));
    let error = 5.0 * (variance(&paths) / paths.len() as f64).sqrt();
    assert!((mean(&paths) - expected).abs() < error, "{} +- {error}, {expected}", mean(&paths));
}

#[test]
fn the_least_distance_holds_on_every_border() {
    for border in [Border::Open, Border::Inset, Border::Torus] {
        for (seed, distance) in [(1, 0.3), (2, 1.0), (3, 3.0), (4, 3.4)] {
            let spec = ForestSpec { min_distance: distance, border, ..Default::default() };
            let forest = generate(&spec, seed);
            let torus = (border == Border::Torus).then_some(DVec2::splat(50.0));
            let least = least_distance(forest.trees(), torus);
            assert!(least >= distance, "{border:?} {distance}: {least}");
            assert!(forest.trees().len() > 70);
        }
    }
}

#[test]
fn sequential_addition_keeps_the_poisson_count() {
    let spec = ForestSpec { min_distance: 2.0, ..Default::default() };
    let counts: Vec<f64> =
        (0..2000).map(|seed| generate(&spec, seed).trees().len() as f64).collect();
    // Mean 125, 5 standard errors; variance / mean 5 sigma of sqrt(2 / 2000).
    assert!((mean(&counts) - 125.0).abs() < 5.0 * (125.0_f64 / 2000.0).sqrt());
    assert!((variance(&counts) / mean(&counts) - 1.0).abs() < 5.0 * (2.0_f64 / 2000.0).sqrt());
}

#[test]
fn too_many_trees_for_their_distance_is_an_error_at_once() {
    let spec = ForestSpec { min_distance: 4.0, ..Default::default() };
    let error = spec.generate(Seed(1)).unwrap_err();
    let ForestError::Capacity { trees, capacity, distance } = error else {
        panic!("{error:?}");
    };
    assert!(trees > 90 && distance == 4.0);
    assert!((capacity - 0.65 * 54.0 * 54.0 / 16.0).abs() < 1e-9);
}

#[test]
fn inset_trunks_lie_inside_and_open_ones_stick_out() {
    for law in [RadiusLaw::Fixed, RadiusLaw::Uniform, RadiusLaw::LogNormal] {
        let spec = ForestSpec { radius_law: law, border: Border::Inset, ..Default::default() };
        let mut outside = 0;
        for seed in 0..50 {
            let inset = generate(&spec, seed);
            assert!(inset.trees().iter().all(|tree| {
                let r = DVec2::splat(tree.radius);
                spec.area().contains(tree.center - r) && spec.area().contains(tree.center + r)
            }));
            let open = generate(&ForestSpec { border: Border::Open, ..spec.clone() }, seed);
            outside += open.trees().iter().filter(|t| t.center.x < t.radius).count();
        }
        assert!(outside > 0);
    }
    // The intensity counts on the centres' area: 48 x 48 m.
    let spec = ForestSpec { border: Border::Inset, ..Default::default() };
    let counts: Vec<f64> =
        (0..2000).map(|seed| generate(&spec, seed).trees().len() as f64).collect();
    assert!((mean(&counts) - 115.2).abs() < 5.0 * (115.2_f64 / 2000.0).sqrt());
}

#[test]
fn density_thins_the_forest() {
    // Left half empty, right half at double the intensity on top and at half of it below.
    let rows = vec![vec![0.0, 2.0], vec![0.0, 0.5]];
    for min_distance in [0.0, 0.5] {
        let spec = ForestSpec {
            density: Some(DensityMap { rows: rows.clone() }),
            min_distance,
            ..Default::default()
        };
        let (mut top, mut bottom) = (0.0_f64, 0.0_f64);
        for seed in 0..400 {
            for tree in generate(&spec, seed).trees() {
                assert!(tree.center.x >= 25.0);
                *(if tree.center.y >= 25.0 { &mut top } else { &mut bottom }) += 1.0;
            }
        }
        // 625 m^2 each; 5 Poisson sigmas.
        for (count, expected) in [(top, 400.0 * 62.5), (bottom, 400.0 * 15.625)] {
            assert!((count - expected).abs() < 5.0 * f64::sqrt(expected), "{count} {expected}");
        }
    }
}

#[test]
fn ends_of_a_narrow_forest_are_felt_far_away() {
    // From the integral over a line of a Poisson number of at least two points.
    for (width, height, intensity, expected) in
        [(0.01, 1000.0, 2.0, 27.797), (0.1, 100.0, 1.0, 6.273), (0.01, 100.0, 10.0, 6.273)]
    {
        let radius = 0.1 * width;
        let spec = ForestSpec {
            width,
            height,
            intensity,
            radius,
            robot_radius: 0.0,
            ..Default::default()
        };
        let found = generate(&spec, 1).metrics().nearest_neighbour_predicted.unwrap();
        assert!((found / expected - 1.0).abs() < 0.01, "{found} for {expected}");
    }
}

#[test]
fn a_single_tree_has_no_neighbours() {
    let spec = ForestSpec {
        width: 10.0,
        height: 10.0,
        min_distance: 60.0,
        intensity: 0.01,
        ..Default::default()
    };
    let counts: Vec<_> = (0..20)
        .map(|seed| spec.generate(Seed(seed)).map(|forest| forest.trees().len()).ok())
        .collect();
    assert!(counts.contains(&Some(1)) && !counts.contains(&Some(2)), "{counts:?}");
}

#[test]
fn a_density_function_takes_the_place_of_the_intensity() {
    let spec = ForestSpec::default();
    let slope = (0.2, |p: DVec2| 0.2 * p.x / 50.0);
    let mut total = 0.0;
    for seed in 0..200 {
        let forest = spec.generate_with(Seed(seed), &slope).unwrap();
        total += forest.trees().len() as f64;
        assert!(forest.to_world().provenance.edited);
    }
    assert!((total - 200.0 * 250.0).abs() < 5.0 * f64::sqrt(50_000.0), "{total}");

    for liar in [f64::NAN, -0.1, 0.3] {
        let error = spec.generate_with(Seed(1), &(0.2, |_| liar)).unwrap_err();
        assert!(matches!(error, ForestError::Density { .. }), "{error}");
    }
}

#[test]
fn clearings_are_clear_and_counted() {
    let bare = ForestSpec { intensity: 0.2, ..Default::default() };
    let spec = ForestSpec { clearing: 3.0, ..bare.clone() };
    for seed in 0..50 {
        let forest = generate(&spec, seed);
        let full = generate(&bare, seed).trees().len() as u64;
        assert_eq!(forest.trees().len() as u64 + forest.cleared(), full);
        assert_eq!(forest.metrics().cleared, forest.cleared());
        let world = forest.to_world();
        for pose in [world.start.unwrap(), world.goal.unwrap()] {
            assert!(world.clearance(pose.position) >= 3.0 - 1e-9);
        }
    }
}

#[test]
fn digests_are_frozen() {
    // A change here is value-breaking: raise the value version and say so in the changelog.
    let spec = ForestSpec::default();
    let spaced = ForestSpec { min_distance: 3.0, radius_law: RadiusLaw::LogNormal, ..spec.clone() };
    let digests = [&spec, &spaced].map(|spec| Digest::of(&generate(spec, 1)).to_string());
    assert_eq!(
        digests,
        [
            "34306d890f79f884c71162cbe68725c70a9d3fc3fbdd25f14bd08a3d4950e2f5",
            "37fd1ac0c33058b47e605bc36ef2e5df4051bd3b8ce09adc911d4002db4c3c7b",
        ]
    );
}

#[test]
fn bad_specs_name_field_value_and_limits_at_once() {
    let with = |name: &str, value: f64| {
        let mut spec = ForestSpec::default();
        match name {
            "width" => spec.width = value,
            "height" => spec.height = value,
            "intensity" => spec.intensity = value,
            "radius" => spec.radius = value,
            "min_distance" => spec.min_distance = value,
            "clearing" => spec.clearing = value,
            _ => spec.robot_radius = value,
        }
        spec
    };
    for name in
        ["width", "height", "intensity", "radius", "min_distance", "clearing", "robot_radius"]
    {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 1e300] {
            let error = with(name, value).validate().unwrap_err();
            assert_eq!(error.field, name);
            assert_eq!(error.value.parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
    }
    assert_eq!(with("width", 0.0).validate().unwrap_err().field, "width");
    // 1e12 trees.
    let huge = ForestSpec { width: 1e6, height: 1e6, intensity: 1.0, ..Default::default() };
    let error = huge.generate(Seed(1)).unwrap_err().to_string();
    assert_eq!(
        error,
        "`intensity` must be at most 0.00002 1/m^2, got 1: 20000000 trees on 1000000000000 m^2"
    );
}

#[test]
fn the_first_error_about_the_intensity_names_what_is_allowed() {
    for (radius, min_distance, reason) in [
        (1.0, 0.0, "with trunks of 1 m and a robot of 0.36 m, either would overlap too often"),
        (1e-4, 0.5, "5000000 trees on 1000000 m^2"),
    ] {
        let spec = ForestSpec {
            width: 1e3,
            height: 1e3,
            intensity: 1e3,
            radius,
            min_distance,
            ..Default::default()
        };
        let error = spec.validate().unwrap_err();
        assert!(error.allowed.ends_with(reason), "{error}");
        let intensity = error.allowed.split(' ').nth(2).unwrap().parse().unwrap();
        assert_eq!(ForestSpec { intensity, ..spec }.validate(), Ok(()));
    }
}

#[test]
fn long_thin_and_crowded_forests_come_to_an_end() {
    // Each of these once took minutes.
    let thin = ForestSpec {
        width: 1e5,
        height: 0.1,
        intensity: 0.1,
        radius: 0.001,
        robot_radius: 0.0,
        ..Default::default()
    };
    let tall = ForestSpec { width: 1.0, height: 2e4, min_distance: 0.5, ..thin.clone() };
    let crowded = ForestSpec { intensity: 5.0, radius: 1.5, ..Default::default() };
    let mut rows = vec![vec![0.0; 50]; 50];
    rows[20][30] = 1.0;
    let patch = ForestSpec {
        width: 500.0,
        height: 500.0,
        intensity: 0.8,
        min_distance: 1.0,
        radius: 0.1,
        density: Some(DensityMap { rows }),
        ..Default::default()
    };
    for spec in [thin, tall, crowded] {
        let forest = generate(&spec, 1);
        assert!(forest.metrics().count > 50);
        let world = forest.to_world();
        assert_eq!(world.check(), Ok(()));
        envgen::certificate::verify(&world);
    }
    let error = patch.generate(Seed(1)).unwrap_err();
    assert!(matches!(error, ForestError::Capacity { .. }), "{error}");
}

proptest! {
    #[test]
    fn every_valid_spec_gives_a_world_that_holds(
        seed: u64,
        width in 0.5..60.0_f64,
        height in 0.5..60.0_f64,
        intensity in 0.0..0.4_f64,
        radius in 0.01..2.0_f64,
        min_distance in prop_oneof![Just(0.0), 0.0..2.0_f64],
        border in prop_oneof![Just(Border::Open), Just(Border::Inset), Just(Border::Torus)],
        clearing in prop_oneof![Just(0.0), 0.0..5.0_f64],
    ) {
        let spec = ForestSpec {
            width, height, intensity, radius, min_distance, border, clearing, ..Default::default()
        };
        if spec.validate().is_ok()
            && let Ok(forest) = spec.generate(Seed(seed))
        {
            let world = forest.to_world();
            prop_assert_eq!(world.check(), Ok(()));
            for pose in world.start.into_iter().chain(world.goal) {
                prop_assert!(world.clearance(pose.position) >= spec.robot_radius - 1e-9);
            }
            let metrics = forest.metrics();
            prop_assert!((0.0..=1.0).contains(&metrics.cover));
            let torus = (border == Border::Torus).then_some(DVec2::new(width, height));
            prop_assert!(least_distance(forest.trees(), torus) >= min_distance);
        }
    }
}

#[test]
fn the_intensity_that_an_error_names_is_allowed() {
    for i in 0..200 {
        let width = 100.0 + 0.37 * f64::from(i);
        let (height, intensity) = (width / 3.0, 1e6);
        let radius = 1e-4;
        let mut spec = ForestSpec {
            width,
            height,
            intensity,
            radius,
            robot_radius: 0.0,
            ..Default::default()
        };
        let allowed = spec.validate().unwrap_err().allowed;
        spec.intensity = allowed.split(' ').nth(2).unwrap().parse().unwrap();
        assert_eq!(spec.validate(), Ok(()), "{width} m");
    }
}
