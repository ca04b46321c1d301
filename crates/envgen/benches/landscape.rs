//! Landscapes against baselines measured in the same run: best of several turns, interleaved, so
//! that the ratios hold on a busy machine too.
//!
//! `cargo bench -p envgen --bench landscape`

use std::hint::black_box;
use std::time::{Duration, Instant};

use envgen::landscape::metrics::{Adjacency, Neighbourhood, patches};
use envgen::landscape::paths::TravelMap;
use envgen::landscape::{
    Algorithm, Composition, LandscapeSpec, automaton_fill, edge_count, random_fill,
};
use envgen::{Seed, Spec};

/// The best time of each task over `turns` turns, the tasks by turns.
fn best<const N: usize>(turns: u32, mut tasks: [&mut dyn FnMut(); N]) -> [Duration; N] {
    let mut least = [Duration::MAX; N];
    for _ in 0..turns {
        for (task, least) in tasks.iter_mut().zip(&mut least) {
            #[expect(clippy::disallowed_methods, reason = "a benchmark reads the clock")]
            let start = Instant::now();
            task();
            *least = start.elapsed().min(*least);
        }
    }
    least
}

fn say(what: &str, value: f64, limit: f64) {
    let verdict = if value <= limit { "" } else { "  MISSED" };
    #[expect(clippy::print_stdout, reason = "a benchmark reports")]
    {
        println!("{what:<66}{value:>9.2}  (limit {limit}){verdict}");
    }
}

fn per(time: Duration, cells: u64) -> f64 {
    time.as_secs_f64() * 1e9 / cells as f64
}

fn counts(cells: u64) -> Vec<u32> {
    Composition::closest(cells, 9, 1.9, false).unwrap().counts().to_vec()
}

/// Algorithms 1 and 2, small and large, and a shuffle of as many bytes.
fn filling() {
    let (small, large) = (256_u64, 8192_u64);
    let (few, many) = (counts(small * small), counts(large * large));
    let repeats = 64;
    let mut bytes: Vec<u16> = random_fill(&many, Seed(1));
    let [random_small, automaton_small, random_large, automaton_large, shuffle] = best(
        3,
        [
            &mut || {
                for seed in 0..repeats {
                    black_box(random_fill(&few, Seed(seed)));
                }
            },
            &mut || {
                for seed in 0..repeats {
                    let mut stream = Seed(seed).stream("landscape/automaton", 0);
                    black_box(automaton_fill(256, 256, &few, 0.1, &mut stream));
                }
            },
            &mut || {
                black_box(random_fill(&many, Seed(1)));
            },
            &mut || {
                let mut stream = Seed(1).stream("landscape/automaton", 0);
                black_box(automaton_fill(8192, 8192, &many, 0.1, &mut stream));
            },
            &mut || {
                Seed(1).stream("shuffle", 0).shuffle(&mut bytes);
                black_box(&bytes);
            },
        ],
    );
    let (few, many) = (small * small * repeats, large * large);
    say("random filling, ns a cell at 8192^2", per(random_large, many), f64::INFINITY);
    say("automaton, ns a cell at 8192^2", per(automaton_large, many), f64::INFINITY);
    say(
        "random filling, time a cell at 8192^2 by that at 256^2",
        per(random_large, many) / per(random_small, few),
        3.0,
    );
    say(
        "automaton, time a cell at 8192^2 by that at 256^2",
        per(automaton_large, many) / per(automaton_small, few),
        3.0,
    );
    say("random filling by a shuffle of the same bytes, 8192^2", ratio(random_large, shuffle), 3.0);
    say("automaton by a shuffle of the same bytes, 8192^2", ratio(automaton_large, shuffle), 3.0);
}

/// Total Edge and adjacency, and one vectorised pass that sums up the same memory.
fn counting() {
    for side in [1024_u64, 8192] {
        let cells = random_fill(&counts(side * side), Seed(1));
        let cols = side as usize;
        let [read, edges, adjacency, patched] = best(
            5,
            [
                &mut || {
                    let sum = black_box(&cells)
                        .chunks(4096)
                        .map(|lane| u64::from(lane.iter().fold(0_u16, |a, &b| a.wrapping_add(b))));
                    black_box(sum.sum::<u64>());
                },
                &mut || {
                    black_box(edge_count(black_box(&cells), cols));
                },
                &mut || {
                    black_box(Adjacency::new(black_box(&cells), cols));
                },
                &mut || {
                    black_box(patches(black_box(&cells), cols, Neighbourhood::Eight));
                },
            ],
        );
        say(&format!("reading, ns a cell, {side}^2"), per(read, side * side), f64::INFINITY);
        say(&format!("Total Edge by reading the memory once, {side}^2"), ratio(edges, read), 4.0);
        say(
            &format!("adjacency of 9 classes by reading the memory once, {side}^2"),
            ratio(adjacency, read),
            4.0,
        );
        say(
            &format!("patches by reading the memory once, {side}^2"),
            ratio(patched, read),
            f64::INFINITY,
        );
    }
}

/// Both targets on 1000 x 1000 cells, in every look.
fn exact() {
    for (algorithm, target) in [
        (Algorithm::Mixed, 800_000),
        (Algorithm::Mixed, 50_000),
        (Algorithm::Mixed, 1_900_000),
        (Algorithm::Bands, 800_000),
        (Algorithm::Automaton, 800_000),
        (Algorithm::Smooth, 200_000),
    ] {
        let spec = LandscapeSpec {
            rows: 1000,
            cols: 1000,
            algorithm,
            total_edge: Some(target),
            ..Default::default()
        };
        let mut seed = 0;
        let [time] = best(
            3,
            [&mut || {
                seed += 1;
                let landscape = spec.generate(Seed(seed)).unwrap();
                assert_eq!(landscape.total_edge(), target);
            }],
        );
        let limit = if target == 800_000 { 0.5 } else { f64::INFINITY };
        let what = format!("exact Total Edge {target} at 1000^2, {}, s", algorithm.name());
        say(&what, time.as_secs_f64(), limit);
    }
}

fn travel() {
    let spec = LandscapeSpec { rows: 500, cols: 500, speeds: vec![0.5; 9], ..Default::default() };
    let raster = spec.generate(Seed(1)).unwrap().to_raster();
    let map = TravelMap::new(&raster, Neighbourhood::Eight).unwrap();
    let [field] = best(
        2,
        [&mut || {
            black_box(map.cost_field(0));
        }],
    );
    say("cost field, ns a cell at 500^2", per(field, 250_000), f64::INFINITY);
}

fn ratio(a: Duration, b: Duration) -> f64 {
    a.as_secs_f64() / b.as_secs_f64()
}

fn main() {
    counting();
    exact();
    travel();
    filling();
}
