//! Limits of settings.

use envgen::SpecError;
use envgen::settings::Setting;

/// Greatest time limit of a trial in simulated seconds: one day.
pub const MAX_TIME_LIMIT: f64 = 86_400.0;

/// Checks a number that is no field of its own, or whose limits depend on other numbers.
///
/// # Errors
///
/// Names the field, the value and the limits.
pub(crate) fn number(
    field: &'static str,
    value: f64,
    least: f64,
    most: f64,
) -> Result<(), SpecError> {
    Setting::number(field, "", least, most, "").check(value)
}
