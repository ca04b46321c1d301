//! A forest whose density is a closure: it grows from west to east, around a lake without trees.
//!
//! `cargo run --release --example custom_density`

#![expect(clippy::print_stdout, reason = "the output of an example")]

use std::error::Error;

use envgen::forest::ForestSpec;
use envgen::glam::DVec2;
use envgen::{Blueprint, Seed};

/// Trees per square metre at the eastern border, the greatest density.
const GREATEST: f64 = 0.2;

/// Radius of the lake in metres.
const LAKE: f64 = 8.0;

fn main() -> Result<(), Box<dyn Error>> {
    let spec = ForestSpec { width: 60.0, height: 60.0, radius: 0.3, ..Default::default() };
    let lake = spec.area().center();
    let density = |p: DVec2| {
        if p.distance(lake) < LAKE { 0.0 } else { GREATEST * p.x / spec.width }
    };
    // Points are drawn at the greatest density and kept in proportion, so it must be given too.
    let world = spec.generate_with(Seed(7), &(GREATEST, density))?.to_world();

    let mut strips = [0; 6];
    for tree in &world.trees {
        if tree.center.distance(lake) < LAKE {
            return Err(format!("a tree is in the lake, at {}", tree.center).into());
        }
        strips[((tree.center.x / 10.0) as usize).min(5)] += 1;
    }
    for (strip, trees) in strips.iter().enumerate() {
        println!("x from {:>2} m to {:>2} m: {trees:>3} trees", 10 * strip, 10 * (strip + 1));
    }
    if strips[5] <= strips[0] {
        return Err("the forest is not denser in the east".into());
    }
    Ok(())
}
