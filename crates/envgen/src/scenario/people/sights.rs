//! Lines of sight between people.

use super::surroundings::Surroundings;
use crate::scenario::doors::DoorState;
use crate::scenario::neighbourhood::Neighbourhood;

/// For each pair of neighbours, whether they saw each other when the lists of neighbours were built. It is computed
/// when it is first used. People therefore notice within [`REBUILD`](crate::scenario::neighbourhood::REBUILD) ticks
/// who comes into sight or goes out of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Sights {
    pairs: Vec<Option<bool>>,
    /// The states of the doors when the lists were built.
    doors: Vec<DoorState>,
}

impl Sights {
    /// Starts again with the pairs of new lists.
    pub(super) fn restart(&mut self, pairs: usize, doors: &[DoorState]) {
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
            around.sees_with_doors(&self.doors, a, b - a)
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::indoor::IndoorSpec;
    use crate::scenario::neighbourhood::REBUILD;
    use crate::scenario::people::Crowd;
    use crate::scenario::tick::TICK;
    use crate::scenario::{Scenario, ScenarioSpec, ScenarioState};
    use crate::{Blueprint, Seed, Spec};

    /// Which pairs see each other, asked in this tick.
    fn ask(state: &mut ScenarioState) -> Vec<bool> {
        let doors = state.doors.clone();
        let around = state.scene.surroundings(&doors, &[], state.tick()).unwrap();
        let Crowd { near, sights, .. } = &mut state.crowd;
        let pairs = 0..near.pair_count() as u32;
        pairs.map(|pair| sights.see_each_other(pair, near, &around)).collect()
    }

    #[test]
    fn who_sees_whom_does_not_depend_on_when_it_is_asked() {
        let world = IndoorSpec::default().generate(Seed(2)).unwrap().to_world();
        let spec = ScenarioSpec {
            people: 20,
            doors: 1.0,
            door_open: 3.0,
            door_closed: 3.0,
            ..Default::default()
        };
        let scenario = Scenario::new(&world, &spec, Seed(2)).unwrap();
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        let mut changed = 0;
        for _ in 0..400 {
            state.step(TICK * REBUILD as f64, &[]).unwrap();
            let at_once = ask(&mut state.clone());
            let mut later = state.clone();
            later.step(TICK * (REBUILD - 1) as f64, &[]).unwrap();
            assert_eq!(ask(&mut later), at_once);
            // With the doors as they are now.
            later.crowd.sights.restart(at_once.len(), &later.doors);
            changed += usize::from(ask(&mut later) != at_once);
        }
        assert!(changed > 10, "doors changed who sees whom {changed} times");
    }
}
