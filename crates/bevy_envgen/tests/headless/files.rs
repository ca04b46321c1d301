//! Specs and rooms in files, and what happens when they change.

use std::fs;
use std::time::Duration;

use bevy::prelude::*;
use bevy_envgen::asset::WorldAsset;
use bevy_envgen::envgen::indoor::Catalogue;
use bevy_envgen::envgen::{Seed, World as EnvgenWorld, WorldSpec};
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{spawn_ready, step, test_app, test_app_in, truth, wait_until_ready};
use bevy_envgen::{EnvironmentError, EnvironmentState};

use super::assets;

const CELL: &str = "(name: \"cell\", width: 2, height: 2, difficulty: 5)";

fn environment(app: &App, path: &str, seed: u64) -> Environment {
    let handle = app.world().resource::<AssetServer>().load(path.to_owned());
    Environment::from_asset(handle, seed)
}

fn world_of(text: &str, seed: u64) -> EnvgenWorld {
    WorldSpec::from_ron(text).unwrap().generate(Seed(seed)).unwrap().to_world()
}

/// Runs frames until a condition is true, for at most ten seconds.
fn wait_for(app: &mut App, what: &str, mut holds: impl FnMut(&mut App) -> bool) {
    for _ in 0..10_000 {
        step(app, 1);
        if holds(app) {
            return;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    panic!("{what} did not happen in ten seconds");
}

#[derive(Resource, Default)]
struct Failures(Vec<EnvironmentError>);

fn record_failures(app: &mut App) {
    app.init_resource::<Failures>();
    app.add_observer(|failed: On<EnvironmentFailed>, mut failures: ResMut<Failures>| {
        failures.0.push(failed.error.clone());
    });
}

#[test]
fn every_world_of_the_project_is_an_asset() {
    let folder = assets().join("worlds");
    let mut count = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let mut app = test_app_in(&assets());
        let asked = environment(&app, &format!("worlds/{name}"), 1);
        let root = spawn_ready(&mut app, asked).unwrap_or_else(|error| panic!("{name}: {error}"));
        let text = fs::read_to_string(folder.join(&name)).unwrap();
        assert_eq!(**truth(&app, root), world_of(&text, 1), "{name}");
        count += 1;
    }
    assert!(count >= 10);
}

#[test]
fn a_file_that_changes_changes_the_world_and_a_broken_one_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("hall.envgen.ron");
    fs::write(&file, "Hallway(segments: 20)").unwrap();
    let mut app = test_app_in(folder.path());
    record_failures(&mut app);
    let asked = environment(&app, "hall.envgen.ron", 3);
    let root = spawn_ready(&mut app, asked).unwrap();
    let first = truth(&app, root);
    assert_eq!(**first, world_of("Hallway(segments: 20)", 3));

    fs::write(&file, "Hallway(segments: 40)").unwrap();
    wait_for(&mut app, "the change", |app| truth(app, root).walls.len() > first.walls.len());
    assert_eq!(**truth(&app, root), world_of("Hallway(segments: 40)", 3));
    assert_eq!(app.world().get(root), Some(&EnvironmentState::Ready));
    assert!(app.world().resource::<Failures>().0.is_empty());

    // A broken file and an invalid spec are reported, and the last world is kept.
    for (text, says) in [("Hallway(segments: 4", "1:"), ("Hallway(p_st: 1.5)", "p_st")] {
        fs::write(&file, text).unwrap();
        wait_for(&mut app, text, |app| {
            let failures = &app.world().resource::<Failures>().0;
            failures.last().is_some_and(|error| error.to_string().contains(says))
        });
        let error = app.world().resource::<Failures>().0.last().unwrap().to_string();
        assert!(error.contains("hall.envgen.ron"), "{error}");
        assert_eq!(**truth(&app, root), world_of("Hallway(segments: 40)", 3));
        assert_eq!(app.world().get(root), Some(&EnvironmentState::Failed));
    }

    // Undoing a mistake gives the same spec as before.
    fs::write(&file, "Hallway(segments: 40)").unwrap();
    let is_ready = |app: &mut App| app.world().get(root) == Some(&EnvironmentState::Ready);
    wait_for(&mut app, "the repair", is_ready);
    let reported = app.world().resource::<Failures>().0.len();
    fs::write(&file, "Hallway(segments: 4").unwrap();
    wait_for(&mut app, "the mistake", |app| app.world().resource::<Failures>().0.len() > reported);
    fs::write(&file, "Hallway(segments: 40)").unwrap();
    wait_for(&mut app, "the undone mistake", is_ready);
    assert_eq!(**truth(&app, root), world_of("Hallway(segments: 40)", 3));

    fs::write(&file, "Forest(intensity: 0.02)").unwrap();
    wait_for(&mut app, "the other world", |app| !truth(app, root).trees.is_empty());
    assert_eq!(app.world().get(root), Some(&EnvironmentState::Ready));
}

#[test]
fn a_spec_depends_on_the_rooms_that_it_names() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("rooms")).unwrap();
    let room = folder.path().join("rooms/cell.room.ron");
    fs::write(&room, CELL).unwrap();
    let text = "Indoor(rooms: [\"rooms/cell.room.ron\"])";
    fs::write(folder.path().join("map.envgen.ron"), text).unwrap();
    let mut app = test_app_in(folder.path());
    record_failures(&mut app);
    let asked = environment(&app, "map.envgen.ron", 3);
    let root = spawn_ready(&mut app, asked).unwrap();
    let rooms = |app: &App| truth(app, root).rooms.clone();
    assert!(!rooms(&app).is_empty());
    assert!(rooms(&app).iter().all(|room| room.name == "cell" && room.lit));

    // When the file of the room changes, the map changes too.
    fs::write(&room, CELL.replace("difficulty: 5", "difficulty: 5, lit: false")).unwrap();
    wait_for(&mut app, "the change", |app| rooms(app).iter().all(|room| !room.lit));

    fs::write(&room, CELL.replace("width: 2", "width: 0")).unwrap();
    wait_for(&mut app, "the failure", |app| !app.world().resource::<Failures>().0.is_empty());
    let error = app.world().resource::<Failures>().0[0].to_string();
    assert!(error.contains("map.envgen.ron") && error.contains("cell.room.ron"), "{error}");
    assert!(error.contains("cells, got 0 by 2"), "{error}");
    assert!(!rooms(&app).is_empty());
}

#[test]
fn a_spec_is_loaded_once_its_rooms_are_there() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("rooms")).unwrap();
    let room = |name: &str| folder.path().join(format!("rooms/{name}.room.ron"));
    let text = "Indoor(rooms: [\"rooms/cell.room.ron\", \"rooms/den.room.ron\"])";
    fs::write(folder.path().join("map.envgen.ron"), text).unwrap();
    // One room is broken, and the other one is missing.
    fs::write(room("cell"), CELL.replace("width: 2", "width: 0")).unwrap();
    let mut app = test_app_in(folder.path());
    record_failures(&mut app);
    let asked = environment(&app, "map.envgen.ron", 3);
    let root = app.world_mut().spawn(asked).id();
    let failures = |app: &mut App| app.world().resource::<Failures>().0.len();
    wait_for(&mut app, "the first failure", |app| failures(app) == 1);
    fs::write(room("cell"), CELL).unwrap();
    wait_for(&mut app, "the second failure", |app| failures(app) > 1);
    let error = app.world().resource::<Failures>().0[1].to_string();
    assert!(error.contains("den.room.ron"), "{error}");
    fs::write(room("den"), CELL.replace("cell", "den")).unwrap();
    let is_ready = |app: &mut App| app.world().get(root) == Some(&EnvironmentState::Ready);
    wait_for(&mut app, "the world", is_ready);
    assert!(truth(&app, root).rooms.iter().all(|room| ["cell", "den"].contains(&&*room.name)));
}

#[test]
fn rooms_are_assets_of_their_own() {
    let mut app = test_app_in(&assets());
    let server = app.world().resource::<AssetServer>();
    let room: Handle<RoomAsset> = server.load("rooms/dark.room.ron");
    wait_for(&mut app, "the room", |app| {
        app.world().resource::<Assets<RoomAsset>>().get(&room).is_some()
    });
    let design = &app.world().resource::<Assets<RoomAsset>>().get(&room).unwrap().design;
    assert_eq!(Some(design), Catalogue::builtin().get("dark").map(|room| &**room));
}

#[test]
fn files_that_are_missing_too_long_or_no_text_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    write("binary.envgen.ron", &[0xff, 0xfe, 0x00]);
    write("long.envgen.ron", &vec![b' '; bevy_envgen::asset::MAX_FILE_BYTES + 1]);
    write("deep.envgen.ron", "[".repeat(100_000).as_bytes());
    write("lost.envgen.ron", b"Indoor(rooms: [\"no.room.ron\"])");
    write("empty.envgen.ron", b"");
    write("twice.envgen.ron", b"Hallway()Hallway()");
    for name in ["missing", "binary", "long", "deep", "lost", "empty", "twice"] {
        let mut app = test_app_in(folder.path());
        let asked = environment(&app, &format!("{name}.envgen.ron"), 3);
        let error = spawn_ready(&mut app, asked.clone()).unwrap_err();
        assert!(matches!(error, EnvironmentError::Asset { .. }), "{name}: {error}");
        assert!(error.to_string().contains(&format!("{name}.envgen.ron")), "{error}");
        // A second request fails as well, although the server reports the failure only once.
        let error = spawn_ready(&mut app, asked).unwrap_err();
        assert!(matches!(error, EnvironmentError::Asset { .. }), "{name}: {error}");
        let fine = Environment::new(WorldSpec::from_ron("Hallway()").unwrap(), 1);
        spawn_ready(&mut app, fine).unwrap();
    }
}

#[test]
fn an_asset_that_vanishes_is_reported_and_the_world_stays() {
    let mut app = test_app_in(&assets());
    record_failures(&mut app);
    let asked = environment(&app, "worlds/paper_forest.envgen.ron", 1);
    let handle = app.world().resource::<AssetServer>().load("worlds/paper_forest.envgen.ron");
    let root = spawn_ready(&mut app, asked).unwrap();
    let trees = truth(&app, root).trees.len();
    app.world_mut().resource_mut::<Assets<WorldAsset>>().remove(&handle);
    step(&mut app, 3);
    let failures = &app.world().resource::<Failures>().0;
    assert_eq!(failures.len(), 1, "{failures:?}");
    assert!(failures[0].to_string().contains("paper_forest.envgen.ron"), "{}", failures[0]);
    assert_eq!(truth(&app, root).trees.len(), trees);
}

#[test]
fn assets_made_in_code_are_followed() {
    let mut app = test_app();
    let asset = |text: &str| WorldAsset { spec: WorldSpec::from_ron(text).unwrap() };
    let handle = app.world().resource::<Assets<WorldAsset>>().reserve_handle();
    let root = app.world_mut().spawn(Environment::from_asset(handle.clone(), 3)).id();
    step(&mut app, 5);
    assert_eq!(app.world().get(root), Some(&EnvironmentState::Waiting));
    let mut assets = app.world_mut().resource_mut::<Assets<WorldAsset>>();
    assets.insert(&handle, asset("Hallway(segments: 10)")).unwrap();
    wait_until_ready(&mut app, root).unwrap();
    let first = truth(&app, root);
    let mut assets = app.world_mut().resource_mut::<Assets<WorldAsset>>();
    assets.get_mut(&handle).unwrap().spec = asset("Hallway(segments: 30)").spec;
    step(&mut app, 3);
    let second = truth(&app, root).walls.len();
    assert!(second > first.walls.len());
    // An asset that is removed and added again in the same frame has not vanished, whether it is equal or not.
    record_failures(&mut app);
    for (segments, is_larger) in [(30, false), (60, true)] {
        let mut assets = app.world_mut().resource_mut::<Assets<WorldAsset>>();
        assets.remove(&handle);
        assets.insert(&handle, asset(&format!("Hallway(segments: {segments})"))).unwrap();
        step(&mut app, 3);
        assert!(app.world().resource::<Failures>().0.is_empty());
        assert_eq!(app.world().get(root), Some(&EnvironmentState::Ready));
        assert_eq!(truth(&app, root).walls.len() > second, is_larger);
    }
}
