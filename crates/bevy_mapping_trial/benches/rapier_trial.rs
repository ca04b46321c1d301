//! Headless mapping trials in rapier against real time, and against the flat simulator.
//!
//! `cargo bench -p bevy_mapping_trial --bench rapier_trial`

use bench_ratio::{Times, at_most, faster, seconds};
use bevy_mapping_trial::trial::run_headless;
use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec};
use mapping_trial::trial::{Trial, TrialSettings};

/// The number of maps.
const MAPS: u64 = 4;

/// How many times faster than real time a trial should be.
const REAL_TIME: f64 = 100.0;

/// The largest ratio of the time in rapier to that of the flat simulator.
const FLAT: f64 = 10.0;

fn main() {
    let mut maps = Vec::new();
    for seed in 1..=MAPS {
        let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
        let world = spec.generate(Seed(seed)).expect("a map").to_world();
        let settings = TrialSettings { seed: Seed(seed), ..Default::default() };
        let mut simulated = [0.0; 2];
        let rapier = seconds(|| {
            let trial = run_headless(&world, settings.clone(), |_| ()).expect("a trial");
            simulated[0] = trial.time();
        });
        let flat = seconds(|| {
            let mut trial = Trial::flat(&world, settings.clone()).expect("a trial");
            while trial.step() {}
            simulated[1] = trial.time();
        });
        maps.push([rapier, flat, simulated[0], simulated[1]]);
    }
    let real: Times = maps.iter().map(|&[rapier, _, simulated, _]| (rapier, simulated)).collect();
    faster("trials in rapier, against real time", real.summed(), REAL_TIME);
    let second =
        |&[rapier, flat, in_rapier, in_flat]: &[f64; 4]| (rapier / in_rapier, flat / in_flat);
    let ratio = maps.iter().map(second).collect::<Times>().summed();
    at_most("a simulated second in rapier, against one in the flat simulator", ratio, FLAT);
}
