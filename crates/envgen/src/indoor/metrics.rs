//! Metrics of a plan.

use std::collections::BTreeMap;

use serde::Serialize;

use super::access::hallway_shape;
use super::blueprint::FloorPlan;
use super::grid::{Cell, Origin};
use crate::world::Contents;

/// The metrics of a plan. Those of random draws are null or empty for plans that were not generated.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
///
/// let plan = IndoorSpec { width: 12, height: 10, ..Default::default() }.generate(Seed(3))?;
/// let metrics = plan.metrics();
/// let cells = &metrics.cells;
/// assert_eq!(cells.hallway + cells.open + cells.room + cells.solid, 12 * 10);
/// // Everything is connected.
/// assert_eq!((metrics.parts, metrics.rooms_closed), (1, 0));
/// # Ok::<(), envgen::indoor::IndoorError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IndoorMetrics {
    /// Distance between vertical and between horizontal hallways before the clamp, in cells.
    pub spacing_raw: Option<[f64; 2]>,
    /// How often each allowed room was the first drawn for a cell, by name.
    pub first_choice: BTreeMap<String, u64>,
    /// Mean difficulty of the first drawn rooms.
    pub first_choice_difficulty_mean: Option<f64>,
    /// Expected difficulty of a room by the rooms' probabilities.
    pub room_difficulty_expected: Option<f64>,
    /// Mean difficulty of the rooms on the plan.
    pub room_difficulty_mean: Option<f64>,
    /// Number of rooms.
    pub rooms: u64,
    /// Number of sides of all rooms. Each side had one draw for a doorway.
    pub sides: u64,
    /// Number of sides for which a doorway was drawn.
    pub doorways: u64,
    /// Number of drawn doorways that stayed closed because nothing is behind them.
    pub doorways_closed: u64,
    /// Number of openings in the walls. Two rooms may share an opening.
    pub openings: u64,
    /// Number of openings that were moved away from the middle of their side so that they are whole.
    pub openings_shifted: u64,
    /// Number of openings that were added so that a place can be reached.
    pub openings_added: u64,
    /// Number of rooms whose contents were removed so that a place can be reached.
    pub rooms_emptied: u64,
    /// Number of rooms without the contents that blocked a drawn doorway.
    pub rooms_cleared: u64,
    /// Area of each room in square metres, measured between the centre lines of the walls, in the order of the rooms.
    pub room_areas: Vec<f64>,
    /// Number of cells of each kind.
    pub cells: CellCounts,
    /// Number of hallway cells with at most one hallway neighbour.
    pub hallway_ends: u64,
    /// Number of independent cycles of the hallway cells alone.
    pub hallway_cycles: u64,
    /// Number of connected components of the hallway cells alone.
    pub hallway_parts: u64,
    /// Number of floor cells with only one link, counting hallways, open areas and doorways.
    pub dead_ends: u64,
    /// Number of rooms, and parts of divided rooms, with only one link.
    pub room_dead_ends: u64,
    /// Number of rooms without a passable doorway.
    pub rooms_closed: u64,
    /// Mean number of passable doorways per room.
    pub doors_a_room: Option<f64>,
    /// Number of independent cycles of hallways, open areas, doorways and rooms together.
    pub cycles: u64,
    /// Number of connected components of the plan.
    pub parts: u64,
    /// The narrowest passage through each room before and after its contents were moved, in metres; empty if they
    /// were not moved.
    pub variations: Vec<[f64; 2]>,
}

/// Number of cells of each kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct CellCounts {
    /// Number of hallway cells.
    pub hallway: u64,
    /// Number of cells of open areas.
    pub open: u64,
    /// Number of cells of rooms.
    pub room: u64,
    /// Number of solid cells.
    pub solid: u64,
}

impl IndoorMetrics {
    pub(super) fn of(plan: &FloorPlan) -> Self {
        let grid = plan.grid();
        let count = |condition: fn(Cell) -> bool| grid.count(condition) as u64;
        let hallways = hallway_shape(grid);
        let access = plan.access();
        let doors = access.doors_by_room();
        let dead_ends = access.dead_ends();
        let rooms = plan.rooms();
        let draws = plan.draws();
        let openings = |origin: Origin| {
            plan.openings().iter().filter(|opening| opening.origin == origin).count() as u64
        };
        let with_contents =
            |contents| rooms.iter().filter(|room| room.contents == contents).count() as u64;
        let first_choice: &[(String, u64)] =
            draws.map_or(&[], |draws| draws.first_choice.as_slice());
        let allowed = plan.spec().allowed_rooms();
        let weighted = |weights: &dyn Fn(usize) -> f64| {
            let total: f64 = (0..allowed.len()).map(weights).sum();
            let sum: f64 =
                allowed.iter().enumerate().map(|(i, room)| room.difficulty * weights(i)).sum();
            (total > 0.0).then(|| sum / total)
        };
        let probabilities = plan.spec().room_probabilities();
        IndoorMetrics {
            spacing_raw: draws.map(|draws| draws.spacing_raw),
            first_choice: first_choice.iter().cloned().collect(),
            first_choice_difficulty_mean: weighted(&|i| {
                first_choice.get(i).map_or(0.0, |&(_, count)| count as f64)
            }),
            room_difficulty_expected: draws.and_then(|_| weighted(&|i| probabilities[i])),
            room_difficulty_mean: mean(rooms.iter().map(|room| room.room.difficulty)),
            rooms: rooms.len() as u64,
            sides: 4 * rooms.len() as u64,
            doorways: rooms.iter().map(|room| u64::from(room.doorways.count())).sum(),
            doorways_closed: draws.map_or(0, |draws| draws.doorways_closed),
            openings: plan.openings().len() as u64,
            openings_shifted: openings(Origin::Shifted),
            openings_added: openings(Origin::Added),
            rooms_emptied: with_contents(Contents::Emptied),
            rooms_cleared: with_contents(Contents::Cleared),
            room_areas: rooms
                .iter()
                .map(|room| {
                    let (width, height) = room.size();
                    f64::from(width * height) * plan.spec().cell_size * plan.spec().cell_size
                })
                .collect(),
            cells: CellCounts {
                hallway: hallways.cells,
                open: count(|cell| cell == Cell::Open),
                room: count(|cell| matches!(cell, Cell::Room(_))),
                solid: count(|cell| cell == Cell::Solid),
            },
            hallway_ends: hallways.ends,
            hallway_cycles: hallways.cycles,
            hallway_parts: hallways.parts,
            dead_ends: dead_ends[0],
            room_dead_ends: dead_ends[1],
            rooms_closed: doors.iter().filter(|&&doors| doors == 0).count() as u64,
            doors_a_room: mean(doors.iter().map(|&doors| f64::from(doors))),
            cycles: access.cycles(),
            parts: access.parts(),
            variations: draws.map_or_else(Vec::new, |draws| draws.variations.clone()),
        }
    }
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> Option<f64> {
    let count = values.len();
    (count > 0).then(|| values.sum::<f64>() / count as f64)
}
