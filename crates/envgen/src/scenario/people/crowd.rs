//! The step of all people.

use glam::DVec2;

use super::door_passage::passes_door;
use super::orca::{Disc, HalfPlane, WALL_HORIZON, avoid, keep_off, solve};
use super::sights::Sights;
use super::surroundings::Surroundings;
use crate::scenario::ScenarioSpec;
use crate::scenario::doors::DoorState;
use crate::scenario::neighbourhood::{Neighbour, Neighbourhood, RANGE, REBUILD};
use crate::scenario::person::{PERSON_RADIUS, Person, PersonState, Reaction, Task};
use crate::scenario::tick::{TICK, TICKS_PER_SECOND};
use crate::seed::Seed;

/// The number of ticks between decisions on a velocity. People decide in every tick at corners of their paths,
/// while they step aside freely, and where they slid along a wall. Between decisions, they stop before they would
/// touch something.
pub(super) const DECIDE: u64 = 5;

/// The greatest number of neighbours that a person avoids, which are the nearest ones.
const MAX_NEIGHBOURS: usize = 10;

/// The tangent of the angle by which people turn to the right of those they meet.
const KEEP_RIGHT: f64 = 0.06;

/// The number of ticks after which a person who left the path looks for it again.
const LOOK: u64 = 4;

/// The number of ticks after which a person who does not see the path searches for a new one.
const SEARCH: u64 = TICKS_PER_SECOND;

/// The distance in metres within which the next corner is not enough for a person who left the path: the person
/// looks at further corners, too.
const NEAR_CORNER: f64 = 1.0;

/// An upper bound, in metres, of the rounding error of a distance.
pub(super) const ROUNDING: f64 = 1e-6;

/// All people.
#[derive(Clone, Debug)]
pub(crate) struct Crowd {
    pub(crate) people: Vec<PersonState>,
    pub(crate) near: Neighbourhood,
    /// Number of people who go to each place, or are there.
    pub(super) taken: Vec<u32>,
    /// The tick until which each person needs no decision; see the module `quiet`.
    pub(super) quiet_until: Vec<u64>,
    /// For each person, whether the person can come near a door before the lists of neighbours are rebuilt.
    comes_near_doors: Vec<bool>,
    pub(super) sights: Sights,
    wishes: Vec<Wish>,
    planes: Vec<HalfPlane>,
    /// The people who are looked at in a tick.
    awake: Vec<u32>,
}

/// The velocity that a person takes if nothing is in front of the person.
#[derive(Clone, Copy, Debug)]
struct Wish {
    velocity: DVec2,
    /// Whether nobody has to be avoided.
    is_free: bool,
    /// Whether the velocity leads along the path, on which there are no solids.
    is_clear: bool,
    /// The distance in metres that the person can walk in any direction without touching a solid, if it is known.
    room: f64,
    /// Whether nobody can be touched until the next decision.
    is_apart: bool,
}

impl Wish {
    const STAND: Wish =
        Wish { velocity: DVec2::ZERO, is_free: true, is_clear: true, room: 0.0, is_apart: false };
}

impl Crowd {
    pub(crate) fn new(
        people: &[Person],
        places: usize,
        (spec, seed): (&ScenarioSpec, Seed),
        near: Neighbourhood,
        doors: &[DoorState],
    ) -> Self {
        let state = |(i, person)| {
            let mut stream = seed.stream("scenario/people/first", i);
            PersonState::new(person, ticks(-spec.waiting * libm::log1p(-stream.unit())))
        };
        let people: Vec<PersonState> = (0_u64..).zip(people).map(state).collect();
        let wishes = vec![Wish::STAND; people.len()];
        let quiet_until = vec![0; people.len()];
        let taken = vec![0; places];
        let comes_near_doors = vec![true; people.len()];
        let planes = Vec::new();
        let mut crowd = Crowd {
            people,
            near,
            taken,
            quiet_until,
            comes_near_doors,
            sights: Sights::default(),
            wishes,
            planes,
            awake: Vec::new(),
        };
        crowd.find_neighbours(doors);
        crowd
    }

    pub(crate) fn step(&mut self, around: &Surroundings<'_>) {
        if around.tick.is_multiple_of(REBUILD) {
            self.find_neighbours(around.doors);
            for (near, person) in self.comes_near_doors.iter_mut().zip(&self.people) {
                *near = !around.at(around.near_doors, person.position).is_empty();
            }
        }
        if !around.robots.is_empty() {
            // Everyone looks at robots, but for those who are stopped: they look again when it is time.
            for (until, person) in self.quiet_until.iter_mut().zip(&self.people) {
                if !person.is_walking() || person.velocity != DVec2::ZERO {
                    *until = 0;
                }
            }
        }
        for i in 0..self.people.len() {
            if !self.is_quiet(i, around.tick) {
                self.choose(i, around);
            }
        }
        // All wish before anyone moves, so that none is better informed than another.
        let is_time = around.tick.is_multiple_of(DECIDE);
        let mut awake = std::mem::take(&mut self.awake);
        select(&mut awake, self.quiet_until.iter().map(|&until| until <= around.tick));
        for &i in &awake {
            let i = i as usize;
            if is_time || !self.keeps_wish(i) {
                self.wishes[i] = self.wish(i, around);
            }
        }
        let is_awake_or_moves = |(&until, person): (&u64, &PersonState)| {
            (until <= around.tick) | (person.velocity != DVec2::ZERO)
        };
        select(&mut awake, self.quiet_until.iter().zip(&self.people).map(is_awake_or_moves));
        for &i in &awake {
            let i = i as usize;
            if self.is_quiet(i, around.tick) {
                self.cruise(i, around);
                continue;
            }
            let before = self.people[i].velocity;
            if self.wishes[i].velocity == DVec2::ZERO {
                self.people[i].stop();
            } else {
                self.follow(i, around);
            }
            if self.people[i].velocity != before {
                self.disturb_others(i, around.tick + 1);
            }
            if self.people[i].is_walking() && self.people[i].velocity == DVec2::ZERO {
                // Who is stopped looks again when it is time.
                self.quiet_until[i] = (around.tick + 1).next_multiple_of(DECIDE);
            }
        }
        self.awake = awake;
    }

    /// Rebuilds the lists of neighbours.
    fn find_neighbours(&mut self, doors: &[DoorState]) {
        self.near.rebuild(&self.people);
        self.sights.restart(self.near.pair_count(), doors);
    }

    /// Whether a person keeps the velocity that was decided before; see [`DECIDE`].
    fn keeps_wish(&self, i: usize) -> bool {
        let (person, wish) = (&self.people[i], &self.wishes[i]);
        if person.task != Task::Walk {
            return false;
        }
        if person.steps_left > 0 || !wish.is_free {
            return true;
        }
        // Who walks freely beside the path decides again where its next corner is near. Who steps aside does so in every
        // tick, and so does who has a wish along the path, which is no longer known to be clear.
        let walked = wish.velocity * (TICK * DECIDE as f64);
        let is_far =
            |corner: &DVec2| corner.distance_squared(person.position) > walked.length_squared();
        !person.on_path
            && !wish.is_clear
            && person.aside.is_none()
            && walked != DVec2::ZERO
            && person.path.last().is_some_and(is_far)
    }

    /// Makes a person decide again in this tick.
    pub(super) fn forget_wish(&mut self, i: usize) {
        self.wishes[i] = Wish::STAND;
    }

    /// Returns the doors whose leaves can be near a point to which a person comes.
    #[inline]
    pub(super) fn zone<'a>(&self, i: usize, p: DVec2, around: &Surroundings<'a>) -> &'a [u32] {
        if self.comes_near_doors[i] { around.at(around.door_zones, p) } else { &[] }
    }

    /// Returns the velocity that a person wishes to have.
    fn wish(&mut self, i: usize, around: &Surroundings<'_>) -> Wish {
        if self.walks_on(i, around) {
            return Wish { velocity: self.people[i].velocity, ..Wish::STAND };
        }
        let person = &self.people[i];
        let (mut preferred, max_speed) = match person.task {
            Task::Stand { .. } => return Wish::STAND,
            Task::Walk => {
                let Some(&corner) = person.path.last() else { return Wish::STAND };
                let (to, speed) = (corner - person.position, around.people[i].speed);
                if person.steps_left == 0 {
                    (to.normalize_or_zero() * speed.min(to.length() / TICK), speed)
                } else {
                    // Not computed again: rounding would change it.
                    (person.velocity, speed)
                }
            }
            Task::React { .. } if around.robots.is_empty() => return Wish::STAND,
            Task::React { .. } => {
                let reaction = around.people[i].reaction;
                let to = around.noticed_robot(person.position).position - person.position;
                (reaction.velocity(to), reaction.max_speed())
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
            if let Some(shuffle) = self.shuffle(i, around) {
                (preferred, is_clear) = (shuffle, false);
            }
        }
        self.avoiding(i, (preferred, max_speed, is_clear), around)
    }

    /// Returns the velocity nearest to a preferred one that avoids others.
    fn avoiding(
        &mut self,
        i: usize,
        (preferred, max_speed, is_clear): (DVec2, f64, bool),
        around: &Surroundings<'_>,
    ) -> Wish {
        let zone = self.zone(i, self.people[i].position, around);
        let Crowd { people, near, sights, planes, .. } = self;
        let person = &people[i];
        let p = person.position;
        let (mut nearest, mut count) = ([(0.0, 0_u32, 0_u32); MAX_NEIGHBOURS], 0);
        for &Neighbour { person: j, pair } in near.of(i) {
            let distance2 = people[j as usize].position.distance_squared(p);
            if distance2 > RANGE * RANGE {
                continue;
            }
            let is_before = |other: &(f64, u32, u32)| (distance2, j) < (other.0, other.1);
            if count == MAX_NEIGHBOURS {
                if !is_before(&nearest[count - 1]) {
                    continue;
                }
                count -= 1;
            }
            let mut at = count;
            while at > 0 && is_before(&nearest[at - 1]) {
                nearest[at] = nearest[at - 1];
                at -= 1;
            }
            nearest[at] = (distance2, j, pair);
            count += 1;
        }
        let me = Disc { position: p, velocity: person.velocity, radius: PERSON_RADIUS, share: 1.0 };
        let apart = 2.0 * (PERSON_RADIUS + around.max_speed * TICK * DECIDE as f64);
        let is_apart = around.robots.is_empty() && (count == 0 || nearest[0].0 > apart * apart);
        let free = Wish { velocity: preferred, is_clear, is_apart, ..Wish::STAND };
        planes.clear();
        let disc = |j: u32| {
            let other = &people[j as usize];
            let share = if other.task == Task::Walk { 1.0 } else { 0.0 };
            Disc {
                position: other.position,
                velocity: other.velocity,
                radius: PERSON_RADIUS,
                share,
            }
        };
        for &(_, j, pair) in &nearest[..count] {
            let plane = avoid(&me, &disc(j), TICK);
            // Those behind a wall or a leaf are not avoided, which matters only where they would be.
            if plane.excess(preferred) <= 0.0 || sights.see_each_other(pair, near, around) {
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
            let plane = avoid(&me, &disc, TICK);
            if plane.excess(preferred) <= 0.0 || around.sees(p, robot.position - p) {
                planes.push(plane);
            }
        }
        if planes.iter().all(|plane| plane.excess(preferred) <= 0.0) {
            return free;
        }
        let reach = PERSON_RADIUS + max_speed * WALL_HORIZON;
        let before = planes.len();
        let mut clearance = f64::INFINITY;
        around.space.index.contacts(p, reach, |contact| {
            clearance = clearance.min(contact.distance);
            let plane = keep_off(p, PERSON_RADIUS, contact.point);
            if planes.len() < before + 4 * MAX_NEIGHBOURS {
                planes.push(plane);
            }
        });
        for &door in zone {
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
        let is_known = around.space.is_firm_everywhere();
        let room = if is_known { clearance.min(reach) - PERSON_RADIUS - ROUNDING } else { 0.0 };
        Wish { velocity, is_free: false, is_clear: false, room, is_apart }
    }

    /// Moves a person with the wished velocity, as far as possible.
    fn follow(&mut self, i: usize, around: &Surroundings<'_>) {
        let wish = self.wishes[i];
        let from = self.people[i].position;
        // No step is longer than that of the wish.
        let step = if wish.room > 0.0 { wish.velocity.length() * TICK } else { f64::INFINITY };
        self.wishes[i].room -= step;
        let allowed = |(velocity, is_clear): (DVec2, bool)| {
            let to = from + velocity * TICK;
            let is_allowed = velocity != DVec2::ZERO
                && (is_clear || step <= wish.room || around.space.fits(to))
                && self.is_passable((i, wish.is_apart), from, to, around);
            is_allowed.then_some((velocity, is_clear))
        };
        let allowed = allowed((wish.velocity, wish.is_clear))
            .or_else(|| allowed((self.along_wall(from, wish.velocity, around), false)))
            .or_else(|| allowed((0.5 * wish.velocity, wish.is_clear)));
        let person = &mut self.people[i];
        match allowed {
            Some((velocity, is_clear)) => {
                person.position = from + velocity * TICK;
                person.on_path &= is_clear;
                person.note_progress(around.people[i].speed, around.tick);
                let is_as_wished = velocity == wish.velocity;
                if is_as_wished && is_clear && person.steps_left > 0 {
                    person.steps_left -= 1;
                    return;
                }
                person.steps_left = 0;
                self.turn(i, velocity, wish.is_free, around);
                if !is_as_wished {
                    self.people[i].steps_left = 0;
                }
            }
            None => person.stop(),
        }
    }

    /// Sets the velocity of a person who moved, and updates what depends on the new position.
    fn turn(&mut self, i: usize, velocity: DVec2, is_free: bool, around: &Surroundings<'_>) {
        let person = &mut self.people[i];
        if person.velocity != velocity {
            person.velocity = velocity;
            person.facing = velocity.normalize_or(person.facing);
        }
        if person.task != Task::Walk {
            return;
        }
        let Some(&corner) = person.path.last() else { return };
        let left = corner.distance(person.position);
        if left < 1e-9 || (!person.on_path && left < 0.5 * PERSON_RADIUS && person.path.len() == 1)
        {
            person.path.pop();
            // The last step to a corner is a shorter one, which is not to be repeated.
            self.wishes[i] = Wish::STAND;
            if person.path.is_empty() {
                person.velocity = DVec2::ZERO;
                person.on_path = false;
                let mut stream =
                    around.seed.attempt("scenario/people/stay", i as u64, person.draws);
                let is_work = person.draws.is_multiple_of(2);
                let mean = if is_work { around.spec.working } else { around.spec.waiting };
                let mut stay = ticks(-mean * libm::log1p(-stream.unit()));
                person.held_up.1 = 0;
                if around.is_in_doorway(person.position) {
                    // Only who finds no room elsewhere stops here, and leaves again soon.
                    stay = stay.min(TICKS_PER_SECOND);
                }
                person.task = Task::Stand { until: around.tick + stay };
            }
        } else if person.on_path {
            let step = velocity.length() * TICK;
            // Without the last step to a corner.
            person.steps_left = (left / step - 1e-6).max(0.0) as u32;
        } else if (around.tick + i as u64).is_multiple_of(if is_free { LOOK } else { SEARCH }) {
            self.look(i, around);
        }
    }

    /// Looks for the path that a person left.
    fn look(&mut self, i: usize, around: &Surroundings<'_>) {
        let person = &mut self.people[i];
        let (p, corners) = (person.position, person.path.len());
        let sees = |k: usize| around.space.is_clear_from(p, person.path[k]);
        // The farthest of the next corners that is in sight; mostly the next, unless it is near.
        let next = corners - 1;
        let is_far = person.path[next].distance_squared(p) > NEAR_CORNER * NEAR_CORNER;
        let seen = match is_far && sees(next) {
            true => Some(next),
            false => {
                let end = if is_far { next } else { corners };
                (corners.saturating_sub(3)..end).find(|&k| sees(k))
            }
        };
        match seen {
            Some(k) => {
                person.path.truncate(k + 1);
                person.on_path = true;
            }
            None if (around.tick + i as u64).is_multiple_of(SEARCH) => self.search(i, around),
            None => {}
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

    /// Returns a velocity without its component towards the nearest wall.
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
    fn is_passable(
        &self,
        (i, is_apart_from_people): (usize, bool),
        from: DVec2,
        to: DVec2,
        around: &Surroundings<'_>,
    ) -> bool {
        let is_apart = |p: DVec2, least: f64| {
            let distance2 = to.distance_squared(p);
            distance2 >= least * least || distance2 > from.distance_squared(p)
        };
        let mut doors = self.zone(i, to, around).iter().map(|&door| door as usize);
        let near = if is_apart_from_people { &[] } else { self.near.touchable(i) };
        let position = |other: &Neighbour| self.people[other.person as usize].position;
        near.iter().all(|other| is_apart(position(other), 2.0 * PERSON_RADIUS))
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

impl PersonState {
    fn stop(&mut self) {
        self.velocity = DVec2::ZERO;
        self.steps_left = 0;
    }
}

/// Lists the indices for which something holds.
#[inline]
fn select(indices: &mut Vec<u32>, holds: impl ExactSizeIterator<Item = bool>) {
    indices.resize(holds.len(), 0);
    let mut count = 0;
    for (i, holds) in holds.enumerate() {
        // Without a branch, which would be hard to predict.
        indices[count] = i as u32;
        count += usize::from(holds);
    }
    indices.truncate(count);
}

/// Returns a time in seconds as whole ticks, at least one.
pub(super) fn ticks(seconds: f64) -> u64 {
    ((seconds * TICKS_PER_SECOND as f64).round() as u64).max(1)
}
