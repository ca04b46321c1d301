//! Doors, people and smoke as entities.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_envgen::bevy_rapier2d::prelude::*;
use bevy_envgen::envgen::clearance_index::ClearanceIndex;
use bevy_envgen::envgen::glam::DVec2;
use bevy_envgen::envgen::{Seed, WorldSpec};
use bevy_envgen::prelude::*;
use bevy_envgen::scenario::{Reactions, Scenario, ScenarioError, ScenarioState};
use bevy_envgen::testing::{
    in_rapier, spawn_ready, step, test_app, test_app_with, truth, wait_until_ready,
};

use super::GenerateWorld;

/// Returns settings with doors, people and smoke.
fn everything() -> ScenarioSpec {
    let reaction = Reactions::Mixed;
    ScenarioSpec {
        doors: 0.6,
        people: 6,
        smoke: 0.4,
        reaction,
        waiting: 2.0,
        working: 4.0,
        ..default()
    }
}

fn indoor() -> Environment {
    Environment::new(IndoorSpec::default(), 4)
}

/// Creates an app with an indoor map and a scenario with everything.
fn busy(seed: u64) -> (App, Entity) {
    let mut app = test_app();
    let scenario = EnvironmentScenario::new(everything(), seed);
    let root = app.world_mut().spawn((indoor(), scenario)).id();
    wait_until_ready(&mut app, root).unwrap();
    (app, root)
}

fn state(app: &App, root: Entity) -> &ScenarioState {
    app.world().get::<ScenarioRun>(root).expect("a scenario").state()
}

/// Returns the numbers of people, doors, leaves and places of smoke.
fn count(app: &mut App) -> [usize; 4] {
    let world = app.world_mut();
    [
        world.query::<&Person>().iter(world).count(),
        world.query::<&Door>().iter(world).count(),
        world.query::<&DoorLeaf>().iter(world).count(),
        world.query::<&Smoke>().iter(world).count(),
    ]
}

#[test]
fn everything_is_where_the_scenario_has_it_step_by_step() {
    let (mut app, root) = busy(3);
    let world = truth(&app, root);
    let scenario = Scenario::new(&world, &everything(), Seed(3)).unwrap();
    assert_eq!(*app.world().get::<ScenarioRun>(root).unwrap().scenario(), scenario);
    let mut alone = ScenarioState::new(&world, &scenario).unwrap();
    // Catches up with the step of the frame in which the scenario began.
    alone.step(state(&app, root).time(), &[]).unwrap();
    let mut moved = 0;
    for _ in 0..64 * 15 {
        step(&mut app, 1);
        alone.step(1.0 / 64.0, &[]).unwrap();
        assert_eq!(state(&app, root).tick(), alone.tick());
        let mut next = alone.clone();
        next.step(0.05, &[]).unwrap();
        let now = alone.interpolated(&next, 20.0 * alone.time() - alone.tick() as f64);
        let run = app.world().get::<ScenarioRun>(root).unwrap();
        assert_eq!(run.now().digest(), now.digest());
        for (&entity, person) in run.people().iter().zip(now.people()) {
            let at = app.world().get::<Transform>(entity).unwrap();
            assert_eq!(at.translation.truncate(), person.position.as_vec2());
            let facing = (at.rotation * Vec3::X).truncate();
            assert!(facing.distance(person.facing.as_vec2()) < 1e-5);
            moved += usize::from(person.velocity != DVec2::ZERO);
        }
        for (index, entity) in run.doors().enumerate() {
            let door = app.world().get::<Door>(entity).unwrap();
            assert_eq!(door.openness(), alone.doors()[index].openness);
            let leaves = app.world().get::<Children>(entity).unwrap();
            for (leaf, there) in leaves.iter().zip(now.leaves(index)) {
                let frame = app.world().get::<GlobalTransform>(leaf).unwrap();
                let length = app.world().get::<DoorLeaf>(leaf).unwrap().length;
                let tip = frame.transform_point(Vec3::X * length).truncate();
                assert!(frame.translation().truncate().distance(there.hinge.as_vec2()) < 1e-4);
                assert!(tip.distance(there.tip.as_vec2()) < 1e-4, "{tip} {there:?}");
            }
        }
    }
    assert_eq!(state(&app, root).digest(), alone.digest());
    assert!(moved > 500, "{moved}");
    let known: Vec<_> = (0..).zip(alone.smoke()).map(|(i, (_, smoke))| (i, smoke)).collect();
    let mut smoke = app.world_mut().query::<&Smoke>();
    let shown: Vec<_> = smoke.iter(app.world()).map(|s| (s.index, s.extinction)).collect();
    assert!(known.len() > 2 && known.iter().all(|place| shown.contains(place)));
}

#[test]
fn frames_of_any_length_give_the_same_scenario() {
    let end = |frame: f64| {
        let mut app = test_app();
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(frame)));
        let scenario = EnvironmentScenario::new(everything(), 5);
        let environment = indoor().with_pace(GenerationMode::Blocking);
        let root = app.world_mut().spawn((environment, scenario)).id();
        step(&mut app, 5);
        // An agent that people and doors meet from their start.
        let body = (RigidBody::KinematicVelocityBased, Velocity::linear(Vec2::new(0.4, 0.1)));
        let start = Transform::from_xyz(5.0, 5.0, 0.0);
        app.world_mut().spawn((start, ScenarioAgent::new(0.3), Collider::ball(0.3), body));
        app.world_mut().trigger(RestartScenario { entity: root });
        while state(&app, root).tick() < 120 {
            app.update();
        }
        let state = state(&app, root);
        (state.tick() == 120).then(|| state.digest().to_string())
    };
    let first = end(1.0 / 64.0).unwrap();
    // A long frame may end after the tick.
    let found: Vec<_> = [1.0 / 190.0, 1.0 / 40.0, 0.05].into_iter().filter_map(end).collect();
    assert!(found.len() > 1 && found.iter().all(|other| *other == first), "{first} {found:?}");
}

#[test]
fn nobody_walks_into_walls_or_agents() {
    let (mut app, root) = busy(7);
    let index = ClearanceIndex::new(&truth(&app, root), 1.0).unwrap();
    let start = app.world().get::<EnvironmentLandmarks>(root).unwrap().start.unwrap().pose;
    app.world_mut().spawn((start, ScenarioAgent::new(0.3), RigidBody::Fixed, Collider::ball(0.3)));
    for _ in 0..300 {
        step(&mut app, 6);
        let mut people = app.world_mut().query_filtered::<&GlobalTransform, With<Person>>();
        for at in people.iter(app.world()) {
            let p = at.translation();
            let clearance = index.clearance(p.truncate().as_dvec2());
            assert!(clearance > 0.249, "{clearance} at {p}");
            assert!(p.distance(start.translation) > 0.54, "{p}");
        }
    }
}

#[test]
fn nothing_is_left_of_a_scenario_that_is_gone() {
    let (mut app, root) = busy(1);
    step(&mut app, 5);
    let [people, doors, leaves, smoke] = count(&mut app);
    assert!(people == 6 && doors > 2 && leaves >= doors && smoke > 2);
    let full = in_rapier(&mut app);
    for _ in 0..3 {
        app.world_mut().trigger(RestartScenario { entity: root });
        step(&mut app, 3);
        assert_eq!((count(&mut app), in_rapier(&mut app)), ([6, doors, leaves, smoke], full));
        assert!(state(&app, root).tick() < 3);
    }
    app.world_mut().entity_mut(root).remove::<EnvironmentScenario>();
    step(&mut app, 3);
    assert_eq!(count(&mut app), [0; 4]);
    assert_eq!(in_rapier(&mut app), (full.0 - people - leaves, full.1 - people - leaves));
    assert!(!app.world().entity(root).contains::<ScenarioRun>());

    app.world_mut().entity_mut(root).insert(EnvironmentScenario::new(everything(), 2));
    step(&mut app, 3);
    assert_eq!(count(&mut app)[0], 6);
    // First the world is removed without the entity, and then the entity is despawned.
    let environment = app.world_mut().entity_mut(root).take::<Environment>().unwrap();
    step(&mut app, 3);
    assert_eq!((count(&mut app), in_rapier(&mut app)), ([0; 4], (0, 0)));
    app.world_mut().entity_mut(root).insert(environment);
    wait_until_ready(&mut app, root).unwrap();
    assert_eq!(count(&mut app)[0], 6);
    app.world_mut().despawn(root);
    step(&mut app, 3);
    assert_eq!((count(&mut app), in_rapier(&mut app)), ([0; 4], (0, 0)));
}

#[test]
fn another_world_or_scenario_starts_from_its_beginning() {
    #[derive(Resource, Default)]
    struct Heard(Vec<String>);
    let mut app = test_app();
    app.init_resource::<Heard>();
    app.add_observer(|_: On<ScenarioStarted>, mut heard: ResMut<Heard>| {
        heard.0.push("started".into());
    });
    app.add_observer(|failed: On<ScenarioFailed>, mut heard: ResMut<Heard>| {
        heard.0.push(failed.error.to_string());
    });
    let heard = |app: &mut App, frames: usize| {
        step(app, frames);
        std::mem::take(&mut app.world_mut().resource_mut::<Heard>().0)
    };
    let root = spawn_ready(&mut app, indoor()).unwrap();
    assert!(heard(&mut app, 2).is_empty());
    let people = |people| EnvironmentScenario::new(ScenarioSpec { people, ..default() }, 1);
    app.world_mut().entity_mut(root).insert(people(3));
    assert_eq!(heard(&mut app, 2), ["started"]);
    assert_eq!(count(&mut app), [3, 0, 0, 0]);
    app.world_mut().entity_mut(root).insert(people(5));
    assert_eq!(heard(&mut app, 2), ["started"]);
    assert_eq!(count(&mut app), [5, 0, 0, 0]);

    let small = WorldSpec::from(HallwaySpec { segments: 4, ..default() });
    app.world_mut().entity_mut(root).insert(Environment::new(small, 2));
    wait_until_ready(&mut app, root).unwrap();
    assert_eq!(heard(&mut app, 2), ["started"]);
    assert_eq!(state(&app, root).people().len(), 5);

    app.world_mut().entity_mut(root).insert(people(10_000));
    let reported = heard(&mut app, 2);
    assert!(reported.len() == 1 && reported[0].contains("`people` must be"), "{reported:?}");
    assert!(app.world().get::<ScenarioFailure>(root).is_some());
    assert!(!app.world().entity(root).contains::<ScenarioRun>());
    assert_eq!(count(&mut app), [0; 4]);

    // A listed scenario that is made for another world.
    let other = IndoorSpec::default().generate_world(9);
    let doors = ScenarioSpec { doors: 1.0, ..default() };
    let listed = Scenario::new(&other, &doors, Seed(1)).unwrap();
    app.world_mut().entity_mut(root).insert(EnvironmentScenario::prebuilt(listed));
    let reported = heard(&mut app, 2);
    assert!(
        reported.len() == 1 && reported[0].contains("`doors[0].doorway` must be"),
        "{reported:?}"
    );
    app.world_mut().entity_mut(root).insert(people(1));
    assert_eq!(heard(&mut app, 2), ["started"]);
    assert!(app.world().get::<ScenarioFailure>(root).is_none());

    let anchor = app.world_mut().spawn(Transform::default()).id();
    let forest = Environment::new(ForestSpec::default(), 1).endless(10.0);
    let forest = (forest, StreamAround::new(anchor, 20.0), people(2));
    let root = app.world_mut().spawn(forest).id();
    wait_until_ready(&mut app, root).unwrap();
    let failure = app.world().get::<ScenarioFailure>(root).unwrap();
    assert_eq!(**failure, ScenarioError::Endless);
}

#[test]
fn a_request_that_is_written_again_as_it_was_restarts_nothing() {
    let (mut app, root) = busy(3);
    step(&mut app, 20);
    let people = app.world().get::<ScenarioRun>(root).unwrap().people().to_vec();
    for _ in 0..20 {
        app.world_mut().get_mut::<EnvironmentScenario>(root).unwrap().seed = 3;
        step(&mut app, 1);
        app.world_mut().entity_mut(root).insert(EnvironmentScenario::new(everything(), 3));
        step(&mut app, 1);
    }
    assert_eq!(app.world().get::<ScenarioRun>(root).unwrap().people(), people);
    assert!(state(&app, root).tick() > 15);
    // A scenario that has failed is tried again only when something has changed.
    let many = EnvironmentScenario::new(ScenarioSpec { people: 10_000, ..default() }, 1);
    app.world_mut().entity_mut(root).insert(many.clone());
    step(&mut app, 1);
    let added = |app: &App| {
        let root = app.world().entity(root);
        root.get_change_ticks::<ScenarioFailure>().map(|ticks| ticks.added)
    };
    let first = added(&app).unwrap();
    app.world_mut().entity_mut(root).insert(many);
    step(&mut app, 2);
    assert_eq!(added(&app), Some(first));
    app.world_mut().get_mut::<EnvironmentScenario>(root).unwrap().source =
        EnvironmentScenario::new(everything(), 4).source;
    step(&mut app, 2);
    assert_eq!(count(&mut app)[0], 6);
}

#[test]
fn agents_that_are_moved_in_jumps_are_not_faster() {
    let mut app = test_app();
    let agent = app.world_mut().spawn((Transform::default(), ScenarioAgent::new(0.3))).id();
    let velocity = |app: &App| {
        let shown = format!("{:?}", app.world().get::<ScenarioAgent>(agent).unwrap());
        let from = shown.find("velocity: Vec2(").unwrap() + "velocity: Vec2(".len();
        shown[from..].split(',').next().unwrap().parse::<f32>().unwrap()
    };
    // Half a metre per second, in every second step only.
    let mut seen = Vec::new();
    for number in 0..200 {
        if number % 2 == 0 {
            app.world_mut().get_mut::<Transform>(agent).unwrap().translation.x += 1.0 / 64.0;
        }
        step(&mut app, 1);
        seen.push(velocity(&app));
    }
    assert!(seen[20..].iter().all(|speed| (0.4..0.6).contains(speed)), "{seen:?}");
    // The agent is moved elsewhere.
    app.world_mut().get_mut::<Transform>(agent).unwrap().translation.x += 100.0;
    for _ in 0..10 {
        step(&mut app, 1);
        assert!(velocity(&app) < 0.6);
    }
}

#[test]
fn an_environment_that_is_moved_turned_and_resized_takes_them_along() {
    let mut app = test_app();
    let turn = Quat::from_rotation_z(1.0);
    let at = Transform::from_xyz(40.0, -7.0, 0.0).with_rotation(turn).with_scale(Vec3::splat(2.0));
    let environment = indoor().with_origin(DVec2::new(3.0, 2.0));
    let scenario = EnvironmentScenario::new(everything(), 3);
    let root = app.world_mut().spawn((environment.clone(), at, scenario)).id();
    wait_until_ready(&mut app, root).unwrap();
    step(&mut app, 200);
    let run = app.world().get::<ScenarioRun>(root).unwrap();
    let frame = *app.world().get::<GlobalTransform>(root).unwrap();
    for (&entity, person) in run.people().iter().zip(run.now().people()) {
        let there = app.world().get::<GlobalTransform>(entity).unwrap().translation().truncate();
        let expected = environment.point_in_app(&frame, person.position);
        assert!(there.distance(expected) < 1e-3, "{there} {expected}");
    }
    // People avoid an agent that is in front of them in this environment.
    let person = run.people()[0];
    let before = *app.world().get::<GlobalTransform>(person).unwrap();
    let body = Transform::from_translation(before.translation());
    app.world_mut().spawn((body, ScenarioAgent::new(0.1)));
    step(&mut app, 2);
    let mut agents = app.world_mut().query::<&ScenarioAgent>();
    assert_eq!(agents.iter(app.world()).count(), 1);
}

/// An app with a map whose doors open for agents, and one of these doors.
fn with_triggered_doors() -> (App, Entity) {
    let mut app = test_app();
    let door_control = DoorControl::Triggered;
    let spec = ScenarioSpec { doors: 1.0, door_control, ..default() };
    let root = app.world_mut().spawn((indoor(), EnvironmentScenario::new(spec, 1))).id();
    wait_until_ready(&mut app, root).unwrap();
    let door = app.world().get::<ScenarioRun>(root).unwrap().doors().next().unwrap();
    (app, door)
}

#[test]
fn a_door_sees_an_agent_where_it_is_while_both_are_moved() {
    type Shifted = Or<(With<Environment>, With<ScenarioAgent>)>;
    let (mut app, door) = with_triggered_doors();
    let at = app.world().get::<GlobalTransform>(door).unwrap().translation() + Vec3::Y * 0.5;
    app.world_mut().spawn((Transform::from_translation(at), ScenarioAgent::new(0.1)));
    // Moves everything to and fro, as a floating origin does, before Bevy or rapier propagate transforms.
    let mut by = 64.0;
    let swing = move |mut all: Query<&mut Transform, Shifted>| {
        all.iter_mut().for_each(|mut at| at.translation.x += by);
        by = -by;
    };
    let between = swing.after(PhysicsSet::Writeback).before(ScenarioSystems);
    app.add_systems(FixedUpdate, between);
    step(&mut app, 100);
    assert_eq!(app.world().get::<Door>(door).unwrap().openness(), 1.0);
}

/// A resource with the largest distance between a person or leaf and its current place.
#[derive(Resource, Default)]
struct Astray(f32);

#[test]
fn people_and_leaves_are_in_an_environment_that_moves_in_the_same_step() {
    type Moving = Or<(With<Person>, With<DoorLeaf>)>;
    let (mut app, root) = busy(3);
    app.init_resource::<Astray>();
    let shift = |mut all: Query<&mut Transform, With<Environment>>| {
        all.iter_mut().for_each(|mut at| at.translation.x += 64.0);
    };
    let look = |moving: Query<(Entity, &GlobalTransform), Moving>,
                transforms: TransformHelper,
                mut astray: ResMut<Astray>| {
        for (entity, known) in &moving {
            let at = transforms.compute_global_transform(entity).unwrap().translation();
            astray.0 = astray.0.max(known.translation().distance(at));
        }
    };
    app.add_systems(
        FixedUpdate,
        (shift.after(PhysicsSet::Writeback).before(ScenarioSystems), look.after(ScenarioSystems)),
    );
    for is_paused in [false, true] {
        app.world_mut().get_mut::<ScenarioRun>(root).unwrap().set_paused(is_paused);
        step(&mut app, 10);
        assert!(
            app.world().resource::<Astray>().0 < 0.01,
            "{}",
            app.world().resource::<Astray>().0
        );
    }
}

#[test]
fn a_collision_with_a_person_is_reported_in_its_step() {
    #[derive(Resource, Default)]
    struct Heard(Vec<Entity>);
    let fixed = EnvgenPlugins::default().in_schedule(FixedUpdate);
    for envgen in [EnvgenPlugins::default(), fixed] {
        let mut app = test_app_with(envgen);
        app.init_resource::<Heard>().add_observer(
            |collision: On<PersonCollision>, mut heard: ResMut<Heard>| {
                heard.0.push(collision.entity);
            },
        );
        let spec = ScenarioSpec { people: 1, waiting: 1e6, ..default() };
        let hall = Environment::new(IndoorSpec::default(), 4);
        let root = app.world_mut().spawn((hall, EnvironmentScenario::new(spec, 1))).id();
        wait_until_ready(&mut app, root).unwrap();
        let person = app.world().get::<ScenarioRun>(root).unwrap().people()[0];
        let at = app.world().get::<GlobalTransform>(person).unwrap().translation();
        let aside = Transform::from_translation(at + Vec3::X * 0.4);
        let ball = (RigidBody::Dynamic, Collider::ball(0.1), Velocity::linear(Vec2::NEG_X * 0.5));
        let ball = app.world_mut().spawn((ball, aside)).id();
        let mut known = app.world().resource::<Messages<CollisionEvent>>().get_cursor();
        let mut has_begun = false;
        for _ in 0..40 {
            step(&mut app, 1);
            let events = app.world().resource::<Messages<CollisionEvent>>();
            has_begun |= known.read(events).any(|event| {
                matches!(event, CollisionEvent::Started(a, b, _) if [[*a, *b], [*b, *a]].contains(&[person, ball]))
            });
            let heard = &app.world().resource::<Heard>().0[..];
            assert_eq!(heard, &[person][..usize::from(has_begun)]);
        }
        assert!(has_begun);
    }
}

#[test]
fn people_react_to_agents_and_are_hit_by_bodies() {
    #[derive(Resource, Default)]
    struct Heard(Vec<bool>, Vec<(Entity, Entity)>);
    let mut app = test_app();
    app.init_resource::<Heard>();
    app.add_observer(|reacted: On<PersonReacted>, mut heard: ResMut<Heard>| {
        heard.0.push(reacted.begins);
    });
    app.add_observer(|collision: On<PersonCollision>, mut heard: ResMut<Heard>| {
        heard.1.push((collision.entity, collision.collider));
    });
    let spec =
        ScenarioSpec { people: 1, reaction: Reactions::Surprised, waiting: 1e6, ..default() };
    let hall = Environment::new(IndoorSpec::default(), 4);
    let root = app.world_mut().spawn((hall, EnvironmentScenario::new(spec, 1))).id();
    wait_until_ready(&mut app, root).unwrap();
    let person = app.world().get::<ScenarioRun>(root).unwrap().people()[0];
    let at = app.world().get::<GlobalTransform>(person).unwrap().translation();
    let ball = (RigidBody::Dynamic, Collider::ball(0.1), ScenarioAgent::new(0.1));
    // The ball starts within the free space that a person needs, and moves towards the person.
    let aside = Transform::from_translation(at + Vec3::X * 0.4);
    let ball = app.world_mut().spawn((ball, aside, Velocity::linear(Vec2::NEG_X * 0.5))).id();
    step(&mut app, 40);
    assert!(app.world().get::<Person>(person).unwrap().reacts);
    let heard = app.world().resource::<Heard>();
    assert_eq!((&heard.0[..], &heard.1[..]), (&[true][..], &[(person, ball)][..]));
    step(&mut app, 64 * 30);
    assert_eq!(app.world().resource::<Heard>().0, [true, false]);
}

#[test]
fn a_door_opens_for_an_agent_and_bad_agents_are_ignored() {
    let (mut app, door) = with_triggered_doors();
    let at = app.world().get::<GlobalTransform>(door).unwrap().compute_transform();
    let near = Transform::from_translation(at.translation + Vec3::Y * 0.5);
    for radius in [f64::NAN, f64::INFINITY, -1.0] {
        app.world_mut().spawn((near, ScenarioAgent::new(radius)));
    }
    app.world_mut().spawn((Transform::from_xyz(f32::NAN, 0.0, 0.0), ScenarioAgent::new(0.2)));
    step(&mut app, 100);
    assert_eq!(app.world().get::<Door>(door).unwrap().openness(), 0.0);
    app.world_mut().spawn((near, ScenarioAgent::new(0.1)));
    step(&mut app, 100);
    assert_eq!(app.world().get::<Door>(door).unwrap().openness(), 1.0);
}

#[test]
fn a_clone_has_a_scenario_of_its_own() {
    let (mut app, root) = busy(2);
    let before = count(&mut app);
    for deep in [false, true] {
        let clone = app.world_mut().entity_mut(root).clone_and_spawn_with_opt_out(move |builder| {
            builder.linked_cloning(deep);
        });
        wait_until_ready(&mut app, clone).unwrap();
        assert_eq!(count(&mut app), before.map(|n| 2 * n), "{deep}");
        assert_eq!(state(&app, clone).people().len(), 6);
        app.world_mut().despawn(clone);
        step(&mut app, 2);
        assert_eq!(count(&mut app), before);
    }
}

#[test]
fn a_scenario_needs_no_physics() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, EnvgenCorePlugin::default()));
    app.add_plugins(EnvgenScenarioPlugin::default());
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(0.1)));
    let scenario = EnvironmentScenario::new(everything(), 1);
    let environment = indoor().with_pace(GenerationMode::Blocking);
    let root = app.world_mut().spawn((environment, scenario)).id();
    step(&mut app, 300);
    let state = state(&app, root);
    let mut alone = ScenarioState::new(
        &truth(&app, root),
        app.world().get::<ScenarioRun>(root).unwrap().scenario(),
    )
    .unwrap();
    alone.step(state.time(), &[]).unwrap();
    assert!(state.time() > 29.0);
    assert_eq!(state.digest(), alone.digest());
}

#[test]
fn another_origin_moves_nothing_before_its_world_is_there() {
    let (mut app, root) = busy(3);
    step(&mut app, 5);
    let places = |app: &mut App| -> Vec<Vec3> {
        let mut people = app.world_mut().query::<(&Person, &Transform)>();
        people.iter(app.world()).map(|(_, at)| at.translation).collect()
    };
    let before = places(&mut app);
    // The new environment fails, so the previous world is kept, with everything in it.
    let mut other = Environment::new(IndoorSpec { cell_size: -1.0, ..default() }, 1);
    other.origin = DVec2::splat(1000.0);
    app.world_mut().entity_mut(root).insert(other);
    wait_until_ready(&mut app, root).unwrap_err();
    step(&mut app, 20);
    let after = places(&mut app);
    assert_eq!(before.len(), after.len());
    for (before, after) in before.into_iter().zip(after) {
        assert!(before.distance(after) < 5.0, "{before} {after}");
    }
}
