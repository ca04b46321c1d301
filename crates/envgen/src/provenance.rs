//! The provenance of worlds.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::dials::{Dials, Estimate};
use crate::seed::{STREAM_ALGORITHM, Seed};

/// The provenance of a world, complete enough to generate it again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// The kind of world, such as `hallway`; `import` for a world that was read from another format, and `manual`
    /// for one that was built by hand.
    pub kind: String,
    /// The settings, by name, or what is known about the source.
    pub spec: Value,
    /// The seed; absent for worlds that were made without one.
    pub seed: Option<Seed>,
    /// The algorithm of the random streams: [`STREAM_ALGORITHM`] of the version that generated the world.
    pub algorithm: String,
    /// The version of the crate `envgen`.
    pub crate_version: String,
    /// The value version of this kind. As long as it does not change, the same spec and seed give the same world.
    pub value_version: u32,
    /// Whether the world was changed after it was generated, so that it may no longer satisfy its spec.
    pub edited: bool,
    /// The manual changes of an indoor map, in order, each an [`indoor::Edit`](crate::indoor::Edit). Spec, seed and
    /// these edits give the world again. Empty for worlds that were changed in another manner.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub edits: Vec<Value>,
    /// The requested difficulty, recorded when an edit makes it invalid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difficulty_requested: Option<f64>,
    /// The difficulty that trials measured in this world, if they did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<Box<MeasuredDifficulty>>,
}

/// The difficulty of a world, as measured by trials.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredDifficulty {
    /// The name of the panel of policies, lasers and estimators.
    pub panel: String,
    /// The version of the panel.
    pub panel_version: u32,
    /// The dials, with standard errors due to the noise of the trials.
    pub dials: Dials<Estimate>,
    /// Number of trials.
    pub trials: u32,
    /// The first seed of their sensor noise.
    pub noise_seed: Seed,
}

/// The kind of worlds that were read from files of other formats.
pub(crate) const IMPORT: &str = "import";

impl Provenance {
    /// Returns the provenance that a world had before it was written to a file of another format and read again, as
    /// far as the file states it. For any other world, returns this provenance itself.
    ///
    /// ```
    /// # #[cfg(feature = "geojson")] {
    /// use envgen::export::{Format, Job};
    /// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec, import};
    ///
    /// let forest = ForestSpec::default().generate(Seed(7))?.to_world();
    /// let mut file = Vec::new();
    /// Format::GeoJson.write(&Job::new(&forest), &mut file)?;
    /// let read = import::read_geojson(&mut file.as_slice())?;
    /// assert_eq!(read.provenance.kind, "import");
    /// assert_eq!(read.provenance.original().kind, "forest");
    /// # }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn original(&self) -> Cow<'_, Provenance> {
        let made_by = self.spec.get("made_by").filter(|_| self.kind == IMPORT);
        let made_by = made_by.and_then(|made_by| serde_json::from_value(made_by.clone()).ok());
        made_by.map_or(Cow::Borrowed(self), Cow::Owned)
    }

    /// Returns kind and seed as text, such as `indoor, seed 3`.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
    ///
    /// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
    /// assert_eq!(world.provenance.name(), "hallway, seed 7");
    /// # Ok::<(), envgen::GenerateError>(())
    /// ```
    pub fn name(&self) -> String {
        self.seed.map_or(self.kind.clone(), |seed| format!("{}, seed {seed}", self.kind))
    }

    /// Returns the provenance of a generated world.
    pub fn generated(kind: &str, spec: Value, seed: Seed, value_version: u32) -> Self {
        Provenance {
            kind: kind.to_owned(),
            spec,
            seed: Some(seed),
            algorithm: STREAM_ALGORITHM.to_owned(),
            crate_version: env!("CARGO_PKG_VERSION").to_owned(),
            value_version,
            edited: false,
            edits: Vec::new(),
            difficulty_requested: None,
            measured: None,
        }
    }

    /// Returns the provenance of a world that was built by hand (`manual`) or read from another format (`import`),
    /// with what is known about its source.
    pub fn other(kind: &str, source: Value) -> Self {
        Provenance {
            kind: kind.to_owned(),
            spec: source,
            seed: None,
            algorithm: String::new(),
            crate_version: env!("CARGO_PKG_VERSION").to_owned(),
            value_version: 0,
            edited: false,
            edits: Vec::new(),
            difficulty_requested: None,
            measured: None,
        }
    }
}
