//! All counts near the geometric ones.

use super::entropy_term::n_ln_n;

/// The greatest number of lists of counts that are tried one by one.
const TRIED: u64 = 1 << 19;

/// Returns how far a count may be from the geometric one: 5 % of it, and at least 2 cells.
pub(super) fn largest_shift(count: u32) -> u32 {
    (count / 20).max(2)
}

/// Returns the counts nearest to an entropy whose classes have at least `floor` cells, and each as many as in a given
/// list up to its [`largest_shift`]. Counts that are only equally near leave the list as it is. `None` if there are too
/// many lists of counts to try them all.
pub(super) fn nearest(counts: &[u32], entropy: f64, floor: u32) -> Option<Vec<u32>> {
    let cells: u32 = counts.iter().sum();
    // The first class has what the others leave.
    let mut lists = 1_u64;
    for &n in &counts[1..] {
        lists = lists.saturating_mul(u64::from(2 * largest_shift(n) + 1));
    }
    if lists > TRIED {
        return None;
    }
    let n = f64::from(cells);
    let wanted = (libm::log(n) - entropy) * n;
    let sum: f64 = counts.iter().copied().map(n_ln_n).sum();
    let range = |&n: &u32| (n.saturating_sub(largest_shift(n)).max(floor), n + largest_shift(n));
    let mut search = Search {
        wanted,
        ranges: counts.iter().map(range).collect(),
        least: (sum - wanted).abs(),
        best: counts.to_vec(),
        current: vec![0; counts.len()],
    };
    search.classes(counts.len() - 1, cells, floor, 0.0);
    Some(search.best)
}

struct Search {
    /// The sum of n ln n at the entropy.
    wanted: f64,
    /// The least and the greatest count of each class.
    ranges: Vec<(u32, u32)>,
    least: f64,
    best: Vec<u32>,
    current: Vec<u32>,
}

impl Search {
    /// Gives `cells` cells to class `i` and those before it, none fewer than `fewest`.
    fn classes(&mut self, i: usize, cells: u32, fewest: u32, sum: f64) {
        let (least, most) = self.ranges[i];
        let (least, most) = (least.max(fewest), most.min(cells));
        if i > 0 {
            for n in least..=most {
                self.current[i] = n;
                self.classes(i - 1, cells - n, n, sum + n_ln_n(n));
            }
            return;
        }
        if !(least..=most).contains(&cells) {
            return;
        }
        self.current[0] = cells;
        let miss = (sum + n_ln_n(cells) - self.wanted).abs();
        // Sums of the same terms in another order differ in their last digits.
        if miss < self.least - 1e-11 * self.wanted.abs().max(1.0) {
            self.least = miss;
            self.best.clone_from(&self.current);
        }
    }
}
