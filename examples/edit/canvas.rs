//! The canvas with the plan, and the actions of the pointer on it.

use bevy_mapping_trial::ui::egui;
use egui::{PointerButton, Sense, Ui};
use envgen::edit::{Change, Target, WorldEdit};
use envgen::glam::DVec2;
use envgen::indoor::{Edit, PlanTarget};

use crate::painting::{self, Ghost};
use crate::session::{Drag, Session};
use crate::tools::{Painting, Tool};

/// Greatest distance in points of the pointer from what it selects.
const REACH: f64 = 4.0;

/// Objects are moved by multiples of this distance, in metres.
const STEP: f64 = 0.05;

/// A line that is in a cell for less than this fraction of its length passes the cell's corner.
const CORNER: f64 = 1e-9;

/// Change of the zoom per step of the wheel.
const ZOOM_A_POINT: f64 = 0.002;

/// Shows the canvas, and carries out what the person does on it.
pub(crate) fn show(ui: &mut Ui, session: &mut Session) {
    let area = ui.available_rect_before_wrap();
    session.view.set_canvas(area, ui.pixels_per_point());
    let response = ui.interact(area, ui.id().with("canvas"), Sense::click_and_drag());
    navigate(ui, &response, session);
    let pointer = response.hover_pos().or(response.interact_pointer_pos());
    let at = pointer.map(|p| session.view.to_world(p));
    let reach = REACH * session.view.scale();
    match session.tools.tool {
        Tool::Select => select(ui, &response, session, reach),
        Tool::Hallway => paint(ui, &response, session),
        _ if response.clicked_by(PointerButton::Primary) => {
            if let Some(at) = at {
                click(session, at);
            }
        }
        _ => {}
    }
    let is_free = session.drag.is_none();
    session.hovered = at.filter(|_| is_free).and_then(|p| session.target_seen(p, reach));
    session.pointer = at;
    let leave = 2.0 * reach;
    session.done_at =
        session.done_at.filter(|done| at.is_some_and(|at| at.distance(*done) < leave));
    let shows = session.drag.is_some() || session.done_at.is_none();
    let ghost = at.filter(|_| shows).and_then(|at| ghost(session, at));
    painting::paint(ui, session, ghost.as_ref());
}

/// Moves the plan with the middle and the right button, and zooms with the wheel.
fn navigate(ui: &Ui, response: &egui::Response, session: &mut Session) {
    for button in [PointerButton::Middle, PointerButton::Secondary] {
        if response.dragged_by(button) {
            session.view.pan(response.drag_delta());
        }
    }
    if let Some(pointer) = response.hover_pos() {
        let (scrolled, pinched) =
            ui.input(|input| (input.smooth_scroll_delta(), input.zoom_delta()));
        let factor =
            (1.0 - ZOOM_A_POINT * f64::from(scrolled.y)).clamp(0.5, 2.0) / f64::from(pinched);
        if factor != 1.0 {
            session.view.zoom(factor, pointer);
        }
    }
}

fn select(ui: &Ui, response: &egui::Response, session: &mut Session, reach: f64) {
    let pressed = ui.input(|input| input.pointer.press_origin());
    if response.drag_started_by(PointerButton::Primary)
        && let Some(from) = pressed.map(|p| session.view.to_world(p))
    {
        let seen = session.seen_at(from);
        // The selected thing is moved even if something else lies on it.
        let selected = session.selected.filter(|&target| {
            session.document.outline(target).is_some_and(|shape| shape.distance(seen) <= reach)
        });
        let target = selected.or_else(|| session.target_seen(from, reach));
        session.selected = target;
        session.drag = target.map(|target| Drag { target, from });
    }
    let at = response.interact_pointer_pos().map(|p| session.view.to_world(p));
    if response.drag_stopped_by(PointerButton::Primary)
        && let (Some(drag), Some(at)) = (session.drag.take(), at)
    {
        match moved(session, drag, at) {
            Some(change) if is_move(session, &change) => _ = session.change(change, at),
            // A slow click counts as a drag.
            None if drag.from.distance(at) > reach => {
                session.refuse("this cannot be moved".to_owned(), at);
            }
            _ => {}
        }
    } else if response.clicked_by(PointerButton::Primary)
        && let Some(at) = at
    {
        session.selected = session.target_seen(at, reach);
        session.refusal = None;
    }
}

/// Returns the change that the end of a drag makes.
fn moved(session: &Session, drag: Drag, to: DVec2) -> Option<Change> {
    let by = to - drag.from;
    let is_room = matches!(drag.target, Target::Plan(PlanTarget::Room(_)));
    let by = if is_room { by } else { (by / STEP).round() * STEP };
    session.document.moved(drag.target, by)
}

/// Whether a room or part changes its position.
fn is_move(session: &Session, change: &Change) -> bool {
    let edit = match change {
        Change::Plan(edit) => edit,
        Change::World(edit) => {
            return !matches!(**edit, WorldEdit::Move { by, .. } if by == DVec2::ZERO);
        }
    };
    match **edit {
        Edit::MoveRoom { room, x, y } => session
            .document
            .plan()
            .and_then(|plan| plan.rooms().get(room))
            .is_none_or(|room| (room.x, room.y) != (x, y)),
        Edit::MoveObject { by, .. } => by != DVec2::ZERO,
        _ => true,
    }
}

/// Adds cells of hallways along the pointer, or removes them if the first one is a hallway.
fn paint(ui: &Ui, response: &egui::Response, session: &mut Session) {
    let Some(at) = response.interact_pointer_pos() else {
        session.tools.paints = None;
        return;
    };
    let is_down = ui.input(|input| input.pointer.primary_down());
    let (is_clicked, at) = (response.clicked_by(PointerButton::Primary), session.view.to_world(at));
    if !is_down && !is_clicked {
        session.tools.paints = None;
        return;
    }
    let Some(size) = session.document.plan().map(|plan| plan.spec().cell_size) else { return };
    let began = session.tools.paints;
    let (from, mut adds) = (began.map_or(at, |began| began.at), began.map(|began| began.adds));
    let mut has_changed = began.is_some_and(|began| began.has_changed);
    for p in in_each_cell(from, at, size) {
        let Some(change) = session.tools.paint(&session.document, p, adds) else { continue };
        // During a drag, what cannot be changed is skipped without a message.
        if adds.is_none() || session.document.test(change.clone()).is_ok() {
            has_changed = match has_changed {
                true => session.extend(change.clone(), at) || has_changed,
                false => session.change(change.clone(), at),
            };
        }
        let is_added = |edit: &Edit| matches!(edit, Edit::AddHallway { .. });
        adds.get_or_insert(matches!(&change, Change::Plan(edit) if is_added(edit)));
    }
    session.tools.paints = adds.filter(|_| is_down).map(|adds| Painting { adds, at, has_changed });
}

/// Returns a point in each cell that the line between two points crosses, in order: between two frames a fast pointer
/// passes over several cells.
fn in_each_cell(from: DVec2, to: DVec2, size: f64) -> Vec<DVec2> {
    // Where the line leaves a column or a row, as fractions of its length.
    let mut borders = vec![0.0, 1.0];
    for (from, to) in [(from.x / size, to.x / size), (from.y / size, to.y / size)] {
        let mut border = from.min(to).ceil();
        while from != to && border <= from.max(to) {
            borders.push((border - from) / (to - from));
            border += 1.0;
        }
    }
    borders.sort_by(f64::total_cmp);
    let within = borders.array_windows().filter(|[enter, leave]| leave - enter > CORNER);
    within.map(|[enter, leave]| from.lerp(to, 0.5 * (enter + leave))).collect()
}

fn click(session: &mut Session, at: DVec2) {
    match change_at(session, at) {
        Some(Ok(change)) => _ = session.change(change, at),
        Some(Err(reason)) => session.refuse(reason, at),
        None => {}
    }
}

/// Returns the change that a click at a point of the floor makes. Doorways are opened and closed where
/// a wall is seen; everything else is put onto the floor.
fn change_at(session: &mut Session, at: DVec2) -> Option<Result<Change, String>> {
    let at = if session.tools.tool == Tool::Doorway { session.seen_at(at) } else { at };
    session.tools.change_at(&session.document, &session.catalogue, at)
}

/// Returns what a click at a point, or the end of the drag there, would do.
fn ghost(session: &mut Session, at: DVec2) -> Option<Ghost> {
    let change = match session.drag {
        Some(drag) => Ok(moved(session, drag, at)?),
        None => change_at(session, at)?,
    };
    Some(match change {
        Ok(change) => {
            let outline = session.document.preview(&change);
            let is_moved = session.drag.is_none() || is_move(session, &change);
            let tested = if is_moved { session.document.test(change) } else { Ok(()) };
            Ghost { outline, refused: tested.err().map(|error| error.to_string()) }
        }
        Err(reason) => Ghost { outline: None, refused: Some(reason) },
    })
}
