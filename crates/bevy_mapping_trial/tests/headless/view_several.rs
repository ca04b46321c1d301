//! The drawing of mapping trials together with others, and with what an app sets itself.

use bevy::camera::visibility::RenderLayers;
use bevy::mesh::Mesh2d;
use bevy::prelude::*;
use bevy_envgen::Tile;
use bevy_envgen::testing::step;
use bevy_mapping_trial::view::{ShowWholeMap, TrialSights, TrialView};

use super::view::{app, drive, hallway, trial, watch};

#[test]
fn the_arrows_of_each_trial_fit_its_own_map() {
    let world = hallway();
    let mut app = app();
    let roots = [10, 400].map(|ticks| {
        let root = watch(&mut app, &world, trial(&world, 1));
        drive(&mut app, root, ticks);
        root
    });
    for margin in [1.0, 30.0] {
        let cameras = roots
            .map(|trial| app.world_mut().spawn((Camera2d, ShowWholeMap { trial, margin })).id());
        step(&mut app, 2);
        let [first, second] = roots.map(|root| {
            let map = app.world().get::<TrialSights>(root).unwrap().map.unwrap();
            let side = (map.size().max_element() + 2.0 * margin).max(10.0);
            let mut below = app.world_mut().query::<&Children>();
            let below = below.query(app.world()).iter_descendants(root).collect::<Vec<_>>();
            let is_mark = |entity: &&Entity| {
                let name = app.world().get::<Name>(**entity);
                name.is_some_and(|name| name.as_str() == "mark of robot 0")
            };
            let mark = *below.iter().find(is_mark).expect("an arrow");
            let scale = app.world().get::<Transform>(mark).unwrap().scale;
            assert!((scale.x - 0.06 * side).abs() < 1e-3, "{scale} for {side} m");
            scale.x
        });
        assert!((first - second).abs() > 0.01, "{first} {second}");
        for camera in cameras {
            app.world_mut().despawn(camera);
        }
    }
}

#[test]
fn what_an_app_adds_to_a_hidden_world_or_changes_of_it_is_hidden() {
    let world = hallway();
    let mut app = app();
    let root = watch(&mut app, &world, trial(&world, 1));
    let world = app.world_mut();
    let mut tiles = world.query_filtered::<Entity, With<Tile>>();
    let tile = tiles.iter(world).next().expect("a tile");
    let mesh = world.resource_mut::<Assets<Mesh>>().add(Circle::new(1.0));
    let is_hidden = |app: &App, mesh: Entity| {
        app.world().get::<RenderLayers>(mesh) == Some(&RenderLayers::none())
    };
    let added = app.world_mut().spawn((Mesh2d(mesh.clone()), ChildOf(tile))).id();
    step(&mut app, 1);
    assert!(is_hidden(&app, added), "a new mesh");
    for layers in [Some(RenderLayers::layer(3)), None] {
        match layers {
            Some(layers) => app.world_mut().entity_mut(added).insert(layers),
            None => app.world_mut().entity_mut(added).remove::<RenderLayers>(),
        };
        step(&mut app, 1);
        assert!(is_hidden(&app, added), "other layers");
    }
    // A mesh that the app spawned elsewhere, below an entity that it then moves below the tile.
    let group = app.world_mut().spawn(Transform::default()).id();
    let moved = app.world_mut().spawn((Mesh2d(mesh), ChildOf(group))).id();
    step(&mut app, 2);
    assert!(!is_hidden(&app, moved));
    app.world_mut().entity_mut(group).insert(ChildOf(tile));
    step(&mut app, 1);
    assert!(is_hidden(&app, moved), "a mesh that is moved");
    app.world_mut().entity_mut(tile).insert(Visibility::Visible);
    step(&mut app, 1);
    assert_eq!(app.world().get(tile), Some(&Visibility::Hidden), "a tile that is shown");
    // Both have their own layers again, which are the default.
    app.world_mut().get_mut::<TrialView>(root).unwrap().truth = true;
    step(&mut app, 1);
    assert_eq!(app.world().get(tile), Some(&Visibility::Visible));
    for mesh in [added, moved] {
        assert_eq!(app.world().get::<RenderLayers>(mesh), None);
    }
}

#[test]
fn what_an_app_hides_of_a_world_stays_hidden_when_the_world_is_shown() {
    let world = hallway();
    let mut app = app();
    let root = watch(&mut app, &world, trial(&world, 1));
    let mut tiles = app.world_mut().query_filtered::<Entity, With<Tile>>();
    let tile = tiles.iter(app.world()).next().expect("a tile");
    let mesh = app.world_mut().spawn((Mesh2d::default(), ChildOf(tile))).id();
    let own = RenderLayers::layer(5);
    let set = |app: &mut App, shown: Visibility, layers: &RenderLayers| {
        app.world_mut().entity_mut(tile).insert(shown);
        app.world_mut().entity_mut(mesh).insert(layers.clone());
        step(app, 2);
    };
    let found = |app: &App| {
        let layers = app.world().get::<RenderLayers>(mesh).cloned();
        (*app.world().get::<Visibility>(tile).unwrap(), layers)
    };
    let show = |app: &mut App, truth: bool| {
        app.world_mut().get_mut::<TrialView>(root).unwrap().truth = truth;
        step(app, 2);
    };
    let hidden = (Visibility::Hidden, Some(RenderLayers::none()));
    // Before, during and after the world is hidden.
    set(&mut app, Visibility::Visible, &own);
    assert_eq!(found(&app), hidden);
    show(&mut app, true);
    assert_eq!(found(&app), (Visibility::Visible, Some(own.clone())));
    let other = RenderLayers::layer(6);
    set(&mut app, Visibility::Hidden, &other);
    assert_eq!(found(&app), (Visibility::Hidden, Some(other.clone())));
    show(&mut app, false);
    assert_eq!(found(&app), hidden);
    app.world_mut().entity_mut(root).remove::<TrialView>();
    step(&mut app, 2);
    assert_eq!(found(&app), (Visibility::Hidden, Some(other)));
}
