//! Metrics of a hallway, and the values that the chain predicts for them.

use serde::Serialize;

use super::blueprint::Hallway;
use super::chain::{HallwayChain, Proportion};
use super::feature;

/// The metrics of a hallway.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HallwayMetrics {
    /// Number of turns.
    pub turns: u64,
    /// Expected number of turns of the chain for this start and length.
    pub turns_expected: f64,
    /// Share of turns among the transitions that leave a straight segment.
    pub p_st: Proportion,
    /// Share of turns among the transitions that leave a turn.
    pub p_tt: Proportion,
    /// Length of the centreline in metres.
    pub length: f64,
    /// Number of alcoves, door frames and narrow places that were placed.
    pub features: u64,
    /// Number of features that were dropped because there was no room for them.
    pub features_dropped: u64,
}

pub(super) fn measure(hallway: &Hallway) -> HallwayMetrics {
    let (spec, states) = (hallway.spec(), hallway.states());
    let chain = HallwayChain::new(spec.p_st, spec.p_tt);
    let estimate = HallwayChain::estimate(states).unwrap_or_default();
    let layout = hallway.layout();
    let placed = feature::place(hallway, &layout);
    HallwayMetrics {
        turns: states.iter().filter(|state| state.is_turn()).count() as u64,
        turns_expected: chain.map_or(0.0, |chain| chain.expected_turns(states[0], states.len())),
        p_st: estimate.p_st,
        p_tt: estimate.p_tt,
        length: layout.length(),
        features: placed.features.len() as u64,
        features_dropped: placed.dropped,
    }
}
