//! The frame rate of a window.

use std::time::Duration;

use bevy::prelude::*;
use bevy::window::WindowEvent;
use bevy::winit::{UpdateMode, WinitSettings};
use bevy_mapping_trial::ui::bevy_egui::{EguiInput, EguiPreUpdateSet};
use bevy_mapping_trial::ui::egui::{Event, Modifiers};

/// Longest time between two frames while other threads compute, whose results then become visible, and
/// after inputs. Letters that are drawn for the first time become visible in the next frame.
const FRAME: Duration = Duration::from_millis(100);

/// Number of frames after an input.
const AFTER: u32 = 3;

/// Longest time between two frames without inputs, since old notes have to disappear.
const IDLE: Duration = Duration::from_millis(400);

/// Reasons for which a window changes without inputs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Activity {
    /// Simulated time passes.
    pub(crate) moves: bool,
    /// Other threads compute.
    pub(crate) computes: bool,
}

/// Draws the panels only when something happens to them. In every frame `bevy_egui` reports which
/// modifier keys are held, and egui draws once more after every input.
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

/// Draws as rarely as possible.
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
