use std::sync::Arc;

use bevy_mapping_trial::ui::*;
use envgen::hallway::HallwaySpec;
use envgen::scenario::ScenarioSpec;
use envgen::{Blueprint, Seed, Spec, WorldKind};
use mapping_trial::lidar::LaserProfile;
use mapping_trial::names::Named;
use mapping_trial::robot::{Footprint, LaserMount, Robot};
use mapping_trial::trial::TrialSettings;

use crate::screen::{Screen, show_in};

/// The space beside the panel of the example `teleop`, in points, for both of its sizes.
const SPACES: [egui::Vec2; 2] = [egui::vec2(920.0, 720.0), egui::vec2(1062.0, 800.0)];

#[test]
fn robots_are_drawn_with_their_sizes() {
    for space in SPACES {
        let settings = TrialSettings { robots: 2, ..Default::default() };
        let shown = show_in(space, |ui| robot_preview(ui, "Pioneer 3-AT", &settings));
        for text in [
            "Pioneer 3-AT, laser lms200_mm",
            "2 robots",
            "range 8.19 m, field of view 180 degrees",
            "2 m",
            "0.51 m",
            "turns in 0.71 m",
            "laser at 0.45 m",
            "0.7 m/s",
            "181 beams, 5 scans/s",
        ] {
            assert!(shown.has(text), "{text}");
        }
    }
}

#[test]
fn texts_of_every_robot_are_whole_and_apart() {
    let small = Robot {
        length: 0.14,
        width: 0.14,
        height: 0.19,
        circumscribed_radius: 0.11,
        footprint: Footprint::Disc,
        laser_offset: -0.03,
        laser_mount: LaserMount { left: 0.0, heading: 0.0, height: 0.18 },
        ..Robot::default()
    };
    let large = Robot {
        length: 1.35,
        width: 0.91,
        height: 0.32,
        circumscribed_radius: 0.82,
        laser_offset: 0.44,
        laser_mount: LaserMount { left: -0.35, heading: -0.8, height: 0.19 },
        ..Robot::default()
    };
    for body in [Robot::default(), small, large] {
        for (name, laser) in LaserProfile::NAMES {
            let settings =
                TrialSettings { body: body.clone(), laser: laser.clone(), ..Default::default() };
            assert_eq!(settings.validate(), Ok(()), "{name}");
            for space in SPACES {
                let shown = show_in(space, |ui| robot_preview(ui, "some robot", &settings));
                assert_eq!(shown.cut(), Vec::<String>::new(), "{name} {body:?}");
                assert_eq!(shown.overlapping(), Vec::new(), "{name} {body:?}");
            }
        }
    }
}

#[test]
fn previews_of_no_size_and_of_bad_settings_do_nothing() {
    let bad = TrialSettings {
        body: Robot { length: f64::NAN, ..Robot::default() },
        ..Default::default()
    };
    for settings in [bad, TrialSettings::default()] {
        for space in [egui::vec2(1.0, 1.0), egui::vec2(40.0, 700.0), egui::vec2(900.0, 20.0)] {
            show_in(space, |ui| robot_preview(ui, "some robot", &settings));
        }
    }
}

#[test]
fn the_last_world_that_was_asked_for_is_shown() {
    let mut form = SpecForm::new(&WorldKind::Hallway.default_spec(), Seed(3));
    let mut preview = WorldPreview::new(form.request());
    for segments in 2..40 {
        form.set("segments", &segments.to_string());
        preview.request(form.request());
        preview.advance();
    }
    while preview.is_pending() {
        preview.advance();
    }
    let expected = HallwaySpec { segments: 39, ..Default::default() };
    let expected = expected.generate(Seed(3)).expect("allowed").to_world();
    assert_eq!(**preview.world().expect("a world"), expected);
    assert_eq!(preview.error(), None);
}

#[test]
fn errors_are_shown_over_the_last_picture() {
    let world = HallwaySpec::default().generate(Seed(7)).expect("allowed").to_world();
    let mut preview = WorldPreview::given(Arc::new(world));
    let screen = Screen::new(SPACES[0]);
    // A hallway has no doorways, so it cannot have doors.
    let scenario = ScenarioSpec { doors: 0.5, ..Default::default() };
    let mut shown = screen.show(|ui| preview.show(ui, Some((&scenario, Seed(7)))));
    for _ in 0..2000 {
        if shown.has("`doors`") {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
        shown = screen.show(|ui| preview.show(ui, Some((&scenario, Seed(7)))));
    }
    assert!(shown.has("`doors`"));
    let mut form = SpecForm::new(&WorldKind::Indoor.default_spec(), Seed(3));
    form.set("width", "2");
    preview.request(form.request());
    let shown = screen.show(|ui| preview.show(ui, None));
    assert!(shown.has("`width` must be a whole number from 4 to 1024, got 2"));
    assert!(preview.world().is_none() && !preview.is_pending());
}
