//! The robot and laser for which difficulty is computed.

use clap::Args;
use envgen::assignment::{Assignment, assignments};
use envgen::difficulty::Platform;
use envgen::located::Locate;

use crate::failure::Failure;

#[derive(Args)]
pub(crate) struct PlatformOptions {
    /// Changes a property of the robot and laser for which the difficulty vector is computed, such as
    /// `max_range=20`; may be given several times. An unknown name lists all names.
    #[arg(long = "platform", value_name = "NAME=VALUE")]
    numbers: Vec<String>,
}

impl PlatformOptions {
    pub(crate) fn is_given(&self) -> bool {
        !self.numbers.is_empty()
    }

    /// The default platform with its changes, checked.
    pub(crate) fn read(&self) -> Result<Platform, Failure> {
        let mut platform = Platform::default();
        for Assignment { name, value, text } in
            assignments("--platform", &self.numbers, Platform::SETTINGS)?
        {
            platform.set(name, value).in_option("--platform", text)?;
        }
        platform.validate()?;
        Ok(platform)
    }
}
