//! The panel for the settings of a trial.

use bevy_egui::egui::{ComboBox, DragValue, Slider, Ui};
use envgen::{Seed, SpecError};
use mapping_trial::lidar::LaserProfile;
use mapping_trial::names::Named;
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::policy::PolicyKind;
use mapping_trial::trial::{MAX_TIME_LIMIT, TrialSettings};

use super::{ScenarioForm, error, row};

/// The entry for a person in the list of exploration policies.
const PERSON: &str = "a person";

/// The settings of a trial, before it begins.
#[derive(Clone, Debug)]
pub struct SetupForm {
    /// The settings.
    pub settings: TrialSettings,
    /// What moves in the world.
    pub scenario: ScenarioForm,
    /// Whether the true world and the true poses are shown, for training.
    pub training: bool,
}

impl SetupForm {
    /// The settings for a world of this seed.
    ///
    /// # Errors
    /// The first setting that is out of range.
    pub fn request(&self, seed: Seed) -> Result<TrialSettings, SpecError> {
        let settings = TrialSettings { seed, ..self.settings.clone() };
        settings.validate()?;
        Ok(settings)
    }

    /// Draws the panel.
    pub fn show(&mut self, ui: &mut Ui) {
        let settings = &mut self.settings;
        let driver = settings.policy.as_ref().and_then(Named::name).unwrap_or(PERSON);
        row(ui, "operator", "who drives: you, or a program to watch", |ui| {
            ComboBox::from_id_salt("operator").selected_text(driver).show_ui(ui, |ui| {
                ui.selectable_value(&mut settings.policy, None, PERSON);
                for (name, kind) in PolicyKind::NAMES {
                    ui.selectable_value(&mut settings.policy, Some(*kind), *name);
                }
            });
        });
        choose(ui, "slam", "how poses and map are estimated", &mut settings.slam);
        choose::<LaserProfile>(ui, "laser", "what the laser measures", &mut settings.laser);
        choose::<OdometryProfile>(
            ui,
            "odometry",
            "how exactly the wheels measure",
            &mut settings.odometry,
        );
        row(ui, "robots", "they share one map; Tab switches between them", |ui| {
            ui.spacing_mut().slider_width = 80.0;
            ui.add(Slider::new(&mut settings.robots, 1..=4));
        });
        row(ui, "time limit", "simulated seconds after which the trial ends", |ui| {
            let seconds = DragValue::new(&mut settings.time_limit).range(1.0..=MAX_TIME_LIMIT);
            ui.add(seconds.speed(5.0).suffix(" s"));
        });
        ui.collapsing("doors, people, smoke", |ui| self.scenario.show(ui));
        row(ui, "training", "shows the true world with the map", |ui| {
            ui.checkbox(&mut self.training, "show the truth");
        });
        if let Err(problem) = self.settings.validate() {
            error(ui, &problem.to_string());
        }
    }
}

/// A choice among named values.
fn choose<T: Named>(ui: &mut Ui, name: &str, help: &str, value: &mut T) {
    row(ui, name, help, |ui| {
        let shown = value.name().unwrap_or("custom");
        ComboBox::from_id_salt(name).selected_text(shown).show_ui(ui, |ui| {
            for (name, other) in T::NAMES {
                ui.selectable_value(value, other.clone(), *name);
            }
        });
    });
}
