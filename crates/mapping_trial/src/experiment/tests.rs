use std::fs;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use envgen::Seed;
use tempfile::TempDir;

use super::stats::analyse;
use super::*;
use crate::policy::PolicyKind;
use crate::score::Scores;

/// Small maps and short trials.
pub(super) fn small() -> Design {
    let nearest = vec![PolicyKind::Nearest];
    Design {
        maps: 2,
        noise_seeds: 2,
        policies: nearest.clone(),
        replay: Replay { maps: 1, policies: vec![PolicyKind::Nearest, PolicyKind::Corridors] },
        size: 7,
        time_limit: 4.0,
        ..Design::default()
    }
}

/// Two levels alone.
fn tiny() -> Design {
    Design { levels: vec![1.0, 9.0], ..small() }
}

/// A record that no trial made.
pub(super) fn record(level: u32, map: u32, noise: u32, difficulty: f64) -> Record {
    Record {
        trial: TrialId { level, map, noise, policy: PolicyKind::Nearest },
        world_seed: Seed(0),
        noise_seed: Seed(0),
        world_digest: String::new(),
        log_digest: String::new(),
        end: None,
        pose_error: None,
        features: MapFeatures::default(),
        scores: Scores {
            difficulty,
            mapping: difficulty,
            navigation: difficulty,
            e_time: difficulty / 10.0,
            ..Scores::default()
        },
    }
}

/// Records of a whole design with given difficulties by level and map.
pub(super) fn made_records(design: &Design, of: impl Fn(usize, u32) -> f64) -> Vec<Record> {
    let trials = design.trials().into_iter();
    let made = trials.map(|trial| {
        let difficulty = of(trial.level as usize, trial.map);
        Record { trial, ..record(0, 0, 0, difficulty) }
    });
    made.collect()
}

fn go_on(_: Progress<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn run(folder: &Path, design: &Design, shard: Shard, threads: usize) -> Experiment {
    let mut experiment = Experiment::open(folder, design, shard).expect("a folder");
    assert!(experiment.run(threads, &go_on).expect("trials"));
    experiment
}

/// Every file of a folder, by name.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry"));
    let mut files: Vec<_> = entries
        .map(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            (name, fs::read(entry.path()).expect("a file"))
        })
        .collect();
    files.sort();
    files
}

fn assert_same(a: &Path, b: &Path) {
    let (a, b) = (files(a), files(b));
    let names = |files: &[(String, Vec<u8>)]| -> Vec<String> {
        files.iter().map(|(name, _)| name.clone()).collect()
    };
    assert_eq!(names(&a), names(&b));
    for ((name, a), (_, b)) in a.iter().zip(&b) {
        assert!(a == b, "{name} differs");
    }
}

#[test]
fn threads_interrupts_and_shards_leave_no_trace() {
    let design = tiny();
    let straight = TempDir::new().unwrap();
    let experiment = run(straight.path(), &design, Shard::WHOLE, 1);
    report::write(&experiment, 1).expect("a report");
    drop(experiment);
    assert_eq!(files(straight.path()).len(), 2 + report::FILES.len());

    let threaded = TempDir::new().unwrap();
    let experiment = run(threaded.path(), &design, Shard::WHOLE, 2);
    report::write(&experiment, 2).expect("a report");
    assert_same(straight.path(), threaded.path());

    // Stopped after three trials, the fourth half written.
    let interrupted = TempDir::new().unwrap();
    let seen = AtomicUsize::new(0);
    let mut experiment = Experiment::open(interrupted.path(), &design, Shard::WHOLE).unwrap();
    let complete = experiment.run(2, &|_| {
        if seen.fetch_add(1, Ordering::Relaxed) < 2 {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    });
    assert!(!complete.expect("trials"));
    let reported = report::write(&experiment, 1).expect_err("not complete").to_string();
    assert!(reported.contains("trials are missing"), "{reported}");
    drop(experiment);
    let lines = interrupted.path().join("trials.jsonl");
    let mut text = fs::read(&lines).unwrap();
    text.extend(b"{\"trial\":{\"level\":1,\"ma");
    fs::write(&lines, text).unwrap();
    let mut experiment = Experiment::open(interrupted.path(), &design, Shard::WHOLE).unwrap();
    let before = experiment.records().len();
    assert!((3..=4).contains(&before), "{before}");
    let again = AtomicUsize::new(0);
    let complete = experiment.run(2, &|_| {
        again.fetch_add(1, Ordering::Relaxed);
        ControlFlow::Continue(())
    });
    assert!(complete.expect("trials"));
    assert_eq!(before + again.into_inner(), experiment.trials());
    report::write(&experiment, 1).expect("a report");
    assert_same(straight.path(), interrupted.path());

    // Three shares, merged in another order; one more than needed.
    let shares = TempDir::new().unwrap();
    let folders: Vec<_> = [3, 1, 2]
        .map(|index| {
            let folder = shares.path().join(index.to_string());
            let share = run(&folder, &design, Shard { index, of: 3 }, 1);
            let reported = report::write(&share, 1).expect_err("a share").to_string();
            assert!(reported.contains("merge"), "{reported}");
            folder
        })
        .into();
    let merged = TempDir::new().unwrap();
    let reported = Experiment::merge(merged.path(), &folders[..2]).expect_err("one is missing");
    assert_eq!(std::fs::read_dir(merged.path()).expect("a folder").count(), 0);
    assert!(matches!(reported, ExperimentError::Incomplete { .. }), "{reported}");
    let experiment = Experiment::merge(merged.path(), &folders).expect("all shares");
    report::write(&experiment, 1).expect("a report");
    assert_same(straight.path(), merged.path());
}

#[test]
fn a_report_has_every_part() {
    let folder = TempDir::new().unwrap();
    let design = Design { levels: vec![1.0, 5.0, 9.0], noise_seeds: 1, ..small() };
    let experiment = run(folder.path(), &design, Shard::WHOLE, 2);
    let paths = report::write(&experiment, 2).expect("a report");
    let html = fs::read_to_string(&paths[0]).unwrap();
    for part in ["Difficulty against level", "The order of three maps", "Statistics", "to blame"] {
        assert!(html.contains(part), "{part}");
    }
    // Two panels of two figures and one of the rules; three pictures of each level's map.
    assert_eq!(html.matches("<svg").count(), 5);
    assert_eq!(html.matches("data:image/png;base64,").count(), 9);
    for outside in ["http://", "https://", "<script", "<link", "NaN", "inf"] {
        let text = html.replace("http://www.w3.org/2000/svg", "");
        let found = text
            .split("base64,")
            .any(|piece| piece.split_once('"').map_or(piece, |(_, after)| after).contains(outside));
        assert!(!found, "{outside}");
    }
    let rows = experiment.trials();
    let csv = fs::read_to_string(&paths[2]).unwrap();
    assert_eq!(csv.lines().count(), rows + 1);
    assert!(csv.starts_with("level,map,noise,operator,end,difficulty,mapping,navigation,e_cov,"));
}

#[test]
fn csv_and_parquet_hold_the_same_numbers() {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    let design = tiny();
    let mut records = made_records(&design, |level, map| 0.1 * level as f64 + f64::from(map) / 3.0);
    records[0].scores.relative_error_far = Some(0.25);
    // More than signed numbers hold.
    records[1].world_seed = Seed(u64::MAX - 3);
    let records: Vec<&Record> = records.iter().collect();
    let columns = table::columns(&design, &records);
    let mut file = tempfile::tempfile().unwrap();
    file.write_all(&table::parquet(&columns).expect("a file")).unwrap();
    let reader = SerializedFileReader::new(file).expect("its own file");
    let csv = table::csv(&columns).expect("a file");
    let mut csv = csv::Reader::from_reader(&csv[..]);
    let head = csv.headers().unwrap().clone();
    let rows = csv.records().zip(reader.get_row_iter(None).expect("rows"));
    let mut count = 0;
    for (line, row) in rows {
        let (line, row) = (line.unwrap(), row.unwrap());
        for ((name, cell), (other, field)) in head.iter().zip(&line).zip(row.get_column_iter()) {
            assert_eq!(name, other);
            match &field {
                Field::Null => assert_eq!(cell, ""),
                Field::Double(x) => assert_eq!(cell.parse(), Ok(*x)),
                Field::ULong(n) => assert_eq!(cell.parse(), Ok(*n)),
                Field::Str(text) => assert_eq!(cell, text.as_str()),
                other => panic!("{other:?}"),
            }
        }
        count += 1;
    }
    assert_eq!(count, records.len());
}

#[test]
fn folders_of_other_experiments_are_refused() {
    let folder = TempDir::new().unwrap();
    let design = tiny();
    drop(Experiment::open(folder.path(), &design, Shard::WHOLE).unwrap());
    let open = |design: &Design, shard| {
        Experiment::open(folder.path(), design, shard).expect_err("another").to_string()
    };
    let reported = open(&Design { maps: 3, ..design.clone() }, Shard::WHOLE);
    assert!(reported.contains("`maps` is 2, expected 3"), "{reported}");
    let reported = open(&design, Shard { index: 1, of: 2 });
    assert!(reported.contains("share 1/1, expected 1/2"), "{reported}");
    let reported = open(&Design { maps: 0, ..design.clone() }, Shard::WHOLE);
    assert!(reported.contains("`maps` must be a whole number from 2 to 1000, got 0"), "{reported}");

    let head = folder.path().join("experiment.json");
    let text = fs::read_to_string(&head).unwrap();
    fs::write(&head, text.replacen("\"version\": 3", "\"version\": 9", 1)).unwrap();
    let reported = open(&design, Shard::WHOLE);
    assert!(reported.contains("version 9, expected 3"), "{reported}");
    fs::write(&head, "no json").unwrap();
    assert!(open(&design, Shard::WHOLE).contains("this is not an experiment"));
    fs::remove_file(&head).unwrap();
    fs::write(folder.path().join("trials.jsonl"), "a trial\n").unwrap();
    assert!(open(&design, Shard::WHOLE).contains("no experiment.json"));
    // Trials that this program cannot make again are not deleted.
    let foreign = Experiment::fresh(folder.path(), &design, Shard::WHOLE).expect_err("foreign");
    assert!(foreign.to_string().contains("no experiment.json"), "{foreign}");
    assert_eq!(fs::read(folder.path().join("trials.jsonl")).unwrap(), b"a trial\n");
    // Neither is the report of another program.
    let other = TempDir::new().unwrap();
    fs::write(other.path().join("report.html"), "of a proof").unwrap();
    drop(Experiment::fresh(other.path(), &design, Shard::WHOLE).expect("a folder"));
    assert!(other.path().join("report.html").exists());
    fs::write(&head, "no json").unwrap();
    let old = folder.path().join("report.html");
    fs::write(&old, "an earlier report").unwrap();
    // A new experiment works, but not while another process writes to this one.
    drop(Experiment::fresh(folder.path(), &design, Shard::WHOLE).expect("a folder"));
    assert!(!old.exists(), "it would pass for that of the new experiment");
    let running = run(folder.path(), &design, Shard::WHOLE, 2);
    let lines = folder.path().join("trials.jsonl");
    let (head_before, lines_before) = (fs::read(&head).unwrap(), fs::read(&lines).unwrap());
    let other = Design { maps: 3, ..design.clone() };
    let busy = Experiment::fresh(folder.path(), &other, Shard::WHOLE).expect_err("busy");
    assert!(matches!(busy, ExperimentError::Busy(_)), "{busy}");
    assert_eq!((fs::read(&head).unwrap(), fs::read(&lines).unwrap()), (head_before, lines_before));
    drop(running);
    drop(Experiment::fresh(folder.path(), &design, Shard::WHOLE).expect("a folder"));
    drop(Experiment::open(folder.path(), &design, Shard::WHOLE).expect("again"));
}

#[test]
fn bad_lines_and_other_code_are_reported() {
    let folder = TempDir::new().unwrap();
    let design = Design { noise_seeds: 1, ..tiny() };
    drop(run(folder.path(), &design, Shard::WHOLE, 2));
    let lines = folder.path().join("trials.jsonl");
    let text = fs::read_to_string(&lines).unwrap();
    let open = |text: &str| {
        fs::write(&lines, text).unwrap();
        Experiment::open(folder.path(), &design, Shard::WHOLE).expect_err("bad").to_string()
    };
    let first = text.lines().next().unwrap();
    assert!(open(&format!("{text}{first}\n")).contains("occurs twice"));
    assert!(open(&format!("{text}{{}}\n")).contains("line 7: missing field"));
    let other = first.replacen("\"map\":0", "\"map\":77", 1);
    assert!(open(&format!("{other}\n")).contains("a trial of another design"));
    let changed = first.replacen("\"log_digest\":\"", "\"log_digest\":\"0", 1);
    let reported = open(&format!("{changed}\n"));
    assert!(
        reported.contains("the trial of map 0 of level 1 with noise 0 by nearest"),
        "{reported}"
    );
    fs::write(&lines, [0xff, 0xfe, b'\n']).unwrap();
    let reported = Experiment::open(folder.path(), &design, Shard::WHOLE).expect_err("bad");
    assert!(reported.to_string().contains("not text"), "{reported}");
}

#[test]
fn records_say_how_far_off_the_last_pose_is() {
    let folder = TempDir::new().unwrap();
    let design = tiny();
    let experiment = run(folder.path(), &design, Shard::WHOLE, 2);
    let mut records: Vec<Record> = experiment.records().cloned().collect();
    drop(experiment);
    assert!(records.iter().all(|record| record.pose_error.is_some_and(|error| error < 0.2)));
    records[0].pose_error = Some(4.27);
    records[1].pose_error = None;
    assert_eq!(records[0].end_text(), "time up, lost: 4.3 m off");
    assert_eq!(records[1].end_text(), "time up");
    let columns = table::columns(&design, &records.iter().collect::<Vec<_>>());
    let last = columns.last().expect("columns");
    assert_eq!(last.name, "pose_error");
    let table::Values::Real(values) = &last.values else { panic!("{last:?}") };
    assert_eq!(values[..2], [Some(4.27), None]);

    // A folder of an earlier version, which continues.
    let lines = folder.path().join("trials.jsonl");
    let newer = TempDir::new().unwrap();
    for name in ["experiment.json", "trials.jsonl"] {
        fs::copy(folder.path().join(name), newer.path().join(name)).unwrap();
    }
    let earlier = fs::read_to_string(&lines).unwrap();
    let earlier: Vec<String> = earlier
        .lines()
        .map(|line| {
            let (before, rest) = line.split_once(",\"pose_error\":").expect("a pose error");
            let (_, after) = rest.split_once(',').expect("more fields");
            format!("{before},{after}\n")
        })
        .collect();
    fs::write(&lines, earlier.concat()).unwrap();
    let again = Experiment::open(folder.path(), &design, Shard::WHOLE).expect("the same trials");
    assert!(again.records().all(|record| record.pose_error.is_none()));
    drop(again);
    // Joined with what a later version found, in either order: what is known stays.
    let parts = [folder.path().to_owned(), newer.path().to_owned()];
    for order in [[0, 1], [1, 0]] {
        let (merged, parts) = (TempDir::new().unwrap(), order.map(|i| parts[i].clone()));
        let merged = Experiment::merge(merged.path(), &parts).expect("the same trials");
        assert!(merged.records().all(|record| record.pose_error.is_some()), "{order:?}");
    }
}

#[test]
fn a_folder_is_one_process_at_a_time() {
    let folder = TempDir::new().unwrap();
    let first = Experiment::open(folder.path(), &tiny(), Shard::WHOLE).unwrap();
    let reported = Experiment::open(folder.path(), &tiny(), Shard::WHOLE).expect_err("busy");
    assert!(matches!(reported, ExperimentError::Busy(_)), "{reported}");
    drop(first);
    drop(Experiment::open(folder.path(), &tiny(), Shard::WHOLE).expect("free again"));
}

#[test]
fn folders_that_cannot_be_written_are_reported() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let reported = Experiment::open(&file, &tiny(), Shard::WHOLE).expect_err("a file").to_string();
    assert!(reported.contains(&file.display().to_string()), "{reported}");
    let reported = Experiment::merge(folder.path(), &[folder.path().join("none")]);
    assert!(reported.expect_err("no share").to_string().contains("holds no share"));
    let reported = Experiment::merge(folder.path(), &[]).expect_err("none").to_string();
    assert!(reported.contains("no folders to merge"), "{reported}");
}

#[test]
fn shares_of_designs_that_are_not_allowed_are_refused() {
    let (folder, merged) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    drop(Experiment::open(folder.path(), &tiny(), Shard::WHOLE).unwrap());
    let head = folder.path().join("experiment.json");
    let text = fs::read_to_string(&head).unwrap();
    let maps = format!("\"maps\": {}", tiny().maps);
    for (field, other) in [(maps.as_str(), "\"maps\": 4294967295"), ("\"of\": 1", "\"of\": 0")] {
        assert!(text.contains(field), "{text}");
        fs::write(&head, text.replacen(field, other, 1)).unwrap();
        let error = Experiment::merge(merged.path(), &[folder.path().to_owned()]);
        let error = error.expect_err("not allowed").to_string();
        let name = field.split('"').nth(1).unwrap().replace("of", "shard");
        assert!(error.contains("experiment.json") && error.contains(&name), "{error}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_in_a_files_place_is_not_read() {
    let folder = TempDir::new().unwrap();
    drop(Experiment::open(folder.path(), &tiny(), Shard::WHOLE).unwrap());
    let lines = folder.path().join("trials.jsonl");
    fs::remove_file(&lines).unwrap();
    std::os::unix::fs::symlink("/dev/zero", &lines).unwrap();
    let reported = Experiment::open(folder.path(), &tiny(), Shard::WHOLE).expect_err("a device");
    assert!(reported.to_string().contains("this is not a file"), "{reported}");
}

#[test]
fn variance_belongs_to_maps_policies_and_noise() {
    let both = vec![PolicyKind::Nearest, PolicyKind::Corridors];
    let design = Design { policies: both, ..small() };
    let records: Vec<Record> = design
        .trials()
        .into_iter()
        .map(|trial| {
            let policy = f64::from(u8::from(trial.policy == PolicyKind::Corridors));
            let noise = 0.1 * f64::from(trial.noise);
            let difficulty = f64::from(trial.level) + 2.0 * policy + noise;
            Record { trial, ..record(0, 0, 0, difficulty) }
        })
        .collect();
    let found = analyse(&design, &records.iter().collect::<Vec<_>>());
    let [d, ..] = &found.main.components[..] else { panic!("no components") };
    assert_eq!(d.symbol, "D");
    let share = |effect: &str| d.components.share(effect).expect("a share").value;
    // Five levels of two equal maps: 20 / 9; two policies 2 apart: 2; two seeds 0.1 apart: 0.005, half of which is in
    // the means of maps.
    let (map, policy, noise) = (20.0 / 9.0 - 0.005 / 2.0, 2.0, 0.005);
    let all = map + policy + noise;
    assert!((share("map") - map / all).abs() < 1e-9, "{d:?}");
    assert!((share("policy") - policy / all).abs() < 1e-9, "{d:?}");
    assert!((share("noise") - noise / all).abs() < 1e-9, "{d:?}");
    assert_eq!(share("map x policy"), 0.0, "{d:?}");
    // One seed: nothing is repeated.
    assert!(found.replay.components.is_empty());
}

#[test]
fn policies_averaged_and_alone_differ() {
    let design = small();
    let records = made_records(&design, |level, map| level as f64 + 0.1 * f64::from(map));
    let records: Vec<&Record> = records.iter().collect();
    let found = analyse(&design, &records);
    assert_eq!((found.main.trials, found.main.values.len()), (5 * 2 * 2, 10));
    assert_eq!((found.replay.trials, found.replay.values.len()), (5 * 2, 5));
    assert_eq!(found.main.policies.len(), 1);
    assert_eq!(found.replay.policies.len(), 2);
    let order = &found.main.orders[0];
    assert_eq!((order.neighbours_in_order, order.neighbours()), (4, 4));
    let rho = order.rho.expect("a correlation");
    assert!(rho.value > 0.97 && rho.low > 0.9 && rho.high <= 1.0);
    let shares = order.shares.expect("shares");
    assert!(shares.level > 0.99 && shares.noise.is_some_and(|noise| noise < 1e-9));
    assert_eq!(found.main.relative[0].ranks, [1.0, 2.0, 3.0]);
    assert_eq!(found.weights.len(), 20);
    // One map per level: no spread within levels, and no interval but the whole scale.
    let alone = found.replay.orders[0].means[0].mean;
    assert_eq!((alone.low, alone.high), (0.0, 10.0));
    assert_eq!(found.replay.orders[0].shares, None);
}
