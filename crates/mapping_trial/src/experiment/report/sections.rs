//! The page of the report, section by section.

use std::fmt::Write;

use super::maps::MapPictures;
use super::page::{STYLE, escape, image, interval, list, number, percent, some, table};
use super::{figures, words};
use crate::experiment::design::{Design, operator_name};
use crate::experiment::error::ExperimentError;
use crate::experiment::record::Record;
use crate::experiment::stats::{Analysis, FeatureEffect, MEASURES, Part, RESAMPLES, driver};
use crate::names::Named;
use crate::trial::EndReason;

/// Greatest number of trials in the page's table; the files have all.
const ROWS: usize = 20_000;

/// The reasons why trials end, in the order of the table.
const ENDS: [EndReason; 6] = [
    EndReason::Explored,
    EndReason::Stuck,
    EndReason::Drowned,
    EndReason::Battery,
    EndReason::TimeLimit,
    EndReason::Stopped,
];

/// The whole page.
pub(super) fn page(
    design: &Design,
    records: &[&Record],
    analysis: &Analysis,
    maps: &[MapPictures],
) -> Result<String, ExperimentError> {
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <title>Do the rules make maps difficult?</title><style>{STYLE}</style></head>\n\
         <body><main>\n<h1>Do the rules make maps difficult?</h1>\n"
    );
    html.push_str(&lead(design, records));
    html.push_str("<div class=\"findings\"><ul>\n");
    for finding in words::findings(design, analysis) {
        let _ = writeln!(html, "<li>{finding}</li>");
    }
    html.push_str("</ul></div>\n");
    figure_7(design, analysis, &mut html)?;
    statistics(design, analysis, &mut html);
    rules(design, analysis, &mut html)?;
    weights(analysis, &mut html);
    ends(design, analysis, &mut html);
    pictures(design, maps, &mut html);
    trials(design, records, &mut html);
    how(design, &mut html);
    html.push_str("</main></body></html>\n");
    Ok(html)
}

fn names(design: &Design) -> (String, String) {
    let of = |kinds: &[crate::policy::PolicyKind]| {
        list(&kinds.iter().map(|&kind| operator_name(kind).to_owned()).collect::<Vec<_>>())
    };
    (of(&design.replay.operators), of(&design.operators))
}

fn lead(design: &Design, records: &[&Record]) -> String {
    let levels: Vec<String> = design.levels.iter().map(f64::to_string).collect();
    let (replay, main) = names(design);
    let metres = f64::from(design.size) * design.spec(design.levels[0]).cell_size;
    format!(
        "<p class=\"lead\">{} trials in a simulator, in which policies map indoor worlds of the \
         levels {} and their maps are scored against the worlds. The experiment of O. Zwennes, \
         <i>Adaptive Indoor Map Generator for USARSim</i> (2011), which asked people, is \
         replayed.</p>\n\
         <p class=\"note\">The paper's design: {} maps per level, each once by {replay}. The larger \
         design: {} maps per level, {} noise seed{} each, by {main}. Maps of {} x {} cells \
         ({metres} m square), estimated by {}, laser {}, odometry {}, time limit {} s.</p>\n",
        records.len(),
        list(&levels),
        design.replay.maps,
        design.maps,
        design.noise_seeds,
        if design.noise_seeds == 1 { "" } else { "s" },
        design.size,
        design.size,
        design.slam.name().unwrap_or("custom"),
        design.laser.name().unwrap_or("custom"),
        design.odometry.name().unwrap_or("custom"),
        design.time_limit,
    )
}

const KEY: &str = "<div class=\"key\">\
    <span><i style=\"color:var(--d)\"></i>D, overall</span>\
    <span><i style=\"color:var(--m)\"></i>M, mapping</span>\
    <span><i style=\"color:var(--n)\"></i>N, getting around</span>";

fn figure_7(
    design: &Design,
    analysis: &Analysis,
    html: &mut String,
) -> Result<(), ExperimentError> {
    let parts = [("The paper's design", &analysis.replay), ("The larger design", &analysis.main)];
    html.push_str("<h2>Difficulty against level</h2>\n<div class=\"pair\">\n");
    for (name, part) in parts {
        let svg = figures::absolute(design, part)?;
        let _ = writeln!(html, "<figure><h3>{}</h3>{svg}</figure>", title(name, part));
    }
    let _ = writeln!(
        html,
        "</div>{KEY}\
         <span><i class=\"dot\" style=\"background:var(--d);opacity:.4\"></i>one map</span>\
         <span><i class=\"dash\" style=\"color:var(--soft)\"></i>difficulty equals level</span>\
         <span><i class=\"hollow\" style=\"color:var(--p)\"></i>stated in the paper: rated 6</span>\
         <span><b style=\"color:var(--p)\">&#x2193;</b>stated: rated lower than level 1</span>\
         <span><i class=\"band\" style=\"background:var(--p)\"></i>stated without numbers: near \
         the diagonal</span></div>\n\
         <p class=\"note\">Figure 7 (a) of the paper, with new data. Bars are intervals of 95 % of the \
         levels' means (Student's t over maps). People's ratings and measured scores share the \
         scale from 0 to 10 and its ends (nothing forces an error; the map cannot be navigated), \
         not its unit: shapes can be compared, heights only with care.</p>"
    );
    if design.levels.len() < 3 {
        return Ok(());
    }
    html.push_str("<h2>The order of three maps</h2>\n<div class=\"pair\">\n");
    for (name, part) in parts {
        let svg = figures::relative(part)?;
        let caption = words::three_maps(part);
        let _ = writeln!(
            html,
            "<figure><h3>{}</h3>{svg}<figcaption>Mean ranks: {caption}.</figcaption></figure>",
            title(name, part)
        );
    }
    let _ = writeln!(
        html,
        "</div>{KEY}<span><i class=\"dash\" style=\"color:var(--soft)\"></i>always in \
         order</span></div>\n\
         <p class=\"note\">Figure 7 (b) of the paper, with new data: all triples of maps of different \
         levels, ranked within each operator; by chance all ranks are 2. The paper states that on \
         average the easiest map was rated lowest, the second higher and the hardest highest, the \
         last two close together; it prints no numbers.</p>"
    );
    Ok(())
}

fn title(name: &str, part: &Part) -> String {
    format!("{name}: {} maps, {} trials", part.values.len(), part.trials)
}

fn statistics(design: &Design, analysis: &Analysis, html: &mut String) {
    html.push_str("<h2>Statistics</h2>\n");
    for (name, part) in
        [("The larger design", &analysis.main), ("The paper's design", &analysis.replay)]
    {
        let _ = writeln!(
            html,
            "<h3>{}</h3>\n<p class=\"note\">A rank correlation counts from {} on: chance alone \
             gives as much in 5 % of cases.</p>",
            title(name, part),
            number(part.critical_rho, 2)
        );
        let head = [
            "measure",
            "Spearman's ρ <small>95 %</small>",
            "p",
            "Kendall's τ",
            "neighbours<br>in order",
            "variance<br>of level",
            "of map",
            "of noise",
        ];
        let rows: Vec<Vec<String>> = part
            .orders
            .iter()
            .zip(&MEASURES)
            .map(|(order, measure)| {
                let shares = order.shares;
                vec![
                    format!("{} <small>{}</small>", symbol(measure.symbol), measure.name),
                    interval(order.rho, 2),
                    order.p.map_or("–".to_owned(), |p| {
                        if p < 0.001 { "&lt; 0.001".to_owned() } else { number(p, 3) }
                    }),
                    some(order.tau, 2),
                    format!("{} of {}", order.neighbours_in_order, order.neighbours()),
                    shares.map_or("–".to_owned(), |s| percent(s.level)),
                    shares.map_or("–".to_owned(), |s| percent(s.map)),
                    shares.and_then(|s| s.noise).map_or("–".to_owned(), percent),
                ]
            })
            .collect();
        html.push_str(&table("Whether measures follow the level", &head.map(str::to_owned), &rows));
        let mut head = vec!["mean of a level's maps".to_owned()];
        head.extend(design.levels.iter().map(|level| format!("level {level} <small>95 %</small>")));
        let rows: Vec<Vec<String>> = part
            .orders
            .iter()
            .map(|order| {
                let mut row = vec![symbol(order.measure)];
                row.extend(order.means.iter().map(|mean| interval(Some(mean.mean), 2)));
                row
            })
            .collect();
        html.push_str(&table("", &head, &rows));
        let head = [
            "operator",
            "ρ of D <small>95 %</small>",
            "ρ of M",
            "ρ of N",
            "mean D",
            "mean M",
            "mean N",
        ];
        let rows: Vec<Vec<String>> = part
            .operators
            .iter()
            .map(|operator| {
                let mut row = vec![format!("<code>{}</code>", operator.operator)];
                row.extend(operator.orders.iter().map(|order| interval(order.rho, 2)));
                row.extend(operator.orders.iter().map(|order| {
                    let sum: f64 = order.means.iter().map(|mean| mean.mean.value).sum();
                    number(sum / order.means.len() as f64, 2)
                }));
                row
            })
            .collect();
        html.push_str(&table("By operator", &head.map(str::to_owned), &rows));
    }
    let _ = writeln!(
        html,
        "<p class=\"note\">The unit is the map: trials on one map are averaged first. Intervals of \
         ρ are percentile bootstraps over maps within levels ({RESAMPLES} samples), which are too \
         narrow for few maps per level; p is by permutation, one-sided. Shares of variance are the components of a nested analysis of \
         variance, operators averaged; with one noise seed the map's share holds the noise.</p>"
    );
}

fn symbol(symbol: &str) -> String {
    match symbol.split_once('_') {
        Some((letter, index)) => format!("<i>{letter}</i><sub>{index}</sub>"),
        None => format!("<b>{symbol}</b>"),
    }
}

fn rules(design: &Design, analysis: &Analysis, html: &mut String) -> Result<(), ExperimentError> {
    let svg = figures::rules(&analysis.rules)?;
    let _ = writeln!(
        html,
        "<h2>Which rule is to blame</h2>\n\
         <p>Each rule moves a feature of the maps with the level (its trend). Between maps of one \
         level the feature varies by chance, and difficulty with it (its effect, level means \
         removed). Trend times effect is what the rule adds from the lowest to the highest level. \
         Right of 0 the rule does what it should; a rule whose interval is left of 0 makes maps \
         easier when it should make them harder.</p>\n\
         <figure>{svg}</figure>{KEY}</div>"
    );
    let mut head = vec!["feature".to_owned()];
    head.extend(design.levels.iter().map(|level| format!("level {level}")));
    head.push("trend per level <small>95 %</small>".to_owned());
    let rows: Vec<Vec<String>> = analysis
        .rules
        .iter()
        .map(|effect| {
            let mut row = vec![rule(effect)];
            row.extend(effect.means.iter().map(|&mean| number(mean, 2)));
            row.push(interval(effect.trend, 3));
            row
        })
        .collect();
    html.push_str(&table("What the rules make of the maps: means of levels", &head, &rows));
    let head = [
        "rule",
        "of",
        "effect of one unit <small>95 %</small>",
        "others fixed <small>95 %</small>",
        "points added <small>95 %</small>",
        "",
    ];
    let rows: Vec<Vec<String>> = analysis
        .rules
        .iter()
        .flat_map(|effect| {
            effect.slopes.iter().enumerate().map(|(i, slope)| {
                let name = if i == 0 { rule(effect) } else { String::new() };
                let verdict = match (slope.is_to_blame, slope.helps) {
                    (true, _) => "<span class=\"bad\">to blame</span>",
                    (_, true) => "<span class=\"good\">works</span>",
                    _ => "",
                };
                vec![
                    name,
                    symbol(slope.measure),
                    interval(slope.within, 2),
                    interval(slope.others_fixed, 2),
                    interval(slope.carried, 2),
                    verdict.to_owned(),
                ]
            })
        })
        .collect();
    html.push_str(&table(
        "What the features do to difficulty, between maps of one level",
        &head.map(str::to_owned),
        &rows,
    ));
    html.push_str(
        "<p class=\"note\">Effects are least-squares slopes over the larger design's maps; \"others \
         fixed\" holds the five rules' own features fixed together. Intervals are percentile \
         bootstraps over maps within levels. Of twenty effects of size 0, one is beyond its \
         interval by chance.</p>\n",
    );
    Ok(())
}

fn rule(effect: &FeatureEffect) -> String {
    format!("{}<br><small>{}</small>", effect.rule, escape(effect.feature))
}

fn weights(analysis: &Analysis, html: &mut String) {
    html.push_str(
        "<h2>What the weights decide</h2>\n\
         <p>D is a weighted mean. With each weight in turn multiplied by 0.5 and by 1.5, \
         the larger design's maps are ranked again: τ compares with the ranking before, ρ is \
         that of level and D.</p>\n",
    );
    let head = ["weight", "τ at 0.5", "most places", "ρ", "τ at 1.5", "most places", "ρ"];
    let rows: Vec<Vec<String>> = analysis
        .weights
        .chunks(2)
        .map(|pair| {
            let mut row = vec![pair[0].sensitivity.weight.to_owned()];
            for weighting in pair {
                row.push(some(weighting.sensitivity.tau, 3));
                row.push(weighting.sensitivity.most_places.to_string());
                row.push(some(weighting.rho, 2));
            }
            row
        })
        .collect();
    html.push_str(&table("", &head.map(str::to_owned), &rows));
}

fn ends(design: &Design, analysis: &Analysis, html: &mut String) {
    html.push_str("<h2>How trials ended</h2>\n");
    let met: Vec<EndReason> = ENDS
        .into_iter()
        .filter(|end| analysis.ends.iter().any(|level| level.reasons.contains_key(end)))
        .collect();
    let mut head = vec!["level".to_owned(), "trials".to_owned()];
    head.extend(met.iter().map(|end| end.text().to_owned()));
    head.push("mean time (s)".to_owned());
    let rows: Vec<Vec<String>> = design
        .levels
        .iter()
        .zip(&analysis.ends)
        .map(|(level, ends)| {
            let mut row = vec![level.to_string(), ends.trials.to_string()];
            row.extend(met.iter().map(|end| {
                let count = ends.reasons.get(end).copied().unwrap_or(0);
                let share = percent(count as f64 / ends.trials.max(1) as f64);
                format!("{count} <small>{share}</small>")
            }));
            row.push(number(ends.time, 0));
            row
        })
        .collect();
    html.push_str(&table("", &head, &rows));
}

fn pictures(design: &Design, maps: &[MapPictures], html: &mut String) {
    let Some(first) = maps.first() else { return };
    let _ = writeln!(
        html,
        "<h2>Maps of each level</h2>\n\
         <p>The world; the map that <code>{}</code> made of it, with the robot's estimated \
         trajectory; and that map over the mappable area: walls in their place black, walls that do \
         not exist vermilion, missed walls blue, ground not seen light blue, the true trajectory green.</p>",
        driver(&first.record)
    );
    for map in maps {
        let record = &map.record;
        let scores = &record.scores;
        let name = format!("map {} of level {}", record.trial.map, design.level(&record.trial));
        let _ = writeln!(
            html,
            "<h3>Level {}, map {} <small class=\"note\">seed {}: D {}, M {}, N {}; {}</small></h3>\n\
             <div class=\"maps\"><div>{}</div><div>{}</div><div>{}</div></div>",
            design.level(&record.trial),
            record.trial.map,
            record.world_seed,
            number(scores.difficulty, 2),
            number(scores.mapping, 2),
            number(scores.navigation, 2),
            record.end.map_or("", EndReason::text),
            image(&map.world, &format!("The world of {name}")),
            image(&map.map, &format!("The robot's map of {name}")),
            image(&map.errors, &format!("Errors of the map of {name}")),
        );
    }
}

fn trials(design: &Design, records: &[&Record], html: &mut String) {
    let shown = records.len().min(ROWS);
    let _ = writeln!(
        html,
        "<h2>Every trial</h2>\n<details><summary>{shown} of {} trials; all, with all columns, are \
         in trials.csv and trials.parquet</summary>",
        records.len()
    );
    let head = [
        "level",
        "map",
        "noise",
        "operator",
        "end",
        "D",
        "M",
        "N",
        "coverage",
        "wall F1",
        "navigability",
        "trajectory error (m)",
        "time (s)",
        "distance (m)",
        "turning (rad)",
        "collisions",
        "recoveries",
    ];
    let rows: Vec<Vec<String>> = records[..shown]
        .iter()
        .map(|record| {
            let (trial, s) = (&record.trial, &record.scores);
            vec![
                design.level(trial).to_string(),
                trial.map.to_string(),
                trial.noise.to_string(),
                format!("<code>{}</code>", driver(record)),
                record.end.map_or("–", EndReason::text).to_owned(),
                number(s.difficulty, 2),
                number(s.mapping, 2),
                number(s.navigation, 2),
                percent(s.coverage),
                percent(s.f1_30),
                percent(s.navigability),
                number(s.trajectory_error, 2),
                number(s.time, 0),
                number(s.distance, 0),
                number(s.turning, 0),
                s.hits.to_string(),
                s.recoveries.to_string(),
            ]
        })
        .collect();
    html.push_str(&table("", &head.map(str::to_owned), &rows));
    html.push_str("</details>\n");
}

fn how(design: &Design, html: &mut String) {
    let _ = writeln!(
        html,
        "<h2>Method</h2>\n\
         <p class=\"note\">Map <i>k</i> of level <i>l</i> is generated with seed {} + 10000 <i>l</i> \
         + <i>k</i>, its noise <i>j</i> with 1000 times that seed + <i>j</i>. The robot is a P3-AT \
         with the noise of its laser and wheels; the world is unknown to it. M = 10 (0.35 \
         e<sub>wall</sub> + 0.30 e<sub>use</sub> + 0.25 e<sub>pose</sub> + 0.10 e<sub>cov</sub>), \
         N = 10 (0.40 e<sub>time</sub> + 0.25 e<sub>cov</sub> + 0.20 e<sub>hit</sub> + 0.15 \
         e<sub>turn</sub>), D = 0.6 M + 0.4 N. The same design gives the same page to the last \
         byte.</p>",
        design.seed.0.wrapping_mul(1_000_000)
    );
}
