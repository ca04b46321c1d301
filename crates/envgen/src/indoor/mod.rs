//! Indoor maps that adapt to a difficulty: hallways, rooms and doorways on a grid.
//!
//! Source: O. Zwennes, Adaptive Indoor Map Generator for USARSim, bachelor thesis, University of
//! Amsterdam, 2011.
//!
//! - [`adaptation`]: the equations of the five adaptive rules.
//! - [`Catalogue`] and [`RoomDesign`]: the rooms that a map may hold; the paper's 20 are built in.
//! - [`IndoorSpec`] and [`FloorPlan`]: the settings, and the plan on the grid that the rules draw.
//! - [`AccessGraph`]: which places are connected; [`Interior`]: the same inside one room.
//! - [`PlanEditor`]: changes by hand, with undo and redo.
//! - [`world_generator`]: the files of the tool that the paper extended.
//! - [`vary`]: moves the contents of a room until its narrowest passage has a wanted width.

pub mod adaptation;

mod access;
mod build;
mod catalogue;
mod edit;
mod generate;
mod grid;
mod interior;
mod metrics;
mod plan;
mod rules;
mod spec;
mod variation;
pub mod world_generator;

#[cfg(test)]
mod tests;

pub use access::{AccessGraph, Link, Place, PlaceKind};
pub use catalogue::{
    Catalogue, CatalogueError, DESIGN_UNIT, FolderError, MAX_ROOM_PARTS, MAX_ROOM_SIZE, MAX_ROOMS,
    RoomDesign, RoomError, SharedRoom, room_from_ron, room_to_ron,
};
pub use edit::{Edit, EditError, PlanEditor};
pub use generate::Stage;
pub use grid::{Axis, Cell, Gate, Grid, Opening, Origin, Side, Sides};
pub use interior::{DOORWAY_DEPTH, Dimensions, Interior, Part, Port, STEP, narrowest_way};
pub use metrics::{CellCounts, IndoorMetrics};
pub use plan::{Draws, FloorPlan, PlacedRoom};
pub use spec::{Cycles, IndoorSpec, Layout, Profile, RoomChoice, Turn};
pub use variation::{Varied, vary};
