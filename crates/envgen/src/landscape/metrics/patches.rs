//! Patches: connected cells of one class.

use serde::{Deserialize, Serialize};

use crate::distance::assert_whole_rows;
use crate::union_find::UnionFind;

/// Which cells count as neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Neighbourhood {
    /// The 4 cells that share a side.
    Four,
    /// The 8 cells that share a side or a corner, as in FRAGSTATS by default.
    #[default]
    Eight,
}

/// A patch: connected cells of one class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Patch {
    /// The class.
    pub class: u16,
    /// Number of cells.
    pub cells: u64,
}

/// Returns the patches of a raster given row by row, in the order of their first cells. Class 0 is no data and
/// forms no patches. It takes O(N), with a union-find that sees two rows at a time; memory grows with the number of
/// pieces found, not with the raster.
///
/// ```
/// use envgen::landscape::metrics::{Neighbourhood, Patch, patches};
///
/// // 1 2
/// // 2 1
/// let cells = [1, 2, 2, 1];
/// assert_eq!(patches(&cells, 2, Neighbourhood::Four).len(), 4);
/// // With corners, the cells of each class are connected.
/// let joined = patches(&cells, 2, Neighbourhood::Eight);
/// assert_eq!(joined, [Patch { class: 1, cells: 2 }, Patch { class: 2, cells: 2 }]);
/// ```
///
/// # Panics
/// When the number of cells is not a multiple of `cols`.
#[track_caller]
pub fn patches(cells: &[u16], cols: usize, neighbourhood: Neighbourhood) -> Vec<Patch> {
    assert_whole_rows(cells.len(), cols);
    if cells.is_empty() {
        return Vec::new();
    }
    let mut pieces = Pieces::default();
    let (mut above, mut labels) = (vec![0_u32; cols], vec![0_u32; cols]);
    let mut last: &[u16] = &[];
    for row in cells.chunks_exact(cols) {
        let same = |at: usize, class: u16| last.get(at).is_some_and(|&other| other == class);
        for c in 0..cols {
            let class = row[c];
            if class == 0 {
                continue;
            }
            let mut label = (c > 0 && row[c - 1] == class).then(|| labels[c - 1]);
            let mut join = |at: usize| {
                label = Some(match label {
                    Some(label) => pieces.join(label, above[at]),
                    None => above[at],
                });
            };
            if same(c, class) {
                join(c);
            } else if neighbourhood == Neighbourhood::Eight {
                // Beside the cell above, the corners are connected to it already.
                if c > 0 && same(c - 1, class) {
                    join(c - 1);
                }
                if same(c + 1, class) {
                    join(c + 1);
                }
            }
            labels[c] = match label {
                Some(label) => pieces.grow(label),
                None => pieces.add(class),
            };
        }
        std::mem::swap(&mut above, &mut labels);
        last = row;
    }
    pieces.patches()
}

/// The pieces of patches that were found so far.
#[derive(Default)]
struct Pieces {
    sets: UnionFind,
    pieces: Vec<Patch>,
}

impl Pieces {
    /// Adds a new piece of one cell.
    fn add(&mut self, class: u16) -> u32 {
        self.pieces.push(Patch { class, cells: 1 });
        self.sets.push() as u32
    }

    /// Adds a cell to a piece; returns the piece that represents its patch.
    fn grow(&mut self, label: u32) -> u32 {
        let piece = self.sets.find(label as usize);
        self.pieces[piece].cells += 1;
        piece as u32
    }

    /// Joins the newer of two pieces to the older one, so that patches keep the order of their first cells.
    fn join(&mut self, a: u32, b: u32) -> u32 {
        let (a, b) = (self.sets.find(a as usize), self.sets.find(b as usize));
        let (old, young) = (a.min(b), a.max(b));
        if old != young {
            self.sets.link(old, young);
            self.pieces[old].cells += self.pieces[young].cells;
        }
        old as u32
    }

    fn patches(self) -> Vec<Patch> {
        let labelled = self.pieces.iter().enumerate();
        labelled
            .filter(|(label, _)| self.sets.represents(*label))
            .map(|(_, patch)| *patch)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Flood fill.
    fn slow(cells: &[u16], cols: usize, neighbourhood: Neighbourhood) -> Vec<Patch> {
        let (rows, mut seen, mut found) = (cells.len() / cols, vec![false; cells.len()], vec![]);
        for start in 0..rows * cols {
            if seen[start] || cells[start] == 0 {
                continue;
            }
            let (mut stack, mut many) = (vec![start], 0);
            seen[start] = true;
            while let Some(at) = stack.pop() {
                many += 1;
                let (r, c) = ((at / cols) as i64, (at % cols) as i64);
                for dr in -1..=1 {
                    for dc in -1..=1_i64 {
                        let (y, x) = (r + dr, c + dc);
                        let corner = dr != 0 && dc != 0;
                        if y < 0 || x < 0 || y >= rows as i64 || x >= cols as i64 {
                            continue;
                        }
                        let next = y as usize * cols + x as usize;
                        let joined = !corner || neighbourhood == Neighbourhood::Eight;
                        if joined && !seen[next] && cells[next] == cells[start] {
                            seen[next] = true;
                            stack.push(next);
                        }
                    }
                }
            }
            found.push(Patch { class: cells[start], cells: many });
        }
        found
    }

    #[test]
    fn corners_join_only_eight_neighbours() {
        let cells = [1, 2, 2, 1];
        assert_eq!(patches(&cells, 2, Neighbourhood::Four).len(), 4);
        assert_eq!(patches(&cells, 2, Neighbourhood::Eight).len(), 2);
        assert!(patches(&[0, 0], 1, Neighbourhood::Four).is_empty());
    }

    proptest! {
        #[test]
        fn patches_are_those_of_a_flood(
            cells in prop::collection::vec(0_u16..4, 1..400), cols in 1_usize..30,
        ) {
            prop_assume!(cells.len() >= cols);
            let cells = &cells[..cells.len() / cols * cols];
            for neighbourhood in [Neighbourhood::Four, Neighbourhood::Eight] {
                prop_assert_eq!(
                    patches(cells, cols, neighbourhood),
                    slow(cells, cols, neighbourhood)
                );
            }
        }
    }
}
