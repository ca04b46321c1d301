//! The log of a trial: its world, its settings and every command, by which the trial is replayed to the
//! last bit.

use std::io::{ErrorKind, Read, Write};

use envgen::SpecError;
use envgen::scenario::{GivenDoorCommand, Scenario, ScenarioState};
use envgen::text_file;
use envgen::world::{Digest, Violation};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::command_log::CommandLog;
use super::end::RobotEnd;
use super::log_world::LogWorld;
use super::parts::ForeignPart;
use super::running::Trial;
use super::settings::TrialSettings;
use crate::backend::{Command, RobotBackend, TICK};
use crate::setting_limits::MAX_TIME_LIMIT;

/// Version of the logs' layout and of their replay. A log of another version is rejected.
///
/// 2: robots see water, and estimators find old walls again. 3: estimators close loops only where the
/// scans then agree, and policies keep to the area to map.
pub const LOG_VERSION: u32 = 3;

/// Greatest number of commands per robot in a log, which is that of the longest trial.
const MAX_TICKS: u64 = (MAX_TIME_LIMIT / TICK) as u64 + 1;

/// Greatest length of a log in bytes. Longer ones are rejected before they fill the memory.
const MAX_BYTES: u64 = 1 << 30;

/// The log of a trial, by which the trial is replayed to the last bit.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
/// use mapping_trial::trial::{Trial, TrialLog, TrialSettings};
///
/// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
/// let settings = TrialSettings { time_limit: 2.0, ..Default::default() };
/// let mut trial = Trial::flat(&world, settings)?;
/// while trial.step() {}
/// let mut file = Vec::new();
/// trial.log().write(&mut file)?;
/// let log = TrialLog::read(&mut file.as_slice())?;
/// assert_eq!((log.ticks(), log.commands(0).count()), (40, 40));
/// assert_eq!(log.digest(), trial.log().digest());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialLog {
    version: u32,
    /// The world of the trial.
    pub world: LogWorld,
    /// Digest of the world, as returned by [`World::digest`](envgen::World::digest).
    pub world_digest: String,
    /// The settings of the trial.
    pub settings: TrialSettings,
    /// Name of the robot backend, such as `flat`.
    pub engine: String,
    /// The parts that were plugged in. A replay uses the parts of the settings instead, unless they are
    /// plugged in again. A policy's commands are in the log.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub foreign: Vec<ForeignPart>,
    /// The doors, people and smoke; absent if nothing moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario: Option<Scenario>,
    pub(super) commands: Vec<CommandLog>,
    /// The commands to doors; absent if no program gave any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) door_commands: Vec<GivenDoorCommand>,
    /// Why and when each robot's part ended; `None` if it had not ended.
    pub ends: Vec<Option<RobotEnd>>,
    /// Number of recoveries of each robot.
    pub recoveries: Vec<u32>,
}

/// The one field that logs of every version have.
#[derive(Deserialize)]
struct AnyVersion {
    version: u64,
}

/// An error in reading or writing a log.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LogError {
    /// The text is not a log, or only a part of one.
    #[error("this is not a trial log: {0}")]
    Format(#[from] serde_json::Error),
    /// Another version of this crate wrote the log.
    #[error("a log of version {found}, expected version {LOG_VERSION}")]
    Version {
        /// The log's version.
        found: u64,
    },
    /// A value that no trial can have.
    #[error("`{field}` must be {allowed}, got {value}")]
    Content {
        /// The field.
        field: &'static str,
        /// Its value.
        value: String,
        /// The allowed values.
        allowed: String,
    },
    /// The log's world breaks an invariant.
    #[error("the log's world is broken: {0}")]
    World(#[from] Violation),
    /// A setting is not allowed.
    #[error("the log's settings: {0}")]
    Setting(#[from] SpecError),
    /// The log is too long.
    #[error("the log is longer than {MAX_BYTES} bytes")]
    TooLong,
    /// The log could not be read or written.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}

impl TrialLog {
    /// Reads a log.
    ///
    /// # Errors
    ///
    /// If the text is not a log, if it is of another version, if its world is broken or its settings
    /// are not allowed, or if it contradicts itself.
    pub fn read(input: &mut dyn Read) -> Result<Self, LogError> {
        let text =
            text_file::read_at_most(input, MAX_BYTES).map_err(|error| match error.kind() {
                ErrorKind::FileTooLarge => LogError::TooLong,
                _ => error.into(),
            })?;
        // The version is read first, since a log of another version has other fields.
        match serde_json::from_str(&text) {
            Ok(AnyVersion { version }) if version != u64::from(LOG_VERSION) => {
                return Err(LogError::Version { found: version });
            }
            _ => {}
        }
        let log: TrialLog = serde_json::from_str(&text)?;
        if let LogWorld::Given(world) = &log.world {
            world.check()?;
        }
        log.settings.validate()?;
        let robots = log.settings.robots as usize;
        for (field, len) in [
            ("commands", log.commands.len()),
            ("ends", log.ends.len()),
            ("recoveries", log.recoveries.len()),
        ] {
            if len != robots {
                let allowed = format!("{robots}, one per robot");
                return Err(LogError::Content { field, value: len.to_string(), allowed });
            }
        }
        let ticks = log.ticks();
        let differ = log.commands.iter().any(|track| track.ticks() != ticks);
        if differ || ticks > MAX_TICKS {
            let value = format!("for {ticks} ticks and others");
            let allowed = format!("the same for every robot, at most {MAX_TICKS} ticks");
            return Err(LogError::Content { field: "commands", value, allowed });
        }
        let last = log.ends.iter().flatten().map(|end| end.tick).max();
        if let Some(tick) = last.filter(|&tick| tick > ticks) {
            let value = format!("one in tick {tick}");
            let allowed = format!("in tick {ticks} at the latest");
            return Err(LogError::Content { field: "ends", value, allowed });
        }
        log.check_door_commands()?;
        Ok(log)
    }

    /// Checks that the commands to doors belong to this trial and are in order.
    fn check_door_commands(&self) -> Result<(), LogError> {
        let doors = self.scenario.as_ref().map_or(0, |scenario| scenario.doors.len());
        let mut earliest = 0;
        for given in &self.door_commands {
            let allowed = if given.door >= doors {
                format!("to one of the scenario's {doors} doors")
            } else if !(earliest..=self.ticks()).contains(&given.tick) {
                format!("in ascending order of their ticks, at most {}", self.ticks())
            } else {
                earliest = given.tick;
                continue;
            };
            let value = format!("one to door {} in tick {}", given.door, given.tick);
            return Err(LogError::Content { field: "door_commands", value, allowed });
        }
        Ok(())
    }

    /// Writes the log as JSON.
    ///
    /// # Errors
    ///
    /// Returns any error of the writer.
    pub fn write(&self, out: &mut dyn Write) -> Result<(), LogError> {
        serde_json::to_writer(&mut *out, self)?;
        Ok(out.write_all(b"\n")?)
    }

    /// Returns the SHA-256 of the log. Two trials of the flat simulator with equal digests were the
    /// same to the last bit. With other robot backends, they had the same world, settings, commands and
    /// ends.
    pub fn digest(&self) -> Digest {
        Digest::of(self)
    }

    /// Returns the number of ticks of the trial.
    pub fn ticks(&self) -> u64 {
        self.commands.first().map_or(0, CommandLog::ticks)
    }

    /// Returns the commands to the doors of the scenario, in the order in which they were given.
    /// Commands that changed nothing are left out.
    pub fn door_commands(&self) -> &[GivenDoorCommand] {
        &self.door_commands
    }

    /// Returns the commands of a robot, tick by tick; none for a robot that the trial did not have.
    pub fn commands(&self, robot: usize) -> impl Iterator<Item = Command> + '_ {
        self.commands.get(robot).into_iter().flat_map(CommandLog::iter)
    }
}

impl<B: RobotBackend> Trial<B> {
    /// Returns the log of the trial so far.
    pub fn log(&self) -> TrialLog {
        // These commands take effect from the next tick on.
        let pending = self.bodies.scenario().into_iter().flat_map(ScenarioState::door_commands);
        let pending = pending.filter(|given| given.tick == self.clock.ticks());
        TrialLog {
            version: LOG_VERSION,
            world: self.source.clone(),
            world_digest: self.world_digest.clone(),
            settings: self.settings.clone(),
            engine: self.bodies.engine().to_owned(),
            foreign: self.foreign.clone(),
            scenario: self.scenario().cloned(),
            commands: self.commands.clone(),
            door_commands: self.door_commands.iter().chain(pending).copied().collect(),
            ends: self.ends.clone(),
            recoveries: (0..self.robots()).map(|robot| self.recoveries(robot)).collect(),
        }
    }
}
