//! Tests the example `mapping_trial` as a user runs it.

mod common;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use common::Example;

/// The example that is tested.
const EXAMPLE: Example = Example("mapping_trial");

/// Returns the name and the bytes of every file in a folder.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .map(|path| {
            (PathBuf::from(path.file_name().expect("a name")), fs::read(&path).expect("a file"))
        })
        .collect()
}

#[test]
fn the_same_arguments_write_the_same_bytes_and_so_does_a_replay() {
    for engine in ["flat", "rapier"] {
        twice_and_replayed(engine, &[]);
        twice_and_replayed(
            engine,
            &["--set", "doors=0.5", "--set", "people=3", "--set", "smoke=0.2"],
        );
    }
}

fn twice_and_replayed(engine: &str, moving: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let out = |name: &str| folder.path().join(name);
    let world = ["--difficulty", "3", "--seed", "4", "--size", "6", "--engine", engine];
    let world = [&world[..], moving].concat();
    let arguments = |policy| {
        let options = [policy, "corridors", "--time-limit", "45", "--robots", "2"];
        [&world[..], &options].concat()
    };
    let table = EXAMPLE.ok(&arguments("--policy"), &out("first"));
    // The old name of the option.
    EXAMPLE.ok(&arguments("--operator"), &out("second"));
    let log = out("first").join("log.json");
    EXAMPLE.ok(&["--replay", log.to_str().expect("a path")], &out("replay"));

    let first = files(&out("first"));
    assert_eq!(first, files(&out("second")));
    assert_eq!(first, files(&out("replay")));
    let names: Vec<_> = first.keys().map(|name| name.to_string_lossy().into_owned()).collect();
    let expected = [
        "log.json",
        "map.png",
        "overlay.png",
        "report.json",
        "ros_map.pgm",
        "ros_map.yaml",
        "truth.png",
    ];
    assert_eq!(names, expected);
    #[cfg(unix)]
    for name in expected {
        use std::os::unix::fs::PermissionsExt;
        // The files can be read by everyone who can read any other file that is created here.
        let usual = folder.path().join("usual");
        fs::write(&usual, "").expect("a file");
        let mode = |path: &Path| fs::metadata(path).expect("a file").permissions().mode();
        assert_eq!(mode(&out("first").join(name)), mode(&usual), "{name}");
    }
    assert!(table.contains("robot 2: time up after 45 s"), "{table}");
    let report: serde_json::Value =
        serde_json::from_slice(&first[Path::new("report.json")]).expect("JSON");
    assert!(report["scores"]["coverage"].as_f64().expect("a share") > 0.01);
    let log: serde_json::Value =
        serde_json::from_slice(&first[Path::new("log.json")]).expect("JSON");
    assert_eq!(log["engine"].as_str(), Some(engine));
}

#[test]
fn a_bag_and_that_of_the_replay_are_the_same_bytes() {
    for engine in ["flat", "rapier"] {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let bag = |name: &str| at(name).join("trial.mcap").to_str().expect("a path").to_owned();
        let (first, again) = (bag("first"), bag("again"));
        let world = ["--size", "6", "--time-limit", "35", "--robots", "2", "--engine", engine];
        EXAMPLE.ok(&[&world[..], &["--log", &first]].concat(), &at("out"));
        let log = at("out").join("log.json");
        EXAMPLE.ok(&["--replay", log.to_str().expect("a path"), "--log", &again], &at("replay"));
        let found = files(&at("first"));
        assert_eq!(found, files(&at("again")), "{engine}");
        let names: Vec<_> = found.keys().map(|name| name.to_string_lossy().into_owned()).collect();
        let expected = [
            "metadata.yaml",
            "trial.estimate.tum",
            "trial.estimate_2.tum",
            "trial.mcap",
            "trial.truth.tum",
            "trial.truth_2.tum",
            "trial.world.json",
        ];
        assert_eq!(names, expected);
        // Another log in the same folder would make the metadata wrong.
        let other = at("first").join("other.mcap");
        let other = ["--size", "6", "--log", other.to_str().expect("a path")];
        assert!(EXAMPLE.error(&other, &at("other")).contains("describes another bag"));
        assert_eq!(found, files(&at("first")));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let error = EXAMPLE.error(&["--log", "trial.bag"], folder.path());
    assert!(error.contains("--log trial.bag: must end in .mcap"), "{error}");
}

#[test]
fn a_reader_that_goes_away_loses_no_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = EXAMPLE.command(&["--size", "4", "--time-limit", "5"], folder.path());
    let mut trial = command.stdout(Stdio::piped()).spawn().expect("the example starts");
    drop(trial.stdout.take());
    assert!(trial.wait().expect("it ends").success());
    assert_eq!(files(folder.path()).len(), 7);
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = EXAMPLE.command(&["--size", "4", "--time-limit", "5"], folder.path());
    let full = fs::File::create("/dev/full").expect("a full disk");
    let trial = command.stdout(full).output().expect("the example starts");
    let error = String::from_utf8_lossy(&trial.stderr);
    assert!(error.starts_with("error: stdout: ") && !trial.status.success(), "{error}");
    assert_eq!(files(folder.path()).len(), 7);
}

#[test]
fn every_kind_of_world_and_the_robots_own_map_can_be_mapped() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/worlds");
    for spec in ["paper_hallway", "paper_forest"] {
        let path = assets.join(spec).with_extension("envgen.ron");
        assert!(path.exists(), "{}", path.display());
        EXAMPLE.ok(&["--world", path.to_str().expect("a path"), "--time-limit", "20"], &out);
    }
    let again = folder.path().join("again");
    let map = out.join("ros_map.yaml");
    let table = EXAMPLE.ok(&["--map", map.to_str().expect("a path"), "--time-limit", "20"], &again);
    assert!(table.contains("time up") || table.contains("explored"), "{table}");
}

#[test]
fn other_robots_are_read_from_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/robots/turtlebot3_waffle.ron");
    let robot = robot.to_str().expect("a path");
    for engine in ["flat", "rapier"] {
        let out = folder.path().join(engine);
        let arguments = ["--robot", robot, "--size", "4", "--time-limit", "30", "--engine", engine];
        EXAMPLE.ok(&arguments, &out);
        let report: serde_json::Value =
            serde_json::from_slice(&fs::read(out.join("report.json")).expect("a file"))
                .expect("JSON");
        assert_eq!(report["settings"]["body"]["max_speed"].as_f64(), Some(0.26));
        let distance = report["scores"]["distance"].as_f64().expect("a distance");
        assert!((1.0..0.26 * 30.0).contains(&distance), "{distance}");
    }
}

#[test]
fn no_file_that_is_read_is_written_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    EXAMPLE.ok(&["--size", "4", "--time-limit", "5"], &out);
    let before = files(&out);
    for (option, name) in [("--map", "ros_map.yaml"), ("--replay", "log.json")] {
        let input = out.join(name);
        let error = EXAMPLE.error(&[option, input.to_str().expect("a path")], &out);
        assert!(error.contains(name) && error.contains("is the input"), "{error}");
    }
    // The image that a description in another folder names is an input as well.
    let yaml = fs::read_to_string(out.join("ros_map.yaml")).expect("a file");
    let elsewhere = folder.path().join("map.yaml");
    fs::write(&elsewhere, yaml.replace("ros_map.pgm", "out/ros_map.pgm")).expect("a file");
    for option in ["--map", "--world"] {
        let error = EXAMPLE.error(&[option, elsewhere.to_str().expect("a path")], &out);
        assert!(error.contains("is the input") && error.contains("out/ros_map.pgm"), "{error}");
    }
    assert_eq!(files(&out), before);
}

#[test]
#[cfg(unix)]
fn files_appear_together_or_not_at_all() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a folder");
    let report = folder.path().join("report.json");
    fs::write(&report, "mine").expect("a file");
    fs::set_permissions(&report, PermissionsExt::from_mode(0o444)).expect("a mode");
    let error = EXAMPLE.error(&["--size", "4", "--time-limit", "5"], folder.path());
    assert!(error.contains("report.json: exists and is read-only"), "{error}");
    assert_eq!(files(folder.path()).len(), 1);
}

#[test]
fn impossible_arguments_are_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let slow = folder.path().join("slow.ron");
    fs::write(&slow, "(max_speed: 0)").expect("a file");
    let error = EXAMPLE.error(&["--robot", slow.to_str().expect("a path")], &out);
    assert!(error.contains("slow.ron: `body.max_speed` must be a number from 0.01 to"), "{error}");
    let small = folder.path().join("small.ron");
    fs::write(&small, "(length: 0.1, width: 0.1, swing_radius: 0.08, laser_offset: 0)")
        .expect("a file");
    let error = EXAMPLE.error(&["--robot", small.to_str().expect("a path")], &out);
    assert!(
        error.contains("small.ron: `circumscribed_radius` must be from 0.15 to 2 m"),
        "{error}"
    );
    assert!(EXAMPLE.error(&["--difficulty", "11"], &out).contains("`difficulty` must be"));
    assert!(EXAMPLE.error(&["--robots", "0"], &out).contains("`robots` must be"));
    let error = EXAMPLE.error(&["--driver", "python3", "--driver-timeout", "1e300"], &out);
    assert!(error.ends_with("above 0, at most 1000000000, got 1e300\n"), "{error}");
    assert!(EXAMPLE.error(&["--size", "193"], &out).contains("193 is not in 4..=192"));
    assert!(EXAMPLE.error(&["--seed", "-1"], &out).contains("`seed` must be a whole"));
    let wide = folder.path().join("wide.envgen.ron");
    fs::write(&wide, "Forest(width: 600, height: 600, intensity: 0.001)").expect("a file");
    let error = EXAMPLE.error(&["--world", wide.to_str().expect("a path")], &out);
    assert!(error.contains("wide.envgen.ron: `bounds` are 602 m x 602 m, expected"), "{error}");
    fs::write(&wide, "Forest(width: -6)").expect("a file");
    let error = EXAMPLE.error(&["--world", wide.to_str().expect("a path")], &out);
    assert!(error.contains("wide.envgen.ron: `width` must be"), "{error}");
    // A trial could start here, but it would have no score.
    fs::write(&wide, "Hallway(segments: 3, width: 0.715)").expect("a file");
    let error = EXAMPLE.error(&["--world", wide.to_str().expect("a path")], &out);
    assert!(error.contains("`start` must be on ground to drive on with 0.36 m"), "{error}");
    assert!(EXAMPLE.error(&["--policy", "chauffeur"], &out).contains("nearest, info_gain"));
    assert!(EXAMPLE.error(&["--start", "1,2,3,4"], &out).contains("x,y,heading"));
    assert!(EXAMPLE.error(&["--start", "-50,0,0"], &out).contains("start"));
    assert!(EXAMPLE.error(&["--world", "nowhere.ron"], &out).contains("nowhere.ron"));
    let half = folder.path().join("half.json");
    fs::write(&half, "{\"version\": 1, \"world\"").expect("a file");
    assert!(
        EXAMPLE.error(&["--replay", half.to_str().expect("a path")], &out).contains("half.json")
    );
    let file = folder.path().join("file");
    fs::write(&file, "").expect("a file");
    assert!(EXAMPLE.error(&[], &file.join("below")).contains("--out"));
}

#[cfg(not(feature = "render"))]
#[test]
fn cameras_need_a_build_that_draws() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let frames = folder.path().join("frames");
    let arguments = ["--engine", "rapier", "--camera", frames.to_str().expect("a path")];
    let error = EXAMPLE.error(&arguments, &out);
    assert!(
        error.contains("cargo run --release --features window --example mapping_trial"),
        "{error}"
    );
    assert!(!frames.exists() && !out.exists());
}
