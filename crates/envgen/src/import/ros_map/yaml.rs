//! Readable errors for the YAML of a map.

use serde_saphyr::{Error, MessageFormatter, UserMessageFormatter};

/// The greatest length of a line that an error quotes, in letters.
const MAX_LINE: usize = 60;

/// Describes the mistake in a text, and its position.
pub(super) fn reason(error: &Error, yaml: &str) -> String {
    let error = original(error);
    let text = match error {
        Error::SerdeMissingField { field, .. } => return format!("`{field}` is missing"),
        Error::DuplicateMappingKey { .. } => "the key occurs twice".to_owned(),
        Error::Eof { .. } => "the text ends too early".to_owned(),
        Error::InvalidScalar { ty, .. } if ty.contains("float") => "not a number".to_owned(),
        Error::SerdeInvalidType { .. } | Error::SerdeInvalidLength { .. } => {
            "not in the form that the key requires".to_owned()
        }
        Error::Unexpected { expected, .. } if expected.contains("mapping") => {
            "not a key with its value".to_owned()
        }
        Error::Unexpected { expected, .. } if expected.contains("sequence") => {
            "not a list in brackets".to_owned()
        }
        Error::Unexpected { .. } => "not a text or a number".to_owned(),
        // Errors about fields of a map put the names into backticks; the YAML scanner uses other words.
        Error::Message { msg, .. } if msg.starts_with('`') => msg.clone(),
        Error::Message { .. } | Error::ExternalMessage { .. } => "not valid YAML".to_owned(),
        Error::SerdeUnknownVariant { variant, expected, .. } => {
            format!("`{variant}` is not one of {}", expected.join(", "))
        }
        Error::Budget { .. } => "more data than a map needs".to_owned(),
        other => UserMessageFormatter.format_message(other).into_owned(),
    };
    let Some(number) = error.location().map(|at| at.line()).filter(|line| *line > 0) else {
        return text.to_owned();
    };
    match yaml.lines().nth(number as usize - 1).map(str::trim) {
        Some(line) if !line.is_empty() && line.chars().count() <= MAX_LINE => {
            format!("line {number}, `{line}`: {text}")
        }
        _ => format!("line {number}: {text}"),
    }
}

/// Returns the original error, without quotations of the text and references to other positions.
fn original(mut error: &Error) -> &Error {
    while let Error::WithSnippet { error: inner, .. } | Error::AliasError { error: inner, .. } =
        error
    {
        error = inner;
    }
    error
}
