//! An app that draws without a window.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use bevy::app::PluginsState;
use bevy::asset::AssetPlugin;
use bevy::camera::{CameraPlugin, RenderTarget, ScalingMode};
use bevy::core_pipeline::CorePipelinePlugin;
#[cfg(feature = "render3d")]
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::diagnostic::FrameCountPlugin;
use bevy::image::ImagePlugin;
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::render_resource::{PollType, TextureFormat};
use bevy::render::renderer::RenderDevice;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::sprite::SpritePlugin;
use bevy::sprite_render::SpriteRenderPlugin;
use bevy::tasks::block_on;
use bevy::time::{TimePlugin, TimeUpdateStrategy};
use bevy::window::{ExitCondition, WindowPlugin};

use crate::captured_image::CapturedImage;
use crate::error::{CaptureError, MAX_SIDE, MOST_FRAMES};
use crate::request::{CapturePlugin, Supersampling};

/// The distance of the near plane of cameras in perspective, in the units of the app.
#[cfg(feature = "render3d")]
const NEAR: f32 = 0.02;

/// The number of pixels along each side that are drawn per pixel of a three-dimensional picture. The result
/// is as smooth as that of four samples of the driver, which take a software renderer several times as long.
#[cfg(feature = "render3d")]
const SAMPLES: u32 = 2;

/// The margin around an area on each side, as a fraction of its size.
const MARGIN: f32 = 0.03;

/// Returns the name of the graphics card or of the software renderer, for instance Mesa's `llvmpipe`.
///
/// # Errors
/// Returns [`CaptureError::NoRenderer`], which says what to install, where Bevy's `RenderPlugin` would panic.
pub fn find_renderer() -> Result<String, CaptureError> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::from_env().unwrap_or(wgpu::Backends::all()),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    match block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())) {
        Ok(adapter) => Ok(adapter.get_info().name),
        Err(error) => Err(CaptureError::NoRenderer { reason: error.to_string() }),
    }
}

/// Returns the width and the height that a camera shows for an area.
fn with_margin(area: Rect) -> Result<Vec2, CaptureError> {
    let size = area.size() * (1.0 + 2.0 * MARGIN);
    let corners = [area.min, area.max, area.min + area.max, size];
    if corners.iter().all(|corner| corner.is_finite()) && size.min_element() >= 0.0 {
        return Ok(size.max(Vec2::splat(1e-3)));
    }
    Err(CaptureError::Area { found: area })
}

/// An app that draws into images, without a window or a display.
///
/// Frames run only on request, and the time of the app advances per frame by the time of
/// [`Studio::set_frame_time`].
pub struct Studio {
    app: App,
    begun: bool,
}

impl Studio {
    /// Creates an app with Bevy's plugins for two-dimensional drawing, and for three-dimensional drawing if
    /// the feature `render3d` is on, and with [`CapturePlugin`]. More plugins can be added before the first
    /// frame.
    ///
    /// # Errors
    /// [`CaptureError::NoRenderer`].
    pub fn new() -> Result<Self, CaptureError> {
        // Before the macro, which evaluates its arguments only where such messages are logged.
        let renderer = find_renderer()?;
        log::debug!("drawing by {renderer}");
        let mut app = App::new();
        app.add_plugins((
            TaskPoolPlugin::default(),
            FrameCountPlugin,
            TimePlugin,
            TransformPlugin,
            bevy::input::InputPlugin,
            // Bevy's renderer needs the types of windows, although there are no windows here.
            WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            },
            AssetPlugin::default(),
            RenderPlugin { synchronous_pipeline_compilation: true, ..default() },
            ImagePlugin::default(),
            MeshPlugin,
            CameraPlugin,
            CorePipelinePlugin,
            SpritePlugin,
            SpriteRenderPlugin,
        ));
        #[cfg(feature = "render3d")]
        app.add_plugins((
            // Bevy's plugin for lights draws gizmos for debugging.
            bevy::gizmos::GizmoPlugin,
            bevy::light::LightPlugin,
            bevy::pbr::PbrPlugin::default(),
        ));
        app.add_plugins(CapturePlugin);
        let mut studio = Studio { app, begun: false };
        studio.set_frame_time(Duration::from_secs_f64(1.0 / 64.0));
        Ok(studio)
    }

    /// Returns the Bevy app.
    pub fn app(&mut self) -> &mut App {
        &mut self.app
    }

    /// Sets the time by which the app advances per frame, independently of the clock.
    pub fn set_frame_time(&mut self, time: Duration) {
        self.app.insert_resource(TimeUpdateStrategy::ManualDuration(time));
    }

    /// Runs and draws one frame.
    ///
    /// # Errors
    /// Returns an error if the driver fails.
    pub fn step(&mut self) -> Result<(), CaptureError> {
        if !self.begun {
            while self.app.plugins_state() == PluginsState::Adding {
                bevy::tasks::tick_global_task_pools_on_main_thread();
            }
            self.app.finish();
            self.app.cleanup();
            self.begun = true;
        }
        self.app.update();
        if let Some(device) = self.app.world().get_resource::<RenderDevice>() {
            let wait = PollType::Wait { submission_index: None, timeout: None };
            device
                .poll(wait)
                .map_err(|error| CaptureError::NoRenderer { reason: error.to_string() })?;
        }
        Ok(())
    }

    /// Spawns a camera that looks down on an area, all of which is visible in the picture.
    ///
    /// # Errors
    /// Returns an error if the area or the size is out of range.
    pub fn camera(&mut self, area: Rect, size: UVec2) -> Result<Entity, CaptureError> {
        let [width, height] = with_margin(area)?.to_array();
        let target = self.target(size, 1)?;
        let camera = (
            Camera2d,
            target,
            Projection::Orthographic(OrthographicProjection {
                scaling_mode: ScalingMode::AutoMin { min_width: width, min_height: height },
                ..OrthographicProjection::default_2d()
            }),
            Transform::from_translation(area.center().extend(0.0)),
        );
        Ok(self.app.world_mut().spawn(camera).id())
    }

    /// Spawns a perspective camera that looks along -z of its pose, with +y up in the picture, as
    /// [`Transform::looking_at`] defines it. The field of view is the angle from the bottom to the top of the
    /// picture in radians. The camera uses [`Tonemapping::KhronosPbrNeutral`], which keeps the colours of
    /// materials.
    ///
    /// Four pixels are drawn per pixel of a picture, so the sides of a picture must be at most half of
    /// [`MAX_SIDE`]. [`Studio::picture`] and [`TakePicture`](crate::TakePicture) average them. Other users of
    /// the camera's image see all pixels.
    ///
    /// ```no_run
    /// # use bevy::prelude::*;
    /// # let mut studio = bevy_offscreen::Studio::new()?;
    /// let pose = Transform::from_xyz(-4.0, 0.0, 1.6).looking_at(Vec3::ZERO, Vec3::Z);
    /// let camera = studio.camera_3d(pose, 1.0, UVec2::new(800, 600))?;
    /// studio.picture(camera)?.write_png("room.png")?;
    /// # Ok::<(), bevy_offscreen::CaptureError>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the size, the field of view or the pose is out of range.
    #[cfg(feature = "render3d")]
    pub fn camera_3d(
        &mut self,
        pose: Transform,
        field_of_view: f32,
        size: UVec2,
    ) -> Result<Entity, CaptureError> {
        if !(field_of_view > 0.0 && field_of_view < std::f32::consts::PI) {
            return Err(CaptureError::FieldOfView { found: field_of_view });
        }
        if !(pose.is_finite() && pose.rotation.is_normalized()) {
            return Err(CaptureError::Pose { found: pose });
        }
        let target = self.target(size, SAMPLES)?;
        let camera = (
            Camera3d::default(),
            Msaa::Off,
            Supersampling(SAMPLES),
            target,
            Projection::Perspective(PerspectiveProjection {
                fov: field_of_view,
                near: NEAR,
                ..default()
            }),
            Tonemapping::KhronosPbrNeutral,
            pose,
        );
        Ok(self.app.world_mut().spawn(camera).id())
    }

    /// Creates an image to draw into, for pictures of a given size.
    fn target(&mut self, size: UVec2, samples: u32) -> Result<RenderTarget, CaptureError> {
        let largest = MAX_SIDE / samples;
        let sides = 1..=largest;
        if !(sides.contains(&size.x) && sides.contains(&size.y)) {
            return Err(CaptureError::Size { width: size.x, height: size.y, largest });
        }
        let drawn = size * samples;
        let image =
            Image::new_target_texture(drawn.x, drawn.y, TextureFormat::Rgba8UnormSrgb, None);
        let image = self.app.world_mut().resource_mut::<Assets<Image>>().add(image);
        Ok(RenderTarget::Image(image.into()))
    }

    /// Returns the current picture of a camera.
    ///
    /// Extra frames are drawn for it, in which the time of the app does not advance. An inactive camera draws
    /// only in these frames, which saves time if many frames pass per picture.
    ///
    /// # Errors
    /// Returns an error if the entity is not a camera, or if the driver fails.
    pub fn picture(&mut self, camera: Entity) -> Result<CapturedImage, CaptureError> {
        let target = self.app.world().get_entity(camera).ok().filter(|c| c.contains::<Camera>());
        let found = target.and_then(|camera| {
            camera.get_components::<(&RenderTarget, Option<&Supersampling>)>().ok()
        });
        let Some((target, samples)) = found else {
            return Err(CaptureError::NoCamera { camera });
        };
        let (target, side) = (target.clone(), samples.map_or(1, |samples| samples.0));
        let clock = self.app.world_mut().remove_resource::<TimeUpdateStrategy>();
        self.set_frame_time(Duration::ZERO);
        let active = self.activate(camera, true);
        let picture = self.take(camera, target, side);
        self.activate(camera, active);
        if let Some(clock) = clock {
            self.app.insert_resource(clock);
        }
        picture
    }

    /// Sets whether a camera is active, and returns whether it was active before.
    fn activate(&mut self, camera: Entity, active: bool) -> bool {
        let camera = self.app.world_mut().get_mut::<Camera>(camera);
        camera.is_some_and(|mut camera| std::mem::replace(&mut camera.is_active, active))
    }

    /// Takes the picture of an active camera, which is inactive afterwards.
    fn take(
        &mut self,
        camera: Entity,
        target: RenderTarget,
        side: u32,
    ) -> Result<CapturedImage, CaptureError> {
        // Draws a frame first, for entities that were spawned since the last one.
        self.step()?;
        let taken = Arc::new(Mutex::new(None));
        let film = taken.clone();
        self.app.world_mut().spawn(Screenshot(target)).observe(
            move |captured: On<ScreenshotCaptured>| {
                *film.lock().unwrap_or_else(PoisonError::into_inner) =
                    Some(CapturedImage::averaged(&captured.image, side));
            },
        );
        self.step()?;
        // The image of that frame arrives in one of the next frames, which need not be drawn.
        self.activate(camera, false);
        for _ in 0..MOST_FRAMES {
            self.step()?;
            if let Some(picture) = taken.lock().unwrap_or_else(PoisonError::into_inner).take() {
                return picture;
            }
        }
        Err(CaptureError::Lost { frames: MOST_FRAMES })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_are_finite_and_in_order() {
        let area = |x: f32| Rect { min: Vec2::ZERO, max: Vec2::new(x, 5.0) };
        let shown = with_margin(area(0.0)).expect("a line has a height");
        assert!(shown.distance(Vec2::new(1e-3, 5.3)) < 1e-5, "{shown}");
        for x in [f32::NAN, f32::INFINITY, f32::MAX, -1.0] {
            let error = with_margin(area(x)).expect_err("a wrong area").to_string();
            assert!(error.contains("area") && error.contains(&format!("{x:?}")), "{error}");
        }
    }
}
