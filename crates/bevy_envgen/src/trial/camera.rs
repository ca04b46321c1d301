//! What the robots' cameras show of water.

use envgen::World;
use envgen::geometry::Pose;
use envgen::glam::DVec2;
use envgen::raycast::Raycaster;
use envgen::surface_index::SurfaceIndex;
use mapping_trial::robot::Robot;
use mapping_trial::water;

/// The world as robots see it by camera.
pub(super) struct Camera {
    grounds: SurfaceIndex,
    rays: Raycaster,
}

impl Camera {
    pub(super) fn new(world: &World) -> Self {
        Camera { grounds: SurfaceIndex::new(world), rays: Raycaster::new(world) }
    }

    /// The points that a robot at a pose of the world sees to be water, in its own frame.
    pub(super) fn water(&self, robot: &Robot, pose: Pose) -> Vec<DVec2> {
        water::seen(&self.grounds, &self.rays, robot, pose)
    }
}
