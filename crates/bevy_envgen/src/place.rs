//! The transform of an environment, and whether it is valid for a flat world.

use bevy::prelude::*;

use crate::environment::EnvironmentError;

/// Computes the global transform of an entity exactly as Bevy will propagate it.
pub(crate) fn global_transform(world: &World, entity: Entity) -> GlobalTransform {
    let parent = |entity| world.get::<ChildOf>(entity);
    propagated(entity, |entity| world.get::<Transform>(entity), parent)
}

/// Computes the same from the transforms and parents of entities.
pub(crate) fn propagated<'a>(
    entity: Entity,
    local: impl Fn(Entity) -> Option<&'a Transform>,
    parent: impl Fn(Entity) -> Option<&'a ChildOf>,
) -> GlobalTransform {
    let mut locals = Vec::new();
    let mut next = Some(entity);
    while let Some(entity) = next {
        locals.push(local(entity).copied().unwrap_or_default());
        next = parent(entity).map(ChildOf::parent);
    }
    let root = locals.pop().unwrap_or_default();
    locals.iter().rfold(root.into(), |above: GlobalTransform, local| above.mul_transform(*local))
}

/// Sets the global transforms of an entity and its descendants to the values that Bevy will propagate.
pub(crate) fn propagate(world: &mut World, entity: Entity, global: GlobalTransform) {
    let mut left = vec![(entity, global)];
    while let Some((entity, global)) = left.pop() {
        if let Some(mut known) = world.get_mut::<GlobalTransform>(entity) {
            known.set_if_neq(global);
        }
        for &child in world.get::<Children>(entity).into_iter().flatten() {
            if let Some(local) = world.get::<Transform>(child) {
                left.push((child, global.mul_transform(*local)));
            }
        }
    }
}

/// Checks that a transform keeps a flat world flat and its circles round.
pub(crate) fn check_transform(transform: &GlobalTransform) -> Result<(), EnvironmentError> {
    /// Relative differences below this value are due to rounding.
    const TOLERANCE: f32 = 1e-3;
    let error = |what, value, allowed| Err(EnvironmentError::Transform { what, value, allowed });
    let affine = transform.affine();
    let (at, [x, y, z]) = (
        Vec3::from(affine.translation),
        [affine.matrix3.x_axis, affine.matrix3.y_axis, affine.matrix3.z_axis].map(Vec3::from),
    );
    if !at.is_finite() {
        return error("translation", at, "finite");
    }
    let mirrored = if x.cross(y).dot(z) < 0.0 { -1.0 } else { 1.0 };
    let scale = Vec3::new(x.length(), y.length() * mirrored, z.length());
    let allowed = "finite and positive, the same along x and y";
    if !(scale.is_finite() && scale.min_element() > 0.0) {
        return error("scale", scale, allowed);
    }
    let skewed = x.dot(y).abs() > TOLERANCE * scale.x * scale.y;
    if (scale.x - scale.y).abs() > TOLERANCE * scale.x || skewed {
        return error("scale", scale, allowed);
    }
    if x.z.abs().max(y.z.abs()) > TOLERANCE * scale.x || x.truncate().perp_dot(y.truncate()) < 0.0 {
        return error("x axis", x / scale.x, "in the xy plane, neither tilted nor turned over");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(transform: Transform) -> Result<(), &'static str> {
        check_transform(&transform.into()).map_err(|error| match error {
            EnvironmentError::Transform { what, .. } => what,
            _ => "another error",
        })
    }

    #[test]
    fn flat_transforms_carry_a_world() {
        for scale in [1e-3, 1.0, 50.0] {
            for turn in [0.0, 1.0, 3.0, -2.0] {
                let transform = Transform::from_xyz(1e3, -5.0, 3.0)
                    .with_rotation(Quat::from_rotation_z(turn))
                    .with_scale(Vec3::new(scale, scale, 1.0));
                assert_eq!(check(transform), Ok(()));
            }
        }
    }

    #[test]
    fn other_transforms_are_named() {
        let scaled = |x, y, z| check(Transform::from_scale(Vec3::new(x, y, z)));
        for (x, y, z) in [
            (0.0, 0.0, 0.0),
            (0.0, 0.0, 1.0),
            (1.0, 1.0, 0.0),
            (1.0, 2.0, 1.0),
            (-1.0, 1.0, 1.0),
            (f32::NAN, 1.0, 1.0),
            (f32::INFINITY, f32::INFINITY, 1.0),
        ] {
            assert_eq!(scaled(x, y, z), Err("scale"), "{x} {y} {z}");
        }
        assert_eq!(check(Transform::from_xyz(f32::NAN, 0.0, 0.0)), Err("translation"));
        assert_eq!(check(Transform::from_rotation(Quat::from_rotation_x(0.3))), Err("x axis"));
        let over = Transform::from_rotation(Quat::from_rotation_x(std::f32::consts::PI));
        assert_eq!(check(over), Err("x axis"));
    }
}
