//! Correlative scan matching (Olson, Real-Time Correlative Scan Matching, ICRA 2009): the pose near
//! an expected one at which a scan fits a likelihood field best.

use envgen::geometry::{Pose, unit_vector, wrap_angle};
use glam::{DVec2, Vec2};

use super::likelihood::LikelihoodField;
use crate::map::RESOLUTION;

/// Fine steps a cell: 3.1 mm.
const FINE: i32 = 16;

const FINE_BITS: u32 = FINE.trailing_zeros();

/// A fine step of the heading: 0.06 degrees.
pub const FINE_ANGLE: f64 = 0.06 * std::f64::consts::PI / 180.0;

/// Fine steps of the heading in a coarse one.
const COARSE_ANGLE: i32 = 8;

/// Steps of the refinement: in 1/16 cells, and in fine angles.
const REFINEMENT: [(i32, i32); 4] = [(8, 4), (4, 2), (2, 1), (1, 1)];

/// Weight of the squared deviation from the expected pose, in likelihood.
const PRIOR_WEIGHT: f64 = 0.002;

/// Moves of the refinement at most, at each step size.
const MOST_MOVES: usize = 64;

/// Where a pose is expected, and where it is looked for.
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
    /// Three standard deviations around an expected pose.
    pub fn around(centre: Pose, deviation: f64, heading_deviation: f64) -> Self {
        let (reach, heading_reach) = (3.0 * deviation, 3.0 * heading_deviation);
        Window { centre, deviation, heading_deviation, reach, heading_reach }
    }

    /// Whether there is anything to be searched: finite numbers, positive deviations.
    fn is_sound(&self) -> bool {
        let Pose { position, heading } = self.centre;
        let sizes = [self.deviation, self.heading_deviation];
        position.is_finite()
            && heading.is_finite()
            && sizes.iter().all(|&size| size > 0.0 && size.is_finite())
            && self.reach >= 0.0
            && self.heading_reach >= 0.0
    }
}

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// The pose of the highest score.
    pub pose: Pose,
    /// Mean likelihood of the echoes there, 0 to 1.
    pub response: f64,
    /// Response minus the penalty for what deviates from the expected pose.
    pub score: f64,
}

/// A place of the search: steps from the expected pose, in fine steps on each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Step {
    x: i32,
    y: i32,
    angle: i32,
}

/// Cells x to x + block - 1, y likewise, at one heading.
#[derive(Clone, Copy, Debug)]
struct Block {
    bound: f64,
    /// Place of the heading in the list of those that are searched.
    turn: i32,
    x: i32,
    y: i32,
}

/// Matches scans; it holds what is used again from scan to scan.
#[derive(Clone, Debug, Default)]
pub struct Matcher {
    /// Place in the field of each echo at each heading, heading by heading.
    places: Vec<u32>,
    /// Echoes at one heading in fine steps from the field's corner, for the refinement.
    fine: Vec<(i32, i32)>,
    roots: Vec<Block>,
}

/// One search over the lattice of whole cells and coarse headings.
struct Search<'a> {
    field: &'a LikelihoodField,
    blocks: Vec<i32>,
    places: &'a [u32],
    echoes: usize,
    window: Window,
    /// Whole cells that are searched on each side of the expected pose.
    cells: i32,
    /// Coarse headings likewise.
    turns: i32,
    best: f64,
    found: Step,
}

impl Matcher {
    /// A matcher.
    pub fn new() -> Self {
        Matcher::default()
    }

    /// Finds where the echoes of a scan, in metres in the robot's frame, fit best. First the best
    /// place of a lattice of whole cells and headings 0.48 degrees apart is found, exactly, by
    /// branch and bound on the pooled levels; from there the interpolated likelihood is climbed in
    /// halved steps down to 3 mm and 0.06 degrees.
    ///
    /// The field is to cover the scan wherever in the window it may lie; see
    /// [`Matcher::radius`]. `None` without an echo, or when it does not.
    pub fn find(
        &mut self,
        field: &LikelihoodField,
        echoes: &[Vec2],
        window: Window,
    ) -> Option<Match> {
        let coarse = self.coarse(field, echoes, window)?;
        Some(self.refine(field, echoes, window, coarse))
    }

    /// As [`Matcher::find`], without the refinement.
    pub fn find_coarse(
        &mut self,
        field: &LikelihoodField,
        echoes: &[Vec2],
        window: Window,
    ) -> Option<Match> {
        let step = self.coarse(field, echoes, window)?;
        let places = &mut self.fine;
        turn_into(places, field, echoes, window.centre, step.angle);
        let sum: u64 = places.iter().map(|&(x, y)| nearest(field, x + step.x, y + step.y)).sum();
        let response = sum as f64 / (255 * echoes.len()) as f64;
        let score = response - penalty(window, step.x, step.y, step.angle);
        Some(Match { pose: pose_at(window.centre, step), response, score })
    }

    /// Half the side in metres of the square around a window's centre that a field has to cover,
    /// for a scan that reaches `scan` metres from the robot.
    pub fn radius(scan: f64, window: &Window) -> f64 {
        scan + window.reach + 2.0 * RESOLUTION
    }

    /// The best step of the coarse lattice.
    fn coarse(&mut self, field: &LikelihoodField, echoes: &[Vec2], window: Window) -> Option<Step> {
        let cells = (window.reach / RESOLUTION).ceil().min(1e3) as i32;
        let turns = (window.heading_reach / (f64::from(COARSE_ANGLE) * FINE_ANGLE)).ceil();
        let turns = turns.min(4e2) as i32;
        let blocks: Vec<i32> = field.blocks().collect();
        let largest = blocks.iter().copied().max()?;
        if echoes.is_empty() || field.cols() == 0 || !window.is_sound() {
            return None;
        }

        self.places.clear();
        let cols = field.cols() as i32;
        let rows = (field.cells(0).len() / field.cols()) as i32;
        // The search looks at blocks that begin up to a block below the window.
        let (low, high) = (cells + largest, cells + largest);
        for turn in -turns..=turns {
            turn_into(&mut self.fine, field, echoes, window.centre, turn * COARSE_ANGLE);
            for &(x, y) in &self.fine {
                let (col, row) = (x >> FINE_BITS, y >> FINE_BITS);
                if col < low || row < low || col + high >= cols || row + high >= rows {
                    return None;
                }
                self.places.push((row * cols + col) as u32);
            }
        }
        let mut search = Search {
            field,
            blocks,
            places: &self.places,
            echoes: echoes.len(),
            window,
            cells,
            turns,
            best: f64::NEG_INFINITY,
            found: Step { x: 0, y: 0, angle: 0 },
        };
        search.run(&mut self.roots);
        Some(search.found)
    }

    /// Climbs from a step of the coarse lattice.
    fn refine(
        &mut self,
        field: &LikelihoodField,
        echoes: &[Vec2],
        window: Window,
        from: Step,
    ) -> Match {
        // Turns are about the middle of the echoes, so that they do not shift the whole scan.
        let sum = echoes.iter().fold(DVec2::ZERO, |sum, p| sum + p.as_dvec2());
        let middle = sum / echoes.len() as f64;
        let lever = |angle: i32| {
            let heading = window.centre.heading + f64::from(angle) * FINE_ANGLE;
            unit_vector(heading).rotate(middle) * (f64::from(FINE) / RESOLUTION)
        };
        let per_echo = 1.0 / ((255 * FINE * FINE) as f64 * echoes.len() as f64);
        let score = |places: &[(i32, i32)], step: Step| {
            let response = interpolated(field, places, step.x, step.y) as f64 * per_echo;
            (response - penalty(window, step.x, step.y, step.angle), response)
        };
        let (most, most_angle) = (
            (window.reach / RESOLUTION).ceil() as i32 * FINE,
            (window.heading_reach / FINE_ANGLE).ceil() as i32,
        );
        let inside = |step: Step| {
            step.x.abs() <= most && step.y.abs() <= most && step.angle.abs() <= most_angle
        };

        let mut at = from;
        let mut turned = Vec::with_capacity(echoes.len());
        turn_into(&mut self.fine, field, echoes, window.centre, at.angle);
        let mut best = score(&self.fine, at);
        for (shift, angle) in REFINEMENT {
            for _ in 0..MOST_MOVES {
                let before = at;
                for (dx, dy) in [(shift, 0), (-shift, 0), (0, shift), (0, -shift)] {
                    let step = Step { x: at.x + dx, y: at.y + dy, ..at };
                    if inside(step) {
                        let tried = score(&self.fine, step);
                        if tried.0 > best.0 {
                            (at, best) = (step, tried);
                        }
                    }
                }
                for turn in [angle, -angle] {
                    let swing = (lever(at.angle) - lever(at.angle + turn)).round().as_ivec2();
                    let step =
                        Step { x: at.x + swing.x, y: at.y + swing.y, angle: at.angle + turn };
                    if inside(step) {
                        turn_into(&mut turned, field, echoes, window.centre, step.angle);
                        let tried = score(&turned, step);
                        if tried.0 > best.0 {
                            (at, best) = (step, tried);
                            std::mem::swap(&mut turned, &mut self.fine);
                        }
                    }
                }
                if at == before {
                    break;
                }
            }
        }
        Match { pose: pose_at(window.centre, at), response: best.1, score: best.0 }
    }
}

impl Search<'_> {
    fn run(&mut self, roots: &mut Vec<Block>) {
        // From the largest blocks to single cells.
        let mut order: Vec<usize> = (0..self.blocks.len()).collect();
        order.sort_by_key(|&level| std::cmp::Reverse(self.blocks[level]));
        let Some(&top) = order.first() else { return };
        let size = self.blocks[top];
        roots.clear();
        for turn in -self.turns..=self.turns {
            for y in (-self.cells..=self.cells).step_by(size as usize) {
                for x in (-self.cells..=self.cells).step_by(size as usize) {
                    let bound = self.bound(top, turn, x, y);
                    roots.push(Block { bound, turn, x, y });
                }
            }
        }
        by_bound(roots);
        for &root in roots.iter() {
            if root.bound <= self.best {
                break;
            }
            self.descend(&order, root);
        }
    }

    /// Looks into a block of the first level of `order`.
    fn descend(&mut self, order: &[usize], block: Block) {
        let [level, finer @ ..] = order else { return };
        let Some(&next) = finer.first() else {
            if block.bound > self.best {
                self.best = block.bound;
                self.found =
                    Step { x: block.x * FINE, y: block.y * FINE, angle: block.turn * COARSE_ANGLE };
            }
            return;
        };
        let (size, step) = (self.blocks[*level], self.blocks[next] as usize);
        let end = |from: i32| (from + size - 1).min(self.cells);
        let mut children = Vec::with_capacity(((size * size) as usize).div_ceil(step * step));
        for y in (block.y..=end(block.y)).step_by(step) {
            for x in (block.x..=end(block.x)).step_by(step) {
                let bound = self.bound(next, block.turn, x, y);
                if bound > self.best {
                    children.push(Block { bound, turn: block.turn, x, y });
                }
            }
        }
        by_bound(&mut children);
        for child in children {
            if child.bound <= self.best {
                break;
            }
            self.descend(finer, child);
        }
    }

    /// The most that a step within a block can score; what it does score for a single cell.
    fn bound(&self, level: usize, turn: i32, x: i32, y: i32) -> f64 {
        let offset = y * self.field.cols() as i32 + x;
        let first = (turn + self.turns) as usize * self.echoes;
        let cells = self.field.cells(level);
        let places = &self.places[first..first + self.echoes];
        let look = |&place: &u32| u64::from(cells[place.wrapping_add_signed(offset) as usize]);
        let sum: u64 = places.iter().map(look).sum();
        let last = self.blocks[level] - 1;
        let nearest = |from: i32| 0.clamp(from, from + last) * FINE;
        let response = sum as f64 / (255 * self.echoes) as f64;
        response - penalty(self.window, nearest(x), nearest(y), turn * COARSE_ANGLE)
    }
}

/// Puts the most promising blocks first; of equal ones those that came first stay first.
fn by_bound(blocks: &mut [Block]) {
    blocks.sort_by(|a, b| b.bound.total_cmp(&a.bound));
}

/// What a step away from the expected pose costs.
fn penalty(window: Window, x: i32, y: i32, angle: i32) -> f64 {
    let metres = RESOLUTION / f64::from(FINE);
    let (x, y) = (f64::from(x) * metres, f64::from(y) * metres);
    let turn = f64::from(angle) * FINE_ANGLE / window.heading_deviation;
    PRIOR_WEIGHT * ((x * x + y * y) / (window.deviation * window.deviation) + turn * turn)
}

fn pose_at(centre: Pose, step: Step) -> Pose {
    let shift = DVec2::new(f64::from(step.x), f64::from(step.y)) * (RESOLUTION / f64::from(FINE));
    Pose {
        position: centre.position + shift,
        heading: wrap_angle(centre.heading + f64::from(step.angle) * FINE_ANGLE),
    }
}

/// Echoes at a heading some fine steps from the expected one, in fine steps from the field's
/// corner.
fn turn_into(
    places: &mut Vec<(i32, i32)>,
    field: &LikelihoodField,
    echoes: &[Vec2],
    centre: Pose,
    angle: i32,
) {
    let per_cell = 1.0 / RESOLUTION;
    let scale = (f64::from(FINE) * per_cell) as f32;
    let axis = unit_vector(centre.heading + f64::from(angle) * FINE_ANGLE).as_vec2() * scale;
    // The pose lies within the field, so that single precision is far finer than a fine step.
    let base = (centre.position * per_cell - field.origin().as_dvec2()) * f64::from(FINE);
    let base = base.as_vec2();
    places.clear();
    places.extend(echoes.iter().map(|p| {
        let x = base.x + (axis.x * p.x - axis.y * p.y);
        let y = base.y + (axis.y * p.x + axis.x * p.y);
        (x as i32, y as i32)
    }));
}

/// The likelihood at a place in fine steps, of the cell that holds it.
fn nearest(field: &LikelihoodField, x: i32, y: i32) -> u64 {
    let index = (y >> FINE_BITS) as usize * field.cols() + (x >> FINE_BITS) as usize;
    u64::from(field.cells(0)[index])
}

/// The sum over all echoes of the likelihood between the middles of cells, in 1/65280.
fn interpolated(field: &LikelihoodField, places: &[(i32, i32)], dx: i32, dy: i32) -> u64 {
    let (cells, cols) = (field.cells(0), field.cols());
    let (dx, dy) = (dx - FINE / 2, dy - FINE / 2);
    let mut sum = 0;
    for &(x, y) in places {
        let (x, y) = (x + dx, y + dy);
        let index = (y >> FINE_BITS) as usize * cols + (x >> FINE_BITS) as usize;
        let (u, v) = ((x & (FINE - 1)) as u32, (y & (FINE - 1)) as u32);
        let across =
            |at: usize| u32::from(cells[at]) * (FINE as u32 - u) + u32::from(cells[at + 1]) * u;
        sum += u64::from(across(index) * (FINE as u32 - v) + across(index + cols) * v);
    }
    sum
}
