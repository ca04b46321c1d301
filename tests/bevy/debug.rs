//! Lines over worlds and trials.

use std::any::TypeId;
use std::collections::BTreeSet;

use bevy::ecs::reflect::{ReflectComponent, ReflectResource};
use bevy::gizmos::{GizmoHandles, GizmoPlugin};
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy::reflect::TypeInfo;
use bevy_envgen::debug::{DebugLayers, DebugTrials, EnvgenDebugPlugin, EnvgenGizmos};
use bevy_envgen::envgen::indoor::IndoorSpec;
use bevy_envgen::envgen::{Blueprint, Seed, Spec};
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{step, test_app_with, wait_until_ready};
use bevy_envgen::view::TrialViewPlugin;
use mapping_trial::map::Cell;
use mapping_trial::trial::{Trial, TrialSettings};

use super::view::Flat;

/// An app with a trial of a building, driven for so many ticks.
fn app(ticks: usize) -> (App, Entity) {
    let mut app = test_app_with((
        MeshPlugin,
        GizmoPlugin,
        EnvgenPlugins::default(),
        TrialViewPlugin::default(),
        EnvgenDebugPlugin,
    ));
    app.debug_trials::<Flat>();
    let world = IndoorSpec::default().generate(Seed(4)).unwrap().to_world();
    let mut trial = Trial::flat(&world, TrialSettings::default()).unwrap();
    for _ in 0..ticks {
        trial.step();
    }
    let environment = Environment::prebuilt(world);
    let root = app.world_mut().spawn((environment, Flat(Some(trial)))).id();
    wait_until_ready(&mut app, root).unwrap();
    (app, root)
}

/// The ends of the lines that are drawn with some layers, those of lists and those of strips.
fn lines(app: &mut App, layers: DebugLayers) -> (Vec<Vec2>, Vec<Vec2>) {
    app.insert_resource(layers);
    step(app, 2);
    let handles = app.world().resource::<GizmoHandles>().handles();
    let Some(handle) = handles[&TypeId::of::<EnvgenGizmos>()].as_ref() else {
        return (Vec::new(), Vec::new());
    };
    let gizmos = app.world().resource::<Assets<GizmoAsset>>().get(handle).unwrap().buffer();
    let flat = |points: &[Vec3]| {
        points.iter().filter(|p| p.is_finite()).map(|p| p.truncate()).collect::<Vec<_>>()
    };
    (flat(&gizmos.list_positions), flat(&gizmos.strip_positions))
}

#[test]
fn nothing_is_drawn_until_a_layer_is_switched_on() {
    let (mut app, root) = app(200);
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
    let (mut app, root) = app(0);
    let (list, _) = lines(&mut app, DebugLayers { colliders: true, ..default() });
    let truth = app.world().get::<GroundTruth>(root).unwrap();
    assert!(list.len() >= 8 * truth.walls.len());
    for p in &list {
        let p = p.as_dvec2();
        let walls = truth.walls.iter().map(|wall| &wall.shape);
        let things = truth.obstacles.iter().map(|thing| &thing.shape);
        let doors = truth.doorways.iter().map(|door| &door.shape);
        // Sensors are colliders, too.
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
    let (mut app, root) = app(0);
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
fn rays_frontiers_and_plans_are_those_of_the_trial() {
    let (mut app, root) = app(400);
    let rays = lines(&mut app, DebugLayers { rays: true, ..default() }).0;
    let frontiers = lines(&mut app, DebugLayers { frontiers: true, ..default() }).0;
    let plan = lines(&mut app, DebugLayers { plan: true, ..default() }).1;
    let holder = app.world().get::<Flat>(root).unwrap();
    let trial = holder.0.as_ref().unwrap();
    let autonomy = trial.autonomy();
    let echoes = autonomy.scan(0).ranges.iter().filter(|range| range.is_finite());
    assert_eq!(rays.len(), 2 * echoes.count());
    let at = autonomy.slam().estimate(0).pose.position.as_vec2();
    assert!(rays.chunks(2).all(|ray| (ray[0].distance(at) - 0.21).abs() < 1e-3));

    // Each cell is a cross of two lines, its middle free with something unknown beside it.
    assert!(frontiers.len() >= 40 && frontiers.len().is_multiple_of(4));
    let map = autonomy.slam().map();
    for cross in frontiers.chunks(4) {
        let middle = (cross[0] + cross[1]) * 0.5;
        let cell = mapping_trial::map::CellIndex::of(middle.as_dvec2());
        assert_eq!(map.cell(cell), Cell::Free);
        let beside = [(1, 0), (-1, 0), (0, 1), (0, -1)].map(|(col, row)| {
            let (col, row) = (cell.col + col, cell.row + row);
            map.cell(mapping_trial::map::CellIndex { col, row })
        });
        assert!(beside.contains(&Cell::Unknown));
    }

    let path = autonomy.policy().unwrap().path(0);
    assert!(path.len() >= 2);
    assert!(path.iter().all(|p| plan.iter().any(|q| q.distance(p.as_vec2()) < 1e-3)));
}

#[test]
fn without_bevys_plugin_for_gizmos_nothing_is_drawn() {
    let mut app = test_app_with((EnvgenPlugins::default(), EnvgenDebugPlugin));
    app.insert_resource(DebugLayers::ALL).debug_trials::<Flat>();
    let world = IndoorSpec::default().generate(Seed(4)).unwrap().to_world();
    let trial = Trial::flat(&world, TrialSettings::default()).unwrap();
    let environment = Environment::prebuilt(world);
    let root = app.world_mut().spawn((environment, Flat(Some(trial)))).id();
    wait_until_ready(&mut app, root).unwrap();
    step(&mut app, 5);
}

/// What the crate keeps to itself and no inspector needs: bookkeeping of plugins and generators.
const PRIVATE: &[&str] = &[
    "bevy_envgen::Schedules",
    "bevy_envgen::debug::Drawable",
    "bevy_envgen::job::GenerationJob",
    "bevy_envgen::job::PendingEvents",
    "bevy_envgen::job::SpawnedTiles",
    "bevy_envgen::streaming::Streaming",
    "bevy_envgen::view::camera::MapMark",
    "bevy_envgen::view::drawing::Drawing",
    "bevy_envgen::visuals::Inks",
];

/// What is made again from an environment, and must not get into scenes.
const MADE_AGAIN: &[&str] = &[
    "bevy_envgen::environment::EndlessTruth",
    "bevy_envgen::environment::EnvironmentFailure",
    "bevy_envgen::environment::GroundTruth",
];

/// Components of the numbers of other crates, which do not reflect.
const CLOSED: &[&str] =
    &["bevy_envgen::robot::model::RobotModel", "bevy_envgen::trial::ManualControl"];

#[test]
fn inspectors_know_every_component_and_resource() {
    let (mut app, _) = app(5);
    step(&mut app, 3);
    let world = app.world();
    let registry = world.resource::<AppTypeRegistry>().read();
    let mut unknown = BTreeSet::new();
    let mut closed = BTreeSet::new();
    let mut known = 0;
    for info in world.components().iter_registered() {
        let name = info.name().to_string();
        if !name.starts_with("bevy_envgen::") {
            continue;
        }
        match info.type_id().and_then(|id| registry.get(id)) {
            Some(kind) => {
                known += 1;
                let reflects = kind.data::<ReflectComponent>().is_some()
                    || kind.data::<ReflectResource>().is_some();
                assert!(reflects, "{name} is registered, but neither as component nor resource");
                if matches!(kind.type_info(), TypeInfo::Opaque(_)) {
                    closed.insert(name);
                }
            }
            None => {
                unknown.insert(name);
            }
        }
    }
    assert!(known >= 20, "{known}");
    unknown.retain(|name| ![PRIVATE, MADE_AGAIN].concat().contains(&name.as_str()));
    assert!(unknown.is_empty(), "not registered: {unknown:?}");
    closed.retain(|name| !CLOSED.contains(&name.as_str()));
    assert!(closed.is_empty(), "show nothing: {closed:?}");
}
