//! What can be reached while doors are open or closed.

use std::collections::BTreeSet;

use envgen::certificate::{Verdict, verify_claims};
use envgen::clearance_index::ClearanceIndex;
use envgen::geometry::{Pose, Rect, Shape};
use envgen::glam::DVec2;
use envgen::indoor::IndoorSpec;
use envgen::scenario::{BehindDoor, Door, DoorKind, DoorKinds, Scenario, ScenarioSpec};
use envgen::world::{Surface, SurfaceKind, Wall, WallKind};
use envgen::{Blueprint, Seed, Spec, World};

use crate::two_rooms;

#[test]
fn the_other_room_is_behind_its_door() {
    let (mut world, scenario) = two_rooms("kind: sliding, control: triggered");
    world.start = Some(Pose::new(2.0, 2.0, 0.0));
    world.goal = Some(Pose::new(7.0, 2.0, 0.0));
    // Half of the other room is a hallway as well.
    for (from, kind) in [(0.0, SurfaceKind::Water), (6.0, SurfaceKind::Hallway)] {
        let floor = Rect::new(DVec2::new(from, 0.0), DVec2::new(from + 0.5, 4.0));
        world.surfaces.push(Surface::new(kind, Shape::from_rect(floor)));
    }
    let there = BehindDoor { door: 0, rooms: vec![1], hallways: vec![1], goal: true };
    assert_eq!(scenario.behind_doors(&world, 0.3).unwrap(), [there]);
    // A disc that never fits through loses nothing.
    assert_eq!(scenario.behind_doors(&world, 0.9).unwrap(), []);
    for radius in [0.0, -1.0, f64::NAN, 11.0] {
        let error = scenario.behind_doors(&world, radius).unwrap_err().to_string();
        assert!(error.contains("`radius` must be a number from 0.01 to 10"), "{error}");
    }
    // In cells of more than 0.1 m doorways are too narrow.
    world.bounds = Rect::new(DVec2::ZERO, DVec2::splat(500.0));
    let error = scenario.behind_doors(&world, 0.3).unwrap_err().to_string();
    assert!(error.contains("`bounds` must be an area of at most 167772"), "{error}");
    world.bounds = two_rooms("kind: sliding, control: triggered").0.bounds;
    // The leaf of a sliding door is in the wall, that of a hinged one in the room.
    assert_eq!(scenario.with_open_doors(&world).unwrap(), world);
    let (world, hinged) = two_rooms("kind: hinged, control: triggered");
    assert_eq!(hinged.with_open_doors(&world).unwrap().walls.len(), world.walls.len() + 1);
}

#[test]
fn places_behind_doors_are_those_that_a_wall_in_the_doorway_cuts_off() {
    const RADIUS: f64 = 0.3;
    let (mut behind, mut undecided) = (0, 0);
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
        let found = scenario.behind_doors(&world, RADIUS).unwrap();
        let all = places_reached(&open, RADIUS);
        for (door, Door { doorway, .. }) in scenario.doors.iter().enumerate() {
            // Whatever the leaves of the other doors.
            let mut closed = world.clone();
            let shape = closed.doorways[*doorway as usize].shape.clone();
            closed.walls.push(Wall::new(WallKind::Wall, shape));
            let lost = |radius: f64| {
                let left = places_reached(&closed, radius);
                [0, 1].map(|i| all[i].difference(&left[i]).copied().collect::<BTreeSet<u32>>())
            };
            let behind_it = found.iter().find(|found| found.door == door);
            let found = behind_it.map_or_else(Default::default, |found| {
                [&found.rooms, &found.hallways].map(|places| places.iter().copied().collect())
            });
            // What even a slim disc does not reach is behind the door; what the disc reaches is not.
            let [least, most] = [RADIUS - 0.05, RADIUS].map(lost);
            for i in [0, 1] {
                assert!(least[i].is_subset(&found[i]), "door {door} of seed {seed}");
                assert!(found[i].is_subset(&most[i]), "door {door} of seed {seed}");
                behind += found[i].len();
                undecided += most[i].len() - least[i].len();
            }
        }
    }
    assert!(behind > 20 && undecided < behind / 4, "{behind} and {undecided}");
}

#[test]
fn a_place_with_another_path_is_behind_no_door() {
    let (mut world, scenario) = two_rooms("kind: sliding, control: triggered");
    world.start = Some(Pose::new(2.0, 2.0, 0.0));
    let wall = |low: f64, high: f64| {
        let rect = Rect::new(DVec2::new(3.9, low), DVec2::new(4.1, high));
        Wall::new(WallKind::Wall, Shape::from_rect(rect))
    };
    // A gap beside the door, 0.8 m wide: the middle of the disc can be in 0.08 m of it, between multiples of 0.1 m.
    for (gap, is_behind) in [(0.8, false), (0.6, true)] {
        world.walls[0] = wall(0.0, 0.3);
        world.walls.truncate(2);
        world.walls.push(wall(0.3 + gap, 1.5));
        let behind = scenario.behind_doors(&world, 0.36).unwrap();
        assert_eq!(behind.iter().any(|behind| behind.rooms == [1]), is_behind, "{gap} m");
    }
}

#[test]
fn the_leaf_of_a_door_closes_no_path_while_the_door_is_closed() {
    let (mut world, mut scenario) = two_rooms("kind: hinged, control: triggered");
    // The robot is in a corridor of 1.1 m beside the wall with the door, which ends at a gap in this wall.
    world.start = Some(Pose::new(4.65, 2.0, 0.0));
    let wall = |from: (f64, f64), to: (f64, f64)| {
        let rect = Rect::new(DVec2::from(from), DVec2::from(to));
        Wall::new(WallKind::Wall, Shape::from_rect(rect))
    };
    world.walls[1] = wall((3.9, 2.5), (4.1, 3.0));
    world.walls.push(wall((5.2, 0.0), (5.3, 4.0)));
    // Open, the leaf is across the corridor, between the robot and the gap.
    let middle = DVec2::new(4.5, 2.5);
    let is_across =
        [(false, false), (false, true), (true, false), (true, true)].into_iter().any(|to| {
            (scenario.doors[0].far_end, scenario.doors[0].to_right) = to;
            let open = scenario.with_open_doors(&world).unwrap();
            open.walls.last().unwrap().shape.bounds().center().distance(middle) < 1e-9
        });
    assert!(is_across);
    assert_eq!(scenario.behind_doors(&world, 0.36).unwrap(), []);
}

#[test]
fn what_a_world_promises_holds_with_all_doors_open() {
    // The robot is larger than a person, or smaller.
    for (seed, robot_radius) in [(1, 0.36), (12, 0.36), (16, 0.36), (3, 0.2), (4, 0.2), (12, 0.2)] {
        let spec = IndoorSpec { width: 8, height: 8, robot_radius, ..Default::default() };
        let world = spec.generate(Seed(seed)).unwrap().to_world();
        let door_kind = if robot_radius < 0.3 { DoorKinds::Hinged } else { DoorKinds::Mixed };
        let spec = ScenarioSpec { doors: 1.0, door_kind, ..Default::default() };
        let scenario = Scenario::new(&world, &spec, Seed(seed)).unwrap();
        assert!(scenario.doors.iter().filter(|door| door.kind != DoorKind::Sliding).count() > 5);
        let open = scenario.with_open_doors(&world).unwrap();
        for (claim, verdict) in verify_claims(&open, &open.certificate) {
            assert_eq!(verdict, Verdict::Holds, "{claim}, seed {seed}");
        }
    }
}

#[test]
fn worlds_of_any_size_without_doors_have_nothing_behind_them() {
    let (mut world, mut scenario) = two_rooms("kind: sliding, control: triggered");
    world.bounds = Rect::new(DVec2::ZERO, DVec2::splat(50_000.0));
    scenario.doors.clear();
    assert_eq!(scenario.behind_doors(&world, 0.3).unwrap(), []);
}

/// The rooms and the hallways, by their surfaces, that a disc reaches from the start: by steps of 0.04 m from point to
/// point.
fn places_reached(world: &World, radius: f64) -> [BTreeSet<u32>; 2] {
    const STEP: f64 = 0.04;
    let index = ClearanceIndex::new(world, 1.0).unwrap();
    let start = world.start.unwrap().position;
    let mut seen = BTreeSet::from([(0, 0)]);
    let mut queue = vec![(0, 0)];
    let mut reached = [BTreeSet::new(), BTreeSet::new()];
    let rooms = world.rooms.iter().map(|room| Some(&room.shape));
    let floors = world.surfaces.iter().map(|floor| floor.kind.is_hall().then_some(&floor.shape));
    let places: [Vec<Option<&Shape>>; 2] = [rooms.collect(), floors.collect()];
    while let Some((col, row)) = queue.pop() {
        let p = start + DVec2::new(f64::from(col), f64::from(row)) * STEP;
        for (reached, places) in reached.iter_mut().zip(&places) {
            let here = (0..).zip(places).filter(|(_, shape)| shape.is_some_and(|s| s.contains(p)));
            reached.extend(here.map(|(place, _)| place));
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
