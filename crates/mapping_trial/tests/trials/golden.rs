//! Trials are the same to the last bit: in debug and release builds, on one thread and on several.

use std::thread;

use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec, World};
use mapping_trial::names::Named;
use mapping_trial::policy::PolicyKind;
use mapping_trial::slam::{SlamKind, WheelCalibration};
use mapping_trial::trial::{Trial, TrialSettings};

/// Digests of logs and trajectories, by policy. The last three are of two robots, of `pose_graph`, and
/// of wheels whose distances are learned, too. A change here changes what every trial measures: note it
/// in the changelog.
const GOLDEN: [&str; 9] = [
    "99e893e242f02a2cce3542c66eda0a82",
    "d6e6d481c2f86b575127a49e6fc56e7c",
    "886e499cd463255f73d490926bff6e17",
    "873033160c9a7162f05d6cc863dd3caa",
    "104cce2dc910be6ca39bff1d8979c299",
    "efca20a2372990f31163df63a64f1b49",
    "2a22e5b34eb382aa828372935bfdcdd5",
    "77449adf3292396e5c2c544bc6c686fa",
    "62ea70e5802b95e51a5f75521d5de137",
];

fn world() -> World {
    let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
    spec.generate(Seed(11)).expect("a map").to_world()
}

fn settings() -> Vec<TrialSettings> {
    let short = TrialSettings { time_limit: 150.0, seed: Seed(5), ..TrialSettings::default() };
    let policies = PolicyKind::NAMES
        .iter()
        .map(|(_, kind)| TrialSettings { policy: Some(*kind), ..short.clone() });
    policies
        .chain([
            TrialSettings { robots: 2, ..short.clone() },
            TrialSettings { slam: SlamKind::PoseGraph, ..short.clone() },
            TrialSettings {
                wheel_calibration: WheelCalibration::TurnsAndDistances,
                ..short.clone()
            },
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
