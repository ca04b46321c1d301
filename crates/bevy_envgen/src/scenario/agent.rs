//! Entities that the people and doors of scenarios take into account.

use bevy::prelude::*;
use envgen::glam::DVec2;
use envgen::scenario::TICKS_PER_SECOND;

/// Makes people avoid an entity and react to it, and doors open for it and stop at it, in every scenario.
///
/// The robots of `bevy_mapping_trial` have it. The velocity is the mean over the last 1/20 s; who jumps, at more than
/// 50 m/s, has none. One whose radius is not a number from 0 to a million, or whose position is not finite, is ignored.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform)]
pub struct ScenarioAgent {
    /// Radius in metres, in the app's space, of a disc that holds the entity.
    pub radius: f64,
    /// Where it is in the app's space, once it was located.
    at: Option<Vec2>,
    /// Velocity in m/s in the app's space.
    velocity: Vec2,
    /// Where it was when its velocity was measured last.
    from: Vec2,
    /// Seconds since then.
    elapsed: f32,
}

/// Velocities are measured over this many seconds at least: a tick. Apps may move an entity in some steps of a frame only.
const MEASURED: f32 = 1.0 / TICKS_PER_SECOND as f32;

/// What is faster, in m/s, was put elsewhere.
const FASTEST: f32 = 50.0;

impl ScenarioAgent {
    /// With the radius in metres of a disc that holds the entity.
    pub fn new(radius: f64) -> Self {
        ScenarioAgent { radius, ..default() }
    }

    /// As a robot in the frame of an environment, into which `affine` leads, with a point of the world at its origin.
    pub(super) fn robot(
        &self,
        affine: &bevy::math::DAffine3,
        origin: DVec2,
    ) -> Option<envgen::scenario::Robot> {
        let to = |p: Vec2| p.as_dvec2().extend(0.0);
        let robot = envgen::scenario::Robot {
            position: affine.transform_point3(to(self.at?)).truncate() + origin,
            velocity: affine.transform_vector3(to(self.velocity)).truncate(),
            radius: self.radius * affine.matrix3.x_axis.length(),
        };
        let is_valid = robot.position.is_finite()
            && robot.velocity.is_finite()
            && (0.0..1e6).contains(&robot.radius);
        is_valid.then_some(robot)
    }
}

/// Reads where agents are. Bevy propagates transforms only once per frame, which may have several steps.
pub(super) fn locate(
    time: Res<Time>,
    mut agents: Query<(Entity, &mut ScenarioAgent)>,
    transforms: TransformHelper,
) {
    let dt = time.delta_secs();
    for (entity, mut agent) in &mut agents {
        let Ok(transform) = transforms.compute_global_transform(entity) else { continue };
        let at = transform.translation().truncate();
        let known = agent.bypass_change_detection();
        let before = (known.at, known.velocity);
        if known.at.is_none() {
            known.from = at;
        }
        known.at = Some(at);
        known.elapsed += dt;
        // A step that is a tick may be shorter by rounding.
        if known.elapsed > 0.999 * MEASURED {
            let velocity = (at - known.from) / known.elapsed;
            known.velocity = if velocity.length() > FASTEST { Vec2::ZERO } else { velocity };
            (known.from, known.elapsed) = (at, 0.0);
        }
        if (known.at, known.velocity) != before {
            agent.set_changed();
        }
    }
}
