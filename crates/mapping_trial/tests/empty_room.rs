//! The easiest world there is must not be difficult, whoever drives.

use envgen::geometry::{Pose, Rect, Shape, edges};
use envgen::world::{Wall, WallKind};
use envgen::{Provenance, Seed, World};
use glam::DVec2;
use mapping_trial::lidar::LaserProfile;
use mapping_trial::names::Named;
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::operator::OperatorKind;
use mapping_trial::score::Scores;
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

fn run(settings: TrialSettings) -> (Option<EndReason>, Scores) {
    let world = room();
    let truth = Truth::new(&world, &settings.body).expect("a start");
    let mut trial = Trial::flat(&world, settings).expect("a free start");
    while trial.step() {}
    (trial.end_of(0).map(|end| end.reason), trial.score(&truth).expect("scores"))
}

#[test]
fn no_operator_finds_an_empty_room_difficult() {
    for (name, operator) in OperatorKind::NAMES {
        for seed in 0..3 {
            let (end, scores) = run(TrialSettings {
                operator: Some(*operator),
                laser: LaserProfile::USARSIM,
                seed: Seed(seed),
                ..TrialSettings::default()
            });
            assert_eq!(end, Some(EndReason::Explored), "{name}, seed {seed}");
            assert!(scores.difficulty <= 1.0, "{name}, seed {seed}: {scores:#?}");
        }
    }
}

/// The room is wider than twice the range of the default laser: its middle is crossed on the wheels
/// alone, and what they get wrong (a scale of 1.5 %, turns of 5 %) is in the map. With wheels that get
/// nothing wrong, nothing else may.
#[test]
fn a_short_range_costs_what_the_wheels_get_wrong() {
    let settings = |odometry: OdometryProfile, seed| TrialSettings {
        odometry,
        seed: Seed(seed),
        ..TrialSettings::default()
    };
    for seed in 0..3 {
        let (_, exact) = run(settings(OdometryProfile::EXACT, seed));
        assert!(exact.difficulty <= 1.0 && exact.trajectory_error < 0.1, "{exact:#?}");
        let (end, skid) = run(settings(OdometryProfile::SKID, seed));
        assert_eq!(end, Some(EndReason::Explored));
        assert!(skid.difficulty < 3.0, "{skid:#?}");
    }
}
