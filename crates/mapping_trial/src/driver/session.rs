//! The exchange with a driver: gathers what each robot observed, asks the driver, and keeps its
//! answers.

use std::time::Duration;

use envgen::geometry::Pose;

use super::error::DriverError;
use super::grid::Grid;
use super::limits::Limits;
use super::link::{Link, LinkError};
use super::process::Process;
use super::protocol::{
    Ended, Greeting, Hello, Observed, Odometry, Reply, Wish, excerpt, line, ranges, triple,
};
use crate::backend::{Command, Observation};
use crate::map::OccupancyMap;
use crate::names::printable;
use crate::policy::Decision;
use crate::trial::TrialReport;

/// How long a driver may take to end after the last line, before its process is ended.
const FAREWELL: Duration = Duration::from_secs(2);

/// How long to wait at the end for a line that nobody asked for.
const LEFTOVER: Duration = Duration::from_millis(50);

fn unasked(line: &[u8]) -> DriverError {
    DriverError::Unasked(excerpt(&String::from_utf8_lossy(line)))
}

/// The contents of one robot's next line, and of its last answer.
#[derive(Debug)]
struct Gathered {
    ticks: u64,
    odometry: Odometry,
    since_scan: Odometry,
    ranges: Vec<Option<f64>>,
    /// Whether a scan came since the last line.
    scanned: bool,
    water: Vec<[f64; 2]>,
    bumped: bool,
    wants_map: bool,
    decision: Decision,
}

impl Gathered {
    fn new() -> Self {
        Gathered {
            ticks: 0,
            odometry: Odometry::default(),
            since_scan: Odometry::default(),
            ranges: Vec::new(),
            scanned: false,
            water: Vec::new(),
            bumped: false,
            wants_map: false,
            decision: Decision::Drive(Command::STOP),
        }
    }

    fn add(&mut self, seen: &Observation, max_range: f64) {
        self.odometry.add(seen);
        self.since_scan.add(seen);
        if let Some(scan) = &seen.scan {
            self.since_scan = Odometry::default();
            ranges(scan, max_range, &mut self.ranges);
            self.scanned = true;
        }
        if let Some(water) = &seen.water {
            self.water.clear();
            self.water.extend(water.iter().map(|&point| <[f64; 2]>::from(point)));
        }
        self.bumped |= seen.bumped;
        self.ticks += 1;
    }

    /// Marks observations as sent, so that they are not sent again.
    fn mark_sent(&mut self) {
        self.odometry = Odometry::default();
        self.scanned = false;
        self.bumped = false;
    }
}

/// A driver's estimate of a robot's pose and of the map.
#[derive(Debug)]
pub(super) struct Said {
    pub(super) pose: Option<Pose>,
    pub(super) map: Option<Grid>,
}

/// The exchange with one driver.
#[derive(Debug)]
pub(super) struct Session {
    link: Link,
    limits: Limits,
    process: Option<Process>,
    greeting: Option<Greeting>,
    max_range: f64,
    robots: Vec<Gathered>,
    /// Number of observations sent so far.
    id: u64,
    failure: Option<String>,
}

impl Session {
    pub(super) fn new(link: Link, limits: Limits, process: Option<Process>) -> Self {
        Session {
            link,
            limits,
            process,
            greeting: None,
            max_range: 0.0,
            robots: Vec::new(),
            id: 0,
            failure: None,
        }
    }

    pub(super) fn greet(&mut self, hello: &Hello) -> Option<Greeting> {
        self.robots.extend((0..hello.robots()).map(|_| Gathered::new()));
        self.max_range = hello.max_range();
        let answer = line(hello).and_then(|line| self.answer(line));
        let greeting = answer.and_then(|answer| Greeting::parse(&answer));
        match greeting {
            Ok(greeting) => self.greeting = Some(greeting),
            Err(error) => self.failure = Some(format!("{error} (answer to the hello)")),
        }
        self.greeting.clone()
    }

    pub(super) fn name(&self) -> Option<&str> {
        self.greeting.as_ref().map(|greeting| greeting.name.as_str())
    }

    /// Returns whether the driver estimates poses and map itself.
    pub(super) fn has_slam(&self) -> bool {
        self.greeting.as_ref().is_some_and(|greeting| greeting.slam)
    }

    pub(super) fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    pub(super) fn fail(&mut self, error: &DriverError, time: f64) {
        let id = self.id.saturating_sub(1);
        self.failure.get_or_insert_with(|| format!("{error} (observation {id}, at {time:.2} s)"));
    }

    /// Returns the driver's last decision on a robot; `None` once the driver has failed.
    pub(super) fn decision(&self, robot: usize) -> Option<Decision> {
        let gathered = self.robots.get(robot).filter(|_| self.failure.is_none());
        gathered.map(|gathered| gathered.decision)
    }

    /// Runs a tick of a robot: asks the driver if it is due, and returns its estimates. `known` are
    /// pose and map if the driver does not estimate them itself.
    pub(super) fn tick(
        &mut self,
        robot: usize,
        seen: &Observation,
        known: Option<(Pose, &OccupancyMap)>,
    ) -> Option<Said> {
        let rate = self.greeting.as_ref()?.rate;
        if self.failure.is_some() {
            return None;
        }
        let gathered = self.robots.get_mut(robot)?;
        gathered.add(seen, self.max_range);
        if !(gathered.ticks - 1).is_multiple_of(rate) {
            return None;
        }
        let said = self.exchange(robot, seen, known);
        said.map_err(|error| self.fail(&error, seen.time)).ok()
    }

    fn exchange(
        &mut self,
        robot: usize,
        seen: &Observation,
        known: Option<(Pose, &OccupancyMap)>,
    ) -> Result<Said, DriverError> {
        let gathered = &mut self.robots[robot];
        let map = known.filter(|_| gathered.wants_map).map(|(_, map)| Grid::of(map)).transpose()?;
        let id = self.id;
        self.id += 1;
        let line = line(&Observed {
            id,
            robot,
            time: seen.time,
            odometry: gathered.odometry,
            scan: gathered.scanned.then_some(&gathered.ranges),
            since_scan: gathered.scanned.then_some(gathered.since_scan),
            water: &gathered.water,
            bumped: gathered.bumped,
            battery: seen.battery,
            pose: known.map(|(pose, _)| triple(pose)),
            map,
        })?;
        gathered.mark_sent();
        let answer = self.answer(line)?;
        let Reply { wish, wants_map, pose, map } = Reply::parse(&answer, id, self.has_slam())?;
        let gathered = &mut self.robots[robot];
        gathered.wants_map = wants_map;
        gathered.decision = match wish {
            Wish::Drive(command) => Decision::Drive(command),
            Wish::Finished => Decision::Finished,
            Wish::Stuck => Decision::Stuck,
            Wish::GiveUp(reason) => return Err(DriverError::GaveUp(printable(&reason))),
        };
        Ok(Said { pose, map })
    }

    fn answer(&mut self, line: Vec<u8>) -> Result<Vec<u8>, DriverError> {
        self.link.ask(line).map_err(|error| match error {
            LinkError::Late => DriverError::Late(self.limits.reply),
            LinkError::Slow => DriverError::Slow(self.limits.total),
            LinkError::Deaf => DriverError::Deaf,
            LinkError::TooLong => DriverError::TooLong,
            LinkError::Unasked(line) => unasked(&line),
            LinkError::Closed { half: 0 } => self.gone("closed its output", ""),
            LinkError::Closed { half } => {
                let half = format!(" after {half} bytes of a line without its end");
                self.gone("closed its output", &half)
            }
            LinkError::Read(error) => self.gone(&format!("cannot be read: {error}"), ""),
            LinkError::Write(error) => self.gone(&format!("cannot be written to: {error}"), ""),
        })
    }

    /// The error of a driver that is gone or has closed one of its ends. It says how the process ended,
    /// if it has; which end was seen to close first means nothing then.
    fn gone(&mut self, what: &str, half: &str) -> DriverError {
        let Some(process) = &mut self.process else {
            return DriverError::Gone(format!("it {what}{half}"));
        };
        let (status, words) = process.last_words();
        let mut text = match status {
            Some(status) => format!("it ended ({status}){half}"),
            None => format!("it {what}{half}, but has not ended"),
        };
        if let Some(words) = words {
            text.push_str(&format!("; the last line of its standard error: `{}`", excerpt(&words)));
        }
        DriverError::Gone(text)
    }

    pub(super) fn end(&mut self, report: Option<&TrialReport>) {
        // There was one line too many, and all later answers were those to the previous lines.
        if self.failure.is_none()
            && let Some(line) = self.link.leftover(LEFTOVER)
        {
            self.failure = Some(unasked(&line).to_string());
        }
        let last = line(&Ended::new(report, self.failure.as_deref()));
        self.link.close(last.ok());
        // A driver that has failed may hang, and its state no longer matters.
        if self.failure.is_none() {
            // The program may end before the writing thread does.
            self.link.finish_writing(FAREWELL);
            if let Some(process) = &mut self.process {
                process.ended(FAREWELL);
            }
        }
    }
}
