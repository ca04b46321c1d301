//! Why a block field could not be generated.

use thiserror::Error;

use crate::error::SpecError;

/// Why a block field could not be generated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CellularError {
    /// The spec asks for something that is not allowed.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// No field was accepted.
    #[error(
        "none of {attempts} fields was accepted; ask for a lower `fill`, fewer `robot_cells`, more \
         `attempts` or another `acceptance`"
    )]
    Attempts {
        /// The fields that were drawn.
        attempts: u64,
    },
}
