//! The example `mapping_trial`, as a user runs it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The example, which `cargo test` builds beside this test.
fn example() -> Command {
    let mut path = std::env::current_exe().expect("this test");
    path.pop();
    path.pop();
    path.push("examples");
    path.push(format!("mapping_trial{}", std::env::consts::EXE_SUFFIX));
    assert!(path.exists(), "{} is not there: build the examples first", path.display());
    Command::new(path)
}

fn run(arguments: &[&str], out: &Path) -> Output {
    example().args(arguments).arg("--out").arg(out).output().expect("the example starts")
}

fn ok(arguments: &[&str], out: &Path) -> String {
    let output = run(arguments, out);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {errors}");
    String::from_utf8(output.stdout).expect("text")
}

fn error(arguments: &[&str], out: &Path) -> String {
    let output = run(arguments, out);
    assert!(!output.status.success(), "{arguments:?} went well");
    assert!(output.stdout.is_empty() || !out.join("report.json").exists());
    String::from_utf8(output.stderr).expect("text")
}

/// Name and bytes of every file in a folder.
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
    let folder = tempfile::tempdir().expect("a folder");
    let out = |name: &str| folder.path().join(name);
    let arguments = ["--difficulty", "3", "--seed", "4", "--time-limit", "90", "--robots", "2"];
    let table = ok(&arguments, &out("first"));
    ok(&arguments, &out("second"));
    let log = out("first").join("log.json");
    ok(&["--replay", log.to_str().expect("a path")], &out("replay"));

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
    assert!(table.contains("robot 2: time up after 90 s"), "{table}");
    let report: serde_json::Value =
        serde_json::from_slice(&first[Path::new("report.json")]).expect("JSON");
    assert!(report["scores"]["coverage"].as_f64().expect("a share") > 0.01);
}

#[test]
fn every_kind_of_world_and_the_robots_own_map_can_be_mapped() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/worlds");
    for spec in ["paper_hallway", "paper_forest"] {
        let path = assets.join(spec).with_extension("envgen.ron");
        assert!(path.exists(), "{}", path.display());
        ok(&["--world", path.to_str().expect("a path"), "--time-limit", "20"], &out);
    }
    let again = folder.path().join("again");
    let map = out.join("ros_map.yaml");
    let table = ok(&["--map", map.to_str().expect("a path"), "--time-limit", "20"], &again);
    assert!(table.contains("time up") || table.contains("explored"), "{table}");
}

#[test]
fn what_cannot_be_done_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    assert!(error(&["--difficulty", "11"], &out).contains("`difficulty` is 11"));
    assert!(error(&["--robots", "0"], &out).contains("`robots` is 0"));
    assert!(error(&["--operator", "chauffeur"], &out).contains("nearest, info_gain"));
    assert!(error(&["--start", "1,2,3,4"], &out).contains("x,y,heading"));
    assert!(error(&["--start", "-50,0,0"], &out).contains("start"));
    assert!(error(&["--world", "nowhere.ron"], &out).contains("nowhere.ron"));
    let half = folder.path().join("half.json");
    fs::write(&half, "{\"version\": 1, \"world\"").expect("a file");
    assert!(error(&["--replay", half.to_str().expect("a path")], &out).contains("half.json"));
    let file = folder.path().join("file");
    fs::write(&file, "").expect("a file");
    assert!(error(&[], &file.join("below")).contains("--out"));
}
