//! The cost of an indoor map, rule by rule.
//!
//! `cargo bench -p envgen --bench indoor` prints the time of each stage, plans per second, and how the
//! cost of a cell grows from a map of 16 x 16 to one of 256 x 256 cells. Every number is the best of
//! several interleaved rounds; compare the ratios between machines, not the seconds.

#![expect(clippy::print_stdout, reason = "a benchmark prints its results")]
#![expect(clippy::disallowed_methods, reason = "a benchmark needs a clock")]

use std::hint::black_box;
use std::time::Instant;

use bench_ratio::{at_most, faster, rounds};
use envgen::indoor::{FloorPlan, IndoorSpec, Layout, Profile, Stage};
use envgen::{Blueprint, Seed, Spec};

const ROUNDS: usize = 7;

/// Seconds of each stage and of the whole.
struct Times {
    stages: [f64; Stage::ALL.len()],
    all: f64,
}

/// The times of `count` plans.
fn stages(spec: &IndoorSpec, count: u64) -> Times {
    let mut times = [0.0; Stage::ALL.len()];
    let begin = Instant::now();
    for seed in 0..count {
        let mut last = Instant::now();
        let plan = spec.generate_observed(Seed(seed), &mut |stage| {
            let now = Instant::now();
            times[stage as usize] += (now - last).as_secs_f64();
            last = now;
        });
        black_box(plan).expect("the spec is valid");
    }
    Times { stages: times, all: begin.elapsed().as_secs_f64() }
}

/// Seconds to generate `count` plans and to do something with them.
fn after(spec: &IndoorSpec, count: u64, work: impl Fn(&FloorPlan)) -> f64 {
    let begin = Instant::now();
    for seed in 0..count {
        work(&spec.generate(Seed(seed)).expect("the spec is valid"));
    }
    begin.elapsed().as_secs_f64()
}

fn best(round: impl Fn() -> f64) -> f64 {
    (0..ROUNDS).map(|_| round()).fold(f64::INFINITY, f64::min)
}

fn main() {
    let spec = |difficulty: f64, profile, size| IndoorSpec {
        difficulty,
        profile,
        width: size,
        height: size,
        ..Default::default()
    };
    // The rooms' free space is computed once for all maps.
    black_box(spec(5.0, Profile::Guaranteed, 16).generate(Seed(0))).expect("the spec is valid");

    println!("share of each stage, 16 x 16, microseconds a plan");
    print!("{:<28}", "");
    Stage::ALL.iter().for_each(|stage| print!("{:>10}", format!("{stage:?}")));
    println!("{:>10}", "all");
    let l_system = IndoorSpec { layout: Layout::LSystem, ..spec(5.0, Profile::Guaranteed, 16) };
    for (name, spec) in [
        ("thesis, d = 0", spec(0.0, Profile::Thesis, 16)),
        ("thesis, d = 5", spec(5.0, Profile::Thesis, 16)),
        ("guaranteed, d = 0", spec(0.0, Profile::Guaranteed, 16)),
        ("guaranteed, d = 5", spec(5.0, Profile::Guaranteed, 16)),
        ("guaranteed, d = 10", spec(10.0, Profile::Guaranteed, 16)),
        ("guaranteed, d = 5, l_system", l_system),
    ] {
        let count = 200;
        let rounds: Vec<_> = (0..ROUNDS).map(|_| stages(&spec, count)).collect();
        print!("{name:<28}");
        let least = |time: &dyn Fn(&Times) -> f64| {
            1e6 / count as f64 * rounds.iter().map(time).fold(f64::INFINITY, f64::min)
        };
        for stage in 0..Stage::ALL.len() {
            print!("{:>10.2}", least(&|round| round.stages[stage]));
        }
        println!("{:>10.2}", least(&|round| round.all));
    }

    let guaranteed = spec(5.0, Profile::Guaranteed, 16);
    let count = 400;
    let repaired = best(|| {
        after(&guaranteed, count, |plan| {
            black_box(plan);
        })
    });
    let verified = best(|| after(&guaranteed, count, |plan| assert_eq!(plan.access().parts(), 1)));
    let built = best(|| after(&guaranteed, count, |plan| drop(black_box(plan.to_world()))));
    println!("  {:.0} plans/s, built as worlds", count as f64 / built);
    let a_second = |seconds: f64| (seconds / count as f64, 1.0);
    faster("a plan, access repaired, against a second", a_second(repaired), 5000.0);
    let what = "a plan, free space on the contents verified, against a second";
    faster(what, a_second(verified), 300.0);
    for (name, profile) in [("thesis", Profile::Thesis), ("guaranteed", Profile::Guaranteed)] {
        for difficulty in [0.0, 5.0, 10.0] {
            let (small, large) = (spec(difficulty, profile, 16), spec(difficulty, profile, 256));
            // 256 small maps have the cells of one large one.
            let times = rounds(ROUNDS, || stages(&large, 4).all, || stages(&small, 1024).all);
            let what =
                format!("a cell of 256 x 256, {name}, d = {difficulty}, against one of 16 x 16");
            at_most(&what, times, 1.5);
        }
    }
}
