//! The file that describes what a folder holds.

use std::io;
use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::error::ExperimentError;
use super::write;

/// Writes the description of a folder as JSON.
pub(super) fn write<T: Serialize>(path: &Path, head: &T) -> Result<(), ExperimentError> {
    let content = |error: serde_json::Error| ExperimentError::Content {
        path: path.to_owned(),
        reason: error.to_string(),
    };
    let mut bytes = serde_json::to_vec_pretty(head).map_err(content)?;
    bytes.push(b'\n');
    write::whole(path, &bytes)
}

/// Reads the description of a folder, which errors call `what`; `None` if the file does not exist.
///
/// # Errors
/// A file that cannot be read, is something else, or has another `version`.
pub(super) fn read<T: DeserializeOwned>(
    path: &Path,
    what: &str,
    version: u32,
) -> Result<Option<T>, ExperimentError> {
    let content = |reason: String| ExperimentError::Content { path: path.to_owned(), reason };
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(ExperimentError::File { path: path.to_owned(), source }),
    };
    let not = |error: serde_json::Error| content(format!("this is not {what}: {error}"));
    let value: serde_json::Value = serde_json::from_str(&text).map_err(not)?;
    // The version first: another one may have other fields.
    let found = value.get("version").and_then(serde_json::Value::as_u64);
    if let Some(found) = found.filter(|&found| found != u64::from(version)) {
        return Err(content(format!("{what} of version {found}, expected {version}")));
    }
    // From the text, as the records are: from the value, all of it would be compiled once more.
    serde_json::from_str(&text).map(Some).map_err(not)
}

/// The first difference between the fields of two descriptions.
pub(super) fn difference<T: Serialize>(found: &T, asked: &T) -> String {
    let fields = |head: &T| -> serde_json::Map<String, serde_json::Value> {
        // By the text that `write` writes: for the same reason as in `read`.
        let text = serde_json::to_string_pretty(head);
        text.and_then(|text| serde_json::from_str(&text)).unwrap_or_default()
    };
    let (found, asked) = (fields(found), fields(asked));
    let mut differ = found.iter().filter(|(name, value)| asked.get(*name) != Some(*value));
    differ.next().map_or_else(String::new, |(name, value)| {
        let asked = asked.get(name).unwrap_or(&serde_json::Value::Null);
        format!("`{name}` is {value}, expected {asked}")
    })
}
