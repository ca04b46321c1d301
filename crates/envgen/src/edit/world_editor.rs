//! An editor of the parts of any world.

use glam::DVec2;
use thiserror::Error;

use super::target::WorldTarget;
use crate::geometry::{Pose, wrap_angle};
use crate::history::History;
use crate::provenance::Provenance;
use crate::world::{
    Claim, Doorway, Obstacle, PartId, PartKind, Surface, Tree, Violation, Wall, World,
};

/// A change of a world.
#[derive(Clone, Debug, PartialEq)]
pub enum WorldEdit {
    /// Adds a part at the end of its list, or sets the start or the goal.
    Add(NewPart),
    /// Moves a part or a pose.
    Move {
        /// The target that is moved.
        target: WorldTarget,
        /// The displacement in metres.
        by: DVec2,
    },
    /// Turns a part about its middle, or a pose about its position.
    Turn {
        /// The target that is turned.
        target: WorldTarget,
        /// The angle in radians, counter-clockwise.
        angle: f64,
    },
    /// Removes a part or a pose. The indices of the parts behind it in its list decrease by one.
    Remove(WorldTarget),
    /// Opens or closes the door of a doorway.
    SetOpen {
        /// The index of the doorway in [`World::doorways`].
        doorway: u32,
        /// Whether the door is open, so that a robot can pass.
        open: bool,
    },
}

/// A part that can be added, with its shape in metres.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "the names say it")]
pub enum NewPart {
    Wall(Wall),
    Tree(Tree),
    Doorway(Doorway),
    Obstacle(Obstacle),
    Surface(Surface),
    Victim(Pose),
    Start(Pose),
    Goal(Pose),
}

/// The reasons why an edit is refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum WorldEditError {
    /// The part or pose does not exist.
    #[error("there is no {0}")]
    NoTarget(WorldTarget),
    /// The part cannot be edited: rooms and roads follow from other parts.
    #[error("{0} cannot be edited: rooms need their plan, and roads their spec")]
    Fixed(PartId),
    /// The world would be invalid.
    #[error(transparent)]
    Broken(#[from] Violation),
}

/// A world that is being edited. Every edit can be undone and redone. A refused edit changes nothing.
///
/// An edited world is marked as edited in its provenance, and loses its measured or predicted difficulty. The other
/// promises of its certificate remain, whether they still hold or not; [`verify`](crate::certificate::verify)
/// checks them.
///
/// ```
/// use envgen::edit::{WorldEdit, WorldEditor, WorldTarget};
/// use envgen::glam::DVec2;
/// use envgen::world::{PartId, PartKind};
/// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec};
///
/// let world = ForestSpec::default().generate(Seed(7))?.to_world();
/// let mut editor = WorldEditor::new(world.clone());
/// let target = WorldTarget::Part(PartId { kind: PartKind::Tree, index: 3 });
/// editor.apply(WorldEdit::Move { target, by: DVec2::new(0.2, 0.0) })?;
/// assert_eq!(editor.world().trees[3].center.x, world.trees[3].center.x + 0.2);
/// assert!(editor.world().provenance.edited);
/// assert!(editor.undo() && *editor.world() == world);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct WorldEditor {
    world: World,
    /// The provenance before the first edit.
    provenance: Provenance,
    history: History<Change>,
}

/// A reversible change: the state before and the state after.
#[derive(Clone, Debug)]
enum Change {
    /// A change of a part. If one of the two states is absent, the part is inserted or removed.
    Part {
        target: WorldTarget,
        from: Option<NewPart>,
        to: Option<NewPart>,
    },
    Certificate {
        from: Vec<Claim>,
        to: Vec<Claim>,
    },
}

impl WorldEditor {
    /// Creates an editor of a world.
    pub fn new(world: World) -> Self {
        let provenance = world.provenance.clone();
        WorldEditor { world, provenance, history: History::default() }
    }

    /// Returns the current world.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Applies an edit. Edits that were undone before can no longer be redone.
    ///
    /// # Errors
    /// When the part does not exist or cannot be edited, or when the world would be invalid. Then nothing changes.
    /// It takes one check of the world.
    pub fn apply(&mut self, edit: WorldEdit) -> Result<(), WorldEditError> {
        let mut step = Vec::new();
        if let Err(error) = self.perform(edit, &mut step) {
            self.revert(&step);
            return Err(error);
        }
        self.history.push(step);
        self.mark();
        Ok(())
    }

    /// Tests whether an edit is allowed now, without changing the world.
    ///
    /// # Errors
    /// As [`WorldEditor::apply`].
    pub fn test(&mut self, edit: WorldEdit) -> Result<(), WorldEditError> {
        let mut step = Vec::new();
        let result = self.perform(edit, &mut step);
        self.revert(&step);
        result
    }

    /// Undoes the last change; returns whether there was one.
    pub fn undo(&mut self) -> bool {
        let mut history = std::mem::take(&mut self.history);
        let is_undone = history.undo(|step| self.revert(step));
        self.history = history;
        self.mark();
        is_undone
    }

    /// Repeats the edit that was undone last; returns whether there was one.
    pub fn redo(&mut self) -> bool {
        let mut history = std::mem::take(&mut self.history);
        let is_redone =
            history.redo(|step| step.iter().for_each(|change| self.change(change, true)));
        self.history = history;
        self.mark();
        is_redone
    }

    /// Returns whether there is a change to undo.
    pub fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    /// Returns whether there is a change to redo.
    pub fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    /// Records in the provenance whether the world was edited.
    fn mark(&mut self) {
        self.world.provenance = self.provenance.clone();
        if self.history.can_undo() {
            self.world.provenance.edited = true;
            self.world.provenance.edits.clear();
            self.world.provenance.measured = None;
        }
    }

    fn perform(&mut self, edit: WorldEdit, step: &mut Vec<Change>) -> Result<(), WorldEditError> {
        match edit {
            WorldEdit::Add(part) => {
                let target = self.place_of(&part);
                // A world has one start and one goal.
                let from = match target {
                    WorldTarget::Start | WorldTarget::Goal => self.get(target).ok(),
                    _ => None,
                };
                self.record(Change::Part { target, from, to: Some(part) }, step);
            }
            WorldEdit::Move { target, by } => {
                let from = self.get(target)?;
                let to = Some(from.clone().moved(by));
                self.record(Change::Part { target, from: Some(from), to }, step);
            }
            WorldEdit::Turn { target, angle } => {
                let from = self.get(target)?;
                let to = Some(from.clone().turned(angle));
                self.record(Change::Part { target, from: Some(from), to }, step);
            }
            WorldEdit::Remove(target) => {
                let from = Some(self.get(target)?);
                self.record(Change::Part { target, from, to: None }, step);
            }
            WorldEdit::SetOpen { doorway, open } => {
                let id = PartId { kind: PartKind::Doorway, index: doorway };
                let target = WorldTarget::Part(id);
                let from = self.get(target)?;
                let NewPart::Doorway(old) = &from else {
                    return Err(WorldEditError::NoTarget(target));
                };
                let to = Some(NewPart::Doorway(Doorway { open, ..old.clone() }));
                self.record(Change::Part { target, from: Some(from), to }, step);
            }
        }
        self.adapt_claims(step);
        Ok(self.world.check()?)
    }

    /// Removes predictions, which refer to the world before the edit, and updates the indices of added doorways.
    fn adapt_claims(&mut self, step: &mut Vec<Change>) {
        let removed = step.iter().find_map(|change| match change {
            Change::Part { target: WorldTarget::Part(id), to: None, .. } => {
                (id.kind == PartKind::Doorway).then_some(id.index)
            }
            _ => None,
        });
        let adapted = |claim: &Claim| match *claim {
            Claim::PredictedDifficulty { .. } => None,
            Claim::AddedDoorway { doorway } => match removed {
                Some(gone) if gone == doorway => None,
                Some(gone) if gone < doorway => Some(Claim::AddedDoorway { doorway: doorway - 1 }),
                _ => Some(*claim),
            },
            _ => Some(*claim),
        };
        let from = self.world.certificate.clone();
        let to: Vec<Claim> = from.iter().filter_map(adapted).collect();
        if to != from {
            self.record(Change::Certificate { from, to }, step);
        }
    }

    /// Returns the target that a part will be when it is added.
    pub(super) fn place_of(&self, part: &NewPart) -> WorldTarget {
        let end = |kind, len: usize| WorldTarget::Part(PartId { kind, index: len as u32 });
        match part {
            NewPart::Wall(_) => end(PartKind::Wall, self.world.walls.len()),
            NewPart::Tree(_) => end(PartKind::Tree, self.world.trees.len()),
            NewPart::Doorway(_) => end(PartKind::Doorway, self.world.doorways.len()),
            NewPart::Obstacle(_) => end(PartKind::Obstacle, self.world.obstacles.len()),
            NewPart::Surface(_) => end(PartKind::Surface, self.world.surfaces.len()),
            NewPart::Victim(_) => WorldTarget::Victim(self.world.victims.len() as u32),
            NewPart::Start(_) => WorldTarget::Start,
            NewPart::Goal(_) => WorldTarget::Goal,
        }
    }

    fn get(&self, target: WorldTarget) -> Result<NewPart, WorldEditError> {
        let world = &self.world;
        let found = match target {
            WorldTarget::Start => world.start.map(NewPart::Start),
            WorldTarget::Goal => world.goal.map(NewPart::Goal),
            WorldTarget::Victim(index) => {
                world.victims.get(index as usize).copied().map(NewPart::Victim)
            }
            WorldTarget::Part(id) => {
                let index = id.index as usize;
                match id.kind {
                    PartKind::Wall => world.walls.get(index).cloned().map(NewPart::Wall),
                    PartKind::Tree => world.trees.get(index).copied().map(NewPart::Tree),
                    PartKind::Doorway => world.doorways.get(index).cloned().map(NewPart::Doorway),
                    PartKind::Obstacle => {
                        world.obstacles.get(index).cloned().map(NewPart::Obstacle)
                    }
                    PartKind::Surface => world.surfaces.get(index).cloned().map(NewPart::Surface),
                    PartKind::Room | PartKind::RoadStrip | PartKind::Ground => {
                        return Err(WorldEditError::Fixed(id));
                    }
                    PartKind::Start | PartKind::Goal | PartKind::Victim => None,
                }
            }
        };
        found.ok_or(WorldEditError::NoTarget(target))
    }

    fn record(&mut self, change: Change, step: &mut Vec<Change>) {
        self.change(&change, true);
        step.push(change);
    }

    fn revert(&mut self, step: &[Change]) {
        step.iter().rev().for_each(|change| self.change(change, false));
    }

    /// Makes a change, or reverts it.
    fn change(&mut self, change: &Change, forward: bool) {
        match change {
            Change::Certificate { from, to } => {
                self.world.certificate.clone_from(if forward { to } else { from });
            }
            Change::Part { target, from, to } => {
                let (from, to) = if forward { (from, to) } else { (to, from) };
                self.set(*target, from.as_ref(), to.as_ref());
            }
        }
    }

    fn set(&mut self, target: WorldTarget, from: Option<&NewPart>, to: Option<&NewPart>) {
        let world = &mut self.world;
        let index = match target {
            WorldTarget::Part(id) => id.index as usize,
            WorldTarget::Victim(index) => index as usize,
            WorldTarget::Start | WorldTarget::Goal => 0,
        };
        /// Replaces a part by another one. If one of the two is absent, the parts behind it move.
        macro_rules! put {
            ($list:ident, $variant:ident) => {{
                let part = match to {
                    Some(NewPart::$variant(part)) => vec![part.clone()],
                    _ => Vec::new(),
                };
                let replaced = usize::from(from.is_some());
                world.$list.splice(index..index + replaced, part);
            }};
        }
        match to.or(from) {
            Some(NewPart::Wall(_)) => put!(walls, Wall),
            Some(NewPart::Tree(_)) => put!(trees, Tree),
            Some(NewPart::Doorway(_)) => put!(doorways, Doorway),
            Some(NewPart::Obstacle(_)) => put!(obstacles, Obstacle),
            Some(NewPart::Surface(_)) => put!(surfaces, Surface),
            Some(NewPart::Victim(_)) => put!(victims, Victim),
            Some(NewPart::Start(_)) => {
                world.start = to
                    .and_then(|to| if let NewPart::Start(pose) = to { Some(*pose) } else { None });
            }
            Some(NewPart::Goal(_)) => {
                world.goal =
                    to.and_then(|to| if let NewPart::Goal(pose) = to { Some(*pose) } else { None });
            }
            None => {}
        }
    }
}

impl NewPart {
    fn moved(self, by: DVec2) -> Self {
        let pose = |pose: Pose| Pose { position: pose.position + by, ..pose };
        match self {
            NewPart::Wall(wall) => NewPart::Wall(Wall { shape: wall.shape.moved(by), ..wall }),
            NewPart::Tree(tree) => NewPart::Tree(Tree { center: tree.center + by, ..tree }),
            NewPart::Doorway(door) => {
                NewPart::Doorway(Doorway { shape: door.shape.moved(by), ..door })
            }
            NewPart::Obstacle(obstacle) => {
                NewPart::Obstacle(Obstacle { shape: obstacle.shape.moved(by), ..obstacle })
            }
            NewPart::Surface(surface) => {
                NewPart::Surface(Surface { shape: surface.shape.moved(by), ..surface })
            }
            NewPart::Victim(there) => NewPart::Victim(pose(there)),
            NewPart::Start(there) => NewPart::Start(pose(there)),
            NewPart::Goal(there) => NewPart::Goal(pose(there)),
        }
    }

    fn turned(self, angle: f64) -> Self {
        let pose = |pose: Pose| Pose { heading: wrap_angle(pose.heading + angle), ..pose };
        match self {
            NewPart::Wall(wall) => NewPart::Wall(Wall { shape: wall.shape.turned(angle), ..wall }),
            tree @ NewPart::Tree(_) => tree,
            NewPart::Doorway(door) => {
                NewPart::Doorway(Doorway { shape: door.shape.turned(angle), ..door })
            }
            NewPart::Obstacle(obstacle) => {
                NewPart::Obstacle(Obstacle { shape: obstacle.shape.turned(angle), ..obstacle })
            }
            NewPart::Surface(surface) => {
                NewPart::Surface(Surface { shape: surface.shape.turned(angle), ..surface })
            }
            NewPart::Victim(there) => NewPart::Victim(pose(there)),
            NewPart::Start(there) => NewPart::Start(pose(there)),
            NewPart::Goal(there) => NewPart::Goal(pose(there)),
        }
    }
}

#[cfg(test)]
mod tests;
