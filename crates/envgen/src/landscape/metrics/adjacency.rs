//! Adjacency: how often cells of two classes are neighbours.

use super::sides::count;
use crate::distance::assert_whole_rows;

/// The sides between cells of a raster, counted by the two classes that they separate, each side once. Cells of
/// class 0 are no data; sides beside them and at the raster's end count as border.
///
/// ```
/// use envgen::landscape::metrics::Adjacency;
///
/// // Two rows of three cells.
/// let found = Adjacency::new(&[1, 1, 2, 1, 2, 2], 3);
/// assert_eq!(found.classes(), [(1, 3), (2, 3)]);
/// assert_eq!(found.sides(), [(1, 1, 2), (1, 2, 3), (2, 2, 2)]);
/// assert_eq!(found.edge_count(), 3);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adjacency {
    classes: Vec<(u16, u64)>,
    sides: Vec<(u16, u16, u64)>,
}

impl Adjacency {
    /// Counts the sides of cells given row by row. It takes O(N): with classes up to 15, one look-up in a table for
    /// two cells of a large raster; with up to 512 classes, two per cell; with more, a sort. Large rasters of
    /// classes up to 255 are counted on all cores.
    ///
    /// # Panics
    /// When the number of cells is not a multiple of `cols`.
    #[track_caller]
    pub fn new(cells: &[u16], cols: usize) -> Self {
        assert_whole_rows(cells.len(), cols);
        let mut sides = count(cells, cols);
        let most = sides.iter().map(|side| side.1).max().unwrap_or(0);
        let mut of_class = vec![0; usize::from(most) + 1];
        for &(a, b, n) in &sides {
            of_class[usize::from(a)] += n;
            of_class[usize::from(b)] += n;
        }
        // Four sides per cell; those between two cells of the class are counted from both.
        let classes = (1..=most)
            .zip(&of_class[1..])
            .filter(|&(_, &sides)| sides > 0)
            .map(|(class, sides)| (class, sides / 4))
            .collect();
        sides.retain(|side| side.0 > 0);
        Adjacency { classes, sides }
    }

    /// Returns the classes that occur, with their numbers of cells, sorted by class.
    pub fn classes(&self) -> &[(u16, u64)] {
        &self.classes
    }

    /// Returns the pairs of adjacent classes, the smaller class first, with the number of sides between them,
    /// sorted. A pair of equal classes is a side inside the class.
    pub fn sides(&self) -> &[(u16, u16, u64)] {
        &self.sides
    }

    /// Returns the number of sides between cells of different class.
    pub fn edge_count(&self) -> u64 {
        self.sides.iter().filter(|(a, b, _)| a != b).map(|side| side.2).sum()
    }

    /// Returns, for each class that occurs, the number of sides to other classes, inside the class, and at the
    /// border.
    pub fn class_sides(&self) -> Vec<ClassSides> {
        let mut list: Vec<ClassSides> = self
            .classes
            .iter()
            .map(|&(class, cells)| ClassSides { class, cells, other: 0, own: 0, border: 0 })
            .collect();
        let place = |class: u16| self.classes.binary_search_by_key(&class, |c| c.0);
        for &(a, b, n) in &self.sides {
            if a == b {
                if let Ok(i) = place(a) {
                    list[i].own += n;
                }
            } else {
                for i in [place(a), place(b)].into_iter().flatten() {
                    list[i].other += n;
                }
            }
        }
        for class in &mut list {
            class.border = 4 * class.cells - 2 * class.own - class.other;
        }
        list
    }

    /// Returns the entropies of a cell's class x and its neighbour's class y in bits, with every side read in both
    /// directions: H(x), H(x, y), H(y | x) and the mutual information. `None` if there are no sides.
    pub fn entropies(&self) -> Option<Entropies> {
        let total: u64 = self.sides.iter().map(|side| 2 * side.2).sum();
        if total == 0 {
            return None;
        }
        let bits = |n: u64| {
            let p = n as f64 / total as f64;
            if n > 0 { -p * libm::log2(p) } else { 0.0 }
        };
        // Not `sum`, which is -0 for one class.
        let joint = self
            .sides
            .iter()
            .fold(0.0, |sum, &(a, b, n)| sum + if a == b { bits(2 * n) } else { 2.0 * bits(n) });
        let classes = self.class_sides();
        let marginal =
            classes.iter().fold(0.0, |sum, class| sum + bits(2 * class.own + class.other));
        Some(Entropies {
            marginal,
            joint,
            conditional: (joint - marginal).max(0.0),
            mutual: (2.0 * marginal - joint).max(0.0),
        })
    }
}

/// The sides of a class's cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClassSides {
    /// The class.
    pub class: u16,
    /// Number of its cells.
    pub cells: u64,
    /// Number of sides between it and other classes.
    pub other: u64,
    /// Number of sides between two of its cells.
    pub own: u64,
    /// Number of sides at the raster's end or beside no data.
    pub border: u64,
}

/// The entropies of adjacency in bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entropies {
    /// H(x), the entropy of a cell's class.
    pub marginal: f64,
    /// H(x, y), the joint entropy of a cell's and its neighbour's class.
    pub joint: f64,
    /// H(y | x), the entropy of the neighbour's class if the cell's class is known.
    pub conditional: f64,
    /// The mutual information of the two classes.
    pub mutual: f64,
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::super::sides::Pairs;
    use super::*;
    use crate::seed::Seed;

    /// One cell after the other, each side from both its cells.
    fn slow(cells: &[u16], cols: usize) -> Pairs {
        let rows = cells.len() / cols;
        let mut twice: BTreeMap<(u16, u16), u64> = BTreeMap::new();
        for r in 0..rows as i64 {
            for c in 0..cols as i64 {
                for (dr, dc) in [(0, 1), (1, 0), (0, -1), (-1, 0)] {
                    let (y, x) = (r + dr, c + dc);
                    if y >= 0 && y < rows as i64 && x >= 0 && x < cols as i64 {
                        let a = cells[r as usize * cols + c as usize];
                        let b = cells[y as usize * cols + x as usize];
                        if a > 0 && b > 0 {
                            *twice.entry((a.min(b), a.max(b))).or_insert(0) += 1;
                        }
                    }
                }
            }
        }
        twice.into_iter().map(|((a, b), n)| (a, b, n / 2)).collect()
    }

    #[test]
    fn all_four_methods_agree_with_the_slow_one() {
        let mut stream = Seed(1).stream("test", 0);
        for (rows, cols, classes, spread) in [
            (20, 30, 3, 1),
            (20, 30, 15, 1),
            (1, 50, 15, 1000),
            (50, 1, 15, 7),
            (13, 17, 16, 3),
            (1, 1, 255, 1),
            (33, 2, 254, 1),
            (2, 33, 255, 1),
            (30, 31, 200, 1),
            (1, 70_000, 15, 1),
            (70_000, 1, 3, 1),
            (257, 260, 15, 1),
            (256, 256, 1, 1),
            (300, 299, 9, 1),
            (900, 1100, 9, 1),
            (3, 300_000, 3, 1),
            (300_000, 3, 20, 1),
            (40, 40, 300, 5),
            (60, 60, 900, 70),
            (1, 1, 1, 1),
        ] {
            let cells: Vec<u16> =
                (0..rows * cols).map(|_| (stream.below(classes + 1) * spread) as u16).collect();
            let found = Adjacency::new(&cells, cols);
            assert_eq!(found.sides(), slow(&cells, cols), "{rows} x {cols}, {classes}");
            let mut counts = BTreeMap::new();
            for &class in cells.iter().filter(|&&class| class > 0) {
                *counts.entry(class).or_insert(0_u64) += 1;
            }
            assert_eq!(found.classes(), counts.into_iter().collect::<Vec<_>>());
            assert!(found.sides().is_sorted());
        }
    }

    #[test]
    fn a_class_that_few_rows_hold_is_found() {
        for class in [5, 12, 20, 300, 60_000] {
            for at in [0, 700, 70_001, 89_999] {
                let mut cells = vec![3; 90_000];
                cells[at] = class;
                assert_eq!(Adjacency::new(&cells, 300).sides(), slow(&cells, 300));
            }
        }
    }

    #[test]
    fn four_sides_a_cell() {
        let cells = [1, 1, 0, 2, 1, 1];
        let sides = Adjacency::new(&cells, 3).class_sides();
        assert_eq!(sides[0], ClassSides { class: 1, cells: 4, other: 2, own: 3, border: 8 });
        assert_eq!(sides[1], ClassSides { class: 2, cells: 1, other: 2, own: 0, border: 2 });
        assert!(Adjacency::new(&[], 0).classes().is_empty());
        assert_eq!(Adjacency::new(&[3], 1).entropies(), None);
    }

    #[test]
    fn entropies_of_a_checkerboard() {
        let cells: Vec<u16> = (0..36).map(|i| 1 + (i / 6 + i % 6) % 2).collect();
        let found = Adjacency::new(&cells, 6).entropies().unwrap();
        assert!((found.marginal - 1.0).abs() < 1e-12 && (found.joint - 1.0).abs() < 1e-12);
        assert!(found.conditional.abs() < 1e-12 && (found.mutual - 1.0).abs() < 1e-12);
    }
}
