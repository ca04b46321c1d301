//! Doors, and the kinds of their motion.

use serde::{Deserialize, Serialize};

use crate::error::SpecError;
use crate::scenario::spec::{DoorControl, ScenarioSpec};
use crate::world::World;

/// A door of a scenario, in an open doorway of its world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Door {
    /// The index of the door's doorway in [`World::doorways`].
    pub doorway: u32,
    /// The kind of motion.
    pub kind: DoorKind,
    /// Whether the hinge, or the wall into which the leaf slides, is at the far end of the doorway, along the
    /// doorway's longer axis.
    #[serde(default)]
    pub far_end: bool,
    /// Whether it swings to the right of the doorway's longer axis instead of to its left.
    #[serde(default)]
    pub to_right: bool,
    /// What opens and closes it.
    #[serde(default = "usual_control")]
    pub control: DoorControl,
    /// Mean time in seconds for which the door stays open, if it is timed.
    #[serde(default = "usual_open")]
    pub open: f64,
    /// Mean time in seconds for which the door stays closed, if it is timed.
    #[serde(default = "usual_closed")]
    pub closed: f64,
    /// Probability that the door slams when it closes.
    #[serde(default = "usual_slam")]
    pub slam: f64,
}

fn usual_control() -> DoorControl {
    DoorControl::Timed
}

fn usual_open() -> f64 {
    ScenarioSpec::default().door_open
}

fn usual_closed() -> f64 {
    ScenarioSpec::default().door_closed
}

fn usual_slam() -> f64 {
    ScenarioSpec::default().slam
}

/// The kinds of motion of a door.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DoorKind {
    /// One leaf that turns by 90 degrees about an end of the doorway.
    Hinged,
    /// Two leaves, each half as wide, that turn about both ends of the doorway.
    Double,
    /// One leaf that slides into the wall.
    Sliding,
}

impl DoorKind {
    /// Returns the number of leaves.
    pub fn leaves(self) -> usize {
        match self {
            DoorKind::Double => 2,
            DoorKind::Hinged | DoorKind::Sliding => 1,
        }
    }
}

impl Door {
    /// Checks the door against its world.
    ///
    /// # Errors
    /// When the doorway does not exist or is closed, and when times or probabilities are out of range.
    pub(in crate::scenario) fn check(&self, world: &World) -> Result<(), SpecError> {
        match world.doorways.get(self.doorway as usize) {
            None => {
                let allowed = match world.doorways.len() {
                    0 => "absent: the world has no doorway".to_owned(),
                    n => format!("the index of a doorway of the world, at most {}", n - 1),
                };
                return Err(SpecError::new("doorway", self.doorway, allowed));
            }
            Some(doorway) if !doorway.open => {
                let allowed = "the index of an open doorway: this one is closed for ever";
                return Err(SpecError::new("doorway", self.doorway, allowed));
            }
            Some(_) => {}
        }
        for (name, value) in [("open", self.open), ("closed", self.closed)] {
            ScenarioSpec::setting("door_open")
                .check(value)
                .map_err(|error| SpecError { field: name.to_owned(), ..error })?;
        }
        ScenarioSpec::setting("slam").check(self.slam)
    }
}
