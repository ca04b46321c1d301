//! The settings of a forest.

use std::f64::consts::{PI, SQRT_2};

use glam::DVec2;
use serde::{Deserialize, Serialize};
use strum::VariantNames;

use super::density::DensityMap;
use crate::error::SpecError;
use crate::geometry::Rect;
use crate::settings;
use crate::world::{Extent, Tree};

/// The greatest expected number of trees of a forest.
pub const MAX_TREES: f64 = 2e7;

/// The greatest expected number of trees of a forest with a least distance. Generating it needs a grid of up to 256
/// bytes per tree.
pub const MAX_HARD_CORE_TREES: f64 = 5e6;

settings! {
    /// The settings of a forest, which is the rectangle from (0, 0) to (`width`, `height`).
    ///
    /// The defaults have the density and radius of the paper's figure 2.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec};
    ///
    /// let spec = ForestSpec { width: 100.0, min_distance: 3.0, ..Default::default() };
    /// let forest = spec.generate(Seed(1))?;
    /// assert!(forest.to_world().trees.len() > 100);
    /// # Ok::<(), envgen::forest::ForestError>(())
    /// ```
    pub struct ForestSpec {
        /// Width of the area.
        width: f64 = 50.0 => number("m", 0.01..=1e6);
        /// Height of the area.
        height: f64 = 50.0 => number("m", 0.01..=1e6);
        /// Mean number of trees per square metre.
        intensity: f64 = 0.05 => number("1/m^2", 0.0..=1e6);
        /// Radius of the trunks; the median of `log_normal`, unused by `uniform`.
        radius: f64 = 1.0 => number("m", 1e-4..=1e4);
        /// The law of the radii.
        #[group = "trees"]
        radius_law: RadiusLaw = RadiusLaw::Fixed => choice;
        /// Least radius of a varying law.
        radius_min: f64 = 0.5 => number("m", 1e-4..=1e4);
        /// Greatest radius of a varying law.
        radius_max: f64 = 2.0 => number("m", 1e-4..=1e4);
        /// Standard deviation of the logarithm of a `log_normal` radius.
        radius_sigma: f64 = 0.4 => number("", 1e-3..=5.0);
        /// Height of the trees; none follows from their radii.
        #[serde(skip_serializing_if = "Option::is_none")]
        tree_height: Option<f64> = None => optional_number("m", 0.05..=200.0);
        /// Least distance between two trees' centres; 0 for none.
        #[group = ""]
        min_distance: f64 = 0.0 => number("m", 0.0..=1e5);
        /// How the border limits the trees.
        #[group = "placement"]
        border: Border = Border::Open => choice;
        /// Radius around start and goal that no trunk reaches into; 0 clears nothing.
        clearing: f64 = 0.0 => number("m", 0.0..=1e5);
        /// Radius of the robot for which start, goal and crossings are found; 0 for a point, which is
        /// stopped only by trunks that touch.
        robot_radius: f64 = 0.36 => number("m", 0.0..=1e4);
        /// Density over the area: a raster of factors on `intensity`.
        density: Option<DensityMap> = None => optional_other(
            "",
            "rows of factors of at least 0, the top row first",
            "[[0, 1], [1, 0.5]]"
        );
    }
}

/// The distribution of the radii.
///
/// ```
/// use envgen::forest::{ForestSpec, RadiusLaw};
/// use envgen::{Seed, Spec};
///
/// let radius_law = RadiusLaw::Uniform;
/// let spec = ForestSpec { radius_law, radius_min: 0.2, radius_max: 0.4, ..Default::default() };
/// let forest = spec.generate(Seed(7))?;
/// assert!(forest.trees().iter().all(|tree| (0.2..=0.4).contains(&tree.radius)));
/// # Ok::<(), envgen::forest::ForestError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum RadiusLaw {
    /// All trees have the radius `radius`.
    Fixed,
    /// The radius is uniform from `radius_min` to `radius_max`.
    Uniform,
    /// The radius is log-normal with median `radius` and `radius_sigma`. Values outside `radius_min` to
    /// `radius_max` are drawn again.
    LogNormal,
}

/// How a forest's border limits the trees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Border {
    /// Centres lie inside the area; trunks may extend beyond it by their radius.
    Open,
    /// Whole trunks lie inside the area; `intensity` applies to the smaller area that remains for the centres.
    Inset,
    /// Opposite sides are joined: distances count across them, so that copies of the forest tile the plane.
    Torus,
}

pub(super) const RULES: &[&str] = &[
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

impl ForestSpec {
    /// Creates a tree of the spec's height.
    pub(super) fn tree(&self, center: DVec2, radius: f64) -> Tree {
        let height = self.tree_height.and_then(|top| Extent::new(0.0, top).ok());
        Tree { height, ..Tree::new(center, radius) }
    }

    /// Checks every field, and the rules about several fields.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        self.check_fields()?;
        if let Some(density) = &self.density {
            density.validate()?;
        }
        self.check_radii()?;
        self.check_border()?;
        self.check_intensity()
    }

    /// Returns the rectangle of the forest.
    pub fn area(&self) -> Rect {
        Rect::new(DVec2::ZERO, DVec2::new(self.width, self.height))
    }

    /// Returns the rectangle in which centres lie.
    pub(super) fn centre_area(&self) -> Rect {
        match self.border {
            Border::Open | Border::Torus => self.area(),
            Border::Inset => self.area().grown(-self.largest_radius()),
        }
    }

    /// Returns the greatest radius that the distribution can give, in metres.
    pub(crate) fn largest_radius(&self) -> f64 {
        match self.radius_law {
            RadiusLaw::Fixed => self.radius,
            RadiusLaw::Uniform | RadiusLaw::LogNormal => self.radius_max,
        }
    }

    /// Checks that the distribution of the radii has values between its limits.
    fn check_radii(&self) -> Result<(), SpecError> {
        if self.radius_law == RadiusLaw::Fixed {
            return Ok(());
        }
        if self.radius_min > self.radius_max {
            let allowed = format!("at most radius_max, which is {} m", self.radius_max);
            return Err(SpecError::new("radius_min", self.radius_min, allowed));
        }
        if self.radius_law == RadiusLaw::LogNormal {
            let below = |r: f64| {
                let z = libm::log(r / self.radius) / self.radius_sigma;
                0.5 * libm::erfc(-z / SQRT_2)
            };
            let share = below(self.radius_max) - below(self.radius_min);
            if share < LEAST_SHARE {
                let allowed = format!(
                    "a median with at least {LEAST_SHARE} of the law between radius_min = {} m and \
                     radius_max = {} m; here it is {share:.2e}",
                    self.radius_min, self.radius_max
                );
                return Err(SpecError::new("radius", self.radius, allowed));
            }
        }
        Ok(())
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

    /// Returns the area in square metres in which centres lie, and the greatest factor on the intensity.
    fn area_and_peak(&self) -> (f64, f64) {
        let size = self.centre_area().size();
        (size.x * size.y, self.density.as_ref().map_or(1.0, DensityMap::max))
    }

    /// Returns the expected number of trees if the density had its greatest value everywhere.
    pub(super) fn expected_trees(&self) -> f64 {
        let (area, peak) = self.area_and_peak();
        self.intensity * peak * area
    }

    /// Checks the number of trees and how often they overlap. The error names the lower limit of the two.
    fn check_intensity(&self) -> Result<(), SpecError> {
        let most_trees = if self.min_distance > 0.0 { MAX_HARD_CORE_TREES } else { MAX_TREES };
        let (area, peak) = self.area_and_peak();
        let mut by_count = most_trees / (area * peak);
        // By rounding, the limit may itself be too great.
        while by_count * peak * area > most_trees {
            by_count = by_count.next_down();
        }
        let grown = self.largest_radius() + self.robot_radius;
        let (disc, trees) = (PI * grown * grown * peak, area * peak);
        let by_overlaps = (MAX_REDUCED_DENSITY / disc).min((MAX_OVERLAPS / (trees * disc)).sqrt());
        if self.intensity <= by_overlaps && self.expected_trees() <= most_trees {
            return Ok(());
        }
        let allowed = if by_count <= by_overlaps {
            format!("at most {by_count} 1/m^2: {most_trees} trees on {area} m^2")
        } else {
            format!(
                "at most {by_overlaps} 1/m^2: with trunks of {} m and a robot of {} m, either would \
                 overlap too often",
                self.largest_radius(),
                self.robot_radius
            )
        };
        Err(SpecError::new("intensity", self.intensity, allowed))
    }
}

/// The greatest mean number of trunks, enlarged by the robot's radius, that may cover a point; it is far too many
/// for a forest that can be crossed.
const MAX_REDUCED_DENSITY: f64 = 100.0;

/// The greatest expected number of overlaps of such trunks in a forest, which bounds the time of its metrics.
const MAX_OVERLAPS: f64 = 4e7;

/// The least share of a log-normal distribution that must lie between the limits, so that drawing again soon gives
/// a value inside.
const LEAST_SHARE: f64 = 1e-3;
