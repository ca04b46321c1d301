//! Doors of scenarios follow commands, stop at agents and push other bodies.

use std::time::Duration;

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_envgen::bevy_rapier2d::prelude::*;
use bevy_envgen::envgen::indoor::IndoorSpec;
use bevy_envgen::prelude::*;
use bevy_envgen::scenario::DoorKinds;
use bevy_envgen::testing::{step, test_app, truth, wait_until_ready};

use super::GenerateWorld;

/// Requests doors in all open doorways, which move only on command.
fn commanded(door_kind: DoorKinds) -> EnvironmentScenario {
    let door_control = DoorControl::Commanded;
    let spec = ScenarioSpec { doors: 1.0, door_kind, door_control, ..default() };
    EnvironmentScenario::new(spec, 1)
}

/// Creates an app with an indoor map, and returns one of its doors.
fn building(kind: DoorKinds) -> (App, Entity, Entity) {
    let mut app = test_app();
    let environment = Environment::new(IndoorSpec::default(), 4);
    let root = app.world_mut().spawn((environment, commanded(kind))).id();
    wait_until_ready(&mut app, root).unwrap();
    step(&mut app, 2);
    let door = app.world().get::<ScenarioRun>(root).unwrap().doors().next().expect("a door");
    (app, root, door)
}

/// Returns the centre of a doorway, a unit vector through it, and half the thickness of its wall.
fn passage(app: &App, root: Entity, doorway: u32) -> (Vec2, Vec2, f32) {
    let bounds = truth(app, root).doorways[doorway as usize].shape.bounds();
    let half = 0.5 * bounds.size().as_vec2();
    let across = if half.x < half.y { Vec2::X } else { Vec2::Y };
    (bounds.center().as_vec2(), across, half.min_element())
}

/// Returns whether a ray of rapier through a doorway is stopped within the thickness of the wall.
fn is_blocked(app: &mut App, root: Entity, doorway: u32) -> bool {
    let (middle, across, half) = passage(app, root, doorway);
    let reach = half + 0.05;
    let cast = move |context: ReadRapierContext| {
        let filter = QueryFilter::default().exclude_sensors();
        let context = context.single().unwrap();
        // Beside the centre, where two leaves meet.
        let from = middle - across * reach + 0.1 * across.perp();
        context.cast_ray(from, across, 2.0 * reach, true, filter).is_some()
    };
    app.world_mut().run_system_once(cast).unwrap()
}

#[derive(Resource, Default)]
struct Heard(Vec<(Entity, DoorChange)>);

#[test]
fn a_door_closes_opens_and_slams_in_its_time() {
    for kind in [DoorKinds::Sliding, DoorKinds::Hinged, DoorKinds::Double] {
        let (mut app, root, door) = building(kind);
        app.init_resource::<Heard>();
        app.add_observer(|changed: On<DoorChanged>, mut heard: ResMut<Heard>| {
            heard.0.push((changed.entity, changed.change));
        });
        let doorway = app.world().get::<Door>(door).unwrap().doorway();
        assert!(!is_blocked(&mut app, root, doorway));
        let mut act = |how: fn(&mut Door), end: f64| {
            how(&mut app.world_mut().get_mut::<Door>(door).unwrap());
            let mut steps = 0;
            while app.world().get::<Door>(door).unwrap().openness() != end {
                step(&mut app, 1);
                steps += 1;
                assert!(steps < 100, "{kind:?}");
            }
            // Rapier moves the leaves in its next step.
            step(&mut app, 2);
            assert_eq!(is_blocked(&mut app, root, doorway), end == 0.0, "{kind:?}");
            steps
        };
        let (closing, opening) = (act(Door::close, 0.0), act(Door::open, 1.0));
        let slamming = act(Door::slam, 0.0);
        assert!((60..=68).contains(&closing) && (60..=68).contains(&opening));
        assert!((6..=13).contains(&slamming), "{slamming}");
        let changes = [DoorChange::Closed, DoorChange::Opened, DoorChange::Closed];
        let heard: Vec<_> = app.world().resource::<Heard>().0.clone();
        assert_eq!(heard, changes.map(|change| (door, change)));
    }
}

#[test]
fn a_leaf_stops_at_an_agent_and_pushes_other_bodies() {
    for kind in [DoorKinds::Sliding, DoorKinds::Hinged, DoorKinds::Double] {
        let (mut app, root, door) = building(kind);
        app.init_resource::<Heard>();
        app.add_observer(|changed: On<DoorChanged>, mut heard: ResMut<Heard>| {
            heard.0.push((changed.entity, changed.change));
        });
        let doorway = app.world().get::<Door>(door).unwrap().doorway();
        let (middle, ..) = passage(&app, root, doorway);
        let at = Transform::from_translation(middle.extend(0.0));
        let agent = app.world_mut().spawn((at, ScenarioAgent::new(0.2))).id();
        step(&mut app, 5);
        for how in [Door::close, Door::slam] {
            how(&mut app.world_mut().get_mut::<Door>(door).unwrap());
            step(&mut app, 160);
            assert_eq!(app.world().get::<Door>(door).unwrap().openness(), 1.0);
        }
        assert_eq!(app.world().get::<Door>(door).unwrap().stopped(), 2);
        let changes: Vec<_> = app.world().resource::<Heard>().0.iter().map(|c| c.1).collect();
        let blocked = changes.iter().filter(|change| **change == DoorChange::Blocked).count();
        assert!(blocked == 2 && !changes.contains(&DoorChange::Closed), "{changes:?}");
        app.world_mut().despawn(agent);
        if kind == DoorKinds::Sliding {
            continue;
        }
        // A ball in front of a turning leaf.
        let leaf = app.world().get::<Children>(door).unwrap()[0];
        let tip = *app.world().get::<GlobalTransform>(leaf).unwrap();
        let at = tip.transform_point(Vec3::X * 0.4);
        let aside = (middle.extend(0.0) - at).normalize() * 0.1;
        let ball = (RigidBody::Dynamic, Collider::ball(0.06), Velocity::zero());
        let place = Transform::from_translation(at + aside);
        let ball = app.world_mut().spawn((ball, place)).id();
        step(&mut app, 5);
        app.world_mut().get_mut::<Door>(door).unwrap().close();
        step(&mut app, 100);
        assert_eq!(app.world().get::<Door>(door).unwrap().openness(), 0.0);
        let moved = app.world().get::<Transform>(ball).unwrap().translation;
        assert!(moved.distance(at + aside) > 0.1, "{kind:?}: {moved}");
    }
}

#[test]
fn a_door_that_is_blocked_and_open_again_within_a_step_reports_both() {
    let (mut app, root, door) = building(DoorKinds::Hinged);
    app.init_resource::<Heard>();
    app.add_observer(|changed: On<DoorChanged>, mut heard: ResMut<Heard>| {
        heard.0.push((changed.entity, changed.change));
    });
    let (middle, ..) = passage(&app, root, app.world().get::<Door>(door).unwrap().doorway());
    let at = Transform::from_translation(middle.extend(0.0));
    app.world_mut().spawn((at, ScenarioAgent::new(0.2)));
    let long = Duration::from_secs(4);
    app.world_mut().resource_mut::<Time<Virtual>>().set_max_delta(long);
    app.insert_resource(Time::<Fixed>::from_duration(long));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(long));
    app.world_mut().get_mut::<Door>(door).unwrap().close();
    step(&mut app, 3);
    let heard: Vec<_> = app.world().resource::<Heard>().0.clone();
    assert_eq!(heard, [DoorChange::Blocked, DoorChange::Opened].map(|change| (door, change)));
}

#[test]
fn a_doorway_that_is_closed_in_the_world_is_solid() {
    let mut world = IndoorSpec::default().generate_world(4);
    world.doorways.iter_mut().for_each(|door| door.open = false);
    world.certificate.clear();
    let doorways = world.doorways.len() as u32;
    assert!(doorways > 5);
    let mut app = test_app();
    let root = app.world_mut().spawn(Environment::prebuilt(world)).id();
    wait_until_ready(&mut app, root).unwrap();
    step(&mut app, 2);
    for doorway in 0..doorways {
        assert!(is_blocked(&mut app, root, doorway));
    }
    // A closed doorway cannot have a door of a scenario.
    app.world_mut().entity_mut(root).insert(commanded(DoorKinds::Mixed));
    step(&mut app, 2);
    let failure = app.world().get::<ScenarioFailure>(root).unwrap().to_string();
    assert!(failure.contains("the world has no open doorway"), "{failure}");
}

#[test]
fn a_sliding_leaf_that_is_in_the_wall_comes_out_of_it() {
    let (mut app, _, door) = building(DoorKinds::Sliding);
    let leaf = app.world().get::<Children>(door).unwrap()[0];
    let hinge = |app: &App| app.world().get::<GlobalTransform>(leaf).unwrap().translation();
    step(&mut app, 100);
    assert_eq!(app.world().get::<DoorLeaf>(leaf).unwrap().length, 0.0);
    let open = hinge(&app);
    app.world_mut().get_mut::<Door>(door).unwrap().close();
    for _ in 0..80 {
        step(&mut app, 1);
        let moved = hinge(&app).distance(open);
        assert!(moved < 1e-4, "it jumps by {moved} m");
    }
    assert!(app.world().get::<DoorLeaf>(leaf).unwrap().length > 0.5);
}
