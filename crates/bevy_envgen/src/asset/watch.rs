//! Rebuilding environments when the files of their specs change.

use bevy::asset::{AssetLoadFailedEvent, LoadState};
use bevy::prelude::*;

use super::file::{RoomAsset, RoomLoader, WorldAsset, WorldLoader};
use crate::environment::{Environment, EnvironmentError, RebuildEnvironment, WorldSource};
use crate::generate::request_worlds;
use crate::job::GenerationJob;
use crate::systems::{EnvgenSchedules, EnvgenSystems};

/// Loads `.envgen.ron` and `.room.ron` files, and rebuilds worlds whose files change.
///
/// Needs Bevy's `AssetPlugin`, added before or after; without it, environments with specs in files
/// fail. Files are watched with Bevy's feature `file_watcher`, which the feature of the same name
/// turns on.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnvgenAssetPlugin;

impl Plugin for EnvgenAssetPlugin {
    fn build(&self, app: &mut App) {
        register(app);
        let schedule = EnvgenSchedules::of(app).main;
        app.add_systems(
            schedule,
            watch_assets
                .in_set(EnvgenSystems::Request)
                .before(request_worlds)
                .run_if(resource_exists::<Assets<WorldAsset>>),
        );
    }

    fn finish(&self, app: &mut App) {
        register(app);
    }
}

/// Registers assets and loaders as soon as there is an asset server.
fn register(app: &mut App) {
    if app.world().contains_resource::<AssetServer>()
        && !app.world().contains_resource::<Assets<WorldAsset>>()
    {
        app.init_asset::<WorldAsset>()
            .init_asset::<RoomAsset>()
            .init_asset_loader::<WorldLoader>()
            .init_asset_loader::<RoomLoader>();
    }
}

/// Requests a rebuild of environments whose assets changed, and fails those whose assets cannot be
/// loaded or were removed.
fn watch_assets(
    mut environments: Query<(Entity, &Environment, &mut GenerationJob)>,
    assets: Res<Assets<WorldAsset>>,
    server: Res<AssetServer>,
    mut events: MessageReader<AssetEvent<WorldAsset>>,
    mut failures: MessageReader<AssetLoadFailedEvent<WorldAsset>>,
    mut commands: Commands,
) {
    let events: Vec<_> = events.read().collect();
    let failures: Vec<_> = failures.read().collect();
    for (entity, environment, mut slot) in &mut environments {
        let WorldSource::Asset(handle) = &environment.source else { continue };
        let id = handle.id();
        let named = || server.get_path(id).map_or_else(|| id.to_string(), |path| path.to_string());
        let asset = |reason: String| EnvironmentError::Asset { path: named(), reason };
        let (mut changed, mut error) = (false, None);
        for event in &events {
            match event {
                AssetEvent::Added { id: other } | AssetEvent::Modified { id: other }
                    if *other == id =>
                {
                    let now = assets.get(handle).map(|asset| &asset.spec);
                    changed |= now.is_some() && now != slot.spec.as_ref();
                }
                AssetEvent::Removed { id: other } | AssetEvent::Unused { id: other }
                    if *other == id =>
                {
                    error = Some(EnvironmentError::AssetGone(named()));
                }
                _ => {}
            }
        }
        if let Some(failure) = failures.iter().rev().find(|failure| failure.id == id) {
            error = Some(asset(failure.error.to_string()));
        } else if slot.waits()
            && let Some(LoadState::Failed(failure)) = server.get_load_state(id)
        {
            // Loading failed before the environment requested the asset.
            error = Some(asset(failure.to_string()));
        }
        if let Some(error) = error {
            slot.fail(error);
        }
        if changed {
            commands.trigger(RebuildEnvironment { entity });
        }
    }
}
