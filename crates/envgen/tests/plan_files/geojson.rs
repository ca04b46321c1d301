//! Polygons and roads of GeoJSON.

use std::f64::consts::FRAC_PI_2;

use envgen::geometry::{signed_area, unit_vector};
use envgen::glam::DVec2;
use envgen::import::read_geojson;
use envgen::indoor::IndoorSpec;
use envgen::road::{Prefab, RoadSpec};
use envgen::{Blueprint, Seed, Spec};
use serde_json::Value;

use super::{SQUARE, assert_read_back_as_geojson, written};

#[test]
fn nodes_on_straight_sides_of_polygons_with_holes_are_no_needles() {
    // Squares with two nodes on every side, turned, so that rounding moves the nodes off the sides.
    let ring = |half: f64, heading: f64| {
        let square = [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(x, y)| DVec2::new(x, y));
        let nodes = (0..12).map(|i| {
            let (a, b) = (square[i / 3], square[(i / 3 + 1) % 4]);
            let p = unit_vector(heading).rotate(a.lerp(b, (i % 3) as f64 / 3.0) * half);
            format!("[{:?},{:?}]", p.x, p.y)
        });
        let nodes: Vec<String> = nodes.collect();
        format!("[{},{}]", nodes.join(","), nodes[0])
    };
    for i in 0..100 {
        let heading = 0.06 * f64::from(i);
        let text = format!(
            r#"{{"type": "Polygon", "coordinates": [{}, {}]}}"#,
            ring(9.0, heading),
            ring(6.0, heading)
        );
        let world = read_geojson(&mut text.as_bytes()).unwrap();
        let areas = world.obstacles.iter().map(|obstacle| signed_area(&obstacle.shape.corners()));
        assert!(areas.clone().all(|area| area > 1e-6), "{heading}: {areas:?}");
        assert!((areas.sum::<f64>() - 180.0).abs() < 1e-6, "{heading}");
    }
}

#[test]
fn closed_roads_are_closed_lines() {
    use Prefab::{Left, Straight};
    let prefabs = [Straight, Left].repeat(4);
    let spec = RoadSpec { prefabs, closed: true, speed: 10.0, ..Default::default() };
    let world = spec.generate(Seed(3)).unwrap().to_world();
    let text = written(&world, "a.geojson");
    let collection: Value = serde_json::from_str(&text).unwrap();
    let features = collection["features"].as_array().unwrap();
    let road = features.iter().find(|feature| feature["id"] == "road_strip 0").unwrap();
    let line = road["geometry"]["coordinates"].as_array().unwrap();
    assert_eq!(line.first(), line.last());
    assert_eq!(line.len(), world.road_strips[0].centreline.len() + 1);
    assert_read_back_as_geojson(&world);
    // Closed by its points alone, and not closed whatever its points are.
    let read = |text: &str| {
        let road = read_geojson(&mut text.as_bytes()).unwrap().road_strips.remove(0);
        (road.closed, road.centreline.len())
    };
    let points = world.road_strips[0].centreline.len();
    assert_eq!(read(&text), (true, points));
    assert_eq!(read(&text.replace("\"closed\":true,", "")), (true, points));
    let open = text.replace("\"closed\":true", "\"closed\":false");
    assert_eq!(read(&open), (false, points + 1));
    // The last point heads for the first.
    let square = read_geojson(
        &mut format!(
            r#"{{"type": "Feature", "properties": {{"part": "road_strip"}},
            "geometry": {{"type": "LineString", "coordinates": {SQUARE}}}}}"#
        )
        .as_bytes(),
    );
    let last = square.unwrap().road_strips[0].centreline[3].pose;
    assert_eq!((last.position, last.heading), (DVec2::new(0.0, 10.0), -FRAC_PI_2));
}

#[test]
fn bounds_are_as_stated_where_parts_reach_over_them_by_rounding() {
    let world = IndoorSpec { width: 6, height: 6, ..Default::default() };
    let world = world.generate(Seed(1)).unwrap().to_world();
    let text = written(&world, "a.geojson");
    assert_eq!(read_geojson(&mut text.as_bytes()).unwrap().bounds, world.bounds);
    // Walls that lie outside enlarge them.
    let mut collection: Value = serde_json::from_str(&text).unwrap();
    collection["bbox"] = serde_json::json!([1.0, 1.0, 5.0, 5.0]);
    let bounds = read_geojson(&mut collection.to_string().as_bytes()).unwrap().bounds;
    assert!((bounds.min - world.bounds.min).abs().max_element() < 1e-9, "{bounds:?}");
    assert!((bounds.max - world.bounds.max).abs().max_element() < 1e-9, "{bounds:?}");
}
