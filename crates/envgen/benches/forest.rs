//! Forests against two uniform numbers per tree, against the crate `fast_poisson` and against brute
//! force.
#![expect(clippy::print_stdout, reason = "the result of a benchmark")]

use bench_ratio::{Times, at_most, contest, faster, growth, rounds, seconds};
use envgen::forest::{EndlessForest, ForestSpec};
use envgen::geometry::Rect;
use envgen::glam::DVec2;
use envgen::{Blueprint, Seed, Spec};
use fast_poisson::Poisson2D;

fn main() {
    plain();
    spaced();
    brute_force();
    endless();
    metrics();
}

/// A square forest of `trees` trees whose intensity x distance^2 is `filling`; 1 m apart.
fn spec(trees: f64, filling: f64) -> ForestSpec {
    let side = (trees / filling).sqrt();
    ForestSpec {
        width: side,
        height: side,
        intensity: filling,
        radius: 0.1,
        min_distance: 1.0,
        ..Default::default()
    }
}

fn plain() {
    let plain = ForestSpec { min_distance: 0.0, ..spec(1e6, 0.05) };
    let times = contest(
        || plain.generate(Seed(1)),
        || {
            let mut stream = Seed(1).stream("uniform", 0);
            let mut places = Vec::with_capacity(1_000_000);
            for _ in 0..1_000_000 {
                places.push(DVec2::new(stream.unit(), stream.unit()));
            }
            places
        },
    );
    at_most("plain forest of 1e6 trees, against two uniforms a tree", times, 3.0);
}

fn trees(spec: &ForestSpec) -> usize {
    spec.generate(Seed(1)).map_or(0, |forest| forest.trees().len())
}

fn spaced() {
    let mut costs = Vec::new();
    for (count, repeats) in [(1e4, 5), (1e5, 3), (1e6, 1)] {
        // fast_poisson fills its area as densely as it can: about 0.63 by this measure.
        let side = f64::sqrt(count / 0.63);
        let mut made = 1;
        let peer: Vec<f64> = (0..repeats)
            .map(|_| {
                let points = Poisson2D::new().with_dimensions([side, side], 1.0).with_seed(1);
                seconds(|| made = points.generate().len())
            })
            .collect();
        for filling in [0.2, 0.5, 0.6] {
            let spec = spec(count, filling);
            // The peer takes long: its rounds are used several times.
            let all = peer.iter().cycle().take(5).map(|&peer| (seconds(|| trees(&spec)), peer));
            let times: Times = all.collect();
            let what = format!("{count:e} trees at intensity x distance^2 = {filling}");
            if filling == 0.5 {
                costs.push((count, times.ours()));
            }
            let target = if count == 1e6 && filling == 0.5 { 50.0 } else { 1.0 };
            let per_tree = times.scaled(1.0 / trees(&spec) as f64, 1.0 / made as f64);
            faster(&format!("{what}, a tree, against fast_poisson"), per_tree, target);
        }
    }
    growth("spaced trees at intensity x distance^2 = 0.5, by their number", &costs);
    for filling in [0.2, 0.5, 0.6] {
        let (small, large) = (spec(1e4, filling), spec(1e6, filling));
        let hundred_small = || (0..100).map(|_| trees(&small)).sum::<usize>();
        let times = rounds(5, || trees(&large), hundred_small);
        println!(
            "  {:.2} million trees per second at 1e6",
            trees(&large) as f64 / times.ours() / 1e6
        );
        at_most(&format!("a tree of 1e6, at {filling}, against one of 1e4"), times, 3.0);
    }
}

fn brute_force() {
    let spec = spec(2000.0, 0.5);
    let times = contest(
        || spec.generate(Seed(1)),
        || {
            let mut stream = Seed(1).stream("uniform", 0);
            let mut placed: Vec<DVec2> = Vec::new();
            while placed.len() < 2000 {
                let p = DVec2::new(stream.unit() * spec.width, stream.unit() * spec.height);
                if placed.iter().all(|q| q.distance_squared(p) >= 1.0) {
                    placed.push(p);
                }
            }
            placed
        },
    );
    faster("2000 spaced trees, against comparing each with each", times, 4.0);
}

/// A window of 100 x 100 tiles, spaced and plain, with as many trees.
fn endless() {
    let window = Rect::new(DVec2::splat(-503.0), DVec2::splat(497.0));
    let forest = |min_distance: f64| {
        let spec = ForestSpec { min_distance, intensity: 0.15, ..Default::default() };
        EndlessForest::new(&spec, 10.0, Seed(1))
    };
    let (Ok(spaced), Ok(plain)) = (forest(1.0), forest(0.0)) else { return };
    let times = contest(|| spaced.window(window), || plain.window(window));
    at_most("endless spaced forest, against a plain one", times, 10.0);
    let tiles = || {
        (-51..49).map(|i| (-51..49).map(|j| spaced.tile(i, j).len()).sum::<usize>()).sum::<usize>()
    };
    let times = contest(|| spaced.window(window), tiles);
    at_most("a window of an endless spaced forest, against its tiles one by one", times, 0.7);
}

/// Neighbours that lie far apart in memory would make a tree of a large forest cost more.
fn metrics() {
    let forest =
        |trees: f64| ForestSpec { min_distance: 0.0, ..spec(trees, 0.5) }.generate(Seed(1));
    let (Ok(small), Ok(large)) = (forest(1e4), forest(1e6)) else { return };
    let hundred_small = || (0..100).map(|_| small.metrics().count).sum::<u64>();
    let times = rounds(5, || large.metrics().count, hundred_small);
    at_most("metrics of a tree of 1e6, against one of 1e4", times, 3.0);
}
