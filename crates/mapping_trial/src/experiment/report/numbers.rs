//! Formats numbers and lists in words.

use crate::experiment::stats::Interval;

/// Formats a number with `digits` decimals and a true minus sign.
pub(super) fn number(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{value:.digits$}");
    let zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
    if zero { text.trim_start_matches('-').to_owned() } else { text.replace('-', "−") }
}

/// Formats a number that may be absent.
pub(super) fn some(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "–".to_owned(), |value| number(value, digits))
}

/// Formats a fraction in percent.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share, 0))
}

/// Formats an estimate and its interval for a sentence.
pub(super) fn said(interval: Interval, digits: usize) -> String {
    let Interval { value, low, high } = interval;
    let [value, low, high] = [value, low, high].map(|x| number(x, digits));
    format!("{value} ({low} to {high})")
}

/// Formats words as `a, b and c`.
pub(super) fn list(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [others @ .., last] => format!("{} and {last}", others.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(number(-0.001, 2), "0.00");
        assert_eq!(number(-1.5, 1), "−1.5");
        assert_eq!(number(f64::NAN, 1), "–");
        assert_eq!(percent(0.125), "12 %");
        assert_eq!(list(&["a".to_owned(), "b".to_owned(), "c".to_owned()]), "a, b and c");
    }
}
