//! Entities that the people and doors of scenarios react to.

use bevy::prelude::*;
use envgen::glam::DVec2;
use envgen::scenario::TICKS_PER_SECOND;

/// A component that makes people of all scenarios avoid its entity and react to it, and makes doors open for
/// it and stop at it.
///
/// The robots of `bevy_mapping_trial` have it. The velocity is the mean over the last 1/20 s. An entity that
/// moves faster than 50 m/s is taken to have been moved elsewhere, and has no velocity. An entity is ignored
/// if its radius is not a number from 0 to a million, or if its position is not finite.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform)]
pub struct ScenarioAgent {
    /// The radius in metres, in global coordinates of the app, of a disc that contains the entity.
    pub radius: f64,
    /// The last known position in global coordinates of the app.
    at: Option<Vec2>,
    /// The velocity in m/s, in global coordinates of the app.
    velocity: Vec2,
    /// The position when the velocity was last measured.
    from: Vec2,
    /// The seconds since then.
    elapsed: f32,
}

/// The shortest time in seconds over which velocities are measured, which is one tick. Apps may move an
/// entity only in some of the steps of a frame.
const MEASURED: f32 = 1.0 / TICKS_PER_SECOND as f32;

/// The largest velocity in m/s. A faster entity was moved elsewhere.
const FASTEST: f32 = 50.0;

impl ScenarioAgent {
    /// Creates an agent with the radius in metres of a disc that contains the entity.
    pub fn new(radius: f64) -> Self {
        ScenarioAgent { radius, ..default() }
    }

    /// Returns the agent as a robot in the frame of a world. `affine` converts to the frame of the
    /// environment, whose origin is the point `origin` of the world.
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

/// Updates the positions of agents. It computes their transforms, since Bevy propagates transforms only once
/// per frame, which may have several steps.
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
        // A step of one tick may be shorter by rounding.
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
