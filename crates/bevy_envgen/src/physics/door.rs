//! Doors that open, close and slam.

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use bevy_rapier2d::prelude::{ColliderDisabled, CollisionGroups, RigidBody};
use envgen::{Seed, SpecError};

use crate::environment::{Environment, EnvironmentState};
use crate::part::{Doorway, PartId, PartOf};
use crate::shape::PartShape;

/// Seconds that a door takes to open or close, and to slam shut.
const OPENING: f32 = 1.0;
const SLAMMING: f32 = 0.15;

/// The shortest mean wait of a schedule in seconds, so that a door that is spawned again after
/// hours can catch up with its schedule.
const SHORTEST_WAIT: f32 = 0.5;

/// The door of a [`Doorway`]: a leaf that slides into the wall.
///
/// Closed, it fills the opening as the world defines it. Open, it blocks neither robots nor rays.
/// In between it is a kinematic body, which pushes what is in the opening.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct Door {
    /// The entity of the leaf, which is the moving body.
    #[entities]
    pub leaf: Entity,
    openness: f32,
    target: f32,
    /// Change of openness per second.
    speed: f32,
    /// The next action of the schedule, and when it is due, in seconds of the environment's clock.
    next: Option<(u64, f64)>,
}

impl Door {
    fn new(leaf: Entity, open: bool) -> Self {
        let openness = f32::from(open);
        Door { leaf, openness, target: openness, speed: 0.0, next: None }
    }

    /// Starts to open it; takes at most 1 s.
    pub fn open(&mut self) {
        (self.target, self.speed) = (1.0, 1.0 / OPENING);
    }

    /// Starts to close it; takes at most 1 s.
    pub fn close(&mut self) {
        (self.target, self.speed) = (0.0, 1.0 / OPENING);
    }

    /// Starts to slam it shut; takes at most 0.15 s.
    pub fn slam(&mut self) {
        (self.target, self.speed) = (0.0, 1.0 / SLAMMING);
    }

    /// How far it is open: 0 is closed, 1 is open.
    pub fn openness(&self) -> f32 {
        self.openness
    }

    /// Whether it is open or opening.
    pub fn opens(&self) -> bool {
        self.target > 0.5
    }
}

/// Opens, closes and slams the doors of an environment at random. On the entity of its
/// [`Environment`].
///
/// The times and actions depend only on the environment's seed and the doorway, so that every run
/// is the same. Time starts when the world is ready. A schedule whose fields are out of range is
/// logged as a warning and moves no door.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(DoorClock)]
pub struct DoorSchedule {
    /// Mean time in seconds between actions of a door, at least 0.5; the waits are exponentially
    /// distributed.
    pub mean_wait: f32,
    /// Probability that a closing door slams, from 0 to 1.
    pub slam: f32,
}

impl DoorSchedule {
    /// Checks the fields; the error names the field, its value and the allowed range.
    pub fn validate(&self) -> Result<(), SpecError> {
        if !(self.mean_wait.is_finite() && self.mean_wait >= SHORTEST_WAIT) {
            let allowed = format!("a finite number of seconds of at least {SHORTEST_WAIT}");
            return Err(SpecError::new("mean_wait", self.mean_wait, allowed));
        }
        if !(0.0..=1.0).contains(&self.slam) {
            return Err(SpecError::new("slam", self.slam, "a number from 0 to 1"));
        }
        Ok(())
    }
}

impl Default for DoorSchedule {
    fn default() -> Self {
        DoorSchedule { mean_wait: 20.0, slam: 0.2 }
    }
}

/// Seconds since the world of a scheduled environment became ready.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct DoorClock(pub f64);

/// Triggered on a [`Doorway`], and written as a message, when its door has fully opened or closed.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct DoorStopped {
    /// The doorway.
    pub entity: Entity,
    /// Whether it is open.
    pub open: bool,
}

/// Adds a door to a doorway; a door that cannot move only exists when it is closed.
pub(super) fn add_door(world: &mut World, doorway: Entity, groups: CollisionGroups, moves: bool) {
    let entity = world.entity(doorway);
    let (Some(part), Some(shape)) = (entity.get::<Doorway>(), entity.get::<PartShape>()) else {
        return;
    };
    let (open, at) = (part.open, place(shape, f32::from(part.open)));
    let Some(collider) = super::collider::collider(shape) else { return };
    let above = entity.get::<GlobalTransform>().copied().unwrap_or_default();
    let leaf = (Name::new("leaf"), ChildOf(doorway), at, above.mul_transform(at), collider, groups);
    if !moves {
        if !open {
            world.spawn(leaf);
        }
        return;
    }
    let leaf = world.spawn((leaf, RigidBody::KinematicPositionBased)).id();
    if open {
        world.entity_mut(leaf).insert(ColliderDisabled);
    }
    world.entity_mut(doorway).insert(Door::new(leaf, open));
}

/// The pose of a leaf in the frame of its doorway.
fn place(shape: &PartShape, openness: f32) -> Transform {
    let width = match shape {
        // A doorway's width is the longer side, the wall's thickness the other.
        PartShape::Box { half_size } if half_size.x >= half_size.y => Vec2::X * 2.0 * half_size.x,
        PartShape::Box { half_size } => Vec2::Y * 2.0 * half_size.y,
        PartShape::Segment { half_length } => Vec2::X * 2.0 * *half_length,
        PartShape::Disc { radius } => Vec2::X * 2.0 * *radius,
        PartShape::Polygon { vertices } => {
            let reach = vertices.iter().fold(Vec2::ZERO, |reach, v| reach.max(v.abs()));
            if reach.x >= reach.y { Vec2::X * 2.0 * reach.x } else { Vec2::Y * 2.0 * reach.y }
        }
        PartShape::Point | PartShape::Strip { .. } => Vec2::ZERO,
    };
    Transform::from_translation((width * openness).extend(0.0))
}

/// Advances the clocks of scheduled environments.
pub(super) fn run_clocks(
    time: Res<Time>,
    mut clocks: Query<(&mut DoorClock, &EnvironmentState), With<DoorSchedule>>,
) {
    for (mut clock, state) in &mut clocks {
        if *state == EnvironmentState::Ready {
            clock.0 += time.delta_secs_f64();
        }
    }
}

/// Logs schedules whose fields are out of range.
pub(super) fn warn_bad_schedules(schedules: Query<(Entity, &DoorSchedule), Changed<DoorSchedule>>) {
    for (entity, schedule) in &schedules {
        if let Err(error) = schedule.validate() {
            log::warn!("door schedule of environment {entity}: {error}");
        }
    }
}

/// Starts the actions that are due.
pub(super) fn follow_schedules(
    mut doors: Query<(&PartId, &PartOf, &mut Door)>,
    schedules: Query<(&DoorSchedule, &DoorClock, &Environment)>,
) {
    if schedules.is_empty() {
        return;
    }
    for (id, part, mut door) in &mut doors {
        let Ok((schedule, clock, environment)) = schedules.get(part.0) else { continue };
        if schedule.validate().is_err() {
            continue;
        }
        let (mut action, mut due) = match door.next {
            Some(next) => next,
            None => (0, wait(schedule, environment.seed, id.index, 0)),
        };
        if clock.0 < due && door.next.is_some() {
            continue;
        }
        let mut last = None;
        while due <= clock.0 {
            last = Some((action, due));
            action += 1;
            due += wait(schedule, environment.seed, id.index, action);
        }
        door.next = Some((action, due));
        if let Some((action, since)) = last {
            act(&mut door, schedule, environment.seed, id.index, action);
            // A door that was spawned again with its tile has already reached its position.
            if clock.0 - since > f64::from(OPENING) {
                door.openness = door.target;
            }
        }
    }
}

/// Seconds before an action of a door.
fn wait(schedule: &DoorSchedule, seed: u64, door: u32, action: u64) -> f64 {
    let mut stream = Seed(seed).attempt("bevy/doors/wait", u64::from(door), action);
    // The exponential law by inversion. Waits have a minimum, so that hours of them can be caught
    // up.
    let mean = f64::from(schedule.mean_wait);
    f64::from(0.25 * SHORTEST_WAIT).max(-mean * libm::log1p(-stream.unit()))
}

/// Starts an action: opening and closing alternate, and the seed decides which is first.
fn act(door: &mut Door, schedule: &DoorSchedule, seed: u64, index: u32, action: u64) {
    let first = Seed(seed).stream("bevy/doors/first", u64::from(index)).chance(0.5);
    if first == action.is_multiple_of(2) {
        door.open();
    } else if Seed(seed)
        .attempt("bevy/doors/slam", u64::from(index), action)
        .chance(f64::from(schedule.slam))
    {
        door.slam();
    } else {
        door.close();
    }
}

/// Moves the leaves of doors that are opening or closing.
pub(super) fn move_doors(
    time: Res<Time>,
    mut doors: Query<(Entity, &mut Door, &PartShape, &GlobalTransform)>,
    mut leaves: Query<(&mut Transform, &mut GlobalTransform, Has<ColliderDisabled>), Without<Door>>,
    mut stopped: MessageWriter<DoorStopped>,
    mut commands: Commands,
) {
    for (entity, mut door, shape, doorway) in &mut doors {
        let Ok((mut at, mut global, disabled)) = leaves.get_mut(door.leaf) else { continue };
        let placed = place(shape, door.openness);
        let moving = door.openness != door.target;
        // Rapier writes the transform back with rounding errors.
        if !moving && at.translation.distance_squared(placed.translation) < 1e-8 {
            continue;
        }
        let remaining = door.target - door.openness;
        let step = remaining.abs().min(door.speed * time.delta_secs());
        door.openness += step * remaining.signum();
        *at = place(shape, door.openness);
        // Propagated at once: rapier reads it in this step, before Bevy propagates transforms.
        *global = *doorway * *at;
        let open = door.openness >= 1.0;
        if disabled && !open {
            commands.entity(door.leaf).remove::<ColliderDisabled>();
        } else if open && !disabled {
            commands.entity(door.leaf).insert(ColliderDisabled);
        }
        if moving && door.openness == door.target {
            stopped.write(DoorStopped { entity, open });
            commands.trigger(DoorStopped { entity, open });
        }
    }
}
