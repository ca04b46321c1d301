//! People who are held up by others, and people who hold up doors.

use std::f64::consts::TAU;

use glam::DVec2;

use super::crowd::{Crowd, DECIDE};
use super::door_passage::OFF_SWINGS;
use super::free_path::{Blockers, free_path};
use super::places::ROOMY;
use super::surroundings::Surroundings;
use crate::geometry::{segments_cross, unit_vector};
use crate::scenario::person::{PersonState, Task};
use crate::scenario::{PERSON_RADIUS, TICKS_PER_SECOND};

/// The number of goals that a person must give up without moving by more than this many metres, before the person
/// looks for a path between the others.
const HELD_UP: u32 = 3;
const HELD_UP_WITHIN: f64 = 0.5;

/// The distance in metres that people go aside who find no place, and the distance that those step back who find no
/// room there.
const ASIDE: f64 = 2.0;
const STEP_BACK: f64 = 1.0;

/// The number of goals that a person must give up at a place before the person shuffles every other second, and the
/// greatest speed of shuffling in m/s. Discs can block each other between walls permanently, and small random steps
/// free them.
const JAMMED: u32 = 10;
const SHUFFLE: f64 = 0.3;

/// The distance in metres within which people notice others who are held up, and the number of ticks between such
/// checks.
pub(super) const JAM: f64 = 1.5;
const NOTICE: u64 = 10;

/// The distance in metres beyond which blockers are left out.
const BLOCKERS: f64 = 6.0;

impl PersonState {
    /// Whether the person gave up several goals at some place, and reached no goal since.
    pub(super) fn was_held_up(&self) -> bool {
        self.held_up.1 >= HELD_UP
    }

    /// Whether the person gave up several goals at the current place.
    fn is_held_up(&self) -> bool {
        let p = self.held_up.0;
        self.was_held_up() && p.distance_squared(self.position) < HELD_UP_WITHIN * HELD_UP_WITHIN
    }
}

impl Crowd {
    /// Whether a person who is not held up comes to others who are, and would only shut them in. It is checked at
    /// intervals.
    pub(super) fn comes_to_jam(&self, i: usize, around: &Surroundings<'_>) -> bool {
        if !(around.tick + i as u64).is_multiple_of(NOTICE) || self.people[i].is_held_up() {
            return false;
        }
        let (p, velocity) = (self.people[i].position, self.people[i].velocity);
        self.others_near(i).any(|other| {
            let to = other.position - p;
            other.is_held_up() && to.length_squared() < JAM * JAM && to.dot(velocity) > 0.0
        })
    }

    /// Returns the velocity of a person who shuffles, as people do whom others hold up for a long time.
    pub(super) fn shuffle(&self, i: usize, around: &Surroundings<'_>) -> Option<DVec2> {
        let person = &self.people[i];
        let (second, number) = (around.tick / TICKS_PER_SECOND, i as u64);
        let is_time = (second + number).is_multiple_of(2);
        let is_jammed = person.is_walking() && person.held_up.1 >= JAMMED && person.is_held_up();
        (is_time && is_jammed).then(|| {
            let mut stream = around.seed.attempt("scenario/people/shuffle", number, second);
            SHUFFLE.min(around.people[i].speed) * unit_vector(TAU * stream.unit())
        })
    }

    /// Records that a person is blocked; returns whether the person is held up now.
    pub(super) fn note_block(&mut self, i: usize) -> bool {
        let person = &mut self.people[i];
        let (p, times) = person.held_up;
        let is_here = p.distance_squared(person.position) < HELD_UP_WITHIN * HELD_UP_WITHIN;
        person.held_up = if is_here { (p, times + 1) } else { (person.position, 1) };
        person.is_held_up()
    }

    /// Sends a person to the nearest free place to which a path between all others leads; if there are no such
    /// places, aside; and if there is no room, a step back. Returns whether a path leads away.
    pub(super) fn leave_between_others(&mut self, i: usize, around: &Surroundings<'_>) -> bool {
        let Surroundings { space, routes, door_zones, .. } = *around;
        let from = self.people[i].position;
        let mut places: Vec<(usize, usize)> = routes
            .around(space, from)
            .filter(|&(place, p)| {
                let distance2 = p.distance_squared(from);
                self.taken[place] == 0 && (1.0..=BLOCKERS * BLOCKERS).contains(&distance2)
            })
            .filter_map(|(place, p)| Some((space.frame.index_at(p)?, place)))
            .collect();
        places.sort_unstable();
        let place_of = |cell: usize| {
            let found = places.binary_search_by_key(&cell, |&(cell, _)| cell);
            found.ok().map(|i| places[i].1)
        };
        let blockers = self.blockers(i, around);
        let to_place = free_path(space, from, &blockers, |cell| place_of(cell).is_some());
        // Nobody goes where only a gap leads that is too narrow for paths: no path would lead away again.
        let goal = self.people[i].place.map(|place| place as usize);
        let leads_on = |p: DVec2| goal.is_none_or(|goal| routes.begins_near(space, p, goal));
        let aside = |least: f64, is_fit: &dyn Fn(usize) -> bool| {
            free_path(space, from, &blockers, |cell| {
                let p = space.frame.center_of(cell);
                p.distance_squared(from) >= least * least && is_fit(cell) && leads_on(p)
            })
        };
        let is_off_doors = |cell| door_zones.of(cell).is_empty();
        let is_roomy = |cell| space.cell_clearance(cell) >= ROOMY && is_off_doors(cell);
        let found = to_place
            .or_else(|| aside(ASIDE, &is_roomy))
            .or_else(|| aside(STEP_BACK, &is_off_doors))
            .or_else(|| aside(STEP_BACK, &|_| true));
        let Some((cell, path)) = found else { return false };
        let person = &mut self.people[i];
        person.draws += 1;
        person.moved = (from, around.tick);
        person.steps_left = 0;
        match place_of(cell) {
            Some(place) => self.walk(i, place as u32, path),
            None => {
                (person.path, person.on_path) = (path, true);
                person.task = Task::Walk;
                self.forget_wish(i);
            }
        }
        true
    }

    fn others_near(&self, i: usize) -> impl Iterator<Item = &PersonState> {
        self.near.of(i).iter().map(|other| &self.people[other.person as usize])
    }

    /// Returns everything near a person that may move.
    fn blockers(&self, i: usize, around: &Surroundings<'_>) -> Blockers {
        let p = self.people[i].position;
        let others = self.others_near(i).map(|other| other.position);
        let robots =
            around.robots.iter().map(|robot| (robot.position, robot.radius + PERSON_RADIUS));
        let doors = around.shapes.iter().zip(around.doors);
        let near_doors = doors.filter(|(shape, _)| shape.middle().distance(p) < BLOCKERS);
        Blockers {
            discs: others.map(|other| (other, 2.0 * PERSON_RADIUS)).chain(robots).collect(),
            leaves: near_doors.flat_map(|(shape, state)| state.leaves(shape)).collect(),
        }
    }

    /// Returns the door that cannot swing open because of a person, unless the person leaves in any case.
    pub(super) fn blocks_door(&self, i: usize, around: &Surroundings<'_>) -> Option<usize> {
        let person = &self.people[i];
        let blocks = |door: &usize| {
            let (shape, state) = (&around.shapes[*door], &around.doors[*door]);
            let leaves = |&corner: &DVec2| {
                let [a, b] = shape.ends;
                shape.swing_distance(corner) >= OFF_SWINGS
                    && !segments_cross(person.position, corner, a, b)
            };
            shape.swings()
                && state.opens
                && !state.is_open()
                && shape.swing_distance(person.position) < OFF_SWINGS
                && !person.path.last().is_some_and(leaves)
        };
        self.zone(i, person.position, around).iter().map(|&door| door as usize).find(blocks)
    }

    /// Returns the point to which a person steps aside for a door.
    pub(super) fn aside(
        &mut self,
        i: usize,
        door: usize,
        around: &Surroundings<'_>,
    ) -> Option<DVec2> {
        let person = &self.people[i];
        let is_stopped = person.velocity == DVec2::ZERO;
        let shape = &around.shapes[door];
        let is_valid = |aside: DVec2| aside.distance_squared(person.position) > 1e-18;
        // In every second stretch of `DECIDE` ticks: who is stopped is asked once in a stretch.
        let is_time = (around.tick / DECIDE + i as u64).is_multiple_of(2);
        if is_time && (is_stopped || !person.aside.is_some_and(is_valid)) {
            let path =
                free_path(around.space, person.position, &self.blockers(i, around), |cell| {
                    around.space.is_free(cell)
                        && shape.swing_distance(around.space.frame.center_of(cell)) >= OFF_SWINGS
                });
            self.people[i].aside = path.and_then(|(_, path)| path.last().copied());
        }
        self.people[i].aside
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::indoor::IndoorSpec;
    use crate::scenario::tick::TICK;
    use crate::scenario::{DoorKinds, Scenario, ScenarioSpec, ScenarioState};
    use crate::{Blueprint, Seed, Spec};

    #[test]
    fn who_steps_aside_for_a_door_goes_straight_there() {
        let mut steps = 0;
        for seed in 1..=20 {
            let world = IndoorSpec::default().generate(Seed(seed)).unwrap().to_world();
            let spec = ScenarioSpec {
                people: 6,
                doors: 1.0,
                door_kind: DoorKinds::Hinged,
                door_open: 4.0,
                door_closed: 4.0,
                waiting: 1.0,
                working: 1.0,
                ..Default::default()
            };
            let scenario = Scenario::new(&world, &spec, Seed(seed)).unwrap();
            let mut state = ScenarioState::new(&world, &scenario).unwrap();
            for _ in 0..20 * 600 {
                let before = state.people().to_vec();
                state.step(TICK, &[]).unwrap();
                for (i, (then, now)) in before.iter().zip(state.people()).enumerate() {
                    let (Some(aside), true) = (then.aside, then.aside == now.aside) else {
                        continue;
                    };
                    let is_alone = state.crowd.near.of(i).is_empty();
                    if is_alone && now.is_walking() && now.velocity != DVec2::ZERO {
                        let [left, was] = [now, then].map(|one| one.position.distance(aside));
                        assert!(left < was, "seed {seed}: {left} after {was} m");
                        steps += 1;
                    }
                }
            }
        }
        assert!(steps > 100, "{steps} steps aside");
    }
}
