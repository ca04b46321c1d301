//! Symbols of the page and its legend: start and goal, scale bar, and samples.

use glam::DVec2;
use svg::node::element::{Group, Path};

use super::path::PathData;
use super::shapes::{filled, rectangle, stroked};
use super::style::Style;
use super::text::{Align, CAPITAL_HEIGHT, Typesetter};
use super::view::{self, View};
use crate::geometry::{Pose, Rect, unit_vector};
use crate::palette::{self, Srgb};
use crate::world::World;

/// Draws the start: a disc with an arrow along the heading.
pub(super) fn arrow(at: DVec2, pose: Pose) -> Group {
    let heading = unit_vector(pose.heading);
    let along = DVec2::new(heading.x, -heading.y);
    let across = along.perp();
    let p = |x: f64, y: f64| at + along * x + across * y;
    let mut path = PathData::new(2);
    path.circle(at, 5.5);
    path.polygon([p(4.0, 1.4), p(4.0, -1.4), p(14.0, -1.4), p(14.0, 1.4)].into_iter().rev());
    path.polygon([p(23.0, 0.0), p(11.5, -6.0), p(13.5, 0.0), p(11.5, 6.0)].into_iter().rev());
    haloed(path, palette::START, palette::PAGE, 3.0)
}

/// Draws a symbol or a label with a rim of another colour, which separates it from what lies below. The rim is a
/// separate element, since not every program supports `paint-order`.
pub(super) fn haloed(path: PathData, color: Srgb, halo: Srgb, width: f64) -> Group {
    let rim = filled(path.clone(), halo)
        .set("stroke", halo.to_string())
        .set("stroke-width", width)
        .set("stroke-linejoin", "round");
    Group::new().add(rim).add(filled(path, color))
}

/// Draws the goal: a flag whose pole ends at the goal, 23 px high at a size of 1. It has no rim, which would hide
/// parts of the walls behind it.
pub(super) fn flag(at: DVec2, size: f64) -> Group {
    let p = |x: f64, y: f64| at + DVec2::new(x, y) * size;
    let [mut pole, mut cloth] = [PathData::new(2), PathData::new(2)];
    pole.circle(at, 3.4 * size);
    pole.rect(p(-1.0, -23.0), p(1.0, 0.0));
    cloth.polygon([p(1.0, -23.0), p(17.0, -17.5), p(1.0, -12.0)]);
    let cloth = filled(cloth, palette::GOAL)
        .set("stroke", palette::INK.to_string())
        .set("stroke-width", 0.8 * size)
        .set("stroke-linejoin", "round");
    Group::new().add(filled(pole, palette::INK)).add(cloth)
}

/// Returns the rectangles that the symbols of start and goal cover.
pub(super) fn symbols(world: &World, view: &View) -> Vec<Rect> {
    let start = world.start.map(|start| {
        let at = view.px(start.position);
        let heading = unit_vector(start.heading);
        let tip = at + DVec2::new(heading.x, -heading.y) * 23.0;
        Rect::new(at.min(tip), at.max(tip)).grown(6.0)
    });
    let goal = world.goal.map(|goal| {
        let at = view.px(goal.position);
        Rect::new(at - DVec2::new(4.0, 24.0), at + DVec2::new(18.0, 4.0))
    });
    start.into_iter().chain(goal).collect()
}

/// Draws the scale bar with its lower left corner at `at`, and returns it with its width including the label;
/// `None` if no round length is long enough to be visible.
pub(super) fn scale_bar(view: &View, at: DVec2, typesetter: &Typesetter) -> Option<(Group, f64)> {
    let metres = view::round_number(130.0_f64.min(0.5 * view.plan.size().x) / view.scale)?;
    let long = metres * view.scale;
    if !(4.0..1e4).contains(&long) {
        return None;
    }
    let [mut bar, mut label] = [PathData::new(2), PathData::new(2)];
    let v = DVec2::new;
    bar.polyline([at + v(0.5, -5.0), at + v(0.5, 0.0), at + v(long, 0.0), at + v(long, -5.0)]);
    let text = view::length(metres);
    typesetter.write(&mut label, &text, at + v(long + 6.0, 0.5), 12.0, Align::Left);
    let group = Group::new()
        .set("id", "scale-bar")
        .add(stroked(bar, palette::INK, 1.5))
        .add(filled(label, palette::INK));
    Some((group, long + 6.0 + typesetter.width(&text, 12.0)))
}

/// Draws a legend's sample of a filled part.
pub(super) fn sample(style: Style, min: DVec2, max: DVec2) -> Path {
    let mut path = PathData::new(2);
    path.rect(min, max);
    filled(path, style.fill)
        .set("stroke", style.edge.to_string())
        .set("stroke-width", style.edge_width.max(0.8))
}

/// Draws a colour bar of the difficulties from 0 to 10, `width` px wide, with its numbers.
pub(super) fn difficulty_bar(
    min: DVec2,
    width: f64,
    label: &mut PathData,
    typesetter: &Typesetter,
) -> Group {
    let bar = rectangle(Rect::new(min, min + DVec2::new(width, 10.0)))
        .set("fill", "url(#difficulty)")
        .set("stroke", palette::FRAME.to_string())
        .set("stroke-width", 0.8);
    for tenth in [0.0, 5.0, 10.0] {
        let at = min + DVec2::new(width * tenth / 10.0, 12.5 + CAPITAL_HEIGHT * 9.0);
        typesetter.write(label, &view::short(tenth), at, 9.0, Align::Middle);
    }
    Group::new().add(bar)
}
