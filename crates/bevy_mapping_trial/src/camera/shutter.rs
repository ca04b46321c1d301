//! Takes the pictures that are due, with Bevy's cameras for colour images.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::camera::RenderTarget;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::ecs::system::SystemParam;
use bevy::math::DAffine3;
use bevy::prelude::*;
use bevy::render::gpu_readback::{Readback, ReadbackComplete};
use bevy::render::render_resource::{TextureFormat, TextureUsages};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy_envgen::visuals3d::Visuals3dSettings;
use bevy_envgen::{EndlessTruth, Environment, GroundTruth, ScenarioRun, SpawnedOrigin};
use bevy_offscreen::DrawnFrames;

use super::frame::CameraFrame;
use super::labels::Labels;
use super::moving::{Movers, SceneFrame};
use super::optics::{CameraOptics, CameraPose, NEAR};
use super::pass::{NumberPass, SceneBuffer};
use super::scene::Scene;
use super::settings::{CameraError, RobotCamera};
use crate::robot::{TruePose, Wheels};
use crate::trial::{MappingTrial, in_world};

/// How early a picture may be to count as due, as a fraction of the time between two pictures.
const ROUNDING: f64 = 1e-6;

/// The number of frames after which colours that have not arrived are lost.
const MOST_FRAMES: u32 = 100;

/// An event that is triggered on a robot when its camera has taken a picture.
#[derive(EntityEvent, Clone, Debug)]
pub struct CameraFrameTaken {
    /// The robot.
    pub entity: Entity,
    /// The images.
    pub frame: Arc<CameraFrame>,
}

/// An event that is triggered on a robot when its camera cannot take pictures. It is not triggered again
/// for the same error until a picture is complete, or another [`RobotCamera`] is inserted.
///
/// A camera that has no finite world takes pictures as soon as there is one. A camera whose colours were lost
/// continues. After any other error, a camera takes no pictures until another [`RobotCamera`] is inserted.
#[derive(EntityEvent, Clone, Debug)]
pub struct CameraFailed {
    /// The robot.
    pub entity: Entity,
    /// The error.
    pub error: CameraError,
}

/// A component with the camera that draws the colours of a [`RobotCamera`], on the same entity. Scenes and
/// clones do not hold it, since they get a camera of their own.
#[derive(Component, Clone, Debug, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(from_reflect = false)]
#[reflect(Component, Debug)]
pub struct RobotCameraView {
    /// The image with the last picture, for panels and sprites.
    pub image: Handle<Image>,
    /// The entity with the [`Camera3d`], a child of the robot. The camera is active only while it takes a
    /// picture.
    pub camera: Entity,
}

/// A marker component of the camera of a [`RobotCameraView`]. Scenes and clones hold it, so that their
/// cameras can be found.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub(super) struct Eye;

/// A component that records which of the pictures that are due have been taken.
#[derive(Component, Default)]
pub(super) struct Shutter {
    last: Option<u64>,
    taken: u64,
    /// The number of pictures that were dropped because their colours were not complete.
    dropped: u64,
    /// The number of these since the last complete picture.
    dropped_in_a_row: u32,
    /// The last error that was reported since the last complete picture.
    reported: Option<CameraError>,
}

impl Shutter {
    /// Reports an error, unless it was the last to be reported since the last complete picture.
    fn report(&mut self, robot: Entity, error: CameraError, commands: &mut Commands) {
        if self.reported.as_ref() != Some(&error) {
            self.reported = Some(error.clone());
            log::warn!("robot {robot}: {error}");
            commands.trigger(CameraFailed { entity: robot, error });
        }
    }
}

/// A component with a picture whose colours have not arrived yet.
#[derive(Component)]
pub(super) struct Exposure {
    robot: Entity,
    frame: CameraFrame,
    age: u32,
    /// The frame of Bevy in which the colours are drawn.
    drawn_in: u64,
    /// What [`Shutter::last`] was after the picture was taken.
    due: Option<u64>,
}

/// A resource with the worlds that cameras have seen, and the render pass that draws them.
#[derive(Resource, Default)]
pub(super) struct Scenes {
    pass: Option<NumberPass>,
    known: BTreeMap<Entity, KnownScene>,
}

/// A world on the graphics card.
struct KnownScene {
    world: Arc<envgen::World>,
    movers: [usize; 2],
    has_ceilings: bool,
    scene: Scene,
    names: Arc<Labels>,
    buffer: SceneBuffer,
}

/// Adds the components that a camera needs.
pub(super) fn fit(
    added: On<Insert, RobotCamera>,
    cameras: Query<&RobotCamera>,
    images: Option<ResMut<Assets<Image>>>,
    mut commands: Commands,
) {
    let robot = added.entity;
    let Ok(camera) = cameras.get(robot) else { return };
    let mut fail = |error: CameraError| {
        log::warn!("robot {robot}: {error}");
        commands.trigger(CameraFailed { entity: robot, error });
    };
    if let Err(error) = camera.check() {
        return fail(error);
    }
    if !camera.images.color {
        commands.entity(robot).try_insert(Shutter::default());
        return;
    }
    let Some(mut images) = images else { return fail(CameraError::NoRenderer) };
    let format = TextureFormat::Rgba8UnormSrgb;
    let mut image = Image::new_target_texture(camera.width, camera.height, format, None);
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let image = images.add(image);
    let optics = CameraOptics::new(camera);
    let perspective = PerspectiveProjection {
        fov: optics.vertical_field_of_view() as f32,
        near: NEAR,
        near_clip_plane: Vec4::new(0.0, 0.0, -1.0, -NEAR),
        ..default()
    };
    let eye = (
        Name::new("Robot's camera"),
        Eye,
        Camera3d::default(),
        Camera { is_active: false, ..default() },
        RenderTarget::Image(image.clone().into()),
        Projection::Perspective(perspective),
        Tonemapping::KhronosPbrNeutral,
        Msaa::Off,
        CameraPose::on_robot(camera),
    );
    commands.queue(move |world: &mut World| {
        // Another observer may have despawned the robot or removed its camera.
        if world.get::<RobotCamera>(robot).is_none() {
            return;
        }
        let camera = world.spawn((eye, ChildOf(robot))).id();
        if let Ok(mut robot) = world.get_entity_mut(robot) {
            robot.insert((RobotCameraView { image, camera }, Shutter::default()));
        }
    });
}

/// Removes the components that a camera needed.
pub(super) fn remove(
    gone: On<Discard, RobotCamera>,
    views: Query<&RobotCameraView>,
    mut commands: Commands,
) {
    if let Some(mut camera) =
        views.get(gone.entity).ok().and_then(|view| commands.get_entity(view.camera).ok())
    {
        camera.try_despawn();
    }
    if let Ok(mut robot) = commands.get_entity(gone.entity) {
        robot.try_remove::<(RobotCameraView, Shutter)>();
    }
}

/// Despawns the cameras that were spawned from a scene, or cloned, together with their robot.
pub(super) fn remove_clones(
    added: Query<(Entity, &ChildOf), Added<Eye>>,
    views: Query<&RobotCameraView>,
    mut commands: Commands,
) {
    for (eye, robot) in &added {
        if !views.get(robot.parent()).is_ok_and(|view| view.camera == eye) {
            commands.entity(eye).try_despawn();
        }
    }
}

/// The components of a robot with a camera.
type Seeing = (
    Entity,
    &'static RobotCamera,
    &'static mut Shutter,
    &'static TruePose,
    &'static Wheels,
    Option<&'static ChildOf>,
    Option<&'static RobotCameraView>,
);

/// The components of the world around robots.
type Surroundings = (
    Entity,
    &'static Environment,
    Option<&'static SpawnedOrigin>,
    Option<&'static GroundTruth>,
    Has<EndlessTruth>,
    &'static GlobalTransform,
    Option<&'static ScenarioRun>,
    Option<&'static MappingTrial>,
);

/// The system parameters with everything around robots that a picture is made of.
#[derive(SystemParam)]
pub(super) struct Site<'w, 's> {
    environments: Query<'w, 's, Surroundings>,
    movers: Movers<'w, 's>,
    fixed: Res<'w, Time<Fixed>>,
    visuals: Option<Res<'w, Visuals3dSettings>>,
    device: Option<Res<'w, RenderDevice>>,
    queue: Option<Res<'w, RenderQueue>>,
    scenes: ResMut<'w, Scenes>,
}

/// Takes the pictures that are due.
pub(super) fn shoot(
    mut robots: Query<Seeing>,
    mut eyes: Query<&mut Camera>,
    drawn: Res<DrawnFrames>,
    mut site: Site<'_, '_>,
    mut commands: Commands,
) {
    let Site { environments, scenes, .. } = &mut site;
    scenes.known.retain(|&environment, _| environments.contains(environment));
    for (robot, camera, mut shutter, pose, wheels, parent, view) in &mut robots {
        // The pose of a robot is not known before its first step.
        if !wheels.is_placed() {
            continue;
        }
        let eye = view.and_then(|view| Some((view, eyes.get_mut(view.camera).ok()?)));
        let picture = site.take(robot, camera, pose, parent, &mut shutter);
        let picture = match picture {
            Ok(Some(_)) if camera.images.color && eye.is_none() => Err(CameraError::NoEye),
            _ => picture,
        };
        let picture = match picture {
            Ok(Some(picture)) => picture,
            Ok(None) => continue,
            Err(error) => {
                // The app may be about to replace the world.
                if !matches!(error, CameraError::NoEnvironment | CameraError::Endless) {
                    commands.entity(robot).try_remove::<Shutter>();
                }
                shutter.report(robot, error, &mut commands);
                continue;
            }
        };
        match eye {
            Some((view, mut eye)) => {
                eye.is_active = true;
                let (drawn_in, due) = (drawn.current(), shutter.last);
                let exposure = Exposure { robot, frame: picture, age: 0, drawn_in, due };
                commands.spawn((Readback::texture(view.image.clone()), exposure));
            }
            None => {
                shutter.reported = None;
                commands.trigger(CameraFrameTaken { entity: robot, frame: Arc::new(picture) });
            }
        }
    }
}

impl Site<'_, '_> {
    /// Returns the picture of a camera without its colours, or `None` if no picture is due.
    fn take(
        &mut self,
        robot: Entity,
        camera: &RobotCamera,
        pose: &TruePose,
        parent: Option<&ChildOf>,
        shutter: &mut Shutter,
    ) -> Result<Option<CameraFrame>, CameraError> {
        let own = parent.and_then(|parent| self.environments.get(parent.parent()).ok());
        let around = own.or_else(|| self.environments.single().ok());
        let (entity, environment, origin, truth, is_endless, frame, run, trial) =
            around.ok_or(CameraError::NoEnvironment)?;
        if is_endless {
            return Err(CameraError::Endless);
        }
        let origin = origin.map_or(environment.origin, |origin| origin.0);
        // Waits for a world that is not ready.
        let Some(truth) = truth else { return Ok(None) };
        // The time is that of the robot's own trial. The time of a trial that has ended does not apply to
        // other robots.
        let own = trial.filter(|trial| trial.robots().contains(&robot));
        let time = own.and_then(MappingTrial::trial).map(|trial| trial.time());
        let time = time.unwrap_or(self.fixed.elapsed_secs_f64());
        let due = (time * camera.rate + ROUNDING).floor() as u64;
        if shutter.last == Some(due) {
            return Ok(None);
        }
        let (Some(device), Some(queue)) = (&self.device, &self.queue) else {
            return Err(CameraError::NoRenderer);
        };
        let to_frame = frame.affine().as_daffine3().inverse();
        let mut picture = CameraFrame {
            number: shutter.taken,
            time,
            pose: CameraPose::new(in_world(pose, &to_frame, origin), camera),
            optics: CameraOptics::new(camera),
            color: None,
            depth: None,
            labels: None,
            names: Arc::default(),
        };
        // Colour images show the app's own meshes.
        if camera.images.depth || camera.images.labels {
            let Scenes { pass, known } = &mut *self.scenes;
            let pass = pass.get_or_insert_with(|| NumberPass::new(device, queue));
            let has_ceilings = self.visuals.as_ref().is_some_and(|visuals| visuals.ceilings);
            let state = run.map(ScenarioRun::state);
            let known = KnownScene::of(known, (entity, truth), state, has_ceilings, pass)?;
            picture.names = known.names.clone();
            let scene = &known.scene;
            let to_world = DAffine3::from_translation(origin.extend(0.0)) * to_frame;
            let frame = SceneFrame { to_world, origin: scene.origin };
            let environments = &self.environments;
            let is_alone = environments.iter().len() == 1;
            let is_here =
                |parent: Option<Entity>| match parent.filter(|&e| environments.contains(e)) {
                    Some(own) => own == entity,
                    None => is_alone,
                };
            let moving = self.movers.triangles(is_here, (&known.world, run), &known.names, &frame);
            let CameraFrame { pose, optics, .. } = &picture;
            let numbers = pass.draw((scene, &known.buffer), &moving, pose, optics)?;
            let (depth, labels) = scene.resolve(&moving, &numbers, pose, optics);
            picture.depth = camera.images.depth.then_some(depth);
            picture.labels = camera.images.labels.then_some(labels);
        }
        shutter.last = Some(due);
        shutter.taken += 1;
        Ok(Some(picture))
    }
}

impl KnownScene {
    /// Returns the scene of an environment, which is built if the world or the scenario has changed.
    fn of<'a>(
        known: &'a mut BTreeMap<Entity, KnownScene>,
        (environment, truth): (Entity, &GroundTruth),
        state: Option<&envgen::scenario::ScenarioState>,
        has_ceilings: bool,
        pass: &NumberPass,
    ) -> Result<&'a KnownScene, CameraError> {
        let movers = state.map_or([0, 0], |state| [state.doors().len(), state.people().len()]);
        let is_same = |scene: &KnownScene| {
            Arc::ptr_eq(&scene.world, &truth.0)
                && scene.movers == movers
                && scene.has_ceilings == has_ceilings
        };
        if !known.get(&environment).is_some_and(is_same) {
            let scene = Scene::new(&truth.0, state, has_ceilings)?;
            let (names, buffer) = (Arc::new(scene.labels.clone()), pass.load(&scene));
            let world = truth.0.clone();
            let scene = KnownScene { world, movers, has_ceilings, scene, names, buffer };
            known.insert(environment, scene);
        }
        known.get(&environment).ok_or(CameraError::NoEnvironment)
    }
}

/// Deactivates cameras whose picture was drawn in the last frame, and gives up on pictures that do not
/// arrive.
pub(super) fn close(
    mut exposures: Query<(Entity, &mut Exposure, Has<Readback>)>,
    views: Query<&RobotCameraView>,
    mut eyes: Query<&mut Camera>,
    mut shutters: Query<Option<&mut Shutter>>,
    mut commands: Commands,
) {
    for (entity, mut exposure, is_drawn) in &mut exposures {
        exposure.age += 1;
        if is_drawn {
            commands.entity(entity).remove::<Readback>();
            let view = views.get(exposure.robot).ok();
            if let Some(mut eye) = view.and_then(|view| eyes.get_mut(view.camera).ok()) {
                eye.is_active = false;
            }
        }
        if exposure.age > MOST_FRAMES {
            let error = CameraError::Driver(format!("no colours within {MOST_FRAMES} frames"));
            match shutters.get_mut(exposure.robot) {
                Ok(Some(mut shutter)) => shutter.report(exposure.robot, error, &mut commands),
                // The camera was removed, or its error was reported.
                Ok(None) => {}
                // The robot was despawned after its last picture.
                Err(_) => Shutter::default().report(exposure.robot, error, &mut commands),
            }
            commands.entity(entity).despawn();
        }
    }
}

/// Completes a picture with its colours. A picture whose colours may lack something is dropped, and another one is
/// taken as soon as possible, unless too many have been dropped.
pub(super) fn develop(
    read: On<ReadbackComplete>,
    mut exposures: Query<&mut Exposure>,
    mut shutters: Query<&mut Shutter>,
    drawn: Res<DrawnFrames>,
    mut commands: Commands,
) {
    let Ok(mut exposure) = exposures.get_mut(read.entity) else { return };
    let Exposure { robot, ref mut frame, drawn_in, due, .. } = *exposure;
    if let Ok(mut shutter) = shutters.get_mut(robot) {
        let is_complete = drawn.is_complete(drawn_in);
        if !is_complete && shutter.dropped_in_a_row < MOST_FRAMES {
            shutter.dropped += 1;
            shutter.dropped_in_a_row += 1;
            if shutter.last == due {
                shutter.last = None;
            }
            commands.entity(read.entity).despawn();
            return;
        }
        if is_complete {
            shutter.dropped_in_a_row = 0;
        }
        shutter.reported = None;
        frame.number -= shutter.dropped.min(frame.number);
    }
    let CameraOptics { width, height, .. } = frame.optics;
    // The rows of copied images are padded.
    let row = read.data.len() / height as usize;
    let pixels = read
        .data
        .chunks_exact(row)
        .flat_map(|row| row.as_chunks::<4>().0.iter().take(width as usize));
    frame.color = Some(pixels.flat_map(|[red, green, blue, _]| [*red, *green, *blue]).collect());
    commands.trigger(CameraFrameTaken { entity: robot, frame: Arc::new(frame.clone()) });
    commands.entity(read.entity).despawn();
}
