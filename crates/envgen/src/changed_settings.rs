//! Summaries of a world's settings: those that differ from the defaults, as text.

use serde_json::Value;

use crate::provenance::Provenance;
use crate::spec::WorldKind;

/// Longer lists are not written out in [`Provenance::changed_settings`].
const MOST_ITEMS: usize = 4;

impl Provenance {
    /// Returns the settings that differ from the defaults of the kind, in the order of the kind's list, such as
    /// `difficulty 7, profile thesis`. For an edited world the text ends with `edited`. The text is empty for kinds
    /// that are not generated.
    pub fn changed_settings(&self) -> String {
        let Some(kind) = WorldKind::named(&self.kind) else {
            return String::new();
        };
        let defaults = kind.default_spec().settings_json();
        let changed = kind.settings().iter().filter_map(|setting| {
            let former = || setting.alias.and_then(|alias| self.spec.get(alias));
            let value = self.spec.get(setting.name).or_else(former)?;
            let text = (Some(value) != defaults.get(setting.name)).then(|| plain(value))??;
            Some(format!("{} {text}", setting.name.replace('_', " ")))
        });
        let edited = self.edited.then(|| "edited".to_owned());
        changed.chain(edited).collect::<Vec<_>>().join(", ")
    }
}

/// Rounds a number to significant digits, at least one.
pub(crate) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// Returns a value as text; `None` for a value that has several parts.
fn plain(value: &Value) -> Option<String> {
    match value {
        Value::Bool(true) => Some("on".to_owned()),
        Value::Bool(false) => Some("off".to_owned()),
        Value::Number(number) => Some(match number.as_f64() {
            Some(value) if number.is_f64() => rounded(value, 4).to_string(),
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
