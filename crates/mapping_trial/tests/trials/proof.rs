//! A small version of the proof that maps are as difficult as requested: in shares, interrupted and
//! continued.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use mapping_trial::difficulty::proof::{
    Dial, Part, ProofDesign, ProofResult, analyse, figure, merge, page, run,
};
use mapping_trial::difficulty::reference_scale;
use mapping_trial::experiment::Shard;

/// Maps of 4 x 4 cells, one trial each.
fn design() -> ProofDesign {
    ProofDesign {
        footprints: vec![4],
        maps: 4,
        link: 4,
        dial: Dial::Navigation,
        held_out: vec!["all at once".to_owned()],
        thesis: 0,
        ..ProofDesign::quick()
    }
}

type Results = Vec<(Part, Vec<ProofResult>)>;

/// Only one part, to save time.
const PART: Part = Part::Calibrated;

fn finish(folder: &Path, shard: Shard) -> Results {
    let on = |_: &str, _: u64, _: u64| ControlFlow::Continue(());
    let found = run(&design(), PART, folder, shard, 0, &on).expect("trials");
    vec![(PART, found.expect("nothing stops it"))]
}

/// The bytes of page, summary and figure.
fn report(results: &Results) -> [String; 3] {
    let (design, scale) = (design(), reference_scale());
    let analysis = analyse(&design, scale, results);
    [
        page(&analysis, scale, results).expect("a page"),
        serde_json::to_string(&analysis).expect("JSON"),
        figure(design.dial, 4, scale, results).expect("a figure"),
    ]
}

#[test]
fn shares_and_continued_runs_make_the_report_of_one_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = |name: &str| folder.path().join(name);
    let shares = [out("1"), out("2")];
    let [first, second] = [1, 2].map(|index| Shard { index, of: 2 });
    let stop = |_: &str, _: u64, _: u64| ControlFlow::Break(());
    let stopped = run(&design(), PART, &shares[0], first, 1, &stop).expect("trials");
    assert_eq!(stopped, None);
    for (path, shard) in shares.iter().zip([first, second]) {
        assert_eq!(finish(path, shard)[0].1.len(), 2);
    }
    let missing = merge(&design(), PART, &out("half"), &shares[..1]).expect_err("half");
    assert!(missing.to_string().contains("24 of 48 trials are missing"), "{missing}");
    merge(&design(), PART, &out("merged"), &shares).expect("both shares");
    let results = finish(&out("merged"), Shard::WHOLE);
    let expected = report(&results);
    let [page, summary, svg] = &expected;
    assert!(page.contains("Requested and measured difficulty of navigation"));
    assert!(summary.contains("\"dial\":\"navigation\""));
    assert!(svg.contains("measured difficulty of navigation of 4 x 4 cells"));
    // On this dial, maps of other requests differ, as far as four of them show.
    let calibrated = &results[0].1;
    assert_eq!(calibrated.len(), 4);
    let (low, high) = (calibrated[0].scores[0], calibrated[3].scores[0]);
    assert!(low < high, "{low} {high}");

    // This run was interrupted within a line.
    let file = out("merged").join("calibrated/reference/trials.jsonl");
    let whole = fs::read(&file).expect("trials");
    fs::write(&file, &whole[..whole.len() - 2000]).expect("a file");
    assert_eq!(report(&finish(&out("merged"), Shard::WHOLE)), expected);
    assert_eq!(fs::read(&file).expect("trials"), whole);
}

#[test]
fn winners_of_other_requests_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let design = ProofDesign { verified: 2, ..design() };
    let [share, out] = ["share", "out"].map(|name| folder.path().join(name));
    fs::create_dir_all(share.join("race")).expect("a folder");
    let maps = design.maps(Part::Verified);
    let write = |navigation: f64| {
        let mut spec = maps[0].spec.clone();
        (spec.navigation, spec.candidate) = (Some(navigation), 3);
        let line = serde_json::json!({ "seed": maps[0].seed, "spec": spec });
        fs::write(share.join("race/trials.jsonl"), format!("{line}\n")).expect("a file");
    };
    let part = Part::Verified;
    write(maps[0].requested + 0.1);
    let on = |_: &str, _: u64, _: u64| ControlFlow::Continue(());
    let error = run(&design, part, &share, Shard::WHOLE, 1, &on).expect_err("another request");
    assert!(error.to_string().ends_with("is of another request"), "{error}");
    write(maps[0].requested);
    let shares: [PathBuf; 1] = [share];
    let error = merge(&design, part, &out, &shares).expect_err("one race of two");
    let first = maps[1].seed;
    let expected =
        format!("1 of 2 trials are missing, the first is the race of the map of seed {first}");
    assert_eq!(error.to_string(), expected);
}
