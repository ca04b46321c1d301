//! The transforms of bodies whose parents are turned.
//!
//! `bevy_rapier2d` 0.36 rotates the inverse scale of the parent instead of the position of the body, so that the
//! translation that it writes is right only if the parent is not turned.

use bevy::prelude::*;
use bevy_rapier2d::prelude::{
    RapierConfiguration, RapierContextEntityLink, RapierRigidBodyHandle, RapierRigidBodySet,
    RigidBody, RigidBodyDisabled,
};
use bevy_rapier2d::rapier::dynamics::RigidBodyType;
use bevy_rapier2d::rapier::math::Pose;

/// A component with the pose of a body whose translation was corrected.
#[derive(Component, Clone, Copy)]
#[component(clone_behavior = Ignore)]
pub(super) struct Corrected {
    /// The pose in rapier.
    pose: Pose,
    /// The global transform that follows from the correction. If it is different in the next step, the app has moved
    /// the body or its parent.
    global: GlobalTransform,
}

/// A body below another entity.
type Body = (
    Entity,
    &'static RapierRigidBodyHandle,
    &'static RapierContextEntityLink,
    &'static ChildOf,
    &'static mut Transform,
    Option<&'static mut Corrected>,
);

/// Corrects the translations of bodies below turned parents.
pub(super) fn correct(
    contexts: Query<(&RapierRigidBodySet, &RapierConfiguration)>,
    parents: Query<&GlobalTransform>,
    mut bodies: Query<Body, (With<RigidBody>, Without<RigidBodyDisabled>)>,
    mut commands: Commands,
) {
    for (entity, handle, link, parent, mut transform, known) in &mut bodies {
        let Ok(parent) = parents.get(parent.parent()) else { continue };
        let affine = parent.affine();
        if affine.matrix3.x_axis.y == 0.0 && affine.matrix3.x_axis.x > 0.0 {
            if known.is_some() {
                commands.entity(entity).try_remove::<Corrected>();
            }
            continue;
        }
        let Ok((set, settings)) = contexts.get(link.0) else { continue };
        let Some(body) = set.bodies.get(handle.0) else { continue };
        if !settings.physics_pipeline_active {
            continue;
        }
        let at = body.translation().extend(0.0);
        let below = affine.inverse().transform_point3(at).truncate();
        if transform.translation.truncate() != below {
            transform.translation = below.extend(transform.translation.z);
        }
        let now = Corrected { pose: *body.position(), global: parent.mul_transform(*transform) };
        match known {
            Some(mut known) => *known = now,
            None => {
                commands.entity(entity).try_insert(now);
            }
        }
    }
}

/// Gives corrected bodies their exact poses again. Rapier takes the correction for a change by the app, and rounding
/// would move bodies at rest.
pub(super) fn restore(
    mut contexts: Query<&mut RapierRigidBodySet>,
    bodies: Query<(&RapierRigidBodyHandle, &RapierContextEntityLink, &GlobalTransform, &Corrected)>,
) {
    for (handle, link, global, corrected) in &bodies {
        if *global != corrected.global {
            continue;
        }
        let Ok(mut set) = contexts.get_mut(link.0) else { continue };
        let Some(body) = set.bodies.get_mut(handle.0) else { continue };
        if body.body_type() == RigidBodyType::KinematicPositionBased {
            body.set_next_kinematic_position(corrected.pose);
        } else if *body.position() != corrected.pose {
            body.set_position(corrected.pose, false);
        }
    }
}
