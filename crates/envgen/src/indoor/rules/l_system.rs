//! The second hallway layout: a branching network, grown by an L-system.
//!
//! Zwennes' conclusion is that "the generator could only generate one type of hallway layout", and his future work
//! names L-systems, as Parish and Müller (Procedural modeling of cities, SIGGRAPH 2001,
//! <https://doi.org/10.1145/383259.383292>) use them for streets. This is a small version of their system. Its
//! alphabet is F(n), a hallway of n cells; A, a tip that grows; and the turtle's + - [ ]. The axiom is a straight
//! hallway through the map, and a tip is rewritten as
//!
//! ```text
//! A -> F(n) A  |  F(n) [+A] A  |  F(n) [-A] A  |  F(n) [+A] [-A] A
//! ```
//! where each bracket occurs with the probability `branching` (in the axiom one occurs for sure, unless that
//! probability is 0), and n is about the distance between hallways that the difficulty gives. The environment
//! limits the hallway that F draws: it ends at the map's edge. If it meets another hallway, it joins that hallway
//! with the same probability, if loops are allowed, or ends one cell before it.

use std::collections::VecDeque;

use crate::indoor::adaptation::LEAST_SPACING;
use crate::indoor::grid::{Cell, Grid};
use crate::seed::Stream;

/// The parameters of the system.
pub(in crate::indoor) struct Law {
    /// Mean length of a hallway between two branches, along x and along y, in cells.
    pub(in crate::indoor) spacing: [u32; 2],
    /// Probability of each branch, and of a loop where two hallways meet.
    pub(in crate::indoor) branching: f64,
    /// Whether hallways may join and thus close a loop.
    pub(in crate::indoor) loops: bool,
}

/// A growing tip, with its position and direction.
#[derive(Clone, Copy)]
struct Tip {
    x: u32,
    y: u32,
    direction: Direction,
}

/// A step in cells, y down.
type Direction = (i32, i32);

/// Grows a connected network. Every rewriting step fills a cell or ends its tip, so that the growth stops after at
/// most one step per cell.
pub(in crate::indoor) fn grow(grid: &mut Grid, law: &Law, stream: &mut Stream) {
    // The axiom: from a cell in the middle half of the map, in both directions.
    let middle = |size: u32, stream: &mut Stream| {
        size / 4 + stream.below(u64::from(size.div_ceil(2))) as u32
    };
    let (x, y) = (middle(grid.width(), stream), middle(grid.height(), stream));
    let along: Direction = if stream.chance(0.5) { (1, 0) } else { (0, 1) };
    grid.set(x, y, Cell::Hallway);
    let mut tips = VecDeque::new();
    for direction in [along, (-along.0, -along.1)] {
        tips.push_back(Tip { x, y, direction });
    }
    let sides = tips_at(x, y, along);
    branch(&mut tips, sides, law, stream);
    // One straight hallway is not a net yet; beside it there is always room.
    if tips.len() == 2 && law.branching > 0.0 {
        tips.push_back(sides[stream.below(2) as usize]);
    }
    while let Some(tip) = tips.pop_front() {
        let spacing = law.spacing[usize::from(tip.direction.0 == 0)];
        let length = (spacing + stream.below(3) as u32).saturating_sub(1).max(LEAST_SPACING);
        let Some(end) = draw(grid, tip, length, law, stream) else { continue };
        branch(&mut tips, tips_at(end.x, end.y, end.direction), law, stream);
        tips.push_back(end);
    }
}

/// Returns the two tips at the sides of a hallway.
fn tips_at(x: u32, y: u32, (dx, dy): Direction) -> [Tip; 2] {
    [(dy, -dx), (-dy, dx)].map(|direction| Tip { x, y, direction })
}

fn branch(tips: &mut VecDeque<Tip>, sides: [Tip; 2], law: &Law, stream: &mut Stream) {
    for side in sides {
        if stream.chance(law.branching) {
            tips.push_back(side);
        }
    }
}

/// Draws F(n); returns the tip at its end, or `None` if the hallway ended.
fn draw(grid: &mut Grid, tip: Tip, length: u32, law: &Law, stream: &mut Stream) -> Option<Tip> {
    let mut tip = tip;
    for _ in 0..length {
        let (x, y) = step(grid, tip.x, tip.y, tip.direction)?;
        if grid.at(x, y) != Cell::Solid {
            return None;
        }
        // One neighbour is the growing hallway; a second one is a hallway that it meets.
        let neighbours = [(1, 0), (0, 1), (-1, 0), (0, -1)]
            .into_iter()
            .filter_map(|direction| step(grid, x, y, direction))
            .filter(|&(x, y)| grid.at(x, y) == Cell::Hallway)
            .count();
        if neighbours > 1 {
            let joins = law.loops && stream.chance(law.branching);
            if joins && !makes_square(grid, x, y) {
                grid.set(x, y, Cell::Hallway);
            }
            return None;
        }
        if makes_square(grid, x, y) {
            return None;
        }
        grid.set(x, y, Cell::Hallway);
        (tip.x, tip.y) = (x, y);
    }
    Some(tip)
}

fn step(grid: &Grid, x: u32, y: u32, (dx, dy): Direction) -> Option<(u32, u32)> {
    let (x, y) = (x.checked_add_signed(dx)?, y.checked_add_signed(dy)?);
    (x < grid.width() && y < grid.height()).then_some((x, y))
}

/// Whether a hallway at a cell would fill a square of four.
fn makes_square(grid: &Grid, x: u32, y: u32) -> bool {
    let hallway =
        |dx, dy| step(grid, x, y, (dx, dy)).is_some_and(|(x, y)| grid.at(x, y) == Cell::Hallway);
    [(1, 1), (1, -1), (-1, 1), (-1, -1)]
        .into_iter()
        .any(|(dx, dy)| hallway(dx, 0) && hallway(0, dy) && hallway(dx, dy))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::indoor::access::{HallwayShape, hallway_shape};
    use crate::seed::Seed;
    use proptest::prelude::*;

    fn shape(seed: u64, size: u32, branching: f64, loops: bool) -> (HallwayShape, Grid) {
        let mut grid = Grid::new(size, size);
        let law = Law { spacing: [5, 5], branching, loops };
        grow(&mut grid, &law, &mut Seed(seed).stream("test", 0));
        (hallway_shape(&grid), grid)
    }

    proptest! {
        #[test]
        fn the_net_is_connected_and_one_cell_wide(
            seed: u64, size in 4..60_u32, branching in 0.0..=1.0_f64, loops: bool,
        ) {
            let (shape, grid) = shape(seed, size, branching, loops);
            prop_assert_eq!(shape.parts, 1);
            prop_assert!(loops || shape.cycles == 0);
            prop_assert!(shape.cells >= u64::from(size));
            for y in 1..size {
                for x in 1..size {
                    let square = [(x, y), (x - 1, y), (x, y - 1), (x - 1, y - 1)];
                    prop_assert!(square.iter().any(|&(x, y)| grid.at(x, y) == Cell::Solid));
                }
            }
        }
    }

    #[test]
    fn branches_and_loops_rise_with_the_parameter() {
        // Means of 400 nets each; neighbouring parameters differ by far more than the means err.
        let means: Vec<(f64, f64)> = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]
            .into_iter()
            .map(|branching| {
                let shapes: Vec<_> =
                    (0..400).map(|seed| shape(seed, 40, branching, true).0).collect();
                let mean = |f: fn(&HallwayShape) -> u64| {
                    shapes.iter().map(|shape| f(shape) as f64).sum::<f64>() / 400.0
                };
                (mean(|shape| shape.cells), mean(|shape| shape.cycles))
            })
            .collect();
        assert_eq!(means[0], (40.0, 0.0));
        for pair in means.windows(2) {
            assert!(pair[1].0 > pair[0].0 && pair[1].1 > pair[0].1, "{means:?}");
        }
    }

    #[test]
    fn one_branch_is_certain() {
        for seed in 0..300 {
            for (size, branching) in [(4, 0.5), (16, 0.01), (16, 0.5), (40, 0.2)] {
                let (shape, _) = shape(seed, size, branching, seed % 2 == 0);
                assert!(shape.ends > 2 || shape.cycles > 0, "seed {seed}: {shape:?}");
            }
        }
    }

    #[test]
    fn without_loops_it_is_a_tree() {
        let (shape, _) = shape(5, 40, 1.0, false);
        assert_eq!(shape.cycles, 0);
        assert!(shape.ends > 10 && shape.cells > 200, "{shape:?}");
    }
}
