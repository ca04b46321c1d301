//! What lasers at a height detect in rapier, and what stops robots of a height.

use bevy::prelude::*;
use bevy_envgen::HeightRange;
use bevy_envgen::bevy_rapier2d::prelude::{Collider, Friction, RigidBody};
use bevy_envgen::physics::{ColliderMerging, ColliderSettings, EnvironmentColliders};
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{in_rapier, spawn_ready, step, test_app_with};
use bevy_mapping_trial::prelude::*;
use envgen::geometry::{Pose, Rect, Shape};
use envgen::glam::DVec2;
use envgen::world::{Doorway as Opening, Extent as Height, Obstacle as Block, Wall as Side};
use envgen::world::{ObstacleKind as BlockKind, WallKind as SideKind};
use envgen::{Provenance, Seed, World as EnvWorld};
use mapping_trial::lidar::LaserProfile;
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::robot::Robot;
use mapping_trial::trial::TrialSettings;

/// Returns a world with a corridor of 10 x 2 m along x.
fn corridor() -> EnvWorld {
    let bounds = Rect::new(DVec2::ZERO, DVec2::new(10.0, 2.0));
    let mut world = EnvWorld::new(Provenance::other("test", serde_json::Value::Null), bounds);
    let corners = Shape::from_rect(bounds).corners();
    world.walls = envgen::geometry::edges(&corners)
        .map(|(a, b)| Side::new(SideKind::Wall, Shape::Segment { a, b }))
        .collect();
    world.start = Some(Pose::new(1.0, 1.0, 0.0));
    world
}

fn slab(y0: f64, y1: f64) -> Shape {
    Shape::from_rect(Rect::new(DVec2::new(5.0, y0), DVec2::new(6.0, y1)))
}

/// Returns the corridor with a block 4 to 5 m ahead of the start, across its whole width.
fn with_block(bottom: f64, top: f64) -> EnvWorld {
    let mut world = corridor();
    let height = Some(Height::new(bottom, top).unwrap());
    world.obstacles.push(Block { height, ..Block::new(BlockKind::Other, slab(0.0, 2.0)) });
    world
}

fn robot(height: f64, laser: f64) -> Robot {
    let mut robot = Robot { height, ..Robot::default() };
    robot.laser_mount.height = laser;
    robot
}

/// Returns the range straight ahead in metres, and how far a robot drives ahead in 16 s.
fn ahead(world: &EnvWorld, model: &Robot, colliders: ColliderSettings) -> (f64, f64) {
    let mut app = test_app_with((EnvgenPlugins::default(), RobotPlugin::default()));
    let environment = spawn_ready(&mut app, Environment::prebuilt(world.clone())).unwrap();
    app.world_mut().entity_mut(environment).insert(EnvironmentColliders(colliders));
    let sensors = (
        LaserScanner::new(LaserProfile { ticks_a_scan: 1, ..LaserProfile::USARSIM }, 1, 0),
        WheelOdometry::new(OdometryProfile::EXACT, 1, 0),
    );
    let at = Transform::from_xyz(1.0, 1.0, 0.0);
    let robot = app.world_mut().spawn((RobotModel(model.clone()), at, sensors)).id();
    step(&mut app, 2);
    let range = app.world().get::<LaserScan>(robot).unwrap().ranges[90] + model.laser_offset;
    // Scans take most of the time of a step.
    app.world_mut().entity_mut(robot).remove::<LaserScanner>();
    app.world_mut().get_mut::<DriveCommand>(robot).unwrap().speed = 1.0;
    step(&mut app, 16 * 64);
    (range, app.world().get::<TruePose>(robot).unwrap().position.x - 1.0)
}

fn all_settings() -> [ColliderSettings; 2] {
    [ColliderMerging::Always, ColliderMerging::Never]
        .map(|merge| ColliderSettings { merge, ..Default::default() })
}

#[test]
fn what_is_lower_than_the_laser_is_not_seen_but_stops_the_robot() {
    let pioneer = Robot::default();
    let near = |a: f64, b: f64| (a - b).abs() < 0.1;
    let stop = |wall: f64| wall - 1.0 - 0.5 * pioneer.length;
    for colliders in all_settings() {
        for (bottom, top, seen, stopped) in [
            (0.0, 1.0, 5.0, 5.0),
            // A block below the laser at 0.45 m, and one that the plane of the laser just touches, which is
            // detected.
            (0.0, 0.3, 10.0, 5.0),
            (0.0, 0.45, 5.0, 5.0),
            // Above the laser, but below the top of the robot at 0.5 m.
            (0.47, 1.0, 10.0, 5.0),
            // Above the robot.
            (0.5, 1.0, 10.0, 10.0),
            (2.1, 2.6, 10.0, 10.0),
        ] {
            let (range, driven) = ahead(&with_block(bottom, top), &pioneer, colliders);
            assert!(near(range, seen - 1.0), "{bottom} to {top}: seen at {range}");
            assert!(near(driven, stop(stopped)), "{bottom} to {top}: stopped after {driven}");
        }
    }
}

#[test]
fn a_lower_robot_passes_below_and_a_lower_laser_sees() {
    for colliders in all_settings() {
        let (table, kerb) = (with_block(0.3, 0.75), with_block(0.0, 0.15));
        let (range, driven) = ahead(&table, &robot(0.25, 0.2), colliders);
        assert!(range > 8.0 && driven > 8.0, "{range} {driven}");
        let (range, driven) = ahead(&kerb, &robot(0.25, 0.132), colliders);
        assert!(range < 4.1 && driven < 4.0, "{range} {driven}");
    }
}

/// Returns a corridor with an open door of the usual height.
fn with_doorway() -> EnvWorld {
    let mut world = corridor();
    world.walls.extend([slab(0.0, 0.5), slab(1.5, 2.0)].map(|s| Side::new(SideKind::Wall, s)));
    world.doorways.push(Opening::new(slab(0.5, 1.5), true, [None, None]));
    world
}

#[test]
fn lintels_stop_what_is_higher_than_the_opening() {
    let world = with_doorway();
    for colliders in all_settings() {
        let lintels = ColliderSettings { lintels: true, ..colliders };
        let (_, driven) = ahead(&world, &robot(2.0, 0.45), lintels);
        assert!(driven > 8.0, "{driven}");
        let (range, driven) = ahead(&world, &robot(2.2, 0.45), lintels);
        assert!(range > 8.0 && driven < 4.0, "{range} {driven}");
        let (range, _) = ahead(&world, &robot(2.2, 2.15), lintels);
        assert!(range < 4.1, "{range}");
        // By default there are no lintels.
        let (_, driven) = ahead(&world, &robot(2.2, 0.45), colliders);
        assert!(driven > 8.0, "{driven}");
    }
}

/// Creates an app for trials, in which each update is a tick.
fn app_for_trials() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, TopDownPhysicsPlugin::for_trials()));
    let colliders = EnvgenPhysicsPlugin::default().with_colliders(ColliderSettings::for_trials());
    app.add_plugins((EnvgenPlugins::default().set(colliders), TrialPlugin::default()));
    let tick = std::time::Duration::from_millis(50);
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(tick));
    app.finish();
    app.cleanup();
    app
}

fn trial_of(body: Robot) -> MappingTrial {
    let laser = LaserProfile::USARSIM;
    MappingTrial::new(TrialSettings { seed: Seed(1), body, laser, ..Default::default() })
}

/// Returns the range ahead in the first scan of a trial.
fn first_range(world: EnvWorld, body: Robot) -> f64 {
    let mut app = app_for_trials();
    let offset = body.laser_offset;
    let trial = app.world_mut().spawn((Environment::prebuilt(world), trial_of(body))).id();
    step(&mut app, 3);
    let robot = app.world().get::<MappingTrial>(trial).unwrap().robots()[0];
    let scan = app.world().get::<LaserScan>(robot).unwrap();
    scan.ranges[scan.ranges.len() / 2] + offset
}

#[test]
fn the_colliders_of_a_trial_are_those_of_its_robot() {
    // Merged tiles treat everything from half a metre in height as one collider, unless the laser is higher.
    let desk = with_block(0.0, 0.75);
    for (world, body, expected) in [
        (desk.clone(), robot(1.0, 0.7), 4.0),
        (desk, robot(1.0, 0.8), 9.0),
        (with_doorway(), robot(2.2, 0.45), 9.0),
        (with_doorway(), robot(2.2, 2.15), 4.0),
    ] {
        let range = first_range(world, body);
        assert!((range - expected).abs() < 0.1, "{range}, not {expected}");
    }
}

#[test]
fn a_trial_keeps_the_colliders_that_it_needs_and_then_gives_them_back() {
    let own = ColliderSettings { friction: 0.2, ..ColliderSettings::for_trials() };
    for own in [None, Some(EnvironmentColliders(own))] {
        let mut app = app_for_trials();
        let desk = Environment::prebuilt(with_block(0.0, 0.75));
        let root = app.world_mut().spawn(desk.with_pace(GenerationMode::Blocking)).id();
        if let Some(own) = own {
            app.world_mut().entity_mut(root).insert(own);
        }
        step(&mut app, 3);
        let before = in_rapier(&mut app);
        let colliders = |app: &App| app.world().get::<EnvironmentColliders>(root).copied();
        app.world_mut().entity_mut(root).insert(trial_of(robot(1.0, 0.8)));
        step(&mut app, 3);
        assert_eq!(colliders(&app).map(|during| during.full_height), Some(0.8));
        let clone = app.world_mut().entity_mut(root).clone_and_spawn();
        step(&mut app, 1);
        assert_eq!(app.world().get::<EnvironmentColliders>(clone).copied(), own);
        app.world_mut().entity_mut(clone).despawn();
        app.world_mut().entity_mut(root).remove::<MappingTrial>();
        step(&mut app, 3);
        assert_eq!((colliders(&app), in_rapier(&mut app)), (own, before));
        // The app inserts other colliders during the trial.
        app.world_mut().entity_mut(root).insert(trial_of(robot(1.0, 0.8)));
        step(&mut app, 3);
        let others = ColliderSettings { friction: 0.9, ..ColliderSettings::for_trials() };
        app.world_mut().entity_mut(root).insert(EnvironmentColliders(others));
        step(&mut app, 3);
        let during = ColliderSettings { full_height: 0.8, ..others };
        assert_eq!(colliders(&app), Some(EnvironmentColliders(during)));
        app.world_mut().entity_mut(root).remove::<MappingTrial>();
        step(&mut app, 3);
        assert_eq!(colliders(&app), Some(EnvironmentColliders(others)));
        // The app removes the colliders during the trial.
        app.world_mut().entity_mut(root).insert(trial_of(robot(1.0, 0.8)));
        step(&mut app, 3);
        app.world_mut().entity_mut(root).remove::<EnvironmentColliders>();
        step(&mut app, 3);
        let during = ColliderSettings { full_height: 0.8, ..ColliderSettings::for_trials() };
        assert_eq!(colliders(&app), Some(EnvironmentColliders(during)));
        app.world_mut().entity_mut(root).remove::<MappingTrial>();
        step(&mut app, 3);
        assert_eq!(colliders(&app), None);
    }
}

#[test]
fn other_settings_replace_the_colliders_that_are_there() {
    let mut app = test_app_with(EnvgenPlugins::default());
    let environment = spawn_ready(&mut app, Environment::prebuilt(with_doorway())).unwrap();
    step(&mut app, 2);
    let [merged, single] = all_settings();
    let mut colliders = |settings: ColliderSettings| {
        app.world_mut().entity_mut(environment).insert(EnvironmentColliders(settings));
        step(&mut app, 2);
        in_rapier(&mut app).0
    };
    // The colliders are six walls and the sensor of the doorway.
    assert_eq!(colliders(single), 7);
    assert_eq!(colliders(single), 7);
    assert_eq!(colliders(merged), 2);
    assert_eq!(colliders(merged), 2);
    assert_eq!(colliders(ColliderSettings { lintels: true, ..single }), 8);
    assert_eq!(colliders(ColliderSettings { lintels: true, sensors: false, ..merged }), 2);
    assert_eq!(colliders(single), 7);
}

#[test]
fn colliders_of_an_environment_without_its_own_settings_have_those_of_the_resource() {
    for merge in [ColliderMerging::Always, ColliderMerging::Never] {
        let mut app = test_app_with(EnvgenPlugins::default());
        let world = Environment::prebuilt(with_doorway());
        let root = spawn_ready(&mut app, world).unwrap();
        app.insert_resource(ColliderSettings { merge, ..default() });
        let frictions = |app: &mut App| {
            let mut solids = app.world_mut().query_filtered::<&Friction, With<Collider>>();
            let mut found: Vec<f32> = solids.iter(app.world()).map(|one| one.coefficient).collect();
            found.dedup();
            found
        };
        let slippery = ColliderSettings { friction: 0.1, merge, ..default() };
        app.world_mut().entity_mut(root).insert(EnvironmentColliders(slippery));
        step(&mut app, 2);
        assert_eq!(frictions(&mut app), [0.1]);
        let before = in_rapier(&mut app);
        app.world_mut().entity_mut(root).remove::<EnvironmentColliders>();
        step(&mut app, 2);
        assert_eq!((frictions(&mut app), in_rapier(&mut app)), (vec![0.5], before));
        // Nothing is left of an environment that is despawned with its settings.
        app.world_mut().entity_mut(root).insert(EnvironmentColliders(slippery));
        app.world_mut().despawn(root);
        step(&mut app, 2);
        assert_eq!(in_rapier(&mut app), (0, 0));
    }
}

#[test]
fn a_body_whose_colliders_are_children_is_as_high_for_lasers_as_for_robots() {
    let mut app = test_app_with((EnvgenPlugins::default(), RobotPlugin::default()));
    spawn_ready(&mut app, Environment::prebuilt(corridor())).unwrap();
    let sensor = LaserScanner::new(LaserProfile { ticks_a_scan: 1, ..LaserProfile::USARSIM }, 1, 0);
    let at = Transform::from_xyz(1.0, 1.0, 0.0);
    let robot = app.world_mut().spawn((RobotModel(Robot::default()), at, sensor)).id();
    let ahead = |app: &App| app.world().get::<LaserScan>(robot).unwrap().ranges[90];
    step(&mut app, 4);
    let free = ahead(&app);
    // First a shelf above the laser, and then one in front of it.
    let shelf = app
        .world_mut()
        .spawn((
            RigidBody::Fixed,
            Transform::from_xyz(4.0, 1.0, 0.0),
            HeightRange { bottom: 0.7, top: 1.0 },
            children![(Collider::cuboid(0.3, 0.9), Transform::default())],
        ))
        .id();
    step(&mut app, 4);
    assert!((ahead(&app) - free).abs() < 0.1, "{} of {free}", ahead(&app));
    app.world_mut().entity_mut(shelf).insert(HeightRange { bottom: 0.0, top: 1.0 });
    step(&mut app, 4);
    assert!((ahead(&app) - 2.5).abs() < 0.3, "{}", ahead(&app));
}
