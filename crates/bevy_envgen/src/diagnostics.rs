//! How much there is, and what it costs, as Bevy's diagnostics.

use bevy::diagnostic::{
    Diagnostic, DiagnosticMeasurement, DiagnosticPath, Diagnostics, DiagnosticsStore,
    RegisterDiagnostic,
};
use bevy::platform::time::Instant;
use bevy::prelude::*;

use crate::part::PartId;
use crate::spawn::{Tile, TileSolids};
use crate::{EnvgenSystems, Schedules};

/// Measures the worlds of an app as Bevy's diagnostics, for its `LogDiagnosticsPlugin` and the like.
///
/// Not of the group: it counts parts in every frame. Add it after
/// [`EnvgenPlugins`](crate::EnvgenPlugins).
#[derive(Clone, Copy, Debug, Default)]
pub struct EnvgenDiagnosticsPlugin;

impl EnvgenDiagnosticsPlugin {
    /// Parts that are spawned now, entities and data, of all environments.
    pub const PARTS: DiagnosticPath = DiagnosticPath::const_new("envgen/parts");
    /// Tiles that are spawned now.
    pub const TILES: DiagnosticPath = DiagnosticPath::const_new("envgen/tiles");
    /// Milliseconds that the generator took for a world, measured when its parts are spawned.
    pub const GENERATION_TIME: DiagnosticPath = DiagnosticPath::const_new("envgen/generation_time");
    /// Milliseconds of a frame that the streaming of all environments took; nothing is measured while
    /// none is streamed.
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
        let schedule = Schedules::of(app).main;
        app.add_systems(schedule, count.after(EnvgenSystems::Notify));
    }
}

/// Counts what is spawned.
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

/// Adds a measurement, where the plugin is there and the diagnostic enabled.
pub(crate) fn measure(world: &mut World, path: &DiagnosticPath, value: f64) {
    let Some(mut store) = world.get_resource_mut::<DiagnosticsStore>() else { return };
    if let Some(diagnostic) = store.get_mut(path).filter(|diagnostic| diagnostic.is_enabled) {
        diagnostic.add_measurement(DiagnosticMeasurement { time: Instant::now(), value });
    }
}
