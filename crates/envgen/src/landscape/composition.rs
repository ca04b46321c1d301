//! Compositions: from an entropy to the number of cells of each class.

mod entropy_term;
mod moves;
mod nearby;

use self::moves::move_single_cells;
use self::nearby::nearest;
use super::spec::{LandscapeSpec, MAX_CELLS};
use crate::error::SpecError;

/// The number of cells of each class, with the greatest count first.
///
/// By Kuznetsov (2017), section 2, the counts fall as a geometric sequence of ratio `beta`, which solves his
/// equation (4). Because that equation suffers from cancellation near `beta` = 1, its defining sum is solved
/// instead. The counts are then rounded by largest remainders. Of all counts that differ from these by at most 5 %, or
/// by 2 cells, those with the entropy nearest to the target are taken. Where there are more than 2^19 such lists of
/// counts, or empty classes must be filled, a few cells at a time are moved between classes as long as this brings the
/// entropy nearer to its target.
///
/// ```
/// use envgen::landscape::Composition;
///
/// let found = Composition::closest(2304, 3, 1.0, false)?;
/// assert_eq!(found.counts().iter().sum::<u32>(), 2304);
/// assert!((found.entropy() - 1.0).abs() < 1e-4 && found.beta() < 1.0);
/// # Ok::<(), envgen::SpecError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Composition {
    counts: Vec<u32>,
    beta: f64,
    entropy: f64,
}

impl Composition {
    /// Finds the counts of `cells` cells in `classes` classes whose entropy is nearest to `entropy` (in nats), as far as
    /// the search finds it. With `keep_classes`, no class is empty.
    ///
    /// # Errors
    /// When `cells` or `classes` is out of range, when there are more classes than cells, or when no counts reach
    /// the entropy; the error then names the least or the greatest entropy that can be reached.
    pub fn closest(
        cells: u64,
        classes: u64,
        entropy: f64,
        keep_classes: bool,
    ) -> Result<Composition, SpecError> {
        const { LandscapeSpec::setting("classes") }.check_integer(classes)?;
        if cells == 0 || cells > MAX_CELLS {
            return Err(SpecError::new("cells", cells, format!("from 1 to {MAX_CELLS}")));
        }
        if classes > cells {
            return Err(SpecError::new(
                "classes",
                classes,
                format!("at most the {cells} cells there are"),
            ));
        }
        const { LandscapeSpec::setting("entropy") }.check(entropy)?;
        let (cells, l) = (cells as u32, classes as usize);
        let most = entropy_of(&even_counts(cells, l));
        // An entropy that was written with few digits may round to just above the maximum.
        if entropy > most + 1e-9 {
            return Err(SpecError::new(
                "entropy",
                entropy,
                format!("at most {most} nats, which {cells} cells in {l} classes reach"),
            ));
        }
        let floor = u32::from(keep_classes);
        if keep_classes {
            let mut least = vec![1; l];
            least[0] = cells - (l as u32 - 1);
            let least = entropy_of(&least);
            if entropy < least - 1e-9 {
                let allowed = format!(
                    "at least {least} nats, which {l} classes reach with none of them empty"
                );
                return Err(SpecError::new("entropy", entropy, allowed));
            }
        }
        let beta = geometric_ratio(l, entropy);
        let mut counts = rounded(cells, l, beta);
        let is_filled = fill_empty(&mut counts, floor);
        let near = nearest(&counts, entropy, floor);
        // Filled classes are no geometric ones.
        let moves = is_filled || near.is_none();
        counts = near.unwrap_or(counts);
        if moves {
            move_single_cells(&mut counts, entropy, floor);
        }
        let entropy = entropy_of(&counts);
        Ok(Composition { counts, beta, entropy })
    }

    /// Returns the number of cells of each class, with the greatest first.
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// Returns the ratio of the geometric sequence, from 0 to 1.
    pub fn beta(&self) -> f64 {
        self.beta
    }

    /// Returns the entropy of the counts in nats.
    pub fn entropy(&self) -> f64 {
        self.entropy
    }
}

/// Returns the entropy of class counts in nats: Kuznetsov's definition 2, the Shannon diversity index of ecology.
/// It is 0 without cells, and the same to the last bit for any order of the classes.
///
/// ```
/// use std::f64::consts::LN_2;
///
/// use envgen::landscape::entropy_of;
///
/// // Four classes of the same size have ln 4 = 2 ln 2 nats; empty classes do not count.
/// assert!((entropy_of(&[5, 5, 0, 5, 5]) - 2.0 * LN_2).abs() < 1e-12);
/// // That of one class, or of none, is 0, never -0.
/// assert_eq!([entropy_of(&[7]), entropy_of(&[])].map(f64::to_bits), [0, 0]);
/// assert_eq!(entropy_of(&[20]), 0.0);
/// ```
pub fn entropy_of(counts: &[u32]) -> f64 {
    let mut counts: Vec<u32> = counts.iter().copied().filter(|&n| n > 0).collect();
    counts.sort_unstable();
    let cells = counts.iter().map(|&n| u64::from(n)).sum::<u64>() as f64;
    let sum: f64 = counts
        .iter()
        .map(|&n| {
            let share = f64::from(n) / cells;
            -share * libm::log(share)
        })
        .sum();
    // The second sum turns -0 into 0.
    sum.max(0.0) + 0.0
}

/// Returns the greatest entropy, in nats, that `cells` cells in `classes` classes can have; 0 if either is 0.
///
/// ```
/// use envgen::landscape::{entropy_of, largest_entropy};
///
/// // Ten cells in three classes are at best 4, 3 and 3: a little less even than 9 cells can be.
/// assert_eq!(largest_entropy(10, 3), entropy_of(&[4, 3, 3]));
/// assert!(largest_entropy(10, 3) < largest_entropy(9, 3));
/// ```
pub fn largest_entropy(cells: u64, classes: u64) -> f64 {
    if cells <= MAX_CELLS && classes <= 65_535 {
        let counts = even_counts(cells as u32, classes as usize);
        return if classes == 0 { 0.0 } else { entropy_of(&counts) };
    }
    // More classes than a map can have: the sum of the two sizes that classes then have.
    if cells == 0 || classes == 0 {
        return 0.0;
    }
    let (whole, larger) = (cells / classes, cells % classes);
    let part = |size: u64, classes: u64| {
        let share = size as f64 / cells as f64;
        if size == 0 { 0.0 } else { -(classes as f64) * share * libm::log(share) }
    };
    part(whole.saturating_add(1), larger) + part(whole, classes - larger)
}

fn even_counts(cells: u32, classes: usize) -> Vec<u32> {
    let l = classes as u32;
    (0..l).map(|i| cells / l + u32::from(i < cells % l)).collect()
}

/// Returns the entropy of the sequence 1, beta, beta^2 ... of `classes` terms.
fn geometric_entropy(classes: usize, beta: f64) -> f64 {
    let ln_beta = libm::log(beta);
    let (mut weight, mut total, mut logs) = (1.0, 0.0, 0.0);
    for i in 0..classes {
        if weight == 0.0 {
            break;
        }
        total += weight;
        logs += weight * i as f64 * ln_beta;
        weight *= beta;
    }
    libm::log(total) - logs / total
}

/// Finds the ratio for an entropy by bisection, since the entropy rises with beta from 0 to ln l.
fn geometric_ratio(classes: usize, entropy: f64) -> f64 {
    if entropy <= 0.0 || classes == 1 {
        return 0.0;
    }
    if entropy >= geometric_entropy(classes, 1.0) {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if geometric_entropy(classes, middle) < entropy {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Returns the geometric counts, rounded by largest remainders.
fn rounded(cells: u32, classes: usize, beta: f64) -> Vec<u32> {
    let weights: Vec<f64> =
        std::iter::successors(Some(1.0), |w| Some(w * beta)).take(classes).collect();
    let total: f64 = weights.iter().sum();
    let shares: Vec<f64> = weights.iter().map(|w| w / total * f64::from(cells)).collect();
    let mut counts: Vec<u32> = shares.iter().map(|share| *share as u32).collect();
    let given: u64 = counts.iter().map(|&n| u64::from(n)).sum();
    let mut order: Vec<usize> = (0..classes).collect();
    let remainder = |i: usize| shares[i] - f64::from(counts[i]);
    order.sort_by(|&a, &b| remainder(b).total_cmp(&remainder(a)).then(a.cmp(&b)));
    // Rounding of the shares can leave a cell too many as well as cells to give.
    let mut left = i64::from(cells) - given as i64;
    for &i in order.iter().cycle().take(2 * classes) {
        if left > 0 {
            counts[i] += 1;
            left -= 1;
        }
    }
    counts[0] = (i64::from(counts[0]) + left) as u32;
    counts.sort_unstable_by(|a, b| b.cmp(a));
    counts
}

/// Raises every class to at least `floor` cells, which are taken from the largest classes. Returns whether any had
/// fewer.
fn fill_empty(counts: &mut [u32], floor: u32) -> bool {
    let mut missing = 0;
    for n in counts.iter_mut().filter(|n| **n < floor) {
        missing += floor - *n;
        *n = floor;
    }
    let is_filled = missing > 0;
    while missing > 0 {
        // Many classes can be empty only when the largest are large: a few turns suffice.
        let (largest, next) = (counts[0], counts.iter().find(|&&n| n < counts[0]));
        let ties = counts.iter().take_while(|&&n| n == largest).count() as u32;
        let step = (largest - next.copied().unwrap_or(floor)).min(missing.div_ceil(ties)).max(1);
        for n in counts.iter_mut().take(ties as usize) {
            let taken = step.min(missing);
            *n -= taken;
            missing -= taken;
        }
        counts.sort_unstable_by(|a, b| b.cmp(a));
    }
    is_filled
}

#[cfg(test)]
mod tests {
    use super::nearby::largest_shift;
    use super::*;
    use proptest::prelude::*;

    /// The rounded counts, and whether classes were filled.
    fn geometric(cells: u32, classes: usize, entropy: f64, floor: u32) -> (Vec<u32>, bool) {
        let mut counts = rounded(cells, classes, geometric_ratio(classes, entropy));
        let is_filled = fill_empty(&mut counts, floor);
        (counts, is_filled)
    }

    /// Every list of counts, in any order: the slow, obvious method.
    fn least_error(cells: u32, classes: usize, entropy: f64, floor: u32) -> f64 {
        fn walk(left: u32, counts: &mut Vec<u32>, classes: usize, visit: &mut impl FnMut(&[u32])) {
            if counts.len() + 1 == classes {
                counts.push(left);
                visit(counts);
                counts.pop();
                return;
            }
            for n in 0..=left {
                counts.push(n);
                walk(left - n, counts, classes, visit);
                counts.pop();
            }
        }
        let mut least = f64::INFINITY;
        walk(cells, &mut Vec::new(), classes, &mut |counts| {
            if counts.iter().all(|&n| n >= floor) && is_near(counts, entropy, floor) {
                least = least.min((entropy_of(counts) - entropy).abs());
            }
        });
        least
    }

    /// Whether each of the counts, sorted, is near to the geometric one.
    fn is_near(counts: &[u32], entropy: f64, floor: u32) -> bool {
        let (geometric, _) = geometric(counts.iter().sum(), counts.len(), entropy, floor);
        let mut sorted = counts.to_vec();
        sorted.sort_unstable_by(|a, b| b.cmp(a));
        let mut pairs = sorted.iter().zip(&geometric);
        pairs.all(|(&n, &geometric)| n.abs_diff(geometric) <= largest_shift(geometric))
    }

    /// Other partitions have the same entropies, such as 200, 200, 0, 0 the first of these.
    #[test]
    fn counts_of_small_landscapes_are_geometric() {
        for (cells, classes, entropy, geometric) in [
            (400, 4, std::f64::consts::LN_2, vec![307, 72, 17, 4]),
            (100, 4, std::f64::consts::LN_2, vec![77, 18, 4, 1]),
            (2304, 3, 0.7, vec![1716, 463, 125]),
            (2304, 3, 0.6 * libm::log(3.0), vec![1766, 432, 106]),
            (100, 6, 1.3, vec![51, 25, 13, 6, 3, 2]),
        ] {
            let found = Composition::closest(cells, classes, entropy, false).unwrap();
            for (n, &geometric) in found.counts().iter().zip(&geometric) {
                assert!(n.abs_diff(geometric) <= largest_shift(geometric), "{found:?}");
            }
            assert!((found.entropy() - entropy).abs() < 3e-3, "{found:?}");
        }
    }

    #[test]
    fn more_cells_and_classes_than_a_map_has_are_no_fewer() {
        for (cells, classes) in [(1 << 40, 3), (1 << 40, 1 << 20), (u64::MAX, u64::MAX)] {
            let found = largest_entropy(cells, classes);
            assert!((found - libm::log(classes as f64)).abs() < 1e-9, "{cells} {classes}: {found}");
        }
        // With more classes than cells, each cell has a class of its own.
        assert!((largest_entropy(70_000, 80_000) - libm::log(70_000.0)).abs() < 1e-9);
        assert!((largest_entropy(10, 70_000) - libm::log(10.0)).abs() < 1e-12);
        assert_eq!((largest_entropy(1 << 40, 0), largest_entropy(0, 1 << 40)), (0.0, 0.0));
    }

    #[test]
    fn no_counts_of_few_cells_are_nearer() {
        for cells in 1..=14_u32 {
            for classes in 1..=cells.min(5) as usize {
                let most = largest_entropy(u64::from(cells), classes as u64);
                for floor in 0..=1 {
                    for step in 0..=10 {
                        let entropy = most * f64::from(step) / 10.0;
                        let found = Composition::closest(
                            u64::from(cells),
                            classes as u64,
                            entropy,
                            floor == 1,
                        );
                        // Below what non-empty classes reach.
                        let Ok(found) = found else {
                            assert_eq!(floor, 1);
                            continue;
                        };
                        let error = (found.entropy() - entropy).abs();
                        let least = least_error(cells, classes, entropy, floor);
                        assert!(error <= least + 1e-10, "{cells} {classes} {entropy} {found:?}");
                        assert_eq!(found.counts().iter().sum::<u32>(), cells);
                    }
                }
            }
        }
    }

    #[test]
    fn equation_4_is_the_sum() {
        for (classes, beta) in [(2, 0.3), (10, 0.5), (9, 0.811), (150, 0.97)] {
            let (l, b): (f64, f64) = (f64::from(classes), beta);
            let power = libm::pow(b, l);
            let printed = -(b * (1.0 - power) - (1.0 - b) * l * power)
                / ((1.0 - b) * (1.0 - power))
                * libm::log(b)
                + libm::log((1.0 - power) / (1.0 - b));
            assert!((geometric_entropy(classes as usize, beta) - printed).abs() < 1e-12);
        }
    }

    #[test]
    fn the_ends_of_the_range() {
        let none = Composition::closest(100, 7, 0.0, false).unwrap();
        assert_eq!((none.counts(), none.beta()), (&[100, 0, 0, 0, 0, 0, 0][..], 0.0));
        let all = Composition::closest(100, 4, libm::log(4.0), false).unwrap();
        assert_eq!((all.counts(), all.beta()), (&[25; 4][..], 1.0));
        let one = Composition::closest(100, 1, 0.0, true).unwrap();
        assert_eq!(one.counts(), [100]);
        let kept = Composition::closest(100, 7, 0.4, true).unwrap();
        assert!(kept.counts().iter().all(|&n| n >= 1));
        // Geometric sequences of whole classes reach down to less than what is left if none is empty.
        for (cells, classes) in [(400, 9), (100, 7), (2304, 3), (2304, 40)] {
            let mut least = vec![1; classes];
            least[0] = cells - (classes as u32 - 1);
            for entropy in [entropy_of(&least), 1.5 * entropy_of(&least)] {
                let kept =
                    Composition::closest(u64::from(cells), classes as u64, entropy, true).unwrap();
                assert!((kept.entropy() - entropy).abs() < 0.01, "{entropy}: {kept:?}");
            }
        }
    }

    #[test]
    fn errors_name_what_can_be_reached() {
        let error = |cells, classes, entropy, keep| {
            Composition::closest(cells, classes, entropy, keep).unwrap_err().to_string()
        };
        assert!(error(100, 7, 1.9459, false).contains("at most 1.945"), "maximum for integers");
        assert!(error(100, 7, 3.0, false).contains("at most 1.945"));
        assert!(
            error(100, 7, 0.01, true).contains("at least 0.3"),
            "{}",
            error(100, 7, 0.01, true)
        );
        assert!(error(100, 7, f64::NAN, false).contains("`entropy` must be"));
        assert!(error(100, 7, -0.1, false).contains("`entropy` must be"));
        assert!(error(100, 101, 1.0, false).contains("at most the 100 cells"));
        assert!(error(100, 0, 1.0, false).contains("`classes` must be"));
        assert!(error(1 << 20, 65_536, 1.0, false).contains("`classes` must be"));
        assert!(error(1_000_000_000_000_000_000, 5, 1.0, false).contains("from 1 to"));
        assert!(error(0, 5, 1.0, false).contains("from 1 to"));
    }

    #[test]
    fn many_classes_of_many_cells() {
        for part in [0.05, 0.5, 0.9, 0.999] {
            let entropy = part * libm::log(65_535.0);
            let found = Composition::closest(1 << 20, 65_535, entropy, false).unwrap();
            let error = (found.entropy() - entropy).abs();
            assert!(error < 1e-8, "{part}: off by {error}");
        }
    }

    proptest! {
        #[test]
        fn counts_sum_up_and_no_single_move_is_better(
            cells in 1_u64..3000, classes in 1_u64..40, part in 0.0..1.0_f64, keep: bool,
        ) {
            prop_assume!(classes <= cells);
            let entropy = part * largest_entropy(cells, classes);
            let Ok(found) = Composition::closest(cells, classes, entropy, keep) else {
                prop_assert!(keep);
                return Ok(());
            };
            let counts = found.counts();
            prop_assert_eq!(counts.iter().map(|&n| u64::from(n)).sum::<u64>(), cells);
            prop_assert!(counts.is_sorted_by(|a, b| a >= b));
            prop_assert!(!keep || counts.iter().all(|&n| n > 0));
            let error = (found.entropy() - entropy).abs();
            let floor = u32::from(keep);
            let (geometric, is_filled) =
                geometric(cells as u32, classes as usize, entropy, floor);
            let is_limited = !is_filled && nearest(&geometric, entropy, floor).is_some();
            for i in 0..counts.len() {
                for j in 0..counts.len() {
                    if i != j && counts[i] > floor {
                        let mut moved = counts.to_vec();
                        moved[i] -= 1;
                        moved[j] += 1;
                        if is_limited && !is_near(&moved, entropy, floor) {
                            continue;
                        }
                        prop_assert!((entropy_of(&moved) - entropy).abs() >= error - 1e-10);
                    }
                }
            }
        }
    }
}
