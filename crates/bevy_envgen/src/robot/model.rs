//! The components of a robot.

use bevy::prelude::*;
use bevy_rapier2d::prelude::{
    AdditionalMassProperties, Collider, ColliderMassProperties, Friction, RigidBody, Sleeping,
    Velocity,
};
use envgen::Seed;
use envgen::geometry::Pose;
use envgen::glam::DVec2;
use mapping_trial::backend::Command;
use mapping_trial::odometry::{Increment, Odometry, OdometryProfile, WheelSensor};
use mapping_trial::robot::{Footprint, Robot};

/// Makes an entity a robot of these numbers; the default is the Pioneer 3-AT.
///
/// It is a dynamic body of rapier with a collider of the model's footprint, which is put on when the
/// component is inserted, unless the entity has a collider of its own; colliders of its children
/// count as the robot's, too. Its [`Chassis`] is the model's, unless the entity has one of its own.
/// Robots of other numbers can be read from RON: see [`Robot::from_ron`].
/// One whose numbers are not allowed gets no body and a warning.
#[derive(Component, Clone, Debug, Default, PartialEq, Deref, DerefMut, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(
    DriveCommand,
    Wheels,
    Bumper,
    RobotCondition,
    TruePose,
    Transform,
    RigidBody = RigidBody::Dynamic,
    Velocity,
    Friction = Friction::coefficient(0.3),
    Sleeping = Sleeping::disabled()
)]
pub struct RobotModel(pub Robot);

/// What a robot is told to do, until it is told otherwise. Numbers that are none, or beyond the
/// model's limits, are cut to them.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct DriveCommand {
    /// Speed ahead in m/s, negative backwards.
    pub speed: f64,
    /// Rate of turning in rad/s, counter-clockwise.
    pub turn_rate: f64,
}

impl From<Command> for DriveCommand {
    fn from(Command { speed, turn_rate }: Command) -> Self {
        DriveCommand { speed, turn_rate }
    }
}

/// Weight and wheels of a robot in rapier; the default is the Pioneer 3-AT.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct Chassis {
    /// Mass in kg.
    pub mass: f32,
    /// Coefficient of friction of the wheels on the ground, which bounds the force that they push
    /// with.
    pub grip: f32,
    /// Effective track of the skid-steered wheels in metres: wider than the geometric one, since
    /// wheels that turn a robot slip sideways.
    pub track: f64,
}

impl From<mapping_trial::robot::Chassis> for Chassis {
    fn from(chassis: mapping_trial::robot::Chassis) -> Self {
        let mapping_trial::robot::Chassis { mass, track, grip } = chassis;
        Chassis { mass: mass as f32, grip: grip as f32, track }
    }
}

impl Default for Chassis {
    fn default() -> Self {
        mapping_trial::robot::Chassis::default().into()
    }
}

/// How fast the wheels of either side turn, as speed over ground in m/s.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct Wheels {
    /// Speed of the left wheels.
    pub left: f64,
    /// Speed of the right wheels.
    pub right: f64,
    /// Whether ground on which it cannot drive stopped it in the last step.
    pub(super) bogged: bool,
    /// Whether it was felt before, so that the next motion is one.
    pub(super) placed: bool,
}

impl Wheels {
    /// Speed ahead in m/s, and rate of turning in rad/s, of wheels that far apart.
    pub fn motion(&self, track: f64) -> Command {
        let Wheels { left, right, .. } = *self;
        let turn_rate = if track > 0.0 { (right - left) / track } else { 0.0 };
        Command { speed: 0.5 * (left + right), turn_rate }
    }

    pub(super) fn set(&mut self, motion: Command, track: f64) {
        let half = 0.5 * motion.turn_rate * track;
        (self.left, self.right) = (motion.speed - half, motion.speed + half);
    }
}

/// Where a robot truly is after the last step, in the frame of rapier's world: metres and radians.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct TruePose {
    /// Its middle.
    pub position: DVec2,
    /// Where it looks, counter-clockwise from the x axis.
    pub heading: f64,
}

impl TruePose {
    /// The same as a pose.
    pub fn pose(&self) -> Pose {
        Pose { position: self.position, heading: self.heading }
    }
}

impl From<Pose> for TruePose {
    fn from(Pose { position, heading }: Pose) -> Self {
        TruePose { position, heading }
    }
}

/// What a robot's bumper feels.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct Bumper {
    /// Whether it touches something solid, or is stopped by the ground.
    pub touching: bool,
    /// How often it has run into something: contacts with at least 10 steps without one between.
    pub hits: u32,
    /// Steps since it last touched something.
    pub(super) clear: u32,
}

impl Bumper {
    /// Steps without a contact after which the next one is another hit.
    const STEPS_BETWEEN_HITS: u32 = 10;

    pub(super) fn feel(&mut self, touching: bool) {
        if touching && self.clear >= Bumper::STEPS_BETWEEN_HITS {
            self.hits += 1;
        }
        self.clear = if touching { 0 } else { self.clear.saturating_add(1) };
        self.touching = touching;
    }
}

impl Default for Bumper {
    fn default() -> Self {
        Bumper { touching: false, hits: 0, clear: Bumper::STEPS_BETWEEN_HITS }
    }
}

/// What is left in a robot's battery. An empty one stops the robot. It is put on with the
/// [`RobotModel`], full.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct Battery {
    /// Seconds that it still lasts.
    pub left: f64,
}

/// What became of a robot.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub enum RobotCondition {
    /// It drives.
    #[default]
    Operational,
    /// It drove into water and stays where it is.
    Drowned,
}

/// Measures the motion of a robot with the errors of a profile.
#[derive(Component, Reflect)]
#[reflect(from_reflect = false)]
#[reflect(Component)]
pub struct WheelOdometry {
    /// Metres ahead in the last step, as measured.
    pub distance: f64,
    /// Radians turned in the last step, as measured.
    pub turn: f64,
    #[reflect(ignore)]
    wheels: Box<dyn WheelSensor + Send + Sync>,
}

impl WheelOdometry {
    /// The wheels of the robot of number `robot` in the run of a seed.
    ///
    /// # Panics
    /// When [`OdometryProfile::validate`] refuses the profile.
    pub fn new(profile: OdometryProfile, seed: u64, robot: u64) -> Self {
        WheelOdometry::with_sensor(Box::new(Odometry::new(profile, Seed(seed), robot)))
    }

    /// Wheels with an error model of one's own.
    pub fn with_sensor(wheels: Box<dyn WheelSensor + Send + Sync>) -> Self {
        WheelOdometry { distance: 0.0, turn: 0.0, wheels }
    }

    /// What was measured in the last step.
    pub fn last(&self) -> Increment {
        Increment { distance: self.distance, turn: self.turn }
    }

    pub(super) fn measure(&mut self, motion: Increment, noise: f64) {
        let measured = self.wheels.measure(motion, noise);
        (self.distance, self.turn) = (measured.distance, measured.turn);
    }
}

/// What follows from the model: another model changes it.
#[derive(Component, Clone, Copy, Default)]
pub(super) struct Fitted {
    chassis: bool,
    collider: bool,
}

/// A model, and what is on its robot already.
type Model =
    (&'static RobotModel, Option<&'static Chassis>, Has<Collider>, Option<&'static Fitted>);

/// Puts a collider, a chassis and a full battery on a robot.
pub(super) fn fit(fit: On<Insert, RobotModel>, models: Query<Model>, mut commands: Commands) {
    let Ok((model, chassis, collides, fitted)) = models.get(fit.entity) else { return };
    let fitted = fitted.copied().unwrap_or_default();
    let own_chassis = chassis.filter(|_| !fitted.chassis);
    let mut robot = commands.entity(fit.entity);
    if let Err(error) = model.validate() {
        log::warn!("robot {}: {error}", fit.entity);
        let chassis = own_chassis.copied().unwrap_or_default();
        robot.insert((chassis, Fitted { chassis: own_chassis.is_none(), ..fitted }));
        return;
    }
    robot.insert_if_new(Battery { left: model.battery });
    let chassis = own_chassis.copied().unwrap_or(model.chassis.into());
    let own_collider = collides && !fitted.collider;
    robot.insert((chassis, Fitted { chassis: own_chassis.is_none(), collider: !own_collider }));
    if own_collider {
        robot.insert_if_new(AdditionalMassProperties::Mass(chassis.mass));
        return;
    }
    let collider = match model.footprint {
        Footprint::Box => Collider::cuboid(0.5 * model.length as f32, 0.5 * model.width as f32),
        Footprint::Disc => Collider::ball(model.circumscribed_radius as f32),
    };
    robot.insert((collider, ColliderMassProperties::Mass(chassis.mass)));
}
