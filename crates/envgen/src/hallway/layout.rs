//! The layout of a corridor in metres, computed from its states.
//!
//! Each state owns one square cell of a lattice, and the next cell lies in the exit direction. No exit direction is
//! down, the walk keeps one direction inside a row of cells, and it never returns to a row. Therefore no cell is
//! used twice, whatever the probabilities are.

use std::f64::consts::FRAC_PI_2;

use glam::DVec2;

use super::spec::{Corners, HallwaySpec};
use super::state::State;
use crate::geometry::{Pose, unit_vector};

/// The greatest deviation in metres of chords from the arcs that they replace.
const CHORD_TOLERANCE: f64 = 0.002;

/// The geometry of a corridor in metres. The origin is the centre of the first cell.
///
/// ```
/// use envgen::{Seed, Spec, hallway::HallwaySpec};
///
/// let hallway = HallwaySpec { width: 1.5, ..Default::default() }.generate(Seed(7))?;
/// let layout = hallway.layout();
/// let (middle, left, right) = (layout.centreline(), layout.left_face(), layout.right_face());
/// assert_eq!(left[0].distance(right[0]), 1.5);
/// assert_eq!(middle[0].distance(left[0]), 0.75);
/// # Ok::<(), envgen::SpecError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HallwayLayout {
    cells: Vec<DVec2>,
    pub(super) legs: Vec<Leg>,
    width: f64,
    /// Radius of the arcs of the centreline; 0 for square corners.
    pub(super) arc_radius: f64,
    pub(super) arc_pieces: usize,
    start: Pose,
    goal: Pose,
}

/// A straight piece of the centreline, from corner point to corner point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    pub(super) from: DVec2,
    pub(super) to: DVec2,
    /// Unit vector of the direction of travel.
    pub(super) direction: DVec2,
    /// Index of the first state whose cell lies on the leg after its first corner.
    pub(super) first_cell: usize,
}

impl HallwayLayout {
    pub(super) fn new(states: &[State], spec: &HallwaySpec) -> Self {
        let half_width = 0.5 * spec.width;
        let arc_radius = match spec.corners {
            Corners::Square => 0.0,
            Corners::Rounded => half_width.max(0.5 * spec.pitch),
        };
        // An end that turns needs room for its inner corner, which would lie outside of the end cell if the
        // corridor were wider than its cells.
        let stub = |state: State| {
            let half_pitch = 0.5 * spec.pitch;
            if state.is_turn() {
                half_pitch.max(half_width + spec.wall_thickness)
            } else {
                half_pitch
            }
        };
        let (first, last) = (states[0], states[states.len() - 1]);

        let mut cells = Vec::with_capacity(states.len());
        let mut legs = Vec::with_capacity(states.len() / 2 + 1);
        let mut cell = DVec2::ZERO;
        let mut from = -first.entry() * stub(first);
        let mut first_cell = 0;
        for (i, state) in states.iter().enumerate() {
            let center = cell * spec.pitch;
            cells.push(center);
            if state.is_turn() {
                legs.push(Leg { from, to: center, direction: state.entry(), first_cell });
                from = center;
                first_cell = i + 1;
            }
            cell += state.exit();
        }
        let end = cells[cells.len() - 1];
        let to = end + last.exit() * stub(last);
        legs.push(Leg { from, to, direction: last.exit(), first_cell });

        let mut layout = HallwayLayout {
            cells,
            legs,
            width: spec.width,
            arc_radius,
            arc_pieces: arc_pieces(arc_radius + half_width + spec.wall_thickness),
            start: Pose::default(),
            goal: Pose::default(),
        };
        layout.start = layout.pose_in_cell(first, DVec2::ZERO, first.entry());
        layout.goal = layout.pose_in_cell(last, end, last.exit());
        layout
    }

    /// Returns the centre of each state's cell, in order.
    pub fn cells(&self) -> &[DVec2] {
        &self.cells
    }

    /// Returns the centreline from end to end, with arcs as chords.
    pub fn centreline(&self) -> Vec<DVec2> {
        self.offset_line(0.0)
    }

    /// Returns the inner face of the left wall, from start to goal.
    pub fn left_face(&self) -> Vec<DVec2> {
        self.offset_line(0.5 * self.width)
    }

    /// Returns the inner face of the right wall, from start to goal.
    pub fn right_face(&self) -> Vec<DVec2> {
        self.offset_line(-0.5 * self.width)
    }

    /// Returns the length of the centreline in metres, from end to end.
    pub fn length(&self) -> f64 {
        let legs: f64 = self.legs.iter().map(|leg| (leg.to - leg.from).length()).sum();
        let corners = (self.legs.len() - 1) as f64;
        legs - corners * self.arc_radius * (2.0 - FRAC_PI_2)
    }

    /// Returns the pose in which a robot starts: in the first cell, facing along the corridor.
    pub fn start(&self) -> Pose {
        self.start
    }

    /// Returns the pose that the robot should reach: in the last cell.
    pub fn goal(&self) -> Pose {
        self.goal
    }

    /// Returns the line at `offset` metres to the left of the centreline.
    pub(super) fn offset_line(&self, offset: f64) -> Vec<DVec2> {
        let mut line = Vec::with_capacity(2 * self.legs.len());
        for (k, leg) in self.legs.iter().enumerate() {
            let (a, b) = self.run(k, offset);
            line.push(a);
            if self.arc_radius > 0.0 {
                line.push(b);
                if let Some(corner) = self.corner(k) {
                    let arc = corner.arc(corner.face_radius(offset), self.arc_pieces);
                    line.extend(&arc[1..self.arc_pieces]);
                }
            }
            if k + 1 == self.legs.len() && self.arc_radius == 0.0 {
                line.push(leg.to + leg.direction.perp() * offset);
            }
        }
        line
    }

    /// Returns both ends of the straight part, along leg `k`, of the line at `offset` metres to the left.
    pub(super) fn run(&self, k: usize, offset: f64) -> (DVec2, DVec2) {
        let leg = self.legs[k];
        let shift = |corner: Option<Corner>| match corner {
            None => 0.0,
            Some(_) if self.arc_radius > 0.0 => self.arc_radius,
            Some(corner) => corner.turn * offset,
        };
        let before = k.checked_sub(1).and_then(|k| self.corner(k));
        let side = leg.direction.perp() * offset;
        (
            leg.from + side + leg.direction * shift(before),
            leg.to + side - leg.direction * shift(self.corner(k)),
        )
    }

    /// Returns the corner at the end of leg `k`; `None` at the hallway's end.
    pub(super) fn corner(&self, k: usize) -> Option<Corner> {
        let (leg, next) = (self.legs.get(k)?, self.legs.get(k + 1)?);
        Some(Corner {
            entry: leg.direction,
            exit: next.direction,
            turn: leg.direction.perp_dot(next.direction),
            center: leg.to + (next.direction - leg.direction) * self.arc_radius,
            radius: self.arc_radius,
        })
    }

    fn pose_in_cell(&self, state: State, cell: DVec2, heading: DVec2) -> Pose {
        if state.is_turn() && self.arc_radius > 0.0 {
            // The middle of the arc: a narrow corridor misses the middle of the cell.
            let outward = (state.entry() - state.exit()).normalize();
            let center = cell + (state.exit() - state.entry()) * self.arc_radius;
            let along = state.entry() + state.exit();
            return Pose {
                position: center + outward * self.arc_radius,
                heading: libm::atan2(along.y, along.x),
            };
        }
        Pose { position: cell, heading: libm::atan2(heading.y, heading.x) }
    }
}

/// A corner between two legs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    entry: DVec2,
    exit: DVec2,
    /// 1 for a turn to the left, -1 for a turn to the right.
    pub(super) turn: f64,
    center: DVec2,
    radius: f64,
}

impl Corner {
    /// Returns the radius of the line at `offset` metres to the left of the centreline; at least 0.
    pub(super) fn face_radius(&self, offset: f64) -> f64 {
        (self.radius - self.turn * offset).max(0.0)
    }

    /// Returns the `pieces + 1` points of a concentric arc, from entry to exit.
    pub(super) fn arc(&self, radius: f64, pieces: usize) -> Vec<DVec2> {
        let (first, last) = (-self.exit, self.entry);
        (0..=pieces)
            .map(|i| {
                // The end points are exact, so that arcs meet their runs without a gap.
                let direction = match i {
                    0 => first,
                    i if i == pieces => last,
                    i => {
                        let (s, c) = {
                            let v = unit_vector(FRAC_PI_2 * i as f64 / pieces as f64);
                            (v.y, v.x)
                        };
                        first * c + last * s
                    }
                };
                self.center + direction * radius
            })
            .collect()
    }
}

/// Returns the number of chords that keeps a quarter circle within [`CHORD_TOLERANCE`]; at most 64, so that huge
/// corridors remain cheap.
fn arc_pieces(radius: f64) -> usize {
    let half_step = libm::acos((1.0 - CHORD_TOLERANCE / radius.max(CHORD_TOLERANCE)).max(0.0));
    ((FRAC_PI_2 / (2.0 * half_step)).ceil() as usize).clamp(4, 64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::Spec;
    use crate::geometry::segments_cross;
    use crate::seed::Seed;
    use proptest::prelude::*;

    fn layout(states: &[u8], spec: &HallwaySpec) -> HallwayLayout {
        let states: Vec<_> = states.iter().filter_map(|&n| State::new(n)).collect();
        HallwayLayout::new(&states, spec)
    }

    #[test]
    fn a_left_turn_by_hand() {
        let spec = HallwaySpec { pitch: 4.0, width: 2.0, ..Default::default() };
        let v = DVec2::new;
        let corridor = layout(&[3, 5, 1], &spec);
        assert_eq!(corridor.cells(), [v(0., 0.), v(0., 4.), v(-4., 4.)]);
        assert_eq!(corridor.centreline(), [v(0., -2.), v(0., 4.), v(-6., 4.)]);
        assert_eq!(corridor.left_face(), [v(-1., -2.), v(-1., 3.), v(-6., 3.)]);
        assert_eq!(corridor.right_face(), [v(1., -2.), v(1., 5.), v(-6., 5.)]);
        assert_eq!(corridor.length(), 12.0);
        assert_eq!(corridor.start(), Pose::new(0., 0., FRAC_PI_2));
        assert_eq!(corridor.goal(), Pose::new(-4., 4., std::f64::consts::PI));
    }

    #[test]
    fn a_rounded_turn_keeps_its_radii() {
        let corners = Corners::Rounded;
        let spec = HallwaySpec { pitch: 4.0, width: 2.0, corners, ..Default::default() };
        let corridor = layout(&[3, 5, 1], &spec);
        let center = DVec2::new(-2.0, 2.0);
        for (line, radius) in [
            (corridor.left_face(), 1.0),
            (corridor.centreline(), 2.0),
            (corridor.right_face(), 3.0),
        ] {
            let arc = line.iter().filter(|p| p.x > -2.0 && p.y > 2.0);
            assert!(arc.clone().count() > 3);
            assert!(arc.into_iter().all(|p| (p.distance(center) - radius).abs() < 1e-12));
        }
        assert!((corridor.length() - (4.0 + 4.0 + std::f64::consts::PI)).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn no_cell_is_used_twice_and_walls_never_cross(
            seed: u64,
            start in 1..=8_u8,
            p_st in 0.0..=1.0_f64,
            p_tt in prop_oneof![Just(0.0), 0.0..=1.0_f64],
            fill in 0.05..=1.0_f64,
            rounded: bool,
        ) {
            let rows = if p_tt > 0.0 { 1.0 } else { 2.0 };
            let spec = HallwaySpec {
                segments: 60,
                start: super::super::Start::State(State::new(start).unwrap()),
                p_st,
                p_tt,
                width: fill * (rows * 2.5 - 0.1),
                corners: if rounded { Corners::Rounded } else { Corners::Square },
                ..Default::default()
            };
            let layout = spec.generate(Seed(seed)).unwrap().layout();
            let mut cells: Vec<_> =
                layout.cells().iter().map(|c| ((c.x / 2.5) as i64, (c.y / 2.5) as i64)).collect();
            cells.sort_unstable();
            cells.dedup();
            prop_assert_eq!(cells.len(), 60);

            let faces = [layout.left_face(), layout.right_face()];
            let sides: Vec<Vec<_>> = faces
                .iter()
                .map(|face| {
                    face.windows(2).map(|p| (p[0], p[1])).filter(|(a, b)| a.distance(*b) > 1e-9)
                        .collect()
                })
                .collect();
            for &(a, b) in &sides[0] {
                for &(c, d) in &sides[1] {
                    prop_assert!(!segments_cross(a, b, c, d), "{a} {b} {c} {d}");
                }
            }
            for side in &sides {
                for (i, &(a, b)) in side.iter().enumerate() {
                    for &(c, d) in side.iter().skip(i + 2) {
                        prop_assert!(!segments_cross(a, b, c, d), "{a} {b} {c} {d}");
                    }
                }
            }
        }
    }
}
