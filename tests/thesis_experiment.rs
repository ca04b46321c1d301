//! Tests the example `thesis_experiment` as a user runs it.

mod common;

use std::fs;

use common::Example;

/// Arguments for small maps and short trials: 2 levels x 2 maps, by five policies.
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

/// The example that is tested.
const EXAMPLE: Example = Example("thesis_experiment");

#[test]
fn shards_join_into_the_report_of_one_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = |name: &str| folder.path().join(name);
    let reported = EXAMPLE.ok(&SMALL, &out("whole"));
    assert!(
        reported.starts_with("20 trials: 2 levels x 2 maps x 1 noise seeds x 1 policies"),
        "{reported}"
    );
    for shard in ["1/2", "2/2"] {
        let reported = EXAMPLE.ok(&[&SMALL[..], &["--shard", shard]].concat(), &out(&shard[..1]));
        assert!(reported.starts_with("10 trials of share"), "{reported}");
    }
    let (one, two) = (out("1"), out("2"));
    let merge = ["--merge", one.to_str().expect("a path"), two.to_str().expect("a path")];
    EXAMPLE.ok(&merge, &out("merged"));
    for name in ["report.html", "summary.json", "trials.csv", "trials.parquet", "trials.jsonl"] {
        let read = |folder: &str| fs::read(out(folder).join(name)).expect("a file");
        assert!(read("whole") == read("merged"), "{name} differs");
    }
    // Finished trials are not run again, and the folder accepts no other design.
    let reported = EXAMPLE.ok(&SMALL, &out("whole"));
    assert!(reported.contains("20 of them were finished before"), "{reported}");
    let reported = EXAMPLE.error(&[&SMALL[..], &["--seed=1"]].concat(), &out("whole"));
    assert!(reported.contains("`seed` is 0, expected 1"), "{reported}");
    EXAMPLE.ok(&[&SMALL[..], &["--seed=1", "--fresh"]].concat(), &out("whole"));
}

#[test]
fn shares_with_hazards_join_into_one_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = |name: &str| folder.path().join(name);
    let small = [&SMALL[..], &["--policies=nearest", "--hazards=doors"]].concat();
    for shard in ["1/2", "2/2"] {
        let reported = EXAMPLE.ok(&[&small[..], &["--shard", shard]].concat(), &out(&shard[..1]));
        assert!(reported.starts_with(&format!("share {shard} is finished: ")), "{reported}");
        assert!(!reported.contains("maps  D more"), "{reported}");
    }
    let (one, two) = (out("1"), out("2"));
    let merge = ["--merge", one.to_str().expect("a path"), two.to_str().expect("a path")];
    let reported = EXAMPLE.error(&[&merge[..], &["--hazards=people"]].concat(), &out("other"));
    assert!(reported.contains("those of the shares, doors=0.5"), "{reported}");
    assert!(!out("other").exists());
    let plain = EXAMPLE.error(&merge, &out("other"));
    assert!(plain.contains("the share measured what hazards cost: give its --hazards"), "{plain}");
    let merged = EXAMPLE.ok(&[&merge[..], &["--hazards=doors"]].concat(), &out("merged"));
    let table = |reported: &str| {
        assert!(reported.contains("maps  D more"), "{reported}");
        reported.lines().filter(|line| line.contains("doors=0.5")).collect::<String>()
    };
    assert_eq!(table(&merged), table(&EXAMPLE.ok(&small, &out("whole"))));
}

#[test]
fn bad_arguments_are_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    assert!(
        EXAMPLE
            .error(&["--maps=1"], &out)
            .contains("`maps` must be a whole number from 2 to 1000, got 1")
    );
    assert!(EXAMPLE.error(&["--levels=9,1"], &out).contains("`levels` must be"));
    for flag in ["--policies=nobody", "--operators=nobody"] {
        assert!(
            EXAMPLE.error(&[flag], &out).contains("[possible values: nearest, info_gain"),
            "{flag}"
        );
    }
    assert!(EXAMPLE.error(&["--shard=3/2"], &out).contains("`shard` must be"));
    assert!(EXAMPLE.error(&["--size=3"], &out).contains("`size` must be"));
    assert!(!out.exists(), "nothing is written for bad arguments");
    let file = folder.path().join("file");
    fs::write(&file, "").expect("a file");
    assert!(EXAMPLE.error(&SMALL, &file).contains(file.to_str().expect("a path")));
    let reported =
        EXAMPLE.error(&["--merge", out.to_str().expect("a path")], &folder.path().join("merged"));
    assert!(reported.contains("holds no share"), "{reported}");
}
