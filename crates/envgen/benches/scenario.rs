//! Steps of people and doors, against comparing everyone with everyone.

use std::hint::black_box;

use bench_ratio::{at_most, contest, faster, growth, seconds};
use envgen::glam::DVec2;
use envgen::indoor::IndoorSpec;
use envgen::scenario::{Scenario, ScenarioSpec, ScenarioState};
use envgen::{Blueprint, Seed, Spec};

/// Simulated seconds per measurement.
const TIME: f64 = 60.0;

/// A map of `side` cells of 3 m with people and doors; `None` where they do not fit.
fn scenario(side: u32, people: u32, doors: f64) -> Option<ScenarioState> {
    let spec = IndoorSpec { width: side, height: side, ..Default::default() };
    let world = spec.generate(Seed(1)).ok()?.to_world();
    let spec = ScenarioSpec { people, doors, ..Default::default() };
    let mut scenario = Scenario::new(&world, &spec, Seed(1)).ok()?;
    scenario.doors.truncate(2 * people as usize / 5);
    let mut state = ScenarioState::new(&world, &scenario).ok()?;
    // Paths to a place are found when it is first gone to.
    state.step(1800.0, &[]).ok()?;
    Some(state)
}

#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
fn main() {
    let Some(mut state) = scenario(16, 50, 1.0) else { return };
    let walking = state.people().iter().filter(|person| person.is_walking()).count();
    let (people, doors) = (state.people().len(), state.doors().len());
    // The least that a model without an index does: the distances of all pairs.
    let naive = |state: &ScenarioState| {
        let positions: Vec<DVec2> = state.people().iter().map(|person| person.position).collect();
        move || {
            let mut near = 0_u32;
            for _ in 0..(20.0 * TIME) as u32 {
                for p in black_box(&positions) {
                    near += positions.iter().map(|q| u32::from(p.distance(*q) < 5.0)).sum::<u32>();
                }
            }
            near
        }
    };
    let all_pairs = naive(&state);
    let times = contest(|| state.step(TIME, &[]), all_pairs);
    println!(
        "{people} people, {walking} of them walking at first, and {doors} doors: {:.0} times real time",
        TIME / times.ours()
    );
    faster("a step of 50 people, against the distances of all pairs", times, 0.5);
    let mut costs = Vec::new();
    for (side, people) in [(16, 50), (32, 200), (50, 500), (71, 1000)] {
        let Some(mut state) = scenario(side, people, 1.0) else { continue };
        let all_pairs = naive(&state);
        let ours = (0..5).map(|_| seconds(|| state.step(TIME, &[]))).fold(f64::INFINITY, f64::min);
        let pairs = seconds(all_pairs);
        let one = ours / f64::from(people) / (20.0 * TIME) * 1e9;
        costs.push((f64::from(people), ours));
        println!(
            "{people} people in {} m: {one:.0} ns per person and step, {:.0} times real time, {:.2} of all pairs",
            3 * side,
            TIME / ours,
            ours / pairs
        );
    }
    growth("a step, by people", &costs);
    if let (Some(first), Some(last)) = (costs.first(), costs.last()) {
        let [first, last] = [first, last].map(|(people, seconds)| seconds / people);
        at_most("a person of 1000, against one of 50", (last, first), 2.0);
    }
}
