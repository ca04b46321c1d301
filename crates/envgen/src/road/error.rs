//! Errors of generating roads.

use thiserror::Error;

use crate::error::SpecError;

/// The reasons why a road could not be generated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RoadError {
    /// The spec has a setting that is not allowed.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// The drawn length of a turn is too short for every allowed radius.
    #[error(
        "segment {segment}, a turn, got {length:.3} m, which allows radii up to {greatest:.3} m, \
         but at least {least:.3} m are needed; `lengths` = reserve always leaves enough"
    )]
    TurnTooShort {
        /// The number of the segment, counted from 1.
        segment: usize,
        /// Length of the segment in metres.
        length: f64,
        /// The least radius in metres that speed, friction and width allow.
        least: f64,
        /// The greatest radius in metres that the least angle allows.
        greatest: f64,
    },
    /// The road overlaps itself.
    #[error(
        "the road covers itself: {first:.3} m from the start it overlaps its part at {second:.3} m"
    )]
    Crossing {
        /// Distance of the overlapping part along the road in metres.
        first: f64,
        /// Distance of the other overlapping part along the road in metres.
        second: f64,
    },
    /// The road leaves its area.
    #[error("the road leaves its square area of {side} m")]
    OutOfArea {
        /// Side of the square in metres.
        side: f64,
    },
    /// The road cannot end at the requested point with any lengths of its straights.
    #[error(
        "the road cannot end at ({x}, {y}): with the drawn turns no lengths of its straights of at \
         least {shortest} m each lead there"
    )]
    Unreachable {
        /// The x coordinate of the point in metres.
        x: f64,
        /// The y coordinate of the point in metres.
        y: f64,
        /// The least length of a straight in metres.
        shortest: f64,
    },
    /// The straights that would lead to the requested point are too long.
    #[error(
        "the road could end there only with a length of {length:.0} m, and {most} m or {waypoints} \
         waypoints are the most"
    )]
    TooLong {
        /// Length of the road in metres that this would need.
        length: f64,
        /// Greatest length in metres.
        most: f64,
        /// Greatest number of waypoints.
        waypoints: u64,
    },
    /// The angles of the road's turns cannot add up to full circles.
    #[error(
        "the road cannot close: its turns add up to {least:.1} to {greatest:.1} degrees, and {} is \
         needed",
        if *.crosses { "a multiple of 360" } else { "360 or -360" }
    )]
    NoFullTurn {
        /// Least sum in degrees.
        least: f64,
        /// Greatest sum in degrees.
        greatest: f64,
        /// Whether the road may cross itself, so that the sum can be any multiple of 360 degrees.
        crosses: bool,
    },
    /// All directions of the road lead away from its start.
    #[error(
        "the road cannot close: its directions differ by at most {greatest:.1} degrees, and more than \
         180 are needed; give it more turns to one side or a greater `theta_max`"
    )]
    LeadsAway {
        /// The greatest difference between two headings of the road in degrees.
        greatest: f64,
    },
    /// No lengths within their limits close the road.
    #[error("no segment lengths close the road after {tries} draws of the turn angles")]
    NotClosed {
        /// Number of draws of the angles that were tried.
        tries: u64,
    },
    /// A distribution of lengths that replaces the spec's gave a number that is not allowed.
    #[error(
        "the law of `lengths` must give finite numbers of at least 0, got {value:?} for segment \
         {segment}"
    )]
    LengthLaw {
        /// The number of the segment, counted from 1.
        segment: usize,
        /// The number that it gave.
        value: f64,
    },
    /// A distribution of lengths that replaces the spec's gave 0 for every segment.
    #[error(
        "the law of `lengths` must give a number over 0 for at least one of the {segments} segments, \
         got 0 for all"
    )]
    NoLengths {
        /// Number of segments.
        segments: usize,
    },
    /// A distribution of turns that replaces the spec's gave a number that is not allowed.
    #[error(
        "the law of `turns` must give numbers from 0 to 1, got {value:?} for segment {segment}"
    )]
    TurnLaw {
        /// The number of the segment, counted from 1.
        segment: usize,
        /// The number that it gave.
        value: f64,
    },
    /// Every attempt failed.
    #[error("no road in {attempts} attempts; the last: {last}")]
    Attempts {
        /// Number of attempts made.
        attempts: u64,
        /// The error of the last attempt.
        last: Box<RoadError>,
    },
}
