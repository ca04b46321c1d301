//! Generates a hallway from a spec and a seed.

use super::blueprint::Hallway;
use super::chain::HallwayChain;
use super::spec::{HallwaySpec, Start};
use super::state::State;
use crate::error::SpecError;
use crate::seed::Seed;

/// Generates the hallway of a valid spec.
pub(super) fn hallway(spec: &HallwaySpec, seed: Seed) -> Result<Hallway, SpecError> {
    let chain = HallwayChain::new(spec.p_st, spec.p_tt)?;
    let start = match spec.start {
        Start::State(state) => state,
        Start::Stationary => {
            let drawn = seed.stream("hallway/start", 0).weighted(&chain.stationary()?);
            State::ALL[drawn.unwrap_or(0)]
        }
    };
    let mut stream = seed.stream("hallway/chain", 0);
    let states = chain.sample(start, spec.segments as usize, &mut stream);
    Ok(Hallway { states, spec: spec.clone(), seed })
}
