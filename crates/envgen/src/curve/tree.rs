//! A tree of boxes over elements in order along a path.

use glam::DVec2;

use crate::geometry::Rect;

/// A balanced binary tree over boxes in the order given. Neighbours along a path are neighbours in space, so that
/// no sorting is needed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BoxTree {
    /// The nodes. Node 1 is the root, the children of `n` are `2 n` and `2 n + 1`, and the leaves begin at `leaves`.
    nodes: Vec<Rect>,
    leaves: usize,
}

/// An empty box, which overlaps no other box and is infinitely far away.
const NOTHING: Rect = Rect::new(DVec2::INFINITY, DVec2::NEG_INFINITY);

impl BoxTree {
    pub(super) fn new(boxes: &[Rect]) -> Self {
        let leaves = boxes.len().next_power_of_two();
        let mut nodes = vec![NOTHING; 2 * leaves];
        nodes[leaves..leaves + boxes.len()].copy_from_slice(boxes);
        for n in (1..leaves).rev() {
            nodes[n] = nodes[2 * n].union(nodes[2 * n + 1]);
        }
        BoxTree { nodes, leaves }
    }

    /// Calls `visit` with every box that shares a point with `area`, in order, until it returns true; returns
    /// whether it did.
    pub(super) fn any_overlap(&self, area: Rect, mut visit: impl FnMut(usize) -> bool) -> bool {
        let mut stack = vec![1];
        while let Some(n) = stack.pop() {
            if !self.nodes[n].overlaps(area) {
                continue;
            }
            if n >= self.leaves {
                if visit(n - self.leaves) {
                    return true;
                }
            } else {
                stack.extend([2 * n + 1, 2 * n]);
            }
        }
        false
    }

    /// Calls `visit` with boxes, nearer ones first, whose squared distance from `p` does not exceed the number that
    /// it returned last.
    pub(super) fn nearest(&self, p: DVec2, mut visit: impl FnMut(usize) -> f64) {
        let mut best = f64::INFINITY;
        // A path down a tree of 2^62 leaves leaves no more than 62 others open.
        let mut stack = [(0, 0.0); 64];
        stack[0] = (1, distance_squared(self.nodes[1], p));
        let mut open = 1;
        while open > 0 {
            open -= 1;
            let (n, d) = stack[open];
            if d > best || d == f64::INFINITY {
                continue;
            }
            if n >= self.leaves {
                best = visit(n - self.leaves);
                continue;
            }
            let a = (2 * n, distance_squared(self.nodes[2 * n], p));
            let b = (2 * n + 1, distance_squared(self.nodes[2 * n + 1], p));
            // Of two boxes around the point, the one whose middle is nearer is the better guess.
            let b_first = if a.1 == b.1 {
                let middle = |n: usize| self.nodes[n].center().distance_squared(p);
                middle(a.0) > middle(b.0)
            } else {
                a.1 > b.1
            };
            (stack[open], stack[open + 1]) = if b_first { (a, b) } else { (b, a) };
            open += 2;
        }
    }
}

#[inline]
fn distance_squared(rect: Rect, p: DVec2) -> f64 {
    (rect.min - p).max(p - rect.max).max(DVec2::ZERO).length_squared()
}
