//! The panel for the settings of a trial.

use bevy_egui::egui::{Color32, ComboBox, DragValue, RichText, Slider, SliderClamping, Ui};
use envgen::{Seed, SpecError};
use mapping_trial::backend::TICK;
use mapping_trial::names::Named;
use mapping_trial::policy::PolicyKind;
use mapping_trial::trial::{MAX_ROBOTS, MAX_TIME_LIMIT, TrialSettings};

use super::draft::help;
use super::scenario::ScenarioForm;
use super::spec::{SpecAction, SpecForm};
use super::widgets::{error, group, row};

/// The entry for an operator in the list of exploration policies.
const PERSON: &str = "a person";

/// The settings of a trial before it begins, which are being edited.
#[derive(Clone, Debug)]
pub struct SetupForm {
    /// The settings.
    pub settings: TrialSettings,
    /// The settings of the scenario.
    pub scenario: ScenarioForm,
    /// Whether the true world and the true poses are shown, for training.
    pub training: bool,
}

impl SetupForm {
    /// Returns the settings for a world with this seed.
    ///
    /// # Errors
    /// Returns an error with the first setting that is out of range.
    pub fn request(&self, seed: Seed) -> Result<TrialSettings, SpecError> {
        let settings = TrialSettings { seed, ..self.settings.clone() };
        settings.validate()?;
        Ok(settings)
    }

    /// Draws the settings of a trial and of its world by groups. Settings that users seldom change are in a
    /// group that is closed at first.
    pub fn show(&mut self, ui: &mut Ui, world: &mut SpecForm) -> Option<SpecAction> {
        let mut action = None;
        group(ui, section("World"), true, false, |ui| action = world.show(ui));
        group(ui, section("Robot and laser"), true, false, |ui| self.show_robots(ui));
        group(ui, section("Trial"), true, false, |ui| self.show_trial(ui));
        group(ui, section("Things that move"), true, false, |ui| self.scenario.show(ui));
        let fails = world.has_error_in_groups() || self.scenario.has_error_in_groups();
        group(ui, section("Advanced"), false, fails, |ui| {
            choose(ui, "wheel_calibration", &mut self.settings.wheel_calibration);
            action = action.take().or(world.show_groups(ui));
            self.scenario.show_groups(ui);
        });
        action
    }

    /// Draws the settings of the robots and of their sensors.
    fn show_robots(&mut self, ui: &mut Ui) {
        let settings = &mut self.settings;
        row(ui, "robots", &help(&TrialSettings::setting("robots")), |ui| {
            ui.spacing_mut().slider_width = 80.0;
            let slider = Slider::new(&mut settings.robots, 1..=MAX_ROBOTS);
            ui.add(slider.clamping(SliderClamping::Never));
        });
        choose(ui, "laser", &mut settings.laser);
        choose(ui, "odometry", &mut settings.odometry);
    }

    /// Draws the settings of the trial itself.
    fn show_trial(&mut self, ui: &mut Ui) {
        let settings = &mut self.settings;
        let shown = settings.policy.as_ref().and_then(Named::name).unwrap_or(PERSON);
        row(ui, "policy", "Who drives: you, or an exploration policy to watch", |ui| {
            ComboBox::from_id_salt("policy").selected_text(shown).show_ui(ui, |ui| {
                ui.selectable_value(&mut settings.policy, None, PERSON);
                for (name, kind) in PolicyKind::NAMES {
                    ui.selectable_value(&mut settings.policy, Some(*kind), *name);
                }
            });
        });
        choose(ui, "slam", &mut settings.slam);
        row(ui, "time limit", &help(&TrialSettings::setting("time_limit")), |ui| {
            match settings.time_per_area {
                // The limit follows from the area of the world.
                Some(seconds) => drop(ui.label(format!("{seconds} s/m²"))),
                None => {
                    // A field that loses the focus writes what it shows. It shows all digits, so that the
                    // value does not change.
                    let seconds = DragValue::new(&mut settings.time_limit)
                        .range(TICK..=MAX_TIME_LIMIT)
                        .custom_formatter(|value, _| value.to_string());
                    ui.add(seconds.speed(5.0).max_decimals(0).suffix(" s"));
                }
            }
        });
        row(ui, "training", "Shows the true world, before the trial and with the map", |ui| {
            ui.checkbox(&mut self.training, "show the truth");
        });
        if let Err(problem) = self.settings.validate() {
            error(ui, &problem.to_string());
        }
    }
}

/// Returns the name of a group, in a larger font than the names of the groups inside it.
fn section(name: &str) -> RichText {
    RichText::new(name).size(15.0).color(Color32::WHITE)
}

/// Draws a choice among the named values of a setting of trials.
fn choose<T: Named>(ui: &mut Ui, name: &'static str, value: &mut T) {
    let shown = value.name().unwrap_or("custom");
    row(ui, name, TrialSettings::setting(name).help, |ui| {
        ComboBox::from_id_salt(name).selected_text(shown).show_ui(ui, |ui| {
            for (name, other) in T::NAMES {
                ui.selectable_value(value, other.clone(), *name);
            }
        });
    });
}
