//! Procedural roads against the definitions' oracles. Seeds are fixed; each tolerance states its
//! false-alarm rate.

mod bad_input;
mod geometry;
#[cfg(feature = "picture")]
mod pictures;
mod statistics;
mod worlds;

use envgen::glam::DVec2;
use envgen::road::{Road, RoadSegment, RoadSpec};
use envgen::{Seed, Spec};

const SEEDS: u64 = 10_000;

fn generate(spec: &RoadSpec, seed: u64) -> Road {
    spec.generate(Seed(seed)).unwrap()
}

fn turns(road: &Road) -> impl Iterator<Item = &RoadSegment> {
    road.segments().iter().filter(|segment| segment.kind.is_turn())
}

/// Where a road of straights and arcs ends, by complex numbers: each segment adds its chord.
fn closed_form_end(road: &Road) -> (DVec2, f64) {
    let start = road.spec().start();
    let (mut p, mut heading) = (start.position, start.heading);
    for segment in road.segments() {
        let chord = match segment.radius {
            None => segment.length,
            Some(radius) => 2.0 * radius * libm::sin(0.5 * segment.angle.abs()),
        };
        let direction = heading + 0.5 * segment.angle;
        p += DVec2::new(libm::cos(direction), libm::sin(direction)) * chord;
        heading += segment.angle;
    }
    (p, heading)
}
