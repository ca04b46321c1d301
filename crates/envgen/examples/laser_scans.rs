//! Drives a laser scanner along the middle of a hallway and prints its ranges: how a program uses
//! worlds without an engine.
//!
//! `cargo run --release --example laser_scans`

use std::f64::consts::PI;

use envgen::geometry::Pose;
use envgen::hallway::HallwaySpec;
use envgen::raycast::{Raycaster, ScanPattern};
use envgen::{Blueprint, GenerateError, Seed, Spec};

fn main() -> Result<(), GenerateError> {
    let spec = HallwaySpec { segments: 20, door_frame_rate: 0.1, ..Default::default() };
    let hallway = spec.generate(Seed(7))?;
    let rays = Raycaster::new(&hallway.to_world());
    let scanner = ScanPattern::new(PI, 181)?;
    let mut ranges = Vec::new();
    for (cell, state) in hallway.layout().cells().iter().zip(hallway.states()) {
        let ahead = state.exit();
        let heading = if ahead.y > 0.0 {
            0.5 * PI
        } else if ahead.x > 0.0 {
            0.0
        } else {
            PI
        };
        rays.scan(Pose::new(cell.x, cell.y, heading), &scanner, 8.0, &mut ranges);
        #[expect(clippy::print_stdout, reason = "the output of an example")]
        {
            let (right, front, left) = (ranges[0], ranges[90], ranges[180]);
            println!(
                "state {state} at {cell}: {right:.2} m right, {front:.2} m ahead, {left:.2} m left"
            );
        }
    }
    Ok(())
}
