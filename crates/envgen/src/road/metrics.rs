//! Metrics of a road.

use serde::Serialize;

use super::blueprint::Road;
use super::turn::GRAVITY;
use crate::curve::overlap::strip_overlap;

/// The metrics of a road.
///
/// ```
/// use envgen::road::{Prefab, RoadSpec};
/// use envgen::{Blueprint, Seed, Spec};
///
/// let prefabs = vec![Prefab::Straight, Prefab::Left, Prefab::Straight];
/// let metrics = RoadSpec { prefabs, ..Default::default() }.generate(Seed(7))?.metrics();
/// // The one turn has 30 to 90 degrees.
/// assert_eq!((metrics.turns, metrics.length), (1, 1000.0));
/// assert!((30.0 - 1e-9..=90.0 + 1e-9).contains(&metrics.turning));
/// assert!(metrics.straight_share < 1.0 && metrics.directness < 1.0);
/// # Ok::<(), envgen::road::RoadError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RoadMetrics {
    /// Length in metres.
    pub length: f64,
    /// Number of waypoints.
    pub waypoints: u64,
    /// Number of turns.
    pub turns: u64,
    /// Least radius in metres; `None` without turns.
    pub min_radius: Option<f64>,
    /// Mean absolute angle of the turns in degrees; `None` without turns.
    pub mean_angle: Option<f64>,
    /// Sum of the turns' absolute angles in degrees.
    pub turning: f64,
    /// Share of the length that is straight.
    pub straight_share: f64,
    /// Lateral acceleration at the spec's speed in the tightest turn, in m/s^2.
    pub lateral_acceleration: f64,
    /// Greatest speed in m/s at which friction is sufficient in every turn; `None` without turns.
    pub max_speed: Option<f64>,
    /// Distance between start and end divided by the length, which is 1 for a straight road.
    pub directness: f64,
    /// Whether the road overlaps itself.
    pub crosses_itself: bool,
    /// Number of attempts that were needed.
    pub attempts: u64,
}

pub(super) fn measure(road: &Road) -> RoadMetrics {
    let spec = road.spec();
    let turns = || road.segments().iter().filter(|segment| segment.kind.is_turn());
    let count = turns().count() as u64;
    // Not `sum`, which is -0 without any.
    let turning = turns().fold(0.0, |sum, turn| sum + turn.angle.abs()).to_degrees();
    let min_radius = turns().filter_map(|turn| turn.radius).reduce(f64::min);
    let straights = road.segments().iter().filter(|segment| !segment.kind.is_turn());
    let straight = straights.fold(0.0, |sum, segment| sum + segment.length);
    let speed = spec.speed;
    let between = road.end().position.distance(spec.start().position);
    RoadMetrics {
        length: road.length(),
        waypoints: road.waypoints().len() as u64,
        turns: count,
        min_radius,
        mean_angle: (count > 0).then(|| turning / count as f64),
        turning,
        straight_share: straight / road.length(),
        lateral_acceleration: min_radius.map_or(0.0, |radius| speed * speed / radius),
        max_speed: min_radius.map(|radius| (radius * GRAVITY * spec.friction).sqrt()),
        directness: between / road.length(),
        crosses_itself: strip_overlap(road.path(), 0.5 * spec.width, spec.closed).is_some(),
        attempts: road.attempts(),
    }
}
