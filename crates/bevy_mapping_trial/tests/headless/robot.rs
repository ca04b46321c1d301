//! Robots in rapier.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{in_rapier, spawn_ready, step, test_app_with};
use bevy_mapping_trial::prelude::*;
use bevy_mapping_trial::robot::{RobotCondition, Wheels};
use bevy_rapier2d::prelude::{
    Collider, ColliderMassProperties, Friction, RapierRigidBodySet, RigidBody, Sensor, Sleeping,
    Velocity,
};
use envgen::geometry::{Rect, Shape};
use envgen::glam::DVec2;
use envgen::world::{Surface as Ground, SurfaceKind, Wall as Side, WallKind};
use envgen::{Provenance, World as EnvWorld};
use mapping_trial::lidar::LaserProfile;
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::robot::{Footprint, Robot};

/// Returns a world with a room whose walls have no thickness.
fn room(width: f64, height: f64) -> EnvWorld {
    let bounds = Rect::new(DVec2::ZERO, DVec2::new(width, height));
    let mut world = EnvWorld::new(Provenance::other("test", serde_json::Value::Null), bounds);
    let corners = Shape::from_rect(bounds).corners();
    world.walls = envgen::geometry::edges(&corners)
        .map(|(a, b)| Side::new(WallKind::Wall, Shape::Segment { a, b }))
        .collect();
    world
}

/// Creates an app with a world and robots, which runs 64 steps per second.
fn app(world: EnvWorld) -> App {
    let mut app = test_app_with((EnvgenPlugins::default(), RobotPlugin::default()));
    spawn_ready(&mut app, Environment::prebuilt(Arc::new(world))).unwrap();
    app
}

fn robot(app: &mut App, x: f32, y: f32) -> Entity {
    let sensors = (
        LaserScanner::new(LaserProfile { ticks_a_scan: 1, ..LaserProfile::USARSIM }, 1, 0),
        WheelOdometry::new(OdometryProfile::EXACT, 1, 0),
    );
    let robot = app.world_mut().spawn((RobotModel::default(), Transform::from_xyz(x, y, 0.0)));
    let robot = { robot }.insert(sensors).id();
    step(app, 2);
    robot
}

/// Drives a robot for a number of seconds, and returns the distance and the turn that its wheels measured.
fn drive(app: &mut App, robot: Entity, speed: f64, turn_rate: f64, seconds: f64) -> (f64, f64) {
    *app.world_mut().get_mut::<DriveCommand>(robot).unwrap() = DriveCommand { speed, turn_rate };
    let mut total = (0.0, 0.0);
    for _ in 0..(seconds * 64.0) as usize {
        app.update();
        let measured = app.world().get::<WheelOdometry>(robot).unwrap().last();
        total = (total.0 + measured.distance, total.1 + measured.turn);
    }
    total
}

fn position(app: &App, robot: Entity) -> DVec2 {
    app.world().get::<TruePose>(robot).unwrap().position
}

fn ahead(app: &App, robot: Entity) -> f64 {
    app.world().get::<LaserScan>(robot).unwrap().ranges[90]
}

#[test]
fn a_robot_drives_as_its_wheels_say() {
    let mut app = app(room(20.0, 20.0));
    let robot = robot(&mut app, 5.0, 10.0);
    let (distance, turn) = drive(&mut app, robot, 0.5, 0.0, 10.0);
    // The robot takes a second to reach 0.5 m/s at 0.5 m/s^2.
    assert!((distance - 4.75).abs() < 0.03 && turn.abs() < 1e-4, "{distance} {turn}");
    assert!((position(&app, robot).x - 5.0 - distance).abs() < 1e-4);
    let (_, turned) = drive(&mut app, robot, 0.0, 9.0, 5.0);
    assert!(turned < 1.4 * 5.0 && turned > 1.4 * 4.0, "{turned}");
    assert_eq!(app.world().get::<Bumper>(robot).unwrap().collisions, 0);
}

#[test]
fn a_wall_stops_and_is_one_collision() {
    let mut app = app(room(10.0, 10.0));
    let robot = robot(&mut app, 5.0, 5.0);
    drive(&mut app, robot, 0.7, 0.0, 20.0);
    let x = position(&app, robot).x;
    assert!((x - (10.0 - 0.254)).abs() < 0.01, "{x}");
    let bumper = *app.world().get::<Bumper>(robot).unwrap();
    assert!(bumper.touching && bumper.collisions == 1, "{bumper:?}");
    let (stalled, _) = drive(&mut app, robot, 0.7, 0.0, 1.0);
    assert!(stalled.abs() < 0.01, "stalled wheels measure {stalled}");
    drive(&mut app, robot, -0.5, 0.0, 3.0);
    assert!(!app.world().get::<Bumper>(robot).unwrap().touching);
    drive(&mut app, robot, 0.5, 0.0, 5.0);
    assert_eq!(app.world().get::<Bumper>(robot).unwrap().collisions, 2);
}

#[test]
fn what_stops_a_robot_in_a_trial_is_one_collision() {
    // Steps of trials have several substeps, and in the last one a robot that was stopped may rest.
    let wall = Collider::segment(Vec2::new(0.0, -2.0), Vec2::new(0.0, 2.0));
    for (collider, body) in [
        (Collider::ball(0.25), Some(RigidBody::KinematicPositionBased)),
        (Collider::ball(0.25), Some(RigidBody::Fixed)),
        (Collider::ball(0.25), None),
        (wall, None),
    ] {
        for (speed, turn_rate) in [(0.5, 0.0), (0.7, 0.0), (0.5, 0.05)] {
            let mut app = App::new();
            let physics = TopDownPhysicsPlugin::for_trials();
            app.add_plugins((MinimalPlugins, TransformPlugin, physics, RobotPlugin::default()));
            let tick = std::time::Duration::from_millis(50);
            app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(tick));
            app.finish();
            app.cleanup();
            let at = Transform::from_xyz(2.0, 0.0, 0.0);
            let mut solid = app.world_mut().spawn((at, collider.clone()));
            if let Some(body) = body {
                solid.insert(body);
            }
            let command = DriveCommand { speed, turn_rate };
            let robot = app.world_mut().spawn((RobotModel::default(), command)).id();
            step(&mut app, 20);
            assert_eq!(app.world().get::<Bumper>(robot).unwrap().collisions, 0);
            step(&mut app, 80);
            let bumper = app.world().get::<Bumper>(robot).unwrap();
            assert_eq!(
                (bumper.collisions, bumper.person_collisions),
                (1, 0),
                "{speed} {turn_rate} {body:?}"
            );
        }
    }
}

#[test]
fn no_wall_is_driven_through() {
    let mut app = app(room(3.0, 3.0));
    let robot = robot(&mut app, 1.5, 1.5);
    for turn_rate in [0.0, 0.3, -0.7, 1.4, -1.4, 0.1] {
        for speed in [9.0, -9.0] {
            drive(&mut app, robot, speed, turn_rate, 6.0);
            let at = position(&app, robot);
            assert!(at.min_element() > 0.23 && at.max_element() < 2.77, "{at}");
        }
    }
}

#[test]
fn a_laser_sees_what_is_there_and_no_sensor() {
    let mut app = app(room(10.0, 10.0));
    let robot = robot(&mut app, 3.0, 5.0);
    // A scan is taken in each tick, which is three or four steps.
    let free = 10.0 - 3.0 - 0.21;
    assert!((ahead(&app, robot) - free).abs() < 0.011, "{}", ahead(&app, robot));
    let at = Transform::from_xyz(5.0, 5.0, 0.0);
    let ghost = app.world_mut().spawn((at, Collider::ball(0.5), Sensor)).id();
    step(&mut app, 5);
    assert!((ahead(&app, robot) - free).abs() < 0.011);
    app.world_mut().despawn(ghost);
    let person = app.world_mut().spawn((at, Collider::ball(0.5), RigidBody::Fixed)).id();
    step(&mut app, 5);
    assert!((ahead(&app, robot) - (2.0 - 0.21 - 0.5)).abs() < 0.011, "{}", ahead(&app, robot));
    app.world_mut().despawn(person);
    let other = app.world_mut().spawn((RobotModel::default(), at)).id();
    step(&mut app, 5);
    assert!((ahead(&app, robot) - (2.0 - 0.21 - 0.254)).abs() < 0.011);
    let before = in_rapier(&mut app);
    app.world_mut().despawn(other);
    step(&mut app, 5);
    assert_eq!(in_rapier(&mut app), (before.0 - 1, before.1 - 1));
    assert!((ahead(&app, robot) - free).abs() < 0.011);
}

#[test]
fn dark_walls_are_seen_only_from_near() {
    let mut world = room(20.0, 10.0);
    for wall in &mut world.walls {
        wall.visible_range = Some(3.0);
    }
    let mut app = app(world);
    let (near, far) = (robot(&mut app, 17.5, 3.0), robot(&mut app, 10.0, 7.0));
    let seen = ahead(&app, near);
    assert!((2.0..2.6).contains(&seen), "{seen}");
    assert!(ahead(&app, far).is_nan(), "a wall that is too dark is no free space");
}

#[test]
fn dark_walls_are_seen_from_as_near_as_the_environment_is_small() {
    let mut world = room(20.0, 10.0);
    world.walls.iter_mut().for_each(|wall| wall.visible_range = Some(3.0));
    // A screen that is visible from everywhere, in front of the dark wall.
    let screen = Shape::Segment { a: DVec2::new(19.0, 0.0), b: DVec2::new(19.0, 3.0) };
    world.walls.push(Side::new(WallKind::Wall, screen));
    for scale in [0.25, 2.0] {
        let mut app = app(world.clone());
        let root = app.world_mut().query_filtered::<Entity, With<Environment>>();
        let root = { root }.single(app.world()).unwrap();
        let scaled = Transform::from_scale(Vec3::new(scale, scale, 1.0));
        app.world_mut().entity_mut(root).insert(scaled);
        let mut seen = |x: f32, y: f32| {
            let robot = robot(&mut app, scale * x, scale * y);
            ahead(&app, robot)
        };
        let scale = f64::from(scale);
        let (near, far, before_screen) = (seen(17.5, 5.0), seen(12.0, 7.0), seen(14.0, 1.5));
        assert!(near < 2.6 * scale, "{scale}: {near}");
        assert!(far.is_nan(), "{scale}: {far}");
        assert!(before_screen < 5.1 * scale, "{scale}: {before_screen}");
    }
}

#[test]
fn wheels_measure_too_far_on_loose_ground() {
    let mut world = room(20.0, 10.0);
    let loose = Ground::new(SurfaceKind::Loose, Shape::from_rect(world.bounds));
    world.surfaces.push(Ground { wheel_bias: 0.2, ..loose });
    let mut app = app(world);
    let robot = robot(&mut app, 5.0, 5.0);
    let from = position(&app, robot);
    let (reported, _) = drive(&mut app, robot, 0.5, 0.0, 6.0);
    let driven = position(&app, robot).x - from.x;
    assert!((reported / driven - 1.2).abs() < 1e-3, "{reported} m for {driven} m");
}

#[test]
fn water_drowns_and_deep_ground_stops() {
    let mut world = room(20.0, 10.0);
    let mut surface = |x: f64, speed: f64, kind| {
        let rect = Rect::new(DVec2::new(x, 0.0), DVec2::new(x + 1.0, 10.0));
        let shape = Shape::from_rect(rect);
        world.surfaces.push(Ground { speed, ..Ground::new(kind, shape) });
    };
    surface(14.0, 0.0, SurfaceKind::Class(1));
    surface(2.0, 0.0, SurfaceKind::Water);
    let mut app = app(world);
    let robot = robot(&mut app, 8.0, 5.0);
    drive(&mut app, robot, 0.5, 0.0, 30.0);
    assert_eq!(app.world().get(robot), Some(&RobotCondition::Operational));
    assert!((13.9..=14.0).contains(&position(&app, robot).x), "{}", position(&app, robot));
    drive(&mut app, robot, -0.5, 0.0, 40.0);
    assert_eq!(app.world().get(robot), Some(&RobotCondition::Drowned));
    let lost = position(&app, robot);
    drive(&mut app, robot, 0.5, 0.0, 5.0);
    assert_eq!(position(&app, robot), lost);
}

#[test]
fn numbers_that_are_not_allowed_stand_still() {
    let mut app = app(room(10.0, 10.0));
    let chassis = Chassis { track: 0.0, ..Chassis::default() };
    let sound =
        app.world_mut().spawn((RobotModel::default(), chassis, Transform::from_xyz(5.0, 5.0, 0.0)));
    let sound = { sound }.insert(WheelOdometry::new(OdometryProfile::EXACT, 1, 0)).id();
    drive(&mut app, sound, 0.5, 0.3, 2.0);
    assert!(position(&app, sound).is_finite());
    for (speed, width) in [(-1.0, 0.4), (f64::NAN, 0.4), (0.5, f64::NAN)] {
        let model = Robot { max_speed: speed, acceleration: speed, width, ..Robot::default() };
        let place = Transform::from_xyz(2.0, 2.0, 0.0);
        let robot = app.world_mut().spawn((RobotModel(model), place));
        let robot = { robot }.insert(WheelOdometry::new(OdometryProfile::EXACT, 1, 0)).id();
        drive(&mut app, robot, 0.5, 0.3, 1.0);
        assert!(app.world().get::<Collider>(robot).is_none());
        assert!(app.world().get::<RigidBody>(robot).is_none());
        assert_eq!(app.world().get::<Transform>(robot), Some(&place));
        app.world_mut().despawn(robot);
    }
}

#[test]
fn a_model_that_is_not_allowed_takes_what_the_last_one_added() {
    let mut app = app(room(10.0, 10.0));
    let robot = robot(&mut app, 5.0, 5.0);
    let own = (RobotModel::default(), RigidBody::Dynamic, HeightRange { bottom: 0.0, top: 1.0 });
    let own = app.world_mut().spawn((own, Transform::from_xyz(2.0, 2.0, 0.0))).id();
    step(&mut app, 2);
    let before = in_rapier(&mut app);
    let broken = RobotModel(Robot { width: -1.0, ..Robot::default() });
    for robot in [robot, own] {
        app.world_mut().entity_mut(robot).insert(broken.clone());
    }
    drive(&mut app, robot, 0.5, 0.0, 1.0);
    let found = app.world().entity(robot);
    assert!(!found.contains::<RigidBody>() && !found.contains::<Collider>());
    assert!(!found.contains::<HeightRange>() && !found.contains::<ScenarioAgent>());
    assert!(!found.contains::<Battery>() && !found.contains::<Velocity>());
    assert!(!found.contains::<Friction>() && !found.contains::<Sleeping>());
    let found = app.world().entity(own);
    assert!(found.contains::<RigidBody>() && found.contains::<HeightRange>());
    assert!(!found.contains::<Collider>());
    assert_eq!(in_rapier(&mut app), (before.0 - 2, before.1 - 1));
    let at = app.world().get::<Transform>(robot).unwrap().translation;
    assert!(at.distance(Vec3::new(5.0, 5.0, 0.0)) < 1e-3, "{at}");
    app.world_mut().entity_mut(robot).insert(RobotModel::default());
    app.world_mut().entity_mut(own).insert(RobotModel::default());
    let from = position(&app, robot);
    drive(&mut app, robot, 0.5, 0.0, 2.0);
    assert_eq!(in_rapier(&mut app), before);
    assert!(position(&app, robot).distance(from) > 0.7);
}

#[test]
fn what_a_child_of_the_robot_touches_is_felt() {
    let mut app = app(room(10.0, 10.0));
    let robot = robot(&mut app, 5.0, 5.0);
    let fork = (Transform::from_xyz(0.5, 0.0, 0.0), Collider::cuboid(0.3, 0.05), ChildOf(robot));
    app.world_mut().spawn(fork);
    drive(&mut app, robot, 0.7, 0.0, 15.0);
    assert!((position(&app, robot).x - 9.2).abs() < 0.02, "{}", position(&app, robot));
    assert!(app.world().get::<Bumper>(robot).unwrap().touching);
}

/// Returns a world with two rooms of 6 m beside each other, and a gap in the wall between them.
fn rooms(gap: f64) -> EnvWorld {
    let mut world = room(12.0, 6.0);
    for (from, to) in [(0.0, 3.0 - 0.5 * gap), (3.0 + 0.5 * gap, 6.0)] {
        let rect = Rect::new(DVec2::new(5.9, from), DVec2::new(6.1, to));
        world.walls.push(Side::new(WallKind::Wall, Shape::from_rect(rect)));
    }
    world
}

#[test]
fn robots_pass_gaps_of_their_own_size_and_refuse_narrower_ones() {
    for radius in [0.2, 0.8] {
        let model = Robot {
            length: 2.0 * radius,
            width: 2.0 * radius,
            circumscribed_radius: radius,
            footprint: Footprint::Disc,
            laser_offset: 0.0,
            ..Robot::default()
        };
        let end = |gap: f64| {
            let mut app = app(rooms(gap));
            let at = Transform::from_xyz(3.0, 3.0, 0.0);
            let robot = app.world_mut().spawn((RobotModel(model.clone()), at)).id();
            app.world_mut().entity_mut(robot).insert(WheelOdometry::new(
                OdometryProfile::EXACT,
                1,
                0,
            ));
            step(&mut app, 2);
            drive(&mut app, robot, 0.5, 0.0, 14.0);
            position(&app, robot).x
        };
        let (wide, narrow) = (end(2.0 * radius + 0.04), end(2.0 * radius - 0.04));
        assert!(wide > 6.1 + radius, "{radius}: stopped at {wide}");
        assert!(narrow < 6.0, "{radius}: went through to {narrow}");
    }
}

#[test]
fn weight_and_wheels_are_the_models() {
    let mut app = app(room(10.0, 10.0));
    let chassis = mapping_trial::robot::Chassis { mass: 30.0, track: 0.9, grip: 0.2 };
    let model = RobotModel(Robot { chassis, ..Robot::default() });
    let robot = app.world_mut().spawn((model.clone(), Transform::from_xyz(5.0, 5.0, 0.0))).id();
    step(&mut app, 2);
    let expected = Chassis { mass: 30.0, grip: 0.2, track: 0.9 };
    assert_eq!(app.world().get::<Chassis>(robot), Some(&expected));
    let mass = ColliderMassProperties::Mass(30.0);
    assert_eq!(app.world().get::<ColliderMassProperties>(robot), Some(&mass));
    // Another model changes these components, but not those that the app has inserted.
    app.world_mut().entity_mut(robot).insert(RobotModel::default());
    step(&mut app, 1);
    assert_eq!(app.world().get::<Chassis>(robot), Some(&Chassis::default()));
    let own = Chassis { mass: 5.0, ..Chassis::default() };
    let robot = app.world_mut().spawn((model, own, Transform::from_xyz(2.0, 2.0, 0.0))).id();
    step(&mut app, 1);
    assert_eq!(app.world().get::<Chassis>(robot), Some(&own));
}

/// Returns the mass of a body in rapier, in kg.
fn mass(app: &mut App, robot: Entity) -> f32 {
    let mut sets = app.world_mut().query::<&RapierRigidBodySet>();
    let bodies = sets.single(app.world()).unwrap();
    bodies.bodies[bodies.entity2body()[&robot]].mass()
}

#[test]
fn a_chassis_that_is_changed_or_put_on_later_weighs_what_it_says() {
    let mut app = app(room(10.0, 10.0));
    let light = Chassis { mass: 5.0, ..Chassis::default() };
    let robot = robot(&mut app, 5.0, 5.0);
    let at = Transform::from_xyz(2.0, 2.0, 0.0);
    // A collider almost without mass.
    let collider = (Collider::ball(0.3), ColliderMassProperties::Density(0.001));
    let own = app.world_mut().spawn((RobotModel::default(), collider, at)).id();
    step(&mut app, 2);
    for robot in [robot, own] {
        let found = mass(&mut app, robot);
        assert!((found - Chassis::default().mass).abs() < 0.01, "{found} kg");
        for chassis in [light, Chassis { mass: 50.0, ..light }] {
            app.world_mut().entity_mut(robot).insert(chassis);
            step(&mut app, 2);
            let found = mass(&mut app, robot);
            assert!((found - chassis.mass).abs() < 0.01, "{found} kg");
            // Another model keeps the chassis.
            app.world_mut().entity_mut(robot).insert(RobotModel::default());
            step(&mut app, 2);
            assert_eq!(app.world().get::<Chassis>(robot), Some(&chassis));
            assert!((mass(&mut app, robot) - chassis.mass).abs() < 0.01);
        }
    }
}

#[test]
fn robots_with_little_grip_take_longer_to_start() {
    let driven = |grip: f64| {
        let mut app = app(room(20.0, 10.0));
        let chassis = mapping_trial::robot::Chassis { grip, ..Default::default() };
        let model = Robot { chassis, acceleration: 5.0, ..Robot::default() };
        let at = Transform::from_xyz(5.0, 5.0, 0.0);
        let robot = app.world_mut().spawn((RobotModel(model), at)).id();
        app.world_mut().entity_mut(robot).insert(WheelOdometry::new(OdometryProfile::EXACT, 1, 0));
        step(&mut app, 2);
        drive(&mut app, robot, 0.7, 0.0, 1.0);
        position(&app, robot).x - 5.0
    };
    let (ice, ground) = (driven(0.05), driven(0.6));
    // At 0.05 g, a second of pushing moves the robot by a quarter of a metre.
    assert!((ice - 0.245).abs() < 0.03 && ground > 0.6, "{ice} and {ground} m");
}

#[test]
fn a_robot_that_is_put_elsewhere_turns_no_wheels() {
    let mut app = app(room(40.0, 10.0));
    let robot = robot(&mut app, 5.0, 5.0);
    drive(&mut app, robot, 0.5, 0.0, 2.0);
    let before = position(&app, robot);
    app.world_mut().get_mut::<Transform>(robot).unwrap().translation.x += 20.0;
    let (measured, turn) = drive(&mut app, robot, 0.5, 0.0, 2.0);
    let driven = position(&app, robot).x - before.x - 20.0;
    assert!((0.5..1.5).contains(&driven), "{driven}");
    assert!((measured - driven).abs() < 1e-3 && turn.abs() < 1e-3, "{measured} for {driven}");
    // The same is true if the parent of the robot is moved.
    let parent = app.world_mut().spawn(Transform::default()).id();
    app.world_mut().entity_mut(robot).insert(ChildOf(parent));
    drive(&mut app, robot, 0.0, 0.0, 2.0);
    app.world_mut().get_mut::<Transform>(parent).unwrap().translation.x -= 10.0;
    let (measured, turn) = drive(&mut app, robot, 0.0, 0.0, 1.0);
    assert!(measured.abs() < 1e-3 && turn.abs() < 1e-3, "{measured} {turn}");
}

#[test]
fn a_robot_that_is_taken_out_of_the_water_drives_again() {
    let mut world = room(20.0, 10.0);
    let shape = Shape::from_rect(Rect::new(DVec2::new(2.0, 0.0), DVec2::new(3.0, 10.0)));
    world.surfaces.push(Ground::new(SurfaceKind::Water, shape));
    let mut app = app(world);
    let robot = robot(&mut app, 5.0, 5.0);
    drive(&mut app, robot, -0.5, 0.0, 10.0);
    assert_eq!(app.world().get(robot), Some(&RobotCondition::Drowned));
    app.world_mut().get_mut::<Transform>(robot).unwrap().translation.x = 10.0;
    *app.world_mut().get_mut::<RobotCondition>(robot).unwrap() = RobotCondition::Operational;
    drive(&mut app, robot, 0.5, 0.0, 4.0);
    let x = position(&app, robot).x;
    assert!(x > 11.0, "it is at {x}");
}

#[test]
fn a_laser_has_the_rate_of_its_profile_whatever_the_steps() {
    let mut app = app(room(10.0, 10.0));
    let laser = LaserScanner::new(LaserProfile::USARSIM, 1, 0);
    let place = Transform::from_xyz(5.0, 5.0, 0.0);
    let robot = app.world_mut().spawn((RobotModel::default(), place, laser)).id();
    // 64 steps per second, a scan in 0.2 s.
    step(&mut app, 641);
    let number = app.world().get::<LaserScan>(robot).unwrap().number;
    assert!((49..=51).contains(&number), "{number} scans in 10 s");
}

#[test]
fn an_observer_may_despawn_a_robot_as_it_is_spawned() {
    let mut app = app(room(10.0, 10.0));
    app.add_observer(|added: On<Add, RobotModel>, mut commands: Commands| {
        commands.entity(added.entity).despawn();
    });
    let invalid = Robot { length: -1.0, ..Robot::default() };
    for model in [Robot::default(), invalid] {
        app.world_mut().spawn(RobotModel(model));
        step(&mut app, 3);
        let mut robots = app.world_mut().query::<&RobotModel>();
        assert_eq!(robots.iter(app.world()).count(), 0);
    }
}

#[test]
fn robots_may_be_spawned_before_the_plugin_is_added() {
    let mut app = App::new();
    let odometry = WheelOdometry::new(OdometryProfile::EXACT, 1, 0);
    let robot = app.world_mut().spawn((RobotModel::default(), odometry)).id();
    app.add_plugins((MinimalPlugins, TransformPlugin, TopDownPhysicsPlugin::default()));
    app.add_plugins(RobotPlugin::default());
    let frame = std::time::Duration::from_secs_f64(1.0 / 64.0);
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(frame));
    app.finish();
    app.cleanup();
    drive(&mut app, robot, 0.5, 0.0, 2.0);
    assert!(position(&app, robot).x > 0.7, "{}", position(&app, robot));
}

#[test]
fn a_robot_whose_model_is_removed_keeps_only_what_is_its_own() {
    let mut app = app(room(10.0, 10.0));
    let robot = robot(&mut app, 5.0, 5.0);
    drive(&mut app, robot, 0.5, 0.0, 1.0);
    app.world_mut().entity_mut(robot).remove::<RobotModel>();
    let own = (RobotModel::default(), Battery { left: 9.0 }, Chassis::default());
    let own = app.world_mut().spawn((own, Transform::from_xyz(2.0, 2.0, 0.0))).id();
    step(&mut app, 2);
    app.world_mut().entity_mut(own).remove::<RobotModel>();
    step(&mut app, 2);
    let of_rapier = |entity: EntityRef<'_>| {
        entity.contains::<RigidBody>()
            || entity.contains::<Collider>()
            || entity.contains::<Friction>()
    };
    for robot in [robot, own] {
        assert!(!of_rapier(app.world().entity(robot)));
        assert!(!app.world().entity(robot).contains::<ScenarioAgent>());
    }
    assert!(!app.world().entity(robot).contains::<Battery>());
    assert!(!app.world().entity(robot).contains::<Chassis>());
    assert!(app.world().entity(own).contains::<Battery>());
    assert!(app.world().entity(own).contains::<Chassis>());
    let place = |app: &App| *app.world().get::<Transform>(robot).unwrap();
    let before = place(&app);
    step(&mut app, 64);
    assert_eq!(place(&app), before);
}

#[test]
fn a_body_of_ones_own_stops_when_the_model_is_removed() {
    let mut app = app(room(10.0, 10.0));
    let own = (RigidBody::Dynamic, Collider::ball(0.3), Transform::from_xyz(5.0, 5.0, 0.0));
    let odometry = WheelOdometry::new(OdometryProfile::EXACT, 1, 0);
    let robot = app.world_mut().spawn((own, RobotModel::default(), odometry)).id();
    drive(&mut app, robot, 0.5, 0.0, 1.0);
    let place = |app: &App| app.world().get::<Transform>(robot).unwrap().translation;
    assert!(place(&app).x > 5.2, "{}", place(&app));
    app.world_mut().entity_mut(robot).remove::<RobotModel>();
    step(&mut app, 2);
    let before = place(&app);
    step(&mut app, 64);
    assert!(app.world().entity(robot).contains::<RigidBody>());
    assert!(place(&app).distance(before) < 1e-3, "{before} to {}", place(&app));
}

#[test]
fn a_robot_whose_chassis_is_not_allowed_does_not_move_until_it_is_corrected() {
    let normal = Chassis::default();
    for chassis in [
        Chassis { mass: f32::NAN, ..normal },
        Chassis { mass: 0.0, ..normal },
        Chassis { mass: -1.0, ..normal },
        Chassis { mass: f32::INFINITY, ..normal },
        Chassis { grip: f32::NAN, ..normal },
        Chassis { grip: -1.0, ..normal },
        Chassis { track: f64::NAN, ..normal },
        Chassis { track: -1.0, ..normal },
        Chassis { track: f64::INFINITY, ..normal },
    ] {
        let mut app = app(room(10.0, 10.0));
        let robot = robot(&mut app, 5.0, 5.0);
        app.world_mut().entity_mut(robot).insert(chassis);
        drive(&mut app, robot, 0.5, 0.3, 1.0);
        assert!(position(&app, robot).distance(DVec2::new(5.0, 5.0)) < 1e-3, "{chassis:?}");
        let wheels = app.world().get::<Wheels>(robot).unwrap();
        assert_eq!((wheels.left, wheels.right), (0.0, 0.0), "{chassis:?}");
        app.world_mut().entity_mut(robot).insert(normal);
        drive(&mut app, robot, 0.5, 0.0, 2.0);
        assert!((position(&app, robot).x - 5.75).abs() < 0.1, "{}", position(&app, robot));
    }
    // One that the robot has from the beginning.
    let mut app = app(room(10.0, 10.0));
    let broken = Chassis { mass: f32::NAN, ..normal };
    let odometry = WheelOdometry::new(OdometryProfile::EXACT, 1, 0);
    let place = Transform::from_xyz(5.0, 5.0, 0.0);
    let robot = app.world_mut().spawn((RobotModel::default(), broken, odometry, place)).id();
    drive(&mut app, robot, 0.5, 0.0, 1.0);
    assert!(position(&app, robot).distance(DVec2::new(5.0, 5.0)) < 1e-3);
    app.world_mut().entity_mut(robot).insert(normal);
    drive(&mut app, robot, 0.5, 0.0, 2.0);
    assert!((position(&app, robot).x - 5.75).abs() < 0.1, "{}", position(&app, robot));
}
