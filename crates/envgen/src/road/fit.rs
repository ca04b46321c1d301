//! Lengths that lead to a given point and are nearest to the drawn ones.

/// The greatest number of Newton steps. After these, there is taken to be no solution.
const MOST_STEPS: u32 = 100;

/// Returns the lengths x nearest to `wanted`, by the sum of squares, for which x >= `least` and the sum of
/// `columns`[i] x[i] is `target`. Returns `None` if there is no solution, or if the only solutions are many times
/// as long as the target because all directions are nearly opposite or parallel.
///
/// The dual problem has one multiplier per equation: x(m) = max(least, wanted + columns m), and the residual of the
/// equations is the gradient of a convex, piecewise quadratic function of m. Newton's method with a line search
/// finds its minimum in finitely many steps; without a solution, the function has no minimum. Each step costs one
/// pass over the lengths.
pub(super) fn nearest_lengths<const M: usize>(
    wanted: &[f64],
    least: &[f64],
    columns: &[[f64; M]],
    target: [f64; M],
) -> Option<Vec<f64>> {
    let scale = wanted.iter().sum::<f64>().max(dot(&target, &target).sqrt()).max(1e-9);
    let problem = Problem { wanted, least, columns, target };
    let mut at = [0.0; M];
    let mut now = problem.evaluate(&at);
    for _ in 0..MOST_STEPS {
        let size = norm(&now.residual);
        if size <= 1e-15 * scale {
            break;
        }
        let Some(step) = solve(now.curvature, now.residual) else { break };
        let slope = -dot(&step, &now.residual);
        let mut fraction = 1.0;
        let better = loop {
            let next = std::array::from_fn(|k| at[k] - fraction * step[k]);
            let there = problem.evaluate(&next);
            let falls = there.value <= now.value + 1e-4 * fraction * slope;
            // Next to the minimum, rounding hides that the value falls; the residual still shows it.
            if (falls && there.value < now.value) || norm(&there.residual) < 0.5 * size {
                break Some((next, there));
            }
            fraction *= 0.5;
            if fraction < 1e-12 {
                break None;
            }
        };
        let Some(better) = better else { break };
        (at, now) = better;
    }
    (norm(&now.residual) <= 1e-11 * scale).then(|| problem.lengths(&at).collect())
}

struct Problem<'a, const M: usize> {
    wanted: &'a [f64],
    least: &'a [f64],
    columns: &'a [[f64; M]],
    target: [f64; M],
}

/// The dual function at given multipliers.
struct Dual<const M: usize> {
    value: f64,
    residual: [f64; M],
    curvature: [[f64; M]; M],
}

impl<const M: usize> Problem<'_, M> {
    fn lengths(&self, at: &[f64; M]) -> impl Iterator<Item = f64> {
        let at = *at;
        self.wanted
            .iter()
            .zip(self.least)
            .zip(self.columns)
            .map(move |((wanted, least), column)| (wanted + dot(column, &at)).max(*least))
    }

    fn evaluate(&self, at: &[f64; M]) -> Dual<M> {
        let mut value = -dot(&self.target, at);
        let mut residual = self.target.map(|t| -t);
        let mut curvature = [[0.0; M]; M];
        for ((wanted, least), column) in self.wanted.iter().zip(self.least).zip(self.columns) {
            let free = wanted + dot(column, at);
            let (x, weight) = if free > *least { (free, 1.0) } else { (*least, 1e-6) };
            value += x * free - 0.5 * x * x;
            for k in 0..M {
                residual[k] += column[k] * x;
                for l in 0..M {
                    curvature[k][l] += weight * column[k] * column[l];
                }
            }
        }
        for (k, row) in curvature.iter_mut().enumerate() {
            row[k] += 1e-12;
        }
        Dual { value, residual, curvature }
    }
}

fn dot<const M: usize>(a: &[f64; M], b: &[f64; M]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm<const M: usize>(a: &[f64; M]) -> f64 {
    dot(a, a).sqrt()
}

/// Solves linear equations by Gaussian elimination with pivoting; `None` for a singular matrix.
fn solve<const M: usize>(mut a: [[f64; M]; M], mut b: [f64; M]) -> Option<[f64; M]> {
    for k in 0..M {
        let pivot = (k..M).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))?;
        if a[pivot][k] == 0.0 || !a[pivot][k].is_finite() {
            return None;
        }
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..M {
            let factor = a[i][k] / a[k][k];
            let row = a[k];
            a[i].iter_mut().zip(row).for_each(|(x, y)| *x -= factor * y);
            b[i] -= factor * b[k];
        }
    }
    for k in (0..M).rev() {
        let known: f64 = (k + 1..M).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k][k];
    }
    Some(b)
}

/// Returns the angles nearest to `wanted` between `least` and `most`, all positive, whose sum with `signs` is
/// `target`; `None` if the limits do not allow it.
pub(super) fn nearest_angles(
    wanted: &[f64],
    signs: &[f64],
    (least, most): (f64, f64),
    target: f64,
) -> Option<Vec<f64>> {
    let shifted = |by: f64| -> Vec<f64> {
        let shift = |(angle, sign): (&f64, &f64)| (angle + sign * by).clamp(least, most);
        wanted.iter().zip(signs).map(shift).collect()
    };
    let sum = |angles: &[f64]| angles.iter().zip(signs).map(|(a, s)| a * s).sum::<f64>();
    let (mut low, mut high) = (least - most, most - least);
    let slack = 1e-12 * wanted.len() as f64;
    if sum(&shifted(low)) > target + slack || sum(&shifted(high)) < target - slack {
        return None;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if sum(&shifted(middle)) < target {
            low = middle;
        } else {
            high = middle;
        }
    }
    let mut angles = shifted(high);
    // The last bits go to an angle that has room for them.
    let missing = target - sum(&angles);
    let fits = |i: &usize| (least..=most).contains(&(angles[*i] + signs[*i] * missing));
    if let Some(i) = (0..angles.len()).find(fits) {
        angles[i] += signs[i] * missing;
    }
    Some(angles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Whether directions can be added with positive factors to reach a point, which is the case if the point lies
    /// between two of them, or on one.
    fn in_cone(directions: &[[f64; 2]], p: [f64; 2], slack: f64, least_turn: f64) -> bool {
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let inside = |a: [f64; 2], b: [f64; 2]| {
            let turn = cross(a, b);
            turn > least_turn && cross(a, p) >= -slack && cross(p, b) >= -slack
        };
        directions.iter().any(|&a| directions.iter().any(|&b| inside(a, b)))
    }

    proptest! {
        #[test]
        fn lengths_are_found_exactly_where_there_are_some(
            angles in prop::collection::vec(-3.0..3.0_f64, 2..8),
            wanted in 1.0..100.0_f64,
            x in -200.0..200.0_f64,
            y in -200.0..200.0_f64,
        ) {
            let columns: Vec<[f64; 2]> =
                angles.iter().map(|&a| [libm::cos(a), libm::sin(a)]).collect();
            let n = columns.len();
            let found = nearest_lengths(&vec![wanted; n], &vec![1.0; n], &columns, [x, y]);
            let rest: [f64; 2] =
                [x - columns.iter().map(|c| c[0]).sum::<f64>(), y - columns.iter().map(|c| c[1]).sum::<f64>()];
            match found {
                Some(lengths) => {
                    prop_assert!(in_cone(&columns, rest, 1e-6, 1e-9));
                    prop_assert!(lengths.iter().all(|&l| l >= 1.0));
                    let sum = |k: usize| -> f64 { lengths.iter().zip(&columns).map(|(l, c)| l * c[k]).sum() };
                    prop_assert!((sum(0) - x).abs() < 1e-8 && (sum(1) - y).abs() < 1e-8);
                }
                // Of directions under 3 degrees from one line the lengths can be out of reach.
                None => prop_assert!(!in_cone(&columns, rest, -1e-3, 0.05)),
            }
        }

        #[test]
        fn the_lengths_found_are_the_nearest(
            angles in prop::collection::vec(-3.0..3.0_f64, 4..8),
            by in prop::collection::vec(-1.0..1.0_f64, 8),
        ) {
            // Any other solution is a feasible step away; none along random ones is nearer.
            let columns: Vec<[f64; 2]> =
                angles.iter().map(|&a| [libm::cos(a), libm::sin(a)]).collect();
            let wanted: Vec<f64> = (0..angles.len()).map(|i| 3.0 + i as f64).collect();
            let least = vec![1.0; wanted.len()];
            let target = [5.0, 2.0];
            let Some(best) = nearest_lengths(&wanted, &least, &columns, target) else { return Ok(()) };
            let cost = |x: &[f64]| -> f64 { x.iter().zip(&wanted).map(|(a, b)| (a - b) * (a - b)).sum() };
            let shifted: Vec<f64> = best.iter().zip(&by).map(|(x, d)| (x + d).max(1.0)).collect();
            let Some(other) = nearest_lengths(&shifted, &least, &columns, target) else { return Ok(()) };
            let (best, other) = (cost(&best), cost(&other));
            prop_assert!(best <= other * (1.0 + 1e-9) + 1e-6, "{best} > {other}");
        }

        #[test]
        fn angles_add_up(
            wanted in prop::collection::vec((0.5..1.5_f64, any::<bool>()), 1..30), target in -10.0..10.0_f64,
        ) {
            let signs: Vec<f64> = wanted.iter().map(|w| if w.1 { 1.0 } else { -1.0 }).collect();
            let wanted: Vec<f64> = wanted.iter().map(|w| w.0).collect();
            let left = signs.iter().filter(|s| **s > 0.0).count() as f64;
            let right = signs.len() as f64 - left;
            let (low, high) = (0.5 * left - 1.5 * right, 1.5 * left - 0.5 * right);
            match nearest_angles(&wanted, &signs, (0.5, 1.5), target) {
                Some(angles) => {
                    prop_assert!(angles.iter().all(|a| (0.5..=1.5).contains(a)));
                    let sum: f64 = angles.iter().zip(&signs).map(|(a, s)| a * s).sum();
                    prop_assert!((sum - target).abs() < 1e-12, "{sum} {target}");
                }
                None => prop_assert!(target < low || target > high),
            }
        }
    }

    #[test]
    fn one_direction_reaches_its_line_alone() {
        let columns = [[1.0, 0.0], [1.0, 0.0]];
        let found = nearest_lengths(&[3.0, 5.0], &[1.0; 2], &columns, [10.0, 0.0]).unwrap();
        assert!((found[0] - 4.0).abs() < 1e-12 && (found[1] - 6.0).abs() < 1e-12);
        assert_eq!(nearest_lengths(&[3.0, 5.0], &[1.0; 2], &columns, [10.0, 0.1]), None);
        assert_eq!(nearest_lengths(&[3.0, 5.0], &[1.0; 2], &columns, [1.9, 0.0]), None);
        assert_eq!(nearest_lengths(&[], &[], &[], [1.0, 0.0]), None);
    }
}
