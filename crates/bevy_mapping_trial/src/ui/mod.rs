//! Panels in egui for specs, trials, scores and the feedback form.
//!
//! Each panel is a plain type with the data that it edits. Its method `show` draws it into any [`egui::Ui`]
//! and returns what the user has requested. No panel depends on a window, so all can be tested without one.
//! An app calls them from a system in `EguiPrimaryContextPass`.
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
mod colors;
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
mod widgets;
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
