//! The poses of cameras, and the rays of their pixels.

use bevy::math::DMat3;
use bevy::prelude::*;
use envgen::geometry::Pose;
use envgen::glam::{DQuat, DVec2, DVec3};

use super::settings::RobotCamera;

/// The distance of the near plane of a camera in metres.
pub(super) const NEAR: f32 = 0.02;

/// A pinhole camera without distortion.
///
/// Pixel coordinates are measured from the left and the top edge of the image, so that the centre of the
/// first pixel is at (0.5, 0.5). Programs that measure from the centre of the first pixel subtract 0.5 from
/// the principal point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraOptics {
    /// The number of pixels from left to right.
    pub width: u32,
    /// The number of pixels from top to bottom.
    pub height: u32,
    /// The focal length in pixels, which is the same on both axes.
    pub focal_length: f64,
}

impl CameraOptics {
    /// Returns the optics of a camera.
    pub fn new(camera: &RobotCamera) -> Self {
        let half = 0.5 * camera.field_of_view.to_radians();
        let focal_length = 0.5 * f64::from(camera.width) / libm::tan(half);
        CameraOptics { width: camera.width, height: camera.height, focal_length }
    }

    /// Returns the principal point in pixels, which is the centre of the image.
    pub fn center(&self) -> DVec2 {
        0.5 * DVec2::new(self.width.into(), self.height.into())
    }

    /// Returns the vertical field of view in radians.
    pub fn vertical_field_of_view(&self) -> f64 {
        2.0 * libm::atan2(0.5 * f64::from(self.height), self.focal_length)
    }

    /// Returns the ray through the centre of a pixel, in the axes of the camera (right, up, back). Its
    /// component along the optical axis has a length of 1.
    pub fn ray(&self, column: u32, row: u32) -> DVec3 {
        let pixel = DVec2::new(column.into(), row.into()) + 0.5 - self.center();
        DVec3::new(pixel.x / self.focal_length, -pixel.y / self.focal_length, -1.0)
    }

    /// Returns the projection matrix that Bevy's cameras use, with a depth of 1 at [`NEAR`] and 0 at
    /// infinity.
    pub(super) fn projection(&self) -> Mat4 {
        let aspect = self.width as f32 / self.height as f32;
        Mat4::perspective_infinite_reverse_rh(self.vertical_field_of_view() as f32, aspect, NEAR)
    }
}

/// The pose of a camera in the frame of its world, in metres, with x and y horizontal and z up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraPose {
    /// The position of the pinhole.
    pub position: DVec3,
    /// The axes of the camera as columns: right, up in the image, and backwards along the optical axis, as in
    /// `OpenGL` and in files of radiance fields (`NeRF`).
    pub axes: DMat3,
}

impl CameraPose {
    /// Returns the pose of the camera of a robot.
    pub fn new(robot: Pose, camera: &RobotCamera) -> Self {
        let position = robot.to_world(DVec2::new(camera.forward, camera.left));
        let (sin_yaw, cos_yaw) = libm::sincos(robot.heading + camera.yaw.to_radians());
        let (sin, cos) = libm::sincos(camera.pitch.to_radians());
        let forward = DVec3::new(cos_yaw * cos, sin_yaw * cos, sin);
        let right = DVec3::new(sin_yaw, -cos_yaw, 0.0);
        let axes = DMat3::from_cols(right, right.cross(forward), -forward);
        CameraPose { position: position.extend(camera.up), axes }
    }

    /// Returns the rotation from the axes of the camera to the axes of the world.
    pub fn orientation(&self) -> DQuat {
        DQuat::from_mat3(&self.axes)
    }

    /// Returns the transform of a Bevy camera in the frame of the robot.
    pub(super) fn on_robot(camera: &RobotCamera) -> Transform {
        let pose = CameraPose::new(Pose::new(0.0, 0.0, 0.0), camera);
        Transform::from_translation(pose.position.as_vec3())
            .with_rotation(pose.orientation().as_quat())
    }

    /// Returns the matrix that converts points relative to `origin` to the axes of the camera.
    pub(super) fn view_from(&self, origin: DVec3) -> Mat4 {
        let at = (self.position - origin).as_vec3();
        Mat4::from_rotation_translation(self.orientation().as_quat(), at).inverse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_looks_where_its_robot_looks() {
        let camera = RobotCamera { forward: 0.2, left: 0.1, up: 0.5, ..default() };
        let north = CameraPose::new(Pose::new(3.0, 4.0, std::f64::consts::FRAC_PI_2), &camera);
        assert!(north.position.distance(DVec3::new(2.9, 4.2, 0.5)) < 1e-12);
        let [right, up, back] = [north.axes.x_axis, north.axes.y_axis, north.axes.z_axis];
        assert!(right.distance(DVec3::X) < 1e-12 && up.distance(DVec3::Z) < 1e-12);
        assert!(back.distance(DVec3::NEG_Y) < 1e-12);
        let tilted = RobotCamera { pitch: 90.0, yaw: 90.0, ..camera };
        let tilted = CameraPose::new(Pose::new(0.0, 0.0, 0.0), &tilted);
        assert!(tilted.axes.z_axis.distance(DVec3::NEG_Z) < 1e-12);
        assert!(tilted.axes.x_axis.distance(DVec3::X) < 1e-12);
        assert!(tilted.axes.y_axis.distance(DVec3::NEG_Y) < 1e-12);
    }

    #[test]
    fn pixels_project_where_their_rays_go() {
        let camera = RobotCamera { width: 64, height: 48, field_of_view: 90.0, ..default() };
        let optics = CameraOptics::new(&camera);
        assert!((optics.focal_length - 32.0).abs() < 1e-9);
        for (column, row) in [(0, 0), (63, 47), (20, 31)] {
            let ray = optics.ray(column, row);
            let clip = optics.projection() * (ray * 5.0).as_vec3().extend(1.0);
            let [x, y, depth] = (clip.truncate() / clip.w).to_array();
            let pixel = [(x + 1.0) * 32.0, (1.0 - y) * 24.0];
            assert!((pixel[0] - column as f32 - 0.5).abs() < 1e-4);
            assert!((pixel[1] - row as f32 - 0.5).abs() < 1e-4);
            assert!((depth - NEAR / 5.0).abs() < 1e-6);
        }
    }
}
