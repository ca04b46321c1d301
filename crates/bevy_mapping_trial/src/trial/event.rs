//! The events of trials.

use bevy::prelude::*;

use super::error::MappingTrialError;

/// An event that is triggered on an environment when its trial begins.
#[derive(EntityEvent, Clone, Debug)]
pub struct TrialStarted {
    /// The environment.
    pub entity: Entity,
}

/// An event that is triggered on an environment when its trial has ended.
#[derive(EntityEvent, Clone, Debug)]
pub struct TrialEnded {
    /// The environment.
    pub entity: Entity,
}

/// An event that is triggered on an environment when its trial cannot begin, or cannot continue because the
/// environment was removed or scaled, or the time steps were changed.
#[derive(EntityEvent, Clone, Debug)]
pub struct TrialFailed {
    /// The environment.
    pub entity: Entity,
    /// The error.
    pub error: MappingTrialError,
}
