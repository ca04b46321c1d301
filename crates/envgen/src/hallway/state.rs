//! The states of the chain: the direction of a segment, and the segments that can follow it.

use std::fmt;

use glam::DVec2;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// A state of the chain, numbered 1 to 8 as in the paper.
///
/// | state | segment | after | straight on | turn next |
/// |---|---|---|---|---|
/// | 1 | straight, left | left turn 5 | 1 | 7 |
/// | 2 | straight, up | right turn 7 | 2 | 8 |
/// | 3 | straight, up | left turn 6 | 3 | 5 |
/// | 4 | straight, right | right turn 8 | 4 | 6 |
/// | 5 | left turn, up to left | straight 3 | 1 | 7 |
/// | 6 | left turn, right to up | straight 4 | 3 | 5 |
/// | 7 | right turn, left to up | straight 1 | 2 | 8 |
/// | 8 | right turn, up to right | straight 2 | 4 | 6 |
///
/// ```
/// use envgen::glam::DVec2;
/// use envgen::hallway::State;
///
/// // After a straight segment up, a left turn (state 5) leads to the left.
/// let turn = State::UP.turn();
/// assert_eq!((turn.number(), turn.is_turn()), (5, true));
/// assert_eq!((turn.entry(), turn.exit()), (DVec2::Y, DVec2::NEG_X));
/// assert_eq!(turn.straight(), State::new(1).expect("from 1 to 8"));
/// assert_eq!(State::new(9), None);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct State(u8);

/// The states that can follow each state 1..=8: a straight segment, a turn.
const NEXT: [[u8; 2]; 9] = [[0, 0], [1, 7], [2, 8], [3, 5], [4, 6], [1, 7], [3, 5], [2, 8], [4, 6]];

impl State {
    /// Every state, in order.
    pub const ALL: [State; 8] =
        [State(1), State(2), State(3), State(4), State(5), State(6), State(7), State(8)];

    /// A straight segment that goes up after a left turn: the default start of a hallway.
    pub const UP: State = State(3);

    /// Returns the state with a number; `None` outside 1..=8.
    pub const fn new(number: u8) -> Option<State> {
        if number >= 1 && number <= 8 { Some(State(number)) } else { None }
    }

    /// Returns the number of the state in the paper, 1..=8.
    pub const fn number(self) -> u8 {
        self.0
    }

    /// Returns whether the state is one of the four turns.
    pub const fn is_turn(self) -> bool {
        self.0 > 4
    }

    /// Returns the state of the straight segment that can follow.
    #[inline]
    pub const fn straight(self) -> State {
        self.next(false)
    }

    /// Returns the state of the turn that can follow.
    #[inline]
    pub const fn turn(self) -> State {
        self.next(true)
    }

    /// Returns the state of the turn, or of the straight segment, that can follow.
    #[inline]
    pub(super) const fn next(self, turns: bool) -> State {
        State(NEXT[self.0 as usize][turns as usize])
    }

    /// Returns the unit vector of the direction in which the segment is entered.
    #[inline]
    pub const fn entry(self) -> DVec2 {
        match self.0 {
            1 | 7 => DVec2::NEG_X,
            4 | 6 => DVec2::X,
            _ => DVec2::Y,
        }
    }

    /// Returns the unit vector of the direction in which the segment is left. It never points down, so that a
    /// hallway cannot cross itself.
    #[inline]
    pub const fn exit(self) -> DVec2 {
        match self.0 {
            1 | 5 => DVec2::NEG_X,
            4 | 8 => DVec2::X,
            _ => DVec2::Y,
        }
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl fmt::Debug for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Serialize for State {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u8(self.0)
    }
}

impl<'de> Deserialize<'de> for State {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let number = u8::deserialize(deserializer)?;
        State::new(number).ok_or_else(|| {
            de::Error::custom(format!("the state must be from 1 to 8, got {number}"))
        })
    }
}
