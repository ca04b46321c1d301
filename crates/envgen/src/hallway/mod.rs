//! Markov hallways: corridors whose turns follow a Markov chain and that never cross themselves.
//!
//! Source: C. Richter, W. Vega-Brown and N. Roy, Markov Chain Hallway and Poisson Forest
//! Environment Generating Distributions, MIT-CSAIL-TR-2015-014, section 1.
//!
//! - [`HallwayChain`]: the eight states, the transition matrix, its stationary law, sampling and
//!   estimation from a history of states.
//! - [`HallwaySpec`] and [`Hallway`]: the settings, and the states that were drawn.
//! - [`HallwayLayout`]: the corridor's centreline and walls in metres.

mod blueprint;
mod chain;
mod feature;
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
        let chain = HallwayChain::new(self.p_st, self.p_tt)?;
        let start = match self.start {
            Start::State(state) => state,
            Start::Stationary => {
                let drawn = seed.stream("hallway/start", 0).weighted(&chain.stationary()?);
                State::ALL[drawn.unwrap_or(0)]
            }
        };
        let mut stream = seed.stream("hallway/chain", 0);
        let states = chain.sample(start, self.segments as usize, &mut stream);
        Ok(Hallway { states, spec: self.clone(), seed })
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
