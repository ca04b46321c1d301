//! Indoor maps that adapt to a difficulty: hallways, rooms and doorways on a grid.
//!
//! Source: O. Zwennes, Adaptive Indoor Map Generator for USARSim, bachelor thesis, University of
//! Amsterdam, 2011.
//!
//! - [`adaptation`]: the equations of the five adaptive rules.
//! - [`Catalogue`] and [`RoomDesign`]: the rooms that a map may contain. The paper's 20 rooms are built in.
//! - [`IndoorSpec`] and [`FloorPlan`]: the settings, and the plan that the rules draw on the grid.
//! - [`AccessGraph`]: which places of a plan are connected. [`Interior`]: the same inside one room.
//! - [`PlanEditor`]: manual changes, with undo and redo.
//! - `world_generator`: the files of the tool that the paper extended.

pub mod adaptation;

mod access;
mod blueprint;
mod calibrated;
mod catalogue;
mod clutter;
mod custom_laws;
mod dimensions;
mod doubt;
mod edit;
mod error;
mod generate;
mod grid;
mod interior;
mod lever_terms;
mod levers;
mod materials;
mod maze;
mod metrics;
mod placed_room;
mod plan_edit;
mod request;
mod room_placement;
mod rules;
mod spec;
mod stages;
mod variation;
mod world;
#[cfg(feature = "usarsim")]
pub mod world_generator;

#[cfg(test)]
mod tests;

pub use access::{AccessGraph, Link, Place, PlaceKind};
pub use blueprint::{Draws, FloorPlan};
pub use catalogue::{
    Catalogue, CatalogueError, FolderError, MAX_ROOM_PARTS, MAX_ROOM_SIZE, MAX_ROOMS, RoomDesign,
    RoomError, SharedRoom, room_from_ron, room_to_ron,
};
#[cfg(feature = "rand")]
pub use custom_laws::IndoorLaws;
pub use dimensions::{Dimensions, STEP};
pub use doubt::CalibrationDoubt;
pub use edit::{Edit, EditError, PlanEditor, PlanTarget};
pub use error::IndoorError;
pub use grid::{Axis, Cell, Gate, Grid, Opening, Origin, Side, Sides};
pub use interior::{DOORWAY_DEPTH, Interior, Part, Port, narrowest_passage};
pub use metrics::{CellCounts, IndoorMetrics};
pub use placed_room::PlacedRoom;
pub use request::Request;
pub use room_placement::DESIGN_UNIT;
pub use spec::{Cycles, IndoorSpec, Layout, Profile, RoomChoice, Turn};
pub use stages::Stage;

use crate::error::SpecError;
use crate::generate::{Blueprint, Spec};
use crate::seed::Seed;
use crate::settings::Setting;
use crate::world::World;

impl Spec for IndoorSpec {
    type Blueprint = FloorPlan;
    type Error = IndoorError;

    const KIND: &'static str = "indoor";

    const VALUE_VERSION: u32 = 2;

    const SETTINGS: &'static [Setting] = IndoorSpec::SETTINGS;

    const RULES: &'static [&'static str] = spec::RULES;

    fn validate(&self) -> Result<(), SpecError> {
        self.check()
    }

    fn work(&self) -> f64 {
        // About ten parts are as much work as a cell. Moving the contents of a room measures it many times, at
        // points as dense in large cells as in small ones.
        let parts = (0.1 * (self.most_contents() + self.maze_squares())).max(1.0);
        let measured = 1000.0 * (self.cell_size / 3.0) * (self.cell_size / 3.0);
        let contents = if self.clearance.is_some() { measured.max(1.0) * parts } else { parts };
        let maps = if self.profile == Profile::Calibrated { calibrated::CANDIDATES } else { 1 };
        let crates = self.clutter / 100.0 * self.cell_size * self.cell_size;
        let a_cell = contents + crates * clutter::ATTEMPTS as f64;
        f64::from(self.width) * f64::from(self.height) * a_cell * maps as f64
    }

    fn generate(&self, seed: Seed) -> Result<FloorPlan, IndoorError> {
        self.generate_observed(seed, &mut |_| ())
    }
}

impl Blueprint for FloorPlan {
    type Metrics = IndoorMetrics;

    fn metrics(&self) -> IndoorMetrics {
        IndoorMetrics::of(self)
    }

    fn to_world(&self) -> World {
        world::world(self)
    }
}
