//! The difficulty vector: features of a world that determine how difficult it is to map, for a robot and its laser.
//!
//! All features follow from the [`World`] alone, without simulation, and are the same to the last bit on every
//! platform. Each is documented at its field, with unit and source. [`DifficultyVector::features`] lists them all,
//! and [`DifficultyVector::values`] returns their values in the same order.
//!
//! ```
//! use envgen::difficulty::{DifficultyVector, Platform};
//! use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
//!
//! let spec = IndoorSpec { width: 6, height: 6, ..Default::default() };
//! let world = spec.generate(Seed(7))?.to_world();
//! let vector = DifficultyVector::of(&world, &Platform::default())?;
//! assert!(vector.tour.tour_length_95_m.expect("the tour ends") > 10.0);
//! assert!((0.0..=1.0).contains(&vector.localization.scan_degeneracy));
//! for (feature, value) in DifficultyVector::features().iter().zip(vector.values()) {
//!     assert!(value.is_none_or(f64::is_finite), "{}", feature.name);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Method
//!
//! A grid of [`CELL`] covers the world's bounds. Worlds with more than [`MAX_CELLS`] such cells get larger cells;
//! worlds that would need cells over [`MAX_CELL`] have no vector.
//!
//! A cell is free if the robot's centre has a clearance of its circumscribed radius and 5 mm there, on ground on
//! which it can drive. The free cells that it reaches from the world's start are the ground of the vector; without
//! a start, those of the largest connected region. Distances to solids and rays are exact. [`POSES`] poses are
//! spread over that ground. The tour ends after [`MAX_SCANS`] scans, or when its searches have visited
//! [`MAX_VISITS`] cells; features that it has not reached by then are `None`.

mod barn;
mod clearance;
mod drift;
mod error;
mod feature;
mod information;
mod leg;
mod limits;
mod localization;
mod places;
mod platform;
mod poses;
mod search;
mod space;
mod statistics;
mod tour;
mod visibility;
mod walls;

#[cfg(feature = "parallel")]
use rayon::join;
use serde::Serialize;

pub use barn::{Barn, BarnMetrics, BarnMode};
pub use clearance::Clearance;
pub use drift::Drift;
pub use error::DifficultyError;
pub use feature::Feature;
pub use information::{Echoes, ScanInformation};
pub use limits::{MAX_CELL, MAX_CELLS, MAX_READS};
pub use localization::Localization;
pub use places::Places;
pub use platform::Platform;
pub use poses::POSES;
pub use search::MAX_VISITS;
pub use space::CELL;
pub use tour::{MAX_SCANS, TourFeatures};
pub use visibility::Visibility;
pub use walls::Walls;

use crate::distance::squared_distances;
use crate::geometry::Pose;
use crate::occupancy::{Coverage, OccupancyGrid};
use crate::raycast::Raycaster;
use crate::world::World;
use feature::features;
use leg::Floor;
use poses::{Laser, View, poses};
use search::Search;
use space::Space;
use tour::Tour;

features! {
    /// The ground to which the other features refer.
    pub struct Ground {
        /// Area of the ground that the robot's body can cover, F.
        ground_area_m2: f64, "m^2";
        /// Side of the cells of the grid on which reachable ground, tour and places are computed.
        grid_cell_m: f64, "m";
    }
}

/// The difficulty vector of a world. It serialises to one flat object, with `null` for features that do not exist.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DifficultyVector {
    /// The ground that the robot reaches.
    #[serde(flatten)]
    pub ground: Ground,
    /// How well scans determine the position.
    #[serde(flatten)]
    pub localization: Localization,
    /// How much of the world the robot sees.
    #[serde(flatten)]
    pub visibility: Visibility,
    /// The tour of a robot without errors.
    #[serde(flatten)]
    pub tour: TourFeatures,
    /// Drift along the tour.
    #[serde(flatten)]
    pub drift: Drift,
    /// The clearance of the robot.
    #[serde(flatten)]
    pub clearance: Clearance,
    /// The walls.
    #[serde(flatten)]
    pub walls: Walls,
    /// The graph of places.
    #[serde(flatten)]
    pub places: Places,
    /// BARN's metrics.
    #[serde(flatten)]
    pub barn: Barn,
}

impl DifficultyVector {
    /// Computes the difficulty vector of a world for a robot and its laser.
    ///
    /// # Errors
    /// When a number of the platform is not allowed; when the world is invalid or too large, or its solids are too
    /// dense; and when the robot does not fit at the world's start, or anywhere in a world without a start.
    pub fn of(world: &World, platform: &Platform) -> Result<Self, DifficultyError> {
        platform.validate()?;
        world.check()?;
        let space = Space::new(world, platform.footprint())?;
        let rays = Raycaster::new(world);
        let laser = Laser::new(&rays, platform)?;
        let ground_area = ground_area(world, &space)?;
        let by_clearance = space.by_clearance();
        let heading = world.start.map_or(0.0, |start| start.heading);
        let start = Pose { position: space.points[space.start], heading };
        // With the feature `parallel` on two threads: the tour takes longer than all that does not need it.
        let (of_tour, of_ground) = join(
            || {
                let tour = Tour::new(&space, &laser, &Floor::new(world), platform, start);
                (
                    tour.features(),
                    Drift::of(&tour.stops, platform),
                    Clearance::of(&space, &by_clearance, &tour),
                    barn(world, &space, &tour),
                )
            },
            || {
                let poses = poses(&space).into_iter();
                let views: Vec<View> = poses.map(|pose| View::new(&laser, pose)).collect();
                (
                    Localization::of(&views, platform.sigma),
                    Visibility::of(&views, platform, ground_area),
                    Walls::of(world, &space, &rays, ground_area, platform.max_range),
                    Places::of(&space, &by_clearance),
                )
            },
        );
        let (tour, drift, clearance, barn) = of_tour;
        let (localization, visibility, walls, places) = of_ground;
        let ground = Ground { ground_area_m2: ground_area, grid_cell_m: space.frame.cell_size };
        space.check_reads()?;
        Ok(DifficultyVector {
            ground,
            localization,
            visibility,
            tour,
            drift,
            clearance,
            walls,
            places,
            barn,
        })
    }

    /// Returns every feature, in order.
    pub fn features() -> Vec<Feature> {
        let groups = [
            Ground::FEATURES,
            Localization::FEATURES,
            Visibility::FEATURES,
            TourFeatures::FEATURES,
            Drift::FEATURES,
            Clearance::FEATURES,
            Walls::FEATURES,
            Places::FEATURES,
            Barn::FEATURES,
        ];
        groups.concat()
    }

    /// Returns the values in the order of [`DifficultyVector::features`]; `None` where a feature does not exist.
    pub fn values(&self) -> Vec<Option<f64>> {
        let groups = [
            self.ground.values(),
            self.localization.values(),
            self.visibility.values(),
            self.tour.values(),
            self.drift.values(),
            self.clearance.values(),
            self.walls.values(),
            self.places.values(),
            self.barn.values(),
        ];
        groups.concat()
    }

    /// Returns the value of a feature; `None` if it does not exist in this world, and for an unknown name.
    ///
    /// ```
    /// use envgen::difficulty::{DifficultyVector, Platform};
    /// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
    ///
    /// let spec = IndoorSpec { width: 6, height: 6, ..Default::default() };
    /// let world = spec.generate(Seed(7))?.to_world();
    /// let vector = DifficultyVector::of(&world, &Platform::default())?;
    /// assert_eq!(vector.get("reachable_area_m2"), Some(vector.clearance.reachable_area_m2));
    /// assert_eq!(vector.get("no such feature"), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn get(&self, name: &str) -> Option<f64> {
        let place = Self::features().iter().position(|feature| feature.name == name)?;
        self.values()[place]
    }
}

#[cfg(not(feature = "parallel"))]
fn join<A, B>(a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    (a(), b())
}

/// Returns the area in square metres of the cells that a robot's body can cover and that no solid covers.
fn ground_area(world: &World, space: &Space<'_>) -> Result<f64, DifficultyError> {
    let side = space.frame.cell_size;
    let solid = OccupancyGrid::of(world, side, Coverage::Centre)?;
    let within = (space.footprint / side) * (space.footprint / side);
    let near = squared_distances(space.frame.cols, &space.reached);
    let is_covered = |cell: &usize| {
        space.reached[*cell] || (!solid.cells()[*cell] && f64::from(near[*cell]) <= within)
    };
    Ok((0..space.frame.len()).filter(is_covered).count() as f64 * space.cell_area())
}

fn barn(world: &World, space: &Space<'_>, tour: &Tour) -> Barn {
    let mut cells: Vec<usize> =
        tour.points.iter().filter_map(|(p, _)| space.frame.index_at(*p)).collect();
    cells.retain(|&cell| space.is_free(cell));
    cells.dedup();
    let goal = world.goal.and_then(|goal| space.cell_to(goal.position));
    let to_goal = goal.and_then(|goal| {
        Search::new(space.frame.len()).nearest(space, space.start, |cell| cell == goal)
    });
    let blocked: Vec<bool> = (0..space.frame.len()).map(|cell| !space.is_free(cell)).collect();
    Barn::of(space.frame.cols, &blocked, space.frame.cell_size, &cells, to_goal.as_deref())
}

#[cfg(test)]
mod tests;
