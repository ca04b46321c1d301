//! Doors, people and smoke in generated worlds.

#[path = "common/watch.rs"]
mod watch;

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use envgen::clearance_index::ClearanceIndex;
use envgen::geometry::{Pose, Rect, Shape, unit_vector};
use envgen::glam::DVec2;
use envgen::indoor::IndoorSpec;
use envgen::scenario::smoke::{Laser, Reading, SmokePlace};
use envgen::scenario::{
    BehindDoor, Body, Door, DoorCommand, DoorControl, DoorKinds, PersonState, Reactions, Robot,
    Scenario, ScenarioSpec, ScenarioState, SmokeKind, Target,
};
use envgen::world::{Doorway, Room, Wall, WallKind};
use envgen::{Blueprint, Provenance, Seed, Spec, World, WorldKind};
use proptest::prelude::*;
use watch::Watch;

fn indoor(seed: u64, side: u32) -> World {
    let spec = IndoorSpec { width: side, height: side, ..Default::default() };
    spec.generate(Seed(seed)).unwrap().to_world()
}

fn run(state: &mut ScenarioState, seconds: u32, robots: &[Robot]) -> Watch {
    let mut watch = Watch::default();
    for _ in 0..20 * seconds {
        state.step(0.05, robots).unwrap();
        watch.look(state, robots);
    }
    let (overlap, what) = &watch.overlap;
    assert!(*overlap < 0.01, "{what} overlap by {overlap} m");
    watch
}

#[test]
fn nobody_is_in_anything_in_random_maps() {
    let (mut walked, mut waited, mut longest, mut stopped) = (0.0, 0.0, 0.0_f64, 0);
    for seed in 0..8 {
        let world = indoor(seed, 6 + (seed % 3) as u32 * 2);
        let kinds = [DoorKinds::Mixed, DoorKinds::Hinged, DoorKinds::Double, DoorKinds::Sliding];
        let spec = ScenarioSpec {
            doors: 0.7,
            door_kind: kinds[seed as usize % 4],
            door_control: if seed % 3 == 2 { DoorControl::Triggered } else { DoorControl::Timed },
            door_open: 15.0,
            door_closed: 10.0,
            slam: 0.5,
            people: 3 + seed as u32,
            working: 10.0,
            waiting: 5.0,
            ..Default::default()
        };
        let scenario = Scenario::new(&world, &spec, Seed(seed)).unwrap();
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        let watch = run(&mut state, 300, &[]);
        walked += watch.walked;
        waited += watch.waited;
        longest = longest.max(watch.longest);
        stopped += state.doors().iter().map(|door| door.stopped).sum::<u64>();
    }
    let share = waited / walked;
    assert!(walked > 2e3, "{walked} s of walking");
    assert!(longest < 60.0, "someone was stuck for {longest} s");
    assert!(share < 0.5, "{share} of the walks are waits");
    assert!(stopped > 0, "no door met a body");
}

#[test]
fn a_thousand_people_do_not_jam() {
    let world = indoor(1, 71);
    let spec = ScenarioSpec { people: 1000, doors: 0.5, ..Default::default() };
    let scenario = Scenario::new(&world, &spec, Seed(1)).unwrap();
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    state.step(240.0, &[]).unwrap();
    let before = state.people().to_vec();
    state.step(60.0, &[]).unwrap();
    let walkers = before.iter().zip(state.people());
    let walkers: Vec<_> =
        walkers.filter(|(then, now)| then.is_walking() && now.is_walking()).collect();
    let came_on =
        |(then, now): &&(&PersonState, &PersonState)| then.position.distance(now.position) > 1.0;
    let stuck = walkers.len() - walkers.iter().filter(came_on).count();
    assert!(walkers.len() > 100, "{} walkers", walkers.len());
    assert!(stuck < walkers.len() / 20, "{stuck} of {} walkers are stuck", walkers.len());
}

#[test]
fn nobody_is_in_anything_in_worlds_of_other_kinds() {
    for kind in [WorldKind::Hallway, WorldKind::Forest, WorldKind::Indoor] {
        let world = kind.default_spec().generate(Seed(3)).unwrap().to_world();
        let spec = ScenarioSpec { people: 5, working: 5.0, waiting: 5.0, ..Default::default() };
        let scenario = Scenario::new(&world, &spec, Seed(1)).unwrap();
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        let starts: Vec<DVec2> = state.people().iter().map(|person| person.position).collect();
        run(&mut state, 60, &[]);
        let moved = |(person, start): (&envgen::scenario::PersonState, &DVec2)| {
            person.position.distance(*start) > 1.0
        };
        assert!(state.people().iter().zip(&starts).any(moved), "nobody walks in a {kind}");
    }
}

#[test]
fn a_robot_among_people_is_never_walked_into() {
    let world = indoor(4, 10);
    for reaction in [Reactions::Regular, Reactions::Impassive, Reactions::Mixed] {
        let spec = ScenarioSpec {
            people: 20,
            reaction,
            doors: 0.5,
            door_control: DoorControl::Triggered,
            working: 10.0,
            ..Default::default()
        };
        let scenario = Scenario::new(&world, &spec, Seed(2)).unwrap();
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        let position = world.start.unwrap().position;
        let robot = Robot { position, velocity: DVec2::ZERO, radius: 0.3 };
        // People who stand where the robot starts are none of its.
        let is_far = |state: &ScenarioState| {
            state.people().iter().all(|person| person.position.distance(position) > 0.55)
        };
        assert!(is_far(&state), "another seed is needed");
        run(&mut state, 300, &[robot]);
    }
}

/// A room of 8 x 6 m with one person in its middle, who stands for an hour.
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

#[test]
fn people_react_as_their_kind() {
    let at = |reaction: &str, robot: DVec2, seconds: f64| {
        let (world, scenario) = room_with_a_person(reaction);
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        let robot = Robot { position: robot, velocity: DVec2::ZERO, radius: 0.3 };
        state.step(seconds, &[robot]).unwrap();
        state.people()[0].position.distance(robot.position)
    };
    let robot = DVec2::new(1.0, 3.0);
    // 3 m away: only who is curious moves, and up to 1.5 m.
    assert_eq!(at("regular", robot, 20.0), 3.0);
    assert_eq!(at("surprised", robot, 20.0), 3.0);
    assert_eq!(at("impassive", robot, 20.0), 3.0);
    let near = at("curious", robot, 20.0);
    assert!((near - 1.5).abs() < 0.02, "{near}");
    // dr/dt = -0.18 r.
    let after = at("curious", robot, 2.0);
    assert!((after - 3.0 * libm::exp(-0.36)).abs() < 0.03, "{after}");
    // 2 m away: who is scared goes at 0.6 m/s.
    let away = at("scared", DVec2::new(2.0, 3.0), 2.0);
    assert!((away - 3.2).abs() < 0.07, "{away}");
}

#[test]
fn the_share_of_time_that_doors_are_open_is_that_of_their_law() {
    let world = indoor(6, 12);
    let spec = ScenarioSpec {
        doors: 1.0,
        door_kind: DoorKinds::Sliding,
        door_open: 10.0,
        door_closed: 30.0,
        slam: 0.0,
        ..Default::default()
    };
    let scenario = Scenario::new(&world, &spec, Seed(1)).unwrap();
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    let (mut open, mut looks) = (0.0, 0.0);
    for _ in 0..20_000 {
        state.step(1.0, &[]).unwrap();
        open += state.doors().iter().map(|door| door.openness).sum::<f64>();
        looks += state.doors().len() as f64;
    }
    // An alternating process with a mean cycle of 40 s: of over 10,000 cycles, five standard errors.
    assert!(looks > 4e5, "{looks} looks");
    assert!((open / looks - 0.25).abs() < 0.012, "{}", open / looks);
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

#[test]
fn a_triggered_door_opens_for_a_robot_and_never_closes_on_it() {
    for kind in ["hinged", "double", "sliding"] {
        let (world, scenario) = two_rooms(&format!("kind: {kind}, control: triggered"));
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        let robot =
            |x: f64| Robot { position: DVec2::new(x, 2.0), velocity: DVec2::X, radius: 0.3 };
        let mut at = |x: f64, seconds: f64| {
            state.step(seconds, &[robot(x)]).unwrap();
            let leaves: Vec<_> = state.leaves(0).collect();
            let clear = |leaf: &envgen::scenario::Leaf| {
                leaf.nearest_point(robot(x).position).distance(robot(x).position) >= 0.3
            };
            assert!(x == 1.0 || leaves.iter().all(clear), "{kind}: {leaves:?} at {x}");
            state.doors()[0].openness
        };
        assert_eq!(at(1.0, 10.0), 0.0);
        assert!((at(2.1, 0.5) - 0.5).abs() < 1e-9);
        assert_eq!(at(2.1, 0.6), 1.0);
        assert_eq!(at(4.0, 60.0), 1.0);
        assert_eq!(at(7.0, 1.9), 1.0);
        let closing = at(7.0, 0.6);
        assert!(closing > 0.0 && closing < 1.0, "{closing}");
        assert_eq!(at(7.0, 1.0), 0.0);
    }
}

#[test]
fn a_commanded_door_obeys_and_never_closes_on_a_robot() {
    for kind in ["hinged", "double", "sliding"] {
        let (world, scenario) = two_rooms(&format!("kind: {kind}, control: commanded"));
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        state.step(100.0, &[]).unwrap();
        assert_eq!(state.doors()[0].openness, 1.0);
        for (command, seconds, before) in
            [(DoorCommand::Close, 1.0, 0.05), (DoorCommand::Open, 1.0, 0.95)]
        {
            state.command_door(0, command).unwrap();
            state.step(seconds - 0.05, &[]).unwrap();
            assert!((state.doors()[0].openness - before).abs() < 1e-9, "{kind} {command:?}");
            state.step(0.05, &[]).unwrap();
            assert!(state.doors()[0].is_still());
        }
        let robot = Robot { position: DVec2::new(4.0, 2.0), velocity: DVec2::ZERO, radius: 0.3 };
        state.command_door(0, DoorCommand::Slam).unwrap();
        state.step(0.15, &[]).unwrap();
        assert_eq!(state.doors()[0].openness, 0.0);
        state.command_door(0, DoorCommand::Open).unwrap();
        state.step(1.0, &[]).unwrap();
        for command in [DoorCommand::Close, DoorCommand::Slam] {
            state.command_door(0, command).unwrap();
            state.step(3.0, &[robot]).unwrap();
            assert_eq!(state.doors()[0].openness, 1.0, "{kind} {command:?}");
        }
        assert_eq!(state.doors()[0].stopped, 2);
        let error = state.command_door(1, DoorCommand::Open).unwrap_err();
        let text = "`door` must be the index of one of the scenario's 1 doors, got 1";
        assert_eq!(error.to_string(), text);
    }
}

#[test]
fn the_places_of_smoke_are_those_where_it_is() {
    let (world, mut scenario) = two_rooms("kind: sliding, control: commanded");
    assert_eq!(ScenarioState::new(&world, &scenario).unwrap().smoke().count(), 0);
    let room = "(region: room(0), extinction: 2.0, growth: 0.0, kind: regional)";
    let disc = "(region: disc(center: (6.0, 2.0), radius: 1.0), extinction: 0.5, growth: 0.0, kind: regional)";
    scenario.smoke = [room, disc].map(|text| ron::from_str(text).unwrap()).to_vec();
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    state.step(60.0, &[]).unwrap();
    let places: Vec<_> = state.smoke().collect();
    let known =
        [SmokePlace::Room(0), SmokePlace::Room(1), SmokePlace::Halls, SmokePlace::Source(1)];
    assert_eq!(places.iter().map(|(place, _)| *place).collect::<Vec<_>>(), known);
    for i in 0..80 {
        let p = DVec2::new(0.05 + 0.1 * f64::from(i), 2.2);
        let here = places
            .iter()
            .filter(|(place, _)| state.smoke_shapes(*place).iter().any(|shape| shape.contains(p)));
        let sum: f64 = here.map(|(_, extinction)| extinction).sum();
        assert!((sum - state.extinction(p)).abs() < 1e-12, "{p}");
    }
    assert_eq!(state.smoke_shapes(SmokePlace::Room(9)), []);
    assert_eq!(state.smoke_shapes(SmokePlace::Source(0)), []);
}

#[test]
fn rays_meet_leaves_where_they_are() {
    let (world, scenario) = two_rooms("kind: hinged, control: triggered");
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    let cast = |state: &ScenarioState, y: f64| {
        state.cast(DVec2::new(1.0, y), DVec2::X, 8.0).map(|hit| (hit.target, hit.distance))
    };
    assert_eq!(cast(&state, 2.0), Some((Target::Leaf(0), 3.0)));
    let wall = cast(&state, 1.0).unwrap();
    assert!(matches!(wall.0, Target::Part(_)) && (wall.1 - 2.9).abs() < 1e-12);
    let robot = Robot { position: DVec2::new(5.5, 3.0), velocity: DVec2::ZERO, radius: 0.1 };
    // Half open: the leaf of 1 m is turned by 45 degrees about the lower end, to the left.
    state.step(0.5, &[robot]).unwrap();
    let half = cast(&state, 1.8).unwrap();
    assert!(half.0 == Target::Leaf(0) && (half.1 - 2.7).abs() < 1e-12, "{half:?}");
    assert_eq!(cast(&state, 2.3), None);
    let clearance = state.clearance(DVec2::new(3.5, 1.5));
    assert!((clearance - 0.4).abs() < 1e-9 || clearance <= 0.5_f64.sqrt() * 0.5 + 1e-9);
    state.step(0.5, &[robot]).unwrap();
    assert_eq!(cast(&state, 2.0), None);
}

#[test]
fn a_laser_sees_a_disc_or_two_legs() {
    let (world, mut scenario) = room_with_a_person("impassive");
    let hit = |scenario: &Scenario, y: f64| {
        let state = ScenarioState::new(&world, scenario).unwrap();
        let hit = state.cast(DVec2::new(7.0, y), DVec2::NEG_X, 10.0).unwrap();
        (hit.target == Target::Person(0), hit.distance)
    };
    assert_eq!(hit(&scenario, 3.0), (true, 2.75));
    assert!(!hit(&scenario, 3.3).0);
    scenario.settings.body = Body::Legs;
    assert!(!hit(&scenario, 3.0).0);
    assert_eq!(hit(&scenario, 3.15), (true, 3.0 - 0.07));
    assert_eq!(hit(&scenario, 2.85), (true, 3.0 - 0.07));
}

#[test]
fn beams_fail_in_smoke_as_their_laser() {
    let (world, mut scenario) = two_rooms("kind: sliding, control: triggered");
    let smoke = |kind: SmokeKind| {
        let kind = if kind == SmokeKind::Particle { "particle" } else { "regional" };
        let text = format!("(region: room(0), extinction: 2.0, growth: 0.0, kind: {kind})");
        ron::from_str(&text).unwrap()
    };
    scenario.smoke = vec![smoke(SmokeKind::Regional)];
    let read = |scenario: &Scenario, laser: Laser, y: f64| {
        let state = ScenarioState::new(&world, scenario).unwrap();
        let ray = (DVec2::new(3.5, y), DVec2::NEG_X);
        state.beam(&laser, ray, 8.0, &mut Seed(1).stream("beam", 0)).0
    };
    let state = ScenarioState::new(&world, &scenario).unwrap();
    assert_eq!(state.extinction(DVec2::new(1.0, 1.0)), 2.0);
    assert_eq!(state.extinction(DVec2::new(5.0, 1.0)), 0.0);
    // There is no outer wall: nothing to see within 8 m.
    assert_eq!(read(&scenario, Laser::Sick, 1.0), Reading::NoEcho);
    let mut closed = world.clone();
    let outer = Shape::from_rect(Rect::new(DVec2::ZERO, DVec2::new(0.1, 4.0)));
    closed.walls.push(Wall::new(WallKind::Wall, outer));
    let read = |scenario: &Scenario, laser: Laser, from: f64| {
        let state = ScenarioState::new(&closed, scenario).unwrap();
        let ray = (DVec2::new(from, 1.0), DVec2::NEG_X);
        state.beam(&laser, ray, 8.0, &mut Seed(1).stream("beam", 0)).0
    };
    let physical = Laser::Physical { power_range: 30.0 };
    // The range in smoke of 2/m is 1.486 m.
    assert!(matches!(read(&scenario, physical, 1.55), Reading::Echo(d) if (d - 1.45).abs() < 1e-9));
    assert_eq!(read(&scenario, physical, 1.65), Reading::NoEcho);
    assert!(matches!(read(&scenario, Laser::Sick, 3.5), Reading::Echo(_)));
    let hokuyo = Laser::Hokuyo { budget: Laser::HOKUYO_BUDGET };
    assert_eq!(read(&scenario, hokuyo, 3.5), Reading::NoEcho);
    scenario.smoke = vec![smoke(SmokeKind::Particle)];
    assert_eq!(read(&scenario, Laser::Sick, 3.5), Reading::NoEcho);
}

#[test]
fn smoke_leaks_through_an_open_door_alone() {
    let (world, mut scenario) = two_rooms("kind: sliding, control: triggered");
    let text = "(region: room(0), extinction: 2.0, growth: 0.0, kind: regional)";
    scenario.smoke = vec![ron::from_str(text).unwrap()];
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    let there = DVec2::new(7.0, 2.0);
    state.step(60.0, &[]).unwrap();
    assert_eq!(state.extinction(there), 0.0);
    let robot = Robot { position: DVec2::new(5.0, 2.0), velocity: DVec2::ZERO, radius: 0.3 };
    state.step(60.0, &[robot]).unwrap();
    // dC/dt = 0.1 (2 - C) / 16, for the 59.5 s that it was open on average.
    let expected = 2.0 * (1.0 - libm::exp(-0.1 * 59.5 / 16.0));
    let found = state.extinction(there);
    assert!((found - expected).abs() < 0.02, "{found} {expected}");
}

fn everything() -> (World, Scenario) {
    let world = indoor(9, 10);
    let spec = ScenarioSpec {
        doors: 0.6,
        people: 12,
        smoke: 0.5,
        smoke_growth: 20.0,
        smoke_sources: 2,
        working: 10.0,
        reaction: Reactions::Mixed,
        ..Default::default()
    };
    let scenario = Scenario::new(&world, &spec, Seed(3)).unwrap();
    (world, scenario)
}

#[test]
fn the_scenario_is_frozen() {
    let (world, scenario) = everything();
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    state.step(120.0, &[]).unwrap();
    // A change here changes what happens in the scenario of every seed.
    let found = [state.digest().to_string(), world.digest().to_string()];
    assert_eq!(
        found.map(|digest| digest[..16].to_owned()),
        ["5b8eccc8e24ee468", "fc647f03e6b7927d"]
    );
}

#[test]
fn a_file_holds_the_whole_scenario() {
    let (world, scenario) = everything();
    let read = Scenario::from_ron(&scenario.to_ron().unwrap()).unwrap();
    assert_eq!(read, scenario);
    let end = |scenario: &Scenario| {
        let mut state = ScenarioState::new(&world, scenario).unwrap();
        state.step(30.0, &[]).unwrap();
        state.digest()
    };
    assert_eq!(end(&read), end(&scenario));
    assert_eq!(Scenario::new(&world, &scenario.settings, scenario.seed).unwrap(), scenario);
}

#[test]
fn without_settings_nothing_moves() {
    for &kind in WorldKind::ALL {
        let world = kind.default_spec().generate(Seed(3)).unwrap().to_world();
        let scenario = Scenario::new(&world, &ScenarioSpec::default(), Seed(1)).unwrap();
        assert!(scenario.doors.is_empty() && scenario.people.is_empty());
        let state = ScenarioState::new(&world, &scenario).unwrap();
        let middle = world.start.map_or(world.bounds.center(), |start| start.position);
        for i in 0..100 {
            let direction = unit_vector(TAU * f64::from(i) / 100.0);
            let still = state.still_rays().cast_along(middle, direction, 20.0);
            let hit = state.cast(middle, direction, 20.0);
            assert_eq!(hit.map(|hit| hit.distance), still.map(|hit| hit.distance));
        }
    }
}

/// The error of a scenario in a world.
fn refusal(world: &World, spec: ScenarioSpec) -> String {
    Scenario::new(world, &spec, Seed(1)).unwrap_err().to_string()
}

#[test]
fn errors_name_what_does_not_fit() {
    let forest = WorldKind::Forest.default_spec().generate(Seed(1)).unwrap().to_world();
    let (world, scenario) = everything();
    let spec = |text: &str| ron::from_str::<ScenarioSpec>(text).unwrap();
    assert_eq!(
        refusal(&forest, spec("(doors: 0.5)")),
        "`doors` must be 0, got 0.5: the world has no open doorway"
    );
    assert_eq!(
        refusal(&world, spec("(smoke: -0.5)")),
        "`smoke` must be a number from 0 to 100, got -0.5"
    );
    let error = refusal(&world, spec("(people: 10000)"));
    assert!(error.starts_with("`people` must be a whole number from 0 to "), "{error}");
    assert!(error.ends_with("got 10000: no more fit into the free space"), "{error}");
    // As many as the error says do fit.
    let most = error.split("from 0 to ").nth(1).unwrap().split(',').next().unwrap();
    let most = ScenarioSpec { people: most.parse().unwrap(), ..Default::default() };
    let crowd = Scenario::new(&world, &most, Seed(1)).unwrap();
    assert!(ScenarioState::new(&world, &crowd).is_ok());
    let full = {
        let mut full = room_with_a_person("regular").0;
        let solid = Shape::from_rect(full.bounds);
        full.walls.push(Wall::new(WallKind::Wall, solid));
        full
    };
    let error = refusal(&full, spec("(people: 1)"));
    assert!(error.starts_with("`people` must be 0, got 1: nowhere in the world"), "{error}");

    let refused = |change: &dyn Fn(&mut Scenario)| {
        let mut scenario = scenario.clone();
        change(&mut scenario);
        ScenarioState::new(&world, &scenario).unwrap_err().to_string()
    };
    let n = world.doorways.len();
    assert_eq!(
        refused(&|s| s.doors[1].doorway = 999),
        format!(
            "`doors[1].doorway` must be the index of a doorway of the world, at most {}, got 999",
            n - 1
        )
    );
    let error = refused(&|s| s.doors[1].doorway = s.doors[0].doorway);
    assert!(
        error.contains("a doorway without a door") && error.ends_with("doors[0] is in it"),
        "{error}"
    );
    let error = refused(&|s| s.doors[0].open = f64::NAN);
    assert!(error.starts_with("`doors[0].open` must be a number from 0.5"), "{error}");
    let error = refused(&|s| s.people[2].position = DVec2::ZERO);
    assert!(error.starts_with("`people[2].position` must be a point with 0.25 m"), "{error}");
    let error = refused(&|s| s.people[3].position = s.people[1].position);
    assert!(error.ends_with("people[1] is nearer"), "{error}");
    let error = refused(&|s| s.smoke[0].extinction = -1.0);
    assert_eq!(error, "`smoke[0].extinction` must be a number from 0 to 100, got -1");
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    let error = state.step(f64::NAN, &[]).unwrap_err().to_string();
    assert_eq!(error, "`dt` must be a number from 0 to 86400, got NaN");
    let robot = Robot { position: DVec2::NAN, velocity: DVec2::ZERO, radius: 0.3 };
    let error = state.step(1.0, &[robot]).unwrap_err().to_string();
    assert!(error.starts_with("`robots[0].position` must be finite numbers"), "{error}");
    assert_eq!(state.tick(), 0);
    assert_eq!(Pose::default().position, DVec2::ZERO);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn steps_of_any_length_are_the_same_to_the_bit(
        steps in prop::collection::vec(0.0..3.0_f64, 1..40),
    ) {
        let (world, scenario) = everything();
        let state = ScenarioState::new(&world, &scenario).unwrap();
        let (mut many, mut one) = (state.restarted(), state);
        for &dt in &steps {
            many.step(dt, &[]).unwrap();
        }
        one.step(many.time(), &[]).unwrap();
        prop_assert_eq!(many.digest(), one.digest());
    }
}

proptest! {
    #[test]
    fn any_text_is_a_scenario_or_an_error(text in ".{0,200}") {
        let _ = Scenario::from_ron(&text);
    }

    #[test]
    fn any_numbers_are_a_scenario_or_an_error(
        doors: f64, people in 0..40_u32, smoke: f64, speed: f64, growth: f64, door: u32,
        x: f64, y: f64, extinction: f64, radius: f64,
    ) {
        let (world, known) = two_rooms("kind: hinged, control: timed");
        let spec = ScenarioSpec {
            doors, people, smoke, walking_speed: speed, smoke_growth: growth, ..Default::default()
        };
        if let Ok(mut scenario) = Scenario::new(&world, &spec, Seed(1)) {
            let mut state = ScenarioState::new(&world, &scenario).unwrap();
            state.step(1.0, &[]).unwrap();
            scenario.doors = vec![envgen::scenario::Door { doorway: door, ..known.doors[0] }];
            let _ = ScenarioState::new(&world, &scenario);
        }
        let mut scenario = known;
        let text = format!(
            "(region: disc(center: ({x:?}, {y:?}), radius: {radius:?}), extinction: {extinction:?}, \
             growth: 0.0, kind: regional)"
        );
        if let Ok(source) = ron::from_str(&text) {
            scenario.smoke = vec![source];
            if let Ok(mut state) = ScenarioState::new(&world, &scenario) {
                state.step(1.0, &[]).unwrap();
                let extinction = state.extinction(DVec2::new(x, y));
                prop_assert!((0.0..=100.0).contains(&extinction));
            }
        }
    }
}

#[test]
fn the_other_room_is_behind_its_door() {
    let (mut world, scenario) = two_rooms("kind: sliding, control: triggered");
    world.start = Some(Pose::new(2.0, 2.0, 0.0));
    world.goal = Some(Pose::new(7.0, 2.0, 0.0));
    let there = BehindDoor { door: 0, rooms: vec![1], goal: true };
    assert_eq!(scenario.behind_doors(&world, 0.3).unwrap(), [there]);
    // A disc that never fits through loses nothing.
    assert_eq!(scenario.behind_doors(&world, 0.9).unwrap(), []);
    for radius in [0.0, -1.0, f64::NAN, 11.0] {
        let error = scenario.behind_doors(&world, radius).unwrap_err().to_string();
        assert!(error.contains("`radius` must be a number from 0.01 to 10"), "{error}");
    }
    // The leaf of a sliding door is in the wall, that of a hinged one in the room.
    assert_eq!(scenario.with_open_doors(&world).unwrap(), world);
    let (world, hinged) = two_rooms("kind: hinged, control: triggered");
    assert_eq!(hinged.with_open_doors(&world).unwrap().walls.len(), world.walls.len() + 1);
}

#[test]
fn rooms_behind_doors_are_those_that_a_wall_in_the_doorway_cuts_off() {
    const RADIUS: f64 = 0.3;
    let mut behind = 0;
    for seed in 0..4 {
        let few = IndoorSpec {
            width: 7,
            height: 7,
            doorway_probability: Some(0.1),
            ..Default::default()
        };
        let world = few.generate(Seed(seed)).unwrap().to_world();
        let spec = ScenarioSpec { doors: 0.8, ..Default::default() };
        let scenario = Scenario::new(&world, &spec, Seed(seed)).unwrap();
        let open = scenario.with_open_doors(&world).unwrap();
        let all = rooms_reached(&open, RADIUS);
        let mut expected = Vec::new();
        for (door, Door { doorway, .. }) in scenario.doors.iter().enumerate() {
            let mut closed = open.clone();
            let shape = closed.doorways[*doorway as usize].shape.clone();
            closed.walls.push(Wall::new(WallKind::Wall, shape));
            let left = rooms_reached(&closed, RADIUS);
            let lost: Vec<u32> = (0..world.rooms.len() as u32)
                .filter(|r| all[*r as usize] && !left[*r as usize])
                .collect();
            if !lost.is_empty() {
                expected.push((door, lost));
            }
        }
        let found = scenario.behind_doors(&world, RADIUS).unwrap();
        let found: Vec<_> = found.into_iter().map(|door| (door.door, door.rooms)).collect();
        behind += found.len();
        // Doors to the goal alone are no rooms.
        let found: Vec<_> = found.into_iter().filter(|(_, rooms)| !rooms.is_empty()).collect();
        assert_eq!(found, expected, "seed {seed}");
    }
    assert!(behind > 3, "{behind} doors have a room behind them");
}

/// Which rooms a disc reaches from the start: by steps of 0.1 m from point to point.
fn rooms_reached(world: &World, radius: f64) -> Vec<bool> {
    const STEP: f64 = 0.1;
    let index = ClearanceIndex::new(world, 1.0).unwrap();
    let start = world.start.unwrap().position;
    let mut seen = BTreeSet::from([(0, 0)]);
    let mut queue = vec![(0, 0)];
    let mut reached = vec![false; world.rooms.len()];
    while let Some((col, row)) = queue.pop() {
        let p = start + DVec2::new(f64::from(col), f64::from(row)) * STEP;
        for (room, is_reached) in world.rooms.iter().zip(&mut reached) {
            *is_reached |= room.shape.contains(p);
        }
        for next in [(col + 1, row), (col - 1, row), (col, row + 1), (col, row - 1)] {
            let p = start + DVec2::new(f64::from(next.0), f64::from(next.1)) * STEP;
            if world.bounds.contains(p) && index.clearance(p) >= radius && seen.insert(next) {
                queue.push(next);
            }
        }
    }
    reached
}
