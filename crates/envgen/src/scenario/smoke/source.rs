//! Sources of smoke, and the space that they fill.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::SpecError;
use crate::geometry::{Rect, Shape};
use crate::scenario::spec::{ScenarioSpec, SmokeKind};
use crate::world::World;

/// The least and the greatest allowed side of a box in metres, which are those of a disc's diameter.
const BOX_SIDES: [f64; 2] = [0.1, 2000.0];

/// A source of smoke.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SmokeSource {
    /// The space that the smoke fills.
    pub region: SmokeRegion,
    /// The final extinction coefficient of the smoke, in 1/m. Rooms and halls from which smoke leaks may stay below it;
    /// in one with several sources, theirs add up.
    /// In the profile `usarsim`, it is the density of `USARSim`.
    pub extinction: f64,
    /// The time in seconds in which the smoke reaches 63 % of that; where it leaks, it takes longer. 0 if it is there
    /// from the start.
    #[serde(default)]
    pub growth: f64,
    /// The kind of smoke.
    #[serde(default = "usual_kind")]
    pub kind: SmokeKind,
}

fn usual_kind() -> SmokeKind {
    SmokeKind::Regional
}

/// The space that the smoke of a source fills.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SmokeRegion {
    /// The room with this index, from which regional smoke leaks through open doorways.
    Room(u32),
    /// All hallways and open areas, which share one density. Regional smoke leaks from them into rooms through open
    /// doorways.
    Halls,
    /// A disc of constant size.
    Disc {
        /// Centre in metres.
        center: DVec2,
        /// Radius in metres.
        radius: f64,
    },
    /// An axis-aligned rectangle of constant size, such as a part of a hallway.
    Box {
        /// The corner with the least x and y, in metres.
        min: DVec2,
        /// The corner with the greatest x and y, in metres.
        max: DVec2,
    },
}

impl SmokeRegion {
    /// Returns the shape of the region if it does not depend on the world: that of a disc or a box.
    pub(crate) fn shape(self) -> Option<Shape> {
        match self {
            SmokeRegion::Room(_) | SmokeRegion::Halls => None,
            SmokeRegion::Disc { center, radius } => Some(Shape::Disc { center, radius }),
            SmokeRegion::Box { min, max } => Some(Shape::from_rect(Rect::new(min, max))),
        }
    }

    /// Returns the place that the region fills, as the region of the source with this index.
    pub(crate) fn place(self, source: u32) -> SmokePlace {
        match self {
            SmokeRegion::Room(room) => SmokePlace::Room(room),
            SmokeRegion::Halls => SmokePlace::Halls,
            SmokeRegion::Disc { .. } | SmokeRegion::Box { .. } => SmokePlace::Source(source),
        }
    }

    /// Whether a point is in the region's own shape.
    pub(super) fn contains(self, p: DVec2) -> bool {
        match self {
            SmokeRegion::Room(_) | SmokeRegion::Halls => false,
            SmokeRegion::Disc { center, radius } => p.distance_squared(center) <= radius * radius,
            SmokeRegion::Box { min, max } => Rect::new(min, max).contains(p),
        }
    }
}

/// A place with smoke of one density: the region of a source, or a place to which smoke leaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SmokePlace {
    /// The room with this index.
    Room(u32),
    /// All hallways and open areas.
    Halls,
    /// The disc or box of the source with this index in the scenario.
    Source(u32),
}

impl SmokeSource {
    /// Whether the smoke leaks through doorways. Particles do not, as in `USARSim`, where a fixed emitter makes them.
    pub(super) fn leaks(&self) -> bool {
        self.region.shape().is_none() && self.kind == SmokeKind::Regional
    }

    /// Checks the source against its world.
    ///
    /// # Errors
    /// Names the first field that is not allowed, its value and its limits.
    pub(in crate::scenario) fn check(&self, world: &World) -> Result<(), SpecError> {
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
            SmokeRegion::Halls if !world.surfaces.iter().any(|surface| surface.kind.is_hall()) => {
                let allowed = "a room, a disc or a box: the world has no hallways or open areas, which indoor maps \
                               have";
                Err(SpecError::new("region", "halls", allowed))
            }
            SmokeRegion::Room(_) | SmokeRegion::Halls => Ok(()),
            SmokeRegion::Disc { center, radius } => {
                if !center.is_finite() {
                    return Err(SpecError::new("region.center", center, "a finite point"));
                }
                limited("region.radius", "smoke_radius", radius)
            }
            SmokeRegion::Box { min, max } => {
                if !min.is_finite() {
                    return Err(SpecError::new("region.min", min, "a finite point"));
                }
                let [least, most] = BOX_SIDES;
                let is_side = |side: f64| (least..=most).contains(&side);
                if is_side(max.x - min.x) && is_side(max.y - min.y) {
                    return Ok(());
                }
                let allowed =
                    format!("a point {least} to {most} m to the right of `min` and above it");
                Err(SpecError::new("region.max", max, allowed))
            }
        }
    }
}
