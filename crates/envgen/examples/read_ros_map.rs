//! Reads a map of ROS or Nav2 as a world, and prints its size, its free area and a start for a robot.
//!
//! ```sh
//! cargo run --release --example read_ros_map
//! cargo run --release --example read_ros_map -- map.yaml
//! ```
//!
//! Without a file it first writes the map of a hallway to a temporary folder.

#![expect(clippy::print_stdout, reason = "the output of an example")]

use std::error::Error;
use std::fs::File;
use std::path::{Path, PathBuf};

use envgen::export::ros_map::{RosCell, RosMap};
use envgen::hallway::HallwaySpec;
use envgen::import::ros_map::{UnknownCells, read_ros_map};
use envgen::raycast::Raycaster;
use envgen::{Blueprint, Seed, Spec};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let yaml = match std::env::args_os().nth(1) {
        Some(path) => PathBuf::from(path),
        None => write_map(folder.path())?,
    };

    // `import::read_world` reads it in one call, if the cells themselves are not needed.
    let map = read_ros_map(&mut File::open(&yaml)?, &yaml)?;
    let metres = |cells: usize| cells as f64 * map.resolution;
    println!("{} is {:.2} m x {:.2} m", yaml.display(), metres(map.cols), metres(map.rows()));
    let free = map.cells.iter().filter(|&&cell| cell == RosCell::Free).count();
    println!("{:.2} m^2 of it are free", free as f64 * map.resolution * map.resolution);

    // A robot must not drive where nothing is known.
    let world = map.to_world(UnknownCells::Solid);
    world.check()?;
    println!("as a world it has {} walls, {} obstacles", world.walls.len(), world.obstacles.len());
    let start = world.start.ok_or("no cell of the map is free")?;
    println!("the place with the greatest clearance is {:.2}", start.position);
    let ahead = Raycaster::new(&world).cast(start.position, start.heading, 100.0);
    let ahead = ahead.ok_or("the map is not closed")?;
    println!("a ray ahead from there ends after {:.2} m", ahead.distance);
    Ok(())
}

/// Writes the map of a hallway, and returns the path of its description.
fn write_map(folder: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let hallway = HallwaySpec { segments: 20, ..Default::default() }.generate(Seed(7))?;
    let map = RosMap::of_world(&hallway.to_world(), 0.05)?;
    let yaml = folder.join("hallway.yaml");
    map.write_yaml("hallway.pgm", &mut File::create(&yaml)?)?;
    map.write_pgm(&mut File::create(folder.join("hallway.pgm"))?)?;
    Ok(yaml)
}
