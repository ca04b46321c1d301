//! Waypoints against one sine and cosine each, and `locate` against a scan of all waypoints.

use std::hint::black_box;

use bench_ratio::{at_most, contest, faster};
use envgen::glam::DVec2;
use envgen::road::{Road, RoadSpec};
use envgen::{Seed, Spec};

const WAYPOINTS: usize = 1_000_000;

fn main() {
    for (name, random, transition) in [
        ("3 segments", 3, 0.0),
        ("2000 segments", 2000, 0.0),
        ("2000 segments with clothoids", 2000, 0.3),
    ] {
        let spec = RoadSpec {
            length: 1e6,
            step: 1.0,
            segment_count: random,
            p_turn: 0.9,
            transition,
            kerb: 0.0,
            ..Default::default()
        };
        if let Ok(road) = spec.generate(Seed(1)) {
            waypoints(name, &spec, &road);
            locate(name, &road);
        }
    }
}

/// Whole generation, waypoints stored, against the sine and cosine of their headings alone.
#[expect(clippy::disallowed_methods, reason = "the platform's sine is the faster baseline")]
fn waypoints(name: &str, spec: &RoadSpec, road: &Road) {
    let headings: Vec<f64> = road.waypoints().iter().map(|point| point.pose.heading).collect();
    let portable = || headings.iter().map(|&h| libm::sincos(h)).map(|(s, c)| s + c).sum::<f64>();
    let platform = || headings.iter().map(|&h| h.sin_cos()).map(|(s, c)| s + c).sum::<f64>();
    let generated = || spec.generate(Seed(1)).map(|road| road.waypoints().len());
    let what = format!("a waypoint of {name}");
    at_most(&format!("{what}, against libm's sincos"), contest(generated, portable), 4.0);
    at_most(&format!("{what}, against the platform's sin_cos"), contest(generated, platform), 4.0);
}

fn locate(name: &str, road: &Road) {
    let mut stream = Seed(2).stream("bench/points", 0);
    let points: Vec<DVec2> = (0..1000)
        .map(|_| {
            let near = road.waypoints()[stream.below(WAYPOINTS as u64) as usize].pose.position;
            near + DVec2::new(stream.between(-50.0, 50.0), stream.between(-50.0, 50.0))
        })
        .collect();
    let indexed = || points.iter().filter_map(|&p| road.locate(p)).map(|at| at.s).sum::<f64>();
    // One point is enough for the scan, whose time does not depend on where it lies.
    let scanned = || {
        let p = black_box(points[0]);
        let distances = road.waypoints().iter().map(|w| w.pose.position.distance_squared(p));
        distances
            .enumerate()
            .fold((0, f64::INFINITY), |best, next| if next.1 < best.1 { next } else { best })
    };
    let times = contest(indexed, scanned).scaled(1.0 / points.len() as f64, 1.0);
    faster(&format!("locating a point on {name}, against a scan"), times, 1000.0);
}
