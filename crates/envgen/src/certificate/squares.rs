//! The free space of a disc as squares: large ones in open space, small ones at its borders.

use glam::DVec2;

use super::budget::{Budget, Doubt, MAX_SQUARES};
use super::piece::Piece;
use crate::geometry::{Rect, Shape};

/// The cost of a square, in addition to the comparisons with its pieces.
const SQUARE_COST: u64 = 4;

/// Half the diagonal of a square of which half a side is 1.
const DIAGONAL: f64 = std::f64::consts::SQRT_2;

/// Not all of the square is free, and the disc does not have `margin` to spare anywhere in it.
const NARROW: u32 = u32::MAX;
/// All of the square is free, and the disc does not have `margin` to spare anywhere in it.
const FREE: u32 = u32::MAX - 1;
/// All of the square is free, and the disc may have `margin` to spare.
const WIDE: u32 = u32::MAX - 2;

/// A tree of squares over a rectangle. Every point where a disc has some margin to spare, to all pieces and to the
/// outside, lies in a square that is entirely free.
///
/// A point's distance to the nearest piece changes by no more than the point moves, so that the distance at a
/// square's centre bounds it in the whole square. Squares are divided until they are entirely free or cannot
/// contain a point of that margin, at the latest when their diagonal is as long as the margin.
pub(super) struct Squares {
    middle: DVec2,
    half: f64,
    /// The first of four children, or the kind of leaf.
    nodes: Vec<u32>,
    /// For free leaves, the leaf that names their region.
    regions: Vec<u32>,
}

/// A free leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Square {
    pub(super) node: usize,
    pub(super) middle: DVec2,
    /// Half the length of a side.
    pub(super) half: f64,
    /// Whether the disc may have the margin to spare somewhere in the square.
    pub(super) is_wide: bool,
}

struct Builder<'a> {
    pieces: &'a [Piece],
    area: Rect,
    radius: f64,
    margin: f64,
    nodes: Vec<u32>,
    /// Pieces that can be nearest to a point of a square, for all squares on the path from the root.
    near: Vec<u32>,
    distances: Vec<f64>,
}

impl Squares {
    pub(super) fn new(
        pieces: &[Piece],
        area: Rect,
        radius: f64,
        margin: f64,
        budget: &mut Budget,
    ) -> Result<Self, Doubt> {
        let (middle, half) = (area.center(), 0.5 * area.size().max_element());
        let near: Vec<u32> = (0..pieces.len() as u32).collect();
        let (nodes, distances) = (vec![NARROW], Vec::new());
        let mut builder = Builder { pieces, area, radius, margin, nodes, near, distances };
        builder.divide(0, middle, half, 0, budget)?;
        let nodes = builder.nodes;
        let mut squares =
            Squares { middle, half, regions: (0..nodes.len() as u32).collect(), nodes };
        squares.join_inside(0);
        // Every node's next is one before it.
        for node in 0..squares.regions.len() {
            squares.regions[node] = squares.regions[squares.regions[node] as usize];
        }
        Ok(squares)
    }

    /// Returns the free square that contains a point.
    pub(super) fn at(&self, p: DVec2) -> Option<Square> {
        let (mut node, mut middle, mut half) = (0, self.middle, self.half);
        while self.is_divided(node) {
            half *= 0.5;
            let (east, north) = (p.x >= middle.x, p.y >= middle.y);
            let corner = usize::from(east) + 2 * usize::from(north);
            middle = child_middle(middle, half, corner);
            node = self.nodes[node] as usize + corner;
        }
        self.leaf(node, middle, half)
    }

    /// Returns the name of the region to which a free leaf belongs. The squares of a region share sides.
    pub(super) fn region(&self, square: Square) -> usize {
        self.regions[square.node] as usize
    }

    /// Calls `visit` for all free leaves that may have a point in common with a shape.
    pub(super) fn over(
        &self,
        shape: &Shape,
        mut visit: impl FnMut(Square) -> Result<(), Doubt>,
    ) -> Result<(), Doubt> {
        let bounds = shape.bounds();
        let mut open = vec![(0, self.middle, self.half)];
        while let Some((node, middle, half)) = open.pop() {
            if !Rect::new(middle, middle).grown(half).overlaps(bounds) {
                continue;
            }
            if self.is_divided(node) {
                for corner in 0..4 {
                    let middle = child_middle(middle, 0.5 * half, corner);
                    open.push((self.nodes[node] as usize + corner, middle, 0.5 * half));
                }
            } else if let Some(square) = self.leaf(node, middle, half) {
                visit(square)?;
            }
        }
        Ok(())
    }

    fn leaf(&self, node: usize, middle: DVec2, half: f64) -> Option<Square> {
        let is_wide = self.nodes[node] == WIDE;
        self.is_free(node).then_some(Square { node, middle, half, is_wide })
    }

    fn is_divided(&self, node: usize) -> bool {
        self.nodes[node] < WIDE
    }

    fn is_free(&self, node: usize) -> bool {
        matches!(self.nodes[node], FREE | WIDE)
    }

    fn join_inside(&mut self, node: usize) {
        if !self.is_divided(node) {
            return;
        }
        let first = self.nodes[node] as usize;
        (first..first + 4).for_each(|child| self.join_inside(child));
        for (a, b, beside) in [(0, 1, true), (2, 3, true), (0, 2, false), (1, 3, false)] {
            self.join_sides(first + a, first + b, beside);
        }
    }

    /// Joins the free leaves along the side that `b` shares with `a`, which is to the left of it or below it.
    fn join_sides(&mut self, a: usize, b: usize, beside: bool) {
        let children = |squares: &Self, node: usize, corners: [usize; 2]| {
            let divided = squares.is_divided(node);
            corners.map(|corner| if divided { squares.nodes[node] as usize + corner } else { node })
        };
        match (self.is_divided(a), self.is_divided(b)) {
            (false, false) => {
                if self.is_free(a) && self.is_free(b) {
                    let (a, b) = (self.root(a), self.root(b));
                    self.regions[a.max(b)] = a.min(b) as u32;
                }
            }
            (a_divided, _) => {
                // A leaf that is not free joins nothing.
                let leaf = if a_divided { b } else { a };
                if !self.is_divided(leaf) && !self.is_free(leaf) {
                    return;
                }
                let of_a = children(self, a, if beside { [1, 3] } else { [2, 3] });
                let of_b = children(self, b, if beside { [0, 2] } else { [0, 1] });
                self.join_sides(of_a[0], of_b[0], beside);
                self.join_sides(of_a[1], of_b[1], beside);
            }
        }
    }

    fn root(&mut self, mut node: usize) -> usize {
        while self.regions[node] as usize != node {
            self.regions[node] = self.regions[self.regions[node] as usize];
            node = self.regions[node] as usize;
        }
        node
    }
}

impl Builder<'_> {
    /// Divides a square as far as necessary. The pieces `near[from..]` can be nearest to points of it.
    fn divide(
        &mut self,
        node: usize,
        middle: DVec2,
        half: f64,
        from: usize,
        budget: &mut Budget,
    ) -> Result<(), Doubt> {
        let end = self.near.len();
        budget.spend((end - from) as u64 + SQUARE_COST)?;
        self.distances.clear();
        let pieces = self.pieces;
        self.distances
            .extend(self.near[from..end].iter().map(|&i| pieces[i as usize].distance(middle)));
        let least = self.distances.iter().copied().fold(f64::INFINITY, f64::min);
        // The outside counts as a piece one radius beyond the area's sides.
        let sides = (middle - self.area.min).min(self.area.max - middle).min_element();
        let clearance = least.min(sides + self.radius);
        let reach = half * DIAGONAL;
        let is_free = clearance >= self.radius + reach;
        if clearance + reach < self.radius + self.margin {
            self.nodes[node] = if is_free { FREE } else { NARROW };
            return Ok(());
        }
        if is_free {
            self.nodes[node] = WIDE;
            return Ok(());
        }
        if self.nodes.len() + 4 > MAX_SQUARES {
            return Err(Doubt::Squares);
        }
        let first = self.nodes.len();
        self.nodes[node] = first as u32;
        self.nodes.extend([NARROW; 4]);
        for k in 0..end - from {
            if self.distances[k] <= least + 2.0 * reach {
                self.near.push(self.near[from + k]);
            }
        }
        for corner in 0..4 {
            let child = child_middle(middle, 0.5 * half, corner);
            self.divide(first + corner, child, 0.5 * half, end, budget)?;
        }
        self.near.truncate(end);
        Ok(())
    }
}

/// Returns the centre of a child with half a side of `half`, in the order south-west, south-east, north-west,
/// north-east.
fn child_middle(middle: DVec2, half: f64, corner: usize) -> DVec2 {
    let east = if corner % 2 == 1 { half } else { -half };
    let north = if corner >= 2 { half } else { -half };
    middle + DVec2::new(east, north)
}
