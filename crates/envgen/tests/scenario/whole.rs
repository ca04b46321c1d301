//! Whole scenarios: files, digests, steps, errors.

use std::f64::consts::TAU;

use envgen::geometry::{Pose, Shape, unit_vector};
use envgen::glam::DVec2;
use envgen::raycast::Raycaster;
use envgen::scenario::{Reactions, Robot, Scenario, ScenarioSpec, ScenarioState};
use envgen::world::{Wall, WallKind};
use envgen::{Seed, World, WorldKind};
use proptest::prelude::*;

use crate::two_rooms;
use crate::{indoor, room_with_a_person};

fn everything() -> (World, Scenario) {
    let world = indoor(9, 10);
    let spec = ScenarioSpec {
        doors: 0.6,
        people: 12,
        smoke: 0.5,
        smoke_growth: 20.0,
        smoke_sources: 2,
        working: 10.0,
        reaction: Reactions::Mixed,
        ..Default::default()
    };
    let scenario = Scenario::new(&world, &spec, Seed(3)).unwrap();
    (world, scenario)
}

#[test]
fn the_scenario_is_frozen() {
    let (world, scenario) = everything();
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    state.step(120.0, &[]).unwrap();
    // A change here changes what happens in the scenario of every seed.
    let found = [state.digest().to_string(), world.digest().to_string()];
    assert_eq!(
        found.map(|digest| digest[..16].to_owned()),
        ["361cf255c38d9a58", "fc647f03e6b7927d"]
    );
}

#[test]
fn a_file_holds_the_whole_scenario() {
    let (world, scenario) = everything();
    let read = Scenario::from_ron(&scenario.to_ron().unwrap()).unwrap();
    assert_eq!(read, scenario);
    let end = |scenario: &Scenario| {
        let mut state = ScenarioState::new(&world, scenario).unwrap();
        state.step(30.0, &[]).unwrap();
        state.digest()
    };
    assert_eq!(end(&read), end(&scenario));
    assert_eq!(Scenario::new(&world, &scenario.settings, scenario.seed).unwrap(), scenario);
}

#[test]
fn without_settings_nothing_moves() {
    for &kind in WorldKind::ALL {
        let world = kind.default_spec().generate(Seed(3)).unwrap().to_world();
        let scenario = Scenario::new(&world, &ScenarioSpec::default(), Seed(1)).unwrap();
        assert!(scenario.doors.is_empty() && scenario.people.is_empty());
        let state = ScenarioState::new(&world, &scenario).unwrap();
        let middle = world.start.map_or(world.bounds.center(), |start| start.position);
        let rays = Raycaster::new(&world);
        for i in 0..100 {
            let direction = unit_vector(TAU * f64::from(i) / 100.0);
            let still = rays.cast_along(middle, direction, 20.0);
            let hit = state.cast(middle, direction, 20.0);
            assert_eq!(hit.map(|hit| hit.distance), still.map(|hit| hit.distance));
        }
    }
}

#[test]
fn ticks_are_as_exact_after_days_as_at_the_start() {
    let world = indoor(3, 5);
    let scenario = Scenario::new(&world, &ScenarioSpec::default(), Seed(1)).unwrap();
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    // 56 hours: a sum of steps of 0.05 s would have missed a tick after 44 hours.
    for tick in 1..=4_000_000 {
        state.step(0.05, &[]).unwrap();
        assert_eq!(state.tick(), tick);
    }
    assert!((state.time() - 200_000.0).abs() < 1e-6);
    let mut short = state.clone();
    for half in 1..=200_000 {
        short.step(0.025, &[]).unwrap();
        assert_eq!(short.tick(), 4_000_000 + half / 2);
    }
    // A frame of 1/60 s is no whole part of a tick.
    let mut frames = state.clone();
    for frame in 1..=300_000 {
        frames.step(1.0 / 60.0, &[]).unwrap();
        assert_eq!(frames.tick(), 4_000_000 + frame / 3);
    }
    state.step(5000.0, &[]).unwrap();
    assert_eq!(state.tick(), 4_100_000);
    for other in [short, frames] {
        assert_eq!(other.tick(), state.tick());
        assert!((other.time() - state.time()).abs() < 1e-6);
    }
    // As are days in single steps, and ten seconds after another month.
    for _ in 0..30 {
        state.step(86_400.0, &[]).unwrap();
    }
    assert_eq!(state.tick(), 4_100_000 + 30 * 1_728_000);
    for tick in 1..=200 {
        state.step(0.05, &[]).unwrap();
        assert_eq!(state.tick(), 4_100_000 + 30 * 1_728_000 + tick);
    }
}

/// The error of a scenario in a world.
fn refusal(world: &World, spec: ScenarioSpec) -> String {
    Scenario::new(world, &spec, Seed(1)).unwrap_err().to_string()
}

#[test]
fn errors_name_what_does_not_fit() {
    let forest = WorldKind::Forest.default_spec().generate(Seed(1)).unwrap().to_world();
    let (world, scenario) = everything();
    let spec = |text: &str| ron::from_str::<ScenarioSpec>(text).unwrap();
    assert_eq!(
        refusal(&forest, spec("(doors: 0.5)")),
        "`doors` must be 0, got 0.5: the world has no open doorway"
    );
    assert_eq!(
        refusal(&world, spec("(smoke: -0.5)")),
        "`smoke` must be a number from 0 to 100, got -0.5"
    );
    let error = refusal(&world, spec("(people: 10000)"));
    assert!(error.starts_with("`people` must be a whole number from 0 to "), "{error}");
    assert!(error.ends_with("got 10000: no more fit into the free space"), "{error}");
    // As many as the error says do fit.
    let most = error.split("from 0 to ").nth(1).unwrap().split(',').next().unwrap();
    let most = ScenarioSpec { people: most.parse().unwrap(), ..Default::default() };
    let crowd = Scenario::new(&world, &most, Seed(1)).unwrap();
    assert!(ScenarioState::new(&world, &crowd).is_ok());
    let full = {
        let mut full = room_with_a_person("regular").0;
        let solid = Shape::from_rect(full.bounds);
        full.walls.push(Wall::new(WallKind::Wall, solid));
        full
    };
    let error = refusal(&full, spec("(people: 1)"));
    assert!(error.starts_with("`people` must be 0, got 1: nowhere in the world"), "{error}");

    let refused = |change: &dyn Fn(&mut Scenario)| {
        let mut scenario = scenario.clone();
        change(&mut scenario);
        ScenarioState::new(&world, &scenario).unwrap_err().to_string()
    };
    let n = world.doorways.len();
    assert_eq!(
        refused(&|s| s.doors[1].doorway = 999),
        format!(
            "`doors[1].doorway` must be the index of a doorway of the world, at most {}, got 999",
            n - 1
        )
    );
    let error = refused(&|s| s.doors[1].doorway = s.doors[0].doorway);
    assert!(
        error.contains("a doorway without a door") && error.ends_with("doors[0] is in it"),
        "{error}"
    );
    let error = refused(&|s| s.doors[0].open = f64::NAN);
    assert!(error.starts_with("`doors[0].open` must be a number from 0.5"), "{error}");
    let error = refused(&|s| s.smoke = vec![s.smoke[0]; 1001]);
    assert_eq!(error, "`smoke_sources` must be a whole number from 1 to 1000, got 1001");
    let error = refused(&|s| s.people[2].position = DVec2::ZERO);
    assert!(error.starts_with("`people[2].position` must be a point with 0.25 m"), "{error}");
    // Where nothing is known of solids.
    for position in [DVec2::splat(5000.0), DVec2::NAN, DVec2::new(1.0, f64::INFINITY)] {
        let error = refused(&|s| s.people[2].position = position);
        assert!(error.starts_with("`people[2].position` must be a point with 0.25 m"), "{error}");
    }
    let error = refused(&|s| s.people[3].position = s.people[1].position);
    assert!(error.ends_with("people[1] is nearer"), "{error}");
    let error = refused(&|s| s.smoke[0].extinction = -1.0);
    assert_eq!(error, "`smoke[0].extinction` must be a number from 0 to 100, got -1");
    let mut state = ScenarioState::new(&world, &scenario).unwrap();
    let error = state.step(f64::NAN, &[]).unwrap_err().to_string();
    assert_eq!(error, "`dt` must be a number from 0 to 86400, got NaN");
    let robot = Robot { position: DVec2::NAN, velocity: DVec2::ZERO, radius: 0.3 };
    let error = state.step(1.0, &[robot]).unwrap_err().to_string();
    assert!(error.starts_with("`robots[0].position` must be finite numbers"), "{error}");
    assert_eq!(state.tick(), 0);
    assert_eq!(Pose::default().position, DVec2::ZERO);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn steps_of_any_length_are_the_same_to_the_bit(
        steps in prop::collection::vec(0.0..3.0_f64, 1..40),
    ) {
        let (world, scenario) = everything();
        let state = ScenarioState::new(&world, &scenario).unwrap();
        let (mut many, mut one) = (state.restarted(), state);
        for &dt in &steps {
            many.step(dt, &[]).unwrap();
        }
        one.step(many.time(), &[]).unwrap();
        prop_assert_eq!(many.digest(), one.digest());
    }
}

proptest! {
    #[test]
    fn any_text_is_a_scenario_or_an_error(text in ".{0,200}") {
        let _ = Scenario::from_ron(&text);
    }

    #[test]
    fn any_numbers_are_a_scenario_or_an_error(
        doors: f64, people in 0..40_u32, smoke: f64, speed: f64, growth: f64, door: u32,
        x: f64, y: f64, extinction: f64, radius: f64,
    ) {
        let (world, known) = two_rooms("kind: hinged, control: timed");
        let spec = ScenarioSpec {
            doors, people, smoke, walking_speed: speed, smoke_growth: growth, ..Default::default()
        };
        if let Ok(mut scenario) = Scenario::new(&world, &spec, Seed(1)) {
            let mut state = ScenarioState::new(&world, &scenario).unwrap();
            state.step(1.0, &[]).unwrap();
            scenario.doors = vec![envgen::scenario::Door { doorway: door, ..known.doors[0] }];
            let _ = ScenarioState::new(&world, &scenario);
        }
        let mut scenario = known;
        let disc = format!("disc(center: ({x:?}, {y:?}), radius: {radius:?})");
        let rectangle = format!("box(min: ({x:?}, {y:?}), max: ({radius:?}, {speed:?}))");
        for region in [disc, rectangle] {
            let text = format!(
                "(region: {region}, extinction: {extinction:?}, growth: 0.0, kind: regional)"
            );
            let Ok(source) = ron::from_str(&text) else { continue };
            scenario.smoke = vec![source];
            if let Ok(mut state) = ScenarioState::new(&world, &scenario) {
                state.step(1.0, &[]).unwrap();
                let extinction = state.extinction(DVec2::new(x, y));
                prop_assert!((0.0..=100.0).contains(&extinction));
            }
        }
    }
}
