//! The session: the edited document, and the person's actions.

use std::error::Error;
use std::f64::consts::FRAC_PI_2;
use std::path::PathBuf;
use std::sync::Arc;

use bevy::prelude::*;
use bevy_envgen::prelude::*;
use bevy_mapping_trial::ui::egui;
use envgen::edit::{Change, Document, DocumentError, Target, WorldTarget};
use envgen::glam::DVec2;
use envgen::indoor::Catalogue;
use envgen::mesh::BodyRaycaster;
use envgen::pieces::pieces;
use envgen::world::{PartId, PartKind};

use crate::arguments::Opened;
use crate::auditing::Auditing;
use crate::saving;
use crate::tools::{Tool, Tools};
use crate::trial::Trials;
use crate::view::{Placed, View};

/// Time in seconds for which a refusal is shown where it happened.
const REFUSAL: f64 = 4.0;

/// Angle by which everything except rooms is turned.
pub(crate) const TURN: f64 = FRAC_PI_2 / 6.0;

/// A change that was refused, and its position.
pub(crate) struct Refusal {
    pub(crate) text: String,
    pub(crate) at: DVec2,
    until: f64,
}

/// Something that is being dragged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drag {
    pub(crate) target: Target,
    pub(crate) from: DVec2,
}

/// A question that is to be answered before anything else is done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Question {
    /// Whether changes that are not saved are saved before the window closes.
    Unsaved,
    /// Whether files are replaced that the command line does not name and this session has not written.
    Replace {
        files: Vec<PathBuf>,
        /// Whether the window closes afterwards.
        closes: bool,
    },
}

/// The answer to a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    Save,
    Discard,
    Stay,
}

/// The bodies that the tilted view shows.
struct Bodies {
    revision: u64,
    index: BodyRaycaster,
    /// The part of each body; the ground is of none.
    parts: Vec<Option<PartId>>,
}

/// Everything that the window shows and changes.
#[derive(Resource)]
pub(crate) struct Session {
    pub(crate) document: Document,
    pub(crate) catalogue: Catalogue,
    pub(crate) name: String,
    /// The file to save to, as typed.
    pub(crate) out: String,
    /// Files that are replaced without a question: that of the command line, and those that were saved.
    own: Vec<PathBuf>,
    pub(crate) tools: Tools,
    pub(crate) view: View,
    pub(crate) selected: Option<Target>,
    bodies: Option<Bodies>,
    /// What is at the pointer.
    pub(crate) hovered: Option<Target>,
    /// The point of the world at the pointer.
    pub(crate) pointer: Option<DVec2>,
    pub(crate) drag: Option<Drag>,
    /// Where the last click changed something. The next change is not shown until the pointer leaves.
    pub(crate) done_at: Option<DVec2>,
    pub(crate) refusal: Option<Refusal>,
    pub(crate) auditing: Auditing,
    pub(crate) trials: Trials,
    pub(crate) grid: bool,
    pub(crate) question: Option<Question>,
    pub(crate) closes: bool,
    /// The last event, in one line.
    pub(crate) message: String,
    /// Why the last file could not be written, or why the last trial could not be opened.
    pub(crate) failure: Option<String>,
    /// Number of states so far. What is drawn and audited belongs to one of them.
    pub(crate) revision: u64,
    now: f64,
}

impl Session {
    pub(crate) fn new(opened: Opened) -> Self {
        let Opened { document, catalogue, name, out, is_own, note } = opened;
        let view = View::of(document.world().bounds);
        let mut session = Session {
            tools: Tools::for_document(&document),
            document,
            catalogue,
            name,
            out: out.display().to_string(),
            own: if is_own { vec![out] } else { Vec::new() },
            view,
            selected: None,
            bodies: None,
            hovered: None,
            pointer: None,
            drag: None,
            done_at: None,
            refusal: None,
            auditing: Auditing::default(),
            trials: Trials::default(),
            grid: true,
            question: None,
            closes: false,
            message: note.unwrap_or_default(),
            failure: None,
            revision: 1,
            now: 0.0,
        };
        session.measure_height();
        session
    }

    /// Makes the tilted view show the highest part.
    fn measure_height(&mut self) {
        let tops = pieces(self.document.world()).into_iter().map(|piece| piece.form.extent().top());
        self.view.set_height(tops.fold(0.0, f64::max));
    }

    /// The canvas in points of the window.
    pub(crate) fn canvas(&self) -> egui::Rect {
        self.view.canvas()
    }

    /// Returns the point of the plan that is seen where a point of the floor would be. In the tilted
    /// view, something in front may hide it.
    pub(crate) fn seen_at(&mut self, floor: DVec2) -> DVec2 {
        self.seen_body(floor).map_or(floor, |(point, _)| point)
    }

    /// Returns the target that is seen where a point of the floor would be, or within a distance of `reach` from it.
    pub(crate) fn target_seen(&mut self, floor: DVec2, reach: f64) -> Option<Target> {
        let (point, part) = self.seen_body(floor).unwrap_or((floor, None));
        // The crown of a tree is not over its outline, which is that of the trunk. What lies flat may lie under
        // something else. Plans have targets of their own.
        let upright = part.filter(|part| {
            use PartKind::{Doorway, Obstacle, Tree, Wall};
            matches!(part.kind, Doorway | Obstacle | Tree | Wall) && self.document.plan().is_none()
        });
        match upright {
            Some(part) => Some(Target::World(WorldTarget::Part(part))),
            None => self.document.target_at(point, reach),
        }
    }

    /// In the tilted view, returns where the body is hit that is seen at a point of the floor, and its part.
    fn seen_body(&mut self, floor: DVec2) -> Option<(DVec2, Option<PartId>)> {
        if !self.view.is_tilted() {
            return None;
        }
        let (revision, world) = (self.revision, self.document.world());
        let bodies = match self.bodies.take() {
            Some(bodies) if bodies.revision == revision => bodies,
            _ => {
                let pieces = pieces(world);
                let index = BodyRaycaster::new(pieces.iter().map(|piece| &piece.form));
                let parts = pieces.iter().map(|piece| piece.part).collect();
                Bodies { revision, index, parts }
            }
        };
        let Bodies { index, parts, .. } = self.bodies.insert(bodies);
        let (from, direction) = self.view.ray(floor);
        let hit = index.cast(from, direction, 1.0)?;
        let part = parts.get(hit.body).copied().flatten();
        Some(((from + direction * hit.distance).truncate(), part))
    }

    /// Makes a change. If it is refused, this is shown at a point.
    pub(crate) fn change(&mut self, change: Change, at: DVec2) -> bool {
        let result = self.document.apply(change);
        self.show(result, at)
    }

    /// Makes a change that is undone together with the one before.
    pub(crate) fn extend(&mut self, change: Change, at: DVec2) -> bool {
        let result = self.document.extend(change);
        self.show(result, at)
    }

    fn show(&mut self, result: Result<Option<Target>, DocumentError>, at: DVec2) -> bool {
        match result {
            Ok(target) => {
                self.selected = target;
                self.changed();
                self.done_at = Some(at);
                true
            }
            Err(error) => {
                self.refuse(error.to_string(), at);
                false
            }
        }
    }

    pub(crate) fn refuse(&mut self, text: String, at: DVec2) {
        self.refusal = Some(Refusal { text, at, until: self.now + REFUSAL });
    }

    pub(crate) fn undo(&mut self) {
        if self.document.undo() {
            self.selected = None;
            // What is painted after this is a step of its own.
            self.tools.paints = None;
            self.changed();
        }
    }

    pub(crate) fn redo(&mut self) {
        if self.document.redo() {
            self.selected = None;
            self.changed();
        }
    }

    fn changed(&mut self) {
        self.revision += 1;
        // The dragged thing may have another number now.
        self.drag = None;
        self.measure_height();
        self.refusal = None;
        self.message.clear();
    }

    /// Turns the room or object that is to be added or, with the other tools, the selection.
    pub(crate) fn turn(&mut self, angle: f64) {
        if self.tools.tool.adds() { self.tools.turn(angle) } else { self.turn_selected(angle) }
    }

    /// Turns the selection.
    pub(crate) fn turn_selected(&mut self, angle: f64) {
        let Some(target) = self.selected else { return };
        let at = self.place_of(target);
        match self.document.turned(target, angle) {
            Some(change) => _ = self.change(change, at),
            None => self.refuse("this cannot be turned".to_owned(), at),
        }
    }

    /// Removes the selection.
    pub(crate) fn remove(&mut self) {
        let Some(target) = self.selected else { return };
        let at = self.place_of(target);
        if let Some(change) = self.document.remove(target) {
            self.change(change, at);
        }
    }

    fn place_of(&self, target: Target) -> DVec2 {
        self.document.outline(target).map_or(DVec2::ZERO, |shape| shape.bounds().center())
    }

    pub(crate) fn choose(&mut self, tool: Tool) {
        if self.tools.has(tool) {
            self.tools.tool = tool;
            self.drag = None;
            self.selected = None;
        }
    }

    /// Cancels the current action.
    pub(crate) fn cancel(&mut self) {
        if self.drag.take().is_none() {
            self.choose(Tool::Select);
        }
        self.selected = None;
        self.refusal = None;
    }

    /// Writes the document to its file, after a question if this replaces a file of others.
    pub(crate) fn save(&mut self) {
        self.save_and(false);
    }

    fn save_and(&mut self, closes: bool) {
        let path = PathBuf::from(self.out.trim());
        let is_own = self.own.contains(&path);
        let files = if is_own { Vec::new() } else { saving::existing(&path) };
        if files.is_empty() {
            self.write(path, closes);
        } else {
            self.question = Some(Question::Replace { files, closes });
        }
    }

    /// Writes the document to a file. If the file does not hold all of it, the changes count as not saved, and the
    /// window stays.
    fn write(&mut self, path: PathBuf, closes: bool) {
        let saved = saving::save(&self.document, &self.catalogue, &path);
        let is_whole = saved.as_ref().is_ok_and(|saved| saved.is_whole);
        if is_whole {
            self.document.mark_saved();
        }
        if saved.is_ok() {
            self.own.push(path);
        }
        self.report(saved.map(|saved| saved.text));
        self.closes = closes && is_whole;
    }

    fn report(&mut self, result: Result<String, Box<dyn Error>>) {
        (self.message, self.failure) = match result {
            Ok(text) => (text, None),
            Err(error) => (String::new(), Some(error.to_string())),
        };
    }

    pub(crate) fn open_trial(&mut self) {
        let opened = self.trials.open(&self.document, &self.catalogue);
        self.report(opened);
    }

    /// Closes the window, after a question if changes are not saved.
    pub(crate) fn close(&mut self) {
        match self.document.is_changed() {
            true => self.question = Some(Question::Unsaved),
            false => self.closes = true,
        }
    }

    /// Carries out an answer.
    pub(crate) fn answer(&mut self, answer: Answer) {
        match (self.question.take(), answer) {
            (Some(Question::Unsaved), Answer::Save) => self.save_and(true),
            (Some(Question::Unsaved), Answer::Discard) => self.closes = true,
            (Some(Question::Replace { closes, .. }), Answer::Save) => {
                self.write(PathBuf::from(self.out.trim()), closes);
            }
            _ => {}
        }
    }
}

/// The environment that shows the world.
#[derive(Component)]
pub(crate) struct Shown {
    revision: u64,
}

/// Shows the present world.
pub(crate) fn show(
    session: Res<Session>,
    mut shown: Query<(Entity, &mut Shown)>,
    mut commands: Commands,
) {
    let environment = || {
        Environment::prebuilt(Arc::clone(session.document.world()))
            .with_pace(GenerationMode::Blocking)
            .with_solids(SolidStorage::TileData)
            .with_origin(session.view.origin())
    };
    let Ok((entity, mut state)) = shown.single_mut() else {
        commands.spawn((environment(), Shown { revision: session.revision }));
        return;
    };
    if state.revision != session.revision {
        state.revision = session.revision;
        commands.entity(entity).insert(environment());
    }
}

/// Moves the cameras to what the view shows.
pub(crate) fn follow(session: Res<Session>, window: Single<&Window>, mut cameras: Query<Placed>) {
    session.view.place(&window, &mut cameras);
}

/// Shows in the panel why the world cannot be shown.
pub(crate) fn show_failure(failed: On<EnvironmentFailed>, mut session: ResMut<Session>) {
    session.failure = Some(failed.error.to_string());
}

/// Counts time, removes old refusals, and takes the results of other threads and programs.
pub(crate) fn poll(mut session: ResMut<Session>, time: Res<Time<Real>>) {
    let session = session.bypass_change_detection();
    session.now = time.elapsed_secs_f64();
    if session.refusal.as_ref().is_some_and(|refusal| refusal.until < session.now) {
        session.refusal = None;
    }
    session.auditing.poll(&session.document, session.revision);
    if let Some(failure) = session.trials.poll() {
        session.failure = Some(failure);
    }
}

/// Closes the window if requested.
pub(crate) fn close(
    mut session: ResMut<Session>,
    mut requests: MessageReader<bevy::window::WindowCloseRequested>,
    mut exits: MessageWriter<AppExit>,
) {
    if requests.read().next().is_some() {
        session.close();
    }
    if session.closes {
        exits.write(AppExit::Success);
    }
}
