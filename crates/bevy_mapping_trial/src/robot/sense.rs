//! Updates poses, contacts, wheel odometry and batteries after a step.

use bevy::prelude::*;
use bevy_envgen::scenario::Person;
use bevy_rapier2d::prelude::systemparams::RapierContext;
use bevy_rapier2d::prelude::{ContactPairView, ReadRapierContext};
use envgen::geometry::{unit_vector, wrap_angle};
use mapping_trial::backend::Command;
use mapping_trial::odometry::Increment;

use super::drive::pose_of;
use super::ground::Terrain;
use super::model::{
    Battery, Bumper, Chassis, RobotCondition, RobotModel, Touched, Touches, TruePose,
    WheelOdometry, Wheels,
};

/// The components of a sensing robot.
type Sensing = (
    Entity,
    &'static Chassis,
    &'static mut Wheels,
    &'static mut TruePose,
    &'static mut Bumper,
    &'static mut RobotCondition,
    Option<&'static mut WheelOdometry>,
    Option<&'static mut Battery>,
);

/// Records the poses of bodies before the step. A change before that, such as a change of the [`Transform`]
/// of a robot or of its environment, has turned no wheels.
pub(super) fn note_places(
    mut robots: Query<(Entity, &mut Wheels), With<RobotModel>>,
    rapier: ReadRapierContext,
) {
    let Ok(rapier) = rapier.single() else { return };
    for (entity, mut wheels) in &mut robots {
        wheels.bypass_change_detection().before = pose_of(rapier.rigidbody_set, entity);
    }
}

/// Updates poses, contacts, odometry and batteries.
pub(super) fn sense(
    time: Res<Time>,
    mut robots: Query<Sensing, With<RobotModel>>,
    people: Query<(), With<Person>>,
    rapier: ReadRapierContext,
    terrain: Terrain,
) {
    let Ok(rapier) = rapier.single() else { return };
    let dt = time.delta_secs_f64();
    for (entity, chassis, mut wheels, mut truth, mut bumper, mut condition, odometry, battery) in
        &mut robots
    {
        let Some(pose) = pose_of(rapier.rigidbody_set, entity) else { continue };
        let from = wheels.before.filter(|_| wheels.placed).unwrap_or(pose);
        wheels.placed = true;
        let turn = wrap_angle(pose.heading - from.heading);
        let ahead = unit_vector(from.heading + 0.5 * turn);
        let distance = (pose.position - from.position).dot(ahead);
        truth.set_if_neq(pose.into());
        if let Some(mut battery) = battery {
            battery.left = (battery.left - dt).max(0.0);
        }
        if *condition == RobotCondition::Drowned {
            if let Some(mut odometry) = odometry {
                odometry.measure(Increment::default(), 1.0);
            }
            continue;
        }
        let wanted = ahead * wheels.motion(chassis.track).speed;
        let rate = if dt > 0.0 { 1.0 / dt } else { 0.0 };
        let lost = wanted - (pose.position - from.position) * rate;
        let mut touched = touched(&rapier, entity, lost.as_vec2(), &people);
        touched[Touched::Solid as usize] |= wheels.bogged;
        bumper.feel(touched);
        if bumper.touching && dt > 0.0 && chassis.check().is_ok() {
            // A stopped body stops its wheels.
            let motion = Command { speed: distance / dt, turn_rate: turn / dt };
            wheels.set(motion, chassis.track);
        }
        if let Some(mut odometry) = odometry {
            let ground = terrain.at(from.position);
            let rolled = Increment { distance: ground.rolled(distance), turn };
            odometry.measure(rolled, ground.odometry_noise);
        }
        if terrain.at(pose.position).water {
            *condition = RobotCondition::Drowned;
        }
    }
}

/// The speed in m/s along the normal of a contact from which on the contact counts as stopping a body.
const STOPPED: f32 = 0.01;

/// Returns whether a contact of a collider of a body took speed from the body. `lost` is the difference
/// between the velocity that its wheels should have given it and its actual velocity, in m/s. Impulses alone
/// do not show this, since they are those of the last substep, in which a body that was stopped before may
/// rest. The order of the two colliders depends on the history of the app, and must not matter.
fn is_stopped_by(pair: &ContactPairView<'_>, own: Entity, lost: Vec2) -> bool {
    let sign = if pair.collider1() == Some(own) { 1.0 } else { -1.0 };
    let mut active = pair.raw.manifolds.iter().filter(|m| !m.data.solver_contacts.is_empty());
    active.any(|manifold| sign * lost.dot(manifold.data.normal) > STOPPED)
}

/// Returns what the colliders of a body touch.
fn touched(
    rapier: &RapierContext,
    body: Entity,
    lost: Vec2,
    people: &Query<(), With<Person>>,
) -> Touches {
    let RapierContext { simulation, colliders, rigidbody_set, .. } = *rapier;
    let own = colliders.rigid_body_colliders(body, rigidbody_set);
    let felt = own.flat_map(|collider| {
        let pairs = simulation.contact_pairs_with(colliders, rigidbody_set, collider);
        let is_felt = move |pair: &ContactPairView<'_>| {
            pair.raw.total_impulse_magnitude() > 0.0 || is_stopped_by(pair, collider, lost)
        };
        pairs.filter(is_felt).map(|pair| {
            let mut both = [pair.collider1(), pair.collider2()].into_iter().flatten();
            if both.any(|entity| people.contains(entity)) {
                Touched::Person
            } else {
                Touched::Solid
            }
        })
    });
    let mut touched = [false; 2];
    felt.for_each(|kind| touched[kind as usize] = true);
    touched
}
