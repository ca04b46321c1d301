//! Environments of every kind are spawned, changed and removed.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_envgen::Tile;
use bevy_envgen::envgen::forest::ForestSpec;
use bevy_envgen::envgen::hallway::HallwaySpec;
use bevy_envgen::envgen::indoor::IndoorSpec;
use bevy_envgen::envgen::world::{Contents, Digest};
use bevy_envgen::envgen::{Blueprint, Seed, Spec, WorldSpec};
use bevy_envgen::part::{Goal, Ground, Start, Surface};
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{
    digest, in_rapier, parts, spawn_ready, step, test_app, truth, wait_until_ready,
};

use super::{spawned, specs};

fn count<C: Component>(app: &mut App) -> usize {
    app.world_mut().query::<&C>().iter(app.world()).count()
}

#[test]
fn every_kind_spawns_each_part_of_its_world() {
    for spec in specs() {
        let mut app = test_app();
        let root = spawn_ready(&mut app, Environment::new(spec.clone(), 3)).unwrap();
        let truth = truth(&app, root);
        assert_eq!(**truth, spec.generate(Seed(3)).unwrap().to_world());
        assert_eq!(count::<Wall>(&mut app), truth.walls.len());
        assert_eq!(count::<Tree>(&mut app), truth.trees.len());
        assert_eq!(count::<RoadStrip>(&mut app), truth.road_strips.len());
        assert_eq!(count::<Room>(&mut app), truth.rooms.len());
        assert_eq!(count::<Doorway>(&mut app), truth.doorways.len());
        assert_eq!(count::<Obstacle>(&mut app), truth.obstacles.len());
        assert_eq!(count::<Surface>(&mut app), truth.surfaces.len());
        assert_eq!(count::<Start>(&mut app), truth.start.iter().len());
        assert_eq!(count::<Goal>(&mut app), truth.goal.iter().len());
        assert_eq!(count::<Victim>(&mut app), truth.victims.len());
        let mut cells = app.world_mut().query::<&Ground>();
        let cells: usize = cells.iter(app.world()).map(|ground| ground.classes.len()).sum();
        assert_eq!(cells, truth.raster.as_ref().map_or(0, |raster| raster.cells.len()));
        let all = count::<PartId>(&mut app);
        assert!(all > 10, "{spec:?}");
        assert_eq!(parts(&app, root).len(), all);
        let stats = app.world().get::<EnvironmentStats>(root).unwrap();
        assert_eq!(stats.parts, Some(all));
        // The ids are unique, and every part has a name.
        assert!(parts(&app, root).windows(2).all(|pair| pair[0].id < pair[1].id));
        let mut named = app.world_mut().query::<(&PartId, &Name)>();
        assert!(named.iter(app.world()).all(|(id, name)| name.as_str() == id.to_string()));
    }
}

#[test]
fn the_same_seed_gives_the_same_parts_and_another_seed_others() {
    for spec in specs() {
        let spawn = |seed: u64| {
            let mut app = test_app();
            let root = spawn_ready(&mut app, Environment::new(spec.clone(), seed)).unwrap();
            (parts(&app, root), digest(&app, root))
        };
        let (first, again, other) = (spawn(5), spawn(5), spawn(6));
        assert_eq!(first, again, "{spec:?}");
        assert_ne!(first.1, other.1, "{spec:?}");
    }
}

/// The parts of fixed specs and seeds, which are frozen. A change here is **value-breaking** for users who
/// compare runs, unless the value version of the kind is raised with it.
#[test]
fn digests_are_frozen() {
    let frozen = [
        "7c86f9c0cde21a69",
        "660be5f6f1c81cc6",
        "dc4938931aed060d",
        "62f2a41b5a2c6bf6",
        "ae1bdcda4143791b",
        "005b2c1996ddbee4",
        "fd5bd8f55df27ab0",
        "5dfa90aaaed50512",
        "67a801cb6d5cc72c",
    ];
    let mut found = Vec::new();
    for spec in specs() {
        let mut app = test_app();
        let root = spawn_ready(&mut app, Environment::new(spec, 1)).unwrap();
        found.push(digest(&app, root).to_string()[..16].to_owned());
    }
    assert_eq!(found, frozen);
}

#[test]
fn parts_lie_where_the_world_says() {
    let mut app = test_app();
    let environment = Environment::new(ForestSpec::default(), 1);
    let root = app.world_mut().spawn(environment).id();
    let at = Transform::from_xyz(30.0, -20.0, 0.0)
        .with_rotation(Quat::from_rotation_z(0.7))
        .with_scale(Vec3::splat(2.0));
    app.world_mut().entity_mut(root).insert(at);
    wait_until_ready(&mut app, root).unwrap();
    step(&mut app, 1);
    let truth = truth(&app, root);
    let mut trees = app.world_mut().query::<(&PartId, &GlobalTransform, &Tree)>();
    for (id, global, tree) in trees.iter(app.world()) {
        let exact = &truth.trees[id.index as usize];
        let there = at.transform_point(exact.center.as_vec2().extend(0.0));
        assert!(global.translation().distance(there) < 1e-4);
        assert_eq!(tree.radius, exact.radius as f32);
    }
}

#[test]
fn changing_the_component_rebuilds_and_keeps_what_is_not_ours() {
    let mut app = test_app();
    let root = spawn_ready(&mut app, Environment::new(HallwaySpec::default(), 1)).unwrap();
    let pet = app.world_mut().spawn((Name::new("robot"), ChildOf(root))).id();
    let first = digest(&app, root);

    app.world_mut().get_mut::<Environment>(root).unwrap().seed = 2;
    wait_until_ready(&mut app, root).unwrap();
    let second = digest(&app, root);
    assert_ne!(first, second);
    assert_eq!(app.world().get::<ChildOf>(pet).unwrap().parent(), root);

    // Inserting another environment is a change too. Marking it as changed without a change is not.
    app.world_mut().entity_mut(root).insert(Environment::new(HallwaySpec::default(), 1));
    wait_until_ready(&mut app, root).unwrap();
    assert_eq!(digest(&app, root), first);
    let tiles: Vec<Entity> = {
        let mut tiles = app.world_mut().query_filtered::<Entity, With<Tile>>();
        tiles.iter(app.world()).collect()
    };
    app.world_mut().get_mut::<Environment>(root).unwrap().set_changed();
    step(&mut app, 3);
    let mut now = app.world_mut().query_filtered::<Entity, With<Tile>>();
    assert_eq!(now.iter(app.world()).collect::<Vec<_>>(), tiles);

    // On request, the world is generated again even so.
    app.world_mut().trigger(RebuildEnvironment { entity: root });
    step(&mut app, 2);
    assert_eq!(digest(&app, root), first);
    let mut now = app.world_mut().query_filtered::<Entity, With<Tile>>();
    assert_ne!(now.iter(app.world()).collect::<Vec<_>>(), tiles);
}

#[test]
fn despawning_or_removing_leaves_nothing_behind() {
    for spec in specs() {
        let mut app = test_app();
        let before = (spawned(&mut app), in_rapier(&mut app));
        for remove in [false, true] {
            let root = spawn_ready(&mut app, Environment::new(spec.clone(), 4)).unwrap();
            step(&mut app, 3);
            assert!(spawned(&mut app) > 10);
            if remove {
                app.world_mut().entity_mut(root).remove::<Environment>();
                step(&mut app, 1);
                let left = app.world().entity(root);
                assert!(!left.contains::<GroundTruth>() && !left.contains::<EnvironmentState>());
            } else {
                app.world_mut().entity_mut(root).despawn();
            }
            step(&mut app, 3);
            assert_eq!((spawned(&mut app), in_rapier(&mut app)), before, "{spec:?}");
        }
    }
}

#[test]
fn forty_rebuilds_leak_nothing() {
    let mut app = test_app();
    let spec = WorldSpec::from(HallwaySpec { door_frame_rate: 0.2, ..Default::default() });
    let indoor = specs().into_iter().find(|spec| spec.kind().name() == "indoor").unwrap();
    let hallway = spawn_ready(&mut app, Environment::new(spec, 0)).unwrap();
    let indoor = spawn_ready(&mut app, Environment::new(indoor, 0)).unwrap();
    let moving = ScenarioSpec { doors: 1.0, people: 3, smoke: 0.1, ..default() };
    app.world_mut().entity_mut(indoor).insert(EnvironmentScenario::new(moving, 1));
    step(&mut app, 2);
    let entities = |app: &App| app.world().entities().count_spawned();
    let first = (spawned(&mut app), in_rapier(&mut app), entities(&app));
    assert!(first.1.1 > 10, "the indoor map has doors and people");
    let mut archetypes = 0;
    for round in 0..40 {
        for root in [hallway, indoor] {
            app.world_mut().trigger(RebuildEnvironment { entity: root });
        }
        step(&mut app, 1);
        if round == 1 {
            archetypes = app.world().archetypes().len();
        }
    }
    step(&mut app, 2);
    assert_eq!((spawned(&mut app), in_rapier(&mut app), entities(&app)), first);
    assert_eq!(app.world().archetypes().len(), archetypes);
}

#[test]
fn both_paces_give_the_same_world_and_events() {
    #[derive(Resource, Default)]
    struct Ready(Vec<Entity>);
    let mut digests = Vec::new();
    for pace in [GenerationMode::Blocking, GenerationMode::Async] {
        let mut app = test_app();
        app.init_resource::<Ready>();
        app.add_observer(|ready: On<EnvironmentReady>, mut all: ResMut<Ready>| {
            all.0.push(ready.entity);
        });
        let environment = Environment::new(ForestSpec::default(), 8).with_pace(pace);
        let root = app.world_mut().spawn(environment).id();
        if pace == GenerationMode::Blocking {
            app.update();
            assert_eq!(app.world().get(root), Some(&EnvironmentState::Ready));
        } else {
            wait_until_ready(&mut app, root).unwrap();
        }
        step(&mut app, 3);
        assert_eq!(app.world().resource::<Ready>().0, [root]);
        digests.push(digest(&app, root));
    }
    assert_eq!(digests[0], digests[1]);
}

#[test]
fn worlds_that_exist_are_spawned_as_they_are() {
    let mut app = test_app();
    let mut world = HallwaySpec::default().generate_world(3);
    world.walls.truncate(7);
    world.certificate.clear();
    let root = spawn_ready(&mut app, Environment::prebuilt(world.clone())).unwrap();
    assert_eq!(**truth(&app, root), world);
    assert_eq!(count::<Wall>(&mut app), 7);
}

#[test]
fn far_from_the_origin_another_origin_keeps_the_millimetre() {
    use bevy_envgen::envgen::glam::DVec2;
    let far = DVec2::new(3e6, -2e6);
    let mut world = ForestSpec::default().generate_world(1);
    let near = world.clone();
    world.bounds.min += far;
    world.bounds.max += far;
    for pose in [&mut world.start, &mut world.goal].into_iter().flatten() {
        pose.position += far;
    }
    for tree in &mut world.trees {
        tree.center += far;
    }
    world.certificate.clear();
    let mut app = test_app();
    let environment = Environment::prebuilt(world).with_origin(far);
    let root = spawn_ready(&mut app, environment).unwrap();
    for part in parts(&app, root).iter().filter(|part| part.id.kind == bevy_envgen::PartKind::Tree)
    {
        let exact = near.trees[part.id.index as usize].center;
        assert!(part.transform.translation.truncate().as_dvec2().distance(exact) < 1e-3);
    }
}

#[test]
fn many_parts_are_spawned_once_and_merged() {
    let mut app = test_app();
    let spec = ForestSpec { width: 200.0, height: 200.0, intensity: 0.2, radius: 0.2, ..default() };
    let root = spawn_ready(&mut app, Environment::new(spec, 1)).unwrap();
    step(&mut app, 1);
    let trees = truth(&app, root).trees.len();
    assert!(trees > 7000);
    assert_eq!(count::<Tree>(&mut app), trees);
    let (colliders, _) = in_rapier(&mut app);
    assert!((10..trees / 100).contains(&colliders), "{colliders}");
    let shown: Digest = digest(&app, root);
    app.world_mut().trigger(RebuildEnvironment { entity: root });
    step(&mut app, 1);
    wait_until_ready(&mut app, root).unwrap();
    assert_eq!(digest(&app, root), shown);
}

#[test]
fn solids_as_data_are_the_same_parts_and_no_entities() {
    for spec in specs() {
        let mut app = test_app();
        let before = (spawned(&mut app), in_rapier(&mut app));
        let entities = spawn_ready(&mut app, Environment::new(spec.clone(), 3)).unwrap();
        let expected = parts(&app, entities);
        app.world_mut().despawn(entities);
        let environment = Environment::new(spec.clone(), 3).with_solids(SolidStorage::TileData);
        let root = spawn_ready(&mut app, environment).unwrap();
        step(&mut app, 2);
        assert_eq!(parts(&app, root), expected, "{spec:?}");
        let solids = expected.iter().filter(|part| part.id.kind.is_solid()).count();
        assert_eq!(count::<PartId>(&mut app), expected.len() - solids);
        assert_eq!(count::<TileSolids>(&mut app) > 0, solids > 0);

        // If requested, they become entities again, and nothing is left of the other form.
        app.world_mut().get_mut::<Environment>(root).unwrap().solids = SolidStorage::Entities;
        wait_until_ready(&mut app, root).unwrap();
        assert_eq!((count::<TileSolids>(&mut app), parts(&app, root)), (0, expected));
        app.world_mut().get_mut::<Environment>(root).unwrap().solids = SolidStorage::TileData;
        wait_until_ready(&mut app, root).unwrap();
        app.world_mut().entity_mut(root).remove::<Environment>();
        step(&mut app, 3);
        assert_eq!((spawned(&mut app), in_rapier(&mut app)), before, "{spec:?}");
    }
}

trait GenerateWorld {
    fn generate_world(self, seed: u64) -> bevy_envgen::envgen::World;
}

impl<S: Into<WorldSpec>> GenerateWorld for S {
    fn generate_world(self, seed: u64) -> bevy_envgen::envgen::World {
        self.into().generate(Seed(seed)).unwrap().to_world()
    }
}

/// A world that is shared is not copied.
#[test]
fn a_shared_world_stays_shared() {
    let mut app = test_app();
    let world = Arc::new(HallwaySpec::default().generate_world(3));
    let root = spawn_ready(&mut app, Environment::prebuilt(Arc::clone(&world))).unwrap();
    assert!(Arc::ptr_eq(&truth(&app, root).0, &world));
}

#[test]
fn rooms_tell_what_was_taken_out_of_them() {
    let mut world = IndoorSpec::default().generate(Seed(4)).unwrap().to_world();
    let all = [Contents::Emptied, Contents::Cleared, Contents::AsDesigned];
    for (room, contents) in world.rooms.iter_mut().zip(all.into_iter().cycle()) {
        room.contents = contents;
    }
    let mut app = test_app();
    spawn_ready(&mut app, Environment::prebuilt(world.clone())).unwrap();
    let mut rooms = app.world_mut().query::<(&PartId, &Room)>();
    assert!(rooms.iter(app.world()).count() >= 3);
    for (id, room) in rooms.iter(app.world()) {
        assert_eq!(room.contents, world.rooms[id.index as usize].contents);
    }
}
