//! Text for YAML files.

use std::fmt::Write;

/// Quotes a text in double quotes, with the escapes of JSON.
pub(super) fn quoted(text: &str) -> String {
    // JSON's strings are those of YAML but for characters that YAML does not print.
    let json = serde_json::Value::from(text).to_string();
    let is_printed = |c: char| {
        !matches!(
            c,
            '\u{7f}'..='\u{9f}' | '\u{2028}' | '\u{2029}' | '\u{feff}' | '\u{fffe}' | '\u{ffff}'
        )
    };
    let mut escaped = String::with_capacity(json.len());
    for c in json.chars() {
        if is_printed(c) {
            escaped.push(c);
        } else {
            write!(escaped, "\\u{:04x}", u32::from(c)).ok();
        }
    }
    escaped
}
