//! Keys, which do nothing while a text is typed.

use bevy_mapping_trial::ui::egui;
use egui::{Context, Key, Modifiers};

use crate::session::{Session, TURN};
use crate::tools::Tool;

/// Carries out the keys that were pressed.
pub(crate) fn act(context: &Context, session: &mut Session) {
    let pressed = |modifiers, key| context.input_mut(|input| input.consume_key(modifiers, key));
    // The longer ones first: a key without Shift is found in one with it.
    let redo = pressed(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z)
        | pressed(Modifiers::COMMAND, Key::Y);
    let undo = pressed(Modifiers::COMMAND, Key::Z);
    let save = pressed(Modifiers::COMMAND, Key::S);
    let close = pressed(Modifiers::COMMAND, Key::Q);
    if save {
        session.save();
    }
    if close {
        session.close();
    }
    if session.asks || context.egui_wants_keyboard_input() {
        return;
    }
    if redo {
        session.redo();
    } else if undo {
        session.undo();
    }
    if pressed(Modifiers::SHIFT, Key::R) {
        session.turn(-TURN);
    } else if pressed(Modifiers::NONE, Key::R) {
        session.turn(TURN);
    }
    if pressed(Modifiers::NONE, Key::Delete) | pressed(Modifiers::NONE, Key::Backspace) {
        session.remove();
    }
    if pressed(Modifiers::NONE, Key::Escape) {
        session.cancel();
    }
    if pressed(Modifiers::NONE, Key::G) {
        session.grid = !session.grid;
    }
    if pressed(Modifiers::NONE, Key::F) {
        session.view.fit(session.document.world().bounds);
    }
    if pressed(Modifiers::NONE, Key::T) {
        session.open_trial();
    }
    let keys = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5];
    for (key, (tool, ..)) in keys.into_iter().zip(Tool::ALL) {
        if pressed(Modifiers::NONE, key) {
            session.choose(tool);
        }
    }
}
