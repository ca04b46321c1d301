//! Difficulty by level, and the order of three maps.

use maud::{Markup, html};

use super::figures::inline;
use super::pieces::{key, title};
use super::{figures, words};
use crate::experiment::design::Design;
use crate::experiment::error::ExperimentError;
use crate::experiment::stats::Analysis;

/// The two sections of figure 7.
pub(super) fn section(design: &Design, analysis: &Analysis) -> Result<Markup, ExperimentError> {
    let parts = [("The paper's design", &analysis.replay), ("The larger design", &analysis.main)];
    Ok(html! {
        h2 { "Difficulty against level" }
        div.pair {
            @for (name, part) in parts {
                figure {
                    h3 { (title(name, part)) }
                    (inline(
                        figures::absolute(design, part)?,
                        "Measured difficulty by level, with the paper's statements",
                    ))
                }
            }
        }
        (key(&html! {
            span { i.dot {} "one map" }
            span { i.dash {} "difficulty equals level" }
            span { i.hollow.p {} "stated in the paper: rated 6" }
            span { b.p { "↓" } "stated: rated lower than level 1" }
            span { i.band {} "stated without numbers: near the diagonal" }
        }))
        p.note {
            "Figure 7 (a) of the paper, with new data. Bars are intervals of 95 % of the levels' means \
             (Student's t over maps). People's ratings and measured scores share the scale from 0 to 10 \
             and its ends (nothing forces an error; the map cannot be navigated), not its unit: shapes \
             can be compared, but heights only with care."
        }
        @if design.levels.len() >= 3 {
            h2 { "The order of three maps" }
            div.pair {
                @for (name, part) in parts {
                    figure {
                        h3 { (title(name, part)) }
                        (figures::relative(part)?)
                        figcaption { "Mean ranks: " (words::three_maps(part)) "." }
                    }
                }
            }
            (key(&html! { span { i.dash {} "always in order" } }))
            p.note {
                "Figure 7 (b) of the paper, with new data: all triples of maps of different levels, \
                 ranked within each policy; by chance all ranks are 2. The paper states that on \
                 average the easiest map was rated lowest, the second higher and the hardest highest, \
                 the last two close together; it prints no numbers."
            }
        }
    })
}
