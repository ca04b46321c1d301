//! A setting that is being edited.

use bevy_egui::egui::{ComboBox, DragValue, Slider, SliderClamping, TextEdit, Ui};
use envgen::serde_json::Value;
use envgen::settings::{Allowed, Setting};

use super::widgets::{error, group, row};

/// The widest range for which a slider is precise enough.
const SLIDER_RANGE: f64 = 20.0;

/// A setting that is being edited, as text in the syntax of `--set`.
#[derive(Clone, Debug)]
pub(super) struct Draft {
    pub(super) setting: &'static Setting,
    pub(super) text: String,
    /// Whether the setting may be absent.
    optional: bool,
    /// The interval that is within reach, if the setting is a dial of measured difficulty.
    pub(super) reached: Option<[f64; 2]>,
    /// Whether that interval is shown, which is the case if the dial is requested.
    pub(super) requested: bool,
    pub(super) error: Option<String>,
}

impl Draft {
    /// Creates the draft of a setting from values by name.
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

    /// Returns whether the draft is that of the setting with a given name.
    pub(super) fn is_of(&self, name: &str) -> bool {
        self.setting.name == name
    }

    /// Draws the setting. Returns true if its text has changed.
    pub(super) fn show(&mut self, ui: &mut Ui) -> bool {
        let first = self.first_value();
        let Draft { setting, text, optional, .. } = self;
        let before = text.clone();
        row(ui, setting.name, &help(setting), |ui| {
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

    /// Returns the value of an absent setting when it is ticked. For a dial it is the middle of what is
    /// within reach.
    pub(super) fn first_value(&self) -> String {
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

/// Draws the settings of a group, or those without one. Returns true if a text has changed.
pub(super) fn show_group(ui: &mut Ui, drafts: &mut [Draft], group: Option<&str>) -> bool {
    let mut changed = false;
    for draft in drafts.iter_mut().filter(|draft| draft.setting.group == group) {
        changed |= draft.show(ui);
    }
    changed
}

/// Draws every group below a header of its own, which is closed at first. Returns true if a text has changed.
/// The header of a group with an error has another colour, so that the error can be found.
pub(super) fn show_groups(ui: &mut Ui, drafts: &mut [Draft]) -> bool {
    let mut names: Vec<&str> = Vec::new();
    for name in drafts.iter().filter_map(|draft| draft.setting.group) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let mut changed = false;
    for name in names {
        let fails = has_error(drafts.iter().filter(|draft| draft.setting.group == Some(name)));
        group(ui, name.into(), false, fails, |ui| changed |= show_group(ui, drafts, Some(name)));
    }
    changed
}

/// Returns whether any of the settings has an error.
pub(super) fn has_error<'a>(drafts: impl IntoIterator<Item = &'a Draft>) -> bool {
    drafts.into_iter().any(|draft| draft.error.is_some())
}

/// Returns what a setting does and which values are allowed.
pub(super) fn help(setting: &Setting) -> String {
    let unit = if setting.unit.is_empty() { "" } else { " " };
    format!("{}\n{}{unit}{}", setting.help, setting.allowed_text(), setting.unit)
}

/// Draws a widget for a value that suits its type.
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

/// Draws a slider for narrow ranges or a drag value for wide ones. Both accept any typed number, and errors
/// are shown below.
fn edit_number(ui: &mut Ui, text: &mut String, (min, max): (f64, f64), unit: &str, whole: bool) {
    let Ok(mut value) = text.parse::<f64>() else {
        ui.add(TextEdit::singleline(text).desired_width(f32::INFINITY));
        return;
    };
    // A field that loses the focus writes what it shows. It shows all digits, so that the value does not
    // change.
    let exact = |value: f64, _| value.to_string();
    let decimals = if whole { 0 } else { 6 };
    let response = if max - min <= SLIDER_RANGE {
        let slider = Slider::new(&mut value, min..=max).clamping(SliderClamping::Never);
        let slider = slider.suffix(unit).max_decimals(decimals).custom_formatter(exact);
        let slider = if whole { slider.step_by(1.0) } else { slider };
        ui.spacing_mut().slider_width = 80.0;
        ui.add(slider)
    } else {
        let speed = if whole { 0.1 } else { (0.01 * value.abs()).max(1e-4) };
        let drag = DragValue::new(&mut value).speed(speed).suffix(unit).max_decimals(decimals);
        ui.add(drag.custom_formatter(exact))
    };
    if response.changed() {
        *text = value.to_string();
    }
}
