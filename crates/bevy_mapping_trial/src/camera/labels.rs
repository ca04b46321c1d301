//! The meaning of the labels in images.

use envgen::pieces::Piece;
use envgen::scenario::Target;

/// The meaning of a label.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The kind, as in world files (`wall`, `desk`, `tree`), or `leaf`, `person` or `robot` for moving
    /// bodies.
    pub kind: String,
    /// The name, which is unique in the world: `wall_3`, `doorway_0_lintel`, `person_2`.
    pub name: String,
}

/// The labels of a world and of the bodies that move in it, numbered from 1.
#[derive(Clone, Debug, Default)]
pub struct Labels {
    /// The labels of the pieces of the world, in their order.
    pieces: Vec<Label>,
    /// The number of doors of the scenario.
    doors: u32,
    people: u32,
}

impl Labels {
    pub(super) fn new(pieces: &[Piece<'_>], [doors, people]: [usize; 2]) -> Self {
        let label = |piece: &Piece<'_>| Label { kind: piece.kind.clone(), name: piece.to_string() };
        let pieces = pieces.iter().map(label).collect();
        Labels { pieces, doors: doors as u32, people: people as u32 }
    }

    /// Returns the label of a piece of the world, by its index in [`pieces`](envgen::pieces::pieces). If
    /// there are [`ceilings`](envgen::pieces::ceilings), they follow the pieces.
    pub fn of_piece(&self, piece: usize) -> u32 {
        piece as u32 + 1
    }

    /// Returns the label of a moving body. Parts of the world have a label for each of their pieces instead.
    pub fn of_moving(&self, target: Target) -> Option<u32> {
        let still = self.pieces.len() as u32;
        match target {
            Target::Part(_) => None,
            Target::Leaf(door) => Some(still + 1 + door),
            Target::Person(person) => Some(still + self.doors + 1 + person),
        }
    }

    /// Returns the label of a robot: first those of the trial by their index, then those of the app in the order of the
    /// indices of their entities.
    pub fn of_robot(&self, robot: usize) -> u32 {
        self.pieces.len() as u32 + self.doors + self.people + 1 + robot as u32
    }

    /// Returns the meaning of a label, or `None` for 0, which means no surface.
    pub fn get(&self, label: u32) -> Option<Label> {
        let index = label.checked_sub(1)?;
        if let Some(label) = self.pieces.get(index as usize) {
            return Some(label.clone());
        }
        let index = index - self.pieces.len() as u32;
        let named = |kind: &str, index: u32| {
            Some(Label { kind: kind.to_owned(), name: format!("{kind}_{index}") })
        };
        match index {
            _ if index < self.doors => named("leaf", index),
            _ if index < self.doors + self.people => named("person", index - self.doors),
            _ => named("robot", index - self.doors - self.people),
        }
    }
}
