//! The settings of an indoor map.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use strum::VariantNames;

use super::adaptation::{self, LEAST_SPACING};
use super::catalogue::{Catalogue, SharedRoom};
use super::dimensions::{Dimensions, STEP};
use crate::difficulty::Platform;
use crate::error::SpecError;
use crate::settings;
use crate::world::{DOORWAY, WALL, is_zero};

/// The greatest number of cells of maps in the profile `calibrated`. Larger maps were not measured.
const MAX_CALIBRATED_CELLS: u64 = 4096;

/// The settings that the profile `calibrated` draws.
pub(super) const LEVERS: [&str; 22] = [
    "difficulty",
    "layout",
    "branching",
    "rooms",
    "room_choice",
    "spacing_h",
    "spacing_v",
    "doorway_probability",
    "cycles",
    "doorway",
    "doorway_narrowest",
    "mazes",
    "maze_passage",
    "maze_braid",
    "clutter",
    "floor_slip",
    "floor_slip_share",
    "wheel_bias",
    "wheel_bias_share",
    "dark_walls",
    "dark_objects",
    "dark_range",
];

/// The default of [`IndoorSpec::dark_range`] in metres.
const DARK_RANGE: f64 = 3.0;

/// The greatest number of parts in rooms, and of squares of mazes, that a map may have.
const MAX_CONTENTS: f64 = 1e8;

/// The default width of the doorways in metres.
const DOORWAY_WIDTH: f64 = 0.94;

/// The greatest width of doorways in metres.
pub(super) const MOST_DOORWAY: f64 = 3.0;

/// The least difference in metres between the widest doorway that is drawn and the narrowest doorway for the robot.
/// Both are rounded to centimetres and must differ.
const DOORWAY_CHOICE: f64 = 0.03;

/// The default width of the passages of mazes in metres.
const MAZE_PASSAGE: f64 = 1.4;

// Settings of materials, clutter and doorway widths are written where they are set, so that the files of
// other maps stay as they were before these existed.
fn is_one(value: &f64) -> bool {
    *value == 1.0
}

fn is_first(value: &u32) -> bool {
    *value == 0
}

fn is_maze_passage(value: &f64) -> bool {
    *value == MAZE_PASSAGE
}

fn is_wall_height(value: &f64) -> bool {
    *value == WALL.top()
}

fn is_doorway_height(value: &f64) -> bool {
    *value == DOORWAY.top()
}

fn is_dark_range(value: &f64) -> bool {
    *value == DARK_RANGE
}

settings! {
    /// The settings of an indoor map.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
    ///
    /// let spec = IndoorSpec { difficulty: 7.0, ..Default::default() };
    /// let plan = spec.generate(Seed(3))?;
    /// assert_eq!(plan.access().parts(), 1);
    /// assert!(plan.to_world().check().is_ok());
    /// # Ok::<(), envgen::indoor::IndoorError>(())
    /// ```
    pub struct IndoorSpec {
        /// The difficulty that the rules adapt to; in the profile `calibrated` the one that trials are predicted to
        /// measure.
        difficulty: f64 = 5.0 => number("", 0.0..=10.0);
        /// Number of columns of the grid; a cell has the side `cell_size`.
        width: u32 = 16 => integer("", 4..=1024);
        /// Number of rows of the grid.
        height: u32 = 16 => integer("", 4..=1024);
        /// Side of a cell.
        #[alias = "unit"]
        #[group = "layout"]
        cell_size: f64 = 3.0 => number("m", 1.2..=12.0);
        /// What a map follows: `thesis` the paper's rules exactly; `guaranteed` these rules, with every place
        /// reachable; `calibrated` the difficulty that trials measure, also with every place reachable.
        #[group = ""]
        profile: Profile = Profile::Guaranteed => choice;
        /// How the hallways are laid out.
        #[group = "layout"]
        layout: Layout = Layout::Grid => choice;
        /// Probability of a branch at each end of an L-system's hallway, and of a loop where it meets
        /// another.
        branching: f64 = 0.5 => number("", 0.0..=1.0);
        /// The rooms of the catalogue that may be placed; empty for all.
        rooms: Vec<String> = Vec::new() => list("", "names of rooms, empty for all", "warehouse,maze");
        /// The available rooms, none for the built-in 20.
        catalogue: Option<Catalogue> = None => optional_other(
            "",
            "a list of rooms as in *.room.ron files",
            r#"[{"name": "vault", "width": 1, "height": 1, "difficulty": 3}]"#
        );
        /// How rooms are chosen.
        room_choice: RoomChoice = RoomChoice::Difficulty => choice;
        /// Whether rooms that are not square may be turned by a quarter.
        turn: Turn = Turn::Profile => choice;
        /// Distance between vertical hallways, less than the width; none follows from the difficulty.
        spacing_h: Option<u32> = None => optional_integer("cells", 3..=1023);
        /// Distance between horizontal hallways, less than the height; none follows from the difficulty.
        spacing_v: Option<u32> = None => optional_integer("cells", 3..=1023);
        /// Probability of a doorway in a side of a room; none follows from the difficulty.
        doorway_probability: Option<f64> = None => optional_number("", 0.0..=1.0);
        /// Whether hallway cycles are prevented.
        cycles: Cycles = Cycles::Difficulty => choice;
        /// Whether the remaining cells become open areas; they are solid otherwise.
        open_areas: bool = true => flag;
        /// Thickness of the walls.
        #[alias = "wall"]
        #[group = "walls and doorways"]
        wall_thickness: f64 = 0.1 => number("m", 0.01..=0.5);
        /// Height of the walls and ceilings.
        #[serde(skip_serializing_if = "is_wall_height")]
        wall_height: f64 = WALL.top() => number("m", 0.05..=100.0);
        /// Clear height of the doorways: the walls above them are lintels.
        #[serde(skip_serializing_if = "is_doorway_height")]
        doorway_height: f64 = DOORWAY.top() => number("m", 0.05..=100.0);
        /// Width of a doorway, at most a cell less two walls.
        doorway: f64 = DOORWAY_WIDTH => number("m", 0.2..=MOST_DOORWAY);
        /// Radius of the robot that must reach every place, at most half a doorway less 0.05 m; doorways that the
        /// profile `calibrated` draws are wide enough.
        #[alias = "footprint"]
        robot_radius: f64 = 0.36 => number("m", 0.01..=1.4);
        /// Width that the narrowest passage through each room should have: contents are moved, turned,
        /// removed or doubled; none leaves rooms as designed.
        #[group = "contents of rooms"]
        clearance: Option<f64> = None => optional_number("m", 0.0..=2.0);
        /// Crates at random places of the floors, as far as they fit: robots pass on every side of them, with
        /// the `clearance` where it is larger than a robot.
        #[serde(skip_serializing_if = "is_zero")]
        clutter: f64 = 0.0 => number("per 100 m^2", 0.0..=30.0);
        /// Share of the rooms, by area, that hold a maze in place of their contents, where two passages fit into
        /// either side.
        #[serde(skip_serializing_if = "is_zero")]
        mazes: f64 = 0.0 => number("", 0.0..=1.0);
        /// Least width of the passages of mazes, at least twice the `robot_radius` plus 0.1 m.
        #[serde(skip_serializing_if = "is_maze_passage")]
        maze_passage: f64 = MAZE_PASSAGE => number("m", 0.12..=6.0);
        /// Share of the dead ends of mazes that are opened: 0 for one path between any two places, 1 for no
        /// dead ends.
        #[serde(skip_serializing_if = "is_zero")]
        maze_braid: f64 = 0.0 => number("", 0.0..=1.0);
        /// Width of the narrowest doorways, from which widths up to `doorway` are drawn; none for all of
        /// one width.
        #[group = "walls and doorways"]
        #[serde(skip_serializing_if = "Option::is_none")]
        doorway_narrowest: Option<f64> = None => optional_number("m", 0.2..=3.0);
        /// Factor on the variances of wheel odometry on slippery floor; 1 for none.
        #[group = "floors and materials"]
        #[serde(skip_serializing_if = "is_one")]
        floor_slip: f64 = 1.0 => number("", 1.0..=25.0);
        /// Share of the floor that is slippery, where `floor_slip` says how much.
        #[serde(skip_serializing_if = "is_one")]
        floor_slip_share: f64 = 1.0 => number("", 0.0..=1.0);
        /// How much too far wheels measure on loose floor, as a fraction of the distance; 0 for none.
        #[serde(skip_serializing_if = "is_zero")]
        wheel_bias: f64 = 0.0 => number("", 0.0..=0.35);
        /// Share of the floor that is loose, where `wheel_bias` says how much.
        #[serde(skip_serializing_if = "is_one")]
        wheel_bias_share: f64 = 1.0 => number("", 0.0..=1.0);
        /// Share of the walls, by their length, that lasers see only within the `dark_range`.
        #[serde(skip_serializing_if = "is_zero")]
        dark_walls: f64 = 0.0 => number("", 0.0..=1.0);
        /// Share of the objects in rooms that lasers see only within the `dark_range`.
        #[serde(skip_serializing_if = "is_zero")]
        dark_objects: f64 = 0.0 => number("", 0.0..=1.0);
        /// Distance beyond which a laser has no echo from a dark wall or object.
        #[serde(skip_serializing_if = "is_dark_range")]
        dark_range: f64 = DARK_RANGE => number("m", 1.0..=10.0);
        /// How hard mapping should be in the profile `calibrated`, in place of `difficulty`.
        #[group = ""]
        #[serde(skip_serializing_if = "Option::is_none")]
        mapping: Option<f64> = None => optional_number("", 0.0..=10.0);
        /// How hard navigation should be in the profile `calibrated`, in place of `difficulty`.
        #[serde(skip_serializing_if = "Option::is_none")]
        navigation: Option<f64> = None => optional_number("", 0.0..=10.0);
        /// The settings that the profile `calibrated` leaves at their defaults; it draws others that are at
        /// theirs.
        #[group = "choice of the map"]
        #[serde(skip_serializing_if = "Vec::is_empty")]
        fixed: Vec<String> = Vec::new() => list("", "names of settings", "floor_slip,doorway");
        /// Which map the profile `calibrated` takes: 0 for the one that is predicted nearest, 1 for the next.
        #[serde(skip_serializing_if = "is_first")]
        candidate: u32 = 0 => integer("", 0..=7);
    }
}

/// How closely the rules follow the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Profile {
    /// Exactly as in the paper, flaws included: rooms may be closed, and contents may block a doorway.
    Thesis,
    /// A robot of the spec's footprint can reach every place.
    Guaranteed,
    /// As `guaranteed`, with the requested difficulty on the scale that trials measure. Doorways, rooms, mazes,
    /// clutter, floors and materials are drawn.
    Calibrated,
}

/// The layout of the hallways.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Layout {
    /// Parallel hallways at a fixed distance in either direction, as in the paper.
    Grid,
    /// A branching network, grown by an L-system.
    LSystem,
}

/// How rooms are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum RoomChoice {
    /// By how near their difficulty is to that of the map.
    Difficulty,
    /// All rooms with equal probability, as in the original World Generator.
    Uniform,
}

/// Whether rooms that are not square may be turned by a quarter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Turn {
    /// Not in the profile `thesis`; allowed in the others.
    Profile,
    /// Never.
    Never,
    /// Allowed: turned or not with equal probability.
    Allowed,
}

/// Whether hallway cycles are prevented.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Cycles {
    /// Drawn with a probability that follows from the difficulty.
    Difficulty,
    /// Cycles are never prevented.
    Allow,
    /// Cycles are always prevented.
    Prevent,
}

pub(super) const RULES: &[&str] = &[
    "`open_areas` is true, where `profile` is guaranteed or calibrated",
    "`spacing_h` is under the `width`, `spacing_v` under the `height`",
    "`doorway` is at most the `cell_size` less two times `wall_thickness`",
    "`robot_radius` is at most half the `doorway` less 0.05 m; where `profile` is calibrated and draws the \
     `doorway`, half of what a cell has between its walls, or of 3 m, less 0.065 m",
    "`maze_passage` is at least twice the `robot_radius` plus 0.1 m",
    "`doorway_narrowest` is at most the `doorway`, and at least twice the `robot_radius` plus 0.1 m",
    "one of the `rooms` fits into `width` - 1 by `height` - 1 cells; turned as well, as `turn` says",
    "`rooms` are names of the `catalogue`",
    "`mapping`, `navigation`, `fixed` and `candidate` need the `profile` calibrated",
    "where `profile` is calibrated, the map has at most 4096 cells, `robot_radius` is at least 0.36 m, and the \
     request is within what maps of this size reach",
];

impl IndoorSpec {
    /// Checks every field, and the rules about several fields.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        self.check_fields()?;
        self.check_metres()?;
        for (name, spacing, size) in
            [("spacing_h", self.spacing_h, self.width), ("spacing_v", self.spacing_v, self.height)]
        {
            if let Some(spacing) = spacing.filter(|spacing| *spacing >= size) {
                let allowed =
                    format!("a whole number from {LEAST_SPACING} to {}, or none", size - 1);
                return Err(SpecError::new(name, spacing, allowed));
            }
        }
        if !self.open_areas && self.profile != Profile::Thesis {
            let allowed = "true in the profiles that reach every room";
            return Err(SpecError::new("open_areas", false, allowed));
        }
        self.check_request()?;
        self.check_rooms()?;
        self.check_contents()
    }

    /// Checks that there are not too many mazes and contents of rooms.
    fn check_contents(&self) -> Result<(), SpecError> {
        let cells = f64::from(self.width) * f64::from(self.height);
        if cells * self.maze_squares() > MAX_CONTENTS {
            let allowed = format!("large enough for at most {MAX_CONTENTS} squares of mazes");
            return Err(SpecError::new("maze_passage", self.maze_passage, allowed));
        }
        let parts = cells * self.most_contents();
        if parts > MAX_CONTENTS {
            let allowed =
                format!("so small that rooms have at most {MAX_CONTENTS} parts, not {parts:.0}");
            return Err(SpecError::new("width", self.width, allowed));
        }
        Ok(())
    }

    /// Returns the mean number of squares of mazes per cell.
    pub(super) fn maze_squares(&self) -> f64 {
        let side = self.cell_size / (self.maze_passage + self.wall_thickness);
        self.mazes * side * side
    }

    /// Returns the greatest number of parts per cell of the rooms that may be placed.
    pub(super) fn most_contents(&self) -> f64 {
        let parts = |room: &SharedRoom| {
            let parts = room.walls.len() + room.obstacles.len() + room.surfaces.len();
            parts as f64 / (f64::from(room.width) * f64::from(room.height))
        };
        let allowed = |room: &&SharedRoom| self.rooms.is_empty() || self.rooms.contains(&room.name);
        self.catalogue().rooms().iter().filter(allowed).map(parts).fold(0.0, f64::max)
    }

    /// Returns the catalogue: the spec's own, or the built-in one.
    pub fn catalogue(&self) -> &Catalogue {
        self.catalogue.as_ref().unwrap_or(Catalogue::builtin())
    }

    /// Returns the rooms that may be placed, in the order of the catalogue.
    pub fn allowed_rooms(&self) -> Vec<SharedRoom> {
        let allowed = |room: &&SharedRoom| self.rooms.is_empty() || self.rooms.contains(&room.name);
        self.catalogue().rooms().iter().filter(allowed).cloned().collect()
    }

    /// Returns the probability of each of [`IndoorSpec::allowed_rooms`] to be drawn.
    ///
    /// ```
    /// use envgen::indoor::IndoorSpec;
    ///
    /// // The more difficult the map, the more difficult the rooms that are likely.
    /// let mean = |difficulty: f64| {
    ///     let spec = IndoorSpec { difficulty, ..Default::default() };
    ///     let rooms = spec.allowed_rooms().into_iter().zip(spec.room_probabilities());
    ///     rooms.map(|(room, p)| p * room.difficulty).sum::<f64>()
    /// };
    /// assert!(mean(9.0) > mean(1.0) + 1.0);
    /// ```
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

    /// Returns the dimensions that determine where a robot can go.
    pub fn dimensions(&self) -> Dimensions {
        Dimensions {
            unit: self.cell_size,
            wall: self.wall_thickness,
            doorway: self.doorway,
            radius: self.robot_radius,
        }
    }

    pub(super) fn may_turn(&self) -> bool {
        match self.turn {
            Turn::Profile => self.profile != Profile::Thesis,
            Turn::Never => false,
            Turn::Allowed => true,
        }
    }

    /// Checks the settings that only the profile `calibrated` has.
    fn check_request(&self) -> Result<(), SpecError> {
        // The difficulty is what is asked for, or drawn for other dials.
        let fixable = || LEVERS.into_iter().filter(|name| *name != "difficulty");
        for name in &self.fixed {
            if !fixable().any(|fixable| fixable == name) {
                let allowed = format!("any of {}", fixable().collect::<Vec<_>>().join(", "));
                return Err(SpecError::new("fixed", name, allowed));
            }
        }
        if self.profile == Profile::Calibrated {
            return self.check_calibrated();
        }
        let set = [
            ("mapping", self.mapping.is_some()),
            ("navigation", self.navigation.is_some()),
            ("fixed", !self.fixed.is_empty()),
            ("candidate", self.candidate != 0),
        ];
        match set.into_iter().find(|(_, is_set)| *is_set) {
            None => Ok(()),
            Some((name, _)) => {
                let value = self.settings_json()[name].to_string();
                Err(SpecError::new(name, value, "absent, except in the profile calibrated"))
            }
        }
    }

    /// Checks whether the profile `calibrated` is possible for the spec's size and robot.
    fn check_calibrated(&self) -> Result<(), SpecError> {
        let cells = u64::from(self.width) * u64::from(self.height);
        if cells > MAX_CALIBRATED_CELLS {
            let allowed = format!(
                "at most {} where the height is {}: the profile calibrated has maps of up to \
                 {MAX_CALIBRATED_CELLS} cells",
                MAX_CALIBRATED_CELLS / u64::from(self.height),
                self.height
            );
            return Err(SpecError::new("width", self.width, allowed));
        }
        let least = Platform::default().footprint();
        if self.robot_radius < least {
            let allowed =
                format!("at least {least} m, the robot for which the profile calibrated predicts");
            return Err(SpecError::new("robot_radius", self.robot_radius, allowed));
        }
        Ok(())
    }

    /// Whether the profile `calibrated` draws the width of the doorways, and thus fits it to the robot.
    fn draws_doorway(&self) -> bool {
        let is_kept =
            self.doorway != DOORWAY_WIDTH || self.fixed.iter().any(|one| one == "doorway");
        self.profile == Profile::Calibrated && !is_kept
    }

    /// Checks the settings in metres against each other.
    pub(super) fn check_metres(&self) -> Result<(), SpecError> {
        let widest = to_nanometres(self.cell_size - 2.0 * self.wall_thickness);
        if self.doorway > widest {
            let allowed = format!("at most {widest} m, what a cell has between its walls");
            return Err(SpecError::new("doorway", self.doorway, allowed));
        }
        let doorway = match self.draws_doorway() {
            true => to_nanometres(widest.min(MOST_DOORWAY) - DOORWAY_CHOICE).max(self.doorway),
            false => self.doorway,
        };
        let largest = to_nanometres(0.5 * doorway - STEP);
        if self.robot_radius > largest {
            let allowed = format!("at most {largest} m: it must pass a doorway of {doorway} m");
            return Err(SpecError::new("robot_radius", self.robot_radius, allowed));
        }
        let least = to_nanometres(2.0 * (self.robot_radius + STEP));
        if self.mazes > 0.0 && self.maze_passage < least {
            let allowed = format!("at least {least} m, which the robot passes");
            return Err(SpecError::new("maze_passage", self.maze_passage, allowed));
        }
        if let Some(narrowest) = self.doorway_narrowest
            && !(least..=doorway).contains(&narrowest)
        {
            let allowed = format!(
                "from {least} m, which the robot passes, to the doorway of {doorway} m, or none"
            );
            return Err(SpecError::new("doorway_narrowest", narrowest, allowed));
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

impl Dimensions {
    /// Checks the dimensions against the limits of the settings of an [`IndoorSpec`]. The radius may be 0.
    ///
    /// # Errors
    /// Names the first dimension that is not allowed.
    pub fn validate(&self) -> Result<(), SpecError> {
        const { IndoorSpec::setting("cell_size") }.check(self.unit)?;
        const { IndoorSpec::setting("wall_thickness") }.check(self.wall)?;
        const { IndoorSpec::setting("doorway") }.check(self.doorway)?;
        match self.radius {
            0.0 => Ok(()),
            radius => const { IndoorSpec::setting("robot_radius") }.check(radius),
        }
    }
}

/// Rounds to nanometres, so that the rounding of a difference does not cause an exactly allowed value to be refused.
fn to_nanometres(metres: f64) -> f64 {
    (metres * 1e9).round() / 1e9
}
