//! Smoke: where it is, how it spreads, what beams read.

use envgen::Seed;
use envgen::geometry::{Rect, Shape};
use envgen::glam::DVec2;
use envgen::scenario::smoke::{Laser, Reading, SmokePlace};
use envgen::scenario::{DoorCommand, Robot, Scenario, ScenarioState, SmokeKind};
use envgen::world::{Surface, SurfaceKind, Wall, WallKind};

use crate::two_rooms;

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
fn particles_stay_in_their_room_and_stay_particles_beside_other_smoke() {
    let (world, mut scenario) = two_rooms("kind: sliding, control: commanded");
    let source = |region: &str, kind: &str| {
        let text = format!("(region: {region}, extinction: 0.5, growth: 0.0, kind: {kind})");
        ron::from_str(&text).unwrap()
    };
    let (here, there) = (DVec2::new(1.0, 2.0), DVec2::new(7.0, 2.0));
    for other in ["disc(center: (6.0, 2.0), radius: 0.5)", "room(1)"] {
        scenario.smoke = vec![source("room(0)", "particle"), source(other, "regional")];
        let state = ScenarioState::new(&world, &scenario).unwrap();
        let mut stretches = Vec::new();
        state.smoke_along(here, DVec2::X, 2.0, &mut stretches);
        assert!(stretches.len() == 1 && stretches[0].is_particle, "{other}");
    }
    // The door is open.
    scenario.smoke.pop();
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    state.step(60.0, &[]).unwrap();
    assert_eq!([here, there].map(|p| state.extinction(p)), [0.5, 0.0]);
    let clouds: Vec<_> = state.smoke().filter(|(_, extinction)| *extinction > 0.0).collect();
    assert_eq!(clouds, [(SmokePlace::Room(0), 0.5)]);
    // What leaks into the room is beside the particles, and adds up with them.
    scenario.smoke.push(source("room(1)", "regional"));
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    state.step(60.0, &[]).unwrap();
    let mut stretches = Vec::new();
    state.smoke_along(here, DVec2::X, 2.0, &mut stretches);
    let [leaked, particles] = stretches[..] else { panic!("{stretches:?}") };
    assert!(!leaked.is_particle && particles.is_particle && particles.extinction == 0.5);
    assert!(leaked.extinction > 0.01, "{leaked:?}");
    assert!((state.extinction(here) - 0.5 - leaked.extinction).abs() < 1e-12);
}

#[test]
fn a_box_fills_what_is_between_its_corners() {
    let (world, mut scenario) = two_rooms("kind: sliding, control: commanded");
    let source = |growth: f64| {
        let region = "box(min: (1.0, 1.0), max: (5.0, 3.0))";
        let text =
            format!("(region: {region}, extinction: 0.5, growth: {growth:?}, kind: particle)");
        ron::from_str(&text).unwrap()
    };
    scenario.smoke = vec![source(0.0)];
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    assert_eq!(Scenario::from_ron(&scenario.to_ron().unwrap()).unwrap(), scenario);
    let v = DVec2::new;
    let diagonal = v(1.0, 1.0).normalize();
    // Start, direction, reach, and where the ray is in smoke.
    let rays = [
        (v(0.0, 2.0), DVec2::X, 8.0, Some((1.0, 5.0))),
        (v(0.0, 2.0), DVec2::X, 3.0, Some((1.0, 3.0))),
        (v(3.0, 2.0), DVec2::NEG_Y, 8.0, Some((0.0, 1.0))),
        (v(0.0, 0.0), diagonal, 8.0, Some((2.0_f64.sqrt(), 18.0_f64.sqrt()))),
        // Through a corner's neighbourhood, from x = 4.5 to 5.
        (v(6.5, 1.0), v(-1.0, 1.0).normalize(), 8.0, Some((4.5_f64.sqrt(), 8.0_f64.sqrt()))),
        (v(0.0, 3.5), DVec2::X, 8.0, None),
        (v(0.0, 2.0), DVec2::NEG_X, 8.0, None),
        (v(0.0, 2.0), DVec2::X, 0.9, None),
    ];
    let mut stretches = Vec::new();
    let mut depth_of = |state: &ScenarioState, (from, direction, reach): (DVec2, DVec2, f64)| {
        state.smoke_along(from, direction, reach, &mut stretches);
        stretches.clone()
    };
    for (from, direction, reach, expected) in rays {
        let found = depth_of(&state, (from, direction, reach));
        assert_eq!(found.len(), usize::from(expected.is_some()), "{from} {direction}");
        for (stretch, (enter, leave)) in found.iter().zip(expected) {
            assert!((stretch.from - enter).abs() < 1e-12, "{from} {direction}: {stretch:?}");
            assert!((stretch.to - leave).abs() < 1e-12, "{from} {direction}: {stretch:?}");
            assert!(stretch.extinction == 0.5 && stretch.is_particle);
        }
    }
    let [shape] = &state.smoke_shapes(SmokePlace::Source(0))[..] else { panic!("one shape") };
    let mut corners = shape.corners();
    corners.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    assert_eq!(corners, [v(1.0, 1.0), v(1.0, 3.0), v(5.0, 1.0), v(5.0, 3.0)]);
    // It does not leak through the open door.
    state.step(60.0, &[]).unwrap();
    let at = |state: &ScenarioState, x: f64| state.extinction(v(x, 2.0));
    assert_eq!([0.9, 1.0, 5.0, 5.1].map(|x| at(&state, x)), [0.0, 0.5, 0.5, 0.0]);
    // It grows as a disc, and adds up with one.
    scenario.smoke = vec![source(30.0)];
    let disc = "(region: disc(center: (5.0, 2.0), radius: 0.5), extinction: 0.25, growth: 0.0, kind: regional)";
    scenario.smoke.push(ron::from_str(disc).unwrap());
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    state.step(30.0, &[]).unwrap();
    let grown = -0.5 * libm::expm1(-1.0);
    assert!((at(&state, 2.0) - grown).abs() < 1e-12);
    assert!((at(&state, 4.8) - grown - 0.25).abs() < 1e-12);
}

#[test]
fn boxes_that_are_none_are_refused() {
    let (world, mut scenario) = two_rooms("kind: sliding, control: commanded");
    let mut refused = |corners: &str| {
        let text =
            format!("(region: box({corners}), extinction: 0.5, growth: 0.0, kind: regional)");
        scenario.smoke = vec![ron::from_str(&text).unwrap()];
        ScenarioState::new(&world, &scenario).unwrap_err().to_string()
    };
    let error = refused("min: (NaN, 1.0), max: (5.0, 3.0)");
    assert!(error.starts_with("`smoke[0].region.min` must be a finite point, got"), "{error}");
    for max in ["(0.5, 3.0)", "(5.0, 1.0)", "(5.0, NaN)", "(inf, 3.0)", "(2002.0, 3.0)"] {
        let error = refused(&format!("min: (1.0, 1.0), max: {max}"));
        let expected = "`smoke[0].region.max` must be a point 0.1 to 2000 m to the right of `min`";
        assert!(error.starts_with(expected), "{error}");
    }
    let text =
        "(region: box(min: (1.0, 1.0), size: 3.0), extinction: 0.5, growth: 0.0, kind: regional)";
    assert!(ron::from_str::<envgen::scenario::smoke::SmokeSource>(text).is_err());
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

#[test]
fn smoke_of_halls_grows_and_leaks_into_a_room_through_an_open_door_alone() {
    // The right room is a hallway of two pieces instead.
    let (mut world, mut scenario) = two_rooms("kind: sliding, control: commanded");
    let v = DVec2::new;
    world.rooms.pop();
    for (bottom, top) in [(0.0, 1.0), (1.0, 4.0)] {
        let shape = Shape::from_rect(Rect::new(v(4.0, bottom), v(8.0, top)));
        world.surfaces.push(Surface::new(SurfaceKind::Hallway, shape));
    }
    world.doorways[0].rooms = [Some(0), None];
    let source = |growth: f64| {
        let text = format!("(region: halls, extinction: 2.0, growth: {growth:?}, kind: regional)");
        ron::from_str(&text).unwrap()
    };
    let (room, hall) = (v(1.0, 2.0), [v(7.0, 0.5), v(7.0, 3.0)]);
    scenario.smoke = vec![source(30.0)];
    assert_eq!(Scenario::from_ron(&scenario.to_ron().unwrap()).unwrap(), scenario);
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    state.command_door(0, DoorCommand::Close).unwrap();
    // Closed before any smoke is there that could leak.
    state.step(30.0, &[]).unwrap();
    let places: Vec<_> = state.smoke().map(|(place, _)| place).collect();
    assert_eq!(places, [SmokePlace::Room(0), SmokePlace::Halls]);
    let grown = -2.0 * libm::expm1(-1.0);
    let leaked = state.extinction(room);
    assert!(leaked < 1e-4, "{leaked}");
    for p in hall {
        assert!((state.extinction(p) - grown).abs() < 1e-3, "{} {grown}", state.extinction(p));
    }
    let before = state.extinction(room);
    state.step(60.0, &[]).unwrap();
    assert_eq!(state.extinction(room), before);
    // Open, all of it from the start: dC/dt = 0.1 (2 - C) / 16.
    scenario.smoke = vec![source(0.0)];
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    state.step(60.0, &[]).unwrap();
    let expected = 2.0 * (1.0 - libm::exp(-0.1 * 60.0 / 16.0));
    assert!((state.extinction(room) - expected).abs() < 0.01, "{}", state.extinction(room));
    for p in hall {
        assert!((state.extinction(p) - 2.0).abs() < 0.01, "{}", state.extinction(p));
    }
    // A ray through both pieces.
    let mut stretches = Vec::new();
    state.smoke_along(v(7.0, 0.0), DVec2::Y, 4.0, &mut stretches);
    let depth: f64 = stretches.iter().map(|s| s.extinction * (s.to - s.from)).sum();
    assert!((depth - 4.0 * state.extinction(hall[0])).abs() < 1e-9, "{depth}");
    world.surfaces.clear();
    let error = ScenarioState::new(&world, &scenario).unwrap_err().to_string();
    let expected = "`smoke[0].region` must be a room, a disc or a box, got halls: the world has no";
    assert!(error.starts_with(expected), "{error}");
}
