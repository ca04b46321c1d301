//! The order of systems, and the schedule that they are in.

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;

/// The systems that generate, spawn and report worlds, in this order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EnvgenSystems {
    /// Detects environments that changed and starts their generators.
    Request,
    /// Collects the worlds that background threads have finished.
    Collect,
    /// Despawns the previous parts and spawns the new ones, with all that other plugins add.
    Spawn,
    /// Spawns and despawns the tiles of streamed worlds around their anchors.
    Stream,
    /// Triggers and writes [`EnvironmentReady`](crate::EnvironmentReady) and
    /// [`EnvironmentFailed`](crate::EnvironmentFailed).
    Notify,
}

/// The schedule of the core plugin's systems, for the plugins that are added after it.
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
