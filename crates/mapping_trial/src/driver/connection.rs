//! Connections to drivers.

use std::io::{Read, Write};
use std::process::Command;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::error::DriverError;
use super::limits::Limits;
use super::link::Link;
use super::process::Process;
use super::protocol::{Greeting, Hello};
use super::session::Session;
use crate::trial::TrialReport;

/// A connection to a driver. The driver's [`DriverPolicy`](super::DriverPolicy) and
/// [`DriverSlam`](super::DriverSlam) share it.
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
    /// Starts a program as driver. Its standard error is copied to `errors`.
    ///
    /// # Errors
    ///
    /// If the program cannot be started.
    pub fn start(
        command: Command,
        limits: Limits,
        errors: impl Write + Send + 'static,
    ) -> Result<Self, DriverError> {
        let program = command.get_program().to_string_lossy().into_owned();
        let (process, input, output) = Process::start(command, errors)
            .map_err(|error| DriverError::Start { program, error })?;
        Ok(Driver::of(Session::new(Link::new(input, output, limits), limits, Some(process))))
    }

    /// Connects to a driver behind any two streams: it reads `input` and writes `output`.
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

    pub(super) fn session(&self) -> MutexGuard<'_, Session> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sends the hello and returns the driver's answer; `None` if the driver fails. A trial may still
    /// start then: it ends at once, with [`Driver::failure`] as the reason.
    pub fn greet(&self, hello: &Hello) -> Option<Greeting> {
        self.session().greet(hello)
    }

    /// Returns why the driver failed; `None` if it did not.
    pub fn failure(&self) -> Option<String> {
        self.session().failure().map(str::to_owned)
    }

    /// Sends the driver the trial's result, and waits a moment for the driver to end.
    pub fn end(&self, report: Option<&TrialReport>) {
        self.session().end(report);
    }
}
