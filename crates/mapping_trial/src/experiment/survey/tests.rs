use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU32, Ordering};

use super::summary::{FaultKind, summarise};
use super::*;
use crate::experiment::{ExperimentError, Shard};

fn survey() -> Survey {
    Survey::from_ron(
        "(
            families: [
                (name: \"short\", spec: Hallway(segments: 2), maps: 2, first_seed: 5),
                (name: \"long\", spec: Hallway(segments: 4)),
            ],
            conditions: [
                (name: \"nearest\", time_limit: 8),
                (name: \"graph\", slam: pose_graph, time_limit: 8),
            ],
            noise_seeds: 2,
        )",
    )
    .expect("a survey")
}

const ON: &(dyn Fn(SurveyProgress<'_>) -> ControlFlow<()> + Sync) = &|_| ControlFlow::Continue(());

#[test]
fn an_interrupted_survey_continues_and_ends_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let (once, twice) = (folder.path().join("once"), folder.path().join("twice"));
    let mut whole = SurveyFolder::open(&once, &survey(), Shard::WHOLE).expect("a new folder");
    assert!(whole.run(2, ON).expect("trials"));
    assert_eq!(whole.records().len(), 12);

    let mut part = SurveyFolder::open(&twice, &survey(), Shard::WHOLE).expect("a new folder");
    let seen = AtomicU32::new(0);
    let stop = |progress: SurveyProgress<'_>| {
        assert_eq!(progress.all, 12);
        match seen.fetch_add(1, Ordering::Relaxed) {
            0..=3 => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        }
    };
    assert!(!part.run(1, &stop).expect("trials"));
    drop(part);
    let mut rest = SurveyFolder::open(&twice, &survey(), Shard::WHOLE).expect("the same folder");
    assert_eq!(rest.records().len(), 5);
    assert!(rest.run(1, ON).expect("trials"));
    let bytes = |folder: &SurveyFolder| std::fs::read(folder.file()).expect("a file");
    assert_eq!(bytes(&rest), bytes(&whole));

    let summary = summarise(&survey(), &rest.records().collect::<Vec<_>>());
    assert_eq!(summary.groups.len(), 4);
    assert_eq!(summary.groups.iter().map(|group| group.trials).sum::<usize>(), 12);
    // All measures that vary at all, of maps, estimators and noise.
    let difficulty = &summary.measures[0];
    assert_eq!(difficulty.symbol, "D");
    assert!(difficulty.components.share("map x SLAM").is_some());
}

#[test]
fn shares_have_their_own_worlds_and_other_surveys_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let first = Shard { index: 1, of: 2 };
    let share = SurveyFolder::open(folder.path(), &survey(), first).expect("a new folder");
    assert_eq!(share.trials(), 8);
    drop(share);
    let mut other = survey();
    other.noise_seeds = 3;
    let error = SurveyFolder::open(folder.path(), &other, first).expect_err("another survey");
    assert!(matches!(error, ExperimentError::Other { .. }), "{error}");
    let difference = format!("`survey.noise_seeds` is {}, expected 3", survey().noise_seeds);
    assert!(error.to_string().contains(&difference), "{error}");
}

#[test]
fn shares_get_worlds_of_all_kinds() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let mut survey = survey();
    // Two kinds take turns, as in the proof.
    let families =
        (0..4).map(|i| Family { maps: 1, name: i.to_string(), ..survey.families[i % 2].clone() });
    survey.families = families.collect();
    survey.conditions.truncate(1);
    let shares = [path("1"), path("2")];
    let expected: [&[u32]; 2] = [&[0, 3], &[1, 2]];
    for ((index, path), expected) in (1..).zip(&shares).zip(expected) {
        let shard = Shard { index, of: 2 };
        let share = SurveyFolder::open_of_kinds(path, &survey, shard, 2);
        let mut share = share.expect("a folder");
        assert!(share.run(1, ON).expect("trials"));
        let mut maps: Vec<u32> = share.records().map(|record| record.map).collect();
        maps.dedup();
        assert_eq!(maps, expected);
        drop(share);
        let other = SurveyFolder::open(path, &survey, shard).expect_err("dealt otherwise");
        assert!(other.to_string().contains("`kinds` is 2, expected null"), "{other}");
    }
    let merged = SurveyFolder::merge(&path("merged"), &shares).expect("both shares");
    drop(merged);
    // The whole is written as if there were no kinds.
    SurveyFolder::open_of_kinds(&path("merged"), &survey, Shard::WHOLE, 2).expect("the same");
    let head = std::fs::read_to_string(path("merged").join("survey.json")).expect("a head");
    assert!(!head.contains("kinds"), "{head}");
}

#[test]
fn a_share_need_not_know_the_worlds_of_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let shares = [path("1"), path("2")];
    for (index, path) in (1..).zip(&shares) {
        let mut own = survey();
        // The only world of the second family is of the first share.
        if index == 2 {
            own.families[1].first_seed = envgen::Seed(99);
        }
        let mut share = SurveyFolder::open(path, &own, Shard { index, of: 2 }).expect("a folder");
        assert!(share.run(1, ON).expect("trials"));
    }
    let merged = SurveyFolder::merge_of(&survey(), &path("all"), &shares).expect("both shares");
    assert!(merged.is_complete());
    let mut other = survey();
    other.families[0].first_seed = envgen::Seed(6);
    let other = SurveyFolder::merge_of(&other, &path("other"), &shares).expect_err("others");
    let difference = "`survey.families[0].first_seed` is 5, expected 6";
    assert!(other.to_string().contains(difference), "{other}");
    // A share whose trials give other results than the same trials of another.
    let file = shares[0].join("trials.jsonl");
    let text = std::fs::read_to_string(&file).expect("trials");
    let cut = text.find("\"pose_error\":").expect("a number") + 13;
    std::fs::write(&file, format!("{}1{}", &text[..cut], &text[cut..])).expect("a file");
    let both = [shares[0].clone(), path("all")];
    let differs = SurveyFolder::merge(&path("differs"), &both).expect_err("two results");
    assert!(
        differs.to_string().contains("the trial of world 0 (short) under `nearest`"),
        "{differs}"
    );
}

#[test]
fn a_robot_that_does_not_fit_is_a_record_with_its_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut survey = survey();
    survey.families.truncate(1);
    survey.families[0].maps = 1;
    survey.conditions.truncate(1);
    survey.conditions[0].robot.circumscribed_radius = 1.5;
    let mut run = SurveyFolder::open(folder.path(), &survey, Shard::WHOLE).expect("a new folder");
    assert!(run.run(1, ON).expect("no trial"));
    let records: Vec<_> = run.records().collect();
    let failure = records[0].failure.as_deref().expect("a reason");
    assert!(failure.contains("`start`"), "{failure}");
    let summary = summarise(&survey, &records);
    assert!(summary.faults.iter().all(|fault| fault.kind == FaultKind::Failed));
    assert_eq!((summary.faults.len(), summary.measures.len()), (2, 0));
    // Which is not the easiest of all.
    assert_eq!((summary.groups[0].mean, summary.groups[0].median_error), (None, None));
}

#[test]
fn a_file_of_something_else_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    drop(SurveyFolder::open(folder.path(), &survey(), Shard::WHOLE).expect("a new folder"));
    std::fs::write(folder.path().join("trials.jsonl"), "{}\n").expect("a file");
    let error = SurveyFolder::open(folder.path(), &survey(), Shard::WHOLE).expect_err("no trial");
    assert!(error.to_string().contains("trials.jsonl: line 1: "), "{error}");
}

#[test]
fn trials_of_another_survey_or_noise_and_trials_that_occur_twice_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut small = survey();
    small.families.truncate(1);
    small.conditions.truncate(1);
    let mut run = SurveyFolder::open(folder.path(), &small, Shard::WHOLE).expect("a new folder");
    assert!(run.run(1, ON).expect("trials"));
    let path = run.file().to_owned();
    drop(run);
    let text = std::fs::read_to_string(&path).expect("trials");
    let line = text.lines().next().expect("a trial");
    let open = |text: String| {
        std::fs::write(&path, text).expect("a file");
        let error = SurveyFolder::open(folder.path(), &small, Shard::WHOLE);
        error.expect_err("no such trial").to_string()
    };
    let other = open(line.replacen("\"map\":0", "\"map\":7", 1) + "\n");
    assert!(other.ends_with("line 1: a trial of another survey"), "{other}");
    let noise = open(line.replacen("\"noise_seed\":5000", "\"noise_seed\":5002", 1) + "\n");
    assert!(noise.ends_with("line 1: `noise_seed` must be 5000, got 5002"), "{noise}");
    let twice = open(format!("{line}\n{line}\n"));
    assert!(twice.ends_with("line 2: a trial that occurs twice"), "{twice}");
}

#[test]
fn merged_shares_are_the_whole_survey() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let mut whole = SurveyFolder::open(&path("whole"), &survey(), Shard::WHOLE).expect("a folder");
    assert!(whole.run(2, ON).expect("trials"));
    let shares: Vec<_> = (1..=2)
        .map(|index| {
            let (path, shard) = (path(&format!("part{index}")), format!("{index}/2"));
            let shard = shard.parse().expect("a share");
            let mut share = SurveyFolder::open(&path, &survey(), shard).expect("a folder");
            assert!(share.run(2, ON).expect("trials"));
            path
        })
        .collect();
    let error = |name: &str, parts: &[std::path::PathBuf]| {
        SurveyFolder::merge(&path(name), parts).expect_err("no merge").to_string()
    };
    assert!(error("none", &[]).contains("no folders to merge"));
    let missing = error("half", &shares[..1]);
    assert!(
        missing.contains("of 12 trials are missing, the first is the trial of world"),
        "{missing}"
    );
    // What is refused leaves no folder.
    assert!(!path("half").exists());
    assert_eq!(SurveyFolder::survey_of(&shares[0]).expect("a share"), survey());
    let nothing = error("nothing", &[path("no")]);
    assert!(nothing.contains("the folder holds no share of a survey"), "{nothing}");
    // In another order, and one of them twice.
    let parts = [&shares[1], &shares[0], &shares[1]].map(Clone::clone);
    let merged = SurveyFolder::merge(&path("all"), &parts).expect("all shares");
    let bytes = |folder: &SurveyFolder| std::fs::read(folder.file()).expect("a file");
    assert_eq!(bytes(&merged), bytes(&whole));
    let other = Survey { noise_seeds: 3, ..survey() };
    SurveyFolder::open(&path("other"), &other, Shard::WHOLE).expect("a folder");
    let differs = error("mixed", &[shares[0].clone(), path("other")]);
    assert!(differs.contains("holds another experiment: `survey.noise_seeds` is 3"), "{differs}");
}
