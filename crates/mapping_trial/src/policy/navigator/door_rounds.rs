//! The state of the rounds in which robots look for closed doors, and the squares in which they are planned.

use std::collections::BTreeSet;

use glam::{DVec2, IVec2};

use crate::map::RESOLUTION;

/// Cells of the map along the side of a square, in which rounds are planned: 0.5 m.
pub(super) const SQUARE: i32 = 10;

/// Distance in metres from which a place has been looked at.
const VISITED: f64 = 1.0;

/// Least number of rounds in which nothing is found, and least time in seconds that they take together, before the
/// search ends.
pub(super) const ROUNDS: (u32, f64) = (3, 240.0);

/// The rounds along what may be rooms.
#[derive(Debug, Default)]
pub(super) struct DoorRounds {
    /// Number of rounds since something was found.
    pub(super) rounds: u32,
    /// Time in seconds when they began.
    pub(super) since: f64,
    /// Whether a robot explored something since the places were listed.
    pub(super) is_stale: bool,
    /// Number of squares that may be rooms, as last listed.
    pub(super) rooms: usize,
    /// The places beside them that are left in this round, once they are listed.
    pub(super) places: Option<BTreeSet<(i32, i32)>>,
    /// The places that were looked at in this round.
    pub(super) visited: BTreeSet<(i32, i32)>,
}

impl DoorRounds {
    /// Notes that a robot explores something.
    pub(super) fn note_goal(&mut self) {
        self.is_stale = true;
    }

    /// Whether the rounds have found nothing for long enough.
    pub(super) fn is_over(&self, time: f64) -> bool {
        self.rounds >= ROUNDS.0 && time - self.since >= ROUNDS.1
    }

    /// Notes the places that a robot looks at.
    pub(super) fn visit(&mut self, position: DVec2) {
        let Some(places) = &mut self.places else { return };
        let (at, reach) = (square_of(position), (VISITED / side()) as i32 + 1);
        for (x, y) in around(at, reach) {
            if centre(x, y).distance(position) <= VISITED && places.remove(&(x, y)) {
                self.visited.insert((x, y));
            }
        }
    }
}

/// Length of a square in metres.
pub(super) fn side() -> f64 {
    f64::from(SQUARE) * RESOLUTION
}

pub(super) fn square_of(p: DVec2) -> IVec2 {
    (p / side()).floor().as_ivec2()
}

pub(super) fn centre(x: i32, y: i32) -> DVec2 {
    (IVec2::new(x, y).as_dvec2() + 0.5) * side()
}

/// The squares from one to another, both included.
pub(super) fn between(low: IVec2, high: IVec2) -> impl Iterator<Item = (i32, i32)> {
    (low.x..=high.x).flat_map(move |x| (low.y..=high.y).map(move |y| (x, y)))
}

/// The squares within a distance of one, in squares along either axis.
pub(super) fn around(at: IVec2, reach: i32) -> impl Iterator<Item = (i32, i32)> {
    between(at - reach, at + reach)
}
