//! A tree of boxes over things that lie in order along a path.

use glam::DVec2;

use crate::geometry::Rect;

/// A balanced binary tree over boxes in the order given: neighbours along a path are neighbours in
/// space, so that no sorting is needed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BoxTree {
    /// Node 1 is the root, the children of `n` are `2 n` and `2 n + 1`; leaves from `leaves` on.
    nodes: Vec<Option<Rect>>,
    leaves: usize,
}

impl BoxTree {
    pub(super) fn new(boxes: &[Rect]) -> Self {
        let leaves = boxes.len().next_power_of_two();
        let mut nodes = vec![None; 2 * leaves];
        for (node, rect) in nodes[leaves..].iter_mut().zip(boxes) {
            *node = Some(*rect);
        }
        for n in (1..leaves).rev() {
            nodes[n] = match (nodes[2 * n], nodes[2 * n + 1]) {
                (Some(a), Some(b)) => Some(a.union(b)),
                (a, b) => a.or(b),
            };
        }
        BoxTree { nodes, leaves }
    }

    /// Calls `visit` with every box that shares a point with `area`, in order, until it says true;
    /// returns whether it did.
    pub(super) fn any_overlap(&self, area: Rect, mut visit: impl FnMut(usize) -> bool) -> bool {
        let mut stack = vec![1];
        while let Some(n) = stack.pop() {
            if !self.nodes[n].is_some_and(|rect| rect.overlaps(area)) {
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

    /// Calls `visit` with boxes, nearer ones first, that lie no farther from `p` than the distance
    /// it last returned.
    pub(super) fn nearest(&self, p: DVec2, mut visit: impl FnMut(usize) -> f64) {
        let mut best = f64::INFINITY;
        let distance = |n: usize| self.nodes[n].map_or(f64::INFINITY, |rect| distance(rect, p));
        let mut stack = vec![(1, distance(1))];
        while let Some((n, d)) = stack.pop() {
            if d > best || d == f64::INFINITY {
                continue;
            }
            if n >= self.leaves {
                best = visit(n - self.leaves);
                continue;
            }
            let (a, b) = ((2 * n, distance(2 * n)), (2 * n + 1, distance(2 * n + 1)));
            stack.extend(if a.1 <= b.1 { [b, a] } else { [a, b] });
        }
    }
}

fn distance(rect: Rect, p: DVec2) -> f64 {
    (rect.min - p).max(p - rect.max).max(DVec2::ZERO).length()
}
