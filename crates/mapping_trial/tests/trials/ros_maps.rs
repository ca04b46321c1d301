//! Robots in maps of ROS stay inside of these maps.

use envgen::Seed;
use envgen::import::ros_map::{RosDescription, RosMode, UnknownCells};
use mapping_trial::mappable_area::MappableArea;
use mapping_trial::trial::{Trial, TrialSettings};

/// A hall of 10 x 8 m whose lower wall has a gateway of 2 m at the image's border, with a room beside it that is
/// unknown.
fn map_with_a_gateway() -> Vec<u8> {
    let (cols, rows) = (50, 40);
    let mut file = format!("P5\n{cols} {rows}\n255\n").into_bytes();
    for row in 0..rows {
        for col in 0..cols {
            let is_wall = row == 0 || row + 1 == rows || col == 0 || col == 35;
            let is_gateway = row + 1 == rows && (15..25).contains(&col);
            let pixel = if is_gateway || !is_wall && col < 35 { 254 } else { 205 };
            file.push(if is_wall && !is_gateway { 0 } else { pixel });
        }
    }
    file
}

#[test]
fn robots_stay_inside_maps_with_open_borders() {
    let description = RosDescription {
        image: "hall.pgm".to_owned(),
        resolution: 0.2,
        origin: [-3.0, 2.0, 0.3],
        negate: false,
        occupied_thresh: 0.65,
        free_thresh: 0.196,
        mode: RosMode::Trinary,
    };
    let map = description.map(&map_with_a_gateway()).expect("a map");
    let world = map.to_world(UnknownCells::Solid);
    let settings = TrialSettings { time_limit: 240.0, seed: Seed(3), ..Default::default() };
    let area = MappableArea::new(&world, &settings.body).expect("a start");
    let mut trial = Trial::flat(&world, settings).expect("a free start");
    while trial.step() {}
    let size = [map.cols, map.rows()].map(|cells| cells as f64 * map.resolution);
    for pose in &trial.trajectory(0).poses {
        let p = map.origin.to_local(pose.position);
        assert!(p.x > 0.0 && p.x < size[0] && p.y > 0.0 && p.y < size[1], "{p} is outside");
    }
    // The robot mapped the hall. Beyond the gateway there is nothing to map.
    let truth = trial.reference(&world).expect("a start");
    let scores = trial.score(&truth).expect("scores");
    assert!(scores.coverage > 0.8, "{}", scores.coverage);
    assert!(area.free_area() < 7.0 * 8.0, "{}", area.free_area());
}
