//! A step of all people.

use glam::DVec2;

use super::door_passage::passes_door;
use super::orca::{Disc, HalfPlane, WALL_HORIZON, avoid, keep_off, solve};
use super::surroundings::{Surroundings, nearest_robot, sees, zone};
use crate::scenario::neighbourhood::{Neighbourhood, RANGE, REBUILD};
use crate::scenario::person::{MAX_CURIOUS, Person, PersonState, Reaction, Task};
use crate::scenario::{PERSON_RADIUS, ScenarioSpec, TICK, TICKS_PER_SECOND};
use crate::seed::Seed;

/// The most neighbours that a person avoids: the nearest.
const MAX_NEIGHBOURS: usize = 10;

/// People keep a little to the right of those they meet: the tangent of the angle by which they turn.
const KEEP_RIGHT: f64 = 0.06;

/// Someone who comes no farther than this many metres within [`PATIENCE`] ticks goes elsewhere.
const PROGRESS: f64 = 0.4;
const PATIENCE: u64 = 3 * TICKS_PER_SECOND;

/// Someone who left the path looks for it again after this many ticks.
pub(super) const LOOK: u64 = 4;

/// Someone who does not see it searches for a new path after this many ticks.
const SEARCH: u64 = TICKS_PER_SECOND;

/// How many goals are tried before a person waits a second, and how many by one who is blocked and looks for
/// one that is not ahead.
const TRIES: u32 = 8;
const BLOCKED_TRIES: u32 = 32;

/// All people.
#[derive(Clone, Debug)]
pub(crate) struct Crowd {
    pub(crate) people: Vec<PersonState>,
    pub(crate) near: Neighbourhood,
    /// How many people go to each place, or are there.
    pub(super) taken: Vec<u32>,
    wishes: Vec<Wish>,
    planes: Vec<HalfPlane>,
}

/// The velocity that a person takes if nothing is in front of it.
#[derive(Clone, Copy, Debug)]
struct Wish {
    velocity: DVec2,
    /// Whether it leads along the path, where there are no solids.
    is_clear: bool,
    /// Whether nobody can be met in this step.
    is_calm: bool,
}

impl Wish {
    const STAND: Wish = Wish { velocity: DVec2::ZERO, is_clear: true, is_calm: true };
}

impl Crowd {
    pub(crate) fn new(
        people: &[Person],
        places: usize,
        (spec, seed): (&ScenarioSpec, Seed),
        near: Neighbourhood,
    ) -> Self {
        let state = |(i, person)| {
            let mut stream = seed.stream("scenario/people/first", i);
            PersonState::new(person, ticks(-spec.waiting * libm::log1p(-stream.unit())))
        };
        let people: Vec<PersonState> = (0_u64..).zip(people).map(state).collect();
        let wishes = vec![Wish::STAND; people.len()];
        let mut crowd = Crowd { people, near, taken: vec![0; places], wishes, planes: Vec::new() };
        crowd.near.rebuild(&crowd.people);
        crowd
    }

    pub(crate) fn step(&mut self, around: &Surroundings<'_>) {
        if around.tick.is_multiple_of(REBUILD) {
            self.near.rebuild(&self.people);
        }
        for i in 0..self.people.len() {
            self.choose(i, around);
        }
        // All wish before anyone moves, so that none is better informed than another.
        for i in 0..self.people.len() {
            self.wishes[i] = self.wish(i, around);
        }
        for i in 0..self.people.len() {
            if self.wishes[i].velocity == DVec2::ZERO {
                self.people[i].velocity = DVec2::ZERO;
            } else {
                self.follow(i, around);
            }
        }
    }

    /// Decides what a person does.
    fn choose(&mut self, i: usize, around: &Surroundings<'_>) {
        if !around.robots.is_empty() && self.react(i, around) {
            return;
        }
        let person = &self.people[i];
        match person.task {
            Task::Stand { until } | Task::React { until } if around.tick >= until => {
                self.depart(i, false, around);
            }
            Task::Walk
                if around.tick - person.moved.1 > patience(i, person.draws)
                    || self.comes_to_jam(i, around) =>
            {
                let leaves = self.note_block(i) && self.leave_between_others(i, around);
                if !leaves {
                    self.depart(i, true, around);
                }
            }
            _ => {}
        }
    }

    /// Starts and ends reactions; whether the person reacts.
    fn react(&mut self, i: usize, around: &Surroundings<'_>) -> bool {
        let Some((range, seconds)) = around.people[i].reaction.trigger() else { return false };
        let person = &mut self.people[i];
        if let Task::React { until } = person.task {
            return around.tick < until;
        }
        let nearest = nearest_robot(person.position, around.robots);
        let to = nearest.position - person.position;
        let distance = to.length();
        if distance > 1.5 * range {
            person.is_used_to_robot = false;
        }
        if person.is_used_to_robot || distance >= range || !sees(around.rays, person.position, to) {
            return false;
        }
        person.is_used_to_robot = true;
        person.task = Task::React { until: around.tick + ticks(seconds) };
        person.path.clear();
        person.on_path = false;
        if let Some(place) = person.place.take() {
            self.taken[place as usize] -= 1;
        }
        true
    }

    /// Sends a person to a new place; one who is blocked at first not ahead.
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
            None => person.task = Task::Stand { until: around.tick + TICKS_PER_SECOND },
        }
    }

    /// Lets a person walk to a place.
    pub(super) fn walk(&mut self, i: usize, place: u32, path: Vec<DVec2>) {
        let person = &mut self.people[i];
        if let Some(old) = person.place.replace(place) {
            self.taken[old as usize] -= 1;
        }
        self.taken[place as usize] += 1;
        person.path = path;
        person.on_path = true;
        person.task = Task::Walk;
    }

    /// The velocity that a person wishes to have.
    fn wish(&mut self, i: usize, around: &Surroundings<'_>) -> Wish {
        let person = &self.people[i];
        let is_calm = around.tick < person.calm_until && around.robots.is_empty();
        if is_calm && person.steps_left > 0 && person.task == Task::Walk {
            return Wish { velocity: person.velocity, is_clear: true, is_calm: true };
        }
        let (mut preferred, max_speed) = match person.task {
            Task::Stand { .. } => return Wish::STAND,
            Task::Walk => {
                let Some(&corner) = person.path.last() else { return Wish::STAND };
                let to = corner - person.position;
                let speed = around.people[i].speed;
                (to.normalize_or_zero() * speed.min(to.length() / TICK), speed)
            }
            Task::React { .. } if around.robots.is_empty() => return Wish::STAND,
            Task::React { .. } => {
                let robot = nearest_robot(person.position, around.robots);
                let to = robot.position - person.position;
                (around.people[i].reaction.velocity(to), MAX_CURIOUS)
            }
        };
        if preferred == DVec2::ZERO {
            return Wish::STAND;
        }
        let mut is_clear = person.on_path;
        if let Some(door) = self.blocks_door(i, around) {
            is_clear = false;
            let p = person.position;
            let middle = around.shapes[door].middle();
            let away = (p - middle).normalize_or(person.facing) * max_speed;
            preferred = self.aside(i, door, around).map_or(away, |aside| {
                (aside - p).normalize_or_zero() * max_speed.min((aside - p).length() / TICK)
            });
        } else {
            self.people[i].aside = None;
        }
        self.avoiding(i, (preferred, max_speed, is_clear), around)
    }

    /// The velocity nearest to a preferred one that avoids others.
    fn avoiding(
        &mut self,
        i: usize,
        (preferred, max_speed, is_clear): (DVec2, f64, bool),
        around: &Surroundings<'_>,
    ) -> Wish {
        let person = &self.people[i];
        let p = person.position;
        let (mut nearest, mut count) = ([(f64::INFINITY, 0_u32); MAX_NEIGHBOURS], 0);
        let mut beyond = f64::INFINITY;
        for &j in self.near.of(i) {
            let distance2 = self.people[j as usize].position.distance_squared(p);
            if distance2 > RANGE * RANGE {
                beyond = beyond.min(distance2);
                continue;
            }
            let entry = (distance2, j);
            let at = nearest[..count].partition_point(|other| *other < entry);
            if at < MAX_NEIGHBOURS {
                count = (count + 1).min(MAX_NEIGHBOURS);
                nearest[at..count].rotate_right(1);
                nearest[at] = entry;
            }
        }
        let me = Disc { position: p, velocity: person.velocity, radius: PERSON_RADIUS, share: 1.0 };
        if count == 0 && around.robots.is_empty() {
            // How long nobody can come within range, at most until the lists are rebuilt.
            let ticks_left = REBUILD - around.tick % REBUILD;
            let calm = (beyond.sqrt() - RANGE) / (2.0 * around.max_speed * TICK);
            let calm = if calm < ticks_left as f64 { calm as u64 } else { ticks_left };
            self.people[i].calm_until = around.tick + calm;
            return Wish { velocity: preferred, is_clear, is_calm: true };
        }
        let planes = &mut self.planes;
        planes.clear();
        let disc = |j: u32| {
            let other = &self.people[j as usize];
            let share = if other.task == Task::Walk { 1.0 } else { 0.0 };
            Disc {
                position: other.position,
                velocity: other.velocity,
                radius: PERSON_RADIUS,
                share,
            }
        };
        for &(_, j) in &nearest[..count] {
            let plane = avoid(&me, &disc(j), TICK);
            // Those behind a wall are not avoided, which matters only where they would be.
            let to = self.people[j as usize].position - p;
            if plane.excess(preferred) <= 0.0 || sees(around.rays, p, to) {
                planes.push(plane);
            }
        }
        for robot in around.robots {
            if robot.position.distance_squared(p) > RANGE * RANGE {
                continue;
            }
            let share = match around.people[i].reaction {
                Reaction::Regular => 1.0,
                _ => 0.0,
            };
            let disc = Disc {
                position: robot.position,
                velocity: if share > 0.0 { robot.velocity } else { DVec2::ZERO },
                radius: robot.radius,
                share,
            };
            planes.push(avoid(&me, &disc, TICK));
        }
        if planes.iter().all(|plane| plane.excess(preferred) <= 0.0) {
            return Wish { velocity: preferred, is_clear, is_calm: false };
        }
        let reach = PERSON_RADIUS + max_speed * WALL_HORIZON;
        let before = planes.len();
        around.space.index.contacts(p, reach, |contact| {
            let plane = keep_off(p, PERSON_RADIUS, contact.point);
            if planes.len() < before + 4 * MAX_NEIGHBOURS {
                planes.push(plane);
            }
        });
        for &door in zone(around, p) {
            let (shape, state) = (&around.shapes[door as usize], &around.doors[door as usize]);
            planes.extend(
                state.leaves(shape).map(|leaf| keep_off(p, PERSON_RADIUS, leaf.nearest_point(p))),
            );
        }
        // Walls first: they must hold.
        let walls = planes.len() - before;
        planes.rotate_left(before);
        let turned = preferred - preferred.perp() * KEEP_RIGHT;
        let velocity = solve(planes, walls, max_speed, turned);
        Wish { velocity, is_clear: false, is_calm: false }
    }

    /// Moves a person as wished, as far as that is possible.
    fn follow(&mut self, i: usize, around: &Surroundings<'_>) {
        let Wish { velocity, is_clear, is_calm } = self.wishes[i];
        let person = &self.people[i];
        let from = person.position;
        let to = from + velocity * TICK;
        if is_calm && is_clear && zone(around, to).is_empty() {
            let person = &mut self.people[i];
            person.position = to;
            person.moved.1 = around.tick;
            if person.steps_left > 0 {
                person.steps_left -= 1;
            } else {
                self.turn(i, velocity, around);
            }
            return;
        }
        let allowed = |(velocity, is_clear): (DVec2, bool)| {
            let is_allowed = velocity != DVec2::ZERO
                && (is_clear || around.space.fits(from + velocity * TICK))
                && self.is_passable(i, from, from + velocity * TICK, around);
            is_allowed.then_some((velocity, is_clear))
        };
        let allowed = allowed((velocity, is_clear))
            .or_else(|| allowed((self.along_wall(from, velocity, around), false)))
            .or_else(|| allowed((0.5 * velocity, is_clear)));
        let person = &mut self.people[i];
        person.steps_left = 0;
        match allowed {
            Some((velocity, is_clear)) => {
                person.position = from + velocity * TICK;
                person.on_path &= is_clear;
                if person.position.distance_squared(person.moved.0) > PROGRESS * PROGRESS {
                    person.moved = (person.position, around.tick);
                }
                self.turn(i, velocity, around);
                self.people[i].steps_left = 0;
            }
            None => person.velocity = DVec2::ZERO,
        }
    }

    /// Sets the velocity of a person who moved, and what follows from the new position.
    fn turn(&mut self, i: usize, velocity: DVec2, around: &Surroundings<'_>) {
        let person = &mut self.people[i];
        person.velocity = velocity;
        person.facing = velocity.normalize_or(person.facing);
        if person.task != Task::Walk {
            return;
        }
        let Some(&corner) = person.path.last() else { return };
        let left = corner.distance(person.position);
        if left < 1e-9 || (!person.on_path && left < 0.5 * PERSON_RADIUS && person.path.len() == 1)
        {
            person.path.pop();
            person.moved = (person.position, around.tick);
            if person.path.is_empty() {
                person.velocity = DVec2::ZERO;
                person.on_path = false;
                let mut stream =
                    around.seed.attempt("scenario/people/stay", i as u64, person.draws);
                let is_work = person.draws.is_multiple_of(2);
                let mean = if is_work { around.spec.working } else { around.spec.waiting };
                let stay = ticks(-mean * libm::log1p(-stream.unit()));
                person.held_up.1 = 0;
                person.task = Task::Stand { until: around.tick + stay };
            }
        } else if person.on_path {
            let step = velocity.length() * TICK;
            // The last step to a corner is a shorter one.
            person.steps_left = (left / step - 1e-6).max(0.0) as u32;
        } else if (around.tick + i as u64).is_multiple_of(LOOK) {
            let p = person.position;
            // The farthest of the next corners that is in sight.
            let corners = person.path.len();
            let first = corners.saturating_sub(3);
            match (first..corners).find(|&k| around.space.is_clear_from(p, person.path[k])) {
                Some(k) => {
                    person.path.truncate(k + 1);
                    person.on_path = true;
                }
                None if (around.tick + i as u64).is_multiple_of(SEARCH) => self.search(i, around),
                None => {}
            }
        }
    }

    /// Finds a new path to the same place, for a person who lost sight of the old one.
    fn search(&mut self, i: usize, around: &Surroundings<'_>) {
        let person = &mut self.people[i];
        let Some(place) = person.place else { return };
        if let Some(path) = around.routes.path(around.space, person.position, place as usize) {
            person.path = path;
            person.on_path = true;
        }
    }

    /// A velocity without its part towards the nearest wall.
    fn along_wall(&self, p: DVec2, velocity: DVec2, around: &Surroundings<'_>) -> DVec2 {
        match around.space.index.nearest(p) {
            Some(contact) if contact.distance > 0.0 => {
                let normal = (contact.point - p) / contact.distance;
                velocity - normal * velocity.dot(normal).max(0.0)
            }
            _ => DVec2::ZERO,
        }
    }

    /// Whether a step touches no leaf, person or robot, or at least leads away from those that it touches.
    fn is_passable(&self, i: usize, from: DVec2, to: DVec2, around: &Surroundings<'_>) -> bool {
        let is_apart = |p: DVec2, least: f64| {
            let distance2 = to.distance_squared(p);
            distance2 >= least * least || distance2 > from.distance_squared(p)
        };
        let mut doors = zone(around, to).iter().map(|&door| door as usize);
        self.near
            .of(i)
            .iter()
            .all(|&j| is_apart(self.people[j as usize].position, 2.0 * PERSON_RADIUS))
            && around
                .robots
                .iter()
                .all(|robot| is_apart(robot.position, PERSON_RADIUS + robot.radius))
            && doors.all(|door| {
                let (shape, state) = (&around.shapes[door], &around.doors[door]);
                let corner = self.people[i].path.last().copied();
                passes_door(shape, state, (from, to), corner)
            })
    }
}

/// The whole ticks of a time in seconds, at least one.
fn ticks(seconds: f64) -> u64 {
    ((seconds * TICKS_PER_SECOND as f64).round() as u64).max(1)
}

/// How many ticks a person waits for others to move aside: not all equally long, so that one of two gives in.
fn patience(i: usize, draws: u64) -> u64 {
    PATIENCE + (7 * i as u64 + 13 * draws) % PATIENCE
}
