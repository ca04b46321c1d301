//! The robot and laser for which difficulty is computed.

use clap::Args;
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
        let (mut platform, mut names) = (Platform::default(), Vec::new());
        for option in &self.numbers {
            let usage =
                |text: &str| Failure::Usage(text.to_owned()).about(format!("--platform {option}"));
            let (name, value) =
                option.split_once('=').ok_or_else(|| usage("is not of the form name=value"))?;
            let name = name.trim();
            if names.contains(&name) {
                return Err(usage(&format!("`{name}` is set twice")));
            }
            names.push(name);
            platform.set(name, value).in_option("--platform", option)?;
        }
        platform.validate()?;
        Ok(platform)
    }
}
