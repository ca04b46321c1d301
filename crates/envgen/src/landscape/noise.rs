//! Natural patches: white noise, smoothed, and divided into classes by the counts.

use super::edge::edge_count;
use crate::seed::Seed;

/// The number of times that the filter runs forth and back; the kernel is then nearly Gaussian.
const PASSAGES: u32 = 3;

/// The number of columns that are smoothed together, so that the steps of one column do not wait for each other.
const SIDE_BY_SIDE: usize = 64;

/// White noise over a grid, which is the same for every smoothing.
pub(super) struct Noise {
    rows: usize,
    cols: usize,
    values: Vec<f32>,
}

impl Noise {
    pub(super) fn new(rows: usize, cols: usize, seed: Seed) -> Self {
        let mut stream = seed.stream("landscape/noise", 0);
        // 24 random bits are all that an f32 in [0, 1) holds.
        let values = (0..rows * cols)
            .map(|_| (stream.bits() >> 40) as f32 * (1.0 / (1 << 24) as f32) - 0.5)
            .collect();
        Noise { rows, cols, values }
    }

    /// Returns the landscape of the noise smoothed by a kernel of standard deviation `sigma` cells. The classes
    /// follow the smoothed values from least to greatest, with `counts[k]` cells of class `k + 1`. With `sigma` = 0
    /// it is a random filling. It takes O(N), whatever `sigma` is.
    pub(super) fn landscape(&self, counts: &[u32], sigma: f64) -> Vec<u16> {
        let mut field = self.values.clone();
        if sigma > 0.0 {
            let keep = decay(sigma);
            let mut turned = vec![0.0; field.len()];
            for _ in 0..PASSAGES {
                forth_and_back(&mut field, self.cols, keep);
            }
            transpose(&field, &mut turned, self.cols);
            for _ in 0..PASSAGES {
                forth_and_back(&mut turned, self.rows, keep);
            }
            transpose(&turned, &mut field, self.rows);
        }
        cut(&field, counts)
    }

    /// Returns the smoothing, in cells, whose landscape has the greatest Total Edge up to `target`, and that
    /// landscape; or the Total Edge of the least and the greatest smoothing if the target is not between them.
    pub(super) fn towards(
        &self,
        counts: &[u32],
        target: u64,
    ) -> Result<(f64, Vec<u16>), (u64, u64)> {
        let edges = |cells: &[u16]| edge_count(cells, self.cols);
        let rough = self.landscape(counts, 0.0);
        let most = edges(&rough);
        if most <= target {
            return if most == target { Ok((0.0, rough)) } else { Err((self.least(counts), most)) };
        }
        let (mut low, mut high) = (0.0, self.greatest_sigma());
        let mut found = self.landscape(counts, high);
        let mut below = edges(&found);
        if below > target {
            return Err((below, most));
        }
        // A coarse result is near enough for the repair, which changes few cells.
        let near = target - target / 200;
        for _ in 0..40 {
            if below >= near {
                break;
            }
            // The Total Edge falls about as 1 / sigma: the geometric middle halves the interval.
            let middle: f64 = if low == 0.0 { high / 8.0 } else { (low * high).sqrt() };
            if middle <= low * 1.0001 || middle < 0.05 {
                break;
            }
            let cells = self.landscape(counts, middle);
            let at = edges(&cells);
            if at <= target {
                (high, found, below) = (middle, cells, at);
            } else {
                low = middle;
            }
        }
        Ok((high, found))
    }

    fn greatest_sigma(&self) -> f64 {
        self.rows.max(self.cols) as f64
    }

    fn least(&self, counts: &[u32]) -> u64 {
        edge_count(&self.landscape(counts, self.greatest_sigma()), self.cols)
    }
}

/// Returns the share that an exponential filter keeps at each step, such that all passages together have the
/// standard deviation `sigma`. One filter has the variance d / (1 - d)^2.
fn decay(sigma: f64) -> f32 {
    let v = sigma * sigma / f64::from(2 * PASSAGES);
    // The difference below has no digit left.
    if v < 1e-9 {
        return v as f32;
    }
    ((1.0 + 2.0 * v - (1.0 + 4.0 * v).sqrt()) / (2.0 * v)) as f32
}

/// Applies an exponential filter to each column, from the first row to the last and back.
fn forth_and_back(field: &mut [f32], cols: usize, keep: f32) {
    let rows = field.len() / cols;
    let gain = 1.0 - keep;
    let mut state = [0.0_f32; SIDE_BY_SIDE];
    for from in (0..cols).step_by(SIDE_BY_SIDE) {
        let to = (from + SIDE_BY_SIDE).min(cols);
        let state = &mut state[..to - from];
        state.copy_from_slice(&field[from..to]);
        let mut pass = |r: usize| {
            for (s, x) in state.iter_mut().zip(&mut field[r * cols + from..r * cols + to]) {
                *s = keep * *s + gain * *x;
                *x = *s;
            }
        };
        (0..rows).for_each(&mut pass);
        (0..rows).rev().for_each(&mut pass);
    }
}

/// Turns rows into columns, in blocks that fit the cache.
fn transpose(from: &[f32], to: &mut [f32], cols: usize) {
    const BLOCK: usize = 32;
    let rows = from.len() / cols;
    for r0 in (0..rows).step_by(BLOCK) {
        for c0 in (0..cols).step_by(BLOCK) {
            for r in r0..(r0 + BLOCK).min(rows) {
                for c in c0..(c0 + BLOCK).min(cols) {
                    to[c * rows + r] = from[r * cols + c];
                }
            }
        }
    }
}

/// Gives the cells of least value the first class, and so on. Equal values are in the order of the cells.
fn cut(field: &[f32], counts: &[u32]) -> Vec<u16> {
    // The bits of an f32, changed so that they sort as the numbers do.
    let key = |x: f32| {
        let bits = x.to_bits();
        if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
    };
    let mut order: Vec<u64> =
        (0_u64..).zip(field).map(|(i, &x)| u64::from(key(x)) << 32 | i).collect();
    radix_sort(&mut order);
    let mut cells = vec![0; field.len()];
    let mut order = order.into_iter();
    for (class, &n) in (1..=u16::MAX).zip(counts) {
        for at in order.by_ref().take(n as usize) {
            cells[(at & 0xffff_ffff) as usize] = class;
        }
    }
    cells
}

/// Sorts by the upper 32 bits, with the least significant digit first, 11 bits at a time. The sort is stable and
/// takes O(N).
fn radix_sort(items: &mut Vec<u64>) {
    const BITS: u32 = 11;
    let mut other = vec![0; items.len()];
    for shift in [32, 32 + BITS, 32 + 2 * BITS] {
        let digit = |item: u64| (item >> shift) as usize & ((1 << BITS) - 1);
        let mut starts = [0_usize; 1 << BITS];
        items.iter().for_each(|&item| starts[digit(item)] += 1);
        let mut sum = 0;
        for start in &mut starts {
            sum += std::mem::replace(start, sum);
        }
        for &item in items.iter() {
            let at = &mut starts[digit(item)];
            other[*at] = item;
            *at += 1;
        }
        std::mem::swap(items, &mut other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernel_has_its_deviation_and_is_round() {
        let (n, sigma) = (121, 6.0);
        let mut field = vec![0.0; n * n];
        field[60 * n + 60] = 1.0;
        let mut turned = field.clone();
        for _ in 0..PASSAGES {
            forth_and_back(&mut field, n, decay(sigma));
        }
        transpose(&field, &mut turned, n);
        for _ in 0..PASSAGES {
            forth_and_back(&mut turned, n, decay(sigma));
        }
        let (mut sum, mut x2, mut y2) = (0.0, 0.0, 0.0);
        for (i, &w) in turned.iter().enumerate() {
            let (x, y) = ((i % n) as f64 - 60.0, (i / n) as f64 - 60.0);
            sum += f64::from(w);
            x2 += f64::from(w) * x * x;
            y2 += f64::from(w) * y * y;
        }
        assert!((sum - 1.0).abs() < 1e-3, "{sum}");
        assert!((x2.sqrt() - sigma).abs() < 0.05 && (y2.sqrt() - sigma).abs() < 0.05, "{x2} {y2}");
        // At one distance, the kernel is nearly the same along the axis and along the diagonal.
        let (axis, diagonal) = (turned[60 * n + 67], turned[65 * n + 65]);
        assert!((axis / diagonal - 1.0).abs() < 0.2, "{axis} {diagonal}");
    }

    #[test]
    fn counts_are_kept_and_smoothing_lowers_the_total_edge() {
        let counts = [300, 1, 700, 0, 599];
        let noise = Noise::new(40, 40, Seed(4));
        let mut last = u64::MAX;
        for sigma in [0.0, 0.7, 2.0, 6.0, 40.0] {
            let cells = noise.landscape(&counts, sigma);
            for (class, &n) in (1..=u16::MAX).zip(&counts) {
                assert_eq!(cells.iter().filter(|&&c| c == class).count(), n as usize);
            }
            let edges = edge_count(&cells, 40);
            assert!(edges < last, "sigma {sigma}: {edges}, before {last}");
            last = edges;
        }
    }

    #[test]
    fn the_radix_sort_sorts() {
        let mut stream = Seed(1).stream("test", 0);
        let mut items: Vec<u64> = (0..10_000).map(|i| stream.bits() >> 32 << 32 | i).collect();
        let mut sorted = items.clone();
        sorted.sort_unstable();
        radix_sort(&mut items);
        assert_eq!(items, sorted);
    }
}
