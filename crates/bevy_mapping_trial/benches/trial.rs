//! Headless mapping trials in rapier against real time, and against the flat simulator.
//!
//! `cargo bench -p bevy_mapping_trial --bench trial`

use bench_ratio::{at_most, faster, seconds};
use bevy_mapping_trial::trial::run_headless;
use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec};
use mapping_trial::trial::{Trial, TrialSettings};

/// Number of maps.
const MAPS: u64 = 4;

/// How many times faster than real time a trial should be.
const REAL_TIME: f64 = 100.0;

/// The largest ratio of the time in rapier to that of the flat simulator.
const FLAT: f64 = 10.0;

fn main() {
    let (mut rapier, mut simulated, mut flat, mut flat_simulated) = (0.0, 0.0, 0.0, 0.0);
    for seed in 1..=MAPS {
        let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
        let world = spec.generate(Seed(seed)).expect("a map").to_world();
        let settings = TrialSettings { seed: Seed(seed), ..Default::default() };
        rapier += seconds(|| {
            let trial = run_headless(&world, settings.clone(), |_| ()).expect("a trial");
            simulated += trial.time();
        });
        flat += seconds(|| {
            let mut trial = Trial::flat(&world, settings.clone()).expect("a trial");
            while trial.step() {}
            flat_simulated += trial.time();
        });
    }
    faster("a trial in rapier, of real time", (rapier, simulated), REAL_TIME);
    let ratio = (rapier / simulated, flat / flat_simulated);
    at_most("a simulated second in rapier, of one in the flat simulator", ratio, FLAT);
}
