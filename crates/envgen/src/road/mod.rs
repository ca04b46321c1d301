//! Procedural roads: a length is shared out at random among straights and turns.
//!
//! Source: Pseudo-random procedural roads (web page): the lengths of a list of prefabs follow a
//! Dirichlet law, the radius of a turn is uniform between what speed and angle allow.
//!
//! - [`RoadSpec`] and [`Road`]: the settings, and the drawn road with its exact centreline.
//! - [`dirichlet`], [`lengths`], [`largest_remainder`]: how the length is shared out.
//! - [`TurnLimits`]: the radii that a turn can have.
//!
//! Differences from the source: lengths are in metres throughout, where the source's code uses
//! waypoints as metres, so that its radii change with the step; `lengths` = `reserve` leaves every turn
//! the length that it needs, where the source has no valid radius for a turn that is too short.

mod apportion;
mod blueprint;
mod build;
mod concentration;
mod draw;
mod error;
mod fit;
mod laws;
mod spec;
mod turn;

pub use apportion::{dirichlet, largest_remainder, lengths, quantum};
pub use blueprint::{Road, RoadMetrics, RoadSegment, SegmentKind};
pub use build::KERB_TOLERANCE;
pub use concentration::Concentration;
pub use error::RoadError;
#[cfg(feature = "rand")]
pub use laws::RoadLaws;
pub use spec::{Crossing, Lengths, MAX_SEGMENTS, MAX_WAYPOINTS, Prefab, RoadSpec, TurnLaw};
pub use turn::{GRAVITY, TurnLimits};
