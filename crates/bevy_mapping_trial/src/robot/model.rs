//! The components of a robot.

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use bevy_envgen::HeightRange;
use bevy_envgen::scenario::ScenarioAgent;
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

/// Makes an entity a robot with these properties; the default is the Pioneer 3-AT.
///
/// Inserting it adds a dynamic body, a collider of the model's footprint, a [`Chassis`] of the
/// model, its [`HeightRange`], and a [`ScenarioAgent`], which people avoid and doors open for. Those that
/// the entity already has are kept, as is another [`Chassis`] that is put on it later, and colliders of its children
/// belong to the robot too. Models of other robots can be read from RON: see [`Robot::from_ron`]. An invalid model gets
/// no body and logs a warning; in place of another model it removes what that one added.
#[derive(Component, Clone, Debug, Default, PartialEq, Deref, DerefMut, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[require(DriveCommand, Wheels, Bumper, RobotCondition, TruePose, Transform)]
pub struct RobotModel(pub Robot);

/// The command to a robot, valid until it is changed. Values beyond the model's limits are clamped;
/// NaN and infinite values are treated as 0.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct DriveCommand {
    /// Forward speed in m/s, negative backwards.
    pub speed: f64,
    /// Turn rate in rad/s, counter-clockwise.
    pub turn_rate: f64,
}

impl From<Command> for DriveCommand {
    fn from(Command { speed, turn_rate }: Command) -> Self {
        DriveCommand { speed, turn_rate }
    }
}

/// Mass and wheels of a robot in rapier; the default is the Pioneer 3-AT.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct Chassis {
    /// Mass in kg.
    pub mass: f32,
    /// Coefficient of friction between wheels and ground, which limits the driving force.
    pub grip: f32,
    /// Effective track of the skid-steered wheels in metres: wider than the geometric track,
    /// because the wheels slip sideways when the robot turns.
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

/// Wheel speeds of both sides, as speed over ground in m/s.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct Wheels {
    /// Speed of the left wheels.
    pub left: f64,
    /// Speed of the right wheels.
    pub right: f64,
    /// Whether impassable ground stopped it in the last step.
    pub(super) bogged: bool,
    /// Whether its pose was read before, so that the next change is a motion.
    pub(super) placed: bool,
    /// Its pose before the step, in rapier's frame.
    #[reflect(ignore)]
    pub(super) before: Option<Pose>,
    /// Whether water holds the body.
    pub(super) drowned: bool,
}

impl Wheels {
    /// Forward speed in m/s and turn rate in rad/s, for wheels that are `track` metres apart.
    pub fn motion(&self, track: f64) -> Command {
        let Wheels { left, right, .. } = *self;
        let turn_rate = if track > 0.0 { (right - left) / track } else { 0.0 };
        Command { speed: 0.5 * (left + right), turn_rate }
    }

    /// Whether the robot's [`TruePose`] is known.
    #[cfg(feature = "camera")]
    pub(crate) fn is_placed(&self) -> bool {
        self.placed
    }

    pub(super) fn set(&mut self, motion: Command, track: f64) {
        let half = 0.5 * motion.turn_rate * track;
        (self.left, self.right) = (motion.speed - half, motion.speed + half);
    }
}

/// The true pose of a robot after the last step, in the frame of rapier's world: metres and
/// radians.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct TruePose {
    /// The position of its centre.
    pub position: DVec2,
    /// Its heading, counter-clockwise from the x axis.
    pub heading: f64,
}

impl TruePose {
    /// Position and heading as a [`Pose`].
    pub fn pose(&self) -> Pose {
        Pose { position: self.position, heading: self.heading }
    }
}

impl From<Pose> for TruePose {
    fn from(Pose { position, heading }: Pose) -> Self {
        TruePose { position, heading }
    }
}

/// What a robot touches: a wall counts where it touches both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Touched {
    Person,
    Solid,
}

/// The state of a robot's bumper.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct Bumper {
    /// Whether it touches a solid or a person, or is stopped by impassable ground.
    pub touching: bool,
    /// Number of collisions, those with people aside: contacts that begin after at least 10 steps without contact.
    pub collisions: u32,
    /// Number of collisions with people of a scenario.
    pub person_collisions: u32,
    /// Steps since the last contact.
    pub(super) clear: u32,
}

impl Bumper {
    /// Steps without contact after which the next contact is a new collision.
    const STEPS_BETWEEN_COLLISIONS: u32 = 10;

    pub(super) fn feel(&mut self, touched: Option<Touched>) {
        if self.clear >= Bumper::STEPS_BETWEEN_COLLISIONS {
            match touched {
                Some(Touched::Solid) => self.collisions += 1,
                Some(Touched::Person) => self.person_collisions += 1,
                None => {}
            }
        }
        self.touching = touched.is_some();
        self.clear = if self.touching { 0 } else { self.clear.saturating_add(1) };
    }
}

impl Default for Bumper {
    fn default() -> Self {
        let clear = Bumper::STEPS_BETWEEN_COLLISIONS;
        Bumper { touching: false, collisions: 0, person_collisions: 0, clear }
    }
}

/// The charge of a robot's battery; an empty one stops the robot. Added full with the
/// [`RobotModel`].
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct Battery {
    /// Remaining operating time in seconds.
    pub left: f64,
}

/// Whether a robot still works.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub enum RobotCondition {
    /// It works.
    #[default]
    Operational,
    /// It drove into water and stays where it is.
    Drowned,
}

/// Measures the motion of a robot with the errors of a profile. Scenes and clones do not hold it.
#[derive(Component, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(from_reflect = false)]
#[reflect(Component)]
pub struct WheelOdometry {
    /// Forward distance in the last step in metres, as measured.
    pub distance: f64,
    /// Turn in the last step in radians, as measured, counter-clockwise.
    pub turn: f64,
    #[reflect(ignore)]
    wheels: Box<dyn WheelSensor + Send + Sync>,
}

impl WheelOdometry {
    /// The wheel odometry of robot number `robot`; its noise depends on that number and on `seed`.
    ///
    /// # Panics
    /// If [`OdometryProfile::validate`] rejects the profile.
    pub fn new(profile: OdometryProfile, seed: u64, robot: u64) -> Self {
        WheelOdometry::with_sensor(Box::new(Odometry::new(profile, Seed(seed), robot)))
    }

    /// Wheel odometry with a custom error model.
    pub fn with_sensor(wheels: Box<dyn WheelSensor + Send + Sync>) -> Self {
        WheelOdometry { distance: 0.0, turn: 0.0, wheels }
    }

    /// The measurement of the last step.
    pub fn last(&self) -> Increment {
        Increment { distance: self.distance, turn: self.turn }
    }

    pub(super) fn measure(&mut self, motion: Increment, noise: f64) {
        let measured = self.wheels.measure(motion, noise);
        (self.distance, self.turn) = (measured.distance, measured.turn);
    }
}

/// The components that were added because of the model, which is valid: another model replaces them.
#[derive(Component, Clone, Copy, Default)]
pub(super) struct Fitted {
    body: bool,
    /// As it was added: with another one, the chassis is the entity's own.
    chassis: Option<Chassis>,
    collider: bool,
    /// The mass beside the entity's own colliders.
    mass: bool,
    agent: bool,
    height: bool,
}

/// A model, and the components that its entity already has.
type Model = (
    &'static RobotModel,
    Has<RigidBody>,
    Option<&'static Chassis>,
    Has<Collider>,
    Has<AdditionalMassProperties>,
    Has<ScenarioAgent>,
    Has<HeightRange>,
    Option<&'static Fitted>,
);

/// Adds a body, a collider, a chassis and a full battery to a robot, and lets people and doors notice it.
pub(super) fn fit(fit: On<Insert, RobotModel>, models: Query<Model>, mut commands: Commands) {
    let Ok((model, has_body, chassis, collides, is_heavy, is_agent, is_high, fitted)) =
        models.get(fit.entity)
    else {
        return;
    };
    let fitted = fitted.copied().unwrap_or_default();
    let own_chassis = chassis.copied().filter(|chassis| fitted.chassis != Some(*chassis));
    let mut robot = commands.entity(fit.entity);
    if let Err(error) = model.validate() {
        log::warn!("robot {}: {error}", fit.entity);
        let chassis = fitted.chassis.filter(|_| own_chassis.is_none());
        strip(&mut robot, Fitted { chassis, ..fitted });
        return;
    }
    robot.insert_if_new((
        Battery { left: model.battery },
        RigidBody::Dynamic,
        Velocity::default(),
        Friction::coefficient(0.3),
        Sleeping::disabled(),
    ));
    let chassis = own_chassis.unwrap_or(model.chassis.into());
    let own_collider = collides && !fitted.collider;
    let own_mass = is_heavy && !fitted.mass;
    let own_agent = is_agent && !fitted.agent;
    if !own_agent {
        robot.insert(ScenarioAgent::new(model.circumscribed_radius));
    }
    let own_height = is_high && !fitted.height;
    if let (false, Ok(extent)) = (own_height, model.extent()) {
        robot.insert(HeightRange::from(extent));
    }
    let fitted = Fitted {
        body: !has_body || fitted.body,
        chassis: own_chassis.is_none().then_some(chassis),
        collider: !own_collider,
        mass: own_collider && !own_mass,
        agent: !own_agent,
        height: !own_height,
    };
    robot.insert((chassis, fitted));
    if own_collider {
        if !own_mass {
            robot.insert(AdditionalMassProperties::Mass(chassis.mass));
        }
        return;
    }
    let collider = match model.footprint {
        Footprint::Box => Collider::cuboid(0.5 * model.length as f32, 0.5 * model.width as f32),
        Footprint::Disc => Collider::ball(model.circumscribed_radius as f32),
    };
    robot.insert((collider, ColliderMassProperties::Mass(chassis.mass)));
}

/// A robot, and its masses in rapier.
type Weighed = (
    &'static Chassis,
    &'static Fitted,
    Option<&'static mut ColliderMassProperties>,
    Option<&'static mut AdditionalMassProperties>,
);

/// Gives robots the masses of chassis that were changed or put on them.
pub(super) fn weigh(mut robots: Query<Weighed, Changed<Chassis>>) {
    for (chassis, fitted, collider, additional) in &mut robots {
        if let Some(mut mass) = collider.filter(|_| fitted.collider) {
            mass.set_if_neq(ColliderMassProperties::Mass(chassis.mass));
        }
        if let Some(mut mass) = additional.filter(|_| fitted.mass) {
            mass.set_if_neq(AdditionalMassProperties::Mass(chassis.mass));
        }
    }
}

/// Removes what was added because of the last model.
fn strip(robot: &mut EntityCommands<'_>, fitted: Fitted) {
    if fitted.body {
        robot.remove::<(RigidBody, Velocity)>();
    }
    if fitted.chassis.is_some() {
        robot.remove::<Chassis>();
    }
    if fitted.collider {
        robot.remove::<(Collider, ColliderMassProperties)>();
    }
    if fitted.mass {
        robot.remove::<AdditionalMassProperties>();
    }
    if fitted.agent {
        robot.remove::<ScenarioAgent>();
    }
    if fitted.height {
        robot.remove::<HeightRange>();
    }
    // It is at rest, wherever it is put, until another model is allowed.
    robot.remove::<Fitted>().insert(Wheels::default());
}
