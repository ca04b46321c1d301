//! Against `dodgy_2d`, a port of RVO2 in `f32`.

use std::borrow::Cow;

use proptest::prelude::*;

use super::*;
use crate::geometry::Rect;
use crate::provenance::Provenance;
use crate::scenario::person::{Reaction, Task};
use crate::scenario::{Person, Scenario, ScenarioSpec, ScenarioState};
use crate::seed::Seed;
use crate::world::World;

const DT: f64 = 0.05;
const RADIUS: f64 = 0.25;
const SPEED: f64 = 1.3;

/// A disc with its goal.
#[derive(Clone, Copy)]
struct Walker {
    disc: Disc,
    goal: DVec2,
}

fn walker(position: DVec2, goal: DVec2) -> Walker {
    let velocity = (goal - position).normalize_or_zero() * SPEED;
    Walker { disc: Disc { position, velocity, radius: RADIUS, share: 1.0 }, goal }
}

fn preferred(walker: &Walker) -> DVec2 {
    let to = walker.goal - walker.disc.position;
    to.normalize_or_zero() * SPEED.min(to.length() / DT)
}

/// The walls of a corridor along x: the heights of its two sides.
type Corridor = Option<[f64; 2]>;

fn ours(walkers: &[Walker], corridor: Corridor) -> Vec<DVec2> {
    let velocity = |i: usize| {
        let me = &walkers[i];
        let p = me.disc.position;
        let mut planes: Vec<HalfPlane> = corridor
            .into_iter()
            .flatten()
            .map(|y| keep_off(p, RADIUS, DVec2::new(p.x, y)))
            .collect();
        let walls = planes.len();
        let others = (0..walkers.len()).filter(|&j| j != i);
        planes.extend(others.map(|j| avoid(&me.disc, &walkers[j].disc, DT)));
        solve(&planes, walls, SPEED, preferred(me))
    };
    (0..walkers.len()).map(velocity).collect()
}

fn theirs(walkers: &[Walker], corridor: Corridor) -> Vec<DVec2> {
    use dodgy_2d::{Agent, AvoidanceOptions, Obstacle, Vec2};
    let v = |p: DVec2| Vec2::new(p.x as f32, p.y as f32);
    let agents: Vec<Agent> = walkers
        .iter()
        .map(|walker| Agent {
            position: v(walker.disc.position),
            velocity: v(walker.disc.velocity),
            radius: RADIUS as f32,
            avoidance_responsibility: 1.0,
        })
        .collect();
    // The left of an edge is solid.
    let obstacles: Vec<Obstacle> = corridor
        .into_iter()
        .flat_map(|[low, high]| {
            let line = |from: f64, to: f64, y| Obstacle::Open {
                vertices: vec![v(DVec2::new(from, y)), v(DVec2::new(to, y))],
            };
            // Not longer than needed: `f32` loses the digits of far ends.
            [line(20.0, -20.0, low), line(-20.0, 20.0, high)]
        })
        .collect();
    let options = AvoidanceOptions {
        obstacle_margin: RADIUS as f32,
        time_horizon: DISC_HORIZON as f32,
        obstacle_time_horizon: WALL_HORIZON as f32,
    };
    let velocity = |i: usize| {
        let others: Vec<_> =
            (0..agents.len()).filter(|&j| j != i).map(|j| Cow::Borrowed(&agents[j])).collect();
        let walls: Vec<_> = obstacles.iter().map(Cow::Borrowed).collect();
        let found = agents[i].compute_avoiding_velocity(
            &others,
            &walls,
            v(preferred(&walkers[i])),
            SPEED as f32,
            DT as f32,
            &options,
        );
        DVec2::new(f64::from(found.x), f64::from(found.y))
    };
    (0..agents.len()).map(velocity).collect()
}

type Rule = fn(&[Walker], Corridor) -> Vec<DVec2>;

/// The positions after every step of 20 s.
fn run(mut walkers: Vec<Walker>, corridor: Corridor, rule: Rule) -> Vec<Vec<DVec2>> {
    let step = |_| {
        let velocities = rule(&walkers, corridor);
        for (walker, velocity) in walkers.iter_mut().zip(velocities) {
            walker.disc.velocity = velocity;
            walker.disc.position += velocity * DT;
        }
        walkers.iter().map(|walker| walker.disc.position).collect()
    };
    (0..400).map(step).collect()
}

/// The greatest distance between the same disc's positions in both, at any time.
fn difference(a: &[Vec<DVec2>], b: &[Vec<DVec2>]) -> f64 {
    let pairs = a.iter().zip(b).flat_map(|(a, b)| a.iter().zip(b));
    pairs.map(|(p, q)| p.distance(*q)).fold(0.0, f64::max)
}

/// How much the nearest two discs overlap at any time, in metres.
fn overlap(frames: &[Vec<DVec2>]) -> f64 {
    let mut least = f64::INFINITY;
    for frame in frames {
        for (i, p) in frame.iter().enumerate() {
            least = frame[i + 1..].iter().map(|q| p.distance(*q)).fold(least, f64::min);
        }
    }
    2.0 * RADIUS - least
}

#[test]
fn two_that_meet_walk_as_the_reference() {
    let v = DVec2::new;
    let walkers = vec![walker(v(-5.0, 0.02), v(5.0, 0.02)), walker(v(5.0, -0.02), v(-5.0, -0.02))];
    let (ours, theirs) = (run(walkers.clone(), None, ours), run(walkers, None, theirs));
    assert!(difference(&ours, &theirs) < 1e-3, "{}", difference(&ours, &theirs));
    assert!(overlap(&ours) < 1e-3 && ours[399][0].distance(v(5.0, 0.02)) < 0.01);
}

/// The positions of the people of a scenario in an empty hall after every step of 20 s.
fn walk_in_hall(walkers: &[Walker]) -> Vec<Vec<DVec2>> {
    let bounds = Rect::new(DVec2::new(-7.0, -4.0), DVec2::new(7.0, 4.0));
    let world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
    let settings = ScenarioSpec { waiting: 1e6, working: 1e6, ..Default::default() };
    let mut scenario = Scenario::new(&world, &settings, Seed(1)).unwrap();
    let person = |walker: &Walker| {
        let to = walker.goal - walker.disc.position;
        let (heading, reaction) = (libm::atan2(to.y, to.x), Reaction::Regular);
        Person { position: walker.disc.position, heading, speed: SPEED, reaction }
    };
    scenario.people = walkers.iter().map(person).collect();
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    for (person, walker) in state.crowd.people.iter_mut().zip(walkers) {
        (person.path, person.on_path, person.task) = (vec![walker.goal], true, Task::Walk);
    }
    let positions = |_| {
        state.step(DT, &[]).unwrap();
        state.people().iter().map(|person| person.position).collect()
    };
    (0..400).map(positions).collect()
}

#[test]
fn two_people_head_on_pass_near_the_reference() {
    let v = DVec2::new;
    let walkers = vec![walker(v(-5.0, 0.0), v(5.0, 0.0)), walker(v(5.0, 0.0), v(-5.0, 0.0))];
    let people = walk_in_hall(&walkers);
    assert!(overlap(&people) < 1e-6, "{}", overlap(&people));
    for (walker, end) in walkers.iter().zip(&people[399]) {
        assert!(end.distance(walker.goal) < 0.01, "{end}");
    }
    // The reference of two who would pass each other 4 cm to the right: exactly head-on it loses time. People decide
    // every 0.25 s and keep to the right, and are up to 0.51 m away from it.
    let aside = vec![walker(v(-5.0, -0.02), v(5.0, -0.02)), walker(v(5.0, 0.02), v(-5.0, 0.02))];
    let apart = difference(&people, &run(aside, None, theirs));
    assert!(apart < 0.52, "{apart}");
}

#[test]
fn four_at_a_crossing_walk_as_the_reference() {
    let v = DVec2::new;
    let walkers = vec![
        walker(v(-5.0, 0.1), v(5.0, 0.1)),
        walker(v(5.2, -0.1), v(-5.0, -0.1)),
        walker(v(0.1, -5.4), v(0.1, 5.0)),
        walker(v(-0.1, 5.6), v(-0.1, -5.0)),
    ];
    let (ours, theirs) = (run(walkers.clone(), None, ours), run(walkers.clone(), None, theirs));
    assert!(difference(&ours, &theirs) < 1e-3, "{}", difference(&ours, &theirs));
    assert!(overlap(&ours) < 1e-3);
    assert!(ours[399].iter().zip(&walkers).all(|(p, walker)| p.distance(walker.goal) < 0.01));
}

/// Ten from each end of a corridor of 2 m.
fn crowd() -> Vec<Walker> {
    let mut stream = crate::seed::Seed(5).stream("test", 0);
    let mut walkers = Vec::new();
    for i in 0..10 {
        for side in [-1.0, 1.0] {
            let y = side * 0.3 + stream.between(-0.25, 0.25);
            let x = side * (4.0 + 0.9 * f64::from(i));
            walkers.push(walker(DVec2::new(x, y), DVec2::new(-side * 14.0, y)));
        }
    }
    walkers
}

/// From the same state every step is that of the reference. Whole walks are not compared: twenty discs that
/// touch each other all the time are a chaotic system, in which the rounding of `f32` grows to 0.05 m within 20 s.
#[test]
fn twenty_in_a_corridor_step_as_the_reference() {
    let corridor = Some([-1.0, 1.0]);
    let rounded = |p: DVec2| DVec2::new(f64::from(p.x as f32), f64::from(p.y as f32));
    let mut walkers = crowd();
    for step in 0..400 {
        for Walker { disc, .. } in &mut walkers {
            (disc.position, disc.velocity) = (rounded(disc.position), rounded(disc.velocity));
        }
        let (ours, theirs) = (ours(&walkers, corridor), theirs(&walkers, corridor));
        for (i, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
            let apart = ours.distance(*theirs) * DT;
            assert!(apart < 1e-4, "disc {i} in step {step}: {ours} {theirs}");
        }
        for (Walker { disc, .. }, velocity) in walkers.iter_mut().zip(ours) {
            disc.velocity = velocity;
            disc.position += velocity * DT;
        }
    }
}

proptest! {
    #[test]
    fn a_single_step_is_that_of_the_reference(
        discs in prop::collection::vec(
            ((-3.0..3.0, -0.7..0.7), (-1.0..1.0, -1.0..1.0), (-9.0..9.0, -0.7..0.7)), 2..6,
        ),
    ) {
        let walkers: Vec<Walker> = discs
            .into_iter()
            .map(|(p, v, goal): ((f64, f64), (f64, f64), (f64, f64))| {
                let mut walker = walker(p.into(), goal.into());
                walker.disc.velocity = v.into();
                walker
            })
            .collect();
        let apart = |i: usize, j: usize| {
            walkers[i].disc.position.distance(walkers[j].disc.position) > 2.0 * RADIUS + 1e-3
        };
        let n = walkers.len();
        prop_assume!((0..n).all(|i| (i + 1..n).all(|j| apart(i, j))));
        let (ours, theirs) = (ours(&walkers, Some([-1.0, 1.0])), theirs(&walkers, Some([-1.0, 1.0])));
        for (ours, theirs) in ours.iter().zip(&theirs) {
            prop_assert!(ours.distance(*theirs) < 2e-3, "{ours} {theirs}");
        }
    }
}
