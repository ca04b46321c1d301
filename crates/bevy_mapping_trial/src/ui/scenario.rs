//! The panel for the scenario of a world: doors, people and smoke.

use bevy_egui::egui::Ui;
use envgen::SpecError;
use envgen::scenario::ScenarioSpec;

use super::draft::{Draft, has_error, show_group, show_groups};

/// The settings of doors, people and smoke, which are being edited.
///
/// ```
/// use bevy_mapping_trial::ui::ScenarioForm;
/// use envgen::scenario::ScenarioSpec;
///
/// let mut form = ScenarioForm::new(&ScenarioSpec::default());
/// form.set("people", "4");
/// assert_eq!(form.request().map(|spec| spec.people), Ok(4));
/// form.set("doors", "2");
/// assert!(form.request().is_err() && form.error_of("doors").is_some());
/// ```
#[derive(Clone, Debug)]
pub struct ScenarioForm {
    drafts: Vec<Draft>,
}

impl ScenarioForm {
    /// Creates a form with the given settings.
    pub fn new(spec: &ScenarioSpec) -> Self {
        let values = spec.settings_json();
        let draft = |setting| Draft::new(setting, &values, false);
        ScenarioForm { drafts: ScenarioSpec::SETTINGS.iter().map(draft).collect() }
    }

    /// Sets one setting from text, in the syntax of `--set`. Unknown names are ignored.
    pub fn set(&mut self, name: &str, text: &str) {
        if let Some(draft) = self.drafts.iter_mut().find(|draft| draft.is_of(name)) {
            text.clone_into(&mut draft.text);
            self.check();
        }
    }

    /// Returns the error that is shown below a setting.
    pub fn error_of(&self, name: &str) -> Option<&str> {
        self.drafts.iter().find(|draft| draft.is_of(name))?.error.as_deref()
    }

    /// Returns the settings in the form.
    ///
    /// # Errors
    /// Returns an error with the first setting that is out of range, its value and the allowed range.
    pub fn request(&self) -> Result<ScenarioSpec, SpecError> {
        let mut spec = ScenarioSpec::default();
        for draft in &self.drafts {
            spec.set(draft.setting.name, &draft.text)?;
        }
        spec.validate()?;
        Ok(spec)
    }

    /// Draws the settings that users change first: the numbers of doors and people, and the amount of smoke.
    pub fn show(&mut self, ui: &mut Ui) {
        if show_group(ui, &mut self.drafts, None) {
            self.check();
        }
    }

    /// Draws the other settings, by groups.
    pub fn show_groups(&mut self, ui: &mut Ui) {
        if show_groups(ui, &mut self.drafts) {
            self.check();
        }
    }

    /// Returns whether one of the settings in groups has an error.
    pub(super) fn has_error_in_groups(&self) -> bool {
        has_error(self.drafts.iter().filter(|draft| draft.setting.group.is_some()))
    }

    /// Updates the error below each setting.
    fn check(&mut self) {
        for draft in &mut self.drafts {
            let mut spec = ScenarioSpec::default();
            let set = spec.set(draft.setting.name, &draft.text).and_then(|()| spec.validate());
            draft.error = set.err().map(|error| error.to_string());
        }
    }
}
