//! Uses a world that was read as a program would. No step may panic or take long.

use envgen::World;
use envgen::clearance_index::ClearanceIndex;
use envgen::export::ros_map::RosMap;
use envgen::export::{Format, Job};
use envgen::glam::DVec2;
use envgen::occupancy::{Coverage, OccupancyGrid};
use envgen::placement::max_clearance_point;
use envgen::raycast::{Raycaster, ScanPattern};
use envgen::surface_index::SurfaceIndex;
use mapping_trial::robot::Robot;
use mapping_trial::score::Reference;
use mapping_trial::trial::{Trial, TrialSettings};

/// The number of cells along the longer side of a world.
const CELLS: f64 = 64.0;

/// The longest side in metres of a world that is mapped at a fixed resolution.
const LONGEST: f64 = 30.0;

/// One file in this many gets the expensive steps.
const THOROUGH: u32 = 32;

/// One file in this many is drawn in pixels, which takes most of the time and reads nothing.
const DRAWN: u32 = 512;

/// Returns whether a file gets the expensive steps.
pub fn thorough(file: &[u8]) -> bool {
    crc32fast::hash(file).is_multiple_of(THOROUGH)
}

/// Uses a valid world that was read from a file, always with the same steps.
pub fn world(world: &World, file: &[u8]) {
    let thorough = thorough(file);
    let drawn = crc32fast::hash(file).is_multiple_of(DRAWN);
    let digest = world.digest();
    let bounds = world.bounds;
    let points = [
        bounds.center(),
        bounds.min,
        bounds.max,
        world.start.map_or(DVec2::ZERO, |start| start.position),
        DVec2::splat(1e300),
        DVec2::NAN,
    ];
    let rays = Raycaster::new(world);
    let grounds = SurfaceIndex::new(world);
    let Ok(near) = ClearanceIndex::new(world, 1.0) else { unreachable!("a metre") };
    let Ok(fan) = ScanPattern::new(std::f64::consts::TAU, 8) else { unreachable!("a full turn") };
    let mut ranges = Vec::new();
    for p in points {
        let pose = envgen::geometry::Pose { position: p, heading: 0.3 };
        rays.scan(pose, &fan, 100.0, &mut ranges);
        let _ = rays.cast(p, 1.0, f64::INFINITY);
        let _ = grounds.at(p);
        let _ = near.clearance(p);
    }
    let resolution = bounds.size().max_element() / CELLS;
    for coverage in [Coverage::Centre, Coverage::Conservative] {
        if let Ok(grid) = OccupancyGrid::of(world, resolution, coverage) {
            let _ = max_clearance_point(&grid);
        }
    }
    let _ = RosMap::of_world(world, resolution);
    for strip in &world.road_strips {
        let _ = strip.mesh(0.1);
    }
    let small = bounds.size().max_element() <= LONGEST;
    for &format in Format::ALL {
        let dear = !matches!(
            format,
            Format::Json | Format::Ron | Format::OpenDrive | Format::Csv | Format::Asc
        );
        if dear && !(thorough && small) || format == Format::Png && !drawn {
            continue;
        }
        for (_, write) in format.files() {
            let _ = write(&Job::new(world), &mut std::io::sink());
        }
    }
    if thorough && small {
        let _ = Reference::new(world, &Robot::default());
        let settings = TrialSettings { time_limit: 0.5, ..Default::default() };
        if let Ok(mut trial) = Trial::flat(world, settings) {
            while trial.step() {}
        }
    }
    assert!(world.digest() == digest, "a world has one digest");
}
