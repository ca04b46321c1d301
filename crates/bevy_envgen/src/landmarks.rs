//! The start and the goal of an environment's world.

use bevy::ecs::entity::MapEntities;
use bevy::prelude::*;
use envgen::World as EnvgenWorld;
use envgen::geometry::Pose;
use envgen::glam::DVec2;

use crate::part::{Goal, PartOf, Start};
use crate::shape::LocalFrame;

/// A component with the start and the goal of an environment's world, on the entity of the
/// [`Environment`](crate::Environment).
///
/// ```
/// use bevy::prelude::*;
/// use bevy_envgen::prelude::*;
///
/// fn spawn_player(
///     ready: On<EnvironmentReady>,
///     landmarks: Query<&EnvironmentLandmarks>,
///     mut commands: Commands,
/// ) {
///     if let Ok(EnvironmentLandmarks { start: Some(start), .. }) = landmarks.get(ready.entity) {
///         commands.spawn((Name::new("player"), start.pose));
///     }
/// }
/// # let mut app = bevy_envgen::testing::test_app();
/// # app.add_observer(spawn_player);
/// # app.world_mut().spawn(Environment::new(HallwaySpec::default(), 1));
/// # app.update();
/// # let mut players = app.world_mut().query_filtered::<&Name, Without<PartOf>>();
/// # assert!(players.iter(app.world()).any(|name| name.as_str() == "player"));
/// ```
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct EnvironmentLandmarks {
    /// The start, or `None` if the world has none.
    #[entities]
    pub start: Option<Landmark>,
    /// The goal, or `None` if the world has none.
    #[entities]
    pub goal: Option<Landmark>,
}

/// A start or a goal. The heading is along +x of its transforms.
#[derive(Clone, Copy, Debug, PartialEq, MapEntities, Reflect)]
#[reflect(Debug, PartialEq, Clone)]
pub struct Landmark {
    /// The entity of the part, which has the component [`Start`] or [`Goal`], or `None` while its tile is not
    /// spawned.
    #[entities]
    pub part: Option<Entity>,
    /// The pose in the frame of the environment, for children of the environment.
    pub local: Transform,
    /// The pose in global coordinates of the app, with a scale of 1. It is updated when Bevy propagates the
    /// transform of the environment.
    pub pose: Transform,
}

impl EnvironmentLandmarks {
    /// Creates the landmarks of a world whose point `origin` is at the origin of the environment.
    pub(crate) fn new(world: &EnvgenWorld, origin: DVec2, environment: &GlobalTransform) -> Self {
        let frame = LocalFrame::new(origin);
        let landmark = |pose: Pose| {
            let local = frame.pose(pose.position, pose.heading);
            Landmark { part: None, local, pose: in_space(environment, local) }
        };
        EnvironmentLandmarks { start: world.start.map(landmark), goal: world.goal.map(landmark) }
    }

    /// Updates the poses from the transform of the environment.
    pub(crate) fn follow(&mut self, environment: &GlobalTransform) {
        for landmark in [&mut self.start, &mut self.goal].into_iter().flatten() {
            landmark.pose = in_space(environment, landmark.local);
        }
    }
}

fn in_space(environment: &GlobalTransform, local: Transform) -> Transform {
    let pose = environment.mul_transform(local).compute_transform();
    pose.with_scale(Vec3::ONE)
}

/// The components that mark a start or a goal.
trait Mark: Component {
    fn of(landmarks: &mut EnvironmentLandmarks) -> Option<&mut Landmark>;
}

impl Mark for Start {
    fn of(landmarks: &mut EnvironmentLandmarks) -> Option<&mut Landmark> {
        landmarks.start.as_mut()
    }
}

impl Mark for Goal {
    fn of(landmarks: &mut EnvironmentLandmarks) -> Option<&mut Landmark> {
        landmarks.goal.as_mut()
    }
}

/// Stores the entity of a landmark's part when it is spawned.
fn find<M: Mark>(
    added: On<Add, M>,
    parts: Query<&PartOf>,
    mut environments: Query<&mut EnvironmentLandmarks>,
) {
    if let Ok(part) = parts.get(added.entity)
        && let Ok(mut landmarks) = environments.get_mut(part.0)
        && let Some(landmark) = M::of(&mut landmarks)
    {
        // A clone of the part must not replace the part.
        landmark.part.get_or_insert(added.entity);
    }
}

/// Removes the entity of a landmark's part when it is despawned.
fn lose<M: Mark>(
    removed: On<Remove, M>,
    parts: Query<&PartOf>,
    mut environments: Query<&mut EnvironmentLandmarks>,
) {
    if let Ok(part) = parts.get(removed.entity)
        && let Ok(mut landmarks) = environments.get_mut(part.0)
        && let Some(landmark) = M::of(&mut landmarks)
    {
        landmark.part.take_if(|part| *part == removed.entity);
    }
}

/// Updates the landmarks of environments that moved.
pub(crate) fn follow_environments(
    mut environments: Query<
        (&GlobalTransform, &mut EnvironmentLandmarks),
        Changed<GlobalTransform>,
    >,
) {
    for (environment, mut landmarks) in &mut environments {
        landmarks.follow(environment);
    }
}

pub(crate) fn register(app: &mut App) {
    app.register_type::<EnvironmentLandmarks>()
        .add_observer(find::<Start>)
        .add_observer(find::<Goal>)
        .add_observer(lose::<Start>)
        .add_observer(lose::<Goal>);
}
