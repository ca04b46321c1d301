//! Features of corridors: alcoves, door frames and crates, which make pieces of a corridor differ.
//!
//! Zwennes (2011) asks for "different hallway pieces" because plain corridors were the predictable part of his
//! maps. Every inner straight cell draws at most one feature, with a probability of rate x pitch. The rates apply
//! to the draws; `features_dropped` counts the drawn features for which there was not enough room.

use std::collections::BTreeMap;

use glam::DVec2;

use super::blueprint::Hallway;
use super::layout::HallwayLayout;
use super::spec::HallwaySpec;
use crate::geometry::Rect;

/// Depth of a door frame and of a crate along the corridor, in metres, if the cell is long enough.
const FRAME_DEPTH: f64 = 0.2;
const CRATE_DEPTH: f64 = 0.6;

/// A feature of a straight piece of corridor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// The kind of feature.
    pub kind: FeatureKind,
    /// Index of the state whose cell contains the feature.
    pub cell: usize,
    /// The feature's middle on the centreline, in metres.
    pub at: DVec2,
    /// Unit vector of the direction of travel at the feature.
    pub direction: DVec2,
    /// The side of the corridor on which the feature is; a door frame is on both.
    pub side: Side,
    /// Length of the feature along the corridor in metres.
    pub length: f64,
    pub(super) leg: usize,
}

/// The kind of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeatureKind {
    /// A recess in the wall.
    Alcove,
    /// A door frame: two posts.
    DoorFrame,
    /// A narrow place: a crate at one wall.
    Narrowing,
}

/// A side of the corridor, seen in the direction of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The left side.
    Left,
    /// The right side.
    Right,
}

impl Side {
    /// Returns 1 for the left side and -1 for the right side.
    pub(super) fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }
}

#[derive(Default)]
pub(super) struct Placed {
    pub(super) features: Vec<Feature>,
    pub(super) dropped: u64,
    /// The last feature that narrows the corridor: a door frame or a crate.
    last_narrowing: Option<Feature>,
}

/// Draws the features of a hallway and drops those for which there is no room, because they are beside a corner or
/// too close to the last feature, or because an alcove would reach into another arm.
pub(super) fn place(hallway: &Hallway, layout: &HallwayLayout) -> Placed {
    let spec = hallway.spec();
    let mut placed = Placed::default();
    if spec.alcove_rate + spec.door_frame_rate + spec.narrowing_rate == 0.0 {
        return placed;
    }
    let mut taken = Taken::new(layout, spec);
    let passage = passage(spec);
    let mut stream = hallway.seed().stream("hallway/features", 0);
    for (k, leg) in layout.legs.iter().enumerate() {
        let end =
            layout.legs.get(k + 1).map_or(hallway.states().len() - 1, |next| next.first_cell - 1);
        for cell in leg.first_cell.max(1)..end {
            // Always three draws per cell, so that a cell's outcome does not change the next one's draws.
            let (which, jitter, left) = (stream.unit(), stream.unit(), stream.chance(0.5));
            let Some((kind, length)) = draw(spec, which) else { continue };
            let side = if left { Side::Left } else { Side::Right };
            let apart =
                if kind == FeatureKind::Alcove { 2.0 * spec.wall_thickness } else { passage };
            let slack = (spec.pitch - length - apart).max(0.0);
            let at = layout.cells()[cell] + leg.direction * slack * (jitter - 0.5);
            let feature =
                Feature { kind, cell, at, direction: leg.direction, side, length, leg: k };
            let room =
                fits_on_leg(layout, spec, &feature) && clear_of_last(&placed, &feature, passage);
            if room && taken.claim(spec, &feature) {
                placed.features.push(feature);
                if kind != FeatureKind::Alcove {
                    placed.last_narrowing = Some(feature);
                }
            } else {
                placed.dropped += 1;
            }
        }
    }
    placed
}

/// Returns the width in metres of the narrowest passage for which the spec asks.
pub(super) fn passage(spec: &HallwaySpec) -> f64 {
    let frame = if spec.door_frame_rate > 0.0 { spec.door_frame_width } else { spec.width };
    let crate_ = if spec.narrowing_rate > 0.0 { spec.narrowing_width } else { spec.width };
    frame.min(crate_)
}

/// Whether a robot that fits through the narrowest passage can also move sideways between this feature and the last
/// one. A crate right behind a door frame would close the corridor.
fn clear_of_last(placed: &Placed, feature: &Feature, passage: f64) -> bool {
    feature.kind == FeatureKind::Alcove
        || placed.last_narrowing.is_none_or(|last| {
            let apart = (feature.at - last.at).dot(feature.direction).abs();
            let lengths = 0.5 * (feature.length + last.length);
            last.leg != feature.leg || apart >= lengths + passage - 1e-9
        })
}

fn draw(spec: &HallwaySpec, which: f64) -> Option<(FeatureKind, f64)> {
    let alcove = spec.alcove_rate * spec.pitch;
    let frame = alcove + spec.door_frame_rate * spec.pitch;
    let crate_ = frame + spec.narrowing_rate * spec.pitch;
    let room = spec.pitch - 2.0 * spec.wall_thickness;
    if which < alcove {
        Some((FeatureKind::Alcove, spec.alcove_width))
    } else if which < frame {
        Some((FeatureKind::DoorFrame, FRAME_DEPTH.min(room.max(0.5 * spec.pitch))))
    } else if which < crate_ {
        Some((FeatureKind::Narrowing, CRATE_DEPTH.min(room.max(0.5 * spec.pitch))))
    } else {
        None
    }
}

/// Whether both walls are straight beside the whole feature, with a wall's thickness to spare.
fn fits_on_leg(layout: &HallwayLayout, spec: &HallwaySpec, feature: &Feature) -> bool {
    let half = 0.5 * feature.length + spec.wall_thickness;
    let at = feature.at.dot(feature.direction);
    [0.5, -0.5].iter().all(|side| {
        let (a, b) = layout.run(feature.leg, side * spec.width);
        // The outer wall continues past the corner, where there is no wall on the other side.
        a.dot(feature.direction) + half <= at && at + half <= b.dot(feature.direction)
    })
}

impl Feature {
    /// Returns the bounds of an alcove and its walls, behind the inner face of the corridor's wall.
    pub(super) fn alcove_outline(&self, spec: &HallwaySpec) -> Rect {
        let outward = self.direction.perp() * self.side.sign();
        let along = self.direction * (0.5 * self.length + spec.wall_thickness);
        let near = self.at + outward * (0.5 * spec.width);
        let far = near + outward * (spec.alcove_depth + spec.wall_thickness);
        let corners = [near - along, near + along, far - along, far + along];
        corners.into_iter().fold(Rect::new(near, far), |r, p| r.union(Rect::new(p, p)))
    }
}

/// The lattice cells that are used by the corridor and the alcoves placed so far.
struct Taken {
    cells: BTreeMap<(i64, i64), Vec<Owner>>,
    /// Half the side of the square around a cell's centre that contains its piece of corridor.
    reach: f64,
}

enum Owner {
    Corridor { leg: usize, corner_of: Option<usize> },
    Alcove(Rect),
}

impl Taken {
    fn new(layout: &HallwayLayout, spec: &HallwaySpec) -> Self {
        let mut cells: BTreeMap<_, Vec<Owner>> = BTreeMap::new();
        for (k, leg) in layout.legs.iter().enumerate() {
            let end = layout.legs.get(k + 1).map_or(layout.cells().len(), |next| next.first_cell);
            for cell in leg.first_cell..end {
                let corner = k + 1 < layout.legs.len() && cell + 1 == end;
                let corner_of = corner.then_some(k + 1);
                let owner = Owner::Corridor { leg: k, corner_of };
                cells.entry(key(layout.cells()[cell], spec)).or_default().push(owner);
            }
        }
        Taken { cells, reach: (0.5 * spec.pitch).max(0.5 * spec.width + spec.wall_thickness) }
    }

    /// Claims the cells of an alcove; returns false if one of them is taken. Other features lie inside the corridor
    /// and always have room.
    fn claim(&mut self, spec: &HallwaySpec, feature: &Feature) -> bool {
        if feature.kind != FeatureKind::Alcove {
            return true;
        }
        let outline = feature.alcove_outline(spec);
        // Corridor cells reach `reach` from their middle, other alcoves at most pitch and wall.
        let around = outline.grown(self.reach + spec.pitch + spec.wall_thickness);
        let (low, high) = (key(around.min, spec), key(around.max, spec));
        for x in low.0..=high.0 {
            for (&(_, y), owners) in self.cells.range((x, low.1)..=(x, high.1)) {
                let center = DVec2::new(x as f64, y as f64) * spec.pitch;
                let square = Rect::new(center, center).grown(self.reach);
                let blocked = owners.iter().any(|owner| match owner {
                    Owner::Alcove(other) => outline.overlaps(*other),
                    Owner::Corridor { leg, corner_of } => {
                        let own = *leg == feature.leg || *corner_of == Some(feature.leg);
                        !own && outline.overlaps(square)
                    }
                });
                if blocked {
                    return false;
                }
            }
        }
        self.cells.entry(key(outline.center(), spec)).or_default().push(Owner::Alcove(outline));
        true
    }
}

fn key(p: DVec2, spec: &HallwaySpec) -> (i64, i64) {
    let cell = (p / spec.pitch).round();
    (cell.x as i64, cell.y as i64)
}
