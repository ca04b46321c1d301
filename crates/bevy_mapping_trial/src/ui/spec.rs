//! The panel for specs, with every setting of every kind of world and its limits.
//!
//! In the profile `calibrated` of indoor maps, the difficulty is the one that trials measure. Below each dial
//! that is requested, the panel shows the interval that maps with the current size and settings can reach.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use bevy_egui::egui::{ComboBox, TextEdit, Ui};
use envgen::calibration::Dials;
use envgen::indoor::{IndoorSpec, Profile};
use envgen::settings::Setting;
use envgen::{Seed, SettingsError, SpecError, WorldKind, WorldSpec, whole_file};

use super::draft::{Draft, has_error, show_group, show_groups};
use super::reach::Reach;
use super::widgets::{error, row};

/// What the user did in the panel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SpecAction {
    /// The kind, the seed or a setting has changed: [`SpecForm::request`] returns the new spec or its error.
    Changed,
    /// The spec was written to this file.
    Saved(PathBuf),
}

/// A spec that is being edited. For each kind it has one text per setting, in the syntax of `--set`, so that
/// nothing is lost when the user switches to another kind and back.
#[derive(Clone, Debug)]
pub struct SpecForm {
    kind: WorldKind,
    texts: BTreeMap<WorldKind, Vec<Draft>>,
    seed: Seed,
    /// The text of the seed. A number in a widget would have too few digits.
    seed_text: String,
    file: String,
    /// The file that was written last. It is replaced without asking.
    own_file: Option<PathBuf>,
    /// A file of others that the next click replaces.
    replaced: Option<PathBuf>,
    /// The last error of the file system, or the last error that names no setting.
    failure: Option<String>,
    reach: Reach,
    /// The name of the file whose world is a choice beside the kinds.
    world_file: Option<String>,
    /// Whether that world is chosen.
    is_of_file: bool,
}

impl SpecForm {
    /// Creates a form with the given spec and seed.
    pub fn new(spec: &WorldSpec, seed: Seed) -> Self {
        let texts = WorldKind::ALL.iter().map(|&kind| {
            let shown = if kind == spec.kind() { spec.clone() } else { Self::initial(kind) };
            (kind, drafts(&shown))
        });
        let texts = texts.collect();
        let file = format!("{}.envgen.ron", spec.kind());
        let (kind, reach) = (spec.kind(), Reach::default());
        let seed_text = seed.to_string();
        let mut form = SpecForm {
            kind,
            texts,
            seed,
            seed_text,
            file,
            own_file: None,
            replaced: None,
            failure: None,
            reach,
            world_file: None,
            is_of_file: false,
        };
        form.check();
        form
    }

    /// Creates a form for a world that was read from a file with this name. The form shows the name and the seed, which
    /// is that of the sensor noise, until a kind is chosen. The file remains a choice.
    ///
    /// ```
    /// use bevy_mapping_trial::ui::SpecForm;
    /// use envgen::{Seed, WorldKind};
    ///
    /// let mut form = SpecForm::of_file("cave.json", Seed(3));
    /// assert!(form.is_of_file());
    /// form.set_kind(WorldKind::Forest);
    /// assert!(!form.is_of_file());
    /// ```
    pub fn of_file(name: &str, seed: Seed) -> Self {
        let form = SpecForm::new(&SpecForm::initial(WorldKind::Indoor), seed);
        SpecForm { world_file: Some(name.to_owned()), is_of_file: true, ..form }
    }

    /// Returns whether the world of the file is chosen, and not a kind: the app keeps that world, whatever
    /// [`SpecForm::request`] returns.
    pub fn is_of_file(&self) -> bool {
        self.is_of_file
    }

    /// Returns the spec that the form has for a kind before anything is set: the default spec, except that
    /// indoor maps have the profile `calibrated`, whose difficulty is the one that trials measure.
    ///
    /// ```
    /// use bevy_mapping_trial::ui::SpecForm;
    /// use envgen::{Seed, WorldKind};
    ///
    /// let mut form = SpecForm::new(&SpecForm::initial(WorldKind::Indoor), Seed(3));
    /// let [_, most] = form.reached("difficulty").expect("a calibrated profile");
    /// form.set("difficulty", &(most + 1.0).to_string());
    /// let error = form.request().expect_err("out of reach").to_string();
    /// assert!(error.starts_with("`difficulty` must be from "), "{error}");
    /// form.set("profile", "thesis");
    /// assert!(form.request().is_ok());
    /// ```
    pub fn initial(kind: WorldKind) -> WorldSpec {
        if kind == WorldKind::Indoor {
            return IndoorSpec { profile: Profile::Calibrated, ..Default::default() }.into();
        }
        kind.default_spec()
    }

    /// Returns the kind that is being edited, or that was last while the world of a file is chosen.
    pub fn kind(&self) -> WorldKind {
        self.kind
    }

    /// Switches to another kind.
    pub fn set_kind(&mut self, kind: WorldKind) {
        if self.file == format!("{}.envgen.ron", self.kind) {
            self.file = format!("{kind}.envgen.ron");
        }
        self.kind = kind;
        self.is_of_file = false;
        self.failure = None;
        self.check();
    }

    /// Returns the seed, or the last valid one if the text is not a number.
    pub fn seed(&self) -> Seed {
        self.seed
    }

    /// Sets one setting of the current kind from text, in the syntax of `--set`. Names that the kind does not
    /// have are ignored.
    pub fn set(&mut self, name: &str, text: &str) {
        let drafts = self.texts.get_mut(&self.kind);
        let draft = drafts.and_then(|drafts| drafts.iter_mut().find(|d| d.is_of(name)));
        if let Some(draft) = draft {
            text.clone_into(&mut draft.text);
            self.check();
        }
    }

    /// Returns the error that is shown below a setting.
    pub fn error_of(&self, name: &str) -> Option<&str> {
        let draft = self.texts.get(&self.kind)?.iter().find(|d| d.is_of(name))?;
        draft.error.as_deref()
    }

    /// Returns the interval that maps can reach of a dial of measured difficulty, which is shown below its
    /// setting, or `None` for other settings, for other profiles, and if the dial is not requested.
    pub fn reached(&self, name: &str) -> Option<[f64; 2]> {
        let draft = self.texts.get(&self.kind)?.iter().find(|d| d.is_of(name))?;
        draft.reached.filter(|_| draft.requested)
    }

    /// Returns the spec and the seed in the form.
    ///
    /// # Errors
    /// Returns an error with the first setting that is out of range or out of reach, its value and the
    /// allowed range, or an error if the seed is not a number.
    pub fn request(&self) -> Result<(WorldSpec, Seed), SettingsError> {
        let mut spec = self.kind.default_spec();
        for draft in self.texts.get(&self.kind).into_iter().flatten() {
            spec.set(draft.setting.name, &draft.text)?;
        }
        spec.validate()?;
        self.reach.check(&spec)?;
        Ok((spec, self.request_seed()?))
    }

    /// Returns the seed in the form.
    ///
    /// # Errors
    /// Returns an error if the text is not a number.
    pub fn request_seed(&self) -> Result<Seed, SettingsError> {
        Ok(self.seed_text.parse()?)
    }

    /// Writes the spec to a file as RON. The file is written completely or not at all.
    ///
    /// # Errors
    /// Returns an error if a setting is invalid, or if the file system reports an error, with the name of the
    /// file.
    pub fn save(&self, path: &Path) -> Result<(), String> {
        let (spec, _) = self.request().map_err(|error| error.to_string())?;
        let text = spec.to_ron() + "\n";
        whole_file::write(path, text.as_bytes()).map_err(|error| error.to_string())
    }

    /// Draws the kind, the seed and the settings that users change first.
    pub fn show(&mut self, ui: &mut Ui) -> Option<SpecAction> {
        let before = (self.kind, self.is_of_file);
        let mut chosen = before;
        let of_file = self.world_file.as_ref().map(|name| format!("world from {name}"));
        let shown = of_file.as_deref().filter(|_| self.is_of_file).unwrap_or(self.kind.name());
        let help = if self.is_of_file { "A file, or a kind of world" } else { self.kind.summary() };
        row(ui, "kind", help, |ui| {
            ComboBox::from_id_salt("kind").truncate().selected_text(shown).show_ui(ui, |ui| {
                if let Some(text) = &of_file {
                    ui.selectable_value(&mut chosen, (self.kind, true), text);
                }
                for &other in WorldKind::ALL {
                    ui.selectable_value(&mut chosen, (other, false), other.name())
                        .on_hover_text(other.summary());
                }
            });
        });
        match chosen {
            _ if chosen == before => {}
            (_, true) => self.is_of_file = true,
            (kind, false) => self.set_kind(kind),
        }
        let seed_changed = self.show_seed(ui);
        let edited = self.edit(|drafts| show_group(ui, drafts, None));
        if let Some(failure) = self.failure.as_ref().filter(|_| !self.is_of_file) {
            error(ui, failure);
        }
        (edited || chosen != before || seed_changed).then_some(SpecAction::Changed)
    }

    /// Draws the seed, and returns whether its text has changed.
    fn show_seed(&mut self, ui: &mut Ui) -> bool {
        let mut changed = false;
        let help = if self.is_of_file {
            "Determines the sensor noise and what moves in the world"
        } else {
            "Determines everything random in the world"
        };
        row(ui, "seed", help, |ui| {
            // The field is as wide as its digits.
            let edit = TextEdit::singleline(&mut self.seed_text).desired_width(32.0);
            changed = ui.add(edit.clip_text(false)).changed();
            if ui.button("Next").on_hover_text("the next seed").clicked() {
                self.seed_text = Seed(self.seed.0.wrapping_add(1)).to_string();
                changed = true;
            }
        });
        match self.seed_text.parse() {
            Ok(seed) => self.seed = seed,
            Err(failure) => error(ui, &SpecError::to_string(&failure)),
        }
        changed
    }

    /// Draws the other settings of the kind, by groups.
    pub fn show_groups(&mut self, ui: &mut Ui) -> Option<SpecAction> {
        self.edit(|drafts| show_groups(ui, drafts)).then_some(SpecAction::Changed)
    }

    /// Draws the buttons that apply to the whole spec: back to the defaults, and save to a file. A file that this form
    /// has not written is replaced by a second click. There are no buttons for the world of a file.
    pub fn show_file(&mut self, ui: &mut Ui) -> Option<SpecAction> {
        let mut action = None;
        if self.is_of_file {
            return action;
        }
        ui.horizontal(|ui| {
            let defaults = ui.button("Defaults");
            if defaults.on_hover_text("of all settings of this kind of world").clicked() {
                self.texts.insert(self.kind, drafts(&Self::initial(self.kind)));
                self.check();
                action = Some(SpecAction::Changed);
            }
            let path = PathBuf::from(&self.file);
            let replaces = self.replaced.as_ref() == Some(&path);
            let save = ui
                .button(if replaces { "Replace" } else { "Save" })
                .on_hover_text("writes the settings of the world to this file");
            if ui.add(TextEdit::singleline(&mut self.file).desired_width(f32::INFINITY)).changed() {
                self.replaced = None;
                self.check();
            }
            if !save.clicked() {
                return;
            }
            if !replaces && self.own_file.as_ref() != Some(&path) && path.exists() {
                self.failure = Some(format!("{} exists", path.display()));
                self.replaced = Some(path);
                return;
            }
            self.replaced = None;
            match self.save(&path) {
                Ok(()) => {
                    self.failure = None;
                    self.own_file = Some(path.clone());
                    action = Some(SpecAction::Saved(path));
                }
                Err(text) => self.failure = Some(text),
            }
        });
        action
    }

    /// Returns whether one of the settings in groups has an error.
    pub(super) fn has_error_in_groups(&self) -> bool {
        let drafts = self.texts.get(&self.kind).filter(|_| !self.is_of_file);
        has_error(drafts.into_iter().flatten().filter(|draft| draft.setting.group.is_some()))
    }

    /// Lets a panel edit the settings of the kind, and checks them if it has changed any. The world of a file has none.
    fn edit(&mut self, show: impl FnOnce(&mut [Draft]) -> bool) -> bool {
        if self.is_of_file {
            return false;
        }
        let changed = self.texts.get_mut(&self.kind).is_some_and(|drafts| show(drafts));
        if changed {
            self.check();
        }
        changed
    }

    /// Updates the error below each setting that has one, and the intervals that are within reach.
    fn check(&mut self) {
        let Some(drafts) = self.texts.get_mut(&self.kind) else { return };
        let mut spec = self.kind.default_spec();
        let mut good = true;
        self.failure = None;
        for draft in &mut *drafts {
            draft.error = spec.set(draft.setting.name, &draft.text).err().map(|e| e.to_string());
            (draft.reached, draft.requested) = (None, false);
            good &= draft.error.is_none();
        }
        if !good {
            return;
        }
        let allowed = spec.validate().and_then(|()| {
            show_reached(drafts, &spec, self.reach.update(&spec));
            self.reach.check(&spec)
        });
        if let Err(error) = allowed {
            let SpecError { field, .. } = &error;
            // Elements of lists have names such as `speeds[2]`.
            let named = drafts.iter_mut().find(|draft| {
                field
                    .strip_prefix(draft.setting.name)
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with(['[', '.', ' ']))
            });
            match named {
                Some(draft) => draft.error = Some(error.to_string()),
                None => self.failure = Some(error.to_string()),
            }
        }
    }
}

/// Stores the interval that is within reach of each dial.
fn show_reached(drafts: &mut [Draft], spec: &WorldSpec, reached: Option<Dials<[f64; 2]>>) {
    let (WorldSpec::Indoor(spec), Some(reached)) = (spec, reached) else { return };
    for (name, (wanted, interval)) in spec.request().0.zip(reached).named() {
        let draft = drafts.iter_mut().find(|draft| draft.is_of(name));
        if let Some(draft) = draft {
            draft.reached = Some(interval);
            draft.requested = wanted.is_some();
        }
    }
}

/// Creates one draft per setting.
fn drafts(spec: &WorldSpec) -> Vec<Draft> {
    let (values, defaults) = (spec.settings_json(), spec.kind().default_spec().settings_json());
    let draft =
        |setting: &'static Setting| Draft::new(setting, &values, defaults[setting.name].is_null());
    spec.kind().settings().iter().map(draft).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dial_that_is_ticked_is_within_reach() {
        for size in ["6", "8", "16"] {
            let mut form = SpecForm::new(&SpecForm::initial(WorldKind::Indoor), Seed(3));
            for name in ["width", "height"] {
                form.set(name, size);
            }
            for name in ["mapping", "navigation"] {
                let draft = form.texts[&WorldKind::Indoor].iter().find(|d| d.is_of(name));
                let first = draft.expect("a setting").first_value();
                form.set(name, &first);
                assert_eq!(form.error_of(name), None, "{size} {name}");
            }
        }
    }
}
