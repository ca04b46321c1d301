//! A running trial: its clock, its battery and its end conditions.

use envgen::geometry::{Pose, wrap_angle};
use envgen::scenario::{DoorCommand, GivenDoorCommand, Scenario};
use envgen::{SpecError, World};

use super::clock::Clock;
use super::command_log::CommandLog;
use super::end::{EndReason, RobotEnd};
use super::log_world::LogWorld;
use super::observer::{Moment, TrialObserver};
use super::parts::ForeignPart;
use super::script::Script;
use super::settings::TrialSettings;
use crate::autonomy::Autonomy;
use crate::backend::{Command, Condition, RobotBackend};
use crate::mappable_area::MappableAreaError;
use crate::policy::{Decision, ExplorationPolicy};
use crate::robot::Robot;
use crate::score::{Reference, RunSummary, ScoreError, Scores, SweptCells, TrajectoryPair};

/// Number of ticks between two samples of the positions of people and door leaves.
const TICKS_PER_SAMPLE: u64 = 10;

/// The true motion of one robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    /// True poses: the start, and one after every tick. A robot whose part has ended brakes.
    pub poses: Vec<Pose>,
    /// Path length in metres.
    pub distance: f64,
    /// Total turning in radians, left and right added.
    pub turning: f64,
}

/// A running trial: a robot backend in a world, the robots' autonomy, a clock and a log.
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
    pub(super) settings: TrialSettings,
    pub(super) bodies: B,
    pub(super) autonomy: Autonomy,
    pub(super) observer: Option<Box<dyn TrialObserver + Send + Sync>>,
    pub(super) foreign: Vec<ForeignPart>,
    /// The parts of [`Trial::foreign`] that a replay does without.
    pub(super) replaced: Vec<ForeignPart>,
    pub(super) starts: Vec<Pose>,
    pub(super) source: LogWorld,
    pub(super) world_digest: String,
    pub(super) clock: Clock,
    pub(super) ends: Vec<Option<RobotEnd>>,
    /// Whether each robot last found that nothing is left to explore.
    pub(super) finished: Vec<bool>,
    pub(super) tracks: Vec<Trajectory>,
    pub(super) commands: Vec<CommandLog>,
    pub(super) door_commands: Vec<GivenDoorCommand>,
    /// What a replayed log knows of its policy.
    pub(super) script: Option<Script>,
    pub(super) over: bool,
    /// The scenario, and the cells where its parts were.
    pub(super) scenario: Option<Box<(Scenario, SweptCells)>>,
}

/// Why a robot's part ends, whatever it decides; `None` while it can drive.
fn lost(condition: Condition) -> Option<EndReason> {
    match condition {
        Condition::Operational => None,
        Condition::Drowned => Some(EndReason::Drowned),
        Condition::Removed => Some(EndReason::Removed),
    }
}

impl<B: RobotBackend> Trial<B> {
    /// Runs one tick, in which the policy drives. Returns false once the trial is over.
    pub fn step(&mut self) -> bool {
        self.tick(None)
    }

    /// Runs one tick with a person's commands, one per robot. Returns false once the trial is over.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
    /// use mapping_trial::backend::Command;
    /// use mapping_trial::trial::{Trial, TrialSettings};
    ///
    /// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
    /// let settings = TrialSettings { policy: None, time_limit: 10.0, ..Default::default() };
    /// let mut trial = Trial::flat(&world, settings)?;
    /// // A person turns the robot on the spot for half a second.
    /// for _ in 0..10 {
    ///     assert!(trial.step_with(&[Command { speed: 0.0, turn_rate: 1.0 }]));
    /// }
    /// assert!(trial.trajectory(0).turning > 0.1 && trial.trajectory(0).distance < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn step_with(&mut self, commands: &[Command]) -> bool {
        self.tick(Some(commands))
    }

    fn tick(&mut self, manual: Option<&[Command]>) -> bool {
        let Some(commands) = self.command(manual) else {
            return false;
        };
        self.bodies.advance(&commands);
        self.record();
        true
    }

    /// Runs the first half of a tick, for backends that are moved from outside: processes the
    /// observation of each robot, and returns a command for each; `None` once the trial is over. The
    /// commands are those of `manual`, one per robot, or else the policy's.
    ///
    /// [`Trial::record`] is the second half, after the robots have moved for a
    /// [`TICK`](crate::backend::TICK). [`Trial::step`] runs both halves, with [`RobotBackend::advance`]
    /// in between.
    pub fn command(&mut self, manual: Option<&[Command]>) -> Option<Vec<Command>> {
        if self.over {
            return None;
        }
        let mut commands = vec![Command::STOP; self.starts.len()];
        let mut has_failed = false;
        for (robot, command) in commands.iter_mut().enumerate() {
            let seen = self.bodies.observe(robot);
            if self.ends[robot].is_some() {
                continue;
            }
            self.autonomy.sense(robot, &seen);
            if let Some(observer) = &mut self.observer {
                let (pose, slam) = (self.bodies.pose(robot), self.autonomy.slam());
                observer.observe(&Moment { robot, seen: &seen, pose, slam });
            }
            let script =
                self.script.as_ref().and_then(|script| script.end_at(robot, self.clock.ticks()));
            let end = if let Some(reason) = script {
                Some(reason)
            } else if seen.battery <= 0.0 {
                Some(EndReason::Battery)
            } else if seen.time >= self.settings.time_limit {
                Some(EndReason::TimeLimit)
            } else if let Some(reason) = lost(self.bodies.condition(robot)) {
                Some(reason)
            } else if let Some(manual) = manual {
                *command = manual.get(robot).copied().unwrap_or(Command::STOP).finite();
                None
            } else {
                let decision = self.autonomy.decide(robot, &seen);
                self.finished[robot] = decision == Decision::Finished;
                if let Decision::Drive(wanted) = decision {
                    *command = wanted.finite();
                }
                match decision {
                    Decision::Stuck => Some(EndReason::Stuck),
                    Decision::Failed => {
                        has_failed = true;
                        Some(EndReason::Failed)
                    }
                    Decision::Drive(_) | Decision::Finished => None,
                }
            };
            self.ends[robot] = end.map(|reason| RobotEnd { reason, tick: self.clock.ticks() });
        }
        // A policy that has failed has no command for any robot.
        if has_failed {
            self.end(EndReason::Failed);
            return None;
        }
        // A robot that has nothing left to explore waits for the others, which may find more for it.
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

    /// Runs the second half of a tick, after [`Trial::command`]: records where the robots are now.
    pub fn record(&mut self) {
        self.clock.advance();
        for (robot, track) in self.tracks.iter_mut().enumerate() {
            let (pose, last) = (self.bodies.pose(robot), track.poses[track.poses.len() - 1]);
            track.distance += pose.position.distance(last.position);
            track.turning += wrap_angle(pose.heading - last.heading).abs();
            track.poses.push(pose);
        }
        if let (Some(moving), Some(state)) = (&mut self.scenario, self.bodies.scenario()) {
            let last = self.clock.ticks() - 1;
            let given = state.door_commands().iter().filter(|given| given.tick == last);
            self.door_commands.extend(given);
            if self.clock.ticks().is_multiple_of(TICKS_PER_SAMPLE) {
                moving.1.add(state);
            }
        }
    }

    /// Opens, closes or slams a door of the scenario, from the next tick on. The log holds the command.
    ///
    /// The flat simulator carries it out. Trials in Bevy take commands through the components of their
    /// doors instead.
    ///
    /// ```
    /// use envgen::scenario::{DoorCommand, DoorControl, Scenario, ScenarioSpec};
    /// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
    /// use mapping_trial::backend::RobotBackend;
    /// use mapping_trial::trial::{Trial, TrialSettings};
    ///
    /// let spec = IndoorSpec { width: 6, height: 6, ..Default::default() };
    /// let world = spec.generate(Seed(3))?.to_world();
    /// let door_control = DoorControl::Commanded;
    /// let doors = ScenarioSpec { doors: 1.0, door_control, ..Default::default() };
    /// let scenario = Scenario::new(&world, &doors, Seed(1))?;
    /// let settings = TrialSettings { time_limit: 5.0, ..Default::default() };
    /// let mut trial = Trial::builder(&world, settings).scenario(scenario).build_flat()?;
    /// trial.command_door(0, DoorCommand::Close)?;
    /// while trial.step() {}
    /// assert_eq!(trial.log().door_commands().len(), 1);
    /// let door = trial.bodies().scenario().map(|state| state.doors()[0]);
    /// let again = trial.log().replay()?;
    /// assert_eq!(again.bodies().scenario().map(|state| state.doors()[0]), door);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If there is no such door, or if the robot backend takes no commands to doors.
    pub fn command_door(&mut self, door: usize, command: DoorCommand) -> Result<(), SpecError> {
        self.bodies.command_door(door, command)
    }

    /// Returns what moves in the world; `None` if nothing does.
    pub fn scenario(&self) -> Option<&Scenario> {
        self.scenario.as_ref().map(|moving| &moving.0)
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
            end.get_or_insert(RobotEnd { reason, tick: self.clock.ticks() });
        }
    }

    /// Returns the simulated time so far, in seconds.
    pub fn time(&self) -> f64 {
        self.clock.time()
    }

    /// Returns the number of robots.
    pub fn robots(&self) -> usize {
        self.starts.len()
    }

    /// Returns the settings of the trial.
    pub fn settings(&self) -> &TrialSettings {
        &self.settings
    }

    /// Returns the autonomy: SLAM and the policy.
    pub fn autonomy(&self) -> &Autonomy {
        &self.autonomy
    }

    /// Returns the robot backend, to move it between [`Trial::command`] and [`Trial::record`].
    pub fn bodies_mut(&mut self) -> &mut B {
        &mut self.bodies
    }

    /// Returns the robot backend.
    pub fn bodies(&self) -> &B {
        &self.bodies
    }

    /// Returns a robot's true motion so far.
    pub fn trajectory(&self, robot: usize) -> &Trajectory {
        &self.tracks[robot]
    }

    /// Returns the distance in metres between a robot's estimated and true positions, at the end of its
    /// part if that has ended: SLAM gets no more scans, while the robot may still brake.
    pub fn pose_error(&self, robot: usize) -> f64 {
        let estimated = self.autonomy.slam().estimate(robot).pose;
        let at_end =
            self.ends[robot].and_then(|end| self.tracks[robot].poses.get(end.tick as usize));
        let truth = at_end.copied().unwrap_or_else(|| self.bodies.pose(robot));
        estimated.position.distance(truth.position)
    }

    /// Returns why and when a robot's part ended; `None` while it continues.
    pub fn end_of(&self, robot: usize) -> Option<RobotEnd> {
        self.ends[robot]
    }

    /// Returns whether the trial is over.
    pub fn is_over(&self) -> bool {
        self.over
    }

    /// Returns the number of recoveries of a robot so far.
    pub fn recoveries(&self, robot: usize) -> u32 {
        match (&self.script, self.autonomy.policy()) {
            (Some(script), _) => script.recoveries(robot),
            (None, Some(policy)) => policy.recoveries(robot),
            (None, None) => 0,
        }
    }

    /// Returns the parts that were plugged in, in place of those that the settings name. For a replay
    /// these are the parts of the log, even if they were [not plugged in again](Trial::replaced).
    pub fn foreign(&self) -> &[ForeignPart] {
        &self.foreign
    }

    /// Returns the parts of a replayed log that were not plugged in again. The built-in parts that the
    /// settings name are in their place.
    pub fn replaced(&self) -> &[ForeignPart] {
        &self.replaced
    }

    /// Returns why the policy failed; `None` while it works.
    pub fn failure(&self) -> Option<&str> {
        self.autonomy.policy().and_then(ExplorationPolicy::failure)
    }

    /// Computes the mappable area of the trial's world from its start, which is the reference for its
    /// scores. Trials with the same start, world and robot may share it.
    ///
    /// # Errors
    ///
    /// As [`Reference::from_start`].
    pub fn reference(&self, world: &World) -> Result<Reference, MappableAreaError> {
        Reference::from_start(world, &self.settings.body, self.starts[0].position)
    }

    /// Scores the trial so far against the mappable area of its world.
    ///
    /// # Errors
    ///
    /// If the mappable area is for another start or robot, or if a custom part returned poses or counts
    /// that cannot be scored.
    pub fn score(&self, truth: &Reference) -> Result<Scores, ScoreError> {
        self.score_of(truth, &self.estimated_tracks()?)
    }

    /// Returns each robot's estimated poses, one for each of its true poses until its part has ended.
    pub(super) fn estimated_tracks(&self) -> Result<Vec<Vec<Pose>>, ScoreError> {
        let estimated = |robot| {
            let trajectory = self.autonomy.slam().trajectory(robot);
            let (found, expected) = (trajectory.len() as u64, self.autonomy.steps(robot) + 1);
            if found != expected {
                return Err(ScoreError::Trajectory { robot, found, expected });
            }
            // The first estimate is the start, and the second that of the first observation, before any
            // motion.
            Ok(trajectory[1..].to_vec())
        };
        (0..self.robots()).map(estimated).collect()
    }

    pub(super) fn score_tracks<'a>(
        &'a self,
        estimated: &'a [Vec<Pose>],
    ) -> Vec<TrajectoryPair<'a>> {
        let track = |(track, estimated): (&'a Trajectory, &'a Vec<Pose>)| {
            let ticks = track.poses.len().min(estimated.len());
            TrajectoryPair { truth: &track.poses[..ticks], estimated: &estimated[..ticks] }
        };
        self.tracks.iter().zip(estimated).map(track).collect()
    }

    pub(super) fn score_of(
        &self,
        truth: &Reference,
        estimated: &[Vec<Pose>],
    ) -> Result<Scores, ScoreError> {
        let (start, body) = (self.starts[0].position, &self.settings.body);
        let (found, radius) = (truth.start(), body.circumscribed_radius);
        let found_radius = truth.robot().circumscribed_radius;
        if (found, found_radius) != (start, radius) {
            return Err(ScoreError::Reference { found, found_radius, start, radius });
        }
        // A time limit by area may have changed the battery.
        if *truth.robot() != (Robot { battery: truth.robot().battery, ..body.clone() }) {
            return Err(ScoreError::OtherRobot);
        }
        let robots = 0..self.robots();
        // Parts of one's own and logs may hold counts of any size.
        let count = |of: &dyn Fn(usize) -> u32| robots.clone().map(of).fold(0, u32::saturating_add);
        let tracks = self.score_tracks(estimated);
        // A robot in water is as lost as one that is stuck.
        let lost = |end: &&Option<RobotEnd>| {
            end.is_some_and(|end| matches!(end.reason, EndReason::Stuck | EndReason::Drowned))
        };
        Scores::of(
            truth,
            &RunSummary {
                map: self.autonomy.slam().map(),
                tracks: &tracks,
                time: self.time(),
                time_limit: self.settings.time_limit.min(self.settings.body.battery),
                distance: self.tracks.iter().map(|track| track.distance).sum(),
                turning: self.tracks.iter().map(|track| track.turning).sum(),
                collisions: count(&|robot| self.bodies.collisions(robot)),
                moving: self.scenario.as_ref().map(|moving| {
                    (&moving.1, count(&|robot| self.bodies.person_collisions(robot)))
                }),
                recoveries: count(&|robot| self.recoveries(robot)),
                stuck: self.ends.iter().filter(lost).count() as u32,
                energy_left: (self.settings.body.battery - self.time()).max(0.0),
            },
        )
    }
}
