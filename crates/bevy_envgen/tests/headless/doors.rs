//! Doors open, close and slam, and push what stands in them.

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_envgen::bevy_rapier2d::prelude::*;
use bevy_envgen::envgen::Seed;
use bevy_envgen::envgen::indoor::IndoorSpec;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{spawn_ready, step, test_app, truth, wait_until_ready};

/// An app with an indoor map, and one of its open doors.
fn building() -> (App, Entity, Entity) {
    let mut app = test_app();
    let root = spawn_ready(&mut app, Environment::new(IndoorSpec::default(), 4)).unwrap();
    step(&mut app, 2);
    let mut doors = app.world_mut().query::<(Entity, &Door, &PartId)>();
    let mut open: Vec<_> =
        doors.iter(app.world()).filter(|(_, door, _)| door.openness() == 1.0).collect();
    open.sort_by_key(|(_, _, id)| **id);
    let door = open.first().expect("an open door").0;
    (app, root, door)
}

/// Whether a ray through the opening of a doorway is stopped within the wall's thickness.
fn blocked(app: &mut App, door: Entity) -> bool {
    let at = app.world().get::<Transform>(door).copied().unwrap();
    let Some(PartShape::Box { half_size }) = app.world().get::<PartShape>(door).cloned() else {
        panic!("a doorway is a box")
    };
    let across = if half_size.x < half_size.y { Vec3::X } else { Vec3::Y };
    let reach = half_size.min_element() + 0.05;
    let way = at.rotation * across;
    let from = (at.translation - way * reach).truncate();
    let cast = move |context: ReadRapierContext| {
        let filter = QueryFilter::default().exclude_sensors();
        let context = context.single().unwrap();
        context.cast_ray(from, way.truncate(), 2.0 * reach, true, filter).is_some()
    };
    app.world_mut().run_system_once(cast).unwrap()
}

#[derive(Resource, Default)]
struct Stops(Vec<(Entity, bool)>);

#[test]
fn a_door_closes_opens_and_slams_in_its_time() {
    let (mut app, _, door) = building();
    app.init_resource::<Stops>();
    app.add_observer(|stopped: On<DoorStopped>, mut stops: ResMut<Stops>| {
        stops.0.push((stopped.entity, stopped.open));
    });
    assert!(!blocked(&mut app, door));
    let act = |app: &mut App, how: fn(&mut Door)| {
        how(&mut app.world_mut().get_mut::<Door>(door).unwrap());
        let mut steps = 0;
        let target = f32::from(app.world().get::<Door>(door).unwrap().opens());
        while app.world().get::<Door>(door).unwrap().openness() != target {
            step(app, 1);
            steps += 1;
            assert!(steps < 100);
        }
        step(app, 2);
        steps
    };
    let closing = act(&mut app, Door::close);
    assert!(blocked(&mut app, door));
    let opening = act(&mut app, Door::open);
    assert!(!blocked(&mut app, door));
    let slamming = act(&mut app, Door::slam);
    assert!(blocked(&mut app, door));
    assert!((63..=65).contains(&closing) && (63..=65).contains(&opening), "{closing} {opening}");
    assert!((9..=11).contains(&slamming), "{slamming}");
    assert_eq!(app.world().resource::<Stops>().0, [(door, false), (door, true), (door, false)]);
}

#[test]
fn a_door_that_closes_pushes_what_stands_in_it() {
    let (mut app, _, door) = building();
    let at = app.world().get::<Transform>(door).copied().unwrap();
    let body = (Transform { ..at }, RigidBody::Dynamic, Collider::ball(0.04), Ccd::enabled());
    let body = app.world_mut().spawn((body, Velocity::zero())).id();
    step(&mut app, 5);
    let place = |app: &App| app.world().get::<Transform>(body).unwrap().translation;
    assert!(place(&app).distance(at.translation) < 1e-3, "it stands in the opening");
    app.world_mut().get_mut::<Door>(door).unwrap().slam();
    step(&mut app, 30);
    assert!(place(&app).distance(at.translation) > 0.2, "{:?}", place(&app));
}

#[test]
fn a_closed_door_is_solid_also_where_doors_do_not_move() {
    let mut world = IndoorSpec::default().generate_world(4);
    world.doorways.iter_mut().for_each(|door| door.open = false);
    world.certificate.clear();
    for moving in [true, false] {
        let mut app = test_app();
        let settings = ColliderSettings { doors: moving, ..default() };
        let environment = Environment::prebuilt(world.clone());
        let root = app.world_mut().spawn((environment, EnvironmentColliders(settings))).id();
        wait_until_ready(&mut app, root).unwrap();
        step(&mut app, 2);
        let mut doorways = app.world_mut().query_filtered::<Entity, With<Doorway>>();
        let doorways: Vec<_> = doorways.iter(app.world()).collect();
        assert!(doorways.len() > 5);
        for doorway in doorways {
            assert!(blocked(&mut app, doorway), "doors move: {moving}");
            assert_eq!(app.world().entity(doorway).contains::<Door>(), moving);
        }
    }
}

#[test]
fn schedules_that_cannot_be_followed_move_no_door() {
    for (field, schedule) in [
        ("mean_wait", DoorSchedule { mean_wait: f32::NAN, slam: 0.5 }),
        ("mean_wait", DoorSchedule { mean_wait: 0.1, slam: 0.5 }),
        ("mean_wait", DoorSchedule { mean_wait: f32::INFINITY, slam: 0.5 }),
        ("slam", DoorSchedule { mean_wait: 0.5, slam: f32::NAN }),
        ("slam", DoorSchedule { mean_wait: 0.5, slam: 1.1 }),
    ] {
        let error = schedule.validate().unwrap_err();
        assert_eq!(error.field, field, "{schedule:?}");
        let mut app = test_app();
        let environment = Environment::prebuilt(IndoorSpec::default().generate_world(4));
        let root = app.world_mut().spawn((environment, schedule)).id();
        wait_until_ready(&mut app, root).unwrap();
        let openness = |app: &mut App| {
            step(app, 100);
            let mut doors = app.world_mut().query::<(&PartId, &Door)>();
            let mut open: Vec<_> =
                doors.iter(app.world()).map(|(id, door)| (*id, door.openness())).collect();
            open.sort_by_key(|(id, _)| *id);
            open
        };
        let first = openness(&mut app);
        assert_eq!(openness(&mut app), first, "{schedule:?}");
        // The clock runs on: a schedule that can be followed takes over.
        app.world_mut().entity_mut(root).insert(DoorSchedule { mean_wait: 0.5, slam: 0.5 });
        assert_ne!(openness(&mut app), first);
    }
}

#[test]
fn schedules_follow_from_the_seed() {
    let run = |seed: u64, steps: usize| {
        let mut app = test_app();
        let schedule = DoorSchedule { mean_wait: 2.0, slam: 0.5 };
        let world = IndoorSpec::default().generate_world(4);
        let mut environment = Environment::prebuilt(world);
        environment.seed = seed;
        let root = app.world_mut().spawn((environment, schedule)).id();
        wait_until_ready(&mut app, root).unwrap();
        let mut history = Vec::new();
        for _ in 0..steps {
            step(&mut app, 1);
            let mut doors = app.world_mut().query::<(&PartId, &Door)>();
            let mut now: Vec<_> =
                doors.iter(app.world()).map(|(id, door)| (*id, door.openness())).collect();
            now.sort_by_key(|(id, _)| *id);
            history.push(now);
        }
        assert_eq!(truth(&app, root).doorways.len(), history[0].len());
        history
    };
    let (first, again, other) = (run(1, 400), run(1, 400), run(2, 400));
    assert_eq!(first, again);
    assert_ne!(first, other);
    // Doors moved, and not all at once.
    let moved =
        |step: usize| first[step].iter().zip(&first[step - 1]).filter(|(a, b)| a.1 != b.1).count();
    let most = (1..400).map(moved).max().unwrap();
    assert!(most > 0 && most < first[0].len(), "{most} of {}", first[0].len());
}

trait GenerateWorld {
    fn generate_world(self, seed: u64) -> bevy_envgen::envgen::World;
}

impl GenerateWorld for IndoorSpec {
    fn generate_world(self, seed: u64) -> bevy_envgen::envgen::World {
        use bevy_envgen::envgen::{Blueprint, Spec};
        self.generate(Seed(seed)).unwrap().to_world()
    }
}
