//! Trials with any robot backend: clock, battery, end conditions, and a log of every command.

mod builder;
mod clock;
mod command_log;
mod end;
mod error;
mod log;
mod log_world;
mod observer;
mod parts;
mod replay;
mod report;
mod running;
mod script;
mod settings;
mod start;
mod summary;

pub use builder::TrialBuilder;
pub use end::{EndReason, RobotEnd};
pub use error::TrialError;
pub use log::{LOG_VERSION, LogError, TrialLog};
pub use log_world::LogWorld;
pub use observer::{Moment, TrialObserver};
pub use parts::{ForeignPart, PartRole, Setup, TrialParts};
pub use report::{REPORT_VERSION, ReportError, RobotReport, TrialReport};
pub use running::{Trajectory, Trial};
pub use settings::{MAX_ROBOTS, MIN_TIME_BY_AREA, TrialSettings};
#[cfg(feature = "experiment")]
pub(crate) use summary::LOST;

pub use crate::setting_limits::MAX_TIME_LIMIT;

#[cfg(test)]
mod custom_parts_tests;
#[cfg(test)]
mod tests;
