//! Compares depths and labels with rays through the bodies of worlds.

use std::sync::{Arc, Mutex};

use bevy::prelude::*;
use bevy_envgen::physics::TopDownPhysicsPlugin;
use bevy_envgen::prelude::*;
use bevy_mapping_trial::camera::{
    CameraFrame, CameraFrameTaken, CameraImages, RobotCamera, RobotCameraPlugin,
};
use bevy_mapping_trial::prelude::*;
use bevy_offscreen::Studio;
use envgen::glam::DVec3;
use envgen::mesh::BodyRaycaster;
use envgen::pieces::{Form, pieces};
use envgen::scenario::Target;
use envgen::{Seed, Stream, WorldKind};

/// The largest difference of depths in metres.
const SAME: f64 = 1e-3;

/// A resource with the frames that were taken.
#[derive(Resource, Default, Clone)]
struct Taken(Arc<Mutex<Vec<Arc<CameraFrame>>>>);

/// A world with a robot whose camera takes depth and label images in every frame.
struct Scene {
    studio: Studio,
    environment: Entity,
    robot: Entity,
    taken: Taken,
}

impl Scene {
    fn new(
        environment: Environment,
        camera: RobotCamera,
        scenario: Option<EnvironmentScenario>,
    ) -> Self {
        let mut studio = Studio::new().unwrap();
        let taken = Taken::default();
        let app = studio.app();
        app.add_plugins((
            TopDownPhysicsPlugin::for_trials(),
            EnvgenPlugins::default(),
            RobotPlugin::default(),
            RobotCameraPlugin,
        ));
        app.insert_resource(taken.clone());
        app.add_observer(|frame: On<CameraFrameTaken>, taken: Res<Taken>| {
            taken.0.lock().unwrap().push(frame.frame.clone());
        });
        let environment = environment.with_pace(GenerationMode::Blocking);
        let environment = app.world_mut().spawn(environment).id();
        if let Some(scenario) = scenario {
            app.world_mut().entity_mut(environment).insert(scenario);
        }
        studio.set_frame_time(std::time::Duration::from_millis(50));
        studio.step().unwrap();
        let images = CameraImages { color: false, depth: true, labels: true };
        let camera = RobotCamera { images, rate: 1000.0, width: 96, height: 72, ..camera };
        let robot = (RobotModel::default(), camera, ChildOf(environment));
        let robot = studio.app().world_mut().spawn(robot).id();
        Scene { studio, environment, robot, taken }
    }

    fn truth(&mut self) -> Arc<envgen::World> {
        let truth = self.studio.app().world().get::<GroundTruth>(self.environment);
        truth.expect("a world").0.clone()
    }

    /// Returns what the camera of the robot takes at a pose.
    fn look(&mut self, at: Vec2, heading: f32) -> Arc<CameraFrame> {
        let pose = Transform::from_translation(at.extend(0.0))
            .with_rotation(Quat::from_rotation_z(heading));
        // Rapier reads the global transform before Bevy updates it.
        let pose = (pose, GlobalTransform::from(pose));
        self.studio.app().world_mut().entity_mut(self.robot).insert(pose);
        self.studio.step().unwrap();
        self.taken.0.lock().unwrap().last().expect("a frame").clone()
    }
}

/// The numbers of pixels that agree.
#[derive(Debug, Default)]
struct Agreement {
    pixels: usize,
    depths: usize,
    labels: usize,
    /// The number of pixels that are not at silhouettes.
    clear: usize,
    clear_depths: usize,
    clear_labels: usize,
}

/// Compares a frame with rays through bodies with labels.
fn compare(frame: &CameraFrame, bodies: &[(u32, &Form<'_>)], agreement: &mut Agreement) {
    let forms = || bodies.iter().map(|(_, form)| *form);
    let rays = BodyRaycaster::new(forms());
    let alone: Vec<BodyRaycaster> = forms().map(|form| BodyRaycaster::new([form])).collect();
    let (depth, labels) = (frame.depth.as_ref().unwrap(), frame.labels.as_ref().unwrap());
    for row in 0..frame.optics.height {
        for column in 0..frame.optics.width {
            let pixel = (row * frame.optics.width + column) as usize;
            let ray = frame.pose.axes * frame.optics.ray(column, row);
            let from = frame.pose.position;
            let hit = rays.cast(from, ray, 1e4);
            let expected = hit.map_or(f64::INFINITY, |hit| hit.distance);
            let found = f64::from(depth[pixel]);
            let is_same = |a: f64, b: f64| a == b || (a - b).abs() <= SAME;
            // Single precision does not resolve more.
            let has_depth = is_same(found, expected) || (found - expected).abs() <= 1e-7 * expected;
            // Where surfaces of two bodies coincide, the label may be that of either.
            let is_there = |i: usize| {
                alone[i].cast(from, ray, 1e4).is_some_and(|hit| is_same(hit.distance, expected))
            };
            let has_label = match hit {
                None => labels[pixel] == 0,
                Some(hit) => {
                    bodies[hit.body].0 == labels[pixel]
                        || (0..bodies.len()).any(|i| bodies[i].0 == labels[pixel] && is_there(i))
                }
            };
            // The pixel is not at a silhouette if rays a fiftieth of a pixel beside it hit the same body.
            let shift = 0.02 / frame.optics.focal_length;
            let is_clear =
                [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].iter().all(|(x, y)| {
                    let beside = ray + frame.pose.axes * DVec3::new(x * shift, y * shift, 0.0);
                    let other = rays.cast(from, beside, 1e4);
                    match (hit, other) {
                        (None, None) => true,
                        (Some(a), Some(b)) => {
                            a.body == b.body && (a.distance - b.distance).abs() < 0.1 * a.distance
                        }
                        _ => false,
                    }
                });
            agreement.pixels += 1;
            agreement.depths += usize::from(has_depth);
            agreement.labels += usize::from(has_label);
            if is_clear {
                agreement.clear += 1;
                agreement.clear_depths += usize::from(has_depth);
                agreement.clear_labels += usize::from(has_label);
            }
        }
    }
}

impl Agreement {
    /// Checks that all but a thousandth of the pixels agree, and all of those that are not at silhouettes,
    /// which are almost all.
    #[track_caller]
    fn check(&self, of: &str) {
        let most = |count: usize, all: usize| count as f64 >= 0.999 * all as f64;
        assert!(most(self.depths, self.pixels), "{of}: {self:?}");
        assert!(most(self.labels, self.pixels), "{of}: {self:?}");
        assert!(self.clear_depths == self.clear, "{of}: {self:?}");
        assert!(self.clear_labels == self.clear, "{of}: {self:?}");
        assert!(self.clear as f64 > 0.95 * self.pixels as f64, "{of}: {self:?}");
    }
}

/// Returns a random pose in a world.
fn pose(world: &envgen::World, stream: &mut Stream) -> (Vec2, f32) {
    for _ in 0..200 {
        let (min, max) = (world.bounds.min, world.bounds.max);
        let at =
            envgen::glam::DVec2::new(stream.between(min.x, max.x), stream.between(min.y, max.y));
        if world.clearance(at) > 0.5 {
            return (at.as_vec2(), stream.between(-3.1, 3.1) as f32);
        }
    }
    panic!("no free place");
}

#[test]
fn depths_and_labels_are_those_of_rays() {
    let mut total = 0;
    for &kind in WorldKind::ALL {
        for seed in 1..=2 {
            let mut stream = Seed(seed).stream("camera", kind as u64);
            let spec = kind.default_spec();
            // Ahead of the robot, which it does not see then.
            let camera = RobotCamera {
                forward: 0.45,
                up: stream.between(0.2, 1.0),
                pitch: stream.between(-20.0, 10.0),
                yaw: stream.between(-30.0, 30.0),
                field_of_view: stream.between(40.0, 100.0),
                ..default()
            };
            let mut scene = Scene::new(Environment::new(spec, seed), camera, None);
            let world = scene.truth();
            let pieces = pieces(&world);
            let bodies: Vec<(u32, &Form<'_>)> =
                (1..).zip(pieces.iter().map(|piece| &piece.form)).collect();
            let mut agreement = Agreement::default();
            for _ in 0..4 {
                let (at, heading) = pose(&world, &mut stream);
                let frame = scene.look(at, heading);
                assert!(frame.pose.position.truncate().distance(at.as_dvec2()) < 0.5);
                compare(&frame, &bodies, &mut agreement);
                total += frame.labels.iter().flatten().filter(|label| **label > 0).count();
            }
            agreement.check(&format!("{kind}, seed {seed}"));
        }
    }
    // Some bodies were visible.
    assert!(total > 100_000, "{total}");
}

#[test]
fn doors_and_people_are_seen_where_they_are() {
    let scenario = ScenarioSpec { doors: 1.0, people: 12, ..default() };
    let camera = RobotCamera { field_of_view: 90.0, ..default() };
    let environment = Environment::new(IndoorSpec { width: 6, height: 6, ..default() }, 4);
    let scenario = EnvironmentScenario::new(scenario, 1);
    let mut scene = Scene::new(environment, camera, Some(scenario));
    let world = scene.truth();
    let pieces = pieces(&world);
    let mut stream = Seed(4).stream("camera", 0);
    let mut agreement = Agreement::default();
    let mut seen = [0, 0];
    for _ in 0..12 {
        let (at, heading) = pose(&world, &mut stream);
        let frame = scene.look(at, heading);
        let root = scene.studio.app().world().entity(scene.environment);
        let state = root.get::<ScenarioRun>().expect("a scenario").state();
        let moving = state.bodies(&world);
        let names = &frame.names;
        let bodies: Vec<(u32, &Form<'_>)> = (1..)
            .zip(pieces.iter().map(|piece| &piece.form))
            .chain(moving.iter().map(|(target, form)| (names.of_moving(*target).unwrap(), form)))
            .collect();
        compare(&frame, &bodies, &mut agreement);
        for &label in frame.labels.iter().flatten().filter(|label| **label > 0) {
            let label = names.get(label).expect("a label");
            seen[0] += usize::from(label.kind == "leaf");
            seen[1] += usize::from(label.kind == "person");
        }
        for (target, _) in &moving {
            let name = names.get(names.of_moving(*target).unwrap()).unwrap().name;
            match target {
                Target::Leaf(door) => assert_eq!(name, format!("leaf_{door}")),
                Target::Person(person) => assert_eq!(name, format!("person_{person}")),
                Target::Part(_) => panic!("{target:?}"),
            }
        }
    }
    agreement.check("doors and people");
    assert!(seen.iter().all(|pixels| *pixels > 50), "{seen:?}");
}

#[test]
fn robots_see_each_other() {
    let camera = RobotCamera { up: 0.3, forward: 0.3, ..default() };
    let environment = Environment::new(HallwaySpec { width: 4.0, ..default() }, 2);
    let mut scene = Scene::new(environment, camera, None);
    let start = scene.truth().start.expect("a start");
    let (at, heading) = (start.position.as_vec2(), start.heading as f32);
    let ahead = at + 2.0 * Vec2::from_angle(heading);
    let other = Transform::from_translation(ahead.extend(0.0))
        .with_rotation(Quat::from_rotation_z(heading));
    let environment = scene.environment;
    let number = TrialRobot { index: 1 };
    let other =
        (RobotModel::default(), number, other, GlobalTransform::from(other), ChildOf(environment));
    scene.studio.app().world_mut().spawn(other);
    let frame = scene.look(at, heading);
    let middle = (frame.optics.height / 2 * frame.optics.width + frame.optics.width / 2) as usize;
    let (depth, labels) = (frame.depth.as_ref().unwrap(), frame.labels.as_ref().unwrap());
    assert_eq!(frame.names.get(labels[middle]).expect("a label").name, "robot_1");
    // A robot of the app that is below no environment hides the other one.
    let own = Transform::from_translation((at + 1.4 * Vec2::from_angle(heading)).extend(0.0));
    let own = own.with_rotation(Quat::from_rotation_z(heading));
    let own = (RobotModel::default(), own, GlobalTransform::from(own));
    let own = scene.studio.app().world_mut().spawn(own).id();
    let hidden = scene.look(at, heading);
    let labels = hidden.labels.as_ref().unwrap();
    assert_eq!(hidden.names.get(labels[middle]).expect("a label").name, "robot_3");
    scene.studio.app().world_mut().despawn(own);
    // The distance is from the camera, 0.3 m ahead of the centre of its robot, to the back of the other
    // robot.
    let back = 0.5 * RobotModel::default().length;
    assert!((f64::from(depth[middle]) - (1.7 - back)).abs() < 1e-3, "{}", depth[middle]);
}
