//! Keys, which do nothing while a text is typed.

use bevy::input::keyboard::{Key, KeyboardFocusLost, KeyboardInput};
use bevy::prelude::*;
use bevy_mapping_trial::ui::bevy_egui::input::EguiWantsInput;

use crate::session::{Session, TURN};
use crate::tools::Tool;

/// The modifiers that are held down.
#[derive(Clone, Copy, Default)]
pub(crate) struct Held {
    control: bool,
    shift: bool,
}

/// Carries out the keys in the order in which they were pressed. In a long frame, a modifier may be
/// down for one of them and up again at the end.
pub(crate) fn act(
    mut session: ResMut<Session>,
    mut inputs: MessageReader<KeyboardInput>,
    mut focus: MessageReader<KeyboardFocusLost>,
    panels: Res<EguiWantsInput>,
    mut held: Local<Held>,
) {
    let session = session.bypass_change_detection();
    for input in inputs.read() {
        let is_down = input.state.is_pressed();
        match &input.logical_key {
            Key::Control | Key::Super => held.control = is_down,
            Key::Shift => held.shift = is_down,
            key if is_down && held.control => {
                with_control(session, key, held.shift, panels.wants_any_keyboard_input());
            }
            key if is_down && session.question.is_none() && !panels.wants_any_keyboard_input() => {
                plain(session, key, held.shift, input.repeat);
            }
            _ => {}
        }
    }
    if focus.read().next().is_some() {
        *held = Held::default();
    }
}

fn with_control(session: &mut Session, key: &Key, shift: bool, is_typing: bool) {
    let Key::Character(letter) = key else { return };
    match (letter.to_lowercase().as_str(), shift) {
        _ if session.question.is_some() => {}
        ("s", _) => session.save(),
        ("q", _) => session.close(),
        _ if is_typing => {}
        ("z", false) => session.undo(),
        ("z", true) | ("y", _) => session.redo(),
        _ => {}
    }
}

fn plain(session: &mut Session, key: &Key, shift: bool, is_repeated: bool) {
    match key {
        Key::Delete | Key::Backspace if !is_repeated => session.remove(),
        Key::Escape => session.cancel(),
        Key::Character(letter) => match letter.to_lowercase().as_str() {
            "r" => session.turn(if shift { -TURN } else { TURN }),
            "g" => session.grid = !session.grid,
            "f" => session.view.fit(session.document.world().bounds),
            "v" if !is_repeated => session.view.tilt(),
            "q" => session.view.turn(1),
            "e" => session.view.turn(-1),
            "t" if !is_repeated => session.open_trial(),
            digit => {
                let number = digit.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
                if let Some((tool, ..)) = number.and_then(|number| Tool::ALL.get(number)) {
                    session.choose(*tool);
                }
            }
        },
        _ => {}
    }
}
