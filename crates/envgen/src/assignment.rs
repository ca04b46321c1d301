//! Settings that are changed by texts such as `width=3`.

use thiserror::Error;

use crate::located::{Locate, Located};
use crate::settings::Setting;

/// A change of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Assignment<'a> {
    /// Name of the setting: its present one if a former name was given.
    pub name: &'a str,
    /// The new value.
    pub value: &'a str,
    /// The whole text.
    pub text: &'a str,
}

/// The reasons why a text changes no setting.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum AssignmentError {
    /// The text has no `=`.
    #[error("is not of the form name=value")]
    Form,
    /// An earlier text changes the same setting.
    #[error("`{0}` is set twice")]
    Twice(String),
}

/// Splits the values of an option such as `--set`. Names that are not among the settings are kept as they are.
///
/// ```
/// use envgen::WorldKind;
/// use envgen::assignment::assignments;
///
/// let texts = ["width=3".to_owned(), "segments = 20".to_owned()];
/// let found = assignments("--set", &texts, WorldKind::Hallway.settings())?;
/// assert_eq!((found[1].name, found[1].value), ("segments", "20"));
/// let twice = [texts, ["width=4".to_owned(), "corners=square".to_owned()]].concat();
/// let error = assignments("--set", &twice, WorldKind::Hallway.settings()).unwrap_err();
/// assert_eq!(error.to_string(), "--set width=4: `width` is set twice");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a text has no `=`, or when a setting occurs twice, also by its former name.
pub fn assignments<'a>(
    option: &str,
    texts: &'a [String],
    settings: &[Setting],
) -> Result<Vec<Assignment<'a>>, Located<AssignmentError>> {
    let mut found: Vec<Assignment<'a>> = Vec::with_capacity(texts.len());
    for text in texts {
        let split = text.split_once('=').ok_or(AssignmentError::Form);
        let (name, value) = split.in_option(option, text)?;
        let (name, value) = (name.trim(), value.trim());
        let setting = settings.iter().find(|setting| setting.alias == Some(name));
        let name = setting.map_or(name, |setting| setting.name);
        if found.iter().any(|other| other.name == name) {
            return Err(AssignmentError::Twice(name.to_owned())).in_option(option, text);
        }
        found.push(Assignment { name, value, text });
    }
    Ok(found)
}
