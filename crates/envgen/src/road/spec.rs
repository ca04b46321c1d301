//! The settings of a road.

use serde::{Deserialize, Serialize};
use strum::VariantNames;

use super::apportion::quantum;
use super::dirichlet::{self, Concentration};
use super::turn::{GRAVITY, TurnLaw, TurnLimits};
use crate::error::SpecError;
use crate::geometry::{Pose, unit_vector};
use crate::settings;
use crate::world::KERB;

/// The greatest number of waypoints of a road.
pub const MAX_WAYPOINTS: u64 = 2_000_000;

/// The greatest deviation in metres of the strip's border from the points at which the area is checked.
pub(super) const AREA_TOLERANCE: f64 = 1e-3;

/// The least width of kerbs in metres. Far from the origin, narrower kerbs lose their area to rounding.
const LEAST_KERB: f64 = 1e-6;

/// The greatest length of a road in metres.
const MAX_LENGTH: f64 = 1e6;

/// The greatest number of segments of a road.
pub const MAX_SEGMENTS: usize = 4096;

/// Whether the height is the default, which files omit, so that the files of other roads are the same as before the
/// setting existed.
fn is_kerb_height(value: &f64) -> bool {
    *value == KERB.top()
}

settings! {
    /// The settings of a road.
    ///
    /// The defaults are those of the source's example, `straight, left, straight, right, straight`.
    ///
    /// ```
    /// use envgen::{Seed, Spec, road::RoadSpec};
    ///
    /// let spec = RoadSpec { length: 500.0, speed: 10.0, ..Default::default() };
    /// let road = spec.generate(Seed(7))?;
    /// let end = road.pose_at(road.length());
    /// let located = road.locate(end.position + glam::DVec2::new(0.0, 2.0)).unwrap();
    /// assert!(located.offset.abs() <= 2.0);
    /// // No turn is tighter than the speed allows.
    /// let radius = spec.turn_limits().least_radius;
    /// assert!(road.curvature_at(250.0).abs() <= 1.0 / radius + 1e-9);
    /// # use envgen::glam;
    /// # Ok::<(), envgen::road::RoadError>(())
    /// ```
    pub struct RoadSpec {
        /// Length.
        length: f64 = 1000.0 => number("m", 0.1..=MAX_LENGTH);
        /// Distance between waypoints, at most the length; the road's own is the nearest that divides the
        /// length.
        #[group = "segments"]
        step: f64 = 1.0 => number("m", 1e-3..=1e5);
        /// The segments in travel order.
        prefabs: Vec<Prefab> = {
            use Prefab::{Left, Right, Straight};
            vec![Straight, Left, Straight, Right, Straight]
        } => list("", "straight, left, right or turn (to either side)", "straight,turn,straight");
        /// Number of segments drawn at random in place of `prefabs`, 0 takes `prefabs`; the length must
        /// suffice for all of them being turns.
        #[alias = "random"]
        #[group = ""]
        segment_count: u64 = 0 => integer("", 0..=MAX_SEGMENTS as u64);
        /// Probability that a segment drawn at random is a turn.
        #[group = "segments"]
        p_turn: f64 = 0.5 => number("", 0.0..=1.0);
        /// Concentration of the Dirichlet law of the lengths: one for all segments or a list.
        alpha: Concentration = Concentration::Same(1.0) => other("", dirichlet::ALLOWED, "1,2,1,2,1");
        /// How lengths are shared out: turns first get the length they need, or all length is drawn.
        lengths: Lengths = Lengths::Reserve => choice;
        /// Least length of a segment, whatever the step, where `lengths` is `reserve` or the road is aimed
        /// or closed.
        #[alias = "shortest"]
        min_segment_length: f64 = 1.0 => number("m", 1e-3..=1e5);
        /// Speed at which the turns must be driveable; 0 for no such limit.
        #[group = ""]
        speed: f64 = 50.0 / 3.6 => number("m/s", 0.0..=1000.0);
        /// Coefficient of friction.
        #[group = "turns"]
        friction: f64 = 0.7 => number("", 0.01..=10.0);
        /// Least angle of a turn.
        theta_min: f64 = 30.0 => number("degrees", 0.1..=350.0);
        /// Greatest angle of a turn.
        theta_max: f64 = 90.0 => number("degrees", 0.1..=350.0);
        /// Least radius of a turn, beside what speed and width demand.
        min_radius: f64 = 0.0 => number("m", 0.0..=1e5);
        /// Which quantity of a turn is uniform between its limits.
        #[alias = "turns"]
        turn_law: TurnLaw = TurnLaw::UniformRadius => choice;
        /// Share of a turn's length that each of its two clothoids takes; 0 for arcs alone.
        transition: f64 = 0.0 => number("", 0.0..=0.5);
        /// Full width.
        #[group = ""]
        width: f64 = 7.0 => number("m", 0.1..=100.0);
        /// Number of lanes.
        lanes: u64 = 2 => integer("", 1..=16);
        /// Width of the kerbs, at least a micrometre; 0 for none.
        #[group = "kerbs"]
        kerb: f64 = 0.15 => number("m", 0.0..=0.9);
        /// Height of the kerbs: lasers that are higher do not see them. Kerbs of streets have 0.1 to 0.15 m.
        #[serde(skip_serializing_if = "is_kerb_height")]
        kerb_height: f64 = KERB.top() => number("m", 0.01..=10.0);
        /// x of the start.
        #[group = "course"]
        start_x: f64 = 0.0 => number("m", -1e6..=1e6);
        /// y of the start.
        start_y: f64 = 0.0 => number("m", -1e6..=1e6);
        /// Heading of the start, counter-clockwise from +x.
        start_heading: f64 = 0.0 => number("degrees", -360.0..=360.0);
        /// x of the point to end at, if any: the straights, and with them the road, become longer or
        /// shorter.
        #[alias = "aim_x"]
        end_x: Option<f64> = None => optional_number("m", -1e6..=1e6);
        /// y of the point to end at, if any.
        #[alias = "aim_y"]
        end_y: Option<f64> = None => optional_number("m", -1e6..=1e6);
        /// Whether the road returns to its start.
        closed: bool = false => flag;
        /// What happens when the road covers itself.
        crossing: Crossing = Crossing::Allow => choice;
        /// Side of the square from (0, 0) that the road must stay in; 0 for none.
        area: f64 = 0.0 => number("m", 0.0..=1e6);
        /// Most attempts where `crossing` is `resample`.
        attempts: u64 = 100 => integer("", 1..=10_000);
    }
}

impl RoadSpec {
    /// Returns the settings of a road by the rules of the SBFT tool competition for self-driving cars: inside a
    /// square of 200 m, with at most 500 points, two lanes of 4 m and radii of at least 14.4 m, longer than 40 m,
    /// and with a strip of 8 m that does not overlap itself.
    ///
    /// ```
    /// use envgen::road::RoadSpec;
    /// use envgen::{Blueprint, Seed, Spec};
    ///
    /// let world = RoadSpec::sbft().generate(Seed(7))?.to_world();
    /// assert_eq!(world.road_strips[0].width, 8.0);
    /// # Ok::<(), envgen::road::RoadError>(())
    /// ```
    pub fn sbft() -> Self {
        RoadSpec {
            length: 200.0,
            step: 1.0,
            segment_count: 6,
            p_turn: 0.6,
            speed: 0.0,
            min_radius: 14.4,
            width: 8.0,
            lanes: 2,
            start_x: 100.0,
            start_y: 30.0,
            start_heading: 90.0,
            crossing: Crossing::Resample,
            area: 200.0,
            attempts: 1000,
            ..Default::default()
        }
    }

    /// Returns the limits of the road's turns, in radians and metres.
    pub fn turn_limits(&self) -> TurnLimits {
        TurnLimits {
            theta_min: self.theta_min.to_radians(),
            theta_max: self.theta_max.to_radians(),
            least_radius: self.speed_radius().max(self.fixed_radius()),
            transition: self.transition,
        }
    }

    /// Returns the pose at the start of the road.
    pub fn start(&self) -> Pose {
        Pose::new(self.start_x, self.start_y, self.start_heading.to_radians())
    }

    /// Returns the point at which the road should end, if one is requested.
    pub fn aim(&self) -> Option<glam::DVec2> {
        Some(glam::DVec2::new(self.end_x?, self.end_y?))
    }

    /// Returns the radius in metres at which friction holds a car at the spec's speed.
    fn speed_radius(&self) -> f64 {
        self.speed * self.speed / (GRAVITY * self.friction)
    }

    /// Returns the least radius in metres that does not depend on the speed.
    fn fixed_radius(&self) -> f64 {
        self.min_radius.max(0.5 * self.width + 1.0)
    }

    /// Returns the number of segments.
    pub(super) fn count(&self) -> usize {
        if self.segment_count > 0 { self.segment_count as usize } else { self.prefabs.len() }
    }

    /// Returns the length in metres that `reserve` keeps for a turn or a straight.
    pub(super) fn reserve(&self, turn: bool) -> f64 {
        let least = if turn { self.turn_limits().shortest() } else { 0.0 };
        // Rounded up, so that rounding a length down to a multiple of the quantum leaves enough.
        let quantum = quantum(self.length);
        (self.min_segment_length.max(least) / quantum).ceil() * quantum
    }

    /// Returns the greatest number of turns of the road.
    fn most_turns(&self) -> usize {
        match self.segment_count {
            0 => self.prefabs.iter().filter(|&&prefab| prefab != Prefab::Straight).count(),
            _ if self.p_turn == 0.0 => 0,
            count => count as usize,
        }
    }

    /// Returns the length in metres that `reserve` needs for the greatest number of turns.
    fn needed(&self) -> f64 {
        let turns = self.most_turns();
        let straights = (self.count() - turns) as f64 * self.reserve(false);
        straights + turns as f64 * self.reserve(true)
    }

    /// Returns the least whole number of millimetres that is enough for `reserve`. A longer road has a larger quantum,
    /// and may thus need slightly more.
    fn needed_millimetres(&self) -> f64 {
        let mut millimetres = (self.needed() * 1e3).ceil();
        while (RoadSpec { length: millimetres / 1e3, ..self.clone() }).needed() > millimetres / 1e3
        {
            millimetres += 1.0;
        }
        millimetres
    }

    /// Checks that `reserve` has enough length for the greatest number of turns.
    ///
    /// # Errors
    /// Names the required length, the given length and the greatest speed that would be allowed.
    fn check_reserve(&self) -> Result<(), SpecError> {
        if self.lengths == Lengths::AsPublished || self.needed() <= self.length {
            return Ok(());
        }
        let turns = self.most_turns();
        let straights = (self.count() - turns) as f64 * self.reserve(false);
        let each = (self.length - straights) / turns as f64;
        let radius = each * (1.0 - self.transition) / self.theta_min.to_radians();
        let cure = if turns > 0 && each >= self.min_segment_length && radius >= self.fixed_radius()
        {
            let speed = (radius * GRAVITY * self.friction).sqrt();
            format!("or a speed of at most {} m/s", rounded_down(speed))
        } else {
            "at any speed".to_owned()
        };
        let most = if self.segment_count > 0 { "up to " } else { "" };
        let needed = self.needed_millimetres() / 1e3;
        let enough = if needed <= MAX_LENGTH {
            format!("at least {needed:.3} m")
        } else {
            format!("at least {needed:.0} m, which is more than the greatest of {MAX_LENGTH} m,")
        };
        let straights = self.count() - turns;
        let allowed = format!("{enough} for {most}{turns} turns and {straights} straights, {cure}");
        Err(SpecError::new("length", self.length, allowed))
    }

    /// Checks every field, and the rules about several fields.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        self.check_fields()?;
        self.check_together()?;
        self.check_area()?;
        self.check_reserve()
    }

    /// Checks that a road that must stay in an area begins there.
    fn check_area(&self) -> Result<(), SpecError> {
        let start = self.start();
        let across = unit_vector(start.heading).perp() * (0.5 * self.width);
        let is_inside = |p: glam::DVec2| {
            p.min_element() >= AREA_TOLERANCE && p.max_element() <= self.area - AREA_TOLERANCE
        };
        if self.area == 0.0
            || [start.position + across, start.position - across].into_iter().all(is_inside)
        {
            return Ok(());
        }
        let allowed = format!(
            "0 or so large that the road begins in the square from (0, 0) to (area, area): both its edges at \
             `start_x` {}, `start_y` {} and `start_heading` {} with a `width` of {} m",
            self.start_x, self.start_y, self.start_heading, self.width
        );
        Err(SpecError::new("area", self.area, allowed))
    }

    /// Checks the fields that depend on each other.
    fn check_together(&self) -> Result<(), SpecError> {
        if self.step > self.length {
            let allowed = format!("at most the length of {} m", self.length);
            return Err(SpecError::new("step", self.step, allowed));
        }
        let waypoints = (self.length / self.step).round();
        if waypoints > MAX_WAYPOINTS as f64 {
            let least = self.length / MAX_WAYPOINTS as f64;
            let allowed =
                format!("at least {least} m, {MAX_WAYPOINTS} waypoints on {} m", self.length);
            return Err(SpecError::new("step", self.step, allowed));
        }
        if self.closed && waypoints < 3.0 {
            let allowed = "at most 0.4 of the length of a closed road, for three waypoints";
            return Err(SpecError::new("step", self.step, allowed));
        }
        if self.kerb > 0.0 && self.kerb < LEAST_KERB {
            let allowed = format!("0 or from {LEAST_KERB} to 0.9");
            return Err(SpecError::new("kerb", self.kerb, allowed));
        }
        if self.segment_count == 0 && self.prefabs.is_empty() {
            return Err(SpecError::new("prefabs", "an empty list", "at least one segment"));
        }
        if self.prefabs.len() > MAX_SEGMENTS {
            let allowed = format!("at most {MAX_SEGMENTS} segments");
            let given = format!("a list of {}", self.prefabs.len());
            return Err(SpecError::new("prefabs", given, allowed));
        }
        self.alpha.check(self.count())?;
        if self.theta_min > self.theta_max {
            let allowed = format!("at most theta_max, {} degrees", self.theta_max);
            return Err(SpecError::new("theta_min", self.theta_min, allowed));
        }
        if self.end_x.is_some() != self.end_y.is_some() {
            let (name, missing) = if self.end_x.is_some() {
                ("end_y", "a number, as end_x is one")
            } else {
                ("end_x", "a number, as end_y is one")
            };
            return Err(SpecError::new(name, "none", missing));
        }
        if self.closed && self.end_x.is_some() {
            let allowed = "false for a road that aims at a point";
            return Err(SpecError::new("closed", true, allowed));
        }
        Ok(())
    }
}

/// Rounds a speed in m/s down, so that the printed number is allowed.
fn rounded_down(speed: f64) -> f64 {
    (speed * 1e6 - 1e-3).floor() / 1e6
}

/// A requested segment of a road.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Prefab {
    /// A straight.
    Straight,
    /// A turn to the left.
    Left,
    /// A turn to the right.
    Right,
    /// A turn to either side with equal probability.
    Turn,
}

/// How the length is divided among the segments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Lengths {
    /// Every segment first gets the least length that it needs, and the rest is divided at random.
    Reserve,
    /// The whole length is divided at random, as published; turns may become too short.
    AsPublished,
}

/// What happens if a road overlaps itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Crossing {
    /// It is allowed.
    Allow,
    /// Generation fails.
    Reject,
    /// The road is drawn again, up to `attempts` times; also if it misses its requested end, its start or its area, or
    /// if a turn is too short.
    Resample,
}

pub(super) const RULES: &[&str] = &[
    "`step` is at most the `length`, 0.4 of it where `closed` is true, and there are at most \
     2,000,000 waypoints: `length` over `step`",
    "`prefabs` holds 1 to 4096 segments, where `segment_count` is 0",
    "`alpha` is a number, or has one for each segment of `prefabs`, or of `segment_count`",
    "`theta_min` is at most `theta_max`",
    "the start, `start_x` and `start_y`, is within the `area`, where that is not 0",
    "`end_x` and `end_y` are both numbers or both none, and none where `closed` is true",
    "`length` has room for the least lengths of all segments, which follow from `min_segment_length`, \
     `theta_min`, `speed`, `friction`, `min_radius` and `width`, where `lengths` is reserve",
];
