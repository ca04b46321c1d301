//! Counts of the sides between cells, by the two classes that they separate.
//!
//! The time of a count is mostly one memory access per look-up. The fewer classes there are, the more sides one
//! look-up counts.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// The number of sides that separate two classes, for pairs with the smaller class first, sorted. 0 is no data and
/// the raster's end.
pub(super) type Pairs = Vec<(u16, u16, u64)>;

/// Up to this many classes, including no data, a window of four cells has a code of 16 bits.
const IN_WINDOWS: u16 = 16;

/// Up to this many classes, including no data, a pair of cells has a code of 16 bits.
const IN_PAIRS: u16 = 256;

/// The least number of cells that are counted by windows, whose many codes have to be added up in the end. Smaller
/// rasters are counted by pairs.
const LEAST_FOR_WINDOWS: usize = 1 << 16;

/// The least number of cells that a thread counts at a time.
#[cfg(feature = "parallel")]
const BAND: usize = 1 << 18;

/// One row in this many is read for a first guess of the greatest class.
const SAMPLED: usize = 61;

/// The greatest number of distinct classes that are counted in a full table.
const IN_TABLE: usize = 512;

/// The number of pairs that are sorted at a time if there are more classes.
const SORTED: usize = 1 << 20;

/// Counts every side once, including those at the raster's end. It takes O(N): with classes up to 15, one look-up
/// for two cells of a large raster; with up to 512 classes, two per cell; with more, a sort. With the feature
/// `parallel`, it runs on all cores.
pub(super) fn count(cells: &[u16], cols: usize) -> Pairs {
    if cells.len() < cols || cols == 0 {
        return Pairs::new();
    }
    let windows = |most: u16| match cells.len() >= LEAST_FOR_WINDOWS && most < IN_WINDOWS {
        true => by_windows(cells, cols, most + 1),
        false => None,
    };
    // Reading the whole raster only for the greatest class takes a third as long as counting.
    let sample = cells.chunks(cols).step_by(SAMPLED).map(greatest).max().unwrap_or(0);
    if let Some(pairs) = windows(sample) {
        return pairs;
    }
    let most = maximum(cells);
    if let Some(pairs) = windows(most) {
        return pairs;
    }
    if most < IN_PAIRS {
        return by_pairs(cells, cols, most + 1);
    }
    let (index, classes) = numbered(cells);
    let pairs = if classes.len() <= IN_TABLE {
        by_table(cells, cols, &index, classes.len())
    } else {
        by_sorting(cells, cols, &index)
    };
    let class = |i: u16| classes[usize::from(i)];
    pairs.into_iter().map(|(a, b, n)| (class(a), class(b), n)).collect()
}

fn greatest(cells: &[u16]) -> u16 {
    cells.iter().copied().max().unwrap_or(0)
}

/// Returns the greatest class of a raster.
fn maximum(cells: &[u16]) -> u16 {
    #[cfg(feature = "parallel")]
    let most = cells.par_chunks(BAND).map(greatest).max().unwrap_or(0);
    #[cfg(not(feature = "parallel"))]
    let most = greatest(cells);
    most
}

/// A raster of at least one row, read row by row. The rows beyond it are no data.
struct Raster<'a> {
    cells: &'a [u16],
    cols: usize,
    outside: Vec<u16>,
}

impl<'a> Raster<'a> {
    fn new(cells: &'a [u16], cols: usize) -> Self {
        Raster { cells, cols, outside: vec![0; cols] }
    }

    fn rows(&self) -> usize {
        self.cells.len() / self.cols
    }

    /// Returns row `r` - 1 and row `r`, up to the first row beyond the raster.
    fn row_below_another(&self, r: usize) -> [&[u16]; 2] {
        let row = |r: usize| &self.cells[r * self.cols..][..self.cols];
        let above = r.checked_sub(1).map_or(&*self.outside, row);
        [above, if r < self.rows() { row(r) } else { &self.outside }]
    }

    /// Returns how often each of `codes` codes occurs. `count` counts those of a range of rows, from the first to
    /// the one beyond the last.
    fn tally(&self, codes: usize, count: impl Fn(&mut Tally, Range<usize>) + Sync) -> Vec<u64> {
        let all = 0..self.rows() + 1;
        #[cfg(feature = "parallel")]
        {
            let bands = (self.cells.len() / BAND).max(1);
            let band = all.end.div_ceil(bands);
            all.clone()
                .into_par_iter()
                .step_by(band)
                .fold(
                    || Tally::new(codes),
                    |mut tally, from| {
                        count(&mut tally, from..all.end.min(from + band));
                        tally
                    },
                )
                .map(Tally::added_up)
                .reduce_with(|mut sums, more| {
                    sums.iter_mut().zip(more).for_each(|(sum, n)| *sum += n);
                    sums
                })
                .unwrap_or_else(|| vec![0; codes])
        }
        #[cfg(not(feature = "parallel"))]
        {
            let mut tally = Tally::new(codes);
            count(&mut tally, all);
            tally.added_up()
        }
    }
}

/// How often each code of 16 bits occurs. Two tables are used in turn, so that a count need not wait for the
/// previous one if codes repeat.
struct Tally {
    tables: [Box<[u32; 1 << 16]>; 2],
    counted: usize,
    sums: Vec<u64>,
}

impl Tally {
    /// Creates a tally of codes below `codes`.
    fn new(codes: usize) -> Self {
        // Zeroed memory from the system, so that only the parts in use are touched.
        let table = || vec![0; 1 << 16].try_into().expect("as long as it was made");
        Tally { tables: [table(), table()], counted: 0, sums: vec![0; codes] }
    }

    /// Counts every `STEP`-th code, beginning with the first.
    fn count<const STEP: usize>(&mut self, codes: &[u16]) {
        // Well before a count of 32 bits overflows.
        for codes in codes.chunks(1 << 30) {
            let [even, odd] = &mut self.tables;
            let mut turns = codes.chunks_exact(2 * STEP);
            for turn in &mut turns {
                even[usize::from(turn[0])] += 1;
                odd[usize::from(turn[STEP])] += 1;
            }
            for &code in turns.remainder().iter().step_by(STEP) {
                even[usize::from(code)] += 1;
            }
            self.counted += codes.len();
            if self.counted >= 1 << 30 {
                self.add_up();
            }
        }
    }

    fn add_up(&mut self) {
        for table in &mut self.tables {
            for (sum, n) in self.sums.iter_mut().zip(table.iter_mut()) {
                *sum += u64::from(std::mem::take(n));
            }
        }
        self.counted = 0;
    }

    /// Returns how often each code was counted.
    fn added_up(mut self) -> Vec<u64> {
        self.add_up();
        self.sums
    }
}

/// Counts by windows of two by two cells, each with four sides, with `k` up to 16 classes; `None` if there are
/// more.
///
/// A side lies in two windows, whose upper left cells are neighbours. Of the windows whose row and column add up to
/// an even number, which are half of them, it lies in exactly one.
fn by_windows(cells: &[u16], cols: usize, k: u16) -> Option<Pairs> {
    // A row's cells with their right neighbours, from the cell before the first on.
    let pair_up = |row: &[u16], pairs: &mut [u16]| {
        pairs[0] = k * row[0];
        for (pair, (left, right)) in pairs[1..].iter_mut().zip(row.iter().zip(&row[1..])) {
            *pair = left + k * right;
        }
        pairs[cols] = row[cols - 1];
    };
    let raster = Raster::new(cells, cols);
    let more = AtomicBool::new(false);
    let sums = raster.tally(usize::from(k).pow(4), |tally, rows| {
        let mut above = vec![0_u16; cols + 1];
        let mut below = above.clone();
        let mut codes = above.clone();
        let row = raster.row_below_another(rows.start)[0];
        if greatest(row) >= k {
            // The thread that counts that row reports it.
            return;
        }
        pair_up(row, &mut above);
        for r in rows {
            let row = raster.row_below_another(r)[1];
            if greatest(row) >= k {
                more.store(true, Ordering::Relaxed);
                return;
            }
            pair_up(row, &mut below);
            for (code, (above, below)) in codes.iter_mut().zip(above.iter().zip(&below)) {
                *code = above.wrapping_add(below.wrapping_mul(k * k));
            }
            tally.count::<2>(&codes[r % 2..]);
            std::mem::swap(&mut above, &mut below);
        }
    });
    if more.into_inner() {
        return None;
    }
    let k = usize::from(k);
    let mut table = vec![0; k * k];
    for (code, n) in sums.into_iter().enumerate().filter(|&(_, n)| n > 0) {
        let [a, b, c, d] = [1, k, k * k, k * k * k].map(|place| code / place % k);
        for (x, y) in [(a, b), (c, d), (a, c), (b, d)] {
            table[x * k + y] += n;
        }
    }
    Some(of_table(&table, k))
}

/// Counts by pairs, the smaller class first, with `k` up to 256 classes. Half a table takes less space in the
/// cache.
fn by_pairs(cells: &[u16], cols: usize, k: u16) -> Pairs {
    let pair = |a: u16, b: u16| a.min(b).wrapping_mul(k).wrapping_add(a.max(b));
    let raster = Raster::new(cells, cols);
    let codes = usize::from(k) * usize::from(k);
    let sums = raster.tally(codes, |tally, rows| {
        let mut codes = vec![0; 2 * cols + 1];
        for r in rows {
            let [above, row] = raster.row_below_another(r);
            let (down, along) = codes.split_at_mut(cols);
            for (code, (&a, &b)) in down.iter_mut().zip(above.iter().zip(row)) {
                *code = pair(a, b);
            }
            for (code, (&a, &b)) in along.iter_mut().zip(row.iter().zip(&row[1..])) {
                *code = pair(a, b);
            }
            (along[cols - 1], along[cols]) = (row[0], row[cols - 1]);
            tally.count::<1>(&codes);
        }
    });
    of_table(&sums, usize::from(k))
}

/// Returns the place of each class among those that occur and 0, and the classes by place.
fn numbered(cells: &[u16]) -> (Vec<u16>, Vec<u16>) {
    let mut occurs = vec![false; 1 << 16];
    occurs[0] = true;
    cells.iter().for_each(|&class| occurs[usize::from(class)] = true);
    let classes: Vec<u16> = (0..=u16::MAX).filter(|&class| occurs[usize::from(class)]).collect();
    let mut index = vec![0_u16; 1 << 16];
    for (i, &class) in (0..=u16::MAX).zip(&classes) {
        index[usize::from(class)] = i;
    }
    (index, classes)
}

fn by_table(cells: &[u16], cols: usize, index: &[u16], width: usize) -> Pairs {
    let mut table = vec![0_u64; width * width];
    each_pair(cells, cols, index, |a, b| table[usize::from(a) * width + usize::from(b)] += 1);
    of_table(&table, width)
}

/// Returns the pairs that occur in a square table.
fn of_table(table: &[u64], width: usize) -> Pairs {
    let sides = |a: usize, b: usize| match a == b {
        true => table[a * width + a],
        false => table[a * width + b] + table[b * width + a],
    };
    (0..width)
        .flat_map(|a| (a..width).map(move |b| (a, b)))
        .map(|(a, b)| (a as u16, b as u16, sides(a, b)))
        .filter(|&(_, _, n)| n > 0)
        .collect()
}

fn by_sorting(cells: &[u16], cols: usize, index: &[u16]) -> Pairs {
    let mut pairs: BTreeMap<(u16, u16), u64> = BTreeMap::new();
    let mut list = Vec::with_capacity(SORTED);
    let mut flush = |list: &mut Vec<u32>| {
        list.sort_unstable();
        for run in list.chunk_by(|a, b| a == b) {
            let (a, b) = ((run[0] >> 16) as u16, (run[0] & 0xffff) as u16);
            *pairs.entry((a, b)).or_insert(0) += run.len() as u64;
        }
        list.clear();
    };
    each_pair(cells, cols, index, |a, b| {
        list.push(u32::from(a.min(b)) << 16 | u32::from(a.max(b)));
        if list.len() == SORTED {
            flush(&mut list);
        }
    });
    flush(&mut list);
    pairs.into_iter().map(|((a, b), n)| (a, b, n)).collect()
}

/// Visits each side once, with the numbers of its two classes; 0 is no data or outside.
fn each_pair(cells: &[u16], cols: usize, index: &[u16], mut visit: impl FnMut(u16, u16)) {
    let number = |class: u16| index[usize::from(class)];
    let mut above: Option<&[u16]> = None;
    for row in cells.chunks_exact(cols) {
        visit(0, number(row[0]));
        for pair in row.windows(2) {
            visit(number(pair[0]), number(pair[1]));
        }
        visit(number(row[cols - 1]), 0);
        match above {
            Some(above) => above.iter().zip(row).for_each(|(&a, &b)| visit(number(a), number(b))),
            None => row.iter().for_each(|&b| visit(0, number(b))),
        }
        above = Some(row);
    }
    above.into_iter().flatten().for_each(|&a| visit(number(a), 0));
}
