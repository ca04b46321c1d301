//! Smoke: where it is, how it spreads, and what a laser reads in it.

mod beam;
mod chord;
mod field;
mod range;

pub use beam::{Laser, Reading};
pub use chord::Stretch;
pub(super) use field::{SmokeField, SmokeRegions};
pub use range::{lambert_w, smoke_range};

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::ScenarioSpec;
use super::spec::SmokeKind;
use crate::error::SpecError;
use crate::occupancy::{Coverage, OccupancyGrid};
use crate::seed::Seed;
use crate::world::World;

/// A source of smoke.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SmokeSource {
    /// The space that it fills.
    pub region: SmokeRegion,
    /// The extinction coefficient that it comes to, in 1/m.
    pub extinction: f64,
    /// The time in seconds in which it comes to 63 % of that, 0 where it is there from the start.
    pub growth: f64,
    /// What kind of smoke it is.
    pub kind: SmokeKind,
}

/// The space that a source of smoke fills.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SmokeRegion {
    /// The room of this index, out of which it leaks through open doorways.
    Room(u32),
    /// A disc of unchanging size.
    Disc {
        /// Middle in metres.
        center: DVec2,
        /// Radius in metres.
        radius: f64,
    },
}

/// A place with smoke of one density: a source's own, or one to which smoke leaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SmokePlace {
    /// The room of this index.
    Room(u32),
    /// All hallways and open areas.
    Halls,
    /// The disc of the source of this index in the scenario.
    Source(u32),
}

/// Draws the sources of a world: in rooms where it has some, otherwise around free points.
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

impl SmokeSource {
    /// Checks it against its world.
    ///
    /// # Errors
    /// Names the first field that is not allowed, its value and its limits.
    pub(super) fn check(&self, world: &World) -> Result<(), SpecError> {
        let limited = |name: &str, setting: &str, value: f64| {
            ScenarioSpec::SETTINGS
                .iter()
                .find(|known| known.name == setting)
                .map_or(Ok(()), |known| known.check(value))
                .map_err(|error| SpecError { field: name.to_owned(), ..error })
        };
        limited("extinction", "smoke", self.extinction)?;
        limited("growth", "smoke_growth", self.growth)?;
        match self.region {
            SmokeRegion::Room(room) if room as usize >= world.rooms.len() => {
                let allowed = match world.rooms.len() {
                    0 => "absent: the world has no room".to_owned(),
                    n => format!("the index of a room of the world, at most {}", n - 1),
                };
                Err(SpecError::new("region", room, allowed))
            }
            SmokeRegion::Room(_) => Ok(()),
            SmokeRegion::Disc { center, radius } => {
                if !center.is_finite() {
                    return Err(SpecError::new("center", center, "a finite point"));
                }
                limited("radius", "smoke_radius", radius)
            }
        }
    }
}
