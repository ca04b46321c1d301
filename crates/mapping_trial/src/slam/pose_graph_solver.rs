//! Pose graphs: finds the poses that fit measured relations between them best.
//!
//! The method is least squares after Levenberg and Marquardt, with Huber's loss for relations that may
//! be wrong (Grisetti, Kummerle, Stachniss, Burgard, A Tutorial on Graph-Based SLAM, 2010,
//! <https://doi.org/10.1109/MITS.2010.939925>). The linear systems are solved directly, block by block
//! in the order of least degree, which leaves the long chains of a robot's path without fill-in.

use std::collections::BTreeSet;

use envgen::geometry::{Pose, unit_vector, wrap_angle};
use glam::{DMat3, DVec2, DVec3};

/// Greatest error of a robust relation, in standard deviations, that counts in full.
const HUBER: f64 = 2.0;

/// Greatest number of steps.
const MOST_STEPS: usize = 30;

/// Greatest step in metres or radians at which the search ends.
const SETTLED: f64 = 1e-5;

/// A measured relation between two poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Relation {
    pub(crate) from: usize,
    pub(crate) to: usize,
    /// The pose `to` relative to `from`.
    pub(crate) measured: Pose,
    /// Information about x, y (m^-2) and heading (rad^-2), in the frame of `from`.
    pub(crate) information: DMat3,
    /// Whether it may be entirely wrong, so that its loss is robust.
    pub(crate) is_robust: bool,
}

impl Relation {
    /// Returns the deviation of two poses from what was measured.
    fn error(&self, poses: &[Pose]) -> DVec3 {
        let (a, b) = (poses[self.from], poses[self.to]);
        let seen = a.to_local(b.position);
        let turn = wrap_angle(b.heading - a.heading - self.measured.heading);
        (seen - self.measured.position).extend(turn)
    }

    /// The loss, and the weight that it gives the squared error.
    fn loss(&self, error: DVec3) -> (f64, f64) {
        let squared = error.dot(self.information * error);
        let size = squared.sqrt();
        if self.is_robust && size > HUBER {
            (HUBER * (2.0 * size - HUBER), HUBER / size)
        } else {
            (squared, 1.0)
        }
    }

    /// The error in standard deviations.
    pub(crate) fn deviations(&self, poses: &[Pose]) -> f64 {
        let error = self.error(poses);
        error.dot(self.information * error).sqrt()
    }
}

/// Sum of the losses of all relations.
pub(crate) fn cost(poses: &[Pose], relations: &[Relation]) -> f64 {
    relations.iter().map(|relation| relation.loss(relation.error(poses)).0).sum()
}

/// Moves all poses except the fixed ones to where the losses are least. Returns whether the cost fell.
/// Relations must refer to existing poses.
pub(crate) fn solve(poses: &mut [Pose], fixed: &[bool], relations: &[Relation]) -> bool {
    let mut unknowns = 0;
    let places: Vec<Option<usize>> = fixed
        .iter()
        .map(|&fixed| {
            let place = (!fixed).then_some(unknowns);
            unknowns += usize::from(!fixed);
            place
        })
        .collect();
    let before = cost(poses, relations);
    let mut best = before;
    let mut damping = 1e-6;
    for _ in 0..MOST_STEPS {
        let Some(steps) =
            System::of(poses, &places, unknowns, relations).damped(damping).eliminate()
        else {
            damping = 10.0 * damping + 1e-6;
            continue;
        };
        let moved: Vec<Pose> = poses
            .iter()
            .zip(&places)
            .map(|(&pose, place)| place.map_or(pose, |place| shifted(pose, steps[place])))
            .collect();
        let reached = cost(&moved, relations);
        // With NaN the cost did not fall.
        if reached < best {
            poses.copy_from_slice(&moved);
            best = reached;
            damping *= 0.1;
        } else {
            damping = 10.0 * damping + 1e-6;
        }
        let longest = steps.iter().fold(0.0_f64, |most, step| most.max(step.abs().max_element()));
        if longest < SETTLED || damping > 1e6 {
            break;
        }
    }
    best < before
}

fn shifted(pose: Pose, step: DVec3) -> Pose {
    Pose { position: pose.position + step.truncate(), heading: wrap_angle(pose.heading + step.z) }
}

/// A symmetric linear system in blocks of three.
#[derive(Clone, Debug)]
struct System {
    diagonal: Vec<DMat3>,
    /// The other blocks of each row, in the order of their columns.
    rows: Vec<Vec<(usize, DMat3)>>,
    right: Vec<DVec3>,
}

impl System {
    fn new(unknowns: usize) -> Self {
        System {
            diagonal: vec![DMat3::ZERO; unknowns],
            rows: vec![Vec::new(); unknowns],
            right: vec![DVec3::ZERO; unknowns],
        }
    }

    /// The normal equations of all relations at the poses.
    fn of(
        poses: &[Pose],
        places: &[Option<usize>],
        unknowns: usize,
        relations: &[Relation],
    ) -> Self {
        let mut system = System::new(unknowns);
        for relation in relations {
            let error = relation.error(poses);
            let information = relation.information * relation.loss(error).1;
            let (from, to) = (poses[relation.from], poses[relation.to]);
            let axis = unit_vector(from.heading);
            let seen = from.to_local(to.position);
            // Derivatives of the error by the pose `to`, and by `from`, whose turn moves `to` relative
            // to it.
            let by_to = DMat3::from_cols(
                DVec3::new(axis.x, -axis.y, 0.0),
                DVec3::new(axis.y, axis.x, 0.0),
                DVec3::Z,
            );
            let swing = -seen.perp();
            let by_from =
                DMat3::from_cols(-by_to.x_axis, -by_to.y_axis, DVec3::new(swing.x, swing.y, -1.0));
            let ends = [(places[relation.from], by_from), (places[relation.to], by_to)];
            for (place, by) in ends {
                let Some(place) = place else { continue };
                let weighted = by.transpose() * information;
                system.right[place] -= weighted * error;
                for (other, by_other) in ends {
                    if let Some(other) = other {
                        system.add(place, other, weighted * by_other);
                    }
                }
            }
        }
        system
    }

    fn add(&mut self, row: usize, col: usize, block: DMat3) {
        if row == col {
            self.diagonal[row] += block;
            return;
        }
        match self.rows[row].binary_search_by_key(&col, |&(at, _)| at) {
            Ok(at) => self.rows[row][at].1 += block,
            Err(at) => self.rows[row].insert(at, (col, block)),
        }
    }

    /// Increases the diagonal by a fraction of itself.
    fn damped(mut self, share: f64) -> Self {
        for block in &mut self.diagonal {
            let diagonal = DVec3::new(block.x_axis.x, block.y_axis.y, block.z_axis.z);
            *block += DMat3::from_diagonal(share * diagonal);
        }
        self
    }

    /// Returns the solution; `None` if it does not exist or its numbers are out of range.
    fn eliminate(mut self) -> Option<Vec<DVec3>> {
        let count = self.diagonal.len();
        let mut queue: BTreeSet<(usize, usize)> =
            self.rows.iter().enumerate().map(|(place, row)| (row.len(), place)).collect();
        let mut done = Vec::with_capacity(count);
        while let Some((_, place)) = queue.pop_first() {
            let block = self.diagonal[place];
            let determinant = block.determinant();
            if determinant <= 0.0 || determinant.is_nan() {
                return None;
            }
            let inverse = block.inverse();
            let row = std::mem::take(&mut self.rows[place]);
            for &(a, _) in &row {
                queue.remove(&(self.rows[a].len(), a));
                self.rows[a].retain(|&(col, _)| col != place);
            }
            for &(a, to_a) in &row {
                let weighted = to_a.transpose() * inverse;
                let change = weighted * self.right[place];
                self.right[a] -= change;
                for &(b, to_b) in &row {
                    self.add(a, b, -(weighted * to_b));
                }
            }
            for &(a, _) in &row {
                queue.insert((self.rows[a].len(), a));
            }
            done.push((place, inverse, row));
        }
        let mut solution = vec![DVec3::ZERO; count];
        for (place, inverse, row) in done.into_iter().rev() {
            let right =
                row.iter().fold(self.right[place], |right, &(a, to_a)| right - to_a * solution[a]);
            solution[place] = inverse * right;
        }
        solution.iter().all(|step| step.is_finite()).then_some(solution)
    }
}

/// Least fraction of the walls' information on the position that an axis needs to count. Less is noise
/// of the walls' directions.
const LEAST_SHARE: f64 = 0.01;

/// Returns the information from walls, which hold a pose across them, not along them. They are given as
/// points and unit normals in the frame of a pose that is seen at `seen`. The result is in the frame of
/// the pose that sees it.
pub(crate) fn held_by_walls(seen: Pose, walls: &[(DVec2, DVec2)], variance: f64) -> DMat3 {
    let axis = unit_vector(seen.heading);
    let sum = walls.iter().fold(DMat3::ZERO, |sum, &(point, normal)| {
        let (point, normal) = (axis.rotate(point), axis.rotate(normal));
        let by = normal.extend(normal.dot(point.perp()));
        sum + DMat3::from_cols(by * by.x, by * by.y, by * by.z)
    });
    // Along a bare corridor nothing is known, so the rest that is left there is removed.
    let (xx, xy, yy) = (sum.x_axis.x, sum.x_axis.y, sum.y_axis.y);
    let spread = (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
    let (most, least) = (0.5 * (xx + yy) + spread, 0.5 * (xx + yy) - spread);
    if least > LEAST_SHARE * most {
        return sum * (1.0 / variance);
    }
    let across = if xx >= yy { DVec2::new(most - yy, xy) } else { DVec2::new(xy, most - xx) };
    let across = across.normalize_or_zero();
    let keep = DMat3::from_cols(
        (across * across.x).extend(0.0),
        (across * across.y).extend(0.0),
        DVec3::Z,
    );
    keep * sum * keep * (1.0 / variance)
}

/// Returns the information on a motion, given the variances of position and heading.
pub(crate) fn of_motion(position: f64, heading: f64) -> DMat3 {
    let least = 1e-8;
    let (position, heading) = (1.0 / position.max(least), 1.0 / heading.max(least));
    DMat3::from_diagonal(DVec3::new(position, position, heading))
}

#[cfg(test)]
mod tests {
    use super::*;
    use envgen::{Seed, Stream};
    use proptest::prelude::*;

    fn chain(count: usize, draws: &mut Stream) -> Vec<Pose> {
        let mut pose = Pose::new(1.0, 2.0, 0.3);
        let mut poses = vec![pose];
        for _ in 1..count {
            pose.heading = wrap_angle(pose.heading + draws.between(-0.5, 0.5));
            pose.position += unit_vector(pose.heading) * draws.between(0.2, 0.5);
            poses.push(pose);
        }
        poses
    }

    fn relation(poses: &[Pose], from: usize, to: usize, is_robust: bool) -> Relation {
        let measured = poses[from].between(poses[to]);
        let information = DMat3::from_diagonal(DVec3::new(400.0, 300.0, 900.0));
        Relation { from, to, measured, information, is_robust }
    }

    /// Gaussian elimination with pivots, of the whole matrix.
    fn dense(system: &System) -> Vec<f64> {
        let n = 3 * system.diagonal.len();
        let mut matrix = vec![vec![0.0; n + 1]; n];
        let mut put = |row: usize, col: usize, block: DMat3| {
            for i in 0..3 {
                for j in 0..3 {
                    matrix[3 * row + i][3 * col + j] = block.col(j)[i];
                }
            }
        };
        for (row, blocks) in system.rows.iter().enumerate() {
            put(row, row, system.diagonal[row]);
            blocks.iter().for_each(|&(col, block)| put(row, col, block));
        }
        for (i, row) in matrix.iter_mut().enumerate() {
            row[n] = system.right[i / 3][i % 3];
        }
        for k in 0..n {
            let pivot = (k..n).max_by(|&a, &b| matrix[a][k].abs().total_cmp(&matrix[b][k].abs()));
            matrix.swap(k, pivot.unwrap_or(k));
            let lead = matrix[k].clone();
            for row in matrix.iter_mut().skip(k + 1) {
                let factor = row[k] / lead[k];
                row.iter_mut().zip(&lead).skip(k).for_each(|(x, y)| *x -= factor * y);
            }
        }
        let mut solution = vec![0.0; n];
        for k in (0..n).rev() {
            let known: f64 = (k + 1..n).map(|j| matrix[k][j] * solution[j]).sum();
            solution[k] = (matrix[k][n] - known) / matrix[k][k];
        }
        solution
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn block_elimination_is_the_dense_solution(seed in any::<u64>(), count in 3..40_usize) {
            let mut draws = Seed(seed).stream("graph", 0);
            let poses = chain(count, &mut draws);
            let mut relations: Vec<_> =
                (1..count).map(|i| relation(&poses, i - 1, i, false)).collect();
            for _ in 0..count / 4 {
                let (a, b) = (draws.below(count as u64) as usize, draws.below(count as u64) as usize);
                if a != b {
                    relations.push(relation(&poses, a, b, true));
                }
            }
            let off: Vec<Pose> =
                poses.iter().map(|&pose| shifted(pose, DVec3::splat(0.1 * draws.unit()))).collect();
            let places: Vec<Option<usize>> = (0..count).map(|i| i.checked_sub(1)).collect();
            let system = System::of(&off, &places, count - 1, &relations).damped(1e-6);
            let expected = dense(&system);
            let solution = system.eliminate();
            prop_assert!(solution.is_some());
            for (i, step) in solution.into_iter().flatten().enumerate() {
                for axis in 0..3 {
                    let expected = expected[3 * i + axis];
                    prop_assert!((step[axis] - expected).abs() < 1e-7 * (1.0 + expected.abs()));
                }
            }
        }

        #[test]
        fn poses_return_to_what_was_measured(seed in any::<u64>()) {
            let mut draws = Seed(seed).stream("graph", 1);
            let count = 60;
            let truth = chain(count, &mut draws);
            let mut relations: Vec<_> =
                (1..count).map(|i| relation(&truth, i - 1, i, false)).collect();
            relations.push(relation(&truth, 0, count - 1, true));
            relations.push(relation(&truth, 10, 50, true));
            let mut fixed = vec![false; count];
            fixed[0] = true;
            let mut poses = truth.clone();
            for pose in &mut poses[1..] {
                *pose = shifted(*pose, DVec3::new(draws.unit(), draws.unit(), 0.3 * draws.unit()));
            }
            prop_assert!(solve(&mut poses, &fixed, &relations));
            prop_assert!(cost(&poses, &relations) < 1e-6, "{}", cost(&poses, &relations));
            let farthest = poses.iter().zip(&truth).map(|(a, b)| a.position.distance(b.position));
            prop_assert!(farthest.fold(0.0, f64::max) < 1e-3);
        }
    }

    #[test]
    fn a_wrong_relation_does_less_harm_when_it_is_robust() {
        let mut draws = Seed(3).stream("graph", 2);
        let count = 30;
        let truth = chain(count, &mut draws);
        let harm = |is_robust: bool| {
            let mut relations: Vec<_> =
                (1..count).map(|i| relation(&truth, i - 1, i, false)).collect();
            // Another correct one holds the pose, so that the wrong one has to pull against it.
            relations.push(relation(&truth, 2, 25, true));
            let mut wrong = relation(&truth, 2, 25, is_robust);
            wrong.measured.position += DVec2::new(3.0, -2.0);
            relations.push(wrong);
            let mut fixed = vec![false; count];
            fixed[0] = true;
            let mut poses = truth.clone();
            solve(&mut poses, &fixed, &relations);
            let moved = poses.iter().zip(&truth).map(|(a, b)| a.position.distance(b.position));
            moved.fold(0.0, f64::max)
        };
        assert!(harm(true) < 0.3 * harm(false), "{} against {}", harm(true), harm(false));
    }

    #[test]
    fn impossible_systems_leave_the_poses() {
        let truth = [Pose::default(), Pose::new(1.0, 0.0, 0.0)];
        let mut relation = relation(&truth, 0, 1, false);
        relation.information = DMat3::ZERO;
        let mut poses = truth;
        assert!(!solve(&mut poses, &[true, false], &[relation]));
        assert_eq!(poses, truth);
        relation.information = DMat3::from_diagonal(DVec3::splat(f64::NAN));
        assert!(!solve(&mut poses, &[true, false], &[relation]));
        assert_eq!(poses, truth);
        assert!(!solve(&mut [], &[], &[]));
    }

    #[test]
    fn walls_hold_across_and_not_along() {
        let wall = |y: f64| {
            (0..20).map(move |i| {
                (DVec2::new(0.1 * f64::from(i), y), DVec2::new(0.01, 1.0).normalize())
            })
        };
        let corridor: Vec<_> = wall(1.0).chain(wall(-1.0)).collect();
        let held = held_by_walls(Pose::default(), &corridor, 0.01);
        let along = DVec3::new(1.0, -0.01, 0.0).normalize();
        assert!(along.dot(held * along) < 1e-6, "{held}");
        assert!(held.y_axis.y > 3000.0 && held.z_axis.z > 100.0, "{held}");
        // The same seen from a pose that is turned: what is along turns with it.
        let turned = held_by_walls(Pose::new(0.0, 0.0, 1.0), &corridor, 0.01);
        let along = (unit_vector(1.0).rotate(along.truncate())).extend(0.0);
        assert!(along.dot(turned * along) < 1e-6);
    }
}
