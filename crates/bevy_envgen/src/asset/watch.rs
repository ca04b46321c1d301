//! Rebuilds environments when the files of their specs change.

use bevy::asset::{AssetLoadError, AssetLoadFailedEvent, AssetPath, LoadState};
use bevy::prelude::*;

use super::file::{RoomAsset, RoomLoader, WorldAsset, WorldLoadError, WorldLoader};
use crate::environment::{Environment, EnvironmentError, RebuildEnvironment, WorldSource};
use crate::generate::request_worlds;
use crate::job::GenerationJob;
use crate::systems::{EnvgenSchedules, EnvgenSystems};

/// Adds the assets of `.envgen.ron` and `.room.ron` files, and rebuilds worlds when these files change.
///
/// Needs Bevy's `AssetPlugin`, which may be added before or after this plugin. Without it, environments whose
/// specs are in files fail. Files are watched if Bevy's feature `file_watcher` is on, which this crate's
/// feature of the same name enables.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnvgenAssetPlugin;

impl Plugin for EnvgenAssetPlugin {
    fn build(&self, app: &mut App) {
        register(app);
        let schedule = EnvgenSchedules::of(app).main;
        app.add_systems(
            schedule,
            (watch_assets.before(request_worlds), watch_rooms)
                .in_set(EnvgenSystems::Request)
                .run_if(resource_exists::<Assets<WorldAsset>>),
        );
    }

    fn finish(&self, app: &mut App) {
        register(app);
    }
}

/// Registers the assets and their loaders, once the app has an asset server.
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

/// Requests a rebuild of environments whose assets have changed, and lets those fail whose assets cannot be
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
                    // It may have been removed and added again in the same frame.
                    error = error.filter(|_| now.is_none());
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

/// A spec that could not be loaded because one of its rooms could not.
struct Unloaded {
    spec: AssetId<WorldAsset>,
    path: AssetPath<'static>,
    /// The handle is kept, so that Bevy loads the room when its file changes or appears.
    room: Handle<RoomAsset>,
}

/// Reloads specs that failed because of a room, once that room can be loaded. Bevy itself records the
/// dependencies of an asset only after the asset is loaded.
fn watch_rooms(
    mut failures: MessageReader<AssetLoadFailedEvent<WorldAsset>>,
    mut loads: MessageReader<AssetEvent<WorldAsset>>,
    mut changes: MessageReader<AssetEvent<RoomAsset>>,
    server: Res<AssetServer>,
    mut unloaded: Local<Vec<Unloaded>>,
) {
    // Failures are handled last, since a spec that fails in this frame has failed again.
    let loaded: Vec<_> = loads.read().filter_map(touched).collect();
    let changed: Vec<_> = changes.read().filter_map(touched).collect();
    unloaded.retain(|waiting| {
        let repaired = changed.contains(&waiting.room.id());
        if repaired {
            server.reload(&waiting.path);
        }
        !repaired && !loaded.contains(&waiting.spec) && server.is_managed(waiting.spec)
    });
    for failure in failures.read() {
        unloaded.retain(|waiting| waiting.spec != failure.id);
        if let Some(room) = missing_room(&failure.path, &failure.error) {
            let room = server.load(room);
            unloaded.push(Unloaded { spec: failure.id, path: failure.path.clone(), room });
        }
    }
}

/// Returns the asset that an event reports as added or modified.
fn touched<A: Asset>(event: &AssetEvent<A>) -> Option<AssetId<A>> {
    match event {
        AssetEvent::Added { id } | AssetEvent::Modified { id } => Some(*id),
        _ => None,
    }
}

/// Returns the room because of which a spec could not be loaded.
fn missing_room(spec: &AssetPath<'_>, error: &AssetLoadError) -> Option<AssetPath<'static>> {
    let AssetLoadError::AssetLoaderError(error) = error else { return None };
    match error.error().downcast_ref()? {
        WorldLoadError::RoomFile { path, .. } => spec.resolve_embed_str(path).ok(),
        _ => None,
    }
}
