//! What can be reached while doors are open or closed.

use std::collections::BTreeSet;

use envgen::clearance_index::ClearanceIndex;
use envgen::geometry::{Pose, Rect, Shape};
use envgen::glam::DVec2;
use envgen::indoor::IndoorSpec;
use envgen::scenario::{BehindDoor, Door, Scenario, ScenarioSpec};
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
        let all = places_reached(&open, RADIUS);
        let mut expected = Vec::new();
        for (door, Door { doorway, .. }) in scenario.doors.iter().enumerate() {
            let mut closed = open.clone();
            let shape = closed.doorways[*doorway as usize].shape.clone();
            closed.walls.push(Wall::new(WallKind::Wall, shape));
            let left = places_reached(&closed, RADIUS);
            let lost = |places: usize| -> Vec<u32> {
                let (all, left) = (&all[places], &left[places]);
                let lost =
                    (0..).zip(all.iter().zip(left)).filter(|(_, (all, left))| **all && !**left);
                lost.map(|(place, _)| place).collect()
            };
            let (rooms, hallways) = (lost(0), lost(1));
            if !rooms.is_empty() || !hallways.is_empty() {
                expected.push((door, rooms, hallways));
            }
        }
        let found = scenario.behind_doors(&world, RADIUS).unwrap();
        let found: Vec<_> =
            found.into_iter().map(|door| (door.door, door.rooms, door.hallways)).collect();
        behind += found.len();
        // Doors to the goal alone are to no place.
        let is_place =
            |found: &(usize, Vec<u32>, Vec<u32>)| !found.1.is_empty() || !found.2.is_empty();
        let found: Vec<_> = found.into_iter().filter(is_place).collect();
        assert_eq!(found, expected, "seed {seed}");
    }
    assert!(behind > 3, "{behind} doors have a room behind them");
}

/// Which rooms and which hallways, by their surfaces, a disc reaches from the start: by steps of 0.1 m from point to
/// point.
fn places_reached(world: &World, radius: f64) -> [Vec<bool>; 2] {
    const STEP: f64 = 0.1;
    let index = ClearanceIndex::new(world, 1.0).unwrap();
    let start = world.start.unwrap().position;
    let mut seen = BTreeSet::from([(0, 0)]);
    let mut queue = vec![(0, 0)];
    let mut reached = [vec![false; world.rooms.len()], vec![false; world.surfaces.len()]];
    while let Some((col, row)) = queue.pop() {
        let p = start + DVec2::new(f64::from(col), f64::from(row)) * STEP;
        let [rooms, floors] = &mut reached;
        for (room, is_reached) in world.rooms.iter().zip(rooms) {
            *is_reached |= room.shape.contains(p);
        }
        for (floor, is_reached) in world.surfaces.iter().zip(floors) {
            let is_hallway = floor.kind.is_hall();
            *is_reached |= is_hallway && floor.shape.contains(p);
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
