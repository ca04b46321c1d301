//! The Markov chain of straight segments and turns.

use serde::Serialize;
use thiserror::Error;

use super::spec::HallwaySpec;
use super::state::State;
use crate::error::SpecError;
use crate::seed::Stream;

/// The Markov chain of equation (1) of the paper, with `p_ss` = 1 - `p_st` and `p_ts` = 1 - `p_tt`.
///
/// ```
/// use envgen::Seed;
/// use envgen::hallway::{HallwayChain, State};
///
/// let chain = HallwayChain::new(0.2, 0.5)?;
/// assert_eq!(chain.matrix()[2][4], 0.2); // from state 3, straight up, to state 5, a left turn
/// let states = chain.sample(State::UP, 1000, &mut Seed(7).stream("example", 0));
/// let (low, high) = HallwayChain::estimate(&states)?.p_st.wilson(3.0);
/// assert!((low..=high).contains(&0.2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HallwayChain {
    p_st: f64,
    p_tt: f64,
}

impl HallwayChain {
    /// Creates the chain in which a turn follows a straight segment with probability `p_st`, and follows a turn
    /// with probability `p_tt`.
    ///
    /// # Errors
    /// When a probability lies outside [0, 1].
    pub fn new(p_st: f64, p_tt: f64) -> Result<Self, SpecError> {
        const { HallwaySpec::setting("p_st") }.check(p_st)?;
        const { HallwaySpec::setting("p_tt") }.check(p_tt)?;
        Ok(HallwayChain { p_st, p_tt })
    }

    /// Returns the transition matrix: row and column `k` belong to state `k + 1`.
    pub fn matrix(&self) -> [[f64; 8]; 8] {
        let mut rows = [[0.0; 8]; 8];
        for state in State::ALL {
            let row = &mut rows[usize::from(state.number() - 1)];
            let p = self.turn_probability(state);
            row[usize::from(state.straight().number() - 1)] = 1.0 - p;
            row[usize::from(state.turn().number() - 1)] = p;
        }
        rows
    }

    /// Returns the probability that a turn follows the given state.
    #[inline]
    pub fn turn_probability(&self, state: State) -> f64 {
        if state.is_turn() { self.p_tt } else { self.p_st }
    }

    /// Returns the stationary distribution: the shares of states 1..=8 in the long run.
    ///
    /// With `p_st` = 0 and `p_tt` < 1, a straight segment is never followed by a turn, and the result is the limit
    /// for `p_st` approaching 0: a quarter for each straight state.
    ///
    /// ```
    /// use envgen::hallway::HallwayChain;
    ///
    /// let law = HallwayChain::new(0.4, 0.0)?.stationary()?;
    /// assert!((law.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    /// // Turns are states 5 to 8: their share is p_st / (p_st + 1 - p_tt).
    /// assert!((law[4..].iter().sum::<f64>() - 0.4 / 1.4).abs() < 1e-12);
    /// # Ok::<(), envgen::SpecError>(())
    /// ```
    ///
    /// # Errors
    /// When `p_st` = 0 and `p_tt` = 1: straights follow straights and turns follow turns forever, so that the
    /// stationary distribution is not unique.
    pub fn stationary(&self) -> Result<[f64; 8], SpecError> {
        let leave = self.p_st + (1.0 - self.p_tt);
        if leave <= 0.0 {
            return Err(SpecError::new(
                "start",
                "stationary",
                "a state 1 to 8 when p_st = 0 and p_tt = 1: there the stationary law is not unique",
            ));
        }
        let straight = (1.0 - self.p_tt) / (4.0 * leave);
        let turn = self.p_st / (4.0 * leave);
        Ok([straight, straight, straight, straight, turn, turn, turn, turn])
    }

    /// Returns the expected number of turns among `n` states, including the start state.
    ///
    /// ```
    /// use envgen::hallway::{HallwayChain, State};
    ///
    /// let chain = HallwayChain::new(0.4, 0.0)?;
    /// // Of two states the second is a turn with probability 0.4.
    /// assert!((chain.expected_turns(State::UP, 2) - 0.4).abs() < 1e-12);
    /// assert!((chain.expected_turns(State::UP, 1000) / 1000.0 - 0.4 / 1.4).abs() < 1e-3);
    /// # Ok::<(), envgen::SpecError>(())
    /// ```
    pub fn expected_turns(&self, start: State, n: usize) -> f64 {
        let p_ts = 1.0 - self.p_tt;
        let leave = self.p_st + p_ts;
        let t0 = if start.is_turn() { 1.0 } else { 0.0 };
        let n = n as f64;
        if leave <= 0.0 {
            return t0 * n;
        }
        if leave < RARE {
            let stay = sum_of_powers(leave, n);
            return t0 * stay + self.p_st * sum_of_sums(leave, n, stay);
        }
        let tau = self.p_st / leave;
        let rho = 1.0 - leave;
        // (1 - rho^n) / (1 - rho), where 1 - rho is `leave`.
        n * tau + (t0 - tau) * (1.0 - libm::pow(rho, n)) / leave
    }

    /// Draws a sequence of `n` states that begins with `start`, with one uniform number per transition.
    pub fn sample(&self, start: State, n: usize, stream: &mut Stream) -> Vec<State> {
        let mut state = start;
        let mut states = Vec::with_capacity(n);
        if n > 0 {
            states.push(state);
        }
        states.extend((1..n).map(|_| {
            let turns = stream.chance(self.turn_probability(state));
            state = state.next(turns);
            state
        }));
        states
    }

    /// Estimates both probabilities from a sequence of states by maximum likelihood.
    ///
    /// ```
    /// use envgen::hallway::{HallwayChain, State};
    ///
    /// let state = |number| State::new(number).expect("from 1 to 8");
    /// // Up, up, left turn, left: one of two straight segments is followed by a turn.
    /// let history = [state(3), state(3), state(5), state(1)];
    /// let estimate = HallwayChain::estimate(&history)?;
    /// assert_eq!((estimate.p_st.hits, estimate.p_st.trials), (1, 2));
    /// assert_eq!(estimate.p_tt.value(), Some(0.0));
    /// // A hallway cannot turn around at once.
    /// assert!(HallwayChain::estimate(&[state(1), state(4)]).is_err());
    /// # Ok::<(), envgen::hallway::HistoryError>(())
    /// ```
    ///
    /// # Errors
    /// When the chain does not have one of the transitions; the error names the first such transition.
    pub fn estimate(states: &[State]) -> Result<Estimate, HistoryError> {
        let mut estimate = Estimate::default();
        for (step, pair) in states.windows(2).enumerate() {
            let (from, to) = (pair[0], pair[1]);
            if to != from.straight() && to != from.turn() {
                return Err(HistoryError { step, from, to });
            }
            let proportion = if from.is_turn() { &mut estimate.p_tt } else { &mut estimate.p_st };
            proportion.trials += 1;
            proportion.hits += u64::from(to.is_turn());
        }
        Ok(estimate)
    }
}

/// Below this sum of `p_st` and 1 - `p_tt`, the closed form of the expected turns loses digits: it is a difference of
/// numbers that are nearly equal.
const RARE: f64 = 0.5;

/// Returns 1 + rho + rho^2 + .. + rho^(n - 1), where rho is 1 - `leave`, without rounding rho.
fn sum_of_powers(leave: f64, n: f64) -> f64 {
    -libm::expm1(n * libm::log1p(-leave)) / leave
}

/// Returns the sum of [`sum_of_powers`] over 0, 1, .., n - 1, where that of n is `powers`.
fn sum_of_sums(leave: f64, n: f64, powers: f64) -> f64 {
    if n * leave > 0.25 {
        return (n - powers) / leave;
    }
    // The binomial series: n over 2, less n over 3 times `leave`, and so on, where each term is less than a twelfth of
    // the one before.
    let mut term = 0.5 * n * (n - 1.0);
    let mut sum = term;
    for k in 2..16 {
        let k = f64::from(k);
        term *= -leave * (n - k) / (k + 1.0);
        sum += term;
    }
    sum
}

/// The error for a sequence of states that the chain cannot produce.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("state {to} cannot follow state {from} (transition {step}, counted from 0)")]
pub struct HistoryError {
    /// The index of the transition, counted from 0.
    pub step: usize,
    /// The state that the transition leaves.
    pub from: State,
    /// The state that the transition reaches.
    pub to: State,
}

/// Estimates of a chain's probabilities from a sequence of states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Estimate {
    /// Share of turns among the transitions that leave a straight segment.
    pub p_st: Proportion,
    /// Share of turns among the transitions that leave a turn.
    pub p_tt: Proportion,
}

/// A proportion: how many of a number of trials had some outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Proportion {
    /// Number of trials with the outcome.
    pub hits: u64,
    /// Number of all trials.
    pub trials: u64,
}

impl Proportion {
    /// Returns the maximum-likelihood estimate of the probability; `None` without trials.
    pub fn value(self) -> Option<f64> {
        (self.trials > 0).then(|| self.hits as f64 / self.trials as f64)
    }

    /// Returns Wilson's score interval for a standard normal quantile `z` (1.96 for 95 %): E. B. Wilson, Probable
    /// Inference, JASA 22, 1927, <https://doi.org/10.1080/01621459.1927.10502953>. Without trials it is [0, 1].
    ///
    /// ```
    /// use envgen::hallway::Proportion;
    ///
    /// let (low, high) = Proportion { hits: 5, trials: 10 }.wilson(1.96);
    /// assert!((low - 0.2366).abs() < 1e-4 && (high - 0.7634).abs() < 1e-4);
    /// assert_eq!(Proportion::default().wilson(1.96), (0.0, 1.0));
    /// ```
    ///
    /// # Panics
    /// When `z` is negative or not finite.
    #[track_caller]
    pub fn wilson(self, z: f64) -> (f64, f64) {
        assert!(z >= 0.0 && z.is_finite(), "the quantile `z` is {z}");
        let Some(p) = self.value() else { return (0.0, 1.0) };
        let n = self.trials as f64;
        let z2n = z * z / n;
        let centre = (p + 0.5 * z2n) / (1.0 + z2n);
        let half = z / (1.0 + z2n) * (p * (1.0 - p) / n + 0.25 * z2n / n).sqrt();
        ((centre - half).max(0.0), (centre + half).min(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use glam::DVec2;
    use proptest::prelude::*;

    fn chain(p_st: f64, p_tt: f64) -> HallwayChain {
        HallwayChain::new(p_st, p_tt).unwrap()
    }

    #[test]
    fn the_matrix_is_the_printed_one() {
        let (st, tt) = (0.4, 0.3);
        let (ss, ts) = (1.0 - st, 1.0 - tt);
        let printed = [
            [ss, 0., 0., 0., 0., 0., st, 0.],
            [0., ss, 0., 0., 0., 0., 0., st],
            [0., 0., ss, 0., st, 0., 0., 0.],
            [0., 0., 0., ss, 0., st, 0., 0.],
            [ts, 0., 0., 0., 0., 0., tt, 0.],
            [0., 0., ts, 0., tt, 0., 0., 0.],
            [0., ts, 0., 0., 0., 0., 0., tt],
            [0., 0., 0., ts, 0., tt, 0., 0.],
        ];
        assert_eq!(chain(st, tt).matrix(), printed);
    }

    #[test]
    fn expected_turns_are_the_known_numbers() {
        let state = |n| State::new(n).unwrap();
        for (p_st, p_tt, n, start, turns) in [
            (0.4, 0.0, 50, 3, 14.0816),
            (0.4, 0.0, 50, 5, 14.7959),
            (0.2, 0.3, 80, 3, 17.5309),
            (0.2, 0.3, 80, 5, 18.6420),
            (0.0, 1.0, 10, 5, 10.0),
            (0.0, 1.0, 10, 3, 0.0),
            (1.0, 1.0, 10, 3, 9.0),
        ] {
            let expected = chain(p_st, p_tt).expected_turns(state(start), n);
            assert!((expected - turns).abs() < 5e-5, "{p_st} {p_tt} {n} {start}: {expected}");
        }
    }

    #[test]
    fn rare_turns_are_expected_to_the_last_digits() {
        let near = |p_st: f64, p_tt: f64, n, start: State, exact: f64| {
            let expected = chain(p_st, p_tt).expected_turns(start, n);
            let error = (expected - exact).abs();
            assert!(error <= 1e-14 * exact, "{p_st} {p_tt} {n}: {expected}, not {exact}");
        };
        // The chances of a turn add up: n (n - 1) / 2 of them, up to terms of p_st squared.
        near(1e-17, 1.0, 10, State::UP, 4.5e-16);
        near(1e-300, 1.0, 10, State::UP, 4.5e-299);
        // n (n - 1) / 2 p - n (n - 1) (n - 2) / 6 p^2 for a p of 1e-13.
        near(1e-13, 1.0, 1000, State::UP, 499_500e-13 - 166_167_000e-26);
        // Up to 1 - p_tt the same from a turn: n, less as much.
        let (p_tt, left) = (1.0 - 1e-10, 1.0 - (1.0 - 1e-10));
        near(0.0, p_tt, 1000, State::UP.turn(), 1000.0 - 499_500.0 * left);
        near(0.0, p_tt, 1, State::UP.turn(), 1.0);
        near(0.1, 0.9, 0, State::UP.turn(), 0.0);
        near(0.1, 0.9, 1, State::UP, 0.0);
        near(1e-6, 1.0, 1_000_000, State::UP, 367_879.257_231_645);
        near(0.4, 0.0, 50, State::UP, 14.081_632_653_061_225);
    }

    #[test]
    fn no_unique_stationary_law_is_an_error() {
        let error = chain(0.0, 1.0).stationary().unwrap_err();
        assert_eq!((error.field.as_str(), error.value.as_str()), ("start", "stationary"));
        assert_eq!(chain(0.0, 0.5).stationary().unwrap()[..4], [0.25; 4]);
    }

    #[test]
    fn bad_probabilities_are_refused() {
        for p in [-1e-9, 1.000_000_1, f64::NAN, f64::INFINITY] {
            assert_eq!(HallwayChain::new(p, 0.0).unwrap_err().field, "p_st");
            assert_eq!(HallwayChain::new(0.0, p).unwrap_err().field, "p_tt");
        }
    }

    #[test]
    fn wilson_interval_is_the_textbook_one() {
        // 4 of 10 at 95 %: 0.1682 to 0.6873 (Brown, Cai and DasGupta 2001).
        let (low, high) = Proportion { hits: 4, trials: 10 }.wilson(1.959_964);
        assert!((low - 0.1682).abs() < 1e-4 && (high - 0.6873).abs() < 1e-4, "{low} {high}");
        assert_eq!(Proportion::default().wilson(1.96), (0.0, 1.0));
    }

    #[test]
    fn an_impossible_history_is_named() {
        let states: Vec<_> = [3, 3, 5, 2].into_iter().filter_map(State::new).collect();
        let error = HallwayChain::estimate(&states).unwrap_err();
        assert_eq!(
            error.to_string(),
            "state 2 cannot follow state 5 (transition 2, counted from 0)"
        );
    }

    #[test]
    fn estimates_find_the_probabilities() {
        // Wilson intervals at z = 4: both miss with probability under 1.3e-4.
        for (case, (p_st, p_tt)) in
            [(0.4, 0.0), (0.2, 0.3), (0.9, 0.9), (0.05, 1.0)].into_iter().enumerate()
        {
            let mut stream = Seed(case as u64).stream("test", 0);
            let states = chain(p_st, p_tt).sample(State::UP, 100_000, &mut stream);
            let estimate = HallwayChain::estimate(&states).unwrap();
            for (proportion, p) in [(estimate.p_st, p_st), (estimate.p_tt, p_tt)] {
                let (low, high) = proportion.wilson(4.0);
                assert!(low <= p && p <= high, "{p}: [{low}, {high}]");
            }
        }
    }

    /// The state of the mirrored hallway, left and right exchanged.
    fn mirrored(state: State) -> State {
        let number = [4, 3, 2, 1, 8, 7, 6, 5][usize::from(state.number()) - 1];
        State::new(number).unwrap()
    }

    /// Mostly small, some so small that it is lost beside 1.
    fn rates() -> impl Strategy<Value = f64> {
        prop_oneof![0.0..=1.0_f64, (-18.0..0.0_f64).prop_map(|digits| libm::pow(10.0, digits))]
    }

    proptest! {
        #[test]
        fn expected_turns_are_the_sum_of_their_chances(
            p_st in rates(), p_ts in rates(), starts_with_turn: bool, n in 0..3000_usize,
        ) {
            let p_tt = 1.0 - p_ts;
            let start = if starts_with_turn { State::UP.turn() } else { State::UP };
            let expected = chain(p_st, p_tt).expected_turns(start, n);
            let first = f64::from(u8::from(starts_with_turn));
            let next = |chance: &f64| Some(p_tt * chance + p_st * (1.0 - chance));
            let sum: f64 = std::iter::successors(Some(first), next).take(n).sum();
            // Where turns are not rare, numbers of the size of `p_st` may cancel.
            let slack = 1e-11 * sum + 1e-14 * p_st;
            prop_assert!((expected - sum).abs() <= slack, "{expected}, not {sum}");
            prop_assert!(expected >= -slack && expected <= n as f64 * (1.0 + 1e-14));
        }

        #[test]
        fn the_stationary_law_is_a_fixed_point(p_st in 0.0..=1.0_f64, p_tt in 0.0..=1.0_f64) {
            let chain = chain(p_st, p_tt);
            prop_assume!(p_st > 0.0 || p_tt < 1.0);
            let law = chain.stationary().unwrap();
            let matrix = chain.matrix();
            prop_assert!((law.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            for to in 0..8 {
                let flow: f64 = (0..8).map(|from| law[from] * matrix[from][to]).sum();
                prop_assert!((flow - law[to]).abs() < 1e-12);
            }
        }

        #[test]
        fn mirrored_histories_are_histories(seed: u64, p_st in 0.0..=1.0_f64, p_tt in 0.0..=1.0_f64) {
            let mut stream = Seed(seed).stream("test", 0);
            let states = chain(p_st, p_tt).sample(State::UP, 200, &mut stream);
            let mirrored: Vec<_> = states.iter().map(|&state| mirrored(state)).collect();
            prop_assert_eq!(HallwayChain::estimate(&states), HallwayChain::estimate(&mirrored));
            for (a, b) in states.iter().zip(&mirrored) {
                prop_assert_eq!(a.exit() * DVec2::new(-1.0, 1.0), b.exit());
                prop_assert_eq!(a.entry() * DVec2::new(-1.0, 1.0), b.entry());
            }
        }

        #[test]
        fn turns_alternate_in_pairs_from_the_second_on(
            seed: u64, start in 1..=8_u8, p_st in 0.0..=1.0_f64, p_tt in 0.0..=1.0_f64,
        ) {
            let mut stream = Seed(seed).stream("test", 0);
            let start = State::new(start).unwrap();
            let states = chain(p_st, p_tt).sample(start, 300, &mut stream);
            let left: Vec<bool> =
                states.iter().filter(|s| s.is_turn()).map(|s| s.number() <= 6).collect();
            for four in left.get(1..).unwrap_or_default().windows(3) {
                // Among three turns in a row two are alike and neighbours, and never all three.
                prop_assert!(four[0] != four[1] || four[1] != four[2]);
                prop_assert!(four[0] == four[1] || four[1] == four[2]);
            }
            for pair in states.windows(2) {
                prop_assert_eq!(pair[0].exit(), pair[1].entry());
            }
        }
    }
}
