//! Cameras that follow robots or show the whole map.

use std::collections::BTreeMap;

use bevy::camera::ScalingMode;
use bevy::math::Affine3A;
use bevy::prelude::*;

use super::sights::TrialSights;
use super::trial_view::TrialView;

/// A component that keeps a two-dimensional camera above the estimated position of a robot of a trial.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct FollowRobot {
    /// The environment of the trial.
    #[entities]
    pub trial: Entity,
    /// The index of the robot, counted from 0. Numbers that are too large select the last robot.
    pub robot: usize,
    /// The height of the visible area in metres of the environment.
    pub height: f32,
}

/// A component that keeps the whole map of a trial, and at least a square of 10 m, in the view of a
/// two-dimensional camera.
///
/// With [`RenderLayers`](bevy::camera::visibility::RenderLayers) 0 and
/// [`MINIMAP_LAYER`](super::MINIMAP_LAYER), the camera also shows arrows at the positions of the robots.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct ShowWholeMap {
    /// The environment of the trial.
    #[entities]
    pub trial: Entity,
    /// The margin around the map in metres of the environment.
    pub margin: f32,
}

/// The smallest side in metres of the area that a [`ShowWholeMap`] shows.
const LEAST: f32 = 10.0;

/// The length of the arrow of a robot, as a fraction of the longer side of the area that a [`ShowWholeMap`]
/// shows.
const ARROW: f32 = 0.06;

/// A component of an arrow at the position of a robot, for maps.
#[derive(Component)]
pub(super) struct MapMark {
    /// The environment of the trial.
    pub(super) trial: Entity,
}

/// What a camera shows, in metres of the environment.
#[derive(Clone, Copy)]
enum Shown {
    /// An area of this height.
    Height(f32),
    /// An area with at least these sides, which are parallel to the axes of the environment.
    Area(Vec2),
}

/// The parent of a camera.
type Above<'a> = Option<&'a ChildOf>;

/// The transforms of cameras and arrows, and access to global transforms before Bevy propagates them.
type Places<'w, 's> = ParamSet<
    'w,
    's,
    (
        TransformHelper<'static, 'static>,
        Query<'static, 'static, (&'static mut Transform, &'static mut Projection)>,
        Query<'static, 'static, (&'static MapMark, &'static mut Transform)>,
    ),
>;

/// Moves cameras to their robots.
pub(super) fn follow(
    trials: Query<&TrialSights, With<TrialView>>,
    cameras: Query<(Entity, &FollowRobot, Above<'_>)>,
    mut places: Places<'_, '_>,
) {
    for (camera, follow, above) in &cameras {
        let Ok(sights) = trials.get(follow.trial) else { continue };
        let robot = sights.robots.get(follow.robot).or(sights.robots.last());
        let Some(&at) = robot else { continue };
        look(&mut places, camera, above, (follow.trial, at), Shown::Height(follow.height));
    }
}

/// Fits cameras to their maps, and the arrows of each trial to the last of its cameras.
pub(super) fn show_maps(
    trials: Query<&TrialSights, With<TrialView>>,
    cameras: Query<(Entity, &ShowWholeMap, Above<'_>)>,
    mut places: Places<'_, '_>,
) {
    let mut arrows = BTreeMap::new();
    for (camera, whole, above) in &cameras {
        let Ok(sights) = trials.get(whole.trial) else { continue };
        let Some(map) = sights.map else { continue };
        let size = (map.size() + 2.0 * whole.margin).max(Vec2::splat(LEAST));
        look(&mut places, camera, above, (whole.trial, map.center()), Shown::Area(size));
        arrows.insert(whole.trial, ARROW * size.max_element());
    }
    for (mark, mut place) in &mut places.p2() {
        if let Some(&length) = arrows.get(&mark.trial)
            && place.scale.x != length
        {
            place.scale = Vec3::new(length, length, 1.0);
        }
    }
}

/// Points a camera at a point of an environment.
fn look(
    places: &mut Places<'_, '_>,
    camera: Entity,
    above: Above<'_>,
    (environment, at): (Entity, Vec2),
    shown: Shown,
) {
    let frames = places.p0();
    let Ok(frame) = frames.compute_global_transform(environment) else { return };
    let at = frame.transform_point(at.extend(0.0));
    let above = above.and_then(|above| frames.compute_global_transform(above.parent()).ok());
    let into_parent = above.map_or(Affine3A::IDENTITY, |above| above.affine().inverse());
    let at = into_parent.transform_point3(at);
    let [x, y] = [Vec3::X, Vec3::Y].map(|axis| frame.affine().transform_vector3(axis));
    let mut cameras = places.p1();
    let Ok((mut place, mut projection)) = cameras.get_mut(camera) else { return };
    let wanted = Transform { translation: at.truncate().extend(place.translation.z), ..*place };
    place.set_if_neq(wanted);
    // The axes of the environment in the frame of the camera.
    let into_camera = Transform { translation: Vec3::ZERO, ..wanted }.compute_affine().inverse();
    let [x, y] = [x, y]
        .map(|axis| into_camera.transform_vector3(into_parent.transform_vector3(axis)).truncate());
    if !(x.is_finite() && y.is_finite() && x.perp_dot(y) != 0.0) {
        return;
    }
    let scaling = match shown {
        // The height of a circle of this diameter. The parent of the camera may be scaled differently along
        // its axes.
        Shown::Height(height) => {
            let viewport_height = height * Vec2::new(x.y, y.y).length();
            ScalingMode::FixedVertical { viewport_height }
        }
        Shown::Area(size) => {
            let around = x.abs() * size.x + y.abs() * size.y;
            ScalingMode::AutoMin { min_width: around.x, min_height: around.y }
        }
    };
    let known = match &*projection {
        Projection::Orthographic(seen) => same(seen.scaling_mode, scaling) && seen.scale == 1.0,
        _ => false,
    };
    if !known && let Projection::Orthographic(seen) = &mut *projection {
        seen.scaling_mode = scaling;
        seen.scale = 1.0;
    }
}

/// Compares scaling modes, since `ScalingMode` has no equality.
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
