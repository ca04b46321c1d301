//! The results in sentences, which are composed from the numbers.

use envgen::indoor::Profile;
use maud::{Markup, html};

use super::numbers::{list, number, percent, said};
use crate::experiment::design::Design;
use crate::experiment::stats::{
    Analysis, EndCounts, FeatureEffect, MEASURES, Order, Part, Slope, Verdict,
};

/// The name of the rules that make maps.
fn rules_name(design: &Design) -> Markup {
    let name = match design.profile {
        Profile::Thesis => "thesis",
        Profile::Guaranteed => "guaranteed",
        Profile::Calibrated => "calibrated",
    };
    html! { code { (name) } }
}

/// The main findings, one per item of a list.
pub(super) fn findings(design: &Design, analysis: &Analysis) -> Vec<Markup> {
    let mut found: Vec<Markup> =
        (0..3).map(|measure| of_measure(design, analysis, measure)).collect();
    found.push(by_score_1(analysis));
    found.push(rules_in_general(analysis));
    found.push(how_trials_ended(design, analysis));
    found.push(beside_the_paper(design, analysis));
    found
}

/// Trials that end early have little time, turning and few collisions: score 1 rates them as easy.
fn how_trials_ended(design: &Design, analysis: &Analysis) -> Markup {
    let each = |of: &dyn Fn(&EndCounts) -> String| -> String {
        let levels = design.levels.iter().zip(&analysis.ends);
        list(
            &levels
                .map(|(level, ends)| format!("{} at level {level}", of(ends)))
                .collect::<Vec<_>>(),
        )
    };
    let lost = each(&|ends| percent(ends.share_lost()));
    let time = each(&|ends| format!("{} s", number(ends.time, 0)));
    let (first, last) = (analysis.ends.first(), analysis.ends.last());
    let early = match first.zip(last) {
        Some((first, last)) if last.time < 0.8 * first.time => {
            " Trials of the highest level end early: they leave much unmapped, but take little time, \
             turning and collisions, which N by score 1 rates as easy."
        }
        Some((first, last)) if first.time < 0.8 * last.time => {
            " Trials of the lowest level end early, which N by score 1 rates as easy."
        }
        _ => "",
    };
    html! {
        b { "How trials ended:" } " the robot was stuck or in water in " (lost)
        "; on average trials took " (time) "." (early)
    }
}

/// Whether the maps are in order in one measure, and which rule is to blame if not.
fn of_measure(design: &Design, analysis: &Analysis, measure: usize) -> Markup {
    let order = &analysis.main.orders[measure];
    let rules = rules_name(design);
    html! {
        b {
            "In " (order.measure) " (" (MEASURES[measure].name) ") "
            @match order.verdict() {
                Verdict::InOrder => { "the " (rules) " rules order the maps" }
                Verdict::OnTheWhole => {
                    "the " (rules) " rules order the maps on the whole, but not level by level"
                }
                Verdict::NotShown => {
                    "no order of the maps by the " (rules) " rules can be shown"
                }
                Verdict::Reversed => { "the " (rules) " rules order the maps in reverse" }
            }
            "."
        }
        " " (correlation(order)) ". The levels' means are " (means(order)) "; "
        (order.neighbours_in_order) " of " (order.neighbours()) " neighbouring levels are in order."
        @if order.verdict() != Verdict::InOrder { (blame(analysis, measure)) }
    }
}

/// Whether the conclusions hold if the same trials are scored by score 1.
fn by_score_1(analysis: &Analysis) -> Markup {
    let of = |symbol: &str| analysis.main.orders.iter().find(|order| order.measure == symbol);
    let said: Vec<String> = [("D", "D1"), ("M", "M1"), ("N", "N1")]
        .iter()
        .filter_map(|(own, older)| of(own).zip(of(older)))
        .map(|(own, older)| {
            let same = if own.verdict() == older.verdict() { "as" } else { "unlike" };
            let verdict = match older.verdict() {
                Verdict::InOrder => "in order",
                Verdict::OnTheWhole => "in order on the whole",
                Verdict::NotShown => "in no order that can be shown",
                Verdict::Reversed => "in reverse order",
            };
            let correlation = correlation(older);
            format!("in {} they are {verdict}, {same} above ({correlation})", older.measure)
        })
        .collect();
    html! { b { "The maps by score 1:" } " " (list(&said)) "." }
}

fn correlation(order: &Order) -> String {
    match order.rho {
        Some(rho) => {
            let p = order.p.map_or_else(String::new, |p| format!(", one-sided p {}", p_value(p)));
            format!("Spearman's ρ of level and map is {}{p}", said(rho, 2))
        }
        None => "Spearman's ρ of level and map is not defined, since nothing varies".to_owned(),
    }
}

/// A probability in words; the number of shuffles limits how small it can be.
fn p_value(p: f64) -> String {
    if p < 0.001 { "below 0.001".to_owned() } else { format!("= {}", number(p, 3)) }
}

fn means(order: &Order) -> String {
    let means = order.means.iter();
    let means: Vec<String> = means
        .map(|mean| format!("{} at level {}", number(mean.mean.value, 2), mean.level))
        .collect();
    list(&means)
}

/// The rules that work against the level in one measure.
fn blame(analysis: &Analysis, measure: usize) -> String {
    let pick = |which: fn(&Slope) -> bool| -> Vec<String> {
        let effects = analysis.rules.iter().filter(|effect| which(&effect.slopes[measure]));
        effects.map(|effect| carried(effect, measure)).collect()
    };
    let (blamed, helping) = (pick(|slope| slope.is_to_blame), pick(|slope| slope.helps));
    let helping = if helping.is_empty() {
        " No rule can be shown to make maps more difficult with the level.".to_owned()
    } else {
        format!(" Rules that work with the level: {}.", list(&helping))
    };
    if blamed.is_empty() {
        format!(" No rule can be shown to work against the level.{helping}")
    } else {
        format!(" Rules to blame: {}.{helping}", list(&blamed))
    }
}

fn carried(effect: &FeatureEffect, measure: usize) -> String {
    let carried = effect.slopes[measure].carried;
    let points = carried.map_or_else(String::new, |carried| said(carried, 2));
    format!("{}, seen in the {}: {points} points", effect.rule, feature(effect))
}

/// A feature without its unit.
fn feature(effect: &FeatureEffect) -> &'static str {
    effect.feature.split(" (").next().unwrap_or(effect.feature)
}

/// One sentence per rule: with the level, against it, or neither, over D, M and N.
fn rules_in_general(analysis: &Analysis) -> Markup {
    let direct = analysis.rules.iter().filter(|effect| effect.is_direct);
    html! {
        b { "Rule by rule:" } " "
        @for (i, effect) in direct.enumerate() {
            @if i > 0 { "; " }
            i { (effect.rule) } ": " (in_general(effect))
        }
        "."
    }
}

fn in_general(effect: &FeatureEffect) -> String {
    let symbols = |which: fn(&Slope) -> bool| -> Vec<String> {
        let slopes = effect.slopes.iter().filter(|slope| which(slope));
        slopes.map(|slope| slope.measure.to_owned()).collect()
    };
    let (against, with) = (symbols(|s| s.is_to_blame), symbols(|s| s.helps));
    match (against.is_empty(), with.is_empty()) {
        (true, true) => "no effect shown".to_owned(),
        (true, false) => format!("with the level in {}", list(&with)),
        (false, true) => format!("against the level in {}", list(&against)),
        (false, false) => {
            let (against, with) = (list(&against), list(&with));
            format!("against the level in {against}, with it in {with}")
        }
    }
}

/// The findings of the paper, and what was measured about them.
fn beside_the_paper(design: &Design, analysis: &Analysis) -> Markup {
    let Analysis { replay, main, .. } = analysis;
    let maps = replay.values.len();
    html! {
        b { "Compared with the paper:" }
        " its operators rated level 1 with 6 on average, higher than level 3, and level 9 with 6."
        (at_the_papers_levels("on as many maps", replay))
        (at_the_papers_levels("on all maps", main))
        " " (maps) " maps cannot show much: chance alone gives "
        @match replay.critical_rho {
            Some(rho) => { "a rank correlation of " (number(rho, 2)) " or more in 5 % of cases." }
            None => { "any rank correlation in more than 5 % of cases." }
        }
        @if let Some(rho) = replay.orders[0].rho {
            " That of D is " (number(rho.value, 2)) ", which "
            (if replay.orders[0].counts() { "is significant" } else { "is not significant" }) "."
        }
        @if design.levels.len() < 3 { " Two levels make no triples of maps." }
    }
}

/// D at the levels that the paper rates, if the design has them.
fn at_the_papers_levels(name: &str, part: &Part) -> String {
    let mean = |level: f64| {
        let means = &part.orders[0].means;
        means.iter().find(|mean| mean.level == level).map(|mean| mean.mean.value)
    };
    let (Some(one), Some(three), Some(nine)) = (mean(1.0), mean(3.0), mean(9.0)) else {
        return String::new();
    };
    let order = if one > three { "higher" } else { "not higher" };
    let [one, three, nine] = [one, three, nine].map(|mean| number(mean, 2));
    format!(
        " Measured {name}, D is {one} at level 1, {order} than the {three} at level 3, and {nine} at \
         level 9."
    )
}

/// The order of three maps, compared with the paper's.
pub(super) fn three_maps(part: &Part) -> String {
    let found: Vec<String> = part
        .relative
        .iter()
        .map(|relative| {
            let [a, b, c] = relative.ranks;
            let order = if a < b && b < c { "in order" } else { "not in order" };
            let ranks = relative.ranks.map(|rank| number(rank, 2)).join(", ");
            format!("{} {ranks} ({order})", relative.measure)
        })
        .collect();
    list(&found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::record::Record;
    use crate::experiment::stats::analyse;
    use crate::experiment::tests::{made_records, small};

    fn sentence(of: impl Fn(usize, u32) -> f64) -> String {
        let design = small();
        let records = made_records(&design, of);
        let records: Vec<&Record> = records.iter().collect();
        let found = findings(&design, &analyse(&design, &records)).into_iter();
        found.map(Markup::into_string).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn words_follow_the_numbers() {
        let rising = sentence(|level, map| level as f64 + 0.01 * f64::from(map));
        assert!(rising.contains("In D (difficulty) the <code>thesis</code> rules order the maps."));
        assert!(rising.contains("4 of 4 neighbouring levels are in order"), "{rising}");
        let falling = sentence(|level, map| 9.0 - level as f64 + 0.01 * f64::from(map));
        assert!(falling.contains("order the maps in reverse"), "{falling}");
        assert!(falling.contains("0 of 4 neighbouring levels"), "{falling}");
        let dented =
            sentence(|level, map| [2.0, 1.0, 3.0, 4.0, 5.0][level] + 0.01 * f64::from(map));
        assert!(dented.contains("on the whole, but not level by level"), "{dented}");
        assert!(dented.contains("level 1, higher than the"), "{dented}");
        let flat = sentence(|_, map| f64::from(map));
        assert!(flat.contains("no order of the maps"), "{flat}");
    }
}
