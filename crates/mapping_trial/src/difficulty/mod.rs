//! The difficulty of a world, measured by trials; and worlds of a requested difficulty.
//!
//! The difficulty `d` of a world is the mean score D of the trials of a [`Panel`] in it, on a scale
//! whose 0 and 10 are the means of two sets of worlds, the [`Anchors`]. `m` and `n` are the same for
//! the scores M and N.
//!
//! | Task | Items |
//! |---|---|
//! | The conditions of trials | [`Panel`] |
//! | The worlds that fix the scale | [`Anchors`], [`reference_scale`] |
//! | Measuring the difficulty of a world | [`measure`](fn@measure) |
//! | Maps of a requested difficulty, verified by trials | [`verified`](fn@verified) |
//! | Checking that maps are as difficult as requested | [`proof`] |
//! | The effect of each setting on the difficulty | [`levers`] |
//! | The worlds to which predictions are fitted | [`AtlasDesign`], [`samples`], [`calibrate`] |

mod anchors;
mod atlas;
mod fit;
pub mod levers;
mod measure;
mod panel;
mod placed;
pub mod proof;
mod ridge;
mod usual_noise;
mod verified;

pub use anchors::{Anchors, reference_scale};
pub use atlas::{AtlasDesign, AtlasSize, samples, table};
pub use fit::{LEAST_SAMPLES, Sample, TooFewSamples, calibrate};
pub use measure::{ConditionMean, MeasureError, Measurement, Measuring, measure};
pub use panel::Panel;
pub use verified::{NEAR_REQUEST, Verified, VerifyError, most_trials, verified};
