//! The subcommand `envgen-trials score`.

use std::path::Path;
#[cfg(target_os = "linux")]
use std::process::{Command, Stdio};

use envgen::export::ros_map::RosMap;
use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec};
use mapping_trial::backend::TICK;
use mapping_trial::score::MapScores;
use mapping_trial::trial::{Trial, TrialReport, TrialSettings};
use mapping_trial::tum::{self, TimedPose};
use serde_json::Value;

use crate::command::{error, run};

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
    trajectories_are_doubted(folder.path(), &own);
    // The text for people has the same content.
    let output = run(folder.path(), &[&["score", "--world", "world.json"][..], &own].concat());
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(text.contains(&format!("{:.1} %", 100.0 * expected.coverage)), "{text}");
}

/// Checks the warnings of trajectories that were exported wrongly, and that rare true poses are no error of the
/// estimate, given the arguments of a map in the frame of the world.
fn trajectories_are_doubted(folder: &Path, map: &[&str]) {
    let lines = |name: &str| {
        let text = std::fs::read_to_string(folder.join(name)).expect("text");
        text.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect::<Vec<_>>()
    };
    let truth = lines("truth.tum");
    let changed = |change: fn([f64; 8]) -> [f64; 8]| -> Vec<String> {
        let pose = |line: &String| {
            let numbers = line.split(' ').map(|part| part.parse().expect("a number"));
            change(numbers.collect::<Vec<_>>().try_into().expect("eight"))
        };
        truth.iter().map(|line| pose(line).map(|number| number.to_string()).join(" ")).collect()
    };
    let w_first = changed(|[t, x, y, z, qx, qy, qz, qw]| [t, x, y, z, qw, qx, qy, qz]);
    let shifted = changed(|[t, x, y, z, qx, qy, qz, qw]| [t, x + 2.0, y, z, qx, qy, qz, qw]);
    let rare: Vec<_> = truth.iter().step_by(20).cloned().collect();
    for (name, lines) in [("w_first.tum", &w_first), ("shifted.tum", &shifted), ("rare.tum", &rare)]
    {
        std::fs::write(folder.join(name), lines.join("\n")).expect("a file");
    }
    let score = |estimate: &str, truth: &str| {
        let pair = ["--json", "--trajectory", estimate, "--truth", truth];
        let all = [&["score", "--world", "world.json"][..], map, &pair].concat();
        let output = run(folder, &all);
        let said = String::from_utf8(output.stderr).expect("text");
        assert!(output.status.success(), "{said}");
        let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let doubts = ["half of the headings err", "check --frame and --start", "more than 0.25 s"];
        (found, doubts.map(|doubt| said.contains(doubt)))
    };
    let (exact, doubts) = score("truth.tum", "truth.tum");
    assert_eq!(doubts, [false; 3]);
    assert_eq!(score("estimate.tum", "truth.tum").1, [false; 3]);
    assert_eq!(score("w_first.tum", "truth.tum").1, [true, false, false]);
    assert_eq!(score("shifted.tum", "truth.tum").1, [false, true, false]);
    // Between true poses that are a second apart, the robot is not where a straight line has it.
    let (sparse, doubts) = score("truth.tum", "rare.tum");
    assert_eq!(doubts, [false, false, true]);
    assert!(sparse["trajectory"]["outside"].as_u64() > Some(1000), "{sparse}");
    for error in ["trajectory_error", "relative_error_near", "relative_error_far"] {
        let errors = [&exact, &sparse].map(|found| found["trajectory"]["as_is"][error].as_f64());
        assert!(errors.iter().all(|error| error.is_none_or(|error| error < 0.02)), "{errors:?}");
    }
    let mapping = [&exact, &sparse].map(|found| found["mapping"].as_f64().expect("M"));
    assert!((mapping[0] - mapping[1]).abs() < 0.01, "{mapping:?}");
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
    std::fs::write(at.join("nanoseconds.tum"), "1700000000000000000 0 0 0 0 0 0 1\n")
        .expect("a file");
    let text = failed(&[&poses[..], &["nanoseconds.tum"]].concat());
    assert!(text.contains("line 1: the time must be in seconds, from "), "{text}");
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
    let mut child = score().stdout(Stdio::piped()).spawn().expect("the command runs");
    drop(child.stdout.take());
    assert!(child.wait().expect("it ends").success());
}
