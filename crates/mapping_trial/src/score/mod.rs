//! Scores of a run: how well a world was mapped, and how difficult that was, with every component and
//! the scores M, N and D.
//!
//! Everything is compared in the start frame, without alignment, since robots know where they start.

mod alignment;
mod error;
mod fit;
mod kendall;
mod map_scores;
mod navigability;
mod parts;
mod pose;
mod raster;
mod reference;
mod rows;
mod run_summary;
mod score_1;
mod scores;
mod swept;
mod trajectory_pair;
mod walls;
mod weights;

pub use self::alignment::alignment;
pub use self::error::ScoreError;
pub use self::fit::fit;
pub use self::kendall::kendall_tau;
pub use self::map_scores::{MapScores, TrajectoryScores};
pub use self::parts::Parts;
pub use self::reference::Reference;
pub use self::rows::ScoreRow;
pub use self::run_summary::RunSummary;
pub use self::score_1::Score1;
pub use self::scores::{MovingScores, Scores};
pub use self::swept::SweptCells;
pub use self::trajectory_pair::TrajectoryPair;
pub use self::weights::{Difficulties, Sensitivity, Weights, sensitivity};

#[cfg(test)]
mod tests;
