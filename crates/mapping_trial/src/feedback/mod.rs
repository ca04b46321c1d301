//! The form that an operator fills after a run: appendix B of Zwennes (2011), with two more questions
//! that separate what its single rating mixes.

mod ask;
mod choice;
mod form;
#[cfg(feature = "experiment")]
mod link;
mod measured;
pub mod questions;
mod rating;

pub use ask::{FeedbackError, MAX_LINE, ask};
pub use choice::{Connection, Experience, NoChoice};
pub use form::{Feedback, Session};
#[cfg(feature = "experiment")]
pub use link::{
    DifficultySource, LEAST_SESSIONS, LinkError, PanelDifficulty, RatedWorld, RatingLink,
    UnknownDifficulty,
};
pub use measured::Measured;
pub use rating::{NoRating, Rating};

#[cfg(test)]
mod tests;
