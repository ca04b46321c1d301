//! Worlds as buildings of Open-RMF.

use envgen::geometry::{Pose, Rect, Shape, unit_vector};
use envgen::glam::DVec2;
use envgen::hallway::HallwaySpec;
use envgen::import::read_geojson;
use envgen::indoor::IndoorSpec;
use envgen::world::{
    Contents, Doorway, Obstacle, ObstacleKind, Room, Surface, SurfaceKind, Wall, WallKind,
};
use envgen::{Blueprint, Provenance, Seed, Spec, World, WorldKind};
use serde_json::Value;

use crate::{small, written};

/// A building that was read, as far as these tests use it.
struct Building {
    level: Value,
    vertices: Vec<DVec2>,
}

impl Building {
    fn of(world: &World) -> Self {
        let text = written(world, "a.building.yaml");
        assert_eq!(text, written(world, "a.building.yaml"));
        let building: Value = serde_saphyr::from_str(&text).unwrap();
        assert_eq!(building["coordinate_system"], "cartesian_meters");
        let provenance = building["parameters"]["provenance"][1].as_str().unwrap();
        let provenance: Provenance = serde_json::from_str(provenance).unwrap();
        assert_eq!(provenance, world.provenance);
        let level = building["levels"]["L1"].clone();
        let vertices = level["vertices"].as_array().unwrap().iter();
        let vertices = vertices.map(|v| DVec2::new(v[0].as_f64().unwrap(), v[1].as_f64().unwrap()));
        let vertices = vertices.collect();
        Building { level, vertices }
    }

    fn edges(&self, name: &str) -> Vec<[DVec2; 2]> {
        let edges = self.level[name].as_array().unwrap().iter();
        let end = |edge: &Value, i: usize| self.vertices[edge[i].as_u64().unwrap() as usize];
        edges.map(|edge| [end(edge, 0), end(edge, 1)]).collect()
    }
}

#[test]
fn the_lane_of_a_corridor_of_kilometres_is_written_at_once() {
    let spec = HallwaySpec { segments: 20_000, p_st: 0.0, ..Default::default() };
    let world = spec.generate(Seed(1)).unwrap().to_world();
    let lanes = Building::of(&world).edges("lanes");
    let length: f64 = lanes.iter().map(|[a, b]| a.distance(*b)).sum();
    let direct = world.start.unwrap().position.distance(world.goal.unwrap().position);
    assert!(direct > 10_000.0 && (length - direct).abs() < 1.0, "{length} m for {direct} m");
}

#[test]
fn buildings_hold_walls_and_doors() {
    let world = small();
    let building = Building::of(&world);
    let walls = building.edges("walls");
    // Five thin walls, the sides of the pillar and of the crate.
    assert_eq!(walls.len(), 5 + 16 + 3);
    assert!(walls.contains(&[DVec2::new(0.0, 0.125), DVec2::new(4.0, 0.125)]));
    assert_eq!(building.edges("doors"), [[DVec2::new(3.875, 1.0), DVec2::new(3.875, 2.0)]]);
    let door = &building.level["doors"][0][2];
    assert_eq!(door["motion_axis"], serde_json::json!([1, "start"]));
    assert_eq!(door["motion_degrees"], serde_json::json!([3, 90]));
    assert_eq!(door["name"], serde_json::json!([1, "doorway_0"]));
    assert_eq!(building.edges("lanes"), [[DVec2::new(1.0, 1.0), DVec2::new(3.0, 1.0)]]);
    assert_eq!(building.level["vertices"][0][3], "start");
}

#[test]
fn lanes_of_buildings_are_free() {
    for &kind in WorldKind::ALL {
        let world = kind.default_spec().generate(Seed(3)).unwrap().to_world();
        let building = Building::of(&world);
        assert_eq!(building.edges("doors").len(), world.doorways.len());
        let lanes = building.edges("lanes");
        for [a, b] in &lanes {
            for i in 0..=50 {
                let p = a.lerp(*b, f64::from(i) / 50.0);
                assert!(world.clearance(p) > 0.3 - 1e-9, "{kind}: {} at {p}", world.clearance(p));
            }
        }
        let is_open = world.goal.is_some() && !matches!(kind, WorldKind::Landscape);
        assert!(!is_open || !lanes.is_empty(), "{kind}");
    }
}

/// The numbers of the vertices that lanes connect with the start.
fn connected(building: &Building) -> Vec<u64> {
    let ends = |lane: &Value| [lane[0].as_u64().unwrap(), lane[1].as_u64().unwrap()];
    let lanes: Vec<[u64; 2]> =
        building.level["lanes"].as_array().unwrap().iter().map(ends).collect();
    let mut reached = vec![0];
    let mut next = 0;
    while let Some(&at) = reached.get(next) {
        next += 1;
        for [a, b] in lanes.iter().flat_map(|&[a, b]| [[a, b], [b, a]]) {
            if a == at && !reached.contains(&b) {
                reached.push(b);
            }
        }
    }
    reached
}

#[test]
fn lanes_lead_to_the_goal_and_into_every_room() {
    for seed in 1..=4 {
        let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
        let world = spec.generate(Seed(seed)).unwrap().to_world();
        let building = Building::of(&world);
        let connected = connected(&building);
        // Start and goal come first, then the rooms.
        let places = 2 + world.rooms.len() as u64;
        let missing: Vec<u64> = (0..places).filter(|place| !connected.contains(place)).collect();
        assert!(missing.is_empty(), "seed {seed}: {missing:?} of {places}");
        for (room, at) in world.rooms.iter().zip(&building.vertices[2..]) {
            assert!(room.shape.contains(*at), "{} at {at}", room.name);
        }
    }
}

#[test]
fn lanes_do_not_cross_water() {
    let world = |water: bool| {
        let bounds = Rect::new(DVec2::ZERO, DVec2::new(6.0, 3.0));
        let mut world = World::new(Provenance::other("manual", Value::Null), bounds);
        world.start = Some(Pose::new(1.0, 1.0, 0.0));
        world.goal = Some(Pose::new(5.0, 2.0, 0.0));
        if water {
            // Between the middles of two columns of cells of 0.1 m.
            let strip = Rect::new(DVec2::new(2.97, 0.0), DVec2::new(3.03, 3.0));
            world.surfaces.push(Surface::new(SurfaceKind::Water, Shape::from_rect(strip)));
        }
        world
    };
    assert_eq!(Building::of(&world(false)).edges("lanes").len(), 1);
    assert_eq!(Building::of(&world(true)).edges("lanes"), Vec::<[DVec2; 2]>::new());
}

#[test]
fn turned_polygons_are_centre_lines_and_doors() {
    let bounds = Rect::new(DVec2::ZERO, DVec2::splat(10.0));
    let mut world = World::new(Provenance::other("manual", Value::Null), bounds);
    let at = |x: f64| Shape::Box {
        center: DVec2::new(x, 5.0),
        half_size: DVec2::new(0.5, 0.05),
        heading: 0.6,
    };
    world.walls.push(Wall::new(WallKind::Wall, at(3.0)));
    world.doorways.push(Doorway::new(at(5.0), true, [None, None]));
    let turned = read_geojson(&mut written(&world, "a.geojson").as_bytes()).unwrap();
    assert!(matches!(turned.walls[0].shape, Shape::Polygon { .. }), "{:?}", turned.walls[0].shape);
    let (before, after) = (Building::of(&world), Building::of(&turned));
    for name in ["walls", "doors"] {
        let (before, after) = (before.edges(name), after.edges(name));
        assert_eq!((before.len(), after.len()), (1, 1), "{name}");
        let [a, b] = before[0];
        let is_same = |[c, d]: [DVec2; 2]| a.distance(c).max(b.distance(d)) < 1e-9;
        assert!(is_same(after[0]) || is_same([after[0][1], after[0][0]]), "{name}: {after:?}");
    }
}

#[test]
fn lanes_around_a_lake_of_thousands_of_corners_are_written_at_once() {
    let corners = |count: u32| -> Vec<DVec2> {
        let corner = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
            (50.0 + unit_vector(20.0 * angle).y) * unit_vector(angle)
        };
        (0..count).map(corner).collect()
    };
    let lanes = |count: u32| {
        let bounds = Rect::new(DVec2::splat(-60.0), DVec2::splat(60.0));
        let mut world = World::new(Provenance::other("manual", Value::Null), bounds);
        let vertices = corners(count);
        world.obstacles.push(Obstacle::new(ObstacleKind::Other, Shape::Polygon { vertices }));
        world.start = Some(Pose::new(-58.0, 0.0, 0.0));
        world.goal = Some(Pose::new(58.0, 0.0, 0.0));
        // A room inside the lake cannot be reached.
        let within = Rect::new(DVec2::splat(-5.0), DVec2::splat(5.0));
        world.rooms.push(Room {
            name: "island".to_owned(),
            shape: Shape::from_rect(within),
            difficulty: None,
            lit: true,
            contents: Contents::AsDesigned,
            height: None,
        });
        let lanes = Building::of(&world).edges("lanes");
        for [a, b] in &lanes {
            for step in 0..=100 {
                let at = a.lerp(*b, f64::from(step) / 100.0);
                assert!(world.clearance(at) >= 0.3 - 1e-9, "{count}: {at}");
            }
        }
        lanes.iter().map(|[a, b]| a.distance(*b)).sum::<f64>()
    };
    let (few, many) = (lanes(60), lanes(6000));
    assert!((150.0..200.0).contains(&few) && (few - many).abs() < 2.0, "{few} m, {many} m");
}
