//! Headless mapping trials with a camera on the robot: pictures per second, and what they cost the trial.
//!
//! `cargo bench -p bevy_mapping_trial --features camera --bench camera`
//!
//! Needs a Vulkan, Metal or DirectX driver, which may draw in software.

use bench_ratio::{Times, faster, seconds};
use bevy_mapping_trial::camera::{CameraFrame, CameraTrial, RobotCamera};
use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec};
use mapping_trial::trial::{TrialParts, TrialSettings};

/// The number of maps.
const MAPS: u64 = 3;

/// The simulated seconds per trial.
const TIME_LIMIT: f64 = 60.0;

/// The smallest number of pictures per second of real time that there should be, including the time of the
/// trial.
const RATE: f64 = 5.0;

fn main() {
    let mut maps = Vec::new();
    for seed in 1..=MAPS {
        let spec = IndoorSpec { width: 16, height: 16, ..Default::default() };
        let world = spec.generate(Seed(seed)).expect("a map").to_world();
        let settings =
            TrialSettings { seed: Seed(seed), time_limit: TIME_LIMIT, ..Default::default() };
        let camera = RobotCamera::on(&settings.body);
        let (mut pictures, mut simulated) = (0, 0.0);
        let taken = seconds(|| {
            let trial = CameraTrial::new(&world, settings.clone(), TrialParts::default(), None);
            let count = |_, _: &CameraFrame| {
                pictures += 1;
                Ok(())
            };
            simulated = trial.watch(camera, |_| (), count).expect("a trial with a camera").time();
        });
        maps.push([taken, f64::from(pictures) / RATE, simulated]);
    }
    let pictures: Times = maps.iter().map(|&[taken, pictures, _]| (taken, pictures)).collect();
    let real: Times = maps.iter().map(|&[taken, _, simulated]| (taken, simulated)).collect();
    let what = "colours, depths and labels of 320 x 240 during a trial, against 5 per second";
    faster(what, pictures.summed(), 1.0);
    faster("a trial with two such pictures per second, against real time", real.summed(), 1.0);
}
