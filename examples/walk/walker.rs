//! The walker: a body that Rapier keeps out of walls, with a camera.

use std::error::Error;

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::input::mouse::AccumulatedMouseMotion;
use bevy::math::ops;
use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;
use bevy::window::{CursorGrabMode, CursorOptions, PrimaryWindow};
use bevy_envgen::bevy_rapier2d::prelude::{
    Collider, Friction, LockedAxes, QueryFilter, ReadRapierContext, RigidBody, Velocity,
};
use bevy_envgen::prelude::ScenarioAgent;
use bevy_envgen::visuals3d::Figure;
use envgen::World;
use envgen::geometry::Pose;
use envgen::glam::DVec2;
use envgen::pieces::ceilings;
use envgen::placement::pose_of_most_clearance;

use crate::samples::samples;

/// Radius of the body in metres.
const RADIUS: f32 = 0.25;

/// Walking and running speeds in m/s.
const SPEEDS: (f32, f32) = (1.6, 4.0);

/// Height of the eyes in metres, and height of the point at which the camera looks from behind. Both are lower under
/// low ceilings.
const EYES: f32 = 1.6;
const SHOULDERS: f32 = 1.4;

/// Greatest distance in metres of the camera behind the walker, and its least distance to walls.
const BEHIND: f32 = 2.8;
const MARGIN: f32 = 0.15;

/// Greatest height of the camera in metres in a world without ceilings.
const HIGHEST: f64 = 2.35;

/// Distance in metres of the camera from ceilings. Under very low ones it is at half their height.
const BELOW_CEILING: f64 = 0.25;

/// Turning in radians per pixel of the mouse, and per second of the arrow keys.
const TURNING: (f32, f32) = (0.0025, 2.0);

/// Greatest angle of view up and down, in radians.
const PITCH: f32 = 1.4;

/// The walker, with the direction in which they look.
#[derive(Component)]
pub(crate) struct Walker {
    /// Heading, counter-clockwise from the x axis, in radians.
    heading: f32,
    /// Angle above the horizon, in radians.
    pitch: f32,
    is_first_person: bool,
    /// Greatest height of the camera in metres.
    highest: f32,
    /// The positions after the last two steps of physics, between which frames are interpolated.
    places: [Vec2; 2],
}

/// The visible body of the walker.
#[derive(Component)]
pub(crate) struct Looks;

/// Returns the start of the world or, if it has none, one in the largest free region.
pub(crate) fn start(world: &World) -> Result<Pose, Box<dyn Error>> {
    if let Some(start) = world.start {
        return Ok(start);
    }
    Ok(pose_of_most_clearance(world)?.ok_or("the world has no free space to start in")?)
}

/// Returns the greatest height of the camera in metres, which is below all ceilings.
pub(crate) fn highest(world: &World) -> f32 {
    let bottoms = ceilings(world).into_iter().map(|ceiling| ceiling.form.extent().bottom());
    let lowest = bottoms.reduce(f64::min);
    lowest.map_or(HIGHEST, |bottom| (bottom - BELOW_CEILING).max(0.5 * bottom)) as f32
}

/// The body at a pose in a world, whose point `origin` is at the origin of the app, with the greatest height of its
/// camera in metres.
pub(crate) fn body(start: Pose, origin: DVec2, highest: f32) -> impl Bundle {
    let heading = start.heading as f32;
    let place = (start.position - origin).as_vec2();
    (
        Walker { heading, pitch: 0.0, is_first_person: true, highest, places: [place; 2] },
        Transform::from_translation(place.extend(0.0)),
        Visibility::Hidden,
        RigidBody::Dynamic,
        LockedAxes::ROTATION_LOCKED,
        Collider::ball(RADIUS),
        Friction::coefficient(0.0),
        Velocity::default(),
        ScenarioAgent::new(f64::from(RADIUS)),
        children![(Looks, Figure)],
    )
}

/// The camera, for any graphics driver.
pub(crate) fn spawn_camera(adapter: Res<RenderAdapterInfo>, mut commands: Commands) {
    commands.spawn((
        Camera3d::default(),
        Projection::Perspective(PerspectiveProjection { fov: 1.1, near: 0.03, ..default() }),
        Tonemapping::KhronosPbrNeutral,
        samples(&adapter),
    ));
}

/// A click captures the mouse, and Esc frees it.
pub(crate) fn hold_mouse(
    mut cursor: Single<&mut CursorOptions, With<PrimaryWindow>>,
    buttons: Res<ButtonInput<MouseButton>>,
    keys: Res<ButtonInput<KeyCode>>,
) {
    if buttons.just_pressed(MouseButton::Left) {
        cursor.grab_mode = CursorGrabMode::Locked;
        cursor.visible = false;
    } else if keys.just_pressed(KeyCode::Escape) {
        cursor.grab_mode = CursorGrabMode::None;
        cursor.visible = true;
    }
}

/// Turns with the mouse and the arrows, and switches between the views.
pub(crate) fn look(
    mut walker: Single<(&mut Walker, &mut Visibility)>,
    cursor: Single<&CursorOptions, With<PrimaryWindow>>,
    mouse: Res<AccumulatedMouseMotion>,
    keys: Res<ButtonInput<KeyCode>>,
    time: Res<Time>,
) {
    let (walker, visibility) = &mut *walker;
    if keys.just_pressed(KeyCode::KeyV) {
        walker.is_first_person = !walker.is_first_person;
        // In first person one's own head is not visible.
        let shown = if walker.is_first_person { Visibility::Hidden } else { Visibility::Inherited };
        visibility.set_if_neq(shown);
    }
    let mut turn = Vec2::ZERO;
    if !cursor.visible {
        turn -= mouse.delta * TURNING.0;
    }
    let arrows = axis(&keys, [KeyCode::ArrowRight], [KeyCode::ArrowLeft]);
    turn.x += arrows * TURNING.1 * time.delta_secs();
    walker.heading = (walker.heading + turn.x).rem_euclid(std::f32::consts::TAU);
    walker.pitch = (walker.pitch + turn.y).clamp(-PITCH, PITCH);
}

/// Returns -1, 0 or 1 for two sets of keys.
fn axis<const N: usize>(
    keys: &ButtonInput<KeyCode>,
    back: [KeyCode; N],
    forth: [KeyCode; N],
) -> f32 {
    f32::from(u8::from(keys.any_pressed(forth))) - f32::from(u8::from(keys.any_pressed(back)))
}

/// Walks with the keys.
pub(crate) fn walk(
    walker: Single<(&Walker, &mut Velocity, &mut Transform)>,
    keys: Res<ButtonInput<KeyCode>>,
) {
    let (walker, mut velocity, mut at) = walker.into_inner();
    let ahead = axis(&keys, [KeyCode::KeyS, KeyCode::ArrowDown], [KeyCode::KeyW, KeyCode::ArrowUp]);
    let left = axis(&keys, [KeyCode::KeyD], [KeyCode::KeyA]);
    let runs = keys.any_pressed([KeyCode::ShiftLeft, KeyCode::ShiftRight]);
    let speed = if runs { SPEEDS.1 } else { SPEEDS.0 };
    let direction = Vec2::new(ahead, left).normalize_or_zero();
    velocity.linear = Vec2::from_angle(walker.heading).rotate(direction) * speed;
    // Rapier does not turn the body.
    at.rotation = Quat::from_rotation_z(walker.heading);
}

/// Records where the last step of physics ended.
pub(crate) fn note_place(walker: Single<(&mut Walker, &Transform)>) {
    let (mut walker, at) = walker.into_inner();
    walker.places = [walker.places[1], at.translation.truncate()];
}

/// The walker, without the visible body.
type Body = (Without<Camera3d>, Without<Looks>);

/// Places the camera at the eyes or behind, and the visible body at the walker.
pub(crate) fn follow(
    walker: Single<(Entity, &Walker, &Transform), Body>,
    mut camera: Single<&mut Transform, (With<Camera3d>, Without<Looks>)>,
    mut looks: Single<&mut Transform, With<Looks>>,
    physics: ReadRapierContext,
    time: Res<Time<Fixed>>,
) {
    let (entity, walker, at) = *walker;
    let [from, to] = walker.places;
    let here = from.lerp(to, time.overstep_fraction());
    looks.translation = at.rotation.inverse() * (here.extend(0.0) - at.translation);
    let turn = Quat::from_rotation_z(walker.heading) * Quat::from_rotation_y(-walker.pitch);
    let ahead = turn * Vec3::X;
    if walker.is_first_person {
        let eyes = here.extend(EYES.min(walker.highest));
        **camera = Transform::from_translation(eyes).looking_to(ahead, Vec3::Z);
        return;
    }
    let shoulders = here.extend(SHOULDERS.min(walker.highest));
    let back = -Vec2::from_angle(walker.heading);
    let wanted = BEHIND * ops::cos(walker.pitch).max(0.2);
    let filter = QueryFilter::default().exclude_sensors().exclude_rigid_body(entity);
    let wall = physics
        .single()
        .ok()
        .and_then(|physics| physics.cast_ray(here, back, wanted + MARGIN, true, filter));
    let distance = wall.map_or(wanted, |(_, distance)| (distance - MARGIN).max(0.05));
    let height = SHOULDERS + 0.45 - BEHIND * ops::sin(walker.pitch);
    let height = height.max(0.2).min(walker.highest);
    let eyes = (here + back * distance).extend(height);
    **camera = Transform::from_translation(eyes).looking_at(shoulders, Vec3::Z);
}
