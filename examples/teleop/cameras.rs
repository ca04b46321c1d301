//! The cameras of the window: one for the robot's surroundings, one for the whole map in a corner, and
//! one for the panels over both.

use bevy::camera::visibility::RenderLayers;
use bevy::camera::{CameraOutputMode, ClearColorConfig, Viewport};
use bevy::prelude::*;
use bevy::render::render_resource::BlendState;
use bevy::render::renderer::RenderAdapterInfo;
use bevy_mapping_trial::ui::bevy_egui::{EguiGlobalSettings, PrimaryEguiContext};
use bevy_mapping_trial::view::{FollowRobot, ShowWholeMap, TrialPalette, minimap_layers};

use crate::panels;
use crate::samples::samples;
use crate::session::{Phase, Session};

/// Initial height of the visible area in metres.
const HEIGHT: f32 = 14.0;

/// Side of the minimap as a fraction of the picture's shorter side.
const MINIMAP: f32 = 0.34;

/// Distance in pixels between the minimap and the window's edge.
const MARGIN: u32 = 12;

pub(crate) fn spawn(
    session: Res<Session>,
    palette: Res<TrialPalette>,
    adapter: Res<RenderAdapterInfo>,
    mut settings: ResMut<EguiGlobalSettings>,
    mut commands: Commands,
) {
    settings.auto_create_primary_context = false;
    let trial = session.world;
    let clear = ClearColorConfig::Custom(palette.unknown);
    let samples = samples(&adapter);
    commands.spawn((
        Camera2d,
        samples,
        Camera { clear_color: clear, ..default() },
        FollowRobot { trial, robot: 0, height: HEIGHT },
    ));
    commands.spawn((
        Camera2d,
        samples,
        Camera { order: 1, clear_color: clear, ..default() },
        ShowWholeMap { trial, margin: 1.0 },
        minimap_layers(),
    ));
    commands.spawn((
        PrimaryEguiContext,
        Camera2d,
        samples,
        RenderLayers::none(),
        Camera {
            order: 2,
            output_mode: CameraOutputMode::Write {
                blend_state: Some(BlendState::ALPHA_BLENDING),
                clear_color: ClearColorConfig::None,
            },
            clear_color: ClearColorConfig::Custom(Color::NONE),
            ..default()
        },
    ));
}

/// Follows the driven robot.
pub(crate) fn follow_driven(session: Res<Session>, mut cameras: Query<&mut FollowRobot>) {
    for mut camera in &mut cameras {
        if camera.robot != session.driven {
            camera.robot = session.driven;
        }
    }
}

/// Returns the window's area in pixels beside the panel.
pub(crate) fn beside(window: &Window) -> URect {
    let size = window.physical_size();
    let panel = panels::WIDTH * panels::zoom(window.height()) * window.scale_factor();
    URect::from_corners(UVec2::new((panel as u32).min(size.x), 0), size)
}

/// Returns the minimap's area in pixels, in the lower right corner.
pub(crate) fn minimap(size: UVec2, beside: URect) -> URect {
    let side = (beside.size().min_element() as f32 * MINIMAP) as u32;
    let corner = size.saturating_sub(UVec2::splat(side + MARGIN));
    URect::from_corners(corner, corner + side)
}

/// Fits the pictures to the window, beside the panel.
pub(crate) fn fit(
    window: Single<&Window>,
    session: Res<Session>,
    mut main: Query<&mut Camera, (With<FollowRobot>, Without<ShowWholeMap>)>,
    mut maps: Query<&mut Camera, With<ShowWholeMap>>,
) {
    let beside = beside(&window);
    let map = minimap(window.physical_size(), beside);
    let shown = !map.is_empty();
    let hidden = session.shows_camera();
    for mut camera in &mut main {
        put(&mut camera, beside, shown && !hidden);
    }
    for mut camera in &mut maps {
        put(&mut camera, map, shown && session.phase == Phase::Running);
    }
}

/// Moves a viewport, unless it is already there.
fn put(camera: &mut Mut<'_, Camera>, place: URect, shown: bool) {
    if camera.is_active != shown {
        camera.is_active = shown;
    }
    let (physical_position, physical_size) = (place.min, place.size());
    let there = camera.viewport.as_ref().is_some_and(|seen| {
        seen.physical_position == physical_position && seen.physical_size == physical_size
    });
    if shown && !there {
        camera.viewport = Some(Viewport { physical_position, physical_size, ..default() });
    }
}
