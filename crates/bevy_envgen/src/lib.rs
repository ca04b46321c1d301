//! Bevy plugins for the worlds of [`envgen`]. A component requests a world, and the parts of the world are
//! spawned as entities with colliders. No window or renderer is needed.
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_envgen::prelude::*;
//!
//! let mut app = App::new();
//! app.add_plugins((MinimalPlugins, TransformPlugin));
//! # #[cfg(feature = "physics")]
//! app.add_plugins(TopDownPhysicsPlugin::default());
//! app.add_plugins(EnvgenPlugins::default());
//! app.world_mut().spawn(Environment::new(ForestSpec::default(), 1));
//! app.update();
//! let trees = app.world_mut().query::<&Tree>().iter(app.world()).count();
//! assert!(trees > 100);
//! ```
//!
//! The crate `bevy_mapping_trial` adds robots and mapping trials to these worlds, and the crate
//! `bevy_offscreen` takes pictures and films without a window.
//!
//! # What is spawned
//!
//! ```text
//! Environment            GroundTruth (the exact world), EnvironmentState, EnvironmentStats,
//!                        EnvironmentLandmarks (its start and goal), EnvironmentFailure,
//!                        EnvironmentDifficulty (where ComputeDifficulty requests it)
//!   Tile                 with merged colliders and meshes, where asked; TileSolids
//!     Wall, Tree, ..     PartId, PartOf (its environment), Name, Transform, PartShape,
//!                        HeightRange
//! ```
//!
//! Every part has a [`PartId`], which is always the same for the same spec and seed. Its [`Transform`] is its
//! pose in the frame of the environment, in metres with x to the right and y up. Its [`GlobalTransform`] is
//! correct as soon as the part is spawned. The components of the kinds of parts are in [`part`]. With
//! [`SolidStorage::TileData`], walls, trees and obstacles are data of their tile, not entities.
//!
//! # Events
//!
//! | event for observers | also as | reported for |
//! |---|---|---|
//! | [`EnvironmentReady`], [`EnvironmentFailed`] | messages; [`EnvironmentState`], [`EnvironmentFailure`] | an environment |
//! | [`DifficultyComputed`] | a message; [`EnvironmentDifficulty`], [`DifficultyFailure`] | an environment with [`ComputeDifficulty`] |
//! | [`TileSpawned`] | `Added<Tile>` | each tile, as it is spawned |
//! | [`ScenarioStarted`], [`ScenarioFailed`] | messages; [`ScenarioRun`], [`ScenarioFailure`] | an environment with an [`EnvironmentScenario`] |
//! | [`DoorChanged`], [`PersonReacted`], `PersonCollision` | messages | a [`Door`], a [`Person`] |
//!
//! # Plugins
//!
//! The plugin group [`EnvgenPlugins`] adds these plugins, unless the table says otherwise. Each can be
//! disabled.
//!
//! | plugin | feature | adds |
//! |---|---|---|
//! | [`EnvgenCorePlugin`] | | generation, spawning, streaming |
//! | `EnvgenAssetPlugin` | `asset` | `.envgen.ron` and `.room.ron` files |
//! | [`EnvgenScenarioPlugin`] | | doors, people and smoke that move |
//! | `EnvgenPhysicsPlugin` | `physics` | rapier colliders |
//! | `EnvgenVisualsPlugin` | `render` | meshes and colours |
//! | `EnvgenVisuals3dPlugin` | `render3d` | not in the group: worlds in three dimensions, with light and sky |
//! | [`EnvgenDiagnosticsPlugin`] | | not in the group: counts of parts and tiles, times of generation and streaming, as Bevy's diagnostics |
//! | `EnvgenDebugPlugin` | `debug` | not in the group: lines over colliders and the graph of rooms |
//! | `TopDownPhysicsPlugin` | `physics` | not in the group: rapier itself, without gravity, in fixed steps |
//!
//! # System sets
//!
//! All systems are in the schedule of [`EnvgenPlugins::in_schedule`], which is `Update` by default, in the
//! order of the sets of [`EnvgenSystems`]: `Request`, `Collect`, `Spawn`, `Stream`, `Notify`. If that is the
//! schedule of rapier or of scenarios, rapier and scenarios run after `Notify`. So do difficulties. Changes of
//! transforms are detected in `PostUpdate`. Doors, people and smoke move in [`ScenarioSystems`], which is in
//! `FixedUpdate` by default, after rapier's `PhysicsSet::Writeback`.
//!
//! # Features
//!
//! | feature | default | what it adds |
//! |---|---|---|
//! | `asset` | yes | specs and rooms as Bevy assets |
//! | `multi_threaded` | yes | generation on background threads |
//! | `physics` | yes | colliders, with `bevy_rapier2d` |
//! | `file_watcher` | no | reloads files that change |
//! | `render` | no | meshes; only this feature and those that include it need rendering crates |
//! | `render3d` | no | meshes with height, materials, light, smoke |
//! | `debug` | no | lines over colliders and the graph of rooms |
//! | `serialize` | no | environments in Bevy's scenes; serde for the components of parts |
//! | `testing` | no | `testing`, helpers for testing apps |

#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "asset")]
pub mod asset;
#[cfg(feature = "debug")]
pub mod debug;
mod diagnostics;
mod difficulty;
mod environment;
mod generate;
mod height;
mod job;
mod landmarks;
mod one_thread;
#[cfg(any(feature = "physics", feature = "render3d"))]
mod overhead;
pub mod part;
#[cfg(feature = "physics")]
pub mod physics;
mod place;
mod plan;
mod require;
pub mod scenario;
mod shape;
mod spawn;
mod streaming;
mod systems;
#[cfg(any(feature = "physics", feature = "render"))]
mod tessellate;
#[cfg(feature = "testing")]
pub mod testing;
#[cfg(feature = "render")]
pub mod visuals;
#[cfg(feature = "render3d")]
pub mod visuals3d;

use bevy::app::PluginGroupBuilder;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

#[cfg(feature = "physics")]
pub use bevy_rapier2d;
pub use envgen;

pub use diagnostics::EnvgenDiagnosticsPlugin;
pub use difficulty::{
    ComputeDifficulty, DifficultyComputed, DifficultyFailure, EnvironmentDifficulty, PlatformValue,
};
pub use environment::{
    EndlessTruth, Environment, EnvironmentError, EnvironmentExtent, EnvironmentFailed,
    EnvironmentFailure, EnvironmentReady, EnvironmentState, EnvironmentStats, GenerationMode,
    GroundTruth, RebuildEnvironment, SolidStorage, SourceSpec, SourceWorld, SpawnedOrigin,
    WorldSource,
};
pub use generate::MAX_PARTS;
pub use height::HeightRange;
pub use landmarks::{EnvironmentLandmarks, Landmark};
pub use one_thread::run_on_one_thread;
pub use part::{PartId, PartKind, PartOf};
pub use require::require_component;
pub use scenario::{
    Door, DoorChanged, EnvgenScenarioPlugin, EnvironmentScenario, Person, PersonReacted,
    ScenarioFailed, ScenarioFailure, ScenarioRun, ScenarioStarted, ScenarioSystems,
};
pub use shape::PartShape;
pub use spawn::{SolidPart, Tile, TileSolids, TileSpawned};
pub use streaming::{StreamAround, StreamingBudget, StreamingReport};
pub use systems::EnvgenSystems;

use systems::EnvgenSchedules;

/// The items that most apps need, including the specs of [`envgen`]. It leaves out items whose names may
/// clash with those of an app or of Bevy, such as [`part::Start`] or [`Tile`].
pub mod prelude {
    #[cfg(feature = "asset")]
    pub use crate::asset::{EnvgenAssetPlugin, RoomAsset};
    pub use crate::part::{
        Doorway, Obstacle, ObstacleKind, PartId, PartKind, PartOf, RoadStrip, Room, SurfaceKind,
        Tree, Victim, Wall, WallKind,
    };
    #[cfg(feature = "physics")]
    pub use crate::physics::{
        ColliderSettings, EnvgenPhysicsPlugin, EnvironmentColliders, PersonCollision,
        TopDownPhysicsPlugin,
    };
    pub use crate::scenario::{
        Door, DoorChange, DoorChanged, DoorControl, DoorLeaf, EnvgenScenarioPlugin,
        EnvironmentScenario, Person, PersonReacted, RestartScenario, ScenarioAgent, ScenarioFailed,
        ScenarioFailure, ScenarioRun, ScenarioSpec, ScenarioStarted, ScenarioSystems, Smoke,
    };
    #[cfg(feature = "render")]
    pub use crate::visuals::EnvgenVisualsPlugin;
    #[cfg(feature = "render3d")]
    pub use crate::visuals3d::{EnvgenVisuals3dPlugin, Visuals3dSettings};
    pub use crate::{
        ComputeDifficulty, DifficultyComputed, DifficultyFailure, EnvgenCorePlugin,
        EnvgenDiagnosticsPlugin, EnvgenPlugins, EnvgenSystems, Environment, EnvironmentDifficulty,
        EnvironmentError, EnvironmentExtent, EnvironmentFailed, EnvironmentFailure,
        EnvironmentLandmarks, EnvironmentReady, EnvironmentState, EnvironmentStats, GenerationMode,
        GroundTruth, HeightRange, Landmark, PartShape, RebuildEnvironment, SolidStorage,
        StreamAround, StreamingBudget, TileSolids, TileSpawned,
    };
    pub use envgen::WorldSpec;
    pub use envgen::cellular::CellularSpec;
    pub use envgen::forest::ForestSpec;
    pub use envgen::hallway::HallwaySpec;
    pub use envgen::indoor::IndoorSpec;
    pub use envgen::landscape::LandscapeSpec;
    pub use envgen::road::RoadSpec;
}

/// The doctests of the README.
#[cfg(all(doctest, feature = "physics"))]
#[doc = include_str!("../README.md")]
struct Readme;

/// Generates, spawns and streams worlds.
///
/// Adds the resources [`StreamingBudget`] and [`StreamingReport`], and the systems of [`EnvgenSystems`].
#[derive(Clone, Copy, Debug)]
pub struct EnvgenCorePlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl EnvgenCorePlugin {
    /// Creates the plugin with its systems in `schedule` instead of `Update`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        EnvgenCorePlugin { schedule: schedule.intern() }
    }
}

impl Default for EnvgenCorePlugin {
    fn default() -> Self {
        EnvgenCorePlugin::new(Update)
    }
}

impl Plugin for EnvgenCorePlugin {
    fn build(&self, app: &mut App) {
        part::register(app);
        environment::register(app);
        difficulty::register(app);
        landmarks::register(app);
        app.register_type::<Tile>()
            .register_type::<TileSolids>()
            .register_type::<StreamAround>()
            .register_type::<StreamingBudget>()
            .register_type::<StreamingReport>()
            .init_resource::<StreamingBudget>()
            .init_resource::<StreamingReport>()
            .init_resource::<job::PendingEvents>()
            .insert_resource(EnvgenSchedules { main: self.schedule })
            .add_observer(generate::clean_up)
            .add_observer(generate::rebuild)
            .configure_sets(
                self.schedule,
                (
                    EnvgenSystems::Request,
                    EnvgenSystems::Collect,
                    EnvgenSystems::Spawn,
                    EnvgenSystems::Stream,
                    EnvgenSystems::Notify,
                )
                    .chain(),
            )
            .add_systems(
                self.schedule,
                (
                    generate::request_worlds.in_set(EnvgenSystems::Request),
                    generate::poll_tasks.in_set(EnvgenSystems::Collect),
                    generate::spawn_worlds.in_set(EnvgenSystems::Spawn),
                    streaming::stream_tiles.in_set(EnvgenSystems::Stream),
                    generate::notify.in_set(EnvgenSystems::Notify),
                    (difficulty::request, difficulty::collect).chain().after(EnvgenSystems::Notify),
                ),
            )
            .add_systems(
                PostUpdate,
                (generate::watch_transforms, landmarks::follow_environments)
                    .after(TransformSystems::Propagate),
            );
        #[cfg(any(feature = "physics", feature = "render3d"))]
        app.add_observer(overhead::forget_overhead);
        require_component::<Environment, job::GenerationJob>(app);
    }
}

/// A plugin group for worlds, which adds generation and scenarios, and assets, colliders and meshes if their
/// features are on. It does not add rapier itself, which `TopDownPhysicsPlugin` does.
#[derive(Clone, Debug, Default)]
pub struct EnvgenPlugins {
    core: EnvgenCorePlugin,
    scenario: scenario::EnvgenScenarioPlugin,
    #[cfg(feature = "physics")]
    physics: physics::EnvgenPhysicsPlugin,
}

impl EnvgenPlugins {
    /// Adds the systems that generate and spawn worlds to `schedule` instead of `Update`.
    pub fn in_schedule(mut self, schedule: impl ScheduleLabel) -> Self {
        self.core = EnvgenCorePlugin::new(schedule);
        self
    }

    /// Inserts `colliders` as the settings of colliders, replacing those that the app already has.
    #[cfg(feature = "physics")]
    pub fn with_colliders(mut self, colliders: physics::ColliderSettings) -> Self {
        self.physics = self.physics.with_colliders(colliders);
        self
    }
}

impl PluginGroup for EnvgenPlugins {
    fn build(self) -> PluginGroupBuilder {
        let group = PluginGroupBuilder::start::<Self>().add(self.core).add(self.scenario);
        #[cfg(feature = "asset")]
        let group = group.add(asset::EnvgenAssetPlugin);
        #[cfg(feature = "physics")]
        let group = group.add(self.physics);
        #[cfg(feature = "render")]
        let group = group.add(visuals::EnvgenVisualsPlugin::default());
        group
    }
}
