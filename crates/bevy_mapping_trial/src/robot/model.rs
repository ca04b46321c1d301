//! The components of robots.

use bevy::ecs::query::QueryData;
use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use bevy_envgen::HeightRange;
use bevy_envgen::scenario::ScenarioAgent;
use bevy_rapier2d::prelude::{
    AdditionalMassProperties, Collider, ColliderMassProperties, Friction, RigidBody, Sleeping,
    Velocity,
};
use envgen::geometry::Pose;
use envgen::glam::DVec2;
use envgen::{Seed, SpecError};
use mapping_trial::backend::Command;
use mapping_trial::odometry::{Increment, Odometry, OdometryProfile, WheelSensor};
use mapping_trial::robot::{Footprint, Robot};

/// A component that makes its entity a robot with these properties. The default is the Pioneer 3-AT. To
/// change the properties, insert another.
///
/// Inserting it adds a dynamic body, a collider with the footprint of the model, its [`Chassis`], its
/// [`Battery`], its [`HeightRange`], and a [`ScenarioAgent`], which people avoid and doors open for. Components
/// that the entity already has are kept, and so is a [`Chassis`] that is inserted later. Colliders of
/// children belong to the robot too. Models of other robots can be read from RON; see [`Robot::from_ron`]. An
/// invalid model gets no body and logs a warning. If it replaces another model, or if this component is
/// removed, the components that the model added are removed.
///
/// A robot is a body of rapier's default context. Robots in other contexts neither drive nor sense.
#[derive(Component, Clone, Debug, Default, PartialEq, Deref, Reflect)]
#[component(immutable)]
#[reflect(opaque)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[require(DriveCommand, Wheels, Bumper, RobotCondition, TruePose, Transform)]
pub struct RobotModel(pub Robot);

/// A component with the command to a robot, which is valid until it is changed. Values beyond the limits of
/// the model are clamped. Values that are infinite or NaN are treated as 0.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct DriveCommand {
    /// The forward speed in m/s, negative when driving backwards.
    pub speed: f64,
    /// The turn rate in rad/s, counter-clockwise.
    pub turn_rate: f64,
}

impl From<Command> for DriveCommand {
    fn from(Command { speed, turn_rate }: Command) -> Self {
        DriveCommand { speed, turn_rate }
    }
}

/// A component with the mass and the wheels of a robot in rapier. The default is the Pioneer 3-AT. A robot
/// does not move, and a warning is logged, while the mass is not positive, or the grip or the track is
/// negative, or any of them is not finite.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct Chassis {
    /// The mass in kg.
    pub mass: f32,
    /// The coefficient of friction between wheels and ground, which limits the driving force.
    pub grip: f32,
    /// The effective track of the skid-steered wheels in metres. It is wider than the geometric track,
    /// because the wheels slip sideways when the robot turns.
    pub track: f64,
}

impl Chassis {
    /// Returns an error if a field has a value with which no robot can drive.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        if !(self.mass > 0.0 && self.mass.is_finite()) {
            let error = SpecError::new("mass", self.mass, "a finite number above 0");
            return Err(error.within("Chassis"));
        }
        for (field, value) in [("grip", f64::from(self.grip)), ("track", self.track)] {
            if !(value >= 0.0 && value.is_finite()) {
                let error = SpecError::new(field, value, "a finite number, at least 0");
                return Err(error.within("Chassis"));
            }
        }
        Ok(())
    }
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

/// A component with the wheel speeds of both sides, as speed over ground in m/s.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct Wheels {
    /// The speed of the left wheels.
    pub left: f64,
    /// The speed of the right wheels.
    pub right: f64,
    /// Whether impassable ground stopped the robot in the last step.
    pub(super) bogged: bool,
    /// Whether the pose was read before, so that the next change is a motion.
    pub(super) placed: bool,
    /// The pose before the step, in the frame of rapier's world.
    #[reflect(ignore)]
    pub(super) before: Option<Pose>,
    /// Whether the robot is stuck in water.
    pub(super) drowned: bool,
}

impl Wheels {
    /// Returns the forward speed in m/s and the turn rate in rad/s, for wheels that are `track` metres apart.
    pub fn motion(&self, track: f64) -> Command {
        let Wheels { left, right, .. } = *self;
        let turn_rate = if track > 0.0 { (right - left) / track } else { 0.0 };
        Command { speed: 0.5 * (left + right), turn_rate }
    }

    /// Returns whether the [`TruePose`] of the robot is known.
    #[cfg(feature = "camera")]
    pub(crate) fn is_placed(&self) -> bool {
        self.placed
    }

    pub(super) fn set(&mut self, motion: Command, track: f64) {
        let half = 0.5 * motion.turn_rate * track;
        (self.left, self.right) = (motion.speed - half, motion.speed + half);
    }
}

/// A component with the true pose of a robot after the last step, in the frame of rapier's world, in metres
/// and radians.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct TruePose {
    /// The position of the robot's centre.
    pub position: DVec2,
    /// The heading, counter-clockwise from the x axis.
    pub heading: f64,
}

impl TruePose {
    /// Returns the position and the heading as a [`Pose`].
    pub fn pose(&self) -> Pose {
        Pose { position: self.position, heading: self.heading }
    }
}

impl From<Pose> for TruePose {
    fn from(Pose { position, heading }: Pose) -> Self {
        TruePose { position, heading }
    }
}

/// The kinds of what a robot touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Touched {
    Solid,
    Person,
}

/// Whether a robot touches each kind.
pub(super) type Touches = [bool; 2];

/// A component with the state of a robot's bumper.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct Bumper {
    /// Whether the robot touches a solid or a person, or is stopped by impassable ground.
    pub touching: bool,
    /// The number of collisions, without those with people. A collision is a contact that begins after at
    /// least 10 steps without contact of its kind.
    pub collisions: u32,
    /// The number of collisions with people of a scenario.
    pub person_collisions: u32,
    /// The number of steps since the last contact of each kind.
    pub(super) clear: [u32; 2],
}

impl Bumper {
    /// The number of steps without contact after which the next contact is a new collision.
    const STEPS_BETWEEN_COLLISIONS: u32 = 10;

    pub(super) fn feel(&mut self, touched: Touches) {
        self.touching = touched.contains(&true);
        let counts = [&mut self.collisions, &mut self.person_collisions];
        for ((count, clear), touched) in counts.into_iter().zip(&mut self.clear).zip(touched) {
            *count += u32::from(touched && *clear >= Bumper::STEPS_BETWEEN_COLLISIONS);
            *clear = if touched { 0 } else { clear.saturating_add(1) };
        }
    }
}

impl Default for Bumper {
    fn default() -> Self {
        let clear = [Bumper::STEPS_BETWEEN_COLLISIONS; 2];
        Bumper { touching: false, collisions: 0, person_collisions: 0, clear }
    }
}

/// A component with the charge of a robot's battery. An empty battery stops the robot. A full one is added
/// with the [`RobotModel`].
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct Battery {
    /// The remaining operating time in seconds.
    pub left: f64,
}

/// A component with the condition of a robot.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub enum RobotCondition {
    /// The robot works.
    #[default]
    Operational,
    /// The robot drove into water and stays where it is.
    Drowned,
}

/// A component that measures the motion of a robot with the errors of a profile. Scenes and clones do not
/// hold it.
#[derive(Component, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(from_reflect = false)]
#[reflect(Component)]
pub struct WheelOdometry {
    /// The measured forward distance of the last step in metres.
    pub distance: f64,
    /// The measured turn of the last step in radians, counter-clockwise.
    pub turn: f64,
    #[reflect(ignore)]
    wheels: Box<dyn WheelSensor + Send + Sync>,
}

impl WheelOdometry {
    /// Creates the wheel odometry of robot number `robot`. Its noise depends on that number and on `seed`.
    ///
    /// # Panics
    /// Panics if [`OdometryProfile::validate`] rejects the profile.
    pub fn new(profile: OdometryProfile, seed: u64, robot: u64) -> Self {
        WheelOdometry::with_sensor(Box::new(Odometry::new(profile, Seed(seed), robot)))
    }

    /// Creates wheel odometry with a custom error model.
    pub fn with_sensor(wheels: Box<dyn WheelSensor + Send + Sync>) -> Self {
        WheelOdometry { distance: 0.0, turn: 0.0, wheels }
    }

    /// Returns the measurement of the last step.
    pub fn last(&self) -> Increment {
        Increment { distance: self.distance, turn: self.turn }
    }

    pub(super) fn measure(&mut self, motion: Increment, noise: f64) {
        let measured = self.wheels.measure(motion, noise);
        (self.distance, self.turn) = (measured.distance, measured.turn);
    }
}

/// A component that records which components were added for the current model, which is valid. Another model
/// replaces them.
#[derive(Component, Clone, Copy, Default)]
pub(super) struct Fitted {
    battery: bool,
    body: bool,
    velocity: bool,
    friction: bool,
    sleeping: bool,
    /// The chassis that was added. If the entity has a different one, it is the entity's own.
    chassis: Option<Chassis>,
    collider: bool,
    /// Whether a mass was added to the entity's own colliders.
    mass: bool,
    agent: bool,
    height: bool,
}

/// What an entity has of the components that a model adds.
#[derive(QueryData)]
pub(super) struct Parts {
    battery: Has<Battery>,
    body: Has<RigidBody>,
    velocity: Has<Velocity>,
    friction: Has<Friction>,
    sleeping: Has<Sleeping>,
    chassis: Option<&'static Chassis>,
    collider: Has<Collider>,
    mass: Has<AdditionalMassProperties>,
    agent: Has<ScenarioAgent>,
    height: Has<HeightRange>,
    fitted: Option<&'static Fitted>,
}

/// Adds a body, a collider, a chassis and a full battery to a robot, and makes people and doors react to it.
pub(super) fn fit(
    fit: On<Insert, RobotModel>,
    models: Query<(&RobotModel, Parts)>,
    mut commands: Commands,
) {
    let Ok((model, has)) = models.get(fit.entity) else { return };
    let fitted = has.fitted.copied().unwrap_or_default();
    let own_chassis = has.chassis.copied().filter(|chassis| fitted.chassis != Some(*chassis));
    // Another observer may have despawned the robot, so insertions may fail.
    let mut robot = commands.entity(fit.entity);
    if let Err(error) = model.validate() {
        log::warn!("robot {}: {error}", fit.entity);
        let chassis = fitted.chassis.filter(|_| own_chassis.is_none());
        strip(&mut robot, Fitted { chassis, ..fitted });
        return;
    }
    robot.try_insert_if_new((
        Battery { left: model.battery },
        RigidBody::Dynamic,
        Velocity::default(),
        Friction::coefficient(0.3),
        Sleeping::disabled(),
    ));
    let chassis = own_chassis.unwrap_or(model.chassis.into());
    // Rapier gets the mass of the model until that of the chassis is valid.
    let mass = chassis.check().map_or(model.chassis.mass as f32, |()| chassis.mass);
    let own_collider = has.collider && !fitted.collider;
    let own_mass = has.mass && !fitted.mass;
    let own_agent = has.agent && !fitted.agent;
    if !own_agent {
        robot.try_insert(ScenarioAgent::new(model.circumscribed_radius));
    }
    let own_height = has.height && !fitted.height;
    if let (false, Ok(extent)) = (own_height, model.extent()) {
        robot.try_insert(HeightRange::from(extent));
    }
    let fitted = Fitted {
        battery: !has.battery || fitted.battery,
        body: !has.body || fitted.body,
        velocity: !has.velocity || fitted.velocity,
        friction: !has.friction || fitted.friction,
        sleeping: !has.sleeping || fitted.sleeping,
        chassis: own_chassis.is_none().then_some(chassis),
        collider: !own_collider,
        mass: own_collider && !own_mass,
        agent: !own_agent,
        height: !own_height,
    };
    robot.try_insert((chassis, fitted));
    if own_collider {
        if !own_mass {
            robot.try_insert(AdditionalMassProperties::Mass(mass));
        }
        return;
    }
    let collider = match model.footprint {
        Footprint::Box => Collider::cuboid(0.5 * model.length as f32, 0.5 * model.width as f32),
        Footprint::Disc => Collider::ball(model.circumscribed_radius as f32),
    };
    robot.try_insert((collider, ColliderMassProperties::Mass(mass)));
}

/// Fits the models that the app has inserted before it adds the plugin.
pub(super) fn fit_early(world: &mut World) {
    let mut models = world.query::<(Entity, &RobotModel)>();
    let models: Vec<_> = models.iter(world).map(|(robot, model)| (robot, model.clone())).collect();
    for (robot, model) in models {
        if let Ok(mut robot) = world.get_entity_mut(robot) {
            robot.insert(model);
        }
    }
}

/// Removes the components that were added for a model that is removed.
pub(super) fn unfit(
    removed: On<Remove, RobotModel>,
    robots: Query<(&Fitted, Option<&Chassis>)>,
    mut commands: Commands,
) {
    let Ok((fitted, chassis)) = robots.get(removed.entity) else { return };
    let added = fitted.chassis.filter(|added| chassis == Some(added));
    strip(&mut commands.entity(removed.entity), Fitted { chassis: added, ..*fitted });
}

/// A robot, with its masses in rapier.
type Weighed = (
    Entity,
    &'static Chassis,
    &'static Fitted,
    Option<&'static mut ColliderMassProperties>,
    Option<&'static mut AdditionalMassProperties>,
);

/// Updates the masses of robots whose chassis has changed.
pub(super) fn weigh(mut robots: Query<Weighed, Changed<Chassis>>) {
    for (robot, chassis, fitted, collider, additional) in &mut robots {
        if let Err(error) = chassis.check() {
            log::warn!("robot {robot} does not move: {error}");
            continue;
        }
        if let Some(mut mass) = collider.filter(|_| fitted.collider) {
            mass.set_if_neq(ColliderMassProperties::Mass(chassis.mass));
        }
        if let Some(mut mass) = additional.filter(|_| fitted.mass) {
            mass.set_if_neq(AdditionalMassProperties::Mass(chassis.mass));
        }
    }
}

/// Removes the components that were added for the last model.
fn strip(robot: &mut EntityCommands<'_>, fitted: Fitted) {
    if fitted.battery {
        robot.try_remove::<Battery>();
    }
    if fitted.body {
        robot.try_remove::<RigidBody>();
    }
    if fitted.velocity && fitted.body {
        robot.try_remove::<Velocity>();
    } else if fitted.velocity {
        // Rapier keeps the velocity of a body from which the component is removed.
        robot.try_insert(Velocity::default());
    }
    if fitted.friction {
        robot.try_remove::<Friction>();
    }
    if fitted.sleeping {
        robot.try_remove::<Sleeping>();
    }
    if fitted.chassis.is_some() {
        robot.try_remove::<Chassis>();
    }
    if fitted.collider {
        robot.try_remove::<(Collider, ColliderMassProperties)>();
    }
    if fitted.mass {
        robot.try_remove::<AdditionalMassProperties>();
    }
    if fitted.agent {
        robot.try_remove::<ScenarioAgent>();
    }
    if fitted.height {
        robot.try_remove::<HeightRange>();
    }
    // The robot is at rest, even if it is moved elsewhere, until it gets a valid model.
    robot.try_remove::<Fitted>().try_insert(Wheels::default());
}
