//! Doors, people and smoke in generated worlds.

#[path = "../common/busy_map.rs"]
mod busy_map;
#[path = "../common/watch.rs"]
mod watch;

mod access;
mod doors;
mod driven;
mod people;
mod robots;
mod smoke;
mod whole;

use envgen::geometry::{Rect, Shape};
use envgen::glam::DVec2;
use envgen::indoor::IndoorSpec;
use envgen::scenario::{Scenario, ScenarioSpec};
use envgen::world::{Doorway, Room, Wall, WallKind};
use envgen::{Blueprint, Provenance, Seed, Spec, World};

fn indoor(seed: u64, side: u32) -> World {
    let spec = IndoorSpec { width: side, height: side, ..Default::default() };
    spec.generate(Seed(seed)).unwrap().to_world()
}

/// Two rooms of 4 x 4 m with a doorway of 1 m between them, and a robot's scenario of a door in it.
fn two_rooms(door: &str) -> (World, Scenario) {
    let v = DVec2::new;
    let bounds = Rect::new(v(0.0, 0.0), v(8.0, 4.0));
    let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
    for (from, to) in [(v(3.9, 0.0), v(4.1, 1.5)), (v(3.9, 2.5), v(4.1, 4.0))] {
        world.walls.push(Wall::new(WallKind::Wall, Shape::from_rect(Rect::new(from, to))));
    }
    for left in [0.0, 4.0] {
        world.rooms.push(Room {
            name: "room".to_owned(),
            shape: Shape::from_rect(Rect::new(v(left, 0.0), v(left + 4.0, 4.0))),
            difficulty: None,
            lit: true,
            contents: Default::default(),
            height: None,
        });
    }
    let shape = Shape::from_rect(Rect::new(v(3.9, 1.5), v(4.1, 2.5)));
    world.doorways.push(Doorway::new(shape, true, [Some(0), Some(1)]));
    let mut scenario = Scenario::new(&world, &ScenarioSpec::default(), Seed(1)).unwrap();
    let door = format!("(doorway: 0, {door}, open: 1e6, closed: 1e6, slam: 0.0)");
    scenario.doors = vec![ron::from_str(&door).unwrap()];
    (world, scenario)
}

fn room_with_a_person(reaction: &str) -> (World, Scenario) {
    let v = DVec2::new;
    let bounds = Rect::new(v(0.0, 0.0), v(8.0, 6.0));
    let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
    for (from, to) in [
        (v(0.0, 0.0), v(8.0, 0.1)),
        (v(0.0, 5.9), v(8.0, 6.0)),
        (v(0.0, 0.0), v(0.1, 6.0)),
        (v(7.9, 0.0), v(8.0, 6.0)),
    ] {
        world.walls.push(Wall::new(WallKind::Wall, Shape::from_rect(Rect::new(from, to))));
    }
    let spec = ScenarioSpec { waiting: 1e6, ..Default::default() };
    let mut scenario = Scenario::new(&world, &spec, Seed(1)).unwrap();
    let person = format!("(position: (4.0, 3.0), heading: 0.0, speed: 1.3, reaction: {reaction})");
    scenario.people = vec![ron::from_str(&person).unwrap()];
    (world, scenario)
}
