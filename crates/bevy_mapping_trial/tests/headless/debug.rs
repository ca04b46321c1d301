//! Tests of the gizmos over trials.

use bevy::gizmos::GizmoPlugin;
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{step, test_app_with, wait_until_ready};
use bevy_mapping_trial::debug::{DebugTrials, TrialDebugLayers, TrialDebugPlugin};
use bevy_mapping_trial::prelude::*;
use bevy_mapping_trial::view::TrialViewPlugin;
use envgen::{Blueprint, Seed, Spec};
use mapping_trial::map::Cell;
use mapping_trial::trial::{Trial, TrialSettings};

use super::gizmos::lines;
use super::inspector::{Inspected, inspect};
use super::view::Flat;

/// Creates an app with a trial in a building that has run for a number of ticks.
fn app(ticks: usize) -> (App, Entity) {
    let mut app = test_app_with((
        MeshPlugin,
        GizmoPlugin,
        EnvgenPlugins::default(),
        TrialPlugin::default(),
        TrialViewPlugin::default(),
        TrialDebugPlugin,
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

#[test]
fn nothing_is_drawn_until_a_layer_is_switched_on() {
    let (mut app, root) = app(400);
    assert_eq!(lines(&mut app, TrialDebugLayers::default()), (vec![], vec![]));
    let (list, strip) = lines(&mut app, TrialDebugLayers::ALL);
    assert!(list.len() > 100 && strip.len() > 2, "{} {}", list.len(), strip.len());
    assert_eq!(lines(&mut app, TrialDebugLayers::default()), (vec![], vec![]));
    app.insert_resource(TrialDebugLayers::ALL);
    app.world_mut().entity_mut(root).despawn();
    step(&mut app, 3);
    assert_eq!(lines(&mut app, TrialDebugLayers::ALL), (vec![], vec![]));
}

#[test]
fn rays_frontiers_and_plans_are_those_of_the_trial() {
    let (mut app, root) = app(400);
    let rays = lines(&mut app, TrialDebugLayers { rays: true, ..default() }).0;
    let frontiers = lines(&mut app, TrialDebugLayers { frontiers: true, ..default() }).0;
    let plan = lines(&mut app, TrialDebugLayers { plan: true, ..default() }).1;
    let holder = app.world().get::<Flat>(root).unwrap();
    let trial = holder.0.as_ref().unwrap();
    let autonomy = trial.autonomy();
    let echoes = autonomy.scan(0).ranges.iter().filter(|range| range.is_finite());
    assert_eq!(rays.len(), 2 * echoes.count());
    let at = autonomy.slam().estimate(0).pose.position.as_vec2();
    assert!(rays.chunks(2).all(|ray| (ray[0].distance(at) - 0.21).abs() < 1e-3));

    // Each frontier cell is a cross of two lines. Its centre is free, with an unknown cell beside it.
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
    let mut app = test_app_with((EnvgenPlugins::default(), TrialDebugPlugin));
    app.insert_resource(TrialDebugLayers::ALL).debug_trials::<Flat>();
    let world = IndoorSpec::default().generate(Seed(4)).unwrap().to_world();
    let trial = Trial::flat(&world, TrialSettings::default()).unwrap();
    let environment = Environment::prebuilt(world);
    let root = app.world_mut().spawn((environment, Flat(Some(trial)))).id();
    wait_until_ready(&mut app, root).unwrap();
    step(&mut app, 5);
}

/// The private types of the crate that no inspector needs, such as the state of plugins.
const PRIVATE: &[&str] = &[
    "bevy_mapping_trial::robot::ground::GroundIndex",
    "bevy_mapping_trial::robot::model::Fitted",
    "bevy_mapping_trial::trial::colliders::ReplacedColliders",
    "bevy_mapping_trial::trial::scenario::ReplacedScenario",
    "bevy_mapping_trial::view::IsWatched<bevy_mapping_trial::trial::component::MappingTrial>",
    "bevy_mapping_trial::view::camera::MapMark",
    "bevy_mapping_trial::view::curtain::HiddenFromAbove",
    "bevy_mapping_trial::view::curtain::HiddenPart",
    "bevy_mapping_trial::view::curtain::Shown",
    "bevy_mapping_trial::view::drawing::Drawing",
];

/// Components with values of other crates' types that do not reflect.
const CLOSED: &[&str] = &[
    "bevy_mapping_trial::robot::model::RobotModel",
    "bevy_mapping_trial::trial::component::ManualControl",
];

#[test]
fn inspectors_know_every_component_and_resource() {
    let (mut app, _) = app(5);
    step(&mut app, 3);
    let Inspected { known, mut unknown, mut closed } = inspect(&app, "bevy_mapping_trial");
    assert!(known >= 18, "{known}");
    unknown.retain(|name| !PRIVATE.contains(&name.as_str()));
    assert!(unknown.is_empty(), "not registered: {unknown:?}");
    closed.retain(|name| !CLOSED.contains(&name.as_str()));
    assert!(closed.is_empty(), "show nothing: {closed:?}");
}
