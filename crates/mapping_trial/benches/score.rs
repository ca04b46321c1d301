//! The cost of scores: the mappable area of a world, once, and the score of a run in it.
//!
//! `cargo bench -p mapping_trial --bench score` compares both, in the same run, with one search of
//! the policies' planner over all of the map: a score makes eight, and drives 40 paths.

#![expect(clippy::print_stdout, reason = "a benchmark prints its results")]

use bench_ratio::{at_most, contest, growth};
use envgen::geometry::Pose;
use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec};
use mapping_trial::policy::costmap::Costmap;
use mapping_trial::policy::search::GridPlanner;
use mapping_trial::robot::Robot;
use mapping_trial::score::{Reference, RunSummary, Scores, TrajectoryPair};

/// Poses of 20 minutes.
const TICKS: usize = 24_000;

fn main() {
    let (mut truths, mut scores) = (Vec::new(), Vec::new());
    for (name, cells) in [("48 x 48 m", 16), ("60 x 60 m", 20), ("120 x 120 m", 40)] {
        let spec =
            IndoorSpec { width: cells, height: cells, difficulty: 5.0, ..Default::default() };
        let Ok(plan) = spec.generate(Seed(1)) else { continue };
        let world = plan.to_world();
        let robot = Robot::default();
        let Ok(truth) = Reference::new(&world, &robot) else { continue };
        let map = truth.perfect_map();
        let poses: Vec<Pose> =
            (0..TICKS).map(|i| Pose::new(0.02 * i as f64, 1.0, 1e-3 * i as f64)).collect();
        let tracks = [TrajectoryPair { truth: &poses, estimated: &poses }];
        let run = RunSummary {
            map: &map,
            tracks: &tracks,
            time_limit: 1200.0,
            time: 1200.0,
            distance: 480.0,
            turning: 24.0,
            collisions: 0,
            moving: None,
            recoveries: 0,
            stuck: 0,
            energy_left: 0.0,
        };
        let Some(start) = world.start else { continue };
        let search = || {
            let (mut costmap, mut search) = (Costmap::new(&robot), GridPlanner::new());
            costmap.refresh(&map);
            search.nearest(&mut costmap, start.position, &[], |_, _| false)
        };
        let truth_time = contest(|| Reference::new(&world, &robot).map_err(drop), search);
        let score_time = contest(|| Scores::of(&truth, &run).map_err(drop), search);
        println!(
            "{name}: {:.0} m^2 free, {} wall points; truth {:.0} ms, score {:.0} ms",
            truth.free_area(),
            truth.walls().len(),
            1e3 * truth_time.ours(),
            1e3 * score_time.ours(),
        );
        truths.push((truth.free_area(), truth_time.ours()));
        scores.push((truth.free_area(), score_time.ours()));
        at_most(&format!("{name}: truth, against a search"), truth_time, 50.0);
        at_most(&format!("{name}: score, against a search"), score_time, 15.0);
    }
    growth("truth, by m^2 that can be covered", &truths);
    growth("score, by m^2 that can be covered", &scores);
}
