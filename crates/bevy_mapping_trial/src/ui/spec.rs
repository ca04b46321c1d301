//! The panel for specs: every setting of every kind, with its limits.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use bevy_egui::egui::{self, ComboBox, DragValue, Slider, SliderClamping, TextEdit, Ui};
use envgen::settings::{Allowed, Setting};
use envgen::{Seed, SettingsError, SpecError, WorldKind, WorldSpec, whole_file};

use super::{error, row};

/// The widest range for which a slider is precise enough.
const SLIDER_RANGE: f64 = 20.0;

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
}

/// One setting as it is edited.
#[derive(Clone, Debug)]
struct Draft {
    setting: &'static Setting,
    text: String,
    /// Whether the setting may be absent.
    optional: bool,
    error: Option<String>,
}

impl SpecForm {
    /// A form that holds a spec and a seed.
    pub fn new(spec: &WorldSpec, seed: Seed) -> Self {
        let texts = WorldKind::ALL.iter().map(|&kind| {
            let shown = if kind == spec.kind() { spec.clone() } else { kind.default_spec() };
            (kind, drafts(&shown))
        });
        let texts = texts.collect();
        let file = format!("{}.envgen.ron", spec.kind());
        SpecForm { kind: spec.kind(), texts, seed: seed.0, file, failure: None }
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

    /// The spec and the seed in the form.
    ///
    /// # Errors
    /// The first setting that is out of range, with its value and the allowed range.
    pub fn request(&self) -> Result<(WorldSpec, Seed), SettingsError> {
        let mut spec = self.kind.default_spec();
        for draft in self.texts.get(&self.kind).into_iter().flatten() {
            spec.set(draft.setting.name, &draft.text)?;
        }
        spec.validate()?;
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
                self.texts.insert(self.kind, drafts(&self.kind.default_spec()));
                self.failure = None;
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

    /// Shows each error below the setting that it names.
    fn check(&mut self) {
        let Some(drafts) = self.texts.get_mut(&self.kind) else { return };
        let mut spec = self.kind.default_spec();
        let mut good = true;
        for draft in &mut *drafts {
            draft.error = spec.set(draft.setting.name, &draft.text).err().map(|e| e.to_string());
            good &= draft.error.is_none();
        }
        if let (true, Err(error)) = (good, spec.validate()) {
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
    /// Draws the setting; true when its text has changed.
    fn show(&mut self, ui: &mut Ui) -> bool {
        let Draft { setting, text, optional, .. } = self;
        let before = text.clone();
        let unit = if setting.unit.is_empty() { "" } else { " " };
        let help = format!("{}\n{}{unit}{}", setting.help, setting.allowed, setting.unit);
        row(ui, setting.name, &help, |ui| {
            if *optional && !matches!(setting.allowed, Allowed::List(_)) {
                let mut set = text != "none";
                if ui.checkbox(&mut set, "").on_hover_text("absent when not ticked").changed() {
                    *text = if set { first_value(setting) } else { "none".to_owned() };
                }
                if !set {
                    ui.weak("none");
                    return;
                }
            }
            edit(ui, setting, text);
        });
        if let Some(text) = &self.error {
            error(ui, text);
        }
        before != self.text
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

/// The value of an absent setting when it is ticked.
fn first_value(setting: &Setting) -> String {
    match setting.allowed {
        Allowed::Integer { min, .. } => min.to_string(),
        Allowed::Number { min, max } => 0.1_f64.clamp(min, max).to_string(),
        Allowed::Choice(names) => names.first().copied().unwrap_or_default().to_owned(),
        Allowed::Flag => "false".to_owned(),
        Allowed::List(_) | Allowed::Other(_) => String::new(),
    }
}

/// One text per setting.
fn drafts(spec: &WorldSpec) -> Vec<Draft> {
    let (values, defaults) = (spec.settings_json(), spec.kind().default_spec().settings_json());
    let draft = |setting: &'static Setting| Draft {
        setting,
        text: setting.text_of(&values[setting.name]),
        optional: defaults[setting.name].is_null(),
        error: None,
    };
    spec.kind().settings().iter().map(draft).collect()
}
