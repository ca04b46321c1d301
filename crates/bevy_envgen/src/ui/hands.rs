//! Keys and gamepads become commands.

use bevy::input::gamepad::Gamepad;
use bevy::prelude::*;
use mapping_trial::backend::Command;
use mapping_trial::robot::Robot;

/// Share of a stick's way that counts as rest.
const REST: f32 = 0.12;

/// What a person asks of the robot that is driven: W, A, S, D or the arrows, and the left stick of
/// every gamepad, which is stronger where it is moved. Forwards and left are positive; all that a
/// robot can is the most that can be asked for.
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
