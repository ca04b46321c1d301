//! How often a window is drawn.

use std::time::Duration;

use bevy::prelude::*;
use bevy::window::WindowEvent;
use bevy::winit::{UpdateMode, WinitSettings};
use bevy_mapping_trial::ui::bevy_egui::{EguiInput, EguiPreUpdateSet};
use bevy_mapping_trial::ui::egui::{Event, Modifiers};

/// The longest time between two frames while other threads compute, whose results are seen then, and after inputs:
/// letters that are drawn for the first time are seen in the next frame.
const FRAME: Duration = Duration::from_millis(100);

/// Frames after an input.
const AFTER: u32 = 3;

/// The longest time between two frames of what nobody has touched: old notes disappear then.
const IDLE: Duration = Duration::from_millis(400);

/// Why a window changes without inputs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Activity {
    /// Simulated time passes.
    pub(crate) moves: bool,
    /// Other threads compute.
    pub(crate) computes: bool,
}

/// Lets the panels be drawn only when something happens to them. `bevy_egui` says in every frame which modifier keys
/// are held, and egui draws once more after every input.
pub(crate) fn let_panels_rest(app: &mut App) {
    let heard = EguiPreUpdateSet::ProcessInput;
    app.add_systems(PreUpdate, drop_repeated.after(heard).before(EguiPreUpdateSet::BeginPass));
}

fn drop_repeated(mut inputs: Query<&mut EguiInput>, mut held: Local<Modifiers>) {
    for mut input in &mut inputs {
        input.events.retain(|event| match event {
            Event::ModifiersChanged(now) => std::mem::replace(&mut *held, *now) != *now,
            _ => true,
        });
    }
}

/// Draws as rarely as can be.
pub(crate) fn pace(
    In(activity): In<Activity>,
    mut inputs: MessageReader<WindowEvent>,
    mut quiet: Local<u32>,
    mut settings: ResMut<WinitSettings>,
) {
    *quiet = if inputs.read().next().is_some() { 0 } else { quiet.saturating_add(1) };
    let longest = if activity.computes || *quiet < AFTER { FRAME } else { IDLE };
    let mode = UpdateMode::reactive(longest);
    *settings = match activity.moves {
        true => WinitSettings::game(),
        false => WinitSettings { focused_mode: mode, unfocused_mode: mode },
    };
}
