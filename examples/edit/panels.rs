//! The panels beside the plan.

use bevy::prelude::*;
use bevy_mapping_trial::ui::bevy_egui::EguiContexts;
use bevy_mapping_trial::ui::egui;
use egui::text::{CCursor, CCursorRange};
use egui::{
    Button, CentralPanel, Color32, ComboBox, DragValue, Frame, Key, Modal, Panel, RichText,
    ScrollArea, Sense, TextEdit, Ui, UiBuilder,
};
use envgen::certificate::Verdict;
use envgen::edit::{Target, WorldEdit, WorldTarget};
use envgen::world::PartKind;

use crate::session::{Answer, Question, Session, TURN};
use crate::tools::{Piece, Tool};
use crate::{canvas, painting};

/// Widths of the panels in points.
const LEFT: f32 = 268.0;
const RIGHT: f32 = 252.0;

/// Window height in points at which texts have their normal size. They grow with the window.
const PLAIN_HEIGHT: f32 = 800.0;

/// Height of the list of rooms, as a fraction of the panel's height.
const ROOMS: f32 = 0.52;

/// Side of a room's small plan in the list.
const THUMBNAIL: f32 = 38.0;

const GOOD: Color32 = Color32::from_rgb(0x0c, 0x6b, 0x3c);
const WARNING: Color32 = Color32::from_rgb(0x9a, 0x5b, 0x00);

/// Draws everything except the world, and carries out the person's actions.
pub(crate) fn panels(
    mut contexts: EguiContexts,
    window: Single<&Window>,
    mut session: ResMut<Session>,
) -> Result {
    let context = contexts.ctx_mut()?;
    context.set_zoom_factor((window.height() / PLAIN_HEIGHT).clamp(1.0, 2.5));
    let mut visuals = egui::Visuals::light();
    visuals.override_text_color = Some(painting::INK);
    visuals.weak_text_color = Some(Color32::from_gray(0x5a));
    context.set_visuals(visuals);
    let area =
        UiBuilder::new().layer_id(egui::LayerId::background()).max_rect(context.viewport_rect());
    let mut screen = Ui::new(context.clone(), "screen".into(), area);
    let session = session.bypass_change_detection();
    Panel::left("tools").exact_size(LEFT).resizable(false).show(&mut screen, |ui| {
        file(ui, session);
        ui.separator();
        tools(ui, session);
    });
    Panel::right("findings").exact_size(RIGHT).resizable(false).show(&mut screen, |ui| {
        selection(ui, session);
        ui.separator();
        ScrollArea::vertical().show(ui, |ui| {
            findings(ui, session);
            ui.separator();
            difficulty(ui, session);
        });
    });
    Panel::bottom("status").exact_size(24.0).resizable(false).show(&mut screen, |ui| {
        status(ui, session);
    });
    CentralPanel::no_frame().frame(Frame::NONE).show(&mut screen, |ui| canvas::show(ui, session));
    if let Some(question) = session.question.clone() {
        ask(context, session, &question);
    }
    Ok(())
}

/// The name, undo and redo, saving, and the trial.
fn file(ui: &mut Ui, session: &mut Session) {
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        let mark = if session.document.is_changed() { " *" } else { "" };
        ui.add(
            egui::Label::new(RichText::new(format!("{}{mark}", session.name)).heading()).truncate(),
        );
    });
    ui.horizontal(|ui| {
        let mut button = |enabled: bool, text: &str, hint: &str| {
            ui.add_enabled(enabled, Button::new(text)).on_hover_text(hint).clicked()
        };
        if button(session.document.can_undo(), "Undo", "Ctrl+Z") {
            session.undo();
        }
        if button(session.document.can_redo(), "Redo", "Ctrl+Shift+Z or Ctrl+Y") {
            session.redo();
        }
        if button(true, "Fit", "Show everything (F)") {
            session.view.fit(session.document.world().bounds);
        }
        let tilt = "Show the plan or the world tilted (V), which Q and E turn";
        if button(true, if session.view.is_tilted() { "Plan" } else { "Tilt" }, tilt) {
            session.view.tilt();
        }
        if button(true, "Trial", "Open the world in a trial, in the program teleop (T)") {
            session.open_trial();
        }
    });
    ui.horizontal(|ui| {
        let letters = session.out.chars().count();
        let edit = TextEdit::singleline(&mut session.out).desired_width(LEFT - 78.0);
        let mut shown = edit.show(ui);
        let response = shown.response.response;
        if response.gained_focus() {
            // All of the text is selected, so that typing replaces it.
            let all = CCursorRange::two(CCursor::new(0), CCursor::new(letters));
            shown.state.cursor.set_char_range(Some(all));
            shown.state.store(ui.ctx(), response.id);
        }
        let response = response.on_hover_text(
            "The ending selects the format: .ron, .json, .xml (World Generator), .svg, .png, .yaml (ROS), .geojson, \
             .glb, .sdf and others",
        );
        let is_entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if ui.button("Save").on_hover_text("Ctrl+S").clicked() || is_entered {
            session.save();
        }
    });
    if let Some(failure) = &session.failure {
        ui.label(RichText::new(failure).color(painting::ERROR));
    }
}

fn tools(ui: &mut Ui, session: &mut Session) {
    ui.horizontal_wrapped(|ui| {
        for (tool, name, hint) in Tool::ALL {
            if session.tools.has(tool) {
                let is_chosen = session.tools.tool == tool;
                if ui.selectable_label(is_chosen, name).on_hover_text(hint).clicked() {
                    session.choose(tool);
                }
            }
        }
    });
    ui.add_space(2.0);
    match session.tools.tool {
        Tool::Select => {
            ui.weak("Click selects, dragging moves, R turns, Delete removes.");
        }
        Tool::Hallway => {
            ui.weak("Click or drag adds cells of hallway, or removes them.");
        }
        Tool::Doorway => {
            ui.weak("Click on a room's wall opens it, click on a doorway closes it.");
        }
        Tool::Room => rooms(ui, session),
        Tool::Object => object(ui, session),
    }
}

/// The rooms that can be added, with small plans.
fn rooms(ui: &mut Ui, session: &mut Session) {
    ui.weak("Click puts the room there, R turns it.");
    let height = (ROOMS * ui.ctx().viewport_rect().height()).min(ui.available_height());
    ScrollArea::vertical().max_height(height).auto_shrink(false).show(ui, |ui| {
        for (i, room) in session.catalogue.rooms().iter().enumerate() {
            let size = egui::vec2(ui.available_width(), THUMBNAIL + 6.0);
            let (place, response) = ui.allocate_exact_size(size, Sense::click());
            if response.clicked() {
                session.tools.room = i;
            }
            if !ui.is_rect_visible(place) {
                continue;
            }
            let painter = ui.painter();
            let style = ui.style().interact_selectable(&response, session.tools.room == i);
            if session.tools.room == i || response.hovered() {
                painter.rect_filled(place, 3.0, style.weak_bg_fill);
            }
            let corner = place.min + egui::vec2(4.0, 3.0);
            let picture = egui::Rect::from_min_size(corner, egui::Vec2::splat(THUMBNAIL));
            painting::thumbnail(painter, picture, room);
            let text = |row: f32, text: String, size: f32| {
                let at = corner + egui::vec2(THUMBNAIL + 8.0, row);
                let font = egui::FontId::proportional(size);
                painter.text(at, egui::Align2::LEFT_TOP, text, font, ui.visuals().text_color());
            };
            text(3.0, room.name.clone(), 13.0);
            let about = format!("{} x {}, difficulty {}", room.width, room.height, room.difficulty);
            text(21.0, about, 11.0);
        }
    });
}

/// The object to be added.
fn object(ui: &mut Ui, session: &mut Session) {
    let is_plan = session.document.plan().is_some();
    ui.weak(if is_plan {
        "Click puts the object into a room, R turns it."
    } else {
        "Click puts it there, R turns it."
    });
    let tools = &mut session.tools;
    ComboBox::from_id_salt("piece").selected_text(tools.piece.name()).show_ui(ui, |ui| {
        for (piece, name) in Piece::all(is_plan) {
            ui.selectable_value(&mut tools.piece, piece, name);
        }
    });
    let sizes = tools.piece.sizes();
    for (name, size) in ["length", "width"].into_iter().zip(&mut tools.size).skip(2 - sizes) {
        ui.horizontal(|ui| {
            ui.add(DragValue::new(size).range(0.05..=50.0).speed(0.05).suffix(" m"));
            ui.label(name);
        });
    }
}

/// The selection, and the actions on it.
fn selection(ui: &mut Ui, session: &mut Session) {
    ui.add_space(4.0);
    let Some(target) = session.selected else {
        ui.strong("Nothing is selected");
        ui.checkbox(&mut session.grid, "grid (G)");
        return;
    };
    ui.strong(session.document.describe(target));
    if let Some(size) = session.document.outline(target).map(|shape| shape.bounds().size()) {
        ui.weak(format!("{:.2} m by {:.2} m", size.x, size.y));
    }
    ui.horizontal(|ui| {
        let turns = session.document.turned(target, TURN).is_some();
        if ui.add_enabled(turns, Button::new("Turn")).on_hover_text("R, Shift+R back").clicked() {
            session.turn_selected(TURN);
        }
        if ui.button("Remove").on_hover_text("Delete").clicked() {
            session.remove();
        }
        if let Target::World(WorldTarget::Part(id)) = target
            && id.kind == PartKind::Doorway
            && let Some(doorway) = session.document.world().doorways.get(id.index as usize)
        {
            let (text, open) = if doorway.open { ("Close", false) } else { ("Open", true) };
            let at = doorway.shape.bounds().center();
            if ui.button(text).on_hover_text("The door").clicked() {
                let change = WorldEdit::SetOpen { doorway: id.index, open };
                session.change(change.into(), at);
            }
        }
    });
}

/// The claims about the world, and what is out of reach.
fn findings(ui: &mut Ui, session: &Session) {
    ui.horizontal(|ui| {
        ui.strong("Certificate");
        if session.auditing.audit.is_running() {
            ui.spinner();
        }
    });
    let Some(audit) = session.auditing.audit.get() else {
        ui.weak("is being checked");
        return;
    };
    if audit.promises.is_empty() {
        ui.weak("Nothing is promised of this world.");
    }
    for (claim, verdict) in &audit.promises {
        let color = match verdict {
            Verdict::Holds => GOOD,
            Verdict::Broken => painting::ERROR,
            Verdict::Undecided(_) => WARNING,
        };
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            ui.label(RichText::new(verdict.name()).color(color).strong());
            ui.label(claim.to_string());
        });
    }
    ui.separator();
    ui.strong("Places out of reach");
    match &audit.unreached {
        Ok(Some(places)) if places.squares.is_empty() && places.rooms.is_empty() => {
            ui.label(RichText::new("none").color(GOOD));
        }
        Ok(Some(places)) => {
            let squares = places.squares.iter();
            let area: f64 = squares.map(|square| square.size().element_product()).sum();
            let rooms = match places.rooms.len() {
                1 => "1 room".to_owned(),
                count => format!("{count} rooms"),
            };
            let text = format!("{area:.1} m², {rooms}");
            ui.label(RichText::new(text).color(painting::UNREACHED).strong());
            // Rooms of an earlier state may have other numbers.
            let is_present = session.auditing.audit.of(session.revision).is_some();
            for &room in places.rooms.iter().take(if is_present { 6 } else { 0 }) {
                if let Some(room) = session.document.world().rooms.get(room as usize) {
                    ui.label(format!("room `{}`", room.name));
                }
            }
            if is_present && places.rooms.len() > 6 {
                ui.weak(format!("and {} more", places.rooms.len() - 6));
            }
        }
        Ok(None) => {
            let text = match session.document.world().start {
                Some(_) => "the robot does not fit at the start",
                None => "the world has no start",
            };
            ui.label(RichText::new(text).color(WARNING));
        }
        Err(doubt) => _ = ui.label(RichText::new(format!("undecided: {doubt}")).color(WARNING)),
    }
    ui.weak(format!("for a robot of radius {} m, from the start", audit.radius));
}

/// The predicted difficulty by trials.
fn difficulty(ui: &mut Ui, session: &Session) {
    let prediction = &session.auditing.prediction;
    ui.horizontal(|ui| {
        ui.strong("Predicted difficulty");
        if prediction.is_running() {
            ui.spinner();
        }
    });
    let Some(Some(prediction)) = prediction.get() else {
        ui.weak(if prediction.is_running() { "is being computed" } else { "none for this world" });
        return;
    };
    egui::Grid::new("difficulty").show(ui, |ui| {
        for (name, dial) in prediction.dials.named() {
            ui.label(name);
            ui.label(format!("{:.1} ± {:.1}", dial.value, dial.standard_error));
            ui.end_row();
        }
    });
    ui.weak("of 10, with its standard error");
    if prediction.outside > 0.0 {
        let share = 100.0 * prediction.outside;
        let text = format!("{share:.0} % of its features lie outside of the worlds measured");
        ui.label(RichText::new(text).color(WARNING));
    }
}

/// The last event, or what is at the pointer.
fn status(ui: &mut Ui, session: &Session) {
    ui.horizontal_centered(|ui| {
        if !session.message.is_empty() {
            ui.add(egui::Label::new(&session.message).truncate());
            return;
        }
        if let Some(at) = session.pointer {
            ui.monospace(format!("{:7.2}, {:6.2} m", at.x, at.y));
        }
        if let Some(target) = session.hovered {
            ui.label(session.document.describe(target));
        }
    });
}

/// Shows a question, and carries out its answer.
fn ask(context: &egui::Context, session: &mut Session, question: &Question) {
    let mut answer = None;
    Modal::new("question".into()).show(context, |ui| {
        ui.set_width(320.0);
        let (heading, text, yes) = match question {
            Question::Unsaved => (
                "Save the changes?",
                format!("{} has changes that are not saved.", session.name),
                format!("Save {}", session.out),
            ),
            Question::Replace { files, .. } => {
                let names: Vec<_> = files.iter().map(|file| file.display().to_string()).collect();
                let exist = if files.len() == 1 { "exists" } else { "exist" };
                let text = format!("{} {exist}.", names.join(" and "));
                ("Replace what is there?", text, "Replace".to_owned())
            }
        };
        ui.heading(heading);
        ui.label(text);
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            if ui.add(Button::new(yes).truncate()).clicked() {
                answer = Some(Answer::Save);
            }
        });
        ui.horizontal(|ui| {
            if *question == Question::Unsaved && ui.button("Discard them").clicked() {
                answer = Some(Answer::Discard);
            }
            if ui.button("Stay here (Esc)").clicked() {
                answer = Some(Answer::Stay);
            }
        });
        if ui.input(|input| input.key_pressed(Key::Escape)) {
            answer = Some(Answer::Stay);
        }
    });
    if let Some(answer) = answer {
        session.answer(answer);
    }
}
