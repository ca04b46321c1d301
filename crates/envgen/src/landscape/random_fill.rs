//! Algorithm 1: classes at uniformly random positions.

use crate::seed::Seed;

/// Fillings of up to this many cells, which fit a processor's second-level cache, are shuffled as a whole.
const WHOLE: usize = 1 << 17;

/// Larger fillings are divided into parts of about this many cells.
const PART: usize = 1 << 16;

/// Returns a uniformly random arrangement of `counts[k]` cells of each class `k + 1`: the same distribution as that
/// of the loop of Kuznetsov (2017), section 2. It takes O(N), and 2 bytes per cell.
///
/// A plain shuffle of a large map waits for memory at every step. Here the cells are first dealt to parts, each
/// cell to a uniformly random part, and then shuffled within the parts. This gives every arrangement with the same
/// probability (C. R. Rao, Generation of random permutations, Sankhya A 23, 1961). The dealing is drawn twice from
/// the same stream, once to find the sizes of the parts and once to place the cells, so that no copy is needed.
///
/// ```
/// use envgen::{Seed, landscape::random_fill};
///
/// // Classes count from 1.
/// let cells = random_fill(&[50, 30, 20], Seed(7));
/// let count = |class: u16| cells.iter().filter(|&&cell| cell == class).count();
/// assert_eq!([1, 2, 3].map(count), [50, 30, 20]);
/// ```
///
/// # Panics
/// When there are more than 65535 classes.
#[track_caller]
pub fn random_fill(counts: &[u32], seed: Seed) -> Vec<u16> {
    assert!(counts.len() <= usize::from(u16::MAX), "{} classes, at most 65535", counts.len());
    let total: usize = counts.iter().map(|&n| n as usize).sum();
    let mut cells = Vec::with_capacity(total);
    let mut shuffle = seed.stream("landscape/shuffle", 0);
    if total <= WHOLE {
        for (class, &n) in (1_u16..=u16::MAX).zip(counts) {
            cells.extend(std::iter::repeat_n(class, n as usize));
        }
        shuffle.shuffle(&mut cells);
        return cells;
    }

    let bits = (total / PART).ilog2().clamp(1, 10);
    let mut ends = vec![0; 1 << bits];
    deal(seed, bits, total, |_, part| ends[part] += 1);
    let mut sum = 0;
    for end in &mut ends {
        sum += std::mem::replace(end, sum);
    }
    cells.resize(total, 0);
    let mut classes = counts.iter().enumerate().filter(|(_, n)| **n > 0);
    let (mut class, mut until) = (0_u16, 0);
    // `ends` holds each part's beginning before the dealing and its end after it.
    deal(seed, bits, total, |i, part| {
        if i == until
            && let Some((k, &n)) = classes.next()
        {
            (class, until) = (k as u16 + 1, i + n as usize);
        }
        cells[ends[part]] = class;
        ends[part] += 1;
    });
    let mut start = 0;
    for end in ends {
        shuffle.shuffle(&mut cells[start..end]);
        start = end;
    }
    cells
}

/// Calls `place(i, part)` for each cell, with a part number of `bits` random bits.
#[inline]
fn deal(seed: Seed, bits: u32, total: usize, mut place: impl FnMut(usize, usize)) {
    let mut stream = seed.stream("landscape/deal", 0);
    let (mask, a_word) = ((1_u64 << bits) - 1, 64 / bits as usize);
    let mut i = 0;
    while i < total {
        let mut word = stream.bits();
        for k in i..(i + a_word).min(total) {
            place(k, (word & mask) as usize);
            word >>= bits;
        }
        i += a_word;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(cells: &[u16], classes: usize) -> Vec<u32> {
        let mut counts = vec![0; classes];
        cells.iter().for_each(|&class| counts[usize::from(class) - 1] += 1);
        counts
    }

    #[test]
    fn counts_are_kept() {
        for counts in [&[3, 0, 5][..], &[0, 1], &[200_000, 1, 0, 70_000], &[1 << 20]] {
            assert_eq!(counted(&random_fill(counts, Seed(3)), counts.len()), counts);
        }
        assert!(random_fill(&[0, 0], Seed(1)).is_empty());
    }

    #[test]
    fn every_arrangement_is_as_likely() {
        // 12 arrangements of 2 + 1 + 1 cells; chi-square of 11 degrees, false-alarm rate 1e-4.
        let mut seen = std::collections::BTreeMap::new();
        for seed in 0..12_000 {
            *seen.entry(random_fill(&[2, 1, 1], Seed(seed))).or_insert(0_u32) += 1;
        }
        assert_eq!(seen.len(), 12);
        let chi2: f64 =
            seen.values().map(|&n| (f64::from(n) - 1000.0) * (f64::from(n) - 1000.0) / 1e3).sum();
        assert!(chi2 < 37.4, "chi-square {chi2}");
    }

    #[test]
    fn a_dealt_map_is_mixed_from_end_to_end() {
        // Of 2^18 cells a quarter is of class 1. Chi-square over 64 stretches, 63 degrees of
        // freedom, false-alarm rate 1e-4; and over the cells' places modulo 64.
        let n = 1 << 18;
        let cells = random_fill(&[n / 4, 3 * (n / 4)], Seed(5));
        let (mut stretches, mut places) = ([0_u32; 64], [0_u32; 64]);
        for (i, _) in cells.iter().enumerate().filter(|(_, class)| **class == 1) {
            stretches[i / (n as usize / 64)] += 1;
            places[i % 64] += 1;
        }
        for counts in [stretches, places] {
            let mean = f64::from(n / 256);
            // Without replacement the variance is 3/4 of the mean.
            let chi2: f64 = counts
                .iter()
                .map(|&k| (f64::from(k) - mean) * (f64::from(k) - mean) / (0.75 * mean))
                .sum();
            assert!(chi2 > 25.0 && chi2 < 111.0, "chi-square {chi2}");
        }
    }
}
