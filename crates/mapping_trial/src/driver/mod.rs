//! Drivers: programs in processes of their own that drive a trial's robots, over lines of JSON.
//!
//! A driver reads one object per line from its standard input and answers each with one line. It
//! decides where the robots go and, if its hello says so, estimates poses and map itself.
//! `docs/driver-protocol.md` describes the lines.
//!
//! Whatever a driver does, a trial continues or ends with [`EndReason::Failed`] and a reason: lines
//! are at most [`MAX_LINE`] long, answers come within [`Limits`], and the process is ended with the
//! last of its [`Driver`]s.
//!
//! [`EndReason::Failed`]: crate::trial::EndReason::Failed

mod error;
mod grid;
mod link;
mod policy_slam;
mod process;
mod protocol;
mod session;

use std::io::{Read, Write};
use std::process::Command;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

pub use error::DriverError;
pub use policy_slam::{DriverPolicy, DriverSlam};
pub use protocol::{Greeting, Hello, PROTOCOL};

use crate::trial::{TrialParts, TrialReport};
use link::{Link, LinkError};
use process::Process;
use session::Session;

/// Bytes in a driver's line, at most.
pub const MAX_LINE: usize = 16 << 20;

/// How long a driver may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// For one answer.
    pub reply: Duration,
    /// For all answers of a trial together.
    pub total: Duration,
}

impl Default for Limits {
    /// 10 seconds per answer, one hour for all answers.
    fn default() -> Self {
        Limits { reply: Duration::from_secs(10), total: Duration::from_secs(3600) }
    }
}

/// A connection to a driver, which its [`DriverPolicy`] and [`DriverSlam`] share.
///
/// ```no_run
/// use std::process::Command;
///
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
/// use mapping_trial::driver::{Driver, Hello, Limits};
/// use mapping_trial::trial::{Trial, TrialSettings};
///
/// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
/// let mut builder = Trial::builder(&world, TrialSettings::default());
///
/// let mut command = Command::new("python3");
/// command.arg("examples/drivers/explorer.py");
/// let driver = Driver::start(command, Limits::default(), std::io::stderr())?;
/// driver.greet(&Hello::new(&builder.setup()?));
///
/// let mut trial = builder.parts(driver.parts()).build_flat()?;
/// while trial.step() {}
/// let report = trial.report(&world, &trial.reference(&world)?)?;
/// driver.end(Some(&report));
/// println!("{}, {:?}", report.scores.coverage, report.failure);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Driver(Arc<Mutex<Session>>);

impl Driver {
    /// Starts a program as driver. What it writes to its standard error is copied to `errors`.
    ///
    /// # Errors
    ///
    /// When it cannot be started.
    pub fn start(
        command: Command,
        limits: Limits,
        errors: impl Write + Send + 'static,
    ) -> Result<Self, DriverError> {
        let (process, input, output) =
            Process::start(command, errors).map_err(DriverError::Start)?;
        Ok(Driver::of(Session::new(Link::new(input, output, limits), limits, Some(process))))
    }

    /// A driver behind any two streams: `input` is what it reads, `output` what it writes.
    pub fn connect(
        input: impl Write + Send + 'static,
        output: impl Read + Send + 'static,
        limits: Limits,
    ) -> Self {
        Driver::of(Session::new(Link::new(input, output, limits), limits, None))
    }

    fn of(session: Session) -> Self {
        Driver(Arc::new(Mutex::new(session)))
    }

    fn session(&self) -> MutexGuard<'_, Session> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sends the hello and returns the driver's answer; `None` if the driver fails. A trial may
    /// begin nevertheless: it ends at once, with [`Driver::failure`] as the reason.
    pub fn greet(&self, hello: &Hello) -> Option<Greeting> {
        self.session().greet(hello)
    }

    /// The trial parts that the driver provides, after [`Driver::greet`]: the policy and, if its
    /// hello says so, SLAM.
    pub fn parts(&self) -> TrialParts {
        let driver = self.clone();
        let parts = TrialParts::default().policy(move |_| DriverPolicy::new(&driver));
        if !self.session().has_slam() {
            return parts;
        }
        let driver = self.clone();
        parts.slam(move |setup| DriverSlam::new(&driver, setup.starts))
    }

    /// Why the driver failed; `None` if it did not.
    pub fn failure(&self) -> Option<String> {
        self.session().failure().map(str::to_owned)
    }

    /// Sends the driver the trial's result, and waits a moment for it to end.
    pub fn end(&self, report: Option<&TrialReport>) {
        self.session().end(report);
    }
}

#[cfg(test)]
mod tests;
