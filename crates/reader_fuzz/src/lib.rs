//! Mutated files for every reader of [`envgen`] and [`mapping_trial`].
//!
//! A [`Format`] has a few small files that are made here, and a function that reads a file and uses
//! what was read as a program would: rays, distances, grids, exports, a short trial. Case `n` of a
//! format is always the same file, so that a number is all that a report needs.
//!
//! - `cargo test -p reader_fuzz` runs a few hundred cases of each format, and the files that were
//!   found to do harm.
//! - `cargo run --release -p reader_fuzz -- --cases 100000` runs many in processes of bounded
//!   memory and time, resumes where it stopped, and keeps the files that do harm.

pub mod corpus;
pub mod exercise;
pub mod formats;
pub mod mutate;
pub mod work;

pub use formats::{FORMATS, Format};
