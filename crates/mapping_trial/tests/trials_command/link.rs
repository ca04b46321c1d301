//! The subcommand `envgen-trials link`.

use std::path::Path;

use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec};
use mapping_trial::feedback::Rating;
use mapping_trial::policy::PolicyKind;
use mapping_trial::trial::{Trial, TrialSettings};
use serde_json::Value;

use crate::command::{error, run};

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
    assert_eq!(json["sessions"][0]["unlike_panel"], Value::Null);

    // Ratings that fall with the difficulty, and sessions with another robot.
    assert!(!four.contains("not as in the panel"), "{four}");
    let falls = |text: &str| {
        let after = text.split_once("\n  difficulty: ").expect("a link").1;
        after.lines().nth(1).is_some_and(|line| line.contains("the ratings do not rise with"))
    };
    let correlation =
        json["links"]["difficulty"]["link"]["correlation"].as_f64().expect("a number");
    assert_eq!(falls(&four), correlation <= 0.0);
    for (name, seed, rating) in [("101", 1, 8.0), ("102", 2, 5.0), ("103", 3, 2.0)] {
        session(at, name, seed, Some(rating));
    }
    let report = std::fs::read_to_string(at.join("101/report.json")).expect("a report");
    let wide = report.replace(r#""width":0.497"#, r#""width":0.45"#);
    assert_ne!(wide, report);
    std::fs::write(at.join("101/report.json"), wide).expect("a report");
    let other = linked(&["101/report.json", "102/report.json", "103/report.json"]);
    assert_eq!(falls(&other), correlation > 0.0);
    assert_eq!(other.matches("settings not as in the panel: body").count(), 1, "{other}");

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
