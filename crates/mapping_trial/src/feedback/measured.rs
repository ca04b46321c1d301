//! Fills the form from measurements, for trials that a policy drove.

use envgen::World;
use envgen::geometry::Pose;
use glam::DVec2;

use super::choice::Experience;
use super::form::{Feedback, Session};
use super::rating::{NoRating, Rating};
use crate::backend::TICK;
use crate::score::{Scores, TrajectoryPair, Weights};

/// Ticks from one sample of the trajectories to the next: 0.2 s.
const STRIDE: usize = 4;

/// Greatest number of rooms that an answer names.
const NAMED: usize = 3;

/// Least time in seconds in a room for the room to be reported.
const KNOWN: f64 = 5.0;

/// Distance in metres up to which a doorway counts as near.
const NEAR: f64 = 1.0;

/// Path length in metres before and after a point: a robot has turned back there if it came within
/// [`BACK`] of where it was.
const STRETCH: f64 = 2.0;

/// See [`STRETCH`].
const BACK: f64 = 0.5;

/// The data of a run from which the form is filled.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// Name of the policy or driver.
    pub policy: &'a str,
    /// The world, for its rooms and doorways.
    pub world: &'a World,
    /// The scores of the run.
    pub scores: &'a Scores,
    /// One pair of trajectories per robot, one pose per tick.
    pub tracks: &'a [TrajectoryPair<'a>],
}

/// Time spent in a place, and the growth of the position error there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Stay {
    seconds: f64,
    growth: f64,
}

impl Stay {
    fn add(&mut self, seconds: f64, growth: f64) {
        self.seconds += seconds;
        self.growth += growth;
    }

    /// The growth in whole centimetres, without the sign of zero.
    fn centimetres(self) -> f64 {
        (100.0 * self.growth).round() + 0.0
    }

    fn text(self) -> String {
        let growth = 0.01 * self.centimetres();
        format!("{growth:+.2} m of position error in {:.0} s", self.seconds)
    }
}

impl Measured<'_> {
    /// Fills the form. The ratings are the scores D, M and N, and every answer states what was
    /// measured.
    ///
    /// # Errors
    ///
    /// If a score is not a rating from 0 to 10.
    pub fn fill(&self, session: &Session) -> Result<Feedback, NoRating> {
        let looks = self.looks();
        let (difficult_rooms, easy_rooms) = self.rooms(&looks);
        let s = self.scores;
        Ok(Feedback {
            name: self.policy.to_owned(),
            experience: Experience::None,
            session: session.clone(),
            difficulty: Rating::try_from(s.difficulty)?,
            mapping: Rating::try_from(s.mapping)?,
            getting_around: Rating::try_from(s.navigation)?,
            contributed: self.contributed(),
            difficult_rooms,
            easy_rooms,
            patterns: self.patterns(&looks),
            other: format!(
                "{} collisions, {} recoveries, {} robots stuck for good; {:.0} % of the ground was \
                 mapped, {:.0} % of the walls are mapped twice.",
                s.collisions,
                s.recoveries,
                s.stuck,
                100.0 * s.coverage,
                100.0 * s.ghosting
            ),
        })
    }

    /// States how much each part adds to M and to N, the largest first.
    fn contributed(&self) -> String {
        let (s, w) = (self.scores, Weights::default());
        let list = |mut parts: Vec<(&str, f64)>| {
            parts.sort_by(|a, b| b.1.total_cmp(&a.1));
            let parts: Vec<String> =
                parts.iter().map(|(name, part)| format!("{name} {:.2}", 10.0 * part)).collect();
            parts.join(", ")
        };
        let mapping = list(vec![
            ("walls out of place", w.wall * s.e_wall),
            ("paths planned on the map that fail", w.navigability * s.e_use),
            ("drift of the pose", w.pose * s.e_pose),
            ("ground not mapped", w.coverage * s.e_cov),
        ]);
        let navigation = list(vec![
            ("time", w.time * s.e_time),
            ("ground not reached", w.reach * s.e_cov),
            ("collisions", w.collisions * s.e_hit),
            ("turning", w.turning * s.e_turn),
        ]);
        format!(
            "Mapping {:.2}: {mapping}. Getting around {:.2}: {navigation}.",
            s.mapping, s.navigation
        )
    }

    /// Returns each robot's sampled poses, with the growth of its error until the next sample.
    fn looks(&self) -> Vec<Vec<(Pose, f64)>> {
        let looks = |track: &TrajectoryPair<'_>| {
            let error = |i: usize| {
                let (truth, found) = (track.truth[i].position, track.estimated[i].position);
                truth.distance(found)
            };
            let last = track.truth.len().min(track.estimated.len());
            let starts = (0..last).step_by(STRIDE);
            let pairs = starts.map(|i| (i, i + STRIDE)).take_while(|(_, next)| *next < last);
            pairs.map(|(i, next)| (track.truth[i], error(next) - error(i))).collect()
        };
        self.tracks.iter().map(looks).collect()
    }

    fn rooms(&self, looks: &[Vec<(Pose, f64)>]) -> (String, String) {
        if self.world.rooms.is_empty() {
            let none = "The world has no rooms.".to_owned();
            return (none.clone(), none);
        }
        let mut stays = vec![Stay::default(); self.world.rooms.len()];
        for (pose, growth) in looks.iter().flatten() {
            if let Some(room) = self.room_at(pose.position) {
                stays[room].add(STRIDE as f64 * TICK, *growth);
            }
        }
        let mut known: Vec<(usize, Stay)> =
            stays.into_iter().enumerate().filter(|(_, stay)| stay.seconds >= KNOWN).collect();
        if known.is_empty() {
            let none = format!("No room was visited for {KNOWN} s.");
            return (none.clone(), none);
        }
        known.sort_by(|a, b| b.1.growth.total_cmp(&a.1.growth));
        let name = |(room, stay): &(usize, Stay)| {
            format!("{} (room {room}): {}", self.world.rooms[*room].name, stay.text())
        };
        let half = known.len().div_ceil(2);
        let rose = known.iter().filter(|(_, stay)| stay.centimetres() > 0.0);
        let difficult: Vec<String> = rose.take(NAMED.min(half)).map(name).collect();
        let easy: Vec<String> =
            known.iter().rev().take(NAMED.min(known.len() - half)).map(name).collect();
        let list = |rooms: Vec<String>, which: &str, none: &str| match rooms.is_empty() {
            true => none.to_owned(),
            false => format!("The error rose {which} in {}.", rooms.join("; ")),
        };
        (
            list(difficult, "most", "The error rose in no room."),
            list(easy, "least", "No other room was visited."),
        )
    }

    fn room_at(&self, p: DVec2) -> Option<usize> {
        self.world.rooms.iter().position(|room| room.shape.contains(p))
    }

    fn patterns(&self, looks: &[Vec<(Pose, f64)>]) -> String {
        let (mut hallways, mut doorways) = (Stay::default(), Stay::default());
        let (mut passes, mut turns, mut dead_ends) = (0, 0, Stay::default());
        for track in looks {
            let mut at_door = false;
            for (pose, growth) in track {
                let seconds = STRIDE as f64 * TICK;
                let near =
                    |door: &envgen::world::Doorway| door.shape.distance(pose.position) <= NEAR;
                let now = self.world.doorways.iter().any(|door| door.open && near(door));
                passes += u32::from(now && !at_door);
                at_door = now;
                if now {
                    doorways.add(seconds, *growth);
                } else if self.room_at(pose.position).is_none() {
                    hallways.add(seconds, *growth);
                }
            }
            let (count, stay) = turn_backs(track);
            turns += count;
            dead_ends.add(stay.seconds, stay.growth);
        }
        format!(
            "Outside rooms, away from doorways: {}. Within {NEAR} m of a doorway, {passes} times: {}. \
             Turned back {turns} times: {} within {STRETCH} m.",
            hallways.text(),
            doorways.text(),
            dead_ends.text()
        )
    }
}

/// Returns how often a robot turned back, and the time and the error from [`STRETCH`] before to
/// [`STRETCH`] after.
fn turn_backs(track: &[(Pose, f64)]) -> (u32, Stay) {
    let mut gone = Vec::with_capacity(track.len());
    let mut distance = 0.0;
    for (i, (pose, _)) in track.iter().enumerate() {
        distance += if i > 0 { track[i - 1].0.position.distance(pose.position) } else { 0.0 };
        gone.push(distance);
    }
    let (mut count, mut stay, mut after) = (0, Stay::default(), 0.0);
    for &middle in &gone {
        if middle < after {
            continue;
        }
        let from = gone.partition_point(|&distance| distance < middle - STRETCH);
        let to = gone.partition_point(|&distance| distance < middle + STRETCH);
        let whole = middle >= STRETCH && to < track.len();
        if whole && track[from].0.position.distance(track[to].0.position) <= BACK {
            count += 1;
            after = middle + STRETCH;
            for (_, growth) in &track[from..to] {
                stay.add(STRIDE as f64 * TICK, *growth);
            }
        }
    }
    (count, stay)
}
