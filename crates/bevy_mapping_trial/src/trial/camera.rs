//! The detection of water by the cameras of robots.

use envgen::World;
use envgen::geometry::Pose;
use envgen::glam::DVec2;
use envgen::raycast::Raycaster;
use envgen::surface_index::SurfaceIndex;
use mapping_trial::robot::Robot;
use mapping_trial::water;

/// The world as the cameras of robots detect it.
pub(super) struct Camera {
    grounds: SurfaceIndex,
    rays: Raycaster,
}

impl Camera {
    pub(super) fn new(world: &World) -> Self {
        Camera { grounds: SurfaceIndex::new(world), rays: Raycaster::new(world) }
    }

    /// Returns the points of water that a robot at a pose in the world detects, in the frame of the robot.
    pub(super) fn water(&self, robot: &Robot, pose: Pose) -> Vec<DVec2> {
        water::seen(&self.grounds, &self.rays, robot, pose)
    }
}
