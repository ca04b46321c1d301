//! Settings on the command line for doors, people and smoke.

use std::error::Error;

use envgen::scenario::ScenarioSpec;

/// Returns the scenario for settings such as `doors=0.5`.
pub(crate) fn spec(settings: &[String]) -> Result<ScenarioSpec, Box<dyn Error>> {
    let (mut spec, mut names) = (ScenarioSpec::default(), Vec::new());
    for setting in settings {
        let (name, value) = setting
            .split_once('=')
            .ok_or_else(|| format!("--set {setting}: not of the form NAME=VALUE"))?;
        let name = name.trim();
        if names.contains(&name) {
            return Err(format!("--set {setting}: `{name}` is set twice").into());
        }
        names.push(name);
        spec.set(name, value).map_err(|error| format!("--set {setting}: {error}"))?;
    }
    Ok(spec)
}
