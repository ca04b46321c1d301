//! OpenDRIVE and CSV files of roads, read back by readers of their own.

use std::collections::BTreeMap;

use envgen::export::{ExportError, Format, Job};
use envgen::forest::ForestSpec;
use envgen::glam::DVec2;
use envgen::road::{Lengths, Prefab, Road, RoadSpec};
use envgen::{Blueprint, Seed, Spec, World};
use quick_xml::Reader;
use quick_xml::events::Event;

/// A `geometry` of a `planView`, with its one child.
#[derive(Debug)]
struct Geometry {
    s: f64,
    x: f64,
    y: f64,
    hdg: f64,
    length: f64,
    start_curvature: f64,
    end_curvature: f64,
}

impl Geometry {
    /// The end by Simpson's rule with Richardson's extrapolation over ever finer halves: a method
    /// that shares nothing with the writer's series.
    fn end(&self) -> (DVec2, f64) {
        let (k, l) = (self.start_curvature, self.length);
        let c = (self.end_curvature - k) / l;
        let heading = |t: f64| self.hdg + t * (k + 0.5 * c * t);
        let at = |t: f64| DVec2::new(libm::cos(heading(t)), libm::sin(heading(t)));
        if k == 0.0 && c == 0.0 {
            return (DVec2::new(self.x, self.y) + at(0.0) * l, self.hdg);
        }
        // Romberg: trapezoids of 1, 2, 4, ... parts, whose error is a series in h^2.
        let mut row = vec![(at(0.0) + at(l)) * (0.5 * l)];
        for level in 1..=10_u32 {
            let parts = 1_u32 << level;
            let h = l / f64::from(parts);
            let middles: DVec2 = (0..parts / 2).map(|i| at(f64::from(2 * i + 1) * h)).sum();
            let mut next = vec![row[0] * 0.5 + middles * h];
            let mut factor = 1.0;
            for j in 0..row.len() {
                factor *= 4.0;
                let better = next[j] + (next[j] - row[j]) / (factor - 1.0);
                next.push(better);
            }
            row = next;
        }
        (DVec2::new(self.x, self.y) + row[row.len() - 1], heading(l))
    }
}

#[derive(Debug, Default)]
struct ReadRoad {
    attributes: BTreeMap<String, String>,
    geometry: Vec<Geometry>,
    /// Signed number and constant width of each lane.
    lanes: Vec<(i64, f64)>,
    offset: f64,
    linked: bool,
}

fn read(xml: &[u8]) -> Vec<ReadRoad> {
    let mut reader = Reader::from_reader(xml);
    let mut roads: Vec<ReadRoad> = Vec::new();
    let mut open: Vec<String> = Vec::new();
    loop {
        let (element, empty) = match reader.read_event().unwrap() {
            Event::Start(element) => (element, false),
            Event::Empty(element) => (element, true),
            Event::End(element) => {
                assert_eq!(open.pop().as_deref(), Some(element.name().as_ref()));
                continue;
            }
            Event::Eof => break,
            _ => continue,
        };
        let name = element.name().as_ref().to_owned();
        let attributes: BTreeMap<String, String> = element
            .attributes()
            .map(|attribute| {
                let attribute = attribute.unwrap();
                (attribute.key.as_ref().to_owned(), attribute.value.into_owned())
            })
            .collect();
        let number = |name: &str| attributes[name].parse::<f64>().unwrap();
        let inside = open.last().map_or("", String::as_str).to_owned();
        match (inside.as_str(), name.as_str()) {
            ("OpenDRIVE", "header") => {
                assert_eq!((number("revMajor"), number("revMinor")), (1.0, 7.0));
            }
            ("OpenDRIVE", "road") => {
                roads.push(ReadRoad { attributes: attributes.clone(), ..Default::default() });
            }
            _ => {}
        }
        if let Some(road) = roads.last_mut() {
            match (inside.as_str(), name.as_str()) {
                ("planView", "geometry") => road.geometry.push(Geometry {
                    s: number("s"),
                    x: number("x"),
                    y: number("y"),
                    hdg: number("hdg"),
                    length: number("length"),
                    start_curvature: f64::NAN,
                    end_curvature: f64::NAN,
                }),
                ("geometry", shape) => {
                    let (start, end) = match shape {
                        "line" => (0.0, 0.0),
                        "arc" => (number("curvature"), number("curvature")),
                        "spiral" => (number("curvStart"), number("curvEnd")),
                        other => panic!("{other}"),
                    };
                    let geometry = road.geometry.last_mut().unwrap();
                    (geometry.start_curvature, geometry.end_curvature) = (start, end);
                }
                ("left" | "center" | "right", "lane") => {
                    road.lanes.push((attributes["id"].parse().unwrap(), 0.0));
                }
                ("lane", "width") => road.lanes.last_mut().unwrap().1 = number("a"),
                ("lanes", "laneOffset") => road.offset = number("a"),
                ("road", "link") => road.linked = true,
                _ => {}
            }
        }
        if !empty {
            open.push(name);
        }
    }
    assert!(open.is_empty());
    roads
}

fn write(format: Format, world: &World) -> Vec<u8> {
    let mut bytes = Vec::new();
    format.write(&Job::new(world), &mut bytes).unwrap();
    bytes
}

/// Checks a road's file, with a reader that integrates the plan view by a second method.
fn check(road: &Road) {
    let spec = road.spec();
    let read = read(&write(Format::OpenDrive, &road.to_world()));
    let [read] = read.as_slice() else { panic!("{} roads", read.len()) };
    let mut s = 0.0;
    let mut joint: Option<(DVec2, f64)> = None;
    for geometry in &read.geometry {
        assert_eq!(geometry.s, s);
        assert!(geometry.length > 0.0);
        s += geometry.length;
        if let Some((p, heading)) = joint {
            let gap = p.distance(DVec2::new(geometry.x, geometry.y));
            assert!(gap < 1e-9, "a gap of {gap} m");
            assert!((heading - geometry.hdg).abs() < 1e-9);
        }
        joint = Some(geometry.end());
    }
    assert_eq!(read.attributes["length"].parse::<f64>().unwrap(), s);
    // Lengths are rounded such that their sum is exact, in whatever order it is taken.
    assert_eq!(s, road.length());
    assert_eq!(read.geometry.iter().rev().map(|geometry| geometry.length).sum::<f64>(), s);
    let (p, heading) = joint.unwrap();
    assert!(p.distance(road.end().position) < 1e-9, "{p} {:?}", road.end());
    assert!((heading - road.end().heading).abs() < 1e-9);
    // Lanes lie as wide as the strip, left to right, with its middle in their middle.
    let ids: Vec<i64> = read.lanes.iter().map(|lane| lane.0).collect();
    assert!(ids.windows(2).all(|pair| pair[0] == pair[1] + 1) && ids.contains(&0));
    assert_eq!(ids.len() as u64, spec.lanes + 1);
    let width = |side: i64| -> f64 {
        read.lanes.iter().filter(|lane| lane.0.signum() == side).map(|lane| lane.1).sum()
    };
    assert!((read.offset + width(1) - 0.5 * spec.width).abs() < 1e-12);
    assert!((read.offset - width(-1) + 0.5 * spec.width).abs() < 1e-12);
    assert_eq!(read.linked, spec.closed);
}

#[test]
fn a_second_reader_lands_on_the_end_of_a_thousand_roads() {
    for seed in 0..1000 {
        let transition = if seed % 2 == 0 { 0.0 } else { 0.05 * (seed % 20 / 2 + 1) as f64 };
        let spec = RoadSpec {
            length: 1500.0 + (seed * 37 % 4000) as f64,
            segment_count: 1 + seed % 30,
            speed: (seed % 15) as f64,
            lanes: 1 + seed % 5,
            start_x: (seed % 7) as f64 * 1000.0 - 3000.0,
            start_heading: (seed % 8) as f64 * 45.0,
            step: 10.0,
            kerb: 0.0,
            transition,
            ..Default::default()
        };
        check(&spec.generate(Seed(seed)).unwrap());
    }
}

#[test]
fn circuits_and_the_longest_road_are_exact_too() {
    use Prefab::{Left, Right, Straight};
    for seed in 0..20 {
        let spec = RoadSpec {
            prefabs: vec![Straight, Left, Left, Straight, Left, Right, Left, Straight, Left],
            closed: true,
            speed: 10.0,
            transition: 0.3,
            ..Default::default()
        };
        check(&spec.generate(Seed(seed)).unwrap());
    }
    for transition in [0.0, 0.5] {
        let longest = RoadSpec {
            length: 1e6,
            segment_count: 4096,
            step: 100.0,
            kerb: 0.0,
            transition,
            ..Default::default()
        };
        check(&longest.generate(Seed(1)).unwrap());
        let few = RoadSpec { segment_count: 3, ..longest };
        check(&few.generate(Seed(1)).unwrap());
    }
}

#[test]
fn equal_neighbours_are_one_geometry() {
    use Prefab::{Left, Straight};
    let spec = RoadSpec { prefabs: vec![Straight, Straight, Left, Straight], ..Default::default() };
    let road = spec.generate(Seed(1)).unwrap();
    assert_eq!(road.segments().len(), 4);
    assert_eq!(read(&write(Format::OpenDrive, &road.to_world()))[0].geometry.len(), 3);
    check(&road);
}

#[test]
fn turns_of_clothoids_alone_have_no_arc() {
    let spec =
        RoadSpec { transition: 0.5, length: 6000.0, segment_count: 40, ..Default::default() };
    let road = spec.generate(Seed(11)).unwrap();
    check(&road);
    let file = &read(&write(Format::OpenDrive, &road.to_world()))[0];
    assert!(file.geometry.len() > 40);
    for geometry in &file.geometry {
        assert!(geometry.length > 1e-6, "{geometry:?}");
    }
}

#[test]
fn csv_holds_every_waypoint_with_its_distance() {
    for (transition, random) in [(0.0, 5), (0.25, 12)] {
        let spec = RoadSpec { transition, segment_count: random, step: 2.0, ..Default::default() };
        let road = spec.generate(Seed(3)).unwrap();
        let world = road.to_world();
        let mut reader = csv::Reader::from_reader(std::io::Cursor::new(write(Format::Csv, &world)));
        assert_eq!(reader.headers().unwrap(), vec!["road", "s", "x", "y", "heading", "curvature"]);
        let rows: Vec<(usize, f64, f64, f64, f64, f64)> =
            reader.deserialize().collect::<Result<_, _>>().unwrap();
        assert_eq!(rows.len(), 501);
        let points = &world.road_strips[0].centreline;
        for (j, (row, point)) in rows.iter().zip(points).enumerate() {
            let (number, s, x, y, heading, curvature) = *row;
            assert_eq!((number, DVec2::new(x, y)), (0, point.pose.position));
            assert_eq!((heading, curvature), (point.pose.heading, point.curvature));
            assert!((s - 2.0 * j as f64).abs() < 1e-9, "{s}");
        }
    }
}

/// The distances in the CSV of a road.
fn distances(spec: &RoadSpec, seed: u64) -> (Road, Vec<f64>) {
    let road = spec.generate(Seed(seed)).unwrap();
    let file = write(Format::Csv, &road.to_world());
    let mut reader = csv::Reader::from_reader(std::io::Cursor::new(file));
    let rows = reader.deserialize().map(|row| row.map(|row: [f64; 6]| row[1]));
    (road, rows.collect::<Result<_, _>>().unwrap())
}

#[test]
fn csv_has_the_distance_also_where_a_step_covers_most_of_a_turn() {
    use Prefab::{Left, Right, Straight};
    let coarse = |length, step, prefabs| RoadSpec {
        length,
        step,
        prefabs,
        speed: 0.0,
        width: 2.0,
        ..Default::default()
    };
    let wide = RoadSpec {
        theta_min: 200.0,
        theta_max: 340.0,
        ..coarse(300.0, 30.0, vec![Left, Straight, Right, Straight])
    };
    let lefts = coarse(100.0, 20.0, vec![Left; 8]);
    let half = RoadSpec {
        theta_min: 180.0,
        theta_max: 270.0,
        speed: 5.0,
        ..coarse(1000.0, 250.0, vec![Left, Straight, Right, Straight])
    };
    for transition in [0.0, 0.3] {
        for spec in [&wide, &lefts, &half] {
            for seed in 0..60 {
                let (_, found) = distances(&RoadSpec { transition, ..spec.clone() }, seed);
                let count = (spec.length / spec.step) as usize;
                let expected: Vec<f64> = (0..=count).map(|i| i as f64 * spec.step).collect();
                assert_eq!(found, expected, "seed {seed}");
            }
            // The waypoints of this rule are not evenly spaced.
            let published = RoadSpec { transition, lengths: Lengths::AsPublished, ..spec.clone() };
            for seed in (0..60).filter(|&seed| published.generate(Seed(seed)).is_ok()) {
                let (road, found) = distances(&published, seed);
                assert!(found.is_sorted(), "seed {seed}: {found:?}");
                assert_eq!(found.last(), Some(&road.length()));
                for (s, point) in found.iter().zip(road.waypoints()) {
                    let there = road.pose_at(*s);
                    assert!(
                        there.position.distance(point.pose.position) < 1e-6,
                        "seed {seed}: {s} m"
                    );
                    assert!(
                        (there.heading - point.pose.heading).abs() < 1e-6,
                        "seed {seed}: {s} m"
                    );
                }
            }
        }
    }
}

#[test]
fn csv_without_exact_pieces_has_the_lengths_of_lines() {
    let mut world = RoadSpec::default().generate(Seed(3)).unwrap().to_world();
    let strip = &mut world.road_strips[0];
    let rows = |world: &World| {
        let mut reader = csv::Reader::from_reader(std::io::Cursor::new(write(Format::Csv, world)));
        reader.deserialize().collect::<Result<Vec<[f64; 6]>, _>>().unwrap()
    };
    // A waypoint beside the road: distances still rise to the road's length.
    strip.centreline[500].pose.position += DVec2::new(0.3, 0.2);
    let found = rows(&world);
    assert!(found.windows(2).all(|pair| pair[0][1] < pair[1][1]));
    assert_eq!(found[1000][1], 1000.0);
    world.road_strips[0].pieces.clear();
    let mut along = 0.0;
    let found = rows(&world);
    for pair in found.windows(2) {
        assert!((pair[0][1] - along).abs() < 1e-9);
        along += DVec2::new(pair[1][2] - pair[0][2], pair[1][3] - pair[0][3]).length();
    }
    assert_eq!(found[1000][1], world.road_strips[0].path().length());
}

#[test]
fn the_csv_of_a_circuit_ends_where_it_begins() {
    use Prefab::{Left, Straight};
    let prefabs = vec![Straight, Left, Straight, Left, Straight, Left, Straight, Left];
    let spec = RoadSpec { prefabs, closed: true, speed: 5.0, ..Default::default() };
    let world = spec.generate(Seed(3)).unwrap().to_world();
    let mut reader = csv::Reader::from_reader(std::io::Cursor::new(write(Format::Csv, &world)));
    let rows: Vec<[f64; 6]> = reader.deserialize().collect::<Result<_, _>>().unwrap();
    assert_eq!(rows.len(), world.road_strips[0].centreline.len() + 1);
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    assert_eq!(first[2..], last[2..]);
    assert!((last[1] - 1000.0).abs() < 1e-6, "{last:?}");
}

#[test]
fn a_road_reaches_its_aim_by_longer_and_by_shorter_straights() {
    let lengths = [(600.0, 200.0), (900.0, 500.0)].map(|(x, y)| {
        let spec = RoadSpec { end_x: Some(x), end_y: Some(y), ..Default::default() };
        let road = spec.generate(Seed(55)).unwrap();
        assert!(road.end().position.distance(DVec2::new(x, y)) < 1e-9);
        road.length()
    });
    assert!(lengths[0] < 1000.0 && lengths[1] > 1000.0, "{lengths:?}");
}

#[test]
fn a_world_without_roads_is_refused() {
    let world = ForestSpec::default().generate(Seed(1)).unwrap().to_world();
    for format in [Format::OpenDrive, Format::Csv] {
        let error = format.write(&Job::new(&world), &mut Vec::new()).unwrap_err();
        assert!(matches!(error, ExportError::Empty { part: "road" }), "{error}");
    }
}
