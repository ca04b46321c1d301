//! The cells in which people and door leaves were. What a map shows there is neither right nor wrong.

use envgen::geometry::Rect;
use envgen::scenario::{PERSON_RADIUS, ScenarioState};
use glam::DVec2;

use crate::mappable_area::{SCORE_CELL, ScoreFrame};

/// Fraction of the time from which a cell that something was in counts as moving.
const MOVING_SHARE: f64 = 0.05;

/// How far beyond an outline a cell still counts, in metres: about a cell's diagonal.
const MARGIN: f64 = 0.1;

/// For each score cell, how often a person or a door leaf was in it.
#[derive(Clone, Debug)]
pub struct SweptCells {
    frame: ScoreFrame,
    counts: Vec<u32>,
    samples: u32,
}

impl SweptCells {
    /// Creates an empty record for a world with these bounds, which must not be far larger than memory.
    pub fn new(bounds: Rect) -> Self {
        let frame = ScoreFrame::around(bounds);
        SweptCells { frame, counts: vec![0; frame.len()], samples: 0 }
    }

    /// Adds the present positions of people and door leaves.
    pub fn add(&mut self, state: &ScenarioState) {
        self.samples += 1;
        // A cell with two of them counts once.
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

    /// Whether something was in a cell for more than a twentieth of the time. The cell's column and row
    /// count from the world's origin.
    pub(super) fn is_moving(&self, col: i32, row: i32) -> bool {
        let count = self.frame.cell(col, row).map_or(0, |cell| self.counts[cell]);
        f64::from(count) > MOVING_SHARE * f64::from(self.samples)
    }

    /// Whether something was in the cell that contains a point for more than a twentieth of the time.
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
    use envgen::geometry::Shape;
    use envgen::scenario::{Door, DoorControl, DoorKind, Person, Reaction, Scenario, ScenarioSpec};
    use envgen::world::{Doorway, World};
    use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};

    use super::*;
    use crate::map::{CLAMP, CellIndex, OccupancyMap};
    use crate::mappable_area::tests::{add_wall, room};
    use crate::robot::Robot;
    use crate::score::tests::run;
    use crate::score::{Reference, RunSummary, Scores};

    /// The cells that a person who waits at a point sweeps in so many of 20 samples.
    fn waits(world: &World, position: DVec2, samples: u32) -> SweptCells {
        let nothing = scenario(world);
        let mut scenario = nothing.clone();
        let reaction = Reaction::Impassive;
        scenario.people = vec![Person { position, heading: 0.0, speed: 1.0, reaction }];
        let states = [nothing, scenario].map(|one| ScenarioState::new(world, &one).unwrap());
        let mut swept = SweptCells::new(world.bounds);
        (0..20).for_each(|i| swept.add(&states[usize::from(i < samples)]));
        swept
    }

    fn scenario(world: &World) -> Scenario {
        Scenario::new(world, &ScenarioSpec::default(), Seed(1)).expect("a scenario")
    }

    /// The scores of a map, without and with what moved.
    fn scores(truth: &Reference, map: &OccupancyMap, swept: &SweptCells) -> [Scores; 2] {
        [None, Some((swept, 0))].map(|moving| {
            Scores::of(truth, &RunSummary { moving, ..run(map) }).expect("a sound run")
        })
    }

    /// Sets the cells of a map in a rectangle.
    fn paint(map: &mut OccupancyMap, (min, max): (DVec2, DVec2), odds: i16) {
        let (first, last) = (CellIndex::of(min), CellIndex::of(max));
        for row in first.row..last.row {
            for col in first.col..last.col {
                // The second one outweighs what was there.
                (0..2).for_each(|_| map.add(CellIndex { col, row }, odds));
            }
        }
        map.bounds().into_iter().for_each(|bounds| map.touch(bounds));
    }

    const V: fn(f64, f64) -> DVec2 = DVec2::new;

    #[test]
    fn what_a_map_shows_of_a_person_is_a_ghost_and_no_error() {
        let world = room(6.0, 4.0);
        let truth = Reference::new(&world, &Robot::default()).expect("a world with free space");
        let mut map = truth.perfect_map();
        // Nine score cells where the person is, two where nobody is.
        paint(&mut map, (V(2.901, 1.901), V(3.201, 2.201)), CLAMP);
        let often = waits(&world, V(3.05, 2.05), 2);
        let [without, with] = scores(&truth, &map, &often);
        assert!(without.precision_30 < 1.0 && without.wall_distance > with.wall_distance);
        assert_eq!((with.precision_30, with.precision_15), (1.0, 1.0));
        let moving = with.moving.expect("something moved");
        assert!((moving.ghost_area - 0.09).abs() < 1e-12, "{}", moving.ghost_area);
        // A twentieth of the time is not more than that.
        let [_, seldom] = scores(&truth, &map, &waits(&world, V(3.05, 2.05), 1));
        assert_eq!(seldom.precision_30, without.precision_30);
        assert_eq!(seldom.moving.map(|moving| moving.ghost_area), Some(0.0));
        // What is elsewhere is wrong, and no ghost.
        paint(&mut map, (V(4.501, 1.901), V(4.701, 2.001)), CLAMP);
        let [_, more] = scores(&truth, &map, &often);
        assert!(more.precision_30 < 1.0 && more.precision_30 > without.precision_30);
        assert_eq!(more.moving, with.moving);
    }

    #[test]
    fn a_wall_behind_a_person_need_not_be_found() {
        let world = room(6.0, 4.0);
        let truth = Reference::new(&world, &Robot::default()).expect("a world with free space");
        let mut map = truth.perfect_map();
        paint(&mut map, (V(-0.2, 1.6), V(0.1, 2.4)), -CLAMP);
        let [without, with] = scores(&truth, &map, &waits(&world, V(0.26, 2.0), 2));
        assert!(without.recall_30 < 1.0 && without.wall_distance > with.wall_distance);
        assert_eq!(with.recall_30, 1.0);
        let [_, seldom] = scores(&truth, &map, &waits(&world, V(0.26, 2.0), 1));
        assert_eq!(seldom.recall_30, without.recall_30);
    }

    #[test]
    fn walls_where_people_were_are_no_ghosts() {
        let world = room(6.0, 4.0);
        let truth = Reference::new(&world, &Robot::default()).expect("a world with free space");
        let swept = waits(&world, V(0.26, 2.0), 20);
        let moving = scores(&truth, &truth.perfect_map(), &swept)[1].moving;
        assert_eq!(moving.map(|moving| moving.ghost_area), Some(0.0));
    }

    #[test]
    fn what_a_map_shows_of_a_leaf_is_a_ghost_and_no_error() {
        let mut world = room(8.0, 4.0);
        add_wall(&mut world, (3.9, 0.0), (4.1, 1.5));
        add_wall(&mut world, (3.9, 2.5), (4.1, 4.0));
        let opening = Shape::from_rect(Rect::new(V(3.9, 1.5), V(4.1, 2.5)));
        world.doorways.push(Doorway::new(opening, true, [None, None]));
        let mut scenario = scenario(&world);
        let (kind, control) = (DoorKind::Sliding, DoorControl::Triggered);
        let (far_end, to_right, open, closed, slam) = (false, false, 20.0, 20.0, 0.0);
        scenario.doors =
            vec![Door { doorway: 0, kind, far_end, to_right, control, open, closed, slam }];
        // Nobody opens it.
        let state = ScenarioState::new(&world, &scenario).expect("a state");
        let mut swept = SweptCells::new(world.bounds);
        swept.add(&state);
        let truth = Reference::new(&world, &Robot::default()).expect("a world with free space");
        let mut map = truth.perfect_map();
        paint(&mut map, (V(3.901, 1.501), V(4.001, 2.501)), CLAMP);
        let [without, with] = scores(&truth, &map, &swept);
        assert!(without.precision_30 < 1.0, "{}", without.precision_30);
        assert_eq!((with.precision_30, with.precision_15), (1.0, 1.0));
        // One score cell wide, and as long as the leaf but for what is near the jambs.
        let ghosts = with.moving.map_or(0.0, |moving| moving.ghost_area);
        assert!((0.05..0.1).contains(&ghosts), "{ghosts}");
    }

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
