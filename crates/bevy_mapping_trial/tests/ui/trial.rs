use bevy_mapping_trial::ui::*;
use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
use mapping_trial::backend::Command;
use mapping_trial::trial::{Trial, TrialSettings};

use crate::screen::{click, show_in};

#[test]
fn the_status_is_that_of_the_trial() {
    let spec = HallwaySpec { segments: 3, ..Default::default() };
    let world = spec.generate(Seed(7)).expect("a hallway").to_world();
    let settings = TrialSettings { policy: None, time_limit: 600.0, ..Default::default() };
    let mut trial = Trial::flat(&world, settings).expect("a trial");
    for _ in 0..40 {
        trial.step_with(&[Command { speed: 0.5, turn_rate: 0.0 }]);
    }
    let status = TrialStatus::of(&trial, 5);
    assert_eq!((status.time, status.battery), (2.0, 1198.0));
    assert_eq!((status.driven, status.robots, status.end), (0, 1, None));
    assert!(status.distance > 0.3 && !status.program);
    trial.stop();
    assert_eq!(TrialStatus::of(&trial, 0).end, Some("stopped"));
}

#[test]
fn the_panel_tells_all_but_the_level() {
    let status = TrialStatus {
        time: 75.2,
        time_limit: 1200.0,
        battery: 600.0,
        full_battery: 1200.0,
        distance: 12.34,
        collisions: 3,
        robots: 2,
        ..Default::default()
    };
    let shown = show_in(egui::vec2(300.0, 300.0), |ui| {
        status.show(ui);
    });
    for text in ["1:15 of 20:00", "50 %", "12.3 m", "1 of 2, you drive", "Reset (R)"] {
        assert!(shown.has(text), "{text}");
    }
    assert!(!shown.has("difficulty"));
    assert_eq!(shown.clipped(), Vec::<String>::new());
    let action = click(egui::vec2(300.0, 300.0), "Stop (End)", |ui| status.show(ui));
    assert_eq!(action, Some(TrialAction::Stop));
}
