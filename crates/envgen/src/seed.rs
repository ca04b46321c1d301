//! Seeds, and the named random streams that are derived from them.

use std::convert::Infallible;
use std::fmt;
use std::str::FromStr;

use chacha20::ChaCha8Rng;
use rand_core::{Rng, SeedableRng, TryRng};
use serde::{Deserialize, Serialize};

use crate::error::SpecError;

/// Name and version of the algorithm of every [`Stream`], as recorded in a world's provenance.
pub const STREAM_ALGORITHM: &str = "chacha8-v1";

/// The number that determines everything random in a world. Seed 0 is a seed like any other.
///
/// ```
/// use envgen::{Seed, Spec, forest::ForestSpec};
///
/// let plant = |seed| ForestSpec::default().generate(seed);
/// assert_eq!(plant(Seed(7))?.trees(), plant("7".parse()?)?.trees());
/// assert_ne!(plant(Seed(7))?.trees(), plant(Seed(7).offset(1))?.trees());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct Seed(pub u64);

impl Seed {
    /// Returns the random stream of one stage of a generator, for instance `("forest/tile", 12)`.
    ///
    /// Streams of different seeds, stages or indices are independent. A stage that is added to a generator, or
    /// another order of the stages, therefore changes nothing in the other stages.
    ///
    /// ```
    /// use envgen::Seed;
    ///
    /// let mut trees = Seed(7).stream("trees", 0);
    /// let (first, second) = (trees.bits(), trees.bits());
    /// assert_ne!(first, second);
    /// // The same stream again, and that of another stage.
    /// assert_eq!(Seed(7).stream("trees", 0).bits(), first);
    /// assert_ne!(Seed(7).stream("rocks", 0).bits(), first);
    /// ```
    pub fn stream(self, stage: &str, index: u64) -> Stream {
        self.attempt(stage, index, 0)
    }

    /// Returns the stream of a retry. Attempt 0 is [`Seed::stream`] itself.
    ///
    /// ```
    /// use envgen::Seed;
    ///
    /// let first = Seed(7).stream("road", 0).bits();
    /// assert_eq!(Seed(7).attempt("road", 0, 0).bits(), first);
    /// assert_ne!(Seed(7).attempt("road", 0, 1).bits(), first);
    /// ```
    pub fn attempt(self, stage: &str, index: u64, attempt: u64) -> Stream {
        // ChaCha's key is 256 bits wide: the four numbers are the key, nothing is mixed or lost.
        let mut key = [0; 32];
        for (bytes, word) in
            key.chunks_exact_mut(8).zip([self.0, stage_hash(stage), index, attempt])
        {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        Stream { rng: ChaCha8Rng::from_seed(key) }
    }

    /// Returns the `n`-th seed after this one, wrapping around at the end of the range.
    pub fn offset(self, n: u64) -> Seed {
        Seed(self.0.wrapping_add(n))
    }

    /// Returns the `n`-th seed after this one; `None` if it exceeds the greatest seed.
    ///
    /// ```
    /// use envgen::Seed;
    ///
    /// assert_eq!(Seed(7).checked_offset(3), Some(Seed(10)));
    /// assert_eq!(Seed(u64::MAX).checked_offset(1), None);
    /// assert_eq!(Seed(u64::MAX).offset(1), Seed(0));
    /// ```
    pub fn checked_offset(self, n: u64) -> Option<Seed> {
        self.0.checked_add(n).map(Seed)
    }
}

impl From<u64> for Seed {
    fn from(value: u64) -> Self {
        Seed(value)
    }
}

impl fmt::Display for Seed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl FromStr for Seed {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let allowed = || format!("a whole number from 0 to {}", u64::MAX);
        text.parse().map(Seed).map_err(|_| SpecError::new("seed", text, allowed()))
    }
}

/// The FNV-1a hash with 64 bits. Stage names are few and fixed, so a short published hash is enough.
const fn stage_hash(stage: &str) -> u64 {
    let bytes = stage.as_bytes();
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut i = 0;
    while i < bytes.len() {
        hash = (hash ^ bytes[i] as u64).wrapping_mul(0x0100_0000_01b3);
        i += 1;
    }
    hash
}

/// A stream of random numbers: ChaCha8 with a key made of seed, stage, index and attempt.
///
/// The draws that the generators use are defined here, bit for bit, so that no release of another crate can change
/// a world. Continuous distributions are in [`crate::distribution`].
///
/// A stream also implements the generator traits of [`rand_core`], so that the methods of `rand`'s extension traits
/// and the distributions of other crates, such as `rand_distr`, can be used with it:
///
/// ```
/// use envgen::Seed;
/// use rand::{RngExt, seq::SliceRandom};
/// use rand_distr::Normal;
///
/// let mut stream = Seed(7).stream("example", 0);
/// let die = stream.random_range(1..=6);
/// let heads: bool = stream.random();
/// let height = stream.sample(Normal::new(1.7, 0.1)?);
/// let mut order = [1, 2, 3];
/// order.shuffle(&mut stream);
/// assert!((1..=6).contains(&die) && height > 0.0 && order.contains(&1));
///
/// // The same seed gives the same numbers.
/// let mut again = Seed(7).stream("example", 0);
/// assert_eq!((again.random_range(1..=6), again.random::<bool>()), (die, heads));
/// # Ok::<(), rand_distr::NormalError>(())
/// ```
#[derive(Debug)]
pub struct Stream {
    rng: ChaCha8Rng,
}

impl Stream {
    /// Draws 64 random bits.
    #[inline]
    pub fn bits(&mut self) -> u64 {
        self.rng.next_u64()
    }

    /// Draws a uniform number in [0, 1): a multiple of 2^-53.
    #[inline]
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// Draws a uniform number in [`low`, `high`), or returns `low` when the two are equal.
    ///
    /// ```
    /// use envgen::Seed;
    ///
    /// let mut stream = Seed(7).stream("example", 0);
    /// let width = stream.between(0.8, 1.2);
    /// assert!((0.8..1.2).contains(&width));
    /// assert_eq!(stream.between(1.0, 1.0), 1.0);
    /// ```
    ///
    /// # Panics
    /// When `low` is greater than `high`, or their difference is not finite.
    #[inline]
    #[track_caller]
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        // False for NaN, and where one is infinite.
        assert!(high - low >= 0.0 && high - low < f64::INFINITY, "between({low}, {high})");
        low + (high - low) * self.unit()
    }

    /// Returns true with probability `p`: never for `p` <= 0 or NaN, always for `p` >= 1.
    #[inline]
    pub fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }

    /// Draws a uniform whole number in 0..`n`, without bias (Lemire, Fast Random Integer Generation in an Interval,
    /// ACM TOMACS 29, 2019).
    ///
    /// ```
    /// use envgen::Seed;
    ///
    /// let mut stream = Seed(7).stream("dice", 0);
    /// let mut counts = [0; 6];
    /// for _ in 0..6000 {
    ///     counts[stream.below(6) as usize] += 1;
    /// }
    /// assert!(counts.iter().all(|count| (800..1200).contains(count)));
    /// ```
    ///
    /// # Panics
    /// When `n` is 0, because there is nothing to draw from.
    #[inline]
    #[track_caller]
    pub fn below(&mut self, n: u64) -> u64 {
        assert!(n > 0, "below(0): there is nothing to draw from");
        let mut wide = u128::from(self.bits()) * u128::from(n);
        if (wide as u64) < n {
            let threshold = n.wrapping_neg() % n;
            while (wide as u64) < threshold {
                wide = u128::from(self.bits()) * u128::from(n);
            }
        }
        (wide >> 64) as u64
    }

    /// Draws the index of a weight with a probability proportional to the weight; `None` if no weight is positive.
    ///
    /// ```
    /// use envgen::Seed;
    ///
    /// let mut stream = Seed(7).stream("example", 0);
    /// let draws: Vec<_> = (0..4000).filter_map(|_| stream.weighted(&[1.0, 0.0, 3.0])).collect();
    /// let last = draws.iter().filter(|&&i| i == 2).count();
    /// assert!((2800..3200).contains(&last) && !draws.contains(&1));
    /// assert_eq!(stream.weighted(&[0.0, 0.0]), None);
    /// ```
    ///
    /// # Panics
    /// When a weight is negative or NaN, or their sum is not finite.
    #[track_caller]
    pub fn weighted(&mut self, weights: &[f64]) -> Option<usize> {
        let total: f64 = weights.iter().sum();
        let sound = total < f64::INFINITY && weights.iter().all(|weight| *weight >= 0.0);
        assert!(sound, "weighted({weights:?})");
        let mut left = self.unit() * total;
        let mut last = None;
        for (i, &weight) in weights.iter().enumerate() {
            if weight > 0.0 {
                if left < weight {
                    return Some(i);
                }
                left -= weight;
                last = Some(i);
            }
        }
        last
    }

    /// Shuffles a slice into uniformly random order (Fisher-Yates, from the end).
    ///
    /// ```
    /// use envgen::Seed;
    ///
    /// let mut order: Vec<u32> = (0..100).collect();
    /// Seed(7).stream("order", 0).shuffle(&mut order);
    /// assert!(!order.is_sorted());
    /// order.sort();
    /// assert_eq!(order, (0..100).collect::<Vec<_>>());
    /// ```
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i as u64 + 1) as usize);
        }
    }
}

impl TryRng for Stream {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        self.rng.try_next_u32()
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        self.rng.try_next_u64()
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        self.rng.try_fill_bytes(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_are_frozen() {
        // Frozen values: a change here changes every world of every seed.
        let mut stream = Seed(7).attempt("stage", 3, 1);
        assert_eq!(stream.bits(), 6_540_101_256_199_365_920);
        assert_eq!(stream.unit(), 0.586_838_354_198_182_4);
        assert_eq!(stream.below(1000), 821);
    }

    #[test]
    fn every_part_of_the_key_changes_the_stream() {
        let first = |mut stream: Stream| stream.bits();
        let draws = [
            first(Seed(1).stream("a", 0)),
            first(Seed(2).stream("a", 0)),
            first(Seed(1).stream("b", 0)),
            first(Seed(1).stream("a", 1)),
            first(Seed(1).attempt("a", 0, 1)),
        ];
        for (i, a) in draws.iter().enumerate() {
            for b in &draws[i + 1..] {
                assert_ne!(a, b);
            }
        }
    }

    #[test]
    fn below_is_uniform() {
        // Chi-square with 5 degrees of freedom, false-alarm rate 1e-4 (critical value 25.7).
        let mut stream = Seed(11).stream("below", 0);
        let mut counts = [0_u32; 6];
        for _ in 0..60_000 {
            counts[stream.below(6) as usize] += 1;
        }
        let chi2: f64 =
            counts.iter().map(|&c| (f64::from(c) - 1e4) * (f64::from(c) - 1e4) / 1e4).sum();
        assert!(chi2 < 25.7, "chi-square {chi2} of {counts:?}");
    }

    #[test]
    fn weighted_never_draws_an_impossible_index() {
        let mut stream = Seed(5).stream("weighted", 0);
        for _ in 0..1000 {
            assert_eq!(stream.weighted(&[0.0, 2.0, 0.0]), Some(1));
        }
        assert_eq!(stream.weighted(&[0.0, 0.0]), None);
        assert_eq!(stream.weighted(&[]), None);
    }

    /// What a draw panics with.
    fn panic_of<T>(draw: impl Fn(&mut Stream) -> T) -> String {
        let draw = || drop(draw(&mut Seed(1).stream("test", 0)));
        let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(draw));
        let payload = caught.expect_err("it panics");
        let text = payload.downcast_ref::<String>().cloned();
        text.or_else(|| payload.downcast_ref::<&str>().map(|&text| text.to_owned()))
            .expect("a text")
    }

    #[test]
    fn what_cannot_be_drawn_is_a_mistake_of_the_program() {
        use crate::distribution::{ln_gamma_variate, poisson};
        assert_eq!(panic_of(|s| s.below(0)), "below(0): there is nothing to draw from");
        assert_eq!(panic_of(|s| s.between(2.0, 1.0)), "between(2, 1)");
        assert_eq!(panic_of(|s| s.between(f64::NAN, 1.0)), "between(NaN, 1)");
        assert_eq!(panic_of(|s| s.between(0.0, f64::INFINITY)), "between(0, inf)");
        assert_eq!(panic_of(|s| s.weighted(&[1.0, -1.0])), "weighted([1.0, -1.0])");
        assert_eq!(panic_of(|s| s.weighted(&[f64::NAN])), "weighted([NaN])");
        assert_eq!(panic_of(|s| poisson(s, -1.0)), "the mean of a Poisson law is -1");
        assert_eq!(panic_of(|s| poisson(s, 2e15)), "the mean of a Poisson law is 2000000000000000");
        assert_eq!(panic_of(|s| ln_gamma_variate(s, 0.0)), "the shape of a gamma law is 0");
        let text = panic_of(|s| ln_gamma_variate(s, f64::NAN));
        assert_eq!(text, "the shape of a gamma law is NaN");
    }

    #[test]
    fn edge_probabilities_are_certain() {
        let mut stream = Seed(6).stream("chance", 0);
        assert!((0..1000).all(|_| stream.chance(1.0) && !stream.chance(0.0)));
    }
}
