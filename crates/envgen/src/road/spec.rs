//! The settings of a road.

use serde::{Deserialize, Serialize};

use super::apportion::quantum;
use super::blueprint::Road;
use super::concentration::Concentration;
use super::laws::RoadLaws;
use super::turn::{GRAVITY, TurnLimits};
use crate::error::{GenerateError, SpecError};
use crate::generate::Spec;
use crate::geometry::Pose;
use crate::seed::Seed;
use crate::settings::Setting;

/// Most waypoints that a road can have.
pub const MAX_WAYPOINTS: u64 = 2_000_000;

/// Most segments that a road can have.
pub const MAX_SEGMENTS: usize = 4096;

/// A road to generate.
///
/// The default is the source's example, `straight, left, straight, right, straight`.
///
/// ```
/// use envgen::{Seed, Spec, road::RoadSpec};
///
/// let spec = RoadSpec { length: 500.0, speed: 10.0, ..Default::default() };
/// let road = spec.generate(Seed(7))?;
/// let end = road.pose_at(road.length());
/// let located = road.locate(end.position + glam::DVec2::new(0.0, 2.0)).unwrap();
/// assert!(located.offset.abs() <= 2.0);
/// # use envgen::glam;
/// # Ok::<(), envgen::GenerateError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RoadSpec {
    /// Length in metres.
    pub length: f64,
    /// Distance between waypoints in metres; the road's own is the nearest that divides the length.
    pub step: f64,
    /// The segments in travel order.
    pub prefabs: Vec<Prefab>,
    /// Number of segments drawn at random in place of `prefabs`; 0 takes `prefabs`.
    pub random: u64,
    /// Probability that a segment drawn at random is a turn.
    pub p_turn: f64,
    /// Concentration of the Dirichlet law of the lengths: one for all segments or a list.
    pub alpha: Concentration,
    /// How lengths are shared out.
    pub lengths: Lengths,
    /// Least length of a segment in metres, where `lengths` is `reserve` or the road is aimed or
    /// closed.
    pub shortest: f64,
    /// Speed in m/s at which the turns must be driveable; 0 for no such limit.
    pub speed: f64,
    /// Coefficient of friction.
    pub friction: f64,
    /// Least angle of a turn in degrees.
    pub theta_min: f64,
    /// Greatest angle of a turn in degrees.
    pub theta_max: f64,
    /// Least radius of a turn in metres, beside what speed and width demand.
    pub min_radius: f64,
    /// Which quantity of a turn is uniform between its limits.
    pub turns: TurnLaw,
    /// Share of a turn's length that each of its two clothoids takes; 0 for arcs alone.
    pub transition: f64,
    /// Full width in metres.
    pub width: f64,
    /// Number of lanes.
    pub lanes: u64,
    /// Width of the kerbs in metres; 0 for none.
    pub kerb: f64,
    /// x of the start in metres.
    pub start_x: f64,
    /// y of the start in metres.
    pub start_y: f64,
    /// Heading of the start in degrees, counter-clockwise from +x.
    pub start_heading: f64,
    /// x in metres of the point to end at; `None` for no such point.
    pub aim_x: Option<f64>,
    /// y in metres of the point to end at.
    pub aim_y: Option<f64>,
    /// Whether the road returns to its start.
    pub closed: bool,
    /// What happens when the road covers itself.
    pub crossing: Crossing,
    /// Side in metres of the square from (0, 0) that the road must stay in; 0 for none.
    pub area: f64,
    /// Most attempts where `crossing` is `resample`.
    pub attempts: u64,
}

impl Default for RoadSpec {
    fn default() -> Self {
        use Prefab::{Left, Right, Straight};
        RoadSpec {
            length: 1000.0,
            step: 1.0,
            prefabs: vec![Straight, Left, Straight, Right, Straight],
            random: 0,
            p_turn: 0.5,
            alpha: Concentration::Same(1.0),
            lengths: Lengths::Reserve,
            shortest: 1.0,
            speed: 50.0 / 3.6,
            friction: 0.7,
            theta_min: 30.0,
            theta_max: 90.0,
            min_radius: 0.0,
            turns: TurnLaw::UniformRadius,
            transition: 0.0,
            width: 7.0,
            lanes: 2,
            kerb: 0.15,
            start_x: 0.0,
            start_y: 0.0,
            start_heading: 0.0,
            aim_x: None,
            aim_y: None,
            closed: false,
            crossing: Crossing::Allow,
            area: 0.0,
            attempts: 100,
        }
    }
}

impl RoadSpec {
    /// A road by the rules of the SBFT tool competition for self-driving cars: inside a square of
    /// 200 m, at most 500 points, two lanes of 4 m, radii of at least 14.4 m, longer than 40 m, and
    /// a strip of 8 m that does not cover itself.
    pub fn sbft() -> Self {
        RoadSpec {
            length: 200.0,
            step: 1.0,
            random: 6,
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

    /// The limits of the road's turns, in radians and metres.
    pub fn turn_limits(&self) -> TurnLimits {
        TurnLimits {
            theta_min: self.theta_min.to_radians(),
            theta_max: self.theta_max.to_radians(),
            least_radius: self.speed_radius().max(self.fixed_radius()),
            transition: self.transition,
        }
    }

    /// Where the road starts.
    pub fn start(&self) -> Pose {
        Pose::new(self.start_x, self.start_y, self.start_heading.to_radians())
    }

    /// The point where the road should end.
    pub fn aim(&self) -> Option<glam::DVec2> {
        Some(glam::DVec2::new(self.aim_x?, self.aim_y?))
    }

    /// The radius in metres at which friction holds a car of the spec's speed.
    fn speed_radius(&self) -> f64 {
        self.speed * self.speed / (GRAVITY * self.friction)
    }

    /// The least radius in metres whatever the speed.
    fn fixed_radius(&self) -> f64 {
        self.min_radius.max(0.5 * self.width + 1.0)
    }

    /// Number of segments.
    pub(super) fn count(&self) -> usize {
        if self.random > 0 { self.random as usize } else { self.prefabs.len() }
    }

    /// The length that `reserve` keeps for a turn or a straight, in metres.
    pub(super) fn reserve(&self, turn: bool) -> f64 {
        let least = if turn { self.turn_limits().shortest() } else { 0.0 };
        // Rounded up, so that rounding a length down to a multiple of the quantum leaves enough.
        let quantum = quantum(self.length);
        (self.shortest.max(least) / quantum).ceil() * quantum
    }

    /// The most turns that the road can have.
    fn most_turns(&self) -> usize {
        match self.random {
            0 => self.prefabs.iter().filter(|&&prefab| prefab != Prefab::Straight).count(),
            _ if self.p_turn == 0.0 => 0,
            count => count as usize,
        }
    }

    /// Checks that `reserve` has room for the most turns that the road can have.
    ///
    /// # Errors
    /// Names the required length, the given length and the greatest speed that would be allowed.
    fn check_reserve(&self) -> Result<(), SpecError> {
        let turns = self.most_turns();
        let straights = (self.count() - turns) as f64 * self.reserve(false);
        let needed = straights + turns as f64 * self.reserve(true);
        if self.lengths == Lengths::AsPublished || needed <= self.length {
            return Ok(());
        }
        let each = (self.length - straights) / turns as f64;
        let radius = each * (1.0 - self.transition) / self.theta_min.to_radians();
        let cure = if turns > 0 && each >= self.shortest && radius >= self.fixed_radius() {
            let speed = (radius * GRAVITY * self.friction).sqrt();
            format!("or a speed of at most {} m/s", rounded_down(speed))
        } else {
            "at any speed".to_owned()
        };
        let most = if self.random > 0 { "up to " } else { "" };
        let allowed = format!(
            "at least {needed:.3} m for {most}{turns} turns and {} straights, {cure}",
            self.count() - turns
        );
        Err(SpecError::new(LENGTH.name, self.length, allowed))
    }

    /// Checks the fields that depend on each other.
    fn check_together(&self) -> Result<(), SpecError> {
        if self.step > self.length {
            let allowed = format!("at most the length of {} m", self.length);
            return Err(SpecError::new(STEP.name, self.step, allowed));
        }
        let waypoints = (self.length / self.step).round();
        if waypoints > MAX_WAYPOINTS as f64 {
            let least = self.length / MAX_WAYPOINTS as f64;
            let allowed =
                format!("at least {least} m, {MAX_WAYPOINTS} waypoints on {} m", self.length);
            return Err(SpecError::new(STEP.name, self.step, allowed));
        }
        if self.closed && waypoints < 3.0 {
            let allowed = "at most a third of the length of a closed road";
            return Err(SpecError::new(STEP.name, self.step, allowed));
        }
        if self.random == 0 && self.prefabs.is_empty() {
            return Err(SpecError::new(PREFABS.name, "an empty list", "at least one segment"));
        }
        if self.prefabs.len() > MAX_SEGMENTS {
            let allowed = format!("at most {MAX_SEGMENTS} segments");
            let given = format!("a list of {}", self.prefabs.len());
            return Err(SpecError::new(PREFABS.name, given, allowed));
        }
        self.alpha.check(self.count())?;
        if self.theta_min > self.theta_max {
            let allowed = format!("at most theta_max, {} degrees", self.theta_max);
            return Err(SpecError::new(THETA_MIN.name, self.theta_min, allowed));
        }
        if self.aim_x.is_some() != self.aim_y.is_some() {
            let (name, missing) = if self.aim_x.is_some() {
                (AIM_Y.name, "a number, as aim_x is one")
            } else {
                (AIM_X.name, "a number, as aim_y is one")
            };
            return Err(SpecError::new(name, "none", missing));
        }
        if self.closed && self.aim_x.is_some() {
            let allowed = "false for a road that aims at a point";
            return Err(SpecError::new(CLOSED.name, true, allowed));
        }
        Ok(())
    }
}

/// A speed in m/s rounded down, so that the printed number is allowed.
fn rounded_down(speed: f64) -> f64 {
    (speed * 1e6 - 1e-3).floor() / 1e6
}

/// A segment of a road, as asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Prefab {
    /// Straight on.
    Straight,
    /// A turn to the left.
    Left,
    /// A turn to the right.
    Right,
    /// A turn to either side with equal probability.
    Turn,
}

/// How lengths are shared out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lengths {
    /// Every segment first gets the least length it needs, the rest is drawn.
    Reserve,
    /// All of the length is drawn, as published; turns may come out too short.
    AsPublished,
}

/// Which quantity of a turn is uniform between its limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TurnLaw {
    /// The radius, as published.
    UniformRadius,
    /// The angle.
    UniformAngle,
}

/// What happens when a road covers itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Crossing {
    /// Nothing.
    Allow,
    /// Generation fails.
    Reject,
    /// The road is drawn again, up to `attempts` times; also where it misses its requested end, its start
    /// or its area.
    Resample,
}

pub(super) const ALPHA_LIMITS: (f64, f64) = (1e-6, 1e12);
pub(super) const LENGTH: Setting = Setting::number("length", "m", 0.1, 1e6, "length");
const STEP: Setting =
    Setting::number("step", "m", 1e-3, 1e5, "distance between waypoints, at most the length");
const PREFABS: Setting = Setting::list(
    "prefabs",
    "",
    "straight, left, right or turn (to either side)",
    "the segments in travel order",
)
.such_as("straight,turn,straight");
const RANDOM: Setting = Setting::integer(
    "random",
    0,
    MAX_SEGMENTS as u64,
    "segments drawn at random instead of prefabs (0: use prefabs); the length must suffice for all of \
     them being turns",
);
const P_TURN: Setting =
    Setting::number("p_turn", "", 0.0, 1.0, "probability that a segment drawn at random is a turn");
pub(super) const ALPHA: Setting = Setting::other(
    "alpha",
    "",
    "a number from 1e-6 to 1e12, or a list with one per segment",
    "concentration of the Dirichlet law of the lengths",
)
.such_as("1,2,1,2,1");
const LENGTHS: Setting = Setting::choice(
    "lengths",
    &["reserve", "as_published"],
    "whether turns first get the length they need, or all length is drawn",
);
const SHORTEST: Setting =
    Setting::number("shortest", "m", 1e-3, 1e5, "least length of a segment, whatever the step");
const SPEED: Setting = Setting::number(
    "speed",
    "m/s",
    0.0,
    1000.0,
    "speed at which turns must be driveable (0: any radius)",
);
const FRICTION: Setting = Setting::number("friction", "", 0.01, 10.0, "coefficient of friction");
const THETA_MIN: Setting =
    Setting::number("theta_min", "degrees", 0.1, 350.0, "least angle of a turn");
const THETA_MAX: Setting =
    Setting::number("theta_max", "degrees", 0.1, 350.0, "greatest angle of a turn");
const MIN_RADIUS: Setting =
    Setting::number("min_radius", "m", 0.0, 1e5, "least radius, beside what speed and width ask");
const TURNS: Setting = Setting::choice(
    "turns",
    &["uniform_radius", "uniform_angle"],
    "which quantity of a turn is uniform between its limits",
);
const TRANSITION: Setting = Setting::number(
    "transition",
    "",
    0.0,
    0.5,
    "share of a turn's length that each of its two clothoids takes",
);
const WIDTH: Setting = Setting::number("width", "m", 0.1, 100.0, "full width");
const LANES: Setting = Setting::integer("lanes", 1, 16, "number of lanes");
const KERB: Setting = Setting::number("kerb", "m", 0.0, 0.9, "width of the kerbs (0: none)");
const START_X: Setting = Setting::number("start_x", "m", -1e6, 1e6, "x of the start");
const START_Y: Setting = Setting::number("start_y", "m", -1e6, 1e6, "y of the start");
const START_HEADING: Setting =
    Setting::number("start_heading", "degrees", -360.0, 360.0, "heading of the start");
const AIM_LIMIT: f64 = 1e6;
const AIM_X: Setting = aim(
    "aim_x",
    "x of the point to end at: the straights, and with them the road, become longer or shorter",
);
const AIM_Y: Setting = aim("aim_y", "y of the point to end at");
const CLOSED: Setting = Setting::flag("closed", "whether the road returns to its start");
const CROSSING: Setting = Setting::choice(
    "crossing",
    &["allow", "reject", "resample"],
    "what happens when the road covers itself",
);
const AREA: Setting = Setting::number(
    "area",
    "m",
    0.0,
    1e6,
    "side of the square from (0, 0) that the road must stay in (0: none)",
);
const ATTEMPTS: Setting = Setting::integer("attempts", 1, 10_000, "most attempts of resample");

const fn aim(name: &'static str, help: &'static str) -> Setting {
    Setting::other(name, "m", "a number from -1e6 to 1e6, or null for none", help)
}

const RULES: &[&str] = &[
    "`step` is at most the `length`, a third of it where `closed` is true, and there are at most \
     2,000,000 waypoints: `length` over `step`",
    "`prefabs` holds 1 to 4096 segments, where `random` is 0",
    "`alpha` is a number, or has one for each segment of `prefabs`, or of `random`",
    "`theta_min` is at most `theta_max`",
    "`aim_x` and `aim_y` are both numbers or both null, and null where `closed` is true",
    "`length` has room for the least lengths of all segments, which follow from `shortest`, \
     `theta_min`, `speed`, `friction`, `min_radius` and `width`, where `lengths` is reserve",
];

impl Spec for RoadSpec {
    type Blueprint = Road;

    const KIND: &'static str = "road";

    const VALUE_VERSION: u32 = 1;

    const SETTINGS: &'static [Setting] = &[
        LENGTH,
        STEP,
        PREFABS,
        RANDOM,
        P_TURN,
        ALPHA,
        LENGTHS,
        SHORTEST,
        SPEED,
        FRICTION,
        THETA_MIN,
        THETA_MAX,
        MIN_RADIUS,
        TURNS,
        TRANSITION,
        WIDTH,
        LANES,
        KERB,
        START_X,
        START_Y,
        START_HEADING,
        AIM_X,
        AIM_Y,
        CLOSED,
        CROSSING,
        AREA,
        ATTEMPTS,
    ];

    const RULES: &'static [&'static str] = RULES;

    fn validate(&self) -> Result<(), SpecError> {
        for (setting, value) in [
            (LENGTH, self.length),
            (STEP, self.step),
            (P_TURN, self.p_turn),
            (SHORTEST, self.shortest),
            (SPEED, self.speed),
            (FRICTION, self.friction),
            (THETA_MIN, self.theta_min),
            (THETA_MAX, self.theta_max),
            (MIN_RADIUS, self.min_radius),
            (TRANSITION, self.transition),
            (WIDTH, self.width),
            (KERB, self.kerb),
            (START_X, self.start_x),
            (START_Y, self.start_y),
            (START_HEADING, self.start_heading),
            (AREA, self.area),
        ] {
            setting.check(value)?;
        }
        RANDOM.check_integer(self.random)?;
        LANES.check_integer(self.lanes)?;
        ATTEMPTS.check_integer(self.attempts)?;
        for (setting, value) in [(AIM_X, self.aim_x), (AIM_Y, self.aim_y)] {
            if let Some(value) = value
                && !(-AIM_LIMIT..=AIM_LIMIT).contains(&value)
            {
                return Err(setting.error(value));
            }
        }
        self.check_together()?;
        self.check_reserve()
    }

    fn work(&self) -> f64 {
        self.length / self.step
    }

    fn generate(&self, seed: Seed) -> Result<Road, GenerateError> {
        self.validate()?;
        super::draw::road(self, seed, &RoadLaws::default())
    }
}
