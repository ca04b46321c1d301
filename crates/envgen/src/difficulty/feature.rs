//! Features: numbers with a name and a unit.

use serde::Serialize;

/// The description of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Feature {
    /// The name, which ends with the unit if there is one, such as `tour_length_95_m`.
    pub name: &'static str,
    /// The unit; empty for shares, ratios and counts.
    pub unit: &'static str,
    /// What the feature measures, without a full stop at the end.
    pub help: &'static str,
}

/// A number that can be the value of a feature.
pub(super) trait Number {
    fn number(self) -> Option<f64>;
}

impl Number for f64 {
    fn number(self) -> Option<f64> {
        Some(self)
    }
}

impl Number for u64 {
    fn number(self) -> Option<f64> {
        Some(self as f64)
    }
}

impl Number for Option<f64> {
    fn number(self) -> Option<f64> {
        self
    }
}

/// Declares a struct of features: fields with documentation, type and unit, each written once. The lists of the
/// features and of their values have the same order.
macro_rules! features {
    (
        $(#[$meta:meta])*
        pub struct $Features:ident {
            $($(#[doc = $doc:literal])+ $field:ident: $type:ty, $unit:literal;)+
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize)]
        pub struct $Features {
            $(
                $(#[doc = $doc])+
                pub $field: $type,
            )+
        }

        impl $Features {
            /// Every feature, in order of declaration.
            pub const FEATURES: &'static [$crate::difficulty::Feature] = &[$(
                $crate::difficulty::Feature {
                    name: stringify!($field),
                    unit: $unit,
                    help: $crate::settings::sentence(concat!($($doc),+)),
                },
            )+];

            /// Returns the values, in the order of [`Self::FEATURES`]; `None` where a feature does not exist.
            pub fn values(&self) -> Vec<Option<f64>> {
                use $crate::difficulty::feature::Number as _;
                vec![$(self.$field.number()),+]
            }
        }
    };
}
pub(super) use features;
