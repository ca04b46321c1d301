//! The worlds that are drawn and filmed.

use envgen::geometry::{Pose, Rect, Shape};
use envgen::glam::DVec2;
use envgen::scenario::smoke::{SmokeRegion, SmokeSource};
use envgen::scenario::{
    Door, DoorControl, DoorKind, Person, Reaction, Scenario, ScenarioSpec, SmokeKind,
};
use envgen::world::{Doorway, Room, Wall, WallKind};
use envgen::{Provenance, Seed, World, WorldKind, WorldSpec};

/// The seed of films.
pub(crate) const FILM_SEED: u64 = 2;

/// Returns the spec of a kind of world with some settings.
pub(crate) fn spec(
    kind: &str,
    settings: &[(&str, &str)],
) -> Result<WorldSpec, Box<dyn std::error::Error>> {
    let mut spec = kind.parse::<WorldKind>()?.default_spec();
    for (setting, value) in settings {
        spec.set(setting, value)?;
    }
    Ok(spec)
}

/// Returns a corridor of 16 x 3 m that is divided by a wall with a door, with two people, and with
/// smoke that grows behind the door.
pub(crate) fn corridor() -> (World, Scenario) {
    let v = DVec2::new;
    let bounds = Rect::new(DVec2::ZERO, v(16.0, 3.0));
    let mut world = World::new(Provenance::other("corridor", serde_json::Value::Null), bounds);
    let boxes = [
        (v(0.0, 0.0), v(16.0, 0.1)),
        (v(0.0, 2.9), v(16.0, 3.0)),
        (v(0.0, 0.1), v(0.1, 2.9)),
        (v(15.9, 0.1), v(16.0, 2.9)),
        (v(9.95, 0.1), v(10.05, 1.0)),
        (v(9.95, 2.0), v(10.05, 2.9)),
    ];
    let walls =
        boxes.map(|(from, to)| Wall::new(WallKind::Wall, Shape::from_rect(Rect::new(from, to))));
    world.walls.extend(walls);
    for (left, right) in [(0.1, 9.95), (10.05, 15.9)] {
        world.rooms.push(Room {
            name: "corridor".to_owned(),
            shape: Shape::from_rect(Rect::new(v(left, 0.1), v(right, 2.9))),
            difficulty: None,
            lit: true,
            contents: Default::default(),
            height: None,
        });
    }
    let shape = Shape::from_rect(Rect::new(v(9.95, 1.0), v(10.05, 2.0)));
    world.doorways.push(Doorway::new(shape, true, [Some(0), Some(1)]));
    world.start = Some(Pose::new(1.0, 1.5, 0.0));

    let seed = Seed(FILM_SEED);
    let settings =
        ScenarioSpec { smoke_leak: 0.5, waiting: 1.0, working: 2.0, ..Default::default() };
    let person = |x: f64, y: f64| Person {
        position: v(x, y),
        heading: 0.0,
        speed: 1.2,
        reaction: Reaction::Regular,
    };
    let door = Door {
        doorway: 0,
        kind: DoorKind::Hinged,
        far_end: false,
        to_right: false,
        control: DoorControl::Triggered,
        open: 20.0,
        closed: 20.0,
        slam: 0.0,
    };
    let smoke = SmokeSource {
        region: SmokeRegion::Room(1),
        extinction: 0.8,
        growth: 5.0,
        kind: SmokeKind::Regional,
    };
    let people = vec![person(4.0, 0.8), person(7.0, 2.2), person(13.0, 1.5), person(14.5, 0.8)];
    (world, Scenario { seed, settings, doors: vec![door], people, smoke: vec![smoke] })
}
