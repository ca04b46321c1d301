//! Worlds as GeoJSON, as houses of HouseExpo, as buildings of Open-RMF and as comma-separated values.

mod buildings;
#[path = "../common/mod.rs"]
mod common;
mod geojson;

use std::path::Path;

use envgen::export::{Format, Job};
use envgen::geometry::{Pose, Rect, Shape, signed_area};
use envgen::glam::DVec2;
use envgen::import::{read_geojson, read_houseexpo, reader};
use envgen::world::{Doorway, Extent, Obstacle, ObstacleKind, Tree, Wall, WallKind};
use envgen::{Provenance, Seed, World, WorldKind};
use proptest::prelude::*;
use serde_json::Value;

fn written(world: &World, name: &str) -> String {
    let format = Format::from_path(Path::new(name)).unwrap();
    let job = Job { stem: "small".to_owned(), ..Job::new(world) };
    let mut file = Vec::new();
    format.write(&job, &mut file).unwrap();
    String::from_utf8(file).unwrap()
}

/// A room of 4 m by 3 m with a door to the right, a pillar and a crate.
fn small() -> World {
    let bounds = Rect::new(DVec2::ZERO, DVec2::new(4.0, 3.0));
    let mut world = World::new(Provenance::other("manual", "small".into()), bounds);
    let rect = |x0, y0, x1, y1| Shape::from_rect(Rect::new(DVec2::new(x0, y0), DVec2::new(x1, y1)));
    for shape in [
        rect(0.0, 0.0, 4.0, 0.25),
        rect(0.0, 2.75, 4.0, 3.0),
        rect(0.0, 0.25, 0.25, 2.75),
        rect(3.75, 0.25, 4.0, 1.0),
        rect(3.75, 2.0, 4.0, 2.75),
    ] {
        world.walls.push(Wall::new(WallKind::Wall, shape));
    }
    world.doorways.push(Doorway {
        height: None,
        shape: rect(3.75, 1.0, 4.0, 2.0),
        open: false,
        rooms: [None; 2],
    });
    world.trees.push(Tree {
        height: Some(Extent::new(0.0, 7.5).unwrap()),
        ..Tree::new(DVec2::new(1.0, 2.25), 0.125)
    });
    let vertices = vec![DVec2::new(2.0, 2.0), DVec2::new(2.5, 2.0), DVec2::new(2.0, 2.5)];
    world.obstacles.push(Obstacle::new(ObstacleKind::Crate, Shape::Polygon { vertices }));
    world.start = Some(Pose::new(1.0, 1.0, 0.5));
    world.goal = Some(Pose::new(3.0, 1.0, 0.0));
    assert_eq!(world.check(), Ok(()));
    world
}

/// Points all over a world, and beside it.
fn points(world: &World) -> impl Iterator<Item = DVec2> + '_ {
    let mut stream = Seed(5).stream("tests/points", 0);
    let area = world.bounds.grown(0.1);
    (0..400).map(move |_| {
        DVec2::new(stream.between(area.min.x, area.max.x), stream.between(area.min.y, area.max.y))
    })
}

fn assert_same_free_space(world: &World, other: &World, tolerance: f64) {
    for p in points(world) {
        let (a, b) = (world.clearance(p), other.clearance(p));
        assert!((a - b).abs() <= tolerance || a == b, "{p}: {a} and {b}");
    }
}

fn assert_read_back_as_geojson(world: &World) {
    let text = written(world, "a.geojson");
    assert_eq!(text, written(world, "a.geojson"));
    let read = read_geojson(&mut text.as_bytes()).unwrap();
    assert_same_free_space(world, &read, 1e-9);
    assert_eq!((read.start.is_some(), read.goal), (true, world.goal));
    assert!(world.start.is_none() || read.start == world.start);
    assert_eq!(read.bounds, world.bounds);
    let counts = |world: &World| {
        let parts = [world.walls.len(), world.rooms.len(), world.obstacles.len()];
        (parts, world.trees.clone(), world.doorways.len(), world.victims.clone())
    };
    assert_eq!(counts(&read), counts(world));
    for (room, read) in world.rooms.iter().zip(&read.rooms) {
        assert_eq!(
            (&room.name, room.difficulty, room.lit),
            (&read.name, read.difficulty, read.lit)
        );
    }
    for (surface, read) in world.surfaces.iter().zip(&read.surfaces) {
        assert_eq!((surface.kind, surface.speed), (read.kind, read.speed));
    }
    for (doorway, read) in world.doorways.iter().zip(&read.doorways) {
        assert_eq!((doorway.open, doorway.rooms), (read.open, read.rooms));
    }
    for (road, read) in world.road_strips.iter().zip(&read.road_strips) {
        let places = |road: &envgen::world::RoadStrip| {
            road.centreline.iter().map(|point| point.pose.position).collect::<Vec<_>>()
        };
        assert_eq!((places(road), road.width, road.lanes), (places(read), read.width, read.lanes));
    }
    assert_eq!(read.provenance.spec["made_by"]["kind"], world.provenance.kind.as_str());
}

#[test]
fn worlds_of_all_kinds_come_back_from_geojson() {
    for &kind in WorldKind::ALL {
        let world = kind.default_spec().generate(Seed(3)).unwrap().to_world();
        assert_read_back_as_geojson(&world);
    }
    assert_read_back_as_geojson(&small());
    assert_read_back_as_geojson(&common::everything());
}

#[test]
fn small_worlds_as_geojson() {
    let text = written(&small(), "a.geojson");
    let collection: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(collection["bbox"], serde_json::json!([0.0, 0.0, 4.0, 3.0]));
    assert!(collection["frame"].as_str().unwrap().contains("metres"));
    let features = collection["features"].as_array().unwrap();
    let of = |id: &str| features.iter().find(|feature| feature["id"] == id).unwrap();
    let doorway = of("doorway 0");
    assert_eq!(doorway["properties"]["solid"], true);
    assert_eq!(
        doorway["geometry"]["coordinates"],
        serde_json::json!([[[3.75, 1.0], [4.0, 1.0], [4.0, 2.0], [3.75, 2.0], [3.75, 1.0]]])
    );
    assert_eq!(of("start")["properties"]["heading"], 0.5);
    assert_eq!(of("tree 0")["properties"]["radius"], 0.125);
    assert_eq!(of("tree 0")["geometry"]["coordinates"][0].as_array().unwrap().len(), 65);
    assert_eq!(of("obstacle 0")["properties"]["kind"], "crate");
}

#[test]
fn geojson_of_others_is_read() {
    let read = |text: &str| read_geojson(&mut text.as_bytes());
    // A courtyard: a square ring, its outer corners clockwise, and a disc in the middle.
    let ring = r#"{"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": null, "geometry": {"type": "Polygon", "coordinates":
            [[[0,0],[0,10],[10,10],[10,0],[0,0]], [[1,1],[9,1],[9,9],[1,9],[1,1]]]}},
        {"type": "Feature", "properties": {"radius": 0.5}, "geometry":
            {"type": "Point", "coordinates": [5, 5, 0]}},
        {"type": "Feature", "properties": {"kind": "bench"}, "geometry":
            {"type": "LineString", "coordinates": [[2,2],[3,2],[3,2],[3,3]]}},
        {"type": "Feature", "properties": {}, "geometry": null}]}"#;
    let world = read(ring).unwrap();
    assert_eq!(world.bounds, Rect::new(DVec2::ZERO, DVec2::splat(10.0)));
    let area: f64 = world.obstacles.iter().map(|obstacle| obstacle.shape.area()).sum();
    assert!((area - 36.0 - 0.25 * std::f64::consts::PI).abs() < 1e-12);
    assert_eq!(world.walls.len(), 2);
    assert!((world.clearance(DVec2::new(5.0, 6.5)) - 1.0).abs() < 1e-12);
    assert_eq!(world.clearance(DVec2::new(0.5, 5.0)), 0.0);
    assert!(world.start.is_some_and(|start| world.clearance(start.position) > 1.0));
    let square = r#"{"type": "MultiPolygon", "coordinates": [[[[0,0],[1,0],[1,1],[0,0]]]]}"#;
    assert_eq!(read(square).unwrap().obstacles.len(), 1);
    let moved = written(&small(), "a.geojson").replacen("1.125,2.25", "1.2,2.25", 2);
    let moved = read(&moved).unwrap();
    // A disc with a corner that was moved is the polygon.
    assert_eq!((moved.trees.len(), moved.obstacles.len()), (0, 2));
    let top = moved.obstacles.iter().map(|one| one.extent().top()).fold(0.0, f64::max);
    assert_eq!(top, small().trees[0].extent().top());
    // As a whole it stays a disc, whatever its properties say.
    let mut file: Value = serde_json::from_str(&written(&small(), "a.geojson")).unwrap();
    for feature in file["features"].as_array_mut().unwrap() {
        if feature["properties"]["part"] == "tree" {
            for corner in feature["geometry"]["coordinates"][0].as_array_mut().unwrap() {
                corner[0] = (corner[0].as_f64().unwrap() + 0.25).into();
            }
        }
    }
    let shifted = read(&file.to_string()).unwrap();
    assert!((shifted.trees[0].center.x - small().trees[0].center.x - 0.25).abs() < 1e-9);
    let line = r#"{"type": "Feature", "properties": {"part": "start"}, "geometry":
        {"type": "LineString", "coordinates": [[1,1],[2,2]]}}"#;
    let error = read(line).unwrap_err().to_string();
    assert!(error.contains("`features[0].geometry` must be a point"), "{error}");
}

#[test]
fn doorways_name_rooms_by_the_order_of_their_features() {
    let feature = |part: &str, rings: &str, more: &str| {
        format!(
            r#"{{"type": "Feature", "properties": {{"part": "{part}", "name": "{part}" {more}}},
            "geometry": {{"type": "Polygon", "coordinates": [{rings}]}}}}"#
        )
    };
    let ring = "[[0,0],[9,0],[9,9],[0,9],[0,0]], [[3,3],[6,3],[6,6],[3,6],[3,3]]";
    let square = "[[9,0],[18,0],[18,9],[9,9],[9,0]]";
    let opening = "[[8.9,4],[9.1,4],[9.1,5],[8.9,5],[8.9,4]]";
    let read = |rooms: &str| {
        let features = [
            feature("room", ring, ""),
            feature("room", square, ", \"lit\": false"),
            feature("doorway", opening, &format!(", \"rooms\": {rooms}")),
        ];
        let text =
            format!(r#"{{"type": "FeatureCollection", "features": [{}]}}"#, features.join(","));
        read_geojson(&mut text.as_bytes())
    };
    let world = read("[0, 1]").unwrap();
    assert!(world.rooms.len() > 2 && !world.rooms.last().unwrap().lit);
    assert_eq!(world.doorways[0].rooms, [Some(0), Some(world.rooms.len() as u32 - 1)]);
    assert_eq!(read("[null, 0]").unwrap().doorways[0].rooms, [None, Some(0)]);
    for rooms in ["[0, 2]", "[4294967295, 0]"] {
        let error = read(rooms).unwrap_err().to_string();
        assert!(error.contains("doorways[0].rooms"), "{error}");
    }
}

#[test]
fn roads_have_a_length() {
    let road = |points: &str| {
        let text = format!(
            r#"{{"type": "Feature", "properties": {{"part": "road_strip", "width": 2}},
            "geometry": {{"type": "LineString", "coordinates": [{points}]}}}}"#
        );
        read_geojson(&mut text.as_bytes())
    };
    let error = road("[1,1],[1,1],[1,1]").unwrap_err().to_string();
    assert!(error.contains("`features[0].geometry` must be a line with at least two"), "{error}");
    let world = road("[0,0],[0,0],[10,0],[10,0],[10,10]").unwrap();
    assert_eq!(world.road_strips[0].centreline.len(), 3);
    // The right angle takes a square inside as much as it adds outside.
    let mesh = world.road_strips[0].mesh(0.01);
    let corners = |triangle: &[u32; 3]| triangle.map(|i| mesh.vertices[i as usize]);
    let areas = mesh.triangles.iter().map(|triangle| signed_area(&corners(triangle)));
    assert!(areas.clone().all(|area| area > 0.0) && (areas.sum::<f64>() - 40.0).abs() < 1e-9);
    // A circuit turns where it closes, too: a square of 12 m without one of 8 m.
    let circuit = written(&world, "a.geojson").replace("\"closed\":false", "\"closed\":true");
    let circuit = circuit.replace("[[0.0,0.0],[10.0,0.0],[10.0,10.0]]", SQUARE);
    let world = read_geojson(&mut circuit.as_bytes()).unwrap();
    let mesh = world.road_strips[0].mesh(0.01);
    let corners = |triangle: &[u32; 3]| triangle.map(|i| mesh.vertices[i as usize]);
    let areas = mesh.triangles.iter().map(|triangle| signed_area(&corners(triangle)));
    assert!((areas.sum::<f64>() - 80.0).abs() < 1e-9, "{:?}", mesh.vertices);
}

const SQUARE: &str = "[[0.0,0.0],[10.0,0.0],[10.0,10.0],[0.0,10.0],[0.0,0.0]]";

#[test]
fn nothing_is_asked_of_the_properties_of_other_geojson() {
    let properties = r#"{"building": "yes", "height": 12.5, "visible_range": "far", "heading": "N",
        "center": "Rome", "radius": "wide", "part": 3}"#;
    let square = r#"{"type": "Polygon", "coordinates": [[[0,0],[4,0],[4,3],[0,0]]]}"#;
    let point = r#"{"type": "Point", "coordinates": [9,9]}"#;
    let feature = |geometry: &str| {
        format!(r#"{{"type": "Feature", "properties": {properties}, "geometry": {geometry}}}"#)
    };
    let text = format!(
        r#"{{"type": "FeatureCollection", "features": [{}, {}]}}"#,
        feature(square),
        feature(point)
    );
    let world = read_geojson(&mut text.as_bytes()).unwrap();
    assert_eq!((world.obstacles.len(), world.walls.len()), (1, 0));
    for radius in ["0", "-1", "6371000000", "1e300"] {
        let text = text.replace("\"wide\"", radius);
        let world = read_geojson(&mut text.as_bytes()).unwrap();
        assert_eq!(world.obstacles.len(), 1, "{radius}");
    }
    // A mark at the beginning of the text, as some editors write it.
    assert!(read_geojson(&mut format!("\u{feff}{text}").as_bytes()).is_ok());
}

#[test]
fn a_start_that_is_looked_for_is_within_the_bounds() {
    let feature = |geometry: &str, properties: &str| {
        format!(r#"{{"type": "Feature", "properties": {properties}, "geometry": {geometry}}}"#)
    };
    let post = |x: f64| {
        let point = format!(r#"{{"type": "Point", "coordinates": [{x}, 0]}}"#);
        feature(&point, r#"{"radius": 0.01}"#)
    };
    let lines = r#"{"type": "MultiLineString",
        "coordinates": [[[0,0],[90000,0.05]],[[110000,0],[200000,0.05]]]}"#;
    for features in [format!("{}, {}", post(0.0), post(5.0)), feature(lines, "{}")] {
        let text = format!(r#"{{"type": "FeatureCollection", "features": [{features}]}}"#);
        let world = read_geojson(&mut text.as_bytes()).expect("a world");
        assert_eq!(world.check(), Ok(()));
    }
}

#[test]
fn geojson_of_others_has_parts_in_metres() {
    let error = |text: &str| read_geojson(&mut text.as_bytes()).unwrap_err().to_string();
    let nothing = r#"{"type": "FeatureCollection", "features": [], "bbox": [0, 0, 9, 9]}"#;
    assert!(error(nothing).starts_with("`features` must be one or more"), "{}", error(nothing));
    let degrees = "[[[8.5, 47.3], [8.5003, 47.3], [8.5003, 47.3002], [8.5, 47.3]]]";
    let degrees = error(&format!(r#"{{"type": "Polygon", "coordinates": {degrees}}}"#));
    assert!(degrees.contains("got all within 0.000300 m: project longitudes"), "{degrees}");
    // An empty world of our own is one.
    let empty = World::new(Provenance::other("test", serde_json::Value::Null), small().bounds);
    assert!(read_geojson(&mut written(&empty, "empty.geojson").as_bytes()).is_ok());
}

#[test]
fn what_is_wrong_with_geojson_is_named() {
    let text = written(&small(), "a.geojson");
    for (from, to, what) in [
        ("\"features\":[", "\"features\":[7,", "not GeoJSON"),
        (
            "[3.75,1.0]",
            "[3.75]",
            "`features[5].geometry` must be two finite coordinates, got [3.75]",
        ),
        (
            "\"heading\":0.5",
            "\"heading\":\"north\"",
            "`features[0].properties.heading` must be a number",
        ),
        ("\"open\":false", "\"open\":7", "properties.open` must be true or false, got 7"),
        ("\"kind\":\"crate\"", "\"kind\":\"lake\"", "properties.kind` must be a kind of obstacle"),
        (
            "\"rooms\":[null,null]",
            "\"rooms\":[9,null]",
            "`doorways[0].rooms` must be numbers of the 0 rooms",
        ),
        ("[2.0,2.5]", "[2.0,2e9]", "must be from -1e8 to 1e8 m"),
        ("[1.0,1.0]", "[0.1,0.1]", "the start pose lies inside wall 0"),
        (
            "[2.0,2.5]",
            "[2.25,2.0]",
            "`features[9].geometry` must be a polygon whose sides neither cross nor touch each other",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let error = read_geojson(&mut text.replacen(from, to, 1).as_bytes()).unwrap_err();
        assert!(error.to_string().contains(what), "{to}: {error}");
    }
    let short = r#"{"type": "Polygon", "coordinates": [[[0,0],[1,0],[0,0]]]}"#;
    let error = read_geojson(&mut short.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("must be three different corners or more, got 2"), "{error}");
    assert!(read_geojson(&mut "{}".as_bytes()).is_err());
    let bbox = r#"{"type": "FeatureCollection", "bbox": [1], "features": []}"#;
    let error = read_geojson(&mut bbox.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("`bbox` must be 4 or 6 numbers"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn shapes_come_back_from_geojson(
        discs in prop::collection::vec((0.0..20.0_f64, 0.0..20.0_f64, 0.01..3.0_f64), 1..12),
        boxes in prop::collection::vec(
            (0.0..20.0_f64, 0.0..20.0_f64, 0.01..3.0_f64, 0.01..3.0_f64, -3.0..3.0_f64), 0..12,
        ),
    ) {
        let bounds = Rect::new(DVec2::splat(-10.0), DVec2::splat(30.0));
        let mut world = World::new(Provenance::other("manual", Value::Null), bounds);
        for (x, y, radius) in discs {
            world.trees.push(Tree::new(DVec2::new(x, y), radius));
        }
        for (x, y, width, height, heading) in boxes {
            let half_size = DVec2::new(width, height);
            let shape = Shape::Box { center: DVec2::new(x, y), half_size, heading };
            world.obstacles.push(Obstacle::new(ObstacleKind::Desk, shape));
        }
        world.goal = Some(Pose::new(-5.0, -5.0, 1.0));
        assert_read_back_as_geojson(&world);
    }
}

#[test]
fn houses_hold_the_outline_of_free_ground() {
    let world = small();
    let text = written(&world, "small.house.json");
    let house: Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&house["id"], &house["room_num"]), (&"small".into(), &0.into()));
    // The crate and the pillar are inside and are lost: the four corners of the room remain.
    assert_eq!(house["verts"].as_array().unwrap().len(), 4, "{}", house["verts"]);
    assert_eq!(house["start"], serde_json::json!([1.0, 1.0, 0.5]));
    let read = read_houseexpo(&mut text.as_bytes()).unwrap();
    assert_eq!((read.start, read.goal), (world.start, world.goal));
    assert_eq!(read.walls.len(), 4);
}

#[test]
fn the_id_of_a_house_is_the_name_of_its_file() {
    let world = small();
    for (name, id) in [("b/0004d5.house.json", "0004d5"), ("A.b.HOUSE.json", "A.b")] {
        let path = Path::new(name);
        let mut file = Vec::new();
        Format::from_path(path).unwrap().write(&Job::for_path(&world, path), &mut file).unwrap();
        let house: Value = serde_json::from_slice(&file).unwrap();
        assert_eq!(house["id"], id);
    }
}

/// Whether a polygon's border is crossed an odd number of times on the right of a point.
fn is_inside(verts: &[DVec2], p: DVec2) -> bool {
    let sides = verts.iter().zip(verts.iter().cycle().skip(1));
    let crossed = sides.filter(|(a, b)| {
        let is_between = (a.y > p.y) != (b.y > p.y);
        is_between && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
    });
    crossed.count() % 2 == 1
}

#[test]
fn free_ground_comes_back_from_houses() {
    for seed in 0..4 {
        let world = WorldKind::Hallway.default_spec().generate(Seed(seed)).unwrap().to_world();
        let text = written(&world, "a.house.json");
        assert_eq!(text, written(&world, "a.house.json"));
        let read = reader(Path::new("b.JSON")).unwrap()(&mut text.as_bytes(), Path::new("b.JSON"))
            .unwrap();
        // Inside, walls are as far as before up to the diagonal of a cell and the cell that the border takes.
        let house: Value = serde_json::from_str(&text).unwrap();
        let verts: Vec<DVec2> = serde_json::from_value(house["verts"].clone()).unwrap();
        let mut inside = 0;
        for p in points(&world) {
            let (before, after) = (world.clearance(p), read.clearance(p));
            if before > 0.3 && is_inside(&verts, p) {
                inside += 1;
                assert!(after <= before + 1e-9 && after > before - 0.13, "{p}: {before} {after}");
            }
        }
        assert!(inside > 20, "{inside}");
    }
}

#[test]
fn outlines_of_houses_keep_their_size() {
    // Along the cells, between them, and oblique.
    let house = r#"{"verts": [[0, 0], [6, 0], [6, 4.02], [3, 4.02], [1, 2], [0, 2]]}"#;
    let first = read_houseexpo(&mut house.as_bytes()).unwrap();
    let mut text = written(&first, "a.house.json");
    let verts_of = |text: &str| -> Vec<DVec2> {
        let house: Value = serde_json::from_str(text).unwrap();
        serde_json::from_value(house["verts"].clone()).unwrap()
    };
    let half_diagonal = 0.5_f64.sqrt() * 0.05 + 1e-9;
    assert!(verts_of(&text).iter().all(|p| first.clearance(*p) <= half_diagonal), "{text}");
    for _ in 0..5 {
        let again = written(&read_houseexpo(&mut text.as_bytes()).unwrap(), "a.house.json");
        let (before, after) = (verts_of(&text), verts_of(&again));
        assert_eq!(before.len(), after.len());
        assert!(before.iter().zip(&after).all(|(a, b)| a.distance(*b) < 1e-9), "{again}");
        text = again;
    }
}

#[test]
fn lines_with_ground_on_both_sides_stay_in_outlines_of_houses() {
    // Between cells, and inside of them.
    for x in [3.0, 3.02] {
        let verts = [[0., 0.], [x, 0.], [x, 4.], [x, 0.], [6., 0.], [6., 6.], [0., 6.]];
        let house = serde_json::json!({ "verts": verts }).to_string();
        let text = written(&read_houseexpo(&mut house.as_bytes()).unwrap(), "a.house.json");
        let again = read_houseexpo(&mut text.as_bytes()).unwrap();
        for y in [0.5, 2.0, 3.8] {
            let clearance = again.clearance(DVec2::new(x, y));
            assert!(clearance <= 0.05 + 1e-9, "{clearance} m from the wall at {x}: {text}");
        }
    }
}

#[test]
fn houses_whose_goal_is_outside_of_the_outline_come_back() {
    // The ground of the start ends at x = 2 m.
    let mut world = small();
    world.walls.push(Wall::new(
        WallKind::Wall,
        Shape::from_rect(Rect::new(DVec2::new(2.0, 0.0), DVec2::new(2.25, 3.0))),
    ));
    let house = written(&world, "small.house.json");
    let read = read_houseexpo(&mut house.as_bytes()).expect("a house");
    assert_eq!((read.start, read.goal), (world.start, world.goal));
    assert!(read.walls.iter().all(|wall| wall.shape.bounds().max.x < 2.1));
}

#[test]
fn houses_of_wide_cells_are_those_of_the_start() {
    // Two rooms; in the smaller one the start is near a wall.
    let bounds = Rect::new(DVec2::ZERO, DVec2::new(10.0, 8.0));
    let mut world = World::new(Provenance::other("manual", "rooms".into()), bounds);
    for [x0, y0, x1, y1] in [[0.5, 0.5, 2.5, 2.5], [3.0, 0.5, 9.5, 7.5]] {
        let corners = Shape::from_rect(Rect::new(DVec2::new(x0, y0), DVec2::new(x1, y1))).corners();
        let sides = envgen::geometry::edges(&corners);
        world.walls.extend(sides.map(|(a, b)| Wall::new(WallKind::Wall, Shape::Segment { a, b })));
    }
    world.start = Some(Pose::new(0.7, 1.5, 0.0));
    let format = Format::from_path(Path::new("rooms.house.json")).unwrap();
    let mut file = Vec::new();
    format.write(&Job { resolution: Some(0.3), ..Job::new(&world) }, &mut file).unwrap();
    let house: Value = serde_json::from_slice(&file).unwrap();
    let widest = house["bbox"]["max"][0].as_f64().unwrap();
    assert!(widest < 3.0, "{widest}");
    assert!(read_houseexpo(&mut &file[..]).is_ok());
}

#[test]
fn houses_of_the_data_set_are_read() {
    let house = r#"{"id": "0042", "room_num": 2, "bbox": {"min": [0, 0], "max": [6, 4]},
        "verts": [[0, 0], [6, 0], [6, 4], [3, 4], [3, 2], [0, 2], [0, 0]],
        "room_category": {"Bedroom": [[0, 0, 3, 2]], "Kitchen": [[3, 0, 6, 4], [3.5, 0, 6, 1]]}}"#;
    let world = read_houseexpo(&mut house.as_bytes()).unwrap();
    assert_eq!(world.walls.len(), 6);
    let names: Vec<_> = world.rooms.iter().map(|room| room.name.as_str()).collect();
    assert_eq!(names, ["Bedroom", "Kitchen", "Kitchen"]);
    assert_eq!(world.bounds, Rect::new(DVec2::splat(-0.5), DVec2::new(6.5, 4.5)));
    // The widest place is in the square of the kitchen's lower part.
    let start = world.start.unwrap().position;
    assert!(world.clearance(start) > 1.4 && start.x > 3.0, "{start}");
    for (from, to, what) in [
        ("[3, 4], ", "[3, 1e300], ", "`verts[3]` must be numbers from -1e8 to 1e8"),
        ("[3, 4], ", "[3], ", "not the JSON of a house of HouseExpo"),
        ("[[0, 0, 3, 2]]", "[[0, 0, 0, 2]]", "`room_category.Bedroom[0]` must be x1 < x2"),
        ("\"verts\"", "\"vert\"", "missing field `verts`"),
    ] {
        let error =
            read_houseexpo(&mut house.replace(from, to).as_bytes()).unwrap_err().to_string();
        assert!(error.contains(what), "{to}: {error}");
    }
    let two = r#"{"verts": [[0, 0], [1, 1]]}"#;
    let error = read_houseexpo(&mut two.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("`verts` must be from 3 to 262144 corners, got 2"), "{error}");
}

#[test]
fn what_is_solid_comes_back_from_tables() {
    for world in [small(), common::forest(60, 12.0), common::everything()] {
        let text = written(&world, "a.obstacles.csv");
        let mut lines = text.lines();
        assert_eq!(
            lines.next(),
            Some("part,index,kind,shape,x,y,heading,length,width,radius,points,bottom,top")
        );
        let mut read = World::new(Provenance::other("manual", Value::Null), world.bounds);
        for line in lines {
            let fields: Vec<&str> = line.split(',').collect();
            let number = |i: usize| fields[i].parse::<f64>().unwrap();
            let at = || DVec2::new(number(4), number(5));
            let points = || -> Vec<DVec2> {
                let pair = |point: &str| {
                    let (x, y) = point.split_once(' ').unwrap();
                    DVec2::new(x.parse().unwrap(), y.parse().unwrap())
                };
                fields[10].split(';').map(pair).collect()
            };
            let shape = match fields[3] {
                "pose" => {
                    let pose = Pose { position: at(), heading: number(6) };
                    match fields[0] {
                        "start" => read.start = Some(pose),
                        "goal" => read.goal = Some(pose),
                        _ => {
                            assert_eq!(fields[..2], ["victim", &read.victims.len().to_string()]);
                            read.victims.push(pose);
                        }
                    }
                    continue;
                }
                "disc" => Shape::Disc { center: at(), radius: number(9) },
                "box" => {
                    let half_size = 0.5 * DVec2::new(number(7), number(8));
                    Shape::Box { center: at(), half_size, heading: number(6) }
                }
                "segment" => Shape::Segment { a: points()[0], b: points()[1] },
                _ => Shape::Polygon { vertices: points() },
            };
            let height = Extent::new(number(11), number(12)).ok();
            let obstacle = Obstacle::new(ObstacleKind::Other, shape);
            read.obstacles.push(Obstacle { height, ..obstacle });
        }
        let heights = |world: &World| -> Vec<_> {
            world.solids().map(|solid| world.extent(solid.id)).collect()
        };
        assert_eq!(heights(&read), heights(&world));
        assert_eq!((read.start, read.goal), (world.start, world.goal));
        assert_eq!(read.victims, world.victims);
        assert_eq!(read.obstacles.len(), world.solids().count());
        assert_same_free_space(&world, &read, 1e-12);
    }
    let empty =
        World::new(Provenance::other("manual", Value::Null), Rect::new(DVec2::ZERO, DVec2::ONE));
    assert_eq!(written(&empty, "a.obstacles.csv").lines().count(), 1);
}
