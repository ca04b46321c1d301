//! Landscapes on the command line.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_envgen")).args(arguments).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let output = run(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn metrics(path: &Path) -> Value {
    json(&["metrics", "--json", path.to_str().unwrap()])
}

#[test]
fn every_format_holds_the_landscape_that_was_asked() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mut arguments: Vec<String> = [
        "generate",
        "landscape",
        "--seed=3",
        "--set",
        "classes=10",
        "--set",
        "entropy=1.9",
        "--set",
        "total_edge=2376",
        "--set",
        "cell=0.5",
        "--set",
        "speeds=1,1,1,0.5,0.5,1,1,0,0,1",
    ]
    .map(str::to_owned)
    .to_vec();
    for name in ["a.json", "a.asc", "a.classes.png", "a.map", "a.svg"] {
        arguments.extend(["--out".to_owned(), at(name).to_str().unwrap().to_owned()]);
    }
    let arguments: Vec<_> = arguments.iter().map(String::as_str).collect();
    let output = run(&arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));

    let report = metrics(&at("a.json"));
    assert_eq!(report["edge_count"], 2376);
    assert_eq!(report["total_edge_m"], 1188.0);
    assert!((report["shdi"].as_f64().unwrap() - 1.9).abs() < 1e-5);
    for name in ["a.asc", "a.classes.png"] {
        assert_eq!(metrics(&at(name)), report, "{name}");
    }
    // A map tells only what can be passed.
    assert_eq!(metrics(&at("a.map"))["by_class"].as_array().unwrap().len(), 3);
    assert!(std::fs::read_to_string(at("a.scen")).unwrap().starts_with("version 1\n"));
    let checked = run(&["check", at("a.json").to_str().unwrap()]);
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));

    let border = json(&["metrics", "--json", "--border", at("a.asc").to_str().unwrap()]);
    assert_eq!(border["edge_count"], 2376 + 4 * 48);
    let text = run(&["metrics", at("a.asc").to_str().unwrap()]);
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.contains("Total Edge") && text.contains("2376 sides"), "{text}");
}

#[test]
fn tasks_name_their_map_as_it_was_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let map = folder.path().join("U.MAP");
    let output = run(&["generate", "landscape", "--out", map.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let tasks = std::fs::read_to_string(folder.path().join("U.scen")).unwrap();
    assert!(tasks.lines().skip(1).all(|task| task.split('\t').nth(1) == Some("U.MAP")), "{tasks}");
    assert_eq!(tasks.lines().count(), 101);
}

#[test]
fn samples_have_the_fields_and_can_be_measured() {
    let folder = tempfile::tempdir().unwrap();
    let line = json(&[
        "sample",
        "landscape",
        "--count",
        "1",
        "--set",
        "rows=6",
        "--set",
        "cols=8",
        "--set",
        "classes=3",
        "--set",
        "entropy=1",
        "--set",
        "algorithm=smooth",
    ]);
    let blueprint = &line["blueprint"];
    for field in ["rows", "cols", "classes", "beta", "counts", "entropy", "total_edge", "ted"] {
        assert!(!blueprint[field].is_null(), "{field}");
    }
    assert_eq!(blueprint["cells"].as_array().unwrap().len(), 6);
    let path = folder.path().join("line.json");
    std::fs::write(&path, line.to_string()).unwrap();
    assert_eq!(metrics(&path)["edge_count"], blueprint["total_edge"]);
}

#[test]
fn bad_input_ends_with_its_code_and_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let grid = "ncols 1000000000\nnrows 1000000000\ncellsize 1\n1\n";
    for (arguments, code, reason) in [
        (vec!["metrics".to_owned(), at("a.txt", "")], 2, ".asc"),
        (vec!["metrics".to_owned(), at("a.asc", grid)], 1, "from 1 to"),
        (vec!["metrics".to_owned(), at("a.png", "no image")], 1, "PNG"),
        (vec!["metrics".to_owned(), at("a.json", "[[1],[1,2]]")], 1, "row 2"),
        (vec!["metrics".to_owned(), "absent.asc".to_owned()], 1, "absent.asc"),
    ] {
        let arguments: Vec<_> = arguments.iter().map(String::as_str).collect();
        let output = run(&arguments);
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{text}");
        assert!(text.contains(reason) && output.stdout.is_empty(), "{text}");
    }
    for (setting, reason) in [
        ("entropy=2.5", "at most 2.197"),
        ("total_edge=4513", "`total_edge` must be from"),
        ("classes=0", "from 1 to 65535"),
        ("rows=99999999999", "`rows`"),
    ] {
        let output = run(&["sample", "landscape", "--count", "1", "--set", setting]);
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(reason), "{text}");
    }
}

#[test]
fn a_picture_is_not_taken_for_classes() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let run = |arguments: &[&str]| {
        std::process::Command::new(env!("CARGO_BIN_EXE_envgen")).args(arguments).output().unwrap()
    };
    let (picture, classes) = (at("l.png"), at("l.classes.png"));
    assert!(run(&["generate", "landscape", "--out", &picture, "--out", &classes]).status.success());
    assert!(run(&["metrics", &classes]).status.success());
    let output = run(&["metrics", &picture]);
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.contains("a picture of a world"), "{text}");
}

#[test]
fn a_total_edge_that_does_not_exist_is_said_so() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("n.asc");
    let settings = [
        "--set=rows=6",
        "--set=cols=6",
        "--set=classes=2",
        "--set=entropy=0.6931471805599453",
        "--set=algorithm=mixed",
        "--set=total_edge=7",
    ];
    let said = |arguments: &[&str]| {
        let output = run(&[arguments, &settings].concat());
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    let text = said(&["generate", "landscape", "--seed=4", "--out", out.to_str().unwrap()]);
    assert!(text.contains("the nearest that was found is"), "{text}");
    let text = said(&["sample", "landscape", "--seed=4", "--count=3"]);
    assert!(text.contains(" of 3 landscapes have the nearest total_edge"), "{text}");
}
