//! Commands from keys and gamepads.

use bevy::input::gamepad::Gamepad;
use bevy::prelude::*;
use mapping_trial::backend::Command;
use mapping_trial::robot::Robot;

/// Stick deflections below this share count as zero.
const REST: f32 = 0.12;

/// The command of a person to the driven robot: from W, A, S, D or the arrows, and the left sticks
/// of all gamepads, whichever is larger. Forwards and left are positive. Full deflection gives the
/// robot's maximum speed and turn rate.
pub fn command_of<'a>(
    keys: &ButtonInput<KeyCode>,
    pads: impl IntoIterator<Item = &'a Gamepad>,
    robot: &Robot,
) -> Command {
    let held = |codes: [KeyCode; 2]| if keys.any_pressed(codes) { 1.0 } else { 0.0 };
    let mut ahead =
        held([KeyCode::KeyW, KeyCode::ArrowUp]) - held([KeyCode::KeyS, KeyCode::ArrowDown]);
    let mut left =
        held([KeyCode::KeyA, KeyCode::ArrowLeft]) - held([KeyCode::KeyD, KeyCode::ArrowRight]);
    for pad in pads {
        let stick = pad.left_stick();
        if stick.length() > REST {
            (ahead, left) = (f64::from(stick.y), f64::from(-stick.x));
        }
    }
    Command {
        speed: robot.max_speed * ahead.clamp(-1.0, 1.0),
        turn_rate: robot.max_turn_rate * left.clamp(-1.0, 1.0),
    }
}
