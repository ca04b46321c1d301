//! The images that a camera takes at one time.

use std::sync::Arc;

use super::labels::Labels;
use super::optics::{CameraOptics, CameraPose};

/// The images that a camera took at one time. Each is row by row from the top, or `None` if it was not
/// requested.
#[derive(Clone, Debug)]
pub struct CameraFrame {
    /// The number of the frame, counted from 0.
    pub number: u64,
    /// The simulated time in seconds, of the robot's trial if it has one, or else of Bevy's fixed clock.
    pub time: f64,
    /// The pose of the camera in the frame of the world.
    pub pose: CameraPose,
    /// The optics, which include the size of all images.
    pub optics: CameraOptics,
    /// The colour image as red, green and blue values in sRGB.
    pub color: Option<Vec<u8>>,
    /// The distance of each pixel in metres along the optical axis, as in the encoding `32FC1` of ROS. It is
    /// infinite if there is no surface.
    pub depth: Option<Vec<f32>>,
    /// The label of the surface at each pixel, or 0 if there is no surface.
    pub labels: Option<Vec<u32>>,
    /// The meaning of the labels. It is empty for a camera that takes only colour images.
    pub names: Arc<Labels>,
}
