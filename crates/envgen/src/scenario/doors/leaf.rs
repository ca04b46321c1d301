//! The geometry of a door's leaves.

use std::f64::consts::FRAC_PI_2;

use glam::DVec2;

use super::door::{Door, DoorKind};
use crate::geometry::{distance_to_segment, nearest_on_segment, unit_vector};
use crate::world::Doorway;

/// A leaf of a door, which is a line without thickness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaf {
    /// The end at the hinge; for a sliding leaf, the end in the wall.
    pub hinge: DVec2,
    /// The other end.
    pub tip: DVec2,
}

impl Leaf {
    /// Returns the point of the leaf that is nearest to a point, in metres.
    pub fn nearest_point(&self, p: DVec2) -> DVec2 {
        nearest_on_segment(p, self.hinge, self.tip)
    }

    /// Returns the distance to the leaf along a ray in the direction of a unit vector; `None` if the ray misses it.
    pub fn distance_along(&self, from: DVec2, direction: DVec2) -> Option<f64> {
        let (to, edge) = (self.hinge - from, self.tip - self.hinge);
        let across = direction.perp_dot(edge);
        // A ray along a line without thickness sees nothing of it.
        if across == 0.0 {
            return None;
        }
        let distance = to.perp_dot(edge) / across;
        let along = to.perp_dot(direction) / across;
        (distance >= 0.0 && (0.0..=1.0).contains(&along)).then_some(distance)
    }
}

/// The positions that the leaves of a door can have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DoorShape {
    kind: DoorKind,
    /// The end with the hinge of the first leaf, and the other end of the doorway.
    pub(crate) ends: [DVec2; 2],
    /// Unit vector to the side to which the leaves swing.
    side: DVec2,
    /// Unit vector from the first end to the second.
    along: DVec2,
    pub(crate) width: f64,
}

/// Returns cosine and sine of the angle of a leaf at an openness.
fn leaf_direction(openness: f64) -> DVec2 {
    match openness {
        0.0 => DVec2::X,
        1.0 => DVec2::Y,
        _ => unit_vector(openness * FRAC_PI_2),
    }
}

impl DoorShape {
    /// Creates the shape of a door in its doorway, whose longer axis is its width.
    pub(crate) fn new(door: &Door, doorway: &Doorway) -> Self {
        let (near, far, _) = doorway.shape.long_axis();
        let along = (far - near).normalize_or(DVec2::X);
        let side = if door.to_right { -along.perp() } else { along.perp() };
        let (ends, along) = if door.far_end { ([far, near], -along) } else { ([near, far], along) };
        DoorShape { kind: door.kind, ends, side, along, width: near.distance(far) }
    }

    pub(crate) fn middle(&self) -> DVec2 {
        0.5 * (self.ends[0] + self.ends[1])
    }

    /// Whether the leaves swing out of the doorway.
    pub(crate) fn swings(&self) -> bool {
        self.kind != DoorKind::Sliding
    }

    /// Returns how far the leaves extend from the middle of the doorway, in metres.
    pub(crate) fn reach(&self) -> f64 {
        // The corner of a leaf that is open by 90 degrees is the farthest.
        1.2 * self.width
    }

    /// Returns the leaves at an openness from 0 to 1; no leaf if nothing is left of a sliding leaf.
    pub(crate) fn leaves(&self, openness: f64) -> impl Iterator<Item = Leaf> + use<> {
        let turned = |along: DVec2| {
            let turn = leaf_direction(openness);
            along * turn.x + self.side * turn.y
        };
        let [a, b] = self.ends;
        let leaf = |hinge: DVec2, tip| Some(Leaf { hinge, tip });
        let leaves = match self.kind {
            DoorKind::Hinged => [leaf(a, a + turned(self.along) * self.width), None],
            DoorKind::Double => {
                let half = 0.5 * self.width;
                [leaf(a, a + turned(self.along) * half), leaf(b, b + turned(-self.along) * half)]
            }
            DoorKind::Sliding if openness >= 1.0 => [None, None],
            DoorKind::Sliding => [leaf(a, a + self.along * self.width * (1.0 - openness)), None],
        };
        leaves.into_iter().flatten()
    }

    /// Returns the distance in metres from a point to the area that the leaves sweep between two opennesses; 0 inside.
    pub(crate) fn swept_distance(&self, p: DVec2, from: f64, to: f64) -> f64 {
        let (low, high) = (from.min(to), from.max(to));
        let [a, b] = self.ends;
        match self.kind {
            DoorKind::Hinged => self.sector_distance(p - a, self.along, self.width, low, high),
            DoorKind::Double => {
                let half = 0.5 * self.width;
                let first = self.sector_distance(p - a, self.along, half, low, high);
                first.min(self.sector_distance(p - b, -self.along, half, low, high))
            }
            DoorKind::Sliding => {
                let at = |openness: f64| a + self.along * self.width * (1.0 - openness);
                distance_to_segment(p, at(low), at(high))
            }
        }
    }

    /// Returns the distance from a point to all positions that a leaf can have; for a sliding door, to the closed leaf.
    pub(crate) fn swing_distance(&self, p: DVec2) -> f64 {
        self.swept_distance(p, 0.0, 1.0)
    }

    /// Returns the distance from a point, relative to the hinge, to a sector of a disc.
    fn sector_distance(&self, p: DVec2, along: DVec2, radius: f64, low: f64, high: f64) -> f64 {
        // In axes where the closed leaf points along +x and opens towards +y.
        let local = DVec2::new(p.dot(along), p.dot(self.side));
        let (first, last) = (leaf_direction(low), leaf_direction(high));
        let is_between = first.perp_dot(local) >= 0.0 && local.perp_dot(last) >= 0.0;
        if is_between {
            return (local.length() - radius).max(0.0);
        }
        let to_edge = |edge: DVec2| distance_to_segment(local, DVec2::ZERO, edge * radius);
        to_edge(first).min(to_edge(last))
    }

    /// Returns the outlines of the areas that a swinging door sweeps, for a check against other solids, without the
    /// parts that are nearer than `gap` metres to the doorway's centre line and its ends. For sliding doors there
    /// are no outlines.
    pub(crate) fn swept_outlines(&self, gap: f64) -> Vec<Vec<DVec2>> {
        const CORNERS: usize = 8;
        let outline = |hinge: DVec2, along: DVec2, radius: f64| -> Vec<DVec2> {
            let point = |x: f64, y: f64| hinge + along * x + self.side * y;
            let rim = (0..=CORNERS).map(|i| {
                let turn = unit_vector(FRAC_PI_2 * i as f64 / CORNERS as f64);
                point((turn.x * radius).max(INSET), (turn.y * radius).max(gap))
            });
            let mut corners = vec![point(INSET, gap)];
            corners.extend(rim);
            corners
        };
        let [a, b] = self.ends;
        match self.kind {
            DoorKind::Hinged => vec![outline(a, self.along, self.width)],
            DoorKind::Double => {
                let half = 0.5 * self.width;
                vec![outline(a, self.along, half), outline(b, -self.along, half)]
            }
            DoorKind::Sliding => Vec::new(),
        }
    }
}

/// An open leaf may touch a wall that continues the doorway's end at a right angle.
const INSET: f64 = 0.02;
