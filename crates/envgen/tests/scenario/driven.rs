//! Robots that are driven through doors and among people: neither moves into them.

use envgen::clearance_index::ClearanceIndex;
use envgen::geometry::unit_vector;
use envgen::glam::DVec2;
use envgen::scenario::{
    DoorControl, DoorKinds, PERSON_RADIUS, Reactions, Robot, Scenario, ScenarioSpec, ScenarioState,
};
use envgen::{Seed, Stream, World};

use crate::indoor;

const TICK: f64 = 0.05;

/// The greatest speed of a robot in m/s, as fast as people walk.
const SPEED: f64 = 1.4;

/// Between two ticks leaves are looked at in so many places.
const LOOKS: u32 = 16;

/// What a robot met.
#[derive(Default)]
struct Met {
    /// Ticks in which it was in the reach of a door's leaves.
    doorways: u32,
    /// Ticks in which it touched a person.
    people: u32,
    distance: f64,
}

/// A robot that turns to the middles of doors and in random directions.
struct Driver<'w> {
    world: &'w World,
    index: ClearanceIndex,
    robot: Robot,
    heading: f64,
    turn_rate: f64,
    speed: f64,
    /// Whether people stop it, as they stop real ones.
    is_stopped_by_people: bool,
    stream: Stream,
}

impl Driver<'_> {
    /// Its own motion of a tick. Walls and leaves stop it.
    fn drive(&mut self, state: &ScenarioState) {
        if self.stream.chance(0.05) {
            self.speed = self.stream.between(-0.3, SPEED);
            self.turn_rate = self.stream.between(-1.0, 1.0);
            let doors = state.doors().len() as u64;
            if self.stream.chance(0.5) && doors > 0 {
                let to = state.doorway_middle(self.stream.below(doors) as usize);
                let to = to - self.robot.position;
                self.heading = libm::atan2(to.y, to.x);
                self.turn_rate = 0.0;
            }
        }
        self.heading += self.turn_rate * TICK;
        let from = self.robot.position;
        let to = from + unit_vector(self.heading) * self.speed * TICK;
        let leaf_gap = |p: DVec2| {
            let gaps = state.all_leaves().map(|leaf| leaf.nearest_point(p).distance(p));
            gaps.fold(f64::INFINITY, f64::min)
        };
        let person_gap = |p: DVec2| {
            let gaps = state.people().iter().map(|person| person.position.distance(p));
            gaps.fold(f64::INFINITY, f64::min) - PERSON_RADIUS
        };
        // It may leave what it touches.
        let is_free =
            |gap: &dyn Fn(DVec2) -> f64| gap(to) >= self.robot.radius || gap(to) > gap(from);
        let is_free = self.world.bounds.contains(to)
            && is_free(&|p| self.index.clearance(p))
            && is_free(&leaf_gap)
            && (!self.is_stopped_by_people || is_free(&person_gap));
        self.robot.position = if is_free { to } else { from };
        self.robot.velocity = (self.robot.position - from) / TICK;
        if !is_free {
            self.heading = self.stream.between(-3.2, 3.2);
        }
    }
}

/// Drives for some seconds, and checks after each tick that only the robot's own motion made it touch a leaf or a
/// person.
fn drive(driver: &mut Driver<'_>, state: &mut ScenarioState, seconds: u32) -> Met {
    let mut met = Met::default();
    let radius = driver.robot.radius;
    for _ in 0..20 * seconds {
        let from = driver.robot.position;
        driver.drive(state);
        let robot = driver.robot;
        let at = robot.position;
        met.distance += from.distance(at);
        let before = state.clone();
        state.step(TICK, &[robot]).unwrap();
        for (door, (then, now)) in before.doors().iter().zip(state.doors()).enumerate() {
            let gap = |p: DVec2, openness: f64| {
                let gaps =
                    state.leaves_at(door, openness).map(|leaf| leaf.nearest_point(p).distance(p));
                gaps.fold(f64::INFINITY, f64::min)
            };
            // Doors move before people do.
            let people = before.people().iter().map(|person| (person.position, PERSON_RADIUS));
            for (p, radius) in people.chain([(at, radius)]) {
                let first = gap(p, then.openness);
                for look in 0..=LOOKS {
                    let share = f64::from(look) / f64::from(LOOKS);
                    let gap = gap(p, then.openness + share * (now.openness - then.openness));
                    assert!(
                        gap >= first.min(radius) - 1e-6,
                        "tick {}: a leaf of door {door} comes to {gap} m of a body of {radius} m, from {first} m",
                        state.tick()
                    );
                }
            }
            let reach = before.doorway_middle(door).distance(at) < 1.2 + radius;
            met.doorways += u32::from(reach && then.openness != now.openness);
        }
        for (i, (then, now)) in before.people().iter().zip(state.people()).enumerate() {
            let overlap = |p: DVec2| (radius + PERSON_RADIUS - p.distance(at)).max(0.0);
            let (then, now) = (overlap(then.position), overlap(now.position));
            assert!(
                now <= then + 1e-6,
                "tick {}: person {i} walks into the robot: {now} m deep, from {then} m",
                state.tick()
            );
            met.people += u32::from(then > 0.0);
        }
    }
    met
}

#[test]
fn neither_leaves_nor_people_move_into_a_robot_that_drives() {
    let (mut doorways, mut people, mut distance, mut stopped) = (0, 0, 0.0, 0);
    for seed in 0..16 {
        let world = indoor(seed, 5 + (seed % 3) as u32);
        let kinds = [DoorKinds::Hinged, DoorKinds::Double, DoorKinds::Sliding, DoorKinds::Mixed];
        let spec = ScenarioSpec {
            doors: 1.0,
            door_kind: kinds[seed as usize % 4],
            door_control: if seed % 5 == 4 { DoorControl::Triggered } else { DoorControl::Timed },
            door_open: 2.0,
            door_closed: 1.0,
            slam: 1.0,
            people: 2 + seed as u32 / 2,
            working: 4.0,
            waiting: 2.0,
            reaction: if seed % 2 == 0 { Reactions::Mixed } else { Reactions::Impassive },
            ..Default::default()
        };
        let scenario = Scenario::new(&world, &spec, Seed(seed)).unwrap();
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        let position = world.start.unwrap().position;
        let radius = if seed % 2 == 0 { 0.2 } else { 0.35 };
        let mut driver = Driver {
            world: &world,
            index: ClearanceIndex::new(&world, 1.0).unwrap(),
            robot: Robot { position, velocity: DVec2::ZERO, radius },
            heading: 0.0,
            turn_rate: 0.0,
            speed: SPEED,
            is_stopped_by_people: seed % 4 != 3,
            stream: Seed(seed).stream("test/drive", 0),
        };
        let met = drive(&mut driver, &mut state, 100);
        doorways += met.doorways;
        people += met.people;
        distance += met.distance;
        stopped += state.doors().iter().map(|door| door.stopped).sum::<u64>();
    }
    // It is a test only where they met.
    assert!(distance > 300.0, "{distance} m were driven");
    assert!(doorways > 250, "{doorways} ticks near leaves that move");
    assert!(people > 25, "{people} ticks of touching people");
    assert!(stopped > 25, "leaves stopped {stopped} times");
}
