//! Trials are the same to the last bit: in debug and in release, on one thread and on several.

use std::thread;

use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec, World};
use mapping_trial::names::Named;
use mapping_trial::policy::PolicyKind;
use mapping_trial::slam::SlamKind;
use mapping_trial::trial::{Trial, TrialSettings};

/// Digests of logs and trajectories, by policy; the last two are of two robots and of
/// `pose_graph`. A change here changes what every trial measures: note it in the changelog.
const GOLDEN: [&str; 7] = [
    "286210b6f2260e9c1bda441c85155b38",
    "ee0ef7359fa1811b5f95d71309129f32",
    "92ed9fffe38510f87a487eef662bcf7e",
    "32fc5cfba24b2c300ee1e54e227d5683",
    "7c48ecbede44a41ecaa34351b3da79d2",
    "4e5022b9c32da8aedc3302d77d51439d",
    "0802dfa6b35c0af767ca04af4e53c6cd",
];

fn world() -> World {
    let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
    spec.generate(Seed(11)).expect("a map").to_world()
}

fn settings() -> Vec<TrialSettings> {
    let short = TrialSettings { time_limit: 150.0, seed: Seed(5), ..TrialSettings::default() };
    let operators = PolicyKind::NAMES
        .iter()
        .map(|(_, kind)| TrialSettings { policy: Some(*kind), ..short.clone() });
    operators
        .chain([
            TrialSettings { robots: 2, ..short.clone() },
            TrialSettings { slam: SlamKind::PoseGraph, ..short.clone() },
        ])
        .collect()
}

/// The first half of the digest of a log and of the estimated trajectory.
fn digest(world: &World, settings: TrialSettings) -> String {
    let mut trial = Trial::flat(world, settings).expect("a free start");
    while trial.step() {}
    let known = (trial.log(), trial.autonomy().slam().trajectory(0));
    envgen::world::Digest::of(&known).to_string()[..32].to_owned()
}

#[test]
fn digests_are_frozen() {
    let world = world();
    let found: Vec<String> = settings().into_iter().map(|s| digest(&world, s)).collect();
    assert_eq!(found, GOLDEN, "{found:#?}");
}

#[test]
fn threads_change_nothing() {
    let world = &world();
    let alone = digest(world, settings().swap_remove(0));
    let together: Vec<String> = thread::scope(|scope| {
        let runs: Vec<_> = settings()
            .into_iter()
            .take(3)
            .map(|settings| scope.spawn(move || digest(world, settings)))
            .collect();
        runs.into_iter().map(|run| run.join().expect("a trial")).collect()
    });
    assert_eq!(together[0], alone);
}
