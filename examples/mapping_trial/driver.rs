//! Drivers, which are other programs that drive the robots.

use std::error::Error;
use std::time::Duration;

use mapping_trial::driver::{Driver, Hello, Limits, command};
use mapping_trial::trial::Setup;

use crate::arguments::Arguments;

/// Value of `--driver` for the program that started this one, which drives over standard input and
/// output.
const OURSELVES: &str = "-";

/// The longest time for which a driver can be waited for.
const MOST_WAITING: Duration = Duration::from_secs(1_000_000_000);

impl Arguments {
    /// Whether standard input and output belong to a driver.
    pub(crate) fn is_driven_by_caller(&self) -> bool {
        self.driver.as_deref() == Some(OURSELVES)
    }

    /// Starts the driver from the arguments, and waits for its hello. If the hello fails, the trial
    /// fails.
    pub(crate) fn start_driver(&self, setup: &Setup<'_>) -> Result<Option<Driver>, Box<dyn Error>> {
        let Some(program) = &self.driver else { return Ok(None) };
        let limits = Limits {
            reply: seconds("--driver-timeout", self.driver_timeout)?,
            total: seconds("--driver-total", self.driver_total)?,
        };
        let hello = Hello::new(setup);
        let driver = if self.is_driven_by_caller() {
            if self.form {
                return Err(
                    "--form reads the answers from the standard input, and so does the driver -"
                        .into(),
                );
            }
            Driver::connect(std::io::stdout(), std::io::stdin(), limits)
        } else {
            let of_program =
                |error: &dyn std::fmt::Display| format!("--driver `{program}`: {error}");
            let command = command(program).map_err(|error| of_program(&error))?;
            Driver::start(command, limits, std::io::stderr()).map_err(|error| of_program(&error))?
        };
        driver.greet(&hello);
        Ok(Some(driver))
    }
}

fn seconds(option: &str, value: f64) -> Result<Duration, String> {
    let is_allowed = |value: &Duration| !value.is_zero() && *value <= MOST_WAITING;
    Duration::try_from_secs_f64(value).ok().filter(is_allowed).ok_or_else(|| {
        let most = MOST_WAITING.as_secs();
        format!("`{option}` must be a number of seconds above 0, at most {most}, got {value:?}")
    })
}
