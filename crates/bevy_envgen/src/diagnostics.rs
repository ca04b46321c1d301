//! Bevy diagnostics with the numbers of parts and tiles, and the time that they take.

use bevy::diagnostic::{
    Diagnostic, DiagnosticMeasurement, DiagnosticPath, Diagnostics, DiagnosticsStore,
    RegisterDiagnostic,
};
use bevy::platform::time::Instant;
use bevy::prelude::*;

use crate::part::PartId;
use crate::spawn::{Tile, TileSolids};
use crate::systems::{EnvgenSchedules, EnvgenSystems};

/// Adds Bevy diagnostics about the worlds of an app, which `LogDiagnosticsPlugin` and similar plugins show.
///
/// It is not in the group [`EnvgenPlugins`](crate::EnvgenPlugins), because it counts parts in every frame.
/// Add it after the group.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnvgenDiagnosticsPlugin;

impl EnvgenDiagnosticsPlugin {
    /// The number of spawned parts of all environments, both entities and data of tiles.
    pub const PARTS: DiagnosticPath = DiagnosticPath::const_new("envgen/parts");
    /// The number of spawned tiles.
    pub const TILES: DiagnosticPath = DiagnosticPath::const_new("envgen/tiles");
    /// The time in milliseconds that the generator took for a world, measured when the parts of the world are
    /// spawned.
    pub const GENERATION_TIME: DiagnosticPath = DiagnosticPath::const_new("envgen/generation_time");
    /// The time in milliseconds per frame that streaming took for all environments. It is not measured while
    /// no environment is streamed.
    pub const STREAMING_TIME: DiagnosticPath = DiagnosticPath::const_new("envgen/streaming_time");
}

impl Plugin for EnvgenDiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        for path in [Self::PARTS, Self::TILES] {
            app.register_diagnostic(Diagnostic::new(path).with_smoothing_factor(0.0));
        }
        for path in [Self::GENERATION_TIME, Self::STREAMING_TIME] {
            app.register_diagnostic(Diagnostic::new(path).with_suffix(" ms"));
        }
        let schedule = EnvgenSchedules::of(app).main;
        app.add_systems(schedule, count.after(EnvgenSystems::Notify));
    }
}

/// Counts spawned parts and tiles.
fn count(
    mut diagnostics: Diagnostics,
    parts: Query<(), With<PartId>>,
    tiles: Query<Option<&TileSolids>, With<Tile>>,
) {
    diagnostics.add_measurement(&EnvgenDiagnosticsPlugin::PARTS, || {
        let data: usize = tiles.iter().flatten().map(|solids| solids.len()).sum();
        (parts.iter().len() + data) as f64
    });
    diagnostics.add_measurement(&EnvgenDiagnosticsPlugin::TILES, || tiles.iter().len() as f64);
}

/// Adds a measurement if the diagnostic exists and is enabled.
pub(crate) fn measure(world: &mut World, path: &DiagnosticPath, value: f64) {
    let Some(mut store) = world.get_resource_mut::<DiagnosticsStore>() else { return };
    if let Some(diagnostic) = store.get_mut(path).filter(|diagnostic| diagnostic.is_enabled) {
        diagnostic.add_measurement(DiagnosticMeasurement { time: Instant::now(), value });
    }
}
