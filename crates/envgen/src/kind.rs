//! The kinds of world, by name.

use std::fmt;

use serde::{Serialize, Serializer};

/// One line per kind: variant, name on the command line, and what it is.
macro_rules! kinds {
    ($($variant:ident, $name:literal, $doc:literal;)+) => {
        /// The kinds of world.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum WorldKind {
            $(#[doc = $doc] $variant,)+
        }

        impl WorldKind {
            /// Every kind, in the order of the documentation.
            pub const ALL: &'static [WorldKind] = &[$(WorldKind::$variant),+];

            /// Returns the name on the command line.
            pub fn name(self) -> &'static str {
                match self {
                    $(WorldKind::$variant => $name,)+
                }
            }

            /// Returns what the kind is, in one sentence.
            pub fn summary(self) -> &'static str {
                match self {
                    $(WorldKind::$variant => $doc.trim_ascii(),)+
                }
            }
        }
    };
}

kinds! {
    Hallway, "hallway", " A corridor whose turns follow a Markov chain.";
    Forest, "forest", " Trees scattered by a Poisson law.";
    Road, "road", " A road of straights and turns, whose lengths follow a Dirichlet law.";
    Indoor, "indoor", " Hallways, rooms and doorways that adapt to a difficulty.";
    Landscape, "landscape", " A grid of classes with a given entropy and Total Edge.";
    Cellular, "cellular", " Blocks grown by a cellular automaton, with a path from left to right.";
}

impl WorldKind {
    /// Returns the kind with this name, if there is one.
    pub(crate) fn named(name: &str) -> Option<Self> {
        WorldKind::ALL.iter().copied().find(|kind| kind.name() == name)
    }
}

impl fmt::Display for WorldKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for WorldKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
