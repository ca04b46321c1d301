//! Tests of the gizmos over worlds.

use bevy::gizmos::GizmoPlugin;
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy_envgen::debug::{DebugLayers, EnvgenDebugPlugin};
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{spawn_ready, step, test_app_with};

use super::gizmos::lines;
use super::inspector::{Inspected, inspect};

/// Creates an app with a building.
fn app() -> (App, Entity) {
    let mut app =
        test_app_with((MeshPlugin, GizmoPlugin, EnvgenPlugins::default(), EnvgenDebugPlugin));
    let root = spawn_ready(&mut app, Environment::new(IndoorSpec::default(), 4)).unwrap();
    (app, root)
}

#[test]
fn nothing_is_drawn_until_a_layer_is_switched_on() {
    let (mut app, root) = app();
    assert_eq!(lines(&mut app, DebugLayers::default()), (vec![], vec![]));
    let (list, strip) = lines(&mut app, DebugLayers::ALL);
    assert!(list.len() > 1000 && strip.len() > 20, "{} {}", list.len(), strip.len());
    assert_eq!(lines(&mut app, DebugLayers::default()), (vec![], vec![]));
    app.insert_resource(DebugLayers::ALL);
    app.world_mut().entity_mut(root).despawn();
    step(&mut app, 3);
    assert_eq!(lines(&mut app, DebugLayers::ALL), (vec![], vec![]));
}

#[test]
fn outlines_lie_on_walls() {
    let (mut app, root) = app();
    let (list, _) = lines(&mut app, DebugLayers { colliders: true, ..default() });
    let truth = app.world().get::<GroundTruth>(root).unwrap();
    assert!(list.len() >= 8 * truth.walls.len());
    for p in &list {
        let p = p.as_dvec2();
        let walls = truth.walls.iter().map(|wall| &wall.shape);
        let things = truth.obstacles.iter().map(|thing| &thing.shape);
        let doors = truth.doorways.iter().map(|door| &door.shape);
        // Sensors are colliders too.
        let rooms = truth.rooms.iter().map(|room| &room.shape);
        let grounds = truth.surfaces.iter().map(|ground| &ground.shape);
        let shapes = walls.chain(things).chain(doors).chain(rooms).chain(grounds);
        let distance = |shape: &bevy_envgen::envgen::geometry::Shape| shape.distance(p).abs();
        let near = shapes.map(distance).fold(f64::INFINITY, f64::min);
        assert!(near < 0.05, "{p} is {near} m from everything");
    }
}

#[test]
fn the_graph_of_rooms_joins_rooms_by_their_doorways() {
    let (mut app, root) = app();
    let (list, strip) = lines(&mut app, DebugLayers { rooms: true, ..default() });
    let truth = app.world().get::<GroundTruth>(root).unwrap();
    let joined = truth.doorways.iter().flat_map(|door| door.rooms).flatten().count();
    assert!(joined > 0);
    assert_eq!(list.len(), 2 * joined, "one line from each room to each of its doorways");
    for end in list.chunks(2) {
        let room = end[0].as_dvec2();
        let door = end[1].as_dvec2();
        assert!(truth.rooms.iter().any(|r| r.shape.bounds().center().distance(room) < 1e-3));
        assert!(truth.doorways.iter().any(|d| d.shape.bounds().center().distance(door) < 1e-3));
    }
    assert!(strip.len() > truth.rooms.len());
}

#[test]
fn people_and_leaves_are_outlined() {
    let (mut app, root) = app();
    let doors = ScenarioSpec { doors: 1.0, people: 3, waiting: 1.0, ..default() };
    app.world_mut().entity_mut(root).insert(EnvironmentScenario::new(doors, 1));
    step(&mut app, 300);
    let (list, strip) = lines(&mut app, DebugLayers { scenario: true, ..default() });
    let state = app.world().get::<ScenarioRun>(root).unwrap().state();
    for leaf in state.all_leaves() {
        for end in [leaf.hinge, leaf.tip] {
            assert!(list.iter().any(|p| p.distance(end.as_vec2()) < 0.06), "{leaf:?}");
        }
    }
    for person in state.people() {
        let near = |p: &&Vec2| (p.distance(person.position.as_vec2()) - 0.25).abs() < 0.01;
        assert!(strip.iter().filter(near).count() > 10);
        for corner in person.path() {
            assert!(strip.iter().any(|p| p.distance(corner.as_vec2()) < 1e-3));
        }
    }
}

#[test]
fn without_bevys_plugin_for_gizmos_nothing_is_drawn() {
    let mut app = test_app_with((EnvgenPlugins::default(), EnvgenDebugPlugin));
    app.insert_resource(DebugLayers::ALL);
    spawn_ready(&mut app, Environment::new(IndoorSpec::default(), 4)).unwrap();
    step(&mut app, 5);
}

/// The private types of the crate that no inspector needs, such as the state of plugins and generators.
const PRIVATE: &[&str] = &[
    "bevy_envgen::debug::Drawable",
    "bevy_envgen::difficulty::DifficultyTask",
    "bevy_envgen::job::GenerationJob",
    "bevy_envgen::job::PendingEvents",
    "bevy_envgen::job::SpawnedTiles",
    "bevy_envgen::physics::turned::Corrected",
    "bevy_envgen::scenario::run::LastRequest",
    "bevy_envgen::streaming::Streaming",
    "bevy_envgen::systems::EnvgenSchedules",
    "bevy_envgen::visuals::part_group::GroupMaterials",
    "bevy_envgen::visuals::moving::LeafMesh",
    "bevy_envgen::visuals::moving::SmokeMesh",
];

/// The components that are rebuilt from an environment, and must not be saved in scenes.
const MADE_AGAIN: &[&str] = &[
    "bevy_envgen::difficulty::DifficultyFailure",
    "bevy_envgen::difficulty::EnvironmentDifficulty",
    "bevy_envgen::environment::EndlessTruth",
    "bevy_envgen::environment::EnvironmentFailure",
    "bevy_envgen::environment::GroundTruth",
    "bevy_envgen::environment::SpawnedOrigin",
    "bevy_envgen::scenario::request::ScenarioFailure",
    "bevy_envgen::scenario::run::ScenarioRun",
];

#[test]
fn inspectors_know_every_component_and_resource() {
    let (mut app, _) = app();
    step(&mut app, 3);
    let Inspected { known, mut unknown, closed } = inspect(&app, "bevy_envgen");
    assert!(known >= 20, "{known}");
    unknown.retain(|name| ![PRIVATE, MADE_AGAIN].concat().contains(&name.as_str()));
    assert!(unknown.is_empty(), "not registered: {unknown:?}");
    assert!(closed.is_empty(), "show nothing: {closed:?}");
}
