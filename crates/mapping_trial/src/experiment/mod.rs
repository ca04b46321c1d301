//! Experiments: repeated trials on maps of several difficulties, by several policies, and the
//! statistics of the rules that generated the maps.
//!
//! The design replays the experiment of O. Zwennes, *Adaptive Indoor Map Generator for USARSim*
//! (2011), sections 5 and 6: two maps each of the levels 1, 3, 5, 7 and 9. People rated those maps;
//! here policies map them and the results are measured. Ten maps show little, so a larger design
//! of the same kind is run with it.
//!
//! | what | where |
//! |---|---|
//! | which trials | [`Design`], [`TrialId`] |
//! | the result of one | [`Record`] |
//! | a folder of records that survives interrupts | [`Experiment`] |
//! | the statistics | [`stats`] |
//! | tables and the report | [`table`], [`report`] |
//! | what doors, people and smoke cost | [`hazards`] |
//! | trials in worlds of any kind, under any conditions | [`survey`] |
//!
//! A finished experiment is the same to the last byte whether it ran on one thread or many, at
//! once or interrupted, in one folder or in shards that were merged.

mod design;
mod error;
pub mod hazards;
mod head;
pub(crate) mod lines;
mod record;
pub mod report;
mod run;
mod site;
pub mod stats;
mod store;
pub mod survey;
pub mod table;
pub(crate) mod write;

pub use design::{
    Design, MAX_MAPS, MAX_NOISE_SEEDS, MAX_SIZE, MAX_TRIALS, Replay, Shard, TrialId, policy_name,
};
pub use error::ExperimentError;
pub use record::{MapFeatures, Record};
pub use run::Progress;
pub use store::{EXPERIMENT_VERSION, Experiment};

#[cfg(test)]
mod tests;
