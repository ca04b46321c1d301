//! Errors of generating landscapes.

use thiserror::Error;

use super::spec::Algorithm;
use crate::error::SpecError;

/// The reasons why a landscape could not be generated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LandscapeError {
    /// The spec has a setting that is not allowed.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// The algorithm cannot reach the requested Total Edge, though other algorithms may.
    #[error(
        "`total_edge` must be from {low} to {high} for {} landscapes of this seed, got {target}; \
         `mixed` and `bands` reach further", algorithm.name()
    )]
    Look {
        /// The algorithm.
        algorithm: Algorithm,
        /// The least Total Edge that the algorithm reaches.
        low: u64,
        /// The greatest Total Edge that the algorithm reaches.
        high: u64,
        /// The requested Total Edge.
        target: u64,
    },
}
