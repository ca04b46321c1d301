//! Whether measures follow the level, in tables.

use maud::{Markup, html};

use super::numbers::{number, percent, some};
use super::pieces::{cell, interval, symbol, table, title, with_interval};
use crate::experiment::design::Design;
use crate::experiment::stats::{Analysis, Interval, MEASURES, Part, RESAMPLES};

/// The section.
pub(super) fn section(design: &Design, analysis: &Analysis) -> Markup {
    let parts = [("The larger design", &analysis.main), ("The paper's design", &analysis.replay)];
    html! {
        h2 { "Statistics" }
        @for (name, part) in parts {
            h3 { (title(name, part)) }
            p.note {
                @match part.critical_rho {
                    Some(rho) => {
                        "A rank correlation is significant from " (number(rho, 2))
                        " on, or from a greater one if values are equal: chance alone gives as much in 5 % of cases."
                    }
                    None => { "No rank correlation is significant: chance alone gives any in more than 5 % of cases." }
                }
            }
            (orders(part))
            (components(part))
            (means(design, part))
            (policies(part))
        }
        p.note {
            "The unit is the map: trials on one map are averaged first. Intervals of ρ are percentile \
             bootstraps over maps within levels (" (RESAMPLES) " samples), which are too narrow for few \
             maps per level; p is by permutation, one-sided. Shares of variance are the components of a \
             nested analysis of variance, policies averaged; with one noise seed the map's share holds \
             the noise. D1, M1, N1 and the parts that end in 1 are score 1. Where the variance of single \
             trials comes from is estimated with crossed factors (maps of all levels by policies), if \
             trials are repeated; signal to noise is the variance of maps over that of noise and of all \
             interactions with the map. The intervals of these are by the jackknife over maps: policies count as \
             fixed."
        }
    }
}

fn orders(part: &Part) -> Markup {
    let head = [
        cell("measure"),
        with_interval("Spearman's ρ"),
        cell("p"),
        cell("Kendall's τ"),
        html! { "neighbours" br; "in order" },
        html! { "variance" br; "of level" },
        cell("of map"),
        cell("of noise"),
    ];
    let rows = part.orders.iter().zip(&MEASURES).map(|(order, measure)| {
        let share = |share: Option<f64>| cell(share.map_or("–".to_owned(), percent));
        let p = order.p.map_or("–".to_owned(), |p| {
            if p < 0.001 { "< 0.001".to_owned() } else { number(p, 3) }
        });
        vec![
            html! { (symbol(measure.symbol)) " " small { (measure.name) } },
            interval(order.rho, 2),
            cell(p),
            cell(some(order.tau, 2)),
            html! { (order.neighbours_in_order) " of " (order.neighbours()) },
            share(order.shares.map(|shares| shares.level)),
            share(order.shares.map(|shares| shares.map)),
            share(order.shares.and_then(|shares| shares.noise)),
        ]
    });
    table("Whether measures follow the level", &head, &rows.collect::<Vec<_>>())
}

/// The parts of the variance of maps, policies, both together, and noise.
fn components(part: &Part) -> Markup {
    let Some(first) = part.components.first() else { return html! {} };
    let mut head = vec![cell("variance of single trials")];
    let effects = first.components.components.iter();
    head.extend(effects.map(|one| with_interval(&one.effect)));
    head.push(with_interval("signal to noise"));
    head.push(html! { "trials per map" br; "for ±0.2" });
    let rows = part.components.iter().map(|measure| {
        let found = &measure.components;
        let mut row = vec![symbol(measure.symbol)];
        let percent = |share: Interval| Interval {
            value: 100.0 * share.value,
            low: 100.0 * share.low,
            high: 100.0 * share.high,
        };
        let shares = found.components.iter();
        row.extend(shares.map(|one| interval(Some(percent(one.share)), 0)));
        row.push(interval(found.signal_to_noise, 2));
        row.push(cell(found.trials_for_fifth));
        row
    });
    table("Where the variance comes from, in percent", &head, &rows.collect::<Vec<_>>())
}

fn means(design: &Design, part: &Part) -> Markup {
    let mut head = vec![cell("mean of a level's maps")];
    head.extend(design.levels.iter().map(|level| with_interval(&format!("level {level}"))));
    let rows = part.orders.iter().map(|order| {
        let means = order.means.iter().map(|mean| interval(Some(mean.mean), 2));
        std::iter::once(symbol(order.measure)).chain(means).collect()
    });
    table("", &head, &rows.collect::<Vec<_>>())
}

fn policies(part: &Part) -> Markup {
    let head = [
        cell("policy"),
        with_interval("ρ of D"),
        cell("ρ of M"),
        cell("ρ of N"),
        cell("mean D"),
        cell("mean M"),
        cell("mean N"),
    ];
    let rows = part.policies.iter().map(|policy| {
        let mut row = vec![html! { code { (policy.policy) } }];
        row.extend(policy.orders.iter().map(|order| interval(order.rho, 2)));
        row.extend(policy.orders.iter().map(|order| {
            let sum: f64 = order.means.iter().map(|mean| mean.mean.value).sum();
            cell(number(sum / order.means.len() as f64, 2))
        }));
        row
    });
    table("By policy", &head, &rows.collect::<Vec<_>>())
}
