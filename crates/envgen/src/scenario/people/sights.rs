//! Who sees whom.

use super::surroundings::Surroundings;
use crate::scenario::doors::DoorState;
use crate::scenario::neighbourhood::Neighbourhood;

/// Whether the people of each pair of neighbours saw each other when the lists of neighbours were built: people notice
/// within [`REBUILD`](crate::scenario::neighbourhood::REBUILD) ticks who comes into sight. Found when it is first asked.
#[derive(Clone, Debug, Default)]
pub(super) struct Sights {
    pairs: Vec<Option<bool>>,
    /// The doors when the lists were built.
    doors: Vec<DoorState>,
}

impl Sights {
    /// Starts again with the pairs of new lists.
    pub(super) fn forget(&mut self, pairs: usize, doors: &[DoorState]) {
        self.pairs.clear();
        self.pairs.resize(pairs, None);
        self.doors.clear();
        self.doors.extend_from_slice(doors);
    }

    /// Whether no wall and no leaf of a door is between the people of a pair.
    pub(super) fn see_each_other(
        &mut self,
        pair: u32,
        near: &Neighbourhood,
        around: &Surroundings<'_>,
    ) -> bool {
        *self.pairs[pair as usize].get_or_insert_with(|| {
            let [a, b] = near.pair_positions(pair);
            around.sees_past(&self.doors, a, b - a)
        })
    }
}
