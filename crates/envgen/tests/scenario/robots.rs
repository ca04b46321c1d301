//! What robots do to people and doors, and what they leave as it is.

use envgen::geometry::{Pose, Rect, Shape};
use envgen::glam::DVec2;
use envgen::placement::pose_of_most_clearance;
use envgen::scenario::{Robot, Scenario, ScenarioSpec, ScenarioState};
use envgen::world::{Doorway, Wall, WallKind};
use envgen::{Provenance, Seed, World};

use crate::{indoor, room_with_a_person};

fn robot(x: f64, y: f64) -> Robot {
    Robot { position: DVec2::new(x, y), velocity: DVec2::ZERO, radius: 0.3 }
}

#[test]
fn people_begin_away_from_the_start() {
    let spec = ScenarioSpec { people: 16, ..Default::default() };
    let nearest = |world: &World, spec: &ScenarioSpec, seed: u64, start: DVec2| {
        let people = Scenario::new(world, spec, Seed(seed)).unwrap().people;
        let distances = people.iter().map(|person| person.position.distance(start));
        distances.fold(f64::INFINITY, f64::min)
    };
    for seed in 0..60 {
        let mut world = indoor(seed, 6);
        let start = world.start.unwrap().position;
        let distance = nearest(&world, &spec, seed, start);
        assert!(distance >= 2.25, "seed {seed}: {distance} m");
        // Where the robots of the examples start.
        world.start = None;
        let start = pose_of_most_clearance(&world).unwrap().unwrap().position;
        let distance = nearest(&world, &spec, seed, start);
        assert!(distance >= 2.25, "seed {seed}: {distance} m");
    }
    // People are closer together before anyone is near the start, and there only where nothing else is free.
    let (mut room, _) = room_with_a_person("regular");
    let start = DVec2::new(4.0, 3.0);
    room.start = Some(Pose { position: start, heading: 0.0 });
    let crowd = |people| ScenarioSpec { people, ..Default::default() };
    let distance = nearest(&room, &crowd(40), 1, start);
    assert!(distance >= 2.25, "{distance} m");
    assert!(nearest(&room, &crowd(70), 1, start) < 2.25);
}

#[test]
fn a_robot_far_away_changes_nothing() {
    for seed in 0..6 {
        let world = indoor(seed, 6);
        let spec = ScenarioSpec { people: 12, doors: 0.5, ..Default::default() };
        let scenario = Scenario::new(&world, &spec, Seed(seed)).unwrap();
        let mut alone = ScenarioState::new(&world, &scenario).unwrap();
        let mut watched = alone.clone();
        for second in 0..300 {
            alone.step(1.0, &[]).unwrap();
            watched.step(1.0, &[robot(1e5, 1e5)]).unwrap();
            assert_eq!(alone.people(), watched.people(), "seed {seed} after {second} s");
        }
        assert_eq!(alone.digest(), watched.digest());
    }
}

#[test]
fn a_robot_behind_a_wall_hides_no_other() {
    let (mut world, scenario) = room_with_a_person("surprised");
    let wall = Rect::new(DVec2::new(2.0, 4.0), DVec2::new(6.0, 4.1));
    world.walls.push(Wall::new(WallKind::Wall, Shape::from_rect(wall)));
    // 2 m away behind the wall, and 2.4 m away in sight.
    let (hidden, seen) = (robot(4.0, 5.0), robot(4.0, 0.6));
    for (robots, reacts) in [
        (vec![hidden], false),
        (vec![seen], true),
        (vec![hidden, seen], true),
        (vec![seen, hidden], true),
    ] {
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        state.step(0.5, &robots).unwrap();
        let person = &state.people()[0];
        assert_eq!(person.is_reacting(), reacts, "{robots:?}");
        assert!(!reacts || person.facing == DVec2::NEG_Y, "{robots:?}");
    }
}

#[test]
fn who_is_scared_is_as_fast_as_stated() {
    let (world, mut scenario) = room_with_a_person("scared");
    scenario.people[0].speed = 0.3;
    // Someone to avoid on the escape.
    let mut other = scenario.people[0];
    other.position.x += 0.7;
    scenario.people.push(other);
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    let mut fastest = 0.0_f64;
    for tick in 0..400 {
        // Straight through both.
        let position = DVec2::new(1.0 + 0.075 * f64::from(tick % 80), 3.0);
        let robot = Robot { position, velocity: 1.5 * DVec2::X, radius: 0.35 };
        state.step(0.05, &[robot]).unwrap();
        let [a, b] = [0, 1].map(|i| state.people()[i].position);
        assert!(a.distance(b) > 0.499, "{a} {b}");
        let speeds = state.people().iter().map(|person| person.velocity.length());
        fastest = speeds.fold(fastest, f64::max);
    }
    assert!((0.5..0.6 + 1e-9).contains(&fastest), "{fastest}");
}

#[test]
fn wide_doors_open_before_their_swing_is_reached() {
    let v = DVec2::new;
    let bounds = Rect::new(v(0.0, 0.0), v(16.0, 6.0));
    let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
    for (from, to) in [(v(7.9, 0.0), v(8.1, 1.5)), (v(7.9, 4.5), v(8.1, 6.0))] {
        world.walls.push(Wall::new(WallKind::Wall, Shape::from_rect(Rect::new(from, to))));
    }
    let opening = Shape::from_rect(Rect::new(v(7.9, 1.5), v(8.1, 4.5)));
    world.doorways.push(Doorway::new(opening, true, [None, None]));
    let mut scenario = Scenario::new(&world, &ScenarioSpec::default(), Seed(1)).unwrap();
    for to_right in [false, true] {
        let door = format!(
            "(doorway: 0, kind: hinged, to_right: {to_right}, control: triggered, open: 9.0, closed: 9.0, slam: 0.0)"
        );
        scenario.doors = vec![ron::from_str(&door).unwrap()];
        let opens_at = |x: f64| {
            let mut state = ScenarioState::new(&world, &scenario).unwrap();
            state.step(0.5, &[robot(x, 3.0)]).unwrap();
            state.doors()[0].opens
        };
        // Leaves of 3 m reach 3.35 m from the middle of the doorway.
        assert!(opens_at(8.0 - 3.6) && opens_at(8.0 + 3.6) && !opens_at(8.0 - 4.5));
    }
}
