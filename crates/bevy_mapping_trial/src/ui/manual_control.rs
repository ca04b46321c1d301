//! Commands from keyboards and gamepads.

use bevy::input::gamepad::Gamepad;
use bevy::prelude::*;
use mapping_trial::backend::Command;
use mapping_trial::robot::Robot;

/// Stick deflections below this fraction count as zero.
const REST: f32 = 0.12;

/// Returns the command of an operator to the driven robot, from the keys W, A, S, D or the arrow keys, and
/// from the left sticks of all gamepads, whichever is larger. Forwards and left are positive. Full deflection
/// gives the maximum speed and turn rate of the robot.
pub fn command_of<'a>(
    keys: &ButtonInput<KeyCode>,
    pads: impl IntoIterator<Item = &'a Gamepad>,
    robot: &Robot,
) -> Command {
    let held = |codes: [KeyCode; 2]| if keys.any_pressed(codes) { 1.0 } else { 0.0 };
    let ahead = held([KeyCode::KeyW, KeyCode::ArrowUp]) - held([KeyCode::KeyS, KeyCode::ArrowDown]);
    let left =
        held([KeyCode::KeyA, KeyCode::ArrowLeft]) - held([KeyCode::KeyD, KeyCode::ArrowRight]);
    let sticks = pads.into_iter().map(Gamepad::left_stick).filter(|stick| stick.length() > REST);
    let wanted = sticks.fold(Vec2::new(ahead, left), |largest, stick| {
        let stick = Vec2::new(stick.y, -stick.x);
        if stick.length() > largest.length() { stick } else { largest }
    });
    let wanted = wanted.clamp(Vec2::NEG_ONE, Vec2::ONE).as_dvec2();
    Command { speed: robot.max_speed * wanted.x, turn_rate: robot.max_turn_rate * wanted.y }
}
