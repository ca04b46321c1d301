//! The component that asks for a world, and its result.

use std::sync::Arc;

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use envgen::geometry::{Rect as WorldRect, Shape};
use envgen::glam::DVec2;
use envgen::world::Violation;
use envgen::{GenerateError, World, WorldKind, WorldSpec};
use thiserror::Error;

/// Asks for a world on this entity: a spec and a seed.
///
/// The parts are spawned below the entity, so that its [`Transform`] moves and turns them, and
/// [`EnvironmentReady`] or [`EnvironmentFailed`] is triggered on it and written as a message. Changing
/// the component, or the asset behind it, rebuilds the world; the old world is kept until the new
/// one is ready. Removing the component, or despawning the entity, removes everything.
///
/// With the feature `serialize` a Bevy scene can hold this component. The other components of the
/// entity and its tiles need not be in the scene: they are rebuilt where the scene is loaded, and
/// also for a clone of the entity.
///
/// Units are metres, x right and y up in the entity's frame. A scale other than 1 resizes the whole
/// world, but for the heights that decide what stops bodies and lasers: see [`HeightRange`](crate::HeightRange).
/// It must be positive and the same along x and y.
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
    /// The spec, the file or the finished world.
    pub source: WorldSource,
    /// Determines everything random. Unused for a world that exists already.
    pub seed: u64,
    /// Whether generation blocks the schedule or runs as a background task.
    pub pace: GenerationMode,
    /// Whether the world is finite or endless.
    pub extent: EnvironmentExtent,
    /// The point of the world, in metres, at the entity's own origin. Single precision resolves a
    /// millimetre up to 8 km from it.
    pub origin: DVec2,
    /// Whether each wall, tree and obstacle is an entity.
    pub solids: SolidStorage,
}

/// Where a world comes from.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(Debug, PartialEq, Clone)]
#[non_exhaustive]
pub enum WorldSource {
    /// A spec, from which a world is generated with the seed.
    Spec(SourceSpec),
    /// A spec in a file such as `hall.envgen.ron`.
    #[cfg(feature = "asset")]
    Asset(Handle<crate::asset::file::WorldAsset>),
    /// A world that exists already.
    World(SourceWorld),
}

/// A spec as a value that scenes can hold, serialized as [`WorldSpec`].
#[derive(Clone, Debug, PartialEq, Deref, DerefMut, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(opaque)]
#[reflect(Debug, PartialEq, Clone)]
pub struct SourceSpec(pub Box<WorldSpec>);

/// A world as a value that scenes can hold, serialized as [`World`].
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

/// Whether generation blocks the schedule or runs as a background task.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, PartialEq, Clone)]
pub enum GenerationMode {
    /// Blocks for worlds that take about a frame or less, by the spec's own estimate, and runs in
    /// the background for others.
    #[default]
    Auto,
    /// Blocks: the world is ready in the same frame.
    Blocking,
    /// Runs as a task of the pool for long computations.
    Async,
}

/// Whether a world is finite or endless.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Debug, PartialEq, Clone)]
pub enum EnvironmentExtent {
    /// It is finite.
    #[default]
    Finite,
    /// It is endless. Only forests can be endless, and only around the anchor of a
    /// [`StreamAround`](crate::StreamAround).
    Endless {
        /// Side of a tile in metres. The world depends on it: another side gives another forest for
        /// the same seed.
        tile: f64,
    },
}

/// How solid parts (walls, trees and obstacles) are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, PartialEq, Clone)]
pub enum SolidStorage {
    /// Each is an entity, with the component of its kind.
    #[default]
    Entities,
    /// They are data of their tile, in [`TileSolids`](crate::TileSolids), for static worlds of
    /// 100,000 parts and more: Bevy's systems visit every entity with a [`Transform`] in every
    /// frame, but none of these. Their colliders are always merged.
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
            (GenerationMode::default(), EnvironmentExtent::default(), SolidStorage::default());
        Environment { source, seed, pace, extent, origin: DVec2::ZERO, solids }
    }

    /// The same, but endless, in square tiles of `tile` metres: see [`EnvironmentExtent::Endless`].
    pub fn endless(self, tile: f64) -> Self {
        Environment { extent: EnvironmentExtent::Endless { tile }, ..self }
    }

    /// The same with another generation mode.
    pub fn with_pace(self, pace: GenerationMode) -> Self {
        Environment { pace, ..self }
    }

    /// The same with another point of the world at the entity's origin.
    pub fn with_origin(self, origin: DVec2) -> Self {
        Environment { origin, ..self }
    }

    /// The same with an origin near a world: its middle where it reaches farther than 8 km from zero, up to which
    /// single precision tells millimetres apart, otherwise zero.
    pub fn with_origin_near(self, world: &World) -> Self {
        const FAR: f64 = 8192.0;
        let WorldRect { min, max } = world.bounds;
        let is_near = min.abs().max(max.abs()).max_element() <= FAR;
        let origin = if is_near { DVec2::ZERO } else { world.bounds.center().floor() };
        self.with_origin(origin)
    }

    /// The same with walls, trees and obstacles as entities or as data of their tiles.
    pub fn with_solids(self, solids: SolidStorage) -> Self {
        Environment { solids, ..self }
    }

    /// A point of the world, in metres, in the space of the app, where `frame` is the entity's
    /// [`GlobalTransform`].
    pub fn point_in_app(&self, frame: &GlobalTransform, point: DVec2) -> Vec2 {
        SpawnedOrigin(self.origin).point_in_app(frame, point)
    }

    /// The smallest rectangle of the app's space around an area of the world: for the bounds of its
    /// [`GroundTruth`], what a camera must show so that the whole world is visible.
    pub fn area_in_app(&self, frame: &GlobalTransform, area: WorldRect) -> Rect {
        let corners = Shape::from_rect(area).corners();
        let mut corners = corners.into_iter().map(|corner| self.point_in_app(frame, corner));
        let first = corners.next().unwrap_or_default();
        corners.fold(Rect::from_corners(first, first), |area, p| area.union_point(p))
    }

    /// How its parts are laid out.
    pub(crate) fn layout(&self) -> TileLayout {
        TileLayout { origin: self.origin, solids: self.solids }
    }
}

/// How the parts of an environment are laid out below it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TileLayout {
    pub(crate) origin: DVec2,
    pub(crate) solids: SolidStorage,
}

/// The state of an environment's world.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub enum EnvironmentState {
    /// Generation has not started, or the asset is not loaded.
    #[default]
    Waiting,
    /// The generator is running.
    Generating,
    /// The first tiles around the anchor are being spawned.
    Streaming,
    /// All parts, or all tiles around the anchor, are spawned.
    Ready,
    /// Generation failed; a previous world, if any, is kept: see [`EnvironmentFailure`].
    Failed,
}

/// Why the world of an environment could not be made. On its entity until a world is ready; scenes
/// do not hold it.
#[derive(Component, Clone, Debug, PartialEq, Deref)]
#[component(clone_behavior = Ignore)]
pub struct EnvironmentFailure(pub EnvironmentError);

/// Triggered on an environment, and written as a message, when its world is ready: the first time
/// and after every change.
///
/// The [`GlobalTransform`]s of all spawned parts are correct by then, even before Bevy propagates
/// transforms. The poses of the start and the goal are in
/// [`EnvironmentLandmarks`](crate::EnvironmentLandmarks).
#[derive(EntityEvent, Message, Clone, Debug)]
pub struct EnvironmentReady {
    /// The environment.
    pub entity: Entity,
}

/// Triggered on an environment, and written as a message, when its world cannot be made. A previous
/// world is kept. The error is also stored on the entity: see [`EnvironmentFailure`].
#[derive(EntityEvent, Message, Clone, Debug)]
pub struct EnvironmentFailed {
    /// The environment.
    pub entity: Entity,
    /// Why.
    pub error: EnvironmentError,
}

/// Trigger it on an environment to rebuild its world although nothing changed.
#[derive(EntityEvent, Clone, Debug)]
pub struct RebuildEnvironment {
    /// The environment.
    pub entity: Entity,
}

/// Why a world cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EnvironmentError {
    /// The spec is invalid, or no world of this seed satisfies it.
    #[error(transparent)]
    Generate(#[from] GenerateError),
    /// The world that was passed in breaks an invariant.
    #[error("the world is invalid: {0}")]
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
    #[error("the asset {0} of the spec was removed")]
    AssetGone(String),
    /// The app has no asset server.
    #[error("the spec is an asset, but the app has no `AssetPlugin`")]
    NoAssets,
    /// The kind of world cannot be endless.
    #[error("a world of kind `{0}` cannot be endless, only one of kind `forest` can")]
    NotEndless(WorldKind),
    /// A world that exists already cannot be endless.
    #[error("a world that exists already cannot be endless")]
    Existing,
    /// An endless world is not streamed.
    #[error("an endless world needs the component `StreamAround`")]
    NoAnchor,
    /// A field of the component [`StreamAround`](crate::StreamAround) is out of range.
    #[error("`{field}` of `StreamAround` must be {allowed}, got {value}")]
    Stream {
        /// The field.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The allowed range.
        allowed: String,
    },
    /// The origin is not finite.
    #[error("the origin must be finite, got {0}")]
    Origin(DVec2),
    /// There are too many parts to be spawned at once.
    #[error(
        "the world has {parts} parts, but at most {limit} can be spawned at once; add `StreamAround`"
    )]
    TooMany {
        /// Parts of the world.
        parts: usize,
        /// The maximum: [`MAX_PARTS`](crate::MAX_PARTS).
        limit: usize,
    },
    /// The transform of the entity, combined with its ancestors', is not one of a flat world.
    #[error("the {what} of the transform must be {allowed}, got {value}")]
    Transform {
        /// The property of the transform, such as `scale`.
        what: &'static str,
        /// Its value.
        value: Vec3,
        /// The allowed values.
        allowed: &'static str,
    },
}

/// The exact world that is spawned, on the entity of its [`Environment`]: geometry, certificate and
/// provenance. While nothing is spawned, the component is absent. It is not reflected, so scenes do
/// not hold it: it is generated again.
#[derive(Component, Clone, Debug, Deref)]
#[component(clone_behavior = Ignore)]
pub struct GroundTruth(pub Arc<World>);

/// The point of the world that is spawned at the entity's origin, in metres, on the entity of its [`Environment`].
/// [`Environment::origin`] is that of the next world while that is generated, or if it failed. It is not reflected, as
/// [`GroundTruth`].
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(clone_behavior = Ignore)]
pub struct SpawnedOrigin(pub DVec2);

impl SpawnedOrigin {
    /// As [`Environment::point_in_app`], of the world that is spawned.
    pub fn point_in_app(self, frame: &GlobalTransform, point: DVec2) -> Vec2 {
        frame.transform_point((point - self.0).as_vec2().extend(0.0)).truncate()
    }
}

/// The endless forest that is streamed, on the entity of its [`Environment`]. It is not reflected,
/// so scenes do not hold it: it is generated again.
#[derive(Component, Clone, Debug, Deref)]
#[component(clone_behavior = Ignore)]
pub struct EndlessTruth(pub Arc<envgen::forest::EndlessForest>);

/// The size of the spawned world, on the entity of its [`Environment`].
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct EnvironmentStats {
    /// Number of parts of the whole world; `None` for an endless one.
    pub parts: Option<usize>,
    /// Number of solid parts of the whole world; `None` for an endless one.
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
