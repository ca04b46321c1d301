//! The motion of doors, which are opened by chance, by a robot or by a command, and never close on a body.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::door::Door;
use super::leaf::{DoorShape, Leaf};
use crate::scenario::neighbourhood::Neighbourhood;
use crate::scenario::person::{PERSON_RADIUS, PersonState};
use crate::scenario::robot::Robot;
use crate::scenario::spec::DoorControl;
use crate::scenario::tick::TICKS_PER_SECOND;
use crate::seed::Seed;

/// The times in seconds that a door takes to open or close, and to slam shut.
const OPENING: f64 = 1.0;
const SLAMMING: f64 = 0.15;

/// The time in seconds for which a triggered door stays open after nobody is near it any more.
const HOLD: f64 = 2.0;
const HOLD_TICKS: u64 = (HOLD * TICKS_PER_SECOND as f64) as u64;

/// The distance in metres from the middle of a triggered door within which a robot or a person opens it. For leaves
/// that swing it is this much more than their reach where that is farther: people wait outside of the swing.
const TRIGGER: f64 = 2.0;
const BEYOND_LEAVES: f64 = PERSON_RADIUS + 0.3;

/// A leaf stops at this distance from a body, in metres.
pub(crate) const LEAF_GAP: f64 = 0.02;

/// The state of a door: its openness, and what it is doing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DoorState {
    /// How far the door is open, from 0 (closed) to 1 (open).
    pub openness: f64,
    /// Whether the door is open or opening.
    pub opens: bool,
    /// Number of times that a body stopped the door while it closed.
    pub stopped: u64,
    slams: bool,
    /// The number of the next action, and the tick at which it is due.
    action: u64,
    due: u64,
}

/// An action that a door should begin at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DoorCommand {
    /// Open the door, which takes at most 1 s.
    Open,
    /// Close the door, which takes at most 1 s.
    Close,
    /// Slam the door shut, which takes at most 0.15 s.
    Slam,
}

/// A command that was given to a door.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GivenDoorCommand {
    /// Number of ticks from the start of the scenario until the command.
    pub tick: u64,
    /// The index of the door.
    pub door: usize,
    /// The command.
    pub command: DoorCommand,
}

/// The data from which a door computes its schedule.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DoorClock {
    pub(crate) seed: Seed,
    /// The index of the doorway, which selects the random streams.
    pub(crate) doorway: u64,
    pub(crate) tick: u64,
}

impl DoorClock {
    /// Draws an exponentially distributed time in ticks, at least one.
    fn wait(&self, mean: f64, action: u64) -> u64 {
        let mut stream = self.seed.attempt("scenario/doors/wait", self.doorway, action);
        let seconds = -mean * libm::log1p(-stream.unit());
        ((seconds * TICKS_PER_SECOND as f64).round() as u64).max(1)
    }

    fn slams(&self, door: &Door, action: u64) -> bool {
        self.seed.attempt("scenario/doors/slam", self.doorway, action).chance(door.slam)
    }
}

/// Everything that a leaf must not touch.
#[derive(Clone, Copy)]
pub(crate) struct Bodies<'a> {
    pub(crate) people: &'a [PersonState],
    pub(crate) near: &'a Neighbourhood,
    pub(crate) robots: &'a [Robot],
}

impl Bodies<'_> {
    /// Whether a test holds for a robot or for a person within a distance of a point. The arguments of the test are
    /// the position, the radius, and whether it is a person.
    fn any_near(&self, p: DVec2, reach: f64, test: impl Fn(DVec2, f64, bool) -> bool) -> bool {
        self.robots.iter().any(|robot| test(robot.position, robot.radius, false))
            || self.near.any(p, reach + PERSON_RADIUS, |i| {
                self.people.get(i).is_some_and(|person| test(person.position, PERSON_RADIUS, true))
            })
    }
}

impl DoorState {
    /// Draws the state at the start: open or closed with the probabilities of the long run; closed if the door is
    /// triggered, and open if it is commanded.
    pub(crate) fn new(door: &Door, clock: &DoorClock) -> Self {
        let share = door.open / (door.open + door.closed);
        let is_timed = door.control == DoorControl::Timed;
        let mut stream = clock.seed.stream("scenario/doors/first", clock.doorway);
        let opens = match door.control {
            DoorControl::Timed => stream.chance(share),
            DoorControl::Triggered => false,
            DoorControl::Commanded => true,
        };
        let mean = if opens { door.open } else { door.closed };
        let due = if is_timed { clock.wait(mean, 0) } else { 0 };
        let openness = f64::from(u8::from(opens));
        DoorState { openness, opens, stopped: 0, slams: false, action: 1, due }
    }

    /// Returns whether the door neither opens nor closes.
    pub fn is_still(&self) -> bool {
        self.openness == f64::from(u8::from(self.opens))
    }

    /// Begins a commanded action. A timed or triggered door continues with its own control from there.
    pub(crate) fn obey(&mut self, command: DoorCommand, door: &Door, tick: u64) {
        self.opens = command == DoorCommand::Open;
        // A command that changes nothing must leave the state as it is: it is not logged.
        self.slams = command == DoorCommand::Slam && !self.is_still();
        if door.control == DoorControl::Triggered && self.opens {
            self.due = tick + HOLD_TICKS;
        }
    }

    /// Whether people can walk through and need not avoid the leaves.
    pub(crate) fn is_open(&self) -> bool {
        self.opens && self.openness >= 1.0
    }

    /// Returns the leaves of the door.
    pub(crate) fn leaves(&self, shape: &DoorShape) -> impl Iterator<Item = Leaf> + use<> {
        shape.leaves(self.openness)
    }

    /// Moves the door by a tick.
    pub(crate) fn step(
        &mut self,
        door: &Door,
        shape: &DoorShape,
        clock: &DoorClock,
        bodies: &Bodies<'_>,
    ) {
        match door.control {
            DoorControl::Timed => {
                while self.due <= clock.tick {
                    self.turn(!self.opens, door, clock);
                    let mean = if self.opens { door.open } else { door.closed };
                    self.due += clock.wait(mean, self.action);
                    self.action += 1;
                }
            }
            DoorControl::Triggered => {
                let swing = if shape.swings() { shape.reach() + BEYOND_LEAVES } else { 0.0 };
                let (middle, reach) = (shape.middle(), TRIGGER.max(swing));
                let is_near = |p: DVec2| p.distance_squared(middle) < reach * reach;
                let is_asked = bodies.robots.iter().any(|robot| is_near(robot.position))
                    || bodies.near.any(middle, reach, |i| {
                        let person = bodies.people.get(i);
                        person.is_some_and(|person| person.is_walking() && is_near(person.position))
                    });
                if is_asked {
                    self.due = clock.tick + HOLD_TICKS;
                    self.opens = true;
                    self.slams = false;
                } else if self.opens && self.due <= clock.tick {
                    self.turn(false, door, clock);
                    self.action += 1;
                }
            }
            DoorControl::Commanded => {}
        }
        if !self.is_still() {
            self.advance(door, shape, clock, bodies);
        }
    }

    fn turn(&mut self, opens: bool, door: &Door, clock: &DoorClock) {
        self.opens = opens;
        self.slams = !opens && clock.slams(door, self.action);
    }

    /// Moves the leaves, unless a body is in front of them.
    fn advance(&mut self, door: &Door, shape: &DoorShape, clock: &DoorClock, bodies: &Bodies<'_>) {
        let seconds = if self.slams { SLAMMING } else { OPENING };
        let step = 1.0 / (seconds * TICKS_PER_SECOND as f64);
        let next = match self.opens {
            // Rounding must not leave a sliver of a step.
            true if self.openness + step > 1.0 - 1e-9 => 1.0,
            true => self.openness + step,
            false if self.openness - step < 1e-9 => 0.0,
            false => self.openness - step,
        };
        // A leaf that slides away touches nobody. People leave the whole swing of one that opens, rather than be
        // shut in behind it.
        let is_sliding_away = self.opens && !shape.swings();
        let (middle, reach) = (shape.middle(), shape.reach() + LEAF_GAP);
        let touches = |p: DVec2, radius: f64, is_person: bool| {
            if p.distance_squared(middle) > (reach + radius) * (reach + radius) {
                return false;
            }
            let end = if is_person && self.opens { 1.0 } else { next };
            let swept = shape.swept_distance(p, self.openness, end);
            // A leaf may always leave a body that it touches.
            swept < radius + LEAF_GAP
                && swept < shape.swept_distance(p, self.openness, self.openness) - 1e-9
        };
        if is_sliding_away || !bodies.any_near(middle, reach, touches) {
            self.openness = next;
        } else if !self.opens {
            self.opens = true;
            self.slams = false;
            self.stopped += 1;
            match door.control {
                DoorControl::Timed => {
                    self.due = clock.tick + clock.wait(door.open, self.action);
                    self.action += 1;
                }
                // It opens fully before it closes again.
                DoorControl::Triggered => self.due = clock.tick + HOLD_TICKS,
                DoorControl::Commanded => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use crate::Seed;
    use crate::geometry::{Rect, Shape};
    use crate::provenance::Provenance;
    use crate::scenario::doors::{Door, DoorKind};
    use crate::scenario::spec::DoorControl;
    use crate::scenario::{Robot, Scenario, ScenarioSpec, ScenarioState};
    use crate::world::{Doorway, Wall, WallKind, World};

    /// Two halls side by side, and a doorway between them that is 5 m wide.
    fn halls(doorway: impl Fn(Shape) -> Shape) -> (World, Scenario) {
        let bounds = Rect::new(DVec2::ZERO, DVec2::new(20.0, 10.0));
        let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
        let rect = |x: [f64; 2], y: [f64; 2]| {
            Shape::from_rect(Rect::new(DVec2::new(x[0], y[0]), DVec2::new(x[1], y[1])))
        };
        for y in [[0.0, 2.5], [7.5, 10.0]] {
            world.walls.push(Wall::new(WallKind::Wall, rect([9.9, 10.1], y)));
        }
        let opening = doorway(rect([9.9, 10.1], [2.5, 7.5]));
        world.doorways.push(Doorway::new(opening, true, [None, None]));
        let mut scenario = Scenario::new(&world, &ScenarioSpec::default(), Seed(1)).unwrap();
        scenario.doors.push(Door {
            doorway: 0,
            kind: DoorKind::Hinged,
            far_end: false,
            to_right: false,
            control: DoorControl::Triggered,
            open: 30.0,
            closed: 30.0,
            slam: 0.0,
        });
        (world, scenario)
    }

    #[test]
    fn a_triggered_door_that_meets_a_body_opens_again() {
        let (world, mut scenario) = halls(|opening| opening);
        let robot = |x: f64, y: f64| Robot {
            position: DVec2::new(x, y),
            velocity: DVec2::ZERO,
            radius: 0.3,
        };
        let mut most_opened = 0;
        for far_end in [false, true] {
            (scenario.doors[0].kind, scenario.doors[0].far_end) = (DoorKind::Sliding, far_end);
            let mut state = ScenarioState::new(&world, &scenario).unwrap();
            state.step(3.0, &[robot(10.5, 5.0)]).unwrap();
            assert_eq!(state.doors()[0].openness, 1.0);
            // Too far from the middle to ask for the door, where its leaf slides.
            let mut opened = 0;
            for _ in 0..60 * 20 {
                let before = state.doors()[0].openness;
                state.step(0.05, &[robot(10.0, 7.1)]).unwrap();
                opened += u32::from(state.doors()[0].openness > before);
            }
            let stopped = state.doors()[0].stopped;
            assert!((5..60).contains(&stopped), "{stopped} stops");
            most_opened = opened.max(most_opened);
        }
        // From one of the two ends the leaf comes a long distance before it meets the robot.
        assert!(most_opened > 40, "{most_opened} ticks opening");
    }

    #[test]
    fn a_leaf_lies_in_a_turned_doorway_of_any_shape() {
        let turned = |opening: Shape| opening.turned(0.7);
        let polygon = |opening: Shape| Shape::Polygon { vertices: opening.turned(0.7).corners() };
        let leaf = |(world, scenario): (World, Scenario)| {
            let state = ScenarioState::new(&world, &scenario).unwrap();
            let leaf = state.leaves_at(0, 0.0).next().unwrap();
            leaf.tip - leaf.hinge
        };
        let (boxed, outline) = (leaf(halls(turned)), leaf(halls(polygon)));
        assert!((boxed.length() - outline.length()).abs() < 1e-9, "{boxed} {outline}");
        assert!(boxed.perp_dot(outline).abs() < 1e-9, "{boxed} {outline}");
    }
}
