//! Errors of building and replaying trials.

use envgen::geometry::Pose;
use envgen::{GenerateError, SettingsError, SpecError};
use thiserror::Error;

use crate::flat::FlatSimulator;
use crate::mappable_area::MappableAreaError;

/// An error that prevents a trial from starting.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TrialError {
    /// A setting is not allowed.
    #[error(transparent)]
    Setting(#[from] SpecError),
    /// A log names a spec that this version cannot read.
    #[error(transparent)]
    Spec(#[from] SettingsError),
    /// A log's world cannot be generated.
    #[error(transparent)]
    Generate(#[from] GenerateError),
    /// The edits of a log's world cannot be repeated.
    #[error("the log's world cannot be edited again: {0}")]
    Edits(String),
    /// A log says that its world was generated, but has no seed.
    #[error("the log's world has a spec but no seed")]
    NoSeed,
    /// The world has no start, and the settings have none either.
    #[error("the world has no start, and the settings give none: set `start`")]
    NoStart,
    /// The start is not in the world.
    #[error("a start at ({}, {}) is outside the world's bounds", start.position.x, start.position.y)]
    OutsideStart {
        /// The start.
        start: Pose,
    },
    /// A solid part is too near to the start.
    #[error(
        "a start at ({}, {}) is {clearance:.6} m from the nearest solid part, expected at least {radius} m",
        start.position.x, start.position.y
    )]
    BlockedStart {
        /// The start.
        start: Pose,
        /// Distance in metres to the nearest solid part.
        clearance: f64,
        /// Radius in metres that a robot needs.
        radius: f64,
    },
    /// A person of the scenario is too near to a start.
    #[error(
        "a start at ({}, {}) is {distance:.3} m from person {person} of the scenario, expected at least {least} m",
        start.position.x, start.position.y
    )]
    OccupiedStart {
        /// The start.
        start: Pose,
        /// The index of the person.
        person: usize,
        /// Distance in metres from the start to the centre of the person.
        distance: f64,
        /// Least distance in metres, at which robot and person touch.
        least: f64,
    },
    /// A leaf of a door of the scenario is too near to a start when the trial begins.
    #[error(
        "a start at ({}, {}) is {distance:.3} m from a leaf of door {door} of the scenario, expected at least \
         {radius} m",
        start.position.x, start.position.y
    )]
    StartOnDoor {
        /// The start.
        start: Pose,
        /// The index of the door.
        door: usize,
        /// Distance in metres from the start to the leaf.
        distance: f64,
        /// Radius in metres that a robot needs.
        radius: f64,
    },
    /// A robot cannot drive on the ground at the start, or it is water.
    #[error("a robot cannot drive on the ground at the start ({}, {})", start.position.x, start.position.y)]
    DeepStart {
        /// The start.
        start: Pose,
    },
    /// The time limit depends on the mappable area, which cannot be computed.
    #[error("`time_per_area` needs the area that can be mapped: {0}")]
    Area(#[from] MappableAreaError),
    /// There is not enough space for all robots near the start.
    #[error("near the start there is room for {found} of {robots} robots")]
    NoRoom {
        /// Requested number of robots.
        robots: u32,
        /// Number of starts found.
        found: u32,
    },
    /// A replay's world is not the one in which the log was made.
    #[error("the world must have the log's digest {logged}, got {found}")]
    OtherWorld {
        /// Digest in the log.
        logged: String,
        /// Digest of the given world.
        found: String,
    },
    /// A [`FlatWorld`](crate::flat::FlatWorld) is the index of another world.
    #[error("the flat world must be that of the world with digest {expected}, got that of {found}")]
    OtherFlatWorld {
        /// Digest of the trial's world.
        expected: String,
        /// Digest of the world that was indexed.
        found: String,
    },
    /// A log's robot backend was not the flat simulator.
    #[error(
        "the log's engine is `{found}`, expected `{}` for the flat simulator",
        FlatSimulator::ENGINE
    )]
    OtherEngine {
        /// The log's robot backend.
        found: String,
    },
}
