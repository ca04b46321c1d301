//! The cameras on the robots.
//!
//! Each robot has a camera that draws into an image. The driven robot's image is large while it is
//! requested; all others are small. The panels show the images.

use bevy::camera::{PerspectiveProjection, RenderTarget};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::math::ops;
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy::render::renderer::RenderAdapterInfo;
use bevy_mapping_trial::camera::RobotCamera;
use bevy_mapping_trial::prelude::*;
use bevy_mapping_trial::ui::bevy_egui::{EguiTextureHandle, EguiUserTextures};
use bevy_mapping_trial::ui::egui;
use mapping_trial::trial::MAX_ROBOTS;

use crate::samples::{is_software, samples};
use crate::session::{Phase, Session};

/// Aspect ratio of pictures: about that of the space that the panel leaves in a window.
pub(crate) const ASPECT: f32 = 4.0 / 3.0;

/// Horizontal field of view in degrees.
const FIELD_OF_VIEW: f32 = 80.0;

/// Height of a small picture as a fraction of that of the large one.
const SMALL: f32 = 0.5;

/// Distance of the near plane in metres, so that a robot at a wall does not see through it.
const NEAR: f32 = 0.03;

/// Number of rows of the large picture with and without a graphics card.
const ROWS: [u32; 2] = [720, 240];

/// Number of frames from one small picture to the next.
const FRAMES_PER_SMALL: u32 = 3;

/// Duration of frames in seconds from which the driven robot, too, has a picture only in every other
/// frame.
const SLOW: f32 = 0.1;

/// The images into which the cameras draw.
#[derive(Resource)]
pub(crate) struct RobotPictures {
    large: DrawnCamera,
    small: Vec<DrawnCamera>,
    samples: Msaa,
    frame: u32,
}

struct DrawnCamera {
    image: Handle<Image>,
    texture: egui::TextureId,
}

/// The camera of a robot.
#[derive(Component)]
pub(crate) struct RobotEye {
    /// Index of the robot, from 0.
    robot: usize,
    /// Pose of the camera on the robot.
    mount: Transform,
    /// The robot's poses at the last two ticks.
    poses: [Transform; 2],
}

/// Spawns the images with `rows` rows, or with as many as the graphics driver is fast enough for.
pub(crate) fn spawn_pictures(
    In(rows): In<Option<u32>>,
    adapter: Res<RenderAdapterInfo>,
    mut images: ResMut<Assets<Image>>,
    mut textures: ResMut<EguiUserTextures>,
    mut commands: Commands,
) {
    let rows = rows.unwrap_or(if is_software(&adapter) { ROWS[1] } else { ROWS[0] }) as f32;
    let mut picture = |rows: f32| {
        let [width, height] = [ASPECT * rows, rows].map(|side| side.round().max(1.0) as u32);
        let format = TextureFormat::Bgra8UnormSrgb;
        let image = images.add(Image::new_target_texture(width, height, format, None));
        let texture = textures.add_image(EguiTextureHandle::Strong(image.clone()));
        DrawnCamera { image, texture }
    };
    commands.insert_resource(RobotPictures {
        large: picture(rows),
        small: (0..MAX_ROBOTS).map(|_| picture(SMALL * rows)).collect(),
        samples: samples(&adapter),
        frame: 0,
    });
}

impl RobotPictures {
    /// Returns the picture of a robot, which is the large one for the driven robot while that is
    /// requested.
    fn of(&self, robot: usize, session: &Session) -> Option<&DrawnCamera> {
        if robot == session.driven && session.camera_is_large {
            return Some(&self.large);
        }
        self.small.get(robot)
    }

    /// Returns the texture of a robot's picture.
    pub(crate) fn texture(&self, robot: usize, session: &Session) -> Option<egui::TextureId> {
        self.of(robot, session).map(|picture| picture.texture)
    }
}

/// Gives a robot of a trial a camera.
pub(crate) fn equip(
    added: On<Add, TrialRobot>,
    robots: Query<(&TrialRobot, &RobotModel)>,
    pictures: Res<RobotPictures>,
    mut commands: Commands,
) {
    let Ok((&TrialRobot { index: robot }, model)) = robots.get(added.entity) else { return };
    let Some(picture) = pictures.small.get(robot) else { return };
    commands.entity(added.entity).insert(Visibility::default());
    let RobotCamera { forward, up, .. } = RobotCamera::on(model);
    let place = Vec3::new(forward as f32, 0.0, up as f32);
    let mount = Transform::from_translation(place).looking_to(Vec3::X, Vec3::Z);
    let across = ops::tan((0.5 * FIELD_OF_VIEW).to_radians());
    commands.spawn((
        Name::new(format!("camera of robot {robot}")),
        RobotEye { robot, mount, poses: [Transform::IDENTITY; 2] },
        Camera3d::default(),
        Camera { order: -1 - robot as isize, ..default() },
        Projection::from(PerspectiveProjection {
            fov: 2.0 * ops::atan(across / ASPECT),
            near: NEAR,
            ..default()
        }),
        RenderTarget::from(picture.image.clone()),
        Tonemapping::KhronosPbrNeutral,
        pictures.samples,
        mount,
        ChildOf(added.entity),
    ));
}

/// Records where the robots were at the last two ticks.
pub(crate) fn note_poses(
    mut eyes: Query<(&mut RobotEye, &ChildOf)>,
    robots: Query<&Transform, With<TrialRobot>>,
) {
    for (mut eye, parent) in &mut eyes {
        if let Ok(pose) = robots.get(parent.parent()) {
            eye.poses = [eye.poses[1], *pose];
        }
    }
}

/// Draws the visible pictures: that of the driven robot in each frame, or in every other one if drawing
/// is slow, and those of the others in turn. Between two ticks the cameras are interpolated.
pub(crate) fn look(
    mut pictures: ResMut<RobotPictures>,
    session: Res<Session>,
    (time, clock): (Res<Time<Fixed>>, Res<Time<Real>>),
    mut eyes: Query<(&RobotEye, &ChildOf, &mut Transform, &mut Camera, &mut RenderTarget)>,
    robots: Query<&Transform, (With<TrialRobot>, Without<RobotEye>)>,
) {
    pictures.frame = pictures.frame.wrapping_add(1);
    let running = session.phase == Phase::Running;
    let frames_per_driven = if clock.delta_secs() > SLOW { 2 } else { 1 };
    for (eye, parent, mut place, mut camera, mut target) in &mut eyes {
        let is_driven = eye.robot == session.driven;
        let period = if is_driven { frames_per_driven } else { FRAMES_PER_SMALL };
        let wanted =
            running && pictures.frame.wrapping_add(eye.robot as u32).is_multiple_of(period);
        if camera.is_active != wanted {
            camera.is_active = wanted;
        }
        if let Some(picture) = pictures.of(eye.robot, &session)
            && target.as_image() != Some(&picture.image)
        {
            *target = picture.image.clone().into();
        }
        if let Ok(robot) = robots.get(parent.parent()) {
            place.set_if_neq(between(eye, *robot, time.overstep_fraction()) * eye.mount);
        }
    }
}

/// Returns the pose between the last two ticks, relative to the present pose of the robot.
fn between(eye: &RobotEye, robot: Transform, share: f32) -> Transform {
    let [from, to] = eye.poses;
    // Robots that were just spawned or moved did not drive there, so that their poses are not
    // interpolated.
    if from.translation.distance(to.translation) > 1.0 {
        return Transform::IDENTITY;
    }
    let at = Transform {
        translation: from.translation.lerp(to.translation, share),
        rotation: from.rotation.slerp(to.rotation, share),
        scale: Vec3::ONE,
    };
    Transform::from_matrix(robot.to_matrix().inverse() * at.to_matrix())
}
