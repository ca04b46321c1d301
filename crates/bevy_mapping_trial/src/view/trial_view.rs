//! The visible layers of a trial.

use bevy::prelude::*;

use super::sights::TrialSights;

/// A component with the visible layers of a trial, on the entity of its environment.
///
/// Removing it shows the plain world. Like the trial itself, it is not held by scenes and clones.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(TrialSights)]
pub struct TrialView {
    /// The world with its people, doors and smoke, and the true poses and paths of the robots. This is for
    /// training only, because it is the task of a trial to find them.
    pub truth: bool,
    /// The map.
    pub map: bool,
    /// The current scans.
    pub scan: bool,
    /// The paths of the robots, as they estimate them.
    pub path: bool,
}

impl Default for TrialView {
    fn default() -> Self {
        TrialView { truth: false, map: true, scan: true, path: true }
    }
}
