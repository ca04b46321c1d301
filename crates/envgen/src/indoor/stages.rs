//! Runs the rules in the order of the paper, each with its own random stream.

use super::adaptation as adapt;
use super::blueprint::{Draws, FloorPlan};
use super::custom_laws::IndoorLaws;
use super::error::IndoorError;
use super::grid::Grid;
use super::maze;
use super::rules::{access, cycles, doorways, hallways, l_system, open_areas, rooms};
use super::spec::{Cycles, IndoorSpec, Layout, Profile};
use crate::seed::Seed;

/// A stage of the generator. Stages are listed in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// The distances between hallways are drawn, and the hallways are placed or grown.
    Hallways,
    /// Hallway cycles are prevented, if the draw decides so.
    Cycles,
    /// Rooms are drawn and placed.
    Rooms,
    /// The remaining cells become open area.
    OpenAreas,
    /// Contents are moved, if a clearance is set.
    Contents,
    /// Doorways are drawn, and walls are opened.
    Doorways,
    /// Unreachable places get doorways, in the profile `guaranteed`.
    Access,
    /// Rooms get mazes, if the spec has any.
    Mazes,
}

impl Stage {
    /// Every stage, in order.
    pub const ALL: [Stage; 8] = [
        Stage::Hallways,
        Stage::Cycles,
        Stage::Rooms,
        Stage::OpenAreas,
        Stage::Contents,
        Stage::Doorways,
        Stage::Access,
        Stage::Mazes,
    ];
}

/// Generates the plan of a spec whose levers are set.
pub(super) fn plan_as_set(
    spec: &IndoorSpec,
    seed: Seed,
    laws: &IndoorLaws<'_>,
    after: &mut dyn FnMut(Stage),
) -> Result<FloorPlan, IndoorError> {
    let mut stream = seed.stream("indoor/spacing", 0);
    let mut space = |given: Option<u32>, size: u32| {
        // Drawn even where a spacing is set, so that setting one does not change the draw of the other.
        let raw = laws.hallway_spacing(spec.difficulty, size, &mut stream);
        match given {
            Some(given) => Ok((f64::from(given), given)),
            None => raw.map(|raw| (raw, adapt::spacing(raw, size))),
        }
    };
    let (raw_h, spacing_h) = space(spec.spacing_h, spec.width)?;
    let (raw_v, spacing_v) = space(spec.spacing_v, spec.height)?;

    let mut stream = seed.stream("indoor/cycles", 0);
    let drawn = stream.chance(adapt::cycle_prevention_probability(spec.difficulty));
    let cycles_prevented = match spec.cycles {
        Cycles::Difficulty => drawn,
        Cycles::Allow => false,
        Cycles::Prevent => true,
    };

    let mut grid = Grid::new(spec.width, spec.height);
    let mut removed = Vec::new();
    match spec.layout {
        Layout::Grid => {
            hallways::place(&mut grid, spacing_h, spacing_v);
            after(Stage::Hallways);
            if cycles_prevented {
                removed = cycles::prevent(&mut grid, spacing_h, spacing_v, &mut stream);
            }
        }
        Layout::LSystem => {
            let law = l_system::Law {
                spacing: [spacing_h, spacing_v],
                branching: spec.branching,
                loops: !cycles_prevented,
            };
            l_system::grow(&mut grid, &law, &mut seed.stream("indoor/l_system", 0));
            after(Stage::Hallways);
        }
    }
    after(Stage::Cycles);

    let allowed = spec.allowed_rooms();
    let probabilities = spec.room_probabilities();
    let choice =
        rooms::Choice { rooms: &allowed, probabilities: &probabilities, turn: spec.may_turn() };
    let rooms::Placed { mut rooms, first_choice } =
        rooms::place(&mut grid, &choice, &mut seed.stream("indoor/rooms", 0));
    after(Stage::Rooms);
    if spec.open_areas {
        open_areas::fill(&mut grid, &removed);
    }
    after(Stage::OpenAreas);

    let mut variations = Vec::new();
    if let Some(wanted) = spec.clearance {
        for (i, room) in rooms.iter_mut().enumerate() {
            let mut stream = seed.stream("indoor/contents", i as u64);
            let varied = laws.vary(&room.room, wanted, spec.dimensions(), &mut stream)?;
            variations.push([varied.before, varied.after]);
            room.room = varied.room;
        }
    }

    after(Stage::Contents);
    let dimensions = (spec.profile != Profile::Thesis).then(|| spec.dimensions());
    let probability =
        spec.doorway_probability.unwrap_or_else(|| adapt::doorway_probability(spec.difficulty));
    let mut stream = seed.stream("indoor/doorways", 0);
    let drawn = doorways::place(&grid, &mut rooms, probability, dimensions, &mut stream);
    after(Stage::Doorways);
    let mut openings = drawn.openings;
    if let Some(dimensions) = dimensions {
        let mut stream = seed.stream("indoor/access", 0);
        access::repair(&grid, &mut rooms, &mut openings, dimensions, &mut stream);
    }
    after(Stage::Access);
    maze::place(spec, seed, &openings, &mut rooms);
    after(Stage::Mazes);
    Ok(FloorPlan {
        spec: Box::new(spec.clone()),
        seed: Some(seed),
        grid,
        rooms,
        openings,
        draws: Some(Draws {
            spacing_raw: [raw_h, raw_v],
            spacing: [spacing_h, spacing_v],
            cycles_prevented,
            first_choice: allowed.iter().map(|room| room.name.clone()).zip(first_choice).collect(),
            doorways_closed: drawn.closed,
            variations,
        }),
        edited: laws.any(),
        edits: Vec::new(),
        choice: None,
    })
}
