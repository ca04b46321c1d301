//! The filled form.

use envgen::calibration::Dials;
use serde::{Deserialize, Serialize};

use super::choice::{Connection, Experience};
use super::rating::Rating;
use crate::robot::Robot;

/// The filled form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Feedback {
    /// Name of the operator: a person, a policy or a driver.
    pub name: String,
    /// The operator's experience level.
    pub experience: Experience,
    /// The environment and the setup, for which the form asks as well.
    #[serde(flatten)]
    pub session: Session,
    /// Overall difficulty of the environment: 0 if nothing in it forces a mapping error on the robot,
    /// 10 if the map cannot be navigated due to excessive mapping errors.
    pub difficulty: Rating,
    /// Difficulty of mapping. It is not in the original form.
    pub mapping: Rating,
    /// Difficulty of getting around. It is not in the original form.
    pub getting_around: Rating,
    /// What contributed most to the difficulty.
    pub contributed: String,
    /// Rooms that were particularly difficult, and why.
    pub difficult_rooms: String,
    /// Rooms that were particularly easy, and why.
    pub easy_rooms: String,
    /// Patterns in the layout (hallways, dead ends, doorways), and their effects.
    pub patterns: String,
    /// Anything else.
    pub other: String,
}

impl Feedback {
    /// Returns the ratings as the dials that they rate.
    pub fn ratings(&self) -> Dials<Rating> {
        Dials {
            difficulty: self.difficulty,
            mapping: self.mapping,
            navigation: self.getting_around,
        }
    }
}
/// The environment and the setup of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Session {
    /// File or name of the environment.
    pub environment: String,
    /// Software that ran the simulation.
    pub software: String,
    /// How robots and operator were connected.
    pub connection: Connection,
    /// Number and type of robots.
    pub robots: String,
}

impl Session {
    /// Describes a run of this crate: robots of one type, under direct control.
    pub fn new(environment: &str, robots: usize, robot: &Robot) -> Self {
        let kind = match *robot == Robot::default() {
            true => "P3AT".to_owned(),
            false => format!("robot of {} m x {} m", robot.length, robot.width),
        };
        Session {
            environment: environment.to_owned(),
            software: format!("mapping_trial {}", env!("CARGO_PKG_VERSION")),
            connection: Connection::Direct,
            robots: format!("{robots}x {kind}"),
        }
    }
}
