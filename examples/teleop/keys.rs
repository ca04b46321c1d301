//! Keys and gamepads.

use bevy::input::gamepad::{Gamepad, GamepadButton};
use bevy::input::keyboard::{Key, KeyboardInput};
use bevy::prelude::*;
use bevy_envgen::prelude::*;
use bevy_mapping_trial::prelude::*;
use bevy_mapping_trial::ui::bevy_egui::EguiInput;
use bevy_mapping_trial::ui::bevy_egui::input::EguiWantsInput;
use bevy_mapping_trial::ui::{TrialAction, command_of, egui};
use bevy_mapping_trial::view::{FollowRobot, TrialView};
use mapping_trial::backend::Command;

use crate::session::{Phase, Session};

/// Least and greatest height of the visible area in metres.
const ZOOM: (f32, f32) = (3.0, 200.0);

/// Factor by which a key changes the zoom.
const ZOOM_STEP: f32 = 1.25;

/// Commands the driven robot by keys and gamepads, but not while a panel has the keyboard focus.
pub(crate) fn steer(
    session: Res<Session>,
    keys: Res<ButtonInput<KeyCode>>,
    pads: Query<&Gamepad>,
    panels: Res<EguiWantsInput>,
    mut manual: Query<&mut ManualControl>,
) {
    let Ok(mut manual) = manual.get_mut(session.world) else { return };
    let command = if session.phase != Phase::Running || panels.wants_any_keyboard_input() {
        Command::STOP
    } else {
        command_of(&keys, pads, &session.setup.settings.body)
    };
    // Robots that are not driven stop.
    let robots = session.setup.settings.robots as usize;
    let command_of = |robot| if robot == session.driven { command } else { Command::STOP };
    manual.set_if_neq(ManualControl { commands: (0..robots).map(command_of).collect() });
}

/// Zooms the map by keys, but not behind the picture of a camera.
pub(crate) fn zoom(
    session: Res<Session>,
    mut inputs: MessageReader<KeyboardInput>,
    panels: Res<EguiWantsInput>,
    mut cameras: Query<&mut FollowRobot>,
) {
    let is_typing = panels.wants_any_keyboard_input();
    let is_hidden = session.shows_camera();
    for input in inputs.read() {
        if !input.state.is_pressed() || is_typing || is_hidden {
            continue;
        }
        // The typed characters count, since + and - are on other keys of other keyboards.
        let typed = |texts: &[&str]| matches!(&input.logical_key, Key::Character(text) if texts.contains(&text.as_str()));
        let factor = match input.key_code {
            KeyCode::NumpadAdd => 1.0 / ZOOM_STEP,
            KeyCode::NumpadSubtract => ZOOM_STEP,
            _ if typed(&["+", "="]) => 1.0 / ZOOM_STEP,
            _ if typed(&["-", "_"]) => ZOOM_STEP,
            _ => continue,
        };
        for mut camera in &mut cameras {
            camera.height = (camera.height * factor).clamp(ZOOM.0, ZOOM.1);
        }
    }
}

/// Keys with a single action.
pub(crate) fn act(
    mut session: ResMut<Session>,
    keys: Res<ButtonInput<KeyCode>>,
    pads: Query<&Gamepad>,
    mut trials: Query<(&mut MappingTrial, &mut TrialView, &GroundTruth)>,
    worlds: Query<&GroundTruth>,
    mut commands: Commands,
) {
    let pressed = |codes: &[KeyCode], button| {
        keys.any_just_pressed(codes.iter().copied())
            || pads.iter().any(|pad| pad.just_pressed(button))
    };
    let begin = pressed(&[KeyCode::Enter, KeyCode::NumpadEnter], GamepadButton::Start);
    if begin && session.phase == Phase::Setup {
        let spawned = worlds.get(session.world).ok();
        session.begin(spawned, &mut commands);
        return;
    }
    if session.phase != Phase::Running {
        return;
    }
    if pressed(&[KeyCode::KeyC], GamepadButton::East) && session.has_cameras {
        session.camera_is_large = !session.camera_is_large;
    }
    let action = if pressed(&[KeyCode::KeyP, KeyCode::Escape], GamepadButton::Start) {
        TrialAction::Pause
    } else if pressed(&[KeyCode::KeyR], GamepadButton::Select) {
        TrialAction::Reset
    } else if pressed(&[KeyCode::KeyT], GamepadButton::North) {
        TrialAction::Training
    } else if pressed(&[KeyCode::Tab], GamepadButton::West) {
        TrialAction::NextRobot
    } else if keys.just_pressed(KeyCode::End) {
        TrialAction::Stop
    } else {
        return;
    };
    let world = session.world;
    if let Ok((mut trial, mut view, truth)) = trials.get_mut(world) {
        session.act(action, &mut trial, &mut view, truth, &mut commands);
    }
}

/// While the robots drive, Tab switches between robots, not between buttons.
pub(crate) fn keep_tab(session: Res<Session>, mut inputs: Query<&mut EguiInput>) {
    if session.phase == Phase::Running {
        for mut input in &mut inputs {
            input
                .events
                .retain(|event| !matches!(event, egui::Event::Key { key: egui::Key::Tab, .. }));
        }
    }
}
