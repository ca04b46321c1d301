//! Compares the replayed session with a program on the same map.

use std::sync::Arc;

use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, futures_lite::future};
use bevy_mapping_trial::trial::{replay_headless, run_headless_with};
use envgen::World;
use mapping_trial::score::{Reference, Scores};
use mapping_trial::trial::{Trajectory, TrialLog, TrialParts, TrialSettings};

/// A comparison that is running or finished.
pub(crate) enum Comparison {
    Running(Task<Result<Box<Compared>, String>>),
    Done(Result<Box<Compared>, String>),
}

/// The scores of two runs in the same world with the same settings.
pub(crate) struct Compared {
    /// The scores of the session, replayed from its log.
    pub(crate) replayed: Scores,
    /// Whether the replay equals the session to the last bit.
    pub(crate) same: bool,
    /// The scores of the program.
    pub(crate) program: Scores,
    /// The program's name.
    pub(crate) name: &'static str,
}

/// A session: its commands and the robots' trajectories.
pub(crate) struct SessionRun {
    pub(crate) log: TrialLog,
    pub(crate) tracks: Vec<Trajectory>,
}

impl Comparison {
    /// Starts to compare a session with a program, on another thread.
    pub(crate) fn begin(
        session: SessionRun,
        world: Arc<World>,
        truth: Arc<Reference>,
        (name, program): (&'static str, TrialSettings),
    ) -> Self {
        Comparison::Running(AsyncComputeTaskPool::get().spawn(async move {
            let text = |error: &dyn std::fmt::Display| error.to_string();
            let moving = session.log.scenario.clone();
            let again =
                replay_headless(&world, session.log, |_| ()).map_err(|error| text(&error))?;
            let mut tracks = session.tracks.iter().enumerate();
            let same = tracks.all(|(robot, track)| again.trajectory(robot) == track);
            let replayed = again.score(&truth).map_err(|error| text(&error))?;
            let parts = TrialParts::default();
            let trial = run_headless_with(&world, program, parts, moving, |_| ())
                .map_err(|error| text(&error))?;
            let program = trial.score(&truth).map_err(|error| text(&error))?;
            Ok(Box::new(Compared { replayed, same, program, name }))
        }))
    }

    /// Takes the result when it is ready.
    pub(crate) fn poll(&mut self) {
        if let Comparison::Running(task) = self
            && let Some(result) = block_on(future::poll_once(task))
        {
            *self = Comparison::Done(result);
        }
    }
}
