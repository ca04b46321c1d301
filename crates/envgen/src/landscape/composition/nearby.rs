//! All partitions of a small number of cells among the classes.

use super::entropy_term::n_ln_n;

/// The greatest number of partitions that are tried one by one.
pub(super) const EXHAUSTIVE: u64 = 1 << 19;

/// Above this number of cells there are always more partitions than [`EXHAUSTIVE`], except for two classes, for
/// which moving single cells finds the nearest counts anyway.
const EXHAUSTIVE_CELLS: u64 = 4096;

/// Returns the number of partitions of `cells` cells into `classes` classes of at least `floor` cells, ignoring the
/// order of the classes; `u64::MAX` if there are very many.
pub(super) fn count_partitions(cells: u32, classes: usize, floor: u32) -> u64 {
    let free = u64::from(cells) - classes as u64 * u64::from(floor);
    if free > EXHAUSTIVE_CELLS {
        return u64::MAX;
    }
    let free = free as usize;
    let mut partitions = vec![0_u64; free + 1];
    partitions[0] = 1;
    for part in 1..=classes.min(free) {
        for n in part..=free {
            partitions[n] = partitions[n].saturating_add(partitions[n - part]);
        }
        if partitions[free] > EXHAUSTIVE {
            return u64::MAX;
        }
    }
    partitions[free]
}

/// Tries every partition of the cells. Partitions that are only equally near leave the counts as they are.
pub(super) fn try_all(counts: &mut Vec<u32>, entropy: f64, floor: u32) {
    let cells: u32 = counts.iter().sum();
    let n = f64::from(cells);
    let table: Vec<f64> = (0..=cells).map(n_ln_n).collect();
    let wanted = (libm::log(n) - entropy) * n;
    let sum: f64 = counts.iter().map(|&n| table[n as usize]).sum();
    let mut search = Search {
        table: &table,
        wanted,
        floor,
        least: (sum - wanted).abs(),
        best: counts.clone(),
        current: vec![floor; counts.len()],
    };
    search.part(0, cells - floor * counts.len() as u32, cells, 0.0);
    *counts = search.best;
}

struct Search<'a> {
    table: &'a [f64],
    wanted: f64,
    floor: u32,
    least: f64,
    best: Vec<u32>,
    current: Vec<u32>,
}

impl Search<'_> {
    /// Gives class `i` and those after it `free` cells above the floor, each at most `most`.
    fn part(&mut self, i: usize, free: u32, most: u32, sum: f64) {
        let after = (self.current.len() - i - 1) as u32;
        let most = most.min(self.floor + free);
        if after == 0 || free == 0 {
            let first = self.floor + free;
            if first > most {
                return;
            }
            let rest = self.table[self.floor as usize] * f64::from(after);
            let miss = (sum + self.table[first as usize] + rest - self.wanted).abs();
            // Sums of the same terms in another order differ in their last digits.
            if miss < self.least - 1e-11 * self.wanted.abs().max(1.0) {
                self.current[i] = first;
                self.current[i + 1..].fill(self.floor);
                self.least = miss;
                self.best.clone_from(&self.current);
            }
            return;
        }
        // The classes after this one hold no more each, so this one must take its share.
        let least = self.floor + free.div_ceil(after + 1);
        for n in (least..=most).rev() {
            self.current[i] = n;
            self.part(i + 1, free - (n - self.floor), n, sum + self.table[n as usize]);
        }
    }
}
