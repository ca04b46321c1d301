//! The building blocks of panels: rows, groups and errors.

use bevy_egui::egui::{self, CollapsingHeader, RichText, Ui};

use super::colors::ERROR;

/// The width in points of the names of settings.
const NAME_WIDTH: f32 = 130.0;

/// Draws an error below the input that caused it, wrapped to the width of the panel.
pub(super) fn error(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).color(ERROR));
}

/// Draws a row with a name of fixed width, and the widgets that edit the value.
pub(super) fn row(ui: &mut Ui, name: &str, help: &str, edit: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        let size = egui::vec2(NAME_WIDTH, ui.spacing().interact_size.y);
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        let label = ui.allocate_ui_with_layout(size, layout, |ui| {
            ui.set_min_width(NAME_WIDTH);
            ui.add(egui::Label::new(name).truncate())
        });
        if !help.is_empty() {
            label.inner.on_hover_text(help);
        }
        edit(ui);
    });
}

/// Draws a group of settings below a header that opens and closes it. The header has another colour if the
/// group has an error.
pub(super) fn group(
    ui: &mut Ui,
    name: RichText,
    open: bool,
    fails: bool,
    contents: impl FnOnce(&mut Ui),
) {
    let name = if fails { name.color(ERROR) } else { name };
    CollapsingHeader::new(name).default_open(open).show_unindented(ui, contents);
}
