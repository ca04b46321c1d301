//! Command lines of drivers, as people write them.

use std::process::Command;

use super::error::DriverError;

/// Returns the command of a line such as `python3 "my driver.py" --fast`, with quotes as in a shell.
///
/// ```
/// use mapping_trial::driver::command;
///
/// let command = command("python3 'my driver.py'")?;
/// assert_eq!(command.get_program(), "python3");
/// assert_eq!(command.get_args().collect::<Vec<_>>(), ["my driver.py"]);
/// # Ok::<(), mapping_trial::driver::DriverError>(())
/// ```
///
/// # Errors
///
/// If a quote is not closed, or if the line is empty.
pub fn command(line: &str) -> Result<Command, DriverError> {
    let words = shlex::split(line).ok_or(DriverError::Command("a quote is not closed"))?;
    let (program, arguments) =
        words.split_first().ok_or(DriverError::Command("names no program"))?;
    let mut command = Command::new(program);
    command.args(arguments);
    Ok(command)
}
