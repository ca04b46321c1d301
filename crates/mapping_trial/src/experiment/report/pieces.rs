//! Pieces of the page.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use maud::{Markup, Render, html};

use super::numbers::number;
use crate::experiment::stats::{FeatureEffect, Interval, Part};

/// An estimate and its interval, the latter small.
pub(crate) fn interval(interval: Option<Interval>, digits: usize) -> Markup {
    let Some(Interval { value, low, high }) = interval else { return cell("–") };
    let [value, low, high] = [value, low, high].map(|x| number(x, digits));
    html! { (value) " " small { (low) " to " (high) } }
}

/// A cell of a table with text.
pub(crate) fn cell(text: impl Render) -> Markup {
    html! { (text) }
}

/// The head of a table in which every cell is text.
pub(crate) fn head<const N: usize>(texts: [&str; N]) -> Vec<Markup> {
    texts.map(cell).into()
}

/// A column's name with the size of the intervals in it.
pub(crate) fn with_interval(name: &str) -> Markup {
    html! { (name) " " small { "95 %" } }
}

/// A table, which can be scrolled if it is wide.
pub(crate) fn table(caption: &str, head: &[Markup], rows: &[Vec<Markup>]) -> Markup {
    html! {
        div.scroll {
            table {
                @if !caption.is_empty() {
                    caption { (caption) }
                }
                thead {
                    tr {
                        @for cell in head {
                            th { (cell) }
                        }
                    }
                }
                tbody {
                    @for row in rows {
                        tr {
                            @for cell in row {
                                td { (cell) }
                            }
                        }
                        "\n"
                    }
                }
            }
        }
    }
}

/// A picture within the page.
pub(super) fn image(png: &[u8], alt: &str) -> Markup {
    let source = format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png));
    html! { img alt=(alt) src=(source); }
}

/// The symbol of a measure, such as `e_wall`.
pub(super) fn symbol(symbol: &str) -> Markup {
    match symbol.split_once('_') {
        Some((letter, index)) => html! { i { (letter) } sub { (index) } },
        None => html! { b { (symbol) } },
    }
}

/// A rule, and the feature that it moves.
pub(super) fn rule(effect: &FeatureEffect) -> Markup {
    html! { (effect.rule) br; small { (effect.feature) } }
}

/// The title of a design's part.
pub(super) fn title(name: &str, part: &Part) -> String {
    format!("{name}: {} maps, {} trials", part.values.len(), part.trials)
}

/// The key of a figure: its colours, and further entries.
pub(super) fn key(others: &Markup) -> Markup {
    html! {
        div.key {
            span { i.d {} "D, overall" }
            span { i.m {} "M, mapping" }
            span { i.n {} "N, navigation" }
            (others)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped() {
        let rows = [vec![cell("<a href=\"&\">")]];
        let table = table("", &head(["a & b"]), &rows).into_string();
        assert!(table.contains("<th>a &amp; b</th>"), "{table}");
        assert!(table.contains("<td>&lt;a href=&quot;&amp;&quot;&gt;</td>"), "{table}");
        assert!(image(b"", "<\"").into_string().contains("alt=\"&lt;&quot;\""));
    }

    #[test]
    fn symbols_have_their_index() {
        assert_eq!(symbol("e_wall").into_string(), "<i>e</i><sub>wall</sub>");
        assert_eq!(symbol("D").into_string(), "<b>D</b>");
    }
}
