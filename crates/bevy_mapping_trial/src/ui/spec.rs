//! The panel for specs: every setting of every kind, with its limits.
//!
//! In the profile `calibrated` of indoor maps, the difficulty is the one that trials measure. What maps of
//! the chosen size and settings reach is shown below each dial that is requested.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use bevy_egui::egui::{self, ComboBox, DragValue, Slider, SliderClamping, TextEdit, Ui};
use envgen::calibration::Dials;
use envgen::indoor::{IndoorSpec, Profile};
use envgen::serde_json::Value;
use envgen::settings::{Allowed, Setting};
use envgen::{Seed, SettingsError, SpecError, WorldKind, WorldSpec, whole_file};

use super::reach::Reach;
use super::{error, row};

/// The widest range for which a slider is precise enough.
const SLIDER_RANGE: f64 = 20.0;

/// Settings that are shown first: what a map is asked for.
const FIRST: [&str; 4] = ["profile", "difficulty", "mapping", "navigation"];

/// What the person asks the app for.
#[derive(Clone, Debug, PartialEq)]
pub enum SpecAction {
    /// Generate the world of this spec and seed.
    Regenerate {
        /// The spec, validated.
        spec: Box<WorldSpec>,
        /// The seed.
        seed: Seed,
    },
    /// The spec was written to this file.
    Saved(PathBuf),
}

/// A spec as it is edited: for each kind one text per setting, in the syntax of `--set`, so that
/// switching to another kind and back loses nothing.
#[derive(Clone, Debug)]
pub struct SpecForm {
    kind: WorldKind,
    texts: BTreeMap<WorldKind, Vec<Draft>>,
    seed: u64,
    file: String,
    /// The last error of the app or the disk.
    failure: Option<String>,
    reach: Reach,
}

/// One setting as it is edited.
#[derive(Clone, Debug)]
pub(super) struct Draft {
    setting: &'static Setting,
    text: String,
    /// Whether the setting may be absent.
    optional: bool,
    /// What is reached of the setting, if it is a dial of measured difficulty.
    reached: Option<[f64; 2]>,
    /// Whether that is shown: the dial is requested.
    requested: bool,
    error: Option<String>,
}

impl SpecForm {
    /// A form that holds a spec and a seed.
    pub fn new(spec: &WorldSpec, seed: Seed) -> Self {
        let texts = WorldKind::ALL.iter().map(|&kind| {
            let shown = if kind == spec.kind() { spec.clone() } else { Self::initial(kind) };
            (kind, drafts(&shown))
        });
        let texts = texts.collect();
        let file = format!("{}.envgen.ron", spec.kind());
        let (kind, reach) = (spec.kind(), Reach::default());
        let mut form = SpecForm { kind, texts, seed: seed.0, file, failure: None, reach };
        form.check();
        form
    }

    /// What the form holds of a kind before anything is set: the defaults, but indoor maps of the profile
    /// `calibrated`, whose difficulty is the one that trials measure.
    ///
    /// ```
    /// use bevy_mapping_trial::ui::SpecForm;
    /// use envgen::{Seed, WorldKind};
    ///
    /// let mut form = SpecForm::new(&SpecForm::initial(WorldKind::Indoor), Seed(3));
    /// let [least, most] = form.reached("difficulty").expect("a calibrated profile");
    /// form.set("difficulty", &(most + 1.0).to_string());
    /// let error = form.request().expect_err("out of reach").to_string();
    /// assert!(error.starts_with(&format!("`difficulty` must be from {least:.1} to {most:.1}")), "{error}");
    /// form.set("profile", "thesis");
    /// assert!(form.request().is_ok());
    /// ```
    pub fn initial(kind: WorldKind) -> WorldSpec {
        if kind == WorldKind::Indoor {
            return IndoorSpec { profile: Profile::Calibrated, ..Default::default() }.into();
        }
        kind.default_spec()
    }

    /// The kind that is edited.
    pub fn kind(&self) -> WorldKind {
        self.kind
    }

    /// Switches to another kind.
    pub fn set_kind(&mut self, kind: WorldKind) {
        if self.file == format!("{}.envgen.ron", self.kind) {
            self.file = format!("{kind}.envgen.ron");
        }
        self.kind = kind;
        self.failure = None;
        self.check();
    }

    /// The seed.
    pub fn seed(&self) -> Seed {
        Seed(self.seed)
    }

    /// Sets one setting of the kind from text, in the syntax of `--set`. Names that the kind does
    /// not have are ignored.
    pub fn set(&mut self, name: &str, text: &str) {
        let drafts = self.texts.get_mut(&self.kind);
        let draft = drafts.and_then(|drafts| drafts.iter_mut().find(|d| d.setting.name == name));
        if let Some(draft) = draft {
            text.clone_into(&mut draft.text);
            self.check();
        }
    }

    /// The error that is shown below a setting.
    pub fn error_of(&self, name: &str) -> Option<&str> {
        let draft = self.texts.get(&self.kind)?.iter().find(|d| d.setting.name == name)?;
        draft.error.as_deref()
    }

    /// What maps reach of a dial of measured difficulty, which is shown below its setting; `None` for other settings,
    /// in other profiles, and where the dial is not requested.
    pub fn reached(&self, name: &str) -> Option<[f64; 2]> {
        let draft = self.texts.get(&self.kind)?.iter().find(|d| d.setting.name == name)?;
        draft.reached.filter(|_| draft.requested)
    }

    /// The spec and the seed in the form.
    ///
    /// # Errors
    /// The first setting that is out of range, or out of reach, with its value and the allowed range.
    pub fn request(&self) -> Result<(WorldSpec, Seed), SettingsError> {
        let mut spec = self.kind.default_spec();
        for draft in self.texts.get(&self.kind).into_iter().flatten() {
            spec.set(draft.setting.name, &draft.text)?;
        }
        spec.validate()?;
        self.reach.check(&spec)?;
        Ok((spec, Seed(self.seed)))
    }

    /// Shows an error of the requested world; `None` removes it.
    pub fn set_failure(&mut self, failure: Option<String>) {
        self.failure = failure;
    }

    /// Writes the spec as RON, completely or not at all.
    ///
    /// # Errors
    /// An invalid setting, or an error of the file system with the file's name.
    pub fn save(&self, path: &Path) -> Result<(), String> {
        let (spec, _) = self.request().map_err(|error| error.to_string())?;
        let text = spec.to_ron() + "\n";
        whole_file::write(path, text.as_bytes()).map_err(|error| error.to_string())
    }

    /// Draws the panel.
    pub fn show(&mut self, ui: &mut Ui) -> Option<SpecAction> {
        let mut action = None;
        let mut kind = self.kind;
        row(ui, "kind", "", |ui| {
            ComboBox::from_id_salt("kind").selected_text(kind.name()).show_ui(ui, |ui| {
                for &other in WorldKind::ALL {
                    ui.selectable_value(&mut kind, other, other.name())
                        .on_hover_text(other.summary());
                }
            });
        });
        if kind != self.kind {
            self.set_kind(kind);
        }
        row(ui, "seed", "determines everything random in the world", |ui| {
            ui.add(DragValue::new(&mut self.seed).speed(0.1));
            if ui.button("Next").on_hover_text("the next seed, and its world").clicked() {
                self.seed = self.seed.wrapping_add(1);
                action = self.regenerate();
            }
        });
        ui.horizontal(|ui| {
            if ui.button("Regenerate").clicked() {
                action = self.regenerate();
            }
            if ui.button("Defaults").clicked() {
                self.texts.insert(self.kind, drafts(&Self::initial(self.kind)));
                self.check();
            }
        });
        row(ui, "file", "where Save writes the spec", |ui| {
            let save = ui.button("Save");
            ui.add(TextEdit::singleline(&mut self.file).desired_width(f32::INFINITY));
            if save.clicked() {
                let path = PathBuf::from(&self.file);
                match self.save(&path) {
                    Ok(()) => {
                        self.failure = None;
                        action = Some(SpecAction::Saved(path));
                    }
                    Err(text) => self.failure = Some(text),
                }
            }
        });
        if let Some(failure) = &self.failure {
            error(ui, failure);
        }
        ui.separator();
        egui::ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
            let mut changed = false;
            for draft in self.texts.get_mut(&self.kind).into_iter().flatten() {
                changed |= draft.show(ui);
            }
            if changed {
                self.check();
            }
        });
        action
    }

    fn regenerate(&mut self) -> Option<SpecAction> {
        match self.request() {
            Ok((spec, seed)) => {
                self.failure = None;
                Some(SpecAction::Regenerate { spec: Box::new(spec), seed })
            }
            Err(error) => {
                self.failure = Some(error.to_string());
                None
            }
        }
    }

    /// Shows each error below the setting that it names, and what is reached.
    fn check(&mut self) {
        let Some(drafts) = self.texts.get_mut(&self.kind) else { return };
        let mut spec = self.kind.default_spec();
        let mut good = true;
        for draft in &mut *drafts {
            draft.error = spec.set(draft.setting.name, &draft.text).err().map(|e| e.to_string());
            (draft.reached, draft.requested) = (None, false);
            good &= draft.error.is_none();
        }
        if !good {
            self.failure = None;
            return;
        }
        let allowed = spec.validate().and_then(|()| {
            show_reached(drafts, &spec, self.reach.update(&spec));
            self.reach.check(&spec)
        });
        if let Err(error) = allowed {
            let SpecError { field, .. } = &error;
            // Fields of lists are named such as `speeds[2]`.
            let named = drafts.iter_mut().find(|draft| {
                field
                    .strip_prefix(draft.setting.name)
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with(['[', '.', ' ']))
            });
            match named {
                Some(draft) => draft.error = Some(error.to_string()),
                None => self.failure = Some(error.to_string()),
            }
        } else {
            self.failure = None;
        }
    }
}

impl Draft {
    /// A setting of some settings by their names.
    pub(super) fn new(setting: &'static Setting, values: &Value, optional: bool) -> Self {
        Draft {
            setting,
            text: setting.text_of(&values[setting.name]),
            optional,
            reached: None,
            requested: false,
            error: None,
        }
    }

    /// Whether it is the setting of a name.
    pub(super) fn is_of(&self, name: &str) -> bool {
        self.setting.name == name
    }

    /// Changes its text.
    pub(super) fn set(&mut self, text: &str) {
        text.clone_into(&mut self.text);
    }

    /// Calls `set` with its name and its text.
    pub(super) fn set_in<E>(&self, set: impl FnOnce(&str, &str) -> Result<(), E>) -> Result<(), E> {
        set(self.setting.name, &self.text)
    }

    /// The error that is shown below it.
    pub(super) fn error(&self) -> Option<&str> {
        self.error.as_deref()
    }

    /// Shows an error below it; `None` removes it.
    pub(super) fn set_error(&mut self, error: Option<String>) {
        self.error = error;
    }

    /// Draws the setting; true when its text has changed.
    pub(super) fn show(&mut self, ui: &mut Ui) -> bool {
        let first = self.first_value();
        let Draft { setting, text, optional, .. } = self;
        let before = text.clone();
        let unit = if setting.unit.is_empty() { "" } else { " " };
        let help = format!("{}\n{}{unit}{}", setting.help, setting.allowed, setting.unit);
        row(ui, setting.name, &help, |ui| {
            if *optional && !matches!(setting.allowed, Allowed::List(_)) {
                let mut set = text != "none";
                if ui.checkbox(&mut set, "").on_hover_text("absent when not ticked").changed() {
                    *text = if set { first } else { "none".to_owned() };
                }
                if !set {
                    ui.weak("none");
                    return;
                }
            }
            edit(ui, setting, text);
        });
        if let (Some([least, most]), true) = (self.reached, self.requested) {
            ui.weak(format!("within reach: {least:.1} to {most:.1}, as trials measure it"));
        }
        if let Some(text) = &self.error {
            error(ui, text);
        }
        before != self.text
    }

    /// The value of an absent setting when it is ticked: of a dial, the middle of what is reached.
    fn first_value(&self) -> String {
        match (self.setting.allowed, self.reached) {
            (Allowed::Number { min, max }, Some([least, most])) => {
                format!("{:.1}", (0.5 * (least + most)).clamp(min, max))
            }
            (Allowed::Number { min, max }, None) => 0.1_f64.clamp(min, max).to_string(),
            (Allowed::Integer { min, .. }, _) => min.to_string(),
            (Allowed::Choice(names), _) => names.first().copied().unwrap_or_default().to_owned(),
            (Allowed::Flag, _) => "false".to_owned(),
            (Allowed::List(_) | Allowed::Other(_), _) => String::new(),
        }
    }
}

/// Edits a value with a widget that suits its type.
fn edit(ui: &mut Ui, setting: &Setting, text: &mut String) {
    let unit = if setting.unit.is_empty() { String::new() } else { format!(" {}", setting.unit) };
    match setting.allowed {
        Allowed::Integer { min, max } => {
            edit_number(ui, text, (min as f64, max as f64), &unit, true);
        }
        Allowed::Number { min, max } => edit_number(ui, text, (min, max), &unit, false),
        Allowed::Choice(names) => {
            let shown = text.clone();
            ComboBox::from_id_salt(setting.name).selected_text(shown).show_ui(ui, |ui| {
                for name in names {
                    ui.selectable_value(text, (*name).to_owned(), *name);
                }
            });
        }
        Allowed::Flag => {
            let mut set = text == "true";
            if ui.checkbox(&mut set, "").changed() {
                *text = set.to_string();
            }
        }
        Allowed::List(hint) | Allowed::Other(hint) => {
            ui.add(TextEdit::singleline(text).hint_text(hint).desired_width(f32::INFINITY));
        }
    }
}

/// A slider for narrow ranges and a drag value for wide ones. Both accept any typed number; errors
/// are shown below.
fn edit_number(ui: &mut Ui, text: &mut String, (min, max): (f64, f64), unit: &str, whole: bool) {
    let Ok(mut value) = text.parse::<f64>() else {
        ui.add(TextEdit::singleline(text).desired_width(f32::INFINITY));
        return;
    };
    let response = if max - min <= SLIDER_RANGE {
        let slider = Slider::new(&mut value, min..=max).clamping(SliderClamping::Never);
        let slider = slider.suffix(unit).max_decimals(if whole { 0 } else { 6 });
        let slider = if whole { slider.step_by(1.0) } else { slider };
        ui.spacing_mut().slider_width = 80.0;
        ui.add(slider)
    } else {
        let speed = if whole { 0.1 } else { (0.01 * value.abs()).max(1e-4) };
        let decimals = if whole { 0 } else { 6 };
        ui.add(DragValue::new(&mut value).speed(speed).max_decimals(decimals).suffix(unit))
    };
    if response.changed() {
        *text = value.to_string();
    }
}

/// Notes what is reached of each dial.
fn show_reached(drafts: &mut [Draft], spec: &WorldSpec, reached: Option<Dials<[f64; 2]>>) {
    let (WorldSpec::Indoor(spec), Some(reached)) = (spec, reached) else { return };
    for (name, (wanted, interval)) in spec.request().0.zip(reached).named() {
        let draft = drafts.iter_mut().find(|draft| draft.setting.name == name);
        if let Some(draft) = draft {
            draft.reached = Some(interval);
            draft.requested = wanted.is_some();
        }
    }
}

/// One text per setting.
fn drafts(spec: &WorldSpec) -> Vec<Draft> {
    let (values, defaults) = (spec.settings_json(), spec.kind().default_spec().settings_json());
    let draft =
        |setting: &'static Setting| Draft::new(setting, &values, defaults[setting.name].is_null());
    let mut drafts: Vec<Draft> = spec.kind().settings().iter().map(draft).collect();
    let place = |draft: &Draft| FIRST.iter().position(|name| *name == draft.setting.name);
    drafts.sort_by_key(|draft| place(draft).unwrap_or(FIRST.len()));
    drafts
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
                let draft = form.texts[&WorldKind::Indoor].iter().find(|d| d.setting.name == name);
                let first = draft.expect("a setting").first_value();
                form.set(name, &first);
                assert_eq!(form.error_of(name), None, "{size} {name}");
            }
        }
    }
}
