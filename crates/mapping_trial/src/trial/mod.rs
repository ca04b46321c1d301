//! The protocol of a trial, over any bodies: clock, battery, ends, and the log of every command.

mod builder;
mod log;
mod parts;
mod report;
mod settings;
mod start;
mod summary;

use envgen::geometry::{Pose, wrap_angle};
use envgen::{GenerateError, SettingsError, SpecError, World};
use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use builder::TrialBuilder;
pub use log::{LOG_VERSION, LogError, TrialLog, WorldSource};
pub use parts::{ForeignPart, PartRole, Setup, TrialParts};
pub use report::{REPORT_VERSION, RobotReport, TrialReport};
pub use settings::{MAX_ROBOTS, MAX_TIME_LIMIT, TrialSettings};
pub(crate) use settings::{count, number};

use crate::autonomy::Autonomy;
use crate::backend::{Command, Condition, RobotBackend, TICK};
use crate::flat::FlatSimulator;
use crate::policy::{Decision, ExplorationPolicy};
use crate::score::{self, ScoreError, Scores};
use crate::truth::{MappableArea, MappableAreaError};

/// Why a trial cannot begin.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TrialError {
    /// A setting is not allowed.
    #[error(transparent)]
    Setting(#[from] SpecError),
    /// A log names a spec that this version cannot read.
    #[error(transparent)]
    Spec(#[from] SettingsError),
    /// A log's world cannot be generated.
    #[error(transparent)]
    Generate(#[from] GenerateError),
    /// A log says that its world was generated, but not from which seed.
    #[error("the log's world has a spec but no seed")]
    NoSeed,
    /// The world has no start and none is given.
    #[error("the world has no start, and the settings give none: set `start`")]
    NoStart,
    /// The start is not in the world.
    #[error("a start at ({}, {}) is outside the world's bounds", start.position.x, start.position.y)]
    OutsideStart {
        /// The start.
        start: Pose,
    },
    /// Something solid stands at the start.
    #[error(
        "a start at ({}, {}) is {clearance:.3} m from the nearest solid part, a robot needs {radius} m",
        start.position.x, start.position.y
    )]
    BlockedStart {
        /// The start.
        start: Pose,
        /// Distance in metres to what stands there.
        clearance: f64,
        /// Radius in metres that a robot needs.
        radius: f64,
    },
    /// The ground at the start is water or such that a robot cannot drive.
    #[error("a robot cannot drive on the ground at the start ({}, {})", start.position.x, start.position.y)]
    DeepStart {
        /// The start.
        start: Pose,
    },
    /// There is no room for all robots near the start.
    #[error("near the start is room for {found} of {robots} robots")]
    NoRoom {
        /// Robots asked for.
        robots: u32,
        /// Starts found.
        found: u32,
    },
    /// A log's world is not the one that it was made in.
    #[error("the log was made in a world of digest {logged}, this one has {found}")]
    OtherWorld {
        /// Digest in the log.
        logged: String,
        /// Digest of the world at hand.
        found: String,
    },
    /// Something else than the flat simulator moved the bodies of a log.
    #[error(
        "the log's engine is `{found}`, the flat simulator replays `{}`",
        FlatSimulator::ENGINE
    )]
    OtherEngine {
        /// The log's engine.
        found: String,
    },
}

/// Why a robot's part in a trial ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EndReason {
    /// No frontier was left that it could reach.
    Explored,
    /// It could not get free.
    Stuck,
    /// Its operator broke down: see [`ExplorationPolicy::failure`].
    Failed,
    /// It drove into water.
    Drowned,
    /// Its battery was empty.
    Battery,
    /// The time was up.
    TimeLimit,
    /// A person ended the trial.
    Stopped,
}

impl EndReason {
    /// The reason in words.
    pub fn text(self) -> &'static str {
        match self {
            EndReason::Explored => "explored",
            EndReason::Stuck => "stuck",
            EndReason::Failed => "operator failed",
            EndReason::Drowned => "drowned",
            EndReason::Battery => "battery empty",
            EndReason::TimeLimit => "time up",
            EndReason::Stopped => "stopped",
        }
    }
}

/// Why and when a robot's part in a trial ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotEnd {
    /// Why.
    pub reason: EndReason,
    /// After how many ticks.
    pub tick: u64,
}

/// What one robot did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    /// True poses after every tick, the start first. A robot whose part has ended stands still.
    pub poses: Vec<Pose>,
    /// Path in metres.
    pub distance: f64,
    /// Total turning in radians.
    pub turning: f64,
}

/// A trial that runs: bodies in a world, a brain, a clock and a log.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
/// use mapping_trial::trial::{Trial, TrialSettings};
///
/// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
/// let mut trial = Trial::flat(&world, TrialSettings { time_limit: 30.0, ..Default::default() })?;
/// while trial.step() {}
/// assert!(trial.trajectory(0).distance > 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Trial<B> {
    settings: TrialSettings,
    bodies: B,
    autonomy: Autonomy,
    foreign: Vec<ForeignPart>,
    starts: Vec<Pose>,
    source: WorldSource,
    world_digest: String,
    tick: u64,
    ends: Vec<Option<RobotEnd>>,
    /// Who said last that nothing is left to explore.
    finished: Vec<bool>,
    tracks: Vec<Trajectory>,
    commands: Vec<log::CommandTrack>,
    /// What a replayed log knows of its operator.
    script: Option<log::Script>,
    over: bool,
}

impl Trial<FlatSimulator> {
    /// A trial of built-in parts in the flat simulator.
    ///
    /// # Errors
    ///
    /// Settings that are not allowed, or a start that is missing or not free.
    pub fn flat(world: &World, settings: TrialSettings) -> Result<Self, TrialError> {
        TrialBuilder::new(world, settings).build_flat()
    }

    /// A trial that is put together part by part: anyone's SLAM, operator, sensors and bodies.
    pub fn builder(world: &World, settings: TrialSettings) -> TrialBuilder<'_> {
        TrialBuilder::new(world, settings)
    }
}

impl<B: RobotBackend> Trial<B> {
    /// One tick, driven by the program; false once the trial is over.
    pub fn step(&mut self) -> bool {
        self.tick(None)
    }

    /// One tick with a person's commands, one a robot; false once the trial is over.
    pub fn step_with(&mut self, commands: &[Command]) -> bool {
        self.tick(Some(commands))
    }

    fn tick(&mut self, hands: Option<&[Command]>) -> bool {
        let Some(commands) = self.command(hands) else {
            return false;
        };
        self.bodies.advance(&commands);
        self.record();
        true
    }

    /// The first half of a tick, for bodies that something else moves: what each robot observes is
    /// taken in, and each one's command comes back; `None` once the trial is over. The commands are
    /// those of `hands`, one a robot, or the program's.
    ///
    /// When the bodies have moved for a [`TICK`], [`Trial::record`] is the second half.
    /// [`Trial::step`] does it all, with [`RobotBackend::advance`] between the two.
    pub fn command(&mut self, hands: Option<&[Command]>) -> Option<Vec<Command>> {
        if self.over {
            return None;
        }
        let mut commands = vec![Command::STOP; self.starts.len()];
        for (robot, command) in commands.iter_mut().enumerate() {
            let seen = self.bodies.observe(robot);
            if self.ends[robot].is_some() {
                continue;
            }
            self.autonomy.sense(robot, &seen);
            let script = self.script.as_ref().and_then(|script| script.end_at(robot, self.tick));
            let end = if let Some(reason) = script {
                Some(reason)
            } else if seen.battery <= 0.0 {
                Some(EndReason::Battery)
            } else if seen.time >= self.settings.time_limit {
                Some(EndReason::TimeLimit)
            } else if self.bodies.condition(robot) == Condition::Drowned {
                Some(EndReason::Drowned)
            } else if let Some(hands) = hands {
                *command = hands.get(robot).copied().unwrap_or(Command::STOP).finite();
                None
            } else {
                let decision = self.autonomy.decide(robot, &seen);
                self.finished[robot] = decision == Decision::Finished;
                if let Decision::Drive(wanted) = decision {
                    *command = wanted.finite();
                }
                match decision {
                    Decision::Stuck => Some(EndReason::Stuck),
                    Decision::Failed => Some(EndReason::Failed),
                    Decision::Drive(_) | Decision::Finished => None,
                }
            };
            self.ends[robot] = end.map(|reason| RobotEnd { reason, tick: self.tick });
        }
        // A robot that has nothing left to do waits for the others, who may find more for it.
        let mut robots = self.ends.iter().zip(&self.finished);
        if robots.all(|(end, &finished)| end.is_some() || finished) {
            self.end(EndReason::Explored);
            return None;
        }
        for (track, &command) in self.commands.iter_mut().zip(&commands) {
            track.push(command);
        }
        Some(commands)
    }

    /// The second half of a tick, after [`Trial::command`]: where the bodies are now.
    pub fn record(&mut self) {
        self.tick += 1;
        for (robot, track) in self.tracks.iter_mut().enumerate() {
            let (pose, last) = (self.bodies.pose(robot), track.poses[track.poses.len() - 1]);
            track.distance += pose.position.distance(last.position);
            track.turning += wrap_angle(pose.heading - last.heading).abs();
            track.poses.push(pose);
        }
    }

    /// Ends the trial for every robot whose part has not ended yet.
    pub fn stop(&mut self) {
        if !self.over {
            self.end(EndReason::Stopped);
        }
    }

    fn end(&mut self, reason: EndReason) {
        self.over = true;
        for end in &mut self.ends {
            end.get_or_insert(RobotEnd { reason, tick: self.tick });
        }
    }

    /// Simulated seconds so far.
    pub fn time(&self) -> f64 {
        self.tick as f64 * TICK
    }

    /// Number of robots.
    pub fn robots(&self) -> usize {
        self.starts.len()
    }

    /// What the trial is made of.
    pub fn settings(&self) -> &TrialSettings {
        &self.settings
    }

    /// The estimates, the map and the operator.
    pub fn autonomy(&self) -> &Autonomy {
        &self.autonomy
    }

    /// The bodies, for whoever moves them between [`Trial::command`] and [`Trial::record`].
    pub fn bodies_mut(&mut self) -> &mut B {
        &mut self.bodies
    }

    /// The bodies.
    pub fn bodies(&self) -> &B {
        &self.bodies
    }

    /// What a robot did so far.
    pub fn trajectory(&self, robot: usize) -> &Trajectory {
        &self.tracks[robot]
    }

    /// Why a robot's part ended; `None` while it goes on.
    pub fn end_of(&self, robot: usize) -> Option<RobotEnd> {
        self.ends[robot]
    }

    /// Whether the trial is over.
    pub fn is_over(&self) -> bool {
        self.over
    }

    /// How often a robot had to be freed so far.
    pub fn recoveries(&self, robot: usize) -> u32 {
        match (&self.script, self.autonomy.policy()) {
            (Some(script), _) => script.recoveries(robot),
            (None, Some(operator)) => operator.recoveries(robot),
            (None, None) => 0,
        }
    }

    /// The parts that were plugged in, in place of those that the settings name.
    pub fn foreign(&self) -> &[ForeignPart] {
        &self.foreign
    }

    /// Why the operator broke down; `None` while it works.
    pub fn failure(&self) -> Option<&str> {
        self.autonomy.policy().and_then(ExplorationPolicy::failure)
    }

    /// What could be mapped of the trial's world from where it began: what its scores are measured
    /// against. Trials that begin in one place of one world with one robot may share it.
    ///
    /// # Errors
    ///
    /// As [`MappableArea::new`].
    pub fn reference(&self, world: &World) -> Result<MappableArea, MappableAreaError> {
        MappableArea::from_start(world, &self.settings.body, self.starts[0].position)
    }

    /// Scores the trial as far as it went, against what could be mapped of its world.
    ///
    /// # Errors
    ///
    /// A truth of another start or robot; poses or counts that no trial of this crate's parts has.
    pub fn score(&self, truth: &MappableArea) -> Result<Scores, ScoreError> {
        self.score_of(truth, &self.estimated_tracks()?)
    }

    /// Each robot's estimated poses, one for each of its true ones as far as they go: robots whose
    /// part has ended are not estimated any more.
    fn estimated_tracks(&self) -> Result<Vec<Vec<Pose>>, ScoreError> {
        let estimated = |robot| {
            let trajectory = self.autonomy.slam().trajectory(robot);
            let (found, expected) = (trajectory.len() as u64, self.autonomy.steps(robot) + 1);
            if found != expected {
                return Err(ScoreError::Trajectory { robot, found, expected });
            }
            // The first estimate is the start and the second the first observation's, before any
            // motion.
            Ok(trajectory[1..].to_vec())
        };
        (0..self.robots()).map(estimated).collect()
    }

    fn score_tracks<'a>(&'a self, estimated: &'a [Vec<Pose>]) -> Vec<score::TrajectoryPair<'a>> {
        let track = |(track, estimated): (&'a Trajectory, &'a Vec<Pose>)| {
            let ticks = track.poses.len().min(estimated.len());
            score::TrajectoryPair { truth: &track.poses[..ticks], estimated: &estimated[..ticks] }
        };
        self.tracks.iter().zip(estimated).map(track).collect()
    }

    fn score_of(
        &self,
        truth: &MappableArea,
        estimated: &[Vec<Pose>],
    ) -> Result<Scores, ScoreError> {
        let (start, radius) = (self.starts[0].position, self.settings.body.circumscribed_radius);
        let (found, found_radius) = (truth.start(), truth.robot().circumscribed_radius);
        if (found, found_radius) != (start, radius) {
            return Err(ScoreError::Reference { found, found_radius, start, radius });
        }
        let robots = 0..self.robots();
        let tracks = self.score_tracks(estimated);
        // A robot in water is as lost as one that is stuck.
        let lost = |end: &&Option<RobotEnd>| {
            end.is_some_and(|end| matches!(end.reason, EndReason::Stuck | EndReason::Drowned))
        };
        Scores::of(
            truth,
            &score::RunSummary {
                map: self.autonomy.slam().map(),
                tracks: &tracks,
                time: self.time(),
                distance: self.tracks.iter().map(|track| track.distance).sum(),
                turning: self.tracks.iter().map(|track| track.turning).sum(),
                hits: robots.clone().map(|robot| self.bodies.hits(robot)).sum(),
                recoveries: robots.map(|robot| self.recoveries(robot)).sum(),
                stuck: self.ends.iter().filter(lost).count() as u32,
                energy_left: (self.settings.body.battery - self.time()).max(0.0),
            },
        )
    }
}

#[cfg(test)]
mod open_tests;
#[cfg(test)]
mod tests;
