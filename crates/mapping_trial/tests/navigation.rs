//! Faults of the navigation must not count as difficulty.

use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec};
use mapping_trial::trial::{EndReason, Trial, TrialSettings};

/// Maps that are driven.
const MAPS: u64 = 20;

/// At most 5 % of maps of level 5 in which every place can be reached may end by getting stuck.
#[test]
#[expect(clippy::print_stdout, reason = "the share is a number to know")]
fn hardly_any_map_ends_by_getting_stuck() {
    let mut ends = Vec::new();
    for seed in 0..MAPS {
        let spec = IndoorSpec { width: 10, height: 10, ..Default::default() };
        let world = spec.generate(Seed(seed)).expect("a map").to_world();
        let settings = TrialSettings { seed: Seed(seed), ..TrialSettings::default() };
        let mut trial = Trial::flat(&world, settings).expect("a free start");
        while trial.step() {}
        ends.push(trial.end_of(0).expect("an end").reason);
    }
    let share = |reason| ends.iter().filter(|&&end| end == reason).count() as f64 / MAPS as f64;
    let stuck = share(EndReason::Stuck);
    println!("{:.0} % of {MAPS} maps end stuck: {ends:?}", 100.0 * stuck);
    assert!(stuck <= 0.05, "{ends:?}");
    assert!(share(EndReason::Explored) >= 0.25, "{ends:?}");
}
