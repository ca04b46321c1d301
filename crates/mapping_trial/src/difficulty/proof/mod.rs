//! The proof: are maps as difficult as requested, also for policies, lasers, estimators and robots that
//! the calibration has not seen?
//!
//! The design is frozen: its maps, conditions and analysis follow from the files of this folder and a
//! seed, and nothing is fitted to its results.

mod agreement;
mod analysis;
mod design;
mod dial;
mod report;
mod run;

pub use agreement::{Agreement, Link, agreement};
pub use analysis::{AllSizes, Analysis, Dropped, Level, MapKind, Row, Single, analyse};
pub use design::{Part, ProofDesign, ProofMap};
pub use dial::Dial;
pub use report::{figure, page};
pub use run::{ProofResult, Watch, merge, run};
