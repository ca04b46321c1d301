//! The settings of a scenario.

use serde::{Deserialize, Serialize};
use strum::VariantNames;

use crate::error::SpecError;
use crate::settings;

/// The greatest number of people of a scenario.
pub const MAX_PEOPLE: u32 = 10_000;

/// The greatest number of sources of smoke.
pub(super) const MAX_SMOKE_SOURCES: u32 = 1000;

settings! {
    /// The settings of a scenario: the moving elements of a world. By default nothing moves.
    ///
    /// ```
    /// use envgen::scenario::ScenarioSpec;
    ///
    /// let spec = ScenarioSpec { doors: 0.5, people: 4, ..Default::default() };
    /// assert!(spec.validate().is_ok() && !spec.is_still());
    /// let error = ScenarioSpec { smoke: -0.1, ..Default::default() }.validate().unwrap_err();
    /// assert_eq!(error.to_string(), "`smoke` must be a number from 0 to 100, got -0.1");
    /// ```
    pub struct ScenarioSpec {
        /// Probability that an open doorway has a door.
        doors: f64 = 0.0 => number("", 0.0..=1.0);
        /// How the doors move; one whose leaf has no room to swing slides.
        #[group = "doors"]
        door_kind: DoorKinds = DoorKinds::Mixed => choice;
        /// What opens and closes the doors.
        door_control: DoorControl = DoorControl::Timed => choice;
        /// Mean of the exponentially distributed time that a door stays open.
        door_open: f64 = 20.0 => number("s", 0.5..=1e6);
        /// Mean of the exponentially distributed time that a door stays closed.
        door_closed: f64 = 20.0 => number("s", 0.5..=1e6);
        /// Probability that a closing door slams.
        slam: f64 = 0.2 => number("", 0.0..=1.0);
        /// Number of people.
        #[group = ""]
        people: u32 = 0 => integer("", 0..=MAX_PEOPLE as u64);
        /// What a laser sees of a person.
        #[group = "people"]
        body: Body = Body::Disc => choice;
        /// How people react to a robot.
        reaction: Reactions = Reactions::Regular => choice;
        /// Speed of walking; that of each person is normally distributed around it with a deviation of a fifth, cut to
        /// between half of it and one and a half, and to 3 m/s.
        walking_speed: f64 = 1.34 => number("m/s", 0.1..=3.0);
        /// Mean of the exponentially distributed time that a person waits between two walks.
        waiting: f64 = 20.0 => number("s", 0.5..=1e6);
        /// Mean of the exponentially distributed time that a person works after about every second walk, in place of waiting.
        working: f64 = 60.0 => number("s", 0.5..=1e6);
        /// Extinction coefficient of the smoke at its sources, 0 for no smoke. In the profile `usarsim`, the density: a
        /// Hokuyo sees through 0.00575 density x metres, which is 5.75 m at 0.001.
        #[group = ""]
        smoke: f64 = 0.0 => number("1/m", 0.0..=100.0);
        /// Number of sources of smoke.
        #[group = "smoke"]
        smoke_sources: u32 = 1 => integer("", 1..=MAX_SMOKE_SOURCES as u64);
        /// Radius of the smoke of a source outside of rooms.
        smoke_radius: f64 = 3.0 => number("m", 0.1..=1000.0);
        /// Time in which smoke grows to 63 % of its density where none leaks, 0 where it is there from the start.
        smoke_growth: f64 = 0.0 => number("s", 0.0..=1e6);
        /// Speed at which air passes an open doorway in each direction.
        smoke_leak: f64 = 0.1 => number("m/s", 0.0..=10.0);
        /// What the smoke of `USARSim` is.
        smoke_kind: SmokeKind = SmokeKind::Regional => choice;
        /// How smoke affects a laser.
        smoke_profile: SmokeProfile = SmokeProfile::Physical => choice;
        /// What a beam that smoke stops reads.
        failed_beams: FailedBeams = FailedBeams::None => choice;
    }
}

/// The kinds of motion of a scenario's doors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum DoorKinds {
    /// Each kind, with the same probability.
    Mixed,
    /// One leaf that turns.
    Hinged,
    /// Two leaves that turn.
    Double,
    /// One leaf that slides into the wall.
    Sliding,
}

/// The control of a door: what opens and closes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum DoorControl {
    /// The door opens and closes at random, with exponentially distributed open and closed times.
    Timed,
    /// A robot, or a walking person, opens the door within 2 m of it, or 0.55 m beyond the reach of wide leaves that
    /// swing.
    Triggered,
    /// Only [`ScenarioState::command_door`](super::ScenarioState::command_door) opens and closes the door, which is
    /// open at first.
    Commanded,
}

/// The shape of a person for a laser.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Body {
    /// A disc of radius 0.25 m.
    Disc,
    /// Two legs of radius 0.07 m, 0.3 m apart.
    Legs,
}

/// The reactions of a scenario's people to a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Reactions {
    /// [`Reaction::Regular`](super::Reaction::Regular).
    Regular,
    /// [`Reaction::Surprised`](super::Reaction::Surprised).
    Surprised,
    /// [`Reaction::Curious`](super::Reaction::Curious).
    Curious,
    /// [`Reaction::Scared`](super::Reaction::Scared).
    Scared,
    /// [`Reaction::Impassive`](super::Reaction::Impassive).
    Impassive,
    /// Each reaction, with the same probability.
    Mixed,
}

/// The kind of smoke in `USARSim`. The physical profile distinguishes the kinds only in that particles do not leak.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum SmokeKind {
    /// Smoke of a density in a region, through which a SICK sees. From rooms and hallways, it leaks through open
    /// doorways.
    Regional,
    /// Particles, which reflect every beam as a wall does, and stay where they are.
    Particle,
}

/// The effect of smoke on a laser.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum SmokeProfile {
    /// The lidar equation with the Beer-Lambert law.
    Physical,
    /// As in `USARSim`, where each laser has a rule of its own.
    Usarsim,
}

/// The reading of a beam that smoke stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum FailedBeams {
    /// No echo.
    None,
    /// A distance of 0, as a Hokuyo reports.
    Zero,
    /// The distance of an echo from the smoke itself.
    Phantom,
}

impl ScenarioSpec {
    /// Checks every setting against its limits.
    ///
    /// # Errors
    /// Names the first setting that is not allowed, its value and its limits.
    pub fn validate(&self) -> Result<(), SpecError> {
        self.check_fields()
    }

    /// Sets one setting from text, as `--set name=value` does. On an error, nothing changes.
    ///
    /// ```
    /// use envgen::scenario::ScenarioSpec;
    ///
    /// let mut spec = ScenarioSpec::default();
    /// spec.set("doors", "0.5")?;
    /// assert_eq!(spec.doors, 0.5);
    /// assert!(spec.set("door", "0.5").is_err());
    /// # Ok::<(), envgen::SpecError>(())
    /// ```
    ///
    /// # Errors
    /// When the setting does not exist (the error lists those that do), or when the text is not one of its values.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), SpecError> {
        let Some(setting) = Self::SETTINGS.iter().find(|setting| setting.name == name) else {
            let known: Vec<_> = Self::SETTINGS.iter().map(|setting| setting.name).collect();
            return Err(SpecError::new("setting", name, format!("one of {}", known.join(", "))));
        };
        let mut settings = self.settings_json();
        settings[setting.name] = setting.parse(value)?;
        *self = serde_json::from_value(settings).map_err(|_| setting.error(value))?;
        Ok(())
    }

    /// Returns whether nothing moves, so that the world is the same as without a scenario.
    pub fn is_still(&self) -> bool {
        self.doors == 0.0 && self.people == 0 && self.smoke == 0.0
    }
}
