//! Pieces of a page.

use std::fmt::Write;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;

use crate::experiment::stats::Interval;

/// The style of the page: one column, tables with aligned numbers.
pub(super) const STYLE: &str = "\
:root{--ink:#1c2733;--soft:#5b6875;--line:#d9dfe5;--paper:#fff;--wash:#f5f7f9;--d:#1f5fa8;--m:#c4560b;--n:#2b7f5d;--p:#a3195b}\
*{box-sizing:border-box}\
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 system-ui,-apple-system,'Segoe UI',Roboto,'Noto Sans','Liberation Sans',sans-serif}\
main{max-width:1120px;margin:0 auto;padding:40px 28px 80px}\
h1{font-size:30px;line-height:1.2;margin:0 0 6px;letter-spacing:-.01em}\
h2{font-size:21px;margin:52px 0 10px;padding-top:14px;border-top:2px solid var(--ink)}\
h3{font-size:16px;margin:26px 0 8px}figure h3{margin-top:6px}h3 small{font-weight:400;margin-left:8px}\
p{margin:8px 0;max-width:78ch}\
.lead{color:var(--soft);font-size:17px}\
.findings{background:var(--wash);border-left:4px solid var(--d);padding:12px 22px;margin:22px 0}\
.findings li{margin:7px 0;max-width:84ch}\
.note{color:var(--soft);font-size:14px}\
.pair{display:grid;grid-template-columns:1fr 1fr;gap:22px}\
figure{margin:14px 0}\
figure svg{width:100%;height:auto;display:block}\
figcaption{font-size:14px;color:var(--soft);margin-top:6px;max-width:100ch}\
.key{display:flex;flex-wrap:wrap;gap:6px 20px;font-size:14px;margin:10px 0 0}\
.key span{display:inline-flex;align-items:center;gap:7px}\
.key i{display:inline-block;width:18px;height:0;border-top:3px solid}\
.key i.dot{width:9px;height:9px;border:0;border-radius:50%}\
.key i.hollow{width:10px;height:10px;border:2px solid;transform:rotate(45deg)}\
.key i.band{width:18px;height:12px;border:0;opacity:.25}\
.key i.dash{border-top:2px dashed}\
.scroll{overflow-x:auto}\
table{border-collapse:collapse;font-size:14px;font-variant-numeric:tabular-nums;margin:10px 0;min-width:60%}\
caption{text-align:left;color:var(--soft);padding:0 0 6px}\
th,td{padding:4px 9px;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}\
thead th{border-bottom:1.5px solid var(--ink);font-weight:600;vertical-align:bottom}\
th:first-child,td:first-child,.l{text-align:left}\
td small,th small{color:var(--soft);font-size:12px;font-weight:400}\
.bad{color:#b3261e;font-weight:600}.good{color:#1d6b45;font-weight:600}\
.maps{display:grid;grid-template-columns:repeat(3,1fr);gap:10px;margin:8px 0 22px}\
.maps img{width:100%;display:block;border:1px solid var(--line);image-rendering:auto}\
.maps div{font-size:13px;color:var(--soft)}\
details summary{cursor:pointer;font-weight:600;margin:10px 0}\
code{font:13px ui-monospace,'DejaVu Sans Mono',monospace;background:var(--wash);padding:1px 4px}\
@media(max-width:760px){.pair,.maps{grid-template-columns:1fr}}\
@media print{h2{break-after:avoid}figure,.maps{break-inside:avoid}}";

/// Text with HTML's special characters escaped.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A number with `digits` digits after the point; a true minus sign.
pub(super) fn number(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{value:.digits$}");
    let zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
    if zero { text.trim_start_matches('-').to_owned() } else { text.replace('-', "−") }
}

/// A number that may be absent.
pub(super) fn some(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "–".to_owned(), |value| number(value, digits))
}

/// A share in percent.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share, 0))
}

/// An estimate and its interval, the latter small.
pub(super) fn interval(interval: Option<Interval>, digits: usize) -> String {
    interval.map_or_else(
        || "–".to_owned(),
        |Interval { value, low, high }| {
            let [value, low, high] = [value, low, high].map(|x| number(x, digits));
            format!("{value} <small>{low} to {high}</small>")
        },
    )
}

/// An estimate and its interval in a sentence.
pub(super) fn said(interval: Interval, digits: usize) -> String {
    let Interval { value, low, high } = interval;
    let [value, low, high] = [value, low, high].map(|x| number(x, digits));
    format!("{value} ({low} to {high})")
}

/// Words as `a, b and c`.
pub(super) fn list(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [others @ .., last] => format!("{} and {last}", others.join(", ")),
    }
}

/// A table: the head's and the rows' cells are HTML.
pub(super) fn table(caption: &str, head: &[String], rows: &[Vec<String>]) -> String {
    let mut html = String::from("<div class=\"scroll\"><table>");
    if !caption.is_empty() {
        let _ = write!(html, "<caption>{caption}</caption>");
    }
    html.push_str("<thead><tr>");
    for cell in head {
        let _ = write!(html, "<th>{cell}</th>");
    }
    html.push_str("</tr></thead><tbody>\n");
    for row in rows {
        html.push_str("<tr>");
        for cell in row {
            let _ = write!(html, "<td>{cell}</td>");
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody></table></div>\n");
    html
}

/// A picture within the page.
pub(super) fn image(png: &[u8], alt: &str) -> String {
    let data = BASE64_STANDARD.encode(png);
    format!("<img alt=\"{}\" src=\"data:image/png;base64,{data}\">", escape(alt))
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
        assert_eq!(escape("<a href=\"&\">"), "&lt;a href=&quot;&amp;&quot;&gt;");
    }
}
