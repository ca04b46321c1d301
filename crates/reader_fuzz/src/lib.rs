//! Mutated files for every reader of [`envgen`] and [`mapping_trial`].
//!
//! A [`Format`] has a few small generated files, and a function that reads a file and uses the
//! result as a program would: rays, distances, grids, exports, a short trial. Case `n` of a format
//! is always the same file, so that a report needs only the number.
//!
//! - `cargo test -p reader_fuzz` runs a few hundred cases of each format, and the files that once
//!   caused failures.
//! - `cargo run --release -p reader_fuzz -- --cases 100000` runs many in processes of limited
//!   memory and time, resumes after an interruption, and keeps the files that cause failures.

pub mod corpus;
pub mod exercise;
pub mod formats;
pub mod mutate;
mod script;
pub mod work;

pub use formats::{FORMATS, Format};
