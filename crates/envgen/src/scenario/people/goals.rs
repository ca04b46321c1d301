//! The choice of the places to which people go, and of the time when they change their goal.

use glam::DVec2;

use super::crowd::{Crowd, ticks};
use super::surroundings::{Surroundings, nearest_robot};
use crate::scenario::TICKS_PER_SECOND;
use crate::scenario::person::{PersonState, Reaction, Task};
use crate::scenario::robot::Robot;

/// The progress that a person must make within [`PATIENCE`] ticks, or else goes elsewhere: this distance in metres,
/// or a walk of so many seconds.
const PROGRESS: f64 = 0.4;
const PROGRESS_TIME: f64 = 1.5;
const PATIENCE: u64 = 3 * TICKS_PER_SECOND;

/// The number of goals that are tried before a person waits a second, and the number for a person who is blocked
/// and looks for a goal that is not ahead.
const TRIES: u32 = 8;
const BLOCKED_TRIES: u32 = 32;

impl Crowd {
    /// Decides what a person does.
    pub(super) fn choose(&mut self, i: usize, around: &Surroundings<'_>) {
        if !around.robots.is_empty() && self.react(i, around) {
            return;
        }
        let person = &self.people[i];
        match person.task {
            Task::Stand { until } | Task::React { until } if around.tick >= until => {
                self.depart(i, false, around);
            }
            Task::Walk if is_impatient(i, person, around.tick) || self.comes_to_jam(i, around) => {
                let is_held_up = self.note_block(i);
                self.disturb_others(i, around.tick);
                if !(is_held_up && self.leave_between_others(i, around)) {
                    self.depart(i, true, around);
                }
            }
            Task::Walk => {}
            Task::Stand { until } | Task::React { until } => self.rest(i, until, around),
        }
    }

    /// Starts and ends reactions; returns whether the person reacts.
    fn react(&mut self, i: usize, around: &Surroundings<'_>) -> bool {
        let reaction = around.people[i].reaction;
        let Some((range, seconds)) = reaction.trigger() else { return false };
        let person = &mut self.people[i];
        let look = |person: &mut PersonState, robot: Robot| {
            if reaction == Reaction::Surprised {
                let to = robot.position - person.position;
                person.facing = to.normalize_or(person.facing);
            }
        };
        if let Task::React { until } = person.task {
            let reacts = around.tick < until;
            if reacts {
                look(person, around.noticed_robot(person.position));
            }
            return reacts;
        }
        let nearest = nearest_robot(person.position, around.robots);
        if nearest.position.distance(person.position) > 1.5 * range {
            person.is_used_to_robot = false;
        }
        if person.is_used_to_robot {
            return false;
        }
        let Some(robot) = around.seen_robot(person.position, range) else { return false };
        look(person, robot);
        person.is_used_to_robot = true;
        person.task = Task::React { until: around.tick + ticks(seconds) };
        person.path.clear();
        person.on_path = false;
        person.steps_left = 0;
        if let Some(place) = person.place.take() {
            self.taken[place as usize] -= 1;
        }
        true
    }

    /// Sends a person to a new place. A blocked person first tries places that are not ahead.
    fn depart(&mut self, i: usize, is_blocked: bool, around: &Surroundings<'_>) {
        let person = &mut self.people[i];
        let number = i as u64;
        let mut stream = around.seed.attempt("scenario/people/goal", number, person.draws);
        person.draws += 1;
        person.moved = (person.position, around.tick);
        person.steps_left = 0;
        // Who hardly moves may look anywhere: the path tells what is ahead.
        let ahead = person.path.last().map_or(person.facing, |corner| *corner - person.position);
        let is_free = |&(place, p): &(usize, DVec2)| {
            self.taken[place] == 0 && p.distance_squared(person.position) >= 1.0
        };
        let places: Vec<usize> = around
            .routes
            .around(around.space, person.position)
            .filter(is_free)
            .map(|(place, _)| place)
            .collect();
        let mut found = None;
        let tries = if is_blocked { BLOCKED_TRIES } else { TRIES };
        for attempt in 0..tries {
            if places.is_empty() {
                break;
            }
            let place = places[stream.below(places.len() as u64) as usize];
            // At first only places that lie behind who is blocked.
            if is_blocked && attempt < tries - 1 {
                let direction = around.routes.direction(around.space, person.position, place);
                if direction.is_some_and(|direction| direction.dot(ahead) > 0.0) {
                    continue;
                }
            }
            found = around
                .routes
                .path(around.space, person.position, place)
                .map(|path| (place as u32, path));
            if found.is_some() {
                break;
            }
        }
        match found {
            Some((place, path)) => self.walk(i, place, path),
            None if is_blocked => {}
            // Who was pushed to where no path begins gets away as those do whom others hold up.
            None if !places.is_empty() && self.leave_between_others(i, around) => {}
            None => self.people[i].task = Task::Stand { until: around.tick + TICKS_PER_SECOND },
        }
    }

    /// Makes a person walk to a place.
    pub(super) fn walk(&mut self, i: usize, place: u32, path: Vec<DVec2>) {
        let person = &mut self.people[i];
        if let Some(old) = person.place.replace(place) {
            self.taken[old as usize] -= 1;
        }
        self.taken[place as usize] += 1;
        person.path = path;
        person.on_path = true;
        person.task = Task::Walk;
        self.forget_wish(i);
    }
}

impl PersonState {
    /// Records where and when a person who walks at a speed last made progress.
    pub(super) fn note_progress(&mut self, speed: f64, tick: u64) {
        let progress = PROGRESS.min(PROGRESS_TIME * speed);
        if self.position.distance_squared(self.moved.0) > progress * progress {
            self.moved = (self.position, tick);
        }
    }
}

/// Returns the tick from which a person has waited long enough for others to move aside. The time differs between
/// people, so that one of two gives in.
pub(super) fn impatient_from(i: usize, person: &PersonState) -> u64 {
    person.moved.1 + PATIENCE + (7 * i as u64 + 13 * person.draws) % PATIENCE + 1
}

/// Whether a person has waited that long. Most people have not waited for the shortest time, which is tested first.
fn is_impatient(i: usize, person: &PersonState, tick: u64) -> bool {
    tick - person.moved.1 > PATIENCE && tick >= impatient_from(i, person)
}
