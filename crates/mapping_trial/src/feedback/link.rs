//! Linking: brings the ratings of people onto the scale of measured difficulty.

use std::collections::BTreeMap;

use envgen::World;
use envgen::calibration::{Calibration, Dials, Estimate, Prediction};
use envgen::difficulty::{DifficultyError, DifficultyVector, Platform};
use serde::Serialize;
use thiserror::Error;

use super::rating::Rating;
use crate::difficulty::Panel;
use crate::difficulty::proof::Link;
use crate::experiment::stats::half_interval;
use crate::experiment::stats::{Interval, pearson};

/// Least number of sessions that can be linked.
pub const LEAST_SESSIONS: usize = 3;

/// Ratings and difficulties that differ by at most this are equal, since means of equal numbers differ
/// by rounding.
const SAME: f64 = 1e-9;

/// The source of a world's difficulty by the reference panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DifficultySource {
    /// Measured by trials of the panel, as recorded in the world's provenance.
    Measured,
    /// Predicted by the calibration of the world's kind, or by that of indoor maps for worlds of other
    /// tools.
    Predicted,
}

/// The difficulty of a world by the reference panel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PanelDifficulty {
    /// The source of the difficulty.
    pub source: DifficultySource,
    /// The dials, with standard errors.
    pub dials: Dials<Estimate>,
}

/// An error for which a world has no difficulty by the reference panel.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum UnknownDifficulty {
    /// The world was not measured, and has no difficulty vector.
    #[error(transparent)]
    Vector(#[from] DifficultyError),
    /// The world was not measured, and there are no predictions for its kind.
    #[error(
        "there are no predictions for worlds of the kind {0}, expected one whose difficulty was measured"
    )]
    Kind(String),
    /// The world was not measured, and is unlike the worlds that predictions come from.
    #[error(
        "{:.0} % of the features of the world lie outside what the atlas has, expected at most {:.0} %, or a \
         world whose difficulty was measured",
        100.0 * outside,
        100.0 * Prediction::MOST_OUTSIDE
    )]
    Outside {
        /// Fraction of the features that lie outside the atlas.
        outside: f64,
    },
}

impl PanelDifficulty {
    /// Returns the difficulty of a world: measured by the reference panel if its provenance has the
    /// measurement, otherwise predicted.
    ///
    /// # Errors
    ///
    /// If the world was not measured and its difficulty cannot be predicted.
    pub fn of(world: &World) -> Result<Self, UnknownDifficulty> {
        let panel = Panel::reference();
        let measured = world.provenance.measured.as_deref();
        let by_reference =
            measured.filter(|m| m.panel == panel.name && m.panel_version == panel.version);
        if let Some(measured) = by_reference {
            let source = DifficultySource::Measured;
            return Ok(PanelDifficulty { source, dials: measured.dials });
        }
        let kind = || world.provenance.original().kind.clone();
        let calibration =
            Calibration::of_world(world).ok_or_else(|| UnknownDifficulty::Kind(kind()))?;
        let vector = DifficultyVector::of(world, &Platform::default())?;
        let prediction = calibration.predict(&vector);
        let Prediction { dials, outside, .. } = prediction;
        if prediction.is_extrapolated() {
            return Err(UnknownDifficulty::Outside { outside });
        }
        Ok(PanelDifficulty { source: DifficultySource::Predicted, dials })
    }
}

/// A rating of a world, together with its difficulty by the reference panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatedWorld<'a> {
    /// An identifier of the world, such as its digest.
    pub world: &'a str,
    /// The rating.
    pub rating: Rating,
    /// The dial of the panel that corresponds to the rating.
    pub difficulty: f64,
}

/// An error for which ratings cannot be linked.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LinkError {
    /// There are too few sessions.
    #[error("expected at least {LEAST_SESSIONS} rated sessions, got {sessions}")]
    Few {
        /// Number of sessions.
        sessions: usize,
    },
    /// All sessions were in one world.
    #[error("all {sessions} sessions were in the same world, expected at least two worlds")]
    OneWorld {
        /// Number of sessions.
        sessions: usize,
    },
    /// All worlds have the same rating.
    #[error("all {worlds} worlds are rated {rating:.1}, expected ratings that differ")]
    SameRating {
        /// Number of worlds.
        worlds: usize,
        /// Their rating.
        rating: f64,
    },
    /// All worlds have the same difficulty.
    #[error("all {worlds} worlds have the difficulty {difficulty:.1}, expected some that differ")]
    SameDifficulty {
        /// Number of worlds.
        worlds: usize,
        /// Their difficulty.
        difficulty: f64,
    },
    /// The difficulty of a world is not a number.
    #[error("the difficulty of the world {world} must be finite, got {difficulty}")]
    NotFinite {
        /// The world.
        world: String,
        /// Its difficulty.
        difficulty: f64,
    },
}

/// A link from ratings to the scale of the reference panel. Over the rated worlds, linked ratings have
/// the mean and the standard deviation of the panel's difficulties,
/// `L(x) = mean_R + sd_R / sd_x (x - mean_x)`.
///
/// ```
/// use mapping_trial::feedback::{RatedWorld, Rating, RatingLink};
///
/// let rated = |world, rating, difficulty| {
///     Ok::<_, Box<dyn std::error::Error>>(RatedWorld { world, rating: Rating::try_from(rating)?, difficulty })
/// };
/// let sessions = [rated("a", 2.0, 1.0)?, rated("b", 4.0, 5.0)?, rated("c", 6.0, 9.0)?];
/// let link = RatingLink::new(&sessions)?;
/// assert!((link.link.apply(5.0) - 7.0).abs() < 1e-9);
/// assert_eq!(link.link.maps, 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RatingLink {
    /// The linear function, with the number of worlds.
    pub link: Link,
    /// Number of sessions.
    pub sessions: usize,
    /// Pearson's correlation between ratings and difficulties over the worlds.
    pub correlation: f64,
    /// Mean of the worlds' ratings.
    pub rating_mean: f64,
    /// Their standard deviation.
    pub rating_deviation: f64,
}

impl RatingLink {
    /// Links the ratings of sessions. Those of one world count as one, with their mean.
    ///
    /// # Errors
    ///
    /// If there are fewer than [`LEAST_SESSIONS`] sessions, or if worlds, ratings or difficulties do
    /// not differ.
    pub fn new(sessions: &[RatedWorld<'_>]) -> Result<Self, LinkError> {
        if sessions.len() < LEAST_SESSIONS {
            return Err(LinkError::Few { sessions: sessions.len() });
        }
        let mut worlds: BTreeMap<&str, Vec<&RatedWorld<'_>>> = BTreeMap::new();
        for session in sessions {
            let RatedWorld { world, difficulty, .. } = *session;
            if !difficulty.is_finite() {
                return Err(LinkError::NotFinite { world: world.to_owned(), difficulty });
            }
            worlds.entry(world).or_default().push(session);
        }
        if worlds.len() < 2 {
            return Err(LinkError::OneWorld { sessions: sessions.len() });
        }
        let means = |of: fn(&RatedWorld<'_>) -> f64| -> Vec<f64> {
            let of_world = |all: &Vec<&RatedWorld<'_>>| {
                all.iter().map(|one| of(one) / all.len() as f64).sum::<f64>()
            };
            worlds.values().map(of_world).collect()
        };
        let (ratings, difficulties) =
            (means(|one| one.rating.value()), means(|one| one.difficulty));
        let worlds = ratings.len();
        if spread(&ratings) <= SAME {
            return Err(LinkError::SameRating { worlds, rating: ratings[0] });
        }
        let same = LinkError::SameDifficulty { worlds, difficulty: difficulties[0] };
        if spread(&difficulties) <= SAME {
            return Err(same);
        }
        let (rating_mean, rating_deviation) = moments(&ratings);
        let link = Link::new(&difficulties, &ratings);
        let (Some(link), Some(correlation)) = (link, pearson(&ratings, &difficulties)) else {
            return Err(same);
        };
        let sessions = sessions.len();
        Ok(RatingLink { link, sessions, correlation, rating_mean, rating_deviation })
    }

    /// Converts a rating to the scale of the panel, with a 95 % interval of where a link over very many
    /// worlds would place it. The bounds are infinite for a link over two worlds.
    ///
    /// The standard error is that of linear equating if the same worlds have both numbers and these are
    /// normally distributed, `sd_R sqrt((1 - r) (2 + (1 + r) z^2) / n)` at z deviations from the mean
    /// rating (M. J. Kolen and R. L. Brennan, *Test Equating, Scaling, and Linking*, chapter 7,
    /// <https://doi.org/10.1007/978-1-4939-0317-7>). The interval uses Student's quantile for n - 2
    /// degrees of freedom.
    pub fn apply(&self, rating: Rating) -> Interval {
        let value = self.link.apply(rating.value());
        let n = self.link.maps as f64;
        let z = (rating.value() - self.rating_mean) / self.rating_deviation;
        let r = self.correlation;
        // The deviation of the sample, not of the worlds at hand.
        let deviation = self.link.slope * self.rating_deviation;
        let variance = deviation * deviation * n / (n - 1.0);
        let error = (variance * (1.0 - r) * (2.0 + (1.0 + r) * z * z) / n).sqrt();
        // Any two worlds agree, in one order or the other.
        let half = half_interval(error, n - 2.0);
        Interval { value, low: value - half, high: value + half }
    }
}

fn spread(values: &[f64]) -> f64 {
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
    high - low
}

/// Mean and standard deviation.
fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n).sqrt())
}

#[cfg(test)]
mod tests {
    use envgen::geometry::{Pose, Rect};
    use envgen::{Blueprint, MeasuredDifficulty, Provenance, Seed, Spec, Stream, indoor, road};
    use glam::DVec2;
    use proptest::prelude::*;

    use super::*;

    fn link(pairs: &[(f64, f64)]) -> Result<RatingLink, LinkError> {
        let names: Vec<String> = (0..pairs.len()).map(|i| i.to_string()).collect();
        let sessions: Vec<RatedWorld<'_>> = pairs
            .iter()
            .zip(&names)
            .map(|(&(rating, difficulty), world)| RatedWorld {
                world,
                rating: Rating::try_from(rating).expect("a rating"),
                difficulty,
            })
            .collect();
        RatingLink::new(&sessions)
    }

    fn rating(value: f64) -> Rating {
        Rating::try_from(value).expect("a rating")
    }

    #[test]
    fn a_link_by_hand() {
        // Ratings 1, 2, 6 (deviation sqrt(14/3)) of difficulties 2, 6, 4 (sqrt(8/3)); correlation 1/(2 sqrt 7).
        let found = link(&[(1.0, 2.0), (2.0, 6.0), (6.0, 4.0)]).expect("a link");
        let slope = (8.0_f64 / 14.0).sqrt();
        assert!((found.link.slope - slope).abs() < 1e-12);
        assert!((found.correlation - 0.5 / 7.0_f64.sqrt()).abs() < 1e-12, "{found:?}");
        assert!((found.apply(rating(3.0)).value - 4.0).abs() < 1e-12);
        assert_eq!((found.sessions, found.link.maps), (3, 3));
        // At the mean rating: sd_R = 2, n = 3, t(1, 97.5 %) = 12.7062.
        let half = 12.7062 * (4.0 * (1.0 - found.correlation) * 2.0 / 3.0).sqrt();
        let interval = found.apply(rating(3.0));
        assert!((interval.high - 4.0 - half).abs() < 1e-3, "{interval:?}");
    }

    #[test]
    fn what_cannot_be_linked_is_refused() {
        let text = |pairs: &[(f64, f64)]| link(pairs).expect_err("no link").to_string();
        assert_eq!(text(&[]), "expected at least 3 rated sessions, got 0");
        assert_eq!(text(&[(1.0, 2.0), (3.0, 4.0)]), "expected at least 3 rated sessions, got 2");
        // Means of 6.1 are not all 6.1 to the bit.
        let constant = [(6.1, 1.0), (6.1, 2.0), (6.1, 5.0)];
        assert_eq!(text(&constant), "all 3 worlds are rated 6.1, expected ratings that differ");
        let alike = [(1.0, 6.1), (2.0, 6.1), (5.0, 6.1)];
        assert_eq!(text(&alike), "all 3 worlds have the difficulty 6.1, expected some that differ");
        for bad in [f64::NAN, f64::INFINITY] {
            let error = text(&[(1.0, 2.0), (2.0, bad), (3.0, 3.0)]);
            assert_eq!(error, format!("the difficulty of the world 1 must be finite, got {bad}"));
        }
        let one = RatedWorld { world: "a", rating: rating(1.0), difficulty: 2.0 };
        let error = RatingLink::new(&[one; 4]).expect_err("one world").to_string();
        assert!(error.starts_with("all 4 sessions were in the same world"), "{error}");
    }

    #[test]
    fn sessions_in_one_world_count_as_one() {
        let of = |world, value, difficulty| RatedWorld { world, rating: rating(value), difficulty };
        let sessions = [of("a", 2.0, 1.0), of("a", 4.0, 1.0), of("b", 7.0, 9.0)];
        let found = RatingLink::new(&sessions).expect("a link");
        assert_eq!((found.sessions, found.link.maps), (3, 2));
        let interval = found.apply(rating(7.0));
        assert!((interval.value - 9.0).abs() < 1e-12);
        assert_eq!((interval.low, interval.high), (f64::NEG_INFINITY, f64::INFINITY));
    }

    /// About normal, of mean 0 and deviation 1.
    fn normal(stream: &mut Stream) -> f64 {
        (0..12).map(|_| stream.unit()).sum::<f64>() - 6.0
    }

    #[test]
    fn intervals_hold_the_true_link_as_often_as_they_say() {
        // Ratings 5 +- 1 and difficulties 4 +- 2 of correlation 0.8: one deviation above the mean, 6 is 6.
        let mut stream = Seed(1).stream("link", 0);
        let mut sample = |_| {
            let (shared, own) = (normal(&mut stream), normal(&mut stream));
            ((5.0 + shared).clamp(0.0, 10.0), 4.0 + 2.0 * (0.8 * shared + 0.6 * own))
        };
        let repeats = 1000;
        let holds = (0..repeats).filter(|_| {
            let pairs: Vec<(f64, f64)> = (0..20).map(&mut sample).collect();
            let interval = link(&pairs).expect("a link").apply(rating(6.0));
            (interval.low..=interval.high).contains(&6.0)
        });
        let share = holds.count() as f64 / f64::from(repeats);
        // 95 %; four standard errors are 2.8 %.
        assert!((share - 0.95).abs() < 0.028, "{share}");
    }

    #[test]
    fn the_difficulty_is_measured_before_it_is_predicted() {
        let spec = indoor::IndoorSpec { width: 8, height: 8, ..Default::default() };
        let mut world = spec.generate(Seed(3)).expect("a plan").to_world();
        let predicted = PanelDifficulty::of(&world).expect("a prediction");
        assert_eq!(predicted.source, DifficultySource::Predicted);
        let dial = Estimate { value: 4.5, standard_error: 0.2 };
        let dials = Dials { difficulty: dial, mapping: dial, navigation: dial };
        let measured = |panel: &str| {
            let panel = panel.to_owned();
            MeasuredDifficulty { panel, panel_version: 1, dials, trials: 12, noise_seed: Seed(0) }
        };
        world.provenance.measured = Some(Box::new(measured("reference")));
        let found = PanelDifficulty::of(&world).expect("a measurement");
        assert_eq!((found.source, found.dials), (DifficultySource::Measured, dials));
        world.provenance.measured = Some(Box::new(measured("mine")));
        assert_eq!(PanelDifficulty::of(&world), Ok(predicted));
        let road = road::RoadSpec { length: 100.0, ..Default::default() };
        let world = road.generate(Seed(1)).expect("a road").to_world();
        let error = PanelDifficulty::of(&world).expect_err("no prediction").to_string();
        assert!(
            error.starts_with("there are no predictions for worlds of the kind road"),
            "{error}"
        );
        // A hall in which nothing is like in the atlas.
        let bounds = Rect::new(DVec2::ZERO, DVec2::splat(100.0));
        let mut hall = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
        hall.start = Some(Pose::new(50.0, 50.0, 0.0));
        let error = PanelDifficulty::of(&hall).expect_err("another world").to_string();
        assert!(error.contains("of the features of the world lie outside"), "{error}");
    }

    proptest! {
        #[test]
        fn linked_ratings_have_the_mean_and_deviation_of_the_panel(
            pairs in prop::collection::vec((0.0..=10.0_f64, -5.0..15.0_f64), 0..12),
            at in 0.0..=10.0_f64,
        ) {
            let Ok(found) = link(&pairs) else { return Ok(()) };
            let linked: Vec<f64> = pairs.iter().map(|(x, _)| found.apply(rating(*x)).value).collect();
            let panel: Vec<f64> = pairs.iter().map(|(_, y)| *y).collect();
            let ((a, b), (c, d)) = (moments(&linked), moments(&panel));
            prop_assert!((a - c).abs() < 1e-6 && (b - d).abs() < 1e-6, "{a} {c} {b} {d}");
            let interval = found.apply(rating(at));
            prop_assert!(interval.low <= interval.value && interval.value <= interval.high);
            // The scale of the panel does not matter.
            let scaled: Vec<(f64, f64)> = pairs.iter().map(|(x, y)| (*x, 3.0 * y + 1.0)).collect();
            let scaled = link(&scaled).expect("a link").apply(rating(at));
            prop_assert!((scaled.value - 3.0 * interval.value - 1.0).abs() < 1e-6 * scaled.value.abs().max(1.0));
        }
    }
}
