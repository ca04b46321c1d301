//! Documents: plans and other worlds that are being edited.

use std::sync::Arc;

use glam::DVec2;
use thiserror::Error;

use super::target::WorldTarget;
use super::world_editor::{NewPart, WorldEdit, WorldEditError, WorldEditor};
use crate::certificate::{Verdict, verify};
use crate::generate::Blueprint;
use crate::geometry::Shape;
use crate::indoor::{Edit, EditError, FloorPlan, PlanEditor, PlanTarget};
use crate::provenance::MeasuredDifficulty;
use crate::reproduction::{Reproduction, reproduce};
use crate::spec::{WorldBlueprint, WorldKind};
use crate::world::{Claim, PartKind, World};

/// A part of a document that can be selected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A target in a plan.
    Plan(PlanTarget),
    /// A target in another world.
    World(WorldTarget),
}

/// A change of a document.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// A change of a plan.
    Plan(Box<Edit>),
    /// A change of another world.
    World(Box<WorldEdit>),
}

impl From<Edit> for Change {
    fn from(edit: Edit) -> Self {
        Change::Plan(Box::new(edit))
    }
}

impl From<WorldEdit> for Change {
    fn from(edit: WorldEdit) -> Self {
        Change::World(Box::new(edit))
    }
}

/// The reasons why a change is refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DocumentError {
    /// The change of a plan is refused.
    #[error(transparent)]
    Plan(#[from] EditError),
    /// The change of another world is refused.
    #[error(transparent)]
    World(#[from] WorldEditError),
    /// The change is for the other type of document. Plans have rooms, hallways, doorways and objects in rooms;
    /// other worlds have parts.
    #[error("a change of a plan needs a plan, and a change of parts needs a world of parts")]
    OtherDocument,
}

/// A plan or any other world that is being edited, with a single list of steps to undo.
///
/// ```
/// use envgen::edit::{Document, Target};
/// use envgen::indoor::{IndoorSpec, PlanTarget};
/// use envgen::{Blueprint, Seed, Spec};
///
/// let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
/// let world = spec.generate(Seed(2))?.to_world();
/// // Worlds of a spec and a seed are edited as what they were built from.
/// let mut document = Document::from_world(world);
/// let room = Target::Plan(PlanTarget::Room(0));
/// let middle = document.outline(room).map(|shape| shape.bounds().center());
/// let remove = document.remove(room).expect("rooms can be removed");
/// document.apply(remove)?;
/// assert!(document.is_changed() && document.world().provenance.edited);
/// document.undo();
/// assert_eq!(middle.and_then(|p| document.target_at(p, 0.0)).is_some(), true);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Document {
    editor: Editor,
    world: Arc<World>,
    /// The certificate of the world before the first change.
    promised: Vec<Claim>,
    /// The measured difficulty of the world before the first change, which a plan does not contain.
    measured: Option<Box<MeasuredDifficulty>>,
    /// Number of changes that were made and not undone.
    made: usize,
    /// The number of changes at which the document was saved; `None` if that state cannot be reached any more.
    saved: Option<usize>,
    /// Number of changes of each step that can be undone, and of each that can be repeated.
    done: Vec<usize>,
    undone: Vec<usize>,
}

#[derive(Clone, Debug)]
enum Editor {
    Plan(Box<PlanEditor>),
    World(Box<WorldEditor>),
}

impl Document {
    /// Creates a document from a blueprint. A plan is edited as a plan, any other blueprint as its world.
    pub fn from_blueprint(blueprint: WorldBlueprint) -> Self {
        match blueprint {
            WorldBlueprint::Indoor(plan) => Document::from_plan(plan),
            other => Document::of(Editor::World(Box::new(WorldEditor::new(other.to_world())))),
        }
    }

    /// Creates a document from a plan.
    pub fn from_plan(plan: FloorPlan) -> Self {
        Document::of(Editor::Plan(Box::new(PlanEditor::new(plan))))
    }

    /// Creates a document from a world. If the world is an indoor map as its spec, seed and edits give it, its plan
    /// is edited.
    pub fn from_world(world: World) -> Self {
        if world.provenance.kind == WorldKind::Indoor.name()
            && let Reproduction::Same(blueprint) = reproduce(&world)
        {
            let mut document = Document::from_blueprint(*blueprint);
            document.measured = world.provenance.measured;
            document.refresh();
            return document;
        }
        Document::of(Editor::World(Box::new(WorldEditor::new(world))))
    }

    fn of(editor: Editor) -> Self {
        let world = Arc::new(editor.world());
        let promised = world.certificate.clone();
        let measured = world.provenance.measured.clone();
        let (done, undone) = (Vec::new(), Vec::new());
        Document { editor, world, promised, measured, made: 0, saved: Some(0), done, undone }
    }

    /// Returns the current world.
    pub fn world(&self) -> &Arc<World> {
        &self.world
    }

    /// Returns the current plan, if the document is a plan.
    pub fn plan(&self) -> Option<&FloorPlan> {
        self.plan_editor().map(PlanEditor::plan)
    }

    /// Returns the editor of the plan, if the document is a plan.
    pub fn plan_editor(&self) -> Option<&PlanEditor> {
        match &self.editor {
            Editor::Plan(editor) => Some(editor),
            Editor::World(_) => None,
        }
    }

    /// Returns the blueprint for formats that contain plans.
    pub fn blueprint(&self) -> Option<WorldBlueprint> {
        self.plan().map(|plan| WorldBlueprint::Indoor(plan.clone()))
    }

    /// Returns the world with only those claims of its certificate that hold.
    pub fn certified_world(&self) -> World {
        let mut world = World::clone(&self.world);
        if world.provenance.edited {
            let checked = verify(&world).into_iter();
            let holds = checked.filter(|(_, verdict)| *verdict == Verdict::Holds);
            world.certificate = holds.map(|(claim, _)| claim).collect();
        }
        world
    }

    /// Returns the promises that an [`Audit`](super::Audit) should check: those of the world before the first
    /// change, and those of its certificate now. Once it is edited, promises about its generation only are left
    /// out.
    pub fn promises(&self) -> Vec<Claim> {
        let of_generation = |claim: &&Claim| {
            matches!(claim, Claim::PredictedDifficulty { .. } | Claim::AddedDoorway { .. })
        };
        let mut promises = self.world.certificate.clone();
        let others = self.promised.iter().filter(|claim| !of_generation(claim));
        for claim in others {
            if !promises.contains(claim) {
                promises.push(*claim);
            }
        }
        promises
    }

    /// Returns the target at a point in metres, or within a distance of `reach` from it.
    pub fn target_at(&self, p: DVec2, reach: f64) -> Option<Target> {
        match &self.editor {
            Editor::Plan(editor) => editor.plan().target_at(p, reach).map(Target::Plan),
            Editor::World(_) => self.world.target_at(p, reach).map(Target::World),
        }
    }

    /// Returns the outline of a target in metres; `None` if the target does not exist, and for roads.
    pub fn outline(&self, target: Target) -> Option<Shape> {
        match (&self.editor, target) {
            (Editor::Plan(editor), Target::Plan(target)) => editor.plan().outline(target),
            (Editor::World(_), Target::World(target)) => self.world.outline(target),
            _ => None,
        }
    }

    /// Returns a short description of a target.
    pub fn describe(&self, target: Target) -> String {
        match target {
            Target::Plan(target) => self.plan().map(|plan| describe(plan, target)),
            Target::World(target) => Some(self.describe_part(target)),
        }
        .unwrap_or_default()
    }

    fn describe_part(&self, target: WorldTarget) -> String {
        let WorldTarget::Part(id) = target else { return target.to_string() };
        let index = id.index as usize;
        match id.kind {
            PartKind::Obstacle => self.world.obstacles.get(index).map(|o| name(&o.kind)),
            PartKind::Wall => self.world.walls.get(index).map(|wall| name(&wall.kind)),
            PartKind::Surface => self.world.surfaces.get(index).map(|s| name(&s.kind)),
            PartKind::Room => self.world.rooms.get(index).map(|room| format!("`{}`", room.name)),
            _ => None,
        }
        .map_or_else(|| id.to_string(), |name| format!("{id} ({name})"))
    }

    /// Returns the change that moves a target by `by` metres, or a room by whole cells; `None` for a target that
    /// cannot be moved.
    pub fn moved(&self, target: Target, by: DVec2) -> Option<Change> {
        let target = match target {
            Target::World(target) => return Some(WorldEdit::Move { target, by }.into()),
            Target::Plan(target) => target,
        };
        let plan = self.plan()?;
        match target {
            PlanTarget::Room(index) => {
                let room = plan.rooms().get(index)?;
                let (width, height) = room.size();
                // Rows run down. A room stays in the grid.
                let cells = (by * DVec2::new(1.0, -1.0) / plan.spec().cell_size).round();
                let within = |from: u32, by: f64, size: u32, all: u32| {
                    (f64::from(from) + by).clamp(0.0, f64::from(all.saturating_sub(size))) as u32
                };
                let x = within(room.x, cells.x, width, plan.grid().width());
                let y = within(room.y, cells.y, height, plan.grid().height());
                Some(Edit::MoveRoom { room: index, x, y }.into())
            }
            PlanTarget::Object { room, object } => {
                Some(Edit::MoveObject { room, object, by }.into())
            }
            PlanTarget::Hallway { .. } | PlanTarget::Doorway(_) => None,
        }
    }

    /// Returns the change that turns a target counter-clockwise: a room by a quarter turn, everything else by an
    /// angle in radians. `None` for a target that cannot be turned, or that is round.
    pub fn turned(&self, target: Target, angle: f64) -> Option<Change> {
        // The outlines of poses are discs as well.
        let has_shape = matches!(
            target,
            Target::World(WorldTarget::Part(_)) | Target::Plan(PlanTarget::Object { .. })
        );
        if has_shape && matches!(self.outline(target), Some(Shape::Disc { .. })) {
            return None;
        }
        match target {
            Target::World(target) => Some(WorldEdit::Turn { target, angle }.into()),
            Target::Plan(PlanTarget::Room(room)) => {
                Some(Edit::TurnRoom { room, quarters: if angle < 0.0 { 3 } else { 1 } }.into())
            }
            Target::Plan(PlanTarget::Object { room, object }) => {
                Some(Edit::TurnObject { room, object, angle }.into())
            }
            Target::Plan(_) => None,
        }
    }

    /// Returns the change that removes a target.
    pub fn remove(&self, target: Target) -> Option<Change> {
        let edit = match target {
            Target::World(target) => return Some(WorldEdit::Remove(target).into()),
            Target::Plan(PlanTarget::Room(room)) => Edit::RemoveRoom { room },
            Target::Plan(PlanTarget::Hallway { x, y }) => Edit::RemoveHallway { x, y },
            Target::Plan(PlanTarget::Doorway(gate)) => Edit::CloseDoorway(gate),
            Target::Plan(PlanTarget::Object { room, object }) => {
                Edit::RemoveObject { room, object }
            }
        };
        Some(edit.into())
    }

    /// Returns the outline in metres of the target as a change would add, move or turn it, whether the change is
    /// allowed or not; for a removal, the outline of the target to be removed.
    pub fn preview(&self, change: &Change) -> Option<Shape> {
        match change {
            Change::Plan(edit) => preview_plan(self.plan()?, edit),
            Change::World(edit) => match &**edit {
                WorldEdit::Add(part) => part.outline(),
                WorldEdit::Move { target, by } => Some(self.world.outline(*target)?.moved(*by)),
                WorldEdit::Turn { target, angle } => {
                    Some(self.world.outline(*target)?.turned(*angle))
                }
                WorldEdit::Remove(target) => self.world.outline(*target),
                WorldEdit::SetOpen { doorway, .. } => {
                    Some(self.world.doorways.get(*doorway as usize)?.shape.clone())
                }
            },
        }
    }

    /// Tests whether a change is allowed now, without changing the document.
    ///
    /// # Errors
    /// As [`Document::apply`].
    pub fn test(&mut self, change: Change) -> Result<(), DocumentError> {
        match (&mut self.editor, change) {
            (Editor::Plan(editor), Change::Plan(edit)) => Ok(editor.test(*edit)?),
            (Editor::World(editor), Change::World(edit)) => Ok(editor.test(*edit)?),
            _ => Err(DocumentError::OtherDocument),
        }
    }

    /// Makes a change, and returns the target that it added, moved or turned, by its new name.
    ///
    /// # Errors
    /// When the plan or world refuses the change. Then nothing changes.
    pub fn apply(&mut self, change: Change) -> Result<Option<Target>, DocumentError> {
        let target = self.make(change)?;
        self.done.push(1);
        Ok(target)
    }

    /// Makes a change as a part of the last step: undo and redo treat them as one. Without a step, it is one.
    ///
    /// ```
    /// use envgen::edit::Document;
    /// use envgen::indoor::{Edit, IndoorSpec};
    /// use envgen::{Seed, Spec};
    ///
    /// let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
    /// let mut document = Document::from_plan(spec.generate(Seed(5))?);
    /// document.apply(Edit::RemoveRoom { room: 0 }.into())?;
    /// document.extend(Edit::RemoveRoom { room: 0 }.into())?;
    /// assert!(document.undo());
    /// assert!(!document.is_changed());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Document::apply`].
    pub fn extend(&mut self, change: Change) -> Result<Option<Target>, DocumentError> {
        let target = self.make(change)?;
        match self.done.last_mut() {
            Some(changes) => *changes += 1,
            None => self.done.push(1),
        }
        Ok(target)
    }

    fn make(&mut self, change: Change) -> Result<Option<Target>, DocumentError> {
        let target = match (&mut self.editor, change) {
            (Editor::Plan(editor), Change::Plan(edit)) => {
                let named = named_after(&edit, editor.plan());
                editor.apply(*edit)?;
                named.map(Target::Plan)
            }
            (Editor::World(editor), Change::World(edit)) => {
                let named = match &*edit {
                    WorldEdit::Add(part) => Some(editor.place_of(part)),
                    WorldEdit::Move { target, .. } | WorldEdit::Turn { target, .. } => {
                        Some(*target)
                    }
                    WorldEdit::Remove(_) | WorldEdit::SetOpen { .. } => None,
                };
                editor.apply(*edit)?;
                named.map(Target::World)
            }
            _ => return Err(DocumentError::OtherDocument),
        };
        // What was undone and saved is gone.
        self.saved = self.saved.filter(|saved| *saved <= self.made);
        self.made += 1;
        self.undone.clear();
        self.refresh();
        Ok(target)
    }

    /// Undoes the last step; returns whether there was one.
    pub fn undo(&mut self) -> bool {
        let Some(changes) = self.done.pop() else { return false };
        for _ in 0..changes {
            match &mut self.editor {
                Editor::Plan(editor) => editor.undo(),
                Editor::World(editor) => editor.undo(),
            };
        }
        self.undone.push(changes);
        self.made -= changes;
        self.refresh();
        true
    }

    /// Repeats the step that was undone last; returns whether there was one.
    pub fn redo(&mut self) -> bool {
        let Some(changes) = self.undone.pop() else { return false };
        for _ in 0..changes {
            match &mut self.editor {
                Editor::Plan(editor) => editor.redo(),
                Editor::World(editor) => editor.redo(),
            };
        }
        self.done.push(changes);
        self.made += changes;
        self.refresh();
        true
    }

    /// Returns whether there is a step to undo.
    pub fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    /// Returns whether there is a step to redo.
    pub fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }

    /// Returns whether the document differs from what was opened or last saved.
    pub fn is_changed(&self) -> bool {
        self.saved != Some(self.made)
    }

    /// Marks the current state as saved.
    pub fn mark_saved(&mut self) {
        self.saved = Some(self.made);
    }

    fn refresh(&mut self) {
        let mut world = self.editor.world();
        if self.made == 0 {
            world.provenance.measured.clone_from(&self.measured);
        }
        self.world = Arc::new(world);
    }
}

impl Editor {
    fn world(&self) -> World {
        match self {
            Editor::Plan(editor) => editor.plan().to_world(),
            Editor::World(editor) => editor.world().clone(),
        }
    }
}

/// Returns the name of a kind in files, in words.
fn name(kind: &impl serde::Serialize) -> String {
    match serde_json::to_value(kind) {
        Ok(serde_json::Value::String(name)) => name.replace('_', " "),
        _ => "class".to_owned(),
    }
}

fn describe(plan: &FloorPlan, target: PlanTarget) -> String {
    match target {
        PlanTarget::Room(room) => plan.rooms().get(room).map_or_else(String::new, |placed| {
            format!("room `{}`, difficulty {}", placed.room.name, placed.room.difficulty)
        }),
        PlanTarget::Hallway { x, y } => format!("hallway at column {x}, row {y}"),
        PlanTarget::Doorway(_) => "doorway".to_owned(),
        PlanTarget::Object { room, object } => {
            let found = plan.object(room, object);
            found.map_or_else(String::new, |object| name(&object.kind))
        }
    }
}

/// Returns the target that an edit of a plan adds, moves or turns, by its new name. A room that changes its place
/// becomes the last one.
fn named_after(edit: &Edit, plan: &FloorPlan) -> Option<PlanTarget> {
    let rooms = plan.rooms().len();
    match *edit {
        Edit::AddRoom { .. } => Some(PlanTarget::Room(rooms)),
        Edit::MoveRoom { .. } | Edit::TurnRoom { .. } => Some(PlanTarget::Room(rooms.max(1) - 1)),
        Edit::AddHallway { x, y } => Some(PlanTarget::Hallway { x, y }),
        Edit::OpenDoorway(gate) => Some(PlanTarget::Doorway(gate)),
        Edit::AddObject { room, .. } => {
            let object = plan.rooms().get(room)?.room.obstacles.len();
            Some(PlanTarget::Object { room, object })
        }
        Edit::MoveObject { room, object, .. } | Edit::TurnObject { room, object, .. } => {
            Some(PlanTarget::Object { room, object })
        }
        Edit::RemoveRoom { .. }
        | Edit::RemoveHallway { .. }
        | Edit::CloseDoorway(_)
        | Edit::RemoveObject { .. } => None,
    }
}

fn preview_plan(plan: &FloorPlan, edit: &Edit) -> Option<Shape> {
    let swapped = |(width, height): (u32, u32), is_swapped: bool| {
        if is_swapped { (height, width) } else { (width, height) }
    };
    match edit {
        Edit::AddRoom { room, x, y, quarters } => {
            let size = swapped((room.width, room.height), quarters % 2 == 1);
            Some(plan.cells_outline(*x, *y, size))
        }
        Edit::MoveRoom { room, x, y } => {
            Some(plan.cells_outline(*x, *y, plan.rooms().get(*room)?.size()))
        }
        Edit::TurnRoom { room, quarters } => {
            let room = plan.rooms().get(*room)?;
            Some(plan.cells_outline(room.x, room.y, swapped(room.size(), quarters % 2 == 1)))
        }
        Edit::RemoveRoom { room } => plan.outline(PlanTarget::Room(*room)),
        Edit::AddHallway { x, y } | Edit::RemoveHallway { x, y } => {
            Some(plan.cells_outline(*x, *y, (1, 1)))
        }
        Edit::OpenDoorway(gate) | Edit::CloseDoorway(gate) => Some(plan.doorway_outline(*gate)),
        Edit::AddObject { object, .. } => Some(object.shape.clone()),
        Edit::MoveObject { room, object, by } => {
            Some(plan.object(*room, *object)?.shape.moved(*by))
        }
        Edit::TurnObject { room, object, angle } => {
            Some(plan.object(*room, *object)?.shape.turned(*angle))
        }
        Edit::RemoveObject { room, object } => Some(plan.object(*room, *object)?.shape),
    }
}

impl NewPart {
    /// Returns the outline of a new part in metres, or a disc around a pose.
    fn outline(&self) -> Option<Shape> {
        match self {
            NewPart::Wall(wall) => Some(wall.shape.clone()),
            NewPart::Tree(tree) => Some(Shape::Disc { center: tree.center, radius: tree.radius }),
            NewPart::Doorway(doorway) => Some(doorway.shape.clone()),
            NewPart::Obstacle(obstacle) => Some(obstacle.shape.clone()),
            NewPart::Surface(surface) => Some(surface.shape.clone()),
            NewPart::Victim(pose) | NewPart::Start(pose) | NewPart::Goal(pose) => {
                Some(super::target::mark(pose))
            }
        }
    }
}

#[cfg(test)]
mod tests;
