//! What is promised of a world, and an independent check of it.

use serde::{Deserialize, Serialize};

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
    /// Whether a disc of this radius can cross the forest's area from west to east.
    CrossesWestEast {
        /// Radius of the disc in metres.
        radius: f64,
        /// Whether it can.
        crosses: bool,
    },
    /// From the start a disc of this radius can reach every room, or every part of a room that its
    /// contents divide, and every piece of the hallways and open areas.
    EveryPlaceReachable {
        /// Radius of the disc in metres.
        radius: f64,
    },
    /// This doorway was added, and is open, so that some place can be reached.
    AddedDoorway {
        /// Its place in [`World::doorways`](crate::World::doorways).
        doorway: u32,
    },
}
