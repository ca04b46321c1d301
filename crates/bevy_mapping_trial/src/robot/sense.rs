//! Sensing after a step: poses, contacts, wheel odometry and batteries.

use bevy::prelude::*;
use bevy_rapier2d::prelude::ReadRapierContext;
use bevy_rapier2d::prelude::systemparams::RapierContext;
use envgen::geometry::{unit_vector, wrap_angle};
use mapping_trial::backend::Command;
use mapping_trial::odometry::Increment;

use super::drive::pose_of;
use super::ground::Terrain;
use super::model::{
    Battery, Bumper, Chassis, RobotCondition, RobotModel, TruePose, WheelOdometry, Wheels,
};

/// The components of a robot that senses.
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

/// Reads poses, contacts, odometry and batteries.
pub(super) fn sense(
    time: Res<Time>,
    mut robots: Query<Sensing, With<RobotModel>>,
    rapier: ReadRapierContext,
    terrain: Terrain,
) {
    let Ok(rapier) = rapier.single() else { return };
    let dt = time.delta_secs_f64();
    for (entity, chassis, mut wheels, mut truth, mut bumper, mut condition, odometry, battery) in
        &mut robots
    {
        let Some(pose) = pose_of(rapier.rigidbody_set, entity) else { continue };
        let from = if wheels.placed { truth.pose() } else { pose };
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
        let touching = wheels.bogged || touches(&rapier, entity);
        bumper.feel(touching);
        if touching && dt > 0.0 {
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

/// Whether any collider of a body touches a solid.
fn touches(rapier: &RapierContext, body: Entity) -> bool {
    let RapierContext { simulation, colliders, rigidbody_set, .. } = *rapier;
    colliders.rigid_body_colliders(body, rigidbody_set).any(|collider| {
        let mut pairs = simulation.contact_pairs_with(colliders, rigidbody_set, collider);
        pairs.any(|pair| pair.raw.total_impulse_magnitude() > 0.0)
    })
}
