//! Levels of detail: trees that are far from every camera are drawn with fewer triangles.

use std::sync::Arc;

use bevy::prelude::*;

use super::settings::Visuals3dSettings;
use crate::environment::Environment;

/// The number of levels.
pub(super) const LEVELS: usize = 3;

/// The distance at which the coarsest level begins, as a multiple of the distance at which the finest one
/// ends.
const COARSEST: f32 = 2.5;

/// The distance, in global units as those of the levels, that a camera must move in an environment before the
/// levels are chosen again.
const MOVED: f32 = 1.0;

/// The relative change of an environment's scale after which the levels are chosen again.
const RESIZED: f32 = 0.01;

/// A component with the meshes of a trunk or crown, from the finest to the coarsest.
#[derive(Component)]
pub(super) struct TreeLevels(pub(super) Arc<[Handle<Mesh>; LEVELS]>);

/// The place of a camera in an environment, and the scale of the environment.
pub(super) struct Place {
    at: Vec3,
    scale: Vec3,
}

impl Place {
    /// Returns the place of a camera at a global position, or `None` in an environment without a size.
    fn new(frame: &GlobalTransform, eye: Vec3) -> Option<Place> {
        let at = frame.affine().inverse().transform_point3(eye);
        at.is_finite().then(|| Place { at, scale: frame.scale() })
    }

    fn has_moved(&self, since: &Place) -> bool {
        let resized = (self.scale - since.scale).abs().cmpgt(RESIZED * since.scale.abs()).any();
        resized || (self.scale * (self.at - since.at)).length() > MOVED
    }
}

/// Returns the level for a distance to the nearest camera.
fn level(distance: f32, detail_distance: f32) -> usize {
    [1.0, COARSEST].iter().filter(|&&factor| distance > factor * detail_distance).count()
}

/// Sets the mesh of each trunk and crown for its distance to the nearest camera.
pub(super) fn choose_levels(
    settings: Res<Visuals3dSettings>,
    cameras: Query<(&GlobalTransform, &Camera, &Projection), With<Camera3d>>,
    environments: Query<&GlobalTransform, With<Environment>>,
    planted: Query<(), Added<TreeLevels>>,
    mut bodies: Query<(&GlobalTransform, &TreeLevels, &mut Mesh3d)>,
    mut chosen_for: Local<(Vec<Place>, f32)>,
) {
    let cameras = || cameras.iter().filter(|(_, camera, _)| camera.is_active);
    let eyes: Vec<Vec3> = cameras().map(|(at, ..)| at.translation()).collect();
    // In an orthographic projection distant trees are not smaller.
    let is_flat = cameras().any(|(.., how)| matches!(how, Projection::Orthographic(_)));
    let detail_distance = if is_flat { f32::INFINITY } else { settings.detail_distance };
    // An app may move environments instead of cameras.
    let places: Vec<Place> = environments
        .iter()
        .flat_map(|frame| eyes.iter().filter_map(move |eye| Place::new(frame, *eye)))
        .collect();
    let (then, distance_then) = &*chosen_for;
    let has_moved = places.len() != then.len()
        || places.iter().zip(then).any(|(now, then)| now.has_moved(then));
    let is_due = has_moved
        // A NaN is no change.
        || detail_distance.to_bits() != distance_then.to_bits()
        || !planted.is_empty();
    if eyes.is_empty() && !planted.is_empty() {
        // The next camera finds trees without a level, even where the last one was.
        chosen_for.0.clear();
    }
    if eyes.is_empty() || !is_due {
        return;
    }
    bodies.par_iter_mut().for_each(|(at, levels, mut mesh)| {
        let at = at.translation();
        let distances = eyes.iter().map(|eye| eye.distance_squared(at));
        let nearest = distances.fold(f32::INFINITY, f32::min).sqrt();
        let wanted = &levels.0[level(nearest, detail_distance)];
        if mesh.0 != *wanted {
            mesh.0 = wanted.clone();
        }
    });
    *chosen_for = (places, detail_distance);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_coarser_farther_away() {
        assert_eq!(
            [0.0, 59.0, 61.0, 149.0, 151.0, 1e9].map(|d| level(d, 60.0)),
            [0, 0, 1, 1, 2, 2]
        );
        assert_eq!(level(1e9, f32::INFINITY), 0);
        assert_eq!(level(1e9, f32::NAN), 0);
        assert_eq!(level(1.0, 0.0), 2);
    }
}
