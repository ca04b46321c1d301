use bevy::input::gamepad::{Gamepad, GamepadAxis};
use bevy::prelude::*;
use bevy_mapping_trial::ui::command_of;
use mapping_trial::backend::Command;
use mapping_trial::robot::Robot;

fn keys(held: &[KeyCode]) -> ButtonInput<KeyCode> {
    let mut keys = ButtonInput::default();
    held.iter().for_each(|&key| keys.press(key));
    keys
}

#[test]
fn keys_drive_within_the_robots_limits() {
    let robot = Robot::default();
    let of = |held: &[KeyCode]| command_of(&keys(held), [], &robot);
    assert_eq!(of(&[]), Command::STOP);
    assert_eq!(of(&[KeyCode::KeyW]), Command { speed: 0.7, turn_rate: 0.0 });
    assert_eq!(of(&[KeyCode::KeyW, KeyCode::ArrowUp]), of(&[KeyCode::KeyW]));
    assert_eq!(of(&[KeyCode::ArrowDown, KeyCode::KeyA]), Command { speed: -0.7, turn_rate: 1.4 });
    assert_eq!(of(&[KeyCode::KeyD]), Command { speed: 0.0, turn_rate: -1.4 });
    assert_eq!(of(&[KeyCode::KeyW, KeyCode::KeyS]), Command::STOP);
}

#[test]
fn what_is_moved_most_drives() {
    let robot = Robot::default();
    let mut pad = Gamepad::default();
    let resting = command_of(&keys(&[KeyCode::KeyW]), [&pad], &robot);
    assert_eq!(resting.speed, 0.7);
    pad.analog_mut().set(GamepadAxis::LeftStickX, 1.0);
    pad.analog_mut().set(GamepadAxis::LeftStickY, -0.5);
    let command = command_of(&keys(&[KeyCode::KeyW]), [&pad], &robot);
    assert_eq!(command, Command { speed: -0.35, turn_rate: -1.4 });
    // Two keys together exceed the stick, and a stick that is moved a little is less than one key.
    let command = command_of(&keys(&[KeyCode::KeyW, KeyCode::KeyA]), [&pad], &robot);
    assert_eq!(command, Command { speed: 0.7, turn_rate: 1.4 });
    let mut touched = Gamepad::default();
    touched.analog_mut().set(GamepadAxis::LeftStickY, -0.25);
    let command = command_of(&keys(&[KeyCode::KeyW]), [&touched], &robot);
    assert_eq!(command, Command { speed: 0.7, turn_rate: 0.0 });
    for pads in [[&pad, &touched], [&touched, &pad]] {
        let command = command_of(&keys(&[]), pads, &robot);
        assert_eq!(command, Command { speed: -0.35, turn_rate: -1.4 });
    }
}
