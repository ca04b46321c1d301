//! Which rule makes maps difficult, and what the weights of the scores decide.

use maud::{Markup, html};

use super::figures;
use super::numbers::{number, some};
use super::pieces::{cell, head, interval, key, rule, symbol, table, with_interval};
use crate::experiment::design::Design;
use crate::experiment::error::ExperimentError;
use crate::experiment::stats::Analysis;

/// The section about the rules.
pub(super) fn section(design: &Design, analysis: &Analysis) -> Result<Markup, ExperimentError> {
    Ok(html! {
        h2 { "Which rule is to blame" }
        p {
            "Each rule moves a feature of the maps with the level (its trend). Between maps of one level \
             the feature varies by chance, and difficulty with it (its effect, level means removed). \
             Trend times effect is what the rule adds from the lowest to the highest level. Right of 0 \
             the rule does what it should; a rule whose interval is left of 0 makes maps easier when it \
             should make them harder."
        }
        figure { (figures::rules(&analysis.rules)?) }
        (key(&Markup::default()))
        (trends(design, analysis))
        (effects(analysis))
        p.note {
            "Effects are least-squares slopes over the larger design's maps; \"others fixed\" holds the \
             five rules' own features fixed together. Intervals are percentile bootstraps over maps \
             within levels. Of twenty effects of size 0, one is beyond its interval by chance."
        }
    })
}

fn trends(design: &Design, analysis: &Analysis) -> Markup {
    let mut head = vec![cell("feature")];
    head.extend(design.levels.iter().map(|level| cell(format!("level {level}"))));
    head.push(with_interval("trend per level"));
    let rows = analysis.rules.iter().map(|effect| {
        let mut row = vec![rule(effect)];
        row.extend(effect.means.iter().map(|&mean| cell(number(mean, 2))));
        row.push(interval(effect.trend, 3));
        row
    });
    let caption = "What the rules make of the maps: means of levels";
    table(caption, &head, &rows.collect::<Vec<_>>())
}

fn effects(analysis: &Analysis) -> Markup {
    let head = [
        cell("rule"),
        cell("of"),
        with_interval("effect of one unit"),
        with_interval("others fixed"),
        with_interval("points added"),
        Markup::default(),
    ];
    let rows = analysis.rules.iter().flat_map(|effect| {
        effect.slopes.iter().enumerate().map(move |(i, slope)| {
            let verdict = match (slope.is_to_blame, slope.helps) {
                (true, _) => html! { span.bad { "to blame" } },
                (_, true) => html! { span.good { "works" } },
                _ => Markup::default(),
            };
            vec![
                if i == 0 { rule(effect) } else { Markup::default() },
                symbol(slope.measure),
                interval(slope.within, 2),
                interval(slope.others_fixed, 2),
                interval(slope.carried, 2),
                verdict,
            ]
        })
    });
    let caption = "What the features do to difficulty, between maps of one level";
    table(caption, &head, &rows.collect::<Vec<_>>())
}

/// The section about the weights.
pub(super) fn weights(analysis: &Analysis) -> Markup {
    let head = head(["weight", "τ at 0.5", "most places", "ρ", "τ at 1.5", "most places", "ρ"]);
    let rows = analysis.weights.chunks(2).map(|pair| {
        let mut row = vec![cell(pair[0].sensitivity.weight)];
        for weighting in pair {
            row.push(cell(some(weighting.sensitivity.tau, 3)));
            row.push(cell(weighting.sensitivity.most_places));
            row.push(cell(some(weighting.rho, 2)));
        }
        row
    });
    html! {
        h2 { "What the weights decide" }
        p {
            "D is a weighted mean. With each weight in turn multiplied by 0.5 and by 1.5, the larger \
             design's maps are ranked again: τ compares with the ranking before, ρ is that of level and D."
        }
        (table("", &head, &rows.collect::<Vec<_>>()))
    }
}
