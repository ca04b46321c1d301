//! [`WorldSpec`]: a spec of any kind, as a RON file holds it; and blueprints of any kind.

use std::str::FromStr;

use ron::extensions::Extensions;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use crate::cellular::CellularError;
use crate::error::SpecError;
use crate::forest::ForestError;
use crate::generate::{Blueprint, Spec};
use crate::indoor::IndoorError;
pub use crate::kind::WorldKind;
use crate::landscape::LandscapeError;
use crate::provenance::Provenance;
use crate::road::RoadError;
use crate::seed::Seed;
use crate::settings::{Allowed, Setting};
use crate::world::World;

/// The reasons why a spec could not be made from settings.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// There is no such kind.
    #[error("unknown world kind `{name}`, expected one of {known}")]
    UnknownKind {
        /// The name that was given.
        name: String,
        /// The kinds that exist.
        known: String,
    },
    /// The kind has no such setting.
    #[error("kind {kind} has no setting `{name}`{}, expected one of {known}", did_you_mean(*nearest))]
    UnknownSetting {
        /// The kind.
        kind: WorldKind,
        /// The name that was given.
        name: String,
        /// The setting with the most similar name, if one is similar.
        nearest: Option<&'static str>,
        /// The settings that exist.
        known: String,
    },
    /// The value is not allowed.
    #[error(transparent)]
    Value(#[from] SpecError),
    /// The text is not the RON of a spec.
    #[error("not the RON of a world spec such as `Hallway(segments: 80)`, at {0}")]
    Ron(Box<ron::error::SpannedError>),
}

impl SettingsError {
    /// Returns the error for a name that no setting of these tables has.
    pub fn unknown_setting(kind: WorldKind, name: &str, tables: &[&'static [Setting]]) -> Self {
        let known: Vec<_> = tables.iter().copied().flatten().map(|setting| setting.name).collect();
        let likeness = |known: &str| strsim::normalized_damerau_levenshtein(known, name);
        let nearest = known.iter().map(|known| (likeness(known), *known));
        let nearest = nearest.max_by(|a, b| a.0.total_cmp(&b.0));
        let nearest = nearest.filter(|(likeness, _)| *likeness > LIKE).map(|(_, name)| name);
        let (name, known) = (name.to_owned(), known.join(", "));
        SettingsError::UnknownSetting { kind, name, nearest, known }
    }
}

/// Names with at least this similarity, from 0 to 1, are suggested for each other.
const LIKE: f64 = 0.6;

fn did_you_mean(name: Option<&str>) -> String {
    name.map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}

/// The reasons why no blueprint could be generated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// The spec asks for something that is not allowed.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// A block field could not be generated.
    #[error(transparent)]
    Cellular(CellularError),
    /// A forest could not be generated.
    #[error(transparent)]
    Forest(ForestError),
    /// An indoor map could not be generated.
    #[error(transparent)]
    Indoor(IndoorError),
    /// A landscape could not be generated.
    #[error(transparent)]
    Landscape(LandscapeError),
    /// A road could not be generated.
    #[error(transparent)]
    Road(RoadError),
}

/// An error about a spec is the same for all kinds.
macro_rules! generate_error_from {
    ($($error:ident => $variant:ident;)+) => {
        $(impl From<$error> for GenerateError {
            fn from(error: $error) -> Self {
                match error {
                    $error::Spec(error) => GenerateError::Spec(error),
                    error => GenerateError::$variant(error),
                }
            }
        })+
    };
}

generate_error_from! {
    CellularError => Cellular;
    ForestError => Forest;
    IndoorError => Indoor;
    LandscapeError => Landscape;
    RoadError => Road;
}

/// The sentence that names the kind of a variant.
macro_rules! of_kind {
    ($variant:ident, $name:literal) => {
        concat!(" Of the kind [`", $name, "`](WorldKind::", stringify!($variant), ").")
    };
}

/// One line per kind: variant and name as in [`WorldKind`], spec and blueprint.
macro_rules! specs {
    ($($variant:ident, $name:literal, $spec:ty, $blueprint:ty;)+) => {
        impl WorldKind {
            /// Returns the settings of this kind's specs.
            pub fn settings(self) -> &'static [Setting] {
                match self {
                    $(WorldKind::$variant => <$spec>::SETTINGS,)+
                }
            }

            /// Returns the rules about several settings, one sentence per rule.
            pub fn rules(self) -> &'static [&'static str] {
                match self {
                    $(WorldKind::$variant => <$spec>::RULES,)+
                }
            }

            /// Returns the value version, which rises when a spec and a seed give other values.
            pub fn value_version(self) -> u32 {
                match self {
                    $(WorldKind::$variant => <$spec>::VALUE_VERSION,)+
                }
            }

            /// Returns the spec with every setting at its default.
            ///
            /// ```
            /// use envgen::{Seed, WorldKind};
            ///
            /// let kind: WorldKind = "forest".parse()?;
            /// let world = kind.default_spec().generate(Seed(7))?.to_world();
            /// assert!(!world.trees.is_empty());
            /// # Ok::<(), Box<dyn std::error::Error>>(())
            /// ```
            pub fn default_spec(self) -> WorldSpec {
                match self {
                    $(WorldKind::$variant => WorldSpec::$variant(Default::default()),)+
                }
            }

            fn spec_from_json(self, settings: Value) -> Result<WorldSpec, serde_json::Error> {
                Ok(match self {
                    $(WorldKind::$variant => WorldSpec::$variant(serde_json::from_value(settings)?),)+
                })
            }
        }

        /// A spec of any kind. In a RON file it is the name of the kind with the settings that differ from their
        /// defaults, such as `Hallway(segments: 80, p_st: 0.2)`.
        ///
        /// ```
        /// use envgen::{Seed, WorldKind, WorldSpec};
        ///
        /// let spec = WorldSpec::from_ron("Hallway(segments: 80, p_st: 0.2)")?;
        /// assert_eq!(spec.kind(), WorldKind::Hallway);
        /// let world = spec.generate(Seed(7))?.to_world();
        /// assert_eq!(world.provenance.name(), "hallway, seed 7");
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[non_exhaustive]
        pub enum WorldSpec {
            $(#[doc = of_kind!($variant, $name)] #[serde(alias = $name)] $variant($spec),)+
        }

        impl WorldSpec {
            /// Returns the kind.
            pub fn kind(&self) -> WorldKind {
                match self {
                    $(WorldSpec::$variant(_) => WorldKind::$variant,)+
                }
            }

            /// Returns every setting as a JSON object, without the kind.
            pub fn settings_json(&self) -> Value {
                match self {
                    $(WorldSpec::$variant(spec) => spec.settings_json(),)+
                }
            }

            /// Checks every setting, and the rules about several settings.
            ///
            /// # Errors
            /// Names the first setting that is not allowed, its value and the allowed values.
            pub fn validate(&self) -> Result<(), SpecError> {
                match self {
                    $(WorldSpec::$variant(spec) => spec.validate(),)+
                }
            }

            /// Estimates the cost of generating a blueprint: the approximate number of its parts, cells or points.
            pub fn work(&self) -> f64 {
                match self {
                    $(WorldSpec::$variant(spec) => spec.work(),)+
                }
            }

            /// Generates a blueprint. The same spec and seed always give the same one.
            ///
            /// # Errors
            /// When the spec is not valid, or when this seed has no blueprint that satisfies it.
            pub fn generate(&self, seed: Seed) -> Result<WorldBlueprint, GenerateError> {
                Ok(match self {
                    $(WorldSpec::$variant(spec) => {
                        WorldBlueprint::$variant(spec.generate(seed)?)
                    })+
                })
            }
        }

        /// A blueprint of any kind. It serialises like the blueprint alone.
        #[derive(Clone, Debug, PartialEq, Serialize)]
        #[serde(untagged)]
        #[non_exhaustive]
        pub enum WorldBlueprint {
            $(#[doc = of_kind!($variant, $name)] $variant($blueprint),)+
        }

        /// The metrics of a blueprint of any kind. They serialise like the metrics alone.
        #[derive(Clone, Debug, PartialEq, Serialize)]
        #[serde(untagged)]
        #[non_exhaustive]
        pub enum WorldMetrics {
            $(#[doc = of_kind!($variant, $name)] $variant(<$blueprint as Blueprint>::Metrics),)+
        }

        impl WorldBlueprint {
            /// Builds the world in metres.
            pub fn to_world(&self) -> World {
                match self {
                    $(WorldBlueprint::$variant(blueprint) => blueprint.to_world(),)+
                }
            }

            /// Measures the blueprint.
            pub fn metrics(&self) -> WorldMetrics {
                match self {
                    $(WorldBlueprint::$variant(blueprint) => {
                        WorldMetrics::$variant(blueprint.metrics())
                    })+
                }
            }
        }

        $(impl From<$spec> for WorldSpec {
            fn from(spec: $spec) -> Self {
                WorldSpec::$variant(spec)
            }
        })+
    };
}

specs! {
    Hallway, "hallway", crate::hallway::HallwaySpec, crate::hallway::Hallway;
    Forest, "forest", crate::forest::ForestSpec, crate::forest::Forest;
    Road, "road", crate::road::RoadSpec, crate::road::Road;
    Indoor, "indoor", crate::indoor::IndoorSpec, crate::indoor::FloorPlan;
    Landscape, "landscape", crate::landscape::LandscapeSpec, crate::landscape::Landscape;
    Cellular, "cellular", crate::cellular::CellularSpec, crate::cellular::BlockField;
}

impl FromStr for WorldKind {
    type Err = SettingsError;

    fn from_str(name: &str) -> Result<Self, SettingsError> {
        WorldKind::named(name).ok_or_else(|| {
            let known =
                WorldKind::ALL.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", ");
            SettingsError::UnknownKind { name: name.to_owned(), known }
        })
    }
}

impl WorldKind {
    /// Returns the setting with a name.
    ///
    /// ```
    /// use envgen::WorldKind;
    ///
    /// let setting = WorldKind::Hallway.setting("width")?;
    /// assert_eq!((setting.unit, setting.allowed_text().as_str()), ("m", "a number from 0.05 to 1000"));
    /// // Former names are understood.
    /// assert_eq!(WorldKind::Hallway.setting("wall")?.name, "wall_thickness");
    /// assert!(WorldKind::Hallway.setting("colour").is_err());
    /// # Ok::<(), envgen::SettingsError>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error that lists the settings that exist.
    pub fn setting(self, name: &str) -> Result<&'static Setting, SettingsError> {
        self.settings()
            .iter()
            .find(|setting| setting.name == name || setting.alias == Some(name))
            .ok_or_else(|| SettingsError::unknown_setting(self, name, &[self.settings()]))
    }
}

impl WorldSpec {
    /// Sets one setting from text, as `--set name=value` does. On an error, the spec is unchanged.
    ///
    /// ```
    /// use envgen::{WorldKind, WorldSpec, hallway::HallwaySpec};
    ///
    /// let mut spec = WorldKind::Hallway.default_spec();
    /// spec.set("segments", "80")?;
    /// let expected = HallwaySpec { segments: 80, ..Default::default() };
    /// assert_eq!(spec, WorldSpec::from(expected));
    /// assert!(spec.set("p_st", "2").is_err() && spec.set("colour", "red").is_err());
    /// # Ok::<(), envgen::SettingsError>(())
    /// ```
    ///
    /// # Errors
    /// When the setting does not exist (the error lists those that do), or when the text is not one of its values.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), SettingsError> {
        let setting = self.kind().setting(name)?;
        let mut settings = self.settings_json();
        settings[setting.name] = setting.parse(value)?;
        let parsed = settings[setting.name].clone();
        let is_structured = parsed.is_array() || parsed.is_object();
        let read = self.kind().spec_from_json(settings.clone()).or_else(|error| {
            // Names may look like numbers. Where they are none, they are numbers.
            settings[setting.name] = Setting::numbers(&parsed);
            let is_list = matches!(setting.allowed, Allowed::List(_));
            if is_list { self.kind().spec_from_json(settings) } else { Err(error) }
        });
        *self = read.map_err(|error| match setting.allowed {
            // What is wrong is a part of the value.
            Allowed::Other(_) if is_structured => {
                setting.error_with(value, format!("{}: {error}", setting.allowed_text()))
            }
            _ => setting.error(value),
        })?;
        Ok(())
    }

    /// Reads a spec from RON.
    ///
    /// # Errors
    /// Names the line and column of the mistake.
    pub fn from_ron(text: &str) -> Result<Self, SettingsError> {
        ron_options().from_str(text).map_err(|error| SettingsError::Ron(Box::new(error)))
    }

    /// Returns the spec as RON, with every setting. The settings of indoor materials, clutter and doorway widths are
    /// written only if they are set.
    ///
    /// ```
    /// use envgen::{WorldSpec, road::RoadSpec};
    ///
    /// let spec = WorldSpec::from(RoadSpec { length: 500.0, ..Default::default() });
    /// let text = spec.to_ron();
    /// assert!(text.contains("length: 500.0"));
    /// assert_eq!(WorldSpec::from_ron(&text)?, spec);
    /// # Ok::<(), envgen::SettingsError>(())
    /// ```
    pub fn to_ron(&self) -> String {
        let config = ron::ser::PrettyConfig::default();
        ron_options().to_string_pretty(self, config).unwrap_or_default()
    }

    /// Returns the spec from which a generated world was made.
    ///
    /// # Errors
    /// When the provenance names no kind of this crate, or has settings that the kind does not have.
    pub fn from_provenance(provenance: &Provenance) -> Result<Self, SettingsError> {
        let kind: WorldKind = provenance.kind.parse()?;
        kind.spec_from_json(provenance.spec.clone()).map_err(|error| {
            let allowed = format!("settings of the kind {kind}: {error}");
            SpecError::new("spec", &provenance.spec, allowed).into()
        })
    }
}

/// Returns the options of RON for specs: `Hallway(segments: 80)`, without a second pair of parentheses.
fn ron_options() -> ron::Options {
    ron::Options::default()
        .with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES)
        .with_default_extension(Extensions::IMPLICIT_SOME)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Allowed;

    #[test]
    fn the_table_of_settings_is_the_spec() {
        for &kind in WorldKind::ALL {
            let fields = kind.default_spec().settings_json();
            let mut fields: Vec<_> = fields.as_object().unwrap().keys().cloned().collect();
            let mut table: Vec<_> = kind.settings().iter().map(|s| s.name.to_owned()).collect();
            fields.sort();
            table.sort();
            assert_eq!(fields, table, "{kind}");
        }
    }

    #[test]
    fn a_misspelt_name_brings_the_right_one_to_mind() {
        let error = WorldKind::Hallway.setting("segmnets").unwrap_err().to_string();
        assert!(
            error.contains("`segmnets` (did you mean `segments`?), expected one of"),
            "{error}"
        );
        let error = WorldKind::Hallway.setting("colour").unwrap_err().to_string();
        assert!(!error.contains("did you mean"), "{error}");
    }

    #[test]
    fn defaults_are_allowed_and_every_choice_can_be_set() {
        for &kind in WorldKind::ALL {
            assert_eq!(kind.default_spec().validate(), Ok(()), "{kind}");
            for setting in kind.settings() {
                let mut spec = kind.default_spec();
                match setting.allowed {
                    Allowed::Choice(names) => {
                        for name in names {
                            spec.set(setting.name, name).unwrap();
                            assert_eq!(spec.settings_json()[setting.name], *name);
                        }
                    }
                    Allowed::Flag => {
                        spec.set(setting.name, "true").unwrap();
                        spec.set(setting.name, "false").unwrap();
                    }
                    _ => {}
                }
            }
        }
    }

    #[test]
    fn former_names_are_read() {
        let former = [
            (WorldKind::Hallway, "wall", "wall_thickness", "0.3"),
            (WorldKind::Road, "random", "segment_count", "7"),
            (WorldKind::Road, "turns", "turn_law", "uniform_angle"),
            (WorldKind::Road, "shortest", "min_segment_length", "2"),
            (WorldKind::Road, "aim_x", "end_x", "40"),
            (WorldKind::Road, "aim_y", "end_y", "41"),
            (WorldKind::Indoor, "unit", "cell_size", "2"),
            (WorldKind::Indoor, "wall", "wall_thickness", "0.2"),
            (WorldKind::Indoor, "footprint", "robot_radius", "0.2"),
            (WorldKind::Landscape, "cell", "cell_size", "2"),
        ];
        for (kind, old, new, value) in former {
            let mut spec = kind.default_spec();
            spec.set(old, value).unwrap();
            let mut by_new = kind.default_spec();
            by_new.set(new, value).unwrap();
            assert_eq!(spec, by_new, "{kind} {old}");
            let mut settings = spec.settings_json();
            settings[old] = settings[new].take();
            settings.as_object_mut().unwrap().remove(new);
            assert_eq!(kind.spec_from_json(settings).unwrap(), spec, "{kind} {old}");
        }
        let aliases: usize = WorldKind::ALL
            .iter()
            .map(|kind| kind.settings().iter().filter(|s| s.alias.is_some()).count())
            .sum();
        assert_eq!(aliases, former.len());
    }

    #[test]
    fn examples_and_rules_are_of_the_kind() {
        for &kind in WorldKind::ALL {
            for setting in kind.settings() {
                let form = matches!(setting.allowed, Allowed::List(_));
                assert!(!form || setting.example.is_some(), "{kind} {}", setting.name);
                let Some(example) = setting.example else { continue };
                // As many values as there are segments by default, or classes.
                let mut spec = kind.default_spec();
                if setting.name == "speeds" {
                    spec.set("classes", "3").unwrap();
                    spec.set("entropy", "1").unwrap();
                }
                if setting.name == "fixed" {
                    spec.set("profile", "calibrated").unwrap();
                }
                assert_eq!(spec.set(setting.name, example), Ok(()), "{kind} {}", setting.name);
                assert_eq!(spec.validate(), Ok(()), "{kind} {}", setting.name);
            }
            assert!(!kind.rules().is_empty(), "{kind}");
            for rule in kind.rules() {
                let mut quoted = rule.split('`').skip(1).step_by(2);
                assert!(quoted.clone().count() > 1, "{kind}: {rule}");
                assert!(quoted.all(|name| kind.setting(name).is_ok()), "{kind}: {rule}");
            }
        }
    }

    #[test]
    fn rules_give_the_limits_that_hold() {
        use crate::{cellular, forest, landscape, road};
        let hold = |kind: WorldKind, limit: u64| {
            let digits = limit.to_string();
            let plain = |rule: &str| rule.replace(',', "").contains(&digits);
            assert!(kind.rules().iter().any(|rule| plain(rule)), "{kind} {limit}");
        };
        hold(WorldKind::Forest, forest::MAX_TREES as u64);
        hold(WorldKind::Forest, forest::MAX_HARD_CORE_TREES as u64);
        hold(WorldKind::Road, road::MAX_WAYPOINTS);
        hold(WorldKind::Road, road::MAX_SEGMENTS as u64);
        hold(WorldKind::Landscape, landscape::MAX_CELLS);
        hold(WorldKind::Landscape, landscape::MAX_SMOOTH_CELLS);
        hold(WorldKind::Cellular, cellular::MAX_VISITS);
    }

    #[test]
    fn rooms_with_commas_can_be_chosen() {
        use crate::indoor::{Catalogue, IndoorSpec};
        let rooms = Catalogue::builtin().rooms().iter().take(2);
        let mut designs: Vec<_> = rooms.map(|room| (**room).clone()).collect();
        let names = ["a, b", "maze"].map(str::to_owned);
        for (design, name) in designs.iter_mut().zip(&names) {
            design.name.clone_from(name);
        }
        let catalogue = Some(Catalogue::new(designs).unwrap());
        let spec = IndoorSpec { catalogue, ..Default::default() };
        let mut set = WorldSpec::from(spec.clone());
        set.set("rooms", r#""a, b",maze"#).unwrap();
        assert_eq!(set, IndoorSpec { rooms: names.to_vec(), ..spec }.into());
        assert_eq!(set.validate(), Ok(()));
    }

    #[test]
    fn every_default_can_be_set_as_it_is_printed() {
        for &kind in WorldKind::ALL {
            let defaults = kind.default_spec().settings_json();
            for setting in kind.settings() {
                let (mut spec, name) = (kind.default_spec(), setting.name);
                let text = setting.text_of(&defaults[name]);
                assert_eq!(spec.set(name, &text), Ok(()), "{kind} {name}");
                assert_eq!(spec, kind.default_spec(), "{kind} {name}");
            }
        }
    }

    #[test]
    fn ron_gives_the_same_spec_back() {
        for &kind in WorldKind::ALL {
            let spec = kind.default_spec();
            assert_eq!(WorldSpec::from_ron(&spec.to_ron()), Ok(spec));
        }
    }

    #[test]
    fn either_spelling_of_the_kind_is_read() {
        for &kind in WorldKind::ALL {
            for name in [format!("{kind:?}"), kind.to_string()] {
                assert_eq!(WorldSpec::from_ron(&format!("{name}()")), Ok(kind.default_spec()));
            }
        }
    }

    #[test]
    fn unknown_names_list_what_exists() {
        let mut spec = WorldKind::Hallway.default_spec();
        let error = spec.set("segmens", "3").unwrap_err().to_string();
        assert!(error.contains("segments, p_st"), "{error}");
        let error = "lake".parse::<WorldKind>().unwrap_err().to_string();
        assert!(error.contains("hallway, forest"), "{error}");
        assert!(WorldSpec::from_ron("Hallway(segmens: 3)").is_err());
    }
}
