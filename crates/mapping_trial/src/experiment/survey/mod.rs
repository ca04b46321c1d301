//! Surveys: trials under several conditions in many worlds of any kind, kept in a folder that survives
//! interrupts, with a summary.
//!
//! | Task | Items |
//! |---|---|
//! | The worlds and conditions | [`Survey`], [`Family`], [`Condition`] |
//! | The result of a trial | [`Record`] |
//! | A folder of records | [`SurveyFolder`] |
//! | How trials ended, and how much of the variance is due to the worlds | [`summary`] |
//!
//! The [`Design`](super::Design) of an experiment is for the levels of one generator; a survey compares
//! worlds of any kind under any conditions. Its records are the same to the last byte, whatever the
//! number of threads, and however often it was interrupted.

mod design;
mod folder;
mod ranks;
mod record;
mod site;
pub mod summary;

pub use design::{
    Condition, Family, MAX_SURVEY_TRIALS, Survey, SurveyError, SurveyMap, SurveyNoise,
};
pub(crate) use design::{check_conditions, ron_options};
pub use folder::{SURVEY_VERSION, SurveyFolder, SurveyProgress};
pub use ranks::{FamilyRanks, Ranks, WorldRanks};
pub use record::Record;
pub(crate) use site::{Failure, Site};

#[cfg(test)]
mod tests;
