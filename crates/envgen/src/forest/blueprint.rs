//! The blueprint of a forest: the trees that were drawn for it.

use serde::ser::SerializeSeq;
use serde::{Serialize, Serializer};

use super::spec::ForestSpec;
use crate::seed::Seed;
use crate::world::Tree;

/// The trees of a forest, with the spec and seed from which they were drawn.
///
/// ```
/// use envgen::{Seed, Spec, forest::ForestSpec};
///
/// let spec = ForestSpec { clearing: 5.0, ..Default::default() };
/// let forest = spec.generate(Seed(7))?;
/// assert_eq!((forest.seed(), forest.spec()), (Seed(7), &spec));
/// // Trees around start and goal that were removed are counted.
/// let all = ForestSpec { clearing: 0.0, ..spec }.generate(Seed(7))?.trees().len();
/// assert_eq!(forest.trees().len() + forest.cleared() as usize, all);
/// # Ok::<(), envgen::forest::ForestError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Forest {
    pub(super) trees: Vec<Tree>,
    pub(super) cleared: u64,
    pub(super) spec: ForestSpec,
    pub(super) seed: Seed,
    pub(super) edited: bool,
    /// Whether a distribution other than the spec's gave the radii.
    pub(super) custom_radii: bool,
}

impl Forest {
    /// Returns the trees, in the order in which they were drawn.
    pub fn trees(&self) -> &[Tree] {
        &self.trees
    }

    /// Returns the number of trees that were removed to make the clearings.
    pub fn cleared(&self) -> u64 {
        self.cleared
    }

    /// Returns the spec.
    pub fn spec(&self) -> &ForestSpec {
        &self.spec
    }

    /// Returns the seed with which the forest was drawn.
    pub fn seed(&self) -> Seed {
        self.seed
    }

    /// Returns whether a density function or another distribution of radii replaced the spec's own. The spec's
    /// intensity is then the greatest value of that function, or its law of radii is `uniform`, respectively.
    pub fn edited(&self) -> bool {
        self.edited
    }
}

impl Serialize for Forest {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Fields<'a> {
            width: f64,
            height: f64,
            trees: Triples<'a>,
        }
        let Forest { trees, spec, .. } = self;
        Fields { width: spec.width, height: spec.height, trees: Triples(trees) }
            .serialize(serializer)
    }
}

/// Serialises trees as `[x, y, radius]`.
struct Triples<'a>(&'a [Tree]);

impl Serialize for Triples<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(Some(self.0.len()))?;
        for tree in self.0 {
            list.serialize_element(&[tree.center.x, tree.center.y, tree.radius])?;
        }
        list.end()
    }
}
