//! Version 1 of the driver protocol: the lines that a trial and a driver exchange.

use envgen::geometry::Pose;
use serde::{Deserialize, Deserializer, Serialize};

use super::error::{DriverError, not_allowed};
use super::grid::Grid;
use crate::backend::{Command, Observation, TICK};
use crate::lidar::Scan;
use crate::names::{is_printable, printable};
use crate::score::Scores;
use crate::setting_limits::number;
use crate::trial::{EndReason, Setup, TrialReport, TrialSettings};

/// Name and version of the protocol, as in the hello of both sides.
pub const PROTOCOL: &str = "envgen-driver 1";

/// Greatest speed in m/s and greatest turn rate in rad/s in a reply. They are clamped to the robot's
/// own limits.
const FASTEST: f64 = 1000.0;

/// Greatest distance of a pose from the origin in metres, and greatest heading in radians.
const FARTHEST: f64 = 1e6;

/// Greatest number of ticks from one observation to the next that a driver may request: 10 s.
const SLOWEST_RATE: u64 = 200;

/// Greatest number of characters of a driver's name, and of its reason for giving up.
const LONGEST_NAME: usize = 64;
const LONGEST_REASON: usize = 500;

/// Number of characters of a driver's line that an error shows.
const EXCERPT: usize = 80;

/// The first line to a driver, which describes the trial.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename = "hello")]
pub struct Hello {
    protocol: &'static str,
    tick: f64,
    time_limit: f64,
    battery: f64,
    robots: usize,
    starts: Vec<[f64; 3]>,
    /// Least x, least y, greatest x and greatest y of the area to map.
    area: [f64; 4],
    /// Whether there are doors that open and close.
    doors: bool,
    robot: RobotNumbers,
    laser: LaserNumbers,
}

#[derive(Clone, Debug, Serialize)]
struct RobotNumbers {
    length: f64,
    width: f64,
    #[serde(rename = "swing_radius")]
    circumscribed_radius: f64,
    max_speed: f64,
    max_turn_rate: f64,
    acceleration: f64,
    turn_acceleration: f64,
}

#[derive(Clone, Debug, Serialize)]
struct LaserNumbers {
    /// Pose in the robot's frame.
    pose: [f64; 3],
    beams: u32,
    first_angle: f64,
    angle_step: f64,
    max_range: f64,
    sigma: f64,
    ticks_per_scan: u32,
}

impl Hello {
    /// Creates the hello of a trial.
    pub fn new(setup: &Setup<'_>) -> Self {
        let Setup { settings, starts, area, doors, .. } = setup;
        let TrialSettings { body: robot, laser, time_limit, .. } = settings;
        Hello {
            protocol: PROTOCOL,
            tick: TICK,
            time_limit: *time_limit,
            battery: robot.battery,
            robots: starts.len(),
            starts: starts.iter().copied().map(triple).collect(),
            area: [area.min.x, area.min.y, area.max.x, area.max.y],
            doors: *doors,
            robot: RobotNumbers {
                length: robot.length,
                width: robot.width,
                circumscribed_radius: robot.circumscribed_radius,
                max_speed: robot.max_speed,
                max_turn_rate: robot.max_turn_rate,
                acceleration: robot.acceleration,
                turn_acceleration: robot.turn_acceleration,
            },
            laser: LaserNumbers {
                pose: triple(robot.laser_pose(Pose::default())),
                beams: laser.beams,
                first_angle: laser.angle(0),
                angle_step: laser.angle(1) - laser.angle(0),
                max_range: laser.max_range,
                sigma: laser.sigma,
                ticks_per_scan: laser.ticks_a_scan,
            },
        }
    }

    /// Number of robots.
    pub(super) fn robots(&self) -> usize {
        self.robots
    }

    /// The greatest range of the laser in metres.
    pub(super) fn max_range(&self) -> f64 {
        self.laser.max_range
    }
}

/// A robot's observation, as a line.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename = "observation")]
pub(super) struct Observed<'a> {
    pub(super) id: u64,
    pub(super) robot: usize,
    pub(super) time: f64,
    pub(super) odometry: Odometry,
    pub(super) scan: Option<&'a [Option<f64>]>,
    pub(super) since_scan: Option<Odometry>,
    pub(super) water: &'a [[f64; 2]],
    pub(super) bumped: bool,
    pub(super) battery: f64,
    pub(super) pose: Option<[f64; 3]>,
    pub(super) map: Option<Grid>,
}

/// What the wheels measured since some time.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Odometry {
    pub(super) distance: f64,
    pub(super) turn: f64,
}

impl Odometry {
    pub(super) fn add(&mut self, seen: &Observation) {
        self.distance += seen.odometry.distance;
        self.turn += seen.odometry.turn;
    }
}

/// The last line to a driver: the result of the trial.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename = "end")]
pub(super) struct Ended<'a> {
    pub(super) ends: Vec<RobotEnded>,
    pub(super) scores: Option<&'a Scores>,
    pub(super) failure: Option<&'a str>,
}

/// Why and when one robot's part ended.
#[derive(Clone, Debug, Serialize)]
pub(super) struct RobotEnded {
    reason: Option<EndReason>,
    time: f64,
}

impl<'a> Ended<'a> {
    pub(super) fn new(report: Option<&'a TrialReport>, failure: Option<&'a str>) -> Self {
        let robots = report.iter().flat_map(|report| &report.robots);
        Ended {
            ends: robots.map(|robot| RobotEnded { reason: robot.end, time: robot.time }).collect(),
            scores: report.map(|report| &report.scores),
            failure,
        }
    }
}

/// A driver's answer to the hello.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub struct Greeting {
    protocol: String,
    /// The driver's name.
    pub name: String,
    /// Number of ticks from one observation of a robot to the next.
    #[serde(default = "every_tick", deserialize_with = "rate_or_every_tick")]
    pub rate: u64,
    /// Whether the driver estimates poses and map itself.
    #[serde(default, deserialize_with = "slam_or_none")]
    pub slam: bool,
}

fn every_tick() -> u64 {
    1
}

/// A field that is `null` counts as left out, as in replies.
fn rate_or_every_tick<'de, D: Deserializer<'de>>(from: D) -> Result<u64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or_else(every_tick))
}

fn slam_or_none<'de, D: Deserializer<'de>>(from: D) -> Result<bool, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or_default())
}

impl Greeting {
    pub(super) fn parse(line: &[u8]) -> Result<Greeting, DriverError> {
        let greeting: Greeting = read(line)?;
        let Greeting { protocol, name, rate, .. } = &greeting;
        if protocol != PROTOCOL {
            return Err(not_allowed("protocol", excerpt(protocol), PROTOCOL));
        }
        if name.trim().is_empty()
            || name.chars().count() > LONGEST_NAME
            || !name.chars().all(is_printable)
        {
            let allowed = format!("from 1 to {LONGEST_NAME} printable characters");
            return Err(not_allowed("name", format!("`{}`", excerpt(name)), allowed));
        }
        if !(1..=SLOWEST_RATE).contains(rate) {
            return Err(not_allowed("rate", rate, format!("from 1 to {SLOWEST_RATE} ticks")));
        }
        Ok(greeting)
    }
}

/// What a driver may request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Want {
    Map,
}

/// What a reply asks the robot to do.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Wish {
    Drive(Command),
    Finished,
    Stuck,
    GiveUp(String),
}

/// A driver's answer to an observation.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Reply {
    pub(super) wish: Wish,
    pub(super) wants_map: bool,
    pub(super) pose: Option<Pose>,
    pub(super) map: Option<Grid>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "an object")]
struct RawReply {
    id: Option<u64>,
    speed: Option<f64>,
    turn_rate: Option<f64>,
    want: Option<Vec<Want>>,
    pose: Option<[f64; 3]>,
    map: Option<Grid>,
    finished: Option<bool>,
    stuck: Option<bool>,
    failed: Option<String>,
}

impl Reply {
    /// Reads the answer to observation `id`; `slam` is whether the driver may give pose and map.
    pub(super) fn parse(line: &[u8], id: u64, slam: bool) -> Result<Reply, DriverError> {
        let raw: RawReply = read(line)?;
        if let Some(other) = raw.id.filter(|&other| other != id) {
            return Err(not_allowed("id", other, format!("{id}, the last observation's")));
        }
        if !slam && (raw.pose.is_some() || raw.map.is_some()) {
            let field = if raw.pose.is_some() { "pose" } else { "map" };
            let allowed = "absent unless `slam` is true in the hello";
            return Err(not_allowed(field, format!("a {field}"), allowed));
        }
        let pose = raw.pose.map(pose).transpose()?;
        let [finished, stuck] = [raw.finished, raw.stuck].map(Option::unwrap_or_default);
        let wish = match (raw.failed, finished, stuck) {
            (Some(reason), _, _) => Wish::GiveUp(reason.chars().take(LONGEST_REASON).collect()),
            (None, true, true) => {
                return Err(not_allowed("stuck", "true", "absent or false if `finished` is true"));
            }
            (None, true, false) => Wish::Finished,
            (None, false, true) => Wish::Stuck,
            (None, false, false) => Wish::Drive(Command {
                speed: rate("speed", raw.speed, "m/s")?,
                turn_rate: rate("turn_rate", raw.turn_rate, "rad/s")?,
            }),
        };
        let wants_map = raw.want.is_some_and(|want| !want.is_empty());
        Ok(Reply { wish, wants_map, pose, map: raw.map })
    }
}

fn rate(field: &str, value: Option<f64>, unit: &str) -> Result<f64, DriverError> {
    let allowed = || format!("from {} to {FASTEST} {unit}", -FASTEST);
    let Some(value) = value else { return Err(not_allowed(field, "missing", allowed())) };
    if value.abs() <= FASTEST { Ok(value) } else { Err(not_allowed(field, value, allowed())) }
}

fn pose([x, y, heading]: [f64; 3]) -> Result<Pose, DriverError> {
    for (field, value) in [("pose[0]", x), ("pose[1]", y), ("pose[2]", heading)] {
        number(field, value, -FARTHEST, FARTHEST)?;
    }
    Ok(Pose::new(x, y, heading))
}

/// Returns a line for a driver, without its line end.
pub(super) fn line(value: &impl Serialize) -> Result<Vec<u8>, DriverError> {
    Ok(serde_json::to_vec(value)?)
}

/// Reads a line of JSON. Errors name the field.
fn read<'a, T: Deserialize<'a>>(line: &'a [u8]) -> Result<T, DriverError> {
    // Otherwise an array with the values of the fields in order would be accepted, too.
    if line.trim_ascii_start().starts_with(b"[") {
        let near = String::from_utf8_lossy(&line[..line.len().min(4 * EXCERPT)]);
        return Err(DriverError::NoReply(format!("not an object, in `{}`", excerpt(&near))));
    }
    let mut input = serde_json::Deserializer::from_slice(line);
    let found = serde_path_to_error::deserialize(&mut input)
        .map_err(|error| (Some(error.path().to_string()), error.into_inner()))
        .and_then(|found| input.end().map(|()| found).map_err(|error| (None, error)));
    found.map_err(|(path, error)| {
        // `?` is a field whose name is incomplete.
        let whole = |path: String| path.trim_end_matches(['?', '.']).to_owned();
        let field = path.map(whole).filter(|path| !path.is_empty());
        let field = field.map_or(String::new(), |field| format!("`{}`: ", excerpt(&field)));
        // The error contains the value, which may be as long as the line.
        let column = error.column();
        let what = error.to_string();
        let what = what.strip_suffix(&format!(" at line 1 column {column}")).unwrap_or(&what);
        let start = column.saturating_sub(EXCERPT / 2).min(line.len());
        let near = String::from_utf8_lossy(&line[start..(start + 4 * EXCERPT).min(line.len())]);
        DriverError::NoReply(format!(
            "{field}{} at character {column}, in `{}`",
            excerpt(what),
            excerpt(&near)
        ))
    })
}

/// Returns the beginning of a text that may be long and contain any characters.
pub(super) fn excerpt(text: &str) -> String {
    let mut short = printable(&text.chars().take(EXCERPT).collect::<String>());
    if text.chars().nth(EXCERPT).is_some() {
        short.push_str("...");
    }
    short
}

/// Returns x, y and heading.
pub(super) fn triple(pose: Pose) -> [f64; 3] {
    [pose.position.x, pose.position.y, pose.heading]
}

/// Writes the ranges of a scan for a line, in metres: the greatest range if there was no echo, and
/// `None` for a beam to be ignored, whether its range is NaN or 0. JSON has neither infinity nor NaN.
pub(super) fn ranges(scan: &Scan, max_range: f64, out: &mut Vec<Option<f64>>) {
    out.clear();
    out.extend(scan.ranges.iter().map(|&r| (r > 0.0).then_some(r.min(max_range))));
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde_json::json;

    use super::*;
    use crate::lidar::NO_ECHO;

    fn parse(text: &str) -> Result<Reply, String> {
        Reply::parse(text.as_bytes(), 7, false).map_err(|error| error.to_string())
    }

    fn error(text: &str) -> String {
        parse(text).expect_err(text)
    }

    #[test]
    fn replies_are_read() {
        let wish = |text| parse(text).map(|reply| reply.wish);
        let command = Command { speed: 0.5, turn_rate: -1.0 };
        assert_eq!(wish(r#"{"speed": 0.5, "turn_rate": -1, "id": 7}"#), Ok(Wish::Drive(command)));
        assert_eq!(wish("{\"finished\": true}\r"), Ok(Wish::Finished));
        assert_eq!(wish(r#"{"stuck": true, "speed": 1}"#), Ok(Wish::Stuck));
        assert_eq!(wish(r#"{"failed": "no plan"}"#), Ok(Wish::GiveUp("no plan".to_owned())));
        assert!(parse(r#"{"finished": true, "want": ["map"]}"#).unwrap().wants_map);
        // A field that is null is left out.
        let null = r#"{"speed": 0.5, "turn_rate": -1, "id": null, "want": null, "pose": null,
                       "map": null, "finished": null, "stuck": null, "failed": null}"#;
        assert_eq!(wish(null), Ok(Wish::Drive(command)));
        let own = Reply::parse(br#"{"finished": true, "pose": [1, 2, 3]}"#, 0, true).unwrap();
        assert_eq!(own.pose, Some(Pose::new(1.0, 2.0, 3.0)));
    }

    #[test]
    fn what_is_wrong_with_a_reply_is_named() {
        for (text, part) in [
            (
                r#"{"speed": null, "turn_rate": 1}"#,
                "`speed` must be from -1000 to 1000 m/s, got missing",
            ),
            (r#"{"speed": 1}"#, "`turn_rate` must be from -1000 to 1000 rad/s, got missing"),
            (
                r#"{"speed": 1e4, "turn_rate": 0}"#,
                "`speed` must be from -1000 to 1000 m/s, got 10000",
            ),
            (r#"{"speed": NaN, "turn_rate": 0}"#, "`speed`: expected value at character 11"),
            (r#"{"turn_rate": 0, "speed": -Infinity}"#, "`speed`: "),
            (r#"{"speed": 1e999, "turn_rate": 0}"#, "`speed`: number out of range"),
            (r#"{"speed": "fast", "turn_rate": 0}"#, "`speed`: invalid type: string \"fast\""),
            (r#"{"sped": 1}"#, "unknown field `sped`"),
            (r#"{"speed": 1, "speed": 2}"#, "duplicate field `speed`"),
            (r#"{"finished": true, "stuck": true}"#, "`stuck` must be absent or false"),
            (r#"{"finished": true, "id": 6}"#, "`id` must be 7, the last observation's, got 6"),
            (r#"{"finished": true, "want": ["scan"]}"#, "`want[0]`: unknown variant `scan`"),
            (
                r#"{"finished": true, "pose": [0, 0, 0]}"#,
                "`pose` must be absent unless `slam` is true in the hello, got a pose",
            ),
            (r#"{"finished": true} {}"#, "trailing characters"),
            ("", "EOF"),
            ("hello", "expected value at character 1, in `hello`"),
            ("\u{1b}[31m", "in `\\u{1b}[31m`"),
            ("[0.1, 0.2]", "a line that is not an answer: not an object, in `[0.1, 0.2]`"),
            ("[]", "not an object"),
            ("null", "invalid type: null, expected an object"),
            ("7", "invalid type: integer `7`, expected an object"),
        ] {
            assert!(error(text).contains(part), "{text}: {}", error(text));
        }
        let long = error(&format!("{{\"speed\": \"{}\"}}", "x".repeat(100_000)));
        assert!(long.len() < 400, "{} characters", long.len());
        let own = |text: &str| Reply::parse(text.as_bytes(), 0, true).unwrap_err().to_string();
        let text = own(r#"{"finished": true, "pose": [0, 2e6, 0]}"#);
        assert_eq!(text, "`pose[1]` must be a number from -1000000 to 1000000, got 2000000");
        assert!(own(r#"{"finished": true, "pose": [0, 1]}"#).contains("`pose`: invalid length 2"));
        let map = json!({"origin": [0, 0], "resolution": 0.1, "cols": 1, "rows": -1, "cells": ""});
        assert!(own(&json!({"finished": true, "map": map}).to_string()).contains("`map.rows`"));
    }

    #[test]
    fn greetings_are_read() {
        let parse =
            |text: &str| Greeting::parse(text.as_bytes()).map_err(|error| error.to_string());
        let read = parse(r#"{"protocol": "envgen-driver 1", "name": "a b"}"#).unwrap();
        assert_eq!((read.name.as_str(), read.rate, read.slam), ("a b", 1, false));
        let null = r#"{"protocol": "envgen-driver 1", "name": "a b", "rate": null, "slam": null}"#;
        assert_eq!(parse(null).unwrap(), read);
        let error = |text| parse(text).expect_err(text);
        let text = error(r#"{"protocol": "envgen-driver 2", "name": "a"}"#);
        assert_eq!(text, "`protocol` must be envgen-driver 1, got envgen-driver 2");
        assert!(error(r#"{"name": "a"}"#).contains("missing field `protocol`"));
        assert!(error(r#"{"protocol": "envgen-driver 1", "name": " "}"#).contains("`name`"));
        let text = error(r#"{"protocol": "envgen-driver 1", "name": "a", "rate": 0}"#);
        assert_eq!(text, "`rate` must be from 1 to 200 ticks, got 0");
    }

    #[test]
    fn lines_cut_in_two_are_named_as_such() {
        let text = error(r#"{"speed": 0.5,"#);
        assert!(text.starts_with("a line that is not an answer: EOF while parsing"), "{text}");
        let text = error(r#"{"speed": 0, "map": {"origin": [0, 0],"#);
        assert!(text.starts_with("a line that is not an answer: `map`: EOF"), "{text}");
    }

    #[test]
    fn scans_keep_what_json_has_no_number_for() {
        let mut out = vec![Some(1.0); 9];
        ranges(&Scan { ranges: vec![2.5, NO_ECHO, f64::NAN, 0.0] }, 8.0, &mut out);
        assert_eq!(out, [Some(2.5), Some(8.0), None, None]);
        assert_eq!(serde_json::to_string(&out).unwrap(), "[2.5,8.0,null,null]");
    }

    proptest! {
        #[test]
        fn any_bytes_are_a_reply_or_an_error(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            for slam in [false, true] {
                if let Err(error) = Reply::parse(&bytes, 0, slam) {
                    prop_assert!(error.to_string().len() < 2000);
                }
            }
            let _ = Greeting::parse(&bytes);
        }

        #[test]
        fn any_numbers_are_a_reply_within_the_limits_or_an_error(
            speed in any::<f64>(), turn_rate in any::<f64>(),
            pose in proptest::array::uniform3(any::<f64>()), scale in -20..5_i32,
        ) {
            // Most doubles are huge or tiny.
            let near = |x: f64| if x.is_finite() { x % libm::pow(10.0, f64::from(scale)) } else { x };
            let text = json!({"speed": near(speed), "turn_rate": near(turn_rate), "pose": pose.map(near)});
            let reported = |field: &str| text[field].as_f64();
            match Reply::parse(text.to_string().as_bytes(), 0, true) {
                Ok(Reply { wish: Wish::Drive(command), .. }) => {
                    prop_assert_eq!(Some(command.speed), reported("speed"));
                    prop_assert_eq!(Some(command.turn_rate), reported("turn_rate"));
                    prop_assert!(command.speed.abs().max(command.turn_rate.abs()) <= FASTEST);
                }
                Ok(other) => prop_assert!(false, "{other:?}"),
                Err(error) => {
                    let fields = ["`speed`", "`turn_rate`", "`pose"];
                    let error = error.to_string();
                    prop_assert!(fields.iter().any(|field| error.contains(field)), "{error}");
                }
            }
        }

        #[test]
        fn lines_cut_short_are_errors(end in 1..100_usize) {
            let text = r#"{"speed": 0.25, "turn_rate": -0.5, "pose": [1, 2, 3], "want": ["map"]}"#;
            let end = end.min(text.len() - 1);
            prop_assert!(Reply::parse(&text.as_bytes()[..end], 0, true).is_err());
        }
    }
}
