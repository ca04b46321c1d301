//! Trials are the same to the last bit: in debug and in release, on one thread and on several.

use std::thread;

use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec, World};
use mapping_trial::names::Named;
use mapping_trial::operator::OperatorKind;
use mapping_trial::slam::SlamKind;
use mapping_trial::trial::{Trial, TrialSettings};

/// Digests of logs and of what was scored, by operator; the last two are of two robots and of
/// `pose_graph`. A change here changes what every trial measures: note it in the changelog.
const GOLDEN: [&str; 7] = [
    "904ad602eb78e29f151258e243e49160",
    "abcbe1c074ff0512ce640eb05080bfb2",
    "4e89ee75bcf9fac1a64712da4743b936",
    "8491b72dd4ae8cbd9b47bf96029e0349",
    "1fa7369e3be4511b5ed5fff1fee027c4",
    "63591b5bad394a7d74a88065802b7230",
    "41dccdb73d56d3a2c01e2635fd8e8e39",
];

fn world() -> World {
    let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
    spec.generate(Seed(11)).expect("a map").to_world()
}

fn settings() -> Vec<TrialSettings> {
    let short = TrialSettings { time_limit: 150.0, seed: Seed(5), ..TrialSettings::default() };
    let operators = OperatorKind::NAMES
        .iter()
        .map(|(_, kind)| TrialSettings { operator: Some(*kind), ..short.clone() });
    operators
        .chain([
            TrialSettings { robots: 2, ..short.clone() },
            TrialSettings { slam: SlamKind::PoseGraph, ..short.clone() },
        ])
        .collect()
}

/// The first half of the digest of a log and of the estimated way.
fn digest(world: &World, settings: TrialSettings) -> String {
    let mut trial = Trial::flat(world, settings).expect("a free start");
    while trial.step() {}
    let known = (trial.log("flat"), trial.brain().slam().trajectory(0));
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
