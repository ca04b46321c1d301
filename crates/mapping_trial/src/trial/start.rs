//! The poses where robots start.

use envgen::World;
use envgen::clearance_index::ClearanceIndex;
use envgen::geometry::{Pose, unit_vector};
use envgen::raycast::Raycaster;
use envgen::scenario::{PERSON_RADIUS, Person};
use envgen::surface_index::SurfaceIndex;
use glam::DVec2;

use super::error::TrialError;
use crate::robot::Robot;

/// Least distance in metres between the centres of robots at their starts.
const APART: f64 = 1.0;

/// Greatest distance of other starts from the first robot's, in metres.
const FAR: f64 = 8.0;

/// Returns a start for each robot: the first at `start`, the others near it and in its sight, with the
/// same heading. All are free of the people of a scenario, where they begin.
pub(super) fn starts(
    world: &World,
    start: Pose,
    robots: u32,
    body: &Robot,
    people: &[Person],
) -> Result<Vec<Pose>, TrialError> {
    if !world.bounds.contains(start.position) {
        return Err(TrialError::OutsideStart { start });
    }
    let radius = body.circumscribed_radius;
    let near = ClearanceIndex::within(world, radius + 0.1, body.extent()?)?;
    let grounds = SurfaceIndex::new(world);
    let clearance = near.clearance(start.position);
    if clearance < radius {
        return Err(TrialError::BlockedStart { start, clearance, radius });
    }
    if grounds.at(start.position).is_barrier() {
        return Err(TrialError::DeepStart { start });
    }
    let to_person = |p: DVec2, person: &Person| person.position.distance(p);
    let least = radius + PERSON_RADIUS;
    let is_met = |person: &Person| to_person(start.position, person) < least;
    if let Some(person) = people.iter().position(is_met) {
        let distance = to_person(start.position, &people[person]);
        return Err(TrialError::OccupiedStart { start, person, distance, least });
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

    #[test]
    fn robots_start_apart_and_free() {
        let body = Robot::default();
        for seed in 0..20 {
            let spec = envgen::indoor::IndoorSpec::default();
            let world = spec.generate(Seed(seed)).expect("a map").to_world();
            let start = world.start.expect("a start");
            let starts = starts(&world, start, 4, &body, &[]).expect("room for four");
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
            starts(world, start, robots, &body, &[]).expect_err("no start").to_string()
        };
        let text = error(&world, 0.1, 1);
        assert!(text.contains("(0.1, 0.5)") && text.contains("0.100 m"), "{text}");
        assert!(error(&world, 1.5, 6).contains("6 robots"), "{}", error(&world, 1.5, 6));
        let shape = Shape::from_rect(world.bounds);
        let kind = SurfaceKind::Water;
        world.surfaces.push(Surface { speed: 0.0, ..Surface::new(kind, shape) });
        assert!(error(&world, 1.5, 1).contains("cannot drive"));
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
        let alone = starts(&world, start, 2, &body, &[]).expect("room for two");
        let there = Person { position: alone[1].position, ..person(0.0) };
        let beside = starts(&world, start, 2, &body, &[there]).expect("room for two");
        let least = body.circumscribed_radius + PERSON_RADIUS;
        assert!(beside[1].position.distance(there.position) >= least, "{beside:?}");
        let met = [person(5.0), person(3.4)];
        let error = starts(&world, start, 1, &body, &met).expect_err("a person").to_string();
        assert!(error.contains("0.400 m from person 1"), "{error}");
    }
}
