//! The easiest world must not be difficult for any policy.

use envgen::geometry::{Pose, Rect, Shape, edges};
use envgen::world::{Wall, WallKind};
use envgen::{Provenance, Seed, World};
use glam::DVec2;
use mapping_trial::lidar::LaserProfile;
use mapping_trial::names::Named;
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::policy::PolicyKind;
use mapping_trial::score::Reference;
use mapping_trial::score::Scores;
use mapping_trial::trial::{EndReason, Trial, TrialSettings};

/// An empty room of 20 x 20 m.
pub(crate) fn room() -> World {
    let bounds = Rect::new(DVec2::ZERO, DVec2::splat(20.0));
    let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
    let corners = Shape::from_rect(bounds).corners();
    world.walls =
        edges(&corners).map(|(a, b)| Wall::new(WallKind::Wall, Shape::Segment { a, b })).collect();
    world.start = Some(Pose::new(4.0, 5.0, 0.3));
    world
}

fn run(settings: TrialSettings) -> (Option<EndReason>, Scores) {
    let world = room();
    let truth = Reference::new(&world, &settings.body).expect("a start");
    let mut trial = Trial::flat(&world, settings).expect("a free start");
    while trial.step() {}
    (trial.end_of(0).map(|end| end.reason), trial.score(&truth).expect("scores"))
}

/// Number of seeds for the errors of sensors.
const SEEDS: u64 = 6;

/// Tests the default laser, whose range is less than half the room, and one that sees all of it.
#[test]
fn no_policy_finds_an_empty_room_difficult() {
    for (name, policy) in PolicyKind::NAMES {
        for laser in [LaserProfile::default(), LaserProfile::USARSIM] {
            let range = laser.max_range;
            for seed in 0..SEEDS {
                let (end, scores) = run(TrialSettings {
                    policy: Some(*policy),
                    laser: laser.clone(),
                    seed: Seed(seed),
                    ..TrialSettings::default()
                });
                assert_eq!(end, Some(EndReason::Explored), "{name}, {range} m, seed {seed}");
                let one = scores.score_1.difficulty;
                assert!(one <= 1.0, "{name}, {range} m, seed {seed}: {scores:#?}");
                // Where the shorter laser sees no wall, the errors of the wheels are difficulty.
                let most = if range < 10.0 { 3.0 } else { 1.0 };
                assert!(scores.difficulty <= most, "{name}, {range} m, seed {seed}: {scores:#?}");
            }
        }
    }
}

/// From the centre of the room its walls are out of sight, so that the errors of the wheels (a scale of
/// 1.5 %, turns of 5 %) are in the map. With exact wheels there must be no other errors.
#[test]
fn wheels_that_are_exact_leave_an_exact_map() {
    for seed in 0..3 {
        let odometry = OdometryProfile::EXACT;
        let (_, scores) =
            run(TrialSettings { odometry, seed: Seed(seed), ..TrialSettings::default() });
        assert!(scores.difficulty <= 1.0 && scores.trajectory_error < 0.1, "{scores:#?}");
    }
}
