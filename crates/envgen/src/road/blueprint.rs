//! A road: its segments, its waypoints and the exact centreline behind them.

use std::sync::OnceLock;

use glam::DVec2;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::spec::RoadSpec;
use crate::curve::{Curve, Located, Path, PathIndex};
use crate::geometry::Pose;
use crate::seed::Seed;
use crate::world::RoadPoint;

/// What a segment of a road is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SegmentKind {
    /// Straight on.
    Straight,
    /// A turn to the left.
    Left,
    /// A turn to the right.
    Right,
}

impl SegmentKind {
    /// Whether it is a turn.
    pub fn is_turn(self) -> bool {
        self != SegmentKind::Straight
    }

    /// 1 for a left turn, -1 for a right turn, 0 for a straight.
    pub fn sign(self) -> f64 {
        match self {
            SegmentKind::Straight => 0.0,
            SegmentKind::Left => 1.0,
            SegmentKind::Right => -1.0,
        }
    }
}

/// A segment of a road.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RoadSegment {
    /// What it is.
    pub kind: SegmentKind,
    /// Number of waypoints on it.
    pub waypoints: u64,
    /// Least radius in metres; `None` for a straight.
    pub radius: Option<f64>,
    /// Signed curvature in 1/m at the tightest point, positive to the left.
    pub curvature: f64,
    /// Distance along the road at which it starts, in metres.
    pub start: f64,
    /// Length in metres.
    pub length: f64,
    /// Angle of the turn in radians, positive to the left.
    pub angle: f64,
}

/// A road, with the spec and seed that it was drawn for.
///
/// As JSON it is an object of `length`, `step`, `closed`, `attempts`, `end` (x, y, heading),
/// `segments` and `waypoints` (each x, y, heading, curvature).
#[derive(Clone, Debug)]
pub struct Road {
    pub(super) spec: Box<RoadSpec>,
    pub(super) seed: Seed,
    pub(super) edited: bool,
    pub(super) attempts: u64,
    pub(super) length: f64,
    pub(super) step: f64,
    pub(super) segments: Vec<RoadSegment>,
    pub(super) waypoints: Vec<RoadPoint>,
    pub(super) path: Path<'static>,
    pub(super) index: OnceLock<PathIndex>,
}

/// Roads are equal when all that was drawn is equal; whether the index exists already does not count.
impl PartialEq for Road {
    fn eq(&self, other: &Road) -> bool {
        self.spec == other.spec
            && (self.seed, self.edited) == (other.seed, other.edited)
            && self.attempts == other.attempts
            && self.segments == other.segments
            && self.path == other.path
            && self.waypoints == other.waypoints
    }
}

impl Road {
    /// The settings.
    pub fn spec(&self) -> &RoadSpec {
        &self.spec
    }

    /// The seed that it was drawn with.
    pub fn seed(&self) -> Seed {
        self.seed
    }

    /// Whether other laws than the spec's gave its lengths or its turns.
    pub fn edited(&self) -> bool {
        self.edited
    }

    /// Attempts that were needed: 1 unless the spec allows more.
    pub fn attempts(&self) -> u64 {
        self.attempts
    }

    /// Length in metres: the spec's, unless the road aims at a point.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Distance between waypoints in metres: the length divided by their number. With lengths as published,
    /// the waypoints of each segment lie evenly on it instead, this far from each other on average.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// The segments in travel order.
    pub fn segments(&self) -> &[RoadSegment] {
        &self.segments
    }

    /// The waypoints. The first is the start; the last lies one step before the end.
    pub fn waypoints(&self) -> &[RoadPoint] {
        &self.waypoints
    }

    /// The exact centreline. Turns with transitions are three pieces of it, or two.
    pub fn path(&self) -> &Path<'static> {
        &self.path
    }

    /// The pose where the road ends.
    pub fn end(&self) -> Pose {
        self.path.curves().last().map_or(self.spec.start(), Curve::end)
    }

    /// The pose at `s` metres along the road; before the start and after the end the curve of its first or
    /// last piece continues.
    pub fn pose_at(&self, s: f64) -> Pose {
        self.path.pose_at(s)
    }

    /// The curvature at `s` metres along the road in 1/m, positive to the left.
    pub fn curvature_at(&self, s: f64) -> f64 {
        self.path.curvature_at(s)
    }

    /// Where a point lies relative to the road: the nearest point of the exact centreline. `None`
    /// for a point that is not finite. Time: about the logarithm of the number of segments; the
    /// first call also builds the index.
    ///
    /// ```
    /// use envgen::{Seed, Spec, road::RoadSpec, glam::DVec2};
    ///
    /// let road = RoadSpec::default().generate(Seed(7))?;
    /// // A point 1 m to the left of the road's 100th metre.
    /// let point = road.pose_at(100.0).to_world(DVec2::new(0.0, 1.0));
    /// let located = road.locate(point).expect("a finite point");
    /// assert!((located.s - 100.0).abs() < 1e-6 && (located.offset - 1.0).abs() < 1e-6);
    /// # Ok::<(), envgen::road::RoadError>(())
    /// ```
    pub fn locate(&self, point: DVec2) -> Option<Located> {
        self.index().locate(point)
    }

    /// The index behind [`Road::locate`].
    pub fn index(&self) -> &PathIndex {
        self.index.get_or_init(|| PathIndex::new(&self.path))
    }
}

impl Serialize for Road {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        /// Writes items one by one, without a copy of the list.
        struct Rows<'a>(&'a [RoadPoint]);
        impl Serialize for Rows<'_> {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_seq(self.0.iter().map(|point| {
                    let Pose { position, heading } = point.pose;
                    [position.x, position.y, heading, point.curvature]
                }))
            }
        }
        let end = self.end();
        let mut road = serializer.serialize_struct("Road", 7)?;
        road.serialize_field("length", &self.length())?;
        road.serialize_field("step", &self.step)?;
        road.serialize_field("closed", &self.spec.closed)?;
        road.serialize_field("attempts", &self.attempts)?;
        road.serialize_field("end", &[end.position.x, end.position.y, end.heading])?;
        road.serialize_field("segments", &self.segments)?;
        road.serialize_field("waypoints", &Rows(&self.waypoints))?;
        road.end()
    }
}
