//! Interpolation of a scenario between two ticks.

use super::ScenarioState;

impl ScenarioState {
    /// Returns this state with people and leaves moved linearly towards their positions in a later state of the
    /// same scenario, by a share from 0 (this state) to 1 (the later state). It is intended for programs that
    /// display or move things more often than [`TICKS_PER_SECOND`](super::TICKS_PER_SECOND). Everything else is as
    /// in this state, so that the result must not be stepped.
    ///
    /// ```
    /// use envgen::scenario::{Scenario, ScenarioSpec, ScenarioState};
    /// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
    ///
    /// let world = IndoorSpec::default().generate(Seed(7))?.to_world();
    /// let spec = ScenarioSpec { people: 4, ..Default::default() };
    /// let mut state = ScenarioState::new(&world, &Scenario::new(&world, &spec, Seed(1))?)?;
    /// state.step(20.0, &[])?;
    /// let mut next = state.clone();
    /// next.step(0.05, &[])?;
    /// let between = state.interpolated(&next, 0.4);
    /// for (i, person) in between.people().iter().enumerate() {
    ///     let [from, to] = [&state, &next].map(|state| state.people()[i].position);
    ///     assert!(person.position.distance(from.lerp(to, 0.4)) < 1e-12);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn interpolated(&self, later: &ScenarioState, share: f64) -> ScenarioState {
        let share = share.clamp(0.0, 1.0);
        let mut between = self.clone();
        if share == 0.0 {
            return between;
        }
        for (door, then) in between.doors.iter_mut().zip(&later.doors) {
            door.openness += (then.openness - door.openness) * share;
        }
        for (person, then) in between.crowd.people.iter_mut().zip(&later.crowd.people) {
            person.position = person.position.lerp(then.position, share);
            // Who turns around at once looks back from the middle on.
            let facing = person.facing.lerp(then.facing, share);
            let nearest = if share < 0.5 { person.facing } else { then.facing };
            person.facing = facing.normalize_or(nearest);
        }
        between
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use crate::indoor::IndoorSpec;
    use crate::scenario::tick::TICK;
    use crate::scenario::{Scenario, ScenarioSpec, ScenarioState};
    use crate::{Blueprint, Seed, Spec};

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn what_moves_is_between_where_it_is_and_where_it_goes(
            seed in 0_u64..20,
            seconds in 0_u32..120,
            share in -0.5..1.5,
        ) {
            let world = IndoorSpec::default().generate(Seed(seed)).unwrap().to_world();
            let spec = ScenarioSpec { people: 5, doors: 1.0, ..Default::default() };
            let scenario = Scenario::new(&world, &spec, Seed(seed)).unwrap();
            let mut state = ScenarioState::new(&world, &scenario).unwrap();
            state.step(f64::from(seconds), &[]).unwrap();
            let mut next = state.clone();
            next.step(TICK, &[]).unwrap();
            let between = state.interpolated(&next, share);
            prop_assert_eq!(between.tick(), state.tick());
            for (i, door) in between.doors().iter().enumerate() {
                let [from, to] = [&state, &next].map(|state| state.doors()[i].openness);
                prop_assert!((from.min(to)..=from.max(to)).contains(&door.openness));
            }
            for (i, person) in between.people().iter().enumerate() {
                let [from, to] = [&state, &next].map(|state| state.people()[i].position);
                let (whole, walked) = (from.distance(to), from.distance(person.position));
                prop_assert!((walked - share.clamp(0.0, 1.0) * whole).abs() < 1e-9);
                prop_assert!((person.facing.length() - 1.0).abs() < 1e-9);
            }
            prop_assert_eq!(state.interpolated(&next, 0.0).digest(), state.digest());
        }
    }
}
