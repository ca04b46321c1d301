//! Settings on the command line for doors, people and smoke.

use std::error::Error;

use envgen::assignment::{Assignment, assignments};
use envgen::located::Locate;
use envgen::scenario::ScenarioSpec;

/// Returns the scenario for settings such as `doors=0.5`.
pub(crate) fn spec(settings: &[String]) -> Result<ScenarioSpec, Box<dyn Error>> {
    let mut spec = ScenarioSpec::default();
    for Assignment { name, value, text } in assignments("--set", settings, ScenarioSpec::SETTINGS)?
    {
        spec.set(name, value).in_option("--set", text)?;
    }
    Ok(spec)
}
