//! Requests of the profile `calibrated`.

use super::spec::IndoorSpec;
use crate::dials::Dials;

/// The dials that a spec of the profile `calibrated` requests; `None` for dials that are not requested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request(pub Dials<Option<f64>>);

impl Request {
    /// Returns the distance of dials from the request: the root of the sum of squared differences over the
    /// requested dials.
    pub fn distance(&self, dials: Dials<f64>) -> f64 {
        let squares = self.0.zip(dials).named().map(|(_, (wanted, value))| {
            wanted.map_or(0.0, |wanted| (value - wanted) * (value - wanted))
        });
        squares.iter().sum::<f64>().sqrt()
    }
}

impl IndoorSpec {
    /// Returns the request of the spec in the profile `calibrated`: `mapping` and `navigation` if one of them is
    /// set, otherwise the `difficulty`.
    pub fn request(&self) -> Request {
        let IndoorSpec { mapping, navigation, .. } = *self;
        let whole = mapping.is_none() && navigation.is_none();
        let difficulty = whole.then_some(self.difficulty);
        Request(Dials { difficulty, mapping, navigation })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dials_of_their_own_replace_the_difficulty() {
        let all = Dials { difficulty: 5.0, mapping: 6.0, navigation: 1.0 };
        let plain = IndoorSpec { difficulty: 7.0, ..Default::default() };
        assert_eq!(plain.request().distance(all), 2.0);
        let mapping = IndoorSpec { mapping: Some(3.0), ..plain };
        assert_eq!(mapping.request().distance(all), 3.0);
        let both = IndoorSpec { navigation: Some(5.0), ..mapping };
        assert_eq!(both.request().distance(all), 5.0);
    }
}
