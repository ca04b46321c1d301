//! Where a world comes from.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::seed::{STREAM_ALGORITHM, Seed};
use crate::spec::WorldKind;

/// Where a world comes from, complete enough to generate it again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// The kind of world, such as `hallway`; `import` for one that was read from another format
    /// and `manual` for one that was put together by hand.
    pub kind: String,
    /// The settings, by name, or what is known about the source.
    pub spec: Value,
    /// The seed; absent for worlds made without one.
    pub seed: Option<Seed>,
    /// The algorithm of the random streams, [`STREAM_ALGORITHM`] when it was generated.
    pub algorithm: String,
    /// The version of the crate `envgen`.
    pub crate_version: String,
    /// The value version of this kind: the same spec and seed give the same world as long as it does
    /// not change.
    pub value_version: u32,
    /// Whether the world was changed after it was generated, so that it may no longer be what the
    /// spec asked for.
    pub edited: bool,
    /// The requested difficulty, recorded when an edit makes it invalid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difficulty_requested: Option<f64>,
}

/// Longer lists are not written out in [`Provenance::changed_settings`].
const MOST_ITEMS: usize = 4;

impl Provenance {
    /// Kind and seed, such as `indoor, seed 3`.
    pub fn name(&self) -> String {
        self.seed.map_or(self.kind.clone(), |seed| format!("{}, seed {seed}", self.kind))
    }

    /// The settings that differ from the defaults of the kind, in the order of its list, such as
    /// `difficulty 7, profile thesis`; at the end `edited` for an edited world. Empty for kinds that are
    /// not generated.
    pub fn changed_settings(&self) -> String {
        let Some(kind) = WorldKind::ALL.iter().find(|kind| kind.name() == self.kind) else {
            return String::new();
        };
        let defaults = kind.default_spec().settings_json();
        let changed = kind.settings().iter().filter_map(|setting| {
            let value = self.spec.get(setting.name)?;
            let text = (Some(value) != defaults.get(setting.name)).then(|| plain(value))??;
            Some(format!("{} {text}", setting.name.replace('_', " ")))
        });
        let edited = self.edited.then(|| "edited".to_owned());
        changed.chain(edited).collect::<Vec<_>>().join(", ")
    }

    /// The provenance of a generated world.
    pub fn generated(kind: &str, spec: Value, seed: Seed, value_version: u32) -> Self {
        Provenance {
            kind: kind.to_owned(),
            spec,
            seed: Some(seed),
            algorithm: STREAM_ALGORITHM.to_owned(),
            crate_version: env!("CARGO_PKG_VERSION").to_owned(),
            value_version,
            edited: false,
            difficulty_requested: None,
        }
    }

    /// The provenance of a world that was put together by hand (`manual`) or read from another
    /// format (`import`), with what is known about it.
    pub fn other(kind: &str, source: Value) -> Self {
        Provenance {
            kind: kind.to_owned(),
            spec: source,
            seed: None,
            algorithm: String::new(),
            crate_version: env!("CARGO_PKG_VERSION").to_owned(),
            value_version: 0,
            edited: false,
            difficulty_requested: None,
        }
    }
}

/// A number to four digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// A value as text; `None` for one with several parts.
fn plain(value: &Value) -> Option<String> {
    match value {
        Value::Bool(true) => Some("on".to_owned()),
        Value::Bool(false) => Some("off".to_owned()),
        Value::Number(number) => Some(match number.as_f64() {
            Some(value) if number.is_f64() => rounded(value).to_string(),
            _ => number.to_string(),
        }),
        Value::String(text) => Some(text.replace('_', " ")),
        Value::Array(items) if items.is_empty() => Some("none".to_owned()),
        Value::Array(items) if items.len() <= MOST_ITEMS => {
            items.iter().map(plain).collect::<Option<Vec<_>>>().map(|items| items.join(" "))
        }
        Value::Array(items) => Some(format!("of {}", items.len())),
        Value::Null | Value::Object(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::indoor::{IndoorSpec, Profile};
    use crate::landscape::{Algorithm, LandscapeSpec};
    use crate::road::RoadSpec;
    use crate::{Blueprint, Seed, Spec, World};

    fn described(world: &World) -> String {
        format!("{}: {}", world.provenance.name(), world.provenance.changed_settings())
    }

    #[test]
    fn settings_that_differ_are_named() {
        let indoor = IndoorSpec { difficulty: 7.0, profile: Profile::Thesis, ..Default::default() };
        let mut world = indoor.generate(Seed(3)).unwrap().to_world();
        assert_eq!(described(&world), "indoor, seed 3: difficulty 7, profile thesis");
        world.provenance.edited = true;
        assert!(described(&world).ends_with("profile thesis, edited"));

        let smooth = LandscapeSpec { algorithm: Algorithm::Smooth, ..Default::default() };
        let world = smooth.generate(Seed(3)).unwrap().to_world();
        assert_eq!(described(&world), "landscape, seed 3: algorithm smooth");
        let road = RoadSpec { length: 512.543, kerb: 0.0, ..Default::default() };
        let world = road.generate(Seed(4)).unwrap().to_world();
        assert_eq!(described(&world), "road, seed 4: length 512.5, kerb 0");
        let world = LandscapeSpec::default().generate(Seed(4)).unwrap().to_world();
        assert_eq!(described(&world), "landscape, seed 4: ");
    }
}
