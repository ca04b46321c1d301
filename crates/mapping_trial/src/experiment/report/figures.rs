//! The figures, as SVG.

use std::fmt::Display;

use envgen::palette::Srgb;
use maud::{Markup, PreEscaped};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::colors;
use crate::experiment::design::Design;
use crate::experiment::error::ExperimentError;
use crate::experiment::stats::{FeatureEffect, Part};

const MEASURED: [RGBColor; 3] =
    [rgb(colors::MEASURED[0]), rgb(colors::MEASURED[1]), rgb(colors::MEASURED[2])];
const STATED: RGBColor = rgb(colors::STATED);
const INK: RGBColor = rgb(colors::INK);
const SOFT: RGBColor = rgb(colors::SOFT);
const LINE: RGBColor = rgb(colors::LINE);

pub(crate) const fn rgb(Srgb([red, green, blue]): Srgb) -> RGBColor {
    RGBColor(red, green, blue)
}

/// Shifts of the marks of D, M and N, so that none hides another.
const APART: [f64; 3] = [0.0, -0.16, 0.16];

/// The ratings that the paper states in words: level and mean rating (its section 6).
const RATED: [(f64, f64); 2] = [(1.0, 6.0), (9.0, 6.0)];

pub(crate) type Chart<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

pub(crate) fn report_error(error: impl Display) -> ExperimentError {
    ExperimentError::Report(error.to_string())
}

/// Figure 7 (a): difficulty by level, with what the paper states, as SVG.
pub(super) fn absolute(design: &Design, part: &Part) -> Result<String, ExperimentError> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, (520, 470)).into_drawing_area();
        let axes = ("level that maps are generated with", "difficulty (0 to 10)");
        let mut chart = chart(&area, (0.0..10.0, 0.0..10.0), axes)?;
        // "Between the extreme difficulties the ratings matched to a reasonable degree": no numbers.
        let band = vec![(2.6, 1.4), (7.4, 6.2), (7.4, 8.6), (2.6, 3.8)];
        chart.draw_series([Polygon::new(band, STATED.mix(0.10).filled())]).map_err(report_error)?;
        diagonal(&mut chart, (0.0, 0.0), (10.0, 10.0))?;
        for map in &part.values {
            for (measure, apart) in APART.into_iter().enumerate() {
                let at = (design.levels[map.level] + apart, map.means[measure]);
                let dot = Circle::new(at, 2, MEASURED[measure].mix(0.30).filled());
                chart.draw_series([dot]).map_err(report_error)?;
            }
        }
        for (measure, order) in part.orders.iter().take(3).enumerate().rev() {
            let colour = MEASURED[measure];
            let at = |level: f64| level + APART[measure];
            let line = order.means.iter().map(|mean| (at(mean.level), mean.mean.value));
            chart
                .draw_series(LineSeries::new(line, colour.stroke_width(2)))
                .map_err(report_error)?;
            for mean in &order.means {
                let x = at(mean.level);
                let ends = [(x, mean.mean.low), (x, mean.mean.high)];
                let bar = PathElement::new(ends, colour.mix(0.55).stroke_width(2));
                chart.draw_series([bar]).map_err(report_error)?;
                let dot = Circle::new((x, mean.mean.value), 5, colour.filled());
                chart.draw_series([dot]).map_err(report_error)?;
            }
        }
        for (level, rating) in RATED {
            let diamond = vec![
                (level, rating + 0.24),
                (level + 0.22, rating),
                (level, rating - 0.24),
                (level - 0.22, rating),
                (level, rating + 0.24),
            ];
            let mark = PathElement::new(diamond, STATED.stroke_width(2));
            chart.draw_series([mark]).map_err(report_error)?;
        }
        // Level 3 was rated lower than level 1: a bar under 6 with an arrow down, no value.
        for line in [
            vec![(2.72, 6.0), (3.28, 6.0)],
            vec![(3.0, 6.0), (3.0, 5.3)],
            vec![(2.87, 5.52), (3.0, 5.3), (3.13, 5.52)],
        ] {
            chart
                .draw_series([PathElement::new(line, STATED.stroke_width(2))])
                .map_err(report_error)?;
        }
        area.present().map_err(report_error)?;
    }
    Ok(svg)
}

/// Figure 7 (b): the order of three maps.
pub(super) fn relative(part: &Part) -> Result<Markup, ExperimentError> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, (520, 430)).into_drawing_area();
        let axes = ("order of three maps by level", "mean rank of measured difficulty");
        let mut chart = chart(&area, (0.7..3.3, 0.8..3.2), axes)?;
        diagonal(&mut chart, (1.0, 1.0), (3.0, 3.0))?;
        let chance = [(0.7, 2.0), (3.3, 2.0)];
        let line = PathElement::new(chance, SOFT.mix(0.5).stroke_width(1));
        chart.draw_series([line]).map_err(report_error)?;
        for (measure, found) in part.relative.iter().enumerate().rev() {
            let colour = MEASURED[measure];
            let points = found.ranks.iter().zip([1.0, 2.0, 3.0]);
            let points: Vec<(f64, f64)> =
                points.map(|(&rank, x)| (x + APART[measure] / 5.0, rank)).collect();
            let line = LineSeries::new(points.iter().copied(), colour.stroke_width(2));
            chart.draw_series(line).map_err(report_error)?;
            let dots = points.iter().map(|&at| Circle::new(at, 5, colour.filled()));
            chart.draw_series(dots).map_err(report_error)?;
        }
        area.present().map_err(report_error)?;
    }
    Ok(inline(svg, "Mean rank of the easiest, middle and hardest of three maps"))
}

/// Draws how much each rule adds from the lowest to the highest level.
pub(super) fn rules(effects: &[FeatureEffect]) -> Result<Markup, ExperimentError> {
    let rows = effects.len() as f64;
    let ends = effects.iter().flat_map(|effect| &effect.slopes).filter_map(|slope| slope.carried);
    let reach = ends.map(|i| i.low.abs().max(i.high.abs())).fold(1.0, f64::max) * 1.05;
    let mut svg = String::new();
    {
        let size = (1040, 80 + 46 * effects.len() as u32);
        let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        let mut chart = ChartBuilder::on(&area)
            .margin(10)
            .margin_left(330)
            .x_label_area_size(46)
            .build_cartesian_2d(-reach..reach, 0.0..rows)
            .map_err(report_error)?;
        chart
            .configure_mesh()
            .disable_y_mesh()
            .disable_y_axis()
            .light_line_style(TRANSPARENT)
            .bold_line_style(LINE)
            .axis_style(SOFT)
            .x_labels(9)
            .x_label_formatter(&|x| if reach > 4.0 { format!("{x:.0}") } else { format!("{x:.1}") })
            .x_desc("points of difficulty that the rule adds from the lowest to the highest level")
            .axis_desc_style(("sans-serif", 15).into_font().color(&INK))
            .label_style(("sans-serif", 14).into_font().color(&SOFT))
            .draw()
            .map_err(report_error)?;
        let zero = PathElement::new([(0.0, 0.0), (0.0, rows)], INK.stroke_width(1));
        chart.draw_series([zero]).map_err(report_error)?;
        let right = Pos::new(HPos::Right, VPos::Center);
        for (row, effect) in effects.iter().enumerate() {
            let middle = rows - row as f64 - 0.5;
            let (_, y) = chart.backend_coord(&(0.0, middle));
            let bold = ("sans-serif", 15).into_font().color(&INK).pos(right);
            let soft = ("sans-serif", 13).into_font().color(&SOFT).pos(right);
            area.draw(&Text::new(effect.rule, (322, y - 8), bold)).map_err(report_error)?;
            area.draw(&Text::new(effect.feature, (322, y + 9), soft)).map_err(report_error)?;
            for (measure, slope) in effect.slopes.iter().enumerate() {
                let Some(carried) = slope.carried else { continue };
                let y = middle + 0.22 - 0.22 * measure as f64;
                let colour = MEASURED[measure];
                let bar = [(carried.low, y), (carried.high, y)];
                let bar = PathElement::new(bar, colour.mix(0.6).stroke_width(2));
                chart.draw_series([bar]).map_err(report_error)?;
                let dot = Circle::new((carried.value, y), 4, colour.filled());
                chart.draw_series([dot]).map_err(report_error)?;
            }
        }
        area.present().map_err(report_error)?;
    }
    Ok(inline(svg, "What each rule adds to the difficulty"))
}

pub(crate) fn chart<'a, 'b>(
    area: &'a DrawingArea<SVGBackend<'b>, plotters::coord::Shift>,
    (x, y): (std::ops::Range<f64>, std::ops::Range<f64>),
    (x_name, y_name): (&str, &str),
) -> Result<Chart<'a, 'b>, ExperimentError> {
    let count = |range: &std::ops::Range<f64>| {
        let whole = range.end.floor() - range.start.ceil() + 1.0;
        whole.max(2.0) as usize
    };
    let labels = (count(&x), count(&y));
    chart_with(area, (x, y), (x_name, y_name), labels, 0)
}

/// Does the same with an approximate number of labels on the axes, and a number of decimals for the
/// labels below.
pub(crate) fn chart_with<'a, 'b>(
    area: &'a DrawingArea<SVGBackend<'b>, plotters::coord::Shift>,
    (x, y): (std::ops::Range<f64>, std::ops::Range<f64>),
    (x_name, y_name): (&str, &str),
    (x_labels, y_labels): (usize, usize),
    digits: usize,
) -> Result<Chart<'a, 'b>, ExperimentError> {
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .x_label_area_size(50)
        .y_label_area_size(56)
        .build_cartesian_2d(x, y)
        .map_err(report_error)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(LINE)
        .axis_style(SOFT)
        .x_labels(x_labels)
        .y_labels(y_labels)
        .x_label_formatter(&|x| format!("{x:.digits$}"))
        .y_label_formatter(&|y| format!("{y:.0}"))
        .x_desc(x_name)
        .y_desc(y_name)
        .axis_desc_style(("sans-serif", 15).into_font().color(&INK))
        .label_style(("sans-serif", 14).into_font().color(&SOFT))
        .draw()
        .map_err(report_error)?;
    Ok(chart)
}

/// The line of the best possible result.
pub(crate) fn diagonal(
    chart: &mut Chart<'_, '_>,
    from: (f64, f64),
    to: (f64, f64),
) -> Result<(), ExperimentError> {
    let steps = 40;
    let at = |i: i32| {
        let t = f64::from(i) / f64::from(steps);
        (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1))
    };
    let dashes = (0..steps).step_by(2).map(|i| PathElement::new([at(i), at(i + 1)], SOFT));
    chart.draw_series(dashes).map(drop).map_err(report_error)
}

/// The SVG as part of a page: scalable, with a name for people who cannot see it.
pub(crate) fn inline(svg: String, name: &str) -> Markup {
    let svg = svg.replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{name}\" "), 1);
    PreEscaped(svg.replace("font-family=\"sans-serif\"", "font-family=\"inherit\""))
}
