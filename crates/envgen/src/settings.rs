//! The settings of a spec: their names, units and limits, and how they are read from text.
//!
//! A spec is a flat struct of numbers, flags, choices and lists, declared with [`settings!`](crate::settings!), so
//! that documentation, type, default, unit and limits of a setting are written only once. The table of its
//! [`Setting`]s is printed by `envgen kinds`, holds the limits that a spec's `validate` checks, and lets a user
//! interface offer every setting with its range.

mod text;

use std::fmt;

use serde_json::Value;

use self::text::{item, item_text, items, number, plain_text};
use crate::error::SpecError;

/// One setting of a spec.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// The name, as in RON files and after `--set`.
    pub name: &'static str,
    /// A former name, which is accepted as well.
    pub alias: Option<&'static str>,
    /// Unit of the value; empty if it has none.
    pub unit: &'static str,
    /// The allowed values.
    pub allowed: Allowed,
    /// Whether it can be `none`.
    pub optional: bool,
    /// What the setting does, without a full stop at the end.
    pub help: &'static str,
    /// An example of a value, as after `--set name=`, if the form is not obvious.
    pub example: Option<&'static str>,
    /// The group in which it is listed: see [`groups`]. `None` for the settings that users change first.
    pub group: Option<&'static str>,
}

/// The values that a setting can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Allowed {
    /// A whole number within limits, both included.
    Integer {
        /// Least value.
        min: u64,
        /// Greatest value.
        max: u64,
    },
    /// A finite number within limits, both included.
    Number {
        /// Least value.
        min: f64,
        /// Greatest value.
        max: f64,
    },
    /// One of a list of names.
    Choice(&'static [&'static str]),
    /// `true` or `false`.
    Flag,
    /// A list, separated by commas on the command line, with or without brackets around it. An item that contains a
    /// comma is in double quotes, as in JSON. The text names the items.
    List(&'static str),
    /// Another form, which the text describes.
    Other(&'static str),
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Allowed::Integer { min, max } => write!(f, "a whole number from {min} to {max}"),
            Allowed::Number { min, max } => write!(f, "a number from {min} to {max}"),
            Allowed::Choice(names) => write!(f, "one of {}", names.join(", ")),
            Allowed::Flag => f.write_str("true or false"),
            Allowed::List(of) => write!(f, "a list of {of}"),
            Allowed::Other(form) => f.write_str(form),
        }
    }
}

impl Setting {
    const fn new(
        name: &'static str,
        unit: &'static str,
        allowed: Allowed,
        help: &'static str,
    ) -> Self {
        let (alias, optional, example, group) = (None, false, None, None);
        Setting { name, alias, unit, allowed, optional, help, example, group }
    }

    /// Creates a setting for a whole number from `min` to `max`.
    pub const fn integer(name: &'static str, min: u64, max: u64, help: &'static str) -> Self {
        Self::new(name, "", Allowed::Integer { min, max }, help)
    }

    /// Creates a setting for a finite number from `min` to `max`.
    pub const fn number(
        name: &'static str,
        unit: &'static str,
        min: f64,
        max: f64,
        help: &'static str,
    ) -> Self {
        Self::new(name, unit, Allowed::Number { min, max }, help)
    }

    /// Creates a setting for one of several names.
    pub const fn choice(
        name: &'static str,
        names: &'static [&'static str],
        help: &'static str,
    ) -> Self {
        Self::new(name, "", Allowed::Choice(names), help)
    }

    /// Creates a setting for `true` or `false`.
    pub const fn flag(name: &'static str, help: &'static str) -> Self {
        Self::new(name, "", Allowed::Flag, help)
    }

    /// Creates a setting for a list; `of` names its items.
    pub const fn list(
        name: &'static str,
        unit: &'static str,
        of: &'static str,
        help: &'static str,
    ) -> Self {
        Self::new(name, unit, Allowed::List(of), help)
    }

    /// Creates a setting for a value of another form, which `form` describes.
    pub const fn other(
        name: &'static str,
        unit: &'static str,
        form: &'static str,
        help: &'static str,
    ) -> Self {
        Self::new(name, unit, Allowed::Other(form), help)
    }

    /// Adds a former name to the setting.
    pub const fn also_called(self, alias: &'static str) -> Self {
        Setting { alias: Some(alias), ..self }
    }

    /// Sets the unit of the setting.
    pub const fn of_unit(self, unit: &'static str) -> Self {
        Setting { unit, ..self }
    }

    /// Allows the value `none` for the setting.
    pub const fn or_none(self) -> Self {
        Setting { optional: true, ..self }
    }

    /// Adds an example of a value to the setting.
    pub const fn such_as(self, example: &'static str) -> Self {
        Setting { example: Some(example), ..self }
    }

    /// Puts the setting into a group.
    pub const fn in_group(self, group: &'static str) -> Self {
        Setting { group: Some(group), ..self }
    }

    /// Returns the allowed values in words.
    pub fn allowed_text(&self) -> String {
        let or_none = if self.optional { ", or none" } else { "" };
        format!("{}{or_none}", self.allowed)
    }

    /// Returns the error for a value of this setting that is not allowed.
    pub fn error(&self, value: impl fmt::Display) -> SpecError {
        self.error_with(value, self.allowed_text())
    }

    /// Returns the error for a value that is within the limits but is not allowed for another reason.
    pub fn error_with(&self, value: impl fmt::Display, allowed: impl Into<String>) -> SpecError {
        SpecError::new(self.name, value, allowed)
    }

    /// Checks a number against the limits. NaN never passes.
    ///
    /// # Errors
    /// Names the setting, the value and the limits.
    #[inline]
    pub fn check(&self, value: f64) -> Result<(), SpecError> {
        let inside = match self.allowed {
            Allowed::Number { min, max } => value >= min && value <= max,
            Allowed::Integer { min, max } => value >= min as f64 && value <= max as f64,
            _ => true,
        };
        if inside { Ok(()) } else { Err(self.error(value)) }
    }

    /// Checks a whole number against the limits.
    ///
    /// # Errors
    /// Names the setting, the value and the limits.
    #[inline]
    pub fn check_integer(&self, value: u64) -> Result<(), SpecError> {
        match self.allowed {
            Allowed::Integer { min, max } if value < min || value > max => Err(self.error(value)),
            _ => Ok(()),
        }
    }

    /// Reads a value from the text that follows `--set name=`.
    ///
    /// ```
    /// use envgen::settings::Setting;
    ///
    /// let kinds = Setting::choice("corners", &["square", "rounded"], "How walls turn");
    /// assert_eq!(kinds.parse(" rounded ")?, "rounded");
    /// let width = Setting::number("width", "m", 0.1, 10.0, "Clear width").or_none();
    /// assert_eq!(width.parse("2.5")?, 2.5);
    /// assert!(width.parse("none")?.is_null());
    /// assert_eq!(
    ///     width.parse("20").unwrap_err().to_string(),
    ///     "`width` must be a number from 0.1 to 10, or none, got 20"
    /// );
    /// # Ok::<(), envgen::SpecError>(())
    /// ```
    ///
    /// # Errors
    /// Names the setting, the text and what is allowed.
    pub fn parse(&self, text: &str) -> Result<Value, SpecError> {
        let text = text.trim();
        if self.optional && matches!(text, "none" | "null") {
            return Ok(Value::Null);
        }
        match self.allowed {
            Allowed::Integer { .. } => {
                let value: u64 = text.parse().map_err(|_| self.error(text))?;
                self.check_integer(value)?;
                Ok(value.into())
            }
            Allowed::Number { .. } => {
                let value: f64 = text.parse().map_err(|_| self.error(text))?;
                // As it is written: 1e400 is read as infinity.
                self.check(value).map_err(|_| self.error(text))?;
                // The sum turns -0 into 0.
                Ok((value + 0.0).into())
            }
            Allowed::Choice(names) if names.contains(&text) => Ok(text.into()),
            Allowed::Choice(_) => Err(self.error(text)),
            Allowed::Flag => match text {
                "true" => Ok(true.into()),
                "false" => Ok(false.into()),
                _ => Err(self.error(text)),
            },
            Allowed::List(_) => {
                // RON and JSON put brackets around a list; a command line can do without.
                let inside = text.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
                let items = items(inside.unwrap_or(text).trim());
                let why = |why| self.error_with(text, format!("{}: {why}", self.allowed_text()));
                Ok(items.map_err(why)?.into())
            }
            Allowed::Other(_) => Ok(item(text)),
        }
    }

    /// Returns a list in which texts that look like numbers, such as `.5`, are numbers.
    pub(crate) fn numbers(list: &Value) -> Value {
        let read = |item: &Value| item.as_str().and_then(number).unwrap_or_else(|| item.clone());
        list.as_array().map_or_else(|| list.clone(), |items| items.iter().map(read).collect())
    }

    /// Returns the text that [`Setting::parse`] reads as the value.
    pub fn text_of(&self, value: &Value) -> String {
        let is_flat = |items: &[Value]| !items.iter().any(|i| i.is_array() || i.is_object());
        match (value, self.allowed) {
            (Value::Null, _) => "none".to_owned(),
            (Value::String(text), _) => text.clone(),
            (Value::Array(items), Allowed::List(_)) if is_flat(items) => {
                items.iter().map(item_text).collect::<Vec<_>>().join(",")
            }
            _ => plain_text(value),
        }
    }
}

/// A number that can have limits.
pub trait Limited {
    /// Checks the number against the limits of a setting. An absent number passes.
    ///
    /// # Errors
    /// Names the setting, the value and the limits.
    fn check(&self, setting: &Setting) -> Result<(), SpecError>;
}

impl Limited for f64 {
    fn check(&self, setting: &Setting) -> Result<(), SpecError> {
        setting.check(*self)
    }
}

impl Limited for u32 {
    fn check(&self, setting: &Setting) -> Result<(), SpecError> {
        setting.check_integer(u64::from(*self))
    }
}

impl Limited for u64 {
    fn check(&self, setting: &Setting) -> Result<(), SpecError> {
        setting.check_integer(*self)
    }
}

impl<T: Limited> Limited for Option<T> {
    fn check(&self, setting: &Setting) -> Result<(), SpecError> {
        self.as_ref().map_or(Ok(()), |value| value.check(setting))
    }
}

/// Returns settings by group: first those without a group, then each group, in the order of their first settings.
///
/// ```
/// use envgen::settings::groups;
/// use envgen::hallway::HallwaySpec;
///
/// let groups = groups(HallwaySpec::SETTINGS);
/// assert_eq!(groups[0].0, None);
/// assert_eq!(groups[0].1[0].name, "segments");
/// assert_eq!(groups[1].0, Some("corridor"));
/// ```
pub fn groups(settings: &'static [Setting]) -> Vec<(Option<&'static str>, Vec<&'static Setting>)> {
    let mut groups = vec![(None, Vec::new())];
    for setting in settings {
        match groups.iter_mut().find(|(group, _)| *group == setting.group) {
            Some((_, settings)) => settings.push(setting),
            None => groups.push((setting.group, vec![setting])),
        }
    }
    groups
}

/// Assigns each setting to the last group that begins before it, where the empty name ends a group.
#[doc(hidden)]
pub const fn grouped<const N: usize>(mut settings: [Setting; N]) -> [Setting; N] {
    let mut group: Option<&'static str> = None;
    let mut i = 0;
    while i < N {
        if let Some(name) = settings[i].group {
            group = if name.is_empty() { None } else { Some(name) };
        }
        settings[i].group = group;
        i += 1;
    }
    settings
}

/// Returns the setting with a name. In a constant, an unknown name is a compile error.
///
/// # Panics
/// When there is no such setting.
#[doc(hidden)]
pub const fn named(settings: &[Setting], name: &str) -> Setting {
    let mut i = 0;
    while i < settings.len() {
        if equal(settings[i].name.as_bytes(), name.as_bytes()) {
            return settings[i];
        }
        i += 1;
    }
    panic!("no setting has this name")
}

const fn equal(a: &[u8], b: &[u8]) -> bool {
    let mut i = 0;
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}

/// Returns the text of a doc comment without surrounding spaces and without the full stop at its end.
#[doc(hidden)]
pub const fn sentence(doc: &'static str) -> &'static str {
    match doc.trim_ascii().as_bytes() {
        [text @ .., b'.'] => match std::str::from_utf8(text) {
            Ok(text) => text,
            Err(_) => doc,
        },
        _ => doc.trim_ascii(),
    }
}

/// Declares a struct of settings: fields with documentation, type, default, and a form with unit and limits, each
/// written once.
///
/// The macro makes a struct that `serde` reads with defaults for absent fields and without unknown ones, with a
/// [`Default`], the table `SETTINGS`, and `check_fields`, which checks every number. The calling crate must depend
/// on `serde` with its derives. The forms are:
///
/// - `number(unit, min..=max)` and `integer(unit, min..=max)`, also `optional_number` and
///   `optional_integer` for an `Option`;
/// - `choice` for an enum that derives [`strum::VariantNames`], `flag` for a `bool`;
/// - `nested` for another struct of settings, whose errors name `field.setting`;
/// - `list(unit, items, example)`, `other(unit, form)` and `other(unit, form, example)`, with texts.
///
/// `#[alias = "name"]` before a field gives it a former name, which is read as well. `#[group = "name"]` before a
/// field begins a group of settings, which holds the fields up to the next `#[group]`. The empty name returns to
/// the settings without a group, which are those that users change first.
///
/// ```
/// envgen::settings! {
///     /// A ramp.
///     pub struct Ramp {
///         /// Height of its upper end.
///         height: f64 = 0.3 => number("m", 0.0..=2.0);
///         /// Number of handrails.
///         rails: u32 = 0 => integer("", 0..=2);
///     }
/// }
///
/// let ramp = Ramp { height: 3.0, ..Default::default() };
/// let error = ramp.check_fields().unwrap_err();
/// assert_eq!(error.to_string(), "`height` must be a number from 0 to 2, got 3");
/// assert_eq!(Ramp::SETTINGS[1].help, "Number of handrails");
/// ```
#[macro_export]
macro_rules! settings {
    (
        $(#[$meta:meta])*
        $vis:vis struct $Spec:ident {
            $(
                $(#[doc = $doc:literal])+
                $(#[alias = $alias:literal])?
                $(#[group = $group:literal])?
                $(#[serde($($serde:tt)*)])*
                $field:ident: $type:ty = $default:expr => $form:ident $(($($args:tt)*))?;
            )+
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, ::serde::Serialize, ::serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        $vis struct $Spec {
            $(
                $(#[doc = $doc])+
                #[doc = ""]
                #[doc = $crate::setting_form!(@doc stringify!($default), $form $(($($args)*))?)]
                $(#[serde(alias = $alias)])?
                $(#[serde($($serde)*)])*
                pub $field: $type,
            )+
        }

        impl Default for $Spec {
            fn default() -> Self {
                $Spec { $($field: $default,)+ }
            }
        }

        impl $Spec {
            /// Every setting, in order of declaration.
            pub const SETTINGS: &'static [$crate::settings::Setting] =
                &$crate::settings::grouped([$(
                    $crate::setting_form!(
                        @table
                        stringify!($field),
                        $crate::settings::sentence(concat!($($doc),+)),
                        $type,
                        $form $(($($args)*))?
                    )$(.also_called($alias))?$(.in_group($group))?,
                )+]);

            /// Returns the setting with a name. In a constant, an unknown name is a compile error.
            ///
            /// # Panics
            /// When there is no such setting.
            pub const fn setting(name: &str) -> $crate::settings::Setting {
                $crate::settings::named(Self::SETTINGS, name)
            }

            /// Returns every setting by name, including those that files omit at their defaults.
            #[doc(hidden)]
            pub fn settings_json(&self) -> $crate::serde_json::Value {
                let mut settings = $crate::serde_json::Map::new();
                $(
                    let value = $crate::serde_json::to_value(&self.$field).unwrap_or_default();
                    settings.insert(stringify!($field).to_owned(), value);
                )+
                settings.into()
            }

            /// Checks every number against the limits of its setting.
            ///
            /// # Errors
            /// Names the first setting that is not allowed, its value and its limits.
            pub fn check_fields(&self) -> Result<(), $crate::SpecError> {
                $($crate::setting_form!(
                    @check &self.$field, Self::setting(stringify!($field)), $form
                );)+
                Ok(())
            }
        }
    };
}

/// The expansion of a setting's form in [`settings!`](crate::settings!).
#[doc(hidden)]
#[macro_export]
macro_rules! setting_form {
    (@table $name:expr, $help:expr, $type:ty, number($unit:literal, $min:literal ..= $max:expr)) => {
        $crate::settings::Setting::number($name, $unit, $min, $max, $help)
    };
    (@table $name:expr, $help:expr, $type:ty, integer($unit:literal, $min:literal ..= $max:expr)) => {
        $crate::settings::Setting::integer($name, $min, $max, $help).of_unit($unit)
    };
    (@table $name:expr, $help:expr, $type:ty, optional_number($($args:tt)*)) => {
        $crate::setting_form!(@table $name, $help, $type, number($($args)*)).or_none()
    };
    (@table $name:expr, $help:expr, $type:ty, optional_integer($($args:tt)*)) => {
        $crate::setting_form!(@table $name, $help, $type, integer($($args)*)).or_none()
    };
    (@table $name:expr, $help:expr, $type:ty, choice) => {
        $crate::settings::Setting::choice(
            $name,
            <$type as $crate::strum::VariantNames>::VARIANTS,
            $help,
        )
    };
    (@table $name:expr, $help:expr, $type:ty, flag) => {
        $crate::settings::Setting::flag($name, $help)
    };
    (@table $name:expr, $help:expr, $type:ty, nested) => {
        $crate::settings::Setting::other($name, "", "settings of its own", $help)
    };
    (@table $name:expr, $help:expr, $type:ty, list($unit:literal, $items:expr, $example:expr)) => {
        $crate::settings::Setting::list($name, $unit, $items, $help).such_as($example)
    };
    (@table $name:expr, $help:expr, $type:ty, other($unit:literal, $allowed:expr)) => {
        $crate::settings::Setting::other($name, $unit, $allowed, $help)
    };
    (@table $name:expr, $help:expr, $type:ty, other($unit:literal, $allowed:expr, $example:expr)) => {
        $crate::setting_form!(@table $name, $help, $type, other($unit, $allowed)).such_as($example)
    };
    (@table $name:expr, $help:expr, $type:ty, optional_other($($args:tt)*)) => {
        $crate::setting_form!(@table $name, $help, $type, other($($args)*)).or_none()
    };

    (@doc $default:expr, $form:ident($unit:literal, $min:literal ..= $max:expr)) => {
        concat!(
            "From ", stringify!($min), " to ", stringify!($max), " ", $unit,
            "; `", $default, "` by default."
        )
    };
    (@doc $default:expr, $form:ident $(($($args:tt)*))?) => {
        concat!("`", $default, "` by default.")
    };

    (@check $value:expr, $setting:expr, number) => {
        $crate::settings::Limited::check($value, &const { $setting })?
    };
    (@check $value:expr, $setting:expr, integer) => {
        $crate::setting_form!(@check $value, $setting, number)
    };
    (@check $value:expr, $setting:expr, optional_number) => {
        $crate::setting_form!(@check $value, $setting, number)
    };
    (@check $value:expr, $setting:expr, optional_integer) => {
        $crate::setting_form!(@check $value, $setting, number)
    };
    (@check $value:expr, $setting:expr, nested) => {
        ($value).check_fields().map_err(|error| error.within($setting.name))?
    };
    (@check $value:expr, $setting:expr, $form:ident) => {};
}

#[cfg(test)]
mod tests;
