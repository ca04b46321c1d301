//! People: whom they avoid, how they react, what a laser sees of them.

use envgen::geometry::Rect;
use envgen::glam::DVec2;
use envgen::scenario::{
    Body, DoorCommand, DoorControl, DoorKinds, Reactions, Robot, Scenario, ScenarioSpec,
    ScenarioState, Target,
};
use envgen::surface_index::SurfaceIndex;
use envgen::{Seed, WorldKind};

use crate::busy_map::{MOST_PEOPLE, busy_map};
use crate::watch::Watch;
use crate::{indoor, room_with_a_person, two_rooms};

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
fn nobody_stays_where_a_path_away_is_free() {
    // Maps of `scenario_sweep` with an obstacle beside the swing of a door, with narrow passages, without a free place
    // beside a jam, without room for more than a step back, with a jam that others would walk into, and with someone
    // who stays where new paths turn.
    for (seed, seconds) in [(106, 960), (36, 1500), (26, 720), (90, 240), (20, 2160), (114, 1440)] {
        let (world, scenario) = busy_map(Seed(seed), MOST_PEOPLE).unwrap();
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        let watch = run(&mut state, seconds, &[]);
        assert!(watch.stuck < 60.0, "seed {seed}: someone stayed for {} s", watch.stuck);
    }
}

#[test]
fn an_arch_of_people_breaks() {
    // Four in front of a doorway that two abreast do not fit through, each held up by the next and by an obstacle: they
    // stayed for an hour.
    let (world, scenario) = busy_map(Seed(274), MOST_PEOPLE).unwrap();
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    let watch = run(&mut state, 300, &[]);
    assert!(watch.longest < 120.0, "someone stayed for {} s", watch.longest);
}

#[test]
fn nobody_steps_aside_to_where_no_path_leads_away() {
    // Someone once squeezed into a room whose doorway is too narrow for paths, and stayed there.
    let (world, scenario) = busy_map(Seed(1605), 120.0).unwrap();
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    let (_, longest) = run(&mut state, 5500, &[]).without_goal;
    assert!(longest < 10.0, "someone found no goal for {longest} s");
}

#[test]
fn who_finds_no_goal_is_counted() {
    // No place is a metre away from the only one.
    let mut world = room_with_a_person("regular").0;
    world.walls.clear();
    world.bounds = Rect::new(DVec2::ZERO, DVec2::new(1.2, 1.2));
    let spec = ScenarioSpec { people: 1, waiting: 1.0, ..Default::default() };
    let scenario = Scenario::new(&world, &spec, Seed(1)).unwrap();
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    let (all, longest) = run(&mut state, 60, &[]).without_goal;
    assert!(longest > 45.0 && (all - longest).abs() < 1e-6, "{all} {longest}");
}

#[test]
fn a_thousand_people_do_not_jam() {
    let world = indoor(1, 71);
    let spec = ScenarioSpec { people: 1000, doors: 0.5, ..Default::default() };
    let scenario = Scenario::new(&world, &spec, Seed(1)).unwrap();
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    state.step(240.0, &[]).unwrap();
    let (mut stuck, mut all) = (0, 0);
    for _ in 0..4 {
        let before = state.people().to_vec();
        state.step(60.0, &[]).unwrap();
        let walkers = before.iter().zip(state.people());
        for (then, now) in walkers.filter(|(then, now)| then.is_walking() && now.is_walking()) {
            stuck += usize::from(then.position.distance(now.position) <= 1.0);
            all += 1;
        }
    }
    assert!(all > 400, "{all} walkers");
    assert!(stuck < all / 20, "{stuck} of {all} walkers are stuck");
}

#[test]
fn nobody_is_in_anything_in_worlds_of_any_kind() {
    for &kind in WorldKind::ALL {
        for seed in 0..3 {
            let world = kind.default_spec().generate(Seed(seed)).unwrap().to_world();
            let ground = SurfaceIndex::new(&world);
            let spec = ScenarioSpec { people: 6, working: 5.0, waiting: 5.0, ..Default::default() };
            let scenario = Scenario::new(&world, &spec, Seed(seed)).unwrap();
            let mut state = ScenarioState::new(&world, &scenario).unwrap();
            let starts: Vec<DVec2> = state.people().iter().map(|person| person.position).collect();
            let mut watch = Watch::default();
            for _ in 0..20 * 60 {
                state.step(0.05, &[]).unwrap();
                watch.look(&state, &[]);
                for person in state.people() {
                    let p = person.position;
                    let below = ground.at(p);
                    assert!(below.speed > 0.0 && !below.water, "{kind} {seed}: {p} is not firm");
                    assert!(world.bounds.contains(p), "{kind} {seed}: {p} is outside");
                }
            }
            let (overlap, what) = &watch.overlap;
            assert!(*overlap < 0.01, "{kind} {seed}: {what} overlap by {overlap} m");
            let moved = |(person, start): (&envgen::scenario::PersonState, &DVec2)| {
                person.position.distance(*start) > 1.0
            };
            let moved = state.people().iter().zip(&starts).filter(|both| moved(*both)).count();
            assert!(moved > 1, "{kind} {seed}: {moved} of 6 walk");
        }
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

/// A room of 8 x 6 m with one person in its middle, who does not move for an hour.
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
fn who_is_surprised_looks_at_the_robot() {
    let (world, scenario) = room_with_a_person("surprised");
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    let mut facing = |robot: DVec2, seconds: f64| {
        let robot = Robot { position: robot, velocity: DVec2::ZERO, radius: 0.3 };
        state.step(seconds, &[robot]).unwrap();
        let person = &state.people()[0];
        (person.is_reacting(), person.facing)
    };
    assert_eq!(facing(DVec2::new(4.0, 5.0), 0.05), (true, DVec2::Y));
    assert_eq!(facing(DVec2::new(4.0, 1.0), 0.05), (true, DVec2::NEG_Y));
    assert_eq!(facing(DVec2::new(1.0, 3.0), 29.9), (true, DVec2::NEG_X));
    // After 30 s the person is used to it.
    assert!(!facing(DVec2::new(4.0, 1.0), 0.1).0);
}

#[test]
fn nobody_reacts_to_a_robot_behind_a_closed_door() {
    for kind in ["hinged", "double", "sliding"] {
        for reaction in ["surprised", "curious", "scared"] {
            let (world, mut scenario) = two_rooms(&format!("kind: {kind}, control: commanded"));
            let person = "position: (2.6, 2.0), heading: 0.0, speed: 1.3";
            let person = format!("({person}, reaction: {reaction})");
            scenario.people = vec![ron::from_str(&person).unwrap()];
            scenario.settings.waiting = 1e6;
            let mut state = ScenarioState::new(&world, &scenario).unwrap();
            state.command_door(0, DoorCommand::Close).unwrap();
            state.step(2.0, &[]).unwrap();
            let position = DVec2::new(5.5, 2.0);
            let robot = Robot { position, velocity: DVec2::ZERO, radius: 0.3 };
            state.step(5.0, &[robot]).unwrap();
            assert!(!state.people()[0].is_reacting(), "{reaction}, {kind}");
            state.command_door(0, DoorCommand::Open).unwrap();
            state.step(2.0, &[robot]).unwrap();
            assert!(state.people()[0].is_reacting(), "{reaction}, {kind}");
        }
    }
}

#[test]
fn nobody_avoids_a_robot_behind_a_closed_door() {
    let (world, mut scenario) = two_rooms("kind: sliding, control: commanded");
    let person = "(position: (2.6, 2.0), heading: 0.0, speed: 1.3, reaction: regular)";
    scenario.people = vec![ron::from_str(person).unwrap()];
    (scenario.settings.waiting, scenario.settings.working) = (1.0, 1.0);
    let walk = |command: DoorCommand, x: f64| {
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        state.command_door(0, command).unwrap();
        state.step(0.05, &[]).unwrap();
        let robot = Robot { position: DVec2::new(x, 2.0), velocity: DVec2::ZERO, radius: 0.3 };
        let position = |_| {
            state.step(0.05, &[robot]).unwrap();
            state.people()[0].position
        };
        (0..2400).map(position).collect::<Vec<_>>()
    };
    assert!(walk(DoorCommand::Slam, 4.5) == walk(DoorCommand::Slam, 7.5));
    assert!(walk(DoorCommand::Open, 4.5) != walk(DoorCommand::Open, 7.5));
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
