//! Cameras that follow robots or show the whole map.

use bevy::camera::ScalingMode;
use bevy::prelude::*;

use super::sights::TrialSights;
use super::trial_view::TrialView;

/// Keeps a two-dimensional camera above the estimated position of a robot of a trial.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct FollowRobot {
    /// The environment that the trial is in.
    #[entities]
    pub trial: Entity,
    /// Index of the robot, from 0; numbers that are too large mean the last robot.
    pub robot: usize,
    /// Height of the visible area in metres.
    pub height: f32,
}

/// Keeps the whole map of a trial in a two-dimensional camera's view, and at least a square of 10
/// m.
///
/// With [`RenderLayers`](bevy::camera::visibility::RenderLayers) of 0 and
/// [`MINIMAP_LAYER`](super::MINIMAP_LAYER) it also shows arrows where the robots are.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct ShowWholeMap {
    /// The environment that the trial is in.
    #[entities]
    pub trial: Entity,
    /// Margin around the map in metres.
    pub margin: f32,
}

/// The smallest side in metres of the area that a [`ShowWholeMap`] shows.
const LEAST: f32 = 10.0;

/// Length of a robot's arrow as a share of the shorter side of the area that a [`ShowWholeMap`]
/// shows.
const ARROW: f32 = 0.06;

/// An arrow at a robot's position, for maps.
#[derive(Component)]
pub(super) struct MapMark;

type Looks<'w, 's, T> =
    Query<'w, 's, (&'static T, &'static mut Transform, &'static mut Projection)>;

/// Moves cameras to their robots.
pub(super) fn follow(
    trials: Query<(&TrialSights, &GlobalTransform), With<TrialView>>,
    mut cameras: Looks<'_, '_, FollowRobot>,
) {
    for (follow, mut place, mut projection) in &mut cameras {
        let Ok((sights, frame)) = trials.get(follow.trial) else { continue };
        let robot = sights.robots.get(follow.robot).or(sights.robots.last());
        let Some(at) = robot else { continue };
        let scaling = ScalingMode::FixedVertical { viewport_height: follow.height };
        look(frame.transform_point(at.extend(0.0)), scaling, &mut place, &mut projection);
    }
}

/// Fits cameras to their maps, and the arrows to the last of them.
pub(super) fn show_maps(
    trials: Query<(&TrialSights, &GlobalTransform), With<TrialView>>,
    mut cameras: Looks<'_, '_, ShowWholeMap>,
    mut marks: Query<&mut Transform, (With<MapMark>, Without<ShowWholeMap>)>,
) {
    let mut arrow = None;
    for (whole, mut place, mut projection) in &mut cameras {
        let Ok((sights, frame)) = trials.get(whole.trial) else { continue };
        let Some(map) = sights.map else { continue };
        let size = (map.size() + 2.0 * whole.margin).max(Vec2::splat(LEAST));
        let scaling = ScalingMode::AutoMin { min_width: size.x, min_height: size.y };
        look(frame.transform_point(map.center().extend(0.0)), scaling, &mut place, &mut projection);
        arrow = Some(ARROW * size.max_element());
    }
    for mut mark in &mut marks {
        if let Some(length) = arrow
            && mark.scale.x != length
        {
            mark.scale = Vec3::new(length, length, 1.0);
        }
    }
}

fn look(
    at: Vec3,
    scaling: ScalingMode,
    place: &mut Mut<'_, Transform>,
    projection: &mut Mut<'_, Projection>,
) {
    let wanted = Transform { translation: at.truncate().extend(place.translation.z), ..**place };
    place.set_if_neq(wanted);
    let known = matches!(&**projection, Projection::Orthographic(seen) if same(seen.scaling_mode, scaling) && seen.scale == 1.0);
    if !known && let Projection::Orthographic(seen) = &mut **projection {
        seen.scaling_mode = scaling;
        seen.scale = 1.0;
    }
}

/// `ScalingMode` has no equality.
fn same(a: ScalingMode, b: ScalingMode) -> bool {
    match (a, b) {
        (
            ScalingMode::FixedVertical { viewport_height: a },
            ScalingMode::FixedVertical { viewport_height: b },
        ) => a == b,
        (
            ScalingMode::AutoMin { min_width: aw, min_height: ah },
            ScalingMode::AutoMin { min_width: bw, min_height: bh },
        ) => (aw, ah) == (bw, bh),
        _ => false,
    }
}
