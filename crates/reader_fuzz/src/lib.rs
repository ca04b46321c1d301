//! Tests every reader of [`envgen`] and [`mapping_trial`] with mutated files.
//!
//! A [`Format`] has a few small generated files, and a function that reads a file and uses the result as a
//! program would, with rays, distances, grids, exports and a short trial. Case `n` of a format is always the
//! same file, so that the number is enough to report it.
//!
//! - `cargo test -p reader_fuzz` runs a few hundred cases of each format, and the files that have caused
//!   failures before.
//! - `cargo run --release -p reader_fuzz -- --cases 100000` runs many cases in processes of limited memory
//!   and time, resumes after an interruption, and keeps the files that cause failures.

pub mod corpus;
pub mod exercise;
pub mod formats;
pub mod mutate;
mod script;
pub mod work;

pub use formats::{FORMATS, Format};
