//! The page around the world: frame, title, start and goal, scale bar and legend.

use glam::DVec2;
use svg::Document;
use svg::node::element::{
    ClipPath, Definitions, Group, LinearGradient, Stop, Style as StyleSheet, Title,
};

use super::labels::Names;
use super::parts;
use super::shapes::rectangle;
use super::symbols::{arrow, flag, symbols};
use super::text::Typesetter;
use super::title::Heading;
use super::view::{self, View};
use super::{MAX_PIXELS, PictureError, PictureOptions, labels, legend, profile};
use crate::geometry::Rect;
use crate::palette;
use crate::world::World;

/// Space between the frame and the world's bounds in px.
const BORDER: f64 = 14.0;

/// The same if the symbol of the start or the goal would extend beyond the frame.
const WIDE_BORDER: f64 = 30.0;
pub(super) const TITLE_HEIGHT: f64 = 26.0;

/// The least width and height of the plan in px.
const LEAST_PLAN: DVec2 = DVec2::new(120.0, 40.0);

/// The width of a legend at the side in px.
const SIDE: f64 = 200.0;

/// Draws the whole picture.
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
    let entries = if options.legend {
        legend::entries(world, options.scenario.as_ref(), &view, &names.numbers)
    } else {
        Vec::new()
    };

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
        page(size, &heading).add(rectangle(plan).set("fill", palette::PLAN.to_string()));
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
        .set("stroke", palette::FRAME.to_string());
    document = document.add(frame);
    if let Some(goal) = world.goal {
        document = document.add(flag(view.px(goal.position), 1.0).set("id", "goal"));
    }
    if let Some(start) = world.start {
        document = document.add(arrow(view.px(start.position), start).set("id", "start"));
    }
    Ok(furniture.into_iter().fold(document, Document::add))
}

/// The style that keeps cells of rasters sharp in browsers; other programs use the images' own `optimizeSpeed`.
const SHARP: &str = "@supports (image-rendering:pixelated){image{image-rendering:pixelated}}";

/// Creates an empty page of a size in px.
pub(super) fn page(size: DVec2, heading: &Heading) -> Document {
    Document::new()
        .set("width", size.x)
        .set("height", size.y)
        .set("viewBox", (0, 0, size.x, size.y))
        .set("role", "img")
        .add(Title::new(heading.text()))
        .add(StyleSheet::new(SHARP))
        .add(rectangle(Rect::new(DVec2::ZERO, size)).set("fill", palette::PAGE.to_string()))
}

fn difficulty_gradient() -> LinearGradient {
    (0..=10).fold(LinearGradient::new().set("id", "difficulty"), |gradient, i| {
        let color = palette::difficulty(f64::from(i));
        gradient.add(
            Stop::new().set("offset", f64::from(i) / 10.0).set("stop-color", color.to_string()),
        )
    })
}
