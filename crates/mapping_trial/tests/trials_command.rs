//! The command `envgen-trials`, as users run it.

use std::path::Path;
use std::process::{Command, Output};

use envgen::certificate::{Claim, Verdict, verify};
use envgen::export::ros_map::RosMap;
use envgen::hallway::HallwaySpec;
use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec, World};
use mapping_trial::backend::TICK;
use mapping_trial::difficulty::{Anchors, Panel, measure, reference_scale};
use mapping_trial::experiment::Shard;
use mapping_trial::experiment::survey::SurveyFolder;
use mapping_trial::feedback::Rating;
use mapping_trial::policy::PolicyKind;
use mapping_trial::score::MapScores;
use mapping_trial::trial::{Trial, TrialReport, TrialSettings};
use mapping_trial::tum::{self, TimedPose};
use serde_json::Value;

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_envgen-trials"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the command runs")
}

fn error(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert!(!output.status.success(), "{arguments:?}");
    String::from_utf8(output.stderr).expect("text")
}

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
#[cfg(target_os = "linux")]
fn a_reader_that_is_gone_is_no_error_and_a_full_disk_is_one() {
    let folder = tempfile::tempdir().expect("a folder");
    trial_in(folder.path());
    let score = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_envgen-trials"));
        command.args("score --map map.yaml --world world.json --frame world".split(' '));
        command.current_dir(folder.path());
        command
    };
    let full = std::fs::File::options().write(true).open("/dev/full").expect("the device");
    let output = score().stdout(full).output().expect("the command runs");
    let text = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("error: stdout: No space left"), "{text}");
    let mut child = score().stdout(std::process::Stdio::piped()).spawn().expect("the command runs");
    drop(child.stdout.take());
    assert!(child.wait().expect("it ends").success());
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

/// Runs a trial and writes its world, its map for ROS, and its trajectories to a folder. Returns its
/// report.
fn trial_in(folder: &Path) -> TrialReport {
    let world = IndoorSpec { width: 6, height: 6, ..Default::default() };
    let world = world.generate(Seed(3)).expect("a map").to_world();
    let settings = TrialSettings { time_limit: 150.0, ..Default::default() };
    let mut trial = Trial::flat(&world, settings).expect("a free start");
    while trial.step() {}
    let write = |name: &str, bytes: &[u8]| {
        std::fs::write(folder.join(name), bytes).expect("a file");
    };
    write("world.json", world.to_json().expect("JSON").as_bytes());
    let map = trial.autonomy().slam().map().to_ros_map().expect("a small map");
    let (mut yaml, mut image) = (Vec::new(), Vec::new());
    map.write_yaml("map.pgm", &mut yaml).expect("text");
    map.write_pgm(&mut image).expect("bytes");
    write("map.yaml", &yaml);
    write("map.pgm", &image);
    // The same map in the frame of a SLAM that does not know the world, with the start as origin.
    let start = trial.trajectory(0).poses[0];
    let map = RosMap { origin: start.between(map.origin), ..map };
    let mut yaml = Vec::new();
    map.write_yaml("map.pgm", &mut yaml).expect("text");
    write("from_start.yaml", &yaml);
    let truth = &trial.trajectory(0).poses;
    let estimated = &trial.autonomy().slam().trajectory(0)[1..];
    for (name, poses) in [("truth.tum", &truth[..]), ("estimate.tum", estimated)] {
        let mut text = Vec::new();
        let timed = poses.iter().take(truth.len()).enumerate();
        let timed = timed.map(|(tick, &pose)| TimedPose { time: tick as f64 * TICK, pose });
        tum::write(timed, &mut text).expect("text");
        write(name, &text);
    }
    trial.report(&world, &trial.reference(&world).expect("a start")).expect("scores")
}

#[test]
fn a_trials_own_map_scores_as_its_report_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let expected = trial_in(folder.path()).scores;
    let score = |arguments: &[&str]| -> Value {
        let all = [&["score", "--world", "world.json", "--json"][..], arguments].concat();
        let output = run(folder.path(), &all);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("JSON")
    };
    let trajectory = ["--trajectory", "estimate.tum", "--truth", "truth.tum"];
    let own = ["--map", "map.yaml", "--frame", "world"];
    let report = score(&[&own[..], &trajectory].concat());
    let all = serde_json::to_value(expected).expect("JSON");
    let near = |found: &Value, name: &str| {
        let [found, expected] = [&found[name], &all[name]].map(Value::as_f64);
        let error = found.zip(expected).map(|(found, expected)| (found - expected).abs());
        assert!(found == expected || error.is_some_and(|error| error < 1e-9), "{name}: {found:?}");
    };
    let of_map: MapScores = serde_json::from_value(report["map"].clone()).expect("scores");
    assert!(of_map.coverage > 0.3 && of_map.f1_30 > 0.5, "{of_map:?}");
    for name in report["map"].as_object().expect("fields").keys() {
        assert_eq!(report["map"][name], all[name], "{name}");
    }
    for name in report["trajectory"]["as_is"].as_object().expect("fields").keys() {
        near(&report["trajectory"]["as_is"], name);
    }
    near(&report, "mapping");
    assert_eq!(report["trajectory"]["outside"], 0);
    let error = |of: &str| report["trajectory"][of]["trajectory_error"].as_f64().expect("metres");
    assert!(error("aligned") <= error("as_is"));

    // In the frame of the start, the map is transformed back to the world's frame.
    let turned = score(&["--map", "from_start.yaml"]);
    let f1 = turned["map"]["f1_30"].as_f64().expect("a share");
    assert!((f1 - expected.f1_30).abs() < 0.03, "{f1} for {}", expected.f1_30);
    assert_eq!(turned["mapping"], Value::Null);
    // A wrong start is corrected by the walls.
    let start = turned["frame"]["position"].as_array().expect("a pose")[..2].to_vec();
    let [x, y] = [0, 1].map(|i| start[i].as_f64().expect("metres"));
    let degrees = turned["frame"]["heading"].as_f64().expect("radians").to_degrees();
    let wrong = format!("{},{},{}", x + 0.2, y - 0.2, degrees + 3.0);
    let lost = score(&["--map", "from_start.yaml", "--start", &wrong]);
    let found = score(&["--map", "from_start.yaml", "--start", &wrong, "--fit"]);
    let strict = |report: &Value| report["map"]["f1_15"].as_f64().expect("a share");
    assert!(strict(&lost) + 0.1 < strict(&found), "{} and {}", strict(&lost), strict(&found));
    assert!(strict(&found) > strict(&turned) - 0.05);
    // The heading of a start is 0 if it is left out.
    let headed = score(&["--map", "from_start.yaml", "--start", &format!("{x},{y},0")]);
    assert_eq!(score(&["--map", "from_start.yaml", "--start", &format!("{x},{y}")]), headed);

    // A map that is free everywhere has full coverage, about which there is a warning.
    let image = [b"P5\n800 800\n255\n".to_vec(), vec![254; 800 * 800]].concat();
    std::fs::write(folder.path().join("free.pgm"), image).expect("a file");
    let yaml = "image: free.pgm\nresolution: 0.05\norigin: [-20, -20, 0]\nnegate: 0\n\
                occupied_thresh: 0.65\nfree_thresh: 0.196\n";
    std::fs::write(folder.path().join("free.yaml"), yaml).expect("a file");
    let warned = |map: &str, frame: &str| {
        let score = ["score", "--world", "world.json", "--frame", frame, "--map", map];
        let output = run(folder.path(), &score);
        assert!(output.status.success(), "{output:?}");
        let said = |text: &str| String::from_utf8_lossy(&output.stderr).contains(text);
        ["must be unknown in the map", "check --frame and --start", "has no free cell"].map(said)
    };
    assert_eq!(warned("free.yaml", "world"), [true, false, false]);
    assert_eq!(warned("map.yaml", "world"), [false; 3]);
    // Of a map in the wrong frame neither walls nor ground are those of the world.
    assert_eq!(warned("map.yaml", "start"), [false, true, false]);
    std::fs::write(folder.path().join("free.yaml"), yaml.replace("negate: 0", "negate: 1"))
        .expect("a file");
    assert_eq!(warned("free.yaml", "world"), [false, false, true]);
    // What an estimate lacks does not count, and there is a warning.
    let all = std::fs::read_to_string(folder.path().join("estimate.tum")).expect("text");
    let part: Vec<&str> = all.lines().take(100).collect();
    std::fs::write(folder.path().join("part.tum"), part.join("\n")).expect("a file");
    let warns = ["estimate.tum", "part.tum"].map(|estimate| {
        let pair = ["--trajectory", estimate, "--truth", "truth.tum"];
        let all = [&["score", "--world", "world.json"][..], &own, &pair].concat();
        String::from_utf8_lossy(&run(folder.path(), &all).stderr).contains("no pose for")
    });
    assert_eq!(warns, [false, true]);
    // The text for people has the same content.
    let output = run(folder.path(), &[&["score", "--world", "world.json"][..], &own].concat());
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(text.contains(&format!("{:.1} %", 100.0 * expected.coverage)), "{text}");
}

#[test]
fn what_cannot_be_scored_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    trial_in(at);
    let failed = |arguments: &[&str]| {
        error(at, &[&["score", "--world", "world.json"][..], arguments].concat())
    };
    assert!(failed(&["--map", "none.yaml"]).starts_with("error: none.yaml: "));
    std::fs::write(at.join("half.yaml"), "image: map.pgm\n").expect("a file");
    assert!(failed(&["--map", "half.yaml"]).starts_with("error: half.yaml: "));
    std::fs::write(at.join("half.tum"), "0 1 2\n").expect("a file");
    let poses = ["--map", "map.yaml", "--truth", "truth.tum", "--trajectory"];
    let text = failed(&[&poses[..], &["half.tum"]].concat());
    assert!(text.starts_with("error: half.tum: line 1 must be `t x y z"), "{text}");
    std::fs::write(at.join("late.tum"), "9999 0 0 0 0 0 0 1\n").expect("a file");
    assert!(failed(&[&poses[..], &["late.tum"]].concat()).contains("no time in common"));
    assert!(failed(&["--map", "map.yaml", "--trajectory", "truth.tum"]).contains("--truth"));
    assert!(failed(&["--map", "map.yaml", "--start", "1,2,3,4"]).contains("x,y,heading"));
    assert!(failed(&["--map", "map.yaml", "--start", "1,nan"]).contains("x,y,heading"));
    let outside = failed(&["--map", "map.yaml", "--start", "-500,0,0"]);
    assert!(outside.starts_with("error: world.json: `start` must be"), "{outside}");
    assert!(outside.contains("got (-500, 0) m"), "{outside}");
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

/// Creates a session of two seconds in a map of its own, with the log and the report of a window. A
/// program drives and fills the form, except for the rating of a person, if there is one.
fn session(folder: &Path, name: &str, seed: u64, rating: Option<f64>) {
    let spec = IndoorSpec { width: 6, height: 6, ..Default::default() };
    let world = spec.generate(Seed(seed)).expect("a plan").to_world();
    let settings = TrialSettings {
        policy: Some(PolicyKind::Nearest),
        time_limit: 2.0,
        ..TrialSettings::default()
    };
    let mut trial = Trial::builder(&world, settings).build_flat().expect("a trial");
    while trial.step() {}
    let truth = trial.reference(&world).expect("a reference");
    let mut report = trial.report(&world, &truth).expect("a report");
    assert!(report.is_form_measured());
    if let Some(rating) = rating {
        let form = report.feedback.as_mut().expect("a form");
        form.difficulty = Rating::try_from(rating).expect("a rating");
        assert!(!report.is_form_measured());
    }
    let folder = folder.join(name);
    std::fs::create_dir(&folder).expect("a folder");
    std::fs::write(folder.join("report.json"), serde_json::to_vec(&report).expect("JSON"))
        .expect("a report");
    let mut log = std::fs::File::create(folder.join("log.json")).expect("a file");
    trial.log().write(&mut log).expect("a log");
}

#[test]
fn ratings_of_three_sessions_are_linked() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    for (name, seed, rating) in [("001", 1, 2.0), ("002", 2, 5.0), ("003", 3, 8.0)] {
        session(at, name, seed, Some(rating));
    }
    session(at, "004_training", 4, Some(9.0));
    session(at, "005", 5, None);
    let linked = |reports: &[&str]| {
        let output = run(at, &[&["link"], reports].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).expect("text")
    };
    let two = linked(&["001/report.json", "002/report.json"]);
    assert!(
        two.contains("difficulty: not linked: expected at least 3 rated sessions, got 2"),
        "{two}"
    );
    assert!(two.contains("indoor, seed 1 by nearest (001/report.json)"), "{two}");
    let all = ["001/report.json", "002/report.json", "003/report.json", "004_training/report.json"];
    let four = linked(&all);
    assert!(four.contains("x rating, from 3 sessions in 3 worlds, correlation"), "{four}");
    assert!(
        four.contains("left out: 004_training/report.json: the true world was shown"),
        "{four}"
    );
    let watched = linked(&["001/report.json", "005/report.json"]);
    let reason = "005/report.json: a program drove, and filled the form from measurements";
    assert!(watched.contains(&format!("left out: {reason}")), "{watched}");
    let inside = run(&at.join("004_training"), &["link", "report.json"]);
    let inside = String::from_utf8(inside.stdout).expect("text");
    assert!(inside.contains("left out: report.json: the true world was shown"), "{inside}");
    let json = linked(&[&all[..], &["--json"]].concat());
    let json: Value = serde_json::from_str(&json).expect("JSON");
    // Linked ratings have the mean of the panel's difficulties.
    let mean = |of: &dyn Fn(usize) -> Value| {
        (0..3).map(|i| of(i).as_f64().expect("a number")).sum::<f64>() / 3.0
    };
    let linked = mean(&|i| json["links"]["difficulty"]["linked"][i]["value"].clone());
    let panel = mean(&|i| json["sessions"][i]["panel"]["dials"]["difficulty"]["value"].clone());
    assert!((linked - panel).abs() < 1e-9, "{linked} {panel}");
    assert_eq!(json["sessions"][0]["panel"]["source"], "predicted");

    // A session that is given twice counts once.
    let twice = ["001/report.json", "002/report.json", "002/../001/report.json"];
    let twice = run(at, &[&["link"], &twice[..]].concat());
    let twice = String::from_utf8(twice.stdout).expect("text");
    assert!(twice.contains("not linked: expected at least 3 rated sessions, got 2"), "{twice}");
    assert!(twice.contains("left out: 002/../001/report.json: it is given twice"), "{twice}");

    // Names are shown, but control no terminal.
    let report = std::fs::read_to_string(at.join("001/report.json")).expect("a report");
    let coloured = report.replace(r#""name":"nearest""#, r#""name":"\u001b[31mA\nda""#);
    assert_ne!(coloured, report);
    std::fs::write(at.join("001/report.json"), coloured).expect("a report");
    let coloured = run(at, &["link", "001/report.json"]);
    let coloured = String::from_utf8(coloured.stdout).expect("text");
    assert!(coloured.contains(r"by \u{1b}[31mA\nda (001/report.json)"), "{coloured}");

    std::fs::copy(at.join("002/log.json"), at.join("001/log.json")).expect("a log");
    let other = error(at, &["link", "001/report.json"]);
    assert_eq!(other, "error: 001/log.json: this is not the world of 001/report.json\n");
    std::fs::remove_file(at.join("001/log.json")).expect("a log");
    assert!(error(at, &["link", "001/report.json"]).starts_with("error: 001/log.json: "));
}
