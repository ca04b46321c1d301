//! The easiest world there is must not be difficult, whoever drives.

use envgen::geometry::{Pose, Rect, Shape, edges};
use envgen::world::{Wall, WallKind};
use envgen::{Provenance, Seed, World};
use glam::DVec2;
use mapping_trial::names::Named;
use mapping_trial::operator::OperatorKind;
use mapping_trial::trial::{EndReason, Trial, TrialSettings};
use mapping_trial::truth::Truth;

/// A room of 20 x 20 m in which nothing stands.
fn room() -> World {
    let bounds = Rect::new(DVec2::ZERO, DVec2::splat(20.0));
    let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
    let corners = Shape::from_rect(bounds).corners();
    world.walls = edges(&corners)
        .map(|(a, b)| Wall { kind: WallKind::Wall, shape: Shape::Segment { a, b } })
        .collect();
    world.start = Some(Pose::new(4.0, 5.0, 0.3));
    world
}

#[test]
fn no_operator_finds_an_empty_room_difficult() {
    let world = room();
    let truth = Truth::new(&world, &TrialSettings::default().body).expect("a start");
    for (name, operator) in OperatorKind::NAMES {
        for seed in 0..3 {
            let settings = TrialSettings {
                operator: Some(*operator),
                seed: Seed(seed),
                ..TrialSettings::default()
            };
            let mut trial = Trial::flat(&world, settings).expect("a free start");
            while trial.step() {}
            let scores = trial.score(&truth).expect("scores");
            let end = trial.end_of(0).map(|end| end.reason);
            assert_eq!(end, Some(EndReason::Explored), "{name}, seed {seed}");
            assert!(scores.difficulty <= 1.0, "{name}, seed {seed}: {scores:#?}");
        }
    }
}
