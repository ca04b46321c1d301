//! What is asked of a forest.
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::error::{GenerateError, SpecError};
use crate::generate::{Blueprint, Spec};
use crate::geometry::Rect;
use crate::seed::Seed;
use crate::settings::Setting;
use crate::world::World;

/// A forest to generate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ForestSpec {
    /// Width of the area in metres.
    pub width: f64,
}

impl Default for ForestSpec {
    fn default() -> Self {
        ForestSpec { width: 50.0 }
    }
}

const WIDTH: Setting = Setting::number("width", "m", 0.1, 1e6, "width of the area");

/// Why a forest could not be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ForestError {}

impl Spec for ForestSpec {
    type Blueprint = Forest;
    const KIND: &'static str = "forest";
    const VALUE_VERSION: u32 = 1;
    const SETTINGS: &'static [Setting] = &[WIDTH];

    fn validate(&self) -> Result<(), SpecError> {
        WIDTH.check(self.width)
    }

    fn generate(&self, seed: Seed) -> Result<Forest, GenerateError> {
        self.validate()?;
        Ok(Forest { spec: self.clone(), seed })
    }
}

/// The trees of a forest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Forest {
    #[serde(skip)]
    spec: ForestSpec,
    #[serde(skip)]
    seed: Seed,
}

/// Numbers that describe a forest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ForestMetrics {}

impl Blueprint for Forest {
    type Metrics = ForestMetrics;

    fn metrics(&self) -> ForestMetrics {
        ForestMetrics {}
    }

    fn to_world(&self) -> World {
        let size = glam::DVec2::new(self.spec.width, 50.0);
        World::new(self.spec.provenance(self.seed), Rect::new(glam::DVec2::ZERO, size))
    }
}
