//! Disjoint sets.

/// Numbers in disjoint sets, joined by size with path halving.
#[derive(Clone, Debug)]
pub(super) struct Sets {
    parent: Vec<u32>,
    size: Vec<u32>,
}

impl Sets {
    /// `n` sets of one number each.
    pub(super) fn new(n: usize) -> Self {
        Sets { parent: (0..n as u32).collect(), size: vec![1; n] }
    }

    /// The number that represents the set of `i`.
    #[inline]
    pub(super) fn find(&mut self, i: usize) -> usize {
        let mut i = i;
        while self.parent[i] as usize != i {
            self.parent[i] = self.parent[self.parent[i] as usize];
            i = self.parent[i] as usize;
        }
        i
    }

    /// Joins two sets; returns whether they were separate.
    pub(super) fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        if a == b {
            return false;
        }
        let (large, small) = if self.size[a] < self.size[b] { (b, a) } else { (a, b) };
        self.parent[small] = large as u32;
        self.size[large] += self.size[small];
        true
    }
}
