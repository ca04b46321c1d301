//! How often which class lies beside which.

use std::collections::BTreeMap;

/// Classes below this number fit into 4 bits.
const FEW: usize = 16;

/// Up to this many classes are counted in a full table.
const TABLE: usize = 512;

/// Pairs that are sorted at a time where there are more.
const SORTED: usize = 1 << 20;

/// The sides between cells of a raster, by the two classes that they part, each side once. Cells
/// of class 0 are no data; sides to them and the raster's end count as border.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adjacency {
    classes: Vec<(u16, u64)>,
    sides: Vec<(u16, u16, u64)>,
}

impl Adjacency {
    /// Counts the sides of cells given row by row. O(N); with up to 15 classes one table access a
    /// cell, with up to 512 two, and with more a sort.
    pub fn new(cells: &[u16], cols: usize) -> Self {
        let most = cells.iter().copied().max().unwrap_or(0);
        let few = usize::from(most) < FEW;
        let (index, classes) = if few { Default::default() } else { numbered(cells) };
        if few || classes.len() < FEW {
            return Adjacency::of_few(cells, cols, &index, &classes);
        }
        let pairs = if classes.len() <= TABLE {
            by_table(cells, cols, &index, classes.len() + 1)
        } else {
            by_sorting(cells, cols, &index)
        };
        Adjacency::named(classes, pairs)
    }

    /// With few classes: without `index` they are their own numbers.
    fn of_few(cells: &[u16], cols: usize, index: &[u16], classes: &[(u16, u64)]) -> Self {
        let triples = triples(cells, cols, index);
        let mut pairs = Pairs::new();
        let mut own_counts = [0_u64; FEW];
        for (code, &n) in (0_u16..=u16::MAX).zip(&triples) {
            let (own, right, down) = (code & 15, code >> 4 & 15, code >> 8);
            own_counts[usize::from(own)] += n;
            add(&mut pairs, own, right, n);
            add(&mut pairs, own, down, n);
        }
        if !classes.is_empty() {
            return Adjacency::named(classes.to_vec(), pairs);
        }
        let counted = (0_u16..).zip(own_counts).filter(|&(class, n)| class > 0 && n > 0);
        let sides = pairs.into_iter().map(|((a, b), n)| (a, b, n)).collect();
        Adjacency { classes: counted.collect(), sides }
    }

    /// From pairs of numbers, which are the classes' places from 1 on, so that pairs sort as the
    /// classes do.
    fn named(classes: Vec<(u16, u64)>, pairs: Pairs) -> Self {
        let class = |i: u16| classes[usize::from(i) - 1].0;
        let sides = pairs.into_iter().map(|((a, b), n)| (class(a), class(b), n)).collect();
        Adjacency { classes, sides }
    }

    /// The classes that occur, with their numbers of cells, by class.
    pub fn classes(&self) -> &[(u16, u64)] {
        &self.classes
    }

    /// The pairs of classes that lie beside each other, the smaller class first, with the number
    /// of sides between them, in order. A pair of equal classes is a side inside the class.
    pub fn sides(&self) -> &[(u16, u16, u64)] {
        &self.sides
    }

    /// The number of sides between cells of different class.
    pub fn edge_count(&self) -> u64 {
        self.sides.iter().filter(|(a, b, _)| a != b).map(|side| side.2).sum()
    }

    /// For each class that occurs: sides to other classes, sides inside the class, and sides at
    /// the border.
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

    /// The entropies of a cell's class x and its neighbour's class y in bits, every side read both
    /// ways: H(x), H(x, y), H(y | x) and the mutual information. `None` without any side.
    pub fn entropies(&self) -> Option<Entropies> {
        let total: u64 = self.sides.iter().map(|side| 2 * side.2).sum();
        if total == 0 {
            return None;
        }
        let bits = |n: u64| {
            let p = n as f64 / total as f64;
            if n > 0 { -p * libm::log2(p) } else { 0.0 }
        };
        let joint: f64 = self
            .sides
            .iter()
            .map(|&(a, b, n)| if a == b { bits(2 * n) } else { 2.0 * bits(n) })
            .sum();
        let marginal: f64 =
            self.class_sides().iter().map(|class| bits(2 * class.own + class.other)).sum();
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
    /// Its cells.
    pub cells: u64,
    /// Sides between it and other classes.
    pub other: u64,
    /// Sides between two of its cells.
    pub own: u64,
    /// Sides at the raster's end or beside no data.
    pub border: u64,
}

/// Entropies of adjacency in bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entropies {
    /// H(x), of a cell's class.
    pub marginal: f64,
    /// H(x, y), of a cell's and its neighbour's class.
    pub joint: f64,
    /// H(y | x), of the neighbour's class where the cell's is known.
    pub conditional: f64,
    /// What the one tells of the other.
    pub mutual: f64,
}

type Pairs = BTreeMap<(u16, u16), u64>;

fn add(pairs: &mut Pairs, a: u16, b: u16, n: u64) {
    if a > 0 && b > 0 && n > 0 {
        *pairs.entry((a.min(b), a.max(b))).or_insert(0) += n;
    }
}

/// The classes that occur, with their numbers of cells, and the place of each from 1 on.
fn numbered(cells: &[u16]) -> (Vec<u16>, Vec<(u16, u64)>) {
    let mut histogram = vec![0_u64; 1 << 16];
    cells.iter().for_each(|&class| histogram[usize::from(class)] += 1);
    let counted = (0..=u16::MAX).zip(histogram).filter(|&(class, n)| class > 0 && n > 0);
    let classes: Vec<(u16, u64)> = counted.collect();
    let mut index = vec![0_u16; 1 << 16];
    for (i, &(class, _)) in (1..=u16::MAX).zip(&classes) {
        index[usize::from(class)] = i;
    }
    (index, classes)
}

/// How often each cell stands with its right and its lower neighbour, all three in 12 bits.
fn triples(cells: &[u16], cols: usize, index: &[u16]) -> Vec<u64> {
    // Two tables by turns: a count need not wait for the one before it.
    let mut tables = [[0_u32; 4096]; 2];
    let mut triples = vec![0_u64; 4096];
    let (mut codes, mut row) = (vec![0_u16; cols], vec![0_u16; cols]);
    let mut below = vec![0_u16; cols];
    let mut rows = cells.chunks_exact(cols.max(1));
    let number = |from: &[u16], to: &mut [u16]| {
        if index.is_empty() {
            to.copy_from_slice(from);
            return;
        }
        for (n, &class) in to.iter_mut().zip(from) {
            *n = index[usize::from(class)];
        }
    };
    let Some(first) = rows.next() else { return triples };
    number(first, &mut row);
    let mut counted = 0_usize;
    loop {
        let next = rows.next();
        match next {
            Some(next) => number(next, &mut below),
            None => below.fill(0),
        }
        for (code, (own, down)) in codes.iter_mut().zip(row.iter().zip(&below)) {
            *code = own | down << 8;
        }
        for (code, right) in codes.iter_mut().zip(&row[1..]) {
            *code |= right << 4;
        }
        for pair in codes.chunks(2) {
            for (table, &code) in tables.iter_mut().zip(pair) {
                table[usize::from(code & 4095)] += 1;
            }
        }
        counted += cols;
        // Well before a count of 32 bits is full.
        if counted >= 1 << 31 || next.is_none() {
            for table in &mut tables {
                for (sum, n) in triples.iter_mut().zip(table) {
                    *sum += u64::from(std::mem::take(n));
                }
            }
            counted = 0;
        }
        if next.is_none() {
            break;
        }
        std::mem::swap(&mut row, &mut below);
    }
    triples
}

fn by_table(cells: &[u16], cols: usize, index: &[u16], width: usize) -> Pairs {
    let mut table = vec![0_u64; width * width];
    each_pair(cells, cols, index, |a, b| table[usize::from(a) * width + usize::from(b)] += 1);
    let mut pairs = Pairs::new();
    for (at, &n) in table.iter().enumerate() {
        add(&mut pairs, (at / width) as u16, (at % width) as u16, n);
    }
    pairs
}

fn by_sorting(cells: &[u16], cols: usize, index: &[u16]) -> Pairs {
    let mut pairs = Pairs::new();
    let mut list = Vec::with_capacity(SORTED);
    let mut flush = |list: &mut Vec<u32>| {
        list.sort_unstable();
        for run in list.chunk_by(|a, b| a == b) {
            add(&mut pairs, (run[0] >> 16) as u16, (run[0] & 0xffff) as u16, run.len() as u64);
        }
        list.clear();
    };
    each_pair(cells, cols, index, |a, b| {
        list.push(u32::from(a) << 16 | u32::from(b));
        if list.len() == SORTED {
            flush(&mut list);
        }
    });
    flush(&mut list);
    pairs
}

/// Visits each side once, with the numbers of its two classes; 0 is no data.
fn each_pair(cells: &[u16], cols: usize, index: &[u16], mut visit: impl FnMut(u16, u16)) {
    let number = |class: u16| index[usize::from(class)];
    let mut above: Option<&[u16]> = None;
    for row in cells.chunks_exact(cols.max(1)) {
        for pair in row.windows(2) {
            visit(number(pair[0]), number(pair[1]));
        }
        if let Some(above) = above {
            for (&a, &b) in above.iter().zip(row) {
                visit(number(a), number(b));
            }
        }
        above = Some(row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;

    /// One cell after the other, each side from both its cells.
    fn slow(cells: &[u16], cols: usize) -> Pairs {
        let rows = cells.len() / cols;
        let mut twice = Pairs::new();
        for r in 0..rows as i64 {
            for c in 0..cols as i64 {
                for (dr, dc) in [(0, 1), (1, 0), (0, -1), (-1, 0)] {
                    let (y, x) = (r + dr, c + dc);
                    if y >= 0 && y < rows as i64 && x >= 0 && x < cols as i64 {
                        let a = cells[r as usize * cols + c as usize];
                        let b = cells[y as usize * cols + x as usize];
                        add(&mut twice, a, b, 1);
                    }
                }
            }
        }
        twice.into_iter().map(|(pair, n)| (pair, n / 2)).collect()
    }

    #[test]
    fn all_three_ways_agree_with_the_slow_one() {
        let mut stream = Seed(1).stream("test", 0);
        for (rows, cols, classes, spread) in [
            (20, 30, 3, 1),
            (20, 30, 15, 1),
            (1, 50, 15, 1000),
            (50, 1, 15, 7),
            (13, 17, 16, 3),
            (40, 40, 300, 5),
            (60, 60, 900, 70),
            (1, 1, 1, 1),
        ] {
            let cells: Vec<u16> =
                (0..rows * cols).map(|_| (stream.below(classes + 1) * spread) as u16).collect();
            let found = Adjacency::new(&cells, cols);
            let sides: Pairs = found.sides().iter().map(|&(a, b, n)| ((a, b), n)).collect();
            assert_eq!(sides, slow(&cells, cols), "{rows} x {cols}, {classes}");
            assert!(found.sides().is_sorted());
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
