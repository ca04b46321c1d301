//! Worlds that are streamed around an anchor.

use std::time::Duration;

use bevy::prelude::*;
use bevy_envgen::envgen::forest::ForestSpec;
use bevy_envgen::envgen::geometry::Rect as WorldRect;
use bevy_envgen::envgen::glam::DVec2;
use bevy_envgen::envgen::landscape::LandscapeSpec;
use bevy_envgen::envgen::road::RoadSpec;
use bevy_envgen::envgen::{Seed, WorldSpec};
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{in_rapier, parts, step, test_app, truth, wait_until_ready};
use bevy_envgen::{EndlessTruth, StreamingReport, Tile};

use super::{spawned, specs};

fn endless(min_distance: f64) -> Environment {
    let spec = ForestSpec { intensity: 0.05, radius: 0.3, min_distance, ..default() };
    Environment::new(spec, 7).endless(12.0)
}

/// Spawns an environment that is streamed around an anchor that does not move.
fn streamed(app: &mut App, environment: Environment, at: Vec2, radius: f64) -> (Entity, Entity) {
    let anchor = app.world_mut().spawn(Transform::from_translation(at.extend(0.0))).id();
    let around = StreamAround::new(anchor, radius);
    let root = app.world_mut().spawn((environment, around)).id();
    (root, anchor)
}

fn settle(app: &mut App) -> usize {
    for frame in 1..2000 {
        step(app, 1);
        if app.world().resource::<StreamingReport>().waiting == 0 {
            return frame;
        }
        std::thread::sleep(Duration::from_micros(200));
    }
    panic!("the window does not settle: {:?}", app.world().resource::<StreamingReport>());
}

fn travel(app: &mut App, anchor: Entity, path: &[Vec2]) {
    for at in path {
        app.world_mut().get_mut::<Transform>(anchor).unwrap().translation = at.extend(0.0);
        step(app, 1);
    }
    settle(app);
}

#[test]
fn a_world_is_ready_only_where_its_anchor_is() {
    let mut app = test_app();
    app.insert_resource(StreamingBudget::Parts(1));
    let environment = endless(0.0).with_pace(GenerationMode::Blocking);
    let (root, anchor) = streamed(&mut app, environment, Vec2::ZERO, 40.0);
    wait_until_ready(&mut app, root).unwrap();
    app.world_mut().entity_mut(root).observe(|_: On<EnvironmentReady>| panic!("ready again"));
    let state = |app: &App| *app.world().get::<EnvironmentState>(root).unwrap();
    // A neighbouring tile is missing, but not the nearest.
    travel(&mut app, anchor, &[]);
    app.world_mut().get_mut::<Transform>(anchor).unwrap().translation.x = 5.0;
    step(&mut app, 1);
    assert!(app.world().resource::<StreamingReport>().waiting > 0);
    assert_eq!(state(&app), EnvironmentState::Ready);
    app.world_mut().get_mut::<Transform>(anchor).unwrap().translation.x = 1000.0;
    step(&mut app, 1);
    assert_eq!(state(&app), EnvironmentState::Streaming);
    settle(&mut app);
    assert_eq!(state(&app), EnvironmentState::Ready);
}

#[test]
fn an_endless_forest_is_spawned_around_its_anchor() {
    for (min_distance, pace) in
        [(0.0, GenerationMode::Blocking), (1.5, GenerationMode::Auto), (1.5, GenerationMode::Async)]
    {
        let mut app = test_app();
        let at = Vec2::new(1003.0, -517.0);
        let environment = endless(min_distance).with_pace(pace);
        let (root, _) = streamed(&mut app, environment, at, 60.0);
        wait_until_ready(&mut app, root).unwrap();
        let spawned = parts(&app, root);
        let truth = app.world().get::<EndlessTruth>(root).unwrap();
        // Everything within the radius is spawned, each tree once, and at its position in the forest.
        let p = at.as_dvec2();
        let window = WorldRect::new(p - 60.0, p + 60.0);
        let near = truth.window(window).unwrap();
        let near: Vec<_> = near.iter().filter(|tree| tree.center.distance(p) <= 60.0).collect();
        assert!(near.len() > 400);
        for tree in near {
            let center = tree.center.as_vec2();
            let there = spawned
                .iter()
                .filter(|part| part.transform.translation.truncate().distance(center) < 1e-4);
            assert_eq!(there.count(), 1, "{tree:?}");
        }
        for part in &spawned {
            let [i, j] = part.id.tile;
            let tree = truth.tile(i, j)[part.id.index as usize];
            assert_eq!(part.transform.translation.truncate(), tree.center.as_vec2());
        }
    }
}

#[test]
fn a_world_that_always_has_something_to_do_starves_no_other() {
    let mut app = test_app();
    app.insert_resource(StreamingBudget::Parts(1));
    let blocking = |environment: Environment| environment.with_pace(GenerationMode::Blocking);
    let (_, anchor) = streamed(&mut app, blocking(endless(0.0)), Vec2::ZERO, 40.0);
    let (other, _) = streamed(&mut app, blocking(endless(0.0)), Vec2::ZERO, 10.0);
    for frame in 0..400 {
        // The anchor moves by more than the width of its surroundings, so that all tiles must be spawned.
        let at = Vec3::X * 100.0 * frame as f32;
        app.world_mut().get_mut::<Transform>(anchor).unwrap().translation = at;
        step(&mut app, 1);
        if app.world().get(other) == Some(&EnvironmentState::Ready) {
            return;
        }
    }
    panic!("the other world waits: {:?}", app.world().resource::<StreamingReport>());
}

#[test]
fn what_is_spawned_does_not_depend_on_the_path_travelled() {
    let zigzag: Vec<Vec2> =
        (0..90).map(|i| Vec2::new(i as f32 * 3.0, ((i % 7) * 9) as f32 - 30.0)).collect();
    let jump = [Vec2::new(-900.0, 400.0), Vec2::new(0.0, 5000.0)];
    let goal = Vec2::new(61.0, 17.0);
    let road = WorldSpec::from(RoadSpec { length: 3000.0, ..default() });
    let landscape = LandscapeSpec {
        rows: 60,
        cols: 60,
        speeds: vec![1.0, 0.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
        ..default()
    };
    for environment in [
        endless(0.0),
        endless(1.5),
        Environment::new(road, 3),
        Environment::new(landscape, 3),
        Environment::new(ForestSpec { width: 150.0, height: 150.0, ..default() }, 3),
    ] {
        let mut found = Vec::new();
        for path in [&zigzag[..], &jump, &[]] {
            for (budget, solids) in [
                (StreamingBudget::Parts(150), SolidStorage::Entities),
                (StreamingBudget::Parts(150), SolidStorage::TileData),
                (StreamingBudget::default(), SolidStorage::Entities),
            ] {
                let mut app = test_app();
                app.insert_resource(budget);
                let environment = environment.clone().with_solids(solids);
                let (root, anchor) = streamed(&mut app, environment, Vec2::ZERO, 40.0);
                wait_until_ready(&mut app, root).unwrap();
                travel(&mut app, anchor, path);
                travel(&mut app, anchor, &[goal]);
                found.push(parts(&app, root));
            }
        }
        assert!(found[0].len() > 2, "{environment:?}");
        for other in &found[1..] {
            assert_eq!(&found[0], other, "{environment:?}");
        }
    }
}

#[test]
fn a_finite_world_has_the_same_parts_whether_streamed_or_not() {
    for spec in specs() {
        let mut app = test_app();
        let whole = app.world_mut().spawn(Environment::new(spec.clone(), 5)).id();
        wait_until_ready(&mut app, whole).unwrap();
        let bounds = truth(&app, whole).bounds;
        let middle = bounds.center().as_vec2();
        let radius = bounds.size().length();
        let environment = Environment::new(spec.clone(), 5);
        let (streamed, anchor) = streamed(&mut app, environment, middle, radius);
        wait_until_ready(&mut app, streamed).unwrap();
        // Blocks of ground are cut by the tiles. Everything else is the same.
        let comparable = |root| {
            let mut parts = parts(&app, root);
            parts.retain(|part| part.id.kind != bevy_envgen::PartKind::Ground);
            parts
        };
        assert_eq!(comparable(whole), comparable(streamed), "{spec:?}");

        // If the anchor is out of reach, nothing of the world is left in the ECS or in rapier.
        app.world_mut().despawn(whole);
        travel(&mut app, anchor, &[Vec2::splat(1e6)]);
        step(&mut app, 3);
        assert_eq!((spawned(&mut app), in_rapier(&mut app)), (0, (0, 0)), "{spec:?}");
    }
}

#[test]
fn parts_near_the_anchor_are_there_and_far_ones_are_not() {
    let mut app = test_app();
    let spec = ForestSpec { width: 300.0, height: 300.0, ..default() };
    let (root, anchor) = streamed(&mut app, Environment::new(spec, 2), Vec2::splat(150.0), 30.0);
    wait_until_ready(&mut app, root).unwrap();
    travel(&mut app, anchor, &[Vec2::splat(100.0)]);
    let world = truth(&app, root);
    let p = DVec2::splat(100.0);
    let there: Vec<_> = parts(&app, root).iter().map(|part| part.id).collect();
    for (index, tree) in world.trees.iter().enumerate() {
        let id = PartId::new(bevy_envgen::PartKind::Tree, index as u32);
        let distance = tree.center.distance(p);
        if distance <= 30.0 {
            assert!(there.contains(&id));
        }
        // A tile is 7.5 m wide, so the farthest corner of a tile within the radius is 10.7 m beyond it.
        if distance > 30.0 + 10.7 {
            assert!(!there.contains(&id));
        }
    }
}

#[test]
fn an_environment_that_is_moved_streams_around_the_anchor_as_it_sees_it() {
    let mut app = test_app();
    let (root, _) = streamed(&mut app, endless(0.0), Vec2::new(500.0, 0.0), 30.0);
    let at = Transform::from_xyz(400.0, 0.0, 0.0)
        .with_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2));
    app.world_mut().entity_mut(root).insert(at);
    wait_until_ready(&mut app, root).unwrap();
    // 100 m ahead in the world is 100 m to the right, at -y, of a frame that is rotated to the left.
    let seen = parts(&app, root);
    let mean = seen.iter().map(|part| part.transform.translation).sum::<Vec3>() / seen.len() as f32;
    assert!(mean.distance(Vec3::new(0.0, -100.0, 0.0)) < 10.0, "{mean}");
}

#[test]
fn an_origin_far_away_streams_there() {
    let far = DVec2::new(4e6, 4e6);
    let mut app = test_app();
    let environment = endless(0.0).with_origin(far);
    let (root, _) = streamed(&mut app, environment, Vec2::ZERO, 30.0);
    wait_until_ready(&mut app, root).unwrap();
    let truth = app.world().get::<EndlessTruth>(root).unwrap();
    let spawned = parts(&app, root);
    assert!(spawned.len() > 100);
    for part in spawned {
        let [i, j] = part.id.tile;
        let exact = truth.tile(i, j)[part.id.index as usize].center - far;
        assert!(part.transform.translation.truncate().as_dvec2().distance(exact) < 1e-4);
    }
}

#[test]
fn a_budget_of_parts_is_kept_and_the_same_in_every_run() {
    let run = |solids| {
        let mut app = test_app();
        app.insert_resource(StreamingBudget::Parts(200));
        let spec =
            ForestSpec { width: 200.0, height: 200.0, intensity: 0.3, radius: 0.2, ..default() };
        let environment =
            Environment::new(spec, 2).with_pace(GenerationMode::Blocking).with_solids(solids);
        let (root, anchor) = streamed(&mut app, environment, Vec2::splat(100.0), 60.0);
        let mut history = Vec::new();
        for frame in 0..150 {
            let at = Vec2::new(100.0 + 0.3 * frame as f32, 100.0);
            app.world_mut().get_mut::<Transform>(anchor).unwrap().translation = at.extend(0.0);
            let before = parts(&app, root).len();
            step(&mut app, 1);
            let after = parts(&app, root).len();
            // The budget is exceeded by at most one step of 128 parts.
            assert!(after.abs_diff(before) <= 200 + 128, "{before} {after}");
            let StreamingReport { spawned, despawned, waiting, .. } = *app.world().resource();
            history.push((after, spawned, despawned, waiting));
        }
        history
    };
    let first = run(SolidStorage::Entities);
    assert_eq!(first, run(SolidStorage::Entities));
    assert_eq!(first, run(SolidStorage::TileData));
    assert!(first.iter().any(|frame| frame.3 == 0) && first[0].3 > 0);
}

fn tiles(app: &mut App) -> Vec<Entity> {
    let mut tiles = app.world_mut().query_filtered::<Entity, With<Tile>>();
    tiles.iter(app.world()).collect()
}

#[test]
fn changes_of_the_window_are_followed() {
    let mut app = test_app();
    let (root, anchor) = streamed(&mut app, endless(0.0), Vec2::ZERO, 20.0);
    wait_until_ready(&mut app, root).unwrap();
    let small = parts(&app, root).len();
    app.world_mut().get_mut::<StreamAround>(root).unwrap().radius = 50.0;
    settle(&mut app);
    assert!(parts(&app, root).len() > 3 * small);
    app.world_mut().get_mut::<StreamAround>(root).unwrap().radius = 20.0;
    settle(&mut app);
    assert_eq!(parts(&app, root).len(), small);

    // Inserting another component does the same. Its side of tiles differs, but is not used.
    let spawned: Vec<Entity> = tiles(&mut app);
    app.world_mut().entity_mut(root).insert(StreamAround::new(anchor, 50.0));
    settle(&mut app);
    let now = tiles(&mut app);
    assert!(now.len() > spawned.len() && spawned.iter().all(|tile| now.contains(tile)));
    app.world_mut().entity_mut(root).insert(StreamAround::new(anchor, 20.0));
    settle(&mut app);
    assert_eq!(parts(&app, root).len(), small);

    // If the anchor does not exist, the world is kept as it is.
    app.world_mut().despawn(anchor);
    step(&mut app, 5);
    assert_eq!(parts(&app, root).len(), small);

    // A finite world that is no longer streamed is spawned as a whole.
    let anchor = app.world_mut().spawn(Transform::default()).id();
    let spec = ForestSpec { width: 200.0, height: 200.0, ..default() };
    let around = StreamAround::new(anchor, 20.0);
    app.world_mut().entity_mut(root).insert((Environment::new(spec, 1), around));
    wait_until_ready(&mut app, root).unwrap();
    let near = parts(&app, root).len();
    app.world_mut().entity_mut(root).remove::<StreamAround>();
    step(&mut app, 1);
    wait_until_ready(&mut app, root).unwrap();
    assert!(parts(&app, root).len() > 5 * near);
    assert!(truth(&app, root).provenance.seed == Some(Seed(1)));
}

#[test]
fn nothing_is_reported_of_a_world_that_another_one_is_requested_in_place_of() {
    #[derive(Resource, Default)]
    struct Ready(usize);
    let mut app = test_app();
    app.init_resource::<Ready>();
    app.insert_resource(StreamingBudget::Parts(1));
    app.add_observer(|_: On<EnvironmentReady>, mut ready: ResMut<Ready>| ready.0 += 1);
    let first = endless(0.0).with_pace(GenerationMode::Blocking);
    let (root, _) = streamed(&mut app, first, Vec2::ZERO, 20.0);
    step(&mut app, 2);
    assert!(app.world().resource::<StreamingReport>().waiting > 0);
    // The new request fails: the previous world is kept, but is not what was requested.
    let bad = Environment::new(ForestSpec { radius: -1.0, ..default() }, 1);
    app.world_mut().entity_mut(root).insert(bad);
    settle(&mut app);
    step(&mut app, 2);
    assert_eq!(app.world().resource::<Ready>().0, 0);
    assert_eq!(app.world().get(root), Some(&EnvironmentState::Failed));
    assert!(app.world().entity(root).contains::<EnvironmentFailure>());
    // Requests the first world again.
    let first = endless(0.0).with_pace(GenerationMode::Blocking);
    app.world_mut().entity_mut(root).insert(first);
    wait_until_ready(&mut app, root).unwrap();
    assert_eq!(app.world().resource::<Ready>().0, 1);
}

#[test]
fn tiles_that_a_fast_anchor_leaves_behind_do_not_pile_up() {
    // Per 12 m, a column of seven tiles must be spawned ahead and one despawned behind, which is more than
    // the budget of a frame.
    for (budget, metres) in [(1, 12.0), (60, 36.0)] {
        let mut app = test_app();
        app.insert_resource(StreamingBudget::Parts(budget));
        let environment = endless(0.0).with_pace(GenerationMode::Blocking);
        let (root, anchor) = streamed(&mut app, environment, Vec2::ZERO, 40.0);
        wait_until_ready(&mut app, root).unwrap();
        let tiles = |app: &mut App| app.world_mut().query::<&Tile>().iter(app.world()).count();
        let window = tiles(&mut app);
        for frame in 0..400 {
            let at = Vec3::X * metres * frame as f32;
            app.world_mut().get_mut::<Transform>(anchor).unwrap().translation = at;
            step(&mut app, 1);
            assert!(tiles(&mut app) <= 2 * window, "{} tiles of {window}", tiles(&mut app));
        }
    }
}
