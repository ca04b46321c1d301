//! The session, from the choice of a world to the scores: the person's actions, and what is saved.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy::prelude::*;
use bevy_envgen::debug::DebugLayers;
use bevy_envgen::prelude::*;
use bevy_mapping_trial::debug::TrialDebugLayers;
use bevy_mapping_trial::prelude::*;
use bevy_mapping_trial::ui::{
    FeedbackForm, ScenarioForm, SetupForm, SpecAction, SpecForm, TrialAction, WorldPreview,
};
use bevy_mapping_trial::view::{ShowIn3d, TrialView};
use envgen::located::{Locate, Located};
use envgen::world::Digest;
use envgen::{Seed, whole_file};
use mapping_trial::feedback::Feedback;
use mapping_trial::names::Named;
use mapping_trial::policy::PolicyKind;
use mapping_trial::score::Reference;
use mapping_trial::trial::{TrialReport, TrialSettings};

use crate::arguments::{Arguments, Beginning};
use crate::compare::{Comparison, SessionRun};
use crate::pace::Activity;
use crate::saving::Saving;
use crate::{draft, output, start};

/// Number of ticks between two writes of the log during the trial, which is the most that a power
/// failure loses.
const TICKS_PER_LOG: u64 = 200;

/// The phase of the session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// The person chooses the world and the trial.
    Setup,
    /// The parts of the chosen world are being spawned for a trial.
    Spawning,
    /// The robots drive.
    Running,
    /// The form is to be filled in.
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
    /// The world that the settings describe.
    pub(crate) preview: WorldPreview,
    /// Name of the robot.
    pub(crate) robot: String,
    /// The environment of the trials.
    pub(crate) world: Entity,
    /// Index of the driven robot.
    pub(crate) driven: usize,
    pub(crate) paused: bool,
    /// Whether the robots' cameras are drawn.
    pub(crate) has_cameras: bool,
    /// Whether the picture of the driven robot's camera is large and the map small.
    pub(crate) camera_is_large: bool,
    /// Number of ticks since the program started.
    pub(crate) ticks: u64,
    pub(crate) form: Option<FeedbackForm>,
    pub(crate) report: Option<TrialReport>,
    /// The mappable area against which the last trial was scored.
    truth: Option<Arc<Reference>>,
    pub(crate) rival: PolicyKind,
    pub(crate) comparison: Option<Comparison>,
    /// The last event, in one line.
    pub(crate) message: String,
    /// The folder with one folder per trial.
    out: PathBuf,
    /// The folder of the current or last trial.
    folder: PathBuf,
    /// The worlds whose true state the person has seen. Trials in them are not blind.
    shown: Vec<Digest>,
    /// The last of these worlds.
    last_shown: Option<Arc<envgen::World>>,
    saving: Saving,
    /// The world that was read from a file. It remains until a kind of world is chosen.
    given: Option<Arc<envgen::World>>,
    /// Whether a trial begins as soon as the world is ready.
    pub(crate) begins: bool,
}

impl Session {
    /// Creates the session of the command line, which requests its world.
    pub(crate) fn new(
        arguments: &Arguments,
        beginning: Beginning,
        (settings, scenario): (TrialSettings, ScenarioForm),
        world: &mut World,
    ) -> Self {
        let seed = arguments.seed;
        let (spec, given) = match beginning {
            Beginning::Spec(spec) => (SpecForm::new(&spec, seed), None),
            Beginning::World(given) => {
                (SpecForm::of_file(&arguments.world_name(), seed), Some(given))
            }
        };
        let preview = match &given {
            None => WorldPreview::new(spec.request()),
            Some(given) => WorldPreview::given(Arc::clone(given)),
        };
        let training = arguments.training;
        let mut session = Session {
            phase: Phase::Setup,
            spec,
            setup: SetupForm { settings, scenario, training },
            preview,
            robot: arguments.robot_name(),
            world: world.spawn_empty().id(),
            driven: 0,
            paused: false,
            has_cameras: arguments.has_cameras(),
            camera_is_large: arguments.has_cameras(),
            ticks: 0,
            form: None,
            report: None,
            truth: None,
            rival: PolicyKind::Nearest,
            comparison: None,
            message: String::new(),
            out: arguments.out.clone(),
            folder: arguments.out.clone(),
            shown: Vec::new(),
            last_shown: None,
            saving: Saving::default(),
            given,
            begins: arguments.policy.is_some(),
        };
        if arguments.known
            && let Some(given) = session.given.clone()
        {
            session.note_shown(&given);
        }
        session
    }

    /// Carries out what a person did in the panel of the world.
    pub(crate) fn edit(&mut self, action: SpecAction) {
        match action {
            SpecAction::Changed => {
                match self.given.as_ref().filter(|_| self.spec.is_of_file()) {
                    None => self.preview.request(self.spec.request()),
                    // The seed is that of the noise.
                    Some(given) if self.preview.world().is_some_and(|w| Arc::ptr_eq(w, given)) => {}
                    Some(given) => self.preview = WorldPreview::given(Arc::clone(given)),
                }
                self.begins = false;
            }
            SpecAction::Saved(path) => self.message = format!("saved {}", path.display()),
        }
    }

    /// Returns whether the picture of a camera is large, in the place of the map.
    pub(crate) fn shows_camera(&self) -> bool {
        self.phase == Phase::Running && self.camera_is_large
    }

    /// Begins a trial in the chosen world. The world is spawned first, unless it is that of the last
    /// trial. While it is being generated, the trial waits.
    pub(crate) fn begin(&mut self, spawned: Option<&GroundTruth>, commands: &mut Commands) {
        let Some(world) = self.preview.world().filter(|_| self.has_seed()) else {
            self.begins = self.preview.is_pending();
            return;
        };
        self.begins = false;
        if let Some(spawned) = spawned.filter(|spawned| Arc::ptr_eq(&spawned.0, world)) {
            self.start(spawned, commands);
            return;
        }
        let view = TrialView { truth: self.setup.training, ..default() };
        let mut environment = commands.entity(self.world);
        environment.remove::<MappingTrial>();
        let wanted = Environment::prebuilt(Arc::clone(world)).with_origin_near(world);
        environment.insert((wanted, view, ShowIn3d));
        // A world that equals the one requested before would not be requested again, and would never be
        // ready.
        commands.trigger(RebuildEnvironment { entity: self.world });
        self.phase = Phase::Spawning;
    }

    /// Returns the seed of the sensor noise and of what moves in a world: the world's own seed or, for
    /// a world from a file, that of the panel.
    pub(crate) fn seed_in(&self, world: &envgen::World) -> Seed {
        let made = world.provenance.seed.filter(|_| !self.spec.is_of_file());
        made.unwrap_or(self.spec.seed())
    }

    /// Returns whether the seed of the noise is a number. The preview refuses a world whose own seed is not.
    pub(crate) fn has_seed(&self) -> bool {
        !self.spec.is_of_file() || self.spec.request_seed().is_ok()
    }

    /// Begins a trial in the spawned world, from its start.
    fn start(&mut self, truth: &GroundTruth, commands: &mut Commands) {
        let seed = self.seed_in(truth);
        let begun = || -> Result<_, Box<dyn std::error::Error>> {
            let settings = start::with_start(truth, self.setup.request(seed)?)?;
            // A trial that cannot be scored does not begin.
            if let Some(start) = settings.start.or(truth.start) {
                Reference::from_start(truth, &settings.body, start.position)?;
            }
            let moving = self.setup.scenario.request()?;
            Ok((settings, moving, new_folder(&self.out)?))
        };
        match begun() {
            Ok((settings, moving, folder)) => {
                self.driven = 0;
                self.paused = false;
                self.report = None;
                self.form = None;
                self.comparison = None;
                self.message = String::new();
                self.phase = Phase::Running;
                if self.setup.training {
                    self.note_shown(&truth.0);
                }
                self.folder = folder;
                let view = TrialView { truth: self.setup.training, ..default() };
                let mut world = commands.entity(self.world);
                if moving.is_still() {
                    world.remove::<EnvironmentScenario>();
                } else {
                    world.insert(EnvironmentScenario::new(moving, seed.0));
                }
                if settings.policy.is_none() {
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

    /// Ends a trial: writes log, pictures and report, and asks for the form if a person drove. The
    /// scores are shown after the form, so that they do not influence the ratings.
    pub(crate) fn finish(&mut self, holder: &mut MappingTrial, world: &GroundTruth) {
        holder.stop();
        self.paused = false;
        self.await_log();
        let Some(trial) = holder.trial() else {
            self.give_up("The trial was stopped before it began. Nothing is saved.".to_owned());
            return;
        };
        self.phase = Phase::Done;
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
        if report.settings.policy.is_none() {
            self.form = Some(FeedbackForm::new(report.session()));
            self.phase = Phase::Form;
        }
        let marked =
            if self.shown.contains(&world.digest()) { self.mark_training() } else { Ok(()) };
        let written = output::folder(&self.folder)
            .and_then(|folder| output::write(folder, trial, &truth, &report));
        self.message = match (written, marked) {
            (Ok(_), Ok(())) => format!("saved in {}", self.folder.display()),
            (Ok(_), Err(error)) => format!("saved in {}: {error}", self.folder.display()),
            (Err(error), _) => error.to_string(),
        };
        self.report = Some(report);
        self.truth = Some(Arc::new(truth));
    }

    /// Returns to the settings for a reason that is shown.
    fn give_up(&mut self, reason: String) {
        if self.phase == Phase::Running {
            // If nothing was written, the folder is empty. Only an empty folder is removed.
            std::fs::remove_dir(&self.folder).ok();
        }
        self.message = reason;
        self.phase = Phase::Setup;
    }

    /// Starts to write the current log, unless a log is being written.
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

    /// Marks the folder of a trial in a world that was shown before or during the trial, so that its
    /// scores are not blind.
    fn mark_training(&mut self) -> std::io::Result<()> {
        let marked = marked(&self.folder);
        std::fs::rename(&self.folder, &marked)?;
        self.folder = marked;
        Ok(())
    }

    /// Records that the person sees a true world, which they also know in later trials.
    pub(crate) fn note_shown(&mut self, world: &Arc<envgen::World>) {
        if !self.last_shown.as_ref().is_some_and(|last| Arc::ptr_eq(last, world)) {
            self.shown.push(world.digest());
            self.last_shown = Some(Arc::clone(world));
        }
    }

    /// Adds the answers to the report and shows the scores. If the report cannot be written, the form stays.
    pub(crate) fn hand_in(&mut self, feedback: Feedback) {
        let Some(report) = &mut self.report else { return };
        report.feedback = Some(feedback);
        let path = self.folder.join("report.json");
        let json = serde_json::to_vec_pretty(report).map_err(std::io::Error::from).in_file(&path);
        let written = json.and_then(|mut json| {
            json.push(b'\n');
            whole_file::write(&path, &json)
        });
        match written {
            Ok(()) => {
                self.form = None;
                self.phase = Phase::Done;
            }
            Err(error) => {
                report.feedback = None;
                self.message = error.to_string();
            }
        }
    }

    /// Shows the scores without the form. What is filled in is kept in a file.
    pub(crate) fn skip_form(&mut self) {
        match self.save_draft() {
            Some(Ok(path)) => self.message = format!("what the form has is in {}", path.display()),
            Some(Err(error)) => {
                self.message = error.to_string();
                return;
            }
            None => {}
        }
        self.form = None;
        self.phase = Phase::Done;
    }

    fn save_draft(&self) -> Option<Result<PathBuf, Located<io::Error>>> {
        let (form, report) = (self.form.as_ref()?, self.report.as_ref()?);
        draft::save(form, &report.session(), &self.folder)
    }

    /// Carries out an action of a key or a button during a trial.
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
            TrialAction::Stop => {
                self.finish(trial, truth);
                if self.phase == Phase::Setup {
                    // It would begin later. Without a view, the true world would be visible.
                    commands.entity(self.world).remove::<MappingTrial>().insert(*view);
                }
            }
            TrialAction::Training => {
                self.setup.training = !self.setup.training;
                if self.setup.training {
                    self.note_shown(&truth.0);
                }
                view.truth = self.setup.training;
            }
            TrialAction::NextRobot => {
                let robots = trial.robots().len();
                self.driven = (self.driven + 1) % robots.max(1);
            }
        }
    }

    /// Compares the session with the chosen program.
    pub(crate) fn compare(&mut self, holder: &MappingTrial, world: &GroundTruth) {
        let (Some(trial), Some(truth)) = (holder.trial(), &self.truth) else { return };
        let program = TrialSettings { policy: Some(self.rival), ..trial.settings().clone() };
        let name = self.rival.name().unwrap_or("program");
        let run = SessionRun {
            log: trial.log(),
            tracks: (0..trial.robots()).map(|robot| trial.trajectory(robot).clone()).collect(),
        };
        let (world, truth) = (Arc::clone(&world.0), Arc::clone(truth));
        self.comparison = Some(Comparison::begin(run, world, truth, (name, program)));
    }
}

/// Creates the first of the folders `001`, `002` and so on that does not exist, with or without a mark.
/// If two windows begin at the same time, each gets a folder of its own.
fn new_folder(out: &Path) -> Result<PathBuf, Located<io::Error>> {
    let mut number = 1_u32;
    loop {
        let folder = out.join(format!("{number:03}"));
        number += 1;
        if marked(&folder).exists() {
            continue;
        }
        match std::fs::create_dir(&folder) {
            Ok(()) => return Ok(folder),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error).in_file(&folder),
        }
    }
}

/// Returns the folder of a trial during which the true world was shown.
fn marked(folder: &Path) -> PathBuf {
    let mut name = folder.as_os_str().to_owned();
    name.push("_training");
    name.into()
}

/// Hides the lines over the world, since they also show the true world.
pub(crate) fn hide_lines(
    session: Res<Session>,
    mut of_world: ResMut<DebugLayers>,
    mut of_trial: ResMut<TrialDebugLayers>,
) {
    if !session.setup.training {
        of_world.set_if_neq(DebugLayers::default());
        of_trial.set_if_neq(TrialDebugLayers::default());
    }
}

/// Begins the trial when the world is spawned.
pub(crate) fn world_is_ready(
    ready: On<EnvironmentReady>,
    mut session: ResMut<Session>,
    truths: Query<&GroundTruth>,
    mut commands: Commands,
) {
    if session.phase == Phase::Spawning
        && let Ok(truth) = truths.get(ready.entity)
    {
        session.start(truth, &mut commands);
    }
}

/// Shows in the panel why the world cannot be spawned.
pub(crate) fn world_has_failed(failed: On<EnvironmentFailed>, mut session: ResMut<Session>) {
    session.give_up(failed.error.to_string());
}

/// Handles the end of a trial that ended by itself.
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

/// Shows in the panel why the trial cannot begin.
pub(crate) fn trial_has_failed(failed: On<TrialFailed>, mut session: ResMut<Session>) {
    session.give_up(failed.error.to_string());
}

/// Stops time while the trial is paused.
pub(crate) fn halt(session: Res<Session>, mut time: ResMut<Time<Virtual>>) {
    if session.paused != time.is_paused() {
        if session.paused {
            time.pause();
        } else {
            time.unpause();
        }
    }
}

/// Counts the ticks of trials, 20 per second, and saves their logs.
pub(crate) fn count(mut session: ResMut<Session>, trials: Query<&MappingTrial>) {
    if session.phase != Phase::Running || session.paused {
        return;
    }
    let Ok(trial) = trials.get(session.world) else { return };
    session.ticks += 1;
    if session.ticks.is_multiple_of(TICKS_PER_LOG) {
        session.keep_log(trial);
    }
}

/// Takes the results of background computations: a comparison, and the world that the settings
/// describe.
pub(crate) fn poll(
    mut session: ResMut<Session>,
    truths: Query<&GroundTruth>,
    mut commands: Commands,
) {
    let session = session.bypass_change_detection();
    if let Some(comparison) = &mut session.comparison {
        comparison.poll();
    }
    session.preview.advance();
    if session.begins && session.phase == Phase::Setup {
        session.begin(truths.get(session.world).ok(), &mut commands);
    }
}

/// Reasons for which the window changes without inputs.
pub(crate) fn activity(session: Res<Session>) -> Activity {
    let compares = matches!(session.comparison, Some(Comparison::Running(_)));
    Activity {
        moves: matches!(session.phase, Phase::Spawning | Phase::Running) && !session.paused,
        computes: compares || session.begins || session.preview.is_pending(),
    }
}

/// Ends the trial and saves it when the window is closed.
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
    } else if let Some(form) = &session.form {
        match form.fill() {
            Ok(feedback) => session.hand_in(feedback),
            Err(missing) => session.message = missing.to_string(),
        }
        // The form is still there if it was not handed in.
        #[expect(clippy::print_stderr, reason = "the window is closed")]
        match session.save_draft() {
            Some(Ok(path)) => {
                eprintln!("{}: what the form has is in {}", session.message, path.display());
            }
            Some(Err(error)) => eprintln!("the form is lost: {error}"),
            None => {}
        }
    }
}
