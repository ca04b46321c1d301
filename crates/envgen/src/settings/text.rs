//! Values of settings as text: items of lists, which may be in quotes.

use serde_json::Value;

/// Returns an item of a list as text, in quotes if it would be read as something else without them.
pub(super) fn item_text(value: &Value) -> String {
    match value.as_str() {
        Some(text) => {
            let whole = !text.is_empty() && text.trim() == text;
            let plain = whole && !text.contains(['"', ',', '[', ']']) && item(text) == *value;
            if plain { text.to_owned() } else { value.to_string() }
        }
        None => plain_text(value),
    }
}

/// Formats a number without needless decimals, and anything else as JSON.
pub(super) fn plain_text(value: &Value) -> String {
    match value.as_f64() {
        Some(number) if value.is_f64() => number.to_string(),
        _ => value.to_string(),
    }
}

/// Returns the value that a text represents: the value of its JSON, otherwise the text itself.
pub(super) fn item(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|_| text.into())
}

/// Returns the number that a text represents in a form that JSON does not have, such as `.5` or `+1`.
pub(super) fn number(text: &str) -> Option<Value> {
    // Words such as `inf` are text.
    let is_number = text.ends_with(|c: char| c.is_ascii_digit() || c == '.');
    let whole = || text.parse::<u64>().ok().map(Value::from);
    let real = || text.parse::<f64>().ok().filter(|value| value.is_finite()).map(Value::from);
    is_number.then(|| whole().or_else(real)).flatten()
}

/// Returns the items of a list, separated by commas; or a description of what is wrong with its quotes.
pub(super) fn items(list: &str) -> Result<Vec<Value>, &'static str> {
    let mut items = Vec::new();
    let mut rest = Some(list).filter(|list| !list.is_empty());
    while let Some(list) = rest.map(str::trim_start) {
        if list.starts_with('"') {
            let (text, after) = quoted(list)?;
            items.push(text.into());
            rest = match after.trim_start() {
                "" => None,
                after => Some(
                    after.strip_prefix(',').ok_or("a comma is missing after a closing quote")?,
                ),
            };
        } else {
            let (text, after) =
                list.split_once(',').map_or((list, None), |(text, after)| (text, Some(after)));
            items.push(item(text.trim()));
            rest = after;
        }
    }
    Ok(items)
}

/// Returns the text in quotes and the rest of the text; or a description of what is wrong with the quotes.
fn quoted(text: &str) -> Result<(String, &str), &'static str> {
    let mut values = serde_json::Deserializer::from_str(text).into_iter::<String>();
    match values.next() {
        Some(Ok(value)) => Ok((value, &text[values.byte_offset()..])),
        Some(Err(error)) if !error.is_eof() => Err("in quotes, a backslash is written as two"),
        _ => Err("a quote is not closed"),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use crate::settings::Setting;

    #[test]
    fn items_in_quotes_hold_commas() {
        let list = Setting::list("rooms", "", "names of rooms", "which rooms");
        for text in [r#""a, b",maze,"""#, r#"[ "a, b" , maze, "" ]"#, r#""a, b", maze ,"""#] {
            let items = serde_json::json!(["a, b", "maze", ""]);
            assert_eq!(list.parse(text).unwrap(), items, "{text}");
        }
        let quotes = serde_json::json!(["a \"b\", c", "5\" pipe", "\\"]);
        assert_eq!(list.parse(r#""a \"b\", c",5" pipe,\"#).unwrap(), quotes);
        for (text, why) in [
            (r#"maze,"a, b"#, "a quote is not closed"),
            (r#"["a, b]"#, "a quote is not closed"),
            (r#""a, b\""#, "a quote is not closed"),
            (r#""a, b" c,maze"#, "a comma is missing after a closing quote"),
            (r#""a\c""#, "in quotes, a backslash is written as two"),
        ] {
            let expected = format!("`rooms` must be a list of names of rooms, got {text}: {why}");
            assert_eq!(list.parse(text).unwrap_err().to_string(), expected);
        }
    }

    #[test]
    fn numbers_are_those_of_other_settings() {
        let list = Setting::list("speeds", "", "numbers", "how fast");
        let items = Setting::numbers(&list.parse("1,.5,+1,1.,-.25,+2.5,007").expect("a list"));
        assert_eq!(items, serde_json::json!([1, 0.5, 1, 1.0, -0.25, 2.5, 7]));
        let words = ["inf", "NaN", "+", ".", "1e999", "++1", "+-1", "1.2.3"];
        let items = Setting::numbers(&list.parse(&words.join(",")).expect("a list"));
        assert_eq!(items, serde_json::json!(words));
        let speed = Setting::number("speed", "m/s", 0.0, 10.0, "how fast");
        for text in [".5", "+1", "1.", "007"] {
            let one = Setting::numbers(&list.parse(text).expect("a list"));
            assert_eq!(one[0].as_f64(), speed.parse(text).expect("a number").as_f64(), "{text}");
        }
    }

    #[test]
    fn values_are_written_as_they_are_read() {
        let width = Setting::number("width", "m", 0.5, 10.0, "how wide");
        let list = Setting::list("rooms", "", "names of rooms", "which rooms");
        let names = [
            "maze", "a, b", "\"a", "5\" pipe", "", " a", "3", "+3", ".5", "true", "null", "[a",
            "b]", "\\", "ä",
        ];
        let (all, ends) = (serde_json::json!(names), serde_json::json!(["[a", "b]"]));
        let one = names.map(|name| serde_json::json!([name]));
        for items in one.iter().chain([&all, &ends, &serde_json::json!([1, 0.5, null])]) {
            let text = list.text_of(items);
            assert_eq!(list.parse(&text).as_ref(), Ok(items), "{text}");
        }
        assert_eq!(list.text_of(&serde_json::json!(["maze", "a, b"])), r#"maze,"a, b""#);
        assert_eq!(width.text_of(&Value::Null), "none");
        assert_eq!(width.text_of(&2.0.into()), "2");
        assert_eq!(width.text_of(&u64::MAX.into()), u64::MAX.to_string());
        let other = Setting::other("catalogue", "", "rooms", "which rooms");
        for value in [serde_json::json!([{ "name": "a, b" }, ["c"]]), serde_json::json!(["a"])] {
            assert_eq!(other.parse(&other.text_of(&value)), Ok(value));
        }
    }
}
