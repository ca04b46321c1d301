//! What is promised of a world, and an independent check of it.

use serde::{Deserialize, Serialize};

use crate::geometry::Rect;

/// A promise that a generator makes of a world, and that can be checked on the world alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Claim {
    /// A disc of this radius can move from the start to the goal.
    Connected {
        /// Radius of the disc in metres.
        radius: f64,
    },
    /// No two trees' centres are nearer than this.
    TreeDistance {
        /// Least distance in metres.
        distance: f64,
    },
    /// Whether a disc can cross an area from its west to its east side with its middle inside.
    CrossesWestEast {
        /// The area.
        area: Rect,
        /// Radius of the disc in metres.
        radius: f64,
        /// Whether it can.
        crosses: bool,
    },
}
