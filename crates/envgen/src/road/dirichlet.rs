//! The Dirichlet distribution of the lengths, and its concentration, which determines how similar they are.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::distribution::ln_gamma_variate;
use crate::error::SpecError;
use crate::seed::Stream;

/// The allowed concentrations.
pub(super) const ALLOWED: &str = "a number from 1e-6 to 1e12, or a list with one per segment";
const LIMITS: (f64, f64) = (1e-6, 1e12);

/// The concentration of a Dirichlet distribution.
#[derive(Clone, Debug, PartialEq)]
pub enum Concentration {
    /// One concentration for all segments.
    Same(f64),
    /// A concentration for each segment.
    Each(Vec<f64>),
}

impl Concentration {
    /// Returns the concentration of segment `i`.
    ///
    /// # Panics
    /// When a list of concentrations has no element `i`.
    pub fn of(&self, i: usize) -> f64 {
        match self {
            Concentration::Same(alpha) => *alpha,
            Concentration::Each(alphas) => alphas[i],
        }
    }

    pub(super) fn check(&self, count: usize) -> Result<(), SpecError> {
        let (least, most) = LIMITS;
        let alphas = match self {
            Concentration::Same(alpha) => std::slice::from_ref(alpha),
            Concentration::Each(alphas) => {
                if alphas.len() != count {
                    let given = format!("a list of {}", alphas.len());
                    let allowed = match count {
                        1 => "one number".to_owned(),
                        _ => format!("one number, or {count} numbers for {count} segments"),
                    };
                    return Err(SpecError::new("alpha", given, allowed));
                }
                alphas
            }
        };
        match alphas.iter().find(|alpha| !(least..=most).contains(*alpha)) {
            Some(alpha) => Err(SpecError::new("alpha", alpha, ALLOWED)),
            None => Ok(()),
        }
    }
}

/// Draws `count` proportions from a Dirichlet distribution, which sum to 1. They all have the same concentration,
/// or each has its own.
///
/// Gamma variates are drawn and normalised as logarithms, so that very small concentrations such as 1e-6 work as
/// well: one proportion is then 1 and the others are 0, as the distribution requires.
///
/// ```
/// use envgen::Seed;
/// use envgen::road::{Concentration, dirichlet};
///
/// let mut stream = Seed(7).stream("example", 0);
/// // The greater the concentration, the more similar the proportions.
/// let even = dirichlet(&Concentration::Same(1e6), 4, &mut stream);
/// assert!(even.iter().all(|share| (share - 0.25).abs() < 0.01));
/// let uneven = dirichlet(&Concentration::Each(vec![8.0, 1.0]), 2, &mut stream);
/// assert!((uneven.iter().sum::<f64>() - 1.0).abs() < 1e-12);
/// ```
pub fn dirichlet(alpha: &Concentration, count: usize, stream: &mut Stream) -> Vec<f64> {
    if count == 1 {
        return vec![1.0];
    }
    let mut shares: Vec<f64> = (0..count).map(|i| ln_gamma_variate(stream, alpha.of(i))).collect();
    let greatest = shares.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    shares.iter_mut().for_each(|share| *share = libm::exp(*share - greatest));
    let total: f64 = shares.iter().sum();
    shares.iter_mut().for_each(|share| *share /= total);
    shares
}

impl Serialize for Concentration {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Concentration::Same(alpha) => alpha.serialize(serializer),
            Concentration::Each(alphas) => alphas.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Concentration {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl<'de> de::Visitor<'de> for Visitor {
            type Value = Concentration;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a list of numbers")
            }

            fn visit_f64<E: de::Error>(self, alpha: f64) -> Result<Concentration, E> {
                Ok(Concentration::Same(alpha))
            }

            fn visit_u64<E: de::Error>(self, alpha: u64) -> Result<Concentration, E> {
                Ok(Concentration::Same(alpha as f64))
            }

            fn visit_i64<E: de::Error>(self, alpha: i64) -> Result<Concentration, E> {
                Ok(Concentration::Same(alpha as f64))
            }

            /// Reads the form of the command line, such as `1,2,1`.
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Concentration, E> {
                let number = |part: &str| part.trim().parse().map_err(E::custom);
                let mut alphas: Vec<f64> = text.split(',').map(number).collect::<Result<_, E>>()?;
                Ok(match alphas.len() {
                    1 => Concentration::Same(alphas.remove(0)),
                    _ => Concentration::Each(alphas),
                })
            }

            fn visit_seq<A: de::SeqAccess<'de>>(
                self,
                mut items: A,
            ) -> Result<Concentration, A::Error> {
                let mut alphas = Vec::new();
                while let Some(alpha) = items.next_element()? {
                    alphas.push(alpha);
                }
                Ok(Concentration::Each(alphas))
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;

    #[test]
    fn one_share_is_everything() {
        let mut stream = Seed(1).stream("test", 0);
        assert_eq!(dirichlet(&Concentration::Same(0.3), 1, &mut stream), [1.0]);
    }

    #[test]
    fn a_tiny_concentration_gives_everything_to_one() {
        // For alpha = 1e-3 and 5 shares the greatest is over 0.99 in over 98 % of draws: 5 sigma.
        let mut wins = [0_u32; 5];
        let mut clear = 0;
        for seed in 0..2000 {
            let mut stream = Seed(seed).stream("test", 0);
            let shares = dirichlet(&Concentration::Same(1e-3), 5, &mut stream);
            assert!(shares.iter().all(|p| p.is_finite() && *p >= 0.0));
            let best = (0..5).max_by(|&a, &b| shares[a].total_cmp(&shares[b])).unwrap();
            wins[best] += 1;
            clear += u32::from(shares[best] > 0.99);
        }
        assert!(clear > 1900, "{clear}");
        assert!(wins.iter().all(|&n| n.abs_diff(400) < 90), "{wins:?}");
    }
}
