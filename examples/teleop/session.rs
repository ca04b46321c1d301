//! From the choice of a world to the scores: what the person does, and what is kept of it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy::prelude::*;
use bevy_envgen::debug::DebugLayers;
use bevy_envgen::prelude::*;
use bevy_envgen::ui::{FeedbackForm, SetupForm, SpecForm, TrialAction};
use bevy_envgen::view::TrialView;
use envgen::located::Locate;
use envgen::{Seed, WorldKind, WorldSpec, whole_file};
use mapping_trial::feedback::Feedback;
use mapping_trial::names::Named;
use mapping_trial::policy::PolicyKind;
use mapping_trial::trial::{TrialReport, TrialSettings};
use mapping_trial::truth::MappableArea;

use crate::arguments::{Arguments, Beginning};
use crate::compare::{Comparison, SessionRun};
use crate::saving::Saving;
use crate::{output, start};

/// Ticks between two writings of the log while the trial runs: what is lost when the power fails.
const TICKS_A_LOG: u64 = 200;

/// Where the person is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// The world is being made.
    Generating,
    /// The world stands, the trial is chosen.
    Setup,
    /// The robots drive.
    Running,
    /// The form is to be filled.
    Form,
    /// The scores are shown.
    Done,
}

/// Everything that the panels edit and show.
#[derive(Resource)]
pub(crate) struct Session {
    pub(crate) phase: Phase,
    pub(crate) spec: SpecForm,
    pub(crate) setup: SetupForm,
    /// The environment.
    pub(crate) world: Entity,
    /// The robot that is driven.
    pub(crate) driven: usize,
    pub(crate) paused: bool,
    /// Ticks done since the program began.
    pub(crate) ticks: u64,
    pub(crate) form: Option<FeedbackForm>,
    pub(crate) report: Option<TrialReport>,
    /// What the last trial was measured against.
    truth: Option<Arc<MappableArea>>,
    pub(crate) rival: PolicyKind,
    pub(crate) comparison: Option<Comparison>,
    /// What happened last, in a line.
    pub(crate) message: String,
    /// Holds a folder a trial.
    out: PathBuf,
    /// The folder of the last trial that began.
    folder: PathBuf,
    /// Whether the truth was shown during the last trial.
    truth_seen: bool,
    saving: Saving,
    /// Whether the world is from a file, and of no spec.
    from_file: bool,
    /// Whether a program that was asked for on the command line has still to begin.
    pub(crate) at_once: bool,
}

impl Session {
    /// The session of the command line, with its world asked for.
    pub(crate) fn begin(
        arguments: &Arguments,
        beginning: Beginning,
        settings: TrialSettings,
        world: &mut World,
    ) -> Self {
        let seed = arguments.seed;
        let from_file = matches!(beginning, Beginning::World(_));
        let (spec, environment) = match beginning {
            Beginning::Spec(spec) => (SpecForm::new(&spec, seed), Environment::new(*spec, seed.0)),
            Beginning::World(given) => (
                SpecForm::new(&WorldKind::Indoor.default_spec(), seed),
                Environment::prebuilt(given),
            ),
        };
        let training = arguments.training;
        let view = TrialView { truth: training, ..default() };
        Session {
            phase: Phase::Generating,
            spec,
            setup: SetupForm { settings, training },
            world: world.spawn((environment, view)).id(),
            driven: 0,
            paused: false,
            ticks: 0,
            form: None,
            report: None,
            truth: None,
            rival: PolicyKind::Nearest,
            comparison: None,
            message: String::new(),
            out: arguments.out.clone(),
            folder: arguments.out.clone(),
            truth_seen: training,
            saving: Saving::default(),
            from_file,
            at_once: arguments.operator.is_some(),
        }
    }

    /// Asks for another world.
    pub(crate) fn regenerate(&mut self, spec: WorldSpec, seed: Seed, commands: &mut Commands) {
        commands.entity(self.world).remove::<MappingTrial>();
        let view = TrialView { truth: self.setup.training, ..default() };
        commands.entity(self.world).insert((Environment::new(spec, seed.0), view));
        // Also where it is the spec that stands: it is asked for.
        commands.trigger(RebuildEnvironment { entity: self.world });
        self.phase = Phase::Generating;
        self.from_file = false;
    }

    /// Begins a trial in the world that stands, from its start.
    pub(crate) fn start(&mut self, truth: &GroundTruth, commands: &mut Commands) {
        // Of a world from a file the panel's, as of everything else that is not in the file.
        let made = truth.provenance.seed.filter(|_| !self.from_file);
        let seed = made.unwrap_or(self.spec.seed());
        let begun = self.setup.request(seed).map_err(Into::into);
        match begun.and_then(|settings| start::with_start(truth, settings)) {
            Ok(settings) => {
                self.driven = 0;
                self.paused = false;
                self.report = None;
                self.form = None;
                self.comparison = None;
                self.message = String::new();
                self.phase = Phase::Running;
                self.truth_seen = self.setup.training;
                self.folder = new_folder(&self.out);
                let view = TrialView { truth: self.setup.training, ..default() };
                let mut world = commands.entity(self.world);
                if settings.operator.is_none() {
                    world.insert(ManualControl::default());
                } else {
                    world.remove::<ManualControl>();
                }
                world.insert((MappingTrial::new(settings), view));
            }
            Err(error) => {
                self.message = error.to_string();
                self.phase = Phase::Setup;
            }
        }
    }

    /// Ends a trial: log, pictures and report are written, and the form is asked for where a person
    /// drove. The scores come after it, so that they sway no rating.
    pub(crate) fn finish(&mut self, holder: &mut MappingTrial, world: &GroundTruth) {
        holder.stop();
        self.paused = false;
        self.phase = Phase::Done;
        self.await_log();
        let Some(trial) = holder.trial() else { return };
        let measured = || -> Result<_, Box<dyn std::error::Error>> {
            let truth = trial.reference(world)?;
            Ok((trial.report(world, &truth)?, truth))
        };
        let (report, truth) = match measured() {
            Ok(measured) => measured,
            Err(error) => {
                self.message = error.to_string();
                self.keep_log(holder);
                self.await_log();
                return;
            }
        };
        if report.settings.operator.is_none() {
            self.form = Some(FeedbackForm::new(report.session()));
            self.phase = Phase::Form;
        }
        if self.truth_seen {
            self.mark_training();
        }
        let written = output::folder(&self.folder)
            .and_then(|folder| output::write(folder, trial, &truth, &report));
        self.message = match written {
            Ok(_) => format!("saved in {}", self.folder.display()),
            Err(error) => error.to_string(),
        };
        self.report = Some(report);
        self.truth = Some(Arc::new(truth));
    }

    /// Has the log written as far as it goes, unless it is being written.
    fn keep_log(&mut self, holder: &MappingTrial) {
        let Some(trial) = holder.trial() else { return };
        match self.saving.is_done() {
            Ok(true) => self.saving.begin(trial.log(), &self.folder),
            Ok(false) => {}
            Err(error) => self.message = error,
        }
    }

    /// Waits for the log that is being written.
    fn await_log(&mut self) {
        if let Err(error) = self.saving.wait() {
            self.message = error;
        }
    }

    /// Gives the folder of a trial whose truth was seen a name that says so: its scores are no blind ones.
    fn mark_training(&mut self) {
        let mut name = self.folder.clone().into_os_string();
        name.push("_training");
        let marked = PathBuf::from(name);
        // Where the log was not kept yet, there is none to be renamed.
        if !self.folder.exists() || std::fs::rename(&self.folder, &marked).is_ok() {
            self.folder = marked;
        }
    }

    /// Puts the filled form into the report, or goes on without one.
    pub(crate) fn hand_in(&mut self, feedback: Option<Feedback>) {
        self.phase = Phase::Done;
        self.form = None;
        let (Some(report), Some(feedback)) = (&mut self.report, feedback) else { return };
        report.feedback = Some(feedback);
        let path = self.folder.join("report.json");
        let json = serde_json::to_vec_pretty(report).map_err(std::io::Error::from).in_file(&path);
        let written = json.and_then(|mut json| {
            json.push(b'\n');
            whole_file::write(&path, &json)
        });
        if let Err(error) = written {
            self.message = error.to_string();
        }
    }

    /// Does what a key or a button asks for while a trial runs.
    pub(crate) fn act(
        &mut self,
        action: TrialAction,
        trial: &mut MappingTrial,
        view: &mut TrialView,
        truth: &GroundTruth,
        commands: &mut Commands,
    ) {
        match action {
            TrialAction::Pause => self.paused = !self.paused,
            TrialAction::Reset => {
                self.finish(trial, truth);
                self.start(truth, commands);
            }
            TrialAction::Stop => self.finish(trial, truth),
            TrialAction::Training => {
                self.setup.training = !self.setup.training;
                self.truth_seen |= self.setup.training;
                view.truth = self.setup.training;
            }
            TrialAction::NextRobot => {
                let robots = trial.robots().len();
                self.driven = (self.driven + 1) % robots.max(1);
            }
        }
    }

    /// Compares the session with the program that is chosen.
    pub(crate) fn compare(&mut self, holder: &MappingTrial, world: &GroundTruth) {
        let (Some(trial), Some(truth)) = (holder.trial(), &self.truth) else { return };
        let program = TrialSettings { operator: Some(self.rival), ..trial.settings().clone() };
        let name = self.rival.name().unwrap_or("program");
        let run = SessionRun {
            log: trial.log(),
            tracks: (0..trial.robots()).map(|robot| trial.trajectory(robot).clone()).collect(),
        };
        let (world, truth) = (Arc::clone(&world.0), Arc::clone(truth));
        self.comparison = Some(Comparison::begin(run, world, truth, (name, program)));
    }
}

/// The first of the folders `001`, `002` and so on that is not there yet, with or without a mark.
fn new_folder(out: &Path) -> PathBuf {
    (1_u32..)
        .map(|number| format!("{number:03}"))
        .find(|name| !out.join(name).exists() && !out.join(format!("{name}_training")).exists())
        .map_or_else(|| out.to_path_buf(), |name| out.join(name))
}

/// Lines over the world are the truth, too.
pub(crate) fn hide_lines(session: Res<Session>, mut layers: ResMut<DebugLayers>) {
    if !session.setup.training {
        layers.set_if_neq(DebugLayers::default());
    }
}

/// The world stands: a trial can begin.
pub(crate) fn world_is_ready(
    ready: On<EnvironmentReady>,
    mut session: ResMut<Session>,
    truths: Query<&GroundTruth>,
    mut commands: Commands,
) {
    if session.phase != Phase::Generating {
        return;
    }
    session.phase = Phase::Setup;
    session.spec.set_failure(None);
    if session.at_once
        && let Ok(truth) = truths.get(ready.entity)
    {
        session.at_once = false;
        session.start(truth, &mut commands);
    }
}

/// There is no such world: the panel says why.
pub(crate) fn world_has_failed(failed: On<EnvironmentFailed>, mut session: ResMut<Session>) {
    session.spec.set_failure(Some(failed.error.to_string()));
    session.phase = Phase::Setup;
}

/// The trial has come to its end by itself.
pub(crate) fn trial_has_ended(
    ended: On<TrialEnded>,
    mut session: ResMut<Session>,
    mut trials: Query<(&mut MappingTrial, &GroundTruth)>,
) {
    if session.phase == Phase::Running
        && let Ok((mut trial, truth)) = trials.get_mut(ended.entity)
    {
        session.finish(&mut trial, truth);
    }
}

/// The trial cannot begin: the panel says why.
pub(crate) fn trial_has_failed(failed: On<TrialFailed>, mut session: ResMut<Session>) {
    session.message = failed.error.to_string();
    session.phase = Phase::Setup;
}

/// Time stands still while the trial is paused.
pub(crate) fn halt(session: Res<Session>, mut time: ResMut<Time<Virtual>>) {
    if session.paused != time.is_paused() {
        if session.paused {
            time.pause();
        } else {
            time.unpause();
        }
    }
}

/// Counts the ticks of trials, 20 a second, and keeps their logs.
pub(crate) fn count(mut session: ResMut<Session>, trials: Query<&MappingTrial>) {
    if session.phase != Phase::Running || session.paused {
        return;
    }
    let Ok(trial) = trials.get(session.world) else { return };
    session.ticks += 1;
    if session.ticks.is_multiple_of(TICKS_A_LOG) {
        session.keep_log(trial);
    }
}

/// Takes a comparison that is made.
pub(crate) fn poll_comparison(mut session: ResMut<Session>) {
    if let Some(comparison) = &mut session.bypass_change_detection().comparison {
        comparison.poll();
    }
}

/// A window that is closed ends the trial; nothing of it is lost.
pub(crate) fn save_at_exit(
    mut exits: MessageReader<AppExit>,
    mut session: ResMut<Session>,
    mut trials: Query<(&mut MappingTrial, &GroundTruth)>,
) {
    if exits.read().next().is_none() {
        return;
    }
    if session.phase == Phase::Running
        && let Ok((mut trial, truth)) = trials.get_mut(session.world)
    {
        session.finish(&mut trial, truth);
    } else if let Some(feedback) = session.form.as_ref().and_then(|form| form.fill().ok()) {
        session.hand_in(Some(feedback));
    }
}
