//! Hallways against drawing as many uniform numbers.

use bench_ratio::{at_most, contest};
use envgen::hallway::HallwaySpec;
use envgen::{Blueprint, Seed, Spec};

const HALLWAYS: u64 = 2000;

fn main() {
    let spec = HallwaySpec::default();
    let uniform = || {
        (0..HALLWAYS)
            .map(|seed| {
                let mut stream = Seed(seed).stream("uniform", 0);
                (1..spec.segments).map(|_| stream.unit()).sum::<f64>()
            })
            .sum::<f64>()
    };
    let each = |work: fn(envgen::hallway::Hallway) -> usize| {
        let spec = &spec;
        move || {
            (0..HALLWAYS).filter_map(|seed| spec.generate(Seed(seed)).ok()).map(work).sum::<usize>()
        }
    };
    let states = contest(each(|hallway| hallway.states().len()), uniform);
    at_most("states of 50 segments, against their uniform numbers", states, 6.0);
    let layout = contest(each(|hallway| hallway.layout().left_face().len()), uniform);
    at_most("states and layout, against their uniform numbers", layout, 25.0);
    let world = contest(each(|hallway| hallway.to_world().walls.len()), uniform);
    at_most("states, layout and world, against their uniform numbers", world, 150.0);
}
