//! The component that requests a world, and the components and events with its result.

use std::sync::Arc;

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use envgen::geometry::{Rect as WorldRect, Shape};
use envgen::glam::DVec2;
use envgen::world::Violation;
use envgen::{GenerateError, World, WorldKind, WorldSpec};
use thiserror::Error;

/// A component that requests a world on its entity, from a spec and a seed.
///
/// The parts are spawned as descendants of the entity, so that its [`Transform`] moves and rotates them. Then
/// [`EnvironmentReady`] or [`EnvironmentFailed`] is triggered on the entity and written as a message.
/// Changing this component, or the asset that it refers to, rebuilds the world. The old world is kept until
/// the new one is generated; the tiles of a streamed world are then spawned over several frames. Removing this
/// component, or despawning the entity, removes everything.
///
/// With the feature `serialize` a Bevy scene can hold this component. The scene need not hold the other
/// components of the entity, or its tiles: they are rebuilt when the scene is spawned, and also when the
/// entity is cloned.
///
/// The world is in metres, with x to the right and y up in the frame of the entity. A scale other than 1
/// scales the whole world, except for the heights that decide which bodies and lasers a part stops; see
/// [`HeightRange`](crate::HeightRange). The scale must be positive, and the same along x and y.
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
    /// The source of the world: a spec, a file with a spec, or a finished world.
    pub source: WorldSource,
    /// The seed of everything random. It is not used for a world that already exists.
    pub seed: u64,
    /// Whether generation blocks the schedule or runs in a background task.
    pub pace: GenerationMode,
    /// Whether the world is finite or endless.
    pub extent: EnvironmentExtent,
    /// The point of the world, in metres, that is placed at the origin of the entity. Single precision
    /// resolves a millimetre up to 8 km from this point.
    pub origin: DVec2,
    /// Whether each wall, tree and obstacle is an entity of its own.
    pub solids: SolidStorage,
}

/// The source of a world.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(Debug, PartialEq, Clone)]
#[non_exhaustive]
pub enum WorldSource {
    /// A spec, from which the world is generated with the seed.
    Spec(SourceSpec),
    /// A spec in a file such as `hall.envgen.ron`.
    #[cfg(feature = "asset")]
    Asset(Handle<crate::asset::file::WorldAsset>),
    /// A world that already exists.
    World(SourceWorld),
}

/// A spec as a value of a component. Scenes serialize it as [`WorldSpec`].
#[derive(Clone, Debug, PartialEq, Deref, DerefMut, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(opaque)]
#[reflect(Debug, PartialEq, Clone)]
pub struct SourceSpec(pub Box<WorldSpec>);

/// A world as a value of a component. Scenes serialize it as [`World`].
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

/// Whether generation blocks the schedule or runs in a background task.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, PartialEq, Clone)]
pub enum GenerationMode {
    /// Blocks for worlds that take about a frame or less, as estimated from the spec, and runs in the
    /// background for all others.
    #[default]
    Auto,
    /// Blocks the schedule, so that the world is ready in the same frame.
    Blocking,
    /// Runs as a task of Bevy's `AsyncComputeTaskPool`.
    Async,
}

/// Whether a world is finite or endless.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Debug, PartialEq, Clone)]
pub enum EnvironmentExtent {
    /// The world is finite.
    #[default]
    Finite,
    /// The world is endless. Only forests can be endless, and only with a
    /// [`StreamAround`](crate::StreamAround), around whose anchor they are spawned.
    Endless {
        /// The side of a tile in metres. It is part of the definition of the world: with the same seed,
        /// another side gives another forest.
        tile: f64,
    },
}

/// How solid parts (walls, trees and obstacles) are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, PartialEq, Clone)]
pub enum SolidStorage {
    /// Each solid part is an entity with the component of its kind.
    #[default]
    Entities,
    /// Solid parts are data of their tile, in the component [`TileSolids`](crate::TileSolids). This is for
    /// static worlds with 100,000 parts and more, since Bevy visits every entity with a [`Transform`] in
    /// every frame. The colliders of these parts are always merged.
    TileData,
}

impl Environment {
    /// Creates a request for the world of a spec, such as a `HallwaySpec` or a [`WorldSpec`], and a seed.
    pub fn new(spec: impl Into<WorldSpec>, seed: u64) -> Self {
        Self::of(WorldSource::Spec(SourceSpec(Box::new(spec.into()))), seed)
    }

    /// Creates a request for the world of a spec in a file, and a seed.
    #[cfg(feature = "asset")]
    pub fn from_asset(spec: Handle<crate::asset::file::WorldAsset>, seed: u64) -> Self {
        Self::of(WorldSource::Asset(spec), seed)
    }

    /// Creates a request for a world that already exists, such as one that was composed, edited or read from
    /// a file.
    pub fn prebuilt(world: impl Into<Arc<World>>) -> Self {
        Self::of(WorldSource::World(SourceWorld(world.into())), 0)
    }

    fn of(source: WorldSource, seed: u64) -> Self {
        let (pace, extent, solids) =
            (GenerationMode::default(), EnvironmentExtent::default(), SolidStorage::default());
        Environment { source, seed, pace, extent, origin: DVec2::ZERO, solids }
    }

    /// Makes the world endless, in square tiles of `tile` metres; see [`EnvironmentExtent::Endless`].
    pub fn endless(self, tile: f64) -> Self {
        Environment { extent: EnvironmentExtent::Endless { tile }, ..self }
    }

    /// Sets the generation mode.
    pub fn with_pace(self, pace: GenerationMode) -> Self {
        Environment { pace, ..self }
    }

    /// Sets the point of the world that is placed at the origin of the entity.
    pub fn with_origin(self, origin: DVec2) -> Self {
        Environment { origin, ..self }
    }

    /// Sets the origin to the centre of a world that extends farther than 8 km from zero, beyond which single
    /// precision does not resolve millimetres, and to zero for all other worlds.
    pub fn with_origin_near(self, world: &World) -> Self {
        const FAR: f64 = 8192.0;
        let WorldRect { min, max } = world.bounds;
        let is_near = min.abs().max(max.abs()).max_element() <= FAR;
        let origin = if is_near { DVec2::ZERO } else { world.bounds.center().floor() };
        self.with_origin(origin)
    }

    /// Sets whether walls, trees and obstacles are entities or data of their tiles.
    pub fn with_solids(self, solids: SolidStorage) -> Self {
        Environment { solids, ..self }
    }

    /// Converts a point of the world in metres to global coordinates of the app. `frame` is the
    /// [`GlobalTransform`] of the entity.
    pub fn point_in_app(&self, frame: &GlobalTransform, point: DVec2) -> Vec2 {
        SpawnedOrigin(self.origin).point_in_app(frame, point)
    }

    /// Returns the smallest axis-aligned rectangle, in global coordinates of the app, around an area of the
    /// world. For the bounds of the [`GroundTruth`], this is what a camera must show to make the whole world
    /// visible.
    pub fn area_in_app(&self, frame: &GlobalTransform, area: WorldRect) -> Rect {
        let corners = Shape::from_rect(area).corners();
        let mut corners = corners.into_iter().map(|corner| self.point_in_app(frame, corner));
        let first = corners.next().unwrap_or_default();
        corners.fold(Rect::from_corners(first, first), |area, p| area.union_point(p))
    }

    /// Returns how the parts are laid out.
    pub(crate) fn layout(&self) -> TileLayout {
        TileLayout { origin: self.origin, solids: self.solids }
    }
}

/// How the parts of an environment are laid out below its entity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TileLayout {
    pub(crate) origin: DVec2,
    pub(crate) solids: SolidStorage,
}

/// A component with the state of an environment's world.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub enum EnvironmentState {
    /// Generation has not started, or the asset is not loaded yet.
    #[default]
    Waiting,
    /// The generator is running.
    Generating,
    /// The tiles around the anchor are being spawned: the first ones, or others after the anchor has moved to
    /// where no tile is spawned yet.
    Streaming,
    /// All parts are spawned. In a streamed world all tiles around the anchor were spawned, and the nearest one
    /// still is; farther tiles follow the anchor.
    Ready,
    /// Generation failed; see [`EnvironmentFailure`]. The previous world, if any, is kept, except if the
    /// transform is not allowed ([`EnvironmentError::Transform`]).
    Failed,
}

/// A component with the reason why the world of an environment could not be made. It is on the entity of the
/// environment until a world is ready. Scenes do not hold it.
#[derive(Component, Clone, Debug, PartialEq, Deref)]
#[component(clone_behavior = Ignore)]
pub struct EnvironmentFailure(pub EnvironmentError);

/// An event that is triggered on an environment, and written as a message, when its world is ready: once at
/// first, and again after every change.
///
/// The [`GlobalTransform`]s of all spawned parts are already correct at that time, before Bevy propagates
/// transforms. [`EnvironmentLandmarks`](crate::EnvironmentLandmarks) has the poses of the start and the goal.
#[derive(EntityEvent, Message, Clone, Debug)]
pub struct EnvironmentReady {
    /// The environment.
    pub entity: Entity,
}

/// An event that is triggered on an environment, and written as a message, when its world cannot be made. The
/// previous world, if any, is kept, except if the transform of the environment is not allowed
/// ([`EnvironmentError::Transform`]): then there is no world until it is, and then the one that the component
/// requests at that time. The error is also stored on the entity; see [`EnvironmentFailure`].
#[derive(EntityEvent, Message, Clone, Debug)]
pub struct EnvironmentFailed {
    /// The environment.
    pub entity: Entity,
    /// The error.
    pub error: EnvironmentError,
}

/// An event that rebuilds the world of the environment on which it is triggered, even if nothing has changed.
#[derive(EntityEvent, Clone, Debug)]
pub struct RebuildEnvironment {
    /// The environment.
    pub entity: Entity,
}

/// An error that prevents the world of an environment.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EnvironmentError {
    /// The spec is invalid, or no world of this seed satisfies it.
    #[error(transparent)]
    Generate(#[from] GenerateError),
    /// The given world violates an invariant.
    #[error("the world is invalid: {0}")]
    Broken(#[from] Violation),
    /// The file of the spec could not be loaded.
    #[error("{path} cannot be loaded: {reason}")]
    Asset {
        /// The path of the file.
        path: String,
        /// The reason why it cannot be loaded.
        reason: String,
    },
    /// The asset of the spec was removed.
    #[error("the asset {0} of the spec was removed")]
    AssetGone(String),
    /// The app has no asset server.
    #[error("the spec is an asset, but the app has no `AssetPlugin`")]
    NoAssets,
    /// The kind of world cannot be endless.
    #[error("a world of kind `{0}` cannot be endless, only one of kind `forest` can")]
    NotEndless(WorldKind),
    /// A world that already exists cannot be endless.
    #[error("a world that exists already cannot be endless")]
    Existing,
    /// An endless world is not streamed: its entity has no `StreamAround`.
    #[error("an endless world needs the component `StreamAround`")]
    NoAnchor,
    /// A field of the component [`StreamAround`](crate::StreamAround) is out of range.
    #[error("`{field}` of `StreamAround` must be {allowed}, got {value}")]
    Stream {
        /// The name of the field.
        field: &'static str,
        /// The value of the field.
        value: f64,
        /// The allowed range.
        allowed: String,
    },
    /// The origin is not finite.
    #[error("the origin must be finite, got {0}")]
    Origin(DVec2),
    /// There are too many parts to spawn at once.
    #[error(
        "the world has {parts} parts, but at most {limit} can be spawned at once; add `StreamAround`"
    )]
    TooMany {
        /// The number of parts of the world.
        parts: usize,
        /// The largest allowed number: [`MAX_PARTS`](crate::MAX_PARTS).
        limit: usize,
    },
    /// The global transform of the entity does not keep the world flat.
    #[error("the {what} of the transform must be {allowed}, got {value}")]
    Transform {
        /// The property of the transform, such as `scale`.
        what: &'static str,
        /// The value of the property.
        value: Vec3,
        /// The allowed values.
        allowed: &'static str,
    },
}

/// A component with the exact world that is spawned: geometry, certificate and provenance. It is on the
/// entity of the [`Environment`] while a world is spawned. It is not reflected, so scenes do not hold it: the
/// world is generated again.
#[derive(Component, Clone, Debug, Deref)]
#[component(clone_behavior = Ignore)]
pub struct GroundTruth(pub Arc<World>);

/// A component with the point of the spawned world, in metres, that is at the origin of the entity, on the
/// entity of its [`Environment`]. While another world is generated, or after that has failed,
/// [`Environment::origin`] may differ, since it is the origin of the requested world. Like [`GroundTruth`],
/// it is not reflected.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(clone_behavior = Ignore)]
pub struct SpawnedOrigin(pub DVec2);

impl SpawnedOrigin {
    /// Works as [`Environment::point_in_app`], for the world that is spawned.
    pub fn point_in_app(self, frame: &GlobalTransform, point: DVec2) -> Vec2 {
        frame.transform_point((point - self.0).as_vec2().extend(0.0)).truncate()
    }
}

/// A component with the endless forest that is streamed, on the entity of its [`Environment`]. It is not
/// reflected, so scenes do not hold it: the forest is generated again.
#[derive(Component, Clone, Debug, Deref)]
#[component(clone_behavior = Ignore)]
pub struct EndlessTruth(pub Arc<envgen::forest::EndlessForest>);

/// A component with the size of the spawned world, on the entity of its [`Environment`].
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct EnvironmentStats {
    /// The number of parts of the whole world, or `None` for an endless one.
    pub parts: Option<usize>,
    /// The number of solid parts of the whole world, or `None` for an endless one.
    pub solids: Option<usize>,
}

pub(crate) fn register(app: &mut App) {
    app.register_type::<Environment>()
        .register_type::<EnvironmentState>()
        .register_type::<EnvironmentStats>()
        .add_message::<EnvironmentReady>()
        .add_message::<EnvironmentFailed>();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_are_where_the_entity_puts_them() {
        let world = Environment::new(envgen::hallway::HallwaySpec::default(), 1);
        let area = WorldRect::new(DVec2::new(1.0, 2.0), DVec2::new(5.0, 4.0));
        let plain = world.area_in_app(&GlobalTransform::IDENTITY, area);
        assert_eq!(plain, Rect::new(1.0, 2.0, 5.0, 4.0));

        let quarter = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
        let frame = Transform::from_xyz(10.0, 0.0, 3.0).with_rotation(quarter);
        let frame = GlobalTransform::from(frame.with_scale(Vec3::splat(2.0)));
        let world = world.with_origin(DVec2::new(1.0, 2.0));
        let turned = world.area_in_app(&frame, area);
        let (least, most) = (Vec2::new(6.0, 0.0), Vec2::new(10.0, 8.0));
        assert!(
            turned.min.distance(least) < 1e-5 && turned.max.distance(most) < 1e-5,
            "{turned:?}"
        );
        assert!(world.point_in_app(&frame, area.min).distance(Vec2::new(10.0, 0.0)) < 1e-5);
    }
}
