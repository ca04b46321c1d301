//! Experiments: repeated trials on maps of several difficulties by several policies, and the statistics
//! of the rules that generated the maps.
//!
//! The design replays the experiment of O. Zwennes, *Adaptive Indoor Map Generator for USARSim* (2011),
//! sections 5 and 6, with two maps each of the levels 1, 3, 5, 7 and 9. In the thesis, people rated
//! those maps; here, policies map them and the results are measured. Since ten maps show little, a
//! larger design of the same kind is run with it.
//!
//! | Task | Items |
//! |---|---|
//! | The trials of an experiment | [`Design`], [`TrialId`] |
//! | The result of a trial | [`Record`] |
//! | A folder of records that survives interrupts | [`Experiment`] |
//! | Statistics | [`stats`] |
//! | Tables and the report | [`table`], [`report`] |
//! | The cost of doors, people and smoke | [`hazards`] |
//! | Trials in worlds of any kind, under any conditions | [`survey`] |
//!
//! A finished experiment is the same to the last byte, whether it ran on one thread or on many, at once
//! or interrupted, in one folder or in shards that were merged.

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
