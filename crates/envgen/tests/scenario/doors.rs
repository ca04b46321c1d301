//! Doors: when they open, and what a ray sees of them.

use envgen::geometry::{Rect, Shape};
use envgen::glam::DVec2;
use envgen::scenario::{
    DoorCommand, DoorKinds, Robot, Scenario, ScenarioSpec, ScenarioState, Target,
};
use envgen::world::{Extent, Obstacle, ObstacleKind};
use envgen::{Seed, World};

use crate::indoor;
use crate::two_rooms;

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

#[test]
fn a_doorway_in_which_something_is_gets_no_door() {
    let (mut world, _) = two_rooms("kind: sliding, control: commanded");
    let doors = |world: &World| {
        let kinds = [DoorKinds::Hinged, DoorKinds::Double, DoorKinds::Sliding];
        kinds.map(|door_kind| {
            let spec = ScenarioSpec { doors: 1.0, door_kind, ..Default::default() };
            Scenario::new(world, &spec, Seed(1)).unwrap().doors.len()
        })
    };
    assert_eq!(doors(&world), [1; 3]);
    let shape = Shape::Disc { center: DVec2::new(4.0, 2.0), radius: 0.2 };
    world.obstacles.push(Obstacle::new(ObstacleKind::Crate, shape));
    assert_eq!(doors(&world), [0; 3]);
    // A lamp over the doorway is in no leaf's path, but leaves no room to swing.
    world.obstacles[0].height = Some(Extent::new(2.2, 2.4).unwrap());
    assert_eq!(doors(&world), [1; 3]);
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
fn commands_that_change_nothing_are_not_kept() {
    for control in ["commanded", "triggered"] {
        let (world, scenario) = two_rooms(&format!("kind: sliding, control: {control}"));
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        state.command_door(0, DoorCommand::Close).unwrap();
        state.step(2.0, &[]).unwrap();
        assert_eq!(state.doors()[0].openness, 0.0);
        let before = state.digest();
        for command in [DoorCommand::Close, DoorCommand::Slam] {
            state.command_door(0, command).unwrap();
        }
        assert_eq!(state.door_commands(), [], "{control}");
        assert_eq!(state.digest(), before);
        state.command_door(0, DoorCommand::Open).unwrap();
        assert_eq!(state.door_commands().len(), 1);
    }
}

#[test]
fn a_sliding_door_opens_beside_a_robot_that_touches_it() {
    let (world, scenario) = two_rooms("kind: sliding, control: commanded");
    for along in [1.6, 2.0, 2.4] {
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        state.command_door(0, DoorCommand::Close).unwrap();
        state.step(1.0, &[]).unwrap();
        let robot =
            Robot { position: DVec2::new(3.695, along), velocity: DVec2::ZERO, radius: 0.3 };
        state.command_door(0, DoorCommand::Open).unwrap();
        state.step(1.0, &[robot]).unwrap();
        assert_eq!(state.doors()[0].openness, 1.0, "a robot at {along} m");
    }
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
fn a_doorway_that_is_narrower_than_its_wall_is_thick_gets_no_door() {
    let (mut world, _) = two_rooms("kind: sliding, control: commanded");
    let spec = ScenarioSpec { doors: 1.0, ..Default::default() };
    // The doorway is 1 m wide.
    for (thickness, expected) in [(1.4, 0), (0.8, 1)] {
        let part = |low: f64, high: f64| {
            let half = 0.5 * thickness;
            Shape::from_rect(Rect::new(DVec2::new(4.0 - half, low), DVec2::new(4.0 + half, high)))
        };
        world.walls[0].shape = part(0.0, 1.5);
        world.walls[1].shape = part(2.5, 4.0);
        world.doorways[0].shape = part(1.5, 2.5);
        let doors = Scenario::new(&world, &spec, Seed(1)).unwrap().doors;
        assert_eq!(doors.len(), expected, "{thickness} m");
    }
}
