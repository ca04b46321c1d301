//! What the bag of a trial of 20 minutes costs: a replay that writes it, less one that does not, and its size.
//!
//! `cargo bench -p mapping_trial --features mcap --bench bag`

use bench_ratio::{Times, at_most, seconds};
use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec};
use mapping_trial::ros_bag::BagRecorder;
use mapping_trial::trial::{Trial, TrialParts, TrialSettings};

/// Alternating rounds; the best of each side counts.
const ROUNDS: usize = 9;

/// The most seconds and bytes that a bag may cost.
const SECONDS: f64 = 0.3;
const BYTES: f64 = 8e6;

fn main() {
    let spec = IndoorSpec { width: 16, height: 16, ..Default::default() };
    let world = spec.generate(Seed(5)).expect("a map").to_world();
    let settings = TrialSettings { seed: Seed(5), ..Default::default() };
    let mut trial = Trial::flat(&world, settings).expect("a trial");
    while trial.step() {}
    let log = trial.log();
    let report =
        trial.report(&world, &trial.reference(&world).expect("a start")).expect("its world");
    let replay = |parts: TrialParts| {
        let build = log.replay_with(&world, |builder| builder.parts(parts).build_flat());
        let mut trial = build.expect("its world");
        log.run_through(&mut trial).expect("the log's commands");
        trial
    };
    let mut bytes = 0;
    let rounds = (0..ROUNDS).map(|_| {
        let plain = seconds(|| replay(TrialParts::default()));
        let written = seconds(|| {
            let recorder = BagRecorder::new(Vec::new());
            let trial = replay(recorder.watch(TrialParts::default()));
            bytes = recorder.finish(&trial, &world, &report).expect("a bag").0.len();
        });
        (written - plain, SECONDS)
    });
    let rounds: Times = rounds.collect();
    let minutes = trial.time() / 60.0;
    at_most(&format!("the bag of {minutes:.0} minutes, against {SECONDS} s"), rounds, 1.0);
    at_most("its bytes, against 8 MB", (bytes as f64, BYTES), 1.0);
}
