//! The difficulty vector against the rays that it needs anyway.

use std::f64::consts::PI;

use bench_ratio::{at_most, contest};
use envgen::difficulty::{DifficultyVector, Platform};
use envgen::geometry::Pose;
use envgen::indoor::IndoorSpec;
use envgen::raycast::{Raycaster, ScanPattern};
use envgen::{Blueprint, Seed, Spec};

/// Scans of the baseline: about as many as poses and tour of such a map take.
const SCANS: usize = 1500;

fn main() {
    for difficulty in [0.0, 5.0, 10.0] {
        let spec = IndoorSpec { difficulty, width: 16, height: 16, ..Default::default() };
        let Ok(plan) = spec.generate(Seed(1)) else { continue };
        let world = plan.to_world();
        let (Ok(pattern), Some(start)) = (ScanPattern::new(PI, 181), world.start) else { continue };
        let platform = Platform::default();
        let vector = || DifficultyVector::of(&world, &platform);
        let rays = || {
            let (index, mut ranges, mut sum) = (Raycaster::new(&world), Vec::new(), 0.0);
            for i in 0..SCANS {
                let pose = Pose { heading: start.heading + i as f64, ..start };
                index.scan(pose, &pattern, platform.max_range, &mut ranges);
                sum += ranges.iter().sum::<f64>();
            }
            sum
        };
        let times = contest(vector, rays);
        let ours = times.ours();
        let what =
            format!("vector of 16 x 16 cells, difficulty {difficulty}, against {SCANS} scans");
        at_most(&what, times, 5.0);
        #[expect(clippy::print_stdout, reason = "the result of a benchmark")]
        {
            println!("  {:.1} ms (target on an idle core: at most 50 ms)", 1e3 * ours);
        }
    }
}
