//! The drawing of mapping trials of which an app despawns parts, or the whole.

use bevy::mesh::Mesh2d;
use bevy::prelude::*;
use bevy_envgen::SpawnedOrigin;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::step;
use bevy_mapping_trial::view::TrialViewSystems;

use super::view::{Flat, app, compare, drive, hallway, named, trial, watch};

#[test]
fn drawings_that_an_app_despawns_are_drawn_again() {
    let parts = ["true robot 0", "mark of robot 1", "path", "map (0, 0)"];
    for name in ["trial view", "map", "scans", "paths", "truth", "robot 0", "scan 0"]
        .into_iter()
        .chain(parts)
    {
        let world = hallway();
        let mut app = app();
        let root = watch(&mut app, &world, trial(&world, 2));
        drive(&mut app, root, 100);
        step(&mut app, 2);
        let drawn = named(&mut app, name);
        app.world_mut().despawn(drawn[0]);
        for _ in 0..3 {
            drive(&mut app, root, 20);
            step(&mut app, 1);
        }
        assert_eq!(named(&mut app, name).len(), drawn.len(), "{name}");
        assert_eq!(named(&mut app, "trial view").len(), 1, "{name}");
        compare(&mut app, root);
    }
    // The world too is despawned here.
    let world = hallway();
    let mut app = app();
    let root = watch(&mut app, &world, trial(&world, 2));
    app.world_mut().entity_mut(root).despawn_children();
    step(&mut app, 3);
    assert_eq!(named(&mut app, "trial view").len(), 1);
}

/// A resource that exists when an app despawns its environments.
#[derive(Resource)]
struct Over;

#[test]
fn nothing_is_drawn_of_an_environment_that_is_despawned_in_the_same_frame() {
    let despawn = |worlds: Query<Entity, With<SpawnedOrigin>>, mut commands: Commands| {
        worlds.iter().for_each(|root| commands.entity(root).despawn());
    };
    for driven in [0, 100] {
        let world = hallway();
        let mut app = app();
        // Its commands are applied together with those that draw, and before them.
        app.add_systems(
            PostUpdate,
            despawn
                .run_if(resource_exists::<Over>)
                .after(TrialViewSystems::Hide)
                .before_ignore_deferred(TrialViewSystems::Draw),
        );
        let mut drawn = app.world_mut().query_filtered::<(), Or<(With<Sprite>, With<Mesh2d>)>>();
        if driven > 0 {
            let root = watch(&mut app, &world, trial(&world, 2));
            drive(&mut app, root, driven);
            step(&mut app, 1);
            assert!(drawn.iter(app.world()).count() > 0);
            drive(&mut app, root, 10 * driven);
        } else {
            let environment = Environment::prebuilt(world.clone());
            let environment = environment.with_pace(GenerationMode::Blocking);
            app.world_mut().spawn((environment, Flat(Some(trial(&world, 2)))));
        }
        app.insert_resource(Over);
        step(&mut app, 20);
        assert_eq!(app.world_mut().query::<&Flat>().iter(app.world()).count(), 0);
        assert_eq!(drawn.iter(app.world()).count(), 0);
        assert!(named(&mut app, "trial view").is_empty());
    }
}
