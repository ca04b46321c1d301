//! The cells that people and leaves were in: what a map shows there is neither right nor wrong.

use envgen::geometry::Rect;
use envgen::scenario::{PERSON_RADIUS, ScenarioState};
use glam::DVec2;

use crate::mappable_area::{SCORE_CELL, ScoreFrame};

/// Share of the time from which a cell that something was in counts as moving.
const MOVING_SHARE: f64 = 0.05;

/// How far beyond an outline a cell still counts, in metres: about a cell's diagonal.
const MARGIN: f64 = 0.1;

/// For each score cell, how often a person or the leaf of a door was in it.
#[derive(Clone, Debug)]
pub struct SweptCells {
    frame: ScoreFrame,
    counts: Vec<u32>,
    samples: u32,
}

impl SweptCells {
    /// Nothing so far, in a world of these bounds, which must not be far larger than memory.
    pub fn new(bounds: Rect) -> Self {
        let frame = ScoreFrame::around(bounds);
        SweptCells { frame, counts: vec![0; frame.len()], samples: 0 }
    }

    /// Adds where everything is now.
    pub fn add(&mut self, state: &ScenarioState) {
        self.samples += 1;
        // A cell that two things are in counts once.
        let mut cells = Vec::new();
        for person in state.people() {
            let reach = PERSON_RADIUS + MARGIN;
            let (p, around) = (person.position, DVec2::splat(reach));
            self.visit(Rect::new(p - around, p + around), |cell, centre| {
                if centre.distance(p) <= reach {
                    cells.push(cell);
                }
            });
        }
        for leaf in state.all_leaves() {
            let bounds = Rect::new(leaf.hinge.min(leaf.tip), leaf.hinge.max(leaf.tip));
            self.visit(bounds.grown(MARGIN), |cell, centre| {
                if leaf.nearest_point(centre).distance(centre) <= MARGIN {
                    cells.push(cell);
                }
            });
        }
        cells.sort_unstable();
        cells.dedup();
        for cell in cells {
            self.counts[cell] += 1;
        }
    }

    /// Calls `visit` with the cells of a rectangle and their centres.
    fn visit(&self, area: Rect, mut visit: impl FnMut(usize, DVec2)) {
        let inside = ScoreFrame::around(area).intersection(self.frame);
        for cell in 0..inside.len() {
            let (col, row) = inside.place(cell);
            if let Some(own) = self.frame.cell(col, row) {
                visit(own, inside.centre(cell));
            }
        }
    }

    /// Whether something was in a cell for more than a twentieth of the time; the cell's column and row are
    /// counted from the world's origin.
    pub(super) fn is_moving(&self, col: i32, row: i32) -> bool {
        let count = self.frame.cell(col, row).map_or(0, |cell| self.counts[cell]);
        f64::from(count) > MOVING_SHARE * f64::from(self.samples)
    }

    /// The same of the cell that contains a point.
    pub(super) fn is_moving_at(&self, p: DVec2) -> bool {
        let count = self.frame.cell_at(p).map_or(0, |cell| self.counts[cell]);
        f64::from(count) > MOVING_SHARE * f64::from(self.samples)
    }

    /// Area in square metres of the cells in which something was for more than a twentieth of the time.
    pub(super) fn area(&self) -> f64 {
        let least = MOVING_SHARE * f64::from(self.samples);
        let moving = self.counts.iter().filter(|&&count| f64::from(count) > least);
        moving.count() as f64 * SCORE_CELL * SCORE_CELL
    }
}

#[cfg(test)]
mod tests {
    use envgen::scenario::{Person, Reaction, Scenario, ScenarioSpec};
    use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};

    use super::*;

    #[test]
    fn a_person_who_waits_sweeps_a_disc() {
        let world = HallwaySpec { segments: 1, pitch: 8.1, width: 8.0, ..Default::default() };
        let world = world.generate(Seed(1)).expect("a hallway").to_world();
        let mut scenario =
            Scenario::new(&world, &ScenarioSpec::default(), Seed(1)).expect("a scenario");
        let position = world.bounds.center();
        let reaction = Reaction::Impassive;
        scenario.people = vec![Person { position, heading: 0.0, speed: 1.0, reaction }];
        let state = ScenarioState::new(&world, &scenario).expect("a state");
        let mut swept = SweptCells::new(world.bounds);
        assert_eq!(swept.area(), 0.0);
        for _ in 0..10 {
            swept.add(&state);
        }
        let disc = std::f64::consts::PI * 0.35 * 0.35;
        assert!((swept.area() / disc - 1.0).abs() < 0.2, "{} of {disc}", swept.area());
        assert!(swept.is_moving_at(position) && !swept.is_moving_at(position + DVec2::X));
    }
}
