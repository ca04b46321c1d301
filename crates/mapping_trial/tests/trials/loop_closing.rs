//! Loops that are closed by the pose graph.

use mapping_trial::lidar::LaserProfile;
use mapping_trial::slam::SlamKind;

use crate::slam_bands::{around, corridor_loop, errors, median};

/// Number of runs around the loop.
const SEEDS: u64 = 12;

/// Scan-to-map matching nearly always finds the old walls again where a loop comes back within its
/// drift. Loop closing also corrects the other cases, and is no worse where there is nothing to
/// correct.
#[test]
fn loops_that_are_closed_always_come_back_to_the_old_walls() {
    let (walls, path) = (corridor_loop(120.0, 80.0, true), around(120.0, 80.0, 20.0));
    let kinds = [SlamKind::ScanToMap, SlamKind::PoseGraph];
    let found = errors((&walls, &path), &LaserProfile::LMS200_MM, &kinds, SEEDS);
    let [open, closed] = [0, 1].map(|kind| median(&found[kind].errors));
    let [gap, mended] = [0, 1].map(|kind| found[kind].gaps.iter().copied().fold(0.0_f64, f64::max));
    assert!(mended < 0.15 && mended < 0.5 * gap, "the worst gap of {gap} m became {mended} m");
    assert!(closed < 1.1 * open, "an error of {open} m became {closed} m");
}
