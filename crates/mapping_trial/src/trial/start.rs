//! The poses where robots start.

use envgen::World;
use envgen::clearance_index::ClearanceIndex;
use envgen::geometry::{Pose, unit_vector};
use envgen::raycast::Raycaster;
use envgen::scenario::{Leaf, PERSON_RADIUS, Person, ScenarioState};
use envgen::surface_index::SurfaceIndex;
use glam::DVec2;

use super::error::TrialError;
use crate::robot::Robot;

/// Least distance in metres between the centres of robots at their starts.
const APART: f64 = 1.0;

/// Greatest distance of other starts from the first robot's, in metres.
const FAR: f64 = 8.0;

/// A start may be this much nearer to solid parts in metres, by rounding: as much as the simulators leave between
/// parts that touch.
const ROUNDING: f64 = 1e-6;

/// The people and the leaves of doors of a scenario, where they are when a trial begins.
#[derive(Clone, Debug, Default)]
pub(super) struct Moving<'a> {
    people: &'a [Person],
    /// Each leaf with the index of its door.
    leaves: Vec<(usize, Leaf)>,
}

impl<'a> Moving<'a> {
    /// The people of a scenario, and the leaves in its state at the start.
    pub(super) fn new(people: &'a [Person], state: &ScenarioState) -> Self {
        let of = |door: usize| state.leaves(door).map(move |leaf| (door, leaf));
        Moving { people, leaves: (0..state.doors().len()).flat_map(of).collect() }
    }
}

/// Returns a start for each robot: the first at `start`, the others near it and in its sight, with the
/// same heading. All are free of people and leaves.
pub(super) fn starts(
    world: &World,
    start: Pose,
    robots: u32,
    body: &Robot,
    Moving { people, leaves }: &Moving<'_>,
) -> Result<Vec<Pose>, TrialError> {
    if !world.bounds.contains(start.position) {
        return Err(TrialError::OutsideStart { start });
    }
    let radius = body.circumscribed_radius;
    let near = ClearanceIndex::within(world, radius + 0.1, body.extent()?)?;
    let grounds = SurfaceIndex::new(world);
    let clearance = near.clearance(start.position);
    if clearance < radius - ROUNDING {
        return Err(TrialError::BlockedStart { start, clearance, radius });
    }
    if grounds.at(start.position).is_barrier() {
        return Err(TrialError::DeepStart { start });
    }
    let to_person = |p: DVec2, person: &Person| person.position.distance(p);
    let least = radius + PERSON_RADIUS;
    let is_met = |person: &Person| to_person(start.position, person) < least - ROUNDING;
    if let Some(person) = people.iter().position(is_met) {
        let distance = to_person(start.position, &people[person]);
        return Err(TrialError::OccupiedStart { start, person, distance, least });
    }
    let to_leaf = |p: DVec2, leaf: &Leaf| leaf.nearest_point(p).distance(p);
    let is_met = |(_, leaf): &&(usize, Leaf)| to_leaf(start.position, leaf) < radius - ROUNDING;
    if let Some(&(door, ref leaf)) = leaves.iter().find(is_met) {
        let distance = to_leaf(start.position, leaf);
        return Err(TrialError::StartOnDoor { start, door, distance, radius });
    }
    let mut starts = vec![start];
    let rays = Raycaster::at_height(world, body.laser_mount.height);
    let sees = |p: DVec2| {
        let offset = p - start.position;
        rays.cast_along(start.position, offset.normalize(), offset.length()).is_none()
    };
    // Candidates are on rings, from behind the first robot round to its front.
    let step = 0.25;
    let rings = (1..=(FAR / step) as u32).map(|ring| f64::from(ring) * step);
    let mut places = rings.flat_map(|far| {
        let turns = (std::f64::consts::TAU * far / step).ceil() as i32;
        (0..turns).map(move |i| {
            // Left and right alternate: 0, 1, -1, 2, -2, ...
            let side = f64::from((i + 1) / 2) * if i % 2 == 0 { 1.0 } else { -1.0 };
            let angle = start.heading + std::f64::consts::PI;
            let angle = angle + side * std::f64::consts::TAU / f64::from(turns);
            start.position + unit_vector(angle) * far
        })
    });
    while (starts.len() as u32) < robots {
        let free = |p: DVec2| {
            world.bounds.contains(p)
                && starts.iter().all(|other| other.position.distance(p) >= APART.max(2.5 * radius))
                && near.clearance(p) >= radius + 0.05
                && people.iter().all(|person| to_person(p, person) >= least + 0.05)
                && leaves.iter().all(|(_, leaf)| to_leaf(p, leaf) >= radius + 0.05)
                && !grounds.at(p).is_barrier()
                && sees(p)
        };
        match places.by_ref().find(|&p| free(p)) {
            Some(position) => starts.push(Pose { position, heading: start.heading }),
            None => {
                let found = starts.len() as u32;
                return Err(TrialError::NoRoom { robots, found });
            }
        }
    }
    Ok(starts)
}

#[cfg(test)]
mod tests {
    use envgen::geometry::{Rect, Shape};
    use envgen::scenario::Reaction;
    use envgen::world::{Surface, SurfaceKind, Wall, WallKind};
    use envgen::{Blueprint, Provenance, Seed, Spec};

    use super::*;

    fn room(size: DVec2) -> World {
        let bounds = Rect::new(DVec2::ZERO, size);
        let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
        let corners = Shape::from_rect(bounds).corners();
        world.walls = envgen::geometry::edges(&corners)
            .map(|(a, b)| Wall::new(WallKind::Wall, Shape::Segment { a, b }))
            .collect();
        world
    }

    fn of(people: &[Person]) -> Moving<'_> {
        Moving { people, ..Default::default() }
    }

    #[test]
    fn robots_start_apart_and_free() {
        let body = Robot::default();
        for seed in 0..20 {
            let spec = envgen::indoor::IndoorSpec::default();
            let world = spec.generate(Seed(seed)).expect("a map").to_world();
            let start = world.start.expect("a start");
            let starts =
                starts(&world, start, 4, &body, &Moving::default()).expect("room for four");
            assert_eq!(starts[0], start);
            for (i, a) in starts.iter().enumerate() {
                assert!(world.clearance(a.position) >= body.circumscribed_radius);
                for b in &starts[..i] {
                    assert!(a.position.distance(b.position) >= APART - 1e-9);
                }
            }
        }
    }

    #[test]
    fn impossible_starts_are_reported() {
        let body = Robot::default();
        let mut world = room(DVec2::new(3.0, 1.0));
        let error = |world: &World, x: f64, robots| {
            let start = Pose::new(x, 0.5, 0.0);
            starts(world, start, robots, &body, &Moving::default())
                .expect_err("no start")
                .to_string()
        };
        let text = error(&world, 0.1, 1);
        assert!(text.contains("(0.1, 0.5)") && text.contains("0.100000 m"), "{text}");
        assert!(error(&world, 1.5, 6).contains("6 robots"), "{}", error(&world, 1.5, 6));
        let shape = Shape::from_rect(world.bounds);
        let kind = SurfaceKind::Water;
        world.surfaces.push(Surface { speed: 0.0, ..Surface::new(kind, shape) });
        assert!(error(&world, 1.5, 1).contains("cannot drive"));
    }

    #[test]
    fn a_start_where_a_robot_touches_a_wall_is_free() {
        let body = Robot::default();
        let world = room(DVec2::new(3.0, 3.0));
        let start = |gap: f64| {
            let start = Pose::new(body.circumscribed_radius + gap, 1.5, 0.0);
            starts(&world, start, 1, &body, &Moving::default())
        };
        assert!(start(0.0).is_ok() && start(-1e-9).is_ok());
        let error = start(-2e-6).expect_err("in the wall").to_string();
        assert!(error.contains(&format!("{:.6} m", body.circumscribed_radius - 2e-6)), "{error}");
    }

    #[test]
    fn robots_start_beside_people() {
        let body = Robot::default();
        let world = room(DVec2::splat(6.0));
        let start = Pose::new(3.0, 3.0, 0.0);
        let person = |x: f64| Person {
            position: DVec2::new(x, 3.0),
            heading: 0.0,
            speed: 1.3,
            reaction: Reaction::Regular,
        };
        // Where the second robot starts without the person.
        let alone = starts(&world, start, 2, &body, &Moving::default()).expect("room for two");
        let there = Person { position: alone[1].position, ..person(0.0) };
        let beside = starts(&world, start, 2, &body, &of(&[there])).expect("room for two");
        let least = body.circumscribed_radius + PERSON_RADIUS;
        assert!(beside[1].position.distance(there.position) >= least, "{beside:?}");
        let met = [person(5.0), person(3.4)];
        let error = starts(&world, start, 1, &body, &of(&met)).expect_err("a person").to_string();
        assert!(error.contains("0.400 m from person 1"), "{error}");
    }
}
