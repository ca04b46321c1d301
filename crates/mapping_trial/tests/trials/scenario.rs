//! Trials in worlds with doors, people and smoke.

use envgen::geometry::{Pose, Rect, Shape, edges};
use envgen::glam::DVec2;
use envgen::indoor::IndoorSpec;
use envgen::scenario::smoke::smoke_range;
use envgen::scenario::{FailedBeams, Person, Reaction, Scenario, ScenarioSpec};
use envgen::world::{Wall, WallKind};
use envgen::{Blueprint, Provenance, Seed, Spec, World};
use mapping_trial::backend::{Command, RobotBackend};
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::trial::{Trial, TrialLog, TrialSettings};

fn hall(width: f64, height: f64, start: Pose) -> World {
    let bounds = Rect::new(DVec2::ZERO, DVec2::new(width, height));
    let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
    let corners = Shape::from_rect(bounds).corners();
    world.walls =
        edges(&corners).map(|(a, b)| Wall::new(WallKind::Wall, Shape::Segment { a, b })).collect();
    world.start = Some(start);
    world
}

fn indoor(seed: u64) -> World {
    let spec = IndoorSpec { width: 6, height: 6, ..Default::default() };
    spec.generate(Seed(seed)).expect("a plan").to_world()
}

fn person(x: f64, y: f64) -> Person {
    let position = DVec2::new(x, y);
    Person { position, heading: 0.0, speed: 1.0, reaction: Reaction::Surprised }
}

fn settings(time_limit: f64) -> TrialSettings {
    TrialSettings { time_limit, odometry: OdometryProfile::EXACT, ..Default::default() }
}

fn still(world: &World) -> Scenario {
    Scenario::new(world, &ScenarioSpec::default(), Seed(1)).expect("a scenario")
}

#[test]
fn a_person_stops_a_robot_and_is_seen() {
    let world = hall(12.0, 6.0, Pose::new(2.0, 3.0, 0.0));
    let mut scenario = still(&world);
    scenario.people = vec![person(5.0, 3.0)];
    let mut trial =
        Trial::builder(&world, settings(60.0)).scenario(scenario).build_flat().expect("a trial");
    let ahead = Command { speed: 0.5, turn_rate: 0.0 };
    assert!(trial.step_with(&[ahead]));
    // 2.75 m to the person's front, less where the laser is.
    let laser = trial.settings().body.laser_pose(Pose::new(2.0, 3.0, 0.0));
    let seen = trial.autonomy().scan(0).ranges[90];
    assert!((seen - (4.75 - laser.position.x)).abs() < 0.05, "{seen}");
    while trial.time() < 20.0 && trial.step_with(&[ahead]) {}
    let at = trial.bodies().pose(0).position;
    let person = trial.bodies().scenario().expect("a scenario").people()[0].position;
    let radius = trial.settings().body.circumscribed_radius;
    assert!(at.distance(person) >= radius + 0.25 - 1e-3, "{at} {person}");
    assert!(at.x < person.x);
    assert_eq!((trial.bodies().collisions(0), trial.bodies().person_collisions(0)), (0, 1));
    let scores = trial.score(&trial.reference(&world).expect("an area")).expect("scores");
    let moving = scores.moving.expect("something moves");
    assert_eq!((scores.collisions, moving.person_collisions), (0, 1));
    assert!(moving.swept_area > 0.3, "{moving:?}");
}

#[test]
fn smoke_hides_what_is_beyond_its_range() {
    let world = hall(40.0, 10.0, Pose::new(20.0, 5.0, 0.0));
    let scan = |failed_beams| {
        let spec =
            ScenarioSpec { smoke: 0.5, smoke_radius: 100.0, failed_beams, ..Default::default() };
        let scenario = Scenario::new(&world, &spec, Seed(1)).expect("a scenario");
        let mut trial = Trial::builder(&world, settings(60.0))
            .scenario(scenario)
            .build_flat()
            .expect("a trial");
        assert!(trial.step());
        trial.autonomy().scan(0).ranges.clone()
    };
    // A SICK of 30 m sees 4 m in smoke of 0.5 per metre.
    let reach = smoke_range(30.0, 0.5);
    assert!((reach - 4.0).abs() < 0.05, "{reach}");
    let none = scan(FailedBeams::None);
    // The side walls are 5 m away, the front wall 20 m.
    assert!(none.iter().all(|range| range.is_nan()), "{none:?}");
    assert!(scan(FailedBeams::Zero).iter().all(|range| *range == 0.0));
    let phantom = scan(FailedBeams::Phantom);
    assert!(phantom.iter().all(|range| (0.8..8.19).contains(range)), "{phantom:?}");
}

#[test]
fn a_trial_with_everything_is_replayed_to_the_bit() {
    let world = indoor(3);
    let spec = ScenarioSpec { doors: 0.6, people: 4, smoke: 0.3, ..Default::default() };
    let scenario = Scenario::new(&world, &spec, Seed(5)).expect("a scenario");
    let mut trial = Trial::builder(&world, settings(90.0))
        .scenario(scenario.clone())
        .build_flat()
        .expect("a trial");
    while trial.step() {}
    let state = |trial: &Trial<mapping_trial::flat::FlatSimulator>| {
        trial.bodies().scenario().expect("a scenario").digest().to_string()
    };
    let mut text = Vec::new();
    trial.log().write(&mut text).expect("a log");
    let log = TrialLog::read(&mut text.as_slice()).expect("the same log");
    assert_eq!(log.scenario.as_ref(), Some(&scenario));
    let again = log.replay().expect("a trial");
    assert_eq!(state(&again), state(&trial));
    assert_eq!(again.log().digest(), trial.log().digest());
    let truth = trial.reference(&world).expect("an area");
    assert_eq!(again.score(&truth), trial.score(&truth));
}

#[test]
fn a_still_scenario_changes_nothing() {
    let world = indoor(4);
    let run = |scenario: Option<Scenario>| {
        let mut builder = Trial::builder(&world, settings(60.0));
        if let Some(scenario) = scenario {
            builder = builder.scenario(scenario);
        }
        let mut trial = builder.build_flat().expect("a trial");
        while trial.step() {}
        trial.trajectory(0).clone()
    };
    assert_eq!(run(Some(still(&world))), run(None));
}

#[test]
fn a_scenario_of_another_world_is_refused() {
    let (world, other) = (indoor(3), hall(12.0, 6.0, Pose::new(2.0, 3.0, 0.0)));
    let spec = ScenarioSpec { doors: 1.0, ..Default::default() };
    let scenario = Scenario::new(&world, &spec, Seed(5)).expect("a scenario");
    let built = Trial::builder(&other, settings(60.0)).scenario(scenario).build_flat();
    let error = built.err().expect("no trial").to_string();
    assert!(error.starts_with("`doors[0].doorway` must be"), "{error}");
}
