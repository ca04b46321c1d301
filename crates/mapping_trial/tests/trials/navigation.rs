//! Faults of the navigation must not count as difficulty.

use std::thread;

use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec};
use mapping_trial::trial::{EndReason, Trial, TrialSettings};

/// Number of maps that are driven.
const MAPS: u64 = 20;

/// Checks how trials end on maps of level 5 in which every place can be reached. None of the 20 got
/// stuck, and 12 were explored, when this test was frozen. One may get stuck, and two thirds as many
/// must be explored.
#[test]
fn hardly_any_map_ends_by_getting_stuck() {
    let drive = |seed| {
        let spec = IndoorSpec { width: 10, height: 10, ..Default::default() };
        let world = spec.generate(Seed(seed)).expect("a map").to_world();
        let settings = TrialSettings { seed: Seed(seed), ..TrialSettings::default() };
        let mut trial = Trial::flat(&world, settings).expect("a free start");
        while trial.step() {}
        trial.end_of(0).expect("an end").reason
    };
    let ends: Vec<EndReason> = thread::scope(|scope| {
        let half = |first| scope.spawn(move || (first..MAPS).step_by(2).map(drive).collect());
        let halves: [thread::ScopedJoinHandle<'_, Vec<EndReason>>; 2] = [half(0), half(1)];
        halves.into_iter().flat_map(|half| half.join().expect("trials")).collect()
    });
    let count = |reason| ends.iter().filter(|&&end| end == reason).count();
    assert!(count(EndReason::Stuck) <= 1, "{ends:?}");
    assert!(count(EndReason::Explored) >= 8, "{ends:?}");
}
