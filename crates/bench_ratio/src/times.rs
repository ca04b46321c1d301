//! The measured times of both sides.

/// The seconds of our side and of the baseline in each round. The ratio is that of the best times of each
/// side, which other work on the machine affects least, or that of the sums over different tasks. The spread
/// is over the rounds.
///
/// ```
/// use bench_ratio::Times;
///
/// let times: Times = [(1.0, 4.0), (2.0, 4.0), (1.0, 2.0)].into_iter().collect();
/// assert_eq!((times.ours(), times.baseline()), (1.0, 2.0));
/// assert_eq!(times.scaled(1.0, 10.0).baseline(), 20.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Times {
    rounds: Vec<(f64, f64)>,
    is_sum: bool,
}

impl FromIterator<(f64, f64)> for Times {
    fn from_iter<I: IntoIterator<Item = (f64, f64)>>(rounds: I) -> Self {
        Times { rounds: rounds.into_iter().collect(), is_sum: false }
    }
}

/// Creates the times of one round, or of the best times of sides that were measured separately, without a
/// spread.
impl From<(f64, f64)> for Times {
    fn from(round: (f64, f64)) -> Self {
        [round].into_iter().collect()
    }
}

impl Times {
    /// Returns the best time of our side, or the sum of its times.
    pub fn ours(&self) -> f64 {
        self.all(self.rounds.iter().map(|round| round.0))
    }

    /// Returns the best time of the baseline, or the sum of its times.
    pub fn baseline(&self) -> f64 {
        self.all(self.rounds.iter().map(|round| round.1))
    }

    fn all(&self, side: impl Iterator<Item = f64>) -> f64 {
        if self.is_sum { side.sum() } else { side.fold(f64::INFINITY, f64::min) }
    }

    /// Declares that each round is another task, so that sums are compared instead of the best times.
    #[must_use]
    pub fn summed(self) -> Self {
        Times { is_sum: true, ..self }
    }

    /// Multiplies the times by factors, for sides that do unequal shares of a task.
    #[must_use]
    pub fn scaled(self, ours: f64, baseline: f64) -> Self {
        let by = |round: (f64, f64)| (ours * round.0, baseline * round.1);
        Times { rounds: self.rounds.into_iter().map(by).collect(), is_sum: self.is_sum }
    }

    /// Returns the least and the greatest value of a round, without the lowest and the highest quarter of the
    /// rounds, or `None` for a single round.
    pub(crate) fn middle_half(&self, value: impl Fn(f64, f64) -> f64) -> Option<(f64, f64)> {
        let mut values: Vec<f64> =
            self.rounds.iter().map(|round| value(round.0, round.1)).collect();
        values.sort_by(f64::total_cmp);
        let (count, left_out) = (values.len(), values.len() / 4);
        (count > 1).then(|| (values[left_out], values[count - 1 - left_out]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_half_leaves_out_what_is_far_off() {
        let times = |list: &[f64]| list.iter().map(|&ours| (ours, 1.0)).collect::<Times>();
        let half = |list: &[f64]| times(list).middle_half(|ours, baseline| ours / baseline);
        assert_eq!(half(&[3.0, 99.0, 2.0, 0.1]), Some((2.0, 3.0)));
        assert_eq!(half(&[3.0, 2.0]), Some((2.0, 3.0)));
        assert_eq!(half(&[2.0]), None);
        assert_eq!(times(&[]).middle_half(|ours, _| ours), None);
    }

    #[test]
    fn different_tasks_are_added_up() {
        let times: Times = [(1.0, 4.0), (2.0, 6.0)].into_iter().collect();
        let times = times.summed().scaled(2.0, 1.0);
        assert_eq!((times.ours(), times.baseline()), (6.0, 10.0));
    }
}
