//! egui panels for specs, trials, scores and the feedback form.
//!
//! Each panel is a plain type with the data that it edits, and a `show` that draws it into any
//! [`egui::Ui`] and returns what the person asks for. No panel depends on a window, so all can be
//! tested without one. An app calls them from a system in `EguiPrimaryContextPass`.
//!
//! | panel | edits or shows | returns |
//! |---|---|---|
//! | [`SpecForm`] | every setting of every kind of world, and the seed | [`SpecAction`] |
//! | [`SetupForm`] | the settings of a trial and its world, by groups | [`SpecAction`] |
//! | [`ScenarioForm`] | the doors, people and smoke in it | |
//! | [`WorldPreview`] | the world that settings describe, generated in the background | |
//! | [`robot_preview`] | the robot with its laser and its sizes | |
//! | [`TrialStatus`] | clock, battery, distance and collisions of a running trial | [`TrialAction`] |
//! | [`scores`] | D, M, N and their components | |
//! | [`FeedbackForm`] | appendix B of Zwennes (2011), and two further questions | the answers |
//! | [`comparison`] | two runs on the same map, side by side | |
//!
//! ```
//! use bevy_mapping_trial::ui::{SpecForm, egui};
//! use envgen::{WorldKind, Seed};
//!
//! let mut form = SpecForm::new(&WorldKind::Indoor.default_spec(), Seed(3));
//! form.set("difficulty", "11");
//! let error = form.request().unwrap_err().to_string();
//! assert_eq!(error, "`difficulty` must be a number from 0 to 10, got 11");
//!
//! let context = egui::Context::default();
//! context.run_ui(egui::RawInput::default(), |ui| {
//!     form.show(ui);
//! }).drop_without_applying_deltas();
//! ```

mod background;
mod draft;
mod feedback;
mod manual_control;
mod reach;
mod robot_preview;
mod scenario;
mod scores;
mod setup;
mod spec;
mod trial;
mod world_preview;

pub use bevy_egui;
pub use bevy_egui::egui;

pub use feedback::{FeedbackForm, Unanswered};
pub use manual_control::command_of;
pub use robot_preview::robot_preview;
pub use scenario::ScenarioForm;
pub use scores::{comparison, scores};
pub use setup::SetupForm;
pub use spec::{SpecAction, SpecForm};
pub use trial::{TrialAction, TrialStatus};
pub use world_preview::WorldPreview;

use egui::{CollapsingHeader, Color32, RichText, Ui};
use envgen::palette::{self, Srgb};

/// The colour of errors, readable on the dark theme's panels.
const ERROR: Color32 = Color32::from_rgb(255, 140, 110);

/// The colour under drawings, that of pictures of worlds.
const PAGE: Color32 = {
    let Srgb([red, green, blue]) = palette::PAGE;
    Color32::from_rgb(red, green, blue)
};

/// Width in points of the names before settings.
const NAME_WIDTH: f32 = 130.0;

/// An error below the input that it is about, wrapped to the panel's width.
fn error(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).color(ERROR));
}

/// A row with a name of fixed width, and the widgets that edit its value.
fn row(ui: &mut Ui, name: &str, help: &str, edit: impl FnOnce(&mut Ui)) {
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

/// A group of settings below a header that opens and closes it, in another colour if there is an error in it.
fn group(ui: &mut Ui, name: RichText, open: bool, fails: bool, contents: impl FnOnce(&mut Ui)) {
    let name = if fails { name.color(ERROR) } else { name };
    CollapsingHeader::new(name).default_open(open).show_unindented(ui, contents);
}
