//! The results in sentences made of the numbers.

use super::page::{list, number, percent, said};
use crate::experiment::design::Design;
use crate::experiment::stats::{
    Analysis, Ends, FeatureEffect, MEASURES, Order, Part, Slope, Verdict,
};

/// The name of the rules that make maps.
fn rules_name(design: &Design) -> &'static str {
    match design.profile {
        envgen::indoor::Profile::Thesis => "<code>thesis</code>",
        envgen::indoor::Profile::Guaranteed => "<code>guaranteed</code>",
    }
}

/// The main findings, as HTML of list items.
pub(super) fn findings(design: &Design, analysis: &Analysis) -> Vec<String> {
    let mut found: Vec<String> =
        (0..3).map(|measure| of_measure(design, analysis, measure)).collect();
    found.push(rules_in_general(analysis));
    found.push(how_trials_ended(design, analysis));
    found.push(beside_the_paper(design, analysis));
    found
}

/// Trials that end early have little time, turning and collisions: N rates them as easy.
fn how_trials_ended(design: &Design, analysis: &Analysis) -> String {
    let each = |of: &dyn Fn(&Ends) -> String| -> String {
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
             turning and collisions, which N rates as easy."
        }
        Some((first, last)) if first.time < 0.8 * last.time => {
            " Trials of the lowest level end early, which N rates as easy."
        }
        _ => "",
    };
    format!(
        "<b>How trials ended:</b> the robot was stuck or in water in {lost}; on average trials took {time}.{early}"
    )
}

/// Whether the maps are in order in one measure, and which rule is to blame if not.
fn of_measure(design: &Design, analysis: &Analysis, measure: usize) -> String {
    let order = &analysis.main.orders[measure];
    let (symbol, name) = (order.measure, MEASURES[measure].name);
    let rules = rules_name(design);
    let verdict = match order.verdict() {
        Verdict::InOrder => format!("the {rules} rules order the maps"),
        Verdict::OnTheWhole => {
            format!("the {rules} rules order the maps on the whole, but not level by level")
        }
        Verdict::NotShown => format!("no order of the maps by the {rules} rules can be shown"),
        Verdict::Reversed => format!("the {rules} rules order the maps in reverse"),
    };
    let mut text = format!("<b>In {symbol} ({name}) {verdict}.</b> {}.", correlation(order));
    text.push_str(&format!(
        " The levels' means are {}; {} of {} neighbouring levels are in order.",
        means(order),
        order.neighbours_in_order,
        order.neighbours()
    ));
    if order.verdict() != Verdict::InOrder {
        text.push_str(&blame(analysis, measure));
    }
    text
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
pub(super) fn p_value(p: f64) -> String {
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
        format!(" What works with the level: {}.", list(&helping))
    };
    if blamed.is_empty() {
        format!(" No rule can be shown to work against the level.{helping}")
    } else {
        format!(" To blame: {}.{helping}", list(&blamed))
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
fn rules_in_general(analysis: &Analysis) -> String {
    let direct = analysis.rules.iter().filter(|effect| effect.is_direct);
    let sentences: Vec<String> = direct
        .map(|effect| {
            let symbols = |which: fn(&Slope) -> bool| -> Vec<String> {
                let slopes = effect.slopes.iter().filter(|slope| which(slope));
                slopes.map(|slope| slope.measure.to_owned()).collect()
            };
            let (against, with) = (symbols(|s| s.is_to_blame), symbols(|s| s.helps));
            let what = match (against.is_empty(), with.is_empty()) {
                (true, true) => "no effect shown".to_owned(),
                (true, false) => format!("with the level in {}", list(&with)),
                (false, true) => format!("against the level in {}", list(&against)),
                (false, false) => {
                    let (against, with) = (list(&against), list(&with));
                    format!("against the level in {against}, with it in {with}")
                }
            };
            format!("<i>{}</i>: {what}", effect.rule)
        })
        .collect();
    format!("<b>Rule by rule:</b> {}.", sentences.join("; "))
}

/// What the paper found, and what was measured for it.
fn beside_the_paper(design: &Design, analysis: &Analysis) -> String {
    let mean = |part: &Part, level: f64| {
        let means = &part.orders[0].means;
        means.iter().find(|mean| mean.level == level).map(|mean| mean.mean.value)
    };
    let mut text =
        "<b>Compared with the paper:</b> its operators rated level 1 with 6 on average, higher than \
         level 3, and level 9 with 6."
            .to_owned();
    for (name, part) in [("on as many maps", &analysis.replay), ("on all maps", &analysis.main)] {
        let (one, three, nine) = (mean(part, 1.0), mean(part, 3.0), mean(part, 9.0));
        if let (Some(one), Some(three), Some(nine)) = (one, three, nine) {
            let order = if one > three { "higher" } else { "not higher" };
            text.push_str(&format!(
                " Measured {name}, D is {} at level 1, {order} than the {} at level 3, and {} at \
                 level 9.",
                number(one, 2),
                number(three, 2),
                number(nine, 2)
            ));
        }
    }
    let critical = analysis.replay.critical_rho;
    let maps = analysis.replay.values.len();
    let rho = analysis.replay.orders[0].rho;
    let shown = rho.map_or_else(String::new, |rho| {
        let counts = if rho.value >= critical { "counts" } else { "does not count" };
        format!(" That of D is {}, which {counts}.", number(rho.value, 2))
    });
    text.push_str(&format!(
        " {maps} maps cannot show much: chance alone gives a rank correlation of {} or more in \
         5 % of cases.{shown}",
        number(critical, 2),
    ));
    let levels = design.levels.len();
    if levels < 3 {
        text.push_str(" Two levels make no triples of maps.");
    }
    text
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

    fn told(of: impl Fn(usize, u32) -> f64) -> String {
        let design = small();
        let records = made_records(&design, of);
        let records: Vec<&Record> = records.iter().collect();
        findings(&design, &analyse(&design, &records)).join(" ")
    }

    #[test]
    fn words_follow_the_numbers() {
        let rising = told(|level, map| level as f64 + 0.01 * f64::from(map));
        assert!(rising.contains("In D (difficulty) the <code>thesis</code> rules order the maps."));
        assert!(rising.contains("4 of 4 neighbouring levels are in order"), "{rising}");
        let falling = told(|level, map| 9.0 - level as f64 + 0.01 * f64::from(map));
        assert!(falling.contains("order the maps in reverse"), "{falling}");
        assert!(falling.contains("0 of 4 neighbouring levels"), "{falling}");
        let dented = told(|level, map| [2.0, 1.0, 3.0, 4.0, 5.0][level] + 0.01 * f64::from(map));
        assert!(dented.contains("on the whole, but not level by level"), "{dented}");
        assert!(dented.contains("level 1, higher than the"), "{dented}");
        let flat = told(|_, map| f64::from(map));
        assert!(flat.contains("no order of the maps"), "{flat}");
    }
}
