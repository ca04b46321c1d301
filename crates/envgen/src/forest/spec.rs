//! The settings of a forest, and the trees that are drawn.

use std::f64::consts::PI;

use glam::DVec2;
use serde::ser::SerializeSeq;
use serde::{Deserialize, Serialize, Serializer};
use thiserror::Error;

use super::density::{Density, DensityMap};
use super::metrics::ForestMetrics;
use super::radius::RadiusLaw;
use super::{hard_core, metrics, poisson, radius, start_goal};
use crate::distribution::Law;
use crate::error::{GenerateError, SpecError};
use crate::generate::{Blueprint, Spec};
use crate::geometry::Rect;
use crate::seed::Seed;
use crate::settings::Setting;
use crate::world::{Tree, World};

/// The most trees that a forest may be expected to hold.
pub const MAX_TREES: f64 = 2e7;

/// The most trees that a forest with a least distance may be expected to hold: generating it needs a
/// grid of up to 256 bytes per tree.
pub const MAX_HARD_CORE_TREES: f64 = 5e6;

/// A forest to generate: the rectangle from (0, 0) to (`width`, `height`).
///
/// The default has the density and radius of the paper's figure 2.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec};
///
/// let spec = ForestSpec { width: 100.0, min_distance: 3.0, ..Default::default() };
/// let forest = spec.generate(Seed(1))?;
/// assert!(forest.to_world().trees.len() > 100);
/// # Ok::<(), envgen::GenerateError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ForestSpec {
    /// Width of the area in metres.
    pub width: f64,
    /// Height of the area in metres.
    pub height: f64,
    /// Mean number of trees per square metre.
    pub intensity: f64,
    /// Radius of the trunks in metres; the median of `log_normal`, unused by `uniform`.
    pub radius: f64,
    /// The law of the radii.
    pub radius_law: RadiusLaw,
    /// Least radius of a varying law in metres.
    pub radius_min: f64,
    /// Greatest radius of a varying law in metres.
    pub radius_max: f64,
    /// Standard deviation of the logarithm of a `log_normal` radius.
    pub radius_sigma: f64,
    /// Least distance between two trees' centres in metres; 0 for none.
    pub min_distance: f64,
    /// How the border limits the trees.
    pub border: Border,
    /// Radius in metres around start and goal that no trunk reaches into; 0 clears nothing.
    pub clearing: f64,
    /// Radius in metres of the robot for which start, goal and crossings are found; 0 for a point, which
    /// is stopped only by trunks that touch.
    pub robot_radius: f64,
    /// Density over the area: factors on `intensity`.
    pub density: Option<DensityMap>,
}

impl Default for ForestSpec {
    fn default() -> Self {
        ForestSpec {
            width: 50.0,
            height: 50.0,
            intensity: 0.05,
            radius: 1.0,
            radius_law: RadiusLaw::Fixed,
            radius_min: 0.5,
            radius_max: 2.0,
            radius_sigma: 0.4,
            min_distance: 0.0,
            border: Border::Open,
            clearing: 0.0,
            robot_radius: 0.36,
            density: None,
        }
    }
}

/// How a forest's border limits the trees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Border {
    /// Centres lie inside; trunks may stick out by their radius.
    Open,
    /// Whole trunks lie inside; `intensity` applies to the area that is left for the centres.
    Inset,
    /// Opposite sides are joined: distances count across them, so that copies of the forest tile the
    /// plane.
    Torus,
}

const WIDTH: Setting = Setting::number("width", "m", 0.01, 1e6, "width of the area");
const HEIGHT: Setting = Setting::number("height", "m", 0.01, 1e6, "height of the area");
const INTENSITY: Setting =
    Setting::number("intensity", "1/m^2", 0.0, 1e6, "mean number of trees per square metre");
const RADIUS: Setting = Setting::number(
    "radius",
    "m",
    1e-4,
    1e4,
    "radius of the trunks (log_normal: median; uniform: unused)",
);
const RADIUS_LAW: Setting =
    Setting::choice("radius_law", &["fixed", "uniform", "log_normal"], "law of the radii");
const RADIUS_MIN: Setting =
    Setting::number("radius_min", "m", 1e-4, 1e4, "least radius of a varying law");
const RADIUS_MAX: Setting =
    Setting::number("radius_max", "m", 1e-4, 1e4, "greatest radius of a varying law");
const RADIUS_SIGMA: Setting = Setting::number(
    "radius_sigma",
    "",
    1e-3,
    5.0,
    "standard deviation of the logarithm of a log_normal radius",
);
const MIN_DISTANCE: Setting = Setting::number(
    "min_distance",
    "m",
    0.0,
    1e5,
    "least distance between two trees' centres (0: none)",
);
const BORDER: Setting =
    Setting::choice("border", &["open", "inset", "torus"], "how the border limits the trees");
const CLEARING: Setting =
    Setting::number("clearing", "m", 0.0, 1e5, "radius kept free of trunks around start and goal");
const ROBOT_RADIUS: Setting = Setting::number(
    "robot_radius",
    "m",
    0.0,
    1e4,
    "radius of the robot for which start, goal and crossings are found (0: a point)",
);
const DENSITY: Setting = Setting::other(
    "density",
    "",
    "none, or rows of factors of at least 0, the top row first",
    "where the forest is dense: a raster of factors on the intensity",
)
.such_as("[[0, 1], [1, 0.5]]");

/// Why a forest could not be generated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ForestError {
    /// The drawn number of trees does not fit at the least distance.
    #[error(
        "`min_distance` must be less, got {distance} m: {trees} trees were drawn and the area \
         holds at most {capacity} at this distance"
    )]
    Capacity {
        /// The number of trees drawn.
        trees: u64,
        /// The number above which random placement does not end.
        capacity: f64,
        /// The least distance in metres.
        distance: f64,
    },
    /// Random placement did not find a position for every tree.
    #[error(
        "{placed} of {trees} trees were placed at a distance of {distance} m in {attempts} \
         attempts; ask for a lower `intensity` or `min_distance`"
    )]
    Attempts {
        /// The number of trees drawn.
        trees: u64,
        /// Trees that were placed.
        placed: u64,
        /// The attempts made.
        attempts: u64,
        /// The least distance in metres.
        distance: f64,
    },
    /// A density function gave a value outside of its own limits.
    #[error("the density at ({x}, {y}) is {value}, expected a number from 0 to {max}")]
    Density {
        /// Where, in metres.
        x: f64,
        /// Where, in metres.
        y: f64,
        /// What it gave.
        value: f64,
        /// The greatest value of its own limits.
        max: f64,
    },
    /// A law of radii that replaces the spec's gave a value outside of the spec's limits.
    #[error(
        "the law of `radii` must give numbers from {min} to {max} m, `radius_min` to `radius_max`, \
         got {value:?}"
    )]
    Radius {
        /// What it gave.
        value: f64,
        /// The least radius in metres, the spec's `radius_min`.
        min: f64,
        /// The greatest radius in metres, the spec's `radius_max`.
        max: f64,
    },
}

const RULES: &[&str] = &[
    "`radius_min` is at most `radius_max`, and a thousandth of a log_normal law lies between them, \
     where `radius_law` is not fixed",
    "the greatest radius, `radius` or `radius_max`, is under half the shorter of `width` and \
     `height`, where `border` is inset",
    "`min_distance` is at most half the shorter of `width` and `height`, where `border` is torus",
    "`intensity` times `density` gives at most 20,000,000 trees on `width` by `height`, and 5,000,000 \
     where `min_distance` is not 0",
    "trunks of the greatest radius, `radius` or `radius_max`, grown by `robot_radius` may overlap only \
     so often: `intensity` is limited by them",
];

impl Spec for ForestSpec {
    type Blueprint = Forest;

    const KIND: &'static str = "forest";

    const VALUE_VERSION: u32 = 1;

    const SETTINGS: &'static [Setting] = &[
        WIDTH,
        HEIGHT,
        INTENSITY,
        RADIUS,
        RADIUS_LAW,
        RADIUS_MIN,
        RADIUS_MAX,
        RADIUS_SIGMA,
        MIN_DISTANCE,
        BORDER,
        CLEARING,
        ROBOT_RADIUS,
        DENSITY,
    ];

    const RULES: &'static [&'static str] = RULES;

    fn validate(&self) -> Result<(), SpecError> {
        WIDTH.check(self.width)?;
        HEIGHT.check(self.height)?;
        INTENSITY.check(self.intensity)?;
        RADIUS.check(self.radius)?;
        RADIUS_MIN.check(self.radius_min)?;
        RADIUS_MAX.check(self.radius_max)?;
        RADIUS_SIGMA.check(self.radius_sigma)?;
        MIN_DISTANCE.check(self.min_distance)?;
        CLEARING.check(self.clearing)?;
        ROBOT_RADIUS.check(self.robot_radius)?;
        if let Some(density) = &self.density {
            density.validate()?;
        }
        radius::validate(self)?;
        self.check_border()?;
        self.check_count()?;
        self.check_filling()
    }

    fn work(&self) -> f64 {
        let size = self.centre_area().size();
        let peak = self.density.as_ref().map_or(1.0, DensityMap::max);
        self.intensity * peak * size.x * size.y
    }

    fn generate(&self, seed: Seed) -> Result<Forest, GenerateError> {
        self.validate()?;
        match &self.density {
            None => self.plant(seed, None, None),
            Some(map) => self.plant(seed, Some(&map.over(self)), None),
        }
    }
}

impl ForestSpec {
    /// Generates a forest of varying density: `density` replaces `intensity` and the spec's own raster.
    /// The provenance cannot hold it and is therefore marked as edited.
    ///
    /// # Errors
    /// As [`Spec::generate`], and when the density gives a value outside its own limits.
    pub fn generate_with(
        &self,
        seed: Seed,
        density: &dyn Density,
    ) -> Result<Forest, GenerateError> {
        let peak = ForestSpec { intensity: density.max(), density: None, ..self.clone() };
        peak.validate()?;
        let mut forest = peak.plant(seed, Some(density), None)?;
        forest.edited = true;
        Ok(forest)
    }

    /// The rectangle of the forest.
    pub fn area(&self) -> Rect {
        Rect::new(DVec2::ZERO, DVec2::new(self.width, self.height))
    }

    /// The rectangle in which centres lie.
    pub(super) fn centre_area(&self) -> Rect {
        match self.border {
            Border::Open | Border::Torus => self.area(),
            Border::Inset => self.area().grown(-self.largest_radius()),
        }
    }

    /// The greatest radius that the law can give, in metres.
    pub(super) fn largest_radius(&self) -> f64 {
        match self.radius_law {
            RadiusLaw::Fixed => self.radius,
            RadiusLaw::Uniform | RadiusLaw::LogNormal => self.radius_max,
        }
    }

    /// The forest of a valid spec; a density and a law of radii replace the spec's own.
    pub(super) fn plant(
        &self,
        seed: Seed,
        density: Option<&dyn Density>,
        radii: Option<&Law<'_>>,
    ) -> Result<Forest, GenerateError> {
        let centres = if self.min_distance > 0.0 {
            hard_core::centres(self, seed, density)?
        } else {
            poisson::centres(self, seed, density)?
        };
        let trees = radius::grow(self, seed, centres, radii)?;
        let (trees, cleared) = start_goal::clear(self, trees);
        let spec = self.clone();
        Ok(Forest { trees, cleared, spec, seed, edited: false, custom_radii: radii.is_some() })
    }

    fn check_border(&self) -> Result<(), SpecError> {
        let side = self.width.min(self.height);
        if self.border == Border::Inset && 2.0 * self.largest_radius() >= side {
            let allowed =
                format!("under {} m with border inset, half the shorter side", 0.5 * side);
            let name = if self.radius_law == RadiusLaw::Fixed { "radius" } else { "radius_max" };
            return Err(SpecError::new(name, self.largest_radius(), allowed));
        }
        if self.border == Border::Torus && 2.0 * self.min_distance > side {
            let allowed =
                format!("at most {} m with border torus, half the shorter side", 0.5 * side);
            return Err(SpecError::new("min_distance", self.min_distance, allowed));
        }
        Ok(())
    }

    fn check_count(&self) -> Result<(), SpecError> {
        let size = self.centre_area().size();
        let area = size.x * size.y;
        let peak = self.density.as_ref().map_or(1.0, DensityMap::max);
        let most = if self.min_distance > 0.0 { MAX_HARD_CORE_TREES } else { MAX_TREES };
        if self.intensity * peak * area <= most {
            return Ok(());
        }
        let allowed = format!("at most {} 1/m^2: {most} trees on {area} m^2", most / (area * peak));
        Err(SpecError::new("intensity", self.intensity, allowed))
    }

    fn check_filling(&self) -> Result<(), SpecError> {
        let grown = self.largest_radius() + self.robot_radius;
        let peak = self.density.as_ref().map_or(1.0, DensityMap::max);
        let disc = PI * grown * grown * peak;
        let size = self.centre_area().size();
        let trees = size.x * size.y * peak;
        let most = (MAX_REDUCED_DENSITY / disc).min((MAX_OVERLAPS / (trees * disc)).sqrt());
        if self.intensity <= most {
            return Ok(());
        }
        let allowed = format!(
            "at most {most} 1/m^2: with trunks of {} m and a robot of {} m, either would overlap too \
             often",
            self.largest_radius(),
            self.robot_radius
        );
        Err(SpecError::new("intensity", self.intensity, allowed))
    }
}

/// The most trunks, grown by the robot's radius, that may cover a point on average: far too many to
/// be crossed.
const MAX_REDUCED_DENSITY: f64 = 100.0;

/// The expected overlaps of such trunks that a forest may have at most: they bound the time of its
/// metrics.
const MAX_OVERLAPS: f64 = 4e7;

/// The trees of a forest, with the spec and seed that they were drawn for.
#[derive(Clone, Debug, PartialEq)]
pub struct Forest {
    trees: Vec<Tree>,
    cleared: u64,
    spec: ForestSpec,
    seed: Seed,
    pub(super) edited: bool,
    /// Whether a law that is not the spec's gave the radii.
    pub(super) custom_radii: bool,
}

impl Forest {
    /// The trees, in the order in which they were drawn.
    pub fn trees(&self) -> &[Tree] {
        &self.trees
    }

    /// How many trees the clearings removed.
    pub fn cleared(&self) -> u64 {
        self.cleared
    }

    /// The settings.
    pub fn spec(&self) -> &ForestSpec {
        &self.spec
    }

    /// The seed that it was drawn with.
    pub fn seed(&self) -> Seed {
        self.seed
    }

    /// Whether a density function replaced the spec's intensity, which is then the greatest value of
    /// that function, or another law the spec's law of radii, which is then uniform.
    pub fn edited(&self) -> bool {
        self.edited
    }
}

impl Serialize for Forest {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Fields<'a> {
            width: f64,
            height: f64,
            trees: Triples<'a>,
        }
        let Forest { trees, spec, .. } = self;
        Fields { width: spec.width, height: spec.height, trees: Triples(trees) }
            .serialize(serializer)
    }
}

/// Trees as `[x, y, radius]`.
struct Triples<'a>(&'a [Tree]);

impl Serialize for Triples<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(Some(self.0.len()))?;
        for tree in self.0 {
            list.serialize_element(&[tree.center.x, tree.center.y, tree.radius])?;
        }
        list.end()
    }
}

impl Blueprint for Forest {
    type Metrics = ForestMetrics;

    fn metrics(&self) -> ForestMetrics {
        metrics::measure(self)
    }

    fn to_world(&self) -> World {
        let mut provenance = self.spec.provenance(self.seed);
        provenance.edited = self.edited;
        start_goal::world(self, provenance)
    }
}
