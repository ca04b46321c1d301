//! Checks of what moves, at every step.

use std::collections::BinaryHeap;

use envgen::glam::DVec2;
use envgen::scenario::{DoorState, PERSON_RADIUS, PersonState, Robot, ScenarioState, Target};

/// Those who wait for so many ticks, and for each multiple, are looked at: could they walk away? Those who stand are
/// asked as often whether they found no goal.
const ASK: u64 = 20;

/// Between two ticks leaves are looked at in so many places: slammed ones turn by up to 30 degrees in a tick.
const LOOKS: u32 = 16;

/// Leaves of doors whose middle is farther away than this touch nobody, in metres.
const LEAVES: f64 = 4.0;

/// A path is free if it leads this far away, in metres.
const AWAY: f64 = 1.5;

/// Side of the cells in which free paths are searched, and how much nearer than their radius people may come to
/// others on them, in metres: who waits touches others, and rounding is no overlap.
const CELL: f64 = 0.05;
const TOUCH: f64 = 0.002;

/// Half the side in cells of the window in which free paths are searched, with the person in the middle.
const WINDOW: usize = (AWAY / CELL) as usize + 2;

/// What was seen of a scenario.
#[derive(Default)]
pub(crate) struct Watch {
    /// Since when each person has been near a point while walking: the point, and the tick. The second tick is
    /// the last one when no path away was free, or a leaf was in front of the person.
    anchors: Vec<(DVec2, u64, u64)>,
    /// How many goals each person had drawn who stood when last asked, and since when none was found.
    standing: Vec<Option<(u64, Option<u64>)>>,
    /// The doors and people of the tick before.
    before: (Vec<DoorState>, Vec<DVec2>),
    /// Seconds of walking of all people.
    pub(crate) walked: f64,
    /// Of these, seconds of standing.
    pub(crate) waited: f64,
    /// The longest time in seconds that someone walked without coming half a metre far.
    pub(crate) longest: f64,
    /// The same where a path away was free all the time, and no leaf in front of the person.
    pub(crate) stuck: f64,
    /// Seconds in which people stood since they found no goal, and the longest such time of one.
    pub(crate) without_goal: (f64, f64),
    /// The greatest overlap of a person with anything in metres, and with what: at ticks, and with leaves also between
    /// them.
    pub(crate) overlap: (f64, String),
}

impl Watch {
    /// Looks at everyone; to be called after every tick.
    pub(crate) fn look(&mut self, state: &ScenarioState, robots: &[Robot]) {
        let people = state.people();
        self.anchors.resize(people.len(), (DVec2::INFINITY, 0, 0));
        self.standing.resize(people.len(), None);
        self.look_between_ticks(state);
        let moved = self.moved_doors(state);
        let positions = people.iter().map(|person| person.position).collect();
        let (_, before) = std::mem::replace(&mut self.before, (state.doors().to_vec(), positions));
        for (i, person) in people.iter().enumerate() {
            let p = person.position;
            // Where neither the person nor a leaf moved, solids and leaves are as far as they were.
            let rests =
                before.get(i) == Some(&p) && moved.iter().all(|door| door.distance(p) > LEAVES);
            let mut worst = (self.overlap.0, String::new());
            let mut meet = |distance: f64, least: f64, what: &dyn Fn() -> String| {
                if least - distance > worst.0 {
                    worst = (least - distance, what());
                }
            };
            if !rests {
                state.contacts(p, PERSON_RADIUS, |contact| match contact.target {
                    Target::Person(_) => {}
                    target => {
                        meet(p.distance(contact.point), PERSON_RADIUS, &|| format!("{target:?}"));
                    }
                });
            }
            let least = 2.0 * PERSON_RADIUS;
            for (j, other) in people.iter().enumerate().skip(i + 1) {
                if p.distance_squared(other.position) < least * least {
                    meet(p.distance(other.position), least, &|| format!("person {j}"));
                }
            }
            for robot in robots {
                let least = PERSON_RADIUS + robot.radius;
                meet(p.distance(robot.position), least, &|| "a robot".to_owned());
            }
            if worst.0 > self.overlap.0 {
                let (overlap, what) = worst;
                self.overlap = (overlap, format!("person {i} and {what} at tick {}", state.tick()));
            }
            let anchor = &mut self.anchors[i];
            if !person.is_walking() || p.distance(anchor.0) > 0.5 {
                *anchor = (p, state.tick(), state.tick());
            }
            let waits = state.tick() - anchor.1;
            if waits >= ASK && waits.is_multiple_of(ASK) {
                if is_behind_leaf(state, person) || !has_free_path(state, i) {
                    anchor.2 = state.tick();
                }
                self.stuck = self.stuck.max((state.tick() - anchor.2) as f64 * 0.05);
            }
            if person.is_walking() {
                self.walked += 0.05;
                self.waited += if person.velocity.length() < 0.05 { 0.05 } else { 0.0 };
            }
            self.longest = self.longest.max((state.tick() - anchor.1) as f64 * 0.05);
            self.look_for_goal(state, i);
        }
    }

    /// Looks at the leaves that moved in the last tick, as they were on the path. Doors move before people do.
    fn look_between_ticks(&mut self, state: &ScenarioState) {
        let (doors, people) = &self.before;
        for (door, (then, now)) in doors.iter().zip(state.doors()).enumerate() {
            if then.openness == now.openness {
                continue;
            }
            for (i, &p) in people.iter().enumerate() {
                if state.doorway_middle(door).distance(p) > LEAVES {
                    continue;
                }
                for look in 1..=LOOKS {
                    let share = f64::from(look) / f64::from(LOOKS);
                    let openness = then.openness + share * (now.openness - then.openness);
                    let gaps =
                        state.leaves_at(door, openness).map(|l| l.nearest_point(p).distance(p));
                    let overlap = PERSON_RADIUS - gaps.fold(f64::INFINITY, f64::min);
                    if overlap > self.overlap.0 {
                        let tick = state.tick();
                        let what = format!("person {i} and door {door} before tick {tick}");
                        self.overlap = (overlap, what);
                    }
                }
            }
        }
    }

    /// The middles of the doors whose leaves moved in the last tick.
    fn moved_doors(&self, state: &ScenarioState) -> Vec<DVec2> {
        let doors = self.before.0.iter().zip(state.doors()).enumerate();
        let moved = doors.filter(|(_, (then, now))| then.openness != now.openness);
        moved.map(|(door, _)| state.doorway_middle(door)).collect()
    }

    /// Counts the time in which a person finds no goal: the person draws one, and waits again.
    fn look_for_goal(&mut self, state: &ScenarioState, i: usize) {
        let (person, tick) = (&state.people()[i], state.tick());
        if person.is_walking() || person.is_reacting() {
            self.standing[i] = None;
        } else if tick.is_multiple_of(ASK) {
            let draws = serde_json::to_value(person).ok();
            let draws = draws.and_then(|person| person["draws"].as_u64()).expect("a number");
            let since = match self.standing[i] {
                Some((before, since)) if before != draws => {
                    let since = since.unwrap_or(tick - ASK);
                    self.without_goal.0 += ASK as f64 * 0.05;
                    self.without_goal.1 = self.without_goal.1.max((tick - since) as f64 * 0.05);
                    Some(since)
                }
                _ => None,
            };
            self.standing[i] = Some((draws, since));
        }
    }
}

/// Whether a leaf of a door that is not fully open is between a person and the next corner of the path.
fn is_behind_leaf(state: &ScenarioState, person: &PersonState) -> bool {
    let p = person.position;
    let Some(to) = person.path().last().map(|corner| corner - p) else { return false };
    let is_not_open = |door: &usize| state.doors()[*door].openness < 1.0;
    let doors = (0..state.doors().len()).filter(is_not_open);
    doors.flat_map(|door| state.leaves(door)).any(|leaf| {
        leaf.distance_along(p, to.normalize_or_zero()).is_some_and(|d| d <= to.length())
    })
}

/// Whether a person could walk away between all others and the leaves of doors as they are now.
fn has_free_path(state: &ScenarioState, person: usize) -> bool {
    let start = state.people()[person].position;
    let fits = |p: DVec2| {
        let mut fits = true;
        state.contacts(p, PERSON_RADIUS - TOUCH, |contact| {
            fits &= contact.target == Target::Person(person as u32);
        });
        fits
    };
    let mut seen = vec![false; (2 * WINDOW + 1) * (2 * WINDOW + 1)];
    let index = |right: isize, up: isize| {
        let at = |steps: isize| (WINDOW as isize + steps) as usize;
        at(up) * (2 * WINDOW + 1) + at(right)
    };
    seen[index(0, 0)] = true;
    // The farthest cells first: most free paths are short.
    let mut queue = BinaryHeap::from([(0, 0, 0)]);
    while let Some((_, right, up)) = queue.pop() {
        for (right, up) in [(right + 1, up), (right - 1, up), (right, up + 1), (right, up - 1)] {
            let to = CELL * DVec2::new(right as f64, up as f64);
            if std::mem::replace(&mut seen[index(right, up)], true) || !fits(start + to) {
                continue;
            }
            if to.length() >= AWAY {
                return true;
            }
            queue.push((right * right + up * up, right, up));
        }
    }
    false
}
