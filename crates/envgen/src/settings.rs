//! The settings of a spec: names, units, limits, and how a text sets one.
//!
//! A spec is a flat struct of numbers, flags, choices and lists. The table of its [`Setting`]s is
//! what `envgen kinds` prints, what the specs' `validate` reads its limits from, and what a panel
//! needs to offer every setting with its range.

use std::fmt;

use serde_json::Value;

use crate::error::SpecError;

/// One setting of a spec.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Name, as in RON files and after `--set`.
    pub name: &'static str,
    /// Unit of the value, empty when it has none.
    pub unit: &'static str,
    /// The values that are allowed.
    pub allowed: Allowed,
    /// What the setting does, in one sentence without a full stop.
    pub help: &'static str,
    /// An example of a value, as after `--set name=`, where the form is not obvious.
    pub example: Option<&'static str>,
}

/// The values that a setting can take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Allowed {
    /// A whole number, limits included.
    Integer {
        /// Least value.
        min: u64,
        /// Greatest value.
        max: u64,
    },
    /// A finite number, limits included.
    Number {
        /// Least value.
        min: f64,
        /// Greatest value.
        max: f64,
    },
    /// One of a list of names.
    Choice(&'static [&'static str]),
    /// `true` or `false`.
    Flag,
    /// A list, separated by commas on the command line, with or without brackets around it; the
    /// text names its items.
    List(&'static str),
    /// Another form, which the text describes.
    Other(&'static str),
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Allowed::Integer { min, max } => write!(f, "a whole number from {min} to {max}"),
            Allowed::Number { min, max } => write!(f, "a number from {min} to {max}"),
            Allowed::Choice(names) => write!(f, "one of {}", names.join(", ")),
            Allowed::Flag => f.write_str("true or false"),
            Allowed::List(of) => write!(f, "a list of {of}"),
            Allowed::Other(form) => f.write_str(form),
        }
    }
}

impl Setting {
    /// A whole number from `min` to `max`.
    pub const fn integer(name: &'static str, min: u64, max: u64, help: &'static str) -> Self {
        Setting { name, unit: "", allowed: Allowed::Integer { min, max }, help, example: None }
    }

    /// A finite number from `min` to `max`.
    pub const fn number(
        name: &'static str,
        unit: &'static str,
        min: f64,
        max: f64,
        help: &'static str,
    ) -> Self {
        Setting { name, unit, allowed: Allowed::Number { min, max }, help, example: None }
    }

    /// One of several names.
    pub const fn choice(
        name: &'static str,
        names: &'static [&'static str],
        help: &'static str,
    ) -> Self {
        Setting { name, unit: "", allowed: Allowed::Choice(names), help, example: None }
    }

    /// True or false.
    pub const fn flag(name: &'static str, help: &'static str) -> Self {
        Setting { name, unit: "", allowed: Allowed::Flag, help, example: None }
    }

    /// A list; `of` names its items.
    pub const fn list(
        name: &'static str,
        unit: &'static str,
        of: &'static str,
        help: &'static str,
    ) -> Self {
        Setting { name, unit, allowed: Allowed::List(of), help, example: None }
    }

    /// A value of another form, which `form` describes.
    pub const fn other(
        name: &'static str,
        unit: &'static str,
        form: &'static str,
        help: &'static str,
    ) -> Self {
        Setting { name, unit, allowed: Allowed::Other(form), help, example: None }
    }

    /// The setting with an example of its values.
    pub const fn such_as(self, example: &'static str) -> Self {
        Setting { example: Some(example), ..self }
    }

    /// The error for a value of this setting that is not allowed.
    pub fn error(&self, value: impl fmt::Display) -> SpecError {
        self.error_with(value, self.allowed.to_string())
    }

    /// The error for a value that is within the limits but not allowed for another reason.
    pub fn error_with(&self, value: impl fmt::Display, allowed: impl Into<String>) -> SpecError {
        SpecError::new(self.name, value, allowed)
    }

    /// Checks a number against the limits; NaN never passes.
    ///
    /// # Errors
    /// Names the setting, the value and the limits.
    #[inline]
    pub fn check(&self, value: f64) -> Result<(), SpecError> {
        let inside = match self.allowed {
            Allowed::Number { min, max } => value >= min && value <= max,
            Allowed::Integer { min, max } => value >= min as f64 && value <= max as f64,
            _ => true,
        };
        if inside { Ok(()) } else { Err(self.error(value)) }
    }

    /// Checks a whole number against the limits.
    ///
    /// # Errors
    /// Names the setting, the value and the limits.
    #[inline]
    pub fn check_integer(&self, value: u64) -> Result<(), SpecError> {
        match self.allowed {
            Allowed::Integer { min, max } if value < min || value > max => Err(self.error(value)),
            _ => Ok(()),
        }
    }

    /// Reads a value from the text that follows `--set name=`.
    ///
    /// # Errors
    /// Names the setting, the text and what is allowed.
    pub fn parse(&self, text: &str) -> Result<Value, SpecError> {
        let text = text.trim();
        let item = |text: &str| {
            serde_json::from_str(text).unwrap_or_else(|_| Value::String(text.to_owned()))
        };
        match self.allowed {
            Allowed::Integer { .. } => {
                let value: u64 = text.parse().map_err(|_| self.error(text))?;
                self.check_integer(value)?;
                Ok(value.into())
            }
            Allowed::Number { .. } => {
                let value: f64 = text.parse().map_err(|_| self.error(text))?;
                self.check(value)?;
                Ok(value.into())
            }
            Allowed::Choice(names) if names.contains(&text) => Ok(text.into()),
            Allowed::Choice(_) => Err(self.error(text)),
            Allowed::Flag => match text {
                "true" => Ok(true.into()),
                "false" => Ok(false.into()),
                _ => Err(self.error(text)),
            },
            Allowed::List(_) => {
                // RON and JSON put brackets around a list; a command line can do without.
                let inside = text.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
                let list = inside.unwrap_or(text).trim();
                let parts = list.split(',').filter(|_| !list.is_empty());
                Ok(parts.map(|part| item(part.trim())).collect::<Vec<_>>().into())
            }
            Allowed::Other(_) => Ok(item(text)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: Setting = Setting::number("width", "m", 0.5, 10.0, "how wide");

    #[test]
    fn errors_name_field_value_and_limits() {
        for text in ["NaN", "inf", "-1", "0.4", "1e300", "wide", ""] {
            let error = WIDTH.parse(text).unwrap_err();
            assert_eq!(error.field, "width");
            assert_eq!(error.value.to_lowercase(), text.to_lowercase());
            assert_eq!(error.allowed, "a number from 0.5 to 10");
        }
        assert!(WIDTH.check(f64::NAN).is_err());
        assert_eq!(WIDTH.parse(" 2 ").unwrap(), Value::from(2.0));
    }

    #[test]
    fn lists_split_at_commas() {
        let list = Setting::list("prefabs", "", "names", "what follows what");
        for text in ["a, b,3", "[a,b,3]", " [ \"a\", b, 3 ] "] {
            assert_eq!(list.parse(text).unwrap(), serde_json::json!(["a", "b", 3]), "{text}");
        }
        for text in ["", "[]", "[ ]"] {
            assert_eq!(list.parse(text).unwrap(), serde_json::json!([]), "{text}");
        }
        assert_eq!(list.parse("[a").unwrap(), serde_json::json!(["[a"]));
    }
}
