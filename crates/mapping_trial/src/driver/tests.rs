//! Drivers on threads of the test, over pipes.

use std::io::{BufRead, BufReader, Write};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use envgen::geometry::{Pose, Rect};
use glam::DVec2;
use serde_json::{Value, json};

use super::*;
use crate::backend::{Command as Drive, Observation};
use crate::lidar::{NO_ECHO, Scan};
use crate::map::{CLAMP, CellIndex, Estimate, OccupancyMap};
use crate::odometry::Increment;
use crate::policy::{Decision, ExplorationPolicy, PolicyInput};
use crate::slam::Slam;
use crate::trial::{Setup, TrialSettings};

/// Long enough for a busy machine.
const PATIENCE: Limits = Limits { reply: Duration::from_secs(60), total: Duration::from_secs(600) };

/// A driver that answers each line by a function until that returns none or half a line. The thread
/// returns the lines sent to it.
fn driver(
    limits: Limits,
    mut answer: impl FnMut(&Value) -> Option<String> + Send + 'static,
) -> (Driver, JoinHandle<Vec<Value>>) {
    let (questions, input) = std::io::pipe().expect("a pipe");
    let (output, mut answers) = std::io::pipe().expect("a pipe");
    let reported = thread::spawn(move || {
        let mut reported = Vec::new();
        for line in BufReader::new(questions).lines() {
            let line: Value = serde_json::from_str(&line.expect("text")).expect("JSON");
            reported.push(line);
            match answer(&reported[reported.len() - 1]) {
                Some(text) => {
                    answers.write_all(text.as_bytes()).expect("the trial reads");
                    if !text.ends_with('\n') {
                        break;
                    }
                }
                None => break,
            }
        }
        reported
    });
    (Driver::connect(input, output, limits), reported)
}

fn area() -> Rect {
    Rect::new(DVec2::ZERO, DVec2::splat(48.0))
}

fn hello(robots: usize) -> Hello {
    let starts = vec![Pose::new(1.0, 2.0, 0.5); robots];
    Hello::new(&Setup {
        settings: &TrialSettings::default(),
        starts: &starts,
        area: area(),
        doors: false,
        scenario: None,
    })
}

/// The decision of a policy on an observation at a pose.
fn decide(
    policy: &mut DriverPolicy,
    robot: usize,
    seen: &Observation,
    pose: Pose,
    map: &OccupancyMap,
) -> Decision {
    let TrialSettings { body, laser, .. } = TrialSettings::default();
    policy.decide(&PolicyInput {
        robot,
        estimates: &[Estimate { pose, ..Estimate::default() }; 2],
        map,
        scan: &Scan { ranges: Vec::new() },
        since_scan: Pose::default(),
        water: &[],
        seen,
        body: &body,
        laser: &laser,
        area: area(),
        doors: false,
    })
}

/// The same if neither pose nor map matter.
fn decide_at(policy: &mut DriverPolicy, tick: u32) -> Decision {
    decide(policy, 0, &seen(tick), Pose::default(), &OccupancyMap::new())
}

fn greeting(line: &Value, more: &str) -> Option<String> {
    (line["type"] == "hello")
        .then(|| format!("{{\"protocol\": \"{PROTOCOL}\", \"name\": \"test\"{more}}}\n"))
}

fn seen(tick: u32) -> Observation {
    let scanned = tick.is_multiple_of(4);
    Observation {
        time: f64::from(tick) * 0.05,
        odometry: Increment { distance: 0.5, turn: 0.25 },
        scan: scanned.then(|| Scan { ranges: vec![f64::from(tick) + 1.0, NO_ECHO, f64::NAN] }),
        water: scanned.then(|| vec![DVec2::new(1.0, f64::from(tick))]),
        bumped: tick == 1,
        battery: 100.0,
    }
}

/// The failure of a driver that answers its first observation with a text.
fn failure(text: &'static str) -> String {
    let (driver, _) = driver(PATIENCE, move |line| {
        greeting(line, "").or_else(|| Some(text.to_owned()).filter(|text| !text.is_empty()))
    });
    driver.greet(&hello(1)).expect("a greeting");
    let mut policy = DriverPolicy::new(&driver);
    assert_eq!(decide_at(&mut policy, 0), Decision::Failed, "{text}");
    // It stays failed.
    assert_eq!(decide_at(&mut policy, 1), Decision::Failed, "{text}");
    assert_eq!(policy.failure().map(str::to_owned), driver.failure());
    driver.failure().expect("a reason")
}

#[test]
fn what_was_measured_between_lines_is_sent_with_the_next() {
    let (driver, reported) = driver(PATIENCE, |line| {
        let command = json!({"speed": 0.1, "turn_rate": 0.2, "id": line["id"]});
        greeting(line, ", \"rate\": 3").or_else(|| Some(format!("{command}\n")))
    });
    assert_eq!(driver.greet(&hello(2)).expect("a greeting").rate, 3);
    let mut policy = DriverPolicy::new(&driver);
    let pose = Pose::new(3.0, 4.0, 5.0);
    for tick in 0..7 {
        for robot in 0..2 {
            let decision = decide(&mut policy, robot, &seen(tick), pose, &OccupancyMap::new());
            let command = Drive { speed: 0.1, turn_rate: 0.2 };
            assert_eq!(decision, Decision::Drive(command));
        }
    }
    driver.end(None);
    drop((driver, policy));
    let reported = reported.join().expect("it ends");
    assert_eq!(reported[0]["protocol"], PROTOCOL);
    assert_eq!(reported[0]["starts"], json!([[1.0, 2.0, 0.5], [1.0, 2.0, 0.5]]));
    assert_eq!(reported[0]["laser"]["beams"], 181);
    let second: Vec<&Value> = reported.iter().filter(|line| line["robot"] == 1).collect();
    let field = |name: &str| second.iter().map(|line| line[name].clone()).collect::<Vec<_>>();
    assert_eq!(field("time"), [0.0, 3.0 * 0.05, 6.0 * 0.05]);
    assert_eq!(field("id"), [1, 3, 5]);
    let increment = |distance: f64, turn: f64| json!({"distance": distance, "turn": turn});
    assert_eq!(
        field("odometry"),
        [increment(0.5, 0.25), increment(1.5, 0.75), increment(1.5, 0.75)]
    );
    assert_eq!(field("scan"), [json!([1.0, 8.19, null]), Value::Null, json!([5.0, 8.19, null])]);
    assert_eq!(field("water")[2], json!([[1.0, 4.0]]));
    assert_eq!(field("bumped"), [false, true, false]);
    assert_eq!(field("pose")[0], json!([3.0, 4.0, 5.0]));
    let last = &reported[reported.len() - 1];
    assert_eq!(last["type"], "end");
}

#[test]
fn the_map_comes_when_it_is_wanted() {
    let (driver, reported) = driver(PATIENCE, |line| {
        let want = if line["id"] == 0 { "[\"map\"]" } else { "[]" };
        let reply = format!("{{\"speed\": 0, \"turn_rate\": 0, \"want\": {want}}}\n");
        greeting(line, "").or(Some(reply))
    });
    driver.greet(&hello(1)).expect("a greeting");
    let mut policy = DriverPolicy::new(&driver);
    let mut map = OccupancyMap::new();
    map.add(CellIndex { col: 0, row: 1 }, CLAMP);
    for tick in 0..3 {
        decide(&mut policy, 0, &seen(tick), Pose::default(), &map);
    }
    driver.end(None);
    drop((driver, policy));
    let reported = reported.join().expect("it ends");
    let maps: Vec<&Value> = reported[1..4].iter().map(|line| &line["map"]).collect();
    assert!(maps[0].is_null() && maps[2].is_null());
    assert_eq!((&maps[1]["cols"], &maps[1]["rows"]), (&json!(32), &json!(32)));
    assert_eq!(maps[1]["origin"], json!([0.0, 0.0]));
}

#[test]
fn a_line_too_many_fails_the_driver_at_the_latest_at_the_end() {
    // Lines after an answer that come while no other is waited for.
    let (driver, _) = driver(PATIENCE, |line| {
        greeting(line, "").or_else(|| {
            let command = json!({"speed": 0.1, "turn_rate": 0.2});
            let extra = if line["id"] == 2 { format!("{command}\n") } else { String::new() };
            Some(format!("{command}\n{extra}"))
        })
    });
    driver.greet(&hello(1)).expect("a greeting");
    let mut policy = DriverPolicy::new(&driver);
    for tick in 0..3 {
        assert_ne!(decide_at(&mut policy, tick), Decision::Failed);
    }
    assert_eq!(driver.failure(), None);
    driver.end(None);
    assert!(
        driver.failure().is_some_and(|reason| reason.contains("0.1")),
        "{:?}",
        driver.failure()
    );
}

#[test]
fn a_driver_may_estimate_for_itself() {
    let cells = "ZGRkZA==";
    let (driver, _) = driver(PATIENCE, move |line| {
        let mut reply = json!({"speed": 0.1, "turn_rate": 0.0});
        if line["id"] == 1 {
            reply["pose"] = json!([7.0, 8.0, 0.0]);
            reply["map"] = json!({"origin": [0.5, 0.5], "resolution": 0.1, "cols": 2, "rows": 2,
                                  "cells": cells});
        }
        greeting(line, ", \"slam\": true").or_else(|| Some(format!("{reply}\n")))
    });
    assert!(driver.greet(&hello(1)).expect("a greeting").slam);
    let start = Pose::new(1.0, 2.0, 0.0);
    let mut slam = DriverSlam::new(&driver, &[start]);
    let mut policy = DriverPolicy::new(&driver);
    for tick in 0..3 {
        slam.step(0, &seen(tick));
        let decision = decide_at(&mut policy, tick);
        assert_eq!(decision, Decision::Drive(Drive { speed: 0.1, turn_rate: 0.0 }));
    }
    let track = slam.trajectory(0);
    assert_eq!(track.len(), 4);
    // The wheels, the driver, the wheels from there.
    assert!((track[1].position.distance(start.position) - 0.5).abs() < 1e-9);
    assert_eq!(track[2], Pose::new(7.0, 8.0, 0.0));
    assert!((track[3].position.distance(track[2].position) - 0.5).abs() < 1e-9);
    assert_eq!(
        slam.map().tiles().flat_map(|(_, odds)| odds).filter(|&&odds| odds == CLAMP).count(),
        16
    );
}

#[test]
fn a_bad_map_fails_the_driver() {
    let (driver, _) = driver(PATIENCE, move |line| {
        let map =
            json!({"origin": [0, 0], "resolution": 0.1, "cols": 2, "rows": 2, "cells": "AA=="});
        let reply = json!({"speed": 0, "turn_rate": 0, "map": map});
        greeting(line, ", \"slam\": true").or_else(|| Some(format!("{reply}\n")))
    });
    driver.greet(&hello(1)).expect("a greeting");
    let mut slam = DriverSlam::new(&driver, &[Pose::default()]);
    slam.step(0, &seen(3));
    let text = "`map.cells` must be 4, one per cell, got 1 bytes (observation 0, at 0.15 s)";
    assert_eq!(driver.failure().as_deref(), Some(text));
    assert_eq!(decide_at(&mut DriverPolicy::new(&driver), 3), Decision::Failed);
    // The wheels continue to the end of the trial.
    slam.step(0, &seen(4));
    assert_eq!(slam.trajectory(0).len(), 3);
}

#[test]
fn bad_answers_fail_the_driver() {
    for (answer, part) in [
        ("garbage\n", "a line that is not an answer: expected value at character 1, in `garbage`"),
        ("{\"speed\": 1, \"turn_rate\": NaN}\n", "`turn_rate`: expected value"),
        ("{\"speed\": 1e9, \"turn_rate\": 0}\n", "`speed` must be from -1000 to"),
        ("{\"failed\": \"no route\"}\n", "it gave up: no route (observation 0, at 0.00 s)"),
        ("", "it closed its output (observation 0"),
        ("{\"speed\": ", "it closed its output after 10 bytes of a line without its end"),
    ] {
        let found = failure(answer);
        assert!(found.contains(part), "{answer}: {found}");
    }
}

#[test]
fn a_bad_hello_is_a_failure_at_once() {
    for (answer, part) in [
        (
            "{\"protocol\": \"envgen-driver 0\", \"name\": \"old\"}\n",
            "`protocol` must be envgen-driver 1",
        ),
        ("Python 3.11.7\n", "in `Python 3.11.7` (answer to the hello)"),
        (
            "{\"protocol\": \"envgen-driver 1\", \"name\": \"a\u{202e}b\"}\n",
            "`name` must be from 1 to 64 printable characters, got `a\\u{202e}b`",
        ),
    ] {
        let (driver, _) = driver(PATIENCE, move |_| Some(answer.to_owned()));
        assert_eq!(driver.greet(&hello(1)), None);
        let found = driver.failure().expect("a reason");
        assert!(found.contains(part), "{found}");
        let mut policy = DriverPolicy::new(&driver);
        assert_eq!(decide_at(&mut policy, 0), Decision::Failed);
    }
}

#[test]
fn a_silent_driver_is_given_up_in_time() {
    let limits = Limits { reply: Duration::from_millis(50), ..PATIENCE };
    let (silence, _held) = std::io::pipe().expect("a pipe");
    let driver = Driver::connect(std::io::sink(), silence, limits);
    assert_eq!(driver.greet(&hello(1)), None);
    assert_eq!(driver.failure().as_deref(), Some("no answer within 0.05 s (answer to the hello)"));
}
