//! Drivers as processes, well-behaved and not: the trial ends with a reason, and has a log and scores.
#![cfg(all(unix, feature = "driver"))]

use std::process::Command;
use std::time::Duration;

use envgen::hallway::HallwaySpec;
use envgen::scenario::{Person, Reaction, Scenario, ScenarioSpec};
use envgen::{Blueprint, Seed, Spec, World};
use mapping_trial::driver::{Driver, Hello, Limits, MAX_LINE};
use mapping_trial::flat::FlatSimulator;
use mapping_trial::trial::{EndReason, PartRole, Trial, TrialReport, TrialSettings};

/// The hello of a driver in sh.
const HELLO: &str = r#"read hello; echo '{"protocol": "envgen-driver 1", "name": "sh"}';"#;

/// Limits that are long enough for a busy machine.
const PATIENCE: Limits = Limits { reply: Duration::from_secs(60), total: Duration::from_secs(600) };

fn world() -> World {
    HallwaySpec { segments: 4, ..Default::default() }.generate(Seed(7)).expect("a hall").to_world()
}

/// A trial of ten seconds that a script of sh drives.
fn run(script: &str, limits: Limits) -> (Trial<FlatSimulator>, TrialReport, Driver) {
    let settings = TrialSettings { time_limit: 10.0, ..TrialSettings::default() };
    let mut command = Command::new("sh");
    command.args(["-c", script]);
    let driver = Driver::start(command, limits, std::io::sink()).expect("sh");
    let world = world();
    let mut builder = Trial::builder(&world, settings);
    driver.greet(&Hello::new(&builder.setup().expect("a start")));
    let mut trial = builder.parts(driver.parts()).build_flat().expect("a trial");
    while trial.step() {}
    let reference = trial.reference(&world).expect("a reference");
    let report = trial.report(&world, &reference).expect("a report");
    (trial, report, driver)
}

/// Returns why the trial of a script ends. It also checks that the log can be replayed, and that the
/// report has the reason.
fn failure(script: &str, limits: Limits) -> String {
    let (trial, report, driver) = run(script, limits);
    assert_eq!(report.robots[0].end, Some(EndReason::Failed), "{script}");
    assert_eq!(report.failure, driver.failure(), "{script}");
    assert!(report.scores.difficulty.is_finite());
    let again = trial.log().replay().expect("its own log");
    assert_eq!(again.trajectory(0), trial.trajectory(0), "{script}");
    assert_eq!(again.end_of(0), trial.end_of(0), "{script}");
    driver.end(Some(&report));
    report.failure.expect("a reason")
}

#[test]
fn a_driver_in_sh_drives_and_its_trial_runs_again() {
    // The last line has no answer, and the script writes it to the file.
    let folder = tempfile::tempdir().expect("a folder");
    let last = folder.path().join("last");
    let script = format!(
        r#"{HELLO} while read line; do case "$line" in
            *'"type":"end"'*) echo "$line" > {}; exit;;
            *) echo '{{"speed": 0.4, "turn_rate": 0}}';; esac; done"#,
        last.display()
    );
    let (trial, report, driver) = run(&script, PATIENCE);
    assert_eq!((report.robots[0].end, &report.failure), (Some(EndReason::TimeLimit), &None));
    assert!(report.scores.distance > 1.0, "{}", report.scores.distance);
    let parts: Vec<_> = report.foreign.iter().map(|part| (part.role, part.name.as_str())).collect();
    assert_eq!(parts, [(PartRole::Policy, "driver sh")]);
    assert!(report.headline().starts_with("driver sh with scan_to_map"), "{}", report.headline());
    let again = trial.log().replay().expect("its own log");
    assert_eq!(again.trajectory(0), trial.trajectory(0));
    driver.end(Some(&report));
    let reported: serde_json::Value =
        serde_json::from_slice(&std::fs::read(last).expect("the last line")).expect("JSON");
    assert_eq!(reported["ends"][0]["reason"], "time_limit");
    assert_eq!(reported["scores"]["coverage"].as_f64(), Some(report.scores.coverage));
    assert!(reported["failure"].is_null());
}

#[test]
fn a_drivers_errors_are_reported() {
    let reply = r#"read line; echo '{"speed": 0.4, "turn_rate": 0}';"#;
    let drives = |then: &str| format!("{HELLO} {reply} {reply} {then}");
    for (script, parts) in [
        (String::new(), ["it ended (exit", "status: 0)", "(answer to the hello)"]),
        (
            "read hello; echo garbage; cat > /dev/null".to_owned(),
            ["a line that is not an answer: expected value", "`garbage`", "(answer to the hello)"],
        ),
        (drives("exit 3"), ["it ended (exit status: 3)", "(observation 2", "at 0.10 s)"]),
        (drives("kill -9 $$"), ["it ended (signal: 9", "(observation 2", "at 0.10 s)"]),
        (
            drives("echo Oh no >&2; exit 1"),
            ["(exit status: 1)", "the last line of its standard error", "`Oh no`"],
        ),
        (
            drives("read line; printf '{\"speed\":'"),
            ["it ended (exit status: 0)", "after 9 bytes of a line without its end", "at 0.10 s"],
        ),
        (
            drives("read line; echo '{\"speed\": NaN}'; cat > /dev/null"),
            ["`speed`: expected value", "`{\"speed\": NaN}`", "observation 2"],
        ),
        (
            drives("read line; echo '[]'; cat > /dev/null"),
            ["a line that is not an answer", "`[]`", "observation 2"],
        ),
        (
            drives("read line; echo null; cat > /dev/null"),
            ["a line that is not an answer", "null, expected an object at", "observation 2"],
        ),
        (
            drives(
                "read line; echo '{\"speed\": 0, \"turn_rate\": 0, \"pose\": [0, 0, 0]}'; cat > /dev/null",
            ),
            [
                "`pose` must be absent unless `slam` is true in the hello",
                "got a pose",
                "observation 2",
            ],
        ),
        (
            // A reason is not cut to the length of an excerpt.
            drives(r#"read line; echo "{\"failed\": \"$(seq -s ' ' 50)\"}"; cat > /dev/null"#),
            ["it gave up: 1 2 3", "48 49 50 (", "observation 2"],
        ),
        (
            drives("exec >&-; cat > /dev/null"),
            ["it closed its output, but has not ended", "(observation 2", "at 0.10 s"],
        ),
    ] {
        let found = failure(&script, PATIENCE);
        for part in parts {
            assert!(found.contains(part), "{script}: {found}");
        }
    }
}

#[test]
fn a_field_of_a_reply_that_is_null_is_left_out() {
    let reply = r#"{"speed": 0.4, "turn_rate": 0, "id": null, "want": null, "pose": null,
        "map": null, "finished": null, "stuck": null, "failed": null}"#;
    let reply = reply.replace('\n', "");
    let (_, report, _) =
        run(&format!("{HELLO} while read line; do echo '{reply}'; done"), PATIENCE);
    assert_eq!((report.robots[0].end, report.failure), (Some(EndReason::TimeLimit), None));
}

#[test]
fn an_answer_to_the_last_line_is_no_error() {
    let reply = r#"echo '{"speed": 0.4, "turn_rate": 0}';"#;
    let (_, report, driver) = run(&format!("{HELLO} while read line; do {reply} done"), PATIENCE);
    driver.end(Some(&report));
    assert_eq!((report.failure.clone(), driver.failure()), (None, None));
}

/// The hello has the poses where robots start beside people, and the first observations agree with it.
#[test]
fn a_hello_has_the_starts_of_a_trial_with_people() {
    let world = world();
    let settings = TrialSettings { robots: 3, time_limit: 1.0, ..TrialSettings::default() };
    let alone = Trial::builder(&world, settings.clone()).setup().expect("starts").starts.to_vec();
    let mut scenario =
        Scenario::new(&world, &ScenarioSpec::default(), Seed(1)).expect("a scenario");
    // Somebody where the second robot would start.
    let position = alone[1].position;
    scenario.people =
        vec![Person { position, heading: 0.0, speed: 1.0, reaction: Reaction::Regular }];
    let mut builder = Trial::builder(&world, settings).scenario(scenario);
    let hello = serde_json::to_value(Hello::new(&builder.setup().expect("starts"))).expect("JSON");
    let trial = builder.build_flat().expect("a trial");
    let starts: Vec<[f64; 3]> = (0..3)
        .map(|robot| trial.trajectory(robot).poses[0])
        .map(|pose| [pose.position.x, pose.position.y, pose.heading])
        .collect();
    assert_eq!(hello["starts"], serde_json::json!(starts));
    assert_ne!(starts[1][..2], [position.x, position.y]);
}

#[test]
fn a_line_without_an_end_is_not_kept() {
    let script = format!("{HELLO} read line; head -c 1000000000 /dev/zero | tr '\\0' x");
    let found = failure(&script, PATIENCE);
    assert!(found.contains(&format!("a line of more than {MAX_LINE} bytes")), "{found}");
}

#[test]
fn a_driver_that_does_not_wait_is_an_error() {
    let found = failure(&format!("{HELLO} yes '{{\"finished\": false}}'"), PATIENCE);
    let either = ["an unexpected line", "got missing"];
    assert!(either.iter().any(|part| found.contains(part)), "{found}");
    let found = failure(&format!("{HELLO} yes '{{\"speed\": 0, \"turn_rate\": 0}}'"), PATIENCE);
    let either = ["an unexpected line", "it answers lines that it has not read"];
    assert!(either.iter().any(|part| found.contains(part)), "{found}");
}

#[test]
fn an_answer_too_many_is_an_error() {
    // Both answers are written at once. The second of two writes could be late, and would be taken for the answer to
    // the next line.
    let reply = r#"'{"speed": 0.4, "turn_rate": 0}'"#;
    let say = r"printf '%s\n'";
    let script = format!(
        "{HELLO} read line; {say} {reply} {reply}; while read line; do {say} {reply}; done"
    );
    let found = failure(&script, PATIENCE);
    assert!(found.contains("expected one line per line sent"), "{found}");
}

#[test]
fn an_error_in_the_last_answer_is_in_the_report() {
    // After ten seconds the time is up, and the policy is not asked for a command.
    let hello = HELLO.replace("\"sh\"", "\"sh\", \"slam\": true");
    let script = format!(
        r#"{hello} while read line; do case "$line" in
            *'"time":10.0'*) echo garbage; exec cat > /dev/null;;
            *) echo '{{"speed": 0.4, "turn_rate": 0}}';; esac; done"#
    );
    let (_, report, driver) = run(&script, PATIENCE);
    let reason = driver.failure().expect("garbage");
    assert!(reason.contains("(observation 200, at 10.00 s)"), "{reason}");
    assert_eq!((report.robots[0].end, report.failure), (Some(EndReason::TimeLimit), Some(reason)));
}

#[test]
fn a_driver_that_hangs_or_crawls_is_ended() {
    let short = Limits { reply: Duration::from_millis(300), ..PATIENCE };
    let found = failure(&format!("{HELLO} read line; exec sleep 1000"), short);
    assert_eq!(found, "no answer within 0.3 s (observation 0, at 0.00 s)");
    let slow = Limits { total: Duration::from_millis(500), ..PATIENCE };
    let script = format!(
        "{HELLO} while read line; do sleep 0.1; echo '{{\"speed\": 0, \"turn_rate\": 0}}'; done"
    );
    let found = failure(&script, slow);
    assert!(found.starts_with("its answers took more than 0.5 s together (observation"), "{found}");
}

#[test]
fn no_process_stays() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("pid");
    let script = format!("echo $$ > {}; {HELLO} read line; exec sleep 1000", file.display());
    let short = Limits { reply: Duration::from_millis(300), ..PATIENCE };
    let (trial, _, driver) = run(&script, short);
    drop((trial, driver));
    let pid = std::fs::read_to_string(file).expect("a number");
    let alive = Command::new("kill").args(["-0", pid.trim()]).output().expect("kill");
    assert!(!alive.status.success(), "process {pid} is still there");
}

#[test]
fn a_driver_that_is_not_there_cannot_be_started() {
    let command = Command::new("no such program");
    let error = Driver::start(command, PATIENCE, std::io::sink()).expect_err("not there");
    assert!(error.to_string().starts_with("it cannot be started: "), "{error}");
}

#[test]
fn what_a_driver_estimates_is_scored() {
    let hello = HELLO.replace("\"sh\"", "\"sh\", \"slam\": true");
    // The driver reports the robot at its start, in a map of one wall.
    let map = r#"{"origin": [0, 0], "resolution": 0.5, "cols": 1, "rows": 1, "cells": "ZA=="}"#;
    let script = format!(
        "{hello} while read line; do echo '{{\"speed\": 0.4, \"turn_rate\": 0, \"pose\": [9, 9, 0], \
         \"map\": {map}}}'; done"
    );
    let (trial, report, driver) = run(&script, PATIENCE);
    assert_eq!((report.robots[0].end, &report.failure), (Some(EndReason::TimeLimit), &None));
    let names: Vec<_> = report.foreign.iter().map(|part| part.role).collect();
    assert_eq!(names, [PartRole::Slam, PartRole::Policy]);
    let headline = report.headline();
    assert!(headline.starts_with("driver sh with lms200_mm, "), "{headline}");
    let last = trial.autonomy().slam().trajectory(0).last().copied().expect("a pose");
    assert_eq!((last.position.x, last.position.y), (9.0, 9.0));
    assert!(report.scores.trajectory_error > 1.0 && report.scores.coverage == 0.0);
    // In a replay, the built-in SLAM takes the place of the driver's. The robot drives the same path.
    let again = trial.log().replay().expect("its own log");
    assert_eq!(again.trajectory(0), trial.trajectory(0));
    assert_eq!(again.foreign(), trial.foreign());
    driver.end(Some(&report));
}
