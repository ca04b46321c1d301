//! What is wrong with the YAML of a map, for someone who did not write the reader.

use serde_saphyr::{Error, MessageFormatter, UserMessageFormatter};

/// The longest line that is repeated, in letters.
const MAX_LINE: usize = 60;

/// What is wrong with a text, and where.
pub(super) fn reason(error: &Error, yaml: &str) -> String {
    let error = original(error);
    let text = match error {
        Error::SerdeMissingField { field, .. } => return format!("`{field}` is missing"),
        Error::DuplicateMappingKey { .. } => "the key stands there twice".to_owned(),
        Error::Eof { .. } => "the text ends too early".to_owned(),
        Error::InvalidScalar { ty, .. } if ty.contains("float") => "not a number".to_owned(),
        Error::SerdeInvalidType { .. } | Error::SerdeInvalidLength { .. } => {
            "not of the form that the key has".to_owned()
        }
        Error::Unexpected { expected, .. } if expected.contains("mapping") => {
            "not a key with its value".to_owned()
        }
        Error::Unexpected { expected, .. } if expected.contains("sequence") => {
            "not a list in brackets".to_owned()
        }
        Error::Unexpected { .. } => "not a text or a number".to_owned(),
        // The fields of a map put their names into backticks, the scanner of YAML has other words.
        Error::Message { msg, .. } if msg.starts_with('`') => msg.clone(),
        Error::Message { .. } | Error::ExternalMessage { .. } => {
            "not written as YAML is".to_owned()
        }
        Error::SerdeUnknownVariant { variant, expected, .. } => {
            format!("`{variant}` is none of {}", expected.join(", "))
        }
        Error::Budget { .. } => "more than the map of a robot needs".to_owned(),
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

/// The error behind pictures of the text and references to other places.
fn original(mut error: &Error) -> &Error {
    while let Error::WithSnippet { error: inner, .. } | Error::AliasError { error: inner, .. } =
        error
    {
        error = inner;
    }
    error
}
