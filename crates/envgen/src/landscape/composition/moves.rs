//! Moves of cells between classes that bring the entropy nearer to its target.

use super::entropy_term::n_ln_n;

/// Returns the increase of the sum of n ln n by the `n`-th cell of a class, which rises with `n`.
fn marginal(n: u32) -> f64 {
    n_ln_n(n) - n_ln_n(n - 1)
}

/// Moves single cells between classes, the best move first, while the entropy comes nearer to its target; then
/// makes pairs of moves of a few cells each, whose changes can nearly cancel; and repeats this until neither helps.
pub(super) fn move_single_cells(counts: &mut Vec<u32>, entropy: f64, floor: u32) {
    let cells: u64 = counts.iter().map(|&n| u64::from(n)).sum();
    let cells = cells as f64;
    let mut moves = Moves::new(counts, floor);
    // S = ln N - sum / N, so the sum of n ln n is what must come near this.
    let wanted = (libm::log(cells) - entropy) * cells;
    let mut miss = moves.sum() - wanted;
    loop {
        let before = miss;
        for best in [Moves::best_single, Moves::best_pair] {
            while let Some(next) = best(&moves, miss) {
                let left = next.sum() - wanted;
                if left.abs() >= miss.abs() {
                    break;
                }
                (moves, miss) = (next, left);
            }
        }
        // A pair can leave room for another single move.
        if miss == before {
            break;
        }
    }
    counts.clear();
    for &(n, many) in moves.groups.iter().rev() {
        counts.extend(std::iter::repeat_n(n, many));
    }
}

/// Pairs of moves are tried if there are at most this many moves. With more kinds of counts, single moves come near
/// enough.
const PAIRED: usize = 1 << 13;

/// The greatest number of cells in a move of a pair. In small landscapes it is 1 % of the cells, and at least 2. As the
/// counts are nearly geometric, single cells change the sum by multiples of one number; several cells at once do not.
const LARGEST_MOVE: u64 = 8;

/// The counts as a sorted list of (count, number of classes). Classes of equal count are alike, and only few counts
/// differ.
#[derive(Clone)]
struct Moves {
    groups: Vec<(u32, usize)>,
    floor: u32,
}

impl Moves {
    /// Creates the list from counts in descending order.
    fn new(counts: &[u32], floor: u32) -> Self {
        let mut groups: Vec<(u32, usize)> =
            counts.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect();
        groups.reverse();
        Moves { groups, floor }
    }

    /// Returns the sum of n ln n.
    fn sum(&self) -> f64 {
        self.groups.iter().map(|&(n, many)| n_ln_n(n) * many as f64).sum()
    }

    /// Returns the counts after `cells` cells were moved from a class of `from` cells to one that then has `to`;
    /// `None` if there are no such classes, or if the first class must not lose that many.
    fn moved(&self, from: u32, to: u32, cells: u32) -> Option<Moves> {
        if from < self.floor + cells {
            return None;
        }
        let mut moved = self.clone();
        regroup(&mut moved.groups, from, from - cells)?;
        regroup(&mut moved.groups, to, to + cells)?;
        Some(moved)
    }

    /// Returns the move that leaves the least of `miss`, the excess of the sum. Moving a cell from a to b lowers
    /// the sum by marginal(a) - marginal(b + 1).
    fn best_single(&self, miss: f64) -> Option<Moves> {
        let mut best: Option<(f64, u32, u32)> = None;
        for &(from, many) in self.groups.iter().filter(|group| group.0 > self.floor) {
            let ideal = marginal(from) - miss;
            let at = self.groups.partition_point(|group| marginal(group.0 + 1) < ideal);
            for &(to, _) in &self.groups[at.saturating_sub(2)..(at + 2).min(self.groups.len())] {
                if to == from && many < 2 {
                    continue;
                }
                let left = (miss - marginal(from) + marginal(to + 1)).abs();
                if best.is_none_or(|(least, ..)| left < least) {
                    best = Some((left, from, to));
                }
            }
        }
        best.and_then(|(_, from, to)| self.moved(from, to, 1))
    }

    /// Returns the two moves that together leave the least of `miss`.
    fn best_pair(&self, miss: f64) -> Option<Moves> {
        let kinds = self.groups.len();
        let cells: u64 = self.groups.iter().map(|&(n, many)| u64::from(n) * many as u64).sum();
        let few = (cells / 100).clamp(2, LARGEST_MOVE);
        let largest = few.min((PAIRED / (kinds * kinds)) as u64) as u32;
        let mut moves = Vec::new();
        for &(from, _) in &self.groups {
            for cells in 1..=largest.min(from.saturating_sub(self.floor)) {
                let loss = n_ln_n(from - cells) - n_ln_n(from);
                moves.extend(
                    self.groups.iter().map(|&(to, _)| {
                        (loss + n_ln_n(to + cells) - n_ln_n(to), (from, to, cells))
                    }),
                );
            }
        }
        moves.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let apply = |counts: &Moves, (from, to, cells)| counts.moved(from, to, cells);
        let sum = self.sum();
        let mut best: Option<(f64, Moves)> = None;
        for &(change, first) in &moves {
            let ideal = -miss - change;
            let at = moves.partition_point(|step| step.0 < ideal);
            for &(other, second) in &moves[at.saturating_sub(2)..(at + 2).min(moves.len())] {
                let least = best.as_ref().map_or(miss.abs(), |found| found.0);
                if (miss + change + other).abs() >= least {
                    continue;
                }
                // Moves of the same class change each other's effect.
                if let Some(both) = apply(self, first).and_then(|next| apply(&next, second)) {
                    let left = (miss + both.sum() - sum).abs();
                    if left < least {
                        best = Some((left, both));
                    }
                }
            }
        }
        best.map(|found| found.1)
    }
}

/// Changes the count of one class in the sorted list; `None` if there are no such classes.
fn regroup(groups: &mut Vec<(u32, usize)>, from: u32, to: u32) -> Option<()> {
    let at = groups.binary_search_by_key(&from, |group| group.0).ok()?;
    groups[at].1 -= 1;
    if groups[at].1 == 0 {
        groups.remove(at);
    }
    match groups.binary_search_by_key(&to, |group| group.0) {
        Ok(i) => groups[i].1 += 1,
        Err(i) => groups.insert(i, (to, 1)),
    }
    Some(())
}
