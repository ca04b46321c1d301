//! The page around the world: frame, title, start and goal, scale bar, legend.

use glam::DVec2;
use svg::Document;
use svg::node::element::{
    ClipPath, Definitions, Group, LinearGradient, Path, Rectangle, Stop, Style as StyleSheet, Title,
};

use super::labels::Names;
use super::parts::{self, filled, stroked};
use super::path::PathData;
use super::style::{self, Color, Style};
use super::text::{Align, CAPITAL_HEIGHT, Typesetter};
use super::title::Heading;
use super::view::{self, View};
use super::{MAX_PIXELS, PictureError, PictureOptions, labels, legend, profile};
use crate::geometry::{Pose, Rect, unit_vector};
use crate::world::World;

/// Space between the frame and the world's bounds in px.
const BORDER: f64 = 14.0;

/// The same where the symbol of start or goal would extend beyond the frame.
const WIDE_BORDER: f64 = 30.0;
pub(super) const TITLE_HEIGHT: f64 = 26.0;

/// The narrowest and lowest plan in px.
const LEAST_PLAN: DVec2 = DVec2::new(120.0, 40.0);

/// The width of a legend at the side in px.
const SIDE: f64 = 200.0;

/// The whole picture.
pub(super) fn document(world: &World, options: &PictureOptions) -> Result<Document, PictureError> {
    let typesetter = Typesetter::new();
    let heading = Heading::new(world, options);
    let margin = f64::from(options.margin);
    let top = if heading.name.is_empty() { margin } else { margin + TITLE_HEIGHT };
    let extent = view::extent(world);
    let most = DVec2::new(f64::from(options.width) - 2.0 * margin, options.height.into());
    let most = most.max(DVec2::splat(40.0));
    let (width, height) = (most.x as u64, most.y as u64);
    if width * height > MAX_PIXELS {
        return Err(PictureError::TooLarge { width, height });
    }
    let corner = DVec2::new(margin, top);
    let fit = |most: DVec2| {
        let fit = |border| {
            View::new(extent, corner, LEAST_PLAN.min(most), most, border)
                .ok_or(PictureError::Scale(extent))
        };
        let view = fit(BORDER)?;
        let inside = symbols(world, &view).into_iter().all(|s| view.plan.contains_rect(s));
        if inside { Ok(view) } else { fit(WIDE_BORDER) }
    };
    let mut view = fit(most)?;
    // High worlds have the legend at the side.
    let shape = view.plan.size();
    let beside = options.legend && shape.x < 0.6 * shape.y && most.x >= 2.0 * SIDE;
    if beside {
        view = fit(most - DVec2::new(SIDE, 0.0))?;
    }

    let names = if options.names {
        labels::draw(world, &view, options.legend, &typesetter)
    } else {
        Names::default()
    };
    let entries =
        if options.legend { legend::entries(world, &view, &names.numbers) } else { Vec::new() };

    let plan = view.plan;
    let (mut right, mut bottom) = (plan.max.x, plan.max.y);
    let mut furniture = Vec::new();
    if options.curvature_profile
        && let Some((group, height)) = profile::draw(world, &view, bottom + 10.0, &typesetter)
    {
        furniture.push(group);
        bottom += 10.0 + height;
    }
    if beside {
        let corner = DVec2::new(right + 14.0, plan.min.y);
        let (group, size) = legend::draw(entries, &view, corner, 0.0, &typesetter);
        furniture.push(group);
        (right, bottom) = (corner.x + size.x, bottom.max(corner.y + size.y));
    } else {
        let corner = DVec2::new(plan.min.x, bottom + 8.0);
        let room = plan.size().x;
        let (group, size) = legend::draw(entries, &view, corner, room, &typesetter);
        furniture.push(group);
        bottom = corner.y + size.y;
    }

    let size = DVec2::new(right + margin, bottom + margin).ceil();
    let mut document =
        page(size, &heading).add(rectangle(plan).set("fill", style::PLAN.to_string()));
    if !heading.name.is_empty() {
        document = document.add(heading.row(&view, right, &typesetter));
    }
    let clip = ClipPath::new().set("id", "plan").add(rectangle(plan));
    document = document.add(Definitions::new().add(clip).add(difficulty_gradient()));
    let inside = parts::draw(world, &view, options)?
        .into_iter()
        .chain(names.group)
        .fold(Group::new().set("clip-path", "url(#plan)"), Group::add);
    document = document.add(inside);
    let frame = rectangle(Rect::new(plan.min + 0.5, plan.max - 0.5))
        .set("fill", "none")
        .set("stroke", style::FRAME.to_string());
    document = document.add(frame);
    if let Some(goal) = world.goal {
        document = document.add(flag(view.px(goal.position), 1.0).set("id", "goal"));
    }
    if let Some(start) = world.start {
        document = document.add(arrow(view.px(start.position), start).set("id", "start"));
    }
    Ok(furniture.into_iter().fold(document, Document::add))
}

/// Cells of rasters stay sharp: by this in browsers, by the images' own `optimizeSpeed` elsewhere.
const SHARP: &str = "@supports (image-rendering:pixelated){image{image-rendering:pixelated}}";

/// An empty page of a size in px.
pub(super) fn page(size: DVec2, heading: &Heading) -> Document {
    Document::new()
        .set("width", size.x)
        .set("height", size.y)
        .set("viewBox", (0, 0, size.x, size.y))
        .set("role", "img")
        .add(Title::new(heading.text()))
        .add(StyleSheet::new(SHARP))
        .add(rectangle(Rect::new(DVec2::ZERO, size)).set("fill", style::PAGE.to_string()))
}

pub(super) fn rectangle(rect: Rect) -> Rectangle {
    let size = rect.size();
    Rectangle::new()
        .set("x", rect.min.x)
        .set("y", rect.min.y)
        .set("width", size.x)
        .set("height", size.y)
}

fn difficulty_gradient() -> LinearGradient {
    (0..=10).fold(LinearGradient::new().set("id", "difficulty"), |gradient, i| {
        let color = style::difficulty(f64::from(i));
        gradient.add(
            Stop::new().set("offset", f64::from(i) / 10.0).set("stop-color", color.to_string()),
        )
    })
}

/// The start: a disc with an arrow along the heading.
pub(super) fn arrow(at: DVec2, pose: Pose) -> Group {
    let heading = unit_vector(pose.heading);
    let along = DVec2::new(heading.x, -heading.y);
    let across = along.perp();
    let p = |x: f64, y: f64| at + along * x + across * y;
    let mut path = PathData::new(2);
    path.circle(at, 5.5);
    path.polygon([p(4.0, 1.4), p(4.0, -1.4), p(14.0, -1.4), p(14.0, 1.4)].into_iter().rev());
    path.polygon([p(23.0, 0.0), p(11.5, -6.0), p(13.5, 0.0), p(11.5, 6.0)].into_iter().rev());
    haloed(path, style::START, style::PAGE, 3.0)
}

/// A symbol or a label with a rim of another colour, which separates it from what lies below. The rim
/// is an element of its own, since not every program supports `paint-order`.
pub(super) fn haloed(path: PathData, color: Color, halo: Color, width: f64) -> Group {
    let rim = filled(path.clone(), halo)
        .set("stroke", halo.to_string())
        .set("stroke-width", width)
        .set("stroke-linejoin", "round");
    Group::new().add(rim).add(filled(path, color))
}

/// The goal: a flag whose pole ends on it, 23 px high at a size of 1. It has no rim, which would cut
/// open the walls behind it.
pub(super) fn flag(at: DVec2, size: f64) -> Group {
    let p = |x: f64, y: f64| at + DVec2::new(x, y) * size;
    let [mut pole, mut cloth] = [PathData::new(2), PathData::new(2)];
    pole.circle(at, 3.4 * size);
    pole.rect(p(-1.0, -23.0), p(1.0, 0.0));
    cloth.polygon([p(1.0, -23.0), p(17.0, -17.5), p(1.0, -12.0)]);
    let cloth = filled(cloth, style::GOAL)
        .set("stroke", style::INK.to_string())
        .set("stroke-width", 0.8 * size)
        .set("stroke-linejoin", "round");
    Group::new().add(filled(pole, style::INK)).add(cloth)
}

/// The rectangles that the symbols of start and goal cover.
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

/// The scale bar with its lower left corner at `at`, and its width with the label; `None` when
/// no round length is long enough to be visible.
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
        .add(stroked(bar, style::INK, 1.5))
        .add(filled(label, style::INK));
    Some((group, long + 6.0 + typesetter.width(&text, 12.0)))
}

/// A legend's sample of a filled part.
pub(super) fn sample(style: Style, min: DVec2, max: DVec2) -> Path {
    let mut path = PathData::new(2);
    path.rect(min, max);
    filled(path, style.fill)
        .set("stroke", style.edge.to_string())
        .set("stroke-width", style.edge_width.max(0.8))
}

/// A colour bar from 0 to 10 of the difficulties, `width` px wide, and its numbers.
pub(super) fn difficulty_bar(
    min: DVec2,
    width: f64,
    label: &mut PathData,
    typesetter: &Typesetter,
) -> Group {
    let edge: Color = style::FRAME;
    let bar = rectangle(Rect::new(min, min + DVec2::new(width, 10.0)))
        .set("fill", "url(#difficulty)")
        .set("stroke", edge.to_string())
        .set("stroke-width", 0.8);
    for tenth in [0.0, 5.0, 10.0] {
        let at = min + DVec2::new(width * tenth / 10.0, 12.5 + CAPITAL_HEIGHT * 9.0);
        typesetter.write(label, &view::short(tenth), at, 9.0, Align::Middle);
    }
    Group::new().add(bar)
}
