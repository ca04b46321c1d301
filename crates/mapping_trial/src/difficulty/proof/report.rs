//! The report of the proof, which is a self-contained page.

use envgen::calibration::Scale;
use maud::{Markup, html};
use plotters::prelude::*;

use super::analysis::{AllSizes, Analysis, Dropped, MapKind, Row};
use super::design::{Part, ProofDesign};
use super::dial::Dial;
use super::run::ProofResult;
use crate::difficulty::NEAR_REQUEST;
use crate::experiment::ExperimentError;
use crate::experiment::report::colors;
use crate::experiment::report::figures::{chart, diagonal, inline, report_error, rgb};
use crate::experiment::report::page::html_page;
use crate::experiment::report::pieces::{cell, head, interval, table, with_interval};

const TITLE: &str = "Is a map as difficult as requested?";

/// The parts, with their names and the colours of their marks.
const PARTS: [(Part, &str, usize); 3] = [
    (Part::Thesis, "rules of the thesis", 1),
    (Part::Calibrated, "calibrated, not simulated", 0),
    (Part::Verified, "verified by trials", 2),
];

/// Returns the page as HTML.
///
/// # Errors
///
/// If a figure cannot be drawn.
pub fn page(
    analysis: &Analysis,
    scale: &Scale,
    results: &[(Part, Vec<ProofResult>)],
) -> Result<String, ExperimentError> {
    let design = &analysis.design;
    let what = design.dial.text();
    let mut figures = Vec::new();
    for &footprint in &design.footprints {
        let svg = figure(design.dial, footprint, scale, results)?;
        figures.push(inline(svg, &format!("Measured over requested {what}")));
    }
    let content = html! {
        p.lead {
            "Maps of a fixed size are requested with a " (what) " spread evenly over what their size reaches, \
             generated, and measured by trials with fresh noise: under the reference panel, and under \
             policies, lasers, estimators and robots that the calibration has not seen."
        }
        h2 { "Requested and measured " (what) }
        @for figure in &figures {
            figure { (figure) }
            "\n"
        }
        (key())
        h2 { "Agreement" }
        (agreement(&analysis.rows, design))
        (dropped(analysis))
        h2 { "Levels" }
        (levels(analysis))
        h2 { "Kinds of maps" }
        (kinds(&analysis.kinds))
        h2 { "What a single number explains" }
        (singles(analysis))
        @if let Some(all) = &analysis.all_sizes {
            h2 { "All sizes together" }
            (all_sizes(all))
        }
    };
    Ok(html_page(TITLE, &content))
}

fn key() -> Markup {
    let [d, m, n] = ["d", "m", "n"];
    html! {
        div.key {
            span { i class=(m) {} (PARTS[0].1) }
            span { i class=(d) {} (PARTS[1].1) }
            span { i class=(n) {} (PARTS[2].1) }
        }
    }
}

/// Draws the measured over the requested values of a dial at one footprint under the reference panel,
/// as SVG, with a colour for each part.
///
/// # Errors
///
/// If the figure cannot be drawn.
pub fn figure(
    dial: Dial,
    footprint: u32,
    scale: &Scale,
    results: &[(Part, Vec<ProofResult>)],
) -> Result<String, ExperimentError> {
    let (unit, zero, what) = (dial.of(scale.units()), dial.of(scale.zero), dial.text());
    let requested = format!("requested {what}");
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, (520, 470)).into_drawing_area();
        let name = format!("measured {what} of {footprint} x {footprint} cells");
        let mut chart = chart(&area, (0.0..10.0, 0.0..10.0), (&requested, &name))?;
        diagonal(&mut chart, (0.0, 0.0), (10.0, 10.0))?;
        let mark = |color: usize| rgb(colors::MEASURED[color]).mix(0.7).filled();
        for (part, name, color) in PARTS {
            let own = results.iter().find(|(own, _)| *own == part).map(|(_, all)| all);
            let own = own.into_iter().flatten().filter(|one| one.map.footprint == footprint);
            let dots = own.map(|one| {
                let measured = unit * (one.scores[0] - zero);
                Circle::new((one.map.requested, measured.clamp(0.0, 10.0)), 4, mark(color))
            });
            let dots: Vec<_> = dots.collect();
            if !dots.is_empty() {
                let series = chart.draw_series(dots).map_err(report_error)?;
                series.label(name).legend(move |(x, y)| Circle::new((x + 10, y), 4, mark(color)));
            }
        }
        let mut legend = chart.configure_series_labels();
        legend.background_style(WHITE.mix(0.8)).border_style(BLACK.mix(0.3));
        legend.position(SeriesLabelPosition::UpperLeft).draw().map_err(report_error)?;
        area.present().map_err(report_error)?;
    }
    Ok(svg)
}

fn agreement(rows: &[Row], design: &ProofDesign) -> Markup {
    let mut names = head(["maps", "cells", "panel", "n"]);
    let near = format!("within {NEAR_REQUEST}");
    let near_linked = format!("{near}, linked");
    names.extend(
        [
            "rank correlation",
            "Kendall's tau",
            "slope",
            "intercept",
            "mean error",
            "mean error, linked",
            &near,
            &near_linked,
        ]
        .map(with_interval),
    );
    names.extend(head(["reliability", "rank correlation without noise"]));
    let row = |row: &Row| {
        vec![
            cell(name(row.part)),
            cell(row.footprint),
            cell(&row.panel),
            cell(row.raw.maps),
            interval(row.raw.rho, 2),
            interval(row.raw.tau, 2),
            interval(row.linked.slope, 2),
            interval(row.linked.intercept, 2),
            interval(row.raw.error, 2),
            interval(row.linked.error, 2),
            interval(row.raw.near, 2),
            interval(row.linked.near, 2),
            number(row.reliability),
            number(row.rho_without_noise),
        ]
    };
    let rows: Vec<Vec<Markup>> = rows.iter().map(row).collect();
    html! {
        p.note {
            "At least " (design.noise_seeds) " trials per map and condition, and " (design.panel_trials) " per map and \
             panel. Slopes and intercepts are of linked values: those of another panel are put on the reference's \
             scale by maps of their own, by mean and deviation. The columns \"" (near) "\" are the shares of the maps \
             whose measured difficulty, as measured and linked, is at most that far from the request. The \
             reliability is the share of the variance of what is measured over maps that is not noise of trials; the \
             rank correlation divided by its root, at most 1, estimates that without noise."
        }
        (table("", &names, &rows))
    }
}

/// A number of two decimals, or a dash.
fn number(value: Option<f64>) -> Markup {
    cell(value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}")))
}

fn name(part: Part) -> &'static str {
    let shown = PARTS.iter().find(|(own, ..)| *own == part);
    shown.map_or("for the links", |(_, name, _)| name)
}

fn dropped(analysis: &Analysis) -> Markup {
    if analysis.dropped.is_empty() {
        return html! { p.note { "Trials of every panel ran in all maps." } };
    }
    let row = |one: &Dropped| {
        vec![cell(name(one.part)), cell(one.footprint), cell(one.dropped), cell(one.maps)]
    };
    let rows: Vec<Vec<Markup>> = analysis.dropped.iter().map(row).collect();
    html! {
        p.note {
            "Maps in which trials of a panel cannot run, since its robot does not fit, are left out of all comparisons:"
        }
        (table("", &head(["maps", "cells", "left out", "of"]), &rows))
    }
}

fn levels(analysis: &Analysis) -> Markup {
    let row = |level: &super::analysis::Level| {
        vec![
            cell(level.footprint),
            cell(level.level),
            cell(level.maps),
            cell(format!("{:.2} +- {:.2}", level.mean, level.half_interval)),
        ]
    };
    let rows: Vec<Vec<Markup>> = analysis.levels.iter().map(row).collect();
    html! {
        p.note { "Calibrated maps whose requests are within one unit of a level; mean and its 95 % interval." }
        (table("", &head(["cells", "level", "maps", "measured"]), &rows))
    }
}

fn singles(analysis: &Analysis) -> Markup {
    let row = |one: &super::analysis::Single| {
        vec![
            cell(one.footprint),
            cell(one.of),
            cell(&one.name),
            cell(format!("{:.2}", one.explained)),
            cell(format!("{:.2}", one.wall_length)),
        ]
    };
    let rows: Vec<Vec<Markup>> = analysis.singles.iter().map(row).collect();
    html! {
        p.note {
            "The setting, the product of two settings, and the feature whose squared rank correlation with the \
             measured difficulty of the calibrated maps is the greatest, and that of the metres of wall."
        }
        (table("", &head(["cells", "of", "name", "explained", "metres of wall"]), &rows))
    }
}

fn kinds(kinds: &[MapKind]) -> Markup {
    let row = |one: &MapKind| {
        vec![
            cell(one.footprint),
            cell(one.kind),
            cell(one.maps),
            number(one.rho),
            cell(format!("{:.2}", one.error)),
            cell(format!("{:+.2}", one.offset)),
        ]
    };
    let rows: Vec<Vec<Markup>> = kinds.iter().map(row).collect();
    html! {
        p.note {
            "The calibrated maps under the reference panel, by how their hallways are laid out, and by whether their \
             settings ask for mazes in rooms. The last column is the mean of measured less requested."
        }
        (table("", &head(["cells", "maps", "n", "rank correlation", "mean error", "offset"]), &rows))
    }
}

fn all_sizes(all: &AllSizes) -> Markup {
    let row = vec![cell(all.maps), interval(all.rho, 2), number(all.wall_length)];
    let mut names = head(["n"]);
    names.push(with_interval("rank correlation"));
    names.extend(head(["of metres of wall alone"]));
    html! {
        p.note {
            "The order of the calibrated maps of all sizes under the reference panel: the rank correlation of the \
             measured with the requested, and with the metres of wall. Where large maps are \
             harder, their size alone orders them."
        }
        (table("", &names, &[row]))
    }
}
