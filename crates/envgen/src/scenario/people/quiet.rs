//! People who need no decision for some ticks: those who do not walk, and those who walk straight while nobody in
//! sight is on a collision course with them.

use glam::DVec2;

use super::crowd::{Crowd, ROUNDING};
use super::goals::impatient_from;
use super::held_up::JAM;
use super::orca::DISC_HORIZON;
use super::surroundings::Surroundings;
use crate::scenario::neighbourhood::{Neighbour, REBUILD, drift};
use crate::scenario::person::{PERSON_RADIUS, Task};
use crate::scenario::tick::TICK;

impl Crowd {
    /// Whether a person continues in this tick, whatever others do in it.
    #[inline]
    pub(super) fn is_quiet(&self, i: usize, tick: u64) -> bool {
        tick < self.quiet_until[i]
    }

    /// Keeps a person who does not walk at the current position until a tick.
    pub(super) fn rest(&mut self, i: usize, until: u64, around: &Surroundings<'_>) {
        if around.robots.is_empty() && self.people[i].velocity == DVec2::ZERO {
            self.quiet_until[i] = until;
        }
    }

    /// Moves a quiet person.
    #[inline]
    pub(super) fn cruise(&mut self, i: usize, around: &Surroundings<'_>) {
        let person = &mut self.people[i];
        if person.velocity != DVec2::ZERO {
            person.position += person.velocity * TICK;
            person.steps_left -= 1;
            person.note_progress(around.people[i].speed, around.tick);
        }
    }

    /// Makes the people who walk near a person look again from a tick on, because what they expect of the person
    /// has changed.
    pub(super) fn disturb_others(&mut self, i: usize, tick: u64) {
        for other in self.near.of(i) {
            let j = other.person as usize;
            if self.people[j].task == Task::Walk {
                self.quiet_until[j] = self.quiet_until[j].min(tick);
            }
        }
    }

    /// Whether a person continues along the path as before. Then the person also continues for as many ticks as is
    /// certain while nobody near changes the velocity.
    pub(super) fn walks_on(&mut self, i: usize, around: &Surroundings<'_>) -> bool {
        let ticks = self.ticks_straight_on(i, around);
        if ticks > 0 {
            self.quiet_until[i] = around.tick + ticks;
            self.people[i].aside = None;
        }
        ticks > 0
    }

    fn ticks_straight_on(&mut self, i: usize, around: &Surroundings<'_>) -> u64 {
        let person = &self.people[i];
        if person.steps_left == 0
            || !around.robots.is_empty()
            || !self.zone(i, person.position, around).is_empty()
        {
            return 0;
        }
        // Until those who are near are others, or the person has waited too long.
        let mut most = (REBUILD - around.tick % REBUILD).min(person.steps_left.into());
        most = most.min(impatient_from(i, person).saturating_sub(around.tick));
        let close = 2.0 * (PERSON_RADIUS + around.max_speed * TICK);
        let jam = JAM + 2.0 * drift(around.max_speed);
        for &Neighbour { person: j, pair } in self.near.of(i) {
            let other = &self.people[j as usize];
            let (to, closing) =
                (other.position - person.position, person.velocity - other.velocity);
            if other.was_held_up() && to.length_squared() < jam * jam {
                return 0;
            }
            let mut ticks = seconds_free(to, closing, close) / TICK;
            if ticks < most as f64 && !self.sights.see_each_other(pair, &self.near, around) {
                ticks = seconds_apart(to, closing, close) / TICK;
            }
            // Rounded down.
            most = if ticks < most as f64 { ticks as u64 } else { most };
            if most == 0 {
                return 0;
            }
        }
        let at = |ticks: u64| person.position + person.velocity * (ticks as f64 * TICK);
        let is_off_doors = |ticks: &u64| self.zone(i, at(*ticks), around).is_empty();
        // Zones are wider than they need to be by more than a few steps: it is enough to look at the ends.
        if is_off_doors(&most) {
            most
        } else {
            (1..most).take_while(is_off_doors).last().unwrap_or(0)
        }
    }
}

/// Returns the time in seconds for which a person need not avoid another one, and stays farther than `close` metres
/// from that one; 0 or less if the person has to avoid the other now. See [`seconds_apart`].
fn seconds_free(to: DVec2, closing: DVec2, close: f64) -> f64 {
    let meeting = seconds_apart(to, closing, 2.0 * PERSON_RADIUS + ROUNDING);
    seconds_apart(to, closing, close).min(meeting - DISC_HORIZON)
}

/// Returns the time in seconds for which a person stays farther than a distance in metres from another one, who is
/// at `to` relative to the person. `closing` is the velocity of the person relative to the other in m/s. Returns 0
/// if they are nearer already.
fn seconds_apart(to: DVec2, closing: DVec2, distance: f64) -> f64 {
    let distance2 = distance * distance;
    if to.length_squared() <= distance2 {
        return 0.0;
    }
    let approach = to.dot(closing);
    if approach <= 0.0 {
        return f64::INFINITY;
    }
    let (speed2, across) = (closing.length_squared(), to.perp_dot(closing));
    let half2 = distance2 * speed2 - across * across;
    if half2 < 0.0 { f64::INFINITY } else { (approach - half2.sqrt()) / speed2 }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::indoor::IndoorSpec;
    use crate::scenario::people::orca::{Disc, avoid};
    use crate::scenario::{Scenario, ScenarioSpec, ScenarioState};
    use crate::{Blueprint, Seed, Spec};

    #[test]
    fn who_is_quiet_walks_as_who_is_looked_at_in_every_tick() {
        // In the last of these maps someone who walks slowly runs out of patience while free to walk on.
        for (seed, people, pace) in [(1, 40, 1.0), (2, 40, 1.0), (3, 100, 1.0), (20, 100, 0.3)] {
            let spec = IndoorSpec { width: 6, height: 6, ..Default::default() };
            let world = spec.generate(Seed(seed)).unwrap().to_world();
            let spec = ScenarioSpec {
                people,
                doors: 0.5,
                waiting: 1.0,
                working: 2.0,
                ..Default::default()
            };
            let mut scenario = Scenario::new(&world, &spec, Seed(seed)).unwrap();
            scenario.people.iter_mut().for_each(|person| person.speed *= pace);
            let mut state = ScenarioState::new(&world, &scenario).unwrap();
            let mut looking = state.clone();
            let mut quiet = 0;
            for tick in 1..=6000 {
                state.step(TICK, &[]).unwrap();
                let states = &looking.crowd.people;
                for (until, person) in looking.crowd.quiet_until.iter_mut().zip(states) {
                    // Who is stopped looks again when it is time.
                    if !person.is_walking() || person.velocity != DVec2::ZERO {
                        *until = 0;
                    }
                }
                looking.step(TICK, &[]).unwrap();
                let walks = |i: &usize| {
                    state.crowd.is_quiet(*i, tick) && state.crowd.people[*i].task == Task::Walk
                };
                quiet += (0..people as usize).filter(walks).count();
            }
            assert_eq!(state.digest(), looking.digest(), "seed {seed}");
            assert!(quiet > 1000, "{quiet}");
        }
    }

    proptest! {
        #[test]
        fn two_are_apart_until_they_are_near(
            to in [-8.0..8.0, -8.0..8.0],
            closing in [-3.0..3.0, -3.0..3.0],
            distance in 0.1..2.0,
        ) {
            let (to, closing) = (DVec2::from(to), DVec2::from(closing));
            let seconds = seconds_apart(to, closing, distance);
            let gap = |time: f64| (to - closing * time).length();
            let is_apart = |k| {
                let time = f64::from(k) * 0.001 * seconds.min(60.0);
                seconds == 0.0 || gap(time) >= distance - 1e-6
            };
            prop_assert!((0..=1000).all(is_apart));
            if seconds.is_finite() {
                prop_assert!(gap(seconds) <= distance + 1e-6);
            }
        }

        #[test]
        fn nobody_is_avoided_while_all_are_free(
            to in [-8.0..8.0, -8.0..8.0],
            mine in [-1.5..1.5, -1.5..1.5],
            theirs in [-1.5..1.5, -1.5..1.5],
            shares in [0.0..1.0, 0.0..1.0, 0.0..1.0],
        ) {
            let (to, mine, theirs) = (DVec2::from(to), DVec2::from(mine), DVec2::from(theirs));
            let seconds = seconds_free(to, mine - theirs, 0.7);
            let disc = |position, velocity| Disc {
                position,
                velocity,
                radius: PERSON_RADIUS,
                share: 1.0,
            };
            for share in shares {
                let time = share * seconds.min(10.0);
                if time <= 0.0 {
                    continue;
                }
                let other = to + theirs * time;
                let plane = avoid(&disc(mine * time, mine), &disc(other, theirs), TICK);
                prop_assert!(plane.excess(mine) <= 0.0);
                prop_assert!(other.distance(mine * time) > 0.7 - 1e-9);
            }
            // Not less than can be: who is free long enough does not meet the other at all.
            let gap = |time: f64| (to + (theirs - mine) * time).length();
            let least = (0..1000).map(|k| gap(f64::from(k) * 0.02)).fold(f64::INFINITY, f64::min);
            prop_assert!(least <= 0.75 || seconds > 10.0);
        }
    }
}
