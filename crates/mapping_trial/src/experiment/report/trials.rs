//! How trials ended, pictures of some of their maps, and a table of all trials.

use maud::{Markup, html};

use super::maps::MapPictures;
use super::numbers::{number, percent};
use super::pieces::{cell, head, image, table};
use crate::experiment::design::Design;
use crate::experiment::record::Record;
use crate::experiment::stats::{Analysis, policy_of};
use crate::trial::EndReason;

/// Greatest number of trials in the page's table. The files have all of them.
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

/// How trials ended, by level.
pub(super) fn ends(design: &Design, analysis: &Analysis) -> Markup {
    let met: Vec<EndReason> = ENDS
        .into_iter()
        .filter(|end| analysis.ends.iter().any(|level| level.reasons.contains_key(end)))
        .collect();
    let mut columns = vec![cell("level"), cell("trials")];
    columns.extend(met.iter().map(|end| cell(end.text())));
    columns.push(cell("mean time (s)"));
    let rows = design.levels.iter().zip(&analysis.ends).map(|(level, ends)| {
        let mut row = vec![cell(level), cell(ends.trials)];
        row.extend(met.iter().map(|end| {
            let count = ends.reasons.get(end).copied().unwrap_or(0);
            html! { (count) " " small { (percent(count as f64 / ends.trials.max(1) as f64)) } }
        }));
        row.push(cell(number(ends.time, 0)));
        row
    });
    html! {
        h2 { "How trials ended" }
        (table("", &columns, &rows.collect::<Vec<_>>()))
    }
}

/// Pictures of some maps; nothing if there are none.
pub(super) fn maps(design: &Design, maps: &[MapPictures]) -> Markup {
    let Some(first) = maps.first() else { return Markup::default() };
    html! {
        h2 { "Maps of each level" }
        p {
            "The world; the map that " code { (policy_of(&first.record)) }
            " made of it, with the robot's estimated trajectory; and that map over the mappable area: \
             walls in their place black, walls that do not exist vermilion, missed walls blue, ground \
             not seen light blue, the true trajectory green."
        }
        @for map in maps {
            (pictures(design, map))
        }
    }
}

fn pictures(design: &Design, map: &MapPictures) -> Markup {
    let MapPictures { record, world, map, errors } = map;
    let (scores, number_of_map) = (&record.scores, record.trial.map);
    let level = design.level(&record.trial);
    let name = format!("map {number_of_map} of level {level}");
    html! {
        h3 {
            "Level " (level) ", map " (number_of_map) " "
            small.note {
                "seed " (record.world_seed.0) ": D " (number(scores.difficulty, 2)) ", M "
                (number(scores.mapping, 2)) ", N " (number(scores.navigation, 2)) "; "
                (record.end_text())
            }
        }
        div.maps {
            div { (image(world, &format!("The world of {name}"))) }
            div { (image(map, &format!("The robot's map of {name}"))) }
            div { (image(errors, &format!("Errors of the map of {name}"))) }
        }
    }
}

/// Every trial, or as many as a page can show.
pub(super) fn list(design: &Design, records: &[&Record]) -> Markup {
    let shown = records.len().min(ROWS);
    let head = head([
        "level",
        "map",
        "noise",
        "policy",
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
    ]);
    let rows: Vec<_> = records[..shown].iter().map(|record| row(design, record)).collect();
    html! {
        h2 { "Every trial" }
        details {
            summary {
                (shown) " of " (records.len())
                " trials; all, with all columns, are in trials.csv and trials.parquet"
            }
            (table("", &head, &rows))
        }
    }
}

fn row(design: &Design, record: &Record) -> Vec<Markup> {
    let (trial, s) = (&record.trial, &record.scores);
    vec![
        cell(design.level(trial)),
        cell(trial.map),
        cell(trial.noise),
        html! { code { (policy_of(record)) } },
        cell(record.end_text()),
        cell(number(s.difficulty, 2)),
        cell(number(s.mapping, 2)),
        cell(number(s.navigation, 2)),
        cell(percent(s.coverage)),
        cell(percent(s.f1_30)),
        cell(percent(s.navigability)),
        cell(number(s.trajectory_error, 2)),
        cell(number(s.time, 0)),
        cell(number(s.distance, 0)),
        cell(number(s.turning, 0)),
        cell(s.collisions),
        cell(s.recoveries),
    ]
}
