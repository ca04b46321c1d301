//! The settings of a hallway.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use strum::VariantNames;

use super::state::State;
use crate::error::SpecError;
use crate::settings;
use crate::world::{MAX_COORDINATE, WALL};

/// Sums of rates may be this much above one per segment, which allows only for rounding.
const ROUNDING: f64 = 1e-9;

/// Whether the height is the default, which files omit, so that the files of other hallways are the same as before
/// the setting existed.
fn is_wall_height(value: &f64) -> bool {
    *value == WALL.top()
}

settings! {
    /// The settings of a hallway.
    ///
    /// The defaults are those of the paper's figure 1: `p_st` = 0.4 and `p_tt` = 0.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
    ///
    /// let spec = HallwaySpec { segments: 80, p_st: 0.2, ..Default::default() };
    /// let hallway = spec.generate(Seed(7))?;
    /// assert_eq!(hallway.states().len(), 80);
    /// assert!(hallway.to_world().check().is_ok());
    /// # Ok::<(), envgen::SpecError>(())
    /// ```
    pub struct HallwaySpec {
        /// Number of segments, the start included.
        segments: u64 = 50 => integer("", 1..=1_000_000);
        /// Probability that a turn follows a straight segment.
        p_st: f64 = 0.4 => number("", 0.0..=1.0);
        /// Probability that a turn follows a turn; 0 prevents U-turns.
        p_tt: f64 = 0.0 => number("", 0.0..=1.0);
        /// The first state.
        #[group = "corridor"]
        start: Start = Start::State(State::UP) => other("", "a state 1 to 8 or stationary");
        /// Side of the lattice cell that each segment owns.
        pitch: f64 = 2.5 => number("m", 0.1..=1000.0);
        /// Clear width of the corridor.
        #[group = ""]
        width: f64 = 2.0 => number("m", 0.05..=1000.0);
        /// Thickness of the walls.
        #[alias = "wall"]
        #[group = "walls"]
        wall_thickness: f64 = 0.1 => number("m", 0.001..=100.0);
        /// Height of the walls.
        #[serde(skip_serializing_if = "is_wall_height")]
        wall_height: f64 = WALL.top() => number("m", 0.05..=100.0);
        /// How the walls turn.
        corners: Corners = Corners::Square => choice;
        /// Whether walls close the corridor's two ends.
        ends: Ends = Ends::Closed => choice;
        /// Alcoves per metre of straight corridor.
        #[group = "alcoves, frames and crates"]
        alcove_rate: f64 = 0.0 => number("1/m", 0.0..=10.0);
        /// Width of an alcove along the corridor.
        alcove_width: f64 = 1.2 => number("m", 0.01..=1000.0);
        /// Depth of an alcove behind the wall's inner face.
        alcove_depth: f64 = 0.6 => number("m", 0.01..=1000.0);
        /// Door frames per metre of straight corridor.
        door_frame_rate: f64 = 0.0 => number("1/m", 0.0..=10.0);
        /// Clear width between the posts of a door frame.
        door_frame_width: f64 = 0.94 => number("m", 0.01..=1000.0);
        /// Narrow places per metre of straight corridor, each a crate at one wall.
        narrowing_rate: f64 = 0.0 => number("1/m", 0.0..=10.0);
        /// Clear width beside a crate.
        narrowing_width: f64 = 1.0 => number("m", 0.01..=1000.0);
    }
}

/// The first state of a hallway: 1 to 8, or `stationary`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// A given state.
    State(State),
    /// A state drawn from the stationary distribution.
    Stationary,
}

impl Serialize for Start {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Start::State(state) => state.serialize(serializer),
            Start::Stationary => serializer.serialize_str("stationary"),
        }
    }
}

impl<'de> Deserialize<'de> for Start {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        const ALLOWED: &str = "a state from 1 to 8 or stationary";

        /// The forms of the setting in files. RON reads a bare word as text, too.
        #[derive(Deserialize)]
        #[serde(untagged, expecting = "a state from 1 to 8 or stationary")]
        enum Written {
            State(u64),
            Text(String),
        }

        let refused = |value| de::Error::invalid_value(value, &ALLOWED);
        match Written::deserialize(deserializer)? {
            Written::Text(text) if text == "stationary" => Ok(Start::Stationary),
            Written::Text(text) => Err(refused(de::Unexpected::Str(&text))),
            Written::State(number) => u8::try_from(number)
                .ok()
                .and_then(State::new)
                .map(Start::State)
                .ok_or_else(|| refused(de::Unexpected::Unsigned(number))),
        }
    }
}

/// The form of a hallway's walls at turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Corners {
    /// The walls turn at right angles.
    Square,
    /// The walls turn along arcs around a common centre.
    Rounded,
}

/// Whether walls close a hallway's two ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Ends {
    /// There is a wall at each end.
    Closed,
    /// The ends are open.
    Open,
}

pub(super) const RULES: &[&str] = &[
    "`width` plus `wall_thickness` is at most the `pitch`, or twice the `pitch` where `p_tt` is 0",
    "`segments` times the `pitch` is at most 100,000 km",
    "`alcove_rate`, `door_frame_rate` and `narrowing_rate` together are at most one per `pitch`",
    "`alcove_width` is at most the `pitch` less two times `wall_thickness`, `alcove_depth` at most the `pitch`, \
     where `alcove_rate` is not 0",
    "`door_frame_width` is under the `width`, where `door_frame_rate` is not 0",
    "`narrowing_width` is under the `width`, where `narrowing_rate` is not 0",
];

impl HallwaySpec {
    /// Checks every field, and the rules about several fields.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        self.check_fields()?;
        self.check_spacing()?;
        self.check_extent()?;
        self.check_features()
    }

    /// Checks that parallel arms do not share space. With U-turns they lie in neighbouring rows of cells, otherwise
    /// in every other row.
    fn check_spacing(&self) -> Result<(), SpecError> {
        let (rows, rule) = if self.p_tt > 0.0 { (1.0, "p_tt > 0") } else { (2.0, "p_tt = 0") };
        let room = rows * self.pitch;
        if self.width + self.wall_thickness <= room {
            return Ok(());
        }
        if room - self.wall_thickness <= 0.0 {
            let allowed =
                format!("less than {room} m: with {rule} parallel arms lie {room} m apart");
            return Err(SpecError::new("wall_thickness", self.wall_thickness, allowed));
        }
        Err(SpecError::new(
            "width",
            self.width,
            format!(
                "at most {} m: with {rule} parallel arms lie {room} m apart, and the wall between \
                 them is {} m thick",
                room - self.wall_thickness,
                self.wall_thickness
            ),
        ))
    }

    /// Checks that a hallway without turns ends inside the largest world.
    fn check_extent(&self) -> Result<(), SpecError> {
        // Walls, alcoves and ends extend beyond the cells of the segments by at most four cells.
        let cells = self.segments as f64 + 4.0;
        if self.pitch * cells <= MAX_COORDINATE {
            return Ok(());
        }
        let allowed = format!(
            "at most {} m for {} segments: worlds end at {MAX_COORDINATE} m",
            MAX_COORDINATE / cells,
            self.segments
        );
        Err(SpecError::new("pitch", self.pitch, allowed))
    }

    fn check_features(&self) -> Result<(), SpecError> {
        let [alcoves, frames, crates] =
            [self.alcove_rate, self.door_frame_rate, self.narrowing_rate];
        if (alcoves + frames + crates) * self.pitch > 1.0 + ROUNDING {
            return Err(SpecError::new(
                "alcove_rate + door_frame_rate + narrowing_rate",
                format!("{alcoves} + {frames} + {crates}"),
                format!("at most {} 1/m: one per segment of {} m", 1.0 / self.pitch, self.pitch),
            ));
        }
        let length = self.pitch - 2.0 * self.wall_thickness;
        if self.alcove_rate > 0.0 && self.alcove_width > length {
            let allowed = format!("at most {length} m, what a segment has between its walls");
            return Err(SpecError::new("alcove_width", self.alcove_width, allowed));
        }
        if self.alcove_rate > 0.0 && self.alcove_depth > self.pitch {
            let allowed = format!("at most the pitch of {} m", self.pitch);
            return Err(SpecError::new("alcove_depth", self.alcove_depth, allowed));
        }
        for (name, rate, width) in [
            ("door_frame_width", self.door_frame_rate, self.door_frame_width),
            ("narrowing_width", self.narrowing_rate, self.narrowing_width),
        ] {
            if rate > 0.0 && width >= self.width {
                let allowed = format!("under the corridor's width of {} m", self.width);
                return Err(SpecError::new(name, width, allowed));
            }
        }
        Ok(())
    }
}
