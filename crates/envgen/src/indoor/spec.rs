//! The settings of an indoor map.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::adaptation;
use super::catalogue::{Catalogue, SharedRoom};
use super::generate::Stage;
use super::interior::Dimensions;
use super::laws::IndoorLaws;
use super::plan::FloorPlan;
use crate::error::{GenerateError, SpecError};
use crate::generate::Spec;
use crate::seed::Seed;
use crate::settings::Setting;

/// An indoor map to generate.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
///
/// let spec = IndoorSpec { difficulty: 7.0, ..Default::default() };
/// let plan = spec.generate(Seed(3))?;
/// assert_eq!(plan.access().parts(), 1);
/// assert!(plan.to_world().check().is_ok());
/// # Ok::<(), envgen::GenerateError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct IndoorSpec {
    /// The difficulty that the rules adapt to, from 0 to 10.
    pub difficulty: f64,
    /// Columns of the grid.
    pub width: u32,
    /// Rows of the grid.
    pub height: u32,
    /// Side of a cell in metres.
    pub unit: f64,
    /// Exactly as in the paper, or with every place reachable.
    pub profile: Profile,
    /// How the hallways are laid out.
    pub layout: Layout,
    /// Probability of a branch at each end of an L-system's hallway, and of a loop where it meets
    /// another.
    pub branching: f64,
    /// Names of the rooms that may be placed; empty for all of the catalogue.
    pub rooms: Vec<String>,
    /// The available rooms; the built-in ones when absent.
    pub catalogue: Option<Catalogue>,
    /// How rooms are chosen.
    pub room_choice: RoomChoice,
    /// Whether rooms that are not square may be turned by a quarter.
    pub turn: Turn,
    /// Distance between vertical hallways in cells; drawn from the difficulty when absent.
    pub spacing_h: Option<u32>,
    /// Distance between horizontal hallways in cells; drawn from the difficulty when absent.
    pub spacing_v: Option<u32>,
    /// Probability of a doorway in a side of a room; it follows from the difficulty when absent.
    pub doorway_probability: Option<f64>,
    /// Whether hallway cycles are prevented.
    pub cycles: Cycles,
    /// Whether the remaining cells become open areas; they are solid otherwise.
    pub open_areas: bool,
    /// Thickness of the walls in metres.
    pub wall: f64,
    /// Width of a doorway in metres.
    pub doorway: f64,
    /// Radius in metres of the robot that must reach every place.
    pub footprint: f64,
    /// Width in metres that the narrowest passage through each room should have: contents are moved,
    /// turned, removed or doubled. Rooms stay as designed when absent.
    pub clearance: Option<f64>,
}

impl Default for IndoorSpec {
    fn default() -> Self {
        IndoorSpec {
            difficulty: 5.0,
            width: 16,
            height: 16,
            unit: 3.0,
            profile: Profile::Guaranteed,
            layout: Layout::Grid,
            branching: 0.5,
            rooms: Vec::new(),
            catalogue: None,
            room_choice: RoomChoice::Difficulty,
            turn: Turn::Profile,
            spacing_h: None,
            spacing_v: None,
            doorway_probability: None,
            cycles: Cycles::Difficulty,
            open_areas: true,
            wall: 0.1,
            doorway: 0.94,
            footprint: 0.36,
            clearance: None,
        }
    }
}

/// How closely the rules follow the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Profile {
    /// Exactly as in the paper, flaws included: rooms may be closed, contents may block a doorway.
    Thesis,
    /// Every place can be reached by the footprint.
    Guaranteed,
}

/// How the hallways are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Layout {
    /// Parallel hallways a fixed distance apart in either direction, as in the paper.
    Grid,
    /// A net that branches, grown by an L-system.
    LSystem,
}

/// How rooms are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RoomChoice {
    /// By how near their difficulty is.
    Difficulty,
    /// All with equal probability, as in the original World Generator.
    Uniform,
}

/// Whether rooms that are not square may be turned by a quarter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Turn {
    /// Not in the profile `thesis`, allowed in `guaranteed`.
    Profile,
    /// Never.
    Never,
    /// Allowed: turned or not with equal probability.
    Allowed,
}

/// Whether hallway cycles are prevented.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cycles {
    /// Drawn from the difficulty.
    Difficulty,
    /// Never.
    Allow,
    /// Always.
    Prevent,
}

const DIFFICULTY: Setting =
    Setting::number("difficulty", "", 0.0, 10.0, "the difficulty that the rules adapt to");
const WIDTH: Setting = Setting::integer("width", 4, 1024, "columns of the grid");
const HEIGHT: Setting = Setting::integer("height", 4, 1024, "rows of the grid");
pub(super) const UNIT: Setting = Setting::number("unit", "m", 1.2, 12.0, "side of a cell");
const PROFILE: Setting = Setting::choice(
    "profile",
    &["thesis", "guaranteed"],
    "exactly as in the paper, or with every place reachable",
);
const LAYOUT: Setting =
    Setting::choice("layout", &["grid", "l_system"], "how the hallways are laid out");
const BRANCHING: Setting = Setting::number(
    "branching",
    "",
    0.0,
    1.0,
    "probability of a branch at each end of an L-system's hallway, and of a loop where two meet",
);
const ROOMS: Setting = Setting::list(
    "rooms",
    "",
    "names of rooms, empty for all",
    "the rooms of the catalogue that may be placed",
)
.such_as("warehouse,maze");
const CATALOGUE: Setting = Setting::other(
    "catalogue",
    "",
    "a list of rooms as in *.room.ron files, or null for the built-in 20",
    "the available rooms",
)
.such_as(r#"[{"name": "vault", "width": 1, "height": 1, "difficulty": 3}]"#);
const ROOM_CHOICE: Setting =
    Setting::choice("room_choice", &["difficulty", "uniform"], "how rooms are chosen");
const TURN: Setting = Setting::choice(
    "turn",
    &["profile", "never", "allowed"],
    "whether rooms that are not square may be turned by a quarter",
);
const SPACING: &str =
    "a whole number from 3 to the map's size less one, or null to follow from the difficulty";
const SPACING_H: Setting =
    Setting::other("spacing_h", "cells", SPACING, "distance between vertical hallways");
const SPACING_V: Setting =
    Setting::other("spacing_v", "cells", SPACING, "distance between horizontal hallways");
const DOORWAY_PROBABILITY: Setting = Setting::other(
    "doorway_probability",
    "",
    "a number from 0 to 1, or null to follow from the difficulty",
    "probability of a doorway in a side of a room",
);
const CYCLES: Setting = Setting::choice(
    "cycles",
    &["difficulty", "allow", "prevent"],
    "whether hallway cycles are prevented",
);
const OPEN_AREAS: Setting =
    Setting::flag("open_areas", "whether the remaining cells become open areas");
pub(super) const WALL: Setting = Setting::number("wall", "m", 0.01, 0.5, "thickness of the walls");
pub(super) const DOORWAY: Setting =
    Setting::number("doorway", "m", 0.2, 3.0, "width of a doorway, at most a cell less two walls");
pub(super) const FOOTPRINT: Setting = Setting::number(
    "footprint",
    "m",
    0.01,
    1.4,
    "radius of the robot that must reach every place, at most half a doorway less 0.05 m",
);
const CLEARANCE: Setting = Setting::other(
    "clearance",
    "m",
    "a number from 0 to 2, or null to leave rooms as designed",
    "width that the narrowest passage through each room should have",
);

const RULES: &[&str] = &[
    "`open_areas` is true, where `profile` is guaranteed",
    "`spacing_h` is under the `width`, `spacing_v` under the `height`",
    "`doorway` is at most the `unit` less two times `wall`",
    "`footprint` is at most half the `doorway` less 0.05 m",
    "one of the `rooms` fits into `width` - 1 by `height` - 1 cells; turned as well, as `turn` says",
    "`rooms` are names of the `catalogue`",
];

impl Spec for IndoorSpec {
    type Blueprint = FloorPlan;

    const KIND: &'static str = "indoor";

    const VALUE_VERSION: u32 = 2;

    const SETTINGS: &'static [Setting] = &[
        DIFFICULTY,
        WIDTH,
        HEIGHT,
        UNIT,
        PROFILE,
        LAYOUT,
        BRANCHING,
        ROOMS,
        CATALOGUE,
        ROOM_CHOICE,
        TURN,
        SPACING_H,
        SPACING_V,
        DOORWAY_PROBABILITY,
        CYCLES,
        OPEN_AREAS,
        WALL,
        DOORWAY,
        FOOTPRINT,
        CLEARANCE,
    ];

    const RULES: &'static [&'static str] = RULES;

    fn validate(&self) -> Result<(), SpecError> {
        DIFFICULTY.check(self.difficulty)?;
        WIDTH.check_integer(self.width.into())?;
        HEIGHT.check_integer(self.height.into())?;
        BRANCHING.check(self.branching)?;
        self.check_metres()?;
        for (setting, spacing, size) in
            [(SPACING_H, self.spacing_h, self.width), (SPACING_V, self.spacing_v, self.height)]
        {
            if let Some(spacing) = spacing
                && !(adaptation::LEAST_SPACING..size).contains(&spacing)
            {
                let allowed = format!("a whole number from 3 to {}, or null", size - 1);
                return Err(SpecError::new(setting.name, spacing, allowed));
            }
        }
        for (setting, value, most) in
            [(DOORWAY_PROBABILITY, self.doorway_probability, 1.0), (CLEARANCE, self.clearance, 2.0)]
        {
            if let Some(value) = value
                && !(0.0..=most).contains(&value)
            {
                return Err(setting.error(value));
            }
        }
        if !self.open_areas && self.profile == Profile::Guaranteed {
            let allowed = "true in the profile guaranteed, which reaches every room";
            return Err(SpecError::new("open_areas", false, allowed));
        }
        self.check_rooms()
    }

    fn work(&self) -> f64 {
        // Moving the contents of a room measures it many times.
        let a_cell = if self.clearance.is_some() { 1000.0 } else { 1.0 };
        f64::from(self.width) * f64::from(self.height) * a_cell
    }

    fn generate(&self, seed: Seed) -> Result<FloorPlan, GenerateError> {
        self.generate_observed(seed, &mut |_| ())
    }
}

impl IndoorSpec {
    /// Generates a plan as [`Spec::generate`] does, and calls `after` after every stage: for clocks
    /// and progress bars, which this crate does not have.
    ///
    /// # Errors
    /// As [`Spec::generate`].
    pub fn generate_observed(
        &self,
        seed: Seed,
        after: &mut dyn FnMut(Stage),
    ) -> Result<FloorPlan, GenerateError> {
        self.validate()?;
        Ok(super::generate::plan(self, seed, &IndoorLaws::default(), after)?)
    }

    /// The catalogue: the spec's own, or the built-in one.
    pub fn catalogue(&self) -> &Catalogue {
        self.catalogue.as_ref().unwrap_or(Catalogue::builtin())
    }

    /// The rooms that may be placed, in the catalogue's order.
    pub fn allowed_rooms(&self) -> Vec<SharedRoom> {
        let allowed = |room: &&SharedRoom| self.rooms.is_empty() || self.rooms.contains(&room.name);
        self.catalogue().rooms().iter().filter(allowed).cloned().collect()
    }

    /// The probability of each of [`IndoorSpec::allowed_rooms`] to be drawn.
    pub fn room_probabilities(&self) -> Vec<f64> {
        let rooms = self.allowed_rooms();
        match self.room_choice {
            RoomChoice::Uniform => vec![1.0 / rooms.len() as f64; rooms.len()],
            RoomChoice::Difficulty => {
                let difficulties: Vec<f64> = rooms.iter().map(|room| room.difficulty).collect();
                adaptation::room_probabilities(self.difficulty, &difficulties)
            }
        }
    }

    /// The dimensions that decide where a robot can go.
    pub fn dimensions(&self) -> Dimensions {
        Dimensions {
            unit: self.unit,
            wall: self.wall,
            doorway: self.doorway,
            radius: self.footprint,
        }
    }

    pub(super) fn may_turn(&self) -> bool {
        match self.turn {
            Turn::Profile => self.profile == Profile::Guaranteed,
            Turn::Never => false,
            Turn::Allowed => true,
        }
    }

    fn check_metres(&self) -> Result<(), SpecError> {
        UNIT.check(self.unit)?;
        WALL.check(self.wall)?;
        DOORWAY.check(self.doorway)?;
        FOOTPRINT.check(self.footprint)?;
        let widest = to_nanometres(self.unit - 2.0 * self.wall);
        if self.doorway > widest {
            let allowed = format!("at most {widest} m, what a cell has between its walls");
            return Err(SpecError::new("doorway", self.doorway, allowed));
        }
        let largest = to_nanometres(0.5 * self.doorway - super::interior::STEP);
        if self.footprint > largest {
            let allowed =
                format!("at most {largest} m: it must pass a doorway of {} m", self.doorway);
            return Err(SpecError::new("footprint", self.footprint, allowed));
        }
        Ok(())
    }

    fn check_rooms(&self) -> Result<(), SpecError> {
        let catalogue = self.catalogue();
        let known: BTreeSet<&str> =
            catalogue.rooms().iter().map(|room| room.name.as_str()).collect();
        if let Some(name) = self.rooms.iter().find(|name| !known.contains(name.as_str())) {
            let known: Vec<_> = known.into_iter().collect();
            return Err(SpecError::new("rooms", name, format!("any of {}", known.join(", "))));
        }
        let (columns, rows) = (self.width - 1, self.height - 1);
        let fits = |room: &SharedRoom| {
            let fits = |width, height| width <= columns && height <= rows;
            fits(room.width, room.height) || (self.may_turn() && fits(room.height, room.width))
        };
        if self.allowed_rooms().iter().any(fits) {
            return Ok(());
        }
        let names: Vec<_> = self.allowed_rooms().iter().map(|room| room.name.clone()).collect();
        let allowed = format!(
            "a choice with a room of at most {columns} by {rows} cells: the first row and column \
             are hallways"
        );
        Err(SpecError::new("rooms", names.join(", "), allowed))
    }
}

/// Rounded, so that the rounding of a difference does not refuse a value that is exactly allowed.
fn to_nanometres(metres: f64) -> f64 {
    (metres * 1e9).round() / 1e9
}
