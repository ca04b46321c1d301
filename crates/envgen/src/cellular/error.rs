//! Errors of generating block fields.

use thiserror::Error;

use crate::error::SpecError;

/// The reasons why a block field could not be generated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CellularError {
    /// The spec has a setting that is not allowed.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// No field was accepted.
    #[error(
        "none of {attempts} fields was accepted; ask for a lower `fill`, fewer `robot_cells`, more \
         `attempts` or another `acceptance`"
    )]
    Attempts {
        /// Number of fields that were drawn.
        attempts: u64,
    },
}
