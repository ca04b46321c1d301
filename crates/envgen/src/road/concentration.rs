//! The concentration of the Dirichlet law: how similar the lengths of the segments are.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::error::SpecError;

/// The concentrations that are allowed.
pub(super) const ALLOWED: &str = "a number from 1e-6 to 1e12, or a list with one per segment";
const LIMITS: (f64, f64) = (1e-6, 1e12);

/// The concentration of a Dirichlet law.
#[derive(Clone, Debug, PartialEq)]
pub enum Concentration {
    /// The same for every segment.
    Same(f64),
    /// One for each segment.
    Each(Vec<f64>),
}

impl Concentration {
    /// The concentration of segment `i`.
    ///
    /// # Panics
    /// When a list of concentrations is shorter than `i + 1`.
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
                    let allowed = format!("one number, or {count} numbers for {count} segments");
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

            /// The command line's form, `1,2,1`.
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
