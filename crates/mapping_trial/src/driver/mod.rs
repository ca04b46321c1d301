//! Drivers: programs in other processes that drive the robots of a trial, by lines of JSON.
//!
//! A driver reads one object per line from its standard input and answers each with one line. It
//! decides where the robots go. If its hello says so, it also estimates poses and map itself.
//! `docs/driver-protocol.md` describes the lines.
//!
//! Whatever a driver does, the trial continues, or it ends with [`EndReason::Failed`] and a reason:
//! lines are at most [`MAX_LINE`] long, answers come within [`Limits`], and the process is ended with
//! the last of its [`Driver`]s.
//!
//! [`EndReason::Failed`]: crate::trial::EndReason::Failed

mod command_line;
mod connection;
mod error;
mod grid;
mod limits;
mod link;
mod policy_slam;
mod process;
mod protocol;
mod session;

pub use command_line::command;
pub use connection::Driver;
pub use error::DriverError;
pub use limits::{Limits, MAX_LINE};
pub use policy_slam::{DriverPolicy, DriverSlam};
pub use protocol::{Greeting, Hello, PROTOCOL};

#[cfg(test)]
mod tests;
