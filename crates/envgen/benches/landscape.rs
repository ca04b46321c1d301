//! Landscapes against baselines of the same run: a shuffle of the same bytes, a pass over the same
//! memory. Absolute times are given too, of the best round.
//!
//! `cargo bench -p envgen --bench landscape`

use std::hint::black_box;

use bench_ratio::{Times, at_most, contest, rounds, seconds};
use envgen::landscape::metrics::{Adjacency, Neighbourhood, patches};
use envgen::landscape::paths::TravelMap;
use envgen::landscape::{
    Algorithm, Composition, LandscapeSpec, automaton_fill, edge_count, random_fill,
};
use envgen::{Seed, Spec};

/// Rounds of tasks that take a second or more.
const LONG_TURNS: usize = 3;

/// A few rounds of two tasks.
fn long_contest<A, B>(ours: impl FnMut() -> A, baseline: impl FnMut() -> B) -> Times {
    rounds(LONG_TURNS, ours, baseline)
}

#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
fn say(what: &str, value: f64, unit: &str) {
    println!("{what}: {value:.2} {unit}");
}

fn ns(seconds: f64, cells: u64) -> f64 {
    seconds * 1e9 / cells as f64
}

fn counts(cells: u64) -> Vec<u32> {
    Composition::closest(cells, 9, 1.9, false)
        .map(|composition| composition.counts().to_vec())
        .unwrap_or_default()
}

/// Algorithms 1 and 2, small and large, and a shuffle of as many bytes.
fn filling() {
    let (side, repeats) = (256_u64, 64_u64);
    let (few, many) = (counts(side * side), counts(8192 * 8192));
    let cells = 8192 * 8192_u64;
    // As many cells in small grids as a sixteenth of the large one.
    let random = || (0..repeats).map(|seed| random_fill(&few, Seed(seed)).len()).sum::<usize>();
    let automaton = || {
        let fill = |seed: u64| {
            let mut stream = Seed(seed).stream("landscape/automaton", 0);
            automaton_fill(256, 256, &few, 0.1, &mut stream).len()
        };
        (0..repeats).map(fill).sum::<usize>()
    };
    let random_large = || random_fill(&many, Seed(1));
    let automaton_large = || {
        let mut stream = Seed(1).stream("landscape/automaton", 0);
        automaton_fill(8192, 8192, &many, 0.1, &mut stream)
    };
    let mut bytes = random_fill(&many, Seed(2));
    let mut shuffle = || Seed(1).stream("shuffle", 0).shuffle(black_box(&mut bytes));

    let scale = cells as f64 / (side * side * repeats) as f64;
    let times = long_contest(random_large, random).scaled(1.0, scale);
    say("random filling at 8192^2", ns(times.ours(), cells), "ns a cell");
    at_most("random filling of a cell at 8192^2, against one at 256^2", times, 3.0);
    let times = long_contest(automaton_large, automaton).scaled(1.0, scale);
    say("automaton at 8192^2", ns(times.ours(), cells), "ns a cell");
    at_most("automaton on a cell at 8192^2, against one at 256^2", times, 3.0);
    let both = long_contest(random_large, &mut shuffle);
    at_most("random filling at 8192^2, against a shuffle of as many bytes", both, 3.0);
    let both = long_contest(automaton_large, &mut shuffle);
    at_most("automaton at 8192^2, against a shuffle of as many bytes", both, 3.0);
}

/// Total Edge and adjacency, by one vectorised pass of one core that sums up the same memory. The
/// smaller raster stays in the cache; adjacency is counted on all cores where it does not.
fn counting() {
    for side in [1024_u64, 8192] {
        let cells = random_fill(&counts(side * side), Seed(1));
        let cols = side as usize;
        let read = || {
            let sum = black_box(&cells)
                .chunks(4096)
                .map(|lane| u64::from(lane.iter().fold(0_u16, |a, &b| a.wrapping_add(b))));
            sum.sum::<u64>()
        };
        let edges = contest(|| edge_count(black_box(&cells), cols), read);
        say(&format!("reading {side}^2"), ns(edges.baseline(), side * side), "ns a cell");
        at_most(&format!("Total Edge of {side}^2, against reading it once"), edges, 4.0);
        for classes in [2, 9, 10, 200] {
            let mut even = vec![(side * side / classes) as u32; classes as usize];
            even[0] += (side * side % classes) as u32;
            let cells = random_fill(&even, Seed(1));
            let what = format!("adjacency of {classes} classes, {side}^2");
            let adjacency = contest(|| Adjacency::new(black_box(&cells), cols), read);
            say(&what, ns(adjacency.ours(), side * side), "ns a cell");
            at_most(&format!("{what}, against reading it once"), adjacency, 4.0);
        }
        let patched = long_contest(|| patches(black_box(&cells), cols, Neighbourhood::Eight), read);
        say(&format!("patches of {side}^2"), ns(patched.ours(), side * side), "ns a cell");
    }
}

/// Both targets on 1000 x 1000 cells, with every algorithm; the target is half a second.
fn exact() {
    for (algorithm, target) in [
        (Algorithm::Mixed, 800_000),
        (Algorithm::Mixed, 50_000),
        (Algorithm::Mixed, 1_900_000),
        (Algorithm::Bands, 800_000),
        (Algorithm::Automaton, 800_000),
        (Algorithm::Smooth, 800_000),
    ] {
        let spec = LandscapeSpec {
            rows: 1000,
            cols: 1000,
            algorithm,
            total_edge: Some(target),
            ..Default::default()
        };
        let mut seed = 0;
        let times = (0..LONG_TURNS).map(|_| {
            seed += 1;
            let ours = seconds(|| {
                let found = spec.generate(Seed(seed)).map(|landscape| landscape.total_edge());
                assert_eq!(found, Ok(target));
            });
            (ours, 0.5)
        });
        let times: Times = times.collect();
        let name = algorithm.name();
        let what = format!("Total Edge {target} at 1000^2, {name}, against half a second");
        at_most(&what, times, 1.0);
    }
}

fn travel() {
    let spec = LandscapeSpec { rows: 500, cols: 500, speeds: vec![0.5; 9], ..Default::default() };
    let Ok(landscape) = spec.generate(Seed(1)) else { return };
    let raster = landscape.to_raster();
    let Ok(map) = TravelMap::new(&raster, Neighbourhood::Eight) else { return };
    let times = long_contest(|| map.cost_field(0), || map.cost_raster());
    say("cost field of 500^2", ns(times.ours(), 250_000), "ns a cell");
    say("cost raster of 500^2", ns(times.baseline(), 250_000), "ns a cell");
}

fn main() {
    counting();
    exact();
    travel();
    filling();
}
