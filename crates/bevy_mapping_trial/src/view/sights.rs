//! The positions of the robots of a trial, and the extent of their map.

use bevy::prelude::*;

/// A component with the estimated positions of the robots of a trial and the bounds of their map, in metres
/// in the frame of the environment.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct TrialSights {
    /// The position of each robot.
    pub robots: Vec<Vec2>,
    /// The bounds of the map, or `None` while the map is empty.
    pub map: Option<Rect>,
}
