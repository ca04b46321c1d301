//! Converts commands to wheel speeds, and wheel speeds to forces on bodies.

use bevy::prelude::*;
use bevy_rapier2d::prelude::{DefaultRapierContext, RapierRigidBodySet, RigidBody, Velocity};
use envgen::geometry::{Pose, unit_vector};
use mapping_trial::backend::Command;
use mapping_trial::robot::Footprint;

use super::ground::Terrain;
use super::model::{Battery, Chassis, DriveCommand, Fitted, RobotCondition, RobotModel, Wheels};

/// The acceleration of gravity in m/s^2.
const G: f64 = 9.81;

/// The components of a driving robot.
type Driven = (
    Entity,
    &'static RobotModel,
    &'static DriveCommand,
    &'static Chassis,
    &'static RobotCondition,
    Option<&'static Battery>,
    &'static mut Wheels,
    &'static mut Velocity,
    &'static mut RigidBody,
);

/// Updates wheel speeds from commands, and pushes the bodies by the forces between wheels and ground.
pub(super) fn drive(
    time: Res<Time>,
    // A robot with an invalid model has no `Fitted`.
    mut robots: Query<Driven, With<Fitted>>,
    bodies: Query<&RapierRigidBodySet, With<DefaultRapierContext>>,
    terrain: Terrain,
) {
    let Ok(bodies) = bodies.single() else { return };
    let dt = time.delta_secs_f64();
    if dt <= 0.0 {
        return;
    }
    for (entity, model, command, chassis, condition, battery, mut wheels, mut velocity, mut kind) in
        &mut robots
    {
        // A robot in water is not even pushed by other bodies.
        if *condition == RobotCondition::Drowned {
            kind.set_if_neq(RigidBody::Fixed);
            if !wheels.drowned {
                *wheels = Wheels { drowned: true, ..default() };
            }
            continue;
        }
        // The robot was moved out of the water.
        if std::mem::take(&mut wheels.bypass_change_detection().drowned) {
            kind.set_if_neq(RigidBody::Dynamic);
        }
        if chassis.check().is_err() {
            wheels.set(Command::STOP, 0.0);
            velocity.set_if_neq(Velocity::default());
            continue;
        }
        let Some(pose) = pose_of(bodies, entity) else { continue };
        let empty = battery.is_some_and(|battery| battery.left <= 0.0);
        let command = if empty { DriveCommand::default() } else { *command };

        let limit = model.max_speed * terrain.at(pose.position).speed;
        let last = wheels.motion(chassis.track);
        let wanted = within(command.speed, limit);
        let speed = toward(last.speed, wanted, model.acceleration * dt);
        let wanted = within(command.turn_rate, model.max_turn_rate);
        let turn_rate = toward(last.turn_rate, wanted, model.turn_acceleration * dt);

        let ahead = unit_vector(pose.heading + 0.5 * turn_rate * dt);
        let there = terrain.at(pose.position + ahead * speed * dt);
        let bogged = there.speed == 0.0 && !there.water;
        let speed = if bogged { 0.0 } else { speed };
        wheels.bogged = bogged;
        wheels.set(Command { speed, turn_rate }, chassis.track);

        // Coulomb friction between wheels and ground, with the longitudinal and the lateral force combined.
        let grip = f64::from(chassis.grip) * G * dt;
        let now = velocity.linear.as_dvec2();
        let wanted = ahead * speed;
        let linear = if bogged { wanted } else { now + (wanted - now).clamp_length_max(grip) };
        // The same force, at half the track from the centre, turns the body. The inertia is that of the
        // footprint.
        let radius2 = match model.footprint {
            Footprint::Box => (model.length * model.length + model.width * model.width) / 12.0,
            Footprint::Disc => 0.5 * model.circumscribed_radius * model.circumscribed_radius,
        };
        let spin = grip * 0.5 * chassis.track / radius2;
        let angular = toward(f64::from(velocity.angular), turn_rate, spin);
        let pushed = Velocity { linear: linear.as_vec2(), angular: angular as f32 };
        velocity.set_if_neq(pushed);
    }
}

/// Returns the pose of a body after the last step, or `None` before rapier has created the body.
pub(super) fn pose_of(bodies: &RapierRigidBodySet, entity: Entity) -> Option<Pose> {
    let handle = bodies.entity2body().get(&entity)?;
    let at = bodies.bodies.get(*handle)?.position();
    let heading = libm::atan2(f64::from(at.rotation.im), f64::from(at.rotation.re));
    Some(Pose { position: at.translation.as_dvec2(), heading })
}

/// Clamps a number to a limit in both directions. If the number is infinite or not a number, or if the limit
/// is negative or not a number, it returns 0, which stops the robot.
fn within(value: f64, limit: f64) -> f64 {
    if value.is_finite() && limit > 0.0 { value.clamp(-limit, limit) } else { 0.0 }
}

/// Moves a value towards `wanted` by at most `change`.
fn toward(value: f64, wanted: f64, change: f64) -> f64 {
    value + within(wanted - value, change)
}
