//! The head: the file that describes what a folder holds.

use std::io;
use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::error::ExperimentError;
use super::lines::Lines;
use super::write;

/// Name of the head in the folder of a survey.
pub(super) const SURVEY: &str = "survey.json";

/// Name of the head in the folder of an experiment.
pub(super) const EXPERIMENT: &str = "experiment.json";

/// Greatest number of characters of a value in an error.
const LONGEST: usize = 100;

/// A kind of head.
pub(super) struct Kind {
    /// Name of the file.
    pub(super) file: &'static str,
    /// The name of its content in errors.
    pub(super) what: &'static str,
    /// The version that can be read.
    pub(super) version: u32,
}

/// Locks a folder for what `head` describes, whether it is new or continued, and reads its trials.
/// `difference` returns what errors say about another description.
///
/// # Errors
///
/// If the folder cannot be written, holds something else, or is in use.
pub(super) fn lock<T: Serialize + DeserializeOwned + PartialEq>(
    folder: &Path,
    kind: &Kind,
    head: &T,
    difference: impl Fn(&T, &T) -> String,
) -> Result<(Lines, String), ExperimentError> {
    write::folder(folder)?;
    let path = folder.join(kind.file);
    let content = |reason: String| ExperimentError::Content { path: folder.to_owned(), reason };
    let is_begun = || match read(&path, kind.what, kind.version)? {
        Some(found) if found != *head => {
            let difference = difference(&found, head);
            Err(ExperimentError::Other { path: folder.to_owned(), difference })
        }
        found => Ok(found.is_some()),
    };
    let is_other = |file: &&str| *file != kind.file && folder.join(file).exists();
    let find_other = || match [SURVEY, EXPERIMENT].iter().find(|file| is_other(file)) {
        Some(other) => {
            Err(content(format!("the folder has a file {other}: it holds something else")))
        }
        None => Ok(()),
    };
    // Files that are not ours are not touched.
    if !is_begun()? {
        find_other()?;
    }
    // Only the process with the lock begins, since another process may have begun something else
    // meanwhile.
    let (mut lines, text) = Lines::open(folder)?;
    if !is_begun()? {
        find_other()?;
        if !lines.is_empty() {
            let file = kind.file;
            return Err(content(format!("there are trials, but no {file} that describes them")));
        }
        write(&path, head)?;
    }
    lines.drop_rest(&text)?;
    Ok((lines, text))
}

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
///
/// If the file cannot be read, is something else, or has another `version`.
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
    let value: Value = serde_json::from_str(&text).map_err(not)?;
    // The version is read first, since another one may have other fields.
    let found = value.get("version").and_then(Value::as_u64);
    if let Some(found) = found.filter(|&found| found != u64::from(version)) {
        return Err(content(format!("{what} of version {found}, expected {version}")));
    }
    // Parses the text, as for records: from the value, the same code would be compiled once more.
    serde_json::from_str(&text).map(Some).map_err(not)
}

/// Returns the first difference between two descriptions: the path to a value, the value, and the
/// expected value.
pub(super) fn difference<T: Serialize>(found: &T, asked: &T) -> String {
    let value = |head: &T| -> Value {
        // Compares by the text that `write` writes, for the same reason as in `read`.
        let text = serde_json::to_string_pretty(head);
        text.and_then(|text| serde_json::from_str(&text)).unwrap_or_default()
    };
    first_difference(String::new(), &value(found), &value(asked)).unwrap_or_default()
}

fn first_difference(path: String, found: &Value, asked: &Value) -> Option<String> {
    match (found, asked) {
        _ if found == asked => None,
        (Value::Object(found), Value::Object(asked)) => {
            let names = found.keys().chain(asked.keys().filter(|name| !found.contains_key(*name)));
            let dot = if path.is_empty() { "" } else { "." };
            let mut differences = names.filter_map(|name| {
                let [found, asked] =
                    [found, asked].map(|fields| fields.get(name).unwrap_or(&Value::Null));
                first_difference(format!("{path}{dot}{name}"), found, asked)
            });
            differences.next()
        }
        (Value::Array(found), Value::Array(asked)) if found.len() == asked.len() => {
            let pairs = found.iter().zip(asked).enumerate();
            let mut differences = pairs.filter_map(|(i, (found, asked))| {
                first_difference(format!("{path}[{i}]"), found, asked)
            });
            differences.next()
        }
        (Value::Array(found), Value::Array(asked)) => {
            Some(format!("`{path}` has {} entries, expected {}", found.len(), asked.len()))
        }
        _ => Some(format!("`{path}` is {}, expected {}", short(found), short(asked))),
    }
}

/// A value as JSON, cut if it is long.
fn short(value: &Value) -> String {
    let text = value.to_string();
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn nothing_is_begun_in_a_folder_that_is_in_use() {
        let folder = tempfile::tempdir().unwrap();
        let kind = Kind { file: EXPERIMENT, what: "an experiment", version: 1 };
        let begin = |seed: u32| {
            lock(folder.path(), &kind, &json!({ "version": 1, "seed": seed }), difference)
        };
        // Another process has the lock, and has not written yet what it begins.
        let held = Lines::open(folder.path()).unwrap();
        assert!(matches!(begin(1), Err(ExperimentError::Busy(_))));
        assert!(!folder.path().join(EXPERIMENT).exists());
        drop(held);
        drop(begin(2).unwrap());
        assert!(matches!(begin(1), Err(ExperimentError::Other { .. })));
        let survey = Kind { file: SURVEY, ..kind };
        let refused = lock(folder.path(), &survey, &json!({ "version": 1 }), difference);
        let error = refused.unwrap_err().to_string();
        assert!(error.contains("has a file experiment.json"), "{error}");
        drop(begin(2).unwrap());
    }

    #[test]
    fn what_something_else_wrote_stays() {
        let folder = tempfile::tempdir().unwrap();
        let kind = Kind { file: EXPERIMENT, what: "an experiment", version: 1 };
        let path = folder.path().join("trials.jsonl");
        // Without a line end, and with one line that has it.
        for foreign in ["{\"my\": \"only data\"}", "mine\nand mine"] {
            std::fs::write(&path, foreign).unwrap();
            let error = lock(folder.path(), &kind, &json!({ "version": 1 }), difference);
            let error = error.unwrap_err().to_string();
            assert!(error.contains("no experiment.json that describes them"), "{error}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), foreign);
            assert!(!folder.path().join(EXPERIMENT).exists());
        }
    }

    #[test]
    fn a_difference_is_named_by_its_path() {
        let found = json!({
            "version": 1,
            "survey": { "families": [{ "name": "a", "maps": 2 }, { "name": "b" }], "seeds": 3 },
        });
        let with = |change: &dyn Fn(&mut Value)| {
            let mut asked = found.clone();
            change(&mut asked);
            difference(&found, &asked)
        };
        assert_eq!(with(&|_| ()), "");
        let seeds = with(&|asked| asked["survey"]["seeds"] = json!(12));
        assert_eq!(seeds, "`survey.seeds` is 3, expected 12");
        let name = with(&|asked| asked["survey"]["families"][1]["name"] = json!("c"));
        assert_eq!(name, "`survey.families[1].name` is \"b\", expected \"c\"");
        // A field that files leave out where it has its default.
        let new = with(&|asked| asked["survey"]["families"][1]["maps"] = json!(7));
        assert_eq!(new, "`survey.families[1].maps` is null, expected 7");
        let fewer = with(&|asked| asked["survey"]["families"] = json!([]));
        assert_eq!(fewer, "`survey.families` has 2 entries, expected 0");
        let other = with(&|asked| asked["survey"] = json!("x".repeat(1000)));
        assert!(other.len() < 300 && other.starts_with("`survey` is {\"families\""), "{other}");
    }
}
