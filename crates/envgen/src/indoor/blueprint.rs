//! The blueprint of an indoor map: the plan of hallways, open areas, rooms and the openings between them.

use glam::DVec2;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::grid::{Axis, Gate, Grid, Opening, Origin, Side};
use super::placed_room::PlacedRoom;
use super::plan_edit::Edit;
use super::room_placement::{DESIGN_UNIT, RoomPlacement};
use super::spec::IndoorSpec;
use crate::dials::Prediction;
use crate::seed::Seed;
use crate::world::Contents;

/// A floor plan on a grid, with the spec and seed from which it was drawn.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
///
/// let plan = IndoorSpec { difficulty: 3.0, ..Default::default() }.generate(Seed(3))?;
/// assert_eq!((plan.seed(), plan.is_edited()), (Some(Seed(3)), false));
/// let world = plan.to_world();
/// assert_eq!(world.rooms.len(), plan.rooms().len());
/// assert_eq!(world.doorways.len(), plan.openings().len());
/// # Ok::<(), envgen::indoor::IndoorError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FloorPlan {
    pub(super) spec: Box<IndoorSpec>,
    pub(super) seed: Option<Seed>,
    pub(super) grid: Grid,
    pub(super) rooms: Vec<PlacedRoom>,
    /// Sorted by position, without duplicates.
    pub(super) openings: Vec<Opening>,
    pub(super) draws: Option<Draws>,
    pub(super) edited: bool,
    /// The manual changes since it was generated, in order; also empty if it differs in another manner.
    pub(super) edits: Vec<Edit>,
    /// The choice that the profile `calibrated` made.
    pub(super) choice: Option<Box<Choice>>,
}

/// The request of the profile `calibrated` and its result.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Choice {
    /// The spec with the request.
    pub(super) spec: IndoorSpec,
    /// The seed of that spec.
    pub(super) seed: Seed,
    /// The difficulty that is predicted for the plan's world.
    pub(super) prediction: Prediction,
}

/// The random draws of a generated plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Draws {
    /// Distance between vertical and between horizontal hallways before the clamp, in cells; the value of the
    /// setting if it is set.
    pub spacing_raw: [f64; 2],
    /// Distance between vertical and between horizontal hallways, in cells.
    pub spacing: [u32; 2],
    /// Whether hallway cycles were prevented.
    pub cycles_prevented: bool,
    /// How often each allowed room was the first drawn for a cell.
    pub first_choice: Vec<(String, u64)>,
    /// Number of drawn doorways that stayed closed because nothing is behind them.
    pub doorways_closed: u64,
    /// The narrowest passage through each room before and after its contents were moved, in metres; empty if they
    /// were not moved.
    pub variations: Vec<[f64; 2]>,
}

impl FloorPlan {
    /// Returns the grid of cells.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Returns the rooms, in the order in which they were placed.
    pub fn rooms(&self) -> &[PlacedRoom] {
        &self.rooms
    }

    /// Returns the openings in walls, sorted by position.
    pub fn openings(&self) -> &[Opening] {
        &self.openings
    }

    /// Returns the difficulty that trials are predicted to measure in the plan's world; `None` for profiles other
    /// than `calibrated`, and for a plan that was changed.
    pub fn prediction(&self) -> Option<&Prediction> {
        self.choice.as_ref().filter(|_| !self.edited).map(|choice| &choice.prediction)
    }

    /// Returns the spec. In the profile `calibrated` it has the settings that were drawn.
    pub fn spec(&self) -> &IndoorSpec {
        &self.spec
    }

    /// Returns the seed with which the plan was drawn, in the profile `calibrated` that of its own draw; `None` if
    /// it was made without a seed.
    pub fn seed(&self) -> Option<Seed> {
        self.seed
    }

    /// Returns the random draws; `None` if the plan was not generated.
    pub fn draws(&self) -> Option<&Draws> {
        self.draws.as_ref()
    }

    /// Returns whether the plan was changed after it was generated, or drawn from other distributions than the spec's.
    pub fn is_edited(&self) -> bool {
        self.edited
    }

    /// Returns the centre of a cell in metres: x right and y up from the lower left corner of the grid.
    pub(super) fn cell_middle(&self, x: u32, y: u32) -> DVec2 {
        self.point(f64::from(x) + 0.5, f64::from(y) + 0.5)
    }

    /// Returns the middle of an opening in metres.
    pub(super) fn gate_middle(&self, gate: Gate) -> DVec2 {
        let (x, y) = gate.middle();
        self.point(x, y)
    }

    /// Returns a point `x` cells from the left and `y` cells from the top, in metres.
    pub(super) fn point(&self, x: f64, y: f64) -> DVec2 {
        DVec2::new(x, f64::from(self.grid.height()) - y) * self.spec.cell_size
    }

    /// Returns the transform from a room's design to the map.
    pub(super) fn design_placement(&self, room: usize) -> RoomPlacement {
        let room = &self.rooms[room];
        let corner = self.point(f64::from(room.x), f64::from(room.y + room.size().1));
        let scale = self.spec.cell_size / DESIGN_UNIT;
        RoomPlacement { corner, scale, quarters: room.quarters, size: room.room.size() }
    }

    /// Returns the transform from a room's own frame, unturned and in metres of the map, to the map.
    pub(super) fn metric_placement(&self, room: usize) -> RoomPlacement {
        let frame = self.design_placement(room);
        RoomPlacement { scale: 1.0, size: frame.size * frame.scale, ..frame }
    }
}

#[derive(Serialize)]
struct RoomJson<'a> {
    name: &'a str,
    x: u32,
    y: u32,
    width: u32,
    height: u32,
    turned: bool,
    quarter_turns: u8,
    difficulty: f64,
    doorways: Vec<Side>,
    contents: Contents,
}

#[derive(Serialize)]
struct OpeningJson {
    /// Middle of the opening in cells from the top left corner, y down.
    x: f64,
    y: f64,
    wall: Axis,
    origin: Origin,
}

impl Serialize for FloorPlan {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let width = self.grid.width() as usize;
        let cells: Vec<String> = self
            .grid
            .cells()
            .chunks(width)
            .map(|row| row.iter().map(|cell| cell.symbol()).collect())
            .collect();
        let rooms: Vec<_> = self
            .rooms
            .iter()
            .map(|room| RoomJson {
                name: &room.room.name,
                x: room.x,
                y: room.y,
                width: room.size().0,
                height: room.size().1,
                turned: room.quarters % 4 != 0,
                quarter_turns: room.quarters % 4,
                difficulty: room.room.difficulty,
                doorways: room.doorways.iter().collect(),
                contents: room.contents,
            })
            .collect();
        let openings: Vec<_> = self
            .openings
            .iter()
            .map(|opening| {
                let (x, y) = opening.gate.middle();
                OpeningJson { x, y, wall: opening.gate.wall, origin: opening.origin }
            })
            .collect();
        let mut plan = serializer.serialize_struct("FloorPlan", 8)?;
        plan.serialize_field("width", &self.grid.width())?;
        plan.serialize_field("height", &self.grid.height())?;
        plan.serialize_field("unit", &self.spec.cell_size)?;
        plan.serialize_field("spacing", &self.draws.as_ref().map(|draws| draws.spacing))?;
        let prevented = self.draws.as_ref().map(|draws| draws.cycles_prevented);
        plan.serialize_field("cycles_prevented", &prevented)?;
        plan.serialize_field("cells", &cells)?;
        plan.serialize_field("rooms", &rooms)?;
        plan.serialize_field("openings", &openings)?;
        plan.end()
    }
}
