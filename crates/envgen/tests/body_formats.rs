//! SDFormat, MJCF and glTF files, read back by readers of their own.

#[path = "common/samples.rs"]
mod samples;

use std::collections::BTreeMap;

use envgen::World;
use envgen::export::{Format, Job};
use envgen::geometry::Shape;
use envgen::glam::DVec2;
use envgen::pieces::{Form, pieces};
use envgen::world::{Extent, Wall, WallKind};
use quick_xml::Reader;
use quick_xml::events::Event;
use samples::{place_names, with_polygon, worlds, write};
use serde_json::Value;

/// The elements of a document: name, attributes, and the text in it.
fn elements(file: &[u8]) -> Vec<(String, BTreeMap<String, String>, String)> {
    let mut reader = Reader::from_str(std::str::from_utf8(file).unwrap());
    let mut found: Vec<(String, BTreeMap<String, String>, String)> = Vec::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Eof => return found,
            Event::Start(element) | Event::Empty(element) => {
                let attributes = element.attributes().map(|attribute| {
                    let attribute = attribute.unwrap();
                    (attribute.key.as_ref().to_owned(), attribute.value.into_owned())
                });
                let attributes = attributes.collect();
                found.push((element.name().as_ref().to_owned(), attributes, String::new()));
            }
            Event::Text(content) => {
                if let Some((_, _, text)) = found.last_mut() {
                    text.push_str(content.trim());
                }
            }
            _ => {}
        }
    }
}

fn named(elements: &[(String, BTreeMap<String, String>, String)], name: &str) -> Vec<String> {
    let named = elements.iter().filter(|(element, ..)| element == name);
    named.filter_map(|(_, attributes, _)| attributes.get("name").cloned()).collect()
}

/// The header, the JSON and the buffer of a GLB file.
fn chunks(file: &[u8]) -> (Value, &[u8]) {
    let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&file[..4], word(4), word(8)), (&b"glTF"[..], 2, file.len()));
    let json = word(12);
    assert_eq!((&file[16..20], json % 4), (&b"JSON"[..], 0));
    let buffer = 28 + json;
    assert_eq!((&file[24 + json..buffer], word(20 + json)), (&b"BIN\0"[..], file.len() - buffer));
    (serde_json::from_slice(&file[20..20 + json]).unwrap(), &file[buffer..])
}

#[test]
fn files_are_the_same_to_the_byte() {
    for (first, second) in worlds().iter().zip(&worlds()) {
        for ending in ["sdf", "mjcf.xml", "glb"] {
            assert_eq!(write(first, ending), write(second, ending), "{ending}");
        }
    }
}

#[test]
fn every_piece_is_in_every_file() {
    for world in worlds() {
        let all = pieces(&world);
        let is_road = |form: &Form<'_>| matches!(form, Form::Road { .. });
        let but_roads = all.iter().filter(|piece| !is_road(&piece.form));
        let names: Vec<String> = but_roads.map(ToString::to_string).collect();

        let sdf = elements(&write(&world, "sdf"));
        assert_eq!(named(&sdf, "link")[1..], names);
        assert_eq!(named(&sdf, "frame"), place_names(&world));

        let mjcf = elements(&write(&world, "mjcf.xml"));
        let mut geoms = named(&mjcf, "geom");
        geoms.retain(|name| name != "floor" && !name.contains('.'));
        assert_eq!(geoms, names);
        assert_eq!(named(&mjcf, "site"), place_names(&world));

        let file = write(&world, "glb");
        let (json, buffer) = chunks(&file);
        let nodes = json["nodes"].as_array().unwrap();
        let found: Vec<&str> = nodes.iter().map(|node| node["name"].as_str().unwrap()).collect();
        let mut names: Vec<String> = all.iter().map(ToString::to_string).collect();
        names.extend(place_names(&world));
        names.push("world".to_owned());
        assert_eq!(found, names);
        assert_eq!(json["buffers"][0]["byteLength"], buffer.len());
        let provenance = serde_json::to_value(&world.provenance).unwrap();
        assert_eq!(json["asset"]["extras"]["provenance"], provenance);
        for (node, piece) in nodes.iter().zip(&all) {
            assert_eq!(node["extras"]["kind"], piece.kind);
            assert_eq!(node["extras"]["solid"], piece.is_solid);
        }
    }
}

#[test]
fn cameras_in_mujoco_see_what_is_near_in_worlds_of_any_size() {
    let number = |world: &World, element: &str, name: &str| -> f64 {
        let file = elements(&write(world, "mjcf.xml"));
        let of = file.iter().find(|(found, ..)| found == element).expect(element);
        of.1[name].parse().unwrap()
    };
    for world in worlds() {
        let extent = number(&world, "statistic", "extent");
        let size = world.bounds.size();
        assert!(extent >= 0.5 * size.max_element(), "{extent} m of {size}");
        assert!((number(&world, "map", "znear") * extent - 0.01).abs() < 1e-12);
        assert!(number(&world, "map", "zfar") * extent > 2.0 * size.length());
    }
    // What is higher than the world is wide counts.
    let mut world = with_polygon(&[(1., 1.), (5., 1.), (5., 2.)]);
    world.obstacles[0].height = Some(Extent::new(-2.0, 40.0).unwrap());
    assert_eq!(number(&world, "statistic", "extent"), 21.0);
    let file = elements(&write(&world, "mjcf.xml"));
    let statistic = file.iter().find(|(found, ..)| found == "statistic").unwrap();
    assert_eq!(statistic.1["center"], "5 5 19");
}

#[test]
fn outlines_that_are_not_convex_are_several_meshes_for_mujoco() {
    let world = with_polygon(&[(1., 1.), (5., 1.), (5., 2.), (2., 2.), (2., 5.), (1., 5.)]);
    let mjcf = elements(&write(&world, "mjcf.xml"));
    assert_eq!(named(&mjcf, "mesh"), ["obstacle_0", "obstacle_0.1"]);
    let sdf = elements(&write(&world, "sdf"));
    let points: Vec<&str> =
        sdf.iter().filter(|(name, ..)| name == "point").map(|(.., text)| text.as_str()).collect();
    // The corners of the collision and those of the visual, relative to the middle.
    assert_eq!((points.len(), points[0]), (12, "-2 -2"));
    let poses: Vec<&str> =
        sdf.iter().filter(|(name, ..)| name == "pose").map(|(.., text)| text.as_str()).collect();
    assert_eq!(poses.last(), Some(&"3 3 0.5 0 0 0"));
}

#[test]
fn pieces_too_thin_for_meshes_are_boxes_for_mujoco() {
    // A square of 9 m with a hair on it.
    let hair = |width| {
        let corners =
            [(0., 0.), (9., 0.), (9., 9.), (5. + width, 9.), (5., 12.), (5., 9.), (0., 9.)];
        let mjcf = elements(&write(&with_polygon(&corners), "mjcf.xml"));
        // The floor and the area are geoms as well.
        let bodies = named(&mjcf, "geom").into_iter().filter(|name| name.starts_with("obstacle"));
        (named(&mjcf, "mesh").len(), bodies.count())
    };
    assert_eq!((hair(1e-4), hair(1e-6), hair(1e-9)), ((2, 2), (1, 2), (1, 1)));
    // A kerb of 15 cm along 1000 km, at an angle.
    let (along, across) = (1e6 * DVec2::new(0.6, 0.8), 0.15 * DVec2::new(-0.8, 0.6));
    let corners = [DVec2::ZERO, along, along + across, across].map(|p| (p + DVec2::ONE).into());
    let mut world = with_polygon(&corners);
    world.bounds.max = DVec2::splat(1e6);
    let mjcf = elements(&write(&world, "mjcf.xml"));
    let (_, kerb, _) = mjcf
        .iter()
        .find(|(_, attributes, _)| attributes.get("name").is_some_and(|name| name == "obstacle_0"))
        .expect("the kerb");
    let numbers = |name: &str| -> Vec<f64> {
        kerb[name].split(' ').map(|number| number.parse().unwrap()).collect()
    };
    let middle = DVec2::ONE + 0.5 * (along + across);
    let [x, y, z] = numbers("pos")[..] else { panic!("a position") };
    assert!(DVec2::new(x, y).distance(middle) < 1e-6 && z == 1.25, "{x} {y} {z}");
    let expected = [5e5, 0.075, 0.75];
    let sizes = numbers("size");
    assert!(sizes.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{sizes:?}");
    assert!((numbers("euler")[2] - libm::atan2(0.8, 0.6)).abs() < 1e-9);
}

#[test]
fn meshes_of_distant_worlds_are_in_their_place() {
    // Single precision has no whole number between 30,000,004 and 30,000,006.
    let world = with_polygon(&[
        (20_000_001., 30_000_004.),
        (20_000_005., 30_000_004.),
        (20_000_005., 30_000_006.),
    ]);
    let file = write(&world, "glb");
    let (json, _) = chunks(&file);
    let nodes = json["nodes"].as_array().unwrap();
    let place = |name: &str| -> Vec<f64> {
        let node = nodes.iter().find(|node| node["name"] == name).unwrap();
        serde_json::from_value(node["translation"].clone()).unwrap()
    };
    let (top, obstacle) = (place("world"), place("obstacle_0"));
    assert_eq!([top[0] + obstacle[0], -top[2] - obstacle[2]], [20_000_003.0, 30_000_005.0]);
}

#[test]
fn worlds_without_start_and_with_wrong_outlines() {
    let world = with_polygon(&[(1., 1.), (5., 5.), (5., 1.), (1., 5.)]);
    assert!(named(&elements(&write(&world, "sdf")), "frame").is_empty());
    for ending in ["glb", "mjcf.xml"] {
        let format = Format::from_path(format!("world.{ending}").as_ref()).unwrap();
        let error = format.write(&Job::new(&world), &mut Vec::new()).unwrap_err().to_string();
        assert!(error.starts_with("obstacle_0 has no mesh"), "{error}");
    }
}

#[test]
fn lines_have_a_length_however_short_they_are() {
    let mut world = with_polygon(&[(1., 1.), (5., 1.), (5., 2.)]);
    let shape = Shape::Segment { a: DVec2::ZERO, b: DVec2::new(1e-170, 0.0) };
    world.walls.push(Wall::new(WallKind::Wall, shape));
    assert_eq!(world.check(), Ok(()));
    let mjcf = elements(&write(&world, "mjcf.xml"));
    let wall = mjcf
        .iter()
        .find(|(_, attributes, _)| attributes.get("name").is_some_and(|n| n == "wall_0"));
    let length: f64 = wall.unwrap().1["size"].split(' ').next().unwrap().parse().unwrap();
    // Half a side.
    assert!((length - 5e-31).abs() < 1e-40, "{length}");
}

#[test]
fn siblings_in_sdf_have_different_names() {
    for world in worlds() {
        let sdf = elements(&write(&world, "sdf"));
        let collisions = named(&sdf, "collision");
        let visuals = named(&sdf, "visual");
        assert!(collisions.iter().all(|name| !visuals.contains(name)), "{collisions:?}");
    }
}
