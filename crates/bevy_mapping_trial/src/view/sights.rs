//! Where the robots of a trial are, and how far their map reaches.

use bevy::prelude::*;

/// The estimated positions of the robots of a trial and the bounds of their map, in the
/// environment's frame in metres.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct TrialSights {
    /// The position of each robot.
    pub robots: Vec<Vec2>,
    /// The bounds of the map; `None` while the map is empty.
    pub map: Option<Rect>,
}
