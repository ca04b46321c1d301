//! Neighbour queries for people: a grid of cells, and lists of neighbours that are rebuilt at intervals.

use std::ops::Range;

use glam::DVec2;

use super::person::{PERSON_RADIUS, PersonState};
use super::tick::TICK;
use crate::geometry::Rect;
use crate::grid::GridFrame;

/// The distance in metres beyond which people do not avoid each other.
pub(super) const RANGE: f64 = 5.0;

/// The distance in metres beyond which people do not touch each other, whatever the rounding errors are.
const TOUCH: f64 = 2.0 * PERSON_RADIUS + 1e-6;

/// The number of ticks after which the lists are rebuilt.
pub(super) const REBUILD: u64 = 10;

/// Returns the greatest distance in metres that people with a greatest speed can go until the lists are rebuilt.
pub(super) fn drift(max_speed: f64) -> f64 {
    max_speed * REBUILD as f64 * TICK
}

/// The people around each point and each person. The lists contain everyone who can come within range before they
/// are rebuilt (L. Verlet, Physical Review 159, 1967, <https://doi.org/10.1103/PhysRev.159.98>), so that the cost
/// of a step is proportional to the number of neighbours.
#[derive(Clone, Debug)]
pub(crate) struct Neighbourhood {
    frame: GridFrame,
    /// The greatest distance in metres that a person can go until the lists are rebuilt.
    drift: f64,
    starts: Vec<u32>,
    ids: Vec<u32>,
    /// The positions of `ids`.
    placed: Vec<DVec2>,
    /// The positions of all people when the lists were built.
    positions: Vec<DVec2>,
    in_range: Lists,
    in_touch: Lists,
}

/// An entry in the list of a person's neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Neighbour {
    pub(super) person: u32,
    /// The number of the pair that the two form.
    pub(super) pair: u32,
}

/// For each person, the others who can come within a distance before the lists are rebuilt.
#[derive(Clone, Debug)]
struct Lists {
    starts: Vec<u32>,
    neighbours: Vec<Neighbour>,
    /// The pairs of people who are in each other's lists.
    pairs: Vec<[u32; 2]>,
}

impl Lists {
    fn new(people: usize) -> Self {
        Lists { starts: vec![0; people + 1], neighbours: Vec::new(), pairs: Vec::new() }
    }

    #[inline]
    fn of(&self, person: usize) -> &[Neighbour] {
        match self.starts.get(person..person + 2) {
            Some(&[from, to]) => &self.neighbours[from as usize..to as usize],
            _ => &[],
        }
    }

    /// Builds the lists from the pairs.
    fn fill(&mut self) {
        self.starts.fill(0);
        for &i in self.pairs.as_flattened() {
            self.starts[i as usize] += 1;
        }
        counts_to_ends(&mut self.starts);
        self.neighbours.resize(2 * self.pairs.len(), Neighbour::default());
        for (number, &[i, j]) in self.pairs.iter().enumerate().rev() {
            for (one, other) in [(i, j), (j, i)] {
                let start = &mut self.starts[one as usize];
                *start -= 1;
                self.neighbours[*start as usize] = Neighbour { person: other, pair: number as u32 };
            }
        }
    }
}

impl Neighbourhood {
    pub(crate) fn new(bounds: Rect, people: usize, max_speed: f64) -> Self {
        let size = bounds.size();
        let drift = drift(max_speed);
        // So that those who can come within range of each other are in cells that touch.
        let side = (size.x * size.y / people.max(1) as f64).sqrt().max(RANGE + 2.0 * drift);
        let side = side.max(size.max_element() / people.max(16) as f64);
        let count = (size / side).ceil().max(DVec2::ONE);
        let (cols, rows) = (count.x as usize, count.y as usize);
        Neighbourhood {
            frame: GridFrame { origin: bounds.min, cell_size: side, cols, rows },
            drift,
            starts: vec![0; cols * rows + 1],
            ids: vec![0; people],
            placed: Vec::new(),
            positions: Vec::new(),
            in_range: Lists::new(people),
            in_touch: Lists::new(people),
        }
    }

    /// Returns the people who can come within [`RANGE`] of a person before the next rebuild.
    #[inline]
    pub(super) fn of(&self, person: usize) -> &[Neighbour] {
        self.in_range.of(person)
    }

    /// Returns the number of pairs.
    pub(super) fn pair_count(&self) -> usize {
        self.in_range.pairs.len()
    }

    /// Returns the positions of a pair when the lists were built.
    pub(super) fn pair_positions(&self, number: u32) -> [DVec2; 2] {
        self.in_range.pairs[number as usize].map(|i| self.positions[i as usize])
    }

    /// Returns the people whom a person can touch before the next rebuild.
    #[inline]
    pub(super) fn touchable(&self, person: usize) -> &[Neighbour] {
        self.in_touch.of(person)
    }

    pub(crate) fn rebuild(&mut self, people: &[PersonState]) {
        self.starts.fill(0);
        let cell = |p: DVec2| {
            let (col, row) = self.clamped(p);
            self.frame.index(col, row)
        };
        let cells: Vec<usize> = people.iter().map(|person| cell(person.position)).collect();
        for &cell in &cells {
            self.starts[cell] += 1;
        }
        counts_to_ends(&mut self.starts);
        // Filled from the back, each start moves from the end of its cell to its beginning.
        for (i, &cell) in cells.iter().enumerate().rev() {
            self.starts[cell] -= 1;
            self.ids[self.starts[cell] as usize] = i as u32;
        }
        self.positions.clear();
        self.positions.extend(people.iter().map(|person| person.position));
        self.find_pairs();
        self.in_range.fill();
        self.in_touch.fill();
    }

    /// Finds the pairs of people who can come within range of each other. They are in the same cell or in adjacent
    /// cells.
    fn find_pairs(&mut self) {
        let [range2, touch2] = [RANGE, TOUCH].map(|reach| {
            let reach = reach + 2.0 * self.drift;
            reach * reach
        });
        let Neighbourhood { frame, starts, ids, placed, positions, in_range, in_touch, .. } = self;
        placed.clear();
        placed.extend(ids.iter().map(|&i| positions[i as usize]));
        let (pairs, touching) = (&mut in_range.pairs, &mut in_touch.pairs);
        touching.clear();
        let mut count = 0;
        let start = |cell: usize| starts[cell] as usize;
        for row in 0..frame.rows {
            for col in 0..frame.cols {
                let cell = frame.index(col, row);
                let own = start(cell)..start(cell + 1);
                if own.is_empty() {
                    continue;
                }
                // Each pair once: with those behind in the order of the cells.
                let (left, right) = (col.saturating_sub(1), (col + 1).min(frame.cols - 1));
                let beside = start(frame.index(right, row) + 1);
                let above = match row + 1 < frame.rows {
                    true => {
                        start(frame.index(left, row + 1))..start(frame.index(right, row + 1) + 1)
                    }
                    false => 0..0,
                };
                for k in own {
                    let (i, p) = (ids[k], placed[k]);
                    for run in [k + 1..beside, above.clone()] {
                        if pairs.len() < count + run.len() {
                            pairs.resize(2 * (count + run.len()), [0; 2]);
                        }
                        for (&j, q) in ids[run.clone()].iter().zip(&placed[run]) {
                            let distance2 = p.distance_squared(*q);
                            // Without a branch, which would be hard to predict.
                            pairs[count] = [i, j];
                            count += usize::from(distance2 <= range2);
                            if distance2 <= touch2 {
                                touching.push([i, j]);
                            }
                        }
                    }
                }
            }
        }
        pairs.truncate(count);
    }

    /// Whether a test holds for one of the people who may be within `reach` metres of a point.
    pub(crate) fn any(&self, p: DVec2, reach: f64, mut test: impl FnMut(usize) -> bool) -> bool {
        let mut runs = self.runs(p, reach + self.drift);
        runs.any(|run| self.ids[run].iter().any(|&i| test(i as usize)))
    }

    /// Returns the ranges of `ids` that are in the cells within `reach` metres of a point.
    fn runs(&self, p: DVec2, reach: f64) -> impl Iterator<Item = Range<usize>> + use<'_> {
        let (left, bottom) = self.clamped(p - reach);
        let (right, top) = self.clamped(p + reach);
        (bottom..=top).map(move |row| {
            let (from, to) = (self.frame.index(left, row), self.frame.index(right, row));
            self.starts[from] as usize..self.starts[to + 1] as usize
        })
    }

    /// Returns the column and row of the cell that is nearest to a point.
    fn clamped(&self, p: DVec2) -> (usize, usize) {
        let cell = (p - self.frame.origin) / self.frame.cell_size;
        // Negative numbers and NaN become 0.
        ((cell.x as usize).min(self.frame.cols - 1), (cell.y as usize).min(self.frame.rows - 1))
    }
}

/// Replaces the number of entries of each list by the index at which the list ends.
fn counts_to_ends(counts: &mut [u32]) {
    let mut end = 0;
    for count in counts {
        end += *count;
        *count = end;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::scenario::person::{Person, Reaction};

    proptest! {
        // Also with people outside of the bounds, and with a single row or column of cells.
        #[test]
        fn lists_hold_whom_a_person_can_meet(
            positions in prop::collection::vec([-9.0..49.0, -9.0..29.0], 0..80),
            origin in [-50.0..50.0, -50.0..50.0],
            size in [1.0..40.0, 1.0..20.0],
            max_speed in 0.6..3.0,
        ) {
            let origin = DVec2::from(origin);
            let person = |&p: &[f64; 2]| Person {
                position: origin + DVec2::from(p),
                heading: 0.0,
                speed: 1.0,
                reaction: Reaction::Regular,
            };
            let people: Vec<PersonState> =
                positions.iter().map(|p| PersonState::new(&person(p), 0)).collect();
            let bounds = Rect::new(origin, origin + DVec2::from(size));
            let mut near = Neighbourhood::new(bounds, people.len(), max_speed);
            near.rebuild(&people);
            for (i, one) in people.iter().enumerate() {
                let sorted = |list: &[Neighbour]| {
                    let mut list: Vec<u32> = list.iter().map(|other| other.person).collect();
                    list.sort_unstable();
                    list
                };
                let within = |reach: f64| -> Vec<u32> {
                    let reach = reach + 2.0 * drift(max_speed);
                    let others = (0..people.len()).filter(|&j| {
                        i != j && one.position.distance(people[j].position) <= reach
                    });
                    others.map(|j| j as u32).collect()
                };
                prop_assert_eq!(sorted(near.of(i)), within(RANGE));
                prop_assert_eq!(sorted(near.touchable(i)), within(TOUCH));
                for other in near.of(i) {
                    let both = [one.position, people[other.person as usize].position];
                    let [a, b] = near.pair_positions(other.pair);
                    prop_assert!(both == [a, b] || both == [b, a]);
                }
            }
        }
    }
}
