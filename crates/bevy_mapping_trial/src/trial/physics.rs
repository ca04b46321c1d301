//! The settings of physics for trials.

use bevy_envgen::physics::{ColliderMerging, ColliderSettings, TopDownPhysicsPlugin};
use mapping_trial::backend::TICK;

/// Physics settings with values for mapping trials.
pub trait ForTrials {
    /// Returns the values for mapping trials.
    ///
    /// - [`TopDownPhysicsPlugin`]: 20 steps per second, each of 4 substeps.
    /// - [`ColliderSettings`]: merged, which makes rapier's rays faster, and without sensors, because robots
    ///   query the surfaces of the world directly.
    fn for_trials() -> Self;
}

impl ForTrials for TopDownPhysicsPlugin {
    fn for_trials() -> Self {
        TopDownPhysicsPlugin::new(1.0 / TICK).with_substeps(4)
    }
}

impl ForTrials for ColliderSettings {
    fn for_trials() -> Self {
        ColliderSettings { merge: ColliderMerging::Always, sensors: false, ..Default::default() }
    }
}
