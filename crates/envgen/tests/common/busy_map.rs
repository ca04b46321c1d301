//! Random maps with random people and doors.

use envgen::indoor::IndoorSpec;
use envgen::scenario::{DoorControl, DoorKinds, Scenario, ScenarioSpec};
use envgen::{Blueprint, Seed, Spec, World};

/// One person on 18 square metres: more hardly fit.
pub(crate) const MOST_PEOPLE: f64 = 18.0;

/// A cell of an indoor map in square metres.
const CELL: f64 = 9.0;

/// A map of a random size with random doors, and one person or up to one on `area` square metres.
pub(crate) fn busy_map(
    seed: Seed,
    area: f64,
) -> Result<(World, Scenario), Box<dyn std::error::Error>> {
    let mut stream = seed.stream("scenario_sweep", 0);
    let side = 5 + stream.below(12) as u32;
    let world =
        IndoorSpec { width: side, height: side, ..Default::default() }.generate(seed)?.to_world();
    let kinds = [DoorKinds::Mixed, DoorKinds::Hinged, DoorKinds::Double, DoorKinds::Sliding];
    let spec = ScenarioSpec {
        doors: stream.between(0.0, 1.0),
        door_kind: kinds[stream.below(4) as usize],
        door_control: if stream.chance(0.3) { DoorControl::Triggered } else { DoorControl::Timed },
        slam: stream.between(0.0, 1.0),
        people: 1 + (stream.below(u64::from(side * side)) as f64 * CELL / area) as u32,
        working: 10.0,
        waiting: 5.0,
        ..Default::default()
    };
    let scenario = Scenario::new(&world, &spec, seed)?;
    Ok((world, scenario))
}
