//! Maps whose difficulty is verified by trials: the candidates of a request race, and the nearest to
//! the request is measured again.

use envgen::calibration::{Dials, Estimate, Scale};
use envgen::indoor::{FloorPlan, IndoorError, IndoorSpec, Request};
use envgen::{Blueprint, Seed, World};
use thiserror::Error;

use super::measure::{MeasureError, Measurement, Measuring, check_conditions, measure};
use super::panel::Panel;

/// How near the measured difficulty of a map should be to the request.
pub const NEAR_REQUEST: f64 = 0.7;

/// Number of candidates in the first round.
const RACERS: usize = 5;

/// Number of candidates in the second round.
const FINALISTS: usize = 2;

/// Number of conditions in a round, spread over the panel.
const ROUND: usize = 4;

/// A candidate is dropped if it is farther from the request than the nearest one by more than this many
/// standard errors of the difference.
const DROPPED: f64 = 2.0;

/// An error for which there is no verified map.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum VerifyError {
    /// There are no candidates.
    #[error(transparent)]
    Generate(#[from] IndoorError),
    /// A candidate cannot be measured.
    #[error(transparent)]
    Measure(#[from] MeasureError),
}

/// A map whose difficulty was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Verified {
    /// Plan of the map.
    pub plan: FloorPlan,
    /// Number of the map among the candidates, which are ordered by prediction from the nearest on.
    pub candidate: u32,
    /// World of the map, with the measurement in its provenance.
    pub world: World,
    /// The measurement, by trials that did not take part in the choice.
    pub measurement: Measurement,
    /// What the race measured of each candidate, in the order of predictions from the nearest on.
    pub race: Vec<Dials<Estimate>>,
}

struct Racer<'a> {
    measuring: Measuring<'a>,
    dials: Dials<Estimate>,
    is_dropped: bool,
}

/// Generates a map of a requested difficulty, and verifies it by trials.
///
/// The candidates of a spec of the profile `calibrated` that are predicted nearest to the request race
/// (sequential halving: five in four conditions of the panel, the best two of them in four more). The
/// map whose measured difficulty is nearest is measured once more, with `seeds` fresh trials under each
/// condition. `step` is called with the number of trials in the race so far; with those of the
/// measurement they are at most [`most_trials`].
///
/// # Errors
///
/// If the panel has no conditions, if the request is not allowed or out of reach, or if the panel cannot
/// drive in a candidate.
pub fn verified(
    spec: &IndoorSpec,
    seed: Seed,
    panel: &Panel,
    scale: &Scale,
    seeds: u32,
    step: &mut dyn FnMut(usize),
) -> Result<Verified, VerifyError> {
    check_conditions(panel)?;
    let request = spec.request();
    let mut plans = spec.candidates(seed)?;
    let mut worlds: Vec<World> = plans.iter().take(RACERS).map(FloorPlan::to_world).collect();
    // Noise of the race and of the measurement, which no other map has.
    let noise = |stage: u64| Seed(seed.stream("difficulty/noise", stage).bits());
    let mut racers: Vec<Racer<'_>> = worlds
        .iter()
        .map(|world| Racer {
            measuring: Measuring::new(world, panel, noise(0)),
            dials: Dials::default(),
            is_dropped: false,
        })
        .collect();
    for conditions in rounds(panel.conditions.len()) {
        for i in 0..racers.len() {
            if racers[i].is_dropped {
                continue;
            }
            racers[i].measuring.add(&conditions)?;
            racers[i].dials = racers[i].measuring.dials(scale).unwrap_or_default();
            step(racers.iter().map(|racer| racer.measuring.trials()).sum());
        }
        drop_far(&mut racers, request);
        if racers.iter().filter(|racer| !racer.is_dropped).count() == 1 {
            break;
        }
    }
    let running = (0..racers.len()).filter(|&i| !racers[i].is_dropped);
    let off = |i: &usize| distance(request, &racers[*i].dials);
    let nearest = running.min_by(|a, b| off(a).total_cmp(&off(b)));
    let Some(nearest) = nearest else { unreachable!("the nearest is never dropped") };
    let race: Vec<Dials<Estimate>> = racers.iter().map(|racer| racer.dials).collect();
    let mut world = worlds.swap_remove(nearest);
    let measurement = measure(&world, panel, scale, noise(1), seeds)?;
    world.provenance.measured = Some(Box::new(measurement.measured.clone()));
    let plan = plans.swap_remove(nearest);
    Ok(Verified { plan, candidate: nearest as u32, world, measurement, race })
}

/// Returns the greatest number of trials of [`verified`](fn@verified) with a panel and `seeds` trials
/// under each condition.
pub fn most_trials(panel: &Panel, seeds: u32) -> usize {
    let conditions = panel.conditions.len();
    let [first, second] = rounds(conditions).map(|round| round.len());
    RACERS * first + FINALISTS * second + conditions * seeds.max(1) as usize
}

/// The conditions of each round, spread over the panel.
fn rounds(conditions: usize) -> [Vec<usize>; 2] {
    let count = ROUND.min(conditions);
    // If policies are the inner loop, both policies and lasers change from one to the next.
    let spread = |from: usize| {
        (0..count).map(move |i| (from + i * (conditions + 1) / count) % conditions.max(1))
    };
    let first: Vec<usize> = spread(0).collect();
    let second = spread(1).filter(|i| !first.contains(i)).collect();
    [first, second]
}

fn distance(request: Request, dials: &Dials<Estimate>) -> f64 {
    request.distance(dials.map(|dial| dial.value))
}

/// Drops the racers that are clearly farther from the request than the nearest, and all but the nearest
/// [`FINALISTS`].
fn drop_far(racers: &mut [Racer<'_>], request: Request) {
    let error = |dials: &Dials<Estimate>| {
        let squares = request.0.zip(*dials).named().map(|(_, (wanted, dial))| {
            wanted.map_or(0.0, |_| dial.standard_error * dial.standard_error)
        });
        squares.iter().sum::<f64>()
    };
    let off = |racer: &Racer<'_>| distance(request, &racer.dials);
    let mut running: Vec<usize> = (0..racers.len()).filter(|&i| !racers[i].is_dropped).collect();
    running.sort_by(|&a, &b| off(&racers[a]).total_cmp(&off(&racers[b])));
    let Some(&nearest) = running.first() else { return };
    let nearest = racers[nearest].dials;
    for (place, &i) in running.iter().enumerate() {
        let farther = off(&racers[i]) - distance(request, &nearest);
        let deviation = (error(&racers[i].dials) + error(&nearest)).sqrt();
        racers[i].is_dropped = place >= FINALISTS || farther > DROPPED * deviation;
    }
}

#[cfg(test)]
mod tests {
    use envgen::Spec;
    use envgen::indoor::Profile;
    use envgen::reproduction::{Reproduction, reproduce};

    use super::*;
    use crate::difficulty::reference_scale;

    #[test]
    fn every_round_has_all_policies_and_lasers() {
        let panel = Panel::reference();
        let [first, second] = rounds(12);
        assert!(first.iter().all(|i| !second.contains(i)));
        for round in [first, second] {
            let policies: Vec<_> = round.iter().map(|&i| panel.conditions[i].policy).collect();
            let lasers: Vec<_> = round.iter().map(|&i| &panel.conditions[i].laser).collect();
            for i in 0..4 {
                assert!(policies[..i].iter().all(|one| *one != policies[i]), "{policies:?}");
            }
            for laser in panel.conditions.iter().map(|condition| &condition.laser) {
                assert!(lasers.contains(&laser), "{lasers:?}");
            }
        }
        assert_eq!(most_trials(&panel, 1), 5 * 4 + 2 * 4 + 12);
        for few in 0..40 {
            let [first, second] = rounds(few);
            assert_eq!(first.len(), few.min(4));
            let mut all = [first, second].concat();
            all.sort_unstable();
            assert!(all.windows(2).all(|pair| pair[0] < pair[1]), "{all:?}");
            assert!(all.iter().all(|&i| i < few));
        }
    }

    #[test]
    fn a_panel_without_conditions_verifies_nothing() {
        let mut panel = Panel::reference();
        panel.conditions.clear();
        assert_eq!(most_trials(&panel, 1), 0);
        let spec = IndoorSpec { profile: Profile::Calibrated, ..Default::default() };
        let found = verified(&spec, Seed(4), &panel, reference_scale(), 1, &mut |_| ());
        let error = MeasureError::NoConditions { panel: "reference".to_owned() };
        assert_eq!(found, Err(VerifyError::Measure(error)));
    }

    #[test]
    fn two_at_most_reach_the_second_round() {
        let panel = Panel::reference();
        let world = IndoorSpec { width: 5, height: 5, ..Default::default() };
        let world = world.generate(Seed(1)).expect("a map").to_world();
        let request = Request(Dials { difficulty: Some(5.0), mapping: None, navigation: None });
        let racing = |values: [f64; 5], standard_error| {
            let mut racers = values.map(|value| Racer {
                measuring: Measuring::new(&world, &panel, Seed(1)),
                dials: Dials { difficulty: Estimate { value, standard_error }, ..Dials::default() },
                is_dropped: false,
            });
            drop_far(&mut racers, request);
            racers.map(|racer| !racer.is_dropped)
        };
        assert_eq!(racing([9.0, 5.1, 4.8, 5.3, 1.0], 0.3), [false, true, true, false, false]);
        assert_eq!(racing([9.0, 5.1, 6.8, 7.3, 1.0], 0.3), [false, true, false, false, false]);
        assert_eq!(racing([5.0; 5], 0.3), [true, true, false, false, false]);
    }

    #[test]
    fn the_winner_is_measured_again_and_can_be_made_again() {
        let mut panel = Panel::reference();
        panel.conditions.truncate(2);
        panel.conditions.iter_mut().for_each(|one| {
            (one.time_per_area, one.time_limit) = (None, 60.0);
        });
        let profile = Profile::Calibrated;
        let base = IndoorSpec { width: 5, height: 5, profile, ..Default::default() };
        let [least, most] = base.reachable().difficulty;
        let spec = IndoorSpec { difficulty: 0.5 * (least + most), ..base };
        let mut trials = Vec::new();
        let make = |step: &mut dyn FnMut(usize)| {
            verified(&spec, Seed(4), &panel, reference_scale(), 1, step).expect("a map")
        };
        let found = make(&mut |count| trials.push(count));
        assert_eq!((found.race.len(), found.measurement.measured.trials), (RACERS, 2));
        assert!(trials.len() >= RACERS && trials.is_sorted(), "{trials:?}");
        assert_eq!(found.world.provenance.measured.as_deref(), Some(&found.measurement.measured));
        let Reproduction::Same(_) = reproduce(&found.world) else {
            panic!("another world: {:?}", reproduce(&found.world))
        };
        let again = IndoorSpec { candidate: found.candidate, ..spec.clone() };
        assert_eq!(again.generate(Seed(4)).as_ref(), Ok(&found.plan));
        assert_eq!(make(&mut |_| ()), found);
        let fresh = found.measurement.measured.noise_seed;
        assert_ne!(fresh, Seed(Seed(4).stream("difficulty/noise", 0).bits()));
    }
}
