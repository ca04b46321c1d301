//! Block fields: blocks grown by a cellular automaton, which a robot should cross from left to right.
//!
//! Source: the generator of BARN: D. Perille, A. Truong, X. Xiao and P. Stone, Benchmarking Metric Ground
//! Navigation, SSRR 2020, arXiv:2008.13315. Cells are filled at random and smoothed. A field is accepted if a robot
//! with a width of some cells can cross it.
//!
//! - [`CellularSpec`] and [`BlockField`]: the settings, and the generated field.
//! - [`CellularMetrics`]: metrics of a field, including BARN's five.
//! - [`c_space`]: the cells in which a robot's centre can be.

mod blueprint;
mod c_space;
mod error;
mod generate;
mod metrics;
mod path;
mod spec;
mod world;

pub use blueprint::BlockField;
pub use c_space::c_space;
pub use error::CellularError;
#[cfg(feature = "barn")]
pub(crate) use generate::middle_ends;
pub use metrics::CellularMetrics;
#[cfg(feature = "rmf")]
pub(crate) use path::CheapestPaths;
pub use spec::{Acceptance, CellularSpec, Ends, MAX_VISITS, OpenSides};

use crate::error::SpecError;
use crate::generate::{Blueprint, Spec};
use crate::seed::Seed;
use crate::settings::Setting;
use crate::world::World;

impl Spec for CellularSpec {
    type Blueprint = BlockField;
    type Error = CellularError;

    const KIND: &'static str = "cellular";

    const VALUE_VERSION: u32 = 1;

    const SETTINGS: &'static [Setting] = CellularSpec::SETTINGS;

    const RULES: &'static [&'static str] = spec::RULES;

    fn validate(&self) -> Result<(), SpecError> {
        self.check()
    }

    fn work(&self) -> f64 {
        self.cells() as f64
    }

    fn generate(&self, seed: Seed) -> Result<BlockField, CellularError> {
        self.validate()?;
        generate::field(self, seed)
    }
}

impl Blueprint for BlockField {
    type Metrics = CellularMetrics;

    fn metrics(&self) -> CellularMetrics {
        metrics::measure(self)
    }

    fn to_world(&self) -> World {
        world::world(self)
    }
}
