//! The blueprint of a road: its segments, its waypoints and its exact centreline.

use std::sync::OnceLock;

use glam::DVec2;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::spec::RoadSpec;
use crate::curve::{Curve, Located, Path, PathIndex};
use crate::geometry::Pose;
use crate::seed::Seed;
use crate::world::RoadPoint;

/// The kind of a road's segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SegmentKind {
    /// A straight.
    Straight,
    /// A turn to the left.
    Left,
    /// A turn to the right.
    Right,
}

impl SegmentKind {
    /// Returns whether the segment is a turn.
    pub fn is_turn(self) -> bool {
        self != SegmentKind::Straight
    }

    /// Returns 1 for a left turn, -1 for a right turn and 0 for a straight.
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
    /// The kind of the segment.
    pub kind: SegmentKind,
    /// Number of waypoints on the segment.
    pub waypoints: u64,
    /// Least radius in metres; `None` for a straight.
    pub radius: Option<f64>,
    /// Signed curvature in 1/m at the tightest point, positive to the left.
    pub curvature: f64,
    /// Distance along the road at which the segment starts, in metres.
    pub start: f64,
    /// Length in metres.
    pub length: f64,
    /// Angle of the turn in radians, positive to the left.
    pub angle: f64,
}

/// A road, with the spec and seed from which it was drawn.
///
/// Its JSON is an object of `length`, `step`, `closed`, `attempts`, `end` (x, y, heading), `segments` and
/// `waypoints` (each x, y, heading, curvature).
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

/// Roads are equal if everything that was drawn is equal, whether or not the index exists already.
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
    /// Returns the spec.
    pub fn spec(&self) -> &RoadSpec {
        &self.spec
    }

    /// Returns the seed with which the road was drawn.
    pub fn seed(&self) -> Seed {
        self.seed
    }

    /// Returns whether distributions other than the spec's gave its lengths or its turns.
    pub fn edited(&self) -> bool {
        self.edited
    }

    /// Returns the number of attempts that were needed, which is 1 unless the spec allows more.
    pub fn attempts(&self) -> u64 {
        self.attempts
    }

    /// Returns the length in metres. It is the spec's length, unless the road aims at a point.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Returns the distance between waypoints in metres: the length divided by their number. With lengths as
    /// published, the waypoints of each segment are spread evenly on the segment instead, and this is their average
    /// distance.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Returns the segments in the direction of travel.
    pub fn segments(&self) -> &[RoadSegment] {
        &self.segments
    }

    /// Returns the waypoints. The first is the start of the road; the last lies one step before its end.
    pub fn waypoints(&self) -> &[RoadPoint] {
        &self.waypoints
    }

    /// Returns the exact centreline. A turn with transitions consists of three pieces, or two.
    pub fn path(&self) -> &Path<'static> {
        &self.path
    }

    /// Returns the pose at the end of the road.
    pub fn end(&self) -> Pose {
        self.path.curves().last().map_or(self.spec.start(), Curve::end)
    }

    /// Returns the pose at `s` metres along the road. Before the start and after the end, the curve of the first or
    /// last piece continues.
    pub fn pose_at(&self, s: f64) -> Pose {
        self.path.pose_at(s)
    }

    /// Returns the curvature at `s` metres along the road in 1/m, positive to the left.
    pub fn curvature_at(&self, s: f64) -> f64 {
        self.path.curvature_at(s)
    }

    /// Returns the position of a point relative to the road, by the nearest point of the exact centreline; `None`
    /// for a point that is not finite. It takes time logarithmic in the number of segments; the first call also
    /// builds the index.
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

    /// Returns the index that [`Road::locate`] uses.
    pub fn index(&self) -> &PathIndex {
        self.index.get_or_init(|| PathIndex::new(&self.path))
    }
}

impl Serialize for Road {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        /// Serialises items one by one, without a copy of the list.
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
