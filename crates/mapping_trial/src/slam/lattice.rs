//! The coarse lattice of scan matching, searched exactly by branch and bound (Olson, Real-Time
//! Correlative Scan Matching, ICRA 2009, <https://doi.org/10.1109/ROBOT.2009.5152375>).

use envgen::geometry::Pose;
use glam::{DVec2, IVec2};

use super::likelihood::LikelihoodField;
use crate::map::RESOLUTION;

/// Fine steps per cell: 3.1 mm.
pub(super) const FINE: i32 = 16;

pub(super) const FINE_BITS: u32 = FINE.trailing_zeros();

/// A fine step of the heading: 0.06 degrees.
pub const FINE_ANGLE: f64 = 0.06 * std::f64::consts::PI / 180.0;

/// Number of fine steps of the heading in a coarse one.
pub(super) const COARSE_ANGLE: i32 = 8;

/// Weight of the squared deviation from the expected pose, in units of likelihood.
const PRIOR_WEIGHT: f64 = 0.002;

/// Greatest number of cells of a window on each side of its middle.
pub(super) const MOST_STEPS: f64 = 1e3;

/// Number of blocks of a row that are bounded together.
const TOGETHER: usize = 4;

/// The expected pose, and the window in which it is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The expected pose.
    pub centre: Pose,
    /// Standard deviation of its position in metres.
    pub deviation: f64,
    /// Standard deviation of its heading in radians.
    pub heading_deviation: f64,
    /// Half the side of the square that is searched, in metres.
    pub reach: f64,
    /// The largest difference of headings that is searched, in radians.
    pub heading_reach: f64,
}

impl Window {
    /// Returns the window of three standard deviations around an expected pose.
    pub fn around(centre: Pose, deviation: f64, heading_deviation: f64) -> Self {
        let (reach, heading_reach) = (3.0 * deviation, 3.0 * heading_deviation);
        Window { centre, deviation, heading_deviation, reach, heading_reach }
    }

    /// Whether the window can be searched: finite numbers, positive deviations.
    pub(super) fn is_sound(&self) -> bool {
        let Pose { position, heading } = self.centre;
        let sizes = [self.deviation, self.heading_deviation];
        position.is_finite()
            && heading.is_finite()
            && sizes.iter().all(|&size| size > 0.0 && size.is_finite())
            && self.reach >= 0.0
            && self.heading_reach >= 0.0
    }
}

/// A candidate of the search: steps from the expected pose, in fine steps on each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    pub(super) x: i32,
    pub(super) y: i32,
    pub(super) angle: i32,
}

/// Cells x to x + block - 1, y likewise, at one heading.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellBlock {
    bound: f64,
    /// Index of the heading in the list of those that are searched.
    turn: i32,
    x: i32,
    y: i32,
}

/// The lattice of whole cells and coarse headings.
pub(super) struct Lattice<'a> {
    pub(super) field: &'a LikelihoodField,
    /// Sizes of the blocks of the field's levels.
    pub(super) blocks: Vec<i32>,
    /// The levels, those of the largest blocks first.
    pub(super) order: Vec<usize>,
    /// Index in the field of each echo at each heading, heading by heading.
    pub(super) places: &'a [u32],
    /// Number of echoes.
    pub(super) echoes: usize,
    /// The window that is searched.
    pub(super) window: Window,
    /// Number of whole cells that are searched on each side of the expected pose.
    pub(super) cells: i32,
    /// Number of coarse headings that are searched on each side of the expected one.
    pub(super) turns: i32,
}

/// One search over the lattice.
struct BranchAndBound<'a> {
    lattice: &'a Lattice<'a>,
    /// A cell, and the cells around it to each side that are left out.
    excluded: Option<(IVec2, i32)>,
    best: f64,
    found: Step,
}

impl Lattice<'_> {
    /// Bounds the blocks of the largest size.
    pub(super) fn bound_roots(&self, roots: &mut Vec<CellBlock>) {
        roots.clear();
        let Some(&top) = self.order.first() else { return };
        let size = self.blocks[top];
        for turn in -self.turns..=self.turns {
            for y in (-self.cells..=self.cells).step_by(size as usize) {
                self.bound_row(top, turn, (-self.cells, self.cells), y, |block| roots.push(block));
            }
        }
    }

    /// Returns the best step, or the best that is as far from a position as `apart` says; `None` if no
    /// step is that far.
    pub(super) fn best(
        &self,
        roots: &[CellBlock],
        rest: &mut Vec<CellBlock>,
        apart: Option<(DVec2, f64)>,
    ) -> Option<Step> {
        let mut search = BranchAndBound {
            lattice: self,
            excluded: apart.map(|(at, apart)| {
                let middle = ((at - self.window.centre.position) / RESOLUTION).round().as_ivec2();
                (middle, (apart / RESOLUTION).ceil().min(MOST_STEPS) as i32)
            }),
            best: f64::NEG_INFINITY,
            found: Step { x: 0, y: 0, angle: 0 },
        };
        // Blocks are searched in the order of their bounds. After the first one few are left to sort.
        let mut first = 0;
        for (i, root) in roots.iter().enumerate() {
            if root.bound.total_cmp(&roots[first].bound).is_gt() {
                first = i;
            }
        }
        search.descend(&self.order, *roots.get(first)?);
        rest.clear();
        let others = roots[..first].iter().chain(&roots[first + 1..]);
        rest.extend(others.filter(|root| !search.is_hopeless(root)));
        by_bound(rest);
        for &root in rest.iter() {
            if search.is_hopeless(&root) {
                break;
            }
            search.descend(&self.order, root);
        }
        (search.best > f64::NEG_INFINITY).then_some(search.found)
    }

    /// Bounds the blocks of a row, from the first x to the last.
    fn bound_row(
        &self,
        level: usize,
        turn: i32,
        (from, to): (i32, i32),
        y: i32,
        mut found: impl FnMut(CellBlock),
    ) {
        let size = self.blocks[level];
        let count = ((to - from) / size + 1) as usize;
        let place = |i: usize| from + i as i32 * size;
        let block = |i: usize, sum: u32| {
            let x = place(i);
            CellBlock { bound: self.bound(sum, level, turn, (x, y)), turn, x, y }
        };
        let sums = match size {
            1 if count >= TOGETHER => Self::sums::<1>,
            4 if count >= TOGETHER => Self::sums::<4>,
            16 if count >= TOGETHER => Self::sums::<16>,
            _ => {
                (0..count).for_each(|i| found(block(i, self.sum(level, turn, place(i), y))));
                return;
            }
        };
        let mut done = 0;
        while done < count {
            // The last ones are bounded together with some that are known already.
            let first = done.min(count - TOGETHER);
            let sums = sums(self, level, turn, place(first), y);
            (done..first + TOGETHER).for_each(|i| found(block(i, sums[i - first])));
            done = first + TOGETHER;
        }
    }

    /// The places of the echoes at a heading, in the field.
    fn places_at(&self, turn: i32) -> &[u32] {
        let first = (turn + self.turns) as usize * self.echoes;
        &self.places[first..first + self.echoes]
    }

    /// The sum of the likelihoods of all echoes in a block.
    fn sum(&self, level: usize, turn: i32, x: i32, y: i32) -> u32 {
        let offset = y * self.field.cols() as i32 + x;
        let cells = self.field.cells(level);
        let look = |&place: &u32| u32::from(cells[place.wrapping_add_signed(offset) as usize]);
        self.places_at(turn).iter().map(look).sum()
    }

    /// The sums of neighbouring blocks of a size in a row: an echo is looked up once for all.
    fn sums<const SIZE: usize>(&self, level: usize, turn: i32, x: i32, y: i32) -> [u32; TOGETHER] {
        let offset = y * self.field.cols() as i32 + x;
        let cells = self.field.cells(level);
        let mut sums = [0; TOGETHER];
        for &place in self.places_at(turn) {
            let at = place.wrapping_add_signed(offset) as usize;
            let row = &cells[at..at + (TOGETHER - 1) * SIZE + 1];
            for (i, sum) in sums.iter_mut().enumerate() {
                *sum += u32::from(row[i * SIZE]);
            }
        }
        sums
    }

    /// The upper bound of the score within a block, from the sum of likelihoods there; the exact score
    /// for a single cell.
    fn bound(&self, sum: u32, level: usize, turn: i32, (x, y): (i32, i32)) -> f64 {
        let last = self.blocks[level] - 1;
        let nearest = |from: i32| 0.clamp(from, from + last) * FINE;
        let response = f64::from(sum) / (255 * self.echoes) as f64;
        response - penalty(self.window, nearest(x), nearest(y), turn * COARSE_ANGLE)
    }
}

impl BranchAndBound<'_> {
    /// Whether a block cannot hold a better step than the best that is known.
    fn is_hopeless(&self, block: &CellBlock) -> bool {
        block.bound <= self.best
    }

    /// Searches a block of the first level of `order`.
    fn descend(&mut self, order: &[usize], block: CellBlock) {
        let [level, finer @ ..] = order else { return };
        let Some(&next) = finer.first() else {
            let is_excluded = self.excluded.is_some_and(|(middle, apart)| {
                (IVec2::new(block.x, block.y) - middle).abs().max_element() < apart
            });
            if block.bound > self.best && !is_excluded {
                self.best = block.bound;
                self.found =
                    Step { x: block.x * FINE, y: block.y * FINE, angle: block.turn * COARSE_ANGLE };
            }
            return;
        };
        let lattice = self.lattice;
        let (size, step) = (lattice.blocks[*level], lattice.blocks[next] as usize);
        let end = |from: i32| (from + size - 1).min(lattice.cells);
        let mut children = Vec::with_capacity(((size * size) as usize).div_ceil(step * step));
        for y in (block.y..=end(block.y)).step_by(step) {
            lattice.bound_row(next, block.turn, (block.x, end(block.x)), y, |child| {
                if child.bound > self.best {
                    children.push(child);
                }
            });
        }
        by_bound(&mut children);
        for child in children {
            if self.is_hopeless(&child) {
                break;
            }
            self.descend(finer, child);
        }
    }
}

/// Puts the most promising blocks first; of equal ones those that came first stay first.
fn by_bound(blocks: &mut [CellBlock]) {
    blocks.sort_by(|a, b| b.bound.total_cmp(&a.bound));
}

/// The penalty of a step away from the expected pose.
pub(super) fn penalty(window: Window, x: i32, y: i32, angle: i32) -> f64 {
    let metres = RESOLUTION / f64::from(FINE);
    let (x, y) = (f64::from(x) * metres, f64::from(y) * metres);
    let turn = f64::from(angle) * FINE_ANGLE / window.heading_deviation;
    PRIOR_WEIGHT * ((x * x + y * y) / (window.deviation * window.deviation) + turn * turn)
}
