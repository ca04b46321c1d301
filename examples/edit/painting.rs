//! Drawings over the world: the grid, names, what is out of reach, and the change that is being made.

use bevy_mapping_trial::ui::egui;
use egui::{Color32, FontId, Painter, Pos2, Rgba, Stroke, StrokeKind, Ui};
use envgen::geometry::{Rect as WorldRect, Shape};
use envgen::glam::DVec2;

use crate::session::Session;

/// Colour of text on the plan.
pub(crate) const INK: Color32 = Color32::from_rgb(0x22, 0x26, 0x2e);
const GRID: Color32 = Color32::from_black_alpha(36);
pub(crate) const UNREACHED: Color32 = Color32::from_rgb(0xc4, 0x00, 0x94);
pub(crate) const ERROR: Color32 = Color32::from_rgb(0xb0, 0x1e, 0x1e);
const ALLOWED: Color32 = Color32::from_rgb(0x0c, 0x6b, 0x3c);
const SELECTED: Color32 = Color32::from_rgb(0x0b, 0x5c, 0xc4);

/// Least distance in points between lines of the grid. Denser ones are left out.
const LEAST_CELL: f64 = 6.0;

/// Least width in points of squares that are out of reach. Narrower ones are left out, since they are
/// many.
const LEAST_SQUARE: f64 = 0.5;

/// Least width in points of rooms whose names are drawn.
const LEAST_NAMED: f64 = 46.0;

/// Width of texts at the pointer in points.
const NOTE_WIDTH: f32 = 300.0;

/// A translucent colour. The window mixes light, not colour values.
fn clear(color: Color32, opacity: f32) -> Color32 {
    (Rgba::from(color) * opacity).into()
}

/// A preview of what a click or the end of a drag would do.
pub(crate) struct Ghost {
    pub(crate) outline: Option<Shape>,
    /// Why it is not allowed.
    pub(crate) refused: Option<String>,
}

pub(crate) fn paint(ui: &Ui, session: &Session, ghost: Option<&Ghost>) {
    let painter = ui.painter_at(session.canvas());
    if session.grid {
        grid(&painter, session);
    }
    unreached(&painter, session);
    names(&painter, session);
    let outline = |target| session.document.outline(target);
    if let Some(shape) = session.hovered.and_then(outline) {
        draw(&painter, session, &shape, Color32::TRANSPARENT, Stroke::new(1.5, SELECTED));
    }
    if let Some(shape) = session.selected.and_then(outline) {
        draw(&painter, session, &shape, Color32::TRANSPARENT, Stroke::new(2.5, SELECTED));
    }
    if let Some(Ghost { outline: Some(shape), refused }) = ghost {
        let color = if refused.is_some() { ERROR } else { ALLOWED };
        draw(&painter, session, shape, clear(color, 0.55), Stroke::new(2.0, color));
    }
    let refused = ghost.and_then(|ghost| ghost.refused.as_deref()).zip(session.pointer);
    let refusal = session.refusal.as_ref().map(|refusal| (refusal.text.as_str(), refusal.at));
    if let Some((text, at)) = refused.or(refusal) {
        note(&painter, session, text, at);
    }
}

/// Lines between the cells of a plan, or lines of round metres.
fn grid(painter: &Painter, session: &Session) {
    let area = session.view.area();
    let (step, bounds) = match session.document.plan() {
        Some(plan) => {
            let (columns, rows) = (plan.grid().width(), plan.grid().height());
            let size = DVec2::new(f64::from(columns), f64::from(rows)) * plan.spec().cell_size;
            (plan.spec().cell_size, WorldRect::new(DVec2::ZERO, size))
        }
        None => {
            let steps = [0.1, 0.5, 1.0, 5.0, 10.0, 50.0, 100.0, 500.0, 1000.0];
            let wide = |step: &f64| step / session.view.scale() > 24.0;
            (steps.into_iter().find(wide).unwrap_or(5000.0), session.document.world().bounds)
        }
    };
    if step / session.view.scale() < LEAST_CELL {
        return;
    }
    let (min, max) = (area.min.max(bounds.min), area.max.min(bounds.max));
    let lines = |from: f64, to: f64| {
        let (first, last) = ((from / step - 1e-9).ceil() as i64, (to / step + 1e-9).floor() as i64);
        (first..=last).map(move |i| i as f64 * step)
    };
    let stroke = Stroke::new(1.0, GRID);
    let line = |a: DVec2, b: DVec2| {
        painter.line_segment([session.view.to_canvas(a), session.view.to_canvas(b)], stroke);
    };
    lines(min.x, max.x).for_each(|x| line(DVec2::new(x, min.y), DVec2::new(x, max.y)));
    lines(min.y, max.y).for_each(|y| line(DVec2::new(min.x, y), DVec2::new(max.x, y)));
}

/// Highlights places that are out of reach.
fn unreached(painter: &Painter, session: &Session) {
    let Some(audit) = session.auditing.audit.get() else { return };
    let Ok(Some(places)) = &audit.unreached else { return };
    let (mut mesh, color) = (egui::Mesh::default(), clear(UNREACHED, 0.85));
    let (area, least) = (session.view.area(), LEAST_SQUARE * session.view.scale());
    let seen = |square: &&WorldRect| area.overlaps(**square) && square.size().x >= least;
    for square in places.squares.iter().filter(seen) {
        let first = mesh.vertices.len() as u32;
        for corner in Shape::from_rect(*square).corners() {
            mesh.colored_vertex(session.view.to_canvas(corner), color);
        }
        mesh.add_triangle(first, first + 1, first + 2);
        mesh.add_triangle(first, first + 2, first + 3);
    }
    painter.add(mesh);
    // Rooms of an earlier state may have other numbers.
    let present = session.auditing.audit.of(session.revision).map(|_| &places.rooms);
    for &room in present.into_iter().flatten() {
        if let Some(room) = session.document.world().rooms.get(room as usize) {
            draw(painter, session, &room.shape, Color32::TRANSPARENT, Stroke::new(2.5, UNREACHED));
        }
    }
}

/// Draws the names of rooms that are wide enough.
fn names(painter: &Painter, session: &Session) {
    let area = session.view.area();
    for room in &session.document.world().rooms {
        let bounds = room.shape.bounds();
        let width = bounds.size().x / session.view.scale();
        if width < LEAST_NAMED || !area.overlaps(bounds) {
            continue;
        }
        let galley =
            painter.layout(room.name.clone(), FontId::proportional(10.5), INK, width as f32 - 4.0);
        let middle = session.view.to_canvas(bounds.center());
        let corner = middle - 0.5 * galley.size();
        let back = egui::Rect::from_min_size(corner, galley.size()).expand(1.5);
        painter.rect_filled(back, 2.0, clear(Color32::WHITE, 0.7));
        painter.galley(corner, galley, INK);
    }
}

fn draw(painter: &Painter, session: &Session, shape: &Shape, fill: Color32, stroke: Stroke) {
    let place = |p: DVec2| session.view.to_canvas(p);
    match shape {
        Shape::Disc { center, radius } => {
            let (center, radius) = (place(*center), session.view.radii(*radius));
            let angle = 0.0;
            painter.add(egui::epaint::EllipseShape { center, radius, fill, stroke, angle });
        }
        Shape::Segment { a, b } => _ = painter.line_segment([place(*a), place(*b)], stroke),
        Shape::Box { .. } => {
            let corners: Vec<Pos2> = shape.corners().into_iter().map(place).collect();
            painter.add(egui::Shape::convex_polygon(corners, fill, stroke));
        }
        // The polygon may not be convex.
        Shape::Polygon { vertices } => {
            let corners: Vec<Pos2> = vertices.iter().map(|&v| place(v)).collect();
            painter.add(egui::Shape::closed_line(corners, stroke));
        }
    }
}

/// Draws a short text beside a point, inside of the canvas.
fn note(painter: &Painter, session: &Session, text: &str, at: DVec2) {
    let galley =
        painter.layout(text.to_owned(), FontId::proportional(13.0), Color32::WHITE, NOTE_WIDTH);
    let canvas = session.canvas().shrink(8.0);
    let size = galley.size() + egui::vec2(12.0, 8.0);
    let wanted = session.view.to_canvas(at) + egui::vec2(16.0, 16.0);
    let corner = wanted.min(canvas.max - size).max(canvas.min);
    let back = egui::Rect::from_min_size(corner, size);
    painter.rect_filled(back, 4.0, ERROR);
    painter.rect_stroke(back, 4.0, Stroke::new(1.0, Color32::WHITE), StrokeKind::Inside);
    painter.galley(corner + egui::vec2(6.0, 4.0), galley, Color32::WHITE);
}

/// Draws a small plan of a room in the list of rooms.
pub(crate) fn thumbnail(painter: &Painter, place: egui::Rect, room: &envgen::indoor::RoomDesign) {
    let size = room.size();
    let scale = (f64::from(place.width()) / size.x).min(f64::from(place.height()) / size.y);
    let corner =
        place.center() - 0.5 * egui::vec2((size.x * scale) as f32, (size.y * scale) as f32);
    let to = |p: DVec2| corner + egui::vec2((p.x * scale) as f32, ((size.y - p.y) * scale) as f32);
    let floor = egui::Rect::from_two_pos(to(DVec2::ZERO), to(size));
    let lit = if room.lit { Color32::from_gray(0xf2) } else { Color32::from_rgb(0xb4, 0xb6, 0xc6) };
    painter.rect(floor, 0.0, lit, Stroke::new(1.0, INK), StrokeKind::Inside);
    let fill = |shape: &Shape, color: Color32| match shape {
        Shape::Disc { center, radius } => {
            painter.circle_filled(to(*center), (radius * scale) as f32, color);
        }
        shape => {
            let corners = shape.corners().into_iter().map(to).collect();
            painter.add(egui::Shape::convex_polygon(corners, color, Stroke::NONE));
        }
    };
    let surfaces =
        room.surfaces.iter().map(|part| (&part.shape, Color32::from_rgb(0xc9, 0xd8, 0xe8)));
    let obstacles =
        room.obstacles.iter().map(|part| (&part.shape, Color32::from_rgb(0xb0, 0x7d, 0x4a)));
    let walls = room.walls.iter().map(|part| (&part.shape, INK));
    surfaces.chain(obstacles).chain(walls).for_each(|(shape, color)| fill(shape, color));
    for victim in &room.victims {
        painter.circle_filled(to(victim.position), 2.0, Color32::from_rgb(0xa0, 0x3c, 0x80));
    }
}
