//! Reads the lines that gizmos draw.

use std::any::TypeId;

use bevy::gizmos::GizmoHandles;
use bevy::prelude::*;
use bevy_envgen::debug::EnvgenGizmos;
use bevy_envgen::testing::step;

/// Returns the ends of the lines that are drawn with some layers: those of line lists and those of line
/// strips.
pub(crate) fn lines(app: &mut App, layers: impl Resource) -> (Vec<Vec2>, Vec<Vec2>) {
    app.insert_resource(layers);
    step(app, 2);
    let handles = app.world().resource::<GizmoHandles>().handles();
    let Some(handle) = handles[&TypeId::of::<EnvgenGizmos>()].as_ref() else {
        return (Vec::new(), Vec::new());
    };
    let gizmos = app.world().resource::<Assets<GizmoAsset>>().get(handle).unwrap().buffer();
    let flat = |points: &[Vec3]| {
        points.iter().filter(|p| p.is_finite()).map(|p| p.truncate()).collect::<Vec<_>>()
    };
    (flat(&gizmos.list_positions), flat(&gizmos.strip_positions))
}
