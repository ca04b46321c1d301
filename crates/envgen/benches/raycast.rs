//! Rays and rasters against brute force.

use std::hint::black_box;

use bench_ratio::{at_most, contest, faster};
use envgen::forest::ForestSpec;
use envgen::geometry::{Pose, Shape, edges};
use envgen::glam::DVec2;
use envgen::hallway::HallwaySpec;
use envgen::occupancy::{Coverage, OccupancyGrid};
use envgen::raycast::{Raycaster, ScanPattern};
use envgen::{Blueprint, Seed, Spec, World};

const POSES: usize = 200;
const BEAMS: usize = 181;
const RANGE: f64 = 8.0;

fn main() {
    let hallway = HallwaySpec {
        segments: 200,
        door_frame_rate: 0.1,
        narrowing_rate: 0.1,
        alcove_rate: 0.1,
        ..Default::default()
    };
    let hallway = hallway.generate(Seed(1)).map(|hallway| {
        let poses: Vec<_> =
            hallway.layout().cells().iter().map(|c| Pose::new(c.x, c.y, 0.3)).collect();
        (hallway.to_world(), poses)
    });
    let forest = ForestSpec { width: 100.0, height: 100.0, ..Default::default() };
    let forest = forest.generate(Seed(1)).map(|forest| {
        let mut stream = Seed(1).stream("poses", 0);
        let mut pose = || {
            let position = DVec2::new(stream.between(0.0, 100.0), stream.between(0.0, 100.0));
            Pose { position, heading: stream.between(-3.0, 3.0) }
        };
        let poses: Vec<_> = (0..POSES).map(|_| pose()).collect();
        (forest.to_world(), poses)
    });
    for (name, made) in [("hallway", hallway.ok()), ("forest", forest.ok())] {
        if let Some((world, poses)) = made {
            rays(name, &world, &poses);
            raster(name, &world);
        }
    }
}

fn rays(name: &str, world: &World, poses: &[Pose]) {
    let index = Raycaster::new(world);
    let fan = ScanPattern::new(std::f64::consts::PI, BEAMS).expect("half a turn");
    let mut ranges = Vec::new();
    let mut all = || {
        let mut sum = 0.0;
        for &pose in poses {
            index.scan(pose, &fan, RANGE, &mut ranges);
            sum += ranges.iter().sum::<f64>();
        }
        sum
    };
    let shapes: Vec<Shape> = world.solids().map(|solid| solid.shape.into_owned()).collect();
    let brute = || {
        let mut sum = 0.0;
        for pose in poses {
            for beam in 0..BEAMS {
                let angle = beam as f64 / (BEAMS - 1) as f64 - 0.5;
                let heading = pose.heading + std::f64::consts::PI * angle;
                let direction = envgen::geometry::unit_vector(heading);
                sum += shapes
                    .iter()
                    .map(|shape| range(shape, pose.position, direction))
                    .fold(RANGE, f64::min);
            }
        }
        sum
    };
    let times = contest(&mut all, brute);
    let count = (poses.len() * BEAMS) as f64;
    faster(&format!("rays in a {name}, against brute force"), times, 20.0);
    // A bound that no caster can pass: reading one uniform number per ray.
    let mut stream = Seed(1).stream("uniform", 0);
    let times = contest(all, || (0..poses.len() * BEAMS).map(|_| stream.unit()).sum::<f64>());
    let ours = times.ours();
    at_most(&format!("a ray in a {name}, against a uniform number"), times, 50.0);
    #[expect(clippy::print_stdout, reason = "the result of a benchmark")]
    {
        println!("  {:.1} million rays per second in a {name}", count / ours / 1e6);
    }
}

fn range(shape: &Shape, from: DVec2, direction: DVec2) -> f64 {
    if let Shape::Disc { center, radius } = shape {
        let to = *center - from;
        let (middle, off) = (to.dot(direction), to.perp_dot(direction));
        let half2 = radius * radius - off * off;
        let near = middle - half2.max(0.0).sqrt();
        return if half2 >= 0.0 && near >= 0.0 { near } else { f64::INFINITY };
    }
    let corners = shape.corners();
    edges(&corners)
        .map(|(a, b)| {
            let (to, edge) = (a - from, b - a);
            let across = direction.perp_dot(edge);
            let (t, s) = (to.perp_dot(edge) / across, to.perp_dot(direction) / across);
            if t >= 0.0 && (0.0..=1.0).contains(&s) { t } else { f64::INFINITY }
        })
        .fold(f64::INFINITY, f64::min)
}

fn raster(name: &str, world: &World) {
    let cell = 0.1;
    let ours = || OccupancyGrid::of(world, cell, Coverage::Centre);
    let Ok(grid) = ours() else { return };
    let brute = || {
        let mut occupied = vec![false; grid.cols() * grid.rows()];
        for row in (0..grid.rows()).step_by(16) {
            for col in 0..grid.cols() {
                let p = grid.cell_centre(col, row);
                occupied[row * grid.cols() + col] =
                    world.solids().any(|solid| solid.shape.contains(p));
            }
        }
        occupied
    };
    // Brute force tests a sixteenth of the cells.
    let times = contest(ours, brute).scaled(1.0, 16.0);
    let what = format!("raster of a {name} at {cell} m, against brute force");
    faster(&what, times, 20.0);
    let times = contest(
        || OccupancyGrid::of(world, cell, Coverage::Centre),
        || black_box(vec![true; grid.cols() * grid.rows()]),
    );
    at_most(&format!("raster of a {name}, against filling its memory once"), times, 60.0);
}
