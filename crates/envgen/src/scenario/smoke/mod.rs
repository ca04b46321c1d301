//! Smoke: where it is, how it spreads, and what a laser reads in it.

mod beam;
mod chord;
mod field;
mod range;
mod source;

pub use beam::{Laser, Reading};
pub use chord::Stretch;
pub(super) use field::{SmokeField, SmokeRegions};
pub use range::{lambert_w, smoke_range};
pub use source::{SmokePlace, SmokeRegion, SmokeSource};

use super::ScenarioSpec;
use crate::error::SpecError;
use crate::occupancy::{Coverage, OccupancyGrid};
use crate::seed::Seed;
use crate::world::World;

/// Draws the sources of smoke of a world: in rooms if there are any, otherwise around free points.
pub(super) fn place_smoke(
    world: &World,
    spec: &ScenarioSpec,
    seed: Seed,
) -> Result<Vec<SmokeSource>, SpecError> {
    if spec.smoke == 0.0 {
        return Ok(Vec::new());
    }
    let source = |region| SmokeSource {
        region,
        extinction: spec.smoke,
        growth: spec.smoke_growth,
        kind: spec.smoke_kind,
    };
    let count = spec.smoke_sources;
    let mut stream = seed.stream("scenario/smoke", 0);
    if !world.rooms.is_empty() {
        let rooms = world.rooms.len();
        if count as usize > rooms {
            let setting = ScenarioSpec::setting("smoke_sources");
            let why =
                format!("a whole number from 1 to {rooms}: each source has a room of its own");
            return Err(setting.error_with(count, why));
        }
        let mut order: Vec<u32> = (0..rooms as u32).collect();
        stream.shuffle(&mut order);
        let sources = order.into_iter().take(count as usize);
        return Ok(sources.map(|room| source(SmokeRegion::Room(room))).collect());
    }
    let size = world.bounds.size();
    let cell = 0.25_f64.max((size.x * size.y / 1e6).sqrt()).max(size.max_element() / 1e4);
    let grid = OccupancyGrid::of(world, cell, Coverage::Conservative).map_err(|error| {
        ScenarioSpec::setting("smoke").error_with(spec.smoke, format!("0: {error}"))
    })?;
    let free: Vec<usize> = (0..grid.cells().len()).filter(|&cell| !grid.cells()[cell]).collect();
    if free.is_empty() {
        let why = "0: the world has no free space for smoke";
        return Err(ScenarioSpec::setting("smoke").error_with(spec.smoke, why));
    }
    let discs = (0..count).map(|_| {
        let cell = free[stream.below(free.len() as u64) as usize];
        let center = grid.frame().center_of(cell);
        source(SmokeRegion::Disc { center, radius: spec.smoke_radius })
    });
    Ok(discs.collect())
}
