//! The figure of levers: measured m and n over the values of each setting.

use envgen::palette;
use plotters::prelude::*;

use super::lever::{Lever, LeverLevel};
use crate::experiment::ExperimentError;
use crate::experiment::report::colors;
use crate::experiment::report::figures::{chart_with, report_error, rgb};

/// Number of charts in a row, and their size in pixels.
const COLUMNS: usize = 3;
const SIZE: (u32, u32) = (330, 260);

/// Height in pixels of the key above the charts.
const KEY: u32 = 34;

/// Draws the dials m and n of each lever over its values, with 95 % intervals, as SVG.
///
/// # Errors
///
/// If the figure cannot be drawn.
pub fn figure(levers: &[Lever], levels: &[Vec<LeverLevel>]) -> Result<String, ExperimentError> {
    let rows = levers.len().div_ceil(COLUMNS);
    let size = (SIZE.0 * COLUMNS as u32, SIZE.1 * rows as u32 + KEY);
    let mut svg = String::new();
    {
        let page = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        page.fill(&WHITE).map_err(report_error)?;
        let (above, charts) = page.split_vertically(KEY);
        for (i, (text, color)) in [("mapping m", 1), ("navigation n", 2)].into_iter().enumerate() {
            let (x, color) = (66 + 130 * i as i32, rgb(colors::MEASURED[color]));
            above.draw(&Circle::new((x, 20), 5, color.filled())).map_err(report_error)?;
            let style = ("sans-serif", 15).into_font().color(&rgb(palette::INK));
            above.draw(&Text::new(text, (x + 10, 13), style)).map_err(report_error)?;
        }
        let areas = charts.split_evenly((rows, COLUMNS));
        for ((lever, levels), area) in levers.iter().zip(levels).zip(&areas) {
            draw(lever, levels, area)?;
        }
        page.present().map_err(report_error)?;
    }
    Ok(svg)
}

fn draw(
    lever: &Lever,
    levels: &[LeverLevel],
    area: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
) -> Result<(), ExperimentError> {
    let ends = |of: fn(f64, f64) -> f64, from: f64| lever.values.iter().copied().fold(from, of);
    let (least, most) = (ends(f64::min, f64::INFINITY), ends(f64::max, f64::NEG_INFINITY));
    let margin = 0.05 * (most - least).max(0.1);
    let name = match lever.unit.as_str() {
        "" => lever.setting.clone(),
        unit => format!("{} ({unit})", lever.setting),
    };
    let digits = usize::from(most - least < 5.0) + usize::from(most - least < 1.0);
    let ranges = (least - margin..most + margin, 0.0..10.0);
    let mut chart = chart_with(area, ranges, (&name, "m, n"), (6, 6), digits)?;
    for (color, dial) in [(1, 1), (2, 2)] {
        let color = rgb(colors::MEASURED[color]);
        let point = |level: &LeverLevel| {
            let estimate = level.dials.named()[dial].1;
            let half = level.half_interval(estimate);
            let ends = [estimate.value - half, estimate.value + half];
            ((level.value, estimate.value), ends.map(|end| end.clamp(0.0, 10.0)))
        };
        let points: Vec<_> = levels.iter().map(point).collect();
        let line = LineSeries::new(points.iter().map(|(at, _)| *at), color.stroke_width(2));
        chart.draw_series(line).map_err(report_error)?;
        for &(at, [low, high]) in &points {
            let bar =
                PathElement::new([(at.0, low), (at.0, high)], color.mix(0.55).stroke_width(2));
            chart.draw_series([bar]).map_err(report_error)?;
            chart.draw_series([Circle::new(at, 3, color.filled())]).map_err(report_error)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use envgen::calibration::{Dials, Estimate};

    use super::*;
    use crate::difficulty::levers::LeverDesign;

    #[test]
    fn every_lever_has_a_chart_with_its_values() {
        let design = LeverDesign::first();
        let level = |&value: &f64| {
            let dials = Dials::default().map(|()| Estimate { value: 4.0, standard_error: 0.3 });
            LeverLevel { value, dials, maps: 6 }
        };
        let levels: Vec<Vec<LeverLevel>> =
            design.levers.iter().map(|lever| lever.values.iter().map(level).collect()).collect();
        let svg = figure(&design.levers, &levels).expect("a figure");
        for lever in &design.levers {
            assert!(svg.contains(&lever.setting), "{}", lever.setting);
        }
        let values: usize = levels.iter().map(Vec::len).sum();
        // Two dots for each value, and two in the key.
        assert_eq!(svg.matches("<circle").count(), 2 * values + 2);
        assert!(figure(&[], &[]).is_ok());
    }
}
