//! The curvature of roads over their length, drawn below the plan.

use glam::DVec2;
use svg::node::element::{Group, Rectangle};

use super::path::PathData;
use super::shapes::{filled, stroked};
use super::text::{Align, Typesetter};
use super::view::{self, View, round_number};
use crate::curve::Curve;
use crate::palette;
use crate::world::World;

const HEIGHT: f64 = 124.0;
/// Space in px for the numbers and the name below the axis.
const FOOT: f64 = 32.0;
/// Space in px for the title above the curve.
const HEAD: f64 = 18.0;

/// Draws the profile with its upper border at `top`, and returns it with its height; `None` without roads.
///
/// Roads follow each other in the order of the world's list. Each pixel shows the greatest curvature to the left
/// and to the right that occurs within it.
pub(super) fn draw(
    world: &World,
    view: &View,
    top: f64,
    typesetter: &Typesetter,
) -> Option<(Group, f64)> {
    let curves = curves(world);
    let length = Some(length_of(&curves)).filter(|l| l.is_finite() && *l > 0.0)?;
    let greatest = curves.iter().map(Curve::max_curvature).fold(0.0, f64::max);
    let steepest = if greatest > 0.0 { greatest } else { 1.0 };

    let (left, right) = (view.plan.min.x, view.plan.max.x);
    let width = right - left;
    let axis = top + HEAD + 0.5 * (HEIGHT - HEAD - FOOT);
    let half = 0.5 * (HEIGHT - HEAD - FOOT) - 2.0;
    let columns = width.ceil().max(1.0) as usize;
    let range = extremes(&curves, columns);
    let mut group = Group::new().set("id", "curvature-profile").add(
        Rectangle::new()
            .set("x", left)
            .set("y", top)
            .set("width", width)
            .set("height", HEIGHT - FOOT)
            .set("fill", palette::PLAN.to_string()),
    );
    for (side, color) in [(0, palette::BLUE), (1, palette::VERMILION)] {
        let mut path = PathData::new(1);
        path.move_to(DVec2::new(left, axis));
        for (i, curvature) in range.iter().enumerate() {
            let y = axis - half * curvature[side] / steepest;
            path.line_to(DVec2::new(left + i as f64, y));
            path.line_to(DVec2::new((left + i as f64 + 1.0).min(right), y));
        }
        path.line_to(DVec2::new(right, axis));
        path.close();
        group = group.add(filled(path, color).set("fill-opacity", 0.75));
    }
    let mut zero = PathData::new(1);
    zero.line(DVec2::new(left, axis), DVec2::new(right, axis));
    let mut ticks = PathData::new(1);
    let [mut label, mut quiet] = [PathData::new(2), PathData::new(2)];
    let bottom = top + HEIGHT - FOOT;
    if let Some(step) = round_number(length * 110.0 / width) {
        let count = (length / step * (1.0 + 1e-9)).floor().min(1000.0) as u32;
        for i in 0..=count {
            let x = left + width * (f64::from(i) * step / length).min(1.0);
            ticks.line(DVec2::new(x, bottom), DVec2::new(x, bottom + 4.0));
            let text = view::length(f64::from(i) * step);
            let align = match i {
                0 => Align::Left,
                _ if x + 20.0 > right => Align::Right,
                _ => Align::Middle,
            };
            let text = if i == 0 { "0" } else { &text };
            typesetter.write(&mut quiet, text, DVec2::new(x, bottom + 14.5), 10.0, align);
        }
    }
    let at = |x, y| DVec2::new(x, y);
    // The greatest round curvature that fits, to both sides.
    let mut levels = PathData::new(1);
    if let Some(level) = round_number(steepest) {
        for (side, sign) in [(1.0, ""), (-1.0, "−")] {
            let y = axis - half * side * level / steepest;
            levels.line(at(left, y), at(right, y));
            let text = format!("{sign}{}/m", view::short(level));
            let below = if side > 0.0 { 11.0 } else { -4.0 };
            typesetter.write(&mut quiet, &text, at(left + 6.0, y + below), 10.0, Align::Left);
        }
    }
    typesetter.write(
        &mut quiet,
        "distance along the road",
        at(0.5 * (left + right), bottom + 27.0),
        10.0,
        Align::Middle,
    );
    let title = "curvature: left above, right below";
    typesetter.write(&mut label, title, at(left + 6.0, top + 13.0), 11.0, Align::Left);
    let radius = if greatest > 0.0 {
        format!("sharpest {}/m, radius {}", view::short(greatest), view::length(1.0 / greatest))
    } else {
        "straight".to_owned()
    };
    if typesetter.width(title, 11.0) + typesetter.width(&radius, 11.0) + 30.0 < width {
        typesetter.write(&mut quiet, &radius, at(right - 6.0, top + 13.0), 11.0, Align::Right);
    }
    let frame = Rectangle::new()
        .set("x", left + 0.5)
        .set("y", top + 0.5)
        .set("width", width - 1.0)
        .set("height", HEIGHT - FOOT - 1.0)
        .set("fill", "none")
        .set("stroke", palette::FRAME.to_string());
    let group = group
        .add(stroked(levels, palette::GRID, 0.8))
        .add(stroked(zero, palette::INK, 0.8))
        .add(frame)
        .add(stroked(ticks, palette::QUIET_INK, 0.8))
        .add(filled(label, palette::INK))
        .add(filled(quiet, palette::QUIET_INK));
    Some((group, HEIGHT))
}

/// Returns the pieces of all roads. Where only points are known, the curvature that a point states holds up to the
/// next.
fn curves(world: &World) -> Vec<Curve> {
    let mut curves = Vec::new();
    for strip in &world.road_strips {
        if !strip.pieces.is_empty() {
            curves.extend_from_slice(&strip.pieces);
            continue;
        }
        let closing = strip.centreline.first().filter(|_| strip.closed);
        let ends = strip.centreline.iter().skip(1).chain(closing);
        curves.extend(strip.centreline.iter().zip(ends).map(|(point, end)| {
            let length = point.pose.position.distance(end.pose.position);
            Curve::arc(point.pose, length, point.curvature)
        }));
    }
    curves
}

fn length_of(curves: &[Curve]) -> f64 {
    curves.iter().map(|curve| curve.length).sum()
}

/// Returns the greatest and the least curvature, or 0, in each of so many columns of equal length.
fn extremes(curves: &[Curve], columns: usize) -> Vec<[f64; 2]> {
    let mut range = vec![[0.0_f64; 2]; columns];
    let width = length_of(curves) / columns as f64;
    let mut start = 0.0;
    for curve in curves {
        let first = ((start / width) as usize).min(columns - 1);
        let end = (((start + curve.length) / width).ceil() as usize).max(first + 1);
        for (i, column) in range.iter_mut().enumerate().take(end).skip(first) {
            // Curvature changes linearly along a piece.
            for edge in [i, i + 1] {
                let t = (edge as f64 * width - start).clamp(0.0, curve.length);
                let curvature = curve.curvature_at(t);
                *column = [column[0].max(curvature), column[1].min(curvature)];
            }
        }
        start += curve.length;
    }
    range
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Blueprint, Spec};
    use crate::road::RoadSpec;
    use crate::seed::Seed;

    #[test]
    fn every_column_has_the_extremes_of_its_curvature() {
        let spec =
            RoadSpec { segment_count: 40, transition: 0.4, step: 50.0, ..Default::default() };
        let world = spec.generate(Seed(4)).unwrap().to_world();
        let curves = curves(&world);
        assert_eq!(length_of(&curves), 1000.0);
        let path = world.road_strips[0].path();
        let columns = 130;
        for (i, found) in extremes(&curves, columns).into_iter().enumerate() {
            let samples = 2000;
            let inside = (0..=samples).map(|j| {
                let share = i as f64 + 1e-9 + (1.0 - 2e-9) * f64::from(j) / f64::from(samples);
                path.curvature_at(1000.0 * share / columns as f64)
            });
            let expected = inside.fold([0.0_f64; 2], |[most, least], curvature| {
                [most.max(curvature), least.min(curvature)]
            });
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-4, "column {i}: {found} {expected}");
                assert!(found.abs() >= expected.abs() - 1e-12, "column {i}: {found} {expected}");
            }
        }
    }
}
