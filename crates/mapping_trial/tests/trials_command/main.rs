//! The command `envgen-trials`, as users run it.

mod command;
mod link;
mod score;

use envgen::certificate::{Claim, Verdict, verify};
use envgen::hallway::HallwaySpec;
use envgen::{Blueprint, Seed, Spec, World};
use mapping_trial::difficulty::{Anchors, Panel, measure, reference_scale};
use mapping_trial::experiment::Shard;
use mapping_trial::experiment::survey::SurveyFolder;
use serde_json::Value;

use command::{error, run};

#[test]
fn an_empty_room_measures_near_0_and_as_the_library_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let room = HallwaySpec { segments: 1, pitch: 8.3, width: 8.2, ..Default::default() };
    let world = room.generate(Seed(0)).expect("a room").to_world();
    let path = folder.path().join("room.json");
    std::fs::write(&path, world.to_json().expect("JSON")).expect("a file");
    let output = run(folder.path(), &["measure", "room.json", "--seeds", "1", "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let found =
        measure(&world, &Panel::reference(), reference_scale(), Seed(0), 1).expect("trials");
    let dials = &report["measurement"]["measured"]["dials"];
    assert_eq!(*dials, serde_json::json!(found.measured.dials));
    let difficulty = found.measured.dials.difficulty.value;
    assert!(difficulty.abs() < 0.5, "{difficulty}");
    let output = run(folder.path(), &["measure", "room.json", "--seeds", "1"]);
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(text.starts_with("hallway, seed 0: 12 trials of the panel \"reference\""), "{text}");
    assert!(text.contains("wall_follow, short"), "{text}");
}

#[test]
fn formats_that_cannot_hold_the_map_are_refused_before_the_trials() {
    let folder = tempfile::tempdir().expect("a folder");
    let generate = |more: &[&str]| {
        let arguments = [&["generate", "--set", "width=8", "--set", "height=8"][..], more].concat();
        let output = run(folder.path(), &arguments);
        (output.status.code(), String::from_utf8(output.stderr).expect("text"))
    };
    let (code, text) = generate(&["--set", "difficulty=5", "--out", "a.json", "--out", "a.asc"]);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("--out a.asc"), "{text}");
    let (code, text) =
        generate(&["--set", "difficulty=5", "--set", "difficulty=6", "--out", "a.json"]);
    assert!(code == Some(2) && text.contains("`difficulty` is set twice"), "{text}");
}

#[test]
fn bad_arguments_end_with_2_and_bad_worlds_with_1() {
    let folder = tempfile::tempdir().expect("a folder");
    let room = HallwaySpec { segments: 1, ..Default::default() };
    let world = room.generate(Seed(0)).expect("a room").to_world();
    std::fs::write(folder.path().join("room.ron"), world.to_ron().expect("RON")).expect("a file");
    std::fs::write(folder.path().join("bad.ron"), "(").expect("a file");
    let code = |world: &str, options: &[&str]| {
        let arguments = [&["measure", world][..], options].concat();
        run(folder.path(), &arguments).status.code()
    };
    for options in [
        ["--panel", "bad.ron"],
        ["--robot", "bad.ron"],
        ["--laser", "lidar"],
        ["--laser", "bad.ron"],
        ["--odometry", "bad.ron"],
        ["--time-per-area", "0"],
        ["--driver", ""],
    ] {
        assert_eq!(code("room.ron", &options), Some(2), "{options:?}");
    }
    // An endless file does not fill the memory.
    #[cfg(target_os = "linux")]
    assert_eq!(code("room.ron", &["--robot", "/dev/zero"]), Some(1));
    for options in
        [["--panel", "missing.ron"], ["--robot", "missing.ron"], ["--laser", "missing.ron"]]
    {
        assert_eq!(code("room.ron", &options), Some(1), "{options:?}");
    }
    assert_eq!(code("room.zip", &[]), Some(2));
    assert_eq!(code("bad.ron", &[]), Some(1));
    assert_eq!(code("missing.ron", &[]), Some(1));
}

#[test]
fn a_world_without_a_start_gets_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let room = HallwaySpec { segments: 1, pitch: 6.1, width: 6.0, ..Default::default() };
    let mut world = room.generate(Seed(0)).expect("a room").to_world();
    world.start = None;
    world.goal = None;
    world.certificate.clear();
    std::fs::write(folder.path().join("room.ron"), world.to_ron().expect("RON")).expect("a file");
    let output = run(folder.path(), &["measure", "room.ron", "--seeds", "1"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn mistakes_are_named_with_their_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    assert!(error(at, &["measure", "none.json"]).starts_with("error: none.json: "));
    std::fs::write(at.join("half.json"), "{\"schema\": 1").expect("a file");
    assert!(error(at, &["measure", "half.json"]).starts_with("error: half.json: "));
    let far = error(
        at,
        &[
            "generate",
            "--set",
            "difficulty=10",
            "--set",
            "width=6",
            "--set",
            "height=6",
            "--set",
            "floor_slip=1",
            "--set",
            "wheel_bias=0",
            "--out",
            "map.json",
        ],
    );
    assert!(far.contains("`difficulty` must be from "), "{far}");
    assert!(!at.join("map.json").exists());
    let bad = error(at, &["generate", "--set", "speed=1", "--out", "map.json"]);
    assert!(bad.starts_with("error: --set speed=1: kind indoor has no setting `speed`"), "{bad}");
    let ending = error(at, &["generate", "--out", "map.doc"]);
    assert!(ending.starts_with("error: --out map.doc: "), "{ending}");
    let twice = error(at, &["generate", "--out", "map.json", "--out", "./map.json"]);
    assert!(twice.contains("is the same file as --out map.json"), "{twice}");
    let laser = error(at, &["anchors", "--laser", "far"]);
    let expected = "error: --laser far: `laser` must be one of lms200_mm, ";
    assert!(laser.starts_with(expected), "{laser}");
    std::fs::write(at.join("panel.ron"), "(name: \"mine\", version: 1, conditions: [(nam: 1)])")
        .expect("a file");
    let panel = error(at, &["anchors", "--panel", "panel.ron"]);
    assert!(panel.starts_with("error: panel.ron: ") && panel.contains("nam"), "{panel}");
    std::fs::write(at.join("panel.ron"), "(name: \"mine\", version: 1, conditions: [])")
        .expect("a file");
    let empty = error(at, &["anchors", "--panel", "panel.ron"]);
    assert!(
        empty.contains("`conditions` must be one or more") && empty.contains(", got none"),
        "{empty}"
    );
}

#[test]
fn maps_are_made_for_the_robot_that_is_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let robot = |radius: f64| format!("(length: 0.6, width: 0.6, circumscribed_radius: {radius})");
    std::fs::write(at.join("large.ron"), robot(0.55)).expect("a file");
    std::fs::write(at.join("larger.ron"), robot(1.36)).expect("a file");
    let condition = "(name: \"nearest\", time_limit: 8)";
    let panel = format!("(name: \"mine\", version: 1, conditions: [{condition}])");
    std::fs::write(at.join("panel.ron"), panel).expect("a file");
    let size = ["--set", "width=6", "--set", "height=6", "--out", "map.json"];
    let with =
        |robot| [&["generate", "--robot", robot, "--panel", "panel.ron"], &size[..]].concat();
    // What is not possible is rejected before any trial.
    let text = error(at, &with("larger.ron"));
    assert!(text.starts_with("error: `robot_radius` must be at most 1.335 m, got 1.36"), "{text}");
    assert!(text.ends_with("; it is that of the panel's largest robot\n"), "{text}");
    let narrow = error(at, &[&with("large.ron")[..], &["--set", "doorway=1"]].concat());
    assert!(
        narrow.contains("it must pass a doorway of 1 m; it is that of the panel's"),
        "{narrow}"
    );
    let own = ["--set", "doorway=1", "--set", "footprint=0.5"];
    let own = error(at, &[&with("large.ron")[..], &own].concat());
    assert!(own.ends_with("got 0.5: it must pass a doorway of 1 m\n"), "{own}");
    assert!(!at.join("out").exists());

    let output = run(at, &with("large.ron"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let world = std::fs::read_to_string(at.join("map.json")).expect("a map");
    let world = World::from_json(&world).expect("a world");
    assert_eq!(world.provenance.spec["robot_radius"], 0.55);
    let fits = |claim: &Claim| matches!(claim, Claim::EveryPlaceReachable { radius: 0.55 });
    assert!(world.certificate.iter().any(fits), "{:?}", world.certificate);
    for (claim, verdict) in verify(&world) {
        assert_eq!(verdict, Verdict::Holds, "{claim}");
    }
}

/// A driver in sh that answers each observation with the line in the file `answer`.
#[cfg(unix)]
const DRIVER: &str = r#"read hello; echo '{"protocol": "envgen-driver 1", "name": "sh"}'
read answer < answer; while read line; do echo "$answer"; done"#;

/// A folder with a room, a panel of one condition of eight seconds, and the driver.
#[cfg(unix)]
fn folder_with_driver(answer: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("a file");
    };
    let room = HallwaySpec { segments: 1, pitch: 8.3, width: 8.2, ..Default::default() };
    let world = room.generate(Seed(0)).expect("a room").to_world();
    write("room.json", &world.to_json().expect("JSON"));
    let condition = |name: &str| format!("(name: \"{name}\", operator: {name}, time_limit: 8)");
    let both = format!("{}, {}", condition("nearest"), condition("cautious"));
    write("panel.ron", &format!("(name: \"mine\", version: 1, conditions: [{both}])"));
    write("driver.sh", DRIVER);
    write("answer", &format!("{answer}\n"));
    folder
}

#[test]
#[cfg(unix)]
fn a_driver_of_your_own_takes_the_place_of_the_policies() {
    let folder = folder_with_driver(r#"{"finished": true}"#);
    let at = folder.path();
    let with = |driver| {
        ["measure", "room.json", "--seeds=1", "--json", "--panel=panel.ron", "--driver", driver]
    };
    let measured = |driver| -> Value {
        let output = run(at, &with(driver));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("JSON")
    };
    let folders = || std::fs::read_dir(at.join("out")).map_or(0, Iterator::count);
    let found = measured("sh driver.sh");
    // Policies that do not drive make no further conditions.
    let conditions = &found["measurement"]["conditions"];
    assert_eq!(conditions.as_array().map(Vec::len), Some(1), "{conditions}");
    assert_eq!((&conditions[0]["explored"], folders()), (&Value::from(1), 1));
    assert_eq!(found["measurement"]["measured"]["panel"], "mine, driver sh driver.sh");
    assert_eq!(conditions[0]["condition"], "driver");
    // An empty room is an anchor, also on the scale of a driver that never moves.
    let difficulty = found["measurement"]["measured"]["dials"]["difficulty"]["value"].as_f64();
    assert!(difficulty.is_some_and(|value| value.abs() < 0.5), "{difficulty:?}");
    assert_eq!((measured("sh driver.sh"), folders()), (found, 1));
    // Another command may be another driver: its scale is measured.
    measured("sh driver.sh --again");
    assert_eq!(folders(), 2);
    // The driver now behaves differently than when the scale was measured.
    std::fs::write(at.join("answer"), "{\"speed\": 0.4, \"turn_rate\": 0}\n").expect("a file");
    let changed = error(at, &with("sh driver.sh"));
    assert!(changed.contains("another version of this program or of a driver"), "{changed}");
}

#[test]
#[cfg(unix)]
fn maps_are_made_for_a_driver() {
    let folder = folder_with_driver(r#"{"finished": true}"#);
    let make = [
        "generate",
        "--panel=panel.ron",
        "--driver=sh driver.sh",
        "--set=width=6",
        "--set=height=6",
    ];
    let output = run(folder.path(), &[&make[..], &["--out=map.json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let world = std::fs::read_to_string(folder.path().join("map.json")).expect("a map");
    let world = World::from_json(&world).expect("a world");
    let measured = world.provenance.measured.expect("a measurement");
    assert_eq!((measured.panel.as_str(), measured.trials), ("mine, driver sh driver.sh", 1));
}

#[test]
#[cfg(unix)]
fn a_driver_that_fails_leaves_no_trial() {
    let folder = folder_with_driver(r#"{"speed": "fast"}"#);
    let at = folder.path();
    let with = |driver: &str| error(at, &["anchors", "--panel=panel.ron", "--driver", driver]);
    let text = with("sh 'driver.sh");
    assert_eq!(text, "error: --driver sh 'driver.sh: a quote is not closed\n");
    assert_eq!(with(" "), "error: --driver  : names no program\n");
    assert!(!at.join("out").exists());
    let text = with("no such program");
    assert!(text.contains("condition driver: the driver failed: it cannot be started: "), "{text}");
    let text = with("sh driver.sh");
    assert!(text.contains("the driver failed: a line that is not an answer"), "{text}");
    assert!(text.contains("`speed`"), "{text}");
    let trials = |folder: std::io::Result<std::fs::DirEntry>| {
        std::fs::read_to_string(folder.expect("a folder").path().join("trials.jsonl"))
    };
    for text in std::fs::read_dir(at.join("out")).expect("a folder").map(trials) {
        assert_eq!(text.expect("a file"), "");
    }
    // It is no property of a world, either, that a driver fails in it.
    let measure =
        ["measure", "room.json", "--panel=panel.ron", "--driver=sh driver.sh", "--anchors=anchors"];
    assert!(error(at, &measure).contains("the driver failed: a line that is not an answer"));
    // Whether a trial can begin is known before the anchors are measured.
    let (unknown, folder) = ("--driver=no such program", "--anchors=new");
    let text = error(at, &["measure", "room.json", "--panel=panel.ron", unknown, folder]);
    assert!(text.contains("condition \"driver\" of the panel: it cannot be started: "), "{text}");
    assert!(text.starts_with("error: room.json: ") && !at.join("new").exists(), "{text}");
}

#[test]
fn unfinished_and_foreign_atlases_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let missing = error(at, &["calibrate", "--anchors", "anchors", "--out", "new.json"]);
    assert_eq!(missing, "error: anchors: there is no such folder\n");
    let survey = Anchors::first().survey(&Panel::reference(), 1);
    drop(SurveyFolder::open(&at.join("anchors"), &survey, Shard::WHOLE).expect("a folder"));
    let unfinished = error(at, &["calibrate", "--anchors", "anchors", "--out", "new.json"]);
    assert_eq!(unfinished, "error: anchors: 0 of 480 trials are finished\n");
    let head = at.join("anchors").join("survey.json");
    let text = std::fs::read_to_string(&head).expect("a head");
    std::fs::write(&head, text.replacen("\"version\": 2", "\"version\": 1", 1)).expect("a head");
    let other = error(at, &["calibrate", "--anchors", "anchors", "--out", "new.json"]);
    assert!(other.contains("a survey of version 1, expected 2"), "{other}");
    // The built-in scale needs no anchors.
    let missing = error(at, &["calibrate", "--built-in-scale", "--atlas=none", "--out=new.json"]);
    assert!(missing.starts_with("error: none/survey.json: this file does not exist"), "{missing}");
    assert!(!at.join("new.json").exists());
}
