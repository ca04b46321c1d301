//! Asking for a world, and what comes of it.

use std::sync::Arc;

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use envgen::glam::DVec2;
use envgen::world::Violation;
use envgen::{GenerateError, World, WorldKind, WorldSpec};
use thiserror::Error;

/// Asks for a world on this entity: a spec and a seed.
///
/// The parts are spawned below the entity, so that its [`Transform`] moves and turns them, and
/// [`EnvironmentReady`] or [`EnvironmentFailed`] is triggered on it and written as a message. Changing
/// the component, or the asset behind it, rebuilds the world; until the new one is ready the old one
/// stays. Removing the component, or despawning the entity, removes everything.
///
/// With the feature `serialize` a Bevy scene can hold it. The scene needs nothing of what it makes: the
/// other components of the entity and its tiles are made again where the scene is loaded, and so they
/// are for a clone of the entity.
///
/// Units are metres, x right and y up in the entity's frame. Scales other than 1 make all of it
/// larger or smaller; they must be positive and the same along x and y.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_envgen::prelude::*;
///
/// fn ask(mut commands: Commands) {
///     let spec = HallwaySpec { segments: 80, p_st: 0.2, ..default() };
///     commands.spawn(Environment::new(spec, 7)).observe(|ready: On<EnvironmentReady>| {
///         println!("{} is ready", ready.entity);
///     });
/// }
/// # let mut app = bevy_envgen::testing::test_app();
/// # bevy::ecs::system::RunSystemOnce::run_system_once(app.world_mut(), ask).unwrap();
/// # bevy_envgen::testing::step(&mut app, 2);
/// # assert!(app.world_mut().query::<&PartId>().iter(app.world()).count() > 20);
/// ```
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
#[require(EnvironmentState, Transform)]
pub struct Environment {
    /// What the world is made of.
    pub source: WorldSource,
    /// From which everything random follows. Worlds that exist already have no use for it.
    pub seed: u64,
    /// Whether the schedule waits for the generator.
    pub pace: GenerationMode,
    /// Whether the world has an end.
    pub extent: Extent,
    /// The point of the world, in metres, that lies at the entity's own origin. Single precision
    /// keeps a millimetre up to 8 km from it.
    pub origin: DVec2,
    /// Whether each wall, tree and obstacle is an entity.
    pub solids: SolidStorage,
}

/// What a world is made of.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(Debug, PartialEq, Clone)]
#[non_exhaustive]
pub enum WorldSource {
    /// A spec, which the seed makes a world of.
    Spec(SourceSpec),
    /// A spec in a file such as `hall.envgen.ron`.
    #[cfg(feature = "asset")]
    Asset(Handle<crate::asset::file::WorldAsset>),
    /// A world that exists already.
    World(SourceWorld),
}

/// A spec as a value that scenes can hold, by the serde of [`WorldSpec`].
#[derive(Clone, Debug, PartialEq, Deref, DerefMut, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(opaque)]
#[reflect(Debug, PartialEq, Clone)]
pub struct SourceSpec(pub Box<WorldSpec>);

/// A world as a value that scenes can hold, by the serde of [`World`].
#[derive(Clone, Debug, PartialEq, Deref, Reflect)]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(opaque)]
#[reflect(Debug, PartialEq, Clone)]
pub struct SourceWorld(pub Arc<World>);

#[cfg(feature = "serialize")]
impl serde::Serialize for SourceWorld {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        World::serialize(&self.0, serializer)
    }
}

#[cfg(feature = "serialize")]
impl<'de> serde::Deserialize<'de> for SourceWorld {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        World::deserialize(deserializer).map(|world| SourceWorld(Arc::new(world)))
    }
}

/// Whether the schedule waits for the generator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, PartialEq, Clone)]
pub enum GenerationMode {
    /// It waits for worlds that take about a frame or less, by the spec's own estimate, and does not
    /// for others.
    #[default]
    Auto,
    /// It waits: the world is there in the same frame.
    Blocking,
    /// It does not: the generator runs as a task of the pool for long computations.
    Async,
}

/// Whether a world has an end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Debug, PartialEq, Clone)]
pub enum Extent {
    /// It has.
    #[default]
    Finite,
    /// It has none. Only forests can be endless, and only around the anchor of a
    /// [`StreamAround`](crate::StreamAround).
    Endless {
        /// Side of a tile in metres. It is part of what the seed means: another side is another
        /// forest.
        tile: f64,
    },
}

/// How the parts that stop a robot and a ray are kept: walls, trees and obstacles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, PartialEq, Clone)]
pub enum SolidStorage {
    /// Each is an entity, with the component of its kind.
    #[default]
    Entities,
    /// They are data of their tile, its [`TileSolids`](crate::TileSolids), for static worlds of
    /// 100,000 parts and more: Bevy's systems look at every entity with a [`Transform`] in every
    /// frame, and at none of these. Their colliders are merged, whatever the settings say.
    TileData,
}

impl Environment {
    /// The world of a spec, such as a `HallwaySpec` or a [`WorldSpec`], and a seed.
    pub fn new(spec: impl Into<WorldSpec>, seed: u64) -> Self {
        Self::of(WorldSource::Spec(SourceSpec(Box::new(spec.into()))), seed)
    }

    /// The world of a spec in a file and a seed.
    #[cfg(feature = "asset")]
    pub fn from_asset(spec: Handle<crate::asset::file::WorldAsset>, seed: u64) -> Self {
        Self::of(WorldSource::Asset(spec), seed)
    }

    /// A world that exists already: composed, edited or read from a file.
    pub fn prebuilt(world: impl Into<Arc<World>>) -> Self {
        Self::of(WorldSource::World(SourceWorld(world.into())), 0)
    }

    fn of(source: WorldSource, seed: u64) -> Self {
        let (pace, extent, solids) =
            (GenerationMode::default(), Extent::default(), SolidStorage::default());
        Environment { source, seed, pace, extent, origin: DVec2::ZERO, solids }
    }

    /// The same without an end, in square tiles of `tile` metres: see [`Extent::Endless`].
    pub fn endless(self, tile: f64) -> Self {
        Environment { extent: Extent::Endless { tile }, ..self }
    }

    /// The same, with the schedule waiting for the generator or not.
    pub fn with_pace(self, pace: GenerationMode) -> Self {
        Environment { pace, ..self }
    }

    /// The same, with another point of the world at the entity's origin.
    pub fn with_origin(self, origin: DVec2) -> Self {
        Environment { origin, ..self }
    }

    /// The same, with walls, trees and obstacles as entities or as data of their tiles.
    pub fn with_solids(self, solids: SolidStorage) -> Self {
        Environment { solids, ..self }
    }

    /// How its parts are laid out.
    pub(crate) fn layout(&self) -> Layout {
        Layout { origin: self.origin, solids: self.solids }
    }
}

/// How the parts of an environment are laid out below it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout {
    pub(crate) origin: DVec2,
    pub(crate) solids: SolidStorage,
}

/// How far an environment has come.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub enum EnvironmentState {
    /// Nothing has been done yet, or its asset is not loaded.
    #[default]
    Waiting,
    /// The generator is at work.
    Generating,
    /// The first tiles around the anchor are being spawned.
    Streaming,
    /// The world stands.
    Ready,
    /// There is no world, or the one that was there before: see [`EnvironmentFailure`].
    Failed,
}

/// Why the world of an environment cannot be made, on its entity until the world is ready. Scenes do not
/// hold it.
#[derive(Component, Clone, Debug, PartialEq, Deref)]
#[component(clone_behavior = Ignore)]
pub struct EnvironmentFailure(pub EnvironmentError);

/// Triggered on an environment, and written as a message, when its world stands, at first and
/// after every change.
///
/// The [`GlobalTransform`]s of all that stands are right by then, also before Bevy propagates
/// transforms. Where the start and the goal are is in
/// [`EnvironmentLandmarks`](crate::EnvironmentLandmarks).
#[derive(EntityEvent, Message, Clone, Debug)]
pub struct EnvironmentReady {
    /// The environment.
    pub entity: Entity,
}

/// Triggered on an environment, and written as a message, when its world cannot be made. A world
/// that stood before stays. The error is also kept on the entity: see [`EnvironmentFailure`].
#[derive(EntityEvent, Message, Clone, Debug)]
pub struct EnvironmentFailed {
    /// The environment.
    pub entity: Entity,
    /// Why.
    pub error: EnvironmentError,
}

/// Trigger it on an environment to have its world made again, although nothing changed.
#[derive(EntityEvent, Clone, Debug)]
pub struct RebuildEnvironment {
    /// The environment.
    pub entity: Entity,
}

/// Why a world cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EnvironmentError {
    /// The spec asks for what is not allowed, or this seed has no world that keeps it.
    #[error(transparent)]
    Generate(#[from] GenerateError),
    /// A world that was given breaks an invariant.
    #[error("the world is broken: {0}")]
    Broken(#[from] Violation),
    /// The file of the spec could not be loaded.
    #[error("{path} cannot be loaded: {reason}")]
    Asset {
        /// The file.
        path: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The asset of the spec was removed.
    #[error("the asset {0} of the spec is gone")]
    AssetGone(String),
    /// There is no server for assets.
    #[error("the spec is an asset, but the app has no `AssetPlugin`")]
    NoAssets,
    /// The kind of world cannot be endless.
    #[error("a {0} cannot be endless, only a forest can")]
    NotEndless(WorldKind),
    /// A world that exists already cannot be endless.
    #[error("a world that exists already cannot be endless")]
    Existing,
    /// An endless world is not streamed.
    #[error("an endless world needs the component `StreamAround`")]
    NoAnchor,
    /// A number of the component [`StreamAround`](crate::StreamAround) is not allowed.
    #[error("`{field}` of `StreamAround` must be {allowed}, got {value}")]
    Stream {
        /// The field.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What would have been allowed.
        allowed: String,
    },
    /// The origin is not finite.
    #[error("the origin {0} is not finite")]
    Origin(DVec2),
    /// There are too many parts to be spawned at once.
    #[error("the world has {parts} parts, at most {limit} are spawned at once; add `StreamAround`")]
    TooMany {
        /// Parts of the world.
        parts: usize,
        /// The most that are allowed: [`MAX_PARTS`](crate::MAX_PARTS).
        limit: usize,
    },
    /// The transform of the entity, with those above it, cannot carry a flat world.
    #[error("the transform has {what} {value}, expected {allowed}")]
    Transform {
        /// Which of its parts.
        what: &'static str,
        /// Its value.
        value: Vec3,
        /// What would have been allowed.
        allowed: &'static str,
    },
}

/// The world that stands, on the entity of its [`Environment`]: exact geometry, certificate and
/// provenance. It is not reflected, so that scenes do not hold it: it is made again.
#[derive(Component, Clone, Debug, Deref)]
#[component(clone_behavior = Ignore)]
pub struct GroundTruth(pub Arc<World>);

/// The endless forest that is streamed, on the entity of its [`Environment`]. It is not reflected, so
/// that scenes do not hold it: it is made again.
#[derive(Component, Clone, Debug, Deref)]
#[component(clone_behavior = Ignore)]
pub struct EndlessTruth(pub Arc<envgen::forest::EndlessForest>);

/// How much there is of the world that stands, on the entity of its [`Environment`].
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct EnvironmentStats {
    /// Parts of the whole world; absent for an endless one.
    pub parts: Option<usize>,
    /// Parts that stop a robot and a ray, of the whole world; absent for an endless one.
    pub solids: Option<usize>,
}

pub(crate) fn register(app: &mut App) {
    app.register_type::<Environment>()
        .register_type::<EnvironmentState>()
        .register_type::<EnvironmentStats>()
        .add_message::<EnvironmentReady>()
        .add_message::<EnvironmentFailed>();
}
