//! Polygons and roads of GeoJSON.

use envgen::geometry::{signed_area, unit_vector};
use envgen::glam::DVec2;
use envgen::import::read_geojson;

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
