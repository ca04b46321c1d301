//! Checks of numbers that users set.

use envgen::SpecError;

/// Greatest time limit of a trial in simulated seconds: one day.
pub const MAX_TIME_LIMIT: f64 = 86_400.0;

/// Checks that a number lies within its limits; NaN never does.
pub(crate) fn number(field: &str, value: f64, least: f64, most: f64) -> Result<(), SpecError> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    Err(SpecError::new(field, value, format!("a number from {least} to {most}")))
}
