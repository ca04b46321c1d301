//! Water, which robots see and avoid, unless they are blind to it.

use std::thread;

use envgen::geometry::{Pose, Rect, Shape, edges};
use envgen::indoor::{IndoorSpec, Profile};
use envgen::world::{Surface, SurfaceKind, Wall, WallKind};
use envgen::{Blueprint, Provenance, Seed, Spec, World};
use glam::DVec2;
use mapping_trial::names::Named;
use mapping_trial::policy::PolicyKind;
use mapping_trial::robot::Robot;
use mapping_trial::score::{Reference, Scores};
use mapping_trial::trial::{EndReason, Trial, TrialSettings};

/// A room of 16 x 12 m with a pond of 6 x 4 m in its centre.
fn room_with_a_pond() -> World {
    let bounds = Rect::new(DVec2::ZERO, DVec2::new(16.0, 12.0));
    let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
    let corners = Shape::from_rect(bounds).corners();
    world.walls =
        edges(&corners).map(|(a, b)| Wall::new(WallKind::Wall, Shape::Segment { a, b })).collect();
    let pond = Rect::new(DVec2::new(5.0, 4.0), DVec2::new(11.0, 8.0));
    let (kind, shape) = (SurfaceKind::Water, Shape::from_rect(pond));
    world.surfaces.push(Surface { speed: 0.0, ..Surface::new(kind, shape) });
    world.start = Some(Pose::new(2.0, 6.0, 0.0));
    world
}

fn run(world: &World, settings: TrialSettings) -> (EndReason, Scores) {
    let truth = Reference::new(world, &settings.body).expect("a start");
    let mut trial = Trial::flat(world, settings).expect("a free start");
    while trial.step() {}
    (trial.end_of(0).expect("an end").reason, trial.score(&truth).expect("scores"))
}

#[test]
fn a_room_with_a_pond_is_explored_around_it() {
    let world = room_with_a_pond();
    for (name, policy) in PolicyKind::NAMES {
        for seed in 0..4 {
            let policy = Some(*policy);
            let settings = TrialSettings { policy, seed: Seed(seed), ..Default::default() };
            let (end, scores) = run(&world, settings);
            assert_eq!(end, EndReason::Explored, "{name}, seed {seed}");
            assert!(scores.coverage > 0.97, "{name}, seed {seed}: {scores:#?}");
        }
    }
}

#[test]
fn who_is_blind_to_water_drowns() {
    let world = room_with_a_pond();
    let body = Robot { water_sight: 0.0, ..Robot::default() };
    let drowned = (0..4).filter(|&seed| {
        let settings = TrialSettings { body: body.clone(), seed: Seed(seed), ..Default::default() };
        run(&world, settings).0 == EndReason::Drowned
    });
    assert!(drowned.count() > 0);
}

/// Number of maps that are driven.
const MAPS: u64 = 10;

/// Most of the thesis's hardest maps have water, and narrow walkways through it that robots have to
/// use. While robots were blind to water, nearly all of them ended in it. None of the 10 may.
#[test]
fn no_robot_drowns_in_the_hardest_maps() {
    let drive = |seed| {
        let spec = IndoorSpec { difficulty: 9.0, profile: Profile::Thesis, ..Default::default() };
        let world = spec.generate(Seed(seed)).expect("a map").to_world();
        run(&world, TrialSettings { seed: Seed(seed), ..TrialSettings::default() }).0
    };
    let ends: Vec<EndReason> = thread::scope(|scope| {
        let half = |first| scope.spawn(move || (first..MAPS).step_by(2).map(drive).collect());
        let halves: [thread::ScopedJoinHandle<'_, Vec<EndReason>>; 2] = [half(0), half(1)];
        halves.into_iter().flat_map(|half| half.join().expect("trials")).collect()
    });
    let drowned = ends.iter().filter(|&&end| end == EndReason::Drowned).count();
    assert_eq!(drowned, 0, "{ends:?}");
}
