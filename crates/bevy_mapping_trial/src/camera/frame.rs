//! What a camera took.

use std::sync::Arc;

use super::labels::Labels;
use super::optics::{CameraOptics, CameraPose};

/// The images of a camera at one time. Each is row by row from the top, `None` where it was not asked for.
#[derive(Clone, Debug)]
pub struct CameraFrame {
    /// The number of the frame, from 0.
    pub number: u64,
    /// Simulated seconds: of the robot's trial, else of Bevy's fixed clock.
    pub time: f64,
    /// Where the camera was, in the frame of the world.
    pub pose: CameraPose,
    /// The optics, and the size of all images.
    pub optics: CameraOptics,
    /// Red, green and blue, as sRGB.
    pub color: Option<Vec<u8>>,
    /// Distance in metres along the optical axis, as in ROS's `32FC1`; infinite where there is nothing.
    pub depth: Option<Vec<f32>>,
    /// The label of what is seen, 0 where there is nothing.
    pub labels: Option<Vec<u32>>,
    /// What labels mean; none for a camera of colours alone.
    pub names: Arc<Labels>,
}
