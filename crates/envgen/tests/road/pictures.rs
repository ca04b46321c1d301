//! Pictures show the exact curves of roads, not lines between waypoints.

use envgen::glam::DVec2;
use envgen::picture::{self, PictureOptions};
use envgen::road::Prefab::{Left, Right, Straight};
use envgen::road::RoadSpec;
use envgen::{Blueprint, palette};

use super::generate;

fn bare() -> PictureOptions {
    let title = Some(String::new());
    PictureOptions {
        title,
        legend: false,
        margin: 0,
        curvature_profile: true,
        ..Default::default()
    }
}

/// Roads whose steps cover much of their turns.
fn coarse() -> [RoadSpec; 2] {
    let wide = RoadSpec {
        length: 300.0,
        step: 30.0,
        speed: 0.0,
        width: 2.0,
        theta_min: 200.0,
        theta_max: 340.0,
        prefabs: vec![Left, Straight, Right, Straight],
        ..Default::default()
    };
    [wide, RoadSpec { transition: 0.5, step: 60.0, ..Default::default() }]
}

#[test]
fn pictures_are_the_same_for_every_step() {
    for spec in coarse() {
        for seed in 0..5 {
            let of_step = |step| {
                let world = generate(&RoadSpec { step, ..spec.clone() }, seed).to_world();
                picture::svg(&world, &bare()).unwrap()
            };
            assert!(of_step(spec.step) == of_step(1.0), "seed {seed}");
        }
    }
}

#[test]
fn the_surface_lies_between_the_kerbs() {
    let [spec, _] = coarse();
    let spec = RoadSpec { lanes: 1, ..spec };
    for seed in 0..5 {
        let road = generate(&spec, seed);
        let world = road.to_world();
        let options = bare();
        let pixels = picture::pixels(&world, &options).unwrap();
        let extent = world.bounds.union(world.road_strips[0].bounds().unwrap());
        let most = DVec2::new(options.width.into(), options.height.into());
        // The plan has a border of 14 px, or of 30 px where the symbols of start and goal would not fit.
        let drawn = |border: f64| {
            let scale = ((most - 2.0 * border) / extent.size()).min_element();
            let size = (extent.size() * scale + 2.0 * border).ceil();
            let gap = 0.5 * (size - extent.size() * scale);
            let is_asphalt = |p: &DVec2| {
                let at = (DVec2::new(p.x - extent.min.x, extent.max.y - p.y)) * scale + gap;
                let i = 3 * (at.y as usize * pixels.width as usize + at.x as usize);
                pixels.rgb.get(i..i + 3) == Some(palette::ROAD.fill.0.as_slice())
            };
            // Symbols cover the start and the end.
            let middles = (100..2900).map(|i| road.pose_at(0.1 * f64::from(i)).position);
            middles.filter(is_asphalt).count()
        };
        let drawn = drawn(14.0).max(drawn(30.0));
        assert!(drawn > 2700, "seed {seed}: {drawn} of 2800 points");
    }
}

#[test]
fn huge_roads_are_small_pictures() {
    let spec = RoadSpec {
        length: 1e6,
        segment_count: 4096,
        step: 100.0,
        kerb: 0.0,
        transition: 0.2,
        ..Default::default()
    };
    let svg = picture::svg(&generate(&spec, 1).to_world(), &bare()).unwrap();
    assert!(svg.len() < 200_000, "{} bytes", svg.len());
}
