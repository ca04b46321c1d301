//! Disjoint sets.

/// Numbers in disjoint sets, joined by size with path halving (R. E. Tarjan and J. van Leeuwen, Worst-case
/// analysis of set union algorithms, J. ACM 31, 1984): nearly constant time per operation.
///
/// Which number represents a set depends only on the order of the joins. Generators that draw once per set rely on
/// this.
#[derive(Clone, Debug, Default)]
pub(crate) struct UnionFind {
    /// The link of each number: the next one towards its representative; or, for a representative, the negated size
    /// of its set. There are fewer than 2^31 numbers.
    links: Vec<i32>,
}

impl UnionFind {
    /// Creates `n` sets of one number each.
    pub(crate) fn new(n: usize) -> Self {
        UnionFind { links: vec![-1; n] }
    }

    /// Adds a set of one number, the next one, and returns the number.
    #[inline]
    pub(crate) fn push(&mut self) -> usize {
        self.links.push(-1);
        self.links.len() - 1
    }

    /// Returns the number that represents the set of `i`.
    #[inline]
    pub(crate) fn find(&mut self, mut i: usize) -> usize {
        loop {
            let next = self.links[i];
            if next < 0 {
                return i;
            }
            let far = self.links[next as usize];
            if far < 0 {
                return next as usize;
            }
            self.links[i] = far;
            i = far as usize;
        }
    }

    /// Whether `i` represents its set.
    #[inline]
    pub(crate) fn represents(&self, i: usize) -> bool {
        self.links[i] < 0
    }

    /// Joins two sets; returns whether they were separate.
    #[inline]
    pub(crate) fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        if a == b {
            return false;
        }
        // Sizes are negative.
        if self.links[a] > self.links[b] {
            self.link(b, a);
        } else {
            self.link(a, b);
        }
        true
    }

    /// Joins two sets, given by their representatives; `kept` represents both afterwards. This is for callers to
    /// whom the representative matters more than the bound on the time.
    #[inline]
    pub(crate) fn link(&mut self, kept: usize, gone: usize) {
        self.links[kept] += self.links[gone];
        self.links[gone] = kept as i32;
    }

    /// Whether two numbers are in one set.
    pub(crate) fn is_joined(&mut self, a: usize, b: usize) -> bool {
        self.find(a) == self.find(b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn sets_are_those_of_relabelling(
            pairs in prop::collection::vec((0..20_usize, 0..20_usize), 0..40),
        ) {
            let (mut sets, mut labels) = (UnionFind::new(19), (0..20).collect::<Vec<_>>());
            prop_assert_eq!(sets.push(), 19);
            for (a, b) in pairs {
                let (old, new) = (labels[a], labels[b]);
                prop_assert_eq!(sets.join(a, b), old != new);
                labels.iter_mut().filter(|label| **label == old).for_each(|label| *label = new);
            }
            for a in 0..20 {
                prop_assert_eq!(labels[sets.find(a)], labels[a]);
                prop_assert_eq!(sets.represents(a), sets.find(a) == a);
                for b in 0..20 {
                    prop_assert_eq!(sets.is_joined(a, b), labels[a] == labels[b]);
                }
            }
        }
    }

    #[test]
    fn the_larger_set_or_the_first_of_equals_gives_the_representative() {
        let mut sets = UnionFind::new(4);
        sets.join(2, 1);
        assert_eq!(sets.find(1), 2);
        sets.join(3, 1);
        assert_eq!(sets.find(3), 2);
    }
}
