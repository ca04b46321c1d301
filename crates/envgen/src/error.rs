//! Errors of settings, and how this crate treats invalid numbers.
//!
//! An invalid number is never silently replaced by another one:
//!
//! - Input that a program may compute or read (a reach, a resolution, a field of view, any setting of a spec) is
//!   checked on entry. The error, such as [`SpecError`], names the field, its value and the allowed values.
//! - A wrong argument that a programmer writes down (a range to draw from, the number of columns of a slice) is a
//!   bug: the function panics, its documentation says so under "Panics", and the message names the argument and its
//!   value.
//! - Pure geometry accepts every number: NaN gives NaN, or "no hit", "outside" and "infinitely far". Where such a
//!   number has another meaning, the documentation says so.

use std::fmt;

use thiserror::Error;

/// The error for a value of a spec that is not allowed.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}", must_be(field, value, allowed))]
pub struct SpecError {
    /// The name of the setting, such as `p_st`.
    pub field: String,
    /// The value that was given.
    pub value: String,
    /// The allowed values with their limits, as they follow "must be"; a reason may follow after a colon.
    pub allowed: String,
}

impl SpecError {
    /// Creates an error from its three parts. A value with very many digits is shown with an exponent.
    pub fn new(field: &str, value: impl fmt::Display, allowed: impl Into<String>) -> Self {
        let mut value = value.to_string();
        if value.len() > 24
            && let Ok(number) = value.parse::<f64>()
        {
            value = format!("{number:e}");
        }
        SpecError { field: field.to_owned(), value, allowed: allowed.into() }
    }

    /// Returns the error with its field as part of larger settings: the field becomes `part.field`.
    ///
    /// ```
    /// use envgen::SpecError;
    ///
    /// let error = SpecError::new("length", -1.0, "a number from 0.01 to 4");
    /// assert_eq!(error.to_string(), "`length` must be a number from 0.01 to 4, got -1");
    /// assert_eq!(error.within("body").field, "body.length");
    /// ```
    pub fn within(self, part: &str) -> Self {
        SpecError { field: format!("{part}.{}", self.field), ..self }
    }
}

/// Formats an error: the field, what is allowed, the value, and after a colon the reason.
fn must_be(field: &str, value: &str, allowed: &str) -> String {
    match allowed.split_once(": ") {
        Some((allowed, why)) => format!("`{field}` must be {allowed}, got {value}: {why}"),
        None => format!("`{field}` must be {allowed}, got {value}"),
    }
}
