//! Correlative scan matching (Olson, Real-Time Correlative Scan Matching, ICRA 2009,
//! <https://doi.org/10.1109/ROBOT.2009.5152375>): finds the pose near an expected one at which a scan
//! fits a likelihood field best.

use envgen::geometry::{Pose, unit_vector, wrap_angle};
use glam::{DVec2, Vec2};

use super::lattice::{
    COARSE_ANGLE, CellBlock, FINE, FINE_BITS, Lattice, MOST_STEPS, Step, penalty,
};
pub use super::lattice::{FINE_ANGLE, Window};
use super::likelihood::LikelihoodField;
use crate::map::RESOLUTION;

/// Steps of the refinement: in 1/16 cells, and in fine angles.
const REFINEMENT: [(i32, i32); 4] = [(8, 4), (4, 2), (2, 1), (1, 1)];

/// Shifts that the refinement tries: none, along an axis, along both.
const NEIGHBOURS: [(i32, i32); 9] =
    [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];

/// Greatest number of moves of the refinement at each step size.
const MOST_MOVES: usize = 64;

/// The result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// The pose of the highest score.
    pub pose: Pose,
    /// Mean likelihood of the echoes there, 0 to 1.
    pub response: f64,
    /// Response minus the penalty for the deviation from the expected pose.
    pub score: f64,
}

/// A scan matcher, which reuses its memory from scan to scan.
#[derive(Clone, Debug, Default)]
pub struct Matcher {
    /// Index in the field of each echo at each heading, heading by heading.
    places: Vec<u32>,
    /// Echoes at one heading in fine steps from the field's corner, for the refinement.
    fine: Vec<(i32, i32)>,
    roots: Vec<CellBlock>,
    rest: Vec<CellBlock>,
}

/// The searches of a scan in a window, which share the bounds of the largest blocks.
pub(crate) struct Search<'a> {
    lattice: Lattice<'a>,
    echoes: &'a [Vec2],
    fine: &'a mut Vec<(i32, i32)>,
    /// The largest blocks, heading by heading.
    roots: &'a [CellBlock],
    rest: &'a mut Vec<CellBlock>,
}

impl Matcher {
    /// Creates a matcher.
    pub fn new() -> Self {
        Matcher::default()
    }

    /// Finds the pose where the echoes of a scan, in metres in the robot's frame, fit best.
    ///
    /// First it finds the best pose of a lattice of whole cells and headings 0.48 degrees apart,
    /// exactly, by branch and bound on the pooled levels. From there it climbs the interpolated
    /// likelihood in halved steps down to 3 mm and 0.06 degrees.
    ///
    /// The field must cover the scan at every pose of the window; see [`Matcher::radius`]. Returns
    /// `None` if it does not, or if there is no echo.
    pub fn find(
        &mut self,
        field: &LikelihoodField,
        echoes: &[Vec2],
        window: Window,
    ) -> Option<Match> {
        self.search(field, echoes, window)?.find()
    }

    /// Does the same as [`Matcher::find`] without the refinement, for benchmarks and tests.
    #[doc(hidden)]
    pub fn find_coarse(
        &mut self,
        field: &LikelihoodField,
        echoes: &[Vec2],
        window: Window,
    ) -> Option<Match> {
        let mut search = self.search(field, echoes, window)?;
        let step = search.lattice.best(search.roots, search.rest, None);
        Some(search.at_lattice(step?))
    }

    /// Returns half the side in metres of the square around a window's centre that a field has to
    /// cover, for a scan that reaches `scan` metres from the robot.
    pub fn radius(scan: f64, window: &Window) -> f64 {
        scan + window.reach + 2.0 * RESOLUTION
    }

    /// Prepares the searches of a scan in a window; `None` without an echo, or if the field does not
    /// cover the scan at every pose of the window.
    pub(crate) fn search<'a>(
        &'a mut self,
        field: &'a LikelihoodField,
        echoes: &'a [Vec2],
        window: Window,
    ) -> Option<Search<'a>> {
        let cells = (window.reach / RESOLUTION).ceil().min(MOST_STEPS) as i32;
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
        let mut order: Vec<usize> = (0..blocks.len()).collect();
        order.sort_by_key(|&level| std::cmp::Reverse(blocks[level]));
        let places = &self.places;
        let count = echoes.len();
        let lattice = Lattice { field, blocks, order, places, echoes: count, window, cells, turns };
        lattice.bound_roots(&mut self.roots);
        let (fine, roots, rest) = (&mut self.fine, &self.roots, &mut self.rest);
        Some(Search { lattice, echoes, fine, roots, rest })
    }
}

impl Search<'_> {
    /// Returns the best pose of the window.
    pub(crate) fn find(&mut self) -> Option<Match> {
        let coarse = self.lattice.best(self.roots, self.rest, None)?;
        Some(self.refine(coarse))
    }

    /// Returns the mean likelihood of the best pose of the lattice that is at least so many metres from
    /// a position, in x or in y: of a place that looks almost as much like the scan.
    pub(crate) fn rival(&mut self, apart: (DVec2, f64)) -> Option<f64> {
        let step = self.lattice.best(self.roots, self.rest, Some(apart))?;
        Some(self.at_lattice(step).response)
    }

    /// The match of a step of the lattice.
    fn at_lattice(&mut self, step: Step) -> Match {
        let Search { lattice: Lattice { field, window, .. }, echoes, .. } = *self;
        let places = &mut *self.fine;
        turn_into(places, field, echoes, window.centre, step.angle);
        let sum: u64 = places.iter().map(|&(x, y)| nearest(field, x + step.x, y + step.y)).sum();
        let response = sum as f64 / (255 * echoes.len()) as f64;
        let score = response - penalty(window, step.x, step.y, step.angle);
        Match { pose: pose_at(window.centre, step), response, score }
    }

    /// Climbs from a step of the coarse lattice.
    fn refine(&mut self, from: Step) -> Match {
        let Search { lattice: Lattice { field, window, .. }, echoes, .. } = *self;
        // Turns are about the centroid of the echoes, so that they do not shift the whole scan.
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
            (window.reach / RESOLUTION).ceil().min(MOST_STEPS) as i32 * FINE,
            (window.heading_reach / FINE_ANGLE).ceil() as i32,
        );
        let inside = |step: Step| step.x.abs() <= most && step.y.abs() <= most;

        let mut at = from;
        let mut turned = Vec::with_capacity(echoes.len());
        turn_into(self.fine, field, echoes, window.centre, at.angle);
        let mut best = score(self.fine, at);
        for (shift, angle) in REFINEMENT {
            // Along the axes first; if that does not improve, along all diagonals as well.
            let mut shifts = &NEIGHBOURS[..5];
            for _ in 0..MOST_MOVES {
                let before = at;
                for turn in [0, angle, -angle] {
                    let swing = (lever(at.angle) - lever(at.angle + turn)).round().as_ivec2();
                    let base =
                        Step { x: at.x + swing.x, y: at.y + swing.y, angle: at.angle + turn };
                    if base.angle.abs() > most_angle {
                        continue;
                    }
                    let places = if turn == 0 {
                        &*self.fine
                    } else {
                        turn_into(&mut turned, field, echoes, window.centre, base.angle);
                        &turned
                    };
                    let all = if turn == 0 || shifts.len() > 5 { shifts } else { &shifts[..1] };
                    let start = at;
                    for &(dx, dy) in all {
                        let step = Step { x: base.x + dx * shift, y: base.y + dy * shift, ..base };
                        if step != start && inside(step) {
                            let tried = score(places, step);
                            if tried.0 > best.0 {
                                (at, best) = (step, tried);
                            }
                        }
                    }
                    if at.angle != start.angle {
                        std::mem::swap(&mut turned, self.fine);
                    }
                }
                if at != before {
                    shifts = &NEIGHBOURS[..5];
                } else if shifts.len() > 5 {
                    break;
                } else {
                    shifts = &NEIGHBOURS;
                }
            }
        }
        Match { pose: pose_at(window.centre, at), response: best.1, score: best.0 }
    }
}

fn pose_at(centre: Pose, step: Step) -> Pose {
    let shift = DVec2::new(f64::from(step.x), f64::from(step.y)) * (RESOLUTION / f64::from(FINE));
    Pose {
        position: centre.position + shift,
        heading: wrap_angle(centre.heading + f64::from(step.angle) * FINE_ANGLE),
    }
}

/// Computes the echoes, at a heading some fine steps from the expected one, in fine steps from the
/// field's corner.
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

/// The likelihood at a position in fine steps, of the cell that contains it.
fn nearest(field: &LikelihoodField, x: i32, y: i32) -> u64 {
    let index = (y >> FINE_BITS) as usize * field.cols() + (x >> FINE_BITS) as usize;
    u64::from(field.cells(0)[index])
}

/// The sum over all echoes of the likelihood between the centres of cells, in 1/65280.
fn interpolated(field: &LikelihoodField, places: &[(i32, i32)], dx: i32, dy: i32) -> u64 {
    let (cells, cols) = (field.cells(0), field.cols());
    let (dx, dy) = (dx - FINE / 2, dy - FINE / 2);
    let mut sum = 0;
    for &(x, y) in places {
        let (x, y) = (x + dx, y + dy);
        let index = (y >> FINE_BITS) as usize * cols + (x >> FINE_BITS) as usize;
        let (u, v) = ((x & (FINE - 1)) as u32, (y & (FINE - 1)) as u32);
        let across = |at: usize| {
            let pair = &cells[at..at + 2];
            u32::from(pair[0]) * (FINE as u32 - u) + u32::from(pair[1]) * u
        };
        sum += u64::from(across(index) * (FINE as u32 - v) + across(index + cols) * v);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use envgen::Seed;
    use glam::IVec2;
    use proptest::prelude::*;

    /// The best score of the coarse lattice and the response there, by trying every pose of it that is at
    /// least so many cells from a cell.
    fn exhaustive(
        field: &LikelihoodField,
        echoes: &[Vec2],
        window: Window,
        (middle, apart): (IVec2, i32),
    ) -> Option<(f64, f64)> {
        let cells = (window.reach / RESOLUTION).ceil() as i32;
        let turns = (window.heading_reach / (f64::from(COARSE_ANGLE) * FINE_ANGLE)).ceil() as i32;
        let mut best: Option<(f64, f64)> = None;
        let mut places = Vec::new();
        for turn in -turns..=turns {
            turn_into(&mut places, field, echoes, window.centre, turn * COARSE_ANGLE);
            for (y, x) in (-cells..=cells).flat_map(|y| (-cells..=cells).map(move |x| (y, x))) {
                if (IVec2::new(x, y) - middle).abs().max_element() >= apart {
                    let (x, y) = (x * FINE, y * FINE);
                    let sum: u64 = places.iter().map(|p| nearest(field, p.0 + x, p.1 + y)).sum();
                    let response = sum as f64 / (255 * echoes.len()) as f64;
                    let score = response - penalty(window, x, y, turn * COARSE_ANGLE);
                    if best.is_none_or(|(known, _)| score > known) {
                        best = Some((score, response));
                    }
                }
            }
        }
        best
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn branch_and_bound_finds_the_best_place(
            seed in any::<u64>(), deviation in 0.02..0.3_f64, heading_deviation in 0.005..0.08_f64,
            stamps in 0..60_usize, echoes in 1..40_usize, blocks in 0..5_usize, apart in 0..8_i32,
        ) {
            let mut draws = Seed(seed).stream("matcher", 0);
            let mut point = |r: f64| DVec2::new(draws.between(-r, r), draws.between(-r, r));
            let centre = Pose { position: point(5.0), heading: point(3.0).x };
            let window = Window::around(centre, deviation, heading_deviation);
            let blocks = [&[1, 4][..], &[1, 4, 16], &[1], &[1, 3, 7], &[1, 16, 4, 40]][blocks];
            let mut field = LikelihoodField::new(blocks);
            field.cover(centre.position, Matcher::radius(3.0, &window));
            for _ in 0..stamps {
                field.stamp(centre.position + point(2.0));
            }
            let echoes: Vec<Vec2> = (0..echoes).map(|_| point(2.0).as_vec2()).collect();
            let mut matcher = Matcher::new();
            let coarse = matcher.find_coarse(&field, &echoes, window);
            let best = exhaustive(&field, &echoes, window, (IVec2::ZERO, 0)).map(|(score, _)| score);
            prop_assert_eq!(coarse.map(|m| m.score), best);
            // The best place apart from another one, by the same bounds.
            let mut search = matcher.search(&field, &echoes, window).expect("it is covered");
            let elsewhere = exhaustive(&field, &echoes, window, (IVec2::ONE, apart));
            let position = centre.position + RESOLUTION;
            let rival = search.rival((position, f64::from(apart) * RESOLUTION - 1e-9));
            prop_assert_eq!(rival, elsewhere.map(|(_, response)| response));
            let fine = matcher.find(&field, &echoes, window).expect("it is covered");
            let shift = (fine.pose.position - centre.position).abs().max_element();
            prop_assert!(shift <= window.reach + RESOLUTION);
            prop_assert!((0.0..=1.0).contains(&fine.response) && fine.score <= fine.response);
        }

        #[test]
        fn any_window_is_searched_or_refused(
            x in any::<f64>(), heading in any::<f64>(), deviation in any::<f64>(),
            turn in any::<f64>(), reach in any::<f64>(),
        ) {
            let mut field = LikelihoodField::new(&[1, 4]);
            field.cover(DVec2::ZERO, 3.0);
            field.stamp(DVec2::ONE);
            let window = Window {
                centre: Pose::new(x, 0.0, heading),
                deviation,
                heading_deviation: turn,
                reach,
                heading_reach: 0.1,
            };
            let found = Matcher::new().find(&field, &[Vec2::ONE], window);
            prop_assert!(found.is_none_or(|found| found.pose.position.is_finite()));
        }
    }

    /// The corner of a room, scanned: echoes every 5 cm along two walls.
    fn corner(turn: f64) -> Vec<DVec2> {
        let axis = unit_vector(turn);
        let steps = (0..60).map(|i| 0.05 * f64::from(i));
        let walls = steps.flat_map(|s| [DVec2::new(3.0, s - 1.5), DVec2::new(s, 1.5)]);
        walls.map(|p| axis.rotate(p)).collect()
    }

    /// The greatest error of a scan that is matched to where it was taken.
    fn worst(turn: f64) -> (f64, f64) {
        let mut field = LikelihoodField::new(&[1, 4]);
        field.cover(DVec2::ZERO, 6.0);
        corner(turn).iter().for_each(|&p| field.stamp(p));
        let mut draws = Seed(5).stream("matcher", 1);
        let off = (0..50).map(|_| {
            let mut between = |r: f64| draws.between(-r, r);
            let truth = Pose::new(between(0.1), between(0.1), between(0.05));
            let echoes: Vec<Vec2> =
                corner(turn).iter().map(|&p| truth.to_local(p).as_vec2()).collect();
            let window = Window::around(Pose::default(), 0.05, 0.02);
            let found = Matcher::new().find(&field, &echoes, window).expect("covered").pose;
            let turn = (found.heading - truth.heading).abs();
            (found.position.distance(truth.position), turn)
        });
        off.fold((0.0, 0.0), |worst, off| (off.0.max(worst.0), off.1.max(worst.1)))
    }

    #[test]
    fn a_scan_is_put_back_where_it_was_taken() {
        // Across the grid to within a centimetre.
        let (off, turn) = worst(0.3);
        assert!(off < 0.01 && turn < 0.006, "{off} m, {turn} rad");
        // Walls exactly on the borders of cells are the worst case: linear interpolation is flat
        // between the middles of the cells on both sides, half a cell away.
        let (off, turn) = worst(0.0);
        assert!(off < 0.05 && turn < 0.01, "{off} m, {turn} rad");
    }

    #[test]
    fn without_anything_to_match_the_expected_pose_stays() {
        let mut field = LikelihoodField::new(&[1, 4]);
        let expected = Pose::new(0.3, -0.2, 0.7);
        let window = Window::around(expected, 0.05, 0.02);
        let mut matcher = Matcher::new();
        assert_eq!(matcher.find(&field, &[Vec2::X], window), None);
        field.cover(DVec2::ZERO, 3.0);
        assert_eq!(matcher.find(&field, &[], window), None);
        let found = matcher.find(&field, &[Vec2::X], window).expect("covered");
        assert_eq!((found.pose, found.response), (expected, 0.0));
        // A scan that reaches outside of the field.
        assert_eq!(matcher.find(&field, &[Vec2::X * 50.0], window), None);
    }
}
