//! The transforms of bodies whose parents are turned.

use bevy::prelude::*;
use bevy_rapier2d::prelude::{
    RapierConfiguration, RapierContextEntityLink, RapierRigidBodyHandle, RapierRigidBodySet,
    RigidBody, RigidBodyDisabled,
};

/// A body below another entity.
type Body = (
    &'static RapierRigidBodyHandle,
    &'static RapierContextEntityLink,
    &'static ChildOf,
    &'static mut Transform,
);

/// Corrects the translations of bodies below turned parents.
///
/// `bevy_rapier2d` 0.36 rotates the inverse scale of the parent instead of the position of the body, so that the
/// translation that it writes is right only if the parent is not turned.
pub(super) fn place_below_turned(
    contexts: Query<(&RapierRigidBodySet, &RapierConfiguration)>,
    parents: Query<&GlobalTransform>,
    mut bodies: Query<Body, (With<RigidBody>, Without<RigidBodyDisabled>)>,
) {
    for (handle, link, parent, mut transform) in &mut bodies {
        let Ok(parent) = parents.get(parent.parent()).map(GlobalTransform::affine) else {
            continue;
        };
        if parent.matrix3.x_axis.y == 0.0 && parent.matrix3.x_axis.x > 0.0 {
            continue;
        }
        let Ok((set, settings)) = contexts.get(link.0) else { continue };
        let Some(body) = set.bodies.get(handle.0) else { continue };
        if !settings.physics_pipeline_active {
            continue;
        }
        let at = body.translation().extend(0.0);
        let below = parent.inverse().transform_point3(at).truncate();
        if transform.translation.truncate() != below {
            transform.translation = below.extend(transform.translation.z);
        }
    }
}
