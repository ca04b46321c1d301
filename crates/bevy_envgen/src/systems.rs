//! The order of the systems, and the schedule that they are in.

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;

/// The system sets that generate, spawn and report worlds, in this order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EnvgenSystems {
    /// Detects environments that have changed and starts their generators.
    Request,
    /// Collects the worlds that background tasks have finished.
    Collect,
    /// Despawns the previous parts and spawns the new ones, including everything that observers add.
    Spawn,
    /// Spawns and despawns the tiles of streamed worlds around their anchors.
    Stream,
    /// Triggers and writes [`EnvironmentReady`](crate::EnvironmentReady) and
    /// [`EnvironmentFailed`](crate::EnvironmentFailed).
    Notify,
}

/// A resource with the schedule of the core plugin's systems, for plugins that are added later.
#[derive(Resource, Clone, Copy)]
pub(crate) struct EnvgenSchedules {
    pub(crate) main: Interned<dyn ScheduleLabel>,
}

impl EnvgenSchedules {
    pub(crate) fn of(app: &App) -> Self {
        let known = app.world().get_resource::<EnvgenSchedules>().copied();
        known.unwrap_or(EnvgenSchedules { main: Update.intern() })
    }
}
