//! Replays of trials from their logs, to the last bit.

use envgen::World;

use super::builder::TrialBuilder;
use super::command_log::CommandLog;
use super::end::{EndReason, RobotEnd};
use super::error::TrialError;
use super::log::TrialLog;
use super::parts::{ForeignPart, PartRole};
use super::running::Trial;
use super::script::Script;
use super::settings::TrialSettings;
use crate::backend::{Command, RobotBackend};
use crate::flat::FlatSimulator;

impl TrialLog {
    /// Replays a trial of the flat simulator to the last bit. If [`TrialLog::foreign`] names SLAM or
    /// sensors, the built-in parts of the settings make poses and map instead.
    ///
    /// # Errors
    ///
    /// As [`LogWorld::world`](super::LogWorld::world), [`Trial::flat`] and [`TrialLog::run_through`]; or if the
    /// log's backend is not the flat simulator.
    pub fn replay(&self) -> Result<Trial<FlatSimulator>, TrialError> {
        if self.engine != FlatSimulator::ENGINE {
            return Err(TrialError::OtherEngine { found: self.engine.clone() });
        }
        let world = self.world.world()?;
        let mut trial = self.replay_with(&world, TrialBuilder::build_flat)?;
        self.run_through(&mut trial)?;
        Ok(trial)
    }

    /// Builds a trial that is ready to replay the log in the log's world. `build` builds the trial, and
    /// may plug in the parts that [`TrialLog::foreign`] names.
    ///
    /// # Errors
    ///
    /// If the world is not the log's, or if `build` fails.
    pub fn replay_with<'w, B: RobotBackend>(
        &self,
        world: &'w World,
        build: impl FnOnce(TrialBuilder<'w>) -> Result<Trial<B>, TrialError>,
    ) -> Result<Trial<B>, TrialError> {
        let found = world.digest().to_string();
        if found != self.world_digest {
            return Err(TrialError::OtherWorld { logged: self.world_digest.clone(), found });
        }
        // The log replaces the policy, but the settings still name it.
        let settings = TrialSettings { policy: None, ..self.settings.clone() };
        let mut builder = TrialBuilder::new(world, settings);
        if let Some(scenario) = &self.scenario {
            builder = builder.scenario(scenario.clone());
        }
        let mut trial = build(builder)?;
        trial.settings.policy = self.settings.policy;
        let is_missing = |part: &&ForeignPart| {
            part.role != PartRole::Policy
                && !trial.foreign.iter().any(|known| known.role == part.role)
        };
        trial.replaced = self.foreign.iter().filter(is_missing).cloned().collect();
        trial.foreign = self.foreign.clone();
        trial.source = self.world.clone();
        trial.script =
            Some(Script { ends: self.ends.clone(), recoveries: self.recoveries.clone() });
        Ok(trial)
    }

    /// Gives all of the log's commands to a trial that [`TrialLog::replay_with`] has built.
    ///
    /// # Errors
    ///
    /// If the backend does not take a command to a door, which it names, such as `door_commands[3].door`. The trial
    /// stays as it was before that tick.
    pub fn run_through<B: RobotBackend>(&self, trial: &mut Trial<B>) -> Result<(), TrialError> {
        self.run_through_with(trial, |_| ())
    }

    /// Does the same as [`TrialLog::run_through`], and calls `progress` after every tick.
    ///
    /// # Errors
    ///
    /// As [`TrialLog::run_through`].
    pub fn run_through_with<B: RobotBackend>(
        &self,
        trial: &mut Trial<B>,
        mut progress: impl FnMut(&Trial<B>),
    ) -> Result<(), TrialError> {
        let mut tracks: Vec<_> = self.commands.iter().map(CommandLog::iter).collect();
        let mut doors = self.door_commands.iter().enumerate().peekable();
        let mut command_doors = |trial: &mut Trial<B>, tick: u64| {
            while let Some((i, given)) = doors.next_if(|(_, given)| given.tick <= tick) {
                // The log names doors of its scenario, but a custom backend may not take commands to
                // doors.
                let obeyed = trial.command_door(given.door, given.command);
                obeyed.map_err(|error| error.within(&format!("door_commands[{i}]")))?;
            }
            Ok::<(), TrialError>(())
        };
        for tick in 0..self.ticks() {
            command_doors(trial, tick)?;
            let commands: Vec<Command> =
                tracks.iter_mut().map(|track| track.next().unwrap_or(Command::STOP)).collect();
            trial.step_with(&commands);
            progress(trial);
        }
        command_doors(trial, self.ticks())?;
        let stopped = |end: &Option<RobotEnd>| end.is_some_and(|e| e.reason == EndReason::Stopped);
        if self.ends.iter().any(stopped) {
            trial.stop();
        } else if self.ends.iter().all(Option::is_some) {
            // This processes the last observation, after which there was no decision.
            trial.step_with(&[]);
        }
        Ok(())
    }
}
