//! Bevy plugins for the worlds of [`envgen`]: ask for a world with a component, and its parts are
//! entities with colliders; headless first.
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
//! # What is spawned
//!
//! ```text
//! Environment            GroundTruth (the exact world), EnvironmentState, EnvironmentStats,
//!                        EnvironmentLandmarks (its start and goal), EnvironmentFailure
//!   Tile                 with merged colliders and meshes, where asked; TileSolids
//!     Wall, Tree, ..     PartId, PartOf (its environment), Name, Transform, PartShape
//! ```
//!
//! Every part has a [`PartId`] that is the same for the same spec and seed. Its [`Transform`] is
//! where it lies in the environment's frame: metres, x right, y up; its [`GlobalTransform`] is right as
//! soon as it is spawned. The kinds are in [`part`].
//! Walls, trees and obstacles are data of their tile and not entities with [`SolidStorage::TileData`].
//!
//! # What is told
//!
//! | event of an observer | also as | about |
//! |---|---|---|
//! | [`EnvironmentReady`], [`EnvironmentFailed`] | messages; [`EnvironmentState`], [`EnvironmentFailure`] | an environment |
//! | [`TileSpawned`] | `Added<Tile>` | each tile, as it is spawned |
//! | `DoorStopped` | a message | a door |
//!
//! # Plugins
//!
//! [`EnvgenPlugins`] adds them all; each can be left out.
//!
//! | plugin | feature | adds |
//! |---|---|---|
//! | [`EnvgenCorePlugin`] | | generation, spawning, streaming |
//! | `EnvgenAssetPlugin` | `asset` | `.envgen.ron` and `.room.ron` files |
//! | `EnvgenPhysicsPlugin` | `physics` | rapier colliders, doors that move |
//! | `EnvgenVisualsPlugin` | `render` | meshes and colours |
//! | `RobotPlugin` | `trial` | not of the group: robots that drive and sense in rapier |
//! | `TrialPlugin` | `trial` | not of the group: mapping trials, with `RobotPlugin` |
//! | `TrialViewPlugin` | `render`, `trial` | not of the group: how mapping trials look |
//! | [`EnvgenDiagnosticsPlugin`] | | not of the group: numbers of parts and tiles, time of generation and streaming, as Bevy's diagnostics |
//! | `EnvgenDebugPlugin` | `debug` | not of the group: lines over colliders, rays, frontiers, plans, rooms |
//! | `TopDownPhysicsPlugin` | `physics` | not of the group: rapier itself, without gravity, in fixed steps |
//!
//! # System sets
//!
//! All in the schedule of [`EnvgenPlugins::in_schedule`], `Update` by default, in the order of
//! [`EnvgenSystems`]: `Request`, `Collect`, `Spawn`, `Stream`, `Notify`. Transforms are watched in
//! `PostUpdate`; doors move in `DoorSystems`, in `FixedUpdate` by default. There robots and trials go
//! around rapier: `TrialSystems::Command`, `RobotSystems::Drive`, rapier's `PhysicsSet`,
//! `RobotSystems::Sense`, `TrialSystems::Record`.
//!
//! # Features
//!
//! | feature | default | what it adds |
//! |---|---|---|
//! | `asset` | yes | specs and rooms as Bevy assets |
//! | `multi_threaded` | yes | generation on other threads than the schedule's |
//! | `physics` | yes | colliders and doors, by `bevy_rapier2d` |
//! | `file_watcher` | no | files that change are loaded again |
//! | `render` | no | meshes; with the features that build on it the only one with rendering crates |
//! | `capture` | no | pictures and films of cameras, with or without a window |
//! | `debug` | no | lines over colliders, rays, frontiers, plans and the graph of rooms |
//! | `trial` | no | robots in rapier, and mapping trials with them, by `mapping_trial` |
//! | `egui` | no | panels for specs, trials, scores and the operator's form |
//! | `serialize` | no | environments in Bevy's scenes; serde for the components of parts |
//! | `testing` | no | `testing`, helpers for the tests of apps |

#[cfg(feature = "asset")]
pub mod asset;
#[cfg(feature = "capture")]
pub mod capture;
#[cfg(feature = "debug")]
pub mod debug;
mod diagnostics;
mod environment;
mod generate;
mod job;
mod landmarks;
pub mod part;
#[cfg(feature = "physics")]
pub mod physics;
mod place;
mod plan;
#[cfg(feature = "trial")]
pub mod robot;
mod shape;
mod spawn;
mod streaming;
#[cfg(any(feature = "physics", feature = "render"))]
mod tessellate;
#[cfg(feature = "testing")]
pub mod testing;
#[cfg(feature = "trial")]
pub mod trial;
#[cfg(feature = "egui")]
pub mod ui;
#[cfg(all(feature = "render", feature = "trial"))]
pub mod view;
#[cfg(feature = "render")]
pub mod visuals;

use bevy::app::PluginGroupBuilder;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

#[cfg(feature = "physics")]
pub use bevy_rapier2d;
pub use envgen;
#[cfg(feature = "trial")]
pub use mapping_trial;

pub use diagnostics::EnvgenDiagnosticsPlugin;
pub use environment::{
    EndlessTruth, Environment, EnvironmentError, EnvironmentFailed, EnvironmentFailure,
    EnvironmentReady, EnvironmentState, EnvironmentStats, Extent, GenerationMode, GroundTruth,
    RebuildEnvironment, SolidStorage, SourceSpec, SourceWorld, WorldSource,
};
pub use generate::MAX_PARTS;
pub use landmarks::{EnvironmentLandmarks, Landmark};
pub use part::{PartId, PartKind, PartOf};
pub use shape::PartShape;
pub use spawn::{SolidPart, Tile, TileSolids, TileSpawned};
pub use streaming::{StreamAround, StreamingBudget, StreamingReport};

/// What most apps need, the specs of [`envgen`] among it. What has a name that an app may have itself,
/// such as [`part::Start`] or [`Tile`], is not.
pub mod prelude {
    #[cfg(feature = "asset")]
    pub use crate::asset::{EnvgenAssetPlugin, RoomAsset};
    pub use crate::part::{
        Doorway, Obstacle, ObstacleKind, PartId, PartKind, PartOf, RoadStrip, Room, SurfaceKind,
        Tree, Victim, Wall, WallKind,
    };
    #[cfg(feature = "physics")]
    pub use crate::physics::{
        ColliderSettings, Door, DoorSchedule, DoorStopped, EnvgenPhysicsPlugin,
        EnvironmentColliders, TopDownPhysicsPlugin,
    };
    #[cfg(feature = "trial")]
    pub use crate::robot::{
        Battery, Bumper, Chassis, DriveCommand, LaserScan, LaserScanner, RobotModel, RobotPlugin,
        RobotSystems, TruePose, WheelOdometry,
    };
    #[cfg(feature = "trial")]
    pub use crate::trial::{
        ManualControl, MappingTrial, TrialEnded, TrialFailed, TrialPlugin, TrialRobot,
        TrialStarted, TrialSystems,
    };
    #[cfg(feature = "render")]
    pub use crate::visuals::EnvgenVisualsPlugin;
    pub use crate::{
        EnvgenCorePlugin, EnvgenDiagnosticsPlugin, EnvgenPlugins, EnvgenSystems, Environment,
        EnvironmentError, EnvironmentFailed, EnvironmentFailure, EnvironmentLandmarks,
        EnvironmentReady, EnvironmentState, EnvironmentStats, Extent, GenerationMode, GroundTruth,
        Landmark, PartShape, RebuildEnvironment, SolidStorage, StreamAround, StreamingBudget,
        TileSolids, TileSpawned,
    };
    pub use envgen::WorldSpec;
    pub use envgen::forest::ForestSpec;
    pub use envgen::hallway::HallwaySpec;
    pub use envgen::indoor::IndoorSpec;
    pub use envgen::landscape::LandscapeSpec;
    pub use envgen::road::RoadSpec;
}

/// The systems that turn requests into entities, in this order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EnvgenSystems {
    /// Environments that changed are noticed, and their generators started.
    Request,
    /// Worlds that other threads have finished are taken.
    Collect,
    /// What stood before is despawned, and the new parts spawned with all that other plugins add.
    Spawn,
    /// The tiles of streamed worlds follow their anchors.
    Stream,
    /// [`EnvironmentReady`] and [`EnvironmentFailed`] are triggered and written.
    Notify,
}

/// Generates and spawns worlds, and streams them.
///
/// Adds the resources [`StreamingBudget`] and [`StreamingReport`] and the systems of
/// [`EnvgenSystems`].
#[derive(Clone, Copy, Debug)]
pub struct EnvgenCorePlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl EnvgenCorePlugin {
    /// With the systems in another schedule than `Update`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        EnvgenCorePlugin { schedule: schedule.intern() }
    }
}

impl Default for EnvgenCorePlugin {
    fn default() -> Self {
        EnvgenCorePlugin::new(Update)
    }
}

/// Where the core plugin put its systems, for the plugins after it.
#[derive(Resource, Clone, Copy)]
struct Schedules {
    main: Interned<dyn ScheduleLabel>,
}

impl Schedules {
    fn of(app: &App) -> Self {
        let known = app.world().get_resource::<Schedules>().copied();
        known.unwrap_or(Schedules { main: Update.intern() })
    }
}

impl Plugin for EnvgenCorePlugin {
    fn build(&self, app: &mut App) {
        part::register(app);
        environment::register(app);
        landmarks::register(app);
        app.register_type::<Tile>()
            .register_type::<TileSolids>()
            .register_type::<StreamAround>()
            .register_type::<StreamingBudget>()
            .register_type::<StreamingReport>()
            .init_resource::<StreamingBudget>()
            .init_resource::<StreamingReport>()
            .init_resource::<job::PendingEvents>()
            .register_required_components::<Environment, job::GenerationJob>()
            .insert_resource(Schedules { main: self.schedule })
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
                ),
            )
            .add_systems(
                PostUpdate,
                (generate::watch_transforms, landmarks::follow_environments)
                    .after(TransformSystems::Propagate),
            );
    }
}

/// All plugins of this crate but `TopDownPhysicsPlugin`, which sets rapier itself up.
#[derive(Clone, Debug, Default)]
pub struct EnvgenPlugins {
    core: EnvgenCorePlugin,
    #[cfg(feature = "physics")]
    physics: physics::EnvgenPhysicsPlugin,
}

impl EnvgenPlugins {
    /// With the systems that make worlds in another schedule than `Update`.
    pub fn in_schedule(mut self, schedule: impl ScheduleLabel) -> Self {
        self.core = EnvgenCorePlugin::new(schedule);
        self
    }

    /// With other colliders than the default ones.
    #[cfg(feature = "physics")]
    pub fn with_colliders(mut self, colliders: physics::ColliderSettings) -> Self {
        self.physics = self.physics.with_colliders(colliders);
        self
    }
}

impl PluginGroup for EnvgenPlugins {
    fn build(self) -> PluginGroupBuilder {
        let group = PluginGroupBuilder::start::<Self>().add(self.core);
        #[cfg(feature = "asset")]
        let group = group.add(asset::EnvgenAssetPlugin);
        #[cfg(feature = "physics")]
        let group = group.add(self.physics);
        #[cfg(feature = "render")]
        let group = group.add(visuals::EnvgenVisualsPlugin::default());
        group
    }
}
