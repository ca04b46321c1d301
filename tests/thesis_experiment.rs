//! The example `thesis_experiment`, as a user runs it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Small maps and short trials: 2 levels x 2 maps, by five operators.
const SMALL: [&str; 8] = [
    "--quick",
    "--levels=2,8",
    "--maps=2",
    "--size=6",
    "--time-limit=5",
    "--slam",
    "dead_reckoning",
    "--threads=2",
];

/// The example, which `cargo test` builds beside this test.
fn run(arguments: &[&str], out: &Path) -> Output {
    let mut path = std::env::current_exe().expect("this test");
    path.pop();
    path.pop();
    path.push("examples");
    path.push(format!("thesis_experiment{}", std::env::consts::EXE_SUFFIX));
    assert!(path.exists(), "{} is not there: build the examples first", path.display());
    Command::new(path).args(arguments).arg("--out").arg(out).output().expect("the example starts")
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
    String::from_utf8(output.stderr).expect("text")
}

#[test]
fn shards_join_into_the_report_of_one_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = |name: &str| folder.path().join(name);
    let told = ok(&SMALL, &out("whole"));
    assert!(
        told.starts_with("20 trials: 2 levels x 2 maps x 1 noise seeds x 1 operators"),
        "{told}"
    );
    for shard in ["1/2", "2/2"] {
        let told = ok(&[&SMALL[..], &["--shard", shard]].concat(), &out(&shard[..1]));
        assert!(told.starts_with("10 trials of share"), "{told}");
    }
    let (one, two) = (out("1"), out("2"));
    let merge = ["--merge", one.to_str().expect("a path"), two.to_str().expect("a path")];
    ok(&merge, &out("merged"));
    for name in ["report.html", "summary.json", "trials.csv", "trials.parquet", "trials.jsonl"] {
        let read = |folder: &str| fs::read(out(folder).join(name)).expect("a file");
        assert!(read("whole") == read("merged"), "{name} differs");
    }
    // What is finished is not run again; another design has no place in the folder.
    let told = ok(&SMALL, &out("whole"));
    assert!(told.contains("20 of them were finished before"), "{told}");
    let told = error(&[&SMALL[..], &["--seed=1"]].concat(), &out("whole"));
    assert!(told.contains("`seed` is 0, asked is 1"), "{told}");
    ok(&[&SMALL[..], &["--seed=1", "--fresh"]].concat(), &out("whole"));
}

#[test]
fn bad_arguments_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    assert!(error(&["--maps=1"], &out).contains("`maps` is 1, allowed is 2 to 1000"));
    assert!(error(&["--levels=9,1"], &out).contains("`levels` is 9, 1, allowed is"));
    assert!(error(&["--operators=nobody"], &out).contains("allowed is nearest, info_gain"));
    assert!(error(&["--shard=3/2"], &out).contains("`shard` is 3/2"));
    assert!(error(&["--size=3"], &out).contains("`size` is 3"));
    assert!(!out.exists(), "nothing is written for bad arguments");
    let file = folder.path().join("file");
    fs::write(&file, "").expect("a file");
    assert!(error(&SMALL, &file).contains(file.to_str().expect("a path")));
    let told = error(&["--merge", out.to_str().expect("a path")], &folder.path().join("merged"));
    assert!(told.contains("holds no share"), "{told}");
}
