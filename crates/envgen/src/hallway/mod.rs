//! Markov hallways: corridors whose turns follow a Markov chain, and which never cross themselves.
//!
//! Source: C. Richter, W. Vega-Brown and N. Roy, Markov Chain Hallway and Poisson Forest Environment Generating
//! Distributions, MIT-CSAIL-TR-2015-014, section 1, <https://studylib.net/doc/10593763/>.
//!
//! - [`HallwayChain`]: the eight states, the transition matrix and its stationary distribution, sampling, and
//!   estimation from a sequence of states.
//! - [`HallwaySpec`] and [`Hallway`]: the settings, and the drawn states.
//! - [`HallwayLayout`]: the corridor's centreline and walls in metres.

mod blueprint;
mod chain;
mod feature;
mod generate;
mod layout;
mod metrics;
mod spec;
mod state;
mod world;

pub use blueprint::Hallway;
pub use chain::{Estimate, HallwayChain, HistoryError, Proportion};
pub use feature::{Feature, FeatureKind, Side};
pub use layout::HallwayLayout;
pub use metrics::HallwayMetrics;
pub use spec::{Corners, Ends, HallwaySpec, Start};
pub use state::State;

use crate::error::SpecError;
use crate::generate::{Blueprint, Spec};
use crate::seed::Seed;
use crate::settings::Setting;
use crate::world::World;

impl Spec for HallwaySpec {
    type Blueprint = Hallway;
    type Error = SpecError;

    const KIND: &'static str = "hallway";

    const VALUE_VERSION: u32 = 1;

    const SETTINGS: &'static [Setting] = HallwaySpec::SETTINGS;

    const RULES: &'static [&'static str] = spec::RULES;

    fn validate(&self) -> Result<(), SpecError> {
        self.check()?;
        if self.start == Start::Stationary {
            HallwayChain::new(self.p_st, self.p_tt)?.stationary()?;
        }
        Ok(())
    }

    fn work(&self) -> f64 {
        self.segments as f64
    }

    fn generate(&self, seed: Seed) -> Result<Hallway, SpecError> {
        self.validate()?;
        generate::hallway(self, seed)
    }
}

impl Blueprint for Hallway {
    type Metrics = HallwayMetrics;

    fn metrics(&self) -> HallwayMetrics {
        metrics::measure(self)
    }

    fn to_world(&self) -> World {
        world::world(self)
    }
}
